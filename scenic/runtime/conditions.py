"""Conditions of requirements: nodes of the graph where the compiler can tell, Python code on samples elsewhere.

The compiler gives every leaf of a condition twice: as an expression that builds a value, and as a function of the names that
it reads. If the first can be built it becomes the leaf's node. If not, the leaf is *opaque*: the function is called
with the sampled values of the names, lane by lane. The answer is the same; only analysis sees less, and it is slower.
"""

from collections.abc import Callable, Sequence
from typing import Any

import numpy as np

from scenic.graph.construction import apply
from scenic.graph.kinds import Column, Kind
from scenic.graph.node import Node
from scenic.graph.operation import Call, Operation, always
from scenic.graph.operations import TABLE
from scenic.runtime.context import here
from scenic.runtime.lazy import definite
from scenic.runtime.opaque import evaluated, later
from scenic.runtime.samples import Globals
from scenic.runtime.values import as_node


class NotSymbolicError(Exception):
    """Raised while an expression is built that has to be evaluated on samples instead."""


class Condition:
    """A condition of a requirement: a node while a scenario is compiled, its truth during a simulation.

    ``build`` makes the node. It is made where the condition stands, and once more when the program has mutated something:
    a condition means the objects as they come out in the end.
    """

    __slots__ = ("build", "node", "truth")

    def __init__(self, build: Callable[[], Node] | None, truth: bool | None) -> None:
        self.build = build
        self.node = None if build is None else build()
        self.truth = truth


def leaf(
    symbolic: Callable[..., Any] | None, concrete: Callable[..., Any], captured: Sequence[Any]
) -> Callable[[], Node]:
    """What builds the node of one leaf of a condition."""
    names: Globals | None = None

    def build() -> Node:
        nonlocal names
        if symbolic is not None:
            try:
                value = symbolic(*captured)
            except Exception:  # noqa: BLE001 - whatever went wrong goes wrong again, with its place, on a sample
                pass
            else:
                return truth(definite(value, "the requirement"))
        # The names that functions in reach have at the `require` statement count.
        names = Globals() if names is None else names
        return later(OPAQUE, concrete, captured, names=names)

    return build


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
    faults=True,
    rejects=True,
)
