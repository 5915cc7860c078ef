"""The sequential test of a bound of a probability (Wald, "Sequential tests of statistical hypotheses", 1945)."""

import math
from functools import lru_cache
from typing import Final

import numpy as np

from scenic.dataclass import dataclass

__all__ = ["BoundTest"]

_SMALL: Final = 0.01
"""Bound below which the thresholds are those of this bound, with the same ratio of probabilities."""

_RARE_MARGIN: Final = 0.001
"""Distance by which such a threshold is moved to the safe side; the thresholds differ by less than 0.0002."""

_STEPS: Final = 100_000
"""Runs beyond which a path is not followed, and mean number of runs from which the overshoot is neglected, times 20."""

_REST: Final = 1e-7
"""Chance of the paths that are not followed."""


@dataclass(frozen=True, slots=True)
class BoundTest:
    """A test of ``p <= good`` against ``p >= bound``, after each run, with as few runs as any test needs on average.

    Attributes:
        bound: the probability that is not to be reached. Where it is, the answer "at most" comes with probability
            ``1 - confidence`` or less.
        good: a lower probability. Where p is no greater, the answer "at most" comes with probability ``power`` or more.
        confidence: between 0 and 1.
        power: between 0 and 1.

    Between ``good`` and ``bound`` either answer may come. With the thresholds ``1 / (1 - confidence)`` and ``1 - power`` both errors
    are as promised exactly, and not only nearly, as with Wald's own. A violation takes the evidence far beyond the lower one, so that the
    test errs less than it may, and takes longer. So the lower threshold is moved towards 0 by this overshoot (Siegmund, "Sequential
    analysis", 1985), as far as the exact chances of both errors allow.

    """

    bound: float
    good: float
    confidence: float
    power: float

    def evidence(self, violations: int, runs: int) -> float:
        """Return the logarithm of the ratio of the likelihoods of ``good`` and ``bound``."""
        failing, holding = self._increments
        return violations * failing + (runs - violations) * holding

    def is_at_most(self, violations: int, runs: int) -> bool | None:
        """The answer after some runs: at most the bound, more, or ``None`` while more runs are needed."""
        evidence = self.evidence(violations, runs)
        if evidence >= -math.log1p(-self.confidence):
            return True
        lower = _lower_threshold(self.bound, self.good, self.confidence, self.power)
        return False if evidence <= lower else None

    def expected_runs(self, probability: float) -> float:
        """Wald's approximation of the mean number of runs, which neglects by how much the evidence passes a threshold."""
        failing, holding = self._increments
        upper, lower = -math.log1p(-self.confidence), math.log1p(-self.power)
        drift = probability * failing + (1 - probability) * holding
        passing = self._chance(probability, upper, lower)
        if passing is None:
            return -upper * lower / (probability * failing**2 + (1 - probability) * holding**2)
        return (passing * upper + (1 - passing) * lower) / drift

    def _chance(self, probability: float, upper: float, lower: float) -> float | None:
        """The approximate chance of the answer "at most"; ``None`` where the evidence goes nowhere on average."""
        from scipy.optimize import brentq

        failing, holding = self._increments
        drift = probability * failing + (1 - probability) * holding
        if abs(drift) < 1e-12 * abs(failing):
            return None

        def mean(power: float) -> float:
            return probability * math.exp(power * failing) + (1 - probability) * math.exp(power * holding) - 1

        # The mean of exp(power * increment) is 1 at 0 and at one more place, on the other side of its minimum.
        far = -1.0 if drift > 0 else 1.0
        while mean(far) <= 0:
            far *= 2
        root = float(brentq(mean, far * 1e-9, far)) if mean(far * 1e-9) < 0 else far * 1e-9
        return (1 - math.exp(root * lower)) / (math.exp(root * upper) - math.exp(root * lower))

    @property
    def _increments(self) -> tuple[float, float]:
        """The evidence that a run adds which fails, and one that holds."""
        return math.log(self.good / self.bound), math.log1p(-self.good) - math.log1p(-self.bound)


@lru_cache(maxsize=64)
def _lower_threshold(bound: float, good: float, confidence: float, power: float) -> float:
    """Return the evidence at which the answer is "more": the highest one tried at which both errors are as promised."""
    upper, error_rate = -math.log1p(-confidence), 1 - power
    best = lower = math.log(error_rate)
    scale = max(1.0, _SMALL / bound)
    test = BoundTest(scale * bound, scale * good, confidence, power)
    if not lower < 0 < upper or 20 * test.expected_runs(test.good) > _STEPS:
        return best
    for _ in range(4):
        chance = _chance_of_more(test, test.good, lower, upper)
        if chance <= error_rate and 1 - _chance_of_more(test, test.bound, lower, upper) <= 1 - confidence:
            best = max(best, lower)
        # The chance is nearly proportional to the likelihood ratio of the threshold.
        lower = min(lower + math.log(error_rate / chance), lower / 2)
    return best - (_RARE_MARGIN if scale > 1 and best > math.log(error_rate) else 0)


def _chance_of_more(test: BoundTest, probability: float, lower: float, upper: float) -> float:
    """The chance of the answer "more" with these thresholds, exactly but for `_REST`, over the numbers of violations after each run."""
    failing, holding = test.evidence(1, 1), test.evidence(0, 1)
    span = holding - failing
    chances, first, chance, left = np.ones(1), 0, 0.0, 1.0
    for runs in range(1, _STEPS + 1):
        distribution = np.empty(len(chances) + 1)
        distribution[0], distribution[1:] = 0.0, chances
        distribution *= probability
        distribution[:-1] += (1 - probability) * chances
        # With `first` violations or more, up to `last`, neither threshold is reached.
        last = math.ceil((runs * holding - lower) / span) - 1 - first
        if last < len(distribution) - 1:
            over = float(distribution[max(0, last + 1) :].sum())
            chance, left = chance + over, left - over
            distribution = distribution[: max(0, last + 1)]
        least = math.floor((runs * holding - upper) / span) + 1 - first
        if least > 0:
            left -= float(distribution[:least].sum())
            distribution, first = distribution[least:], first + least
        chances = distribution
        if left < _REST or not len(chances):
            break
    return chance
