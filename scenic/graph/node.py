"""Nodes of the value graph, and a graph as the nodes reachable from its roots."""

from collections.abc import Hashable, Iterable, Sequence
from dataclasses import dataclass, field
from typing import Any

import numpy as np

from scenic.graph.bounding import limits_of, overall, read
from scenic.graph.kinds import Column, Kind, boxed
from scenic.graph.operation import Call, Operation, always


@dataclass(frozen=True, slots=True, eq=False)
class Node:
    """One value of a scenario: an operation applied to operands. Two nodes are equal only if they are one.

    ``payload`` is data of the operation that is no operand (an attribute's name, a table of weights). ``span`` is
    the place in the program, carried for reports and never looked into here. ``limits`` bound the value of an integer
    exactly; integer arithmetic uses them to prove that its results fit 64 bits.
    """

    operation: Operation
    operands: tuple["Node", ...]
    kind: Kind
    payload: Any = None
    span: Hashable | None = None
    limits: tuple[int, int] | None = None

    @property
    def is_constant(self) -> bool:
        """Whether the value is fixed."""
        return self.operation is CONSTANT

    @property
    def is_axis(self) -> bool:
        """Whether this is an axis of the unit cube."""
        return self.operation is AXIS

    @property
    def value(self) -> Any:
        """The Python value of a constant."""
        if self.operation is not CONSTANT:
            raise ValueError(f"{self.operation.name} is not a constant")
        return self.payload.value

    def __repr__(self) -> str:
        if self.is_constant:
            return f"<constant {self.payload.value!r}>"
        return f"<{self.operation.name}/{len(self.operands)} {self.kind.value}>"


@dataclass(frozen=True, slots=True, eq=False)
class Constant:
    """Payload of a constant: the Python value and its column, of leading dimension 1."""

    value: Any
    column: Column = field(repr=False)


def _constant_batch(call: Call) -> Column:
    column: Column = call.payload.column
    return column


def _axis_batch(_call: Call) -> Column:
    raise AssertionError("axes are columns of the cube, never evaluated")


CONSTANT = Operation("constant", always(Kind.OTHER), _constant_batch, "A fixed value.")
AXIS = Operation("axis", always(Kind.SCALAR), _axis_batch, "One axis of the unit cube.", pure=False)


def constant(value: Any, kind: Kind, row: Any, span: Hashable | None = None) -> Node:
    """A constant node; ``row`` is the encoded value (see `Codec`)."""
    column = boxed([row]) if kind.is_boxed else np.asarray([row], dtype=kind.dtype)
    limits = (int(row), int(row)) if kind is Kind.INTEGER else None
    return Node(CONSTANT, (), kind, Constant(value, column), span, limits)


def axis(span: Hashable | None = None) -> Node:
    """A new axis of the unit cube: uniform on the open interval (0, 1), independent of all others."""
    return Node(AXIS, (), Kind.SCALAR, None, span)


def apply(
    operation: Operation, operands: Sequence[Node], payload: Any = None, span: Hashable | None = None
) -> Node:
    """The node of ``operation`` over ``operands``, of the kind that the operation's rule gives."""
    kind = operation.kind(operands, payload)
    limits = None
    if kind is Kind.INTEGER:
        limits = limits_of(read(operation, kind, payload, [overall(operand) for operand in operands]))
    return Node(operation, tuple(operands), kind, payload, span, limits)


class Graph:
    """Everything reachable from ``roots``, operands before the nodes that use them.

    The order, and with it the numbering of the axes, depends only on the order of the roots and of operands: two runs
    of one program give graphs that correspond node by node.
    """

    def __init__(self, roots: Iterable[Node]) -> None:
        order: dict[Node, int] = {}
        for root in roots:
            for node in _postorder(root, order):
                order[node] = len(order)
        self.index = order
        """Position of each node in the order."""
        self.nodes: tuple[Node, ...] = tuple(order)
        self.axes: dict[Node, int] = {}
        """Column of the cube that each axis owns."""
        for node in self.nodes:
            if node.is_axis:
                self.axes[node] = len(self.axes)

    @property
    def dimension(self) -> int:
        """Number of axes."""
        return len(self.axes)

    def order(self, root: Node) -> list[Node]:
        """The nodes that ``root`` needs, in evaluation order, ``root`` last; constants and axes left out."""
        return [node for node in _postorder(root, ()) if not node.is_axis and not node.is_constant]


def _postorder(root: Node, done: Any) -> list[Node]:
    """Nodes below ``root`` that are not in ``done``, operands first. No recursion: chains may be long."""
    if root in done:
        return []
    result: dict[Node, None] = {}
    stack: list[tuple[Node, int]] = [(root, 0)]
    while stack:
        node, position = stack.pop()
        if position < len(node.operands):
            stack.append((node, position + 1))
            operand = node.operands[position]
            if operand not in done and operand not in result:
                stack.append((operand, 0))
        elif node not in result:
            result[node] = None
    return list(result)
