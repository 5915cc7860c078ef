"""By how much an observer sees something, or does not: the margin of `can see` (section 12.5's robustness needs one).

Positive values are shares, negative ones angles, so that a search can go by either:

- An object that is seen: the share of the directions in which it lies that reach it. A point that is seen: the angle to the
  nearest direction that does not (radians). Neither is more than the part of the range that is left.
- What is hidden, or beyond the border of the view: minus the least angle (radians) between a direction in which it lies and a
  direction of the view that nothing stops before the target's distance.
- What is too far away: minus the excess of the distance, as a part of the range, if that is less.
"""

from collections.abc import Iterable
from typing import Any, Final

import numpy as np

from scenic.runtime.geometry.poses import Booleans, Floats
from scenic.runtime.geometry.views.hits import place
from scenic.runtime.geometry.views.observers import Views
from scenic.runtime.geometry.views.occluders import Obstacles, Occluder
from scenic.runtime.geometry.views.seen_bodies import box_distance
from scenic.runtime.regions.stacked import body_of, body_operands, is_body
from scenic.runtime.regions.visibility_nodes import view_operands, views_of
from scenic.runtime.values.values import to_vector

__all__ = ["clearance"]

_ACROSS: Final = 33
"""Directions along each side of the squares of directions that are looked in."""
_AROUND: Final = 0.6
"""So far around the target free directions are looked for, radians."""
_LEAST: Final = 1e-9
"""Margins are at least this far from 0, on the side of the truth."""


def clearance(observer: object, target: object, occluders: Iterable[Any], *, seen: bool) -> float:
    """Measure by how much an observer sees a definite object or point past others.

    Args:
        observer: a definite point or object.
        target: an object, or a point.
        occluders: what may hide it; the observer and the target hide nothing.
        seen: whether it is seen, which the sign follows.

    """
    views = views_of([_column(value) for value in view_operands(observer)])
    bodies = [
        Occluder(body_of(*map(_column, body_operands(thing))))
        for thing in occluders
        if thing is not observer and thing is not target and thing.occluding
    ]
    if is_body(target):
        margin = _of_body(views, body_of(*map(_column, body_operands(target))), bodies)
    else:
        margin = _of_point(views, np.array([to_vector(target, "`can see`").row]), bodies)
    return max(_LEAST, margin) if seen else min(-_LEAST, margin)


def _of_body(views: Views, body: Any, bodies: list[Occluder]) -> float:
    placement = place(body, views, np.zeros(1, dtype=np.intp))
    middle = views.to_view(body.poses.position)[0]
    away = float(np.linalg.norm(middle))
    reach = 0.5 * float(np.linalg.norm(body.poses.size))
    left = 1 - float(box_distance(placement.origin, body.poses.size)[0]) / float(views.distance[0])
    if reach >= away:
        return min(1.0, left)
    width = float(np.arcsin(reach / away))
    near = _directions(middle / away, width)
    limits = placement.first(np.zeros(len(near), dtype=np.intp), near)
    towards = np.isfinite(limits)
    if not towards.any():
        return min(0.0, left)
    obstacles = Obstacles(bodies, views, np.zeros(1, dtype=np.intp), body.poses.position, np.array([reach]))
    clear = _are_clear(views, near, np.where(towards, limits, away), obstacles)
    share = float(clear[towards].mean())
    if share > 0:
        return min(share, left)
    far = _directions(middle / away, width + _AROUND)
    wide = Obstacles(bodies, views, np.zeros(1, dtype=np.intp), body.poses.position, np.array([away * 0.99]))
    free = np.concatenate([near[clear], far[_are_clear(views, far, np.full(len(far), away), wide)]])
    return min(-_angle(near[towards], free), left)


def _of_point(views: Views, point: Floats, bodies: list[Occluder]) -> float:
    middle = views.to_view(point)[0]
    away = float(np.linalg.norm(middle))
    left = 1 - away / float(views.distance[0])
    if away == 0:
        return min(1.0, left)
    straight = middle[None] / away
    obstacles = Obstacles(bodies, views, np.zeros(1, dtype=np.intp), point, np.array([away * 0.99]))
    around = _directions(straight[0], _AROUND)
    clear = _are_clear(views, around, np.full(len(around), away), obstacles)
    if _are_clear(views, straight, np.array([away]), obstacles)[0]:
        return min(_angle(straight, around[~clear]), left)
    return min(-_angle(straight, around[clear]), left)


def _directions(middle: Floats, width: float) -> Floats:
    """Directions ``(n, 3)`` of length 1 within an angle of a direction, about evenly spread; the middle is one of them."""
    side = np.cross(middle, (0.0, 0.0, 1.0) if abs(middle[2]) < 0.9 else (1.0, 0.0, 0.0))
    side /= np.linalg.norm(side)
    up = np.cross(side, middle)
    across, upward = np.meshgrid(*2 * (np.linspace(-width, width, _ACROSS),))
    angle = np.hypot(across, upward).ravel()
    within = angle <= width * (1 + 1e-9)
    angle, across, upward = angle[within], across.ravel()[within], upward.ravel()[within]
    scale = np.sinc(angle / np.pi)  # the sine of the angle, by the angle
    directions: Floats = (
        np.cos(angle)[:, None] * middle + (scale * across)[:, None] * side + (scale * upward)[:, None] * up
    )
    return directions


def _are_clear(views: Views, directions: Floats, limits: Floats, obstacles: Obstacles) -> Booleans:
    """Return a mask of the directions that are in the view and that no obstacle stops before their limits (metres)."""
    x, y, z = directions.T
    half = 0.5 * views.window[0] + 1e-9
    within = (np.abs(np.arctan2(-x, y)) <= half[0]) & (np.abs(np.arcsin(np.clip(z, -1, 1))) <= half[1])
    found: Booleans = within & ~obstacles.block(np.zeros(len(directions), dtype=np.intp), directions, limits)
    return found


def _angle(some: Floats, others: Floats) -> float:
    """The least angle between two sets of directions, radians; or the largest angle that is searched if the sets are farther apart."""
    from scipy.spatial import KDTree  # slow to import

    if not len(others):
        return _AROUND
    chord = float(np.min(KDTree(others).query(some)[0]))
    return float(2 * np.arcsin(min(1.0, chord / 2)))


def _column(value: object) -> Any:
    """Return a definite value as a column of one lane."""
    raw = getattr(value, "row", None)
    if raw is None:
        raw = getattr(value, "q", value)
    if isinstance(raw, tuple):
        return np.array([raw], dtype=np.float64)
    if isinstance(raw, bool | int | float):
        return np.array([raw])
    column = np.empty(1, dtype=object)
    column[0] = raw
    return column
