"""Positions and rotations of objects, as numbers for other programs."""

import math

import numpy as np
import numpy.typing as npt

from scenic.formats.scene_protocols import SceneObject

Triple = tuple[float, float, float]
Four = tuple[float, float, float, float]


def quaternion_of(thing: SceneObject) -> Four:
    """Return the global orientation as a quaternion ``(x, y, z, w)``, of the two signs that with ``w >= 0``."""
    rotation = thing.orientation
    x, y, z, w = (float(value) for value in (rotation.x, rotation.y, rotation.z, rotation.w))
    sign = -1.0 if w < 0 else 1.0
    # No negative zeros, which would come back as positive ones.
    return sign * x + 0.0, sign * y + 0.0, sign * z + 0.0, sign * w + 0.0


def rotation_matrix(quaternion: Four) -> npt.NDArray[np.float64]:
    """Return the rotation matrix, shape ``(3, 3)``, of a unit quaternion ``(x, y, z, w)``."""
    x, y, z, w = quaternion
    return np.array(
        [
            [1 - 2 * (y * y + z * z), 2 * (x * y - z * w), 2 * (x * z + y * w)],
            [2 * (x * y + z * w), 1 - 2 * (x * x + z * z), 2 * (y * z - x * w)],
            [2 * (x * z - y * w), 2 * (y * z + x * w), 1 - 2 * (x * x + y * y)],
        ]
    )


def euler_angles(quaternion: Four) -> Triple:
    """Return yaw, pitch and roll in radians: rotations about Z, then the new X, then the new Y.

    With the matrix ``Rz(yaw) Rx(pitch) Ry(roll)``, its lower row is ``(-cos p sin r, sin p, cos p cos r)`` and its middle
    column ``(-sin y cos p, cos y cos p, sin p)``. Straight up or down, only the sum or difference of yaw and roll is
    determined; roll is 0 there.
    """
    x, y, z, w = quaternion
    sine = 2 * (y * z + w * x)
    if abs(sine) > 1 - 1e-12:
        return math.atan2(2 * (x * y + w * z), 1 - 2 * (y * y + z * z)), math.copysign(math.pi / 2, sine), 0.0
    yaw = math.atan2(2 * (w * z - x * y), 1 - 2 * (x * x + z * z))
    roll = math.atan2(2 * (w * y - x * z), 1 - 2 * (x * x + y * y))
    return yaw, math.asin(sine), roll
