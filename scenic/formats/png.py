"""Images of scenes as PNG files."""

import io
from dataclasses import replace
from typing import Final

import numpy as np
import numpy.typing as npt

from scenic.formats.camera import STANDARD, Outlook, framed, framing
from scenic.formats.imaging import require_pillow
from scenic.formats.mesh_instances import picture, resting
from scenic.formats.render import SIZE, render
from scenic.formats.scene_protocols import Scene
from scenic.formats.textures import placed_errors

_EFFORT: Final = 1
_RUNS: Final = 3
"""zlib's strategy for runs: at its lowest level it is both the quickest for such images and better than the usual one."""


def png(scene: Scene, size: tuple[int, int] = SIZE, outlook: Outlook = STANDARD) -> bytes:
    """Return an image of the scene, by default seen from above the south-east, as the content of a PNG file.

    Raises ``MissingLibraryError`` if Pillow is not installed.
    """
    require_pillow()
    scene_picture = picture([scene], ground=True)
    if any(scene_picture.grounds):
        scene_picture = replace(scene_picture, scenes=(resting(scene_picture.scenes[0]),))
    camera = framing(framed(scene, scene_picture.scenes[0], outlook), size[0] / size[1], outlook)
    with placed_errors(scene):
        return encoded(render(scene_picture, 0, size, camera=camera))


def encoded(pixels: npt.NDArray[np.uint8] | npt.NDArray[np.uint16]) -> bytes:
    """Return pixels as the content of a PNG file: colours ``(height, width, 3)``, or numbers ``(height, width)``."""
    stream = io.BytesIO()
    require_pillow().fromarray(pixels).save(stream, format="PNG", compress_level=_EFFORT, compress_type=_RUNS)
    return stream.getvalue()
