"""Plans: scenes on road maps seen from straight above."""

import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import PIL.Image
import PIL.ImageDraw
import shapely

from scenic.formats.mesh_instances import PALETTE

__all__ = ["Footprint", "drawn", "placed"]

_FINER = 3
"""Pictures are drawn this many times larger, and made smaller again for smooth lines."""
_MARGIN = 22.0
"""Metres around the objects."""
_GROUND = (222, 226, 220)
_REGIONS = (("roadOrShoulder", (168, 171, 176)), ("road", (146, 150, 156)), ("sidewalk", (201, 198, 190)))
_LANES = (214, 216, 220)


@dataclass(frozen=True, slots=True)
class Footprint:
    """An object from above: the corners of its rectangle, front left first and clockwise, its colour and its opacity."""

    corners: tuple[tuple[float, float], ...]
    color: tuple[int, int, int]
    opacity: float


def placed(thing: Any, position: Any = None, heading: float | None = None, opacity: float = 1.0) -> Footprint:
    """Return the footprint of an object, where it is or at another position with another heading."""
    position = thing.position if position is None else position
    heading = thing.heading if heading is None else heading
    sine, cosine = math.sin(heading), math.cos(heading)
    half_width, half_length = thing.width / 2, thing.length / 2
    corners = tuple(
        (position.x + x * cosine - y * sine, position.y + x * sine + y * cosine)
        for x, y in (
            (-half_width, half_length),
            (half_width, half_length),
            (half_width, -half_length),
            (-half_width, -half_length),
        )
    )
    red, green, blue = (thing.color or PALETTE[0])[:3]
    return Footprint(corners, (round(255 * red), round(255 * green), round(255 * blue)), opacity)


def drawn(scene: Any, footprints: Sequence[Footprint], size: tuple[int, int]) -> PIL.Image.Image:
    """The plan of a scene with these objects."""
    points = [corner for footprint in footprints for corner in footprint.corners]
    west, south = (min(axis) - _MARGIN for axis in zip(*points, strict=True))
    east, north = (max(axis) + _MARGIN for axis in zip(*points, strict=True))
    width, height = (_FINER * pixels for pixels in size)
    scale = min(width / (east - west), height / (north - south))
    middle = ((west + east) / 2, (south + north) / 2)

    def pixels(points: Any) -> list[tuple[float, float]]:
        return [
            (width / 2 + (x - middle[0]) * scale, height / 2 - (y - middle[1]) * scale) for x, y, *_ in points
        ]

    sheet = PIL.Image.new("RGB", (width, height), _GROUND)
    draw = PIL.ImageDraw.Draw(sheet)
    for name, color in _REGIONS:
        for polygon in _polygons(scene.regions.get(name)):
            draw.polygon(pixels(polygon.exterior.coords), fill=color)
            for hole in polygon.interiors:
                draw.polygon(pixels(hole.coords), fill=_GROUND)
    network = scene.params.get("map") and scene.workspace.network
    for lane in network.lanes if network else ():
        for polygon in _polygons(lane):
            draw.line(pixels(polygon.exterior.coords), fill=_LANES, width=_FINER)
    for footprint in footprints:
        layer = PIL.Image.new("RGBA", sheet.size, (*footprint.color, 0))
        brush = PIL.ImageDraw.Draw(layer)
        places = pixels(footprint.corners)
        alpha = round(255 * footprint.opacity)
        brush.polygon(places, fill=(*footprint.color, alpha))
        # The front is marked, for headings.
        brush.line(places[:2], fill=(255, 255, 255, alpha), width=2 * _FINER)
        sheet.paste(layer, (0, 0), layer)
    return sheet.resize(size, PIL.Image.Resampling.LANCZOS)


def _polygons(region: Any) -> list[shapely.Polygon]:
    shape = getattr(region, "polygons", None)
    return list(shape.geoms) if shape is not None else []
