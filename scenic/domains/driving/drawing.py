"""Drawings of road networks from above, which need no display."""

from collections.abc import Sequence
from html import escape
from pathlib import Path
from types import MappingProxyType
from typing import TYPE_CHECKING, Final

import numpy as np
from numpy.typing import NDArray

from scenic.dataclass import dataclass
from scenic.domains.driving.lamps import LampPosts
from scenic.domains.driving.signals import LightTimes, TrafficLights
from scenic.formats.lamps import COLORS as LIGHTS

if TYPE_CHECKING:
    from scenic.domains.driving.elements import NetworkElement
    from scenic.domains.driving.network import RoadNetwork

__all__ = ["COLORS", "png", "show", "svg"]

_MARGIN: Final = 5.0
"""Metres."""

_GROUND: Final = "#e4ebdd"
COLORS: Final = MappingProxyType(
    {
        "road": "#5b6068",
        "intersection": "#6d737c",
        "shoulder": "#8f8a80",
        "sidewalk": "#c9c4ba",
        "crossing": "#f2f2f2",
        "lane": "#e9e6df",
        "way": "#ffd166",
    }
)
"""Colours of kinds of areas and lines."""

_SIGNS: Final = MappingProxyType({"stop": "#c71219", "yield": "#ffffff"})
_CORNERS: Final = MappingProxyType({"stop": 8, "yield": 3, "light": 12})
"""Corners of the marks of signs and lights, whose radius is `_MARK` metres."""
_MARK: Final = 1.1


def svg(network: "RoadNetwork", width: int = 1200) -> str:
    """Return a drawing as SVG text, ``width`` pixels wide: areas, edges of lanes, their middles, and signals."""
    left, bottom, right, top = _bounds(network)
    height = round(width * (top - bottom) / (right - left))
    view = f"{left:.2f} {-top:.2f} {right - left:.2f} {top - bottom:.2f}"
    parts = [
        f'<svg xmlns="http://www.w3.org/2000/svg" width="{width}" height="{height}" viewBox="{view}">',
        f"<style>{_style()}</style>",
        f'<rect x="{left:.2f}" y="{-top:.2f}" width="100%" height="100%" fill="{_GROUND}"/>',
    ]
    for word, some in _areas(network):
        parts += [
            f'<path class="{word}" d="{_area(element.polygon)}"><title>{escape(element.uid, quote=False)}</title></path>'
            for element in some
        ]
    for road in network.roads:
        for lane in road.lanes:
            parts += [f'<path class="lane" d="{_way(edge)}"/>' for edge in (lane.left, lane.right)]
            parts.append(f'<path class="way" d="{_way(lane.line)}"/>')
    for mark in _marks(network):
        parts.append(
            f'<path class="{mark.form}" fill="{mark.color}" stroke="{mark.border}" stroke-width=".25" d="{_way(mark.outline)}Z">'
            f"<title>{escape(mark.title, quote=False)}</title></path>"
        )
    parts.append("</svg>\n")
    return "\n".join(parts)


def _style() -> str:
    areas = " ".join(f".{word} {{ fill: {color} }}" for word, color in COLORS.items())
    lines = " ".join(
        f".{word} {{ fill: none; stroke: {COLORS[word]}; stroke-width: .13 }}" for word in ("lane", "way")
    )
    return f"{areas} {lines} .way {{ stroke-dasharray: 1.5 1.5; stroke-opacity: .7 }}"


def _way(line: object) -> str:
    points = np.round(np.asarray(line), 2).tolist()
    return "M" + "L".join(f"{x:g} {-y:g}" for x, y in points)


def _area(polygon: object) -> str:
    rings = []
    for part in getattr(polygon, "geoms", [polygon]):
        rings += [part.exterior, *part.interiors]
    return "".join(_way([point[:2] for point in ring.coords]) + "Z" for ring in rings)


def png(network: "RoadNetwork", width: int = 1600) -> bytes:
    """Return a drawing as the content of a PNG file, ``width`` pixels wide.

    Raises ``MissingLibraryError`` without Pillow.
    """
    import io

    import shapely

    from scenic.formats.imaging import require_pillow

    library = require_pillow()
    from PIL import ImageDraw

    left, bottom, right, top = _bounds(network)
    scale = width / (right - left)
    # Drawn at twice the size, so that edges are smooth.
    size = (2 * width, max(2, round(2 * scale * (top - bottom))))
    image = library.new("RGB", size, _GROUND)
    draw = ImageDraw.Draw(image)

    def pixels(line: object) -> list[tuple[float, float]]:
        points = np.asarray(line)[:, :2]
        return [(2 * scale * (x - left), 2 * scale * (top - y)) for x, y in points.tolist()]

    for word, some in _areas(network):
        for element in some:
            for part in shapely.get_parts(element.polygon):
                draw.polygon(pixels(part.exterior.coords), fill=COLORS[word])
                for ring in part.interiors:
                    draw.polygon(pixels(ring.coords), fill=_GROUND)
    for road in network.roads:
        for lane in road.lanes:
            for edge in (lane.left, lane.right):
                draw.line(pixels(edge), fill=COLORS["lane"], width=2)
    for mark in _marks(network):
        draw.polygon(pixels(mark.outline), fill=mark.color, outline=mark.border)
    stream = io.BytesIO()
    image.resize((size[0] // 2, size[1] // 2), library.Resampling.LANCZOS).save(stream, "PNG")
    return stream.getvalue()


@dataclass(frozen=True, slots=True)
class _Mark:
    """A light, a line at which traffic halts for it, or a sign, as an outline ``(n, 2)`` with colours."""

    form: str
    outline: NDArray[np.float64]
    color: str
    border: str
    title: str


def _marks(network: "RoadNetwork") -> list[_Mark]:
    """Return the signals of a network; lights have the colours with which a simulation begins."""
    lights = TrafficLights(network, LightTimes())
    signals = {signal.uid: signal for signal in network.signals}
    marks = []
    for lamp in LampPosts(network).all:
        signal = signals[lamp.key]
        state = lights.get(signal) if signal.isTrafficLight else lamp.form
        color = _SIGNS.get(state) or "#{:02x}{:02x}{:02x}".format(
            *(round(255 * part) for part in LIGHTS[state])
        )
        x, y, _ = lamp.position
        if lamp.form == "line":
            across, along = 0.5 * lamp.size[0], 0.5 * lamp.size[1]
            corners = np.array([[-across, -along], [across, -along], [across, along], [-across, along]])
        else:
            count = _CORNERS[lamp.form]
            turns = 2 * np.pi * (np.arange(count) + 0.5) / count - np.pi / 2
            corners = _MARK * np.column_stack([np.cos(turns), np.sin(turns)])
        sine, cosine = np.sin(lamp.yaw), np.cos(lamp.yaw)
        outline = corners @ np.array([[cosine, sine], [-sine, cosine]]) + (x, y)
        border = {"yield": _SIGNS["stop"], "line": color}.get(lamp.form, "#1c1d20")
        marks.append(_Mark(lamp.form, outline, color, border, f"{lamp.key} {state}"))
    return marks


def _bounds(network: "RoadNetwork") -> tuple[float, float, float, float]:
    import shapely

    elements = [*network.allRoads, *network.sidewalks, *network.shoulders, *network.crossings]
    left, bottom, right, top = shapely.total_bounds([element.polygon for element in elements]).tolist()
    return left - _MARGIN, bottom - _MARGIN, right + _MARGIN, top + _MARGIN


def _areas(network: "RoadNetwork") -> tuple[tuple[str, Sequence["NetworkElement"]], ...]:
    """The areas to draw, those on top last."""
    return (
        ("shoulder", network.shoulders),
        ("sidewalk", network.sidewalks),
        ("road", network.allRoads),
        ("intersection", network.intersections),
        ("crossing", network.crossings),
    )


def show(network: "RoadNetwork") -> Path:
    """Write the drawing to a temporary file, open it in a browser, and return the file."""
    import tempfile
    import webbrowser

    file = Path(tempfile.mkdtemp(prefix="scenic-")) / "map.svg"
    file.write_text(svg(network), encoding="utf-8")
    webbrowser.open(file.as_uri())
    return file
