"""Unit quaternions as rows ``(x, y, z, w)``, elementwise over any leading shape.

Every function is built from elementwise NumPy operations with the sums written out, so that a row of the
result is bitwise the same whatever the batch it is computed in. Leading shapes broadcast. Frames follow
section 4.2 of the specification: the Euler angles (yaw, pitch, roll) are intrinsic rotations about Z, the
new X and the new Y, with the rotation matrix ``Rz(yaw) Rx(pitch) Ry(roll)``; ``multiply(p, q)`` is the frame
p, then q expressed in p's frame.
"""

from typing import Final, TypeAlias

import numpy as np
import numpy.typing as npt

Array: TypeAlias = npt.NDArray[np.float64]

TAU: Final = 2 * np.pi

_GIMBAL: Final = 1e-9
"""Relative size below which one of the two half-angle pairs of ``to_euler`` holds only rounding noise."""


def multiply(p: npt.ArrayLike, q: npt.ArrayLike) -> Array:
    """The composition ``p q`` of quaternions ``(..., 4)``: q expressed in the frame p."""
    a, b = _rows(p), _rows(q)
    px, py, pz, pw = a[..., 0], a[..., 1], a[..., 2], a[..., 3]
    qx, qy, qz, qw = b[..., 0], b[..., 1], b[..., 2], b[..., 3]
    result = _empty(np.broadcast_shapes(a.shape[:-1], b.shape[:-1]), 4)
    result[..., 0] = pw * qx + px * qw + py * qz - pz * qy
    result[..., 1] = pw * qy + py * qw + pz * qx - px * qz
    result[..., 2] = pw * qz + pz * qw + px * qy - py * qx
    result[..., 3] = pw * qw - px * qx - py * qy - pz * qz
    return result


def conjugate(q: npt.ArrayLike) -> Array:
    """The conjugate of quaternions ``(..., 4)``: the inverse rotation of unit ones."""
    result = np.negative(_rows(q))
    result[..., 3] = np.negative(result[..., 3])
    return result


def rotate(q: npt.ArrayLike, v: npt.ArrayLike) -> Array:
    """Vectors ``(..., 3)`` turned by unit quaternions ``(..., 4)``: from the frame q to the global one.

    Uses ``v + 2w (u × v) + 2 u × (u × v)`` with ``u = (x, y, z)``; the identity gives back v exactly.
    """
    a, b = _rows(q), _rows(v)
    x, y, z, w = a[..., 0], a[..., 1], a[..., 2], a[..., 3]
    vx, vy, vz = b[..., 0], b[..., 1], b[..., 2]
    tx = 2 * (y * vz - z * vy)
    ty = 2 * (z * vx - x * vz)
    tz = 2 * (x * vy - y * vx)
    result = _empty(np.broadcast_shapes(a.shape[:-1], b.shape[:-1]), 3)
    result[..., 0] = vx + w * tx + (y * tz - z * ty)
    result[..., 1] = vy + w * ty + (z * tx - x * tz)
    result[..., 2] = vz + w * tz + (x * ty - y * tx)
    return result


def from_euler(yaw: npt.ArrayLike, pitch: npt.ArrayLike, roll: npt.ArrayLike) -> Array:
    """The quaternions ``(..., 4)`` of Euler angles in radians, each of shape ``(...)``."""
    half_yaw, half_pitch, half_roll = (_rows(angle) * 0.5 for angle in (yaw, pitch, roll))
    cy, sy = np.cos(half_yaw), np.sin(half_yaw)
    cp, sp = np.cos(half_pitch), np.sin(half_pitch)
    cr, sr = np.cos(half_roll), np.sin(half_roll)
    result = _empty(np.broadcast_shapes(cy.shape, cp.shape, cr.shape), 4)
    result[..., 0] = cy * sp * cr - sy * cp * sr
    result[..., 1] = cy * cp * sr + sy * sp * cr
    result[..., 2] = sy * cp * cr + cy * sp * sr
    result[..., 3] = cy * cp * cr - sy * sp * sr
    return result


def from_yaw(yaw: npt.ArrayLike) -> Array:
    """The quaternions ``(..., 4)`` of rotations about Z by angles ``(...)`` in radians."""
    half = _rows(yaw) * 0.5
    result = _empty(half.shape, 4)
    result[..., 0] = result[..., 1] = 0.0
    result[..., 2] = np.sin(half)
    result[..., 3] = np.cos(half)
    return result


def to_euler(q: npt.ArrayLike) -> tuple[Array, Array, Array]:
    """The angles (yaw, pitch, roll), each ``(...)``, of quaternions ``(..., 4)`` of any non-zero norm.

    yaw and roll lie in [-π, π], pitch in [-π/2, π/2]. Where pitch is ±π/2 only yaw ± roll is determined;
    roll is then 0. The half sum and the half difference of yaw and roll come from two independent pairs of
    components (Bernardes and Viollet, "Quaternion to Euler angles conversion", PLoS ONE 17(11), 2022), which
    keeps full accuracy next to those poles.
    """
    a = _rows(q)
    x, y, z, w = a[..., 0], a[..., 1], a[..., 2], a[..., 3]
    sum_sine, sum_cosine = z + y, w + x
    difference_sine, difference_cosine = z - y, w - x
    plus = np.hypot(sum_sine, sum_cosine)
    minus = np.hypot(difference_sine, difference_cosine)
    pitch = 2 * np.arctan2(plus, minus) - np.pi / 2
    half_sum = np.arctan2(sum_sine, sum_cosine)
    half_difference = np.arctan2(difference_sine, difference_cosine)
    up = minus <= _GIMBAL * plus
    down = plus <= _GIMBAL * minus
    half_difference = np.where(up, half_sum, half_difference)
    half_sum = np.where(down, half_difference, half_sum)
    return normalize_angle(half_sum + half_difference), pitch, normalize_angle(half_sum - half_difference)


def to_matrix(q: npt.ArrayLike) -> Array:
    """The rotation matrices ``(..., 3, 3)`` of unit quaternions ``(..., 4)``; columns are the turned axes."""
    a = _rows(q)
    x, y, z, w = a[..., 0], a[..., 1], a[..., 2], a[..., 3]
    # Stored coefficient by coefficient, which suits the elementwise work that follows.
    result = np.empty((3, 3, *a.shape[:-1]))
    result[0, 0] = 1 - 2 * (y * y + z * z)
    result[0, 1] = 2 * (x * y - z * w)
    result[0, 2] = 2 * (x * z + y * w)
    result[1, 0] = 2 * (x * y + z * w)
    result[1, 1] = 1 - 2 * (x * x + z * z)
    result[1, 2] = 2 * (y * z - x * w)
    result[2, 0] = 2 * (x * z - y * w)
    result[2, 1] = 2 * (y * z + x * w)
    result[2, 2] = 1 - 2 * (x * x + y * y)
    return result.transpose(*range(2, result.ndim), 0, 1)


def from_axes(x: npt.ArrayLike, y: npt.ArrayLike, z: npt.ArrayLike) -> Array:
    """The quaternions ``(..., 4)`` of right-handed frames with these unit axes ``(..., 3)``.

    Shepperd's method ("Quaternion from rotation matrix", J. Guidance and Control 1(3), 1978): the largest
    component is found first, so that no division is ill-conditioned.
    """
    a, b, c = _rows(x), _rows(y), _rows(z)
    xx, xy, xz = a[..., 0], b[..., 0], c[..., 0]
    yx, yy, yz = a[..., 1], b[..., 1], c[..., 1]
    zx, zy, zz = a[..., 2], b[..., 2], c[..., 2]
    # Four times the products of each component with the others, one row for each choice of the largest.
    squares = np.stack([1 + xx - yy - zz, 1 - xx + yy - zz, 1 - xx - yy + zz, 1 + xx + yy + zz])
    products = {
        0: (squares[0], xy + yx, xz + zx, zy - yz),
        1: (xy + yx, squares[1], yz + zy, xz - zx),
        2: (xz + zx, yz + zy, squares[2], yx - xy),
        3: (zy - yz, xz - zx, yx - xy, squares[3]),
    }
    largest = np.argmax(squares, axis=0)
    result = np.empty((*largest.shape, 4))
    for component in range(4):
        result[..., component] = np.choose(largest, [products[row][component] for row in range(4)])
    i, j, k, w = result[..., 0], result[..., 1], result[..., 2], result[..., 3]
    norm = np.sqrt(i * i + j * j + k * k + w * w)
    normalised: Array = result / norm[..., np.newaxis]
    return normalised


def normalize_angle(a: npt.ArrayLike) -> Array:
    """Angles ``(...)`` in radians moved by whole turns into [-π, π]; those already there are unchanged.

    An infinite angle has no normal form and gives NaN.
    """
    angle = _rows(a)
    with np.errstate(invalid="ignore"):
        turns = np.where(angle > 0, np.ceil((angle - np.pi) / TAU), np.floor((angle + np.pi) / TAU))
        moved = angle - TAU * turns
    # Rounding in the number of turns can leave the result just outside; one more turn corrects it.
    moved = np.where(moved > np.pi, moved - TAU, np.where(moved < -np.pi, moved + TAU, moved))
    result: Array = np.where(np.abs(angle) <= np.pi, angle, np.clip(moved, -np.pi, np.pi))
    return result


def _empty(shape: tuple[int, ...], components: int) -> Array:
    """Rows of components stored component by component, which suits the elementwise work on them."""
    return components_last(np.empty((components, *shape)))


def components_last(array: Array) -> Array:
    """An array ``(components, ...)`` seen as ``(..., components)``; ``np.moveaxis`` takes ten times as long."""
    return array.transpose(*range(1, array.ndim), 0)


def _rows(values: npt.ArrayLike) -> Array:
    return np.asarray(values, dtype=np.float64)
