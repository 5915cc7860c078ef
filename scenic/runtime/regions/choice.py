"""A random choice among regions, as a region: each lane has the one that it draws."""

from collections.abc import Iterator, Sequence
from functools import cached_property, reduce
from typing import Any, TypeVar

import numpy as np
from numpy.typing import NDArray

from scenic.graph.bounds import Bounds
from scenic.graph.construction import make_node
from scenic.graph.kinds import Column, Kind
from scenic.graph.operation import Call, Operation, always
from scenic.graph.operations import TABLE
from scenic.language.errors import InvalidScenarioError
from scenic.runtime.geometry.flat.segments import Lines
from scenic.runtime.ground.context import here
from scenic.runtime.regions.base import Mask, Points, Region
from scenic.runtime.regions.lines import LineRegion, drawn_of_lines
from scenic.runtime.regions.nearness import hull_of
from scenic.runtime.regions.varying import VaryingRegion
from scenic.runtime.values.choices import select
from scenic.runtime.values.values import Orientation, Random, as_node, as_value

_Part = TypeVar("_Part")


class RegionChoice(VaryingRegion):
    """One of several regions.

    Args:
        index: which one, random.
        options: the regions.

    """

    def __init__(self, index: object, options: Sequence[Region]) -> None:
        super().__init__(index, *(value for option in options for value in option.parameters))
        self.options = tuple(options)
        self.dimension = max(option.dimension for option in options)
        self.draws = max(option.draws for option in options)
        self.has_orientation = all(option.has_orientation for option in options)
        self.may_find_none = any(option.may_find_none for option in options)
        self.tolerance = max(option.tolerance for option in options)

    @property
    def footprint(self) -> Region:
        footprints = [option.footprint for option in self.options]
        if all(new is old for new, old in zip(footprints, self.options, strict=True)):
            return self
        return RegionChoice(self.parameters[0], footprints)

    def uniform_placement(self) -> tuple[Any, Any]:
        for option in self.options:
            if option.dimension == np.inf:
                option.uniform_placement()  # says why not
        return super().uniform_placement()

    def project(self, point: object, direction: object) -> tuple[Any, Any]:
        """Project a point onto the option that is drawn.

        An option on which the point does not land rejects only the candidates in which it is drawn.
        """
        landings = [_landing(option, point, direction) for option in self.options]
        index = as_node(self.parameters[0])
        places, orientations = ([as_node(part) for part in parts] for parts in zip(*landings, strict=True))
        return select(index, places), select(index, orientations) if self.has_orientation else None

    def orientation_at(self, point: object) -> Any:
        """Return the orientation that the drawn option has at a point; an option with a vector field evaluates its own."""
        if not self.has_orientation or self._has_no_field:
            return super().orientation_at(point)
        found = [as_node(option.orientation_at(point)) for option in self.options]
        return select(as_node(self.parameters[0]), found)

    @property
    def is_alike(self) -> bool:
        """Return whether all options are of the same dimension."""
        return all(option.dimension == self.dimension for option in self.options)

    @property
    def _has_no_field(self) -> bool:
        """Return whether the options themselves give orientations, so that these can be computed over lanes."""
        return all(
            option._has_no_field
            if isinstance(option, RegionChoice)
            else getattr(option.orientation, "region", None) is option
            for option in self.options
        )

    def sampled(self, sample: Any) -> Region:
        """Return the region that a sample draws."""
        region: Region = self.options[sample.value(self.parameters[0])].sampled(sample)
        return region

    def _each(self, columns: Sequence[_Part]) -> Iterator[tuple[Region, Sequence[_Part]]]:
        """Yield each option with the parts that belong to its parameters."""
        first = 1
        for option in self.options:
            yield option, columns[first : first + len(option.parameters)]
            first += len(option.parameters)

    def drawn(
        self, lanes: int, columns: Sequence[Column]
    ) -> Iterator[tuple[Region, NDArray[np.intp], list[Column]]]:
        """Yield each option with the lanes that draw it and the columns of its parameters there."""
        index = np.broadcast_to(columns[0], lanes)
        for number, (option, mine) in enumerate(self._each(columns)):
            chosen = np.flatnonzero(index == number)
            if len(chosen):
                yield option, chosen, [part if len(part) == 1 else part[chosen] for part in mine]

    def draw_points(self, uniforms: Column, keys: Column, *columns: Column) -> tuple[Points, Mask | None]:
        lanes = uniforms.shape[1]
        points, known = np.zeros((lanes, 3)), np.ones(lanes, dtype=np.bool_)
        for option, chosen, mine in self.drawn(lanes, columns):
            drawn, found = option.draw_points(uniforms[: option.draws, chosen], keys[chosen], *mine)
            points[chosen] = drawn
            if found is not None:
                known[chosen] = found
        return points, known if self.may_find_none else None

    def box(self, *columns: Column) -> tuple[Points, Points]:
        lower, upper = zip(*(option.box(*mine) for option, mine in self._each(columns)), strict=True)
        return reduce(np.minimum, lower), reduce(np.maximum, upper)

    def extent(self, *parameters: Bounds | None) -> Bounds | None:
        return self._hull(parameters, [option.extent(*mine) for option, mine in self._each(parameters)])

    def container_extent(self, *parameters: Bounds | None) -> Bounds | None:
        found = [option.container_extent(*mine) for option, mine in self._each(parameters)]
        return self._hull(parameters, found)

    def drawn_extent(self, numbers: Sequence[Bounds], *parameters: Bounds | None) -> Bounds | None:
        """Return bounds of the points that the given numbers draw; in boxes where the index is known, of points of its option."""
        extent = self.extent(*parameters)
        index = parameters[0]
        if extent is None or index is None:
            return extent
        lanes = max(len(index.lower), len(extent.lower), *(len(part.lower) for part in numbers))
        first, last = (np.broadcast_to(end, lanes) for end in (index.lower, index.upper))
        lower, upper = (np.array(np.broadcast_to(end, (lanes, 3))) for end in (extent.lower, extent.upper))
        if self._lines is not None:
            rows = np.flatnonzero((first == last) & (first >= 0) & (first < len(self.options)))
            parts = drawn_of_lines(self._lines, first[rows].astype(np.intp), _rows(numbers[0], rows))
            lower[rows], upper[rows] = parts.lower, parts.upper
            return Bounds(lower, upper)
        for number, (option, mine) in enumerate(self._each(parameters)):
            rows = np.flatnonzero((first == number) & (last == number))
            if len(rows):
                numbers_of_option = [_rows(part, rows) for part in numbers[: option.draws]]
                box = option.drawn_extent(
                    numbers_of_option, *(None if part is None else _rows(part, rows) for part in mine)
                )
                if box is not None:
                    lower[rows], upper[rows] = box.lower, box.upper
        return Bounds(lower, upper)

    @cached_property
    def _lines(self) -> Lines | None:
        """The options, if all are lines."""
        lines = [option.pieces for option in self.options if isinstance(option, LineRegion)]
        return Lines(tuple(lines)) if len(lines) == len(self.options) else None

    @staticmethod
    def _hull(parameters: Sequence[Bounds | None], boxes: Sequence[Bounds | None]) -> Bounds | None:
        """Return bounds ``(m | 1, 3)`` of the options that the index may draw, from those of each; ``None`` where one is not known."""
        whole, index = hull_of(boxes), parameters[0]
        definite_boxes = [box for box in boxes if box is not None and len(box.lower) == 1]
        if whole is None or index is None or len(definite_boxes) < len(boxes):
            return whole
        last = len(boxes) - 1
        runs = np.stack([np.clip(end, 0, last) for end in (index.lower, index.upper + 1)], axis=1)
        runs[:, 1] = np.where(index.upper < last, runs[:, 1], last + 1)
        lower, upper = (
            np.concatenate([end, end[-1:]])
            for end in (
                np.concatenate([box.lower for box in definite_boxes]),
                np.concatenate([box.upper for box in definite_boxes]),
            )
        )
        places = runs.astype(np.intp).ravel()
        return Bounds(np.minimum.reduceat(lower, places)[::2], np.maximum.reduceat(upper, places)[::2])


def _rows(bounds: Bounds, rows: NDArray[np.intp]) -> Bounds:
    """Return the bounds of the boxes with some numbers."""
    return bounds if len(bounds.lower) == 1 else Bounds(bounds.lower[rows], bounds.upper[rows])


def _landing(option: Region, point: object, direction: object) -> tuple[Any, Any]:
    try:
        return option.project(point, direction)
    except InvalidScenarioError:  # a definite point that does not land
        return as_value(make_node(_NO_LANDING, (), span=here())), Orientation()


def _no_landing(call: Call) -> Points:
    call.reject(np.ones(1, dtype=np.bool_))
    return np.zeros((1, 3))


_NO_LANDING = Operation(
    "landing nowhere",
    always(Kind.VECTOR),
    _no_landing,
    "Where a point lands on an option of a choice that it misses; rejected where that option is drawn.",
    pure=False,
    rejects=True,
    missing="place to land on",
)


def as_region(value: object, missing: Region | None = None) -> Region | None:
    """A region, or a random choice among regions, with ``missing`` in place of `None`; ``None`` for anything else."""
    if isinstance(value, Region):
        return value
    if value is None:
        return missing
    if not isinstance(value, Random) or value.node.operation is not TABLE["select"]:
        return None
    index, *options = (as_value(node) for node in value.node.operands)
    regions = [as_region(option, missing) for option in options]
    regions_of_options = [region for region in regions if region is not None]
    return RegionChoice(index, regions_of_options) if len(regions_of_options) == len(regions) else None
