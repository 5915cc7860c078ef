"""Lines that are followed: signed distances, with a hint of where the car was before."""

import math
from bisect import bisect_right
from collections.abc import Sequence
from typing import Any, Final

import numpy as np
from numpy.typing import NDArray

from scenic.domains.driving.elements import LinearElement
from scenic.domains.driving.levels import Ground, Levels
from scenic.domains.driving.surfaces import GroundedLine
from scenic.runtime.geometry.flat.segments import Segments
from scenic.runtime.regions.lines import PolylineRegion

__all__ = ["FollowedLine", "concatenateCenterlines", "joined_ground"]

Floats = NDArray[np.float64]

_WINDOW: Final = 12
"""Segments on either side of the last nearest one that are looked at first."""


def concatenateCenterlines(centerlines: Sequence[Any] = ()) -> PolylineRegion:
    """Polylines joined in order, as one."""
    points: list[tuple[float, float]] = []
    for line in centerlines:
        for x, y, *_ in line.points:
            if not points or max(abs(points[-1][0] - x), abs(points[-1][1] - y)) > 1e-6:
                points.append((x, y))
    grounded_lines = [line for line in centerlines if isinstance(line, GroundedLine)]
    if not grounded_lines:
        return PolylineRegion(points)
    import shapely

    return GroundedLine(
        shapely.LineString(points), joined_ground(grounded_lines[0].ground.levels, grounded_lines)
    )


def joined_ground(levels: Levels, lines: Sequence[GroundedLine]) -> Ground:
    """Return the surface along several lines: that of the nearest one."""
    pieces = Segments(
        np.concatenate([line.pieces.starts for line in lines]),
        np.concatenate([line.pieces.ends for line in lines]),
    )
    roads = np.concatenate([line.ground.roads_at(line.pieces.starts) for line in lines])

    def roads_at(points: Floats) -> NDArray[np.intp]:
        places = np.array(points)
        places[:, 2] = 0
        found: NDArray[np.intp] = roads[pieces.nearest(places)[1]]
        return found

    return Ground(levels, roads_at, sorted(set(roads.tolist())))


class FollowedLine:
    """A chain of segments that something moves along.

    Args:
        parts: lanes, or polylines, end to end.

    Attributes:
        lengths: metres along the line to each of its points.
        progress: metres along the line to the place nearest to the last point asked about.

    """

    __slots__ = ("_hint", "_segments", "lengths", "progress")

    def __init__(self, *parts: Any) -> None:
        self._hint = 0
        points = np.concatenate([_vertices(part) for part in parts])
        steps = np.diff(points, axis=0)
        square = (steps**2).sum(axis=1)
        keep = square > 1e-12
        rows = np.column_stack((points[:-1], steps, square))[keep]
        self._segments: list[tuple[float, ...]] = [tuple(row) for row in rows.tolist()]
        self.lengths: list[float] = [0.0, *np.cumsum(np.sqrt(square[keep])).tolist()]
        self.progress = 0.0

    def _nearest(self, low: int, high: int, x: float, y: float) -> tuple[float, float, int]:
        """Return the squared distance from the nearest segment among some, the side (positive to its left), and its index."""
        best, side, where = math.inf, 0.0, low
        for index, (x0, y0, dx, dy, square) in enumerate(self._segments[low:high], low):
            a, b = x - x0, y - y0
            share = (a * dx + b * dy) / square
            share = 0.0 if share < 0.0 else min(share, 1.0)
            u, v = a - share * dx, b - share * dy
            away = u * u + v * v
            if away < best:
                best, side, where = away, dx * b - dy * a, index
        return best, side, where

    def signed_distance(self, point: Any) -> float:
        """The distance of a point from the line in metres, positive to the left of it; past its ends the line goes on straight.

        Only segments near the last nearest one are looked at, unless the point is farther away than these reach.
        """
        x, y, *_ = point
        count = len(self._segments)
        hint = self._hint
        # A point that moves by less than a segment in a step has one of these three nearest.
        low, high = max(0, hint - 1), min(count, hint + 2)
        best, side, where = self._nearest(low, high, x, y)
        if (where == low and low > 0) or (where == high - 1 and high < count):
            low, high = max(0, hint - _WINDOW), min(count, hint + _WINDOW + 1)
            best, side, where = self._nearest(low, high, x, y)
        if (where == low and low > 0) or (where == high - 1 and high < count) or best > 100.0:
            best, side, where = self._nearest(0, count, x, y)
        self._hint = where
        x0, y0, dx, dy, square = self._segments[where]
        share = ((x - x0) * dx + (y - y0) * dy) / square
        self.progress = self.lengths[where] + math.sqrt(square) * (0.0 if share < 0.0 else min(share, 1.0))
        if (share < 0.0 and where == 0) or (share > 1.0 and where == count - 1):
            return side / math.sqrt(square)
        distance = math.sqrt(best)
        return distance if side >= 0 else -distance

    def ahead(self, distance: float) -> tuple[float, float]:
        """The place on the line a distance in metres beyond `progress`; beyond its ends the line is continued straight.

        A negative distance looks against the direction of the line.
        """
        along = self.progress + distance
        index = min(max(bisect_right(self.lengths, along) - 1, 0), len(self._segments) - 1)
        x0, y0, dx, dy, square = self._segments[index]
        share = (along - self.lengths[index]) / math.sqrt(square)
        return x0 + share * dx, y0 + share * dy


def _vertices(part: Any) -> Floats:
    if isinstance(part, LinearElement):
        return part.line
    return np.array([point[:2] for point in part.points])
