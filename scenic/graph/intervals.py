"""Interval arithmetic on `Bounds`: every function holds each value that its operands may give, rounded outward.

Two conventions keep conclusions safe. Functions expect operands that are not empty and give results that are not empty
(an impossible division, say, gives unbounded bounds: whether a value is needed at all is the caller's question).
And **bounds whose ends are all finite exclude NaN**: a float operation gives NaN only from infinities, so a function
whose operand has an infinite end gives a result with an infinite end (see `doubtful`).
"""

from collections.abc import Sequence
from typing import Final

import numpy as np

from scenic.graph.bounds import Bounds, Floats, outward

EPSILON: Final = 2.0**-52
"""Relative spacing of doubles."""


def spread(bounds: Bounds, dimensions: int) -> Bounds:
    """A number's bounds made to broadcast against those of vectors."""
    if bounds.lower.ndim >= dimensions:
        return bounds
    return Bounds(bounds.lower[:, np.newaxis], bounds.upper[:, np.newaxis])


def _aligned(*operands: Bounds) -> list[Bounds]:
    dimensions = max([operand.lower.ndim for operand in operands])
    return [spread(operand, dimensions) for operand in operands]


def _are_finite(lower: Floats, upper: Floats) -> bool:
    """Return whether no end is infinite or NaN; may say no where ends are huge."""
    return bool(np.isfinite(upper - lower).all())


def unbounded(like: Bounds) -> Bounds:
    """Return bounds from minus to plus infinity, of the shape of ``like``."""
    return Bounds(np.full(like.lower.shape, -np.inf), np.full(like.lower.shape, np.inf))


def infinite(bounds: Bounds) -> np.ndarray[tuple[int, ...], np.dtype[np.bool_]]:
    """Return a mask of the boxes in which a value may be infinite or NaN."""
    return ~(np.isfinite(bounds.lower) & np.isfinite(bounds.upper))


def doubtful(result: Bounds, *operands: Bounds) -> Bounds:
    """``result``, without ends where an operand may be infinite or NaN but the result does not show it."""
    doubt = np.zeros((1,) * result.lower.ndim, dtype=np.bool_)
    for operand in _aligned(result, *operands)[1:]:
        doubt = doubt | infinite(operand)
    if not doubt.any():
        return result
    doubt = doubt & ~infinite(result)
    return Bounds(np.where(doubt, -np.inf, result.lower), np.where(doubt, np.inf, result.upper))


def _safe(lower: Floats, upper: Floats) -> Bounds:
    """Bounds from ends that may be NaN (infinity less infinity), which say nothing."""
    return Bounds(np.where(np.isnan(lower), -np.inf, lower), np.where(np.isnan(upper), np.inf, upper))


def negative(a: Bounds) -> Bounds:
    """Return the exact bounds of ``-a``."""
    return Bounds(-a.upper, -a.lower)


def add(a: Bounds, b: Bounds) -> Bounds:
    """Return bounds of ``a + b``."""
    a, b = _aligned(a, b)
    lower, upper = a.lower + b.lower, a.upper + b.upper
    if not _are_finite(lower, upper):
        safe = _safe(lower, upper)
        lower, upper = safe.lower, safe.upper
    return outward(lower, upper)


def subtract(a: Bounds, b: Bounds) -> Bounds:
    """Return bounds of ``a - b``."""
    return add(a, negative(b))


def multiply(a: Bounds, b: Bounds) -> Bounds:
    """Return bounds of ``a * b``."""
    a, b = _aligned(a, b)
    products = (a.lower * b.lower, a.lower * b.upper, a.upper * b.lower, a.upper * b.upper)
    lower, upper = _extremes(products)
    if _are_finite(lower, upper):  # and so are the operands
        return outward(lower, upper)
    lower, upper = _extremes([np.where(np.isnan(product), 0.0, product) for product in products])
    return doubtful(outward(lower, upper), a, b)


def divide(a: Bounds, b: Bounds) -> Bounds:
    """Return bounds of ``a / b``; they are infinite where ``b`` may be zero."""
    a, b = _aligned(a, b)
    quotients = (a.lower / b.lower, a.lower / b.upper, a.upper / b.lower, a.upper / b.upper)
    lower, upper = _extremes([np.where(np.isnan(quotient), 0.0, quotient) for quotient in quotients])
    zero = (b.lower <= 0) & (b.upper >= 0)
    result = outward(lower, upper)
    return doubtful(Bounds(np.where(zero, -np.inf, result.lower), np.where(zero, np.inf, result.upper)), a, b)


def _extremes(values: Sequence[Floats]) -> tuple[Floats, Floats]:
    lower = upper = values[0]
    for value in values[1:]:
        lower = np.minimum(lower, value)
        upper = np.maximum(upper, value)
    return lower, upper


def absolute(a: Bounds) -> Bounds:
    """Return the exact bounds of ``abs(a)``."""
    lower = np.maximum(np.maximum(a.lower, -a.upper), 0.0)
    return Bounds(lower, np.maximum(-a.lower, a.upper))


def square(a: Bounds) -> Bounds:
    """Return bounds of ``a * a``, both factors being the same value: they are never negative."""
    size = absolute(a)
    result = outward(size.lower * size.lower, size.upper * size.upper)
    return Bounds(np.maximum(result.lower, 0.0), result.upper)


def square_root(a: Bounds) -> Bounds:
    """Return bounds of ``sqrt(a)``; the negative part of ``a`` is cut off."""
    result = outward(np.sqrt(np.maximum(a.lower, 0.0)), np.sqrt(np.maximum(a.upper, 0.0)))
    return Bounds(np.maximum(result.lower, 0.0), result.upper)


def minimum(a: Bounds, b: Bounds) -> Bounds:
    """Return the exact bounds of ``min(a, b)``."""
    return doubtful(Bounds(np.minimum(a.lower, b.lower), np.minimum(a.upper, b.upper)), a, b)


def maximum(a: Bounds, b: Bounds) -> Bounds:
    """Return the exact bounds of ``max(a, b)``."""
    return doubtful(Bounds(np.maximum(a.lower, b.lower), np.maximum(a.upper, b.upper)), a, b)


def floor_divide(a: Bounds, b: Bounds) -> Bounds:
    """Return bounds of ``a // b``.

    They are exact while quotients are small enough to be whole floats, and infinite where ``b`` may be zero.
    """
    corners = [np.floor_divide(p, q) for p in (a.lower, a.upper) for q in (b.lower, b.upper)]
    lower, upper = _extremes([np.where(np.isnan(corner), 0.0, corner) for corner in corners])
    large = np.maximum(np.abs(lower), np.abs(upper)) >= 2.0**52
    wide = outward(lower, upper)
    zero = (b.lower <= 0) & (b.upper >= 0)
    lower = np.where(zero, -np.inf, np.where(large, wide.lower, lower))
    upper = np.where(zero, np.inf, np.where(large, wide.upper, upper))
    return doubtful(Bounds(lower, upper), a, b)


def modulo(a: Bounds, b: Bounds) -> Bounds:
    """Return bounds of ``a % b`` as Python defines it: the result has the sign of ``b`` and is smaller."""
    lower = np.where(b.lower >= 0, 0.0, np.minimum(b.lower, 0.0))
    upper = np.where(b.upper <= 0, 0.0, np.maximum(b.upper, 0.0))
    # A dividend between zero and the divisor is its own remainder, and a remainder of equal signs is no larger.
    positive = (a.lower >= 0) & (b.lower > 0)
    upper = np.where(positive, np.minimum(upper, a.upper), upper)
    same = positive & (a.upper < b.lower)
    lower = np.where(same, a.lower, lower)
    # Within one period of a fixed divisor the remainder grows with the dividend.
    divisor = np.where((b.lower == b.upper) & (b.lower > 0), b.lower, np.nan)
    first, last = (np.floor_divide(end, divisor) for end in (a.lower, a.upper))
    rest = outward(np.remainder(a.lower, divisor), np.remainder(a.upper, divisor))
    grows = (first == last) & (np.abs(first) < 2.0**52)
    lower = np.where(grows, np.maximum(lower, rest.lower), lower)
    upper = np.where(grows, np.minimum(upper, rest.upper), upper)
    return doubtful(Bounds(lower, upper), a, b)


def power(a: Bounds, b: Bounds) -> Bounds:
    """Return bounds of ``a ** b`` for a fixed whole exponent, or a base that is not negative; other bounds are infinite."""
    corners = [np.power(base, exponent) for base in (a.lower, a.upper) for exponent in (b.lower, b.upper)]
    lower, upper = _extremes([np.where(np.isnan(corner), np.inf, corner) for corner in corners])
    whole = (b.lower == b.upper) & (b.lower == np.floor(b.lower))
    straddles = (a.lower <= 0) & (a.upper >= 0)
    even = whole & (np.mod(b.lower, 2) == 0)
    lower = np.where(even & straddles & (b.lower > 0), np.minimum(lower, 0.0), lower)
    # The C library's power is accurate to about one unit in the last place.
    result = outward(lower - 4 * EPSILON * np.abs(lower), upper + 4 * EPSILON * np.abs(upper))
    is_bounded = np.where(
        whole, ~(straddles & (b.lower < 0)), (a.lower > 0) | ((a.lower >= 0) & (b.lower > 0))
    )
    return doubtful(
        Bounds(np.where(is_bounded, result.lower, -np.inf), np.where(is_bounded, result.upper, np.inf)), a, b
    )


def total(terms: Sequence[Bounds]) -> Bounds:
    """The sum of several bounds, added from the left."""
    result = terms[0]
    for term in terms[1:]:
        result = add(result, term)
    return result


def component(a: Bounds, index: int) -> Bounds:
    """Return one component of a vector's bounds."""
    return Bounds(a.lower[:, index], a.upper[:, index])


def components(a: Bounds) -> list[Bounds]:
    """Return all components of a vector's or quaternion's bounds."""
    return [component(a, index) for index in range(a.lower.shape[1])]


def stacked(parts: Sequence[Bounds]) -> Bounds:
    """Return the bounds of a vector from those of its components; this is the opposite of `components`."""
    lowers = np.broadcast_arrays(*(part.lower for part in parts))
    uppers = np.broadcast_arrays(*(part.upper for part in parts))
    return Bounds(np.stack(lowers, axis=1), np.stack(uppers, axis=1))


def widened(a: Bounds, margin: Floats | float) -> Bounds:
    """Return bounds moved outward by an absolute margin."""
    return outward(a.lower - margin, a.upper + margin)


def relaxed(a: Bounds, relative: float) -> Bounds:
    """Bounds moved outward by a share of the size of each end, and one unit in the last place."""
    return outward(a.lower - relative * np.abs(a.lower), a.upper + relative * np.abs(a.upper))


def size(a: Bounds) -> Floats:
    """Return the largest absolute value in the bounds."""
    return np.maximum(np.abs(a.lower), np.abs(a.upper))
