"""Rectangles of the plane over lanes: outlines of upright boxes, in closed form."""

import numpy as np

from scenic.dataclass import dataclass
from scenic.runtime.geometry.poses import Booleans, Floats, Indices, Poses


@dataclass(frozen=True, slots=True)
class Rectangles:
    """A rectangle in each lane.

    Attributes:
        centre: ``(n | 1, 2)``, metres.
        axis: cosine and sine of the turn from the world's x, ``(n | 1, 2)``.
        half: half the extents along its own axes, ``(n | 1, 2)``.

    """

    centre: Floats
    axis: Floats
    half: Floats

    @classmethod
    def under(cls, poses: Poses) -> "Rectangles":
        """Return the outlines from above of boxes that stand upright."""
        return cls(poses.position[:, :2], poses.matrix[:, :2, 0], poses.size[:, :2] / 2)

    def local(self, points: Floats) -> tuple[Floats, Floats]:
        """Points ``(n | 1, ..., 2)`` in the frames of the rectangles."""
        spread = (slice(None), *(np.newaxis,) * (points.ndim - 2))
        dx = points[..., 0] - self.centre[:, 0][spread]
        dy = points[..., 1] - self.centre[:, 1][spread]
        cos, sin = self.axis[:, 0][spread], self.axis[:, 1][spread]
        return dx * cos + dy * sin, dy * cos - dx * sin

    def distances(self, points: Floats) -> Floats:
        """Distances ``(n,)`` of points ``(n | 1, 2)``; 0 inside."""
        x, y = self.local(points)
        return np.hypot(
            np.maximum(np.abs(x) - self.half[:, 0], 0), np.maximum(np.abs(y) - self.half[:, 1], 0)
        )

    def hold(self, points: Floats) -> Booleans:
        """Return whether points ``(n | 1, ..., 2)`` lie inside or on the edge."""
        x, y = self.local(points)
        spread = (slice(None), *(np.newaxis,) * (points.ndim - 2))
        inside: Booleans = (np.abs(x) <= self.half[:, 0][spread]) & (np.abs(y) <= self.half[:, 1][spread])
        return inside

    def meet(self, other: "Rectangles") -> Booleans:
        """Return whether two rectangles share a point, ``(n,)``: whether no axis of either separates them."""
        one, two = self._overlap_along(other), other._overlap_along(self)
        met: Booleans = one & two
        return met

    def _overlap_along(self, other: "Rectangles") -> Booleans:
        """Return whether the shadows on both axes of the first overlap."""
        x, y = self.local(other.centre)
        cos = np.abs(self.axis[:, 0] * other.axis[:, 0] + self.axis[:, 1] * other.axis[:, 1])
        sin = np.abs(self.axis[:, 0] * other.axis[:, 1] - self.axis[:, 1] * other.axis[:, 0])
        width, length = other.half[:, 0], other.half[:, 1]
        overlap: Booleans = (np.abs(x) <= self.half[:, 0] + cos * width + sin * length) & (
            np.abs(y) <= self.half[:, 1] + sin * width + cos * length
        )
        return overlap

    def corners(self) -> Floats:
        """Return the corners ``(n, 4, 2)``, anticlockwise."""
        signs = np.array([(-1, -1), (1, -1), (1, 1), (-1, 1)])
        x, y = (signs[:, part] * self.half[:, part, np.newaxis] for part in (0, 1))
        cos, sin = self.axis[:, 0, np.newaxis], self.axis[:, 1, np.newaxis]
        turned = np.stack([x * cos - y * sin, x * sin + y * cos], axis=-1)
        corners: Floats = self.centre[:, np.newaxis] + turned
        return corners

    def take(self, lanes: Booleans | Indices) -> "Rectangles":
        """Return the rectangles of some lanes."""
        return Rectangles(
            *(part if len(part) == 1 else part[lanes] for part in (self.centre, self.axis, self.half))
        )


__all__ = ["Rectangles"]
