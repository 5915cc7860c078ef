"""Names of image files in the property ``texture`` of objects; checks of programs need these without reading images."""

from collections.abc import Mapping
from pathlib import Path
from typing import Final

__all__ = ["SUFFIXES", "image_name", "is_image_name"]

SUFFIXES: Final = (".png", ".jpg", ".jpeg")
"""Ends of the names of files that are textures."""


def is_image_name(text: str) -> bool:
    """Return whether a texture given as text is the name of an image file, not of a pattern."""
    return text.lower().endswith(SUFFIXES)


def image_name(value: object) -> str | None:
    """Return the image file that a texture names; ``None`` for other textures."""
    if isinstance(value, Mapping):
        value = value.get("image")
        return str(value) if isinstance(value, str | Path) else None
    is_image = isinstance(value, Path) or (isinstance(value, str) and is_image_name(value))
    return str(value) if is_image else None
