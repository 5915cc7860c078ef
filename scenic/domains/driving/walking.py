"""Decisions of pedestrians that walk to a place: around what stands there, and not in front of cars."""

import math
from collections.abc import Iterable, Iterator
from typing import Any, Final

from scenic.domains.driving.wrong_arguments import wrong_argument
from scenic.runtime.program.builtins import running_simulation

__all__ = ["arrived", "heading_to", "places_of", "walking_step"]

_LOOK: Final = 3.0
"""Metres ahead in which obstacles count."""
_TURNS: Final = tuple(math.radians(angle) for step in range(0, 136, 15) for angle in {step, -step})
"""Turns away from the goal that are tried, the smallest ones first."""
_CLEARANCE: Final = 0.3
"""Metres between the circles about a walker and an obstacle."""
_PATIENCE: Final = 4.0
"""Seconds ahead in which approaching cars count."""
_MOVING: Final = 0.5
"""The speed (m/s) from which a vehicle is one to yield to, rather than an obstacle."""
_SWATHE: Final = 0.7
"""Metres left free on either side of a moving vehicle."""


def heading_to(agent: Any, place: Any) -> float:
    """The heading (radians, anticlockwise from north) from an agent to a place."""
    return math.atan2(agent.position[0] - place[0], place[1] - agent.position[1])


def arrived(agent: Any, place: Any, speed: float) -> bool:
    """Return whether an agent is as near to a place as it comes in half a step at a speed in m/s."""
    reach: float = max(0.05, 0.5 * speed * running_simulation().timestep)
    return math.hypot(agent.position[0] - place[0], agent.position[1] - place[1]) <= reach


def places_of(path: Any) -> list[tuple[float, float]]:
    """The places of a path in order: of a polyline, of an element with a centerline, or of a sequence of places.

    Raises:
        ValueError: there are none.
        ScenicTypeError: they are something else.

    """
    line = getattr(path, "centerline", path)
    try:
        places = [
            (float(x), float(y))
            for x, y, *_ in (tuple(_position(item)) for item in getattr(line, "points", line))
        ]
    except (TypeError, ValueError):
        raise wrong_argument("path", "places", path, "where to walk") from None
    if not places:
        raise ValueError("a path needs at least one place")
    return places


def _position(place: Any) -> Iterable[float]:
    position: Iterable[float] = getattr(place, "position", place)
    return position


def walking_step(agent: Any, place: Any, speed: float) -> tuple[float, float]:
    """Heading (radians) and speed (m/s) of an agent's next step to a place: 0 m/s while it yields to a car.

    A direction is free if nothing that stands lies within three metres in it; the one nearest to the goal's is taken. Cars
    are yielded to if they would come too near while the agent walks on, unless they would hit it standing, too.
    """
    goal = heading_to(agent, place)
    others = [other for other in running_simulation().objects if other is not agent]
    left = math.hypot(agent.position[0] - place[0], agent.position[1] - place[1])
    standing = list(_standing(agent, others))
    heading = next((goal + turn for turn in _TURNS if _is_free(goal + turn, standing, left)), goal)
    velocity = (-speed * math.sin(heading), speed * math.cos(heading))
    if any(_meets(agent, velocity, car) and not _meets(agent, (0.0, 0.0), car) for car in _moving(others)):
        return heading, 0.0
    return heading, speed


def _standing(agent: Any, others: Iterable[Any]) -> Iterator[tuple[float, float, float]]:
    """Yield the position of each nearby standing object, relative to the agent, and the distance that the centres must keep."""
    x, y, *_ = agent.position
    own_radius = math.hypot(agent.width, agent.length) / 2
    for other in others:
        if getattr(other, "isVehicle", False) and other.speed > _MOVING:
            continue
        radius = own_radius + math.hypot(other.width, other.length) / 2 + _CLEARANCE
        a, b = other.position[0] - x, other.position[1] - y
        if math.hypot(a, b) < _LOOK + radius:
            yield a, b, radius


def _is_free(heading: float, standing: Iterable[tuple[float, float, float]], left: float) -> bool:
    """Return whether an agent can walk three metres, or as far as is left, in a direction."""
    dx, dy = -math.sin(heading), math.cos(heading)
    for a, b, radius in standing:
        along = a * dx + b * dy
        # What is beside or behind is left by walking on.
        if along <= 0:
            continue
        near = min(along, _LOOK, left)
        if math.hypot(a - near * dx, b - near * dy) < radius:
            return False
    return True


def _moving(others: Iterable[Any]) -> Iterator[Any]:
    return (other for other in others if getattr(other, "isVehicle", False) and other.speed > _MOVING)


def _meets(agent: Any, velocity: tuple[float, float], car: Any) -> bool:
    """Return whether an agent that keeps a velocity comes too near to a car that keeps its own one."""
    ahead, aside = -math.sin(car.heading), math.cos(car.heading)
    reach = (agent.width + agent.length) / 4 + _SWATHE
    half_length, half_width = car.length / 2 + reach, car.width / 2 + reach
    for step in range(int(_PATIENCE / 0.2) + 1):
        time = 0.2 * step
        a = agent.position[0] + velocity[0] * time - car.position[0] - car.velocity[0] * time
        b = agent.position[1] + velocity[1] * time - car.position[1] - car.velocity[1] * time
        if abs(a * ahead + b * aside) < half_length and abs(a * aside - b * ahead) < half_width:
            return True
    return False
