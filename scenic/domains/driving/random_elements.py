"""Elements at random places: an index into the network's elements, found for all lanes of a batch at once."""

from collections.abc import Sequence
from functools import cached_property
from typing import Any, Protocol

import numpy as np
from numpy.typing import NDArray

from scenic.domains.driving.elements import NetworkElement
from scenic.domains.driving.lookups import Finder
from scenic.graph.bounds import Bounds
from scenic.graph.kinds import Column, Kind
from scenic.graph.operation import Call, Operation, always
from scenic.language.errors import RejectionException
from scenic.runtime.values.values import apply, as_node, as_value, rejection, select

__all__ = ["NestedFinder", "Search", "element_at"]


class Search(Protocol):
    """Finds one of its elements by place."""

    @property
    def elements(self) -> tuple[NetworkElement, ...]:
        """The elements."""

    def near(self, places: NDArray[np.float64]) -> NDArray[np.intp]:
        """Index of the element at each place ``(n, 2 | 3)``; their number where there is none."""


class NestedFinder:
    """Finds parts of the elements that another finder finds.

    Args:
        outer: finds the elements.
        inner: finds the parts of each of them.

    """

    def __init__(self, outer: Finder, inner: Sequence[Finder]) -> None:
        self._outer = outer
        self._inner = tuple(inner)
        self._starts = np.cumsum([0, *(len(finder.elements) for finder in inner)])

    @cached_property
    def elements(self) -> tuple[NetworkElement, ...]:
        """The parts of all elements, one element after the other."""
        return tuple(part for finder in self._inner for part in finder.elements)

    def near(self, places: NDArray[np.float64]) -> NDArray[np.intp]:
        """Index of the part at each place ``(n, 2 | 3)``; their number where there is none."""
        outer = self._outer.near(places)
        result = np.full(len(places), len(self.elements), dtype=np.intp)
        for number in np.unique(outer[outer < len(self._inner)]):
            mine = np.flatnonzero(outer == number)
            found = self._inner[number].near(places[mine])
            known = found < len(self._inner[number].elements)
            result[mine[known]] = self._starts[number] + found[known]
        return result


def element_at(search: Search, place: Any, reject: Any) -> Any:
    """The random element at a random place; where there is none, ``None``, or a rejection if ``reject``."""
    if reject and not search.elements:
        return as_value(rejection(RejectionException("there is no such element in the network")))
    index = apply(_ELEMENT, place, payload=(search, bool(reject)))
    options = search.elements if reject else (*search.elements, None)
    return select(as_node(index), list(map(as_node, options)))


def _element(call: Call, points: Column) -> Column:
    search, reject = call.payload
    found = search.near(points)
    if reject:
        call.reject(found == len(search.elements))
        found = np.minimum(found, len(search.elements) - 1)
    return np.asarray(found, dtype=np.int64)


def _numbers(search: Search, reject: bool) -> Bounds:
    return Bounds(np.zeros(1), np.full(1, float(len(search.elements) - reject)))


_ELEMENT = Operation(
    "element at a place",
    always(Kind.INTEGER),
    _element,
    "Which element is at a place, or their number where none is; payload what finds it, and whether none rejects the sample.",
    bounds=lambda payload, _place: _numbers(*payload),
    rejects=lambda _operands, payload: payload[1],
    missing="element at the place",
)
