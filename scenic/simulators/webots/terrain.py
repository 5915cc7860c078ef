"""Uneven ground: its heights at the points of a grid, and the solid below them."""

import math
from collections.abc import Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray

from scenic.language.errors import InvalidScenarioError
from scenic.runtime.values.random_values import Random

__all__ = ["ground_solid", "heights_of", "hill_height"]

Floats = NDArray[np.float64]


def heights_of(
    terrain: Sequence[Any], width: float, length: float, columns: int, rows: int
) -> tuple[tuple[Any, ...], ...]:
    """The sum of the heights of all parts of a terrain at the points of a grid about the origin.

    Args:
        terrain: things with a method ``heightAt(point)``, whose answers may be random values.
        width: extent along x, metres.
        length: extent along y, metres.
        columns: points along x.
        rows: points along y.

    Returns:
        Rows of heights in metres, from the corner with the least x and y.

    """
    across = np.linspace(-width / 2, width / 2, columns).tolist()
    along = np.linspace(-length / 2, length / 2, rows).tolist()
    return tuple(tuple(sum((part.heightAt((x, y)) for part in terrain), 0.0) for x in across) for y in along)


def hill_height(x: float, y: float, width: float, length: float, height: float, spread: float) -> float:
    """The height of a hill (a Gaussian) at a place in its own frame; 0 outside its rectangle.

    Args:
        x: metres to the right of its middle.
        y: metres ahead of its middle.
        width: extent along x.
        length: extent along y.
        height: in the middle.
        spread: standard deviation as a share of the extents.

    """
    if abs(x) > width / 2 or abs(y) > length / 2:
        return 0.0
    sigma_x, sigma_y = width * spread, length * spread
    return height * math.exp(-((x / sigma_x) ** 2 + (y / sigma_y) ** 2) / 2)


def ground_solid(heights: Any, width: float, length: float, thickness: float) -> Any:
    """The closed mesh (``trimesh.Trimesh``) between a grid of heights and a plane ``thickness`` below the height 0.

    Raises:
        InvalidScenarioError: a height is random.

    """
    import trimesh  # slow to import

    if any(isinstance(value, Random) for row in heights for value in row):
        raise InvalidScenarioError(
            "the terrain of a Ground is random, but the shape of an object has to be fixed",
            help="give its parts fixed places and heights; param values make variants of them",
        )
    values = np.asarray(heights, dtype=np.float64)
    rows, columns = values.shape
    x, y = np.meshgrid(
        np.linspace(-width / 2, width / 2, columns), np.linspace(-length / 2, length / 2, rows)
    )
    above = np.column_stack([x.ravel(), y.ravel(), values.ravel()])
    below = np.column_stack([x.ravel(), y.ravel(), np.full(values.size, -float(thickness))])
    number = np.arange(values.size).reshape(rows, columns)
    a, b, c, d = (
        part.ravel() for part in (number[:-1, :-1], number[:-1, 1:], number[1:, 1:], number[1:, :-1])
    )
    top = np.concatenate([np.column_stack([a, b, c]), np.column_stack([a, c, d])])
    rim = np.concatenate([number[0, :-1], number[:-1, -1], number[-1, :0:-1], number[:0:-1, 0]])
    after, under = np.roll(rim, -1), values.size
    sides = np.concatenate(
        [np.column_stack([rim, rim + under, after]), np.column_stack([after, rim + under, after + under])]
    )
    faces = np.concatenate([top, top[:, ::-1] + under, sides])
    return trimesh.Trimesh(np.concatenate([above, below]), faces, process=False)
