"""Roads of a Webots world as polygons of the plane: lanes with directions, borders, crossings.

The fields are those of the PROTO nodes ``Road``, ``StraightRoadSegment``, ``CurvedRoadSegment``, ``Crossroad`` and
``PedestrianCrossing`` (https://cyberbotics.com/doc/guide/object-road). Heights are dropped. A lane is as wide as the others of
its road, and runs with the traffic of its side; where traffic keeps left, ``info`` of ``WorldInfo`` has a line that says so.
"""

import math
from collections.abc import Sequence
from typing import Any, Final

import numpy as np
import numpy.typing as npt

from scenic.dataclass import dataclass
from scenic.formats.webots_reading import WorldError, WorldFile, WorldNode

__all__ = ["Street", "Streets", "streets_of"]

_SNAP: Final = 0.05
"""Ends of borders so near to a crossroad, in metres, are moved to it."""
_BORDER: Final = 0.8
"""Width of a sidewalk, in metres, if the road does not give it."""
_ROADS: Final = ("Road", "StraightRoadSegment", "CurvedRoadSegment")

Array = npt.NDArray[np.float64]


@dataclass(frozen=True, slots=True)
class Street:
    """A road.

    Attributes:
        id: its name in the world.
        surface: the polygon of its lanes.
        lanes: pairs of a polygon and a heading in radians, anticlockwise from north, for each lane of each segment.
        curbs: the borders as chains of points ``(n, 2)``, in the direction of the traffic beside them.
        sidewalks: the polygons of its sidewalks.

    """

    id: str
    surface: Any
    lanes: tuple[tuple[Any, float], ...]
    curbs: tuple[Array, ...]
    sidewalks: tuple[Any, ...]


@dataclass(frozen=True, slots=True)
class Streets:
    """The roads of a world; ``crossroads`` and ``crossings`` are polygons."""

    streets: tuple[Street, ...]
    crossroads: tuple[Any, ...]
    crossings: tuple[Any, ...]


def streets_of(world: WorldFile) -> Streets:
    """Return the roads of a world; raises `WorldError` if a node makes no road."""
    from shapely.geometry import Polygon  # slow to import

    crossroads = []
    for node in world.of("Crossroad"):
        outline = _placed(world, node, node.points("shape", ()))
        if len(outline) < 3:
            raise WorldError(f"the crossroad {node.fields.get('id', '')!r} of '{world.path}' has no shape")
        crossroads.append(_valid(Polygon(outline)))
    crossings = [_crossing(world, node) for node in world.of("PedestrianCrossing")]
    keeps_left = _keeps_left(world)
    streets = tuple(_street(world, node, crossroads, keeps_left) for node in world.of(*_ROADS))
    return Streets(streets, tuple(crossroads), tuple(crossings))


def _keeps_left(world: WorldFile) -> bool:
    for node in world.of("WorldInfo"):
        info = node.fields.get("info", [])
        lines = info if isinstance(info, list) else [info]
        if any("left-hand traffic" in str(line).lower() for line in lines):
            return True
    return False


def _placed(world: WorldFile, node: WorldNode, points: Array) -> Array:
    """Points of a node's frame in our plane, ``(n, 2)``."""
    from scipy.spatial.transform import Rotation  # slow to import

    x, y, z, angle = node.vector("rotation", (0, 0, 1, 0))
    axis = np.array([x, y, z])
    length = float(np.linalg.norm(axis))
    rotated_points = points if not length else Rotation.from_rotvec(axis / length * angle).apply(points)
    there = np.asarray(rotated_points).reshape(-1, 3) + node.vector("translation", (0, 0, 0))
    ours: Array = (there @ world.matrix)[:, :2]
    return ours


def _valid(polygon: Any) -> Any:
    return polygon if polygon.is_valid else polygon.buffer(0)


def _crossing(world: WorldFile, node: WorldNode) -> Any:
    """Return the rectangle of a pedestrian crossing, in the horizontal plane of its world."""
    from shapely.geometry import Polygon

    width, length = node.vector("size", (20, 8))[:2] / 2
    up = world.axes.index("U")
    across, along = (axis for axis in range(3) if axis != up)
    corners = np.zeros((4, 3))
    corners[:, across] = (-width, width, width, -width)
    corners[:, along] = (-length, -length, length, length)
    return _valid(Polygon(_placed(world, node, corners)))


def _way(world: WorldFile, node: WorldNode) -> Array:
    """Return the middle of a road in the frame of its node, ``(n, 3)``."""
    up = world.axes.index("U")
    across, along = (axis for axis in range(3) if axis != up)
    if node.kind == "StraightRoadSegment":
        way = np.zeros((2, 3))
        way[1, across] = node.number("length", 10)
        return way
    if node.kind == "CurvedRoadSegment":
        count = max(1, round(node.number("subdivision", 16)))
        angles = np.linspace(0, node.number("totalAngle", math.pi / 2), count + 1)
        way = np.zeros((count + 1, 3))
        radius = node.number("curvatureRadius", 10)
        way[:, across], way[:, along] = radius * np.cos(angles), radius * np.sin(angles)
        return way
    return node.points("wayPoints", ())


def _street(world: WorldFile, node: WorldNode, crossroads: Sequence[object], keeps_left: bool) -> Street:
    from shapely.geometry import Polygon

    name = str(node.fields.get("id", node.fields.get("name", node.name or "")))
    way = _placed(world, node, _way(world, node))
    is_distinct = np.ones(len(way), dtype=bool)
    is_distinct[1:] = np.linalg.norm(np.diff(way, axis=0), axis=1) > 1e-9
    way = way[is_distinct]
    count = round(node.number("numberOfLanes", 2))
    forward = round(node.number("numberOfForwardLanes", 1))
    width = node.number("width", 7)
    if len(way) < 2 or count < 1 or not 0 <= forward <= count or not width > 0:
        raise WorldError(
            f"the road {name!r} of '{world.path}' cannot be used: {len(way)} way points, {count} lanes of which {forward} forward, "
            f"{width:g} m wide",
            help="a road has two way points, a lane and a width at least",
        )
    # Lanes from right to left, seen along the way points.
    edges = [
        _at_crossroads(_offset(way, -width / 2 + width * number / count), crossroads)
        for number in range(count + 1)
    ]
    runs_forward = [
        (number >= count - forward) if keeps_left else (number < forward) for number in range(count)
    ]
    lanes: list[tuple[Any, float]] = []
    for number, is_forward in enumerate(runs_forward):
        right, left = edges[number], edges[number + 1]
        for start in range(len(way) - 1):
            dx, dy = way[start + 1] - way[start]
            heading = math.atan2(-dx, dy)
            cell = Polygon([right[start], right[start + 1], left[start + 1], left[start]])
            lanes.append((_valid(cell), heading if is_forward else _opposite(heading)))
    sides = ((edges[0], runs_forward[0]), (edges[-1], runs_forward[-1]))
    return Street(
        name,
        _valid(Polygon([*edges[0], *edges[-1][::-1]])),
        tuple(lanes),
        tuple(line if is_forward else line[::-1] for line, is_forward in sides),
        tuple(_sidewalks(node, way, width)),
    )


def _sidewalks(node: WorldNode, way: Array, width: float) -> list[Any]:
    from shapely.geometry import Polygon

    widths = node.vector("roadBorderWidth", (_BORDER,))
    border = float(widths[0]) if len(widths) else _BORDER
    sidewalks = []
    for side, field in ((-1, "rightBorder"), (1, "leftBorder")):
        if node.flag(field, True) and border > 0:
            inner, outer = (_offset(way, side * (width / 2 + more)) for more in (0, border))
            sidewalks.append(_valid(Polygon([*inner, *outer[::-1]])))
    return sidewalks


def _opposite(heading: float) -> float:
    return heading - math.pi if heading > 0 else heading + math.pi


def _offset(way: Array, distance: float) -> Array:
    """A chain of points ``(n, 2)`` moved to the left by a distance, with mitred corners."""
    steps = np.diff(way, axis=0)
    steps /= np.linalg.norm(steps, axis=1, keepdims=True)
    normals = np.stack([-steps[:, 1], steps[:, 0]], axis=1)
    before, after = np.vstack([normals[:1], normals]), np.vstack([normals, normals[-1:]])
    shares = 1 + np.sum(before * after, axis=1, keepdims=True)
    # Where a road turns back on itself there is no corner.
    mitre = np.where(shares > 0.2, (before + after) / np.maximum(shares, 0.2), after)
    offset_points: Array = way + distance * mitre
    return offset_points


def _at_crossroads(line: Array, crossroads: Sequence[Any]) -> Array:
    """Return a border whose ends, where they are near to a crossroad, are moved to its outline, to a corner if one is near."""
    from shapely.geometry import Point
    from shapely.ops import nearest_points

    line = line.copy()
    for end in (0, -1):
        point = Point(line[end])
        for crossroad in crossroads:
            outline = crossroad.exterior
            if outline.distance(point) > _SNAP:
                continue
            corners = np.array(outline.coords)
            gaps = np.linalg.norm(corners - line[end], axis=1)
            near = int(gaps.argmin())
            line[end] = corners[near] if gaps[near] <= _SNAP else nearest_points(outline, point)[0].coords[0]
            break
    return line
