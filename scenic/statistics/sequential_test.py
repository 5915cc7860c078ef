"""The sequential test of a bound of a probability (Wald, "Sequential tests of statistical hypotheses", 1945)."""

import math

from scenic.dataclass import dataclass

__all__ = ["BoundTest"]


@dataclass(frozen=True, slots=True)
class BoundTest:
    """A test of ``p <= good`` against ``p >= bound``, after each run, with as few runs as any test needs on average.

    Attributes:
        bound: the probability that is not to be reached. Where it is, the answer "at most" comes with probability
            ``1 - confidence`` or less.
        good: a lower probability. Where p is no greater, the answer "at most" comes with probability ``power`` or more.
        confidence: between 0 and 1.
        power: between 0 and 1.

    Between ``good`` and ``bound`` either answer may come. The thresholds are ``1 / (1 - confidence)`` and ``1 - power``: both
    errors are as promised exactly, and not only nearly, as with Wald's own.

    """

    bound: float
    good: float
    confidence: float
    power: float

    def evidence(self, violations: int, runs: int) -> float:
        """The logarithm of the ratio of the likelihoods of ``good`` and ``bound``."""
        failing, holding = self._increments
        return violations * failing + (runs - violations) * holding

    def is_at_most(self, violations: int, runs: int) -> bool | None:
        """The answer after some runs: at most the bound, more, or ``None`` while more runs are needed."""
        evidence = self.evidence(violations, runs)
        if evidence >= -math.log1p(-self.confidence):
            return True
        return False if evidence <= math.log1p(-self.power) else None

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
