"""Calls with starred arguments, which may be random: such a call is put off until the scene is sampled."""

from collections.abc import Callable, Iterator, Mapping, Sequence
from typing import Any

from scenic.graph.node import Node
from scenic.graph.operations import TABLE
from scenic.language.errors import RejectionException
from scenic.runtime.ground.context import current
from scenic.runtime.program.emptied_filters import emptied_error
from scenic.runtime.python.opaque import OpaqueCode, call_later
from scenic.runtime.python.purity import is_pure
from scenic.runtime.values.distributions import Uniform
from scenic.runtime.values.lazy import Lazy, defer
from scenic.runtime.values.values import (
    NOTHING,
    Random,
    as_node,
    element_of,
    elements_of,
    holds_instances,
    over_options,
    uniform,
)

Parts = Sequence[tuple[bool, Any]]
"""Positional arguments, each with whether it is starred."""


def spread(function: Callable[..., Any], parts: Parts, keywords: Mapping[str, object]) -> Any:
    """Call ``function(a, *b, k=c)``, where starred arguments may be random.

    ``Uniform(*xs)`` of a random list draws one of its elements, each equally likely; a sample in which it has none is
    rejected. Any other function is called with the sampled arguments.
    """
    if any(is_starred and isinstance(value, Lazy) for is_starred, value in parts):
        flags = tuple(is_starred for is_starred, _ in parts)
        return defer(_spread_values, function, flags, tuple(value for _, value in parts), dict(keywords))
    if function is Uniform:
        _refuse_nothing(parts)
    if not any(is_starred and isinstance(value, Random) for is_starred, value in parts):
        return function(*_arguments(parts), **keywords)
    if function is Uniform:
        return _one_of(parts)
    if not keywords and is_pure(function):
        choice = _for_each_option(parts, function)
        if choice is not None:
            return choice
    return call_later(_call, function, parts, **keywords)


def _spread_values(
    function: Callable[..., Any],
    flags: Sequence[bool],
    values: Sequence[object],
    keywords: Mapping[str, object],
) -> Any:
    """Evaluate `spread` for values that no longer depend on the object being specified."""
    return spread(function, tuple(zip(flags, values, strict=True)), keywords)


def _refuse_nothing(parts: Parts) -> None:
    """Raise an error where there is nothing to draw from but the result of a filter that left nothing."""
    context = current.get()
    if context is None or len(parts) != 1:
        return
    for emptied in context.record.emptied:
        if emptied.result is parts[0][1]:
            raise emptied_error(context, emptied)


def _for_each_option(parts: Parts, function: Callable[..., Any]) -> Any:
    """The call for each option of a choice among constant lists; ``None`` for other arguments."""
    flags = [is_starred for is_starred, _ in parts]

    def call(*values: Any) -> Any:
        return function(*_arguments(list(zip(flags, values, strict=True))))

    return over_options([as_node(value) for _, value in parts], call)


def _one_of(parts: Parts) -> Any:
    draw = uniform()
    chosen = [value for is_starred, value in parts if is_starred and isinstance(value, Random)]
    if isinstance(draw, Random) and len(chosen) == 1 and chosen[0].node.operation is TABLE["select"]:
        index, *options = chosen[0].node.operands
        lists = [elements_of(option) for option in options]
        # Of instances among them it is not known before the sample that they are some (section 8.1 of the specification).
        if all(elements is not None for elements in lists) and not holds_instances(chosen[0].node):
            return element_of(index, [_with(parts, elements or ()) for elements in lists], draw)
    return call_later(_element, draw, parts)


def _with(parts: Parts, elements: Sequence[Node]) -> list[Node]:
    """Return all arguments as nodes, those of the starred random list ``elements``."""
    nodes: list[Node] = []
    for is_starred, value in parts:
        if is_starred and isinstance(value, Random):
            nodes += elements
        else:
            nodes += map(as_node, value if is_starred else (value,))
    return nodes


def _arguments(parts: Parts) -> Iterator[Any]:
    for is_starred, value in parts:
        if is_starred:
            yield from value
        else:
            yield value


def _call(function: Callable[..., Any], parts: Parts, **keywords: Any) -> Any:
    return function(*_arguments(parts), **keywords)


def chooses_element(node: Node) -> bool:
    """Return whether a node is an element of lists that are known only in each sample, and may all be empty."""
    return isinstance(node.payload, OpaqueCode) and node.payload.function is _element


def _element(draw: float, parts: Parts) -> Any:
    elements = list(_arguments(parts))
    if not elements:
        raise RejectionException(NOTHING)
    return elements[min(int(draw * len(elements)), len(elements) - 1)]
