"""The evolution strategy CMA-ES, by the library ``cma``."""

import contextlib
import io
import warnings
from collections.abc import Iterator
from typing import Any

import numpy as np

from scenic.falsification.samplers.search_sampler import SamplerError, options
from scenic.falsification.space import Floats, Space
from scenic.language.extras import needing
from scenic.runtime.python.random_state import preserved, seed_globals

__all__ = ["Evolution"]


class Evolution:
    """CMA-ES (Hansen, "The CMA evolution strategy: a tutorial", 2016) in the unit cube.

    A discrete value has an equal share of its coordinate, and the least deviation of that coordinate stays wide enough to reach
    the next one. Where the walk has converged it begins anew elsewhere. Rejected points count as worse than all others of
    their generation.
    """

    def __init__(self, space: Space, seed: int, given: object = None) -> None:
        with (
            needing("the sampler 'cma' needs the package `cma`", "falsify", kind=SamplerError),
            warnings.catch_warnings(),
        ):
            warnings.simplefilter("ignore")
            import cma
        settings = options(given, {"sigma": 0.3, "popsize": None}, "cma")
        self._cma: Any = cma
        self._sigma = float(settings["sigma"])
        self._size = settings["popsize"]
        # The library knows no walk in one dimension: a coordinate that nothing reads makes two.
        self._dimension = max(2, len(space))
        self._wanted = len(space)
        self._least = [0.5 / item.count if item.count else 0.0 for item in space.coordinates]
        self._least += [0.0] * (self._dimension - self._wanted)
        self._generator = np.random.default_rng(seed)
        self._walk: Any = None
        self._first = True
        self._asked: dict[bytes, Any] = {}
        self._told: list[tuple[Any, float]] = []
        self._begin()

    @property
    def batch(self) -> int:
        """The size of a generation."""
        return int(self._walk.popsize)

    def _begin(self) -> None:
        start = np.full(self._dimension, 0.5) if self._first else self._generator.random(self._dimension)
        self._first = False
        settings = {
            "bounds": [0, 1],
            "seed": int(self._generator.integers(1, 2**31)),
            "verbose": -9,
            "minstd": self._least,
        }
        if self._size is not None:
            settings["popsize"] = int(self._size)
        with self._quiet():
            self._walk = self._cma.CMAEvolutionStrategy(start, self._sigma, settings)

    @contextlib.contextmanager
    def _quiet(self) -> Iterator[None]:
        """While the library works: it prints, warns and draws from the global generators."""
        seed = int(self._generator.integers(2**32))
        with preserved(), contextlib.redirect_stdout(io.StringIO()), warnings.catch_warnings():
            warnings.simplefilter("ignore")
            seed_globals(seed)
            yield

    def ask(self, count: int) -> Floats:
        """See `Sampler.ask`."""
        rows = []
        with self._quiet():
            solutions = self._walk.ask(count)
        for solution in solutions:
            row = np.clip(solution, 0, 1)[: self._wanted]
            self._asked[row.tobytes()] = solution
            rows.append(row)
        return np.array(rows, dtype=np.float64).reshape(count, self._wanted)

    def tell(self, points: Floats, values: Floats) -> None:
        """See `Sampler.tell`."""
        for point, value in zip(points, values.tolist(), strict=True):
            solution = self._asked.pop(np.asarray(point).tobytes(), None)
            if solution is not None:
                self._told.append((solution, value))
        if len(self._told) < self._walk.popsize:
            return
        finite_values = [value for _, value in self._told if np.isfinite(value)]
        worst = max(finite_values, default=0.0)
        spread = worst - min(finite_values, default=0.0) + 1.0
        fitness = [
            value
            if np.isfinite(value)
            else (min(finite_values, default=0.0) - spread if value == -np.inf else worst + spread)
            for _, value in self._told
        ]
        with self._quiet():
            self._walk.tell([solution for solution, _ in self._told], fitness)
            has_ended = bool(self._walk.stop()) or not finite_values
        self._told = []
        if has_ended:
            self._asked.clear()
            self._begin()
