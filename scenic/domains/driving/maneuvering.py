"""Decisions of behaviors: what lies ahead of a lane, and where a car is."""

from typing import Any

from scenic.domains.driving.elements import Lane, Maneuver, NetworkElement, Sidewalk
from scenic.domains.driving.kinds import ManeuverType
from scenic.runtime.program.builtins import running_simulation
from scenic.runtime.values.values import Vector

__all__ = [
    "closest_vehicle",
    "intersection_ahead",
    "nearest_end",
    "next_maneuver",
    "sidewalk_under",
    "wholly_in_intersection",
]


def intersection_ahead(lane: Lane) -> Any:
    """The intersection into which a lane leads, else the last point of the lane."""
    if lane.maneuvers and lane.maneuvers[0].intersection is not None:
        return lane.maneuvers[0].intersection
    x, y = lane.line[-1]
    return Vector.of((float(x), float(y), 0.0))


def next_maneuver(lane: Lane) -> tuple[Maneuver, ...]:
    """The maneuvers to choose from at the end of a lane: those straight ahead if there are any, else all."""
    straight = tuple(item for item in lane.maneuvers if item.type is ManeuverType.STRAIGHT)
    return straight or lane.maneuvers


def wholly_in_intersection(agent: Any) -> bool:
    """Whether the whole of an object is in one intersection."""
    found = agent.roadNetwork.intersectionAt(agent.position)
    return found is not None and bool(found.containsObject(agent))


def closest_vehicle(agent: Any) -> float:
    """The distance from an object to the nearest other vehicle in metres; infinite if there is none."""
    here = agent.position
    away = [
        here.distanceTo(other.position)
        for other in running_simulation().objects
        if other is not agent and getattr(other, "isVehicle", False)
    ]
    return min(away, default=float("inf"))


def sidewalk_under(agent: Any) -> Sidewalk | None:
    """The sidewalk on which an object is."""
    found: Sidewalk | None = agent.roadNetwork.sidewalkAt(agent.position)
    return found


def nearest_end(element: NetworkElement, forward: bool) -> Vector:
    """The last point of an element's centerline, or the first one."""
    x, y = element.line[-1 if forward else 0]  # type: ignore[attr-defined] # linear elements have one
    return Vector.of((float(x), float(y), 0.0))
