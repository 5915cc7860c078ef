"""Boxes of the unit cube, many at a time."""

from collections.abc import Sequence
from itertools import pairwise
from typing import Any

import numpy as np
from numpy.typing import NDArray

from scenic.dataclass import dataclass
from scenic.graph.bounds import Floats


@dataclass(frozen=True, slots=True, eq=False)
class Boxes:
    """Boxes of the cube, corners of shape ``(m, dimension)``."""

    lower: Floats
    upper: Floats

    def __len__(self) -> int:
        return len(self.lower)

    def volume(self, axes: NDArray[Any]) -> float:
        """Return the volume of all of them together, along some axes only."""
        return float(self.volumes(axes).sum())

    def taken(self, rows: NDArray[np.intp]) -> "Boxes":
        """Return some of the boxes."""
        return Boxes(self.lower[rows], self.upper[rows])

    def volumes(self, axes: NDArray[Any]) -> Floats:
        """Return the volume of each, along some axes only, ``(m,)``."""
        return np.asarray((self.upper - self.lower)[:, axes].prod(axis=1))

    @staticmethod
    def joined(parts: Sequence["Boxes"]) -> "Boxes":
        """All boxes of several sets."""
        return Boxes(
            np.concatenate([part.lower for part in parts]), np.concatenate([part.upper for part in parts])
        )

    def divided(self, axes: NDArray[np.intp], parts: int = 2) -> "Boxes":
        """Each box cut into equal parts along an axis of its own, ``axes`` ``(m,)``; all first parts come first."""
        rows = np.arange(len(self))
        start, end = self.lower[rows, axes], self.upper[rows, axes]
        cuts = [start + (end - start) * (part / parts) for part in range(parts)] + [end]
        lower, upper = np.tile(self.lower, (parts, 1)), np.tile(self.upper, (parts, 1))
        for part in range(parts):
            place = rows + part * len(self)
            lower[place, axes], upper[place, axes] = cuts[part], cuts[part + 1]
        return Boxes(lower, upper)

    def cut(self, axis: int, places: Floats) -> "Boxes":
        """Each box cut along an axis before those of some places that lie within it."""
        lower, upper = [], []
        for low, after in pairwise([0.0, *places.tolist(), 2.0]):
            high = min(np.nextafter(after, 0.0), 1.0)
            mine = (self.lower[:, axis] <= high) & (self.upper[:, axis] >= low)
            some, others = self.lower[mine], self.upper[mine]
            some[:, axis], others[:, axis] = np.maximum(some[:, axis], low), np.minimum(others[:, axis], high)
            lower.append(some)
            upper.append(others)
        return Boxes(np.concatenate(lower), np.concatenate(upper))


__all__ = ["Boxes"]
