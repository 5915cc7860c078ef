"""Regions of the plane: discs, rectangles, polygons, and the columns above and below them.

Containment ignores z; points are drawn at the region's height (section 9.2 of the specification).
"""

import math
from abc import abstractmethod
from collections.abc import Iterable, Sequence
from typing import Any

import numpy as np

from scenic.graph.bounds import Bounds, outward
from scenic.graph.kinds import Column, Kind
from scenic.graph.operation import Call, Operation, always
from scenic.language.errors import ScenicTypeError, ScenicValueError
from scenic.runtime.context import here
from scenic.runtime.geometry import containment
from scenic.runtime.geometry.collision import Body
from scenic.runtime.geometry.polygons import Polygons
from scenic.runtime.regions.base import Mask, Points, Region, unsupported
from scenic.runtime.values import (
    apply,
    is_number,
    is_random,
    operate,
    to_heading,
    to_scalar,
    to_vector,
    uniform,
    vector,
)


class PlanarRegion(Region):
    """A region of the plane at some height."""

    dimension: float = 2

    @property
    def height(self) -> Any:
        """The z of the plane, in metres."""
        return 0.0

    @property
    def footprint(self) -> Region:
        return self

    @abstractmethod
    def beside(self, points: Points, *columns: Column) -> Column:
        """Distances of points ``(n, 3)`` from the region seen from above, ``(n,)``; z is ignored."""

    def heights(self, *columns: Column) -> Column:
        """The z of the plane, ``(n | 1,)``."""
        return np.zeros(1)

    def gaps(self, points: Points, *columns: Column) -> Column:
        return self.beside(points, *columns)

    def distances(self, points: Points, *columns: Column) -> Column:
        return np.hypot(self.beside(points, *columns), points[:, 2] - self.heights(*columns))

    def project(self, point: Any, direction: Any) -> tuple[Any, Any]:
        """Vertically onto the plane; a point beside the region lands nowhere."""
        target = to_vector(point)
        landed = vector(target.x, target.y, self.height)
        return apply(_LAND, landed, *self.parameters, payload=self), None


def _land(call: Call, points: Points, *columns: Column) -> Column:
    inside = call.payload.contains_points(points, *columns)
    call.reject(~inside)
    return points


_LAND = Operation(
    "plane projection",
    always(Kind.VECTOR),
    _land,
    "A point of a plane; the candidate is rejected where it lies beside the region.",
    rejects=True,
)


def _positive(value: Any, what: str) -> Any:
    size = to_scalar(value, what)
    if is_number(size) and not size >= 0:
        raise ScenicValueError(f"{what} cannot be negative: {size:g}", span=here())
    return size


def disc_points(first: Column, second: Column) -> Points:
    """Uniform points ``(n, 3)`` of the unit disc from two uniform numbers ``(n,)``."""
    # The radius of a uniform point of the unit disc is distributed as the square root of a uniform number.
    radius, angle = np.sqrt(first), 2 * math.pi * second
    return np.stack([radius * np.cos(angle), radius * np.sin(angle), np.zeros_like(radius)], axis=-1)


def _disc_point(_call: Call, first: Column, second: Column) -> Column:
    return disc_points(first, second)


def _disc_bounds(_payload: Any, first: Bounds, _second: Bounds) -> Bounds:
    reach = outward(first.upper, np.sqrt(first.upper), ulps=4).upper
    upper = np.stack([reach, reach, np.zeros_like(reach)], axis=-1)
    return Bounds(-upper, upper)


DISC_POINT = Operation(
    "disc point",
    always(Kind.VECTOR),
    _disc_point,
    "A uniform point of the unit disc, from two axes.",
    bounds=_disc_bounds,
)


class CircularRegion(PlanarRegion):
    """A disc.

    Args:
        center: its centre; points are drawn at its z.
        radius: metres.
        resolution: vertices per quadrant of the polygon that must hold the outline of an object.

    """

    parameter_names = ("center", "radius")
    draws = 2

    def __init__(self, center: Any, radius: Any, resolution: int = 32, *, name: str | None = None) -> None:
        self.center = to_vector(center, "`CircularRegion` center")
        self.radius = _positive(radius, "`CircularRegion` radius")
        self.resolution = resolution
        super().__init__(self.center, self.radius, name=name)

    @property
    def height(self) -> Any:
        return self.center.z

    def uniform_placement(self) -> tuple[Any, Any]:
        offset = apply(DISC_POINT, uniform(), uniform())
        return operate("add", self.center, operate("multiply", offset, self.radius)), None

    def draw_points(self, uniforms: Column, keys: Column, *columns: Column) -> tuple[Points, Mask | None]:
        center, radius = columns
        return center + disc_points(uniforms[0], uniforms[1]) * radius[:, np.newaxis], None

    def heights(self, *columns: Column) -> Column:
        return columns[0][:, 2]

    def box(self, *columns: Column) -> tuple[Points, Points]:
        center, radius = columns
        reach = radius[:, np.newaxis] * np.array([1.0, 1.0, 0.0])
        return center - reach, center + reach

    def sizes(self, *columns: Column) -> Column:
        return np.asarray(math.pi * columns[1] ** 2)

    def contains_points(self, points: Points, *columns: Column) -> Mask:
        center, radius = columns
        dx, dy = points[:, 0] - center[:, 0], points[:, 1] - center[:, 1]
        inside: Mask = dx * dx + dy * dy <= radius * radius
        return inside

    def beside(self, points: Points, *columns: Column) -> Column:
        center, radius = columns
        dx, dy = points[:, 0] - center[:, 0], points[:, 1] - center[:, 1]
        return np.asarray(np.maximum(np.hypot(dx, dy) - radius, 0))

    def contains_bodies(self, body: Body, lanes: int, *columns: Column) -> Mask:
        center, radius = columns
        angles = np.arange(4 * self.resolution) * (math.pi / (2 * self.resolution))
        circle = np.stack([np.cos(angles), np.sin(angles)], axis=-1)
        corners = center[:, np.newaxis, :2] + radius[:, np.newaxis, np.newaxis] * circle
        return containment.in_convex_polygon(body, corners, lanes)


class RectangularRegion(PlanarRegion):
    """A rectangle turned by a heading.

    Args:
        position: its centre.
        heading: radians, anticlockwise.
        width: extent across the heading, metres.
        length: extent along the heading, metres.

    """

    parameter_names = ("position", "heading", "width", "length")
    draws = 2

    def __init__(
        self, position: Any, heading: Any, width: Any, length: Any, *, name: str | None = None
    ) -> None:
        self.position = to_vector(position, "`RectangularRegion` position")
        self.heading = to_heading(heading, "`RectangularRegion` heading")
        self.width = _positive(width, "`RectangularRegion` width")
        self.length = _positive(length, "`RectangularRegion` length")
        super().__init__(self.position, self.heading, self.width, self.length, name=name)

    @property
    def height(self) -> Any:
        return self.position.z

    def uniform_placement(self) -> tuple[Any, Any]:
        x = operate("multiply", operate("subtract", uniform(), 0.5), self.width)
        y = operate("multiply", operate("subtract", uniform(), 0.5), self.length)
        frame = operate("from euler", self.heading, 0.0, 0.0)
        offset = vector(x, y, 0)
        if not is_number(self.heading) or self.heading != 0:
            offset = operate("rotate", frame, offset)
        return operate("add", self.position, offset), None

    def draw_points(self, uniforms: Column, keys: Column, *columns: Column) -> tuple[Points, Mask | None]:
        position, heading, width, length = columns
        across, along = (uniforms[0] - 0.5) * width, (uniforms[1] - 0.5) * length
        cos, sin = np.cos(heading), np.sin(heading)
        offsets = [across * cos - along * sin, across * sin + along * cos, np.zeros_like(across)]
        return position + np.stack(offsets, axis=-1), None

    def heights(self, *columns: Column) -> Column:
        return columns[0][:, 2]

    def box(self, *columns: Column) -> tuple[Points, Points]:
        position, heading, width, length = columns
        cos, sin = np.abs(np.cos(heading)), np.abs(np.sin(heading))
        x, y = (width * cos + length * sin) / 2, (width * sin + length * cos) / 2
        reach = np.stack([x, y, np.zeros_like(x)], axis=-1)
        return position - reach, position + reach

    def sizes(self, *columns: Column) -> Column:
        return np.asarray(columns[2] * columns[3])

    def contains_points(self, points: Points, *columns: Column) -> Mask:
        across, along = self._local(points, *columns)
        inside: Mask = (np.abs(across) <= columns[2] / 2) & (np.abs(along) <= columns[3] / 2)
        return inside

    def beside(self, points: Points, *columns: Column) -> Column:
        across, along = self._local(points, *columns)
        return np.hypot(
            np.maximum(np.abs(across) - columns[2] / 2, 0), np.maximum(np.abs(along) - columns[3] / 2, 0)
        )

    def _local(
        self, points: Points, position: Column, heading: Column, *_size: Column
    ) -> tuple[Column, Column]:
        """Coordinates of points across and along the heading, from the centre."""
        dx, dy = points[:, 0] - position[:, 0], points[:, 1] - position[:, 1]
        cos, sin = np.cos(heading), np.sin(heading)
        return dx * cos + dy * sin, dy * cos - dx * sin

    def contains_bodies(self, body: Body, lanes: int, *columns: Column) -> Mask:
        position, heading, width, length = columns
        cos, sin = np.cos(heading), np.sin(heading)
        corners = np.empty((max(map(len, columns)), 4, 2))
        for corner, (x, y) in enumerate(((-0.5, -0.5), (0.5, -0.5), (0.5, 0.5), (-0.5, 0.5))):
            corners[:, corner, 0] = position[:, 0] + (x * width * cos - y * length * sin)
            corners[:, corner, 1] = position[:, 1] + (x * width * sin + y * length * cos)
        return containment.in_convex_polygon(body, corners, lanes)


class PolygonalRegion(PlanarRegion):
    """A polygon, or several, with holes.

    Args:
        points: vertices of one polygon, in order; or
        polygon: a shapely polygon or multipolygon.
        z: height at which points are drawn, metres.

    Raises:
        ValueError: if the polygon is empty or crosses itself.

    """

    def __init__(
        self,
        points: Sequence[Any] = (),
        polygon: Any = None,
        z: float = 0,
        orientation: Any = None,
        *,
        name: str | None = None,
    ) -> None:
        if is_random(points) or is_random(z):
            raise ScenicTypeError("`PolygonalRegion` needs fixed points", span=here())
        if orientation is not None:
            raise unsupported("`PolygonalRegion` with a vector field")
        try:
            if polygon is None:
                self.polygons = Polygons.of_points([tuple(to_vector(point))[:2] for point in points])
            else:
                self.polygons = Polygons(polygon)
        except ValueError as error:
            raise ScenicValueError(f"`PolygonalRegion`: {error}", span=here()) from error
        self.z = float(z)
        super().__init__(name=name)

    @property
    def height(self) -> Any:
        return self.z

    @property
    def area(self) -> float:
        """Square metres."""
        return self.polygons.area

    @property
    def boundary(self) -> Any:
        """The outline, as a line: not built yet."""
        raise unsupported("`boundary`")

    def buffer(self, distance: float) -> "PolygonalRegion":
        """The region of all points within ``distance`` metres (shrunk where negative)."""
        return PolygonalRegion(polygon=self.polygons.polygon.buffer(distance), z=self.z)

    @staticmethod
    def unionAll(regions: Iterable["PolygonalRegion"], buf: float = 0) -> "PolygonalRegion":
        """The union of regions, each grown by ``buf`` metres."""
        members = list(regions)
        if not members or not all(isinstance(member, PolygonalRegion) for member in members):
            raise ScenicTypeError("`unionAll` takes at least one polygonal region", span=here())
        merged = Polygons.union([member.polygons for member in members], buf)
        return PolygonalRegion(polygon=merged.polygon, z=members[0].z)

    def contains_points(self, points: Points, *columns: Column) -> Mask:
        return self.polygons.contains(points[:, 0], points[:, 1])

    def beside(self, points: Points, *columns: Column) -> Column:
        return self.polygons.distances(points[:, 0], points[:, 1])

    def heights(self, *columns: Column) -> Column:
        return np.full(1, self.z)

    def draw_points(self, uniforms: Column, keys: Column, *columns: Column) -> tuple[Points, Mask | None]:
        points = np.empty((uniforms.shape[1], 3))
        points[:, :2] = self.polygons.sample(*uniforms)
        points[:, 2] = self.z
        return points, None

    def box(self, *columns: Column) -> tuple[Points, Points]:
        x, y, last_x, last_y = self.polygons.polygon.bounds
        return np.array([[x, y, self.z]]), np.array([[last_x, last_y, self.z]])

    def sizes(self, *columns: Column) -> Column:
        return np.full(1, self.area)

    def contains_bodies(self, body: Body, lanes: int, *columns: Column) -> Mask:
        return containment.in_polygons(body, self.polygons, lanes)
