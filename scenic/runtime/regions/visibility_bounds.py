"""Bounds and inverse readings, without sampling, of what observers see, for analysis.

Nothing is seen beyond the visible distance, or beside the window of directions that the view angles leave. What hides things
is left to sampling.
"""

from collections.abc import Sequence
from typing import Any, Final

import numpy as np

from scenic.graph import intervals
from scenic.graph.bounds import Bounds, Floats
from scenic.graph.operations.inverse_readings import truth
from scenic.graph.operations.orientations import turned
from scenic.runtime.geometry.views.observers import FULL_ANGLE_SLACK
from scenic.runtime.regions.nearness import SLACK, at_any_height, body_reach, near, only_within

_LESS_THAN_HALF: Final = np.pi - 2 * FULL_ANGLE_SLACK
"""View angles up to here leave a cone that is convex, and not nearly flat; from higher ones nothing is hidden above or below."""

CAMERA, ORIENTATION, HORIZONTAL, VERTICAL, DISTANCE = range(5)
"""Positions of the operands that describe an observer (`scenic.runtime.regions.visibility_nodes.view_operands`)."""

TARGET: Final = 9
"""Position of the first operand of the target: a point, or the operands of a body."""


def sees_looks_at(payload: tuple[bool, bool]) -> slice:
    """Return the operands that matter: not what hides things."""
    is_object, _ = payload
    return slice(TARGET + (4 if is_object else 1))


def sees_bounds(payload: tuple[bool, bool], *operands: Bounds | None) -> Bounds | None:
    """Bound the truth of "sees", from bounds of its operands: false where the target is certainly not seen."""
    camera, place, distance = operands[CAMERA], operands[TARGET], operands[DISTANCE]
    radius = _radius(payload, operands)
    if camera is None or place is None or distance is None or radius is None:
        return None
    bounds = only_within(camera, place, distance.upper + radius)
    orientation = operands[ORIENTATION]
    if orientation is None:
        return bounds
    sign = np.array([-1.0, -1.0, -1.0, 1.0])
    ends = orientation.lower * sign, orientation.upper * sign
    back = Bounds(np.minimum(*ends), np.maximum(*ends))
    local = intervals.widened(
        turned(back, intervals.subtract(place, camera)), (radius + SLACK)[:, np.newaxis]
    )
    is_outside = _beside(local, operands[HORIZONTAL]) | _above_or_below(local, operands[VERTICAL])
    return bounds.meet(truth(np.zeros_like(is_outside), is_outside))


def sees_inverse(
    payload: tuple[bool, bool], result: Bounds, *operands: Bounds | None
) -> Sequence[Bounds | None]:
    """Bound the positions of an observer and of the target that it sees."""
    parts: list[Bounds | None] = [None] * len(operands)
    distance, radius = operands[DISTANCE], _radius(payload, operands)
    if distance is not None and radius is not None:
        parts[CAMERA] = near(result, operands[TARGET], distance.upper + radius)
        parts[TARGET] = near(result, operands[CAMERA], distance.upper + radius)
    return parts


def sees_in_plane_bounds(_payload: object, *operands: Bounds | None) -> Bounds | None:
    """Bound the truth of "sees" in 2D mode: false where the target is certainly too far away.

    The operands are camera, heading, angle, distance, place and body.
    """
    camera, _, _, distance, place, *_ = operands
    radius = _radius_of(operands[5:])
    if camera is None or place is None or distance is None or radius is None:
        return None
    return only_within(at_any_height(camera), at_any_height(place), distance.upper + radius)


def sees_in_plane_inverse(
    _payload: object, result: Bounds, *operands: Bounds | None
) -> Sequence[Bounds | None]:
    """Bound the positions of an observer and of the target that it sees in 2D mode."""
    parts: list[Bounds | None] = [None] * len(operands)
    camera, _, _, distance, place, *_ = operands
    radius = _radius_of(operands[5:])
    if camera is not None and place is not None and distance is not None and radius is not None:
        parts[0] = near(result, at_any_height(place), distance.upper + radius)
        parts[4] = near(result, at_any_height(camera), distance.upper + radius)
    return parts


def _radius(payload: tuple[bool, bool], operands: Sequence[Bounds | None]) -> Floats | None:
    """Return bounds ``(m | 1,)`` of the distance that the target reaches from its place, or ``None``."""
    is_object, _ = payload
    return _radius_of(operands[TARGET + 1 : TARGET + 3] if is_object else ())


def _radius_of(body: Sequence[Bounds | None]) -> Floats | None:
    """Return the radius of a body from bounds of its orientation and size; of a place, for which there are none, it is 0."""
    if not body:
        return np.zeros(1)
    reach = body_reach(None, body[1])
    return None if reach is None else reach.upper.max(axis=1)


def _beside(local: Bounds, angle: Bounds | None) -> Any:
    """Return a mask of the boxes, in the frame of the view, that lie left or right of the view or behind it;
    x is to the right, y ahead.
    """
    if angle is None:
        return np.zeros(1, dtype=np.bool_)
    slope = np.tan(np.minimum(angle.upper, _LESS_THAN_HALF) / 2)
    (low_x, _, _), (high_x, high_y, _) = local.lower.T, local.upper.T
    across = slope * np.maximum(high_y, 0.0)
    outside = (high_y < 0) | (low_x > across * (1 + 1e-9)) | (-high_x > across * (1 + 1e-9))
    return outside & (angle.upper <= _LESS_THAN_HALF)


def _above_or_below(local: Bounds, angle: Bounds | None) -> Any:
    """Return a mask of the boxes, in the frame of the view, that lie above or below the view."""
    if angle is None:
        return np.zeros(1, dtype=np.bool_)
    slope = np.tan(np.minimum(angle.upper, _LESS_THAN_HALF) / 2)
    far_x, far_y, _ = intervals.size(local).T
    upward = slope * np.hypot(far_x, far_y)
    outside = (local.lower[:, 2] > upward * (1 + 1e-9)) | (-local.upper[:, 2] > upward * (1 + 1e-9))
    return outside & (angle.upper <= _LESS_THAN_HALF)
