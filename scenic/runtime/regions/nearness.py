"""Facts, without sampling, about relations that hold only between places near each other: boxes in which things lie.

Bounds are those of a node over many boxes of the cube (`scenic.graph.bounds`): rows ``(m | 1, 3)``, in metres.
"""

from collections.abc import Sequence
from functools import reduce
from typing import Final

import numpy as np

from scenic.graph import intervals
from scenic.graph.bounds import Bounds, Floats
from scenic.graph.operations.inverse_readings import truth, where
from scenic.graph.operations.orientations import turned

SLACK: Final = 1e-6
"""Metres by which readings are generous: more than rounding, and than the tolerances of containment."""


def body_box(position: Bounds | None, orientation: Bounds | None, size: Bounds | None) -> Bounds | None:
    """Return the box in which a body lies, from bounds of what places it; its mesh lies in the unit box."""
    reach = body_reach(orientation, size)
    return None if position is None or reach is None else intervals.add(position, reach)


def body_reach(orientation: Bounds | None, size: Bounds | None) -> Bounds | None:
    """Return the box in which a body lies, seen from its position."""
    if size is None:
        return None
    half = np.maximum(intervals.size(size), 0.0) / 2
    if orientation is not None:
        return turned(orientation, Bounds(-half, half))
    radius = np.sqrt((half * half).sum(axis=1, keepdims=True)) * np.ones(3)
    return intervals.relaxed(Bounds(-radius, radius), 1e-12)


def separation(first: Bounds, second: Bounds) -> Floats:
    """The least distance ``(m | 1,)`` between points of two boxes, rounded down; not more than 0 where nothing is known."""
    beside = np.maximum(np.maximum(first.lower - second.upper, second.lower - first.upper), 0.0)
    distance: Floats = np.sqrt((beside * beside).sum(axis=1)) * (1 - 1e-12) - SLACK
    return np.where(np.isfinite(distance), distance, 0.0)


def hull_of(boxes: Sequence[Bounds | None]) -> Bounds | None:
    """Return the box that holds some boxes; ``None`` where one of them is not known."""
    known = [box for box in boxes if box is not None]
    return reduce(Bounds.hull, known) if len(known) == len(boxes) else None


def at_any_height(box: Bounds) -> Bounds:
    """Return a box and all that is above and below it."""
    z = np.array([False, False, True])
    return Bounds(np.where(z, -np.inf, box.lower), np.where(z, np.inf, box.upper))


def grown(box: Bounds, distance: Floats) -> Bounds:
    """Return the box of everything within distances ``(m | 1,)`` of a box."""
    margin = np.maximum(distance, 0.0)[:, np.newaxis] + SLACK
    return Bounds(box.lower - margin, box.upper + margin)


def only_within(first: Bounds | None, second: Bounds | None, distance: Floats) -> Bounds:
    """Return bounds of a truth value that can hold only where two boxes are within distances ``(m | 1,)`` of each other."""
    if first is None or second is None:
        return truth(np.zeros(1, dtype=np.bool_), np.zeros(1, dtype=np.bool_))
    apart = separation(first, second) > distance
    return truth(np.zeros_like(apart), apart)


def near(result: Bounds, other: Bounds | None, distance: Floats) -> Bounds | None:
    """Bound the position of a thing, if ``result`` is true only within a distance of another thing."""
    return None if other is None else where(result.lower > 0, grown(other, distance))
