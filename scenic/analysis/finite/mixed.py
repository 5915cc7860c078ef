"""Tables of checks that read discrete and continuous values: the combinations of the discrete ones that bounds do not exclude."""

from collections.abc import Hashable, Mapping, Sequence
from typing import Final

import numpy as np

from scenic.analysis.boxes import Boxes
from scenic.analysis.contraction import surviving
from scenic.analysis.facts import Fact
from scenic.analysis.finite.tables import Likeness, Mask
from scenic.analysis.finite.variables import Variable
from scenic.graph.bounding import over
from scenic.graph.bounds import Bounds
from scenic.graph.node import Graph, Node
from scenic.runtime.sampling.checks import Check, CollisionCheck, NodeCheck, ObjectNodes

__all__ = ["Possible"]

LARGEST: Final = 1 << 10
"""Combinations of a table, at most."""

BUDGET: Final = 1 << 19
"""Combinations times nodes of all tables together, at most."""

_MARGIN: Final = 1e-9
"""Relative: what rounding may add to distances and sizes, with room to spare."""


class Possible:
    """Makes tables of what is possible.

    Args:
        graph: the graph.
        variables: the finite axes.

    """

    def __init__(self, graph: Graph, variables: Mapping[Node, Variable]) -> None:
        self._graph = graph
        self._variables = variables
        self._left = BUDGET
        self._likeness = Likeness(variables)
        self._known: dict[Hashable, Mask | None] = {}

    def table(self, check: Check) -> tuple[list[Variable], Mask] | None:
        """Return the finite axes that a check reads, and which combinations may pass it; ``None`` where that is not found out."""
        every = Graph(check.nodes).nodes
        scope = [self._variables[node] for node in every if node in self._variables]
        count = float(np.prod([variable.size for variable in scope], dtype=np.float64))
        if not scope or count > LARGEST or count * len(every) > self._left:
            return None
        key = type(check), self._likeness(check.nodes, every)
        if key not in self._known:
            self._left -= int(count) * len(every)
            self._known[key] = self._made(check, scope)
        possible = self._known[key]
        return None if possible is None else (scope, possible)

    def _made(self, check: Check, scope: Sequence[Variable]) -> Mask | None:
        sizes = tuple(variable.size for variable in scope)
        boxes = self._boxes(scope, sizes)
        if isinstance(check, NodeCheck):
            return surviving(self._graph, Fact(check.node, check.label), boxes).reshape(sizes)
        if isinstance(check, CollisionCheck):
            return np.asarray(~self._collides(check.objects, boxes)).reshape(sizes)
        return None

    def _boxes(self, scope: Sequence[Variable], sizes: tuple[int, ...]) -> Boxes:
        """Return a box of the cube for each combination."""
        cells = np.unravel_index(np.arange(int(np.prod(sizes))), sizes)
        lower = np.zeros((len(cells[0]), self._graph.dimension))
        upper = np.ones((len(cells[0]), self._graph.dimension))
        for variable, cell in zip(scope, cells, strict=True):
            lower[:, variable.number] = variable.lower[cell]
            upper[:, variable.number] = variable.upper[cell]
        return Boxes(lower, upper)

    def _collides(self, pair: Sequence[ObjectNodes], boxes: Boxes) -> Mask:
        """Return the boxes in which two objects collide in any case: balls within them, about their positions, meet."""
        count = len(boxes)
        never = np.zeros(count, dtype=np.bool_)
        if not all(item.shape.is_constant and item.shape.value.mesh.is_box for item in pair):
            return never
        if not all(item.allow_collisions.is_constant and not item.allow_collisions.value for item in pair):
            return never
        nodes = [node for item in pair for node in (item.position, item.size)]
        bounds = over(nodes, self._graph.axes, boxes.lower, boxes.upper)
        radius, places = np.zeros(count), []
        for item in pair:
            position, size = bounds[item.position], bounds[item.size]
            if position is None or size is None or position.lower.ndim != 2 or size.lower.ndim != 2:
                return never
            radius = radius + np.maximum(size.lower.min(axis=1), 0.0) / 2
            places.append(position)
        one, other = places
        with np.errstate(invalid="ignore"):
            apart = np.linalg.norm(_most_apart(one, other), axis=1)
            return np.asarray(np.broadcast_to(apart * (1 + _MARGIN) < radius * (1 - _MARGIN), (count,)))


def _most_apart(one: Bounds, other: Bounds) -> np.ndarray[tuple[int, int], np.dtype[np.float64]]:
    """Return the largest difference of two positions along each axis, ``(m, 3)``."""
    return np.asarray(np.maximum(np.abs(one.upper - other.lower), np.abs(other.upper - one.lower)))
