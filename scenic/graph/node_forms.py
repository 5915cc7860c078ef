"""Forms of nodes: alike computations of alike leaves, whose bounds are equal therefore.

The positions of a thousand boxes are a thousand nodes of one form. Interval arithmetic looks at an operation and the bounds of its
operands alone, so that one of them answers for all.
"""

from collections.abc import Callable, Hashable
from typing import Final

from scenic.graph.node import Node

__all__ = ["Forms"]


class Forms:
    """Numbers of nodes, equal for nodes of one form.

    Args:
        leaf: equal for draws that count as alike; all of one operation are, where it is missing.

    """

    def __init__(self, leaf: Callable[[Node], Hashable] | None = None) -> None:
        self._leaf: Final = leaf
        self._numbers: dict[Node, int] = {}
        self._known: dict[Hashable, int] = {}

    def number(self, root: Node) -> int:
        """The number of the form of a node."""
        numbers = self._numbers
        stack = [root]
        while stack:
            node = stack[-1]
            if node in numbers:
                stack.pop()
                continue
            missing = [operand for operand in node.operands if operand not in numbers]
            if missing:
                stack += missing
                continue
            numbers[node] = self._known.setdefault(self._key(node), len(self._known))
            stack.pop()
        return numbers[root]

    def _key(self, node: Node) -> Hashable:
        if node.is_constant:
            return node.kind, node.payload.key
        if node.is_drawn:
            return node.kind, None if self._leaf is None else self._leaf(node)
        return node.likeness, node.limits, tuple([self._numbers[operand] for operand in node.operands])
