"""The operations of every region.

A region is a fixed kind of shape with parameters (a centre, a radius), each definite or random. Its geometry is written
once, over columns of those parameters; from that come the answers to programs (`containsPoint` on values), the
requirement nodes that the sampler tests in batches, and the points that specifiers draw.
"""

import random
from abc import ABCMeta, abstractmethod
from collections.abc import Sequence
from copy import copy
from typing import Any, ClassVar, cast

import numpy as np
from numpy.typing import NDArray

from scenic.graph.bounds import Bounds
from scenic.graph.kinds import Column, Kind
from scenic.graph.operation import Call, Operation, always, stacking
from scenic.language.errors import (
    InvalidScenarioError,
    RejectionException,
    ScenicTypeError,
    UndefinedSamplingException,
    UnsupportedError,
)
from scenic.language.types import OBJECT
from scenic.runtime.geometry.contact.collision import Body
from scenic.runtime.ground.context import here
from scenic.runtime.python.bounded import bounds_of_region
from scenic.runtime.regions import generic
from scenic.runtime.regions.flat import Flat
from scenic.runtime.regions.knowledge import (
    Containment,
    containment_bounds,
    containment_inverse,
    distance_bounds,
    distance_inverse,
    fixed,
    point_bounds,
    point_inverse,
)
from scenic.runtime.regions.nearness import SLACK, at_any_height, body_box, only_within
from scenic.runtime.regions.scalar_regions import Single
from scenic.runtime.regions.stacked import Stack, body_operands, is_body, placed_of
from scenic.runtime.values.generic import call_later, sample_of
from scenic.runtime.values.lazy import defer, is_lazy
from scenic.runtime.values.source_text import plain_number
from scenic.runtime.values.values import (
    Orientation,
    OrientedVector,
    Vector,
    apply,
    as_node,
    is_open,
    is_random,
    options_of,
    per_option,
    random_key,
    to_vector,
    uniform,
    vector,
    wrong_type,
)

Points = NDArray[np.float64]
Mask = NDArray[np.bool_]


class _RegionType(ABCMeta):
    """The metaclass of regions: a region whose arguments depend on an object is made once these are known."""

    def __call__(cls, *args: Any, **keywords: Any) -> Any:
        if is_lazy(args) or is_lazy(keywords):
            return defer(super().__call__, *args, **keywords)
        return super().__call__(*args, **keywords)


class Region(metaclass=_RegionType):
    """A set of points in space: a structure that is fixed, and parameters that may be random.

    Subclasses give the structure and its *primitives*: functions over the columns of the parameters, each for many lanes.
    Everything else (answers to programs, requirements, points that specifiers draw, choices among regions, what analysis
    knows) is made of these here, so that a new kind of region is one class with its primitives.
    """

    scenic_kind: ClassVar[Kind] = Kind.REGION
    parameter_names: ClassVar[tuple[str, ...]] = ()
    """Attributes that hold the parameters, in order; a region with random ones is sampled through them."""
    _placement_names: ClassVar[tuple[str, ...]] = ()
    """Attributes that are random where the parameters are, but need not be among them."""
    dimension: float
    """0 for points to 3 for volumes; infinite for all of space."""
    draws: int = 3
    """Number of uniform numbers that a point of the region takes."""
    may_find_none: bool = False
    """True if `draw_points` may find no point."""
    has_orientation: bool = False
    """True if every point has a preferred orientation."""
    orientation: Any = None
    """The vector field of the preferred orientations, where there is one."""
    tolerance: float = 0.0
    """Metres by which a point may lie outside and count as in the region."""
    has_closed_form: bool = True
    """True if it can be combined with others as a fixed geometry; surfaces that are not level cannot."""
    kindred: ClassVar[tuple[str, ...]] = ()
    """Names of further classes whose instances count as instances of this class for ``isinstance`` in a program."""

    def __init__(self, *parameters: Any, name: str | None = None) -> None:
        self.parameters: tuple[Any, ...] = parameters
        self.name = name

    def __setattr__(self, name: str, value: Any) -> None:
        object.__setattr__(self, name, value)
        if name == "orientation" and value is not None:
            # A field that the program gives to a region holds for its points.
            object.__setattr__(self, "has_orientation", True)

    @classmethod
    def __subclasshook__(cls, other: type) -> bool:
        # Always a definite answer: else kindred of a subclass would count as of this class. `kindred` is not inherited.
        kindred = cls.__dict__.get("kindred", ())
        return any(base is cls or base.__name__ in kindred for base in other.__mro__)

    # Of fixed regions, on plain floats

    def single(self) -> Single | None:
        """Return the object that answers for one point or body at a time; ``None`` if there is none. Not for random regions."""
        return None

    @property
    def at_once(self) -> Single | None:
        """`single`, made once; ``None`` of random regions."""
        known = self.__dict__.get("_single", self)
        if known is self:
            known = self.__dict__["_single"] = None if self.is_random else self.single()
        return cast("Single | None", known)

    # Primitives over lanes; ``columns`` are those of ``parameters``, one row for each lane or a single one.

    @abstractmethod
    def contains_points(self, points: Points, *columns: Column) -> Mask:
        """The mask ``(n,)`` of points ``(n, 3)`` that lie in the region."""

    def contains_bodies(self, body: Body, lanes: int, *columns: Column) -> Mask:
        """Return a mask of the lanes in which the whole body lies in the region, shape ``(lanes,)``."""
        raise unsupported(f"containment of objects in a region of the kind {type(self).__name__}")

    def meets_bodies(self, body: Body, lanes: int, *columns: Column) -> Mask:
        """Return a mask of the lanes in which the body shares a point with the region, shape ``(lanes,)``; here one lane after the other."""
        mask: Mask = generic.meets_bodies(self, body, lanes, columns)
        return mask

    def from_above(self, *columns: Column) -> Flat | None:
        """Return the region as geometries of level planes or columns; ``None`` where it is neither, or they are not known."""
        return None

    def half_spaces(self, *columns: Column) -> NDArray[np.float64] | None:
        """Return the region as a bounded polytope, half-spaces ``(n | 1, k, 4)``; ``None`` where it is none, or has many faces."""
        return None

    def ball(self, *columns: Column) -> tuple[Points, NDArray[np.float64]] | None:
        """Return centre ``(n | 1, 3)`` and radius ``(n | 1,)`` of a region that is a ball in all lanes; ``None`` of others."""
        return None

    def is_surely_convex(self) -> bool:
        """Return whether the region is known to be convex whatever its parameters."""
        return False

    def draw_points(self, uniforms: Column, keys: Column, *columns: Column) -> tuple[Points, Mask | None]:
        """Uniform points ``(n, 3)`` from uniform numbers ``(draws, n)``, and where there is one (``None``: everywhere).

        A region that retries keys its further draws with the words ``keys``, ``(n,)``.
        """
        raise UndefinedSamplingException(
            f"no point can be drawn uniformly from a region of the kind {type(self).__name__}", span=here()
        )

    def draw_points_in(
        self, lower: Points, upper: Points, uniforms: Column, keys: Column, *columns: Column
    ) -> tuple[Points, Mask | None]:
        """Draw points as `draw_points` does, but from a part of the region that contains all of its points in boxes ``(n, 3)``; this method draws from the whole region."""
        return self.draw_points(uniforms, keys, *columns)

    def orientations(self, points: Points, *columns: Column) -> Column:
        """Preferred orientations ``(n, 4)`` at points of the region; only where `has_orientation`."""
        raise unsupported(f"the orientation of a region of the kind {type(self).__name__}")

    def distances(self, points: Points, *columns: Column) -> NDArray[np.float64]:
        """Distances of points ``(n, 3)`` from the region, shape ``(n,)``; 0 inside."""
        raise unsupported(f"the distance to a region of the kind {type(self).__name__}")

    def nearest(self, points: Points, *columns: Column) -> Points | None:
        """The points ``(n, 3)`` of the region nearest to points ``(n, 3)``; ``None`` where they are not known.

        Of a region of the plane, and of a column, nearest seen from above: the z of the points stays.
        """
        return None

    def gaps(self, points: Points, *columns: Column) -> NDArray[np.float64]:
        """Lower bounds of the distances ``(n,)`` of points ``(n, 3)`` from the region as a container; 0 where unknown."""
        return np.zeros(len(points))

    def lie_farther(self, points: Points, limits: Column, *columns: Column) -> Mask:
        """Return a mask ``(n,)`` of points ``(n, 3)`` whose distance from the region as a container certainly exceeds ``limits`` ``(n,)``."""
        return self.gaps(points, *columns) > limits

    def depths(self, points: Points, *columns: Column) -> NDArray[np.float64]:
        """Upper bounds of the distances ``(n,)`` of points ``(n, 3)`` from the outside of the region as a container.

        0 outside, infinite where nothing is known. Of a region in the plane, seen from above.
        """
        return np.full(len(points), np.inf)

    def box(self, *columns: Column) -> tuple[Points, Points]:
        """Lower and upper corners ``(n | 1, 3)`` of boxes that hold the region; infinite where it is not bounded."""
        told = bounds_of_region(type(self), [Bounds(column, column) for column in columns])
        if told is not None:
            return told.lower, told.upper
        return np.full((1, 3), -np.inf), np.full((1, 3), np.inf)

    def container_box(self, *columns: Column) -> tuple[Points, Points]:
        """Return the box of the region as a container: a region in the plane contains the space above and below it."""
        lower, upper = self.box(*columns)
        if self.dimension == 2:
            found = at_any_height(Bounds(lower, upper))
            return found.lower, found.upper
        return lower, upper

    def tight_box(self, *columns: Column) -> tuple[Points, Points]:
        """Return a box no larger than `container_box`; kinds of regions that know a smaller one override this."""
        return self.container_box(*columns)

    def extent(self, *parameters: Bounds | None) -> Bounds | None:
        """Bounds ``(m | 1, 3)`` of the region's points from those of its parameters; ``None`` where nothing is known.

        Here, and wherever parameters are fixed, by `box`, and by what a `bounded` class was told. Kinds whose parameters are often
        random know more.
        """
        columns = fixed(parameters)
        if columns is not None:
            return Bounds(*self.box(*columns))
        return bounds_of_region(type(self), parameters)

    def drawn_extent(self, numbers: Sequence[Bounds], *parameters: Bounds | None) -> Bounds | None:
        """Bounds ``(m | 1, 3)`` of points that are drawn by numbers in these bounds; here, those of any point."""
        return self.extent(*parameters)

    def draw_cuts(self) -> NDArray[np.float64] | None:
        """Values ``(m,)``, ascending, of the first uniform number of a draw, between which the point does not depend on it."""
        return None

    def container_extent(self, *parameters: Bounds | None) -> Bounds | None:
        """Return the extent of the region as a container; `container_box` says the difference."""
        columns = fixed(parameters)
        if columns is not None:
            return Bounds(*self.container_box(*columns))
        found = self.extent(*parameters)
        return found if found is None or self.dimension != 2 else at_any_height(found)

    def sizes(self, *columns: Column) -> NDArray[np.float64]:
        """The measure ``(n | 1,)`` of the region: count, metres, square or cubic metres by its dimension."""
        return np.full(1, np.nan)

    # Values for programs and specifiers

    def uniform_placement(self) -> tuple[Any, Any]:
        """A uniform random point, and its preferred orientation (``None`` if the region has none)."""
        numbers = [uniform() for _ in range(self.draws)]
        point = apply(_DRAW, *numbers, random_key(), *self.parameters, payload=self)
        return point, self.orientation_drawn(point, numbers)

    def orientation_drawn(self, point: Any, numbers: Sequence[object]) -> Any:
        """`orientation_at` a point that uniform numbers drew."""
        return self.orientation_at(point)

    def orientation_at(self, point: Any) -> Any:
        """The preferred orientation at a point of the region; ``None`` if the region has none."""
        if self.orientation is not None and getattr(self.orientation, "region", None) is not self:
            return self.orientation[point]
        return self.own_orientation(point) if self.has_orientation else None

    def own_orientation(self, point: Any) -> Any:
        """Return the orientation that the region itself gives one of its points (`orientations`)."""
        place = to_vector(point)
        if type(place) is Vector and not self.parameters:
            with np.errstate(all="ignore"):
                return Orientation.of(self.orientations(np.array([place.row]))[0].tolist())
        return apply(_ORIENTATION, place, *self.parameters, payload=self)

    def orientation_asked(self, point: Any) -> Any:
        """`own_orientation` for any point, called by programs."""
        return self.own_orientation(point)

    def random_parts(self) -> list[Any]:
        """Return the parameters, what else is random with them, and the field of orientations, for sampling."""
        placement = (getattr(self, name) for name in self._placement_names)
        return [*self.parameters, *placement, self.__dict__.get("orientation")]

    def sampled(self, sample: Any) -> "Region":
        """The region of one sample."""
        declared_orientation = self.__dict__.get("orientation")
        orientation = sample.value(declared_orientation)
        if not self.is_random and orientation is declared_orientation:
            return self
        region = copy(self)
        region.__dict__.pop("_single", None)
        if orientation is not declared_orientation:
            region.orientation = orientation
        region.parameters = tuple(sample.value(value) for value in self.parameters)
        if self.parameter_names:
            for name, value in zip(self.parameter_names, region.parameters, strict=True):
                setattr(region, name, value)
        for name in self._placement_names:
            setattr(region, name, sample.value(getattr(self, name)))
        return region

    def project(self, point: Any, direction: Any) -> tuple[Any, Any]:
        """The point of the region where ``point`` lands along ``direction``, and its preferred orientation.

        ``direction`` is ``None`` where the object does not say. Raises `ScenicTypeError` for regions on which
        nothing lands.
        """
        raise ScenicTypeError(
            f"nothing can be placed `on` a region of the kind {type(self).__name__} by projection",
            span=here(),
        )

    def distance_from(self, point: Any) -> Any:
        """Distance from a point to the nearest point of the region, in metres; 0 inside."""
        place = to_vector(point)
        if type(place) is Vector and (single := self.at_once) is not None:
            distance = single.distance(place.row)
            if distance is not None:
                return distance
        if type(place) is Vector and not self.parameters:
            return float(self.distances(np.array([place.row]))[0])
        return apply(_DISTANCE, place, *self.parameters, payload=self)

    @property
    def is_random(self) -> bool:
        """Return whether some parameter is random."""
        return is_random(self.parameters)

    @property
    def footprint(self) -> "Region":
        """The region of all points above and below this one; the region itself where it is 3D."""
        return self

    def containsPoint(self, point: Any) -> Any:
        """Return whether a point lies in the region: true or false, or a random truth value."""
        if type(point) is Vector and (single := self.at_once) is not None:
            held = single.holds_point(point.row)
            if held is not None:
                return held
        if type(point) is Vector and not self.parameters:
            return bool(self.contains_points(np.array([point.row]))[0])
        return apply(CONTAINS_POINT, to_vector(point), *self.parameters, payload=self)

    def containsObject(self, thing: Any) -> Any:
        """Return whether the region holds the whole of an object."""
        if not is_body(thing):
            if is_open(thing):
                return call_later(self.containsObject, thing)
            if options_of(thing):
                return per_option(thing, self.containsObject)
            raise wrong_type(OBJECT, thing, "`containsObject`")
        if (single := self.at_once) is not None and (body := placed_of(thing)) is not None:
            is_inside = single.holds_body(body)
            if is_inside is not None:
                return is_inside
        operands = body_operands(thing)
        mesh = None if is_random(operands[3]) else operands[3].mesh
        return apply(CONTAINS_BODY, *operands, *self.parameters, payload=Containment(self, mesh))

    def distanceTo(self, point: Any) -> Any:
        """Distance from a point to the nearest point of the region, in metres."""
        return self.distance_from(point)

    def closestPointTo(self, point: Any) -> Vector:
        """The point of the region nearest to a point; of fixed regions.

        Raises:
            NotImplementedError: for a kind of region whose nearest points are not known.

        """
        place = np.array([tuple(to_vector(point, "`closestPointTo`"))])
        points = self.nearest(place, *self.fixed_columns("the nearest point"))
        if points is None:
            raise unsupported(f"the nearest point of a region of the kind {type(self).__name__}")
        return Vector.of(points[0].tolist())

    def intersects(self, other: Any) -> Any:
        """Return whether the region shares a point with another, or with an object."""
        if is_body(other) and (single := self.at_once) is not None:
            body = placed_of(other)
            met = None if body is None else single.meets_body(body)
            if met is not None:
                return met
        return generic.intersects(self, other)

    def containsRegion(self, other: Any, tolerance: float = 0) -> Any:
        """Return whether the region holds another, up to ``tolerance`` metres; of fixed regions."""
        return generic.contains_region(self, other, tolerance)

    def intersect(self, other: Any) -> "Region":
        """The points that lie in both regions."""
        result: Region = generic.intersection(self, other)
        return result

    def union(self, other: Any) -> "Region":
        """The points that lie in either region."""
        result: Region = generic.union(self, other)
        return result

    def difference(self, other: Any) -> "Region":
        """The points that do not lie in the other region."""
        result: Region = generic.difference(self, other)
        return result

    # What is known of a fixed region

    def fixed_columns(self, what: str) -> list[Column]:
        """Return the columns of the parameters; raises `ScenicTypeError` where they are random."""
        if self.is_random:
            raise ScenicTypeError(f"{what} of a region with random parameters is not known", span=here())
        return [as_node(value).payload.column for value in self.parameters]

    @property
    def AABB(self) -> tuple[tuple[float, float, float], tuple[float, float, float]]:
        """The corners of the bounding box along the global axes; raises ``TypeError`` where there is none."""
        lower, upper = self.box(*self.fixed_columns("the bounding box"))
        if not (np.isfinite(lower).all() and np.isfinite(upper).all()):
            raise ScenicTypeError(
                f"a region of the kind {type(self).__name__} has no bounding box", span=here()
            )
        first, last = lower[0].tolist(), upper[0].tolist()
        return (first[0], first[1], first[2]), (last[0], last[1], last[2])

    @property
    def dimensionality(self) -> float:
        """0 for points to 3 for volumes."""
        return self.dimension

    @property
    def size(self) -> float | None:
        """The measure of the region: count, metres, square or cubic metres; ``None`` where it is not known."""
        size = float(self.sizes(*self.fixed_columns("the size"))[0])
        return None if np.isnan(size) else size

    def sample(self, subsamples: Any = None) -> "Region":
        """Return the region with its random parameters drawn now, independent of all scenes."""
        region: Region = sample_of(self)
        return region

    def uniformPointInner(self) -> Any:
        """A uniform point, drawn now with Python's generator."""
        columns = self.fixed_columns("a point")
        for _ in range(_TRIES):
            numbers = np.array([[random.random()] for _ in range(self.draws)]).reshape(self.draws, 1)
            keys = np.array([random.getrandbits(64)], dtype=np.uint64)
            points, has_point = self.draw_points(numbers, keys, *columns)
            if has_point is None or has_point.all():
                x, y, z = points[0].tolist()
                return self.orient(vector(x, y, z))
        raise RejectionException(f"no point was found in {self!r}")

    @staticmethod
    def uniformPointIn(region: "Region", tag: Any = None) -> Any:  # noqa: ARG004 - of the established call
        """A uniform random point of a region."""
        return region.uniform_placement()[0]

    def projectVector(self, point: Any, onDirection: Any) -> Any:
        """The point of the region where a point lands along a direction; ``None`` where a definite one does not."""
        try:
            return self.project(point, onDirection)[0]
        except InvalidScenarioError:
            return None

    def orient(self, point: Any) -> Any:
        """The point with the preferred heading there; the point itself where there is none."""
        if not self.has_orientation or self.is_random or is_random(point):
            return point
        return OrientedVector.make(point, self.orientation_at(to_vector(point)).yaw)

    def __contains__(self, item: Any) -> Any:
        return self.containsObject(item) if is_body(item) else self.containsPoint(item)

    def __str__(self) -> str:
        return f"<{type(self).__name__}{'' if self.name is None else f' {self.name}'}>"

    def __repr__(self) -> str:
        """As a program would make it, where a few numbers do that."""
        if self.is_random or not 0 < len(self.parameter_names) == len(self.parameters):
            return str(self)
        shown = [plain_number(value) if type(value) is float else repr(value) for value in self.parameters]
        return f"{type(self).__name__}({', '.join(shown)})"


CONTAINS_POINT = Operation(
    "region contains point",
    always(Kind.BOOLEAN),
    lambda call, points, *columns: np.asarray(call.payload.contains_points(points, *columns), dtype=np.bool_),
    "Whether a region holds a point.",
    bounds=point_bounds,
    inverse=point_inverse,
    partial=True,
)


def _distances(call: Call, points: Points, *columns: Column) -> Column:
    distances: Column = call.payload.distances(points, *columns)
    return distances


_DISTANCE = Operation(
    "distance to region",
    always(Kind.SCALAR),
    _distances,
    "Distance from a point to a region.",
    bounds=distance_bounds,
    inverse=distance_inverse,
    partial=True,
)


def _contains_body(call: Call, *columns: Column) -> Column:
    stack = Stack(call, columns)
    inside = call.payload.region.contains_bodies(stack.body(0), stack.rows, *stack.columns(4))
    return stack.restored(np.asarray(inside, dtype=np.bool_))


CONTAINS_BODY = stacking(
    "region contains object",
    always(Kind.BOOLEAN),
    _contains_body,
    "Whether a region holds a whole object.",
    bounds=containment_bounds,
    inverse=containment_inverse,
    partial=True,
)


def _meets_body(call: Call, *columns: Column) -> Column:
    stack = Stack(call, columns)
    met = call.payload.meets_bodies(stack.body(0), stack.rows, *stack.columns(4))
    return stack.restored(np.asarray(met, dtype=np.bool_))


def _meets_bounds(region: Region, *operands: Bounds | None) -> Bounds:
    return only_within(body_box(*operands[:3]), region.container_extent(*operands[4:]), np.zeros(1))


MEETS_BODY = stacking(
    "region meets object",
    always(Kind.BOOLEAN),
    _meets_body,
    "Whether a region shares a point with an object; payload the region.",
    bounds=_meets_bounds,
    partial=True,
)


def _draw(call: Call, *columns: Column) -> Column:
    region: Region = call.payload
    count = region.draws
    stack = Stack(call, columns)
    uniforms = (
        np.stack([np.broadcast_to(stack.column(place), stack.rows) for place in range(count)])
        if count
        else np.empty((0, stack.rows))
    )
    points, has_point = region.draw_points(uniforms, stack.column(count), *stack.columns(count + 1))
    if has_point is not None:
        call.reject(~stack.restored(has_point))
    return stack.restored(points)


def _point_extent(region: Region, *operands: Bounds | None) -> Bounds | None:
    count = region.draws
    numbers = [operand for operand in operands[:count] if operand is not None]
    parameters = operands[count + 1 :]
    found = region.drawn_extent(numbers, *parameters) if len(numbers) == count else region.extent(*parameters)
    return None if found is None else Bounds(found.lower - SLACK, found.upper + SLACK)


_DRAW = stacking(
    "region point",
    always(Kind.VECTOR),
    _draw,
    "A uniform point of a region, from uniform numbers and a key; rejected where the region is empty.",
    bounds=_point_extent,
    cuts=lambda region, operands: region.draw_cuts() if operands and operands[0].is_axis else None,
    partial=True,
    rejects=lambda _operands, payload: bool(payload.may_find_none),
    missing="point of the region",
)


def _orientation(call: Call, points: Points, *columns: Column) -> Column:
    region: Region = call.payload
    return region.orientations(points, *columns)


_ORIENTATION = Operation(
    "region orientation",
    always(Kind.ORIENTATION),
    _orientation,
    "The preferred orientation of a region at one of its points.",
)


_TRIES = 10_000
"""Draws of a point before a region counts as empty."""


def unsupported(what: str) -> UnsupportedError:
    """Return the refusal of a region or function that this version does not build."""
    return UnsupportedError(
        f"{what} is not supported yet", span=here(), help="see the list of what works in the README"
    )


__all__ = [
    "CONTAINS_BODY",
    "CONTAINS_POINT",
    "MEETS_BODY",
    "Mask",
    "Points",
    "Region",
    "unsupported",
]
