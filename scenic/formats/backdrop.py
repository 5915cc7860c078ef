"""Sky and ground of pictures, which are not part of the scene."""

from typing import Final

import numpy as np

from scenic.formats.colors import linear
from scenic.formats.scenery import USUAL, Scenery
from scenic.formats.stage import Stage, ground_light
from scenic.runtime.geometry.meshes.embree import Singles

_LINE_COLOR: Final = (0.55, 0.57, 0.61)


def sky_color(directions: Singles, scenery: Scenery = USUAL) -> Singles:
    """Return linear colours ``(3, n)`` in directions ``(n, 3)``: a gradient; below the horizon it is the horizon's."""
    x, y, z = directions.T
    up = np.clip(z / np.sqrt(x * x + y * y + z * z) * np.float32(2), 0, 1)
    low, high = (linear(color) * np.float32(scenery.exposure) for color in (scenery.horizon, scenery.zenith))
    result: Singles = low[:, None] + (high - low)[:, None] * up
    return result


def ground_color(
    stage: Stage,
    eye: Singles,
    directions: Singles,
    nearness: Singles,
    light: tuple[Singles, Singles],
    pixel: float,
) -> Singles:
    """Return linear colours ``(3, n)`` of the ground in its part of the sun and of the sky, with a grid of lines.

    Far from the scene it turns into sky.

    Args:
        stage: the scene.
        eye: where the rays start, relative to its middle, ``(3,)``.
        directions: of the rays, ``(n, 3)``.
        nearness: one over the lengths of the directions in which they meet the ground, ``(n,)``.
        light: parts of the sun and of the sky, ``(n,)`` each.
        pixel: angle between two pixels, radians.

    """
    depth = np.float32(1) / nearness
    x, y = (np.float32(eye[axis]) + directions[:, axis] * depth for axis in (0, 1))
    steepness = np.maximum(-directions[:, 2], np.float32(0.05))
    footprint = np.asarray(depth / steepness * np.float32(pixel), np.float32)
    scenery = stage.scenery
    cover = _lines(stage, x, y, footprint) if scenery.grid else np.zeros(len(x), np.float32)
    ground, lines = linear(scenery.ground), linear(_LINE_COLOR)
    result = ground_light(ground[:, None] + (lines - ground)[:, None] * cover, *light, scenery)
    away = np.sqrt(x * x + y * y) / np.float32(1.2 * stage.reach) - np.float32(0.5)
    far = np.flatnonzero(away > 0)
    part = np.minimum(away[far], 1) ** np.float32(0.8)
    result[:, far] += part * (sky_color(directions[far], scenery) - result[:, far])
    return result


def _lines(stage: Stage, x: Singles, y: Singles, footprint: Singles) -> Singles:
    """Return the share of each place that grid lines cover: they are a pixel or two wide at any distance, and
    fade where they crowd.
    """
    cover = np.zeros(len(x), np.float32)
    spacing = _grid_spacing(stage.reach)
    for step, strength in ((spacing, 0.35), (spacing * 5, 0.7)):
        away = np.full(len(x), np.inf, np.float32)
        for axis, place in enumerate((x, y)):
            position = place * np.float32(1 / step)
            position += np.float32(stage.center[axis] / step)
            position -= np.rint(position)
            np.minimum(away, np.abs(position, out=position), out=away)
        near = np.flatnonzero(away * np.float32(step) < np.float32(1.2) * footprint)
        wide = footprint[near]
        line = np.minimum(np.float32(1.2) - away[near] * np.float32(step) / wide, 1)
        line *= np.float32(strength) * np.clip(np.float32(1.5) - wide * np.float32(6 / step), 0, 1)
        # A line that crosses another covers what that leaves.
        cover[near] += line * (1 - cover[near])
    return cover


def _grid_spacing(reach: float) -> float:
    """Return one, two or five times a power of ten metres, so that a scene has some twenty lines."""
    power = 10.0 ** np.floor(np.log10(reach / 12))
    return float(min((1, 2, 5, 10), key=lambda step: abs(np.log(step * power * 12 / reach))) * power)
