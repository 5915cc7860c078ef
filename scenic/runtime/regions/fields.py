"""Vector fields: an orientation for every point (sections 4.1 and 6.2 of the specification).

The function of a field is the program's own code, called on sampled points. Fields made of polygons have a closed form, over
arrays of points.
"""

import math
from abc import abstractmethod
from collections.abc import Callable, Iterable, Iterator, Sequence
from copy import copy
from functools import cached_property, partial
from typing import Any, Final

import numpy as np
from numpy.typing import NDArray

from scenic.graph import quaternions
from scenic.graph.bounds import Bounds
from scenic.graph.kinds import Column, Kind
from scenic.graph.operation import Call, Operation, always
from scenic.language.errors import RejectionException, ScenicTypeError, ScenicValueError
from scenic.language.types import FIELD
from scenic.runtime.geometry.flat.cell_index import CellIndex
from scenic.runtime.ground.context import here
from scenic.runtime.python.opaque import Calls, Rows, evaluated, is_later, later, together
from scenic.runtime.values.lane_methods import node_over_lanes
from scenic.runtime.values.lazy import Lazy, defer, reads_of, resolve
from scenic.runtime.values.values import (
    Orientation,
    Random,
    Vector,
    apply,
    as_node,
    as_value,
    operate,
    options_of,
    per_option,
    to_orientation,
    to_scalar,
    to_vector,
    wrong_type,
)

Points = NDArray[np.float64]
Headings = NDArray[np.float64]
Mask = NDArray[np.bool_]

_MANY_REGIONS: Final = 16
"""Regions of a field from which on an index pays."""


class VectorField:
    """An orientation for every point, given by a function.

    Args:
        name: for messages.
        value: from a vector to a heading, a triple of Euler angles or an orientation.
        minSteps: the least number of steps by which the field is followed.
        defaultStepSize: metres; longer ways are followed in steps of at most this length.

    """

    def __init__(
        self, name: str, value: Callable[[Any], Any], minSteps: int = 4, defaultStepSize: float = 5
    ) -> None:
        self.name = name
        self.value = value
        self.valueType = Orientation
        self.minSteps = minSteps
        self.defaultStepSize = defaultStepSize

    def _asked(self) -> dict[str, Any]:
        """Return the functions that it was given, by the names of the attributes that hold them."""
        held = {name: self.__dict__.get(name) for name in ("value", "headingFunction")}
        return {
            name: function
            for name, function in held.items()
            if function is not None and getattr(function, "__self__", None) is not self
        }

    def random_parts(self) -> list[Any]:
        """Return the functions, which may read random values, for sampling."""
        return list(self._asked().values())

    def sampled(self, sample: Any) -> "VectorField":
        """Return the field whose functions read sampled values; itself where they read none."""
        functions_by_name = self._asked()
        functions = {name: sample.value(function) for name, function in functions_by_name.items()}
        if all(functions[name] is function for name, function in functions_by_name.items()):
            return self
        field = copy(self)
        if "value" not in functions_by_name:
            functions["value"] = field._value  # type: ignore[attr-defined] # it is computed by a method of its own
        field.__dict__.update(functions)
        return field

    def __getitem__(self, position: Any) -> Any:
        """The orientation at a point."""
        place = to_vector(position, f"field {self.name!r}")
        if isinstance(place, Lazy):
            return defer(self.__getitem__, place)
        if isinstance(place, Random):
            return as_value(later(_VALUE, self.value, (place,)))
        return _oriented(self.value, place)

    def at(self, position: Any) -> Any:
        """The orientation at a point."""
        return self[position]

    def followFrom(
        self, position: Any, distance: Any, steps: int | None = None, stepSize: float | None = None
    ) -> Any:
        """The point that is reached from ``position`` by following the field for a distance (metres).

        By Euler's method: ``steps`` steps, or as many as keep each below ``stepSize``.
        """
        place = to_vector(position, "`follow ... from`")
        length = to_scalar(distance, "`follow ... for`")
        if isinstance(place, Lazy) or isinstance(length, Lazy):
            return defer(self.followFrom, place, length, steps, stepSize)
        law = (steps, self.minSteps, self.defaultStepSize if stepSize is None else stepSize)
        if isinstance(place, Random) or isinstance(length, Random) or is_later(self.value):
            return as_value(later(_FOLLOW, _followed, (self.value, place, length, law)))
        return _followed(self.value, place, length, law)

    def followFromTrajectory(
        self, position: Any, distance: float, steps: int | None = None, stepSize: float | None = None
    ) -> list[Any]:
        """The places on the way of `followFrom`: where it starts, and where each step ends."""
        place = to_vector(position, "`followFromTrajectory`")
        count = steps_of(
            distance, (steps, self.minSteps, self.defaultStepSize if stepSize is None else stepSize)
        )
        places = [place]
        for _ in range(count):
            places.append(self.followFrom(places[-1], distance / count, steps=1))
        return places

    @staticmethod
    def forUnionOf(regions: Iterable[Any], tolerance: float = 0) -> "PiecewiseVectorField | None":  # noqa: ARG004 - of the established call
        """Return the field that takes each point's orientation from the first region that holds it; ``None`` without any."""
        members = list(regions)
        if not any(member.orientation is not None for member in members):
            return None
        return PiecewiseVectorField("union", members)

    def __repr__(self) -> str:
        return f"<{type(self).__name__} {self.name}>"


class TabulatedField(VectorField):
    """A field whose headings are computed for many points at a time.

    Subclasses implement `headings`; `_is_table` may take that back.
    """

    _is_table: bool = True
    """True if `headings` is defined at every point."""
    divides_backward: bool = False
    """True if a way against the field is divided by its length, as one along it is; else it takes the least number of steps."""

    @abstractmethod
    def headings(self, points: Points) -> tuple[Headings, Mask]:
        """Headings ``(n,)``, anticlockwise from north, at points ``(n, 3)``, and which points have one, ``(n,)``."""

    def heading_bounds(self, points: Bounds) -> Bounds | None:
        """Bounds ``(m,)`` of the headings at points in boxes ``(m, 3)``; ``None`` where nothing is known."""
        return None

    def stepped(self, points: Points, strides: NDArray[np.float64]) -> tuple[Points, Mask]:
        """Move points ``(n, 3)`` along the field by ``strides`` ``(n,)``, in metres; return the new points,
        and a mask ``(n,)`` of the points at which the field has a direction.
        """
        headings, known = self.headings(points)
        reached = np.array(points)
        reached[:, 0] -= strides * np.sin(headings)
        reached[:, 1] += strides * np.cos(headings)
        return reached, known

    def __getitem__(self, position: Any) -> Any:
        place = to_vector(position, f"field {self.name!r}")
        if isinstance(place, Random) and self._is_table:
            return Orientation.fromEuler(apply(_HEADING, place, payload=self), 0, 0)
        return super().__getitem__(place)

    def followFrom(
        self, position: Any, distance: Any, steps: int | None = None, stepSize: float | None = None
    ) -> Any:
        place = to_vector(position, "`follow ... from`")
        length = to_scalar(distance, "`follow ... for`")
        if self._is_table and (isinstance(place, Random) or isinstance(length, Random)):
            law = (steps, self.minSteps, self.defaultStepSize if stepSize is None else stepSize)
            return apply(_FOLLOW_TABLE, place, length, payload=(self, law))
        return super().followFrom(place, length, steps, stepSize)


class PolygonalVectorField(TabulatedField):
    """A field that is constant on polygons.

    Args:
        name: for messages.
        cells: pairs of a polygon (shapely's) and a heading in radians, or ``None`` for that of ``headingFunction``.
        headingFunction: the heading at points of cells that have none of their own.
        defaultHeading: the heading outside of all cells; ``None`` rejects samples that need one there.

    """

    def __init__(
        self,
        name: str,
        cells: Iterable[tuple[Any, float | None]],
        headingFunction: Callable[[Any], Any] | None = None,
        defaultHeading: float | None = None,
        **options: Any,
    ) -> None:
        self.cells = tuple(cells)
        for _, heading in self.cells:
            if heading is None and headingFunction is None:
                raise ScenicTypeError(
                    f"field {name!r} has a cell without a heading",
                    span=here(),
                    help="give a `headingFunction`",
                )
        self.headingFunction = headingFunction
        self.defaultHeading = defaultHeading
        self._table: Headings | None = None
        if all(heading is not None for _, heading in self.cells):
            headings = [*(heading for _, heading in self.cells), defaultHeading or 0.0]
            self._table = np.array(headings, dtype=np.float64)
        self._index: CellIndex | None = None
        self._boxes: tuple[NDArray[np.float64], NDArray[np.float64]] | None = None
        super().__init__(name, self._value, **options)

    def _nearest_cells(self, x: NDArray[np.float64], y: NDArray[np.float64]) -> NDArray[np.intp]:
        """Return the first cell that holds each point; the number of cells where none does."""
        if self._index is None:
            self._index = CellIndex([_polygon(cell) for cell, _ in self.cells])
        return self._index.first_at(x, y)

    def headings(self, points: Points) -> tuple[Headings, NDArray[np.bool_]]:
        """Headings at points ``(n, 3)``, and which points have one; for fields without a function."""
        assert self._table is not None
        cells = self._nearest_cells(points[:, 0], points[:, 1])
        return self._table[cells], (cells < len(self.cells)) | (self.defaultHeading is not None)

    def heading_bounds(self, points: Bounds) -> Bounds | None:
        if self._table is None or len(self.cells) > _MOST_BOUNDED:
            return None
        if self._boxes is None:
            corners = np.array([_polygon(cell).bounds for cell, _ in self.cells]).reshape(-1, 4)
            self._boxes = corners[:, :2], corners[:, 2:]
        low, high = self._boxes
        lower, upper = points.lower[:, np.newaxis, :2], points.upper[:, np.newaxis, :2]
        overlaps = ((lower <= high + _EDGE) & (upper >= low - _EDGE)).all(axis=2)
        # The last entry of the table is the heading outside of all cells.
        outside = np.full((overlaps.shape[0], 1), self.defaultHeading is not None)
        is_possible: NDArray[np.bool_] = np.concatenate([overlaps, outside], axis=1)
        is_possible[~is_possible.any(axis=1)] = True  # no candidate has a heading there
        return Bounds(
            np.where(is_possible, self._table, np.inf).min(axis=1),
            np.where(is_possible, self._table, -np.inf).max(axis=1),
        )

    @property
    def _is_table(self) -> bool:  # type: ignore[override] # only where every cell has a heading of its own
        return self._table is not None

    def _value(self, point: Any) -> Any:
        (cell,) = self._nearest_cells(np.array([point.x]), np.array([point.y]))
        if cell < len(self.cells):
            heading = self.cells[cell][1]
            if heading is not None:
                return heading
            assert self.headingFunction is not None
            return self.headingFunction(point)
        if self.defaultHeading is None:
            raise RejectionException(f"field {self.name!r} has no direction at {point!r}")
        return self.defaultHeading


class PiecewiseVectorField(VectorField):
    """A field that takes each point's orientation from the first region with one that holds the point.

    Args:
        name: for messages.
        regions: with preferred orientations.
        defaultHeading: the heading outside of all of them; ``None`` rejects samples that need one there.

    """

    def __init__(
        self, name: str, regions: Iterable[Any], defaultHeading: float | None = None, **options: Any
    ) -> None:
        self.regions = tuple(regions)
        self.defaultHeading = defaultHeading
        self._oriented = tuple(region for region in self.regions if region.orientation is not None)
        super().__init__(name, self._value, **options)

    @cached_property
    def _index(self) -> CellIndex | None:
        """Finds the region that holds a point, if they are many and fixed polygons."""
        if len(self._oriented) < _MANY_REGIONS:
            return None
        polygons = [
            None if getattr(region, "is_random", False) else getattr(region, "polygons", None)
            for region in self._oriented
        ]
        return None if any(item is None for item in polygons) else CellIndex(polygons)

    def _likely(self, point: Any) -> Iterator[Any]:
        """The regions in their order, before them the one that holds the point as seen from above."""
        if self._index is not None:
            x, y, _ = to_vector(point)
            number = int(self._index.first_at(np.array([x]), np.array([y]))[0])
            yield from self._oriented[number : number + 1]
        yield from self._oriented

    def _value(self, point: Any) -> Any:
        for region in self._likely(point):
            if region.containsPoint(point):
                return region.orientation[point]
        if self.defaultHeading is None:
            raise RejectionException(f"field {self.name!r} has no direction at {point!r}")
        return self.defaultHeading


def field_of_union(members: Sequence[Any]) -> PiecewiseVectorField | None:
    """Return the preferred orientation of a union of regions of the plane: that of the first member that holds the point."""
    oriented = any(member.has_orientation for member in members)
    return PiecewiseVectorField("union", members) if oriented else None


class PolyhedronVectorField(VectorField):
    """A field that is constant on volumes.

    Args:
        name: for messages.
        cells: pairs of a region and an orientation (or heading), or ``None`` for that of ``headingFunction``.
        headingFunction: the orientation at points of cells that have none of their own.
        defaultHeading: the orientation outside of all cells; ``None`` rejects samples that need one there.

    """

    def __init__(
        self,
        name: str,
        cells: Iterable[tuple[Any, Any]],
        headingFunction: Callable[[Any], Any] | None = None,
        defaultHeading: Any = None,
        **options: Any,
    ) -> None:
        self.cells = tuple(cells)
        self.headingFunction = headingFunction
        self.defaultHeading = defaultHeading
        super().__init__(name, self._value, **options)

    def _value(self, point: Any) -> Any:
        for region, orientation in self.cells:
            if region.containsPoint(point):
                if orientation is None and self.headingFunction is not None:
                    return self.headingFunction(point)
                return orientation
        if self.defaultHeading is None:
            raise RejectionException(f"field {self.name!r} has no direction at {point!r}")
        return self.defaultHeading


def _polygon(cell: Any) -> Any:
    """Return a shapely polygon: the cell itself, or that of a polygonal region."""
    return getattr(cell, "polygons", cell)


class FieldChoice(VectorField):
    """One of several fields, drawn at random."""

    def __init__(self, choice: Random) -> None:
        super().__init__("chosen at random", self.__getitem__)
        self._choice = choice

    def __getitem__(self, position: Any) -> Any:
        place = to_vector(position, "a field")
        if isinstance(place, Lazy):
            return defer(self.__getitem__, place)
        found = self._over_lanes("__getitem__", place)
        if found is not None:
            return found
        return per_option(self._choice, lambda field: field_of(field, "a field")[place])

    def followFrom(
        self, position: Any, distance: Any, steps: int | None = None, stepSize: float | None = None
    ) -> Any:
        place, length = to_vector(position, "`follow ... from`"), to_scalar(distance, "`follow ... for`")
        if isinstance(place, Lazy) or isinstance(length, Lazy):
            return defer(self.followFrom, place, length, steps, stepSize)
        place_of_lanes = self._over_lanes("followFrom", place, length, steps, stepSize)
        if place_of_lanes is not None:
            return place_of_lanes
        return per_option(
            self._choice, lambda field: field_of(field, "a field").followFrom(place, length, steps, stepSize)
        )

    def _over_lanes(self, method: str, *args: Any) -> Any:
        """The result of a method of the drawn field as one node; ``None`` if a field has no reading over lanes."""
        index, *options = self._choice.node.operands
        if not all(option.is_constant for option in options):
            return None
        methods = [as_node(getattr(option.value, method)) for option in options]
        found = node_over_lanes(index, methods, args, {})
        return None if found is None else as_value(found)


def is_field(value: Any) -> bool:
    """Return whether a value is a field, or a random choice of which some option is one."""
    return isinstance(value, VectorField) or any(map(is_field, options_of(value)))


def is_certainly_field(value: Any) -> bool:
    """Return whether a value is a field, or a random choice among fields."""
    options = options_of(value)
    return isinstance(value, VectorField) or (bool(options) and all(map(is_certainly_field, options)))


def field_of(value: Any, what: str) -> VectorField:
    """Return a field; raises `ScenicTypeError` for anything else."""
    if isinstance(value, VectorField):
        return value
    if is_certainly_field(value):
        return FieldChoice(value)
    raise wrong_type(FIELD, value, what)


def frame_at(direction: Any, position: Any, what: str) -> Any:
    """Return a direction as an orientation; a field's is that at a point."""
    if type(direction) is float:  # the most frequent one
        return Orientation.fromEuler(direction, 0.0, 0.0)
    if is_certainly_field(direction):
        return field_of(direction, what)[position]
    if not is_field(direction):
        return to_orientation(direction, what)
    place = to_vector(position, what)
    return per_option(direction, lambda option: frame_at(option, place, what))


def relative_to(value: Any, frame: Any) -> Lazy:
    """Return ``value relative to frame`` with a field.

    The result is lazy, since a field means its direction where the object will be.
    """

    def compute(instance: Any) -> Any:
        outer, inner = (
            frame_at(resolve(operand, instance), instance.position, "`relative to`")
            for operand in (frame, value)
        )
        return operate("compose", outer, inner)

    return Lazy(frozenset({"position"}) | reads_of((value, frame)), compute)


# On samples

Law = tuple[int | None, int, float]
"""Number of steps if fixed, least number, and longest step."""

_MOST_STEPS: Final = 1_000_000
"""Steps of a way, at most: beyond, it is a mistake, and would take for ever."""


def _oriented(function: Callable[[Any], Any], point: Any) -> Any:
    return to_orientation(function(point), "the value of a field")


def steps_of(distance: float, law: Law) -> int:
    """The number of steps of a way in metres; raises `ScenicValueError` if there would be too many."""
    steps, least, size = law
    if steps is not None:
        return steps
    if not -math.inf < distance <= _MOST_STEPS * size:
        raise ScenicValueError(
            f"a field cannot be followed for {distance:g} m in steps of {size:g} m",
            span=here(),
            help="give the field a larger `defaultStepSize`, or follow it less far",
        )
    return max(least, 1, math.ceil(distance / size))


def _followed(function: Callable[[Any], Any], point: Any, distance: float, law: Law) -> Any:
    count = steps_of(distance, law)
    step = Vector.of((0.0, distance / count, 0.0))
    for _ in range(count):
        point = point.offsetRotated(_oriented(function, point), step)
    return point


def _values(call: Call, *columns: Column) -> Column:
    failed = np.zeros(call.lanes, dtype=np.bool_)
    turns, error = _turns(evaluated(call, columns, _ABSENT), failed)
    if error is not None:
        call.fault(failed, error)
    return turns


def _turns(values: Sequence[Any], failed: Mask) -> tuple[NDArray[np.float64], Exception | None]:
    """Convert values of a field to quaternions ``(n, 4)``; lanes whose value is not an orientation are marked, and the first error is returned."""
    if all(type(value) in _HEADINGS for value in values):
        yaw = np.array([0.0 if value is _ABSENT else float(value) for value in values])
        return quaternions.from_euler(yaw, np.zeros(1), np.zeros(1)), None
    rows = np.zeros((len(values), 4))
    rows[:, 3] = 1.0
    first: Exception | None = None
    for lane, value in enumerate(values):
        if value is not _ABSENT:
            try:
                rows[lane] = to_orientation(value, "the value of a field").q
            except ScenicTypeError as error:
                failed[lane] = True
                first = error if first is None else first
    return rows, first


class _Absent:
    """Stands for a value that no call has given; ``None`` would be one that the function gives."""


_MOST_BOUNDED: Final = 1 << 10
"""Cells up to which bounds of headings are looked for."""

_EDGE: Final = 1e-6
"""Metres by which boxes of cells are widened."""

_ABSENT: Final = _Absent()
_HEADINGS: Final = (float, int, _Absent)


def _follow(call: Call, *columns: Column) -> Column:
    rows = together(call, columns, partial(_followed_together, call.lanes))
    if rows is None:
        rows = np.zeros((call.lanes, 3))
        for lane, value in enumerate(evaluated(call, columns)):
            if value is not None:
                rows[lane] = tuple(value)
    return rows


def _followed_together(lanes: int, calls: Calls, rows: Rows) -> Column:
    """As `_followed`, step by step in all lanes."""
    place = np.zeros((lanes, 3))
    stride = np.zeros((lanes, 3))
    counts = np.zeros(lanes, dtype=np.int64)
    for lane in calls.present:
        _, point, distance, law = rows[lane]
        place[lane] = tuple(point)
        try:
            counts[lane] = steps_of(distance, law)
        except ScenicValueError as endless:
            calls.mark(lane, endless)
            continue
        stride[lane, 1] = distance / counts[lane]
    for step in range(int(counts.max(initial=0))):
        moving = np.flatnonzero((step < counts) & ~calls.failed & ~calls.rejected)
        points = [(Vector.of(row),) for row in zip(*place[moving].T.tolist(), strict=True)]
        values: list[Any] = [_ABSENT] * lanes
        if len(moving):
            calls.each(rows[moving[0]][0], moving.tolist(), points, values)
        faulty_lanes = np.zeros(lanes, dtype=np.bool_)
        turns, error = _turns(values, faulty_lanes)
        if error is not None:
            for lane in np.flatnonzero(faulty_lanes).tolist():
                calls.mark(lane, error)
        place[moving] += quaternions.rotate(turns[moving], stride[moving])
    return place


_VALUE = Operation(
    "field value",
    always(Kind.ORIENTATION),
    _values,
    "The value of a field, by its own function.",
    pure=False,
    calls_code=True,
    faults=True,
    rejects=True,
)
_FOLLOW = Operation(
    "follow field",
    always(Kind.VECTOR),
    _follow,
    "The end of a way along a field, by its own function.",
    pure=False,
    calls_code=True,
    faults=True,
    rejects=True,
)


def _headings(call: Call, points: Column) -> Column:
    headings, known = call.payload.headings(points)
    call.reject(~known)
    return np.asarray(headings)


_HEADING = Operation(
    "field heading",
    always(Kind.SCALAR),
    _headings,
    "The heading of a field of polygons; the candidate is rejected where it has none.",
    bounds=lambda field, points: field.heading_bounds(points),
    rejects=True,
    missing="direction of the field",
)


def _follow_table(call: Call, points: Column, distance: Column) -> Column:
    field, (steps, least, size) = call.payload
    lanes = max(len(points), len(distance))
    place = np.array(np.broadcast_to(points, (lanes, 3)))
    length = np.broadcast_to(distance, lanes)
    path_length = np.abs(length) if field.divides_backward else length
    counts = (
        np.full(lanes, steps) if steps is not None else np.maximum(max(least, 1), np.ceil(path_length / size))
    )
    missing = np.zeros(lanes, dtype=np.bool_)
    for step in range(int(counts.max(initial=0))):
        moving = np.flatnonzero(step < counts)
        place[moving], has_heading = field.stepped(place[moving], length[moving] / counts[moving])
        missing[moving] |= ~has_heading
    call.reject(missing)
    return place


def _follow_inverse(
    _payload: object, result: Bounds, _points: Bounds | None, distance: Bounds | None
) -> Sequence[Bounds | None]:
    """Bound the start of a path along the field whose end is known."""
    return _around(result, distance), None


def _around(points: Bounds | None, distance: Bounds | None) -> Bounds | None:
    if points is None or distance is None:
        return None
    length = np.maximum(np.abs(distance.lower), np.abs(distance.upper)) * (1 + _ROUNDING) + _ROUNDING
    reach = np.stack([length, length, np.full_like(length, _ROUNDING)], axis=1)
    return Bounds(points.lower - reach, points.upper + reach)


_ROUNDING: Final = 1e-9
"""Bound of the rounding error in the length of a path, relative, and in metres."""


_FOLLOW_TABLE = Operation(
    "follow polygons",
    always(Kind.VECTOR),
    _follow_table,
    "The end of a way along a field of polygons; the candidate is rejected where the way leaves them.",
    bounds=lambda _payload, points, distance: _around(points, distance),
    inverse=_follow_inverse,
    rejects=True,
    missing="direction of the field",
)


__all__ = [
    "PiecewiseVectorField",
    "PolygonalVectorField",
    "PolyhedronVectorField",
    "TabulatedField",
    "VectorField",
    "field_of",
    "frame_at",
    "is_field",
    "relative_to",
    "steps_of",
]
