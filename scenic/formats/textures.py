"""Textures of objects in pictures, by their property ``texture``: patterns, and images from files.

A pattern is computed from places in the object's own frame, in metres. Its name will do, or a mapping with ``pattern``, ``scale``
(metres) and ``color``, which the pattern has in turn with the object's own colour. An image is named by its file, or by a mapping
with ``image``, ``scale`` and ``projection``.
"""

import math
from collections.abc import Callable, Iterator, Mapping
from contextlib import contextmanager
from pathlib import Path
from typing import Any, Final

import numpy as np
import numpy.typing as npt

from scenic.dataclass import dataclass
from scenic.formats.image_textures import PROJECTIONS, ImageTexture, TextureError
from scenic.formats.texture_names import SUFFIXES, image_name
from scenic.runtime.geometry.meshes.embree import Singles

__all__ = ["PATTERNS", "ImageTexture", "Texture", "TextureError", "image_name", "placed_errors", "texture_of"]

_SCALE: Final = 0.25
_DARKER: Final = 0.55
"""By so much the second colour is darker if none is given, in sRGB."""
_SHIFT: Final = 0.37
"""Faces seldom lie at this part of a cell, where rounding would decide."""


def _stripes(places: Singles) -> Singles:
    return np.asarray(np.floor(places[:, 0]).astype(np.int32) & 1, np.float32)


def _noise(places: Singles) -> Singles:
    """Smooth noise in [0, 1]: values at whole places, hashed, and smooth between them; two octaves."""
    return np.asarray(
        _values(places) * np.float32(0.7) + _values(places * np.float32(2.7)) * np.float32(0.3), np.float32
    )


def _values(places: Singles) -> Singles:
    corner = np.floor(places)
    part = places - corner
    part *= part * (np.float32(3) - np.float32(2) * part)
    whole = corner.astype(np.int64)
    total = np.zeros(len(places), np.float32)
    for offset in np.ndindex(2, 2, 2):
        weight = np.prod(np.where(np.array(offset, bool), part, np.float32(1) - part), axis=1)
        total += weight * _hashed(whole + np.array(offset))
    return total


def _hashed(cells: npt.NDArray[np.int64]) -> Singles:
    """A number in [0, 1) for each cell ``(n, 3)``."""
    mixed = (
        cells.astype(np.uint64)
        * np.array([0x9E3779B97F4A7C15, 0xC2B2AE3D27D4EB4F, 0x165667B19E3779F9], np.uint64)
    ).sum(axis=1, dtype=np.uint64)
    mixed ^= mixed >> np.uint64(29)
    mixed *= np.uint64(0xBF58476D1CE4E5B9)
    mixed ^= mixed >> np.uint64(32)
    return np.asarray((mixed >> np.uint64(40)).astype(np.float32) / np.float32(1 << 24), np.float32)


PATTERNS: Final[Mapping[str, Callable[[Singles], Singles]]] = {
    "checker": lambda places: np.asarray(np.floor(places).astype(np.int32).sum(axis=1) & 1, np.float32),
    "stripes": _stripes,
    "noise": _noise,
}
"""The share of the second colour at places, in cells of size 1, by the name of the pattern."""


@dataclass(frozen=True, slots=True)
class Texture:
    """A pattern with the size of its cells (metres) and its second colour (sRGB)."""

    pattern: str
    scale: float
    color: tuple[float, float, float]

    def share(self, places: Singles) -> Singles:
        """The share of the second colour at places in the object's frame ``(n, 3)``, metres."""
        return PATTERNS[self.pattern](places / np.float32(self.scale) + np.float32(_SHIFT))


def texture_of(
    value: Any, color: tuple[float, ...], folder: Path | None = None
) -> Texture | ImageTexture | None:
    """Return the texture that a property describes, for an object of a colour; ``None`` for no texture.

    Args:
        value: the value of the property.
        color: of the object, sRGB.
        folder: where paths of images start; without it, images with relative paths are left out.

    Raises:
        TextureError: there is no such texture.

    """
    if value is None:
        return None
    name = image_name(value)
    if name is not None:
        return _image(value, name, folder)
    fields = dict(value) if isinstance(value, Mapping) else {"pattern": value}
    pattern, scale = fields.pop("pattern", None), fields.pop("scale", _SCALE)
    second = fields.pop("color", tuple(_DARKER * part for part in color[:3]))
    try:
        red, green, blue = (float(part) for part in second)
        fine = (
            pattern in PATTERNS
            and 0 < scale < math.inf
            and all(0 <= part <= 1 for part in (red, green, blue))
        )
    except (TypeError, ValueError):
        fine = False
    if fields or not fine:
        raise _none_such(value)
    return Texture(pattern, float(scale), (red, green, blue))


def _image(value: object, name: str, folder: Path | None) -> ImageTexture | None:
    fields = (
        {key: item for key, item in value.items() if key != "image"} if isinstance(value, Mapping) else {}
    )
    scale, projection = fields.pop("scale", None), fields.pop("projection", PROJECTIONS[0])
    try:
        fine = (scale is None or 0 < scale < math.inf) and projection in PROJECTIONS
    except TypeError:
        fine = False
    if fields or not fine:
        raise _none_such(value)
    if folder is None and not Path(name).is_absolute():
        return None
    path = Path(name) if folder is None else folder / name
    return ImageTexture(path, name, None if scale is None else float(scale), projection)


def _none_such(value: object) -> TextureError:
    return TextureError(
        f"{value!r} is no texture",
        help=f"give the name of a pattern ({', '.join(PATTERNS)}) or of an image ({', '.join(SUFFIXES)}), "
        "{'pattern': name, 'scale': metres, 'color': (red, green, blue)}, or "
        f"{{'image': name, 'scale': metres, 'projection': {' or '.join(map(repr, PROJECTIONS))}}}",
    )


@contextmanager
def placed_errors(scene: Any) -> Iterator[None]:
    """Gives errors about textures the place of the object in the program, where the scene knows it."""
    try:
        yield
    except TextureError as error:
        if error.thing is not None and hasattr(scene, "place"):
            number = next(k for k, thing in enumerate(scene.objects) if thing is error.thing)
            error.at(scene.place(number))
        raise
