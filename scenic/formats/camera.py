"""Where an image is taken from, and the ground that objects are seen above."""

from collections.abc import Sequence
from dataclasses import dataclass
from itertools import product

import numpy as np

from scenic.formats.instances import Array, Instance

AZIMUTH = np.radians(-35)
"""The camera stands to the south-east: this much anticlockwise from due south, seen from above."""
ELEVATION = np.radians(33)
FIELD_OF_VIEW = np.radians(38)
"""The vertical opening angle."""
MARGIN = 1.06

_UNIT_CORNERS = np.array(list(product((-0.5, 0.5), repeat=3)))


@dataclass(frozen=True, slots=True)
class Camera:
    """A perspective camera.

    ``eye`` is its place; ``right``, ``up`` and ``ahead`` are unit vectors, each of shape ``(3,)``; ``tangents`` are
    the tangents of half the horizontal and vertical opening angles.
    """

    eye: Array
    right: Array
    up: Array
    ahead: Array
    tangents: tuple[float, float]

    def directions(self, x: Array, y: Array) -> Array:
        """Unit vectors, shape ``(n, 3)``, through points of the image plane with coordinates in ``[-1, 1]``."""
        rays = (
            self.ahead
            + (x * self.tangents[0])[:, None] * self.right
            + (y * self.tangents[1])[:, None] * self.up
        )
        rays /= np.sqrt(np.einsum("ij,ij->i", rays, rays))[:, None]
        return np.asarray(rays)


def corners(instances: Sequence[Instance]) -> Array:
    """Corners of the objects' boxes, shape ``(8 n, 3)``; of a unit box at the origin if there are none."""
    if not instances:
        return _UNIT_CORNERS
    return np.concatenate(
        [_UNIT_CORNERS @ (matrix := instance.matrix())[:3, :3].T + matrix[:3, 3] for instance in instances]
    )


def ground_height(points: Array) -> float:
    """The height of the ground below points: 0, unless they reach below it or are all far above it."""
    low, extent = points[:, 2].min(), np.ptp(points, axis=0).max()
    return float(low if low < 0 or low > 4 * extent else 0.0)


def framing(instances: Sequence[Instance], aspect: float) -> Camera:
    """The nearest camera of the standard direction that sees every object whole.

    A point with coordinates (r, u, a) along right, up and ahead is in sight of an eye at (R, U, A) if
    ``|r - R| <= t (a - A)`` for the tangent t, and likewise for u: linear bounds on the eye, whose largest A is wanted.
    """
    ahead = np.array(
        [
            np.sin(AZIMUTH) * np.cos(ELEVATION),
            np.cos(AZIMUTH) * np.cos(ELEVATION),
            -np.sin(ELEVATION),
        ]
    )
    right = np.array([np.cos(AZIMUTH), -np.sin(AZIMUTH), 0.0])
    up = np.cross(right, ahead)
    vertical = float(np.tan(FIELD_OF_VIEW / 2))
    tangents = (vertical * aspect, vertical)
    points = corners(instances)
    basis = np.stack([right, up, ahead])
    local = points @ basis.T
    lower, upper, nearest = [], [], []
    for axis, tangent in enumerate(tangents):
        tangent /= MARGIN
        low = np.max(local[:, axis] - tangent * local[:, 2])
        high = np.min(local[:, axis] + tangent * local[:, 2])
        lower.append((low, tangent))
        upper.append((high, tangent))
        nearest.append((high - low) / (2 * tangent))
    depth = min(nearest)
    sides = [
        (low + tangent * depth + high - tangent * depth) / 2
        for (low, tangent), (high, _) in zip(lower, upper, strict=True)
    ]
    eye = np.array([*sides, depth]) @ basis
    return Camera(eye, right, up, ahead, tangents)
