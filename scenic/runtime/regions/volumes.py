"""Solid boxes and ellipsoids as regions, in closed form (section 9.2 of the specification)."""

import math
from abc import abstractmethod
from typing import Any

import numpy as np

from scenic.graph import quaternions
from scenic.graph.bounds import Bounds, outward
from scenic.graph.kinds import Column, Kind
from scenic.graph.operation import Operation, always
from scenic.language.errors import ScenicValueError
from scenic.runtime.geometry.contact.collision import Body, collide
from scenic.runtime.geometry.contact.scalar_bodies import PlacedBody, placed
from scenic.runtime.geometry.containment import body_containment as containment
from scenic.runtime.geometry.meshes import primitives
from scenic.runtime.geometry.meshes.mesh import Mesh
from scenic.runtime.geometry.meshes.polytopes import half_spaces
from scenic.runtime.geometry.poses import Poses
from scenic.runtime.ground.context import here
from scenic.runtime.regions import generic
from scenic.runtime.regions.base import Mask, Points, Region
from scenic.runtime.regions.nearness import body_box
from scenic.runtime.regions.scalar_regions import Ball, Single, SingleBox
from scenic.runtime.values.values import (
    Orientation,
    apply,
    is_number,
    operate,
    to_orientation,
    to_vector,
    uniform,
    vector,
)

BISECTIONS = 60
"""Halvings of an interval until nothing is left of it in double precision."""


class PlacedVolume(Region):
    """A volume of some dimensions, turned and moved.

    ``tolerance``, ``centerMesh`` and ``onDirection`` are those of regions made of meshes; closed forms need none of them.
    """

    dimension: float = 3
    parameter_names = ("dimensions", "position", "rotation")

    def __init__(
        self,
        dimensions: object = (1, 1, 1),
        position: object = None,
        rotation: object = None,
        orientation: object = None,
        tolerance: float = 1e-6,
        centerMesh: bool = True,
        onDirection: object = None,
        *,
        name: str | None = None,
    ) -> None:
        what = f"`{type(self).__name__}`"
        self.orientation = orientation
        self.has_orientation = orientation is not None
        self.onDirection = onDirection
        self.tolerance = tolerance
        sizes = list(to_vector(dimensions, f"{what} dimensions"))
        if any(is_number(size) and not size > 0 for size in sizes):
            raise ScenicValueError(f"{what} needs three positive dimensions, not {dimensions!r}", span=here())
        self.dimensions = vector(*sizes)
        self.position = vector(0, 0, 0) if position is None else to_vector(position, f"{what} position")
        self.rotation = Orientation() if rotation is None else to_orientation(rotation, f"{what} rotation")
        super().__init__(self.dimensions, self.position, self.rotation, name=name)

    def project(self, point: object, direction: object) -> tuple[Any, Any]:
        way = self.onDirection if direction is None else direction
        landed: Any = generic.meshed(self).project(point, way)[0]
        return landed, self.orientation_at(landed)

    def getSurfaceRegion(self) -> Region:
        """Return the surface of the volume."""
        region: Region = generic.meshed(self).getSurfaceRegion()
        return region

    def getVolumeRegion(self) -> Region:
        """Return the volume itself."""
        return self

    @property
    def mesh(self) -> Any:
        """The mesh in the world, trimesh's; of a region without random parameters."""
        return generic.meshed(self).mesh

    def voxelized(self, pitch: float) -> Region:
        """Return the cells of this edge length, in metres, that the volume touches."""
        region: Region = generic.voxelized(self, pitch)
        return region

    @property
    def boundingPolygon(self) -> Any:
        """The region seen from above."""
        return generic.outline_from_above(self)

    def _as_body(self) -> PlacedBody:
        """Return the box about it, where nothing is random."""
        return placed(self.position.row, self.rotation.q, self.dimensions.row, primitives.box())

    @property
    def isConvex(self) -> bool:
        """Boxes and ellipsoids are convex."""
        return True

    @property
    def inradius(self) -> Any:
        """The radius of the largest ball about the middle that it holds, in metres."""
        return operate("divide", operate("minimum", *self.dimensions), 2)

    @property
    def circumcircle(self) -> tuple[Any, Any]:
        """Centre and radius of the ball around the box of its dimensions."""
        return self.position, operate("divide", operate("norm", self.dimensions), 2)

    @staticmethod
    @abstractmethod
    def unit_mesh() -> Mesh:
        """Return the mesh of dimensions 1 as which the volume collides."""

    def is_surely_convex(self) -> bool:
        return True

    def meets_bodies(self, body: Body, lanes: int, *columns: Column) -> Mask:
        dimensions, position, rotation = columns
        solid = Body((self.unit_mesh(),), None, Poses(position, rotation, dimensions))
        return np.asarray(~collide([solid, body], np.array([[0, 1]]), lanes=lanes).free)

    @abstractmethod
    def unit_points(self, uniforms: Column) -> Points:
        """Uniform points ``(n, 3)`` of the volume of dimensions 1 about the origin, from numbers ``(3, n)``."""

    def draw_points(self, uniforms: Column, keys: Column, *columns: Column) -> tuple[Points, Mask | None]:
        dimensions, position, rotation = columns
        return position + quaternions.rotate(rotation, self.unit_points(uniforms) * dimensions), None

    def gaps(self, points: Points, *columns: Column) -> Column:
        return self.distances(points, *columns)

    def extent(self, *parameters: Bounds | None) -> Bounds | None:
        dimensions, position, rotation = parameters
        return super().extent(*parameters) or body_box(position, rotation, dimensions)

    def _placed(self, x: object, y: object, z: object) -> tuple[Any, Any]:
        """The point at these fractions of the dimensions from the centre."""
        size = self.dimensions
        offset = vector(
            operate("multiply", x, size.x), operate("multiply", y, size.y), operate("multiply", z, size.z)
        )
        if not isinstance(self.rotation, Orientation) or self.rotation != Orientation():
            offset = operate("rotate", self.rotation, offset)
        point = operate("add", self.position, offset)
        return point, self.orientation_at(point)


def _local(points: Points, dimensions: Column, position: Column, rotation: Column) -> Points:
    """Points in the unit frame of the volume."""
    local: Points = quaternions.rotate(quaternions.conjugate(rotation), points - position) / dimensions
    return local


class BoxRegion(PlacedVolume):
    """A solid box."""

    @staticmethod
    def unit_mesh() -> Mesh:
        return primitives.box()

    def single(self) -> Single | None:
        return SingleBox(self._as_body(), self.rotation.q, self.dimensions.row)

    def uniform_placement(self) -> tuple[Any, Any]:
        return self._placed(*(operate("subtract", uniform(), 0.5) for _ in range(3)))

    def unit_points(self, uniforms: Column) -> Points:
        return uniforms.T - 0.5

    def box(self, *columns: Column) -> tuple[Points, Points]:
        dimensions, position, rotation = columns
        matrix = np.abs(quaternions.to_matrix(rotation))
        reach = (matrix * dimensions[:, np.newaxis, :] / 2).sum(axis=2)
        return position - reach, position + reach

    def sizes(self, *columns: Column) -> Column:
        return np.asarray(columns[0][:, 0] * columns[0][:, 1] * columns[0][:, 2])

    def contains_points(self, points: Points, *columns: Column) -> Mask:
        local = np.abs(_local(points, *columns))
        inside: Mask = (local[:, 0] <= 0.5) & (local[:, 1] <= 0.5) & (local[:, 2] <= 0.5)
        return inside

    def distances(self, points: Points, *columns: Column) -> Column:
        beside = np.maximum((np.abs(_local(points, *columns)) - 0.5) * columns[0], 0)
        return np.asarray(np.sqrt(beside[:, 0] ** 2 + beside[:, 1] ** 2 + beside[:, 2] ** 2))

    def half_spaces(self, *columns: Column) -> Column | None:
        dimensions, position, rotation = columns
        return half_spaces(primitives.box(), Poses(position, rotation, dimensions))

    def nearest(self, points: Points, *columns: Column) -> Points:
        dimensions, position, rotation = columns
        inside = np.clip(_local(points, *columns), -0.5, 0.5) * dimensions
        return position + quaternions.rotate(rotation, inside)

    def contains_bodies(self, body: Body, lanes: int, *columns: Column) -> Mask:
        return containment.in_box(body, columns[0], columns[1], columns[2], lanes)


def ball_points(first: Column, second: Column, third: Column) -> Points:
    """Uniform points ``(n, 3)`` of the unit ball from three uniform numbers ``(n,)``."""
    # Archimedes: height and azimuth of a uniform point of the sphere are uniform; the radius is a cube root.
    radius, z, angle = np.cbrt(first), 2 * second - 1, 2 * math.pi * third
    level = np.sqrt((1 - z) * (1 + z))
    return np.stack([radius * level * np.cos(angle), radius * level * np.sin(angle), radius * z], axis=-1)


def _ball_bounds(_payload: object, first: Bounds, *_others: Bounds) -> Bounds:
    reach = outward(first.upper, np.cbrt(first.upper), ulps=4).upper
    upper = np.stack([reach, reach, reach], axis=-1)
    return Bounds(-upper, upper)


BALL_POINT = Operation(
    "ball point",
    always(Kind.VECTOR),
    lambda _call, first, second, third: ball_points(first, second, third),
    "A uniform point of the unit ball, from three axes.",
    bounds=_ball_bounds,
)


class SpheroidRegion(PlacedVolume):
    """A solid ellipsoid with these three diameters."""

    def __init__(self, dimensions: object = (2, 2, 2), *args: Any, **options: Any) -> None:
        super().__init__(dimensions, *args, **options)

    @staticmethod
    def unit_mesh() -> Mesh:
        return primitives.spheroid()

    def ball(self, *columns: Column) -> tuple[Points, Column] | None:
        dimensions, position, _ = columns
        if not (dimensions == dimensions[:, :1]).all():
            return None
        return position, dimensions[:, 0] / 2

    def single(self) -> Single | None:
        return Ball(self._as_body())

    def uniform_placement(self) -> tuple[Any, Any]:
        point = apply(BALL_POINT, uniform(), uniform(), uniform())
        return self._placed(*(operate("multiply", 0.5, part) for part in point))

    def unit_points(self, uniforms: Column) -> Points:
        return ball_points(*uniforms) / 2

    def box(self, *columns: Column) -> tuple[Points, Points]:
        # An ellipsoid reaches as far along an axis of the world as the length of that row of R diag(half axes).
        dimensions, position, rotation = columns
        scaled = quaternions.to_matrix(rotation) * dimensions[:, np.newaxis, :] / 2
        reach = np.sqrt((scaled * scaled).sum(axis=2))
        return position - reach, position + reach

    def sizes(self, *columns: Column) -> Column:
        return np.asarray(math.pi / 6 * columns[0][:, 0] * columns[0][:, 1] * columns[0][:, 2])

    def contains_points(self, points: Points, *columns: Column) -> Mask:
        local = _local(points, *columns)
        x, y, z = local[:, 0], local[:, 1], local[:, 2]
        inside: Mask = x * x + y * y + z * z <= 0.25
        return inside

    def nearest(self, points: Points, *columns: Column) -> Points:
        dimensions, position, rotation = columns
        inside = self.contains_points(points, *columns)
        local = _local(points, *columns) * dimensions
        found = np.where(local < 0, -1.0, 1.0) * self._feet(np.abs(local), dimensions)
        placed = position + quaternions.rotate(rotation, found)
        return np.where(inside[:, np.newaxis], points, placed)

    def distances(self, points: Points, *columns: Column) -> Column:
        point = np.abs(_local(points, *columns)) * columns[0]
        gap = point - self._feet(point, columns[0])
        distance = np.sqrt(gap[:, 0] ** 2 + gap[:, 1] ** 2 + gap[:, 2] ** 2)
        return np.where(self.contains_points(points, *columns), 0.0, distance)

    @staticmethod
    def _feet(point: Points, dimensions: Column) -> Points:
        """The points of the surface nearest to outer points of the first octant, in the frame of the ellipsoid, in metres.

        By the root of a decreasing function of one variable, bisected until the interval is spent. The nearest point x of the surface to an outer point y has x = a^2 y / (t + a^2), componentwise over the
        half axes a, for the t > 0 that puts x on the surface (D. Eberly, "Distance from a Point to an Ellipse, an
        Ellipsoid, or a Hyperellipsoid", 2013).
        """
        half = dimensions / 2
        squares = half * half
        length = np.sqrt(point[:, 0] ** 2 + point[:, 1] ** 2 + point[:, 2] ** 2)
        low, high = np.zeros_like(length), length * np.maximum(np.maximum(half[:, 0], half[:, 1]), half[:, 2])
        for _ in range(BISECTIONS):
            middle = (low + high) / 2
            ratio = half * point / (middle[:, np.newaxis] + squares)
            outside = ratio[:, 0] ** 2 + ratio[:, 1] ** 2 + ratio[:, 2] ** 2 > 1
            low, high = np.where(outside, middle, low), np.where(outside, high, middle)
        feet: Points = squares * point / (high[:, np.newaxis] + squares)
        return feet

    def contains_bodies(self, body: Body, lanes: int, *columns: Column) -> Mask:
        return containment.in_ellipsoid(body, columns[0], columns[1], columns[2], lanes)
