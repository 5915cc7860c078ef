"""Conditions of requirements: nodes of the graph where the compiler can tell, Python code on samples elsewhere.

The compiler gives every leaf of a condition twice: as an expression that builds a value, and as a function of the names that
it reads. If the first can be built it becomes the leaf's node. If not, the leaf is *opaque*: the function is called
with the sampled values of the names, lane by lane. The answer is the same; only analysis sees less, and it is slower.
"""

import random
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from scenic.graph.kinds import Column, Kind
from scenic.graph.node import Node, apply
from scenic.graph.operation import Call, Operation, always
from scenic.graph.operations import TABLE
from scenic.runtime.context import Context, current, here
from scenic.runtime.samples import Sample, dependencies
from scenic.runtime.values import CODEC, as_node


class NotSymbolicError(Exception):
    """Raised while an expression is built that has to be evaluated on samples instead."""


@dataclass(frozen=True, slots=True)
class OpaqueCode:
    """Payload of an opaque leaf: the function, the values it reads, and the nodes behind them."""

    function: Callable[..., Any]
    captured: tuple[Any, ...]
    operands: tuple[Node, ...]
    context: Context | None


def leaf(symbolic: Callable[[], Any] | None, concrete: Callable[..., Any], captured: Sequence[Any]) -> Node:
    """The node of one leaf of a condition."""
    if symbolic is not None:
        try:
            return truth(symbolic())
        except Exception:  # noqa: BLE001 - whatever went wrong goes wrong again, with its place, on a sample
            pass
    operands = tuple(dependencies(captured))
    code = OpaqueCode(concrete, tuple(captured), operands, current.get())
    return apply(OPAQUE, operands, code, here())


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


def _evaluate_opaque(call: Call, *columns: Column) -> Column:
    code: OpaqueCode = call.payload
    lanes = call.lanes
    result = np.zeros(lanes, dtype=np.bool_)
    failed = np.zeros(lanes, dtype=np.bool_)
    seeds = call.seeds().tolist()
    bad = np.zeros(lanes, dtype=np.bool_)
    for status in call.operands:
        if status is not None:
            bad |= status != 0
    by_node = dict(zip(code.operands, columns, strict=True))
    context = code.context
    was_evaluating = context is not None and context.evaluating
    python_state, numpy_state = random.getstate(), np.random.get_state()  # noqa: NPY002 - the program's own
    token = current.set(context)
    try:
        if context is not None:
            context.evaluating = True
        for lane in range(lanes):
            if bad[lane]:
                continue

            def lookup(node: Node, lane: int = lane) -> Any:
                column = by_node[node]
                return CODEC.decode(node.kind, column[lane if len(column) > 1 else 0])

            sample = Sample(lookup)
            random.seed(seeds[lane])
            np.random.seed(seeds[lane] & 0xFFFFFFFF)  # noqa: NPY002 - the program may draw from it
            try:
                result[lane] = bool(code.function(*(sample.value(item) for item in code.captured)))
            except Exception as error:  # noqa: BLE001 - whatever the program raises is that lane's fault
                failed[lane] = True
                call.fault(failed, error)
    finally:
        if context is not None:
            context.evaluating = was_evaluating
        current.reset(token)
        random.setstate(python_state)
        np.random.set_state(numpy_state)  # noqa: NPY002
    return result


OPAQUE = Operation(
    "opaque condition",
    always(Kind.BOOLEAN),
    _evaluate_opaque,
    "A condition that is Python code, called with the sampled values of the names it reads.",
    pure=False,
)
