"""Comprehensions, ``all``, ``any``, ``sum``, ``max`` and ``min`` over fixed sequences, as nodes of the graph.

The compiler gives what is iterated over and a function of an element. Where the elements are fixed, the function is called once
for each of them while the program is loaded; that gives the values that Python would compute on a sample. Anything else raises
`NotSymbolicError`: then Python computes it on each sample.
"""

import sys
from collections.abc import Callable, Iterable, Sequence
from itertools import combinations, pairwise
from typing import Any, Final

from scenic.graph.construction import make_node
from scenic.graph.kinds import Kind
from scenic.graph.node import Node
from scenic.graph.operations import TABLE
from scenic.runtime.description.conditions import NotSymbolicError, connect, truth
from scenic.runtime.ground.context import current, here
from scenic.runtime.values.values import as_node, as_value, is_choice_of_frozen, operate

MOST: Final = 1000
"""Elements that are unrolled: more would make the graph large."""

_EXTREMES: Final = {"min": "minimum", "max": "maximum"}
_WITH_NEUTRAL_ELEMENT: Final = ("sum", "all", "any")
"""Functions for which an element that is not there may count as one that changes nothing."""
_COMPENSATES: Final = sys.version_info >= (3, 12)
"""True if Python's ``sum`` compensates rounding, and so differs from adding floats in turn."""


def iterated(function: Callable[..., Any], sequences: Sequence[object]) -> list[Any]:
    """Return the elements of ``range``, ``zip``, ``enumerate`` or ``reversed``, of fixed arguments."""
    given = [item if isinstance(item, int) else _fixed(item) for item in sequences]
    return _fixed(list(_few(function(*given))))


def each(sequence: object, function: Callable[..., list[Any]], *, spread: bool) -> list[Any]:
    """Return the values that a function gives for the elements of a fixed sequence, or for their parts where it is ``spread``."""
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


class _Perhaps:
    """An element of a comprehension that is there where a condition holds.

    Args:
        test: the condition.
        value: the element, which may be another such.

    """

    def __init__(self, test: Node, value: Any) -> None:
        self._test = test
        self._value = value

    def otherwise(self, convert: Callable[[Any], Node], default: object) -> Node:
        """Return the node of the element, as ``convert`` makes it, or of ``default`` where the element is not there."""
        value = self._value
        inner = value.otherwise(convert, default) if isinstance(value, _Perhaps) else convert(value)
        return make_node(TABLE["if"], [self._test, inner, as_node(default)], span=here())

    def counted(self) -> "_Perhaps":
        """One in place of the element."""
        return _Perhaps(self._test, self._value.counted() if isinstance(self._value, _Perhaps) else 1)


def perhaps(test: object, make: Callable[[], list[Any]]) -> list[Any]:
    """The result of ``make``, each element of which is there only where a condition holds."""
    node = truth(test)
    if node.is_constant:
        return make() if node.value else []
    return [_Perhaps(node, value) for value in make()]


def number_of(values: list[Any]) -> Any:
    """The number of elements of a comprehension that are there."""
    return over("sum", [value.counted() if isinstance(value, _Perhaps) else 1 for value in values])


def occurrences(values: object, value: object) -> Any:
    """``values.count(value)`` of a fixed list or tuple."""
    if type(values) not in (list, tuple):
        raise NotSymbolicError
    elements = _fixed(values)
    _require_plain_equality([*elements, value])
    return over("sum", [operate("equal", element, value) for element in elements])


def items_of(container: object, view: str) -> list[Any]:
    """List ``values()``, ``keys()`` or ``items()`` of a dictionary, and record what the program may still change."""
    if type(container) is not dict:
        raise NotSymbolicError
    context = current.get()
    if context is not None:
        for items in (container.keys(), container.values()):
            context.record.unrolled.append((items, tuple(items)))
    return list(_few(getattr(container, view)()))


def ascending(values: object) -> Any:
    """``values == sorted(values)`` of a fixed list of numbers."""
    if type(values) is not list:
        raise NotSymbolicError
    elements = _fixed(values)
    if not all(as_node(element).kind.is_number for element in elements):
        raise NotSymbolicError
    return over("all", [operate("less or equal", one, other) for one, other in pairwise(elements)])


def over(name: str, values: object) -> Any:
    """Evaluate ``all``, ``any``, ``sum``, ``min`` or ``max`` of the elements of a fixed sequence."""
    elements = _fixed(values)
    if name in _WITH_NEUTRAL_ELEMENT:
        convert: Callable[[Any], Node] = as_node if name == "sum" else truth
        default: object = 0 if name == "sum" else name == "all"
        elements = [
            as_value(value.otherwise(convert, default)) if isinstance(value, _Perhaps) else value
            for value in elements
        ]
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
    """Evaluate ``len(set(values)) == count`` where it means that all elements of a fixed sequence differ."""
    elements = _fixed(values)
    if type(count) is not int or count != len(elements) or count * (count - 1) // 2 > MOST:
        raise NotSymbolicError
    _require_plain_equality(elements)
    return over("all", [operate("not equal", one, other) for one, other in combinations(elements, 2)])


def _require_plain_equality(values: Sequence[object]) -> None:
    """Refuse values of whose equality their own methods have to tell."""
    nodes = [as_node(value) for value in values]
    if not all(node.kind.is_number for node in nodes) and not all(map(is_choice_of_frozen, nodes)):
        raise NotSymbolicError


def _fixed(sequence: Any) -> list[Any]:
    """Return the elements of a sequence whose number is known, noting those that the program may still change."""
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


__all__ = [
    "ascending",
    "differ",
    "each",
    "given",
    "items_of",
    "iterated",
    "number_of",
    "occurrences",
    "over",
    "perhaps",
]
