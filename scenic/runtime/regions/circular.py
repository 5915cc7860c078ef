"""Discs of the plane, and uniform points of discs."""

import math
from typing import Any

import numpy as np

from scenic.graph import intervals
from scenic.graph.bounds import Bounds, outward
from scenic.graph.kinds import Column, Kind
from scenic.graph.operation import Operation, always
from scenic.graph.operations.functions import cos_bounds, sin_bounds
from scenic.runtime.geometry.contact.collision import Body
from scenic.runtime.geometry.containment import body_containment as containment
from scenic.runtime.geometry.flat.outlines import Geometries
from scenic.runtime.geometry.flat.rectangles import Rectangles
from scenic.runtime.regions.base import Mask, Points
from scenic.runtime.regions.flat import rows_of
from scenic.runtime.regions.planar import PlanarRegion, positive, rounded_outward
from scenic.runtime.regions.scalar_regions import Disc, Single
from scenic.runtime.values.values import (
    apply,
    operate,
    to_vector,
    uniform,
)


def disc_points(first: Column, second: Column) -> Points:
    """Uniform points ``(n, 3)`` of the unit disc from two uniform numbers ``(n,)``."""
    # The radius of a uniform point of the unit disc is distributed as the square root of a uniform number.
    radius, angle = np.sqrt(first), 2 * math.pi * second
    return np.stack([radius * np.cos(angle), radius * np.sin(angle), np.zeros_like(radius)], axis=-1)


def disc_extent(center: Bounds | None, radius: Bounds | None) -> Bounds | None:
    """Return the box of a level disc, from bounds of its centre and radius."""
    if center is None or radius is None:
        return None
    reach = np.maximum(radius.upper, 0.0)[:, np.newaxis] * np.array([1.0, 1.0, 0.0])
    return intervals.add(center, Bounds(-reach, reach))


def _disc_bounds(_payload: object, first: Bounds, second: Bounds) -> Bounds:
    radius = outward(np.sqrt(first.lower), np.sqrt(first.upper), ulps=4)
    radius = Bounds(np.maximum(radius.lower, 0.0), radius.upper)
    angle = Bounds(math.tau * second.lower, math.tau * second.upper)
    x, y = (intervals.multiply(radius, wave(None, angle)) for wave in (cos_bounds, sin_bounds))
    return intervals.widened(intervals.stacked([x, y, Bounds.exactly(0.0)]), 1e-14)


def _disc_inverse(_payload: object, result: Bounds, _first: Bounds, _second: Bounds) -> list[Bounds | None]:
    """Return the squares of the distances that points in these bounds have from the middle."""
    squares = [intervals.square(part) for part in intervals.components(result)[:2]]
    return [intervals.widened(intervals.total(squares), 1e-13), None]


DISC_POINT = Operation(
    "disc point",
    always(Kind.VECTOR),
    lambda _call, first, second: disc_points(first, second),
    "A uniform point of the unit disc, from two axes.",
    bounds=_disc_bounds,
    inverse=_disc_inverse,
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

    def __init__(
        self, center: object, radius: object, resolution: int = 32, *, name: str | None = None
    ) -> None:
        self.center = to_vector(center, "`CircularRegion` center")
        self.radius = positive(radius, "`CircularRegion` radius")
        self.resolution = resolution
        super().__init__(self.center, self.radius, name=name)

    @property
    def height(self) -> Any:
        return self.center.z

    @property
    def circumcircle(self) -> tuple[Any, Any]:
        return self.center, self.radius

    @property
    def inradius(self) -> Any:
        """The radius of the largest disc about the middle that it holds, in metres."""
        return self.radius

    def uniform_placement(self) -> tuple[Any, Any]:
        offset = apply(DISC_POINT, uniform(), uniform())
        point = operate("add", self.center, operate("multiply", offset, self.radius))
        return point, self.orientation_at(point)

    def draw_points(self, uniforms: Column, keys: Column, *columns: Column) -> tuple[Points, Mask | None]:
        center, radius = columns
        return center + disc_points(uniforms[0], uniforms[1]) * radius[:, np.newaxis], None

    def heights(self, *columns: Column) -> Column:
        return columns[0][:, 2]

    def polygons_now(self) -> Any:
        import shapely

        disc = shapely.Point(self.center.x, self.center.y)
        return disc.buffer(self.radius, quad_segs=self.resolution)

    def box(self, *columns: Column) -> tuple[Points, Points]:
        center, radius = columns
        reach = radius[:, np.newaxis] * np.array([1.0, 1.0, 0.0])
        return rounded_outward(center - reach, center + reach)

    def extent(self, *parameters: Bounds | None) -> Bounds | None:
        return super().extent(*parameters) or disc_extent(*parameters)

    def sizes(self, *columns: Column) -> Column:
        return np.asarray(math.pi * columns[1] ** 2)

    def single(self) -> Single | None:
        return Disc(self.center.row, self.radius, 4 * self.resolution)

    def contains_points(self, points: Points, *columns: Column) -> Mask:
        center, radius = columns
        dx, dy = points[:, 0] - center[:, 0], points[:, 1] - center[:, 1]
        inside: Mask = dx * dx + dy * dy <= radius * radius
        return inside

    def beside(self, points: Points, *columns: Column) -> Column:
        center, radius = columns
        dx, dy = points[:, 0] - center[:, 0], points[:, 1] - center[:, 1]
        return np.asarray(np.maximum(np.hypot(dx, dy) - radius, 0))

    def depths(self, points: Points, *columns: Column) -> Column:
        center, radius = columns
        dx, dy = points[:, 0] - center[:, 0], points[:, 1] - center[:, 1]
        return np.asarray(np.maximum(radius - np.hypot(dx, dy), 0))

    def nearest(self, points: Points, *columns: Column) -> Points:
        center, radius = columns
        offset = points[:, :2] - center[:, :2]
        away = np.hypot(offset[:, 0], offset[:, 1])
        share = np.minimum(1.0, radius / np.where(away > 0, away, 1.0))
        found = np.array(points)
        found[:, :2] = center[:, :2] + share[:, np.newaxis] * offset
        return found

    def meets_rectangles(self, rectangles: Rectangles, *columns: Column) -> tuple[Mask, Mask]:
        met: Mask = rectangles.distances(columns[0][:, :2]) <= columns[1]
        return met, np.zeros(1, dtype=np.bool_)

    def meets_outlines(self, outlines: Geometries, *columns: Column) -> Mask:
        import shapely

        center, radius = columns
        return np.asarray(shapely.distance(outlines, shapely.points(center[:, :2])) <= radius)

    def meets_places(self, points: Points, *columns: Column) -> Mask:
        center, radius = columns
        away = np.hypot(points[..., 0] - center[:, [0]], points[..., 1] - center[:, [1]])
        return np.asarray(np.logical_or.reduce(away <= radius[:, np.newaxis], axis=1))

    def geometries(self, *columns: Column) -> Geometries:
        import shapely

        return np.asarray(shapely.polygons(self._corners(*columns)), dtype=np.object_)

    def _corners(self, center: Column, radius: Column) -> Column:
        """Return the vertices ``(n | 1, k, 2)`` of the polygon that stands for the disc, anticlockwise."""
        angles = np.arange(4 * self.resolution) * (math.pi / (2 * self.resolution))
        circle = np.stack([np.cos(angles), np.sin(angles)], axis=-1)
        corners: Column = center[:, np.newaxis, :2] + radius[:, np.newaxis, np.newaxis] * circle
        return corners

    def contains_bodies(self, body: Body, lanes: int, *columns: Column) -> Mask:
        center, radius = columns
        inside, is_open = containment.surely_in_disc(body, center, radius, 4 * self.resolution, lanes)
        left = np.flatnonzero(is_open)
        if len(left):
            corners = self._corners(*rows_of(columns, left))
            inside[left] = containment.in_convex_polygon(body.take(left), corners, len(left))
        return inside
