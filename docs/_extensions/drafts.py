"""Drafts of the documentation, which are enough to check it: films have few images, and pictures are small."""

import os
from typing import Final

__all__ = ["IS_DRAFT", "draft_size"]

IS_DRAFT: Final = bool(os.environ.get("SCENIC_DOCS_DRAFT"))
"""True where the environment requests a draft."""


def draft_size(size: tuple[int, int]) -> tuple[int, int]:
    """Return the size of a picture, a quarter in each direction in a draft."""
    return (size[0] // 4, size[1] // 4) if IS_DRAFT else size
