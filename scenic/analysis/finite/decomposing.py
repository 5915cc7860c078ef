"""Checks on many discrete values, taken apart: each inner value that has few values is a variable of its own.

A sum of ten digits is a chain of sums of two. So is any value that operations make of others step by step: each step is a
table over its operands and its result. Results that carry no draw of their own are *passed on*: given the draws they are fixed.
"""

from collections.abc import Mapping
from typing import Any, Final

import numpy as np
from numpy.typing import NDArray

from scenic.analysis.finite.tables import Table
from scenic.analysis.finite.variables import Variable
from scenic.dataclass import dataclass
from scenic.graph.kinds import Column, Kind
from scenic.graph.node import Node
from scenic.graph.operation import Call
from scenic.runtime.values.values import CODEC

__all__ = ["Decomposer"]

MOST_VALUES: Final = 1 << 10
"""Values of an inner variable, at most."""

LARGEST: Final = 1 << 20
"""Entries of a table, at most."""

_FOLDED: Final = ("and", "or", "minimum", "maximum")
"""Operations on any number of operands that are taken two at a time."""


@dataclass(frozen=True, slots=True, eq=False)
class _Value:
    """A value as a function of one variable, its column ``(d, ...)`` by the variable's value; a constant has no variable."""

    variable: int | None
    column: Column
    kind: Kind


class _TooLargeError(Exception):
    """Raised where a value has too many values, or may fail."""


class Decomposer:
    """Takes checks apart.

    Args:
        variables: the finite axes.
        numbers: their numbers as variables.
        sizes: the numbers of values of all variables; those that are made are added.

    """

    def __init__(
        self, variables: Mapping[Node, Variable], numbers: Mapping[Node, int], sizes: list[int]
    ) -> None:
        self._variables = variables
        self._numbers = numbers
        self._sizes = sizes
        self._values: dict[Node, _Value] = {}
        self._defining: dict[int, Table] = {}
        """The tables that define inner variables, by their numbers."""
        self._below: dict[int, tuple[int, ...]] = {}

    def tables(self, node: Node) -> list[Table] | None:
        """Return tables that hold together where a condition holds; ``None`` where the condition cannot be decomposed."""
        try:
            columns, scope, kinds = self._operands(node)
            column, shape = _applied(node, columns, kinds)
        except _TooLargeError:
            return None
        final = Table(scope, column.astype(np.bool_).reshape(shape))
        variables: dict[int, None] = {}
        stack = list(scope)
        while stack:
            variable = stack.pop()
            if variable in self._defining and variable not in variables:
                variables[variable] = None
                stack += self._below[variable]
        return [*(self._defining[variable] for variable in variables), final]

    def _operands(self, node: Node) -> tuple[list[_Value], tuple[int, ...], tuple[Kind, ...]]:
        values = [self._value(operand) for operand in node.operands]
        if node.operation.name in _FOLDED and len(values) > 2:
            first = values[0]
            for other in values[1:-1]:
                first = self._passed_on(node, [first, other])
            values = [first, values[-1]]
        scope = tuple(dict.fromkeys(value.variable for value in values if value.variable is not None))
        return values, scope, tuple(value.kind for value in values)

    def _value(self, node: Node) -> _Value:
        known = self._values.get(node)
        if known is None:
            known = self._values[node] = self._made(node)
        return known

    def _made(self, node: Node) -> _Value:
        if node.is_constant:
            return _Value(None, node.payload.column, node.kind)
        if node in self._variables:
            return _Value(self._numbers[node], self._variables[node].middles, Kind.SCALAR)
        if node.is_drawn:
            raise _TooLargeError
        values, _, _ = self._operands(node)
        return self._passed_on(node, values)

    def _passed_on(self, node: Node, values: list[_Value]) -> _Value:
        """Return the value of an operation on others, as an inner variable where these have more than one."""
        column, shape = _applied(node, values, tuple(value.kind for value in values))
        scope = tuple(dict.fromkeys(value.variable for value in values if value.variable is not None))
        if len(scope) < 2:
            return _Value(scope[0] if scope else None, column, node.kind)
        rows = np.ascontiguousarray(column).reshape(len(column), -1).view(np.uint8).reshape(len(column), -1)
        _, first, place = np.unique(rows, axis=0, return_index=True, return_inverse=True)
        if len(first) > MOST_VALUES or len(first) * len(column) > LARGEST:
            raise _TooLargeError
        number = len(self._sizes)
        self._sizes.append(len(first))
        relation = np.zeros((len(column), len(first)), dtype=np.bool_)
        relation[np.arange(len(column)), place.reshape(-1)] = True
        self._defining[number] = Table((*scope, number), relation.reshape(*shape, len(first)))
        self._below[number] = scope
        return _Value(number, column[first], node.kind)


def _applied(node: Node, values: list[_Value], kinds: tuple[Kind, ...]) -> tuple[Column, tuple[int, ...]]:
    """Return the values of an operation for all combinations of the variables of its operands, and how many these have."""
    operation = node.operation
    if not operation.pure or node.kind.is_boxed or any(kind.is_boxed for kind in kinds):
        raise _TooLargeError
    scope: dict[int, int] = {}
    for value in values:
        if value.variable is not None:
            scope.setdefault(value.variable, len(value.column))
    shape = tuple(scope.values())
    count = int(np.prod(shape, dtype=np.float64))
    if count > LARGEST:
        raise _TooLargeError
    places = list(scope)
    cells = np.unravel_index(np.arange(count), shape) if shape else ()
    columns: list[NDArray[Any]] = [
        value.column if value.variable is None else value.column[cells[places.index(value.variable)]]
        for value in values
    ]
    call = Call((count,), node.payload, [None] * len(columns), kinds=kinds, kind=node.kind, codec=CODEC)
    with np.errstate(all="ignore"):
        result = np.asarray(operation.batch(call, *columns))
    if call.status is not None and call.status.any():
        raise _TooLargeError
    return np.broadcast_to(result, (count, *result.shape[1:])), shape
