"""Choices among many alike options, evaluated once a lane instead of once an option.

Of a choice among a thousand values that the same operations make of different numbers, a lane needs one. So the choice
is taken down to what the options are made of: choosing among sums is the sum of what choosing among their terms gives, and at the
bottom are tables of constants, and draws of which each lane makes one. What is merged serves evaluation alone; analysis and the
addresses of draws see the choice as it is.
"""

from collections.abc import Hashable, Sequence
from typing import Final

import numpy as np

from scenic.graph.construction import make_node
from scenic.graph.kinds import Kind
from scenic.graph.node import Node
from scenic.graph.operations.distributions import LOOKUP, SELECT, LookupTable

__all__ = ["Merger", "is_choice_of_draws"]

_LEAST: Final = 8
"""Options from which on merging pays; it also pays with this number of options for each class of similar options."""

_DEEPEST: Final = 64
"""Operations one upon the other down to which options are compared."""


def is_choice_of_draws(node: Node) -> bool:
    """Return whether a node takes one of several axes: a lane draws that one alone."""
    return node.operation is SELECT and all(option.is_axis for option in node.operands[1:])


class Merger:
    """Merges choices, each once."""

    def __init__(self) -> None:
        self._merged: dict[Node, Node] = {}

    def __call__(self, node: Node) -> Node:
        """Return a node of the same value that takes less to evaluate; ``node`` itself where there is none."""
        if node.operation is not SELECT or node.kind.is_boxed or len(node.operands) <= _LEAST:
            return node
        replacement = self._merged.get(node)
        if replacement is None:
            index, *options = node.operands
            choice = _Choice(index).among(options, _DEEPEST)
            replacement = self._merged[node] = (
                choice if choice.kind is node.kind and not choice.is_constant else node
            )
        return replacement


class _Choice:
    """Choosing by one index."""

    def __init__(self, index: Node) -> None:
        self._index = index
        self._known: dict[tuple[Node, ...], Node] = {}

    def among(self, options: Sequence[Node], depth: int) -> Node:
        """Return the value of the option that is chosen."""
        key = tuple(options)
        found = self._known.get(key)
        if found is None:
            found = self._known[key] = self._made(options, depth)
        return found

    def _made(self, options: Sequence[Node], depth: int) -> Node:
        first = options[0]
        if all(option is first for option in options):
            return first
        classes: dict[Hashable, list[int]] = {}
        for place, option in enumerate(options):
            classes.setdefault(_likeness(option), []).append(place)
        if len(classes) == 1:
            if first.is_constant or first.is_axis or depth == 0:
                return self._plain(options)
            rows = zip(*(option.operands for option in options), strict=True)
            operands = [self.among(row, depth - 1) for row in rows]
            node = make_node(first.operation, operands, first.payload)
            return node if node.kind is first.kind else self._plain(options)
        if len(classes) * _LEAST > len(options):
            return self._plain(options)
        number, position = np.zeros((2, len(options)), dtype=np.int64)
        inner = []
        for label, places in enumerate(classes.values()):
            number[places], position[places] = label, np.arange(len(places))
        for label, places in enumerate(classes.values()):
            mine = _Choice(self._looked_up(np.where(number == label, position, 0)))
            inner.append(mine.among([options[place] for place in places], depth))
        return make_node(SELECT, [self._looked_up(number), *inner])

    def _plain(self, options: Sequence[Node]) -> Node:
        return make_node(SELECT, [self._index, *options])

    def _looked_up(self, values: np.ndarray[tuple[int], np.dtype[np.int64]]) -> Node:
        return make_node(LOOKUP, [self._index], LookupTable(Kind.INTEGER, values))


def _likeness(node: Node) -> Hashable:
    """Return a key that is equal for nodes that may be merged."""
    if node.is_constant or node.is_axis:
        return node.operation, node.kind
    operation = node.operation
    # What stacks is elementwise: its values are the same in every bit, whatever else is evaluated with them.
    merges = operation.stacks and operation.strict and operation.pure
    boxed = node.kind.is_boxed or any(operand.kind.is_boxed for operand in node.operands)
    return node.likeness if merges and not boxed else id(node)
