"""Simulated annealing."""

import math
from typing import Any

import numpy as np

from scenic.falsification.samplers.protocol import options
from scenic.falsification.space import Floats, Space

__all__ = ["Annealing"]


class Annealing:
    """A walk that takes worse points with a chance that falls (Kirkpatrick, Gelatt and Vecchi, 1983).

    Steps are normal, of a width in proportion to the temperature's root, and reflected at the borders; in each of
    ``num_epoch`` epochs the temperature falls by ``decay_rate`` at each of ``iterations`` steps, and then begins anew from the best
    point so far.
    """

    batch = None

    def __init__(self, space: Space, seed: int, given: Any = None) -> None:
        chosen = options(
            given, {"T": 1.0, "decay_rate": 0.97, "iterations": 100, "num_epoch": 1_000_000}, "sa"
        )
        self._start = float(chosen["T"])
        self._decay = float(chosen["decay_rate"])
        self._steps = int(chosen["iterations"])
        self._epochs = int(chosen["num_epoch"])
        self._generator = np.random.default_rng(seed)
        self._dimension = len(space)
        self._told = 0
        self._current: tuple[Floats, float] | None = None
        self._best: tuple[Floats, float] | None = None

    @property
    def _heat(self) -> float:
        """The temperature as a share of the first one."""
        epoch, step = divmod(self._told, self._steps)
        return float(self._decay ** (step if epoch < self._epochs else self._steps))

    def ask(self, count: int) -> Floats:
        """See `Sampler.ask`."""
        if self._current is None:
            return self._generator.random((count, self._dimension))
        width = 0.02 + 0.3 * math.sqrt(self._heat)
        steps = self._generator.normal(0, width, (count, self._dimension))
        moved = np.abs((self._current[0] + steps) % 2)
        return np.asarray(np.where(moved > 1, 2 - moved, moved))

    def tell(self, points: Floats, values: Floats) -> None:
        """See `Sampler.tell`."""
        for point, value in zip(points, values.tolist(), strict=True):
            self._told += 1
            if self._told % self._steps == 0 and self._best is not None:
                self._current = self._best
            if not math.isfinite(value) and value != -math.inf:
                continue
            if self._best is None or value < self._best[1]:
                self._best = (point, value)
            if self._current is None or self._takes(value - self._current[1]):
                self._current = (point, value)

    def _takes(self, worse: float) -> bool:
        heat = self._start * self._heat
        return worse <= 0 or bool(self._generator.random() < math.exp(-worse / max(heat, 1e-300)))
