"""Vectors: making them, their parts, lengths and directions."""

import math
from collections.abc import Sequence
from typing import Any

import numpy as np

from scenic.graph import intervals
from scenic.graph.bounds import Bounds
from scenic.graph.kinds import Column, Kind
from scenic.graph.node import Node
from scenic.graph.operation import Call, Terms, always, stacking
from scenic.graph.operations.functions import length_bounds
from scenic.graph.operations.inverse_readings import before_rounding, sides
from scenic.graph.operations.solver_readings import root_of_squares, within
from scenic.graph.quaternions import components_last, normal_angle, normalize_angle


def _vector(_call: Call, x: Column, y: Column, z: Column) -> Column:
    return _stacked(x, y, z)


def _stacked(x: Column, y: Column, z: Column) -> Column:
    """Vectors of three columns of numbers; stored component by component, which suits what reads them."""
    result = np.empty((3, *np.broadcast_shapes(x.shape, y.shape, z.shape)))
    result[0], result[1], result[2] = x, y, z
    return components_last(result)


def _parts(vector: Column) -> tuple[Column, Column, Column]:
    # Contiguous, so that functions give the same bits whatever the memory layout.
    x, y, z = (np.ascontiguousarray(vector[..., index]) for index in range(3))
    return x, y, z


_Triple = tuple[float, float, float]

_SMALL, _LARGE = 2.0**-460, 2.0**500
"""Lengths between these come from squares that neither vanish nor overflow, whatever the components."""


def _length(x: Column, y: Column, z: Column) -> Column:
    length = np.asarray(np.sqrt(x * x + y * y + z * z))
    extreme = ~((length >= _SMALL) & (length <= _LARGE)) & (length == length)
    if extreme.any():
        length = np.where(extreme, _scaled_length(x, y, z), length)
    return length


def _scaled_length(x: Column | float, y: Column | float, z: Column | float) -> Column:
    """Return the length by way of components whose squares are of a usual size; scaling by powers of two rounds nothing."""
    largest = np.maximum(np.maximum(np.abs(x), np.abs(y)), np.abs(z))
    # Tiny ones all grow by the same factor: that of the largest component might overflow.
    _, exponent = np.frexp(np.where(np.isfinite(largest) & (largest > 0), largest, 1.0))
    exponent = np.maximum(exponent, -1000)
    a, b, c = (np.ldexp(part, -exponent) for part in (x, y, z))
    return np.asarray(np.ldexp(np.sqrt(a * a + b * b + c * c), exponent))


def _norm(_call: Call, vector: Column) -> Column:
    return _length(*_parts(vector))


def _dot(_call: Call, a: Column, b: Column) -> Column:
    (ax, ay, az), (bx, by, bz) = _parts(a), _parts(b)
    return np.asarray(ax * bx + ay * by + az * bz)


def _cross(_call: Call, a: Column, b: Column) -> Column:
    (ax, ay, az), (bx, by, bz) = _parts(a), _parts(b)
    return _stacked(ay * bz - az * by, az * bx - ax * bz, ax * by - ay * bx)


def _distance(_call: Call, a: Column, b: Column) -> Column:
    return _length(*_parts(a - b))


def _azimuth(_call: Call, vector: Column) -> Column:
    x, y, _ = _parts(vector)
    return normalize_angle(np.arctan2(y, x) - np.pi / 2)


def _altitude(_call: Call, vector: Column) -> Column:
    x, y, z = _parts(vector)
    return np.asarray(np.arctan2(z, _length(x, y, np.zeros_like(x))))


def _normalized(_call: Call, vector: Column) -> Column:
    length = _norm(_call, vector)
    # The zero vector has no direction and stays as it is.
    return np.asarray(vector / np.where(length == 0, 1.0, length)[..., np.newaxis])


# On plain numbers; vectors are triples. NumPy's functions, where the C library's may differ in the last bit.


def _norm_scalar(_payload: object, vector: _Triple) -> float:
    x, y, z = vector
    length = math.sqrt(x * x + y * y + z * z)
    if _SMALL <= length <= _LARGE or length != length or not (x or y or z):
        return length
    return float(_scaled_length(float(x), float(y), float(z)))


def _cross_scalar(_payload: object, a: _Triple, b: _Triple) -> Any:
    (ax, ay, az), (bx, by, bz) = a, b
    return ay * bz - az * by, az * bx - ax * bz, ax * by - ay * bx


def _altitude_scalar(_payload: object, vector: _Triple) -> float:
    return float(np.arctan2(vector[2], _norm_scalar(None, (vector[0], vector[1], 0.0))))


def _normalized_scalar(_payload: object, vector: _Triple) -> Any:
    length = _norm_scalar(None, vector) or 1.0
    return vector[0] / length, vector[1] / length, vector[2] / length


def _component_inverse(payload: int, result: Bounds, _vector: Bounds) -> list[Bounds]:
    rest = intervals.unbounded(result)
    return [intervals.stacked([result if index == payload else rest for index in range(3)])]


def _norm_bounds(_payload: object, vector: Bounds) -> Bounds:
    return length_bounds(intervals.components(vector))


def _norm_inverse(_payload: object, result: Bounds, vector: Bounds) -> list[Bounds]:
    return [intervals.stacked(sides(result, intervals.components(vector)))]


def _dot_bounds(_payload: object, a: Bounds, b: Bounds) -> Bounds:
    pairs = zip(intervals.components(a), intervals.components(b), strict=True)
    return intervals.total([intervals.multiply(x, y) for x, y in pairs])


def _dot_inverse(_payload: object, result: Bounds, a: Bounds, b: Bounds) -> list[Bounds]:
    parts_a, parts_b = intervals.components(a), intervals.components(b)
    products = [intervals.multiply(x, y) for x, y in zip(parts_a, parts_b, strict=True)]
    # Each sum of the three may have been rounded by a unit in the last place of any partial sum.
    slack = sum(intervals.size(product) for product in products) * 1e-15
    exact = intervals.widened(result, slack)
    new_a, new_b = [], []
    for place in range(3):
        rest = exact
        for other in range(3):
            if other != place:
                rest = intervals.subtract(rest, products[other])
        new_a.append(intervals.divide(rest, parts_b[place]))
        new_b.append(intervals.divide(rest, parts_a[place]))
    return [intervals.stacked(new_a), intervals.stacked(new_b)]


_TURNS = ((1, 2), (2, 0), (0, 1))
"""Components that make each component of a vector product."""


def _cross_bounds(_payload: object, a: Bounds, b: Bounds) -> Bounds:
    p, q = intervals.components(a), intervals.components(b)
    return intervals.stacked(
        [
            intervals.subtract(intervals.multiply(p[i], q[j]), intervals.multiply(p[j], q[i]))
            for i, j in _TURNS
        ]
    )


def _distance_inverse(_payload: object, result: Bounds, a: Bounds, b: Bounds) -> list[Bounds]:
    difference = intervals.subtract(a, b)
    narrowed = intervals.stacked(sides(result, intervals.components(difference)))
    difference = before_rounding(Bounds(*_met(narrowed, difference)))
    return [intervals.add(difference, b), intervals.subtract(a, difference)]


def _met(first: Bounds, second: Bounds) -> tuple[Any, Any]:
    met = first.meet(second)
    # An empty part stays visibly empty through the sums that follow.
    empty = met.lower > met.upper
    return np.where(empty, np.inf, met.lower), np.where(empty, -np.inf, met.upper)


def _distance_solver(terms: Terms, _payload: object, a: Any, b: Any) -> Any:
    return root_of_squares(terms, [x - y for x, y in zip(a, b, strict=True)])


def _angle_bounds(across: Bounds, along: Bounds) -> Bounds:
    """Return bounds of ``atan2(across, along)``, from the corners unless the box touches the cut or the origin."""
    corners = [np.arctan2(y, x) for y in (across.lower, across.upper) for x in (along.lower, along.upper)]
    lower = np.minimum(np.minimum(corners[0], corners[1]), np.minimum(corners[2], corners[3]))
    upper = np.maximum(np.maximum(corners[0], corners[1]), np.maximum(corners[2], corners[3]))
    cut = (along.lower <= 0) & (across.lower <= 0) & (across.upper >= 0)
    margin = 1e-14
    lower = np.where(cut, -math.pi, np.maximum(lower - margin, -math.pi))
    return Bounds(lower, np.where(cut, math.pi, np.minimum(upper + margin, math.pi)))


def _azimuth_bounds(_payload: object, vector: Bounds) -> Bounds:
    x, y, _ = intervals.components(vector)
    # North, the zero of azimuths, is the y axis: a quarter turn takes it to where atan2 is zero.
    angle = _angle_bounds(intervals.negative(x), y)
    # A direction next to South may, once rounded, appear on the other side of the seam.
    seam = (angle.upper > math.pi - 1e-12) | (angle.lower < -math.pi + 1e-12)
    bounds = Bounds(np.where(seam, -math.pi, angle.lower), np.where(seam, math.pi, angle.upper))
    return intervals.doubtful(bounds, x, y)


def _altitude_bounds(_payload: object, vector: Bounds) -> Bounds:
    x, y, z = intervals.components(vector)
    angle = _angle_bounds(z, length_bounds([x, y]))
    half = math.pi / 2
    bounds = Bounds(np.maximum(angle.lower, -half), np.minimum(angle.upper, half))
    return intervals.doubtful(bounds, x, y, z)


def _normalized_bounds(_payload: object, vector: Bounds) -> Bounds:
    length = intervals.spread(_norm_bounds(None, vector), 2)
    quotient = intervals.divide(vector, length)
    # No component is longer than the vector.
    one = 1 + 1e-15
    bounds = Bounds(np.clip(quotient.lower, -one, one), np.clip(quotient.upper, -one, one))
    sign = Bounds(
        np.where(vector.lower >= 0, np.maximum(bounds.lower, 0.0), bounds.lower),
        np.where(vector.upper <= 0, np.minimum(bounds.upper, 0.0), bounds.upper),
    )
    return intervals.doubtful(sign, *(intervals.spread(part, 2) for part in intervals.components(vector)))


def _part_of_vector(operands: Sequence[Node], payload: int) -> Node | None:
    """Return a component of a vector that was made of numbers is that number."""
    (vector,) = operands
    if vector.operation.name != "vector":
        return None
    part = vector.operands[payload]
    return part if part.kind is Kind.SCALAR else None


OPERATIONS = (
    stacking(
        "vector",
        always(Kind.VECTOR),
        _vector,
        "The vector of three numbers, in metres.",
        bounds=lambda _payload, *parts: intervals.stacked(parts),
        inverse=lambda _payload, result, *_parts: intervals.components(result),
        solver=lambda terms, _payload, *parts: tuple(terms.number(part) for part in parts),
        scalar=lambda _payload, x, y, z: (float(x), float(y), float(z)),
    ),
    stacking(
        "component",
        always(Kind.SCALAR),
        lambda call, vector: np.ascontiguousarray(vector[..., call.payload]),
        "One component of a vector; payload 0, 1 or 2.",
        bounds=lambda payload, vector: intervals.component(vector, payload),
        inverse=_component_inverse,
        solver=lambda _terms, payload, vector: vector[payload],
        rewrite=_part_of_vector,
        scalar=lambda payload, vector: vector[payload],
    ),
    stacking(
        "norm",
        always(Kind.SCALAR),
        _norm,
        "Euclidean length of a vector.",
        bounds=_norm_bounds,
        inverse=_norm_inverse,
        solver=lambda terms, _payload, vector: root_of_squares(terms, vector),
        scalar=_norm_scalar,
    ),
    stacking(
        "dot",
        always(Kind.SCALAR),
        _dot,
        "Scalar product of two vectors.",
        bounds=_dot_bounds,
        inverse=_dot_inverse,
        solver=lambda _terms, _payload, a, b: a[0] * b[0] + a[1] * b[1] + a[2] * b[2],
        scalar=lambda _payload, a, b: a[0] * b[0] + a[1] * b[1] + a[2] * b[2],
    ),
    stacking(
        "cross",
        always(Kind.VECTOR),
        _cross,
        "Vector product of two vectors.",
        bounds=_cross_bounds,
        solver=lambda _terms, _payload, a, b: tuple(a[i] * b[j] - a[j] * b[i] for i, j in _TURNS),
        scalar=_cross_scalar,
    ),
    stacking(
        "distance",
        always(Kind.SCALAR),
        _distance,
        "Euclidean distance between two points.",
        bounds=lambda _payload, a, b: length_bounds(intervals.components(intervals.subtract(a, b))),
        inverse=_distance_inverse,
        solver=_distance_solver,
        scalar=lambda _payload, a, b: _norm_scalar(None, (a[0] - b[0], a[1] - b[1], a[2] - b[2])),
    ),
    stacking(
        "azimuth",
        always(Kind.SCALAR),
        _azimuth,
        "Direction of a vector in the horizontal plane: radians from North, anticlockwise, within [-pi, pi].",
        bounds=_azimuth_bounds,
        solver=lambda terms, _payload, _vector: within(terms, -math.pi, math.pi),
        scalar=lambda _payload, vector: normal_angle(float(np.arctan2(vector[1], vector[0])) - np.pi / 2),
    ),
    stacking(
        "altitude",
        always(Kind.SCALAR),
        _altitude,
        "Radians by which a vector rises above the horizon.",
        bounds=_altitude_bounds,
        solver=lambda terms, _payload, _vector: within(terms, -math.pi / 2, math.pi / 2),
        scalar=_altitude_scalar,
    ),
    stacking(
        "normalized",
        always(Kind.VECTOR),
        _normalized,
        "The unit vector of the same direction; zero stays.",
        bounds=_normalized_bounds,
        solver=lambda terms, _payload, _vector: tuple(within(terms, -1.0, 1.0) for _ in range(3)),
        scalar=_normalized_scalar,
    ),
)
