"""Affine maps from the unit frame of one body into that of another, as columns over entries.

All three coordinates are computed by each operation, since for few entries operations cost more than numbers.
"""

import numpy as np

from scenic.dataclass import dataclass
from scenic.runtime.geometry.poses import Floats, Indices, Poses

Columns = tuple[Floats, Floats, Floats] | Floats
"""Coordinates one by one, or as an array ``(3, ...)``."""


@dataclass(frozen=True, slots=True)
class AffineMaps:
    """The maps ``p -> matrix p + offset`` of n entries.

    Attributes:
        matrix: the coefficients, ``(3, 3, n)``.
        offset: ``(3, n)``.

    """

    matrix: Floats
    offset: Floats

    def columns(self, points: Columns) -> Floats:
        """The images ``(3, ..., n)`` of points whose coordinates are ``(..., n)`` or ``(..., 1)`` each."""
        x, y, z = points
        shape = (1,) * (x.ndim - 1) + self.offset.shape[1:]
        matrix = self.matrix.reshape(3, 3, *shape)
        result: Floats = matrix[:, 0] * x + matrix[:, 1] * y + matrix[:, 2] * z
        result += self.offset.reshape(3, *shape)
        return result

    def reaches(self, half: Columns) -> Floats:
        """Return half the extents ``(3, ..., n)`` of the boxes around the images of boxes of half extents ``(..., n)``."""
        x, y, z = half
        matrix = np.abs(self.matrix).reshape(3, 3, *(1,) * (x.ndim - 1), -1)
        result: Floats = matrix[:, 0] * x + matrix[:, 1] * y + matrix[:, 2] * z
        return result

    def take(self, entries: Indices) -> "AffineMaps":
        """The maps of these entries."""
        return AffineMaps(self.matrix.take(entries, axis=2), self.offset.take(entries, axis=1))

    def followed_by(self, others: "AffineMaps") -> "AffineMaps":
        """These maps, then the others."""
        return AffineMaps(
            np.concatenate([self.matrix, others.matrix], axis=2),
            np.concatenate([self.offset, others.offset], axis=1),
        )


def taken(columns: Columns, chosen: Indices) -> Columns:
    """Return the chosen elements of each column."""
    if isinstance(columns, np.ndarray):
        return columns.take(chosen, axis=1)
    x, y, z = columns
    return x[chosen], y[chosen], z[chosen]


def relative_map(moving: Poses, still: Poses) -> AffineMaps:
    """The maps from the unit frame of ``moving`` to that of ``still``, at least one entry."""
    count = max(len(moving), len(still))
    # Indexed by row of the world, axis of the body and entry.
    a, b = (poses.matrix.transpose(1, 2, 0) for poses in (moving, still))
    size_a, size_b = moving.size.T, still.size.T
    x, y, z = moving.position.T - still.position.T
    cosines = b[0][:, np.newaxis] * a[0] + b[1][:, np.newaxis] * a[1] + b[2][:, np.newaxis] * a[2]
    along = b[0] * x + b[1] * y + b[2] * z
    return AffineMaps(_full(cosines * size_a / size_b[:, np.newaxis], count), _full(along / size_b, count))


def _full(columns: Floats, count: int) -> Floats:
    return columns if columns.shape[-1] == count else np.repeat(columns, count, axis=-1)
