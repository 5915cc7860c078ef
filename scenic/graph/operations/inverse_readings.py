"""Functions that the inverse readings share.

A result was rounded when it was computed, so every inverse starts from result bounds moved outward (`before_rounding`).
"""

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from scenic.graph import intervals
from scenic.graph.bounds import Bounds, Floats, outward

Mask = NDArray[np.bool_]


def before_rounding(result: Bounds, ulps: int = 1) -> Bounds:
    """Bounds of the exact result that, rounded, lies in ``result``."""
    return outward(result.lower, result.upper, ulps)


def collapsed(bounds: Bounds, like: Bounds) -> Bounds:
    """Bounds of a number that stood beside a vector, from bounds of the vector: it must suit every component."""
    if bounds.lower.ndim == like.lower.ndim:
        return bounds
    return Bounds(bounds.lower.max(axis=1), bounds.upper.min(axis=1))


def where(mask: Mask, bounds: Bounds) -> Bounds:
    """Return ``bounds`` in the boxes of ``mask`` and infinite bounds in the others."""
    if bounds.lower.ndim > mask.ndim:
        mask = mask[:, np.newaxis]
    return Bounds(np.where(mask, bounds.lower, -np.inf), np.where(mask, bounds.upper, np.inf))


def certain(result: Bounds) -> tuple[Mask, Mask]:
    """Return the mask of the boxes in which a truth value is certainly true, and that of those in which it is certainly false."""
    return result.lower > 0, result.upper < 1


def truth(true: Mask, false: Mask) -> Bounds:
    """Return the bounds of a truth value from the boxes where it certainly holds and where it certainly does not."""
    return Bounds(true.astype(np.float64), np.logical_not(false).astype(np.float64))


def sides(length: Bounds, parts: Sequence[Bounds]) -> list[Bounds]:
    """Return the bounds of the components of a vector from the bounds of its length.

    The others' squares are taken away from the square of the length; what remains bounds each component, from below only
    where its sign is known.
    """
    # Squares, sums and a root lose a few units in the last place.
    length = intervals.relaxed(length, 1e-14)
    total = intervals.square(Bounds(np.maximum(length.lower, 0.0), np.maximum(length.upper, 0.0)))
    squares = [intervals.square(part) for part in parts]
    result = []
    for place, part in enumerate(parts):
        rest = total
        for other, other_square in enumerate(squares):
            if other != place:
                rest = intervals.subtract(rest, other_square)
        size = intervals.square_root(rest)
        lower: Floats = np.where(part.lower >= 0, size.lower, -size.upper)
        upper: Floats = np.where(part.upper <= 0, -size.lower, size.upper)
        # A square less than nothing: the length cannot be reached, which the empty bounds say.
        impossible = rest.upper < 0
        result.append(Bounds(np.where(impossible, np.inf, lower), np.where(impossible, -np.inf, upper)))
    return result
