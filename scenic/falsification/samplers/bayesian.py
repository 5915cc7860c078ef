"""Bayesian optimisation: a Gaussian process of the observed values, by scikit-learn, and expected improvement."""

import warnings
from typing import Any, Final

import numpy as np

from scenic.falsification.samplers.search_sampler import SamplerError, options
from scenic.falsification.space import Floats, Space

__all__ = ["Bayesian"]

_CANDIDATES: Final = 1024
"""Number of points compared for each requested point; a quarter of them near the best points."""
_MOST: Final = 300
"""Values that the process is fitted to: the best half of them, and the newest; the time of a fit grows with their cube."""
_REFIT: Final = 10
"""Number of values after which the parameters of the process are fitted again; up to `_EAGER` values, they always are."""
_EAGER: Final = 40
_LEAST: Final = 1e-12


class Bayesian:
    """Expected improvement (Jones, Schonlau and Welch, 1998) under a process with a Matérn kernel, after ``init_num`` random points.

    Discrete values lie in the middle of their shares of a coordinate. Rejected points count as bad as the worst value, and
    points that wait for their value as what the process expects there, so that those of a batch differ.
    """

    batch = 1

    def __init__(self, space: Space, seed: int, given: object = None) -> None:
        settings = options(given, {"init_num": 5}, "bo")
        _library()
        self._first = int(settings["init_num"])
        self._counts = [item.count for item in space.coordinates]
        self._generator = np.random.default_rng(seed)
        self._points: list[Floats] = []
        self._values: list[float] = []
        self._waiting: list[Floats] = []
        self._kernel: Any = None
        self._fitted_at = 0

    def ask(self, count: int) -> Floats:
        """See `Sampler.ask`."""
        rows = []
        for _ in range(count):
            point_count = len(self._values) + len(self._waiting)
            finite = np.isfinite(self._values)
            if point_count < self._first or not finite.any():
                row = self._placed(self._generator.random((1, len(self._counts))))[0]
            else:
                row = self._best()
            self._waiting.append(row)
            rows.append(row)
        return np.array(rows).reshape(count, len(self._counts))

    def tell(self, points: Floats, values: Floats) -> None:
        """See `Sampler.tell`."""
        for point, value in zip(points, values.tolist(), strict=True):
            row = np.array(point, dtype=np.float64)
            self._waiting = [other for other in self._waiting if not np.array_equal(other, row)]
            self._points.append(row)
            self._values.append(value)

    def _placed(self, rows: Floats) -> Floats:
        """Points with discrete coordinates in the middle of their shares."""
        for place, count in enumerate(self._counts):
            if count is not None:
                rows[:, place] = (np.minimum(np.floor(rows[:, place] * count), count - 1) + 0.5) / count
        return rows

    def _best(self) -> Floats:
        """Return the candidate of the greatest expected improvement."""
        from scipy.stats import norm

        points, values = self._known()
        process = self._process(points, values)
        if self._waiting:
            waiting = np.array(self._waiting)
            points = np.concatenate([points, waiting])
            values = np.concatenate([values, process.predict(waiting)])
            process = self._fitted(process.kernel_, points, values, again=False)
        candidates = self._candidates(points, values)
        mean, deviation = process.predict(candidates, return_std=True)
        better = values.min() - mean
        deviation = np.maximum(deviation, _LEAST)
        improvement = better * norm.cdf(better / deviation) + deviation * norm.pdf(better / deviation)
        return np.asarray(candidates[int(np.argmax(improvement))])

    def _known(self) -> tuple[Floats, Floats]:
        """The points and values that count, at most `_MOST`, the values between -1 and 1."""
        values = np.array(self._values)
        finite = np.isfinite(values)
        worst, least = values[finite].max(), values[finite].min()
        values = np.where(finite, values, np.where(values == -np.inf, least, worst))
        points = np.array(self._points)
        if len(values) > _MOST:
            best = np.argsort(values[: -_MOST // 2], kind="stable")[: _MOST // 2]
            indices = np.concatenate([np.sort(best), np.arange(len(values) - _MOST // 2, len(values))])
            points, values = points[indices], values[indices]
        spread = float(values.max() - values.min())
        return points, (values - values.mean()) / (spread if spread > 0 else 1.0)

    def _process(self, points: Floats, values: Floats) -> Any:
        told = len(self._values)
        again = self._kernel is None or told <= _EAGER or told - self._fitted_at >= _REFIT
        if self._kernel is None:
            self._kernel = _kernel(len(self._counts))
        process = self._fitted(self._kernel, points, values, again=again)
        if again:
            self._kernel, self._fitted_at = process.kernel_, told
        return process

    def _fitted(self, kernel: object, points: Floats, values: Floats, *, again: bool) -> Any:
        regressor = _library().GaussianProcessRegressor(
            kernel, optimizer="fmin_l_bfgs_b" if again else None, alpha=1e-8
        )
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")  # about lengths at their bounds, which do no harm
            return regressor.fit(points, values)

    def _candidates(self, points: Floats, values: Floats) -> Floats:
        size = len(self._counts)
        spread = self._generator.random((_CANDIDATES * 3 // 4, size))
        # What is worst is often at a border, where chance alone never is.
        at_borders = spread[: _CANDIDATES // 2]
        is_snapped = self._generator.random(at_borders.shape) < self._generator.random((len(at_borders), 1))
        at_borders[is_snapped] = np.round(at_borders[is_snapped])
        best = points[np.argsort(values, kind="stable")[:5]]
        width = 0.1 * 0.5 ** self._generator.integers(0, 5, (_CANDIDATES // 4, 1))
        near = best[np.arange(_CANDIDATES // 4) % len(best)]
        near = np.clip(near + self._generator.normal(0, 1, near.shape) * width, 0, 1)
        return self._placed(np.concatenate([spread, near]))


def _kernel(size: int) -> Any:
    from sklearn.gaussian_process import kernels

    lengths = kernels.Matern(np.full(size, 0.5), (0.03, 20.0), nu=2.5)
    return kernels.ConstantKernel(0.1, (1e-3, 1e2)) * lengths + kernels.WhiteKernel(1e-4, (1e-7, 1e-1))


def _library() -> Any:
    try:
        from sklearn import gaussian_process  # optional, and slow to import
    except ImportError:
        raise SamplerError(
            "the sampler 'bo' needs the package `scikit-learn`",
            help='install it: pip install "scenic-lang[falsify]"',
        ) from None
    return gaussian_process
