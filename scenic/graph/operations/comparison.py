"""Comparisons, minimum and maximum."""

import operator
from collections.abc import Callable, Sequence
from typing import Any

import numpy as np

from scenic.graph import intervals
from scenic.graph.bounds import Bounds
from scenic.graph.kinds import Column, Kind
from scenic.graph.node import Node
from scenic.graph.operation import (
    BoundsReading,
    Call,
    InverseReading,
    SolverReading,
    Terms,
    always,
    stacking,
)
from scenic.graph.operations.inverse_readings import Mask, certain, truth, where
from scenic.graph.operations.numbers import are_exact, lane_by_lane
from scenic.graph.operations.solver_readings import conjunction


def _truth_of(function: Callable[[Any, Any], Any]) -> Callable[[Any, Any], bool]:
    def compare(a: object, b: object) -> bool:
        return bool(function(a, b))

    return compare


def _order(function: Callable[[Any, Any], Any], symbol: str) -> Callable[[Call, Column, Column], Column]:
    def batch(call: Call, a: Column, b: Column) -> Column:
        if any(kind.trailing for kind in call.kinds):
            what = f"'{symbol}' is not defined for vectors and orientations"
            call.fault(np.ones(1, dtype=np.bool_), TypeError(what))
            return call.everywhere(value=False)
        return _numbers(call, function, a, b)

    return batch


def _numbers(call: Call, function: Callable[[Any, Any], Any], a: Column, b: Column) -> Column:
    """Compare two columns exactly as Python does: an integer is compared with a float by value, not after rounding."""
    if a.dtype == b.dtype or are_exact(a, b):
        return np.asarray(function(a, b))
    return lane_by_lane(call, function, np.bool_, a, b)


def _same(call: Call, a: Column, b: Column) -> Column:
    one, other = (kind.trailing for kind in call.kinds)
    if not one and not other:
        return _numbers(call, operator.eq, a, b)
    if one != other:
        return call.everywhere(value=False)
    same = _all_components(a == b)
    # The two quaternions q and -q are one orientation.
    return same | _all_components(a == -b) if one == (4,) else same


def _all_components(parts: Column) -> Column:
    result = parts[..., 0]
    for index in range(1, parts.shape[-1]):
        result = result & parts[..., index]
    return result


# Bounds, inverses and terms of the orders. ``a > b`` is read as ``b < a``.


def _comparable(a: Bounds, b: Bounds) -> bool:
    return a.lower.ndim == b.lower.ndim == 1


def _numeric(a: Bounds, b: Bounds) -> Mask:
    """Return a mask of the boxes in which neither number can be NaN, with which every comparison except ``!=`` fails."""
    return np.asarray(~(intervals.infinite(a) | intervals.infinite(b)))


def _order_bounds(*, strict: bool, swapped: bool) -> BoundsReading:
    def bounds(_payload: object, a: Bounds, b: Bounds) -> Bounds | None:
        if not _comparable(a, b):
            return None
        if swapped:
            a, b = b, a
        true = a.upper < b.lower if strict else a.upper <= b.lower
        false = a.lower >= b.upper if strict else a.lower > b.upper
        return truth(true & _numeric(a, b), false)

    return bounds


def _order_inverse(*, strict: bool, swapped: bool) -> InverseReading:
    def inverse(_payload: object, result: Bounds, a: Bounds, b: Bounds) -> Sequence[Bounds | None]:
        if not _comparable(a, b):
            return [None, None]
        if swapped:
            a, b = b, a
        true, false = certain(result)
        low, high = _below(a, b, strict=strict)
        # Where it fails the other order holds, unless a number is NaN.
        false = false & _numeric(a, b)
        other_high, other_low = _below(b, a, strict=not strict)
        first = where(true, low).meet(where(false, other_low))
        second = where(true, high).meet(where(false, other_high))
        return [second, first] if swapped else [first, second]

    return inverse


def _below(a: Bounds, b: Bounds, *, strict: bool) -> tuple[Bounds, Bounds]:
    """Return the bounds of ``a`` and of ``b`` that follow from ``a < b`` (``strict``), or from ``a <= b``."""
    top, bottom = b.upper, a.lower
    if strict:
        top, bottom = np.nextafter(top, -np.inf), np.nextafter(bottom, np.inf)
    return Bounds(np.full_like(top, -np.inf), top), Bounds(bottom, np.full_like(bottom, np.inf))


def _order_solver(function: Callable[[Any, Any], Any]) -> SolverReading:
    def solver(terms: Terms, _payload: object, a: object, b: object) -> Any:
        if isinstance(a, tuple) or isinstance(b, tuple):
            return terms.fresh(Kind.BOOLEAN)
        return function(terms.number(a), terms.number(b))

    return solver


def _equal_certain(a: Bounds, b: Bounds) -> tuple[Mask, Mask] | None:
    """Return masks of the boxes in which two values are certainly equal, and certainly not equal; ``None`` for orientations."""
    if a.lower.shape[1:] != b.lower.shape[1:]:
        return np.zeros(1, dtype=np.bool_), np.ones(1, dtype=np.bool_)
    if a.lower.shape[1:] == (4,):
        return None
    apart = (a.upper < b.lower) | (b.upper < a.lower)
    same = (a.lower == a.upper) & (b.lower == b.upper) & (a.lower == b.lower) & _numeric(a, b)
    if apart.ndim == 1:
        return same, apart
    return np.asarray(same.all(axis=1)), np.asarray(apart.any(axis=1))


def _equal_bounds(_payload: object, a: Bounds, b: Bounds) -> Bounds | None:
    known = _equal_certain(a, b)
    return None if known is None else truth(*known)


def _differs_bounds(_payload: object, a: Bounds, b: Bounds) -> Bounds | None:
    known = _equal_certain(a, b)
    return None if known is None else truth(known[1], known[0])


def _meet_where(equal: Mask, a: Bounds, b: Bounds) -> Sequence[Bounds | None]:
    if a.lower.shape[1:] != b.lower.shape[1:] or a.lower.shape[1:] == (4,):
        return [None, None]
    return [where(equal, b), where(equal, a)]


def _equal_solver(terms: Terms, _payload: object, a: object, b: object) -> Any:
    if not isinstance(a, tuple) and not isinstance(b, tuple):
        return terms.number(a) == terms.number(b)
    if not (isinstance(a, tuple) and isinstance(b, tuple) and len(a) == len(b)):
        return terms.real(0) == terms.real(1)
    if len(a) == 4:
        return terms.fresh(Kind.BOOLEAN)
    return conjunction([x == y for x, y in zip(a, b, strict=True)])


# Minimum and maximum.


def _extreme_kind(operands: Sequence[Node], _payload: object) -> Kind:
    """Python gives back one of the arguments as it is, so that mixed kinds have no common column."""
    kinds = {operand.kind for operand in operands}
    return kinds.pop() if len(kinds) == 1 and all(kind.is_number for kind in kinds) else Kind.OTHER


def _extreme(better: Callable[[Any, Any], Any]) -> Callable[..., Column]:
    def batch(_call: Call, *columns: Column) -> Column:
        result = columns[0]
        for column in columns[1:]:
            # Python keeps the first of equals, which signs of zero and NaN can tell.
            result = np.where(better(column, result), column, result)
        return result

    return batch


def _fold(function: Callable[[Bounds, Bounds], Bounds], operands: Sequence[Bounds]) -> Bounds | None:
    if len(operands) < 2 or any(operand.lower.ndim > 1 for operand in operands):
        return None
    result = operands[0]
    for operand in operands[1:]:
        result = function(result, operand)
    return result


def _fold_bounds(function: Callable[[Bounds, Bounds], Bounds]) -> BoundsReading:
    return lambda _payload, *operands: _fold(function, operands)


def _minimum_inverse(_payload: object, result: Bounds, *operands: Bounds) -> Sequence[Bounds | None]:
    """No operand lies below the minimum; where only one reaches down to it, that one is the minimum."""
    if _fold(intervals.minimum, operands) is None:
        return [None] * len(operands)
    bounds = []
    for place, operand in enumerate(operands):
        others = [other for position, other in enumerate(operands) if position != place]
        alone = np.ones(1, dtype=np.bool_)
        numeric = np.asarray(~intervals.infinite(operand))
        for other in others:
            alone = alone & (other.lower > result.upper)
            numeric = numeric & ~intervals.infinite(other)
        lower = np.where(numeric, result.lower, -np.inf)
        bounds.append(Bounds(lower, np.where(numeric & alone, result.upper, np.inf)))
    return bounds


def _maximum_inverse(_payload: object, result: Bounds, *operands: Bounds) -> Sequence[Bounds | None]:
    mirrored = _minimum_inverse(None, intervals.negative(result), *(intervals.negative(a) for a in operands))
    return [None if bounds is None else intervals.negative(bounds) for bounds in mirrored]


def _extreme_solver(better: Callable[[Any, Any], Any]) -> SolverReading:
    def solver(terms: Terms, _payload: object, *operands: Any) -> Any:
        if len(operands) < 2 or any(isinstance(operand, tuple) for operand in operands):
            return None
        logical = all(terms.number(operand) is not operand for operand in operands)
        result, *others = (terms.number(operand) for operand in operands)
        for other in others:
            result = terms.either(better(other, result), other, result)
        return result == terms.real(1) if logical else result

    return solver


def _orders_vectors(operands: Sequence[Node], _payload: object) -> bool:
    """Return whether an operand is not a number, so that Python has no order for it."""
    return any(operand.kind.trailing for operand in operands)


OPERATIONS = (
    *(
        stacking(
            name,
            always(Kind.BOOLEAN),
            _order(compare, sign),
            f"Whether a {sign} b.",
            python=_truth_of(compare),
            bounds=_order_bounds(strict="=" not in sign, swapped=">" in sign),
            inverse=_order_inverse(strict="=" not in sign, swapped=">" in sign),
            solver=_order_solver(compare),
            faults=_orders_vectors,
        )
        for name, sign, compare in (
            ("less", "<", operator.lt),
            ("less or equal", "<=", operator.le),
            ("greater", ">", operator.gt),
            ("greater or equal", ">=", operator.ge),
        )
    ),
    stacking(
        "equal",
        always(Kind.BOOLEAN),
        _same,
        "Whether a == b; vectors by components, orientations up to the sign of the quaternion.",
        python=_truth_of(operator.eq),
        bounds=_equal_bounds,
        inverse=lambda _payload, result, a, b: _meet_where(certain(result)[0], a, b),
        solver=_equal_solver,
    ),
    stacking(
        "not equal",
        always(Kind.BOOLEAN),
        lambda call, a, b: ~_same(call, a, b),
        "Whether a != b.",
        python=_truth_of(operator.ne),
        bounds=_differs_bounds,
        inverse=lambda _payload, result, a, b: _meet_where(certain(result)[1], a, b),
        solver=lambda terms, payload, a, b: ~_equal_solver(terms, payload, a, b),
    ),
    *(
        stacking(
            name,
            _extreme_kind,
            _extreme(better),
            f"Python's `{python.__name__}` of two or more values, or of the items of one.",
            python=python,
            bounds=_fold_bounds(fold),
            inverse=inverse,
            solver=_extreme_solver(better),
        )
        for name, better, python, fold, inverse in (
            ("minimum", operator.lt, min, intervals.minimum, _minimum_inverse),
            ("maximum", operator.gt, max, intervals.maximum, _maximum_inverse),
        )
    ),
)
