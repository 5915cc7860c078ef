"""Sums, products and quotients of numbers and vectors."""

import operator
from collections.abc import Callable, Sequence
from typing import Any, Final

import numpy as np

from scenic.graph import intervals
from scenic.graph.bounds import Bounds
from scenic.graph.kinds import Column, Kind
from scenic.graph.node import Node
from scenic.graph.operation import BoundsReading, Call, KindRule, stacking
from scenic.graph.operations.inverse_readings import before_rounding, collapsed
from scenic.graph.operations.numbers import (
    are_exact,
    arithmetic_kind,
    as_integers,
    fail_as_python,
    lane_by_lane,
    where_defined,
)
from scenic.graph.operations.possible_faults import may_divide_by_zero
from scenic.graph.operations.solver_readings import componentwise


def _kind(reading: BoundsReading, *vectors: tuple[bool, ...]) -> KindRule:
    """As numbers, and a vector where the operands that are vectors stand as in one of ``vectors``."""
    numbers = arithmetic_kind(reading)

    def rule(operands: Sequence[Node], payload: object) -> Kind:
        pattern = tuple(operand.kind is Kind.VECTOR for operand in operands)
        fits = all(operand.kind.is_number or operand.kind is Kind.VECTOR for operand in operands)
        return Kind.VECTOR if fits and pattern in vectors else numbers(operands, payload)

    return rule


def _spread(column: Column, like: Column) -> Column:
    """A number's column made to broadcast against a vector's."""
    return column[..., np.newaxis] if column.ndim < like.ndim else column


def _elementwise(function: Callable[..., Column]) -> Callable[..., Column]:
    def batch(_call: Call, *columns: Column) -> Column:
        a, *rest = (as_integers(column) for column in columns)
        if not rest:
            return function(a)
        return function(_spread(a, rest[0]), _spread(rest[0], a))

    return batch


def _divide(call: Call, a: Column, b: Column) -> Column:
    a, b = as_integers(a), as_integers(b)
    zero = b == 0
    if zero.any():
        # The divisor is a number even where a vector is divided; Python's error is the same for its components.
        fail_as_python(call, zero, operator.truediv, a if a.ndim == b.ndim else a[..., 0], b)
        b = np.where(zero, np.ones_like(b), b)
    if not (a.dtype == b.dtype == np.int64) or are_exact(a, b):
        return np.asarray(_spread(a, b) / _spread(b, a))
    return lane_by_lane(call, operator.truediv, float, a, b)


def _divide_kind(operands: Sequence[Node], _payload: object) -> Kind:
    a, b = (operand.kind for operand in operands)
    if not b.is_number:
        return Kind.OTHER
    if a is Kind.VECTOR:
        return Kind.VECTOR
    return Kind.SCALAR if a.is_number else Kind.OTHER


def _add_bounds(_payload: object, a: Bounds, b: Bounds) -> Bounds:
    return intervals.add(a, b)


def _add_inverse(_payload: object, result: Bounds, a: Bounds, b: Bounds) -> list[Bounds]:
    exact = before_rounding(result)
    return [intervals.subtract(exact, b), intervals.subtract(exact, a)]


def _subtract_bounds(_payload: object, a: Bounds, b: Bounds) -> Bounds:
    return intervals.subtract(a, b)


def _subtract_inverse(_payload: object, result: Bounds, a: Bounds, b: Bounds) -> list[Bounds]:
    exact = before_rounding(result)
    return [intervals.add(exact, b), intervals.subtract(a, exact)]


def _multiply_bounds(_payload: object, a: Bounds, b: Bounds) -> Bounds:
    return intervals.multiply(a, b)


def _multiply_inverse(_payload: object, result: Bounds, a: Bounds, b: Bounds) -> list[Bounds]:
    exact = before_rounding(result)
    return [collapsed(intervals.divide(exact, b), a), collapsed(intervals.divide(exact, a), b)]


def _divide_inverse(_payload: object, result: Bounds, a: Bounds, b: Bounds) -> list[Bounds]:
    exact = before_rounding(result)
    return [intervals.multiply(exact, b), collapsed(intervals.divide(a, exact), b)]


def _negative_bounds(_payload: object, a: Bounds) -> Bounds:
    return intervals.negative(a)


def _positive_bounds(_payload: object, a: Bounds) -> Bounds:
    return a


def _absolute_bounds(_payload: object, a: Bounds) -> Bounds:
    return intervals.absolute(a)


def _absolute_inverse(_payload: object, result: Bounds, a: Bounds) -> list[Bounds]:
    lower = np.where(a.lower >= 0, result.lower, -result.upper)
    upper = np.where(a.upper <= 0, -result.lower, result.upper)
    return [Bounds(lower, upper)]


# On plain numbers; vectors are triples.


def _add_scalar(_payload: object, a: Any, b: Any) -> Any:
    if type(a) is tuple:
        both = type(b) is tuple and len(a) == len(b) == 3
        return (a[0] + b[0], a[1] + b[1], a[2] + b[2]) if both else NotImplemented
    return NotImplemented if type(b) is tuple else a + b


def _subtract_scalar(_payload: object, a: Any, b: Any) -> Any:
    if type(a) is tuple:
        both = type(b) is tuple and len(a) == len(b) == 3
        return (a[0] - b[0], a[1] - b[1], a[2] - b[2]) if both else NotImplemented
    return NotImplemented if type(b) is tuple else a - b


def _multiply_scalar(_payload: object, a: Any, b: Any) -> Any:
    if type(a) is tuple:
        return NotImplemented if type(b) is tuple or len(a) != 3 else (a[0] * b, a[1] * b, a[2] * b)
    if type(b) is tuple:
        return (a * b[0], a * b[1], a * b[2]) if len(b) == 3 else NotImplemented
    return a * b


def _divide_scalar(_payload: object, a: Any, b: Any) -> Any:
    if type(b) is tuple:
        return NotImplemented
    if type(a) is tuple:
        return (a[0] / b, a[1] / b, a[2] / b) if len(a) == 3 else NotImplemented
    return a / b


def _negative_scalar(_payload: object, a: Any) -> Any:
    if type(a) is tuple:
        return (-a[0], -a[1], -a[2]) if len(a) == 3 else NotImplemented
    return -a


# Simpler nodes of the same value.


def _is_number(operand: Node, number: float) -> bool:
    """Return whether an operand is this number, of a kind that makes no float of a whole number."""
    return operand.is_constant and operand.kind.is_number and operand.value == number


def _keeps(operand: Node, other: Node) -> bool:
    """Return whether arithmetic with ``other``, a number that changes no value, leaves ``operand`` as it is."""
    return operand.kind in (Kind.SCALAR, Kind.VECTOR) or (operand.kind is other.kind is Kind.INTEGER)


def _is_zero_vector(operand: Node) -> bool:
    return operand.is_constant and operand.kind is Kind.VECTOR and not operand.payload.column.any()


def _without_zero(operands: Sequence[Node], _payload: object) -> Node | None:
    for operand, other in (operands, operands[::-1]):
        if operand.kind is Kind.VECTOR and _is_zero_vector(other):
            return operand
        if operand.kind.is_number and _is_number(other, 0) and _keeps(operand, other):
            return operand
    return None


def _minus_zero(operands: Sequence[Node], _payload: object) -> Node | None:
    operand, other = operands
    if operand.kind is Kind.VECTOR and _is_zero_vector(other):
        return operand
    if operand.kind.is_number and _is_number(other, 0) and _keeps(operand, other):
        return operand
    return None


def _times_one(operands: Sequence[Node], _payload: object) -> Node | None:
    for operand, other in (operands, operands[::-1]):
        if _is_number(other, 1) and _keeps(operand, other):
            return operand
    return None


def _over_one(operands: Sequence[Node], _payload: object) -> Node | None:
    operand, other = operands
    simple = _is_number(other, 1) and operand.kind in (Kind.SCALAR, Kind.VECTOR)
    return operand if simple else None


OPERATIONS = (
    stacking(
        "add",
        _kind(_add_bounds, (True, True)),
        _elementwise(np.add),
        "The sum of two numbers or two vectors.",
        python=operator.add,
        bounds=where_defined(_add_bounds, (True, True)),
        inverse=_add_inverse,
        solver=componentwise(lambda _terms, a, b: a + b, (True, True)),
        rewrite=_without_zero,
        scalar=_add_scalar,
    ),
    stacking(
        "subtract",
        _kind(_subtract_bounds, (True, True)),
        _elementwise(np.subtract),
        "The difference of two numbers or two vectors.",
        python=operator.sub,
        bounds=where_defined(_subtract_bounds, (True, True)),
        inverse=_subtract_inverse,
        solver=componentwise(lambda _terms, a, b: a - b, (True, True)),
        rewrite=_minus_zero,
        scalar=_subtract_scalar,
    ),
    stacking(
        "multiply",
        _kind(_multiply_bounds, (True, False), (False, True)),
        _elementwise(np.multiply),
        "The product of two numbers, or of a vector and a number.",
        python=operator.mul,
        bounds=where_defined(_multiply_bounds, (True, False), (False, True)),
        inverse=_multiply_inverse,
        solver=componentwise(lambda _terms, a, b: a * b, (True, False), (False, True)),
        rewrite=_times_one,
        scalar=_multiply_scalar,
    ),
    stacking(
        "divide",
        _divide_kind,
        _divide,
        "The quotient of two numbers, or of a vector by a number; dividing by zero is a fault.",
        python=operator.truediv,
        bounds=where_defined(lambda _payload, a, b: intervals.divide(a, b), (True, False)),
        inverse=_divide_inverse,
        solver=componentwise(lambda _terms, a, b: a / b, (True, False)),
        faults=may_divide_by_zero,
        rewrite=_over_one,
        scalar=_divide_scalar,
    ),
    stacking(
        "negative",
        _kind(_negative_bounds, (True,)),
        _elementwise(np.negative),
        "The opposite number or vector.",
        python=operator.neg,
        bounds=where_defined(_negative_bounds, (True,)),
        inverse=lambda _payload, result, _a: [intervals.negative(result)],
        solver=componentwise(lambda _terms, a: -a, (True,)),
        scalar=_negative_scalar,
    ),
    stacking(
        "positive",
        _kind(_positive_bounds, (True,)),
        _elementwise(np.positive),
        "The number or vector itself; a truth value becomes an integer.",
        python=operator.pos,
        bounds=where_defined(_positive_bounds, (True,)),
        inverse=lambda _payload, result, _a: [result],
        solver=componentwise(lambda _terms, a: a, (True,)),
    ),
    stacking(
        "absolute",
        arithmetic_kind(_absolute_bounds),
        _elementwise(np.abs),
        "The absolute value of a number.",
        python=abs,
        bounds=where_defined(_absolute_bounds),
        inverse=_absolute_inverse,
        solver=componentwise(lambda terms, a: terms.either(a >= terms.real(0), a, -a)),
    ),
)

ADD: Final = OPERATIONS[0]
NEGATIVE: Final = OPERATIONS[4]
