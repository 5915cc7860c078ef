"""Textures from image files: colours of objects that pictures show, at places on their surfaces.

An image is repeated in both directions. Where one of its pixels is smaller than a pixel of the picture, a smaller copy of the image
is used (mip mapping, L. Williams, "Pyramidal Parametrics", SIGGRAPH 1983).
"""

import math
import os
from collections.abc import Sequence
from functools import cached_property, lru_cache
from pathlib import Path
from typing import Any, Final

import numpy as np
import numpy.typing as npt

from scenic.dataclass import dataclass
from scenic.formats.colors import decoded, encoded
from scenic.formats.imaging import require_pillow
from scenic.formats.mesh_files import digest_of
from scenic.language.errors import Located
from scenic.runtime.geometry.meshes.embree import Singles

__all__ = ["PROJECTIONS", "ImageTexture", "TextureError"]

PROJECTIONS: Final = ("mesh", "box", "planar")
"""Ways of an image onto a surface: by the mesh's own coordinates, from six sides, or from above."""

_MOST: Final = 2048
"""Pixels of a side of a texture that are kept; larger images are made smaller."""

_SIDES: Final = ((1, 2), (0, 2), (0, 1))
"""The axes across and up on faces that look along x, y and z."""


class TextureError(Located):
    """A texture that there is not."""

    code = "SC613"
    thing: Any = None
    """The object of the scene that has it, where that is known."""


@dataclass(frozen=True, slots=True)
class ImageTexture:
    """An image file on an object.

    Attributes:
        path: the file.
        name: the file as the program names it.
        scale: metres that the width of the image covers; the object's largest side if ``None``.
        projection: of `PROJECTIONS`; a mesh without coordinates of its own takes ``box``.

    """

    path: Path
    name: str
    scale: float | None
    projection: str

    def image(self) -> "_Image":
        """Return the pixels; raises `TextureError` where the file cannot be read."""
        try:
            status = self.path.stat()
        except OSError as error:
            raise TextureError(
                f"cannot read the texture '{self.name}': {(error.strerror or str(error)).lower()}",
                help=f"paths of textures start from the folder of the program; this one is '{self.path}'",
            ) from error
        return _read(str(self.path), self.name, status.st_mtime_ns, status.st_size)

    def digest(self) -> str:
        """Return the SHA-256 digest of the file."""
        return self.image().digest

    def projected(self, places: Singles, normals: Singles, size: Sequence[float]) -> tuple[Singles, float]:
        """Return coordinates ``(n, 2)`` on the image, in which it is 1 wide and high, and how many of them a metre is.

        Args:
            places: places in the object's frame, metres, ``(n, 3)``.
            normals: directions of the surface there, in the same frame, ``(n, 3)``.
            size: width, length and height of the object.

        """
        scale = max(size) if self.scale is None else self.scale
        if self.projection == "planar":
            axis = np.full(len(places), 2)
        else:
            axis = np.abs(normals).argmax(axis=1)
        across, up = np.array(_SIDES)[axis].T
        rows = np.arange(len(places))
        away = normals[rows, axis] > 0
        # Seen from outside, nothing is mirrored: letters on the image can be read on all sides.
        is_mirrored = np.where(axis == 0, ~away, np.where(axis == 1, away, False))
        is_flipped = (axis == 2) & ~away & (self.projection != "planar")
        u = places[rows, across] * np.where(is_mirrored, -1, 1)
        v = places[rows, up] * np.where(is_flipped, -1, 1)
        coordinates = np.stack([u, v * self.image().aspect], axis=1) / scale + 0.5
        return coordinates.astype(np.float32), 1 / scale

    def colors(self, own: Singles, coordinates: Singles, blur: Singles) -> Singles:
        """Return linear colours ``(3, n)``; the object's own colour shows where the image is transparent.

        Args:
            own: the object's colour, linear, ``(3,)``.
            coordinates: see `projected`.
            blur: widths of the picture's pixels in coordinates, ``(n,)``.

        """
        samples = self.image().at(coordinates, blur)
        alpha = samples[:, 3:]
        return np.asarray((samples[:, :3] + (1 - alpha) * own).T, np.float32)


class _Image:
    """Pixels of an image and its smaller copies: sRGB and opacity, colours weighed by it, ``(height, width, 4)`` each."""

    def __init__(self, pixels: npt.NDArray[np.uint8], digest: str) -> None:
        self.digest: Final = digest
        self._pixels = pixels
        self.aspect: Final = pixels.shape[1] / pixels.shape[0]

    @cached_property
    def _levels(self) -> list[npt.NDArray[np.uint8]]:
        alpha = self._pixels[..., 3:].astype(np.float32) / np.float32(255)
        light = np.concatenate([decoded(self._pixels[..., :3]) * alpha, alpha], axis=2)
        levels = [_packed(light)]
        while max(light.shape[:2]) > 1:
            light = np.pad(light, [(0, light.shape[0] % 2), (0, light.shape[1] % 2), (0, 0)], mode="edge")
            light = (light[::2, ::2] + light[1::2, ::2] + light[::2, 1::2] + light[1::2, 1::2]) / 4
            levels.append(_packed(light))
        return levels

    def at(self, coordinates: Singles, blur: Singles) -> Singles:
        """Return linear colours, weighed by opacity, and opacity ``(n, 4)`` at coordinates ``(n, 2)``."""
        height, width = self._pixels.shape[:2]
        covered = np.maximum(blur * np.float32(max(width, height)), np.float32(1e-6))
        level = np.clip(np.rint(np.log2(covered)), 0, len(self._levels) - 1).astype(np.intp)
        result = np.empty((len(coordinates), 4), np.float32)
        for number in np.unique(level):
            mine = np.flatnonzero(level == number)
            result[mine] = _between(self._levels[number], coordinates[mine])
        return result


def _packed(light: Singles) -> npt.NDArray[np.uint8]:
    opacity = np.rint(light[..., 3:] * 255).astype(np.uint8)
    return np.concatenate([encoded(light[..., :3]), opacity], axis=2)


def _between(pixels: npt.NDArray[np.uint8], coordinates: Singles) -> Singles:
    """Interpolate linear colours and opacity between pixels, by the four nearest; ``(n, 4)``."""
    height, width = pixels.shape[:2]
    # Coordinates go up, rows go down. Whole numbers apart, they mean the same place.
    part = coordinates.astype(np.float64) % 1
    column, row = part[:, 0] * width - 0.5, (1 - part[:, 1]) * height - 0.5
    left, top = np.floor(column).astype(np.intp), np.floor(row).astype(np.intp)
    across, down = (column - left).astype(np.float32), (row - top).astype(np.float32)
    result = np.zeros((len(coordinates), 4), np.float32)
    for x, y in ((0, 0), (1, 0), (0, 1), (1, 1)):
        weight = (across if x else 1 - across) * (down if y else 1 - down)
        texels = pixels[(top + y) % height, (left + x) % width]
        result[:, :3] += decoded(texels[:, :3]) * weight[:, None]
        result[:, 3] += texels[:, 3] * weight / np.float32(255)
    return result


@lru_cache(maxsize=32)
def _read(path: str, name: str, _stamp: int, _length: int) -> _Image:
    """Return the image in a file that has not changed since."""
    pillow: Any = require_pillow()
    try:
        with pillow.open(path) as file:
            image = file.convert("RGBA")
    except (OSError, ValueError, SyntaxError, pillow.DecompressionBombError) as error:
        reason = str(error).replace(path, os.path.basename(path))
        raise TextureError(
            f"cannot read the texture '{name}': {reason}", help="give an image in the format PNG or JPEG"
        ) from error
    longest = max(image.size)
    if longest > _MOST:
        size = [max(1, math.floor(side * _MOST / longest)) for side in image.size]
        image = image.resize(size, pillow.Resampling.BOX)
    return _Image(np.asarray(image), digest_of(Path(path)))
