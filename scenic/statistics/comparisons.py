"""The comparison of two things that were tried on the same cases."""

from typing import Final

from scenic.dataclass import dataclass
from scenic.statistics.confidence_intervals import Interval, exact_interval

__all__ = ["PairedComparison"]

_DIRECTION: Final = 0.8
"""Share of the chance to miss that goes to which of both fails more often; the rest goes to how often they differ."""


@dataclass(frozen=True, slots=True)
class PairedComparison:
    """Cases that two things were both tried on.

    Attributes:
        pairs: number of cases in which both have an outcome.
        first_only: number of cases in which the first failed, and the second did not.
        second_only: number of cases in which the second failed, and the first did not.

    """

    pairs: int
    first_only: int
    second_only: int

    @property
    def p_value(self) -> float:
        """The exact test of McNemar (1947): the chance of a difference as large as this one, if both fail equally often."""
        from scipy.stats import binomtest

        different = self.first_only + self.second_only
        return 1.0 if different == 0 else float(binomtest(self.first_only, different).pvalue)

    @property
    def difference(self) -> float:
        """The probability of the first to fail less that of the second."""
        return (self.first_only - self.second_only) / self.pairs if self.pairs else 0.0

    def interval(self, confidence: float) -> Interval:
        """Return the interval of the difference, without 0 exactly where McNemar's p value is at most 0.8 times ``1 - confidence``.

        The difference is the share of unequal cases, times the share of the first among them less that of the second. Both have exact
        intervals (Clopper and Pearson, 1934), the second given the number of unequal cases, as in McNemar's test; together they miss with at
        most ``1 - confidence`` (Bonferroni).
        """
        if not self.pairs:
            return Interval(-1.0, 1.0)
        miss, different = 1 - confidence, self.first_only + self.second_only
        unequal = exact_interval(different, self.pairs, 1 - (1 - _DIRECTION) * miss)
        if not different:
            return Interval(-unequal.high, unequal.high)
        firsts = exact_interval(self.first_only, different, 1 - _DIRECTION * miss, is_two_sided=True)
        low, high = 2 * firsts.low - 1, 2 * firsts.high - 1
        return Interval(
            low * (unequal.low if low > 0 else unequal.high),
            high * (unequal.high if high > 0 else unequal.low),
        )
