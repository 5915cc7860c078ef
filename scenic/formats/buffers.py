"""What the pixels of an image see first."""

from dataclasses import dataclass
from typing import TypeAlias

import numpy as np
import numpy.typing as npt

from scenic.formats.camera import Camera
from scenic.formats.instances import Array
from scenic.runtime.geometry.embree import RayScene, Singles

_Index: TypeAlias = slice | npt.NDArray[np.intp]


@dataclass(frozen=True, slots=True)
class Buffer:
    """An entry for each pixel, each array of shape ``(height, width)``.

    Attributes:
        triangle: the triangle seen, -1 where there is none.
        nearness: one over its distance along the camera's axis, per metre; 0 where there is none.
        second: weight of the triangle's second corner.
        third: weight of its third corner.

    """

    triangle: npt.NDArray[np.int32]
    nearness: Singles
    second: Singles
    third: Singles


class Lens:
    """Rays through an image of a size, from an eye given relative to the middle of the scene."""

    def __init__(self, camera: Camera, center: Array, size: tuple[int, int]) -> None:
        self.width, self.height = size
        self.eye = (camera.eye - center).astype(np.float32)
        self.pixel = 2 * camera.tangents[1] / self.height
        self._across = camera.right * camera.tangents[0]
        self._upward = camera.up * camera.tangents[1]
        self._ahead = camera.ahead

    def directions(self, x: npt.NDArray[np.float32], y: npt.NDArray[np.float32]) -> Singles:
        """Directions ``(..., 3)``, 1 long along the camera's axis, through places in pixels; x and y broadcast."""
        right = (2 * x / np.float32(self.width) - 1).astype(np.float32)
        up = (1 - 2 * y / np.float32(self.height)).astype(np.float32)
        result = np.empty((*np.broadcast_shapes(x.shape, y.shape), 3), np.float32)
        for axis in range(3):
            sideways = np.float32(self._across[axis]) * right + np.float32(self._ahead[axis])
            np.add(sideways, np.float32(self._upward[axis]) * up, out=result[..., axis])
        return result

    def through(self, pixels: npt.NDArray[np.intp]) -> Singles:
        """Directions ``(n, 3)`` through the middles of pixels, numbered row by row."""
        x = (pixels % self.width).astype(np.float32) + np.float32(0.5)
        y = (pixels // self.width).astype(np.float32) + np.float32(0.5)
        return self.directions(x, y)

    def cast(
        self, rays: RayScene, directions: Singles
    ) -> tuple[npt.NDArray[np.int32], Singles, Singles, Singles]:
        """What rays of directions ``(n, 3)`` see, the four values of a `Buffer`, ``(n,)`` each."""
        hits = rays.first_hits(np.broadcast_to(self.eye, directions.shape), directions)
        return hits.triangle, np.float32(1) / hits.distance, hits.second, hits.third


def seen(lens: Lens, rays: RayScene, *, exact: bool) -> Buffer:
    """What each pixel sees through its middle.

    Unless it must be exact, rays go through every other pixel of every other row; where all those around a pixel see one
    triangle, so does it, and its nearness, which is linear on a plane, is their mean. What is thinner than two pixels
    may then have gaps.
    """
    step = 1 if exact else 2
    x = np.arange(0, lens.width, step, dtype=np.float32) + np.float32(0.5)
    y = np.arange(0, lens.height, step, dtype=np.float32) + np.float32(0.5)
    directions = lens.directions(x, y[:, None])
    shape = directions.shape[:2]
    triangle, nearness, second, third = lens.cast(rays, directions.reshape(-1, 3))
    first = Buffer(
        triangle.reshape(shape), nearness.reshape(shape), second.reshape(shape), third.reshape(shape)
    )
    if exact:
        return first
    size = (lens.height, lens.width)
    result = Buffer(
        np.full(size, -2, np.int32),
        np.zeros(size, np.float32),
        np.zeros(size, np.float32),
        np.zeros(size, np.float32),
    )
    _put(result, (slice(None, None, 2), slice(None, None, 2)), first)
    _fill(result, (slice(1, -1, 2), slice(None, None, 2)), 0)
    _fill(result, (slice(None), slice(1, -1, 2)), 1)
    left = np.flatnonzero(result.triangle.reshape(-1) == -2)
    row, column = np.divmod(left, lens.width)
    _put(result, (row, column), Buffer(*lens.cast(rays, lens.through(left))))
    return result


def _put(into: Buffer, where: tuple[_Index, _Index], values: Buffer) -> None:
    into.triangle[where] = values.triangle
    into.nearness[where] = values.nearness
    into.second[where] = values.second
    into.third[where] = values.third


def _fill(into: Buffer, where: tuple[slice, slice], axis: int) -> None:
    """Give pixels between two others along an axis what both of those see, if it is the same."""
    rows, columns = where
    if axis == 0:
        before, after = (slice(0, -2, 2), columns), (slice(2, None, 2), columns)
    else:
        before, after = (rows, slice(0, -2, 2)), (rows, slice(2, None, 2))
    a, b = into.triangle[before], into.triangle[after]
    into.triangle[where] = np.where((a == b) & (a != -2), a, np.int32(-2))
    for plane in (into.nearness, into.second, into.third):
        plane[where] = np.float32(0.5) * (plane[before] + plane[after])
