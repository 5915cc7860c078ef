"""Conditions of requirements: nodes of the graph if the compiler understands them, otherwise Python code on samples.

The compiler gives every leaf of a condition twice: as an expression that builds a value, and as a function of the names that
it reads. If the first can be built it becomes the leaf's node. If not, the leaf is *opaque*: the function is called
with the sampled values of the names, lane by lane. The answer is the same; only analysis sees less, and it is slower.
"""

from collections.abc import Callable, Sequence
from contextlib import suppress
from typing import Any

import numpy as np

from scenic.graph.construction import make_node
from scenic.graph.kinds import Kind
from scenic.graph.node import Node
from scenic.graph.operation import Operation, always
from scenic.graph.operations import TABLE
from scenic.runtime.description.declarations import Tree
from scenic.runtime.ground.context import current, here
from scenic.runtime.python.opaque import evaluated, later
from scenic.runtime.python.samples import Globals
from scenic.runtime.values.lazy import definite
from scenic.runtime.values.values import as_node, is_answered_by_code

Build = Callable[[], Node]

Indices = Callable[..., Sequence[tuple[int, Sequence[object]]]]
"""A function of the names of a leaf that tells of which of them, by number, only some items are read, and which."""

_OF_TRUTH = ("__bool__", "__len__")


class NotSymbolicError(Exception):
    """Raised while an expression is built that has to be evaluated on samples instead."""


class Condition:
    """A condition: the formula that simulations follow and, while a scenario is compiled, what builds nodes.

    ``build`` makes the node that says whether a scene may meet the condition. It is made where the condition stands, and once
    more when the program has mutated something: a condition means the objects as they come out in the end. ``sure`` makes
    the node that says whether a scene meets it however a simulation goes on; it differs where the condition speaks of time.
    """

    __slots__ = ("build", "sure", "tree")

    def __init__(self, tree: Tree, build: Build | None = None, sure: Build | None = None) -> None:
        self.tree = tree
        self.build = build
        self.sure = build if sure is None else sure


def connected(operation: str, parts: Sequence[Condition]) -> Condition:
    """Return the condition that joins the parts by ``and`` or ``or``."""
    tree: Tree = (operation, *(part.tree for part in parts))
    builds = [part.build for part in parts if part.build is not None]
    sures = [part.sure for part in parts if part.sure is not None]
    if len(builds) < len(parts):
        return Condition(tree)

    def build() -> Node:
        return connect(operation, [each() for each in builds])

    def sure() -> Node:
        return connect(operation, [each() for each in sures])

    return Condition(tree, build, build if builds == sures else sure)


def negated(part: Condition) -> Condition:
    """Return the negated condition: it may hold where the part is not certain to hold."""
    tree: Tree = ("not", part.tree)
    may, certain = part.build, part.sure
    if may is None or certain is None:
        return Condition(tree)

    def build() -> Node:
        return connect("not", [certain()])

    def sure() -> Node:
        return connect("not", [may()])

    return Condition(tree, build, build if may is certain else sure)


def in_time(operator: str, parts: Sequence[Condition]) -> Condition:
    """Return a temporal operator. A scene alone decides it only as far as the first state does."""
    tree: Tree = (operator, *(part.tree for part in parts))
    if operator == "implies":
        either = connected("or", [negated(parts[0]), parts[1]])
        return Condition(tree, either.build, either.sure)
    if any(part.build is None for part in parts):
        return Condition(tree)

    def open_() -> Node:
        return as_node(True)

    def unsure() -> Node:
        return as_node(False)

    match operator:
        case "always":
            return Condition(tree, parts[0].build, unsure)
        case "eventually":
            return Condition(tree, open_, parts[0].sure)
        case "next":
            return Condition(tree, open_, unsure)
        case _:
            return Condition(tree, connected("or", parts).build, parts[1].sure)


def leaf(
    symbolic: Callable[..., Any] | None,
    concrete: Callable[..., Any],
    captured: Sequence[object],
    *,
    awaits: bool = False,
    indices: Indices | None = None,
) -> Callable[[], Node]:
    """Return a function that builds the node of one leaf of a condition; if the leaf ``awaits`` names, again when the program has ended.

    ``indices`` tells which items it reads of what is captured, where it does not read all.
    """
    names: Globals | None = None

    def build() -> Node:
        nonlocal names
        if symbolic is not None:
            context = current.get()
            if context is not None:
                context.judging = True
            try:
                value = symbolic(*captured)
            except Exception:  # noqa: BLE001 - whatever went wrong goes wrong again, with its place, on a sample
                pass
            else:
                value = definite(value, "the requirement")
                with suppress(NotSymbolicError):
                    return truth(value)
            finally:
                if context is not None:
                    context.judging = False
        # The names that functions in reach have at the `require` statement count.
        # Those that have no value yet are read again when the program has ended.
        names = Globals() if names is None or awaits else names.completed() if names.lacks else names
        items = captured if indices is None else picked(captured, indices)
        node = later(OPAQUE, concrete, items, names=names)
        context = current.get()
        if names.lacks and context is not None:
            context.record.awaits = True
        return node

    return build


def picked(captured: Sequence[object], indices: Indices) -> Sequence[object]:
    """Keep those items of captured containers that a leaf reads, as dictionaries, so that it does not depend on the others."""
    result = list(captured)
    context = current.get()
    with suppress(Exception):  # whatever is wrong with an index goes wrong again, with its place, on a sample
        for place, each in indices(*captured):
            container: Any = captured[place]
            is_list = type(container) in (list, tuple)
            if not (is_list or type(container) is dict):
                continue
            if all(type(index) is int or (type(index) is str and not is_list) for index in each):
                result[place] = {index: container[index] for index in each}
                if context is not None and type(container) is not tuple:
                    items = container if is_list else container.values()
                    context.record.unrolled.append((items, tuple(items)))
    return result


def truth(value: object) -> Node:
    """Return the truth value of a value, as a node; raises `NotSymbolicError` if only a sample decides it."""
    if is_answered_by_code(value, _OF_TRUTH):
        raise NotSymbolicError
    node = as_node(value)
    if node.kind is Kind.BOOLEAN:
        return node
    if node.is_constant:
        return as_node(bool(node.value))
    return make_node(TABLE["truth"], [node], span=here())


def connect(operation: str, conditions: Sequence[Node]) -> Node:
    """Return the node that joins conditions by ``and``, ``or`` or ``not``."""
    return make_node(TABLE[operation], conditions, span=here())


def presence(symbolic: Callable[[], Any], now: Callable[[], Any]) -> Any:
    """Return the value of ``with present condition``: a truth value, random where its parts are."""
    context = current.get()
    if context is None or context.is_symbolic:
        # What has no random truth value gives what Python says, or its error.
        with suppress(NotSymbolicError):
            return symbolic()
    return now()


OPAQUE = Operation(
    "opaque condition",
    always(Kind.BOOLEAN),
    lambda call, *columns: np.array([bool(result) for result in evaluated(call, columns)], dtype=np.bool_),
    "A condition that is Python code, called with the sampled values of the names it reads.",
    pure=False,
    calls_code=True,
    faults=True,
    rejects=True,
)
