"""Patterns on objects in pictures, by their property ``texture``: computed from places in the object's own frame, in metres.

A texture is the name of a pattern, or a mapping with ``pattern``, ``scale`` (metres) and ``color``, which the pattern has in turn with
the object's own colour.
"""

import math
from collections.abc import Callable, Mapping
from typing import Any, Final

import numpy as np
import numpy.typing as npt

from scenic.dataclass import dataclass
from scenic.language.errors import Located
from scenic.runtime.geometry.embree import Singles

__all__ = ["PATTERNS", "Texture", "TextureError", "texture_of"]

_SCALE: Final = 0.25
_DARKER: Final = 0.55
"""By so much the second colour is darker if none is given, in sRGB."""
_SHIFT: Final = 0.37
"""Faces seldom lie at this part of a cell, where rounding would decide."""


class TextureError(Located):
    """A texture that there is not."""

    code = "SC604"


def _checker(places: Singles) -> Singles:
    return np.asarray(np.floor(places).astype(np.int32).sum(axis=1) & 1, np.float32)


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
    "checker": _checker,
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


def texture_of(value: Any, color: tuple[float, ...]) -> Texture | None:
    """The texture that a property says, of an object of a colour; ``None`` for none.

    Raises:
        TextureError: there is no such texture.

    """
    if value is None:
        return None
    given = dict(value) if isinstance(value, Mapping) else {"pattern": value}
    pattern, scale = given.pop("pattern", None), given.pop("scale", _SCALE)
    second = given.pop("color", tuple(_DARKER * part for part in color[:3]))
    try:
        red, green, blue = (float(part) for part in second)
        fine = (
            pattern in PATTERNS
            and 0 < scale < math.inf
            and all(0 <= part <= 1 for part in (red, green, blue))
        )
    except (TypeError, ValueError):
        fine = False
    if given or not fine:
        raise TextureError(
            f"{value!r} is no texture",
            help=f"give the name of a pattern ({', '.join(PATTERNS)}), or "
            "{'pattern': name, 'scale': metres, 'color': (red, green, blue)}",
        )
    return Texture(pattern, float(scale), (red, green, blue))
