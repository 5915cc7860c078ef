"""Coloured areas that show what a workspace is, drawn under the objects of a scene."""

import numpy as np
from numpy.typing import NDArray

from scenic.dataclass import dataclass

__all__ = ["Lamp", "Patch"]


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


@dataclass(frozen=True, slots=True)
class Lamp:
    """A light or a sign that a workspace shows.

    Attributes:
        key: of what gives it its colour.
        form: ``light``, ``stop`` or ``yield``: a post that is seen by traffic; ``line``: a line on the ground.
        position: of the middle of its foot, metres.
        yaw: the direction of the traffic for which it stands, radians anticlockwise from north.
        size: across the traffic, along it, and upward, metres.

    """

    key: str
    form: str
    position: tuple[float, float, float]
    yaw: float
    size: tuple[float, float, float]
