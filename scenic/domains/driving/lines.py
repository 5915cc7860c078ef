"""Lines that are followed: signed distances, with a hint of where the car was before."""

from collections.abc import Sequence
from typing import Any, Final

import numpy as np
from numpy.typing import NDArray

from scenic.domains.driving.elements import LinearElement
from scenic.runtime.regions.lines import PolylineRegion

__all__ = ["FollowedLine", "concatenateCenterlines"]

Floats = NDArray[np.float64]

_WINDOW: Final = 12
"""Segments on either side of the last nearest one that are looked at first."""


def concatenateCenterlines(centerlines: Sequence[Any] = ()) -> PolylineRegion:
    """Polylines joined in order, as one."""
    points: list[tuple[float, float, float]] = []
    for line in centerlines:
        for point in line.points:
            if not points or max(abs(a - b) for a, b in zip(points[-1], point, strict=True)) > 1e-6:
                points.append(point)
    return PolylineRegion(points)


class FollowedLine:
    """A chain of segments that something moves along.

    Args:
        parts: lanes, or polylines, end to end.

    """

    __slots__ = ("_dx", "_dy", "_hint", "_square", "_x", "_y")

    def __init__(self, *parts: Any) -> None:
        self._hint = 0
        self._take(np.concatenate([_vertices(part) for part in parts]))

    def _take(self, points: Floats) -> None:
        steps = np.diff(points, axis=0)
        keep = (steps**2).sum(axis=1) > 1e-12
        starts, steps = points[:-1][keep], steps[keep]
        self._x, self._y = starts[:, 0].tolist(), starts[:, 1].tolist()
        self._dx, self._dy = steps[:, 0].tolist(), steps[:, 1].tolist()
        self._square = (steps**2).sum(axis=1).tolist()

    def _away(self, index: int, x: float, y: float) -> tuple[float, float]:
        """Squared distance from a segment, and the side: positive to its left."""
        a, b = x - self._x[index], y - self._y[index]
        dx, dy = self._dx[index], self._dy[index]
        share = (a * dx + b * dy) / self._square[index]
        share = 0.0 if share < 0 else min(share, 1.0)
        u, v = a - share * dx, b - share * dy
        return u * u + v * v, dx * b - dy * a

    def signed_distance(self, point: Any) -> float:
        """The distance of a point from the line in metres, positive to the left of it.

        Only segments near the last nearest one are looked at, unless the point is farther away than these reach.
        """
        x, y, *_ = point
        count = len(self._x)
        low, high = max(0, self._hint - _WINDOW), min(count, self._hint + _WINDOW + 1)
        best, side, where = float("inf"), 0.0, self._hint
        for index in range(low, high):
            square, turn = self._away(index, x, y)
            if square < best:
                best, side, where = square, turn, index
        if (where == low and low > 0) or (where == high - 1 and high < count) or best > 100.0:
            for index in range(count):
                square, turn = self._away(index, x, y)
                if square < best:
                    best, side, where = square, turn, index
        self._hint = where
        distance: float = best**0.5
        return distance if side >= 0 else -distance


def _vertices(part: Any) -> Floats:
    if isinstance(part, LinearElement):
        return part.line
    return np.array([point[:2] for point in part.points])
