"""The space that is searched: coordinates in the unit interval, and the numbers of draws that they stand for."""

from collections.abc import Sequence
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from scenic.dataclass import dataclass
from scenic.graph.operations.distributions import FIRST, LAST
from scenic.graph.operations.normal import conditioned_cumulative, conditioned_quantile
from scenic.runtime.program.external import Choosable

if TYPE_CHECKING:
    from scenic.runtime.scenes.scenario import Scenario

__all__ = ["Coordinate", "Floats", "Space", "space_of"]

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
        """The value at a coordinate; of options the place of one."""
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
        """The coordinate of a value; raises `ValueError` for one that is impossible."""
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

    def numbers(self, points: Floats) -> Floats:
        """The numbers of draws ``(n, d)`` for points ``(n, d)``."""
        columns = [item.number(points[:, place]) for place, item in enumerate(self.coordinates)]
        return np.column_stack(columns) if columns else np.zeros((len(points), 0))


def space_of(scenario: "Scenario", wanted: str = "auto") -> Space:
    """The space of a scenario.

    Args:
        scenario: the scenario.
        wanted: ``external`` for its external parameters, ``scene`` for all draws of a scene, ``auto`` for the
            external parameters where there are any.

    """
    externals = scenario.externals
    if wanted == "external" or (wanted == "auto" and externals):
        return Space(tuple(_external(place, item, scenario) for place, item in externals.items()))
    seen: dict[str, int] = {}
    return Space(
        tuple(Coordinate(axis.address, _numbered(_place(axis.span), seen)) for axis in scenario.axes)
    )


def _external(address: int, item: Choosable, scenario: "Scenario") -> Coordinate:
    label = scenario.external_names.get(address) or f"{item.kind} {address:016x}"
    return Coordinate(
        address,
        label,
        item.low,
        item.high,
        item.count,
        item.shares,
        item.cells,
        item.normal,
        item.is_stratified,
    )


def _place(span: object) -> str:
    line, column = getattr(span, "line", None), getattr(span, "column", None)
    return "draw" if line is None else f"line {line}:{column}"


def _numbered(label: str, seen: dict[str, int]) -> str:
    seen[label] = seen.get(label, 0) + 1
    return label if seen[label] == 1 else f"{label} #{seen[label]}"


def shares_of(space: Space, buckets: int) -> Sequence[Floats]:
    """The first distribution over buckets for each coordinate: its prior, else all alike."""
    return [
        np.array(item.shares)
        if item.shares is not None
        else np.full(item.count or buckets, 1 / (item.count or buckets))
        for item in space.coordinates
    ]
