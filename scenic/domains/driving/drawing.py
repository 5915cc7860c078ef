"""Drawings of road networks from above, which need no display."""

from pathlib import Path
from typing import TYPE_CHECKING, Any, Final
from xml.sax.saxutils import escape

import numpy as np

if TYPE_CHECKING:
    from scenic.domains.driving.network import RoadNetwork

__all__ = ["show", "svg"]

_MARGIN: Final = 5.0
"""Metres."""

_STYLE: Final = """
.road { fill: #5b6068 } .intersection { fill: #6d737c } .shoulder { fill: #8f8a80 }
.sidewalk { fill: #c9c4ba } .crossing { fill: #f2f2f2; fill-opacity: .75 }
.lane { fill: none; stroke: #e9e6df; stroke-width: .12; stroke-opacity: .8 }
.way { fill: none; stroke: #ffd166; stroke-width: .15; stroke-dasharray: 1.5 1.5; stroke-opacity: .7 }
"""


def svg(network: "RoadNetwork", width: int = 1200) -> str:
    """A drawing as SVG text, ``width`` pixels wide: areas, edges of lanes, and their middles with the direction of traffic."""
    import shapely

    elements = [*network.allRoads, *network.sidewalks, *network.shoulders, *network.crossings]
    left, bottom, right, top = shapely.total_bounds([element.polygon for element in elements])
    left, bottom, right, top = left - _MARGIN, bottom - _MARGIN, right + _MARGIN, top + _MARGIN
    height = round(width * (top - bottom) / (right - left))
    view = f"{left:.2f} {-top:.2f} {right - left:.2f} {top - bottom:.2f}"
    parts = [
        f'<svg xmlns="http://www.w3.org/2000/svg" width="{width}" height="{height}" viewBox="{view}">',
        f"<style>{_STYLE}</style>",
        f'<rect x="{left:.2f}" y="{-top:.2f}" width="100%" height="100%" fill="#e4ebdd"/>',
    ]
    for word, some in (
        ("shoulder", network.shoulders),
        ("sidewalk", network.sidewalks),
        ("road", network.allRoads),
        ("intersection", network.intersections),
        ("crossing", network.crossings),
    ):
        parts += [
            f'<path class="{word}" d="{_area(element.polygon)}"><title>{escape(element.uid)}</title></path>'
            for element in some
        ]
    for road in network.roads:
        for lane in road.lanes:
            parts += [f'<path class="lane" d="{_way(edge)}"/>' for edge in (lane.left, lane.right)]
            parts.append(f'<path class="way" d="{_way(lane.line)}"/>')
    parts.append("</svg>\n")
    return "\n".join(parts)


def _way(line: Any) -> str:
    points = np.round(np.asarray(line), 2).tolist()
    return "M" + "L".join(f"{x:g} {-y:g}" for x, y in points)


def _area(polygon: Any) -> str:
    rings = []
    for part in getattr(polygon, "geoms", [polygon]):
        rings += [part.exterior, *part.interiors]
    return "".join(_way([point[:2] for point in ring.coords]) + "Z" for ring in rings)


def show(network: "RoadNetwork") -> Path:
    """Write the drawing to a temporary file, open it in a browser, and return the file."""
    import tempfile
    import webbrowser

    file = Path(tempfile.mkdtemp(prefix="scenic-")) / "map.svg"
    file.write_text(svg(network), encoding="utf-8")
    webbrowser.open(file.as_uri())
    return file
