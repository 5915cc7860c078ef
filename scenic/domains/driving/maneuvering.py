"""Decisions of behaviors: what lies ahead of a lane, and where a car is."""

import math
from typing import Any

from scenic.domains.driving.elements import Lane, Maneuver, NetworkElement, Sidewalk
from scenic.domains.driving.enumerations import ManeuverType
from scenic.runtime.program.builtins import running_simulation
from scenic.runtime.values.values import Vector

__all__ = [
    "closest_vehicle",
    "intersection_ahead",
    "nearest_end",
    "next_maneuver",
    "sidewalk_under",
]


def intersection_ahead(lane: Lane) -> Any:
    """Return the intersection into which a lane leads, else the last point of the lane."""
    if lane.maneuvers and lane.maneuvers[0].intersection is not None:
        return lane.maneuvers[0].intersection
    x, y = lane.line[-1]
    return Vector.of((float(x), float(y), 0.0))


def next_maneuver(lane: Lane) -> tuple[Maneuver, ...]:
    """The maneuvers to choose from at the end of a lane: those straight ahead if there are any, else all."""
    straight = tuple(item for item in lane.maneuvers if item.type is ManeuverType.STRAIGHT)
    return straight or lane.maneuvers


def closest_vehicle(agent: Any) -> float:
    """Return the distance from an object to the nearest other vehicle in metres; infinite if there is none."""
    x, y, z = agent.position
    closest = math.inf
    for other in running_simulation().objects:
        if other is not agent and getattr(other, "isVehicle", False):
            a, b, c = other.position
            closest = min(closest, (a - x) ** 2 + (b - y) ** 2 + (c - z) ** 2)
    return math.sqrt(closest)


def sidewalk_under(agent: Any) -> Sidewalk | None:
    """Return the sidewalk on which an object is."""
    found: Sidewalk | None = agent.roadNetwork.sidewalkAt(agent.position)
    return found


def nearest_end(element: NetworkElement, forward: bool) -> Vector:
    """The last point of an element's centerline, or the first one."""
    x, y = element.line[-1 if forward else 0]  # type: ignore[attr-defined] # linear elements have one
    return Vector.of((float(x), float(y), 0.0))
