"""Nodes of the value graph, and a graph as the nodes reachable from its roots."""

from collections.abc import Hashable, Iterable
from dataclasses import field
from functools import cached_property
from typing import Any, Final
from weakref import WeakValueDictionary

import numpy as np

from scenic.dataclass import dataclass
from scenic.graph.draws import Words, address
from scenic.graph.kinds import Column, Kind, boxed
from scenic.graph.operation import Call, Operation, always

Consumers = WeakValueDictionary[Hashable, "Node"]

UNREAD: Final = object()
"""Marks bounds that have not been computed."""


@dataclass(frozen=True, slots=True, eq=False, weakref_slot=True)
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
    _consumers: Consumers | None = field(default=None, init=False, repr=False)
    _bounds: Any = field(default=UNREAD, init=False, repr=False)
    """The cached result of `scenic.graph.bounding.overall`, which is called for the same node again and again."""

    @property
    def consumers(self) -> Consumers:
        """The nodes made of this one so far: a value that is computed twice is one node (`scenic.graph.construction`)."""
        if self._consumers is None:
            object.__setattr__(self, "_consumers", WeakValueDictionary())
            assert self._consumers is not None
        return self._consumers

    def complete(self, operands: tuple["Node", ...], payload: Any) -> None:
        """Give the node the operands that were not there yet when it was made, before anything reads the graph."""
        object.__setattr__(self, "operands", operands)
        object.__setattr__(self, "payload", payload)
        object.__setattr__(self, "_bounds", UNREAD)

    @property
    def likeness(self) -> Hashable:
        """Equal for nodes of one operation that differ in their operands alone; of a payload that has no hash, the node's own."""
        try:
            hash(self.payload)
        except TypeError:
            return id(self)
        kinds = tuple(operand.kind for operand in self.operands)
        return (id(self.operation), self.payload, self.kind, kinds)

    @property
    def runs_python(self) -> bool:
        """Return whether evaluation calls Python functions lane by lane, which may be the program's own."""
        return self.operation.runs_python(self.operands, self.kind)

    @property
    def bounds(self) -> Any:
        """The bounds over the whole cube, or `UNREAD`."""
        return self._bounds

    def keep_bounds(self, bounds: Any) -> None:
        """Let `bounds` be these from now on."""
        object.__setattr__(self, "_bounds", bounds)

    @property
    def is_constant(self) -> bool:
        """Return whether the value is fixed."""
        return self.operation is CONSTANT

    @property
    def is_axis(self) -> bool:
        """Return whether this is an axis of the unit cube."""
        return self.operation is AXIS

    @property
    def is_drawn(self) -> bool:
        """Return whether the value comes straight from the source of random numbers: an axis, or a key."""
        return self.operation is AXIS or self.operation is KEY

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
    key: Hashable = field(repr=False)
    """Equal for constants that are the same value, bit by bit."""


def _constant_batch(call: Call) -> Column:
    column: Column = call.payload.column
    return column


def _drawn_batch(_call: Call) -> Column:
    raise AssertionError("draws come from a source, they are never evaluated")


CONSTANT: Final = Operation("constant", always(Kind.OTHER), _constant_batch, "A fixed value.")
AXIS: Final = Operation("axis", always(Kind.SCALAR), _drawn_batch, "One axis of the unit cube.", pure=False)
KEY: Final = Operation(
    "key",
    always(Kind.KEY),
    _drawn_batch,
    "A random word: keys the further draws of a node that retries, or of Python code.",
    pure=False,
)


def constant(value: Any, kind: Kind, row: Any, span: Hashable | None = None) -> Node:
    """Return a constant node; ``row`` is the encoded value (see `Codec`)."""
    column = boxed([row]) if kind.is_boxed else np.asarray([row], dtype=kind.dtype)
    limits = (int(row), int(row)) if kind is Kind.INTEGER else None
    key = (kind, id(value)) if kind.is_boxed else (kind, column.tobytes())
    return Node(CONSTANT, (), kind, Constant(value, column, key), span, limits)


def axis(span: Hashable | None = None, place: int | None = None) -> Node:
    """Return a new axis of the unit cube: uniform on the open interval (0, 1), independent of all others.

    ``place`` is its address; without one a graph gives the axis an address by its number in the graph.
    """
    return Node(AXIS, (), Kind.SCALAR, place, span)


def key(span: Hashable | None = None, place: int | None = None) -> Node:
    """Return a new key at an address: a random word of its own in every lane."""
    return Node(KEY, (), Kind.KEY, place, span)


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
        """Number of each axis: which column of a `Domain` it owns."""
        for node in self.nodes:
            if node.is_axis:
                self.axes[node] = len(self.axes)

    @property
    def dimension(self) -> int:
        """Number of axes."""
        return len(self.axes)

    def address(self, node: Node) -> int:
        """Return the address of an axis or key."""
        return address("unnamed", self.index[node]) if node.payload is None else int(node.payload)

    @cached_property
    def drawn_addresses(self) -> frozenset[int]:
        """The addresses of all axes and keys."""
        return frozenset(self.address(node) for node in self.nodes if node.is_drawn)

    def addresses(self, nodes: Iterable[Node]) -> Words:
        """Return the addresses of axes or keys."""
        return np.array([self.address(node) for node in nodes], dtype=np.uint64)

    def order(self, root: Node) -> list[Node]:
        """Return the nodes that ``root`` needs, in evaluation order, ``root`` last; constants and draws left out."""
        return [node for node in _postorder(root, ()) if not node.is_drawn and not node.is_constant]


def _postorder(root: Node, done: Any) -> list[Node]:
    """List the nodes below ``root`` that are not in ``done``, operands first. A loop does it: chains may be too long for recursion."""
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
