"""Comprehensions, ``all``, ``any``, ``sum``, ``max`` and ``min`` over fixed sequences, as nodes of the graph.

The compiler gives what is iterated over and a function of an element. Where the elements are fixed, the function is called once
for each of them while the program is loaded; that gives the values that Python would compute on a sample. Anything else raises
`NotSymbolicError`: then Python computes it on each sample.
"""

import sys
from collections.abc import Callable, Iterable, Sequence
from itertools import combinations
from typing import Any, Final

from scenic.graph.kinds import Kind
from scenic.runtime.description.conditions import NotSymbolicError, connect, truth
from scenic.runtime.ground.context import current
from scenic.runtime.values.values import as_node, as_value, is_choice_of_frozen, operate

MOST: Final = 1000
"""Elements that are unrolled: more would make the graph large."""

_EXTREMES: Final = {"min": "minimum", "max": "maximum"}
_COMPENSATES: Final = sys.version_info >= (3, 12)
"""True if Python's ``sum`` compensates rounding, and so differs from adding floats in turn."""


def iterated(function: Callable[..., Any], sequences: Sequence[object]) -> list[Any]:
    """The elements of ``range``, ``zip``, ``enumerate`` or ``reversed``, of fixed arguments."""
    given = [item if isinstance(item, int) else _fixed(item) for item in sequences]
    return _fixed(list(_few(function(*given))))


def each(sequence: object, function: Callable[..., list[Any]], *, spread: bool) -> list[Any]:
    """The values that a function gives for the elements of a fixed sequence, or for their parts where it is ``spread``."""
    found: list[Any] = []
    for item in _fixed(sequence):
        found += function(*_fixed(item)) if spread else function(item)
    return _fixed(found)


def given(test: object, make: Callable[[], list[Any]]) -> list[Any]:
    """The result of ``make`` where a condition holds, which has to be fixed, and nothing elsewhere."""
    node = truth(test)
    if not node.is_constant:
        raise NotSymbolicError
    return make() if node.value else []


def over(name: str, values: object) -> Any:
    """``all``, ``any``, ``sum``, ``min`` or ``max`` of the elements of a fixed sequence."""
    elements = _fixed(values)
    if name in ("all", "any"):
        nodes = [truth(value) for value in elements]
        if not nodes:
            return name == "all"
        return (
            as_value(connect("and" if name == "all" else "or", nodes))
            if len(nodes) > 1
            else as_value(nodes[0])
        )
    kinds = [as_node(value).kind for value in elements]
    if not elements or not all(kind.is_number for kind in kinds):
        raise NotSymbolicError
    if name in _EXTREMES:
        return operate(_EXTREMES[name], *elements) if len(elements) > 1 else elements[0]
    if _COMPENSATES and len(elements) > 2 and Kind.SCALAR in kinds:
        raise NotSymbolicError
    total: Any = 0
    for value in elements:
        total = operate("add", total, value)
    return total


def differ(values: object, count: object) -> Any:
    """``len(set(values)) == count`` where it means that all elements of a fixed sequence differ."""
    elements = _fixed(values)
    if type(count) is not int or count != len(elements) or count * (count - 1) // 2 > MOST:
        raise NotSymbolicError
    nodes = [as_node(value) for value in elements]
    if not all(node.kind.is_number for node in nodes) and not all(map(is_choice_of_frozen, nodes)):
        raise NotSymbolicError  # Whether others are equal is for their own methods to say.
    return over("all", [operate("not equal", one, other) for one, other in combinations(elements, 2)])


def _fixed(sequence: Any) -> list[Any]:
    """The elements of a sequence whose number is known, noting those that the program may still change."""
    if type(sequence) not in (list, tuple, range):
        raise NotSymbolicError
    elements = list(_few(sequence))
    context = current.get()
    if type(sequence) is list and context is not None:
        context.record.unrolled.append((sequence, tuple(elements)))
    return elements


def _few(items: Iterable[object]) -> Iterable[Any]:
    for number, item in enumerate(items):
        if number == MOST:
            raise NotSymbolicError
        yield item


__all__ = ["differ", "each", "given", "iterated", "over"]
