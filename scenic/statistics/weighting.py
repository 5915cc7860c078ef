"""Importance sampling: draws from where failures are, and weights that make up for it."""

from typing import Final

import numpy as np
from numpy.typing import NDArray

from scenic.dataclass import dataclass
from scenic.statistics.confidence_intervals import Interval

__all__ = ["LEAST_EFFECTIVE", "Proposal", "effective_size", "weighted_interval"]

LEAST_EFFECTIVE: Final = 50.0
"""Effective number of failures below which there is no estimate."""

_FIRST: Final = 2.0**-53
_NARROWEST: Final = 0.2
"""Least standard deviation of a coordinate, in that of the prior."""

Floats = NDArray[np.float64]


@dataclass(frozen=True, slots=True)
class Proposal:
    """A distribution over the unit cube: independent normal distributions after a map of each axis to a standard normal.

    A share of all points comes from the uniform distribution, so that no weight exceeds ``1 / uniform_share``
    (Hesterberg, "Weighted average importance sampling and defensive mixture distributions", 1995).

    Attributes:
        means: of the coordinates ``(d,)``, after the map.
        deviations: ``(d,)``.
        uniform_share: between 0 and 1.

    """

    means: Floats
    deviations: Floats
    uniform_share: float = 0.1

    @classmethod
    def around(cls, points: Floats) -> "Proposal":
        """The proposal with the means and deviations of some points ``(n, d)`` of the open cube."""
        from scipy.special import ndtri

        places = ndtri(points)
        deviations = places.std(axis=0, ddof=1) if len(places) > 1 else np.ones(places.shape[1])
        return cls(places.mean(axis=0), np.clip(deviations, _NARROWEST, 1.0))

    def draw(self, generator: np.random.Generator, count: int) -> Floats:
        """Points ``(count, d)`` of the open cube."""
        from scipy.special import ndtr

        shape = (count, len(self.means))
        from_prior = generator.random(count) < self.uniform_share
        places = self.means + self.deviations * generator.standard_normal(shape)
        points = np.where(from_prior[:, None], generator.random(shape), ndtr(places))
        return np.asarray(np.clip(points, _FIRST, 1 - _FIRST))

    def weights(self, points: Floats) -> Floats:
        """Return the density of the uniform distribution over that of the proposal ``(n,)``, at points ``(n, d)``."""
        from scipy.special import ndtri

        places = ndtri(points)
        standard = (places - self.means) / self.deviations
        ratios = (0.5 * (places**2 - standard**2) - np.log(self.deviations)).sum(axis=1)
        density = self.uniform_share + (1 - self.uniform_share) * np.exp(np.minimum(ratios, 700.0))
        return np.asarray(1 / density)


def effective_size(weights: Floats) -> float:
    """The number of equal weights that would vary as much: the square of the sum over the sum of squares (Kish 1965)."""
    squares = float(np.square(weights).sum())
    return float(weights.sum()) ** 2 / squares if squares else 0.0


def weighted_interval(weights: Floats, runs: int, confidence: float) -> Interval:
    """Return the interval of a probability that is estimated by ``weights.sum() / runs``.

    Fay and Feuer, "Confidence intervals for directly standardized rates: a method based on the gamma distribution", 1997: exact
    where all weights are alike, conservative where they differ, in all studies so far.

    Args:
        weights: of the runs that failed.
        runs: number of all runs, fixed in advance.
        confidence: between 0 and 1.

    """
    from scipy.stats import gamma

    miss = (1 - confidence) / 2
    total, squares = float(weights.sum()), float(np.square(weights).sum())
    if not squares:
        return Interval(0.0, 1.0)
    low = gamma.ppf(miss, total**2 / squares, scale=squares / total)
    largest = float(weights.max())
    more, spread = total + largest, squares + largest**2
    high = gamma.isf(miss, more**2 / spread, scale=spread / more)
    return Interval(float(low) / runs, min(1.0, float(high) / runs))
