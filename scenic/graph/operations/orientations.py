"""Orientations: unit quaternions and the Euler angles (yaw, pitch, roll)."""

import math
from collections.abc import Sequence
from typing import Any, Final

import numpy as np

from scenic.graph import intervals, quaternions
from scenic.graph.bounds import Bounds
from scenic.graph.construction import make_node
from scenic.graph.kinds import Column, Kind
from scenic.graph.node import Node, constant
from scenic.graph.operation import Call, Terms, always, stacking
from scenic.graph.operations.arithmetic import ADD, NEGATIVE
from scenic.graph.operations.functions import (
    NORMALIZE_ANGLE,
    cos_bounds,
    length_bounds,
    sin_bounds,
)
from scenic.graph.operations.solver_readings import within


def _from_euler(_call: Call, yaw: Column, pitch: Column, roll: Column) -> Column:
    return quaternions.from_euler(*(angle.astype(np.float64) for angle in (yaw, pitch, roll)))


def _from_euler_scalar(_payload: object, yaw: float, pitch: float, roll: float) -> Any:
    if not math.isfinite(yaw + pitch + roll):
        return NotImplemented
    return quaternions.of_euler(float(yaw), float(pitch), float(roll))


def _from_yaw_scalar(_payload: object, yaw: float) -> Any:
    if not math.isfinite(yaw):
        return NotImplemented
    half = yaw * 0.5
    return 0.0, 0.0, float(np.sin(half)), float(np.cos(half))


def _compose(_call: Call, outer: Column, inner: Column) -> Column:
    return quaternions.multiply(outer, inner)


def _inverse(_call: Call, orientation: Column) -> Column:
    return quaternions.conjugate(orientation)


def _rotate(_call: Call, orientation: Column, vector: Column) -> Column:
    return quaternions.rotate(orientation, vector)


def _euler(call: Call, orientation: Column) -> Column:
    return np.ascontiguousarray(quaternions.to_euler(orientation)[call.payload])


_SLACK = 1e-14
"""More than rounding can add to a component of a unit quaternion in a few operations."""


def _unit(parts: Sequence[Bounds]) -> Bounds:
    """Return the bounds of a unit quaternion from those of its components, which were computed without rounding."""
    bounds = intervals.widened(intervals.stacked(parts), _SLACK)
    one = 1 + 1e-9
    return Bounds(np.clip(bounds.lower, -one, one), np.clip(bounds.upper, -one, one))


def _product(*factors: Bounds) -> Bounds:
    result = factors[0]
    for factor in factors[1:]:
        result = intervals.multiply(result, factor)
    return result


def _from_euler_bounds(_payload: object, *angles: Bounds) -> Bounds:
    halves = [Bounds(angle.lower / 2, angle.upper / 2) for angle in angles]
    (sy, sp, sr), (cy, cp, cr) = (
        [reading(None, half) for half in halves] for reading in (sin_bounds, cos_bounds)
    )
    # x = cy sp cr - sy cp sr and so on: the eight products at once.
    one, two, three, four, *others = intervals.components(
        _product(
            intervals.stacked([cy, cy, sy, cy, sy, sy, cy, sy]),
            intervals.stacked([sp, cp, cp, cp, cp, sp, sp, sp]),
            intervals.stacked([cr, sr, cr, cr, sr, cr, sr, sr]),
        )
    )
    minus, plus, also, less = others
    return _unit(
        [
            intervals.subtract(one, minus),
            intervals.add(two, plus),
            intervals.add(three, also),
            intervals.subtract(four, less),
        ]
    )


def _from_yaw_bounds(_payload: object, yaw: Bounds) -> Bounds:
    half = Bounds(yaw.lower / 2, yaw.upper / 2)
    nothing = Bounds(np.zeros_like(half.lower), np.zeros_like(half.upper))
    return intervals.stacked([nothing, nothing, sin_bounds(None, half), cos_bounds(None, half)])


_COMPOSED: Final = (
    ((3, 0, 1), (0, 3, 1), (1, 2, 1), (2, 1, -1)),
    ((3, 1, 1), (1, 3, 1), (2, 0, 1), (0, 2, -1)),
    ((3, 2, 1), (2, 3, 1), (0, 1, 1), (1, 0, -1)),
    ((3, 3, 1), (0, 0, -1), (1, 1, -1), (2, 2, -1)),
)
"""Hamilton's product: the terms of each component, by components of the factors and sign."""


def _compose_bounds(_payload: object, outer: Bounds, inner: Bounds) -> Bounds:
    products = intervals.multiply(
        Bounds(outer.lower[:, :, np.newaxis], outer.upper[:, :, np.newaxis]),
        Bounds(inner.lower[:, np.newaxis], inner.upper[:, np.newaxis]),
    )
    return _unit([intervals.total([_term(products, *term) for term in terms]) for terms in _COMPOSED])


def _term(products: Bounds, first: int, second: int, sign: int) -> Bounds:
    term = Bounds(products.lower[:, first, second], products.upper[:, first, second])
    return term if sign > 0 else intervals.negative(term)


def _conjugated(bounds: Bounds) -> Bounds:
    x, y, z, w = intervals.components(bounds)
    return intervals.stacked([*(intervals.negative(part) for part in (x, y, z)), w])


def matrix(orientation: Bounds) -> Bounds:
    """Return the bounds ``(m, 3, 3)`` of the rotation matrix of an orientation."""
    x, y, z, w = intervals.components(orientation)
    xx, yy, zz = intervals.components(
        intervals.square(Bounds(orientation.lower[:, :3], orientation.upper[:, :3]))
    )
    xy, xz, yz, zw, yw, xw = intervals.components(
        intervals.multiply(intervals.stacked([x, x, y, z, y, x]), intervals.stacked([y, z, z, w, w, w]))
    )
    minus = intervals.negative
    sums = intervals.add(
        intervals.stacked([yy, xy, xz, xy, xx, yz, xz, yz, xx]),
        intervals.stacked([zz, minus(zw), yw, zw, zz, minus(xw), minus(yw), xw, yy]),
    )
    double_sums = Bounds(2 * sums.lower, 2 * sums.upper)
    diagonal = intervals.subtract(Bounds.exactly(1.0), double_sums)
    limit = 1 + 1e-8
    lower = np.where(_DIAGONAL, diagonal.lower, double_sums.lower).reshape(-1, 3, 3)
    upper = np.where(_DIAGONAL, diagonal.upper, double_sums.upper).reshape(-1, 3, 3)
    return Bounds(np.clip(lower, -limit, limit), np.clip(upper, -limit, limit))


_DIAGONAL: Final = np.eye(3, dtype=np.bool_).ravel()


def turned(orientation: Bounds, vector: Bounds) -> Bounds:
    """Return the bounds ``(m, 3)`` of vectors turned by orientations."""
    return turned_by(matrix(orientation), vector)


def turned_by(rotation: Bounds, vector: Bounds) -> Bounds:
    """Return the bounds ``(m, 3)`` of vectors turned by rotation matrices ``(m, 3, 3)``."""
    parts = intervals.components(vector)
    products = intervals.multiply(rotation, Bounds(vector.lower[:, np.newaxis], vector.upper[:, np.newaxis]))
    result = intervals.total(
        [Bounds(products.lower[:, :, column], products.upper[:, :, column]) for column in range(3)]
    )
    # A rotation keeps the length; rounding and a norm of the quaternion off by little are covered by the margin.
    length = intervals.spread(length_bounds(parts), 2).upper
    result = intervals.widened(result, np.where(np.isfinite(length), 1e-8 * length, np.inf))
    reach = np.where(np.isfinite(length), length * (1 + 1e-8), np.inf)
    return Bounds(np.maximum(result.lower, -reach), np.minimum(result.upper, reach))


def _rotate_solver(terms: Terms, _payload: object, orientation: Any, vector: Any) -> Any:
    if any(terms.constant(part) is None for part in orientation):
        return terms.fresh(Kind.VECTOR)
    x, y, z, w = orientation
    vx, vy, vz = vector
    two = terms.real(2)
    tx, ty, tz = two * (y * vz - z * vy), two * (z * vx - x * vz), two * (x * vy - y * vx)
    return (vx + w * tx + (y * tz - z * ty), vy + w * ty + (z * tx - x * tz), vz + w * tz + (x * ty - y * tx))


def _quaternion(call: Call, orientation: Column) -> Column:
    return np.ascontiguousarray(orientation[..., call.payload])


def _euler_bounds(payload: int, _orientation: Bounds) -> Bounds:
    limit = math.pi / 2 if payload == 1 else math.pi
    return Bounds(np.array([-limit - _SLACK]), np.array([limit + _SLACK]))


def _euler_solver(terms: Terms, payload: int, _orientation: object) -> Any:
    limit = math.pi / 2 if payload == 1 else math.pi
    return within(terms, -limit, limit)


# Simpler nodes of the same value. Most things stand upright: a rotation about the vertical axis is one angle.

FROM_YAW: Final = stacking(
    "from yaw",
    always(Kind.ORIENTATION),
    lambda _call, yaw: quaternions.from_yaw(yaw),
    "The orientation of a rotation about the vertical axis (radians).",
    bounds=_from_yaw_bounds,
    scalar=_from_yaw_scalar,
)


def _is_nothing(angle: Node) -> bool:
    return angle.is_constant and angle.value == 0


def _is_identity(orientation: Node) -> bool:
    return orientation.is_constant and orientation.payload.column.tolist() == [[0, 0, 0, 1]]


def _is_upright(orientation: Node) -> bool:
    return orientation.operation is FROM_YAW


def _only_yaw(operands: Sequence[Node], _payload: object) -> Node | None:
    yaw, pitch, roll = operands
    if yaw.is_constant or yaw.kind is not Kind.SCALAR or not (_is_nothing(pitch) and _is_nothing(roll)):
        return None
    return make_node(FROM_YAW, [yaw])


def _with_identity(operands: Sequence[Node], _payload: object) -> Node | None:
    outer, inner = operands
    if _is_identity(outer):
        return inner
    if _is_identity(inner):
        return outer
    if _is_upright(outer) and _is_upright(inner):
        return make_node(FROM_YAW, [make_node(ADD, [outer.operands[0], inner.operands[0]])])
    return None


def _twice_inverse(operands: Sequence[Node], _payload: object) -> Node | None:
    (orientation,) = operands
    if orientation.operation.name == "inverse":
        return orientation.operands[0]
    if _is_upright(orientation):
        return make_node(FROM_YAW, [make_node(NEGATIVE, [orientation.operands[0]])])
    return None


def _not_turned(operands: Sequence[Node], _payload: object) -> Node | None:
    orientation, vector = operands
    still = vector.is_constant and not vector.payload.column.any()
    return vector if still or _is_identity(orientation) else None


def _angle_of_yaw(operands: Sequence[Node], payload: int) -> Node | None:
    (orientation,) = operands
    if not _is_upright(orientation):
        return None
    if payload == 0:
        return make_node(NORMALIZE_ANGLE, [orientation.operands[0]])
    return constant(0.0, Kind.SCALAR, 0.0)


OPERATIONS = (
    FROM_YAW,
    stacking(
        "from euler",
        always(Kind.ORIENTATION),
        _from_euler,
        "The orientation of intrinsic rotations about Z, the new X and the new Y (radians).",
        bounds=_from_euler_bounds,
        rewrite=_only_yaw,
        scalar=_from_euler_scalar,
    ),
    stacking(
        "compose",
        always(Kind.ORIENTATION),
        _compose,
        "The second orientation read in the frame of the first.",
        bounds=_compose_bounds,
        rewrite=_with_identity,
        scalar=lambda _payload, outer, inner: quaternions.product(outer, inner),
    ),
    stacking(
        "inverse",
        always(Kind.ORIENTATION),
        _inverse,
        "The opposite rotation.",
        bounds=lambda _payload, orientation: _conjugated(orientation),
        inverse=lambda _payload, result, _orientation: [_conjugated(result)],
        rewrite=_twice_inverse,
        scalar=lambda _payload, q: (-q[0], -q[1], -q[2], q[3]),
    ),
    stacking(
        "rotate",
        always(Kind.VECTOR),
        _rotate,
        "A vector turned by an orientation.",
        bounds=lambda _payload, orientation, vector: turned(orientation, vector),
        inverse=lambda _payload, result, orientation, _vector: [
            None,
            turned_by(matrix(_conjugated(orientation)), result),
        ],
        solver=_rotate_solver,
        rewrite=_not_turned,
        scalar=lambda _payload, orientation, vector: quaternions.turned(orientation, vector),
    ),
    stacking(
        "euler",
        always(Kind.SCALAR),
        _euler,
        "One Euler angle of an orientation in radians; payload 0 yaw, 1 pitch, 2 roll.",
        bounds=_euler_bounds,
        solver=_euler_solver,
        rewrite=_angle_of_yaw,
        scalar=lambda payload, orientation: quaternions.euler_angle(orientation, payload),
    ),
    stacking(
        "quaternion",
        always(Kind.SCALAR),
        _quaternion,
        "One component of the unit quaternion of an orientation; payload 0 to 3 for x, y, z, w.",
        bounds=lambda payload, orientation: intervals.component(orientation, payload),
        solver=lambda _terms, payload, orientation: orientation[payload],
        scalar=lambda payload, orientation: orientation[payload],
    ),
)
