"""Python code that is called on samples: never traced, lane by lane.

What such code does cannot be known before it runs. So it gets concrete values, and finds the names of the program at
concrete values too; analysis sees nothing of it.
"""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace
from types import MappingProxyType
from typing import Any

import numpy as np

from scenic.graph.construction import make_node
from scenic.graph.kinds import Column, Kind, boxed
from scenic.graph.node import Graph, Node, key
from scenic.graph.operation import OK, Call, Operation, always
from scenic.language.errors import InvalidScenarioError, RejectionException
from scenic.runtime.context import Context, current, here, next_address
from scenic.runtime.objects import Point
from scenic.runtime.randomness import preserved, seed_globals
from scenic.runtime.samples import Globals, Sample, dependencies, mention, reachable
from scenic.runtime.values import CODEC, Random, as_value


@dataclass(frozen=True, slots=True)
class OpaqueCode:
    """A function with its arguments, the nodes behind both, and where it runs.

    ``names`` are the global names that functions in reach read, as they were when this was made.
    """

    function: Callable[..., Any]
    args: tuple[Any, ...]
    keywords: Mapping[str, Any]
    operands: tuple[Node, ...]
    names: Globals
    context: Context | None


def later(
    operation: Operation,
    function: Callable[..., Any],
    args: Sequence[Any],
    keywords: Mapping[str, Any] = MappingProxyType({}),
    *,
    names: Globals | None = None,
) -> Node:
    """The node of a call that is made on each sample; ``operation`` is one made with `evaluated`.

    ``names`` are global names as functions in reach shall see them; as they are now by default.
    """
    seen = Globals() if names is None else names
    own = key(here(), next_address())
    context = current.get()
    reads: list[Any] = [function, *args, *keywords.values()]
    if context is not None and mention(reads, seen, "can see"):
        context.looks = True
        reads += context.objects
    operands = (own, *dependencies(reads, seen))
    code = OpaqueCode(function, tuple(args), keywords, operands, seen, context)
    node = make_node(operation, operands, code, here())
    if context is not None and context.is_symbolic:
        instances = [value for value in reachable(reads, seen) if isinstance(value, Point)]
        if instances:
            context.calls.append((node, instances))
    return node


def see_mutated(context: Context) -> None:
    """Let calls that were made before see instances as they come out in the end, mutated.

    What a call sees of an instance is looked up when it is made on a sample; so the nodes of what has been
    mutated since have to be among its operands. A call that decides how an instance is mutated sees it as it was.
    """
    for node, instances in context.calls:
        new = [item for item in dependencies(instances) if item not in node.operands]
        if new and node not in Graph(new).index:
            operands = (*node.operands, *new)
            node.complete(operands, replace(node.payload, operands=operands))


def call_later(function: Callable[..., Any], /, *args: Any, **keywords: Any) -> Any:
    """The random value of a call that is made on each sample."""
    return as_value(later(CALL, function, args, keywords))


Random.later = staticmethod(call_later)


def is_later(*values: Any) -> bool:
    """Whether a call with these values has to wait for samples: something random is in their reach."""
    context = current.get()
    if context is not None and (context.sample is not None or not context.is_symbolic):
        return False
    return bool(dependencies(values))


def evaluated(call: Call, columns: Sequence[Column]) -> list[Any]:
    """The results of the calls, ``None`` in lanes where there is none.

    A call that raises `RejectionException` rejects its lane, any other exception is that lane's fault. Python's and
    NumPy's global generators are seeded for each call by its key, the first column, and are afterwards as they were before.
    """
    code: OpaqueCode = call.payload
    results: list[Any] = [None] * call.lanes
    failed, rejected, absent = (np.zeros(call.lanes, dtype=np.bool_) for _ in range(3))
    for status in call.operands:
        if status is not None:
            absent |= status != OK
    error: Exception | None = None
    sample_before = None if code.context is None else code.context.sample
    lanes = _Lanes(
        {node: CODEC.decode(node.kind, column) for node, column in zip(code.operands, columns, strict=True)}
    )
    seeds = lanes.values[code.operands[0]]
    context = code.context
    was_evaluating = context is not None and context.evaluating
    token = current.set(context)
    try:
        if context is not None:
            context.evaluating = True
        with preserved():
            for lane in np.flatnonzero(~absent).tolist():
                sample = Sample(lanes, lane, code.names)
                if context is not None:
                    context.sample = sample
                seed_globals(seeds[lane])
                try:
                    args = [sample.value(item) for item in code.args]
                    keywords = {name: sample.value(item) for name, item in code.keywords.items()}
                    results[lane] = sample.value(code.function)(*args, **keywords)
                except RejectionException:
                    rejected[lane] = True
                except SystemExit as end:
                    failed[lane] = True
                    error = _ended(end) if error is None else error
                except Exception as problem:  # noqa: BLE001 - whatever the program raises is that lane's fault
                    failed[lane] = True
                    error = problem if error is None else error
    finally:
        if context is not None:
            context.evaluating = was_evaluating
            context.sample = sample_before
        current.reset(token)
    if error is not None:
        call.fault(failed, error)
    call.reject(rejected)
    return results


def _ended(end: SystemExit) -> InvalidScenarioError:
    return InvalidScenarioError(
        f"the program ended itself (`sys.exit`, with {end.code!r}) while a candidate was evaluated",
        help="raise `RejectionException` to reject a candidate, or an exception that says what is wrong",
    )


class _Lanes:
    """The values of the operands, by node."""

    __slots__ = ("values",)

    def __init__(self, values: Mapping[Node, list[Any]]) -> None:
        self.values = values

    def read(self, lane: int, node: Node) -> Any:
        """The value of a node in one lane."""
        found = self.values[node]
        return found[lane if len(found) > 1 else 0]


CALL = Operation(
    "opaque call",
    always(Kind.OTHER),
    lambda call, *columns: boxed(evaluated(call, columns)),
    "A call of Python code with sampled arguments; the first operand is its key.",
    pure=False,
    faults=True,
    rejects=True,
)
