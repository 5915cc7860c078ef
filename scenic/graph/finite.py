"""Discrete values that are drawn together, so that requirements which couple them hold.

An axis of the cube below a discrete value falls into *cells*, on each of which the value is the same. A `Finite` part of a
domain chooses the cells of some axes jointly, by a `Law` over combinations of cells. The number of an axis is then any
number of the cell, so that nothing else of the graph has to know.
"""

import hashlib
from collections.abc import Sequence
from typing import Protocol

import numpy as np
from numpy.typing import NDArray

from scenic.dataclass import dataclass
from scenic.graph.draws import Floats, Words

__all__ = ["Distinct", "Finite", "Law", "Listed", "Sequential", "Step"]

Cells = NDArray[np.intp]


class Law(Protocol):
    """A law over combinations of cells, one of each variable."""

    @property
    def numbers(self) -> int:
        """The number of uniform numbers that choose a combination."""

    def choose(self, draws: Floats) -> Cells:
        """The combinations ``(variables, n)`` that uniform numbers ``(numbers, n)`` choose."""

    def arrays(self) -> Sequence[NDArray[np.generic]]:
        """The arrays that the law is made of, for digests."""


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
class Step:
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

    steps: tuple[Step, ...]
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
    """Variables of which no two have values of one *label*: seats, slots, numbers that differ.

    Attributes:
        labels: of each variable the labels of its values, each below ``width``.
        weights: of each variable the weights of its values.
        completions: for each set of used labels, as bits, the weight of all choices of the variables that are left: as many
            have been chosen as labels are used.

    """

    labels: tuple[Cells, ...]
    weights: tuple[Floats, ...]
    completions: Floats

    @property
    def numbers(self) -> int:
        return len(self.labels)

    def choose(self, draws: Floats) -> Cells:
        used = np.zeros(draws.shape[1], dtype=np.int64)
        result = np.empty((len(self.labels), draws.shape[1]), dtype=np.intp)
        for place, (labels, weights, numbers) in enumerate(
            zip(self.labels, self.weights, draws, strict=True)
        ):
            bits = np.int64(1) << labels.astype(np.int64)
            free = (used[:, np.newaxis] & bits) == 0
            after = self.completions[used[:, np.newaxis] | bits]
            cumulative = np.cumsum(np.where(free, weights * after, 0.0), axis=1)
            limit = numbers * cumulative[:, -1]
            # The first value whose sum exceeds the limit: never one of weight zero.
            found = np.minimum((cumulative <= limit[:, np.newaxis]).sum(axis=1), len(labels) - 1)
            result[place] = found
            used |= bits[found]
        return result

    def arrays(self) -> Sequence[NDArray[np.generic]]:
        return [*self.labels, *self.weights]


def _search(cumulative: Floats, row: Cells, numbers: Floats) -> Cells:
    """The first place in each lane's row of ``cumulative`` whose sum exceeds the lane's number, by bisection."""
    count = cumulative.shape[1]
    if count == 1:
        return np.zeros(len(row), dtype=np.intp)
    if len(cumulative) == 1:
        found = np.searchsorted(cumulative[0], numbers, side="right")
        return np.asarray(np.minimum(found, count - 1))
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
    law: Law
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
