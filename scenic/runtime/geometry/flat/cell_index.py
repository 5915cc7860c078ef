"""The polygon, among many, that holds a point: by a grid of bins over their boxes."""

import math
from collections.abc import Sequence
from functools import cached_property
from typing import Final

import numpy as np

from scenic.runtime.geometry.poses import Floats, Indices
from scenic.runtime.geometry.ragged import expand, group_starts, pieces

_BINS_PER_POLYGON: Final = 2.0
_MOST_BINS: Final = 1 << 20
_PAIRS: Final = 1 << 18
"""Pairs of a point and a polygon that are tested at a time."""


class CellIndex:
    """Polygons of the plane, in order.

    Each bin lists the polygons whose boxes reach into it; a point is tested against those of its bin alone.

    Args:
        polygons: shapely's polygons or multipolygons.

    """

    def __init__(self, polygons: Sequence[object]) -> None:
        import shapely

        self._polygons = np.array(polygons, dtype=object)
        shapely.prepare(self._polygons)
        boxes = shapely.bounds(self._polygons).reshape(-1, 4)
        self._known = np.flatnonzero(np.isfinite(boxes).all(axis=1))
        boxes = boxes[self._known]
        if not len(boxes):
            boxes = np.zeros((0, 4))
        self._low = boxes[:, :2].min(axis=0, initial=np.inf) if len(boxes) else np.zeros(2)
        high = boxes[:, 2:].max(axis=0) if len(boxes) else np.zeros(2)
        extent = np.maximum(high - self._low, 1e-9)
        # About so many square bins in all; long thin maps get long thin grids.
        cell_count = min(max(len(boxes) * _BINS_PER_POLYGON, 1.0), _MOST_BINS)
        edge = np.sqrt(extent[0] * extent[1] / cell_count)
        edge = max(edge, extent.max() / _MOST_BINS**0.5, 1e-9)
        self._shape = np.maximum(np.ceil(extent / edge).astype(np.int64), 1)
        self._edge = extent / self._shape
        first, last = self._bins(boxes[:, :2]), self._bins(boxes[:, 2:])
        spans = last - first + 1
        owner, place = expand(spans[:, 0] * spans[:, 1])
        column, row = place // spans[owner, 1], place % spans[owner, 1]
        number = (first[owner, 0] + column) * self._shape[1] + first[owner, 1] + row
        # Sorted by bin; within one the order of the polygons stays.
        order = np.argsort(number, kind="stable")
        self._members: Indices = self._known[owner[order]]
        self._starts: Indices = group_starts(number[order], int(self._shape.prod()))

    def _bins(self, points: Floats) -> Indices:
        """The bins of points ``(n, 2)``; those outside are put into the nearest."""
        place = np.floor((points - self._low) / self._edge)
        clipped: Indices = np.clip(place, 0, self._shape - 1).astype(np.int64)
        return clipped

    def first_at(self, x: Floats, y: Floats) -> Indices:
        """Return the first polygon that holds each point ``(n,)``, edge included; the number of polygons where none does."""
        import shapely

        result = np.full(len(x), len(self._polygons), dtype=np.intp)
        sound = np.flatnonzero(np.isfinite(x) & np.isfinite(y))
        bins = self._bins(np.stack([x[sound], y[sound]], axis=-1))
        number = bins[:, 0] * self._shape[1] + bins[:, 1]
        starts = self._starts[number]
        counts = self._starts[number + 1] - starts
        for part in pieces(counts, _PAIRS):
            owner, place = expand(counts[part])
            polygon, point = self._members[starts[part][owner] + place], sound[part][owner]
            is_inside = shapely.intersects_xy(self._polygons[polygon], x[point], y[point])
            np.minimum.at(result, point[is_inside], polygon[is_inside])
        return result

    def first_of(self, x: float, y: float) -> int:
        """As `first_at`, of one point."""
        import shapely

        none = len(self._polygons)
        if not (math.isfinite(x) and math.isfinite(y)):
            return none
        low_x, low_y, width, height, columns, rows = self._grid
        column = min(max(math.floor((x - low_x) / width), 0), columns - 1)
        number = column * rows + min(max(math.floor((y - low_y) / height), 0), rows - 1)
        members = self._members[self._starts[number] : self._starts[number + 1]]
        holders = members[shapely.intersects_xy(self._polygons[members], x, y)]
        return int(holders[0]) if len(holders) else none

    @cached_property
    def _grid(self) -> tuple[float, float, float, float, int, int]:
        """The grid on plain numbers: its corner, the size of a bin, and the numbers of columns and rows."""
        low_x, low_y = self._low.tolist()
        width, height = self._edge.tolist()
        columns, rows = self._shape.tolist()
        return low_x, low_y, width, height, columns, rows


__all__ = ["CellIndex"]
