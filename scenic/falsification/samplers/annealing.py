"""Simulated annealing."""

import math
from typing import Final

import numpy as np

from scenic.falsification.samplers.search_sampler import options
from scenic.falsification.space import Floats, Space

__all__ = ["Annealing"]

_FIRST: Final = 10
"""Points from anywhere at the beginning of an epoch; the walk sets out from the best of them."""
_ANYWHERE: Final = 0.3
"""Chance that a later point is from anywhere, so that a walk in a valley without counterexamples does not wait for the next epoch."""
_MOVED: Final = 0.5
"""Chance that a step changes a coordinate."""


class Annealing:
    """A walk that takes worse points with a chance that falls (Kirkpatrick, Gelatt and Vecchi, 1983).

    Steps are normal, of a width that falls with the temperature's root, in about half of the coordinates, and reflected at the
    borders. In each of ``num_epoch`` epochs the temperature falls by ``decay_rate`` at each of ``iterations`` steps, and the next walk
    sets out from the best of ten new points. After the last epoch the walk goes on, cold, from the best point of all.
    """

    batch = None

    def __init__(self, space: Space, seed: int, given: object = None) -> None:
        settings = options(
            given, {"T": 1.0, "decay_rate": 0.97, "iterations": 100, "num_epoch": 1_000_000}, "sa"
        )
        self._start = float(settings["T"])
        self._decay = float(settings["decay_rate"])
        self._steps = int(settings["iterations"])
        self._epochs = int(settings["num_epoch"])
        self._generator = np.random.default_rng(seed)
        self._dimension = len(space)
        self._told = 0
        self._current: tuple[Floats, float] | None = None
        self._best: tuple[Floats, float] | None = None

    def _begins(self, told: int) -> bool:
        """Return whether the point after ``told`` others is one of the first of its epoch."""
        epoch, step = divmod(told, self._steps)
        return epoch < self._epochs and step < _FIRST

    @property
    def _heat(self) -> float:
        """The temperature as a share of the first one."""
        epoch, step = divmod(self._told, self._steps)
        return float(self._decay ** (step if epoch < self._epochs else self._steps))

    def ask(self, count: int) -> Floats:
        """See `Sampler.ask`."""
        size = (count, self._dimension)
        points = self._generator.random(size)
        if self._current is None:
            return points
        steps = self._generator.normal(0, 0.02 + 0.5 * math.sqrt(self._heat), size)
        steps *= self._generator.random(size) < _MOVED
        neighbours = np.abs((self._current[0] + steps) % 2)
        near = self._generator.random(count) >= _ANYWHERE
        near &= [not self._begins(self._told + place) for place in range(count)]
        points[near] = np.where(neighbours > 1, 2 - neighbours, neighbours)[near]
        return points

    def tell(self, points: Floats, values: Floats) -> None:
        """See `Sampler.tell`."""
        for point, value in zip(points, values.tolist(), strict=True):
            begins = self._begins(self._told)
            self._told += 1
            if math.isfinite(value) or value == -math.inf:
                if self._best is None or value < self._best[1]:
                    self._best = (point, value)
                if self._current is None or self._takes(value - self._current[1], begins=begins):
                    self._current = (point, value)
            if self._told % self._steps == 0:
                self._current = None if self._told < self._steps * self._epochs else self._best

    def _takes(self, worse: float, *, begins: bool) -> bool:
        heat = self._start * self._heat
        return worse <= 0 or (
            not begins and bool(self._generator.random() < math.exp(-worse / max(heat, 1e-300)))
        )
