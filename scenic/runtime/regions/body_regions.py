"""Regions that belong to an object: the space it fills, and the sides of its surface."""

from collections.abc import Mapping, Sequence
from functools import cached_property
from types import MappingProxyType
from typing import Any

import numpy as np

from scenic.dataclass import dataclass
from scenic.graph import intervals
from scenic.graph.bounds import Bounds
from scenic.graph.kinds import Column, Kind
from scenic.graph.operation import Call, Operation, always, stacking
from scenic.language.errors import ScenicTypeError
from scenic.runtime.geometry.contact.collision import Body, collide
from scenic.runtime.geometry.contact.scalar_bodies import gap
from scenic.runtime.geometry.containment import body_containment as containment
from scenic.runtime.geometry.containment import body_points, distance
from scenic.runtime.geometry.meshes import projection, surface
from scenic.runtime.geometry.meshes.polytopes import half_spaces
from scenic.runtime.geometry.meshes.surface import Side
from scenic.runtime.ground.context import here
from scenic.runtime.regions import generic
from scenic.runtime.regions.base import Mask, Points, Region, unsupported
from scenic.runtime.regions.fixed_sides import FixedSide
from scenic.runtime.regions.nearness import body_box, body_reach, grown, only_within, separation
from scenic.runtime.regions.stacked import Stack, body_of, body_operands, is_body, placed_of
from scenic.runtime.values.lazy import is_lazy
from scenic.runtime.values.values import (
    apply,
    describe,
    is_number,
    is_random,
    operate,
    to_vector,
    uniform,
    vector,
)

SIDES: Mapping[str, Side] = MappingProxyType(
    {
        "surface": None,
        "right": (0, 1),
        "left": (0, -1),
        "front": (1, 1),
        "back": (1, -1),
        "top": (2, 1),
        "bottom": (2, -1),
    }
)


class OccupiedSpace(Region):
    """The space that an object fills: the solid of a mesh, of some size, turned and moved.

    The parameters are the operands of `body_of`.
    """

    dimension: float = 3
    may_find_none = True
    _placement_names = ("position", "rotation", "dimensions")

    def __init__(self, thing: Any) -> None:
        super().__init__(*body_operands(thing), name="occupied space")
        self.position, self.rotation, self.dimensions = self.parameters[:3]

    def contains_points(self, points: Points, *columns: Column) -> Mask:
        return containment.contains_points(body_of(*columns), points)

    def contains_bodies(self, body: Body, lanes: int, *columns: Column) -> Mask:
        return containment.in_body(body, body_of(*columns), lanes)

    def meets_bodies(self, body: Body, lanes: int, *columns: Column) -> Mask:
        return np.asarray(~collide([body_of(*columns), body], np.array([[0, 1]]), lanes=lanes).free)

    def half_spaces(self, *columns: Column) -> Column | None:
        body = body_of(*columns)
        return half_spaces(body.meshes[0], body.poses) if body.choice is None else None

    def is_surely_convex(self) -> bool:
        shape = self.parameters[3]
        return not is_random(shape) and bool(shape.mesh.is_convex)

    def draw_points(self, uniforms: Column, keys: Column, *columns: Column) -> tuple[Points, Mask | None]:
        return body_points.draw_points(body_of(*columns), uniforms, keys)

    def distances(self, points: Points, *columns: Column) -> Column:
        body = body_of(*columns)
        return distance.to_solid(body, points, max(len(points), len(body)))

    def gaps(self, points: Points, *columns: Column) -> Column:
        return body_points.distances_from_box(body_of(*columns), points)

    def box(self, *columns: Column) -> tuple[Points, Points]:
        return body_points.bounds(body_of(*columns))

    def extent(self, *parameters: Bounds | None) -> Bounds | None:
        return super().extent(*parameters) or body_box(*parameters[:3])

    def sizes(self, *columns: Column) -> Column:
        return body_points.volumes(body_of(*columns))

    def project(self, point: Any, direction: Any) -> tuple[Any, Any]:
        """A point inside stays; any other lands on the surface, by default upwards or downwards."""
        way = vector(0, 0, 1) if direction is None else to_vector(direction, "`onDirection`")
        place = to_vector(point)
        landed = apply(_LANDING_OR_INSIDE, place, way, *self.parameters)
        return landed, self.orientation_at(landed)

    def body(self) -> Body:
        """Return the solid of a region without random parameters."""
        return body_of(*self.fixed_columns("the solid"))

    @property
    def mesh(self) -> Any:
        """The mesh in the world, trimesh's; of a region without random parameters."""
        return generic.world_mesh(self)

    @property
    def boundingPolygon(self) -> Any:
        """The region seen from above."""
        return generic.outline_from_above(self)

    @property
    def inradius(self) -> Any:
        """The radius of a ball about the middle that it holds, in metres; 0 where the middle is outside."""
        return apply(_INRADIUS, *self.parameters)

    @property
    def circumcircle(self) -> tuple[Any, Any]:
        """Centre and radius of the ball around the box of its dimensions."""
        position, _, size, _ = self.parameters
        return position, operate("divide", operate("norm", size), 2)

    @property
    def isConvex(self) -> bool:
        """Return whether the volume is convex."""
        return bool(self.parameters[3].mesh.is_convex)

    def getSurfaceRegion(self) -> Region:
        """Return the surface of the volume."""
        surface: Region = generic.surface_of(self)
        return surface

    def getVolumeRegion(self) -> Region:
        """Return the volume itself."""
        return self

    def voxelized(self, pitch: float) -> Region:
        """Return the cells of this edge length, in metres, that the volume touches."""
        region: Region = generic.voxelized(self, pitch)
        return region

    def intersects(self, other: Any) -> Any:
        """Return whether another object's space, or a region, shares a point with this one."""
        if is_body(other):
            return apply(_INTERSECT, *self.parameters, *body_operands(other))
        return super().intersects(other)


def _landing_or_inside(call: Call, point: Column, direction: Column, *columns: Column) -> Column:
    body = body_of(*columns)
    lanes = _rows(point, direction, *columns)
    faces, landed = projection.project(body, None, 0.0, point, direction, lanes)
    inside = np.broadcast_to(containment.contains_points(body, point), lanes)
    call.reject((faces < 0) & ~inside)
    return np.where(inside[:, np.newaxis], point, landed)


_LANDING_OR_INSIDE = Operation(
    "landing in a volume",
    always(Kind.VECTOR),
    _landing_or_inside,
    "Where a point lands in a volume; rejected where it misses.",
    rejects=True,
    missing="place to land on",
)


_BOX_CORNER = Operation(
    "corner of a bounding box",
    always(Kind.VECTOR),
    lambda call, *columns: body_points.bounds(body_of(*columns))[call.payload],
    "The lower or upper corner of a body's box.",
)
_INRADIUS = Operation(
    "inradius",
    always(Kind.SCALAR),
    lambda _call, *columns: body_points.inradii(body_of(*columns)),
    "The radius of a ball about the position that a body holds.",
)


_PLANAR_INRADIUS = Operation(
    "planar inradius",
    always(Kind.SCALAR),
    lambda _call, *columns: body_points.planar_inradii(body_of(*columns)),
    "The radius of a disc about the position that a body holds, seen along its own z.",
)


def _gap_bounds(_payload: object, *operands: Bounds | None) -> Bounds:
    first, second = body_box(*operands[:3]), body_box(*operands[4:7])
    least = np.zeros(1) if first is None or second is None else np.maximum(separation(first, second), 0.0)
    return Bounds(least, np.full_like(least, np.inf))


def _near_each_other(result: Bounds, operands: Sequence[Bounds | None]) -> list[Bounds | None]:
    """Bound two bodies that are at most ``result`` apart: return bounds for the `body_operands` of both."""
    parts: list[Bounds | None] = [None] * 8
    for mine, other in ((0, 4), (4, 0)):
        box, reach = body_box(*operands[other : other + 3]), body_reach(*operands[mine + 1 : mine + 3])
        if box is not None and reach is not None:
            parts[mine] = intervals.subtract(grown(box, result.upper * (1 + 1e-9)), reach)
    return parts


_GAP = Operation(
    "distance of bodies",
    always(Kind.SCALAR),
    lambda call, *columns: distance.between(body_of(*columns[:4]), body_of(*columns[4:]), call.lanes),
    "The least distance between points of two bodies; 0 where they touch.",
    bounds=_gap_bounds,
    inverse=lambda _payload, result, *operands: _near_each_other(result, operands),
    partial=True,
)


def gap_between(first: Any, second: Any) -> Any:
    """The least distance between points of two objects, in metres."""
    one, other = placed_of(first), placed_of(second)
    found = None if one is None or other is None else gap(one, other)
    return found if found is not None else apply(_GAP, *body_operands(first), *body_operands(second))


def bounding_corners(thing: Any) -> tuple[Any, Any]:
    """The lower and upper corner of the box along the global axes around an object."""
    operands = body_operands(thing)
    return apply(_BOX_CORNER, *operands, payload=0), apply(_BOX_CORNER, *operands, payload=1)


def inradius(thing: Any) -> Any:
    """Return the radius of a ball about the position of an object that it holds; 0 where the position is outside."""
    return apply(_INRADIUS, *body_operands(thing))


def planar_inradius(thing: Any) -> Any:
    """Return the radius of a disc about the position that an object holds seen along its own z; 0 where the position is outside."""
    return apply(_PLANAR_INRADIUS, *body_operands(thing))


def _intersect(
    _call: Call,
    position: Column,
    orientation: Column,
    size: Column,
    shape: Column,
    position_2: Column,
    orientation_2: Column,
    size_2: Column,
    shape_2: Column,
) -> Column:
    bodies = [
        body_of(position, orientation, size, shape),
        body_of(position_2, orientation_2, size_2, shape_2),
    ]
    columns = (position, orientation, size, shape, position_2, orientation_2, size_2, shape_2)
    lanes = max(len(column) for column in columns)
    return ~collide(bodies, np.array([[0, 1]]), lanes=lanes).free


def _intersect_bounds(_payload: object, *operands: Bounds | None) -> Bounds:
    return only_within(body_box(*operands[:3]), body_box(*operands[4:7]), np.zeros(1))


def _intersect_inverse(_payload: object, result: Bounds, *operands: Bounds | None) -> Sequence[Bounds | None]:
    within = np.where(result.lower > 0, 0.0, np.inf)
    return _near_each_other(Bounds(within, within), operands)


_INTERSECT = Operation(
    "bodies intersect",
    always(Kind.BOOLEAN),
    _intersect,
    "Whether two objects share a point.",
    bounds=_intersect_bounds,
    inverse=_intersect_inverse,
    partial=True,
)


@dataclass(frozen=True, slots=True)
class Facing:
    """The faces of a surface that are meant: all, or those whose unit normal passes the threshold on a side's axis."""

    side: Side = None
    threshold: float = 0.0


def _pairs(thresholds: Any) -> list[tuple[float, float]]:
    """Return the thresholds of an object's sides, negative and positive, for each axis."""
    try:
        pairs = [(lower, upper) for lower, upper in thresholds]
    except (TypeError, ValueError):
        pairs = []
    if len(pairs) != 3 or not all(is_number(part) for pair in pairs for part in pair):
        raise ScenicTypeError(
            f"property 'sideComponentThresholds': expected three pairs of numbers, not {describe(thresholds)}",
            span=here(),
            help="one pair for each axis, as `((-0.5, 0.5), (-0.5, 0.5), (-0.5, 0.5))`",
        )
    return [(float(lower), float(upper)) for lower, upper in pairs]


class SideSurface(Region):
    """The faces of an object's surface that look along one direction of the world, or the whole surface.

    Section 9.6 of the specification: a face belongs to a side when the component of its unit normal on the world's
    axis passes the object's threshold.
    """

    dimension: float = 2
    has_orientation = True
    may_find_none = True
    _placement_names = ("position", "rotation", "dimensions")

    def __init__(self, thing: Any, side: str, thresholds: Any) -> None:
        if is_random(thresholds):
            raise unsupported("a `sideComponentThresholds` that is no choice among constants")
        super().__init__(*body_operands(thing), name=f"{side} surface" if SIDES[side] else side)
        self.position, self.rotation, self.dimensions = self.parameters[:3]
        self.tolerance, self.onDirection = 1e-6, None
        self.facing = Facing(SIDES[side])
        if self.facing.side is not None:
            axis, sign = self.facing.side
            lower, upper = _pairs(thresholds)[axis]
            self.facing = Facing((axis, sign), upper if sign > 0 else -lower)

    def sampled(self, sample: Any) -> Region:
        region = super().sampled(sample)
        if region is not self:
            region.__dict__.pop("_fixed", None)
            if getattr(region.__dict__.get("orientation"), "region", None) is self:
                region.orientation = generic.own_field(region)
        return region

    @cached_property
    def _fixed(self) -> FixedSide | None:
        """The faces, where the object is the same in every scene."""
        if self.is_random or is_lazy(self.parameters):
            return None
        *placement, shape = self.parameters
        return FixedSide.of(shape.mesh, tuple(placement), self.facing.side, self.facing.threshold)

    def uniform_placement(self) -> tuple[Any, Any]:
        if self._fixed is not None:
            point, orientation = self._fixed.placement()
        else:
            face = apply(_FACE, uniform(), *self.parameters, payload=self.facing)
            point = apply(_FACE_POINT, face, uniform(), uniform(), *self.parameters)
            orientation = apply(_FACE_ORIENTATION, face, *self.parameters)
        field = self.__dict__.get("orientation")
        if field is None or getattr(field, "region", None) is self:
            return point, orientation
        return point, field[point]

    def project(self, point: Any, direction: Any) -> tuple[Any, Any]:
        place = to_vector(point)
        if direction is None:
            way = apply(_MEAN_NORMAL, *self.parameters, payload=self.facing)
        else:
            way = to_vector(direction, "`onDirection`")
        face = apply(_LANDING_FACE, place, way, *self.parameters, payload=self.facing)
        landed = apply(_LANDING_POINT, face, place, way, *self.parameters)
        common = None if self._fixed is None else self._fixed.orientation
        return landed, apply(_FACE_ORIENTATION, face, *self.parameters) if common is None else common

    def contains_points(self, points: Points, *columns: Column) -> Mask:
        body = body_of(*columns)
        side, threshold = self.facing.side, self.facing.threshold
        return projection.near_surface(
            body, side, threshold, points, max(len(points), len(body)), self.tolerance
        )

    def draw_points(self, uniforms: Column, keys: Column, *columns: Column) -> tuple[Points, Mask | None]:
        body = body_of(*columns)
        faces = surface.draw_faces(
            body, self.facing.side, self.facing.threshold, uniforms[0], uniforms.shape[1]
        )
        return surface.face_points(body, np.maximum(faces, 0), uniforms[1], uniforms[2]), faces >= 0

    def distances(self, points: Points, *columns: Column) -> Column:
        return body_points.distances_to_surface(
            body_of(*columns), points, self.facing.side, self.facing.threshold
        )

    def orientations(self, points: Points, *columns: Column) -> Column:
        body = body_of(*columns)
        return surface.face_orientations(
            body, body_points.nearest_faces(body, points, self.facing.side, self.facing.threshold)
        )

    def box(self, *columns: Column) -> tuple[Points, Points]:
        body = body_of(*columns)
        if len(body) > 1 or self.facing.side is None:
            return body_points.bounds(body)
        return body_points.side_bounds(body, self.facing.side, self.facing.threshold)

    def extent(self, *parameters: Bounds | None) -> Bounds | None:
        return super().extent(*parameters) or body_box(*parameters[:3])

    def sizes(self, *columns: Column) -> Column:
        return body_points.areas(body_of(*columns), self.facing.side, self.facing.threshold)

    def orientation_asked(self, point: Any) -> Any:
        """Return the orientation of the nearest face; rejected for points that are not on the surface."""
        return apply(_ORIENTATION_ON, point, *self.parameters, payload=self)

    @property
    def mesh(self) -> Any:
        """Its faces in the world as a mesh, trimesh's; of a surface without random parameters."""
        return generic.world_mesh(self)

    @cached_property
    def orientation(self) -> Any:
        """The field of its normals."""
        return generic.own_field(self)

    @property
    def isConvex(self) -> bool:
        """Return whether the faces bound a convex volume."""
        return self.facing.side is None and bool(self.parameters[3].mesh.is_convex)

    @property
    def circumcircle(self) -> tuple[Any, Any]:
        """Centre and radius of the ball around the box of the whole body."""
        return self.parameters[0], operate("divide", operate("norm", self.dimensions), 2)

    @property
    def boundingPolygon(self) -> Any:
        """The faces seen from above."""
        return generic.outline_from_above(self)

    def getSurfaceRegion(self) -> Region:
        """Return the surface itself."""
        return self

    def contains_bodies(self, body: Body, lanes: int, *columns: Column) -> Mask:
        return np.zeros(lanes, dtype=np.bool_)


def _orientation_on(call: Call, points: Column, *columns: Column) -> Column:
    region: SideSurface = call.payload
    call.reject(~region.contains_points(points, *columns))
    return region.orientations(points, *columns)


_ORIENTATION_ON = Operation(
    "orientation of a surface",
    always(Kind.ORIENTATION),
    _orientation_on,
    "The preferred orientation of a surface at a point; rejected beside it.",
    rejects=True,
    missing="orientation away from a surface",
)


def _face(call: Call, *columns: Column) -> Column:
    stack, facing = Stack(call, columns), call.payload
    faces = surface.draw_faces(stack.body(1), facing.side, facing.threshold, stack.column(0), stack.rows)
    return _found(call, stack, faces)


def _found(call: Call, stack: Stack, faces: Column) -> Column:
    """The numbers of faces; a candidate is rejected where there is none."""
    result = stack.restored(faces.astype(np.int64))
    call.reject(result < 0)
    return result


def _face_point(call: Call, *columns: Column) -> Column:
    stack = Stack(call, columns)
    points = surface.face_points(stack.body(3), stack.column(0), stack.column(1), stack.column(2))
    return stack.restored(points)


def _face_orientation(call: Call, *columns: Column) -> Column:
    stack = Stack(call, columns)
    return stack.restored(surface.face_orientations(stack.body(1), stack.column(0)))


def _may_have_no_face(operands: Sequence[Any], payload: Any) -> bool:
    """Return whether a side may have no face; for a fixed object this is known."""
    columns = [operand.payload.column for operand in operands[1:] if operand.is_constant]
    if len(columns) < len(operands) - 1:
        return True
    faces = surface.draw_faces(body_of(*columns), payload.side, payload.threshold, np.full(1, 0.5), 1)
    return bool((faces < 0).any())


_FACE = stacking(
    "surface face",
    always(Kind.INTEGER),
    _face,
    "A face of a side, by area; the candidate is rejected where the side has none.",
    rejects=_may_have_no_face,
    missing="surface to stand on",
)
_FACE_POINT = stacking(
    "face point",
    always(Kind.VECTOR),
    _face_point,
    "A uniform point of a face.",
)
_FACE_ORIENTATION = stacking(
    "face orientation",
    always(Kind.ORIENTATION),
    _face_orientation,
    "The preferred orientation of a face.",
)


def _mean_normal(call: Call, *columns: Column) -> Column:
    stack, facing = Stack(call, columns), call.payload
    return stack.restored(surface.mean_normals(stack.body(0), facing.side, facing.threshold, stack.rows))


def _landing_face(call: Call, *columns: Column) -> Column:
    stack, facing = Stack(call, columns), call.payload
    point, direction = stack.column(0), stack.column(1)
    faces, _ = projection.project(stack.body(2), facing.side, facing.threshold, point, direction, stack.rows)
    return _found(call, stack, faces)


def _landing_point(call: Call, *columns: Column) -> Column:
    stack = Stack(call, columns)
    landed = projection.landing_points(stack.body(3), stack.column(0), stack.column(1), stack.column(2))
    return stack.restored(landed)


def _rows(*columns: Column) -> int:
    """Number of different lanes: 1 where all columns are the same everywhere."""
    return max(len(column) for column in columns)


_MEAN_NORMAL = stacking(
    "mean normal",
    always(Kind.VECTOR),
    _mean_normal,
    "The direction in which things land on a side.",
)
_LANDING_FACE = stacking(
    "landing face",
    always(Kind.INTEGER),
    _landing_face,
    "The face of a side where a point lands; the candidate is rejected where it misses.",
    rejects=True,
    missing="place to land on",
)
_LANDING_POINT = stacking(
    "landing point",
    always(Kind.VECTOR),
    _landing_point,
    "Where a point lands on a face.",
)
