"""The library that reads and writes image files, which is optional."""

from types import ModuleType

from scenic.language.errors import Located
from scenic.language.extras import installation

__all__ = ["MissingLibraryError", "require_pillow"]


class MissingLibraryError(Located):
    """An output was asked for that needs a library which is not installed."""

    code = "SC604"


def require_pillow() -> ModuleType:
    """Return the library that writes images; raises ``MissingLibraryError`` with the way to get it."""
    try:
        import PIL.Image
    except ImportError as error:
        raise MissingLibraryError(
            "images need the library Pillow, which is not installed",
            help=f"install it: {installation('view')}",
        ) from error
    return PIL.Image
