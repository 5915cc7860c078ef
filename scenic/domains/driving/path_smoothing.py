"""Smooth curves near polylines: bounded curvature that changes slowly, within a tube around the line.

A curve minimises the sum of its squared third differences (the change of its curvature) and of its weighted squared distances
from the line: a Whittaker smoother of third order (P. H. C. Eilers, A Perfect Smoother, Analytical Chemistry 75, 2003), whose
weights grow where the curve leaves the tube, and shrink where it is bent more than a car can drive.
"""

import math
from functools import cache, lru_cache
from typing import Any, Final

import numpy as np
from numpy.typing import NDArray

from scenic.domains.driving.tight_bends import nearer_in_bends
from scenic.graph.scipy_parts import compiled_part

__all__ = ["SPACING", "TIGHTEST", "curvatures_of", "headings_of", "resampled", "smoothed"]

Floats = NDArray[np.float64]

SPACING: Final = 0.5
"""Metres between the points of a curve."""
_REACH: Final = 12.0
"""Length in metres over which a straight line is smoothed at most."""
_SHORTEST: Final = 0.9
"""Length in metres over which the tightest bend is smoothed at least."""
_TUBES: Final = (0.03, 0.12)
"""Metres that the curve may leave a straight line, and a bend."""
_STRAIGHT: Final = 1 / 400
"""Curvature (1/m) of a line below which it counts as straight."""
TIGHTEST: Final = 0.195
"""Curvature (1/m) that a curve of a car may have: a little less than the sharpest one that it drives."""
_DIGITS: Final = 9
"""Digits of metres that are kept."""
_PINNED: Final = 1e12
"""Weight of points through which a curve must go."""
_ROUNDS: Final = 12
"""Times that weights are corrected."""
_SCALE: Final = (_REACH / SPACING) ** 6
"""Weight of squared third differences."""


def resampled(points: Floats, spacing: float = SPACING) -> Floats:
    """Points ``(m, 2)`` on a polyline ``(n, 2)`` at equal distances of about ``spacing`` metres, without steps backwards."""
    points = _without_folds(points)
    lengths = np.concatenate([[0.0], np.cumsum(np.hypot(*np.diff(points, axis=0).T))])
    count = max(2, round(lengths[-1] / spacing) + 1)
    along = np.linspace(0.0, lengths[-1], count)
    return np.column_stack([np.interp(along, lengths, points[:, 0]), np.interp(along, lengths, points[:, 1])])


def _without_folds(points: Floats) -> Floats:
    """The polyline without points nearer than 5 cm to the one before, and without points at which it turns by over 100 degrees.

    Connecting lanes of some maps run past their end and come back.
    """
    vertices: list[tuple[float, float]] = []
    for x, y in points.tolist():
        while len(vertices) > 1 and _turns_back(*vertices[-2], *vertices[-1], x, y):
            vertices.pop()
        if not vertices or math.hypot(x - vertices[-1][0], y - vertices[-1][1]) >= 0.05:
            vertices.append((x, y))
    return np.array(vertices) if len(vertices) > 1 else points[[0, -1]]


def _turns_back(x0: float, y0: float, x1: float, y1: float, x2: float, y2: float) -> bool:
    """Return whether the way through three points turns by more than 100 degrees at the second one."""
    a, b, c, d = x1 - x0, y1 - y0, x2 - x1, y2 - y1
    return a * c + b * d < -0.17 * math.hypot(a, b) * math.hypot(c, d)


def headings_of(points: Floats) -> Floats:
    """Headings ``(n - 1,)`` of the steps between points ``(n, 2)``: radians, anticlockwise from north, without jumps."""
    steps = np.diff(points, axis=0)
    headings: Floats = np.arctan2(-steps[:, 0], steps[:, 1])
    if (np.abs(headings[1:] - headings[:-1]) < math.pi).all():
        return headings
    return np.unwrap(headings)


def curvatures_of(points: Floats) -> Floats:
    """Curvatures ``(n,)`` (1/m, positive to the left) at points ``(n, 2)``; those of the ends are the ones beside them."""
    if len(points) < 3:
        return np.zeros(len(points))
    steps = np.hypot(*np.diff(points, axis=0).T)
    inner = np.diff(headings_of(points)) / np.maximum((steps[:-1] + steps[1:]) / 2, 1e-6)
    return np.concatenate([inner[:1], inner, inner[-1:]])


def smoothed(
    points: Floats,
    first: Floats | None = None,
    last: Floats | None = None,
    tightest: float = TIGHTEST,
) -> Floats:
    """A smooth curve ``(n, 2)`` near points ``(n, 2)`` at equal distances of about half a metre.

    Args:
        points: on a polyline, see `resampled`.
        first: points ``(k, 2)`` through which the curve begins, in place of the first ones.
        last: points ``(k, 2)`` through which it ends.
        tightest: curvature (1/m) that the curve may have.

    """
    count = len(points)
    if count < 8:
        return points
    bends = _bends(points)
    tubes = np.where(bends < _STRAIGHT, *_TUBES)
    reach = np.clip(np.sqrt(24 * tubes / np.maximum(bends, 1e-4)) / 4, _SHORTEST, _REACH)
    weights = (_REACH / reach) ** 6
    tube_shares = np.ones(count)
    goal = points.copy()
    pin_weights = np.zeros(count)
    if first is not None:
        goal[: len(first)], pin_weights[: len(first)] = first, _PINNED
    if last is not None:
        goal[-len(last) :], pin_weights[-len(last) :] = last, _PINNED
    curve = goal
    for _ in range(_ROUNDS):
        curve = _solved(goal, np.maximum(weights * tube_shares, pin_weights))
        away = np.hypot(*(curve - goal).T)
        sharp = np.abs(curvatures_of(curve)) > tightest
        if sharp.any():
            near = np.convolve(sharp, np.ones(13), "same")[:count] > 0
            tube_shares[near] /= 4
        wide = (away > tubes) & (tube_shares == 1)
        if not wide.any() and not sharp.any():
            break
        weights[wide] *= np.minimum(away[wide] / tubes[wide], 4) ** 3
    bent = (tube_shares < 1) & (pin_weights == 0)
    return nearer_in_bends(curve, points, bent, tightest) if bent.any() else curve


def _bends(points: Floats) -> Floats:
    """Return the curvatures ``(n,)`` of a polyline without sign, averaged over three metres on either side, the largest within two metres."""
    headings = headings_of(points)
    half = 6
    padded_headings = np.pad(headings, half, mode="edge")
    change = np.abs(padded_headings[2 * half :] - padded_headings[: -2 * half]) / (2 * half * SPACING)
    change = np.concatenate([change, change[-1:]])
    around = np.stack([np.roll(change, shift) for shift in range(-4, 5)])
    around[:4, -4:] = change[-4:]
    around[5:, :4] = change[:4]
    bends: Floats = around.max(axis=0)
    return bends


def _solved(points: Floats, weights: Floats) -> Floats:
    """The minimiser of the weighted squares of distances from points and of third differences.

    The system is so ill-conditioned that processors disagree about micrometres, with which a car may brake a step later. So
    corrections of the points are solved for, the second time of what rounding has left, and their digits are cut.
    """
    factor, solve = _banded_solver()
    bands = _third_differences(len(points)).copy()
    bands[0] += weights
    factors, failure = factor(bands, lower=1, overwrite_ab=1)
    if failure:
        raise np.linalg.LinAlgError(f"no smooth curve: the system is singular at point {failure}")
    curve = points
    column_weights = weights[:, np.newaxis]
    third = np.zeros((len(points) + 3, 2))
    for _ in range(2):
        third[3:-3] = np.diff(curve, 3, axis=0)
        slope = column_weights * (points - curve) + _SCALE * np.diff(third, 3, axis=0)
        curve = curve + solve(factors, slope, lower=1)[0]
    solution: Floats = np.round(curve, _DIGITS)
    return solution


@cache
def _banded_solver() -> tuple[Any, Any]:
    """Return LAPACK's Cholesky factorization of banded matrices, and the solution of systems by it."""
    lapack = compiled_part("scipy.linalg", "_flapack", ["dpbtrf", "dpbtrs"], "scipy.linalg.lapack")
    return lapack.dpbtrf, lapack.dpbtrs


@lru_cache(maxsize=64)
def _third_differences(count: int) -> Floats:
    """The lower bands ``(4, n)`` of the matrix of the sum of squared third differences of n values; not to be changed."""
    bands = np.zeros((4, count), order="F")
    for offset in range(4):
        coefficients = (1.0, -3.0, 3.0, -1.0)
        for place in range(4 - offset):
            product = coefficients[place] * coefficients[place + offset] * _SCALE
            bands[offset, place : count - 3 + place] += product
    return bands
