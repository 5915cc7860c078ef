"""The space that is searched: coordinates in the unit interval, and the numbers of draws that they stand for."""

from collections.abc import Sequence
from typing import TYPE_CHECKING, Final

import numpy as np
from numpy.typing import NDArray

from scenic.dataclass import dataclass
from scenic.graph.operations.distributions import FIRST, LAST
from scenic.graph.operations.normal_law import conditioned_cumulative, conditioned_quantile
from scenic.runtime.ground.choosable import Choosable

if TYPE_CHECKING:
    from scenic.runtime.scenes.naming import DrawName
    from scenic.runtime.scenes.scenario import Scenario

__all__ = ["SHARE", "Coordinate", "Floats", "Space", "decides", "space_of", "worded"]

SHARE: Final = "of its range"
"""In the place of the unit of a number from 0 to 1 of which only this is known."""

Floats = NDArray[np.float64]


@dataclass(frozen=True, slots=True)
class Coordinate:
    """One coordinate of a search: a number of [0, 1], for values at equal distances from the least to the greatest one.

    Attributes:
        address: the address of the draw.
        label: what to call it in tables: a name, or a place in the program.
        low: the value at 0.
        high: the value at 1.
        count: of a discrete value how many there are; each has an equal share of the coordinate.
        shares: the prior: probabilities of values, or of buckets, which have equal shares of the coordinate.
        cells: the ends of these buckets, or each value twice, if they do not divide the values from ``low`` to ``high`` evenly.
        normal: mean and deviation, if values within buckets are those of a normal law between ``low`` and ``high``.
        is_stratified: whether buckets come from a prior.
        unit: of the values, where it is known; `SHARE` where only the place between the least and the greatest is.

    """

    address: int
    label: str
    low: float = 0.0
    high: float = 1.0
    count: int | None = None
    shares: tuple[float, ...] | None = None
    cells: tuple[tuple[float, float], ...] | None = None
    normal: tuple[float, float] | None = None
    is_stratified: bool = False
    unit: str = ""

    @property
    def is_continuous(self) -> bool:
        """Return whether samplers that do not learn take values from all along the coordinate, and not bucket by bucket."""
        return self.count is None and not self.is_stratified

    def number(self, place: Floats) -> Floats:
        """The numbers of the draw, in the open unit interval, for coordinates ``(n,)``."""
        if self.count is not None:
            index = np.minimum((place * self.count).astype(np.intp), self.count - 1)
            sums = self._sums(self.count)
            return np.asarray(np.clip((sums[index] + sums[index + 1]) / 2, FIRST, LAST))
        if self.shares is not None:
            place = np.interp(place, np.linspace(0, 1, len(self.shares) + 1), self._sums(len(self.shares)))
        first = FIRST if self.normal is None else 1 - LAST
        return np.asarray(np.clip(place, first, LAST))

    def value(self, place: float) -> float:
        """Return the value at a coordinate; of options the place of one."""
        if self.normal is not None:
            mean, deviation = self.normal
            number = self.number(np.array([place]))
            return mean + deviation * float(conditioned_quantile(*self._window(), number)[0])
        if self.cells is not None:
            index = min(int(place * len(self.cells)), len(self.cells) - 1)
            start, end = self.cells[index]
            return start + (end - start) * (place * len(self.cells) - index)
        if self.count is not None:
            return self.low + min(int(place * self.count), self.count - 1)
        return self.low + (self.high - self.low) * place

    def coordinate(self, value: float) -> float:
        """Return the coordinate of a value; raises `ValueError` for one that is impossible."""
        if not self.low <= value <= self.high:
            raise ValueError(f"{value} is no value of {self.label}")
        if self.normal is not None:
            mean, deviation = self.normal
            below, _ = conditioned_cumulative(*self._window(), np.array([(value - mean) / deviation]))
            shares = self.shares or (1.0,)
            return float(np.interp(below[0], self._sums(len(shares)), np.linspace(0, 1, len(shares) + 1)))
        if self.cells is not None:
            for index, (start, end) in enumerate(self.cells):
                if start <= value <= end:
                    return (index + ((value - start) / (end - start) if end > start else 0.5)) / len(
                        self.cells
                    )
            raise ValueError(f"{value} is no value of {self.label}")
        if self.count is not None:
            return (value - self.low + 0.5) / self.count
        return (value - self.low) / (self.high - self.low) if self.high != self.low else 0.5

    def _window(self) -> tuple[Floats, Floats]:
        """The ends of a normal law as deviations from its mean."""
        assert self.normal is not None
        mean, deviation = self.normal
        return np.array([(self.low - mean) / deviation]), np.array([(self.high - mean) / deviation])

    def _sums(self, count: int) -> Floats:
        shares = (1 / count,) * count if self.shares is None else self.shares
        return np.concatenate([[0.0], np.minimum(np.cumsum(shares), 1.0)])


@dataclass(frozen=True, slots=True)
class Space:
    """The coordinates of a search, in order."""

    coordinates: tuple[Coordinate, ...]

    def __len__(self) -> int:
        return len(self.coordinates)

    @property
    def units(self) -> dict[str, str]:
        """The units of values, by label, where they are known."""
        return {item.label: item.unit for item in self.coordinates if item.unit}

    def numbers(self, points: Floats) -> Floats:
        """The numbers of draws ``(n, d)`` for points ``(n, d)``."""
        columns = [item.number(points[:, place]) for place, item in enumerate(self.coordinates)]
        return np.column_stack(columns) if columns else np.zeros((len(points), 0))


def worded(label: str, value: float, unit: str) -> str:
    """Return a coordinate and its value, for readers."""
    return f"{label} = {value:.6g} {unit}".rstrip()


def space_of(scenario: "Scenario", wanted: str = "auto") -> Space:
    """Return the space of a scenario.

    Args:
        scenario: the scenario.
        wanted: ``external`` for its external parameters, ``scene`` for all draws of a scene, ``auto`` for the
            external parameters where there are any, else for all draws on which something depends, ``none`` for no coordinates.

    """
    if wanted == "none":
        return Space(())
    externals = scenario.externals
    if wanted == "external" or (wanted == "auto" and externals):
        names = scenario.draw_names
        return Space(tuple(_external(place, item, names.get(place)) for place, item in externals.items()))
    left_out = scenario.idle_draws if wanted == "auto" else ()
    return Space(
        tuple(_drawn(axis.address, axis.name) for axis in scenario.axes if axis.address not in left_out)
    )


def decides(space: Space, scenario: "Scenario") -> bool:
    """Return whether a point of a space leaves no draws open on which the requirements may depend."""
    searched = {item.address for item in space.coordinates} | scenario.idle_draws
    return all(axis.address in searched for axis in scenario.axes)


def _drawn(address: int, name: "DrawName") -> Coordinate:
    low, high = name.ends or (0.0, 1.0)
    return Coordinate(address, name.text, low, high, unit=name.unit if name.ends else SHARE)


def _external(address: int, item: Choosable, name: "DrawName | None") -> Coordinate:
    """Return the coordinate of an external parameter; one that nothing holds, as only a behavior uses it, has no name."""
    return Coordinate(
        address,
        f"{item.kind} {address:016x}" if name is None else name.text,
        item.low,
        item.high,
        item.count,
        item.shares,
        item.cells,
        item.normal,
        item.is_stratified,
        name.unit if name is not None and name.ends == (item.low, item.high) else "",
    )


def shares_of(space: Space, buckets: int) -> Sequence[Floats]:
    """Return the first distribution over buckets for each coordinate: its prior, else all alike."""
    return [
        np.array(item.shares)
        if item.shares is not None
        else np.full(item.count or buckets, 1 / (item.count or buckets))
        for item in space.coordinates
    ]
