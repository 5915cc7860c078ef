"""Uneven ground: its heights at the points of a grid, and the shape of the solid below them."""

from collections.abc import Sequence
from typing import Any, TypeAlias

import numpy as np

from scenic.runtime.elements.functions import distributionFunction
from scenic.runtime.geometry.meshes.mesh import Mesh
from scenic.runtime.shapes.shapes import MeshShape

__all__ = ["ground_shape", "heights_of", "hill_heights"]

Rows: TypeAlias = tuple[tuple[float, ...], ...]


@distributionFunction
def heights_of(terrain: Sequence[Any], width: float, length: float, columns: int, rows: int) -> Any:
    """The sum of the heights of all parts of a terrain at the points of a grid about the origin.

    Args:
        terrain: things with a method ``heightsAt(across, along)``, whose answers may be random values.
        width: extent along x, metres.
        length: extent along y, metres.
        columns: points along x.
        rows: points along y.

    Returns:
        Rows of heights in metres, from the corner with the least x and y; a random value if the terrain is random.

    """
    across = tuple(np.linspace(-width / 2, width / 2, columns).tolist())
    along = tuple(np.linspace(-length / 2, length / 2, rows).tolist())
    flat = ((0.0,) * columns,) * rows
    return _sum(flat, *(part.heightsAt(across, along) for part in terrain))


@distributionFunction
def _sum(*grids: Rows) -> Rows:
    total = np.sum([np.asarray(grid, dtype=np.float64) for grid in grids], axis=0)
    return tuple(map(tuple, total.tolist()))


@distributionFunction
def hill_heights(
    across: Sequence[float],
    along: Sequence[float],
    position: Any,
    heading: float,
    size: tuple[float, float, float],
    spread: float,
) -> Rows:
    """The heights of a hill (a Gaussian) at the points of a grid; 0 outside its rectangle.

    One call covers the whole grid, so that a random hill is one random value and not one for each point.

    Args:
        across: x of the points, metres.
        along: y of the points, metres.
        position: the middle of the hill.
        heading: its heading in radians.
        size: its width, its length, and its height in the middle, metres.
        spread: standard deviation as a share of width and length.

    Returns:
        Rows of heights in metres, one row for each y.

    """
    width, length, height = size
    dx, dy = np.meshgrid(np.subtract(across, position[0]), np.subtract(along, position[1]))
    x = dx * np.cos(heading) + dy * np.sin(heading)
    y = dy * np.cos(heading) - dx * np.sin(heading)
    profile = np.exp(-((x / (width * spread)) ** 2 + (y / (length * spread)) ** 2) / 2)
    inside = (np.abs(x) <= width / 2) & (np.abs(y) <= length / 2)
    return tuple(map(tuple, np.where(inside, height * profile, 0.0).tolist()))


@distributionFunction
def ground_shape(heights: object, width: float, length: float, thickness: float) -> MeshShape:
    """Return the shape of the solid between a grid of heights and a plane ``thickness`` below the height 0."""
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
    return MeshShape(Mesh(np.concatenate([above, below]), faces))
