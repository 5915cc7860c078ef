"""How deep convex solids are in each other."""

from typing import Final

import numpy as np

from scenic.runtime.geometry.poses import Floats

__all__ = ["convex_depth"]

_ROUNDING: Final = 1e-9
"""Of the size of the solids: by less two planes do not differ."""


def convex_depth(first: Floats, second: Floats) -> float:
    """The length of the shortest way by which one of two convex solids that meet leaves the other, metres.

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
