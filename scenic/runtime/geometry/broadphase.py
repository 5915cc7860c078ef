"""Quick tests of many pairs of oriented boxes: world boxes, then separating axes."""

from collections.abc import Iterator
from typing import Final

import numpy as np

from scenic.runtime.geometry.poses import Booleans, Floats, Indices, Poses
from scenic.runtime.geometry.ragged import rows

_CHUNK: Final = 1 << 14
"""Entries looked at together, so that the temporary columns stay in the processor's cache."""

_PARALLEL: Final = 1e-12
"""Added to the cosines between axes: keeps rounding from separating boxes by the product of parallel edges."""

_DENSE_BODIES: Final = 64
"""Bodies up to which every pair is looked at; above, the bodies are sorted and swept."""


def boxes_overlap(a: Poses, b: Poses) -> Booleans:
    """Whether the oriented boxes of two poses share a point, ``(n,)``; touching counts.

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
        chosen = entries[part]
        result[part] = _boxes_overlap(a.take(chosen), b.take(chosen), len(chosen))
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
        apart |= np.abs(t[i]) > ha[i] + (hb[0] * s[i][0] + hb[1] * s[i][1] + hb[2] * s[i][2])
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


def overlapping_pairs(lower: Floats, upper: Floats) -> Iterator[tuple[Indices, Indices, Indices]]:
    """All pairs of bodies whose world boxes share a point, lane by lane.

    Args:
        lower: lower corners, ``(3, bodies, lanes)``.
        upper: upper corners, likewise.

    Yields:
        (first body, second body, lane) as arrays of the same length, in several groups; the first body has
        the smaller number.

    """
    if lower.shape[1] <= _DENSE_BODIES:
        yield from _all_pairs(lower, upper)
    else:
        yield from _swept_pairs(lower, upper)


def _all_pairs(lower: Floats, upper: Floats) -> Iterator[tuple[Indices, Indices, Indices]]:
    for first in range(lower.shape[1] - 1):
        later = slice(first + 1, None)
        near = lower[0, later] <= upper[0, first]
        for axis in (0, 1):
            if axis:
                near &= lower[axis, later] <= upper[axis, first]
            near &= lower[axis, first] <= upper[axis, later]
        second, lane = _nonzero(near)
        second += first + 1
        level = (lower[2, second, lane] <= upper[2, first, lane]) & (
            lower[2, first, lane] <= upper[2, second, lane]
        )
        second, lane = second[level], lane[level]
        if len(lane):
            yield np.full(len(lane), first), second, lane


def _nonzero(mask: Booleans) -> tuple[Indices, Indices]:
    """Like ``np.nonzero`` of a contiguous matrix, which is slower."""
    flat = np.flatnonzero(mask)
    return np.divmod(flat, mask.shape[1])


def _swept_pairs(lower: Floats, upper: Floats) -> Iterator[tuple[Indices, Indices, Indices]]:
    """Each lane's bodies sorted along one axis; each is compared with those that begin before it ends."""
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
        if near.any():
            a, b = a[near], b[near]
            body_a, body_b = a // lanes, b // lanes
            yield np.minimum(body_a, body_b), np.maximum(body_a, body_b), a % lanes


def _sweep_axes(lower: Floats, upper: Floats) -> tuple[int, int]:
    """The horizontal axis on which bodies are smaller compared with their spread, and the other one."""
    crowding = [
        float(np.mean(upper[axis] - lower[axis])) / (float(np.ptp(lower[axis])) + 1e-300) for axis in (0, 1)
    ]
    return (0, 1) if crowding[0] <= crowding[1] else (1, 0)
