"""Conditions of requirements: nodes of the graph where the compiler can tell, Python code on samples elsewhere.

The compiler gives every leaf of a condition twice: as an expression that builds a value, and as a function of the names that
it reads. If the first can be built it becomes the leaf's node. If not, the leaf is *opaque*: the function is called
with the sampled values of the names, lane by lane. The answer is the same; only analysis sees less, and it is slower.
"""

from collections.abc import Callable, Sequence
from typing import Any

import numpy as np

from scenic.graph.kinds import Column, Kind
from scenic.graph.node import Node, apply
from scenic.graph.operation import Call, Operation, always
from scenic.graph.operations import TABLE
from scenic.runtime.context import here
from scenic.runtime.lazy import definite
from scenic.runtime.opaque import evaluated, later
from scenic.runtime.values import as_node


class NotSymbolicError(Exception):
    """Raised while an expression is built that has to be evaluated on samples instead."""


def leaf(symbolic: Callable[[], Any] | None, concrete: Callable[..., Any], captured: Sequence[Any]) -> Node:
    """The node of one leaf of a condition."""
    if symbolic is not None:
        try:
            value = symbolic()
        except Exception:  # noqa: BLE001 - whatever went wrong goes wrong again, with its place, on a sample
            pass
        else:
            return truth(definite(value, "the requirement"))
    return later(OPAQUE, concrete, captured)


def truth(value: Any) -> Node:
    """The truth value of a value, as a node."""
    node = as_node(value)
    if node.kind is Kind.BOOLEAN:
        return node
    if node.is_constant:
        return as_node(bool(node.value))
    return apply(TABLE["truth"], [node], span=here())


def connect(operation: str, conditions: Sequence[Node]) -> Node:
    """``and``, ``or`` or ``not`` of conditions."""
    return apply(TABLE[operation], conditions, span=here())


def _truths(call: Call, *columns: Column) -> Column:
    return np.array([bool(result) for result in evaluated(call, columns)], dtype=np.bool_)


OPAQUE = Operation(
    "opaque condition",
    always(Kind.BOOLEAN),
    _truths,
    "A condition that is Python code, called with the sampled values of the names it reads.",
    pure=False,
)
