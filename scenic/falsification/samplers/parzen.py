"""Tree-structured Parzen estimators, by the library ``optuna``."""

import warnings
from typing import Any

import numpy as np

from scenic.falsification.samplers.search_sampler import SamplerError, options
from scenic.falsification.space import Floats, Space
from scenic.language.extras import needing

__all__ = ["Parzen"]


class Parzen:
    """Tree-structured Parzen estimators (Bergstra et al., "Algorithms for hyper-parameter optimization", 2011)."""

    batch: int | None = None

    def __init__(self, space: Space, seed: int, given: object = None) -> None:
        options(given, {}, "tpe")
        optuna = _library()
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")
            sampler = optuna.samplers.TPESampler(seed=seed % 2**32, multivariate=True, constant_liar=True)
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
                coordinate = trial.params[f"x{place}"]
                row[place] = coordinate if item.count is None else (coordinate + 0.5) / item.count
            self._open.append((row.tobytes(), trial))
        return rows

    def tell(self, points: Floats, values: Floats) -> None:
        """See `Sampler.tell`."""
        for point, value in zip(points, values.tolist(), strict=True):
            key = np.ascontiguousarray(point).tobytes()
            place = next((place for place, (open_key, _) in enumerate(self._open) if open_key == key), None)
            if place is None:
                continue
            _, trial = self._open.pop(place)
            with warnings.catch_warnings():
                warnings.simplefilter("ignore")
                if np.isfinite(value):
                    self._study.tell(trial, value)
                else:
                    self._study.tell(trial, state=self._optuna.trial.TrialState.FAIL)


def _library() -> Any:
    with needing("the sampler 'tpe' needs the package `optuna`", "falsify", kind=SamplerError):
        import optuna
    optuna.logging.set_verbosity(optuna.logging.ERROR)
    return optuna
