"""Quick tests of many pairs of oriented boxes: world boxes, then separating axes."""

from collections.abc import Iterator
from typing import Final, TypeAlias

import numpy as np
import numpy.typing as npt

from scenic.dataclass import dataclass
from scenic.runtime.geometry.poses import Booleans, Floats, Indices, Poses
from scenic.runtime.geometry.ragged import rows

Cells: TypeAlias = npt.NDArray[np.uint8]

_CHUNK: Final = 1 << 14
"""Entries looked at together, so that the temporary columns stay in the processor's cache."""

_PARALLEL: Final = 1e-12
"""Added to the cosines between axes: keeps rounding from separating boxes by the product of parallel edges."""

_WORD: Final = 8
"""Lanes that are looked at in one word."""

_BLOCK: Final = 1 << 16
"""Combinations of two bodies and a lane looked at together, a byte each, so that they stay in the cache."""

_SWEPT: Final = 400
"""Moving bodies above which they are sorted and swept instead of each compared with each."""

_SAMPLE: Final = 256
"""Points from which the cells are laid out, at most."""

_SPREAD: Final = 2.5
"""Standard deviations from the mean that the cells cover; what lies beyond is in the outermost ones."""


def boxes_overlap(a: Poses, b: Poses) -> Booleans:
    """Return whether the oriented boxes of two poses share a point, ``(n,)``; touching counts.

    The separating axis test of Gottschalk, Lin and Manocha ("OBBTree", SIGGRAPH 1996): two boxes are apart
    exactly if their projections are apart on a face normal of one of them, or on the cross product of an edge
    of each.
    """
    count = max(len(a), len(b))
    if count <= _CHUNK:
        return _boxes_overlap(a, b, count)
    result = np.empty(count, dtype=np.bool_)
    entries = np.arange(count)
    for part in rows(count, 1, _CHUNK):
        entries_here = entries[part]
        result[part] = _boxes_overlap(a.take(entries_here), b.take(entries_here), len(entries_here))
    return result


def _boxes_overlap(a: Poses, b: Poses, count: int) -> Booleans:
    ma, mb = a.matrix, b.matrix
    ha = [0.5 * a.size[:, i] for i in range(3)]
    hb = [0.5 * b.size[:, i] for i in range(3)]
    d = [b.position[:, i] - a.position[:, i] for i in range(3)]
    t = [ma[:, 0, i] * d[0] + ma[:, 1, i] * d[1] + ma[:, 2, i] * d[2] for i in range(3)]
    r = [
        [ma[:, 0, i] * mb[:, 0, j] + ma[:, 1, i] * mb[:, 1, j] + ma[:, 2, i] * mb[:, 2, j] for j in range(3)]
        for i in range(3)
    ]
    s = [[np.abs(r[i][j]) for j in range(3)] for i in range(3)]
    apart = np.zeros(count, dtype=np.bool_)
    for i in range(3):
        # Negated, so that what is not a number is apart.
        apart |= ~(np.abs(t[i]) <= ha[i] + (hb[0] * s[i][0] + hb[1] * s[i][1] + hb[2] * s[i][2]))
    for j in range(3):
        apart |= np.abs(t[0] * r[0][j] + t[1] * r[1][j] + t[2] * r[2][j]) > hb[j] + (
            ha[0] * s[0][j] + ha[1] * s[1][j] + ha[2] * s[2][j]
        )
    s = [[s[i][j] + _PARALLEL for j in range(3)] for i in range(3)]
    for i in range(3):
        k, m = (i + 1) % 3, (i + 2) % 3
        for j in range(3):
            u, v = (j + 1) % 3, (j + 2) % 3
            reach = ha[k] * s[m][j] + ha[m] * s[k][j] + (hb[u] * s[i][v] + hb[v] * s[i][u])
            apart |= np.abs(t[m] * r[k][j] - t[k] * r[m][j]) > reach
    return ~apart


@dataclass(frozen=True, slots=True)
class CellMap:
    """A map of the world to 256 cells on each axis; what lies outside is in the outermost cells.

    The map is monotonic, so boxes that share a point also do so in cells, wherever the cells are. What is not a
    number is in some cell.

    Attributes:
        origin: the lower end of the cells, ``(3,)``.
        scale: cells per metre, ``(3,)``.

    """

    origin: Floats
    scale: Floats

    @classmethod
    def around(cls, points: Floats) -> "CellMap":
        """Return the map whose cells cover the region where most of the points ``(n, 3)`` are."""
        points = points[:: len(points) // _SAMPLE + 1]
        points = points[np.isfinite(points).all(axis=1)]
        if not len(points):
            return cls(np.zeros(3), np.ones(3))
        middle, spread = points.mean(axis=0), _SPREAD * points.std(axis=0)
        spread = np.where(np.isfinite(spread) & (spread > 1e-100), spread, 1.0)
        return cls(middle - spread, 128 / spread)

    def put(self, corners: Floats, out: Cells) -> None:
        """Write the cells of points ``(bodies, lanes, 3)`` into ``(3, bodies, lanes)``."""
        with np.errstate(invalid="ignore", over="ignore"):
            for axis in range(3):
                place = (corners[..., axis] - self.origin[axis]) * self.scale[axis]
                np.fmin(np.fmax(place, 0, out=place), 255, out=place)
                out[axis] = place


def near_pairs(lower: Cells, upper: Cells, moving: int) -> Iterator[tuple[Indices, Indices, Indices]]:
    """All pairs of bodies whose boxes share a cell, lane by lane, but for pairs of two fixed ones.

    Args:
        lower: cells of lower corners, ``(3, bodies, lanes)``, the lanes a multiple of 8.
        upper: cells of upper corners, likewise.
        moving: the number of bodies that are not fixed; they come first.

    Yields:
        (first body, second body, lane) as arrays of the same length, in several groups; the first body has
        the smaller number.

    """
    if moving > _SWEPT:
        yield from _swept_pairs(lower, upper, moving)
    else:
        yield from _all_pairs(lower, upper, moving)


def _all_pairs(lower: Cells, upper: Cells, moving: int) -> Iterator[tuple[Indices, Indices, Indices]]:
    """Each moving body, or a few of them at a time, beside all that come after."""
    bodies, lanes = lower.shape[1:]
    first = 0
    # Written into over and over: fresh arrays of this size would cost more than the comparisons.
    buffers = np.empty((2, max(_BLOCK, (bodies - 1) * lanes)), dtype=np.bool_)
    while first < min(moving, bodies - 1):
        later = bodies - first - 1
        step = int(np.clip(_BLOCK // (later * lanes), 1, moving - first))
        some, others = slice(first, first + step), slice(first + 1, None)
        near, beside = buffers[:, : step * later * lanes].reshape(2, step, later, lanes)
        np.less_equal(lower[0, None, others], upper[0, some, None], out=near)
        for axis in range(3):
            if axis:
                np.less_equal(lower[axis, None, others], upper[axis, some, None], out=beside)
                near &= beside
            np.greater_equal(upper[axis, None, others], lower[axis, some, None], out=beside)
            near &= beside
        flat = _where(near.reshape(-1))
        if len(flat):
            row, lane = np.divmod(flat, lanes)
            one, two = np.divmod(row, later)
            if step > 1:
                after = (
                    two >= one
                )  # the block also holds its bodies' pairs with themselves and the other way round
                one, two, lane = one[after], two[after], lane[after]
            yield first + one, first + 1 + two, lane
        first += step


def _where(mask: Booleans) -> Indices:
    """Return ``np.flatnonzero`` of a mask whose length is a multiple of 8; this is faster if the mask is long and nearly empty."""
    words = np.flatnonzero(mask.view(np.uint64) != 0)
    found = np.flatnonzero(mask.reshape(-1, _WORD)[words])
    result: Indices = words[found // _WORD] * _WORD + found % _WORD
    return result


def _swept_pairs(lower: Cells, upper: Cells, moving: int) -> Iterator[tuple[Indices, Indices, Indices]]:
    """Yield pairs of bodies that overlap along one axis.

    Each lane's bodies are sorted along the axis; each is compared with those that begin before it ends.
    """
    bodies, lanes = lower.shape[1:]
    along, other = _sweep_axes(lower, upper)
    order = np.argsort(lower[along], axis=0, kind="stable")
    low, high = (np.take_along_axis(corner[along], order, axis=0).ravel() for corner in (lower, upper))
    flat = (order * lanes + np.arange(lanes)).ravel()  # where each sorted body is in the rows of corners
    low_other, high_other = lower[other].ravel(), upper[other].ravel()
    low_z, high_z = lower[2].ravel(), upper[2].ravel()
    active = np.arange((bodies - 1) * lanes)
    for distance in range(1, bodies):
        active = active[active < (bodies - distance) * lanes]
        active = active[low[active + distance * lanes] <= high[active]]
        if not len(active):
            return
        a, b = flat[active], flat[active + distance * lanes]
        near = (low_other[a] <= high_other[b]) & (low_other[b] <= high_other[a])
        near &= (low_z[a] <= high_z[b]) & (low_z[b] <= high_z[a])
        near &= np.minimum(a, b) < moving * lanes
        if near.any():
            a, b = a[near], b[near]
            body_a, body_b = a // lanes, b // lanes
            yield np.minimum(body_a, body_b), np.maximum(body_a, body_b), a % lanes


def _sweep_axes(lower: Cells, upper: Cells) -> tuple[int, int]:
    """Return the horizontal axis on which bodies are smaller compared with their spread, and the other one."""
    crowding = [
        float(np.mean(upper[axis] - lower[axis])) / (float(np.std(lower[axis])) + 1e-300) for axis in (0, 1)
    ]
    return (0, 1) if crowding[0] <= crowding[1] else (1, 0)
