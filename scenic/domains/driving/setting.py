"""The setting of a driving program: its mode, its map, and which objects are near each other."""

from collections.abc import Iterable, Mapping
from typing import Any

from scenic.domains.driving.roads import Network
from scenic.domains.driving.signals import LightTimes, fixed_colors
from scenic.formats.opendrive.xml_tree import MapError
from scenic.language.errors import InvalidScenarioError
from scenic.language.spans import Span
from scenic.runtime.ground.context import current
from scenic.runtime.instances.objects import OrientedPoint
from scenic.runtime.values.lazy import Lazy
from scenic.runtime.values.values import is_random, operate, to_vector, vector

__all__ = ["SettingError", "check_lights", "is2DMode", "nearer", "network_of_program", "standing"]


def is2DMode() -> bool:
    """Return whether the program is compiled in the 2D mode."""
    context = current.get()
    return context is not None and context.mode_2d


class SettingError(InvalidScenarioError, RuntimeError):
    """A driving program that has no usable map, or whose mode does not fit it; placed at the parameter to be changed."""

    code = "SC620"


def network_of_program(parameters: Any) -> Network:
    """The network of the map that a program's parameters name.

    Raises:
        MapError: the map cannot be read.
        SettingError: there is no map, or the mode does not fit.

    """
    if "map" not in parameters:
        raise _wrong(
            "map",
            "the driving model needs a map",
            "set `param map = localPath('town.xodr')` before the `model` statement, or give `--param map=FILE`",
        )
    flat = bool(parameters["use2DMap"])
    if is2DMode() and not flat:
        raise _wrong("use2DMap", "in the 2D mode a map is flat", "leave `use2DMap` out, or set it to True")
    try:
        return Network.fromFile(parameters["map"], elevated=not flat, **dict(parameters["map_options"]))
    except MapError as error:
        # The mistake is in the map; who only sees that needs to know who wants it.
        error.help = f"{error.help or 'mend the map'}; {_wanted_by('map')} names it"
        raise
    except TypeError as error:
        name = "map_options" if parameters["map_options"] else "map"
        raise _wrong(name, str(error), "see docs/reference/driving.md for what it takes") from error
    except (OSError, ValueError) as error:
        raise _wrong(
            "map",
            str(error),
            "paths are relative to the working directory; `localPath(...)` makes them relative to the program",
        ) from error


def check_lights(parameters: Any, network: Network) -> None:
    """Check the parameter ``traffic_lights``, as far as it is not random.

    Raises:
        SettingError: an entry is unknown or no time, or names a light that the map does not have.

    """
    lights = parameters["traffic_lights"]
    if is_random(lights) or not lights:
        return
    if not isinstance(lights, Mapping):
        raise _wrong("traffic_lights", f"traffic_lights is {lights!r}, not a dictionary", _LIGHTS)
    definite = {name: value for name, value in lights.items() if not is_random(value)}
    try:
        states = LightTimes.of(definite).states or {}
        if not isinstance(states, Mapping):
            raise InvalidScenarioError("traffic_lights: states must be a dictionary", help=_LIGHTS)
        fixed_colors(network, {key: color for key, color in states.items() if not is_random(color)})
    except InvalidScenarioError as error:
        raise _wrong("traffic_lights", error.message, error.help or _LIGHTS) from error


_LIGHTS = "write {'green': 10, 'yellow': 3, 'all_red': 1.5, 'offset': 0, 'states': {'12': 'red'}}, or some of these entries"


def _wanted_by(parameter: str) -> str:
    """Return words for the place where the user sets a parameter."""
    context = current.get()
    if context is not None and parameter in context.parameters.given:
        return f"`--param {parameter}=...` (or `params`)"
    place = None if context is None else context.parameters.places.get(parameter)
    span = None if place is None else place[0]
    return f"`param {parameter}`" if span is None else f"`param {parameter}` in line {span.line}"


def _wrong(parameter: str, message: str, help: str) -> SettingError:
    """Return an error where a parameter is set: outside of the program, by a statement of it, else by its `model` statement."""
    error = SettingError(message, help=help)
    context = current.get()
    if context is None:
        return error
    if parameter in context.parameters.given:
        # The program has no line that would have to change.
        error.message = f"{message} (given as `--param {parameter}=...`, or in `params`)"
        return error.at((Span(1, 0, 1, 0), f"--param {parameter}"))
    return error.at(context.parameters.places.get(parameter, context.parameters.model_place))


def standing(spot: Any) -> Lazy:
    """Return the position of what stands on a spot: upright on a point, inclined as the ground is on an oriented one."""

    def place(thing: Any) -> Any:
        gap = vector(0, 0, operate("divide", thing.contactTolerance, 2))
        offset = operate("subtract", gap, to_vector(thing.baseOffset))
        if isinstance(spot, OrientedPoint):
            offset = operate("rotate", spot.orientation, offset)
        return operate("add", spot.position, offset)

    return Lazy(frozenset({"baseOffset", "contactTolerance"}), place)


def nearer(objects: Iterable[object], agent: Any, threshold: float, kind: Any) -> list[Any]:
    """Return the objects of a class, others than an agent, whose centres are nearer to it than a threshold in metres."""
    x, y, z = agent.position
    limit = threshold * threshold
    nearby: list[Any] = []
    for other in objects:
        if other is agent or not isinstance(other, kind):
            continue
        a, b, c = other.position
        a, b, c = a - x, b - y, c - z
        if a * a + b * b + c * c < limit:
            nearby.append(other)
    return nearby
