"""Visibility in 2D mode (section 5.5 of the specification): whether an object's view touches another's outline."""

import math
from collections.abc import Iterable
from typing import Any, Final

import numpy as np

from scenic.graph import quaternions
from scenic.graph.kinds import Column, Kind
from scenic.graph.operation import Call, Operation, always
from scenic.runtime.regions.presence import seen_if_present
from scenic.runtime.regions.stacked import body_operands, is_body
from scenic.runtime.regions.visibility_bounds import sees_in_plane_bounds, sees_in_plane_inverse
from scenic.runtime.regions.visibility_nodes import camera_of, sees, view_operands
from scenic.runtime.values.values import apply, is_random, per_option, to_scalar, to_vector

FULL_ANGLE = 2 * np.pi - 0.017
"""View angles from here on count as all around (section 11.2)."""
_CORNERS: Final = ((0.5, 0.5), (-0.5, 0.5), (-0.5, -0.5), (0.5, -0.5))
"""Corners of a rectangle, in parts of its width and length."""
Triple = tuple[float, float, float]
Parts = tuple[float, float, float, float]


def sees_in_plane(observer: object, target: object, occluders: Iterable[object] = ()) -> Any:
    """Return whether the disc or sector that an observer sees meets the bounding polygon of an object, or holds a point.

    Where something may hide others, which in 2D mode has to be asked for, rays decide as in space.
    """
    everything = tuple(occluders)

    def seen(viewer: Any, thing: object) -> Any:
        hiding = [item for item in everything if item is not viewer and item is not thing and _may_hide(item)]
        if hiding:
            return sees(viewer, thing, hiding)
        camera, *_ = camera_of(viewer)
        _, _, angle, _, distance, *_ = view_operands(viewer)
        heading = to_scalar(viewer.heading) if hasattr(type(viewer), "toHeading") else 0.0
        if not is_body(thing):
            return apply(_SEES_POINT, camera, heading, angle, distance, to_vector(thing, "`can see`"))
        position, orientation, size, _ = body_operands(thing)
        return seen_if_present(
            thing, apply(_SEES, camera, heading, angle, distance, position, orientation, size)
        )

    return per_option(observer, lambda viewer: per_option(target, lambda thing: seen(viewer, thing)))


def sees_in_mode(observer: object, target: object, occluders: Iterable[object], *, mode_2d: bool) -> Any:
    """Return whether an observer sees something: in the plane where the program is in 2D mode, otherwise in space."""
    return (sees_in_plane if mode_2d else sees)(observer, target, occluders)


def _may_hide(thing: Any) -> bool:
    return is_random(thing.occluding) or bool(thing.occluding)


def _sees_point(
    _call: Call, camera: Column, heading: Column, angle: Column, distance: Column, point: Column
) -> Column:
    offset = (point - camera)[:, np.newaxis, :2]
    here = (offset == 0).all(axis=(1, 2))
    return np.asarray(_within(offset, heading, angle, distance)[:, 0] | here)


def _sees(
    _call: Call,
    camera: Column,
    heading: Column,
    angle: Column,
    distance: Column,
    position: Column,
    orientation: Column,
    size: Column,
) -> Column:
    """A rectangle meets a sector when a corner lies in it, or an edge comes within reach inside the view."""
    corners = _corners(position, orientation, size) - camera[:, np.newaxis, :2]
    ends = np.roll(corners, -1, axis=1)
    inside = _holds_origin(corners, ends)
    # Per edge, the part within the view; of the sector's two borders, the edges' crossings with them.
    in_view = _within(corners, heading, angle, distance)
    nearest = _nearest(corners, ends)
    in_view |= _within(nearest, heading, angle, distance)
    full = angle >= FULL_ANGLE
    for side in (-0.5, 0.5):
        border = heading + side * angle
        direction = np.stack([-np.sin(border), np.cos(border)], axis=-1)
        in_view |= _crosses(corners, ends, direction, distance) & ~full[:, np.newaxis]
    return np.asarray(inside | in_view.any(axis=1))


def _sees_at_once(
    _payload: object,
    camera: Triple,
    heading: float,
    angle: float,
    distance: float,
    position: Triple,
    orientation: Parts,
    size: Triple,
) -> bool:
    """Return what `_sees` does for plain floats, equal to it in every bit."""
    corners = []
    for right, front in _CORNERS:
        x, y, _ = quaternions.turned(orientation, (size[0] * right, size[1] * front, 0.0))
        corners.append((x + position[0] - camera[0], y + position[1] - camera[1]))
    edges = list(zip(corners, [*corners[1:], corners[0]], strict=True))
    sides = [a * d - b * c for (a, b), (c, d) in edges]
    if all(side >= 0 for side in sides) or all(side <= 0 for side in sides):
        return True
    places = [*corners, *(_nearest_at_once(*edge) for edge in edges)]
    if any(_is_within(x, y, heading, angle, distance) for x, y in places):
        return True
    if angle >= FULL_ANGLE:
        return False
    ends = np.array([corners])
    for side in (-0.5, 0.5):
        border = heading + side * angle
        direction = np.array([[-math.sin(border), math.cos(border)]])
        if _crosses(ends, np.roll(ends, -1, axis=1), direction, np.array([distance])).any():
            return True
    return False


def _nearest_at_once(start: tuple[float, float], end: tuple[float, float]) -> tuple[float, float]:
    x, y = end[0] - start[0], end[1] - start[1]
    part = min(max(-(start[0] * x + start[1] * y) / max(x * x + y * y, 1e-300), 0.0), 1.0)
    return start[0] + x * part, start[1] + y * part


def _is_within(x: float, y: float, heading: float, angle: float, distance: float) -> bool:
    if x * x + y * y > distance * distance * 1.000001 or not np.hypot(x, y) <= distance:
        return False
    azimuth = float(np.arctan2(y, x)) - math.pi / 2 - heading
    return angle >= FULL_ANGLE or abs((azimuth + math.pi) % (2 * math.pi) - math.pi) <= angle / 2


def _corners(position: Column, orientation: Column, size: Column) -> Column:
    signs = np.array(_CORNERS)
    offsets = np.zeros((len(size), 4, 3))
    offsets[..., :2] = size[:, np.newaxis, :2] * signs
    turned = quaternions.rotate(orientation[:, np.newaxis, :], offsets)
    return np.asarray(turned[..., :2] + position[:, np.newaxis, :2])


def _holds_origin(starts: Column, ends: Column) -> Column:
    cross = starts[..., 0] * ends[..., 1] - starts[..., 1] * ends[..., 0]
    return np.asarray((cross >= 0).all(axis=1) | (cross <= 0).all(axis=1))


def _nearest(starts: Column, ends: Column) -> Column:
    """The point of each edge nearest to the camera."""
    along = ends - starts
    length = along[..., 0] ** 2 + along[..., 1] ** 2
    dot = -(starts[..., 0] * along[..., 0] + starts[..., 1] * along[..., 1])
    part = np.clip(dot / np.maximum(length, 1e-300), 0, 1)
    return np.asarray(starts + along * part[..., np.newaxis])


def _within(points: Column, heading: Column, angle: Column, distance: Column) -> Column:
    x, y = points[..., 0], points[..., 1]
    azimuth = np.arctan2(y, x) - np.pi / 2 - heading[:, np.newaxis]
    azimuth = np.abs(np.remainder(azimuth + np.pi, 2 * np.pi) - np.pi)
    full = angle >= FULL_ANGLE
    in_angle = (azimuth <= angle[:, np.newaxis] / 2) | full[:, np.newaxis]
    return np.asarray(in_angle & (np.hypot(x, y) <= distance[:, np.newaxis]))


def _crosses(starts: Column, ends: Column, direction: Column, distance: Column) -> Column:
    """Return whether each edge crosses the segment from the camera along ``direction``."""
    ray = direction[:, np.newaxis, :]
    along = ends - starts
    across = along[..., 0] * ray[..., 1] - along[..., 1] * ray[..., 0]
    safe = np.where(across == 0, 1, across)
    reach = (starts[..., 1] * along[..., 0] - starts[..., 0] * along[..., 1]) / safe
    part = (starts[..., 1] * ray[..., 0] - starts[..., 0] * ray[..., 1]) / safe
    hit = (part >= 0) & (part <= 1) & (reach >= 0) & (reach <= distance[:, np.newaxis])
    return np.asarray(hit & (across != 0))


_SEES_POINT = Operation(
    "sees point in plane",
    always(Kind.BOOLEAN),
    _sees_point,
    "Whether a 2D view holds a point.",
    bounds=sees_in_plane_bounds,
    inverse=sees_in_plane_inverse,
)
_SEES = Operation(
    "sees in plane",
    always(Kind.BOOLEAN),
    _sees,
    "Whether a 2D view touches an outline.",
    scalar=_sees_at_once,
    bounds=sees_in_plane_bounds,
    inverse=sees_in_plane_inverse,
)
