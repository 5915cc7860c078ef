"""Points of the unit cube that are chosen, not hashed: by a low-discrepancy sequence, or by the caller.

Scene ``k`` is made of row ``k``: the number of a draw is that of the draw's *dimension*. Which dimension that is, whoever
samples decides (`scenic.runtime.sampling.point_set_draws`).
"""

from typing import Any, Final, Protocol

import numpy as np
from numpy.typing import ArrayLike, NDArray

from scenic.graph.draws import Floats, LaneOwners, Words, mix, open_unit

__all__ = ["GivenPoints", "PointSet", "Sobol"]


class PointSet(Protocol):
    """Rows of numbers of the open unit interval, one for each scene."""

    @property
    def retries(self) -> bool:
        """Return whether a row has other numbers for a scene whose first ones do not meet the requirements."""

    def of_scenes(self, axes: NDArray[np.intp], count: int, lanes: LaneOwners) -> Floats:
        """The numbers ``(axes, lanes)`` of some of a program's ``count`` axes; NaN where a row has none, which are hashed.

        Axis -1 is none of them: it chooses among the boxes that analysis leaves of the cube (where it leaves a product of unions, among
        those of the first; the other choices are hashed).
        """

    def of_simulations(self, draws: NDArray[np.intp], count: int, lanes: LaneOwners) -> Floats:
        """The numbers ``(draws, lanes)`` of draws in simulations of scenes with ``count`` axes.

        The attempt of a lane is that at a simulation of its scene.
        """


_BITS: Final = 20
"""Bits of a Sobol number that identify its row: this many bits of rows form one sequence, later rows form others."""

_DIMENSIONS: Final = 21201
"""The dimensions for which Joe and Kuo give direction numbers."""

_FIRST_DIMENSIONS: Final = 64
_FIRST_BITS: Final = 10
"""Dimensions and bits of the direction numbers that are made at once; more are made on demand."""

_DRAWS: Final = 512
"""Draws of a simulation that have dimensions of their own."""

_CHUNK: Final = 1 << 16
"""Numbers that are scrambled at a time, times bits."""


class Sobol:
    """Rows of a Sobol sequence, which fill the cube more evenly than random points.

    Scene ``k`` is made of row ``k`` of a scrambled sequence of many dimensions: those of the first candidate come first, then those
    of the second, should the first not meet the requirements, and so on; the first 512 draws of a simulation have others. What
    comes after all 21,201 dimensions is hashed. The scrambling, by the seed, is nested (Owen, "Randomly permuted (t,m,s)-nets
    and (t,s)-sequences", 1995): each scene alone follows the program's distribution, and depends on seed and number alone.

    Direction numbers are those of SciPy (Joe and Kuo, "Constructing Sobol sequences with better two-dimensional
    projections", 2008). Every 2**20 rows another sequence begins.
    """

    retries = True

    def __init__(self) -> None:
        # SciPy's numbers take long to import: they are here before the first scene.
        self._directions: Words = _directions(_FIRST_DIMENSIONS, _FIRST_BITS)

    def __repr__(self) -> str:
        return "Sobol()"

    def of_scenes(self, axes: NDArray[np.intp], count: int, lanes: LaneOwners) -> Floats:
        """See `PointSet`; scenes have the even dimensions."""
        return self._numbers(2 * ((count + 1) * lanes.attempts + (axes + 1)[:, np.newaxis]), lanes)

    def of_simulations(self, draws: NDArray[np.intp], count: int, lanes: LaneOwners) -> Floats:
        """See `PointSet`; simulations have the odd dimensions."""
        places = np.where(draws < _DRAWS, draws, _DIMENSIONS)[:, np.newaxis]
        return self._numbers(2 * (_DRAWS * lanes.attempts + places) + 1, lanes)

    def _numbers(self, dimensions: NDArray[np.intp], lanes: LaneOwners) -> Floats:
        """The numbers of dimensions ``(m, n)``."""
        has_directions = dimensions < _DIMENSIONS
        dimensions = np.where(has_directions, dimensions, 0)
        rows = lanes.scenes.astype(np.uint64)
        places = rows & np.uint64((1 << _BITS) - 1)
        gray = places ^ (places >> np.uint64(1))
        bits = int(gray.max(initial=0)).bit_length()
        directions = self._directions_of(int(dimensions.max(initial=0)) + 1, bits)
        points = np.zeros(dimensions.shape, dtype=np.uint64)
        for bit in range(bits):
            bit_mask = (gray >> np.uint64(bit)) & np.uint64(1)
            points ^= directions[bit][dimensions] * bit_mask
        keys = mix(mix(lanes.seeds ^ (rows >> np.uint64(_BITS))) + mix(dimensions.astype(np.uint64)))
        return np.where(has_directions, open_unit(_scrambled(points, keys)), np.nan)

    def _directions_of(self, dimensions: int, bits: int) -> Words:
        """Direction numbers ``(bits, dimensions)``: what row 2**bit - 1 and row 2**bit differ by."""
        known_bits, known = self._directions.shape
        if dimensions > known or bits > known_bits:
            wanted = min(_DIMENSIONS, max(known, 1 << (dimensions - 1).bit_length()))
            self._directions = _directions(wanted, max(bits, known_bits))
        return self._directions


def _directions(dimensions: int, bits: int) -> Words:
    from scipy.stats import qmc  # takes long to import

    sequence: Any = qmc.Sobol(dimensions, scramble=False, bits=_BITS)
    result = np.zeros((bits, dimensions), dtype=np.uint64)
    count = 0
    for bit in range(bits):
        sequence.fast_forward((1 << bit) - count)
        count = (1 << bit) + 1
        # Rows are in the order of Gray's code: row 2**bit - 1 is the direction before, row 2**bit that and the next.
        row = (sequence.random(1)[0] * (1 << _BITS)).astype(np.uint64)
        result[bit] = row ^ (result[bit - 1] if bit else np.uint64(0))
    return result


def _scrambled(points: Words, keys: Words) -> Words:
    """Random words ``(m, n)`` for points of ``_BITS`` bits: each bit is turned or not by a hash of the bits before it."""
    one, word = np.uint64(1), np.zeros_like(points)
    levels = np.arange(_BITS, dtype=np.uint64)
    for some in np.array_split(levels, max(1, min(_BITS, points.size * _BITS // _CHUNK))):
        level = some[:, np.newaxis, np.newaxis]
        before = (points >> (np.uint64(_BITS) - level)) | (one << level)
        flips = mix(keys ^ mix(before)) >> np.uint64(63)
        digit = (points >> (np.uint64(_BITS - 1) - level)) & one
        word |= np.bitwise_or.reduce((digit ^ flips) << (np.uint64(63) - level), axis=0)
    # Below the last bit all is random.
    rest: Words = mix(keys ^ mix(points | np.uint64(1 << _BITS))) >> np.uint64(_BITS)
    return word | rest


class GivenPoints:
    """Rows given by the caller, such as an optimiser: scene ``k`` is made from row ``k``, or not at all.

    Args:
        rows: numbers ``(n, d)`` of the open unit interval, one row for each scene. The first columns are those of
            `scenic.Scenario.axes`; further ones are for the draws of a simulation, in order. Numbers that are not given are hashed.

    Raises:
        ValueError: numbers that lie elsewhere, or rows of different lengths.

    """

    retries = False

    def __init__(self, rows: ArrayLike) -> None:
        given = np.array(rows, dtype=np.float64)
        if given.ndim < 2:  # one row; no numbers at all are no row
            given = given.reshape(min(given.size, 1), given.size)
        if given.ndim != 2 or not ((given > 0) & (given < 1)).all():
            raise ValueError("points of the unit cube are rows of numbers between 0 and 1, both excluded")
        self._width = given.shape[1]
        self._rows = np.column_stack([given, np.full(len(given), np.nan)])
        """The rows, and what stands for a number that they do not give."""

    def __len__(self) -> int:
        return len(self._rows)

    def __repr__(self) -> str:
        return f"GivenPoints({len(self)} rows of {self._width})"

    def of_scenes(self, axes: NDArray[np.intp], count: int, lanes: LaneOwners) -> Floats:
        """See `PointSet`; ``IndexError`` for a scene without a row."""
        return self._numbers(np.where(axes < count, axes, -1), lanes)

    def of_simulations(self, draws: NDArray[np.intp], count: int, lanes: LaneOwners) -> Floats:
        """See `PointSet`; ``IndexError`` for a scene without a row."""
        return self._numbers(draws + count, lanes)

    def _numbers(self, columns: NDArray[np.intp], lanes: LaneOwners) -> Floats:
        if len(lanes.scenes) and int(lanes.scenes.max()) >= len(self):
            raise IndexError(
                f"there is no row for scene {int(lanes.scenes.max())}: {len(self)} rows are given"
            )
        known = (columns >= 0) & (columns < self._width)
        places = np.where(known, columns, self._width)
        return np.ascontiguousarray(self._rows[lanes.scenes[:, np.newaxis], places].T)
