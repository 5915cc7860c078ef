"""Surroundings in pictures of a scene: the sun, the sky and the ground, as the scene's parameters say.

``param lighting`` is a mapping with ``sun`` (azimuth and elevation in radians; azimuths as headings, anticlockwise from North),
``sunlight`` and ``skylight`` (factors of the usual strength) and ``exposure`` (in stops). ``param backdrop`` is one with ``ground``,
``horizon``, ``zenith`` (colours) and ``grid``. What they leave out is as usual; parameters of these names that are no mappings are
not meant for pictures.
"""

import math
from collections.abc import Callable, Mapping
from dataclasses import field, replace
from typing import Any, Final

import numpy as np

from scenic.dataclass import dataclass
from scenic.formats.mesh_instances import Array
from scenic.language.errors import Located

__all__ = ["USUAL", "Scenery", "SceneryError", "scenery_of"]

Color = tuple[float, float, float]

_SUN: Final = (-0.55, -0.33, 0.77)
"""Towards the sun: in the west-south-west."""


class SceneryError(Located):
    """A parameter for pictures that has no meaning."""

    code = "SC604"


@dataclass(frozen=True, slots=True)
class Scenery:
    """Sun, sky and ground of one picture; colours are sRGB.

    Attributes:
        sun: unit vector towards the sun, ``(3,)``.
        sunlight: strength of the sun, 1 as usual.
        skylight: strength of the light from sky and ground, 1 as usual.
        exposure: factor of all light.
        ground: colour of the ground.
        horizon: colour of the sky at the horizon.
        zenith: colour of the sky above.
        grid: whether there are lines on the ground.

    """

    sun: Array = field(default_factory=lambda: np.asarray(np.array(_SUN) / np.linalg.norm(_SUN)))
    sunlight: float = 1.0
    skylight: float = 1.0
    exposure: float = 1.0
    ground: Color = (0.80, 0.81, 0.83)
    horizon: Color = (0.90, 0.92, 0.95)
    zenith: Color = (0.74, 0.82, 0.91)
    grid: bool = True


USUAL: Final = Scenery()
"""The scenery of scenes that say nothing about it."""


def scenery_of(params: Mapping[str, object]) -> Scenery:
    """Return the scenery that a scene's parameters say.

    Raises:
        SceneryError: a value has no meaning, or there is no such key.

    """
    fields: dict[str, Any] = {}
    for name, readers in _READERS.items():
        parameter = params.get(name)
        if not isinstance(parameter, Mapping):
            continue
        for key, value in parameter.items():
            if key not in readers:
                raise SceneryError(
                    f"`param {name}` has no {key!r}",
                    help=f"its keys are {', '.join(readers)}; see docs/howto/cameras.md",
                )
            try:
                fields[key] = readers[key](value)
            except (TypeError, ValueError) as error:
                raise SceneryError(f"{key!r} of `param {name}` must be {error}, not {value!r}") from error
    return replace(USUAL, **fields) if fields else USUAL


def _sun(value: Any) -> Array:
    words = "an azimuth and an elevation above 0 and at most 90 degrees, in radians"
    try:
        azimuth, elevation = map(float, value)
    except (TypeError, ValueError):
        raise ValueError(words) from None
    if not (0 < elevation <= math.pi / 2 + 1e-9 and math.isfinite(azimuth)):
        raise ValueError(words)
    flat = math.cos(elevation)
    return np.array([-math.sin(azimuth) * flat, math.cos(azimuth) * flat, math.sin(elevation)])


def _strength(value: object) -> float:
    if isinstance(value, bool) or not (isinstance(value, int | float) and 0 <= value < math.inf):
        raise ValueError("a number from 0 on")
    return float(value)


def _exposure(value: object) -> float:
    if isinstance(value, bool) or not (isinstance(value, int | float) and abs(value) <= 16):
        raise ValueError("a number of stops from -16 to 16")
    return 2.0**value


def _color(value: Any) -> Color:
    words = "three numbers from 0 to 1"
    try:
        red, green, blue = (float(part) for part in value)
    except (TypeError, ValueError):
        raise ValueError(words) from None
    if not all(0 <= part <= 1 for part in (red, green, blue)):
        raise ValueError(words)
    return red, green, blue


def _truth(value: object) -> bool:
    if not isinstance(value, bool | np.bool_):
        raise ValueError("True or False")
    return bool(value)


_READERS: Final[Mapping[str, Mapping[str, Callable[[Any], Any]]]] = {
    "lighting": {"sun": _sun, "sunlight": _strength, "skylight": _strength, "exposure": _exposure},
    "backdrop": {"ground": _color, "horizon": _color, "zenith": _color, "grid": _truth},
}
"""Readers of the values of each parameter's keys."""
