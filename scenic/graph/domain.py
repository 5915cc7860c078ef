"""The part of the unit cube to sample from: a union of boxes."""

from dataclasses import dataclass
from typing import Any, Final, Self

import numpy as np
from numpy.typing import NDArray

Floats = NDArray[np.float64]

FIRST: Final = 5e-324
LAST: Final = 1 - 2.0**-53
"""The outermost points of the open unit interval."""


@dataclass(frozen=True, slots=True, eq=False)
class Domain:
    """A union of boxes of the unit cube that share no volume.

    ``lower`` and ``upper``, both of shape ``(m, dimension)`` with ``0 <= lower < upper <= 1``, are the corners of the
    ``m >= 1`` boxes. Uniform points of the union are points of the cube conditioned to lie in it, which leaves every law
    conditioned on the requirements unchanged as long as the union holds all points that meet them.
    """

    lower: Floats
    upper: Floats

    def __post_init__(self) -> None:
        if self.lower.ndim != 2 or self.lower.shape != self.upper.shape or len(self.lower) == 0:
            raise ValueError(f"not boxes: corners of shapes {self.lower.shape} and {self.upper.shape}")
        if not ((self.lower >= 0) & (self.lower < self.upper) & (self.upper <= 1)).all():
            raise ValueError("a box of the cube must have volume and lie within it")

    @classmethod
    def whole(cls, dimension: int) -> Self:
        """The whole cube."""
        return cls(np.zeros((1, dimension)), np.ones((1, dimension)))

    @property
    def dimension(self) -> int:
        """Number of axes of the cube."""
        return int(self.lower.shape[1])

    @property
    def boxes(self) -> int:
        """Number of boxes."""
        return len(self.lower)

    @property
    def is_whole(self) -> bool:
        """Whether nothing of the cube is left out."""
        return self.boxes == 1 and bool((self.lower == 0).all() and (self.upper == 1).all())

    @property
    def volume(self) -> float:
        """Share of the cube that is left."""
        return float(np.exp(self._logarithms()).sum())

    def _logarithms(self) -> Floats:
        """Logarithm of each box's volume; of many axes the volume itself may be too small for a float."""
        return np.asarray(np.log(self.upper - self.lower).sum(axis=1))

    def choose(self, draws: Floats) -> NDArray[np.intp]:
        """Boxes chosen by uniform numbers ``(n,)`` of the open unit interval, each by its volume; shape ``(n,)``."""
        if self.boxes == 1:
            return np.zeros(len(draws), dtype=np.intp)
        return np.minimum(np.searchsorted(self._shares(), draws, side="right"), self.boxes - 1)

    def place(self, numbers: Floats, axes: NDArray[np.intp], chosen: NDArray[np.intp]) -> Floats:
        """Map uniform numbers of some axes, ``(axes, n)``, into the boxes ``chosen`` for the lanes, ``(n,)``.

        With all axes these are uniform points of the union. Each number depends on its axis and its lane alone.
        """
        lower, upper = self.lower[:, axes], self.upper[:, axes]
        if self.boxes == 1:
            return _between(numbers, lower[0, :, np.newaxis], upper[0, :, np.newaxis])
        points = _between(numbers, lower[0, :, np.newaxis], upper[0, :, np.newaxis])
        # Boxes differ in few axes; only those are looked up lane by lane.
        for row in np.flatnonzero((lower != lower[0]).any(axis=0) | (upper != upper[0]).any(axis=0)):
            points[row] = _between(numbers[row], lower[chosen, row], upper[chosen, row])
        return points

    def place_each(self, numbers: Floats, axes: NDArray[np.intp], chosen: NDArray[np.intp]) -> Floats:
        """The same for numbers ``(n,)`` of one axis in each lane, ``(n,)``."""
        return _between(numbers, self.lower[chosen, axes], self.upper[chosen, axes])

    def _shares(self) -> Floats:
        logarithms = self._logarithms()
        volumes = np.exp(logarithms - logarithms.max())
        return np.asarray(np.cumsum(volumes) / volumes.sum())

    def contains(self, points: Floats) -> NDArray[np.bool_]:
        """Which points of the cube, shape ``(n, dimension)``, lie in the union; shape ``(n,)``."""
        inside = np.zeros(len(points), dtype=np.bool_)
        for lower, upper in zip(self.lower, self.upper, strict=True):
            inside |= ((points >= lower) & (points <= upper)).all(axis=1)
        return inside

    def to_data(self) -> dict[str, Any]:
        """Plain data for a manifest: the axes that are narrowed, by number, box by box."""
        boxes = []
        for lower, upper in zip(self.lower.tolist(), self.upper.tolist(), strict=True):
            ends = enumerate(zip(lower, upper, strict=True))
            boxes.append({str(axis): [low, high] for axis, (low, high) in ends if (low, high) != (0.0, 1.0)})
        return {"dimension": self.dimension, "boxes": boxes}

    @classmethod
    def from_data(cls, data: dict[str, Any]) -> Self:
        """The domain of `to_data`; raises ``ValueError`` for data that describes none."""
        try:
            dimension, boxes = int(data["dimension"]), data["boxes"]
            lower, upper = np.zeros((len(boxes), dimension)), np.ones((len(boxes), dimension))
            for number, box in enumerate(boxes):
                for axis, (low, high) in box.items():
                    lower[number, int(axis)], upper[number, int(axis)] = low, high
        except (KeyError, TypeError, IndexError, AttributeError) as error:
            raise ValueError(f"not a domain: {error}") from error
        return cls(lower, upper)


def _between(rows: Floats, lower: Floats, upper: Floats) -> Floats:
    points = lower + (upper - lower) * rows
    return np.clip(points, np.maximum(lower, FIRST), np.minimum(upper, LAST))
