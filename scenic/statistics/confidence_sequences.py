"""Intervals of a probability that hold at all times: one may look after each run, stop, and go on.

For runs that fail with probability p, the ratio of a mixture of likelihoods to that of p is a martingale with mean 1. It exceeds
``1 / miss`` at any time with probability ``miss`` at most (Ville 1939), so that the values of p that it has not yet excluded are
a confidence sequence (Robbins, "Statistical methods related to the law of the iterated logarithm", 1970; it is the wealth of a
gambler who bets against p in Waudby-Smith and Ramdas, "Estimating means of bounded random variables by betting", 2024). The mixture
is the distribution of Jeffreys, Beta(1/2, 1/2).
"""

import math
from typing import Final

from scenic.statistics.confidence_intervals import Interval

__all__ = ["is_checked", "log_wealth", "sequence_interval"]

_PRIOR: Final = 0.5
_FINE: Final = 6
"""Binary digits of the number of runs at which an interval is computed: 64 times while the number doubles."""


def log_wealth(violations: int, runs: int, probability: float) -> float:
    """Return the logarithm of what a bet against ``probability`` has become; it starts at 0."""
    held = runs - violations
    mixture = _log_beta(violations + _PRIOR, held + _PRIOR) - _log_beta(_PRIOR, _PRIOR)
    if (violations and probability <= 0) or (held and probability >= 1):
        return math.inf
    likelihood = violations * math.log(probability) if violations else 0.0
    return mixture - likelihood - (held * math.log1p(-probability) if held else 0.0)


def sequence_interval(violations: int, runs: int, confidence: float, *, unknown: int = 0) -> Interval:
    """The interval after some runs, one of a sequence of which all contain the probability with the given confidence.

    Args:
        violations: number of runs that failed.
        runs: number of all runs so far; whether there will be more may depend on their outcomes.
        confidence: chance that no interval of the sequence misses the probability, between 0 and 1.
        unknown: number of runs without an outcome among ``runs``; the interval allows for either outcome.

    """
    if runs == 0:
        return Interval(0.0, 1.0)
    most = violations + unknown
    low = 0.0 if violations == 0 else _end(violations, runs, confidence, upper=False)
    high = 1.0 if most == runs else _end(most, runs, confidence, upper=True)
    return Interval(low, high)


def is_checked(runs: int) -> bool:
    """Return whether to look after this number of runs: after each of the first 64, then ever more seldom."""
    return runs % (1 << max(0, runs.bit_length() - 1 - _FINE)) == 0


def _end(violations: int, runs: int, confidence: float, *, upper: bool) -> float:
    from scipy.optimize import brentq

    limit = -math.log1p(-confidence)

    def excess(probability: float) -> float:
        return min(log_wealth(violations, runs, probability), 1e300) - limit

    share = violations / runs
    # The logarithm of the wealth is convex, is least at the share of violations, and negative there.
    return float(brentq(excess, share, 1.0, xtol=1e-15) if upper else brentq(excess, 0.0, share, xtol=1e-15))


def _log_beta(first: float, second: float) -> float:
    return math.lgamma(first) + math.lgamma(second) - math.lgamma(first + second)
