"""Intervals of a probability from a number of runs that was fixed in advance, and the ends of an interval in words."""

from typing import NamedTuple

__all__ = ["Interval", "exact_interval"]


class Interval(NamedTuple):
    """Two ends between which a number lies, with the confidence that belongs to them."""

    low: float
    high: float

    @property
    def half_width(self) -> float:
        """Half the distance of the ends."""
        return (self.high - self.low) / 2

    def __str__(self) -> str:
        return f"{self.low:.3g} to {self.high:.3g}"


def exact_interval(
    violations: int, runs: int, confidence: float, *, unknown: int = 0, is_two_sided: bool = False
) -> Interval:
    """The interval of Clopper and Pearson ("The use of confidence or fiducial limits", Biometrika 1934).

    Each end misses the probability with at most half of ``1 - confidence``. Without any violation the lower end is 0, so that the
    upper end may miss it with all of ``1 - confidence``: it is ``1 - (1 - confidence) ** (1 / runs)``. The same holds for the
    lower end where all runs are violations. Such an end is a one-sided bound, and right as one. (Whoever takes the better of both kinds of
    answer misses a probability near ``3 / runs`` somewhat more often, at most half again as often.)

    Args:
        violations: number of runs that failed.
        runs: number of all runs, fixed before the first of them.
        confidence: share of such intervals that contain the probability, between 0 and 1.
        unknown: number of runs without an outcome among ``runs``; the interval allows for either outcome.
        is_two_sided: whether each end misses with half of ``1 - confidence`` also where the other one is 0 or 1.

    """
    from scipy.stats import beta

    miss, most = 1 - confidence, violations + unknown
    low, high = 0.0, 1.0
    if violations > 0:
        share = miss if violations == runs and not is_two_sided else miss / 2
        low = float(beta.ppf(share, violations, runs - violations + 1))
    if most < runs:
        share = miss if most == 0 and not is_two_sided else miss / 2
        high = float(beta.isf(share, most + 1, runs - most))
    return Interval(low, high)
