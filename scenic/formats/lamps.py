"""Traffic lights and signs in pictures: what a workspace shows beside its objects, in the colours of a moment."""

from collections.abc import Mapping, Sequence
from functools import cache
from types import MappingProxyType
from typing import Any, Final

import numpy as np
import numpy.typing as npt

from scenic.formats.painted_solids import Appearance, Modeller
from scenic.formats.poses import Triple

__all__ = [
    "COLORS",
    "NO_COLORS",
    "color_numbers",
    "first_colors",
    "lamp_form",
    "light_colors",
    "shown_colors",
]

Bytes = npt.NDArray[np.uint8]

COLORS: Final[Mapping[str, Triple]] = MappingProxyType(
    {
        "off": (0.25, 0.25, 0.27),
        "red": (0.95, 0.1, 0.08),
        "yellow": (1.0, 0.8, 0.1),
        "green": (0.1, 0.85, 0.3),
    }
)
"""The colours of lights, by their names."""

NO_COLORS: Final[Mapping[str, str]] = MappingProxyType({})

_POST: Final = (0.3, 0.31, 0.33)
_HOUSING: Final = (0.08, 0.08, 0.09)
_SIGN_RED: Final = (0.78, 0.07, 0.1)
_WHITE: Final = (0.95, 0.95, 0.95)


def color_numbers(keys: Sequence[str], moments: Sequence[Mapping[str, str]]) -> Bytes:
    """Return the colours of lamps with keys in all moments, as numbers of `COLORS`, ``(moments, lamps)``."""
    names = list(COLORS)
    numbers = [[names.index(colors.get(key, "off")) for key in keys] for colors in moments]
    return np.array(numbers, dtype=np.uint8).reshape(len(moments), len(keys))


def first_colors(workspace: object, params: Mapping[str, object]) -> Mapping[str, str]:
    """Return the colours of a workspace's lights when a simulation of a scene with such parameters begins."""
    colors = getattr(workspace, "first_colors", None)
    return {} if colors is None else colors(params)


def shown_colors(scene: Any) -> Mapping[str, str]:
    """Return the colours of lights in a scene: the present ones, if it is that of a running simulation, else the first ones."""
    present: Mapping[str, str] | None = getattr(scene, "light_colors", None)
    return first_colors(scene.workspace, scene.params) if present is None else present


def light_colors(simulation: Any) -> Mapping[str, str]:
    """The colours of lights at the present step of a simulation, by their keys; none where nothing is known of lights."""
    workspace = simulation.scene.workspace
    if not hasattr(workspace, "light_colors") or not hasattr(simulation, "signalState"):
        return {}
    colors: Mapping[str, str] = workspace.light_colors(simulation)
    return colors


@cache
def lamp_form(name: str) -> Appearance:
    """Return the mesh of a lamp; traffic sees its side towards -Y."""
    model = Modeller()
    if name == "line":
        model.box((-1, -1, 0), (1, 1, 1))
        return model.appearance()
    top = 2.5 if name == "light" else 1.9
    model.tube((0, 0.05, 0), (0, 0.05, top), 0.05, _POST)
    if name == "light":
        model.box((-0.22, -0.1, 2.4), (0.22, 0.2, 3.6), _HOUSING)
        for height in (2.6, 3.0, 3.4):
            model.tube((0, -0.1, height), (0, -0.22, height), 0.17, sides=12)
    elif name == "stop":
        model.tube((0, 0, 2.25), (0, -0.03, 2.25), 0.45, _SIGN_RED, sides=8)
        model.box((-0.3, -0.05, 2.18), (0.3, -0.03, 2.32), _WHITE)
    else:
        for out, size, paint in ((0.0, 0.45, _SIGN_RED), (-0.02, 0.27, _WHITE)):
            corners = [(-size, 2.3 + 0.55 * size), (size, 2.3 + 0.55 * size), (0, 2.3 - 1.1 * size)]
            model.loft([[(x, y, z) for x, z in corners] for y in (out, out - 0.03)], paint)
    return model.appearance()
