"""The setting of a driving program: its mode, its map, and which objects are near each other."""

from typing import Any

from scenic.domains.driving.roads import Network
from scenic.runtime.program.builtins import running_simulation
from scenic.runtime.program.context import current

__all__ = ["is2DMode", "nearer", "network_of_program"]


def is2DMode() -> bool:
    """Whether the program is compiled in the 2D mode."""
    context = current.get()
    return context is not None and context.mode_2d


def network_of_program(parameters: Any) -> Network:
    """The network of the map that a program's parameters name.

    Raises:
        RuntimeError: if there is no map, or the mode does not fit.

    """
    if "map" not in parameters:
        raise RuntimeError(
            "the driving model needs a map: set `param map = localPath('town.xodr')` before the `model` statement, "
            "or give `--param map FILE`"
        )
    flat = bool(parameters["use2DMap"]) if "use2DMap" in parameters else is2DMode()
    if is2DMode() and not flat:
        raise RuntimeError("in the 2D mode a map is flat: leave `use2DMap` out, or set it to True")
    options = dict(parameters["map_options"]) if "map_options" in parameters else {}
    return Network.fromFile(parameters["map"], **options)


def nearer(agent: Any, threshold: float, kind: Any) -> list[Any]:
    """The other objects of a class whose centres are nearer to an agent than a threshold in metres."""
    simulation = running_simulation()
    x, y, z = agent.position
    limit = threshold * threshold
    found: list[Any] = []
    for other in simulation.objects:
        if other is agent or not isinstance(other, kind):
            continue
        a, b, c = other.position
        a, b, c = a - x, b - y, c - z
        if a * a + b * b + c * c < limit:
            found.append(other)
    return found
