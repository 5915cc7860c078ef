"""Lanes that open or close: where one is narrower than a car, cars drive partly, and at its end wholly, in the lane beside it."""

from typing import Any, Final

import numpy as np
from numpy.typing import NDArray

from scenic.domains.driving.elements import Lane, Maneuver
from scenic.domains.driving.maneuvering import next_maneuver

__all__ = ["line_to_drive", "ways_after"]

Floats = NDArray[np.float64]

_NARROW: Final = 2.5
"""Metres of width below which a car has no room of its own."""
_WHOLE: Final = 0.97
"""Share of the largest width from which on a lane counts as whole."""
_CLOSED: Final = 0.5
"""Metres of width at which a lane has ended."""
_NEAR: Final = 5.0
"""Metres between the ends of lanes beside each other."""


def line_to_drive(lane: Lane) -> Floats:
    """Return the line ``(n, 2)`` that cars follow on a lane: its middle, and that of the lane beside it where it opens or closes.

    A lane with lanes of its direction on both sides, or on none, is followed in its middle.
    """
    widths = np.hypot(*(lane.left - lane.right).T)
    if widths.min() >= _NARROW:
        return lane.line
    beside = _beside(lane)
    if beside is None:
        return lane.line
    import shapely

    other, is_left = beside
    # From lane to lane over the whole length on which the width changes.
    full = max(_NARROW, _WHOLE * float(widths.max()))
    narrow = widths < full
    share = widths[narrow] / full
    inner = (lane.left if is_left else lane.right)[narrow]
    reach = shapely.distance(shapely.linestrings(other.line), shapely.points(inner)) + widths[narrow] / 2
    offsets = reach * (1 - 3 * share**2 + 2 * share**3)
    along = np.gradient(lane.line, axis=0)[narrow]
    along /= np.maximum(np.hypot(*along.T), 1e-9)[:, None]
    normals = np.column_stack([-along[:, 1], along[:, 0]]) * (1.0 if is_left else -1.0)
    line = lane.line.copy()
    line[narrow] += offsets[:, None] * normals
    return line


def ways_after(lane: Lane) -> tuple[Maneuver, ...]:
    """The maneuvers to choose from at the end of a lane; those of the lane beside it if it closes there and nothing follows it."""
    if not lane.maneuvers and float(np.hypot(*(lane.left[-1] - lane.right[-1]))) < _CLOSED:
        beside = _beside(lane)
        # Lanes that close within a road end far from where the others do.
        if beside is not None and float(np.hypot(*(beside[0].line[-1] - lane.line[-1]))) < _NEAR:
            return next_maneuver(beside[0])
    return next_maneuver(lane)


def _beside(lane: Lane) -> tuple[Any, bool] | None:
    """The only lane of the same direction beside a lane, and whether it is on the left; ``None`` if there are two, or none."""
    sides: dict[bool, Any] = {}
    for section in lane.sections:
        for is_left, other in ((True, section._laneToLeft), (False, section._laneToRight)):
            if other is not None and other.isForward == section.isForward:
                sides[is_left] = other.lane
    if len(sides) != 1:
        return None
    [(is_left, found)] = sides.items()
    return found, is_left
