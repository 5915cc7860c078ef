"""Interval bounds of a node's value, over many boxes of the unit cube at a time."""

from typing import Any

import numpy as np
from numpy.typing import NDArray

from scenic.dataclass import dataclass

Floats = NDArray[np.float64]


@dataclass(frozen=True, slots=True, eq=False)
class Bounds:
    """Closed interval bounds ``lower <= value <= upper``, componentwise.

    Both arrays have the shape of a column of the node's kind with one row per box: ``(m,)`` for numbers and
    booleans (0 and 1), ``(m, 3)`` for vectors, ``(m, 4)`` for orientations. A row whose ``lower`` exceeds its ``upper``
    in any component is empty: no value of that box is possible.
    """

    lower: Floats
    upper: Floats

    @staticmethod
    def exactly(value: Any) -> "Bounds":
        """Bounds of a constant, for one box (broadcasts against others)."""
        array = np.asarray(value, dtype=np.float64)[np.newaxis]
        return Bounds(array, array)

    def empty(self) -> NDArray[np.bool_]:
        """The mask of the boxes that admit no value, shape ``(m,)``."""
        bad: NDArray[np.bool_] = np.logical_not(self.lower <= self.upper)
        return np.asarray(bad.reshape(len(bad), -1).any(axis=1))

    def meet(self, other: "Bounds") -> "Bounds":
        """The intersection."""
        return Bounds(np.maximum(self.lower, other.lower), np.minimum(self.upper, other.upper))

    def hull(self, other: "Bounds") -> "Bounds":
        """The smallest bounds that hold both."""
        return Bounds(np.minimum(self.lower, other.lower), np.maximum(self.upper, other.upper))


def outward(lower: Floats, upper: Floats, ulps: int = 1) -> Bounds:
    """Bounds widened by ``ulps`` units in the last place, to make up for rounding.

    One is enough after a correctly rounded operation (IEEE 754: the four operations, square root); library functions
    such as ``sin`` and ``ndtri`` get more.
    """
    for _ in range(ulps):
        lower = np.nextafter(lower, -np.inf)
        upper = np.nextafter(upper, np.inf)
    return Bounds(lower, upper)
