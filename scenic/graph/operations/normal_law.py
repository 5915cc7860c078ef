"""The standard normal law conditioned to an interval, accurate in both tails."""

from typing import Final

import numpy as np

from scenic.graph.bounds import Floats
from scenic.graph.operations.normal_functions import log_ndtr, ndtr, ndtri, ndtri_exp

_DEEP: Final = 30.0
"""Standard deviations from the mean beyond which probabilities are handled by their logarithms."""

_FAR: Final = 1e4
"""Standard deviations beyond which the tail is an exponential to all digits that matter."""


def conditioned_quantile(a: Floats, b: Floats, u: Floats) -> Floats:
    """Return the quantile ``u`` of the standard normal law conditioned to ``[a, b]``; elementwise, with broadcasting.

    Near the mean through the distribution function, deep in a tail through its logarithm, and far out, where that
    cancels too, through the exponential that the tail then is.
    """
    # An interval in the upper half is reflected down, where probabilities keep their relative accuracy.
    flip = a > 0
    low, high, p = np.broadcast_arrays(np.where(flip, -b, a), np.where(flip, -a, b), np.where(flip, 1 - u, u))
    p = np.ascontiguousarray(p)
    below, above = ndtr(low), ndtr(high)
    z = np.asarray(ndtri(below + p * (above - below)))
    deep = high < -_DEEP
    if deep.any():
        logarithm = np.logaddexp(log_ndtr(low) + np.log1p(-p), log_ndtr(high) + np.log(p))
        z = np.where(deep, ndtri_exp(np.minimum(logarithm, 0.0)), z)
        far = high < -_FAR
        if far.any():
            rate = np.where(far, -high, 1.0)
            z = np.where(
                far, high + np.log(p + (1 - p) * np.exp(rate * np.minimum(low - high, 0.0))) / rate, z
            )
    z = np.clip(z, low, high)
    return np.asarray(np.where(flip, -z, z))


def conditioned_cumulative(a: Floats, b: Floats, z: Floats) -> tuple[Floats, Floats]:
    """Return the probability below ``z`` under the standard normal law conditioned to ``[a, b]``, and a bound on its error.

    ``z`` lies in ``[a, b]``. Ratios of probabilities are taken through logarithms; the error grows where those are large
    or the interval is narrow.
    """
    flip = a > 0
    low, high, place = np.broadcast_arrays(
        np.where(flip, -b, a), np.where(flip, -a, b), np.where(flip, -z, z)
    )
    at_low, at_high, at_place = log_ndtr(low), log_ndtr(high), log_ndtr(place)
    # log_ndtr is minus infinity only at minus infinity, where differences of two such are no number.
    above_low = np.where(place > low, -np.expm1(at_low - at_place), 0.0)
    whole = -np.expm1(at_low - at_high)
    share = np.clip(np.exp(at_place - at_high) * above_low / whole, 0.0, 1.0)
    error = (1e-11 + 1e-14 * np.abs(at_high)) / whole
    error = np.where(np.isfinite(error), error, 1.0)
    share = np.where(np.isnan(share), 0.5, share)
    return np.where(flip, 1 - share, share), error
