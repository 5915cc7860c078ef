"""Objects that come to overlap, in simulators that let objects pass through each other."""

from array import array
from collections.abc import Sequence
from itertools import chain
from typing import Any, Final

import numpy as np

from scenic.runtime.geometry.contact.collision import Body, collide
from scenic.runtime.geometry.poses import Booleans, Floats, Indices, Poses
from scenic.simulators.results import SimulationState

__all__ = ["Contacts"]

_STATES: Final = 128
"""States that are looked at together: few, since the boxes around the ways of objects grow with time."""


class Contacts:
    """Finds the pairs of objects that come to overlap, from the states of a simulation.

    Pairs that overlap in the first state of both, and pairs in which one ``allowCollisions``, are left out, as they are where
    scenes are drawn. States are looked at in groups, so that a step costs next to nothing.

    Args:
        objects: the objects of the simulation; others may follow while it runs.

    """

    def __init__(self, objects: Sequence[Any]) -> None:
        self._objects = objects
        # Numbers alone: objects that outlive a step would cost the garbage collector more than all else here costs.
        self._places, self._turns = array("d"), array("d")
        self._count = self._waiting = self._start = 0
        self._since: list[int] = []
        self._known: set[tuple[int, int]] = set()
        self._firsts: list[tuple[int, int, int, tuple[float, float]]] = []

    def add(self, state: SimulationState) -> None:
        """Take the next state."""
        count = len(state)
        if self._waiting == _STATES or count != self._count:
            self._look()
        self._count = count
        self._waiting += 1
        self._places.extend(chain.from_iterable([place.row for place in state.positions]))
        self._turns.extend(chain.from_iterable([turn.q for turn in state.orientations]))

    def firsts(self) -> list[tuple[int, int, int, tuple[float, float]]]:
        """Return, for each pair, the first state in which it overlaps, the two numbers, and about where, in metres."""
        self._look()
        return sorted(self._firsts)

    def _look(self) -> None:
        """Look at the states that wait."""
        steps, count, start = self._waiting, self._count, self._start
        places = np.array(self._places).reshape(steps, count, 3)
        turns = np.array(self._turns).reshape(steps, count, 4)
        self._places, self._turns = array("d"), array("d")
        self._waiting, self._start = 0, start + steps
        self._since += [start] * (count - len(self._since))
        if count < 2 or not steps:
            return
        sizes = np.array([(item.width, item.length, item.height) for item in self._objects[:count]], float)
        radii = np.linalg.norm(sizes, axis=1) / 2
        one, other = self._pairs(places, radii)
        is_still = (places == places[0]).all(axis=(0, 2)) & (turns == turns[0]).all(axis=(0, 2))
        pair, step = _near(places, radii, one, other, is_still)
        if not len(pair):
            return
        bodies = [self._body(numbers[pair], step, places, turns, sizes) for numbers in (one, other)]
        hits = np.flatnonzero(~collide(bodies, np.array([[0, 1]]), lanes=len(pair)).free)
        for hit in hits[np.unique(pair[hits], return_index=True)[1]].tolist():
            first, second = int(one[pair[hit]]), int(other[pair[hit]])
            self._known.add((first, second))
            when = start + int(step[hit])
            if when > max(self._since[first], self._since[second]):
                # Between the middles, nearer to that of the smaller one.
                share = radii[first] / (radii[first] + radii[second])
                x, y, _ = places[step[hit], [first, second]].T @ (1 - share, share)
                self._firsts.append((when, first, second, (float(x), float(y))))

    def _pairs(self, places: Floats, radii: Floats) -> tuple[Indices, Indices]:
        """Return the pairs that may overlap: boxes around their ways do, and nothing else is known of them."""
        import shapely  # slow to import

        low = places.min(axis=0) - radii[:, None]
        high = places.max(axis=0) + radii[:, None]
        boxes = shapely.box(low[:, 0], low[:, 1], high[:, 0], high[:, 1])
        one, other = shapely.STRtree(boxes).query(boxes)
        may = np.array([not item.allowCollisions for item in self._objects[: len(radii)]], dtype=np.bool_)
        wanted = (one < other) & may[one] & may[other]
        one, other = one[wanted], other[wanted]
        is_open = [pair not in self._known for pair in zip(one.tolist(), other.tolist(), strict=True)]
        return one[is_open], other[is_open]

    def _body(self, numbers: Indices, steps: Indices, places: Floats, turns: Floats, sizes: Floats) -> Body:
        """Return the bodies of these objects in these states, as lanes."""
        shapes = [item.shape.mesh for item in self._objects[: places.shape[1]]]
        meshes = {mesh: index for index, mesh in enumerate(dict.fromkeys(shapes))}
        choice = np.array([meshes[mesh] for mesh in shapes])[numbers] if len(meshes) > 1 else None
        return Body(
            tuple(meshes), choice, Poses(places[steps, numbers], turns[steps, numbers], sizes[numbers])
        )


def _near(
    places: Floats, radii: Floats, one: Indices, other: Indices, is_still: Booleans
) -> tuple[Indices, Indices]:
    """Return pairs and states in which the balls around both overlap; of pairs that stand still, the first state."""
    apart = places[:, one] - places[:, other]
    is_near: Booleans = np.einsum("spc,spc->sp", apart, apart) <= (radii[one] + radii[other]) ** 2
    is_near[1:, is_still[one] & is_still[other]] = False
    pair, step = np.nonzero(is_near.T)
    return pair, step
