"""Coloured areas that show what a workspace is, drawn under the objects of a scene."""

import numpy as np
from numpy.typing import NDArray

from scenic.dataclass import dataclass

__all__ = ["Patch"]


@dataclass(frozen=True, slots=True, eq=False)
class Patch:
    """A part of the ground with one colour; never changes, so that scenes share it.

    Attributes:
        color: red, green and blue from 0 to 1.
        vertices: its corners in the world, metres, ``(n, 3)``.
        faces: triangles, each three numbers of corners, ``(m, 3)``.
        layer: what is on top of others has a larger one, where they overlap.
        is_flat: whether it lies in the plane, and so wherever the ground of a picture is.

    """

    color: tuple[float, float, float]
    vertices: NDArray[np.float64]
    faces: NDArray[np.int64]
    layer: int
    is_flat: bool
