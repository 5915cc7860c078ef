"""Poses of the bodies of many entries: position, orientation and size of a unit mesh."""

from functools import cached_property
from typing import TypeAlias

import numpy as np
import numpy.typing as npt

from scenic.dataclass import dataclass
from scenic.graph import quaternions

Floats: TypeAlias = npt.NDArray[np.float64]
Booleans: TypeAlias = npt.NDArray[np.bool_]
Indices: TypeAlias = npt.NDArray[np.intp]


@dataclass(frozen=True)
class Poses:
    """Placements of a unit mesh: a point ``p`` of the mesh goes to ``position + R (size * p)``.

    Attributes:
        position: centre of the bounding box in the world, metres, ``(n, 3)`` or ``(1, 3)``.
        orientation: unit quaternions (x, y, z, w), ``(n, 4)`` or ``(1, 4)``.
        size: width, length and height, metres, ``(n, 3)`` or ``(1, 3)``.

    """

    position: Floats
    orientation: Floats
    size: Floats

    def __post_init__(self) -> None:
        shapes = {len(self.position), len(self.orientation), len(self.size)} - {1}
        widths = (self.position.shape[1:], self.orientation.shape[1:], self.size.shape[1:])
        if len(shapes) > 1 or widths != ((3,), (4,), (3,)):
            raise ValueError(
                f"poses of shapes {self.position.shape}, {self.orientation.shape}, {self.size.shape}"
            )

    @classmethod
    def fixed(
        cls,
        position: npt.ArrayLike,
        orientation: npt.ArrayLike = (0, 0, 0, 1),
        size: npt.ArrayLike = (1, 1, 1),
    ) -> "Poses":
        """Return one placement, the same in every lane of every batch."""
        return cls(
            np.asarray(position, dtype=np.float64).reshape(1, 3),
            np.asarray(orientation, dtype=np.float64).reshape(1, 4),
            np.asarray(size, dtype=np.float64).reshape(1, 3),
        )

    def __len__(self) -> int:
        """The number of entries; 1 also where all are the same."""
        lengths = {len(self.position), len(self.orientation), len(self.size)} - {1}
        return lengths.pop() if lengths else 1

    @cached_property
    def matrix(self) -> Floats:
        """The rotation matrices, ``(n | 1, 3, 3)``."""
        return quaternions.to_matrix(self.orientation)

    def take(self, entries: Indices) -> "Poses":
        """Return the poses of these entries; parts that are the same everywhere stay so."""
        result = Poses(
            _take(self.position, entries),
            _take(self.orientation, entries),
            _take(self.size, entries),
        )
        if "matrix" in self.__dict__:
            result.__dict__["matrix"] = _take(self.matrix, entries)
        if "_bounds" in self.__dict__:
            lower, upper = self._bounds
            result.__dict__["_bounds"] = _take(lower, entries), _take(upper, entries)
        return result

    def to_world(self, points: Floats) -> Floats:
        """Unit-frame points ``(n | 1, ..., 3)`` in the world."""
        sized_points = points * _spread(self.size, points)
        matrix = self.matrix.reshape(len(self.matrix), *(1,) * (points.ndim - 2), 3, 3)
        position = _spread(self.position, points)
        x, y, z = sized_points[..., 0], sized_points[..., 1], sized_points[..., 2]
        return np.stack(
            [
                matrix[..., i, 0] * x + matrix[..., i, 1] * y + matrix[..., i, 2] * z + position[..., i]
                for i in range(3)
            ],
            axis=-1,
        )

    def to_unit(self, points: Floats) -> Floats:
        """World points ``(n | 1, ..., 3)`` in the unit frame."""
        return self.directions_to_unit(points - _spread(self.position, points))

    def directions_to_unit(self, vectors: Floats) -> Floats:
        """Return world vectors ``(n | 1, ..., 3)`` in the unit frame, where their lengths change."""
        matrix = self.matrix.reshape(len(self.matrix), *(1,) * (vectors.ndim - 2), 3, 3)
        size = _spread(self.size, vectors)
        x, y, z = vectors[..., 0], vectors[..., 1], vectors[..., 2]
        return np.stack(
            [
                (matrix[..., 0, i] * x + matrix[..., 1, i] * y + matrix[..., 2, i] * z) / size[..., i]
                for i in range(3)
            ],
            axis=-1,
        )

    def bounds(self) -> tuple[Floats, Floats]:
        """The lower and upper corners ``(n | 1, 3)`` of the world boxes around the oriented boxes."""
        return self._bounds

    @property
    def knows_bounds(self) -> bool:
        """Return whether `bounds` have been computed."""
        return "_bounds" in self.__dict__

    @cached_property
    def _bounds(self) -> tuple[Floats, Floats]:
        half = 0.5 * self.size
        extents = np.abs(self.matrix)
        reach = np.stack(
            [
                extents[:, i, 0] * half[:, 0] + extents[:, i, 1] * half[:, 1] + extents[:, i, 2] * half[:, 2]
                for i in range(3)
            ],
            axis=-1,
        )
        return self.position - reach, self.position + reach


def _take(part: Floats, entries: Indices) -> Floats:
    return part if len(part) == 1 else part[entries]


def _spread(rows: Floats, points: Floats) -> Floats:
    """Reshape rows ``(n | 1, 3)`` to broadcast against ``points``."""
    return rows.reshape(len(rows), *(1,) * (points.ndim - 2), 3)
