"""Images of scenes as PNG files."""

import io
from types import ModuleType

import numpy as np
import numpy.typing as npt

from scenic.formats.instances import picture
from scenic.formats.render import SIZE, render
from scenic.formats.scenes import Scene
from scenic.language.errors import Located


class MissingLibraryError(Located):
    """An output was asked for that needs a library which is not installed."""

    code = "SC604"


def require_pillow() -> ModuleType:
    """The library that writes images; raises ``MissingLibraryError`` with the way to get it."""
    try:
        import PIL.Image
    except ImportError as error:
        raise MissingLibraryError(
            "images need the library Pillow, which is not installed",
            help="install it: pip install 'scenic-lang[view]'",
        ) from error
    return PIL.Image


def png(scene: Scene, size: tuple[int, int] = SIZE) -> bytes:
    """An image of the scene, seen from above the south-east, as the content of a PNG file.

    Raises ``MissingLibraryError`` if Pillow is not installed.
    """
    require_pillow()
    return encoded(render(picture([scene]), 0, size))


def encoded(pixels: npt.NDArray[np.uint8]) -> bytes:
    """Pixels, shape ``(height, width, 3)``, as the content of a PNG file."""
    stream = io.BytesIO()
    require_pillow().fromarray(pixels).save(stream, format="PNG")
    return stream.getvalue()
