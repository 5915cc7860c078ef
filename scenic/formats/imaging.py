"""The library that reads and writes image files, which is optional."""

from types import ModuleType

from scenic.language.errors import Located
from scenic.language.extras import needing

__all__ = ["MissingLibraryError", "require_pillow"]


class MissingLibraryError(Located):
    """An output was asked for that needs a library which is not installed."""

    code = "SC604"


def require_pillow() -> ModuleType:
    """Return the library that writes images; raises ``MissingLibraryError`` with the way to get it."""
    with needing("images need the library Pillow, which is not installed", "view", kind=MissingLibraryError):
        import PIL.Image
    return PIL.Image
