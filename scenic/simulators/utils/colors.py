"""Colours of cars (section 1.6 of the driving specification)."""

import colorsys
import random
from collections.abc import Iterable, Sequence
from itertools import repeat
from typing import Any, Final, NamedTuple

import numpy as np

from scenic.graph.kinds import Kind
from scenic.graph.operation import Operation, always, by_lane
from scenic.runtime.ground.context import next_address
from scenic.runtime.instances.mutators import Mutator
from scenic.runtime.values.distributions import Discrete, Normal, Range
from scenic.runtime.values.values import apply, is_random

__all__ = ["Color", "ColorMutator", "NoisyColorDistribution"]

_DEVIATION: Final = 0.1
"""Standard deviation of hue, lightness and saturation of a car's colour."""


class Color(NamedTuple):
    """A colour with parts from 0 to 1."""

    r: float
    g: float
    b: float

    @staticmethod
    def withBytes(color: Any) -> "Color":
        """Return the colour of parts from 0 to 255."""
        return Color(*(part / 255 for part in color))

    @staticmethod
    def realToByte(color: Any) -> tuple[int, ...]:
        """Return the parts of a colour as integers from 0 to 255."""
        return tuple(round(255 * part) for part in color)

    @staticmethod
    def uniformColor() -> Any:
        """Return a colour whose parts are uniform and independent."""
        return _color(Range(0, 1), Range(0, 1), Range(0, 1))

    @staticmethod
    def defaultCarColor() -> Any:
        """Return the colour of a car: one of nine common ones, with noise."""
        return NoisyColorDistribution(Discrete(dict(_CAR_COLORS)))


def _color(*parts: Any) -> Any:
    if is_random(parts):
        next_address()  # as in `NoisyColorDistribution`
    return apply(_MADE, *parts)


def _made_together(*columns: list[Any]) -> list[Any]:
    return _colors(zip(*columns, strict=True))


def _colors(rows: Iterable[Sequence[float]]) -> list[Any]:
    """Return colours of rows of three parts, as `Color` does for each, without calling Python code for it."""
    return list(map(tuple.__new__, repeat(Color), rows))


_MADE: Final = Operation(
    "colour", always(Kind.OTHER), by_lane, "A colour of three parts.", python=Color, together=_made_together
)


_CAR_COLORS: Final = tuple(
    (Color.withBytes(parts), weight)
    for parts, weight in (
        ((248, 248, 248), 0.24),
        ((50, 50, 50), 0.19),
        ((188, 185, 183), 0.16),
        ((130, 130, 130), 0.15),
        ((194, 92, 85), 0.10),
        ((75, 119, 157), 0.07),
        ((197, 166, 134), 0.05),
        ((219, 191, 105), 0.02),
        ((68, 160, 135), 0.02),
    )
)


def NoisyColorDistribution(
    baseColor: object, hueNoise: object = None, lightnessNoise: object = None, saturationNoise: object = None
) -> Any:
    """Return a colour about ``baseColor``: hue, lightness and saturation shifted by independent normal draws and clamped to [0, 1]."""
    noise = [
        Normal(0, _DEVIATION) if part is None else part
        for part in (hueNoise, lightnessNoise, saturationNoise)
    ]
    values = (baseColor, *noise)
    if is_random(values):
        next_address()  # which a call of Python code took here: later draws of this place keep their numbers
    return apply(_SHIFTED, *values)


def _shifted(color: Any, hue: float, lightness: float, saturation: float) -> Color:
    h, l, s = colorsys.rgb_to_hls(*color)  # noqa: E741 - the names of the colour space
    parts = (_clamped(h + hue), _clamped(l + lightness), _clamped(s + saturation))
    return Color(*colorsys.hls_to_rgb(*parts))


def _shifted_together(
    colors: list[Any], hues: list[float], lightnesses: list[float], saturations: list[float]
) -> list[Any] | None:
    """Shift many colours as `_shifted` does: the formula is that of `colorsys.hls_to_rgb`, equal in every bit."""
    try:
        numbers = {color: number for number, color in enumerate(dict.fromkeys(colors))}
        hls_colors = np.array([colorsys.rgb_to_hls(*color) for color in numbers])
    except (TypeError, ValueError, ArithmeticError):
        return None
    bases = hls_colors[list(map(numbers.__getitem__, colors))]
    shifts = np.array([hues, lightnesses, saturations])
    h, l, s = np.clip(bases.T + shifts, 0.0, 1.0)  # noqa: E741
    most = np.where(l <= 0.5, l * (1.0 + s), l + s - l * s)
    least = 2.0 * l - most
    parts = []
    for hue in (h + 1 / 3, h, h - 1 / 3):
        turn = hue % 1.0
        rising = least + (most - least) * turn * 6.0
        falling = least + (most - least) * (2 / 3 - turn) * 6.0
        cases = [turn < 1 / 6, turn < 0.5, turn < 2 / 3]
        parts.append(np.where(s == 0.0, l, np.select(cases, [rising, most, falling], least)))
    return _colors(np.array(parts).T.tolist())


_SHIFTED: Final = Operation(
    "shifted colour",
    always(Kind.OTHER),
    by_lane,
    "A colour whose hue, lightness and saturation are shifted.",
    python=_shifted,
    together=_shifted_together,
)


def _clamped(part: float) -> float:
    return min(1.0, max(0.0, part))


class ColorMutator(Mutator):
    """Adds normal noise to the colour of mutated objects."""

    def appliedTo(self, obj: Any) -> tuple[Any, bool]:
        """Return the object with a changed colour."""
        scale = 0.05 * obj.mutationScale
        color = Color(*(_clamped(part + random.gauss(0, scale)) for part in obj.color))
        return obj._copyWith(color=color), True
