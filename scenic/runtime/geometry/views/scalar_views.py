"""Visibility for one observer, on plain floats, for running simulations.

Answers are certain, by more than rounding can change, or ``None``: then rays decide (`scenic.runtime.geometry.views.seen_bodies`).
The middle of a body shows that it is seen, a box before all corners of its box that it is not.
"""

import math
from collections.abc import Iterable, Sequence
from typing import Final, NamedTuple

from scenic.runtime.geometry.contact.scalar_bodies import PlacedBody, Rows, Triple, is_near_way
from scenic.runtime.geometry.views.observers import FULL_ANGLE_SLACK
from scenic.runtime.geometry.views.seen_bodies import contains_own_centre

__all__ = ["View", "sees_body", "sees_point"]

_ANGLE: Final = 1e-6
"""Margin, in radians, around the border of a view, in which directions count as undecided."""

_PART: Final = 1e-6
"""The least distance of an occluder from both ends of a line of sight, as a share of its length."""


class View(NamedTuple):
    """An observer: camera, axes of its frame (right, ahead, up), view angles in radians and range in metres."""

    camera: Triple
    axes: Rows
    angles: tuple[float, float]
    distance: float

    def contains(self, point: Triple) -> bool | None:
        """Return whether a point is within range and angles."""
        return self._holds(point, 0.0, 0.0)

    def meets_ball(self, point: Triple, radius: float) -> bool | None:
        """Return ``False`` if a ball about a point is out of range or angles, else ``None``: the answer is never true."""
        return False if self._holds(point, radius, 1.0) is False else None

    def _holds(self, point: Triple, radius: float, around: float) -> bool | None:
        dx, dy, dz = (end - start for end, start in zip(point, self.camera, strict=True))
        x, y, z = (dx * a + dy * b + dz * c for a, b, c in self.axes)
        flat = x * x + y * y
        across, distance = math.sqrt(flat), math.sqrt(flat + z * z)
        slack = 1e-6 * (1 + self.distance)
        if distance - radius > self.distance + slack:
            return False
        certain = distance < self.distance - slack and distance > slack
        horizontal, vertical = self.angles
        if vertical < math.pi - FULL_ANGLE_SLACK:
            beyond = abs(math.atan2(z, across)) - vertical / 2
            reach = _ANGLE + (around * _angular(radius, distance))
            if beyond > reach:
                return False
            certain = certain and beyond < -_ANGLE
        if horizontal < 2 * math.pi - FULL_ANGLE_SLACK:
            if across <= slack:
                return None
            beyond = abs(math.atan2(-x, y)) - horizontal / 2
            reach = _ANGLE + (around * _angular(radius, across))
            if beyond > reach:
                return False
            certain = certain and beyond < -_ANGLE
        return True if certain else None


def _angular(radius: float, distance: float) -> float:
    """Return half the angle under which a ball is seen; half a turn from inside."""
    return math.asin(radius / distance) if radius < distance else math.pi


def sees_point(view: View, point: Triple, occluders: Iterable[PlacedBody]) -> bool | None:
    """Return whether a view shows a point past others."""
    inside = view.contains(point)
    if not inside:
        return inside
    open_question = False
    for occluder in occluders:
        is_blocked = _blocks(occluder, view.camera, point)
        if is_blocked:
            return False
        open_question |= is_blocked is None
    return None if open_question else True


def sees_body(view: View, target: PlacedBody, occluders: Sequence[PlacedBody]) -> bool | None:
    """Return whether a view shows a body past others."""
    if target.mesh.derived(contains_own_centre) and sees_point(view, target.position, occluders):
        return True
    if view.meets_ball(target.position, target.radius) is False:
        return False
    corners = target.corners()
    for occluder in occluders:
        if occluder.mesh.is_box and all(_blocks(occluder, view.camera, corner) for corner in corners):
            return False
    return None


def _blocks(occluder: PlacedBody, start: Triple, end: Triple) -> bool | None:
    """Return whether the way from one point to another meets the surface of a body; ``None`` if its box leaves that open."""
    if not is_near_way(start, end, occluder.position, occluder.radius):
        return False
    wx, wy, wz = end[0] - start[0], end[1] - start[1], end[2] - start[2]
    ox, oy, oz = (at - centre for at, centre in zip(start, occluder.position, strict=True))
    slack = occluder.slack
    enters, leaves = -math.inf, math.inf
    outer_enters, outer_leaves = 0.0, 1.0
    for (ux, uy, uz), half in zip(occluder.axes, occluder.half, strict=True):
        at, way = ox * ux + oy * uy + oz * uz, wx * ux + wy * uy + wz * uz
        for reach, is_outer in ((half - slack, False), (half + slack, True)):
            if abs(way) < 1e-12:
                first, last = (-math.inf, math.inf) if abs(at) < reach else (math.inf, -math.inf)
            else:
                first, last = (-reach - at) / way, (reach - at) / way
                first, last = min(first, last), max(first, last)
            if is_outer:
                outer_enters, outer_leaves = max(outer_enters, first), min(outer_leaves, last)
            else:
                enters, leaves = max(enters, first), min(leaves, last)
    if outer_enters > outer_leaves:
        return False
    # From outside and in: so the way meets the surface.
    if occluder.mesh.is_box and outer_enters > 0 and _PART < enters < leaves and enters < 1 - _PART:
        return True
    return None
