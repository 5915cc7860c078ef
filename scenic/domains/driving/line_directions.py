"""Directions and shares of length along polylines."""

from typing import Any

import numpy as np
from numpy.typing import NDArray

__all__ = ["Segments", "share_along"]

Floats = NDArray[np.float64]


class Segments:
    """The segments of a line ``(n, 2)``, and which is nearest to a place."""

    __slots__ = ("delta", "heading", "square", "starts")

    def __init__(self, line: Floats) -> None:
        self.starts = line[:-1]
        self.delta = np.diff(line, axis=0)
        self.square = np.maximum((self.delta**2).sum(axis=1), 1e-18)
        self.heading = np.arctan2(-self.delta[:, 0], self.delta[:, 1])

    def nearest(self, places: Floats) -> NDArray[np.intp]:
        """Index of the nearest segment of each place, ``(n,)``."""
        result = np.empty(len(places), dtype=np.intp)
        block = max(1, 1_000_000 // len(self.starts))
        for start in range(0, len(places), block):
            some = places[start : start + block, None] - self.starts
            share = np.clip((some * self.delta).sum(axis=-1) / self.square, 0, 1)
            away = some - share[..., None] * self.delta
            result[start : start + block] = (away**2).sum(axis=-1).argmin(axis=1)
        return result

    def headings(self, places: Floats) -> Floats:
        """Heading of the nearest segment of each place, ``(n,)``."""
        return np.asarray(self.heading[self.nearest(places)])


def share_along(line: Floats, point: Any) -> float:
    """The share of a line's length at the place nearest to a point."""
    import shapely

    string = shapely.linestrings(line)
    x, y, *_ = point.position if hasattr(point, "position") else point
    return float(string.project(shapely.Point(x, y), normalized=True))
