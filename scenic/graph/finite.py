"""Discrete values that are drawn together, so that requirements which couple them hold.

An axis of the cube below a discrete value falls into *cells*, on each of which the value is the same. A `Finite` part of a
domain chooses the cells of some axes jointly, by a `FiniteLaw` over combinations of cells. The number of an axis is then any
number of the cell, so that nothing else of the graph has to know.
"""

import hashlib
import math
from collections.abc import Sequence
from typing import Final, Protocol

import numpy as np
from numpy.typing import NDArray

from scenic.dataclass import dataclass
from scenic.graph.draws import Floats, Words

__all__ = ["BoundedDistinct", "ConditionalChoice", "Distinct", "Finite", "FiniteLaw", "Listed", "Sequential"]

Cells = NDArray[np.intp]

_MOST_ENTRIES: Final = 1 << 19
"""Combinations of a group that are compared at a time, in all lanes."""


class FiniteLaw(Protocol):
    """A law over combinations of cells, one of each variable."""

    @property
    def numbers(self) -> int:
        """The number of uniform numbers that choose a combination."""

    def choose(self, draws: Floats) -> Cells:
        """Return the combinations ``(variables, n)`` that uniform numbers ``(numbers, n)`` choose."""

    def arrays(self) -> Sequence[NDArray[np.generic]]:
        """Return the arrays that the law is made of, for digests."""


@dataclass(frozen=True, slots=True, eq=False)
class Listed:
    """One of a few combinations ``rows`` ``(m, variables)``; ``cumulative`` ``(m,)`` are their probabilities, summed up."""

    rows: Cells
    cumulative: Floats

    @property
    def numbers(self) -> int:
        return 1

    def choose(self, draws: Floats) -> Cells:
        found = np.searchsorted(self.cumulative, draws[0], side="right")
        return np.asarray(self.rows[np.minimum(found, len(self.rows) - 1)].T)

    def arrays(self) -> Sequence[NDArray[np.generic]]:
        return self.rows, self.cumulative


@dataclass(frozen=True, slots=True, eq=False)
class ConditionalChoice:
    """The choice of one variable, given others.

    Attributes:
        variable: its number.
        given: numbers of the variables that its law depends on.
        sizes: numbers of their values.
        cumulative: for each combination of their values, the last one fastest, the law of the variable, summed up.

    """

    variable: int
    given: tuple[int, ...]
    sizes: tuple[int, ...]
    cumulative: Floats


@dataclass(frozen=True, slots=True, eq=False)
class Sequential:
    """One variable after the other, each by its law given the earlier ones that matter to it.

    Attributes:
        steps: in the order of choice; each takes a number, that of the same place among the draws.
        outputs: the numbers of the variables that are the result; others only carry what is passed on.

    """

    steps: tuple[ConditionalChoice, ...]
    outputs: tuple[int, ...]

    @property
    def numbers(self) -> int:
        return len(self.steps)

    def choose(self, draws: Floats) -> Cells:
        chosen: dict[int, Cells] = {}
        for step, numbers in zip(self.steps, draws, strict=True):
            row = np.zeros(draws.shape[1], dtype=np.intp)
            for variable, size in zip(step.given, step.sizes, strict=True):
                row = row * size + chosen[variable]
            chosen[step.variable] = _search(step.cumulative, row, numbers)
        return np.stack([chosen[variable] for variable in self.outputs])

    def arrays(self) -> Sequence[NDArray[np.generic]]:
        return [step.cumulative for step in self.steps]


@dataclass(frozen=True, slots=True, eq=False)
class Distinct:
    """Groups of variables whose values take *labels* (seats, slots, numbers that differ), none of which is taken twice.

    Attributes:
        rows: of each group the combinations of its variables' values that are possible, ``(m, members)``.
        labels: of each group the labels that its combinations take, as bits ``(m,)``: the same number of them each.
        weights: of each group the weights of its combinations ``(m,)``.
        completions: for each set of used labels, as bits, the weight of all choices of the groups that are left: the set tells which.
        outputs: the places of the variables among the members of all groups, one after the other.

    """

    rows: tuple[Cells, ...]
    labels: tuple[NDArray[np.int64], ...]
    weights: tuple[Floats, ...]
    completions: Floats
    outputs: tuple[int, ...]

    @property
    def numbers(self) -> int:
        return len(self.rows)

    def choose(self, draws: Floats) -> Cells:
        largest = max(len(rows) for rows in self.rows)
        step = max(1, _MOST_ENTRIES // largest)
        count = max(1, draws.shape[1])
        parts = [self._chosen(draws[:, start : start + step]) for start in range(0, count, step)]
        return np.concatenate(parts, axis=1)

    def _chosen(self, draws: Floats) -> Cells:
        used_labels = np.zeros(draws.shape[1], dtype=np.int64)
        members = []
        for rows, bits, weights, numbers in zip(self.rows, self.labels, self.weights, draws, strict=True):
            free = (used_labels[:, np.newaxis] & bits) == 0
            after = self.completions[used_labels[:, np.newaxis] | bits]
            cumulative = np.cumsum(np.where(free, weights * after, 0.0), axis=1)
            limit = numbers * cumulative[:, -1]
            # The first combination whose sum exceeds the limit: never one of weight zero.
            place = np.minimum((cumulative <= limit[:, np.newaxis]).sum(axis=1), len(bits) - 1)
            members.append(rows[place].T)
            used_labels |= bits[place]
        return np.concatenate(members)[list(self.outputs)]

    def arrays(self) -> Sequence[NDArray[np.generic]]:
        return [*self.rows, *self.labels, *self.weights]


@dataclass(frozen=True, slots=True, eq=False)
class BoundedDistinct:
    """Variables that differ as in `Distinct`, of so many labels that their sets cannot be counted.

    Label after label is given to a variable or to nobody, with probabilities that come from an upper bound of the permanent in
    place of the weights of completions. The bound of what is left never exceeds the bound before, so that the rest of the
    probability rejects the draw, and what is not rejected follows the exact law (M. Huber and J. Law, "Fast approximation
    of the permanent for very dense problems", SODA 2008). A draw that is rejected gets the combination ``clash``, which
    the conditions themselves reject.

    Attributes:
        labels: of each variable the labels of its values, each below ``width``.
        weights: of each variable the weights of its values.
        width: the number of labels, at least that of the variables.
        clash: a combination in which two variables have values of one label.

    """

    labels: tuple[Cells, ...]
    weights: tuple[Floats, ...]
    width: int
    clash: Cells

    @property
    def numbers(self) -> int:
        return self.width

    @property
    def entries(self) -> Floats:
        """The weights ``(variables, width)`` of the labels, those of each variable divided by its largest."""
        sums = [
            np.bincount(labels, weights=weights, minlength=self.width)
            for labels, weights in zip(self.labels, self.weights, strict=True)
        ]
        return np.array([row / row.max() for row in sums])

    @property
    def bound(self) -> float:
        """The logarithm of an upper bound of the sum, over all choices, of the products of `entries`."""
        spare = self.width - len(self.labels)
        sums = self.entries.sum(axis=1)
        # Labels for nobody are rows of ones, which may be exchanged.
        return float(_log_bound(sums).sum() + spare * _log_bound(self.width) - math.lgamma(spare + 1))

    def choose(self, draws: Floats) -> Cells:
        entries = self.entries
        count = draws.shape[1]
        sums = np.repeat(entries.sum(axis=1)[:, np.newaxis], count, axis=1)
        waiting = np.ones(sums.shape, dtype=np.bool_)
        spare = np.full(count, self.width - len(self.labels))
        result = np.repeat(self.clash[:, np.newaxis], count, axis=1)
        going = np.ones(count, dtype=np.bool_)
        for label in range(self.width):
            rest = np.maximum(sums - entries[:, label, np.newaxis], 0.0)
            before, after = (np.where(waiting, _log_bound(each), 0.0) for each in (sums, rest))
            left = self.width - label
            nobody = _log_bound(left - 1)
            common = (after - before).sum(axis=0) + spare * (nobody - _log_bound(left))
            shares = np.where(waiting, entries[:, label, np.newaxis] * np.exp(common - after), 0.0)
            cumulative = np.cumsum(np.vstack([shares, spare * np.exp(common - nobody)]), axis=0)
            entry_numbers = (cumulative <= draws[label]).sum(axis=0)
            going &= entry_numbers < len(cumulative)
            lanes = np.flatnonzero(going & (entry_numbers < len(entries)))
            waiting[entry_numbers[lanes], lanes] = False
            spare -= going & (entry_numbers == len(entries))
            self._place(result, label, entry_numbers, lanes, draws[label], cumulative)
            sums = rest
        result[:, ~going] = self.clash[:, np.newaxis]
        return result

    def _place(
        self, result: Cells, label: int, chosen: Cells, lanes: Cells, draws: Floats, cumulative: Floats
    ) -> None:
        """Write the values of the variables that got a label; of several values of it, the rest of the number chooses."""
        for variable in np.unique(chosen[lanes]).tolist():
            mine = lanes[chosen[lanes] == variable]
            values = np.flatnonzero(self.labels[variable] == label)
            if len(values) > 1:
                weights = np.cumsum(self.weights[variable][values])
                start = cumulative[variable - 1, mine] if variable else 0.0
                share = (draws[mine] - start) / (cumulative[variable, mine] - start)
                place = np.searchsorted(weights, share * weights[-1], side="right")
                result[variable, mine] = values[np.minimum(place, len(values) - 1)]
            else:
                result[variable, mine] = values[0]

    def arrays(self) -> Sequence[NDArray[np.generic]]:
        return [*self.labels, *self.weights]


def _log_bound(sums: Floats | float) -> Floats:
    """The logarithm of the factor of a row of this sum in the bound of Huber and Law."""
    numbers = np.asarray(sums, dtype=np.float64)
    large = np.maximum(numbers, 1.0)
    factors = np.where(numbers >= 1, large + 0.5 * np.log(large) + math.e - 1, 1 + (math.e - 1) * numbers)
    return np.asarray(np.log(factors) - 1)


def _search(cumulative: Floats, row: Cells, numbers: Floats) -> Cells:
    """The first place in each lane's row of ``cumulative`` whose sum exceeds the lane's number, by bisection."""
    count = cumulative.shape[1]
    if count == 1:
        return np.zeros(len(row), dtype=np.intp)
    if len(cumulative) == 1:
        places = np.searchsorted(cumulative[0], numbers, side="right")
        return np.asarray(np.minimum(places, count - 1))
    low, high = np.zeros(len(row), dtype=np.intp), np.full(len(row), count - 1, dtype=np.intp)
    while (low < high).any():
        middle = (low + high) // 2
        above = cumulative[row, middle] > numbers
        high = np.where(above, middle, high)
        low = np.where(above, low, np.minimum(middle + 1, high))
    return low


@dataclass(frozen=True, slots=True, eq=False)
class Finite:
    """Axes whose cells are chosen together.

    Attributes:
        axes: their numbers ``(v,)``.
        lower: of each axis the lower ends of the cells that are left.
        upper: of each axis the upper ends.
        addresses: the addresses ``(k,)`` of the numbers by which the law chooses.
        law: chooses one cell of each axis.
        share: the share of the cube that the combinations of the law have.

    """

    axes: Cells
    lower: tuple[Floats, ...]
    upper: tuple[Floats, ...]
    addresses: Words
    law: FiniteLaw
    share: float

    @property
    def ends(self) -> tuple[Floats, Floats]:
        """The lowest and highest points of the axes, ``(v,)`` each."""
        return np.array([ends.min() for ends in self.lower]), np.array([ends.max() for ends in self.upper])

    def contains(self, points: Floats) -> NDArray[np.bool_]:
        """The mask ``(n,)`` of the points of the cube all of whose cells are among those that are left."""
        inside = np.ones(len(points), dtype=np.bool_)
        for axis, lower, upper in zip(self.axes.tolist(), self.lower, self.upper, strict=True):
            numbers = points[:, axis, np.newaxis]
            inside &= ((numbers >= lower) & (numbers <= upper)).any(axis=1)
        return inside

    def digest(self) -> bytes:
        """A digest of the part: equal digests choose equal cells."""
        digest = hashlib.sha256()
        for array in (self.axes, *self.lower, *self.upper, self.addresses, *self.law.arrays()):
            digest.update(np.ascontiguousarray(array).tobytes())
        return digest.digest()
