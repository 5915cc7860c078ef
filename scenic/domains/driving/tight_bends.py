"""Curves through bends that are sharper than a car drives: as near to the middle of the lane as that allows.

A car of which the turning circle is wider than a bend must swing out before and after it, or cut it. The offsets of a curve along
its normals that make the largest distance from the line smallest, with bounds on curvature and its change, are the solution of a
linear program, as curvature is about linear in small offsets (as in path planning by quadratic programs: W. Lim et al.,
Hierarchical Trajectory Planning of an Autonomous Car, 2018). It is solved again about each solution.
"""

import hashlib
import sys
from collections.abc import Sequence
from functools import cache, partial
from pathlib import Path
from typing import Final

import numpy as np
from numpy.typing import NDArray

from scenic.runtime.geometry.store import Arrays, digest_of, kept
from scenic.runtime.ground.library_versions import library_version

__all__ = ["nearer_in_bends"]

Floats = NDArray[np.float64]

_KIND: Final = "curve through a tight bend"
_ROUNDS: Final = 4
_ROOM: Final = 2.7
"""Points before and after a bend that may move, too, for each metre of the radius that a car drives."""
_HELD: Final = 3
"""Points at either end that stay: they keep position, heading and curvature."""
_CHANGE: Final = 0.1
"""Change of curvature (1/m in a metre) that a car follows at the speed of such bends."""
_EVENNESS: Final = 10.0
"""Weight of the changes of curvature (1/m), beside metres from the line: without it curves waver for nothing."""
_FARTHEST: Final = 0.1
"""Metres from the line up to which nothing is to be gained."""
_STEP: Final = 0.6
"""Metres that points move in a round at most: farther off, curvature is not linear."""


def nearer_in_bends(curve: Floats, line: Floats, bent: NDArray[np.bool_], sharpest: float) -> Floats:
    """Return a curve ``(n, 2)`` that is nearer to a line than another one in bends, and bends no more than a car drives.

    Args:
        curve: at equal distances, ``(n, 2)``.
        line: through points ``(n, 2)``, each beside that of the curve.
        bent: which points ``(n,)`` are in bends that are too sharp.
        sharpest: curvature (1/m) that the curve may have.

    """
    edges = np.flatnonzero(
        np.diff(np.concatenate([[0], _widened(bent, round(_ROOM / sharpest)).astype(int), [0]]))
    )
    result = curve.copy()
    for begin, end in zip(edges[::2].tolist(), edges[1::2].tolist(), strict=True):
        if end - begin > 3 * _HELD:
            part, around = result[begin:end], line[max(0, begin - 20) : end + 20]
            # A program takes less time to read a curve than to import SciPy's solver.
            content = digest_of(part, around, np.array(sharpest)) + _makers()
            curves = kept(_KIND, content, partial(_curves, part, around, sharpest))
            result[begin:end] = curves["curve"]
    return result


def _curves(part: Floats, line: Floats, sharpest: float) -> Arrays:
    return {"curve": _bend(part, line, sharpest)}


@cache
def _makers() -> bytes:
    """The digest of the code and the versions that decide a curve."""
    versions = f"{sys.version} {sys.platform} {np.__version__} {library_version('scipy')}"
    return hashlib.sha256(versions.encode() + Path(__file__).read_bytes()).digest()


def _widened(bent: NDArray[np.bool_], room: int) -> NDArray[np.bool_]:
    """Return which points are within a number of points of others."""
    wide: NDArray[np.bool_] = np.convolve(bent, np.ones(2 * room + 1), "same")[: len(bent)] > 0
    return wide


def _bend(part: Floats, line: Floats, sharpest: float) -> Floats:
    best = part
    least = np.abs(_away(part, _normals(part), line)).max()
    for _ in range(_ROUNDS):
        normals = _normals(part)
        away = _away(part, normals, line)
        if np.abs(away).max() < _FARTHEST:
            break
        offsets = _offsets(part, away, sharpest)
        if offsets is None:
            break
        part = part + offsets[:, None] * normals
        farthest = np.abs(_away(part, _normals(part), line)).max()
        if farthest < least - 0.01 and np.abs(_curvatures(part)).max() < 1.04 * sharpest:
            best, least = part, farthest
    return best


def _normals(points: Floats) -> Floats:
    """Return unit vectors ``(n, 2)`` to the left of a curve."""
    along = np.gradient(points, axis=0)
    along /= np.hypot(*along.T)[:, None]
    return np.column_stack([-along[:, 1], along[:, 0]])


def _curvatures(points: Floats) -> Floats:
    """Curvatures ``(n - 2,)`` at the inner points."""
    steps = np.diff(points, axis=0)
    headings = np.unwrap(np.arctan2(steps[:, 1], steps[:, 0]))
    lengths = np.hypot(*steps.T)
    curvatures: Floats = np.diff(headings) / ((lengths[1:] + lengths[:-1]) / 2)
    return curvatures


def _away(points: Floats, normals: Floats, line: Floats) -> Floats:
    """Metres ``(n,)`` from points to a line, positive to the left."""
    a, b = line[:-1], line[1:]
    along = b - a
    share = ((points[:, None] - a) * along).sum(axis=2) / np.maximum((along * along).sum(axis=1), 1e-12)
    feet = a + np.clip(share, 0.0, 1.0)[..., None] * along
    delta = feet - points[:, None]
    nearest = (delta * delta).sum(axis=2).argmin(axis=1)
    nearest_deltas = delta[np.arange(len(points)), nearest]
    signs = np.sign((nearest_deltas * normals).sum(axis=1))
    away: Floats = signs * np.hypot(*nearest_deltas.T)
    return away


def _offsets(points: Floats, away: Floats, sharpest: float) -> Floats | None:
    """Return the offsets ``(n,)`` along the normals; ``None`` if there is no curve within bounds."""
    from scipy.optimize import linprog

    count = len(points)
    step = float(np.hypot(*np.diff(points, axis=0).T).mean())
    now = _curvatures(points)
    # Curvature k' = k + k^2 n + n'' at the inner points, for offsets n.
    bend = np.diff(np.eye(count), 2, axis=0) / step**2
    bend[:, 1:-1] += np.diag(now**2)
    turn = np.diff(bend, axis=0) / step
    one = np.eye(count)
    # Unknowns: offsets, their distances from the line, the largest of these, and the changes of curvature without signs.
    sizes = (count, count, 1, len(turn))
    changes = np.eye(len(turn))
    rows = np.vstack(
        [
            _row(sizes, {0: bend}),
            _row(sizes, {0: -bend}),
            _row(sizes, {0: turn, 3: -changes}),
            _row(sizes, {0: -turn, 3: -changes}),
            _row(sizes, {0: one, 1: -one}),
            _row(sizes, {0: -one, 1: -one}),
            _row(sizes, {1: one, 2: -np.ones((count, 1))}),
        ]
    )
    rate = np.diff(now) / step
    # What is sharper, or changes faster, at the ends that stay is no reason to give up.
    most = np.maximum(sharpest, np.abs(now) + 1e-6)
    most[_HELD:-_HELD] = sharpest
    fastest = np.maximum(_CHANGE, np.abs(rate) + 1e-6)
    limits = [most - now, most + now, -rate, rate, away, -away, np.zeros(count)]
    cost = np.concatenate(
        [np.zeros(count), np.full(count, 0.02), [1.0 * count], np.full(len(turn), _EVENNESS * step)]
    )
    room = np.full(count, _STEP)
    room[:_HELD] = room[-_HELD:] = 0.0
    bounds = [(-most, most) for most in room.tolist()] + [(0.0, None)] * (count + 1)
    bounds += [(0.0, most) for most in fastest.tolist()]
    solution = linprog(cost, A_ub=rows, b_ub=np.concatenate(limits), bounds=bounds)
    return None if solution.x is None else np.asarray(solution.x[:count])


def _row(sizes: Sequence[int], parts: dict[int, Floats]) -> Floats:
    """Return a row of blocks of as many columns as sizes say: the parts, by their numbers, and zeros."""
    height = len(next(iter(parts.values())))
    return np.hstack([parts.get(number, np.zeros((height, size))) for number, size in enumerate(sizes)])
