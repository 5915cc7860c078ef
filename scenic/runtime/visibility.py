"""What an object sees in 2D mode (section 5.5 of the specification): whether its view touches another's outline."""

from typing import Any

import numpy as np

from scenic.graph import quaternions
from scenic.graph.kinds import Column, Kind
from scenic.graph.operation import Call, Operation, always
from scenic.runtime.regions.base import body_operands
from scenic.runtime.values import apply, operate, to_scalar, to_vector

FULL_ANGLE = 2 * np.pi - 0.017
"""View angles from here on count as all around (section 11.2)."""


def sees_in_plane(observer: Any, target: Any) -> Any:
    """Whether the bounding polygon of ``target`` meets the disc or sector that ``observer`` sees."""
    offset = operate("rotate", observer.orientation, to_vector(observer.cameraOffset))
    camera = operate("add", observer.position, offset)
    position, orientation, size, _ = body_operands(target)
    return apply(
        _SEES,
        camera,
        to_scalar(observer.heading),
        to_scalar(observer.viewAngle),
        to_scalar(observer.visibleDistance),
        position,
        orientation,
        size,
    )


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
    seen = _within(corners, heading, angle, distance)
    nearest = _nearest(corners, ends)
    seen |= _within(nearest, heading, angle, distance)
    full = angle >= FULL_ANGLE
    for side in (-0.5, 0.5):
        border = heading + side * angle
        direction = np.stack([-np.sin(border), np.cos(border)], axis=-1)
        seen |= _crosses(corners, ends, direction, distance) & ~full[:, np.newaxis]
    return np.asarray(inside | seen.any(axis=1))


def _corners(position: Column, orientation: Column, size: Column) -> Column:
    signs = np.array([[1, 1], [-1, 1], [-1, -1], [1, -1]]) / 2
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
    """Whether each edge crosses the segment from the camera along ``direction``."""
    ray = direction[:, np.newaxis, :]
    along = ends - starts
    across = along[..., 0] * ray[..., 1] - along[..., 1] * ray[..., 0]
    safe = np.where(across == 0, 1, across)
    reach = (starts[..., 1] * along[..., 0] - starts[..., 0] * along[..., 1]) / safe
    part = (starts[..., 1] * ray[..., 0] - starts[..., 0] * ray[..., 1]) / safe
    hit = (part >= 0) & (part <= 1) & (reach >= 0) & (reach <= distance[:, np.newaxis])
    return np.asarray(hit & (across != 0))


_SEES = Operation("sees in plane", always(Kind.BOOLEAN), _sees, "Whether a 2D view touches an outline.")
