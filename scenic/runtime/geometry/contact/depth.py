"""Depth to which one pair of convex solids are in each other, or their distance, without trees of their faces."""

from typing import Final

import numpy as np

from scenic.runtime.geometry.poses import Floats

__all__ = ["convex_depth", "convex_gap"]

_ROUNDING: Final = 1e-9
"""Of the size of the solids: by less two planes do not differ."""
_EXACT: Final = 1e-12
"""Of the size of the solids: by so much a gap may be too large."""
_ROUNDS: Final = 500


def convex_depth(first: Floats, second: Floats) -> float:
    """Return the length of the shortest way by which one of two convex solids that meet leaves the other, metres.

    It is the distance from the origin to the surface of the differences of their points. An inner polytope of that solid grows
    where it comes nearest to the origin until it has the true face there (van den Bergen, "Proximity queries and penetration depth
    computation on 3D game objects", 2001); so all pairs of corners need not be looked at.

    Args:
        first: corners, ``(n, 3)``, metres.
        second: corners of the other, ``(m, 3)``.

    """
    from scipy.spatial import ConvexHull, QhullError  # slow to import

    def farthest(way: Floats) -> Floats:
        difference: Floats = first[np.argmax(first @ way)] - second[np.argmin(second @ way)]
        return difference

    ways = np.array(
        [(x, y, z) for x in (-1, 0, 1) for y in (-1, 0, 1) for z in (-1, 0, 1) if x or y or z], float
    )
    size = float(np.ptp(first, axis=0).max() + np.ptp(second, axis=0).max())
    try:
        inner = ConvexHull(np.array([farthest(way) for way in ways]), incremental=True)
    except QhullError:  # both lie in one plane, as far as numbers tell
        return 0.0
    reach = 0.0
    # Each round adds another corner, of which there are at most so many.
    for _ in range(len(first) * len(second)):
        *normal, offset = inner.equations[np.argmax(inner.equations[:, 3])]
        way = np.array(normal)
        corner = farthest(way)
        reach = float(corner @ way)
        if reach + offset <= _ROUNDING * size:
            break
        inner.add_points(corner[np.newaxis])
    inner.close()
    return max(0.0, reach)


def convex_gap(first: Floats, second: Floats) -> float:
    """The least distance between points of two convex solids that do not meet, metres.

    It is the norm of the least of the differences of their points, which Wolfe's method finds ("Finding the nearest point in a
    polytope", 1976): a simplex of differences moves to where it comes nearest to the origin, by one corner at a time.

    Args:
        first: corners, ``(n, 3)``, metres.
        second: corners of the other, ``(m, 3)``.

    """
    size = float(np.abs(first - second[0]).max() + np.ptp(second, axis=0).max())
    simplex = (first[0] - second[0])[np.newaxis]
    weights = np.ones(1)
    nearest = simplex[0]
    for _ in range(_ROUNDS):
        square = float(nearest @ nearest)
        corner = first[np.argmin(first @ nearest)] - second[np.argmax(second @ nearest)]
        # What is left is at most that much nearer.
        if square - float(corner @ nearest) <= _EXACT * size * np.sqrt(square):
            break
        if (simplex == corner).all(axis=1).any():
            break
        simplex, weights = _nearest_in(np.vstack([simplex, corner]), np.append(weights, 0.0))
        nearest = weights @ simplex
    return float(np.sqrt(nearest @ nearest))


def _nearest_in(simplex: Floats, weights: Floats) -> tuple[Floats, Floats]:
    """Return the corners that hold a simplex's point nearest to the origin, and its weights, from those of another point."""
    while True:
        new_weights = _nearest_in_plane(simplex)
        if (new_weights > 0).all():
            return simplex, new_weights
        # As far as the simplex goes towards it; there a corner counts no more.
        falling = new_weights <= 0
        fall = np.maximum(weights[falling] - new_weights[falling], np.finfo(float).tiny)
        share = float((weights[falling] / fall).min(initial=1.0))
        weights = weights + share * (new_weights - weights)
        weights[falling & (weights <= weights[falling].min())] = 0.0
        left = weights > 0
        simplex, weights = simplex[left], weights[left]


def _nearest_in_plane(simplex: Floats) -> Floats:
    """The weights of the point nearest to the origin in the plane through points ``(k, 3)``; they add up to 1."""
    base = simplex[0]
    edges = simplex[1:] - base
    if not len(edges):
        return np.ones(1)
    shares = np.linalg.lstsq(edges.T, -base, rcond=None)[0]
    return np.append(1.0 - shares.sum(), shares)
