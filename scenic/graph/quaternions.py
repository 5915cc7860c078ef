"""Unit quaternions as rows ``(x, y, z, w)``, elementwise over any leading shape.

Every function is built from elementwise NumPy operations with the sums written out, so that a row of the
result is bitwise the same whatever the batch it is computed in. Leading shapes broadcast. Frames follow
section 4.2 of the specification: the Euler angles (yaw, pitch, roll) are intrinsic rotations about Z, the
new X and the new Y, with the rotation matrix ``Rz(yaw) Rx(pitch) Ry(roll)``; ``multiply(p, q)`` is the frame
p, then q expressed in p's frame.
"""

import math
from typing import Any, Final, TypeAlias

import numpy as np
import numpy.typing as npt

Array: TypeAlias = npt.NDArray[np.float64]

Parts: TypeAlias = tuple[Any, Any, Any, Any]
"""Components x, y, z, w: arrays of one shape, or plain floats."""

Triple: TypeAlias = tuple[Any, Any, Any]
"""Components of a vector, in the same form."""

TAU: Final = 2 * np.pi

_GIMBAL: Final = 1e-9
"""Relative size below which one of the two half-angle pairs of ``to_euler`` holds only rounding noise."""


def multiply(p: npt.ArrayLike, q: npt.ArrayLike) -> Array:
    """Return the composition ``p q`` of quaternions ``(..., 4)``: q expressed in the frame p."""
    a, b = _rows(p), _rows(q)
    p_parts = a[..., 0], a[..., 1], a[..., 2], a[..., 3]
    q_parts = b[..., 0], b[..., 1], b[..., 2], b[..., 3]
    result = _empty(np.broadcast_shapes(a.shape[:-1], b.shape[:-1]), 4)
    result[..., 0], result[..., 1], result[..., 2], result[..., 3] = product(p_parts, q_parts)
    return result


def product(p: Parts, q: Parts) -> Parts:
    """Return the product of two quaternions as `multiply` does, but component by component: of arrays, or of plain floats."""
    px, py, pz, pw = p
    qx, qy, qz, qw = q
    return (
        pw * qx + px * qw + py * qz - pz * qy,
        pw * qy + py * qw + pz * qx - px * qz,
        pw * qz + pz * qw + px * qy - py * qx,
        pw * qw - px * qx - py * qy - pz * qz,
    )


def conjugate(q: npt.ArrayLike) -> Array:
    """Return the conjugate of quaternions ``(..., 4)``: the inverse rotation of unit ones."""
    result = np.negative(_rows(q))
    result[..., 3] = np.negative(result[..., 3])
    return result


def rotate(q: npt.ArrayLike, v: npt.ArrayLike) -> Array:
    """Turn vectors ``(..., 3)`` by unit quaternions ``(..., 4)``, from the frame q to the global one.

    Uses ``v + 2w (u × v) + 2 u × (u × v)`` with ``u = (x, y, z)``; the identity gives back v exactly.
    """
    a, b = _rows(q), _rows(v)
    parts = a[..., 0], a[..., 1], a[..., 2], a[..., 3]
    result = _empty(np.broadcast_shapes(a.shape[:-1], b.shape[:-1]), 3)
    result[..., 0], result[..., 1], result[..., 2] = turned(parts, (b[..., 0], b[..., 1], b[..., 2]))
    return result


def turned(q: Parts, v: Triple) -> Triple:
    """Turn a vector as `rotate` does, but component by component: of arrays, or of plain floats."""
    x, y, z, w = q
    vx, vy, vz = v
    tx = 2 * (y * vz - z * vy)
    ty = 2 * (z * vx - x * vz)
    tz = 2 * (x * vy - y * vx)
    return vx + w * tx + (y * tz - z * ty), vy + w * ty + (z * tx - x * tz), vz + w * tz + (x * ty - y * tx)


def from_euler(yaw: npt.ArrayLike, pitch: npt.ArrayLike, roll: npt.ArrayLike) -> Array:
    """Return the quaternions ``(..., 4)`` of Euler angles in radians, each of shape ``(...)``."""
    angles = tuple(_rows(angle) for angle in (yaw, pitch, roll))
    result = _empty(np.broadcast_shapes(*(angle.shape for angle in angles)), 4)
    result[..., 0], result[..., 1], result[..., 2], result[..., 3] = of_euler(*angles)
    return result


def of_euler(yaw: Any, pitch: Any, roll: Any) -> Parts:
    """Return the quaternion of `from_euler` by components, which are arrays or plain floats."""
    cy, sy = _cos_and_sin(yaw * 0.5)
    cp, sp = _cos_and_sin(pitch * 0.5)
    cr, sr = _cos_and_sin(roll * 0.5)
    return (
        cy * sp * cr - sy * cp * sr,
        cy * cp * sr + sy * sp * cr,
        sy * cp * cr + cy * sp * sr,
        cy * cp * cr - sy * sp * sr,
    )


def turned_upright(outer: Parts, yaw: float) -> Parts:
    """Return the composition of a frame and a rotation about its Z axis, over plain floats; equal to `product` of `of_euler` in every bit."""
    cosine, sine = _cos_and_sin(yaw * 0.5)
    x, y, z, w = outer
    if x == 0 == y and w > 0:
        # Otherwise zeros may have another sign.
        return 0.0, 0.0, w * sine + z * cosine, w * cosine - z * sine
    return product(outer, (0.0, 0.0, sine + 0.0, cosine))


def _cos_and_sin(angle: Any) -> tuple[Any, Any]:
    if type(angle) is not float:
        return np.cos(angle), np.sin(angle)
    if angle == 0:  # the most frequent single angle
        return 1.0, angle
    # NumPy's functions: the C library's may differ from them in the last bit. Its scalars would slow down what follows.
    return float(np.cos(angle)), float(np.sin(angle))


def from_yaw(yaw: npt.ArrayLike) -> Array:
    """Return the quaternions ``(..., 4)`` of rotations about Z by angles ``(...)`` in radians."""
    half = _rows(yaw) * 0.5
    result = _empty(half.shape, 4)
    result[..., 0] = result[..., 1] = 0.0
    result[..., 2] = np.sin(half)
    result[..., 3] = np.cos(half)
    return result


def to_euler(q: npt.ArrayLike) -> tuple[Array, Array, Array]:
    """Return the angles (yaw, pitch, roll), each ``(...)``, of quaternions ``(..., 4)`` of any non-zero norm.

    yaw and roll lie in [-π, π], pitch in [-π/2, π/2]. Where pitch is ±π/2 only yaw ± roll is determined;
    roll is then 0. The half sum and the half difference of yaw and roll come from two independent pairs of
    components (Bernardes and Viollet, "Quaternion to Euler angles conversion", PLoS ONE 17(11), 2022), which
    keeps full accuracy next to those poles.
    """
    a = _rows(q)
    x, y, z, w = a[..., 0], a[..., 1], a[..., 2], a[..., 3]
    sum_sine, sum_cosine = z + y, w + x
    difference_sine, difference_cosine = z - y, w - x
    plus = np.sqrt(sum_sine * sum_sine + sum_cosine * sum_cosine)
    minus = np.sqrt(difference_sine * difference_sine + difference_cosine * difference_cosine)
    pitch = 2 * np.arctan2(plus, minus) - np.pi / 2
    half_sum = np.arctan2(sum_sine, sum_cosine)
    half_difference = np.arctan2(difference_sine, difference_cosine)
    up = minus <= _GIMBAL * plus
    down = plus <= _GIMBAL * minus
    half_difference = np.where(up, half_sum, half_difference)
    half_sum = np.where(down, half_difference, half_sum)
    return normalize_angle(half_sum + half_difference), pitch, normalize_angle(half_sum - half_difference)


def euler_angle(q: Parts, index: int) -> float:
    """Return one of the angles of `to_euler` of a quaternion of plain floats; equal to it in every bit."""
    x, y, z, w = q
    if (
        index == 0 and x == 0 == y and z != 0
    ):  # upright, as most things are: the half sum is the half difference
        return normal_angle(2 * _angle(z, w))
    return euler_angles(q)[index]


def euler_angles(q: Parts) -> tuple[float, float, float]:
    """Return all three angles of `to_euler` of a quaternion of plain floats; equal to it in every bit."""
    x, y, z, w = q
    sum_sine, sum_cosine = z + y, w + x
    difference_sine, difference_cosine = z - y, w - x
    plus = math.sqrt(sum_sine * sum_sine + sum_cosine * sum_cosine)
    minus = math.sqrt(difference_sine * difference_sine + difference_cosine * difference_cosine)
    pitch = 2 * float(np.arctan2(plus, minus)) - math.pi / 2
    half_sum = _angle(sum_sine, sum_cosine)
    if minus <= _GIMBAL * plus or (difference_sine == sum_sine != 0 and difference_cosine == sum_cosine):
        half_difference = half_sum
    else:
        half_difference = _angle(difference_sine, difference_cosine)
    if plus <= _GIMBAL * minus:
        half_sum = half_difference
    return normal_angle(half_sum + half_difference), pitch, normal_angle(half_sum - half_difference)


def _angle(sine: float, cosine: float) -> float:
    return sine if sine == 0 and cosine > 0 else float(np.arctan2(sine, cosine))


def normal_angle(angle: float) -> float:
    """Return a plain float as `normalize_angle` does."""
    if abs(angle) <= math.pi:
        return angle
    if not math.isfinite(angle):
        return math.nan
    turns = math.ceil((angle - np.pi) / TAU) if angle > 0 else math.floor((angle + np.pi) / TAU)
    remainder = angle - TAU * turns
    if remainder > np.pi:
        remainder -= TAU
    elif remainder < -np.pi:
        remainder += TAU
    return min(max(remainder, -np.pi), np.pi)


def to_matrix(q: npt.ArrayLike) -> Array:
    """Return the rotation matrices ``(..., 3, 3)`` of unit quaternions ``(..., 4)``; columns are the turned axes."""
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
    """Return the quaternions ``(..., 4)`` of right-handed frames with these unit axes ``(..., 3)``.

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
    units: Array = result / norm[..., np.newaxis]
    return units


def normalize_angle(a: npt.ArrayLike) -> Array:
    """Angles ``(...)`` in radians moved by whole turns into [-π, π]; those already there are unchanged.

    An infinite angle has no normal form and gives NaN.
    """
    angle = _rows(a)
    with np.errstate(invalid="ignore"):
        turns = np.where(angle > 0, np.ceil((angle - np.pi) / TAU), np.floor((angle + np.pi) / TAU))
        remainder = angle - TAU * turns
    # Rounding in the number of turns can leave the result just outside; one more turn corrects it.
    remainder = np.where(
        remainder > np.pi, remainder - TAU, np.where(remainder < -np.pi, remainder + TAU, remainder)
    )
    result: Array = np.where(np.abs(angle) <= np.pi, angle, np.clip(remainder, -np.pi, np.pi))
    return result


def _empty(shape: tuple[int, ...], components: int) -> Array:
    """Return an array of rows that is stored component by component, which suits elementwise work on them."""
    return components_last(np.empty((components, *shape)))


def components_last(array: Array) -> Array:
    """Return an array ``(components, ...)`` seen as ``(..., components)``; ``np.moveaxis`` takes ten times as long."""
    return array.transpose(*range(1, array.ndim), 0)


def _rows(values: npt.ArrayLike) -> Array:
    return np.asarray(values, dtype=np.float64)
