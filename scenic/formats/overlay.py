"""Previews of labels: an image with the mask, the box and the name of every object that it shows."""

from typing import Final

import numpy as np
import numpy.typing as npt

from scenic.formats.imaging import require_pillow
from scenic.formats.labels import Observation
from scenic.formats.mesh_instances import PALETTE

__all__ = ["overlay"]

_TINT: Final = 0.4
"""Share of a mask's own colour in the picture."""


def overlay(found: Observation) -> npt.NDArray[np.uint8]:
    """Return the colours that a camera sees, with the labels drawn into them, ``(height, width, 3)``.

    Each object that has pixels has a colour of its own: its mask is tinted with it, its box is an outline of it, and beside
    that stand its variable or class and the part of it that is hidden.
    """
    pillow = require_pillow()
    import PIL.ImageDraw

    assert found.rgb is not None
    pixels = found.rgb.copy()
    visible_labels = [label for label in found.labels if label.box is not None]
    colors = {label.index: 255 * np.array(PALETTE[label.index % len(PALETTE)]) for label in visible_labels}
    for label in visible_labels:
        mask = found.mask(label)
        pixels[mask] = ((1 - _TINT) * pixels[mask] + _TINT * colors[label.index]).astype(np.uint8)
    image = pillow.fromarray(pixels)
    draw = PIL.ImageDraw.Draw(image)
    for label in visible_labels:
        assert label.box is not None
        left, top = label.box.left, label.box.top
        color = tuple(int(part) for part in colors[label.index])
        draw.rectangle((left, top, left + label.box.width - 1, top + label.box.height - 1), outline=color)
        words = label.instance.label + (f", {label.occluded:.0%} hidden" if label.occluded else "")
        # Above the box where there is room.
        _, _, right, bottom = draw.textbbox((0, 0), words)
        place = min(left, max(0, image.width - int(right))), top - bottom if top >= bottom else top + 1
        draw.text(place, words, fill=color, stroke_width=1, stroke_fill=(0, 0, 0))
    return np.asarray(image)
