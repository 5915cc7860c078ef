"""The comparison of two things that were tried on the same cases."""

from scenic.dataclass import dataclass
from scenic.statistics.intervals import Interval, exact_interval

__all__ = ["PairedComparison"]


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
        """The interval of the difference: from exact intervals of both kinds of unequal cases (Bonferroni)."""
        if not self.pairs:
            return Interval(-1.0, 1.0)
        each = 1 - (1 - confidence) / 2
        first = exact_interval(self.first_only, self.pairs, each)
        second = exact_interval(self.second_only, self.pairs, each)
        return Interval(first.low - second.high, first.high - second.low)
