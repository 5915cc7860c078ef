"""Conversions, lengths, items and truth values."""

import operator
from collections.abc import Sequence
from typing import Any

import numpy as np

from scenic.graph.bounds import Bounds
from scenic.graph.kinds import Column, Kind
from scenic.graph.node import Node
from scenic.graph.operation import Call, Operation, Terms, always, by_lane, stacking
from scenic.graph.operations.inverse_readings import before_rounding, certain, truth, where


def _len(_call: Call, value: Column) -> Column:
    return np.full(1, value.shape[1], dtype=np.int64)


def _len_kind(operands: Sequence[Node], _payload: object) -> Kind:
    kind = operands[0].kind
    return Kind.INTEGER if kind is Kind.VECTOR or kind.is_boxed else Kind.OTHER


def _getitem_kind(operands: Sequence[Node], _payload: object) -> Kind:
    container, item = operands
    whole = item.kind in (Kind.INTEGER, Kind.BOOLEAN)
    return Kind.SCALAR if container.kind is Kind.VECTOR and whole else Kind.OTHER


def _getitem(call: Call, container: Column, item: Column) -> Column:
    item = item.astype(np.int64)
    outside = (item < -3) | (item > 2)
    if outside.any():
        call.fault(outside, IndexError("a vector has three components"))
    place = np.where(outside, 0, item % 3)
    return container[np.arange(len(container)), place]


def _truth(call: Call, value: Column) -> Column:
    # A vector is true whatever its components: it has three items. So is an orientation, like any other object.
    return call.everywhere(value=True) if call.kinds[0].trailing else value != 0


def _len_bounds(_payload: object, value: Bounds) -> Bounds | None:
    return Bounds.exactly(value.lower.shape[1]) if value.lower.ndim == 2 else None


def _len_solver(terms: Terms, _payload: object, value: object) -> Any:
    return terms.real(len(value)) if isinstance(value, tuple) else terms.fresh(Kind.INTEGER)


def _getitem_bounds(_payload: object, container: Bounds, _item: Bounds) -> Bounds | None:
    if container.lower.ndim != 2:
        return None
    return Bounds(container.lower.min(axis=1), container.upper.max(axis=1))


def _getitem_solver(terms: Terms, _payload: object, container: object, item: object) -> Any:
    index = terms.constant(item)
    if isinstance(container, tuple) and index is not None and index in range(-3, 3):
        return container[int(index)]
    return terms.fresh(Kind.SCALAR) if isinstance(container, tuple) else None


def _truth_bounds(_payload: object, value: Bounds) -> Bounds:
    if value.lower.ndim > 1:
        return Bounds.exactly(1)
    return truth((value.lower > 0) | (value.upper < 0), (value.lower == 0) & (value.upper == 0))


def _truth_inverse(_payload: object, result: Bounds, value: Bounds) -> list[Bounds | None]:
    if value.lower.ndim > 1:
        return [None]
    _, false = certain(result)
    return [where(false, Bounds(np.zeros_like(value.lower), np.zeros_like(value.upper)))]


def _truth_solver(terms: Terms, _payload: object, value: object) -> Any:
    if isinstance(value, tuple):
        return terms.real(0) == terms.real(0)
    return terms.number(value) != terms.real(0)


def _may_miss(operands: Sequence[Node], _payload: object) -> bool:
    """Return whether an index may lie outside a vector."""
    limits = operands[1].limits
    return limits is None or limits[0] < -3 or limits[1] > 2


OPERATIONS = (
    stacking(
        "float",
        always(Kind.SCALAR),
        lambda _call, number: number.astype(np.float64),
        "Python's `float`.",
        python=float,
        bounds=lambda _payload, number: number if number.lower.ndim == 1 else None,
        inverse=lambda _payload, result, _number: [before_rounding(result)],
        solver=lambda terms, _payload, number: terms.number(number),
    ),
    Operation("str", always(Kind.OTHER), by_lane, "Python's `str`.", python=str),
    Operation("len", _len_kind, _len, "Python's `len`.", python=len, bounds=_len_bounds, solver=_len_solver),
    Operation(
        "getitem",
        _getitem_kind,
        _getitem,
        "An item of a container, or a component of a vector.",
        python=operator.getitem,
        bounds=_getitem_bounds,
        solver=_getitem_solver,
        faults=_may_miss,
    ),
    stacking(
        "truth",
        always(Kind.BOOLEAN),
        _truth,
        "Python's truth value.",
        python=bool,
        bounds=_truth_bounds,
        inverse=_truth_inverse,
        solver=_truth_solver,
    ),
)
