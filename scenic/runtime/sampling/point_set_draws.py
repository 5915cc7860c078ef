"""Draws of scenes and of simulations by rows of a point set, rather than by hashing."""

from collections.abc import Callable, Mapping

import numpy as np
from numpy.typing import NDArray

from scenic.graph.draws import BOX, Counter, Floats, LaneOwners, NumberSource, Words, each_of_distinct
from scenic.graph.node import Graph
from scenic.graph.points import PointSet

__all__ = ["driven"]


class _Driven:
    """The source of lanes whose numbers are those of rows, as far as rows go."""

    def __init__(self, points: PointSet, axes: Mapping[int, int], count: int, lanes: LaneOwners) -> None:
        self._points = points
        self._axes = axes
        self._count = count
        self._lanes = lanes
        self._rest = Counter(lanes.keys)

    def __len__(self) -> int:
        return len(self._rest)

    def take(self, lanes: NDArray[np.intp]) -> "_Driven":
        return _Driven(self._points, self._axes, self._count, self._lanes.take(lanes))

    def uniforms(self, addresses: Words) -> Floats:
        names = addresses.tolist()
        axes = np.array([self._axes.get(name, -1) for name in names], dtype=np.intp)
        result = self._points.of_scenes(axes, self._count, self._lanes)
        missing = np.isnan(result)
        # Which boxes are drawn from in all but the first factor of a domain.
        missing[[name not in self._axes for name in names]] = True
        return np.where(missing, self._rest.uniforms(addresses), result) if missing.any() else result

    def uniform_each(self, addresses: Words) -> Floats:
        return each_of_distinct(self, addresses)

    def words(self, addresses: Words) -> Words:
        return self._rest.words(addresses)


def driven(points: PointSet, graph: Graph) -> Callable[[LaneOwners], NumberSource]:
    """Return a function that makes the sources of lanes: axes are numbered in the order of the graph."""
    axes = {graph.address(node): place for place, node in enumerate(graph.axes)}
    return lambda lanes: _Driven(points, {**axes, BOX: -1}, graph.dimension, lanes)
