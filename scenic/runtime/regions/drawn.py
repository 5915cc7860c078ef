"""A region of which nothing is known before it is drawn, as code of the program returns one."""

from collections.abc import Callable, Iterator, Sequence
from typing import Any, Self

import numpy as np
from numpy.typing import NDArray

from scenic.graph.draws import mix, open_unit, words_of
from scenic.graph.kinds import Column
from scenic.language.errors import InvalidScenarioError, RejectionException
from scenic.language.types import REGION
from scenic.runtime.regions.base import Mask, Points, Region
from scenic.runtime.regions.varying import VaryingRegion
from scenic.runtime.values.generic import call_later
from scenic.runtime.values.values import Orientation, Random, operate, to_orientation, to_vector, wrong_type


class DrawnRegion(VaryingRegion):
    """A region that is known when it is drawn; where that has no preferred orientations, those are the global ones.

    Args:
        value: the random value, which certainly is a region.

    """

    dimension = 3
    draws = 0
    may_find_none = True
    has_orientation = True

    def __init__(self, value: Random) -> None:
        super().__init__(value)

    @classmethod
    def made(cls, make: Callable[..., Region], /, *args: Any, **keywords: Any) -> Self:
        """Return the region that a function makes of values once they are drawn."""
        return cls(call_later(make, *args, **keywords))

    @classmethod
    def of(cls, value: Random, what: str) -> Self:
        """Return the region that a random value of unknown type stands for; the draw of anything else is a fault."""
        return cls.made(_wanted, value, what)

    @property
    def footprint(self) -> Region:
        return DrawnRegion.made(_footprint, self.parameters[0])

    def sampled(self, sample: Any) -> Region:
        region: Region = sample.value(self.parameters[0])
        return region

    def orientation_at(self, point: object) -> Any:
        return to_orientation(call_later(_orientation_at, self.parameters[0], point))

    def project(self, point: object, direction: object) -> tuple[Any, Any]:
        landing = call_later(_landing, self.parameters[0], point, direction)
        place, orientation = operate("getitem", landing, 0), operate("getitem", landing, 1)
        return to_vector(place), to_orientation(orientation)

    def drawn(
        self, lanes: int, columns: Sequence[Column]
    ) -> Iterator[tuple[Region, NDArray[np.intp], Sequence[Column]]]:
        (column,) = columns
        regions: dict[int, Region] = {}
        numbers = np.empty(len(column), dtype=np.int64)
        for lane, region in enumerate(column.tolist()):
            if region is not None:  # what has been rejected has none
                regions[id(region)] = region
            numbers[lane] = id(region)
        numbers = np.broadcast_to(numbers, lanes)
        for number, region in regions.items():
            # By now its parameters are fixed.
            yield region, np.flatnonzero(numbers == number), region.fixed_columns("what it holds")

    def draw_points(self, uniforms: Column, keys: Column, *columns: Column) -> tuple[Points, Mask | None]:
        """Draw points; how many numbers they take is known only now: these follow from the keys, and so do further keys."""
        lanes = uniforms.shape[1]
        keys = np.broadcast_to(keys, lanes)
        points, has_point = np.zeros((lanes, 3)), np.ones(lanes, dtype=np.bool_)
        for region, lanes_of_region, mine in self.drawn(lanes, columns):
            addresses = np.arange(1, region.draws + 1, dtype=np.uint64)
            numbers = open_unit(words_of(keys[lanes_of_region], addresses))
            points_of_region, has_point_of_region = region.draw_points(
                numbers, mix(keys[lanes_of_region]), *mine
            )
            points[lanes_of_region] = points_of_region
            if has_point_of_region is not None:
                has_point[lanes_of_region] = has_point_of_region
        return points, has_point


def _wanted(value: object, what: str) -> Region:
    if not isinstance(value, Region):
        raise wrong_type(REGION, value, what)
    return value


def _footprint(region: Region) -> Region:
    return region.footprint


def _orientation_at(region: Region, point: object) -> Any:
    return region.orientation_at(point) if region.has_orientation else Orientation()


def _landing(region: Region, point: object, direction: object) -> tuple[Any, Any]:
    try:
        place, orientation = region.project(point, direction)
    except InvalidScenarioError as error:  # in a program of which nothing is random that is a mistake
        raise RejectionException(str(error)) from error
    return place, Orientation() if orientation is None else orientation
