"""Drawings of where objects may be: boxes that analysis leaves, and places of sampled scenes, from above and from the side."""

import io
from collections.abc import Iterator, Sequence
from html import escape
from typing import Final

import numpy as np
from numpy.typing import NDArray

from scenic.dataclass import dataclass

__all__ = ["Whereabouts", "png", "svg"]

_PANEL: Final = 480
"""Pixels across one of the two drawings."""

_BORDER: Final = 40

_COLOURS: Final = ("#1f77b4", "#d62728", "#2ca02c", "#9467bd", "#ff7f0e", "#8c564b", "#e377c2", "#17becf")

_VIEWS: Final = (("from above", 0, 1), ("from the side", 0, 2))
"""Names of drawings, and which coordinates they show."""


@dataclass(frozen=True, slots=True)
class Whereabouts:
    """The possible positions of an object.

    Attributes:
        name: what it is called.
        lower: least corners ``(m, 3)`` of boxes, one of which its position lies in.
        upper: greatest corners, likewise.
        seen: positions ``(n, 3)`` in scenes that were sampled.

    """

    name: str
    lower: NDArray[np.float64]
    upper: NDArray[np.float64]
    seen: NDArray[np.float64]


@dataclass(frozen=True, slots=True)
class _Box:
    left: float
    top: float
    right: float
    bottom: float
    colour: str


@dataclass(frozen=True, slots=True)
class _Dot:
    x: float
    y: float
    colour: str


@dataclass(frozen=True, slots=True)
class _Word:
    x: float
    y: float
    text: str
    colour: str = "#000000"


_Mark = _Box | _Dot | _Word


def svg(places: Sequence[Whereabouts]) -> str:
    """Return the drawing as SVG; empty where there are no objects."""
    if not places:
        return ""
    width, height = _size(places)
    parts = []
    for mark in _marks(places):
        if isinstance(mark, _Box):
            parts.append(
                f'<rect x="{mark.left:.1f}" y="{mark.top:.1f}" width="{mark.right - mark.left:.1f}" '
                f'height="{mark.bottom - mark.top:.1f}" fill="{mark.colour}" fill-opacity="0.12" stroke="{mark.colour}"/>'
            )
        elif isinstance(mark, _Dot):
            parts.append(f'<circle cx="{mark.x:.1f}" cy="{mark.y:.1f}" r="1.5" fill="{mark.colour}"/>')
        else:
            parts.append(
                f'<text x="{mark.x:.1f}" y="{mark.y:.1f}" font-family="sans-serif" font-size="12" '
                f'fill="{mark.colour}">{escape(mark.text)}</text>'
            )
    return f'<svg xmlns="http://www.w3.org/2000/svg" width="{width}" height="{height}">{"".join(parts)}</svg>'


def png(places: Sequence[Whereabouts]) -> bytes:
    """Return the drawing as the content of a PNG file; raises `MissingLibraryError` if Pillow is not installed."""
    from scenic.formats.imaging import require_pillow

    image_library = require_pillow()
    from PIL import ImageDraw

    image = image_library.new("RGB", _size(places), "white")
    draw = ImageDraw.Draw(image, "RGBA")
    for mark in _marks(places):
        if isinstance(mark, _Box):
            draw.rectangle(
                (mark.left, mark.top, mark.right, mark.bottom), fill=f"{mark.colour}1f", outline=mark.colour
            )
        elif isinstance(mark, _Dot):
            draw.ellipse((mark.x - 1.5, mark.y - 1.5, mark.x + 1.5, mark.y + 1.5), fill=mark.colour)
        else:
            draw.text((mark.x, mark.y - 10), mark.text, fill=mark.colour)
    stream = io.BytesIO()
    image.save(stream, format="PNG")
    return stream.getvalue()


def _size(places: Sequence[Whereabouts]) -> tuple[int, int]:
    return len(_VIEWS) * (_PANEL + 2 * _BORDER), _PANEL + 2 * _BORDER + 16 * -(-len(places) // 4)


def _marks(places: Sequence[Whereabouts]) -> Iterator[_Mark]:
    """Yield the marks to draw, in order."""
    parts = [part for item in places for part in (item.lower, item.upper, item.seen)]
    corners = np.concatenate([np.empty((0, 3)), *parts])
    finite_corners = np.where(np.isfinite(corners), corners, np.nan)
    least = np.array([np.nanmin(column) if np.isfinite(column).any() else 0.0 for column in finite_corners.T])
    most = np.array([np.nanmax(column) if np.isfinite(column).any() else 0.0 for column in finite_corners.T])
    scale = _PANEL / max(float((most - least).max()), 1.0)
    middle = (least + most) / 2
    for number, (title, across, up) in enumerate(_VIEWS):
        x0 = number * (_PANEL + 2 * _BORDER) + _BORDER + _PANEL / 2
        y0 = _BORDER + _PANEL / 2

        def right(values: NDArray[np.float64], x0: float = x0, axis: int = across) -> list[float]:
            shown = x0 + (values[:, axis] - middle[axis]) * scale
            return list(np.clip(shown, x0 - _PANEL / 2 - 4, x0 + _PANEL / 2 + 4))

        def down(values: NDArray[np.float64], y0: float = y0, axis: int = up) -> list[float]:
            shown = y0 - (values[:, axis] - middle[axis]) * scale
            return list(np.clip(shown, y0 - _PANEL / 2 - 4, y0 + _PANEL / 2 + 4))

        letters = "xyz"
        yield _Word(
            x0 - _PANEL / 2,
            _BORDER - 14,
            f"{title}: {letters[across]} {least[across]:.4g} to {most[across]:.4g}, "
            f"{letters[up]} {least[up]:.4g} to {most[up]:.4g}",
        )
        for place, item in enumerate(places):
            colour = _COLOURS[place % len(_COLOURS)]
            sides = (right(item.lower), down(item.upper), right(item.upper), down(item.lower))
            for left, top, end, bottom in zip(*sides, strict=True):
                yield _Box(left, top, end, bottom, colour)
            for x, y in zip(right(item.seen), down(item.seen), strict=True):
                yield _Dot(x, y, colour)
    for place, item in enumerate(places):
        row, column = divmod(place, 4)
        yield _Word(
            _BORDER + column * (_PANEL + _BORDER) / 2,
            _PANEL + 2 * _BORDER + 16 * row + 8,
            item.name,
            _COLOURS[place % len(_COLOURS)],
        )
