"""Options that several commands share, and how their values are read."""

import json
import math
import os
import re
from collections.abc import Callable, Mapping
from types import MappingProxyType
from typing import Any, Final, TypeVar

import click

__all__ = [
    "image_size_option",
    "named_values",
    "no_cache_option",
    "outlook_option",
    "parameter_value",
    "program_options",
    "seconds",
    "simulator_option",
    "sobol_option",
    "timestep_option",
]

_Command = TypeVar("_Command", bound=Callable[..., Any])

_INTEGER: Final = re.compile(r"[+-]?\d+")
_REAL: Final = re.compile(r"[+-]?(\d+\.?\d*|\.\d+)([eE][+-]?\d+)?")
_MOST_PIXELS: Final = 16384
_WORDS: Final = MappingProxyType({"true": True, "True": True, "false": False, "False": False})


def parameter_value(text: str) -> int | float | bool | str:
    """A parameter's value as it is meant: an integer, a real number, true or false, or else text.

    Text that would be read as one of these can be quoted as in JSON: ``"5"``.
    """
    if text in _WORDS:
        return _WORDS[text]
    if _INTEGER.fullmatch(text) and len(text) < 1000:
        return int(text)
    if _REAL.fullmatch(text):
        return float(text)
    if len(text) >= 2 and text[0] == text[-1] == '"':
        try:
            value = json.loads(text)
        except ValueError:
            return text
        if isinstance(value, str):
            return value
    return text


def named_values(_context: click.Context, _option: click.Parameter, given: tuple[str, ...]) -> dict[str, Any]:
    """The values of ``NAME=VALUE`` by name, given repeatedly: the callback of such an option."""
    parameters = {}
    for item in given:
        name, equals, value = item.partition("=")
        if not equals or not name:
            raise click.BadParameter(f"{item!r} is not of the form NAME=VALUE")
        parameters[name] = parameter_value(value)
    return parameters


def seconds(_context: click.Context, _option: click.Parameter, given: float | None) -> float | None:
    if given is not None and not (math.isfinite(given) and given > 0):
        raise click.BadParameter("the time must be a positive number of seconds")
    return given


def image_size_option(
    _context: click.Context, _option: click.Parameter, given: str | None
) -> tuple[int, int] | None:
    """Columns and rows of an image."""
    if given is None:
        return None
    match = re.fullmatch(r"(\d{1,5})[xX](\d{1,5})", given)
    if match is None or not all(1 <= int(part) <= _MOST_PIXELS for part in match.groups()):
        raise click.BadParameter(
            f"{given!r} is not of the form WIDTHxHEIGHT, in pixels up to {_MOST_PIXELS}: 640x480"
        )
    return int(match[1]), int(match[2])


def outlook_option(
    _context: click.Context, _option: click.Parameter, given: str | None
) -> Mapping[str, float]:
    """Azimuth and elevation of a camera, as an `Outlook` takes them."""
    if given is None:
        return {}
    if given == "above":
        return {"azimuth": 0.0, "elevation": 90.0}
    try:
        azimuth, elevation = (float(part) for part in given.split(","))
    except ValueError:
        azimuth = elevation = math.nan
    if not (math.isfinite(azimuth) and -89.9 <= elevation <= 90):
        raise click.BadParameter(
            f"{given!r} is neither 'above' nor AZIMUTH,ELEVATION in degrees, such as -35,33"
        )
    return {"azimuth": azimuth, "elevation": elevation}


def _without_store(_context: click.Context, _parameter: click.Parameter, given: bool) -> None:
    # Workers inherit the environment.
    if given:
        os.environ["SCENIC_CACHE"] = "off"


no_cache_option = click.option(
    "--no-cache",
    is_flag=True,
    expose_value=False,
    callback=_without_store,
    help="Neither read nor keep on disk what is computed of meshes.",
)


sobol_option = click.option(
    "--sobol",
    is_flag=True,
    help="Spread scenes, and what happens in them, evenly: rows of Sobol's sequence rather than random points.",
)


simulator_option = click.option(
    "--simulator",
    metavar="NAME",
    help="kinematic, mujoco, newtonian, dummy, or MODULE:CLASS.  [default: the program's, else kinematic]",
)
timestep_option = click.option(
    "--timestep",
    metavar="T",
    type=float,
    callback=seconds,
    help="Seconds in a step.  [default: the simulator's]",
)


def program_options(command: _Command) -> _Command:
    """What is asked of a program, the same by all commands that run one."""
    for option in (
        no_cache_option,
        click.option("--2d", "mode_2d", is_flag=True, help="Use the 2D compatibility mode."),
        click.option("--model", metavar="MODULE", help="A world model to use in place of the program's."),
        click.option(
            "--scenario", metavar="NAME", help="Which scenario of the file, where it defines several."
        ),
        click.option(
            "-p",
            "--param",
            "parameters",
            metavar="NAME=VALUE",
            multiple=True,
            callback=named_values,
            help="A value for a global parameter: a number, true, false, or text. Repeatable.",
        ),
    ):
        command = option(command)
    return command
