"""Affine maps from the unit frame of one body into that of another, as columns over entries."""

from dataclasses import dataclass

import numpy as np

from scenic.runtime.geometry.poses import Floats, Indices, Poses

Columns = tuple[Floats, Floats, Floats]


@dataclass(frozen=True, slots=True)
class AffineMaps:
    """The maps ``p -> matrix p + offset`` of n entries.

    Attributes:
        matrix: ``matrix[i][j]`` is the column ``(n,)`` of one coefficient.
        offset: three columns ``(n,)``.

    """

    matrix: tuple[Columns, Columns, Columns]
    offset: Columns

    def columns(self, points: Columns) -> Columns:
        """The images of points whose coordinates are ``(k, n)`` or ``(k, 1)`` each, as ``(k, n)``."""
        x, y, z = points
        first, second, third = (
            row[0] * x + row[1] * y + row[2] * z + shift
            for row, shift in zip(self.matrix, self.offset, strict=True)
        )
        return first, second, third

    def reaches(self, half: Columns) -> Columns:
        """Half the extents of the boxes around the images of boxes of half extents ``(k, n)``."""
        x, y, z = half
        first, second, third = (
            np.abs(row[0]) * x + np.abs(row[1]) * y + np.abs(row[2]) * z for row in self.matrix
        )
        return first, second, third

    def take(self, entries: Indices) -> "AffineMaps":
        """The maps of these entries."""
        rows = [taken(row, entries) for row in self.matrix]
        return AffineMaps((rows[0], rows[1], rows[2]), taken(self.offset, entries))

    def followed_by(self, others: "AffineMaps") -> "AffineMaps":
        """These maps, then the others."""
        rows = [_joined(mine, theirs) for mine, theirs in zip(self.matrix, others.matrix, strict=True)]
        return AffineMaps((rows[0], rows[1], rows[2]), _joined(self.offset, others.offset))

    def of_entry(self, entry: int, points: Floats) -> Floats:
        """Points ``(k, 3)`` under the map of one entry."""
        x, y, z = points[:, 0], points[:, 1], points[:, 2]
        result = np.empty((len(points), 3))
        for i, row in enumerate(self.matrix):
            result[:, i] = row[0][entry] * x + row[1][entry] * y + row[2][entry] * z + self.offset[i][entry]
        return result


def taken(columns: Columns, chosen: Indices) -> Columns:
    """These elements of each column."""
    x, y, z = columns
    return x[chosen], y[chosen], z[chosen]


def _joined(first: Columns, second: Columns) -> Columns:
    x, y, z = (np.concatenate(parts) for parts in zip(first, second, strict=True))
    return x, y, z


def relative_map(moving: Poses, still: Poses) -> AffineMaps:
    """The maps from the unit frame of ``moving`` to that of ``still``, at least one entry."""
    count = max(len(moving), len(still))
    a, b = moving.matrix, still.matrix
    size_a, size_b = moving.size, still.size
    difference = [moving.position[:, i] - still.position[:, i] for i in range(3)]

    def coefficient(i: int, j: int) -> Floats:
        cosine = b[:, 0, i] * a[:, 0, j] + b[:, 1, i] * a[:, 1, j] + b[:, 2, i] * a[:, 2, j]
        return _full(cosine * size_a[:, j] / size_b[:, i], count)

    def shift(i: int) -> Floats:
        along = b[:, 0, i] * difference[0] + b[:, 1, i] * difference[1] + b[:, 2, i] * difference[2]
        return _full(along / size_b[:, i], count)

    rows: list[Columns] = [(coefficient(i, 0), coefficient(i, 1), coefficient(i, 2)) for i in range(3)]
    return AffineMaps((rows[0], rows[1], rows[2]), (shift(0), shift(1), shift(2)))


def _full(column: Floats, count: int) -> Floats:
    return column if len(column) == count else np.repeat(column, count)
