"""Floor division, powers and rounding: the operations whose results depend on numbers being whole."""

import operator
from collections.abc import Sequence
from typing import Any

import numpy as np

from scenic.graph import intervals
from scenic.graph.bounding import overall, whole_limits
from scenic.graph.bounds import Bounds
from scenic.graph.kinds import Column, Kind
from scenic.graph.node import Node
from scenic.graph.operation import Call, Operation, Terms, always, by_lane, stacking
from scenic.graph.operations.inverse_readings import before_rounding
from scenic.graph.operations.numbers import (
    arithmetic_kind,
    as_integers,
    fail_as_python,
    lane_by_lane,
    where_defined,
)
from scenic.graph.operations.possible_faults import may_divide_by_zero
from scenic.graph.operations.solver_readings import componentwise


def _floor_divide(call: Call, a: Column, b: Column) -> Column:
    a, b = as_integers(a), as_integers(b)
    zero = b == 0
    fail_as_python(call, zero, operator.floordiv, a, b)
    return np.floor_divide(a, np.where(zero, np.ones_like(b), b))


def _modulo(call: Call, a: Column, b: Column) -> Column:
    a, b = as_integers(a), as_integers(b)
    zero = b == 0
    fail_as_python(call, zero, operator.mod, a, b)
    return np.remainder(a, np.where(zero, np.ones_like(b), b))


def _power_kind(operands: Sequence[Node], payload: object) -> Kind:
    base, exponent = operands
    if not (base.kind.is_number and exponent.kind.is_number):
        return Kind.OTHER
    if Kind.SCALAR in (base.kind, exponent.kind):
        return Kind.SCALAR
    # Whole numbers: the sign of the exponent decides between an integer and a float.
    signs = overall(exponent)
    if signs is not None and signs.upper[0] < 0:
        return Kind.SCALAR
    if (
        signs is not None
        and signs.lower[0] >= 0
        and whole_limits(_power_bounds, operands, payload) is not None
    ):
        return Kind.INTEGER
    return Kind.OTHER


def _power(call: Call, a: Column, b: Column) -> Column:
    a, b = as_integers(a), as_integers(b)
    # NumPy's power differs from the C library's that Python uses, so every lane asks Python. Whether whole numbers
    # give a whole number was settled when the node was made: then no exponent is negative.
    whole = a.dtype == b.dtype == np.int64 and not (b < 0).any()
    return lane_by_lane(call, operator.pow, np.int64 if whole else np.float64, a, b)


def _round_kind(operands: Sequence[Node], payload: object) -> Kind:
    number, *digits = operands
    if not number.kind.is_number or any(not digit.kind.is_number for digit in digits):
        return Kind.OTHER
    if digits:
        return Kind.SCALAR if number.kind is Kind.SCALAR and digits[0].kind is not Kind.SCALAR else Kind.OTHER
    return Kind.INTEGER if whole_limits(_round_bounds, operands, payload) is not None else Kind.OTHER


def _round(call: Call, number: Column, *digits: Column) -> Column:
    if digits:
        return lane_by_lane(call, round, np.float64, number, as_integers(digits[0]))
    if number.dtype == np.float64:
        # The nearest whole number, halves to the even one, as in Python.
        return _whole(np.rint(number))
    return as_integers(number)


def _int_kind(operands: Sequence[Node], payload: object) -> Kind:
    if not operands[0].kind.is_number:
        return Kind.OTHER
    return Kind.INTEGER if whole_limits(_int_bounds, operands, payload) is not None else Kind.OTHER


def _whole(values: Column) -> Column:
    """Convert floats to integers; lanes that failed before may contain any number, even one that no integer represents."""
    return np.where(np.abs(values) < 2.0**62, values, 0.0).astype(np.int64)


def _floor_divide_bounds(_payload: object, a: Bounds, b: Bounds) -> Bounds:
    return intervals.floor_divide(a, b)


def _floor_divide_inverse(_payload: object, result: Bounds, _a: Bounds, b: Bounds) -> list[Bounds | None]:
    quotient = before_rounding(Bounds(result.lower, result.upper + 1), 2)
    return [intervals.multiply(quotient, b), None]


def _floor_divide_solver(terms: Terms, a: Any, b: Any) -> Any:
    if not terms.constant(b):
        return terms.fresh(Kind.SCALAR)
    return terms.integer_part(a / b)


def _modulo_bounds(_payload: object, a: Bounds, b: Bounds) -> Bounds:
    return intervals.modulo(a, b)


def _modulo_solver(terms: Terms, a: Any, b: Any) -> Any:
    if not terms.constant(b):
        return terms.fresh(Kind.SCALAR)
    return a - b * terms.integer_part(a / b)


def _power_bounds(_payload: object, a: Bounds, b: Bounds) -> Bounds:
    return intervals.power(a, b)


def _power_inverse(_payload: object, result: Bounds, a: Bounds, b: Bounds) -> list[Bounds | None]:
    """Return the root, where the exponent is one positive number."""
    has_one_exponent = (b.lower == b.upper) & (b.lower > 0)
    exponent = np.where(has_one_exponent, b.lower, 1.0)
    odd = np.mod(exponent, 2) == 1
    even = np.mod(exponent, 2) == 0
    # With a small exponent very different bases have the same rounded power; the root's own error grows with the
    # logarithm of the base.
    exact = before_rounding(result, 4)
    roots = intervals.relaxed(Bounds(_root(exact.lower, exponent), _root(exact.upper, exponent)), 1e-12)
    low, high = np.maximum(roots.lower, 0.0), np.maximum(roots.upper, 0.0)
    # An even power hides the sign of its base; a broken one admits no negative base.
    lower = np.where(odd, roots.lower, np.where(even & (a.lower < 0), -high, low))
    upper = np.where(odd, roots.upper, np.where(even & (a.upper <= 0), -low, high))
    return [
        Bounds(np.where(has_one_exponent, lower, -np.inf), np.where(has_one_exponent, upper, np.inf)),
        None,
    ]


def _root(value: Column, exponent: Column) -> Column:
    return np.asarray(np.sign(value) * np.abs(value) ** (1 / exponent))


def _power_solver(terms: Terms, a: object, b: object) -> Any:
    exponent = terms.constant(b)
    if exponent == 0.5:
        root = terms.fresh(Kind.SCALAR)
        zero = terms.real(0)
        terms.define((a < zero) | ((root >= zero) & (root * root == a)))
        return root
    if exponent is None or exponent not in range(5):
        return terms.fresh(Kind.SCALAR)
    result = terms.real(1)
    for _ in range(int(exponent)):
        result = result * a
    return result


def _round_bounds(_payload: object, number: Bounds, *digits: Bounds) -> Bounds:
    if not digits:
        return Bounds(np.rint(number.lower), np.rint(number.upper))
    return intervals.widened(number, _unit(digits[0]))


def _round_inverse(_payload: object, result: Bounds, _number: Bounds, *digits: Bounds) -> list[Bounds | None]:
    if not digits:
        return [Bounds(result.lower - 0.5, result.upper + 0.5)]
    return [intervals.widened(result, _unit(digits[0])), None]


def _unit(digits: Bounds) -> Any:
    """The place to which a number is rounded, which rounding never exceeds."""
    return 10.0 ** -np.maximum(digits.lower, -400.0)


def _round_solver(terms: Terms, number: object, *digits: Any) -> Any:
    if digits:
        return terms.fresh(Kind.SCALAR)
    # Halves go to the even neighbour; either neighbour is allowed here.
    half = terms.real(0.5)
    low = terms.integer_part(number + half)
    at_half = terms.integer_part(number + half) == number + half
    down = terms.fresh(Kind.BOOLEAN)
    return terms.either(at_half & down, low - terms.real(1), low)


def _int_bounds(_payload: object, number: Bounds) -> Bounds:
    return Bounds(np.trunc(number.lower), np.trunc(number.upper))


def _int_inverse(_payload: object, result: Bounds, _number: Bounds) -> list[Bounds]:
    lower = np.where(result.lower > 0, result.lower, result.lower - 1)
    return [Bounds(lower, np.where(result.upper < 0, result.upper, result.upper + 1))]


def _int_solver(terms: Terms, number: Any) -> Any:
    return terms.either(number >= terms.real(0), terms.integer_part(number), -terms.integer_part(-number))


OPERATIONS = (
    stacking(
        "floor divide",
        arithmetic_kind(_floor_divide_bounds),
        _floor_divide,
        "Python's `//`; dividing by zero is a fault.",
        python=operator.floordiv,
        bounds=where_defined(_floor_divide_bounds),
        inverse=_floor_divide_inverse,
        solver=componentwise(_floor_divide_solver),
        faults=may_divide_by_zero,
    ),
    stacking(
        "modulo",
        arithmetic_kind(_modulo_bounds),
        _modulo,
        "Python's `%`; dividing by zero is a fault.",
        python=operator.mod,
        bounds=where_defined(_modulo_bounds),
        solver=componentwise(_modulo_solver),
        faults=may_divide_by_zero,
    ),
    Operation(
        "divmod",
        always(Kind.OTHER),
        by_lane,
        "Python's `divmod`: quotient and remainder as a tuple.",
        python=divmod,
    ),
    stacking(
        "power",
        _power_kind,
        _power,
        "Python's `**`; where that is complex or not defined, a fault.",
        python=operator.pow,
        bounds=where_defined(_power_bounds),
        inverse=_power_inverse,
        solver=componentwise(_power_solver),
        faults=True,
    ),
    stacking(
        "round",
        _round_kind,
        _round,
        "Python's `round`, with or without a number of digits.",
        python=round,
        bounds=where_defined(_round_bounds),
        inverse=_round_inverse,
        solver=componentwise(_round_solver),
        faults=lambda operands, _payload: len(operands) > 1,
    ),
    stacking(
        "int",
        _int_kind,
        lambda _call, number: _whole(np.trunc(number)) if number.dtype == np.float64 else as_integers(number),
        "Python's `int` of a number: broken parts are cut off.",
        python=int,
        bounds=where_defined(_int_bounds),
        inverse=_int_inverse,
        solver=componentwise(_int_solver),
    ),
)
