"""The places in view, occlusion ignored (section 11.2 of the specification): drawn from, and as a mesh."""

from functools import lru_cache
from typing import Final

import numpy as np

from scenic.runtime.geometry.meshes.mesh import Mesh
from scenic.runtime.geometry.meshes.topology import merge_vertices
from scenic.runtime.geometry.poses import Floats
from scenic.runtime.geometry.views.observers import FULL_ANGLE_SLACK, Views

LEAST_ANGLE: Final = 0.017
"""Radians to which smaller view angles are raised, so that the region has a volume."""

_CORE: Final = 8.0
"""Distance from the camera, in radii of a ball, within which every direction to the ball counts as near the view."""

_STEP: Final = np.radians(3.0)
"""The widest step between neighbouring corners of the mesh."""


def region_angles(angles: Floats) -> Floats:
    """View angles ``(..., 2)`` as view regions have them: those almost all around are, tiny ones are raised."""
    full = np.array([2 * np.pi, np.pi])
    return np.where(angles >= full - FULL_ANGLE_SLACK, full, np.maximum(angles, LEAST_ANGLE))


def draw_places(views: Views, uniforms: Floats) -> Floats:
    """Places uniformly distributed over the view regions, ``(n, 3)``, from points of the unit cube ``(n, 3)``.

    In spherical coordinates the volume element is r² dr, d(azimuth), d(sin altitude).
    """
    window = region_angles(views.angles)
    radius = views.distance * np.cbrt(uniforms[:, 0])
    azimuth = (uniforms[:, 1] - 0.5) * window[:, 0]
    height = (2 * uniforms[:, 2] - 1) * np.sin(0.5 * window[:, 1])
    across = np.sqrt(1 - height * height)
    local = np.stack([-np.sin(azimuth) * across, np.cos(azimuth) * across, height], axis=-1)
    return _from_view(views, radius[:, None] * local)


def _from_view(views: Views, local: Floats) -> Floats:
    """Points of the view's frame in the world, ``(n, 3)``."""
    x, y, z = local.T
    matrix = views.matrix
    turned = [matrix[:, i, 0] * x + matrix[:, i, 1] * y + matrix[:, i, 2] * z for i in range(3)]
    result: Floats = views.camera + np.stack(turned, axis=-1)
    return result


def view_volume(views: Views) -> Floats:
    """Cubic metres in view, ``(n | 1,)``."""
    window = region_angles(views.angles)
    result: Floats = views.distance**3 / 3 * window[:, 0] * 2 * np.sin(window[:, 1] / 2)
    return result


def near_volume(views: Views, radius: Floats) -> Floats:
    """Return the volume ``(n,)``, in cubic metres, that `draw_near` draws from."""
    inner, outer, window = _near(views, radius)
    result: Floats = 4 / 3 * np.pi * inner**3 + (outer**3 - inner**3) / 3 * window[:, 0] * 2 * np.sin(
        window[:, 1] / 2
    )
    return result


def draw_near(views: Views, radius: Floats, uniforms: Floats) -> Floats:
    """Uniform points of a set that holds all middles of balls that meet a view region, ``(n, 3)``.

    Args:
        views: with a row for each of n lanes.
        radius: of the balls, metres, ``(n,)``.
        uniforms: points of the unit cube, ``(n, 4)``.

    """
    inner, outer, window = _near(views, radius)
    central = uniforms[:, 0] * near_volume(views, radius) < 4 / 3 * np.pi * inner**3
    low, high = np.where(central, 0.0, inner), np.where(central, inner, outer)
    distance = np.cbrt(low**3 + uniforms[:, 1] * (high**3 - low**3))
    azimuth = (uniforms[:, 2] - 0.5) * np.where(central, 2 * np.pi, window[:, 0])
    height = (2 * uniforms[:, 3] - 1) * np.where(central, 1.0, np.sin(0.5 * window[:, 1]))
    across = np.sqrt(np.maximum(1 - height * height, 0.0))
    local = np.stack([-np.sin(azimuth) * across, np.cos(azimuth) * across, height], axis=-1)
    return _from_view(views, distance[:, None] * local)


def _near(views: Views, radius: Floats) -> tuple[Floats, Floats, Floats]:
    """A ball about the camera and a shell around it, cut by wider angles: inner and outer radius, and the angles.

    A ball whose middle is farther than the inner radius reaches into directions at most d from its middle's, where
    sin d is its radius over the inner one. At altitude a, directions up to d away differ in azimuth by at most the arc
    whose sine is sin d / cos a.
    """
    outer = views.distance + radius
    inner = np.minimum(_CORE * radius, outer)
    sine = np.minimum(np.where(inner > 0, radius / np.where(inner > 0, inner, 1.0), 0.0), 1.0)
    window = region_angles(views.angles)
    level = np.cos(0.5 * window[:, 1])
    sideways = np.where(sine < level, np.arcsin(np.minimum(sine / np.maximum(level, 1e-300), 1.0)), np.pi)
    wider = np.stack([window[:, 0] + 2 * sideways, window[:, 1] + 2 * np.arcsin(sine)], axis=-1)
    return inner, outer, np.minimum(wider + 1e-9, [2 * np.pi, np.pi])


@lru_cache(maxsize=64)
def view_mesh(horizontal: float, vertical: float) -> Mesh:
    """The view region of radius 1 about the origin as a closed mesh, whose corners lie on the true region.

    Args:
        horizontal: view angle, radians, above 0; 2π for all around.
        vertical: view angle, radians, above 0; π for up to straight up and down.

    """
    h, v = region_angles(np.array([horizontal, vertical]))
    around = h == 2 * np.pi
    columns, rows = max(3, int(np.ceil(h / _STEP))), max(2, int(np.ceil(v / _STEP)))
    azimuth = -h / 2 + h * np.arange(columns + 1) / columns
    altitude = -v / 2 + v * np.arange(rows + 1) / rows
    level = np.cos(altitude)
    if v == np.pi:
        level[[0, -1]] = 0.0
    if around:
        azimuth[-1] = azimuth[0]
    patch = np.stack(
        [
            -np.sin(azimuth)[:, None] * level,
            np.cos(azimuth)[:, None] * level,
            np.broadcast_to(np.sin(altitude), (columns + 1, rows + 1)),
        ],
        axis=-1,
    )
    number = np.arange((columns + 1) * (rows + 1)).reshape(columns + 1, rows + 1)
    a, b, c, d = (
        corner.ravel() for corner in (number[:-1, :-1], number[1:, :-1], number[1:, 1:], number[:-1, 1:])
    )
    # Azimuth grows anticlockwise seen from above: seen from outside, a, b, c, d run anticlockwise.
    faces = [np.stack([a, c, d], axis=-1), np.stack([a, b, c], axis=-1)]
    apex = number.size
    borders = []
    if not around:
        borders += [number[0], number[-1, ::-1]]
    if v < np.pi:
        borders += [number[::-1, 0], number[:, -1]]
    faces += [np.stack([np.full(len(line) - 1, apex), line[:-1], line[1:]], axis=-1) for line in borders]
    points = np.concatenate([patch.reshape(-1, 3), np.zeros((1, 3))])
    vertices, new_faces = merge_vertices(points, np.concatenate(faces))
    return Mesh(vertices, new_faces)
