"""Samplers that model what was seen, by the library ``optuna``: Bayesian optimisation, tree-structured Parzen estimators."""

import warnings
from typing import Any

import numpy as np

from scenic.falsification.samplers.protocol import SamplerError, options
from scenic.falsification.space import Floats, Space
from scenic.language.extras import installation

__all__ = ["Bayesian", "Parzen"]


class _Study:
    """A study that optuna keeps in memory."""

    batch: int | None = None

    def __init__(self, space: Space, name: str, sampler: Any) -> None:
        optuna = _optuna(name)
        self._optuna = optuna
        self._study: Any = optuna.create_study(sampler=sampler)
        self._laws = {
            f"x{place}": optuna.distributions.FloatDistribution(0, 1)
            if item.count is None
            else optuna.distributions.IntDistribution(0, item.count - 1)
            for place, item in enumerate(space.coordinates)
        }
        self._space = space
        self._open: list[tuple[bytes, Any]] = []

    def ask(self, count: int) -> Floats:
        """See `Sampler.ask`."""
        rows = np.zeros((count, len(self._space)))
        for row in rows:
            with warnings.catch_warnings():
                warnings.simplefilter("ignore")
                trial = self._study.ask(self._laws)
            for place, item in enumerate(self._space.coordinates):
                found = trial.params[f"x{place}"]
                row[place] = found if item.count is None else (found + 0.5) / item.count
            self._open.append((row.tobytes(), trial))
        return rows

    def tell(self, points: Floats, values: Floats) -> None:
        """See `Sampler.tell`."""
        for point, value in zip(points, values.tolist(), strict=True):
            key = np.ascontiguousarray(point).tobytes()
            place = next((place for place, (known, _) in enumerate(self._open) if known == key), None)
            if place is None:
                continue
            _, trial = self._open.pop(place)
            with warnings.catch_warnings():
                warnings.simplefilter("ignore")
                if np.isfinite(value):
                    self._study.tell(trial, value)
                else:
                    self._study.tell(trial, state=self._optuna.trial.TrialState.FAIL)


def _optuna(name: str) -> Any:
    try:
        import optuna
    except ImportError:
        raise SamplerError(
            f"the sampler {name!r} needs the package `optuna`",
            help=f"install it: {installation('falsify')}",
        ) from None
    optuna.logging.set_verbosity(optuna.logging.ERROR)
    return optuna


class Bayesian(_Study):
    """Bayesian optimisation: a Gaussian process and expected improvement, after ``init_num`` random points."""

    batch = 1

    def __init__(self, space: Space, seed: int, given: Any = None) -> None:
        chosen = options(given, {"init_num": 5}, "bo")
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")
            try:
                import torch as torch
            except ImportError:
                raise SamplerError(
                    "the sampler 'bo' needs the package `torch`",
                    help="install it: pip install torch (it is large, so no extra brings it)",
                ) from None
            sampler = _optuna("bo").samplers.GPSampler(
                seed=seed % 2**32, n_startup_trials=int(chosen["init_num"]), deterministic_objective=True
            )
        super().__init__(space, "bo", sampler)


class Parzen(_Study):
    """Tree-structured Parzen estimators (Bergstra et al., "Algorithms for hyper-parameter optimization", 2011)."""

    def __init__(self, space: Space, seed: int, given: Any = None) -> None:
        options(given, {}, "tpe")
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")
            sampler = _optuna("tpe").samplers.TPESampler(
                seed=seed % 2**32, multivariate=True, constant_liar=True
            )
        super().__init__(space, "tpe", sampler)
