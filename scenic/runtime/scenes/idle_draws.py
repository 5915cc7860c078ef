"""Draws on which nothing depends: colours that nobody looks at, and defaults of behaviors that nobody runs."""

import re
from collections.abc import Iterator
from typing import Final

from scenic.graph.node import Graph, Node
from scenic.runtime.description.definitions import Definition, Invocable
from scenic.runtime.description.outcome import Program
from scenic.runtime.instances.objects import Point
from scenic.runtime.python.samples import dependencies, mention, reachable
from scenic.runtime.values.random_base import RandomBase

__all__ = ["defaults", "idle_draws"]

_LOOKS = "color"
"""The property that decides what an object looks like, and nothing else."""

_READING: Final = re.compile(rf"\.\s*{_LOOKS}\b|['\"]{_LOOKS}['\"]")
"""A look at that property in the text of a program."""


def idle_draws(program: Program, graph: Graph, text: str) -> frozenset[int]:
    """Return the addresses of the draws on which neither requirements nor simulations depend.

    Colours count where the program or code of it looks at colours, or an object has sensors, which may see them. A requirement that
    calls a function with an object depends on all of the object, but looks at no colour unless the program does.

    Args:
        program: a program that has run.
        graph: what its scenes need.
        text: of the program.

    """
    properties = [item.properties for item in program.instances]
    walk = list(reachable(program.reachable(), program.names))
    idle: list[object] = []
    others: list[object] = [
        value for values in properties for name, value in values.items() if name != _LOOKS
    ]
    is_seen = _READING.search(text) is not None or mention(walk, _LOOKS)
    is_seen |= any(values.get("sensors") for values in properties)
    (others if is_seen else idle).extend(values.get(_LOOKS) for values in properties)
    for invocable in program.invocables:
        is_run = mention(walk, invocable.__name__)
        (others if is_run else idle).extend(defaults(invocable._definition).values())
    for scope in (program.module, *program.scopes):
        others += [value for name, value in scope.items() if not name.startswith("__")]
    others += program.parameters.values()
    idle_axes = Graph(list(_nodes(idle))).axes
    if not idle_axes:
        return frozenset()
    conditions = [item.condition for item in program.requirements] if is_seen else []
    axes_in_use = Graph([*conditions, *_nodes(others)]).axes
    return frozenset(
        graph.address(axis) for axis in idle_axes if axis in graph.index and axis not in axes_in_use
    )


def defaults(definition: Definition) -> dict[str, object]:
    """The defaults of a behavior's or a scenario's parameters, by name."""
    parameters = definition.signature.parameters.values()
    return {item.name: item.default for item in parameters if item.default is not item.empty}


def _nodes(value: object) -> Iterator[Node]:
    """Yield the nodes of the random values in a value, but for those of instances in it, which have values of their own."""
    if isinstance(value, RandomBase):
        yield value.node
    elif isinstance(value, list | tuple | set | frozenset):
        for item in value:
            yield from _nodes(item)
    elif isinstance(value, dict):
        yield from _nodes([*value.keys(), *value.values()])
    elif isinstance(value, Invocable):
        yield from _nodes(list(value._arguments.arguments.values()))
    elif hasattr(value, "random_parts") and not isinstance(value, Point):
        yield from dependencies([value])
