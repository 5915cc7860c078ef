"""Regions as lines to be drawn, and the box around them."""

from itertools import product
from typing import Any

import numpy as np

from scenic.formats.instances import Array
from scenic.formats.poses import rotation_matrix
from scenic.runtime.regions.planar import CircularRegion, PolygonalRegion, RectangularRegion
from scenic.runtime.regions.volumes import BoxRegion, PlacedVolume

_CORNERS = np.array(list(product((-0.5, 0.5), repeat=3)))
_EDGES = [(a, a | bit) for a in range(8) for bit in (1, 2, 4) if not a & bit]
_SIDES = 72


def outlines(region: Any) -> list[Array]:
    """Lines ``(k, 3)`` that show where a fixed region is; none for a region of another kind.

    Args:
        region: a region, or a workspace.

    """
    match getattr(region, "region", region):
        case CircularRegion() as disc:
            center = np.array(list(disc.center), dtype=float)
            return [center + disc.radius * _ring()]
        case RectangularRegion() as rectangle:
            corners = np.array([[-1, -1], [1, -1], [1, 1], [-1, 1], [-1, -1]]) / 2
            offset = np.zeros((5, 3))
            offset[:, :2] = corners * [rectangle.width, rectangle.length]
            turn = rotation_matrix((0.0, 0.0, np.sin(rectangle.heading / 2), np.cos(rectangle.heading / 2)))
            return [np.array(list(rectangle.position), dtype=float) + offset @ turn.T]
        case PolygonalRegion() as polygonal:
            rings = [ring for part in polygonal.polygons.geoms for ring in (part.exterior, *part.interiors)]
            return [_at_height(np.array(ring.coords)[:, :2], polygonal.z) for ring in rings]
        case PlacedVolume() as volume:
            rotation = volume.rotation
            quaternion = (rotation.x, rotation.y, rotation.z, rotation.w)
            matrix = rotation_matrix(quaternion) * np.array(list(volume.dimensions))
            middle = np.array(list(volume.position), dtype=float)
            if isinstance(volume, BoxRegion):
                lines = [_CORNERS[list(edge)] for edge in _EDGES]
            else:
                ring = _ring() / 2
                lines = [ring, ring[:, [0, 2, 1]], ring[:, [2, 0, 1]]]
            return [middle + line @ matrix.T for line in lines]
        case _:
            return []


def view_outline(horizontal: float, vertical: float, distance: float) -> list[Array]:
    """Lines ``(k, 3)`` that show a view from the origin, ahead to +Y: arcs of its outer border, and its edges.

    Args:
        horizontal: view angle, radians, up to 2π.
        vertical: view angle, radians, up to π.
        distance: how far it reaches, metres.

    """

    def place(azimuth: Array, altitude: Array) -> Array:
        level = np.cos(altitude)
        directions = [-np.sin(azimuth) * level, np.cos(azimuth) * level, np.sin(altitude)]
        return distance * np.stack(np.broadcast_arrays(*directions), axis=-1)

    across = np.linspace(-horizontal / 2, horizontal / 2, _SIDES // 2 + 1)
    upward = np.linspace(-vertical / 2, vertical / 2, _SIDES // 4 + 1)
    around, upright = horizontal > 2 * np.pi - 0.02, vertical > np.pi - 0.02
    lines = [place(across, np.array(0.0))]
    if not upright:
        lines += [place(across, np.array(side * vertical / 2)) for side in (-1, 1)]
    if around:
        lines += [place(np.array(turn * np.pi / 2), upward) for turn in range(4)]
    else:
        lines += [place(np.array(side * horizontal / 2), upward) for side in (-1, 1)]
    if not around:
        tops = (0.0,) if upright else (-0.5, 0.5)
        corners = [(side * horizontal / 2, top * vertical) for side in (-1, 1) for top in tops]
        lines += [np.stack([np.zeros(3), place(np.array(a), np.array(b))]) for a, b in corners]
    return lines


def bounds(region: Any) -> tuple[Array, Array] | None:
    """The lower and upper corner of the box around a fixed region; ``None`` where it has none or is not known."""
    lines = outlines(region)
    if not lines:
        return None
    points = np.concatenate(lines)
    return points.min(axis=0), points.max(axis=0)


def _ring() -> Array:
    angle = np.linspace(0, 2 * np.pi, _SIDES + 1)
    return np.stack([np.cos(angle), np.sin(angle), np.zeros_like(angle)], axis=-1)


def _at_height(points: Array, z: float) -> Array:
    return np.column_stack([points, np.full(len(points), z)])
