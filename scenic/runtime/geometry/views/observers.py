"""Views: the positions and directions of observers, and the range of directions in which they see a box."""

from functools import cached_property
from itertools import product
from typing import Final

import numpy as np
import numpy.typing as npt

from scenic.dataclass import dataclass
from scenic.graph import quaternions
from scenic.runtime.geometry.poses import Booleans, Floats, Indices, Poses

FULL_ANGLE_SLACK: Final = 0.017
"""View angles this close to all around, in radians, count as all around (section 11.2)."""

ANGLE_SLACK: Final = 1e-9
"""By how much, in radians, a direction may lie beyond the border of a view and be in it: borders belong to views."""

DISTANCE_SLACK: Final = 1e-9
"""By how much, relative to it, a distance may exceed another and count as equal: rounding decides nothing."""

CORNERS: Final = np.array(list(product((-0.5, 0.5), repeat=3)))
"""The corners of the unit box, ``(8, 3)``."""

EDGES: Final = np.array([(a, a | bit) for a in range(8) for bit in (1, 2, 4) if not a & bit])
"""The edges of the unit box as numbers of corners, ``(12, 2)``."""


@dataclass(frozen=True)
class Views:
    """Observers over the lanes (section 11.1); every column has one row for each lane, or one for all.

    Attributes:
        camera: where the observer looks from, metres, ``(n | 1, 3)``.
        orientation: unit quaternions (x, y, z, w) of the view's frame: ahead is +Y, up is +Z; ``(n | 1, 4)``.
        angles: horizontal and vertical view angle, radians, ``(n | 1, 2)``.
        distance: how far it sees, metres, ``(n | 1,)``.
        density: rays per degree and dimension, ``(n | 1,)``.
        count: explicit numbers of rays, horizontal and vertical, ``(n | 1, 2)``; 0 leaves them to the density.
        scaling: whether ray numbers grow with the distance to the target, ``(n | 1,)``.

    """

    camera: Floats
    orientation: Floats
    angles: Floats
    distance: Floats
    density: Floats
    count: Floats
    scaling: Booleans

    @classmethod
    def fixed(
        cls,
        camera: npt.ArrayLike,
        orientation: npt.ArrayLike = (0, 0, 0, 1),
        *,
        angles: tuple[float, float] = (2 * np.pi, np.pi),
        distance: float = 50.0,
        density: float = 5.0,
        count: tuple[int, int] = (0, 0),
        scaling: bool = False,
    ) -> "Views":
        """Return one observer, the same in every lane."""
        return cls(
            np.asarray(camera, dtype=np.float64).reshape(1, 3),
            np.asarray(orientation, dtype=np.float64).reshape(1, 4),
            np.array([angles], dtype=np.float64),
            np.array([distance], dtype=np.float64),
            np.array([density], dtype=np.float64),
            np.array([count], dtype=np.float64),
            np.array([scaling]),
        )

    def spread(self, lanes: int) -> "Views":
        """Return the same views with a row for each lane in every column."""
        return Views(
            np.broadcast_to(self.camera, (lanes, 3)),
            np.broadcast_to(self.orientation, (lanes, 4)),
            np.broadcast_to(self.angles, (lanes, 2)),
            np.broadcast_to(self.distance, (lanes,)),
            np.broadcast_to(self.density, (lanes,)),
            np.broadcast_to(self.count, (lanes, 2)),
            np.broadcast_to(self.scaling, (lanes,)),
        )

    def take(self, lanes: Indices) -> "Views":
        """Return the views of these lanes; every column must have a row for each lane."""
        return Views(
            self.camera[lanes],
            self.orientation[lanes],
            self.angles[lanes],
            self.distance[lanes],
            self.density[lanes],
            self.count[lanes],
            self.scaling[lanes],
        )

    @cached_property
    def matrix(self) -> Floats:
        """Rotation matrices from the view's frame to the world, ``(n | 1, 3, 3)``."""
        return quaternions.to_matrix(self.orientation)

    @cached_property
    def window(self) -> Floats:
        """The view angles, those that are almost all around made so, ``(n | 1, 2)``."""
        full = np.array([2 * np.pi, np.pi])
        return np.where(self.angles >= full - FULL_ANGLE_SLACK, full, self.angles)

    def to_view(self, points: Floats) -> Floats:
        """World points ``(n | 1, ..., 3)`` in the frame of the view."""
        spread = (len(self.camera), *(1,) * (points.ndim - 2))
        offset = points - self.camera.reshape(*spread, 3)
        matrix = self.matrix.reshape(len(self.matrix), *(1,) * (points.ndim - 2), 3, 3)
        x, y, z = offset[..., 0], offset[..., 1], offset[..., 2]
        return np.stack(
            [matrix[..., 0, i] * x + matrix[..., 1, i] * y + matrix[..., 2, i] * z for i in range(3)], axis=-1
        )

    def contain(self, points: Floats) -> Booleans:
        """Return whether world points ``(n | 1, 3)`` are within the view's range and angles, borders included, ``(n,)``.

        The camera itself is in every view; straight up and down are of every azimuth.
        """
        local = self.to_view(points)
        x, y, z = local[..., 0], local[..., 1], local[..., 2]
        across = np.hypot(x, y)
        distance = np.hypot(across, z)
        half = 0.5 * self.window + ANGLE_SLACK
        azimuth = np.abs(np.arctan2(-x, y))
        altitude = np.abs(np.arctan2(z, across))
        upright = across <= ANGLE_SLACK * np.abs(z)
        within = (azimuth <= half[:, 0]) | upright
        result: Booleans = (
            (distance <= self.distance * (1 + DISTANCE_SLACK)) & within & (altitude <= half[:, 1])
        )
        return result


@dataclass(frozen=True, slots=True)
class Extents:
    """The directions in which boxes lie as seen from views, a row for each lane.

    Attributes:
        azimuth: the lowest and the highest azimuth, radians, ``(n, 2)``; the lowest may be below -π and the
            highest above π, their difference is below 2π.
        around: whether the box surrounds the vertical through the camera: it lies in every azimuth, ``(n,)``.
        altitude: the lowest and the highest altitude, radians, ``(n, 2)``.

    """

    azimuth: Floats
    around: Booleans
    altitude: Floats

    def meet(self, window: Floats) -> Booleans:
        """Return whether some direction of the box is in view windows ``(n, 2)``, ``(n,)``; never wrongly no."""
        half = 0.5 * window + 2 * ANGLE_SLACK
        turns = np.zeros(len(half), dtype=np.bool_)
        for shift in (-2 * np.pi, 0.0, 2 * np.pi):
            turns |= (self.azimuth[:, 0] + shift <= half[:, 0]) & (self.azimuth[:, 1] + shift >= -half[:, 0])
        result: Booleans = (
            (turns | self.around) & (self.altitude[:, 0] <= half[:, 1]) & (self.altitude[:, 1] >= -half[:, 1])
        )
        return result


def box_corners(views: Views, poses: Poses) -> Floats:
    """Return the corners of boxes in the frames of the views, ``(n, 8, 3)``."""
    return views.to_view(poses.to_world(CORNERS[None]))


def extents(corners: Floats) -> Extents:
    """The directions of boxes with corners ``(n, 8, 3)`` in the view's frame, none of which holds the camera.

    Azimuths are those of the corners, taken relative to the middle: all within half a turn unless the box
    surrounds the vertical. The altitude of a body is greatest straight up, if that meets it, or on an edge:
    seen from the camera, faces are convex polygons of great circles. On the great circle with normal n the
    highest direction is n × (n × up), up to its sign.
    """
    middle = corners.mean(axis=1)
    x, y, z = corners[..., 0], corners[..., 1], corners[..., 2]
    centre = np.arctan2(-middle[:, 0], middle[:, 1])
    relative = np.arctan2(-x, y) - centre[:, None]
    relative -= 2 * np.pi * np.round(relative / (2 * np.pi))
    low, high = relative.min(axis=1), relative.max(axis=1)
    around = high - low >= np.pi - 1e-6
    altitude = np.arctan2(z, np.hypot(x, y))
    lowest, highest = altitude.min(axis=1), altitude.max(axis=1)
    u, v = corners[:, EDGES[:, 0]], corners[:, EDGES[:, 1]]
    nx = u[..., 1] * v[..., 2] - u[..., 2] * v[..., 1]
    ny = u[..., 2] * v[..., 0] - u[..., 0] * v[..., 2]
    nz = u[..., 0] * v[..., 1] - u[..., 1] * v[..., 0]
    flat = np.hypot(nx, ny)
    # The summit of the great circle: (-nx nz, -ny nz, nx² + ny²); the lowest point is its opposite.
    sx, sy, sz = -nx * nz, -ny * nz, flat * flat
    after = _triple(nx, ny, nz, u, sx, sy, sz)
    before = -_triple(nx, ny, nz, v, sx, sy, sz)
    incline = np.arctan2(flat, np.abs(nz))
    # On an edge that runs straight up or down past the camera, the ends decide (or the box is around it).
    top = np.where((after > 0) & (before > 0), incline, -np.inf).max(axis=1)
    bottom = np.where((after < 0) & (before < 0), -incline, np.inf).min(axis=1)
    highest, lowest = np.maximum(highest, top), np.minimum(lowest, bottom)
    above = around & (z.max(axis=1) > 0)
    below = around & (z.min(axis=1) < 0)
    highest = np.where(above, np.pi / 2, highest)
    lowest = np.where(below, -np.pi / 2, lowest)
    slack = ANGLE_SLACK
    return Extents(
        np.stack([centre + low - slack, centre + high + slack], axis=-1),
        around,
        np.stack([lowest - slack, highest + slack], axis=-1),
    )


def _triple(nx: Floats, ny: Floats, nz: Floats, u: Floats, sx: Floats, sy: Floats, sz: Floats) -> Floats:
    """Return the product n · (u × s): positive where s is ahead of u on the way round n."""
    result: Floats = (
        nx * (u[..., 1] * sz - u[..., 2] * sy)
        + ny * (u[..., 2] * sx - u[..., 0] * sz)
        + nz * (u[..., 0] * sy - u[..., 1] * sx)
    )
    return result
