"""Bounds of a node's value without sampling: those of its kind, of a constant, of the whole cube."""

import math
from collections.abc import Iterable, Mapping, Sequence
from typing import Final

import numpy as np

from scenic.graph.bounds import Bounds, Floats, outward
from scenic.graph.kinds import Kind
from scenic.graph.node import UNREAD, Node
from scenic.graph.operation import BoundsReading, Operation

LARGEST: Final = 2.0**62
"""Integer columns hold values of smaller size than this, so that one more addition cannot overflow."""

_VISITS: Final = 256
"""Number of nodes that `overall` visits before it gives up."""


def of_kind(kind: Kind) -> Bounds | None:
    """Return the bounds of any value of a kind, for one box; ``None`` for Python objects."""
    if kind.is_boxed:
        return None
    shape = (1, *kind.trailing)
    if kind is Kind.BOOLEAN:
        return Bounds(np.zeros(shape), np.ones(shape))
    if kind is Kind.ORIENTATION:
        return Bounds(np.full(shape, -1.0 - 1e-9), np.full(shape, 1.0 + 1e-9))
    return Bounds(np.full(shape, -np.inf), np.full(shape, np.inf))


def of_constant(node: Node) -> Bounds | None:
    """Return the bounds of a constant, for one box; ``None`` for Python objects that are not numbers."""
    column = node.payload.column
    if node.kind.is_boxed:
        value = node.value
        if not isinstance(value, int | float) or not abs(value) < LARGEST:
            return None
        column = np.asarray([value])
    values = column.astype(np.float64)
    if not np.isfinite(values).all():
        return of_kind(node.kind)
    if column.dtype == np.int64 and abs(int(column[0])) > 2**53:
        return outward(values, values)
    return Bounds(values, values)


def forward(node: Node, operands: Sequence[Bounds | None]) -> Bounds | None:
    """Return the bounds of a node that is neither constant nor axis, computed from the bounds of its operands."""
    return integral(node.kind, read(node.operation, node.kind, node.payload, operands))


def read(
    operation: Operation, kind: Kind, payload: object, operands: Sequence[Bounds | None]
) -> Bounds | None:
    """The result of the operation's bounds reading, or else the bounds of the kind."""
    default = of_kind(kind)
    blind = operation.strict and not operation.partial
    if operation.bounds is None or (blind and any(operand is None for operand in operands)):
        return default
    with np.errstate(all="ignore"):
        bounds = operation.bounds(payload, *operands)
    return default if bounds is None else bounds


def integral(kind: Kind, bounds: Bounds | None) -> Bounds | None:
    """Bounds tightened to whole numbers where the kind has only those."""
    if bounds is None or kind not in (Kind.INTEGER, Kind.BOOLEAN):
        return bounds
    return Bounds(np.ceil(bounds.lower), np.floor(bounds.upper))


def overall(node: Node) -> Bounds | None:
    """Return the bounds of a node over the whole cube, for one box; ``None`` where nothing is known.

    Visits a bounded number of nodes below, and none below those whose bounds are known already. They are kept with the node.
    """
    if node.bounds is not UNREAD:
        bounds: Bounds | None = node.bounds
        return bounds
    bounds_of: dict[Node, Bounds | None] = {}
    visits = 0
    stack = [node]
    while stack:
        current = stack[-1]
        if current in bounds_of:
            stack.pop()
            continue
        leaf = _leaf(current) if current.bounds is UNREAD else current.bounds
        if leaf is not None:
            bounds_of[current] = leaf
            stack.pop()
            continue
        missing = [operand for operand in current.operands if operand not in bounds_of]
        if missing and visits < _VISITS:
            visits += len(missing)
            stack.extend(missing)
            continue
        operands = [
            bounds_of[operand] if operand in bounds_of else of_kind(operand.kind)
            for operand in current.operands
        ]
        bounds_of[current] = forward(current, operands)
        stack.pop()
    node.keep_bounds(bounds_of[node])
    return bounds_of[node]


def over(
    roots: Iterable[Node],
    axes: Mapping[Node, int],
    lower: Floats,
    upper: Floats,
    known: dict[Node, Bounds | None] | None = None,
) -> dict[Node, Bounds | None]:
    """Return the bounds of the roots, and of all nodes below them, over boxes of the cube.

    Args:
        roots: the nodes whose bounds are wanted.
        axes: numbers of the axes.
        lower: corners of the boxes, ``(m, dimension)``.
        upper: the opposite corners, likewise.
        known: bounds that are there already, to which those of further nodes are added.

    """
    known = {} if known is None else known
    for root in roots:
        stack = [(root, 0)]
        while stack:
            node, position = stack.pop()
            if node in known:
                continue
            if node.is_axis:
                known[node] = Bounds(lower[:, axes[node]], upper[:, axes[node]])
            elif node.is_constant:
                known[node] = of_constant(node)
            else:
                operands = node.operation.bounding(node.operands, node.payload)
                if position < len(operands):
                    stack += ((node, position + 1), (operands[position], 0))
                else:
                    known[node] = forward(node, [known.get(operand) for operand in node.operands])
    return known


def _leaf(node: Node) -> Bounds | None:
    if node.is_constant:
        return of_constant(node)
    if node.is_axis:
        return Bounds(np.zeros(1), np.ones(1))
    if node.limits is not None:
        low, high = node.limits
        return (
            Bounds(*(np.array([float(end)]) for end in (low, high)))
            if -(2**53) < low <= high < 2**53
            else (outward(np.array([float(low)]), np.array([float(high)])))
        )
    return None


def limits_of(bounds: Bounds | None) -> tuple[int, int] | None:
    """The whole numbers that number bounds (of one box) admit; ``None`` unless they certainly fit 64 bits."""
    if bounds is None or bounds.lower.shape != (1,):
        return None
    low, high = float(bounds.lower[0]), float(bounds.upper[0])
    if not (-LARGEST < low <= high < LARGEST):
        return None
    return math.ceil(low), math.floor(high)


def whole_limits(reading: BoundsReading, operands: Sequence[Node], payload: object) -> tuple[int, int] | None:
    """Limits of an integer result over the whole cube, by a bounds reading."""
    bounds = [overall(operand) for operand in operands]
    if any(bound is None for bound in bounds):
        return None
    with np.errstate(all="ignore"):
        return limits_of(reading(payload, *bounds))
