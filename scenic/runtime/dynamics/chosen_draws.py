"""Draws of simulations that are chosen: by rows of a point set, or, some of them, by an earlier simulation."""

import math
from collections.abc import Callable, Collection, Mapping
from typing import Final

import numpy as np

from scenic.graph.draws import LaneOwners
from scenic.graph.points import PointSet
from scenic.runtime.dynamics.time_draws import Draw, Source

__all__ = ["Sourcing", "driven", "kept"]

Sourcing = Callable[[Source], Source]
"""From the source that hashes to the one that is used."""


_AHEAD: Final = 32
"""Numbers of a row that are computed together."""


class _Driven:
    """Numbers of a row, in the order in which they are drawn."""

    def __init__(self, points: PointSet, axes: int, lane: LaneOwners, rest: Source) -> None:
        self._points = points
        self._axes = axes
        self._lane = lane
        self._rest = rest
        self._next = 0
        self._ready: list[float] = []

    def draw(self, place: int, what: Draw) -> float:
        """The number at an address."""
        if not self._ready:
            draws = np.arange(self._next, self._next + _AHEAD)
            self._next += _AHEAD
            self._ready = self._points.of_simulations(draws, self._axes, self._lane)[::-1, 0].tolist()
        number = self._ready.pop()
        return self._rest.draw(place, what) if math.isnan(number) else number

    def word(self, place: int) -> int:
        """Return 64 random bits at an address."""
        return self._rest.word(place)


def driven(points: PointSet, axes: int, *, seed: int, scene: int, attempt: int) -> Sourcing:
    """The draws of a simulation, from the row of its scene, after the numbers of the scene's axes.

    ``attempt`` tells simulations of one scene from one another, of which the earlier ones were rejected.
    """
    return lambda rest: _Driven(points, axes, LaneOwners.of(seed, scene, attempt), rest)


class _Kept:
    """Some numbers of an earlier simulation, the others from elsewhere."""

    def __init__(self, numbers: Mapping[int, float], keep: Callable[[Draw], bool], rest: Source) -> None:
        self._numbers = numbers
        self._keep = keep
        self._rest = rest

    def draw(self, place: int, what: Draw) -> float:
        """The number at an address."""
        number = self._numbers.get(place)
        if number is not None and self._keep(what):
            return number
        return self._rest.draw(place, what)

    def word(self, place: int) -> int:
        """Return 64 random bits at an address."""
        return self._rest.word(place)


def kept(
    numbers: Mapping[int, float],
    *,
    until: int | None = None,
    agents: Collection[int | None] | None = None,
    keep: Callable[[Draw], bool] | None = None,
) -> Sourcing:
    """The draws of an earlier simulation for draws that meet all given conditions; new draws for the others."""

    def wanted(what: Draw) -> bool:
        return (
            (until is None or what.step < until)
            and (agents is None or what.agent in agents)
            and (keep is None or keep(what))
        )

    return lambda rest: _Kept(numbers, wanted, rest)
