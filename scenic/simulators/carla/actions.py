"""Actions that only CARLA's actors can take."""

from typing import Any

from scenic.domains.driving.actions import *  # noqa: F403 - programs import them from here
from scenic.simulators.actions import Action

__all__ = [
    "SetAngularVelocityAction",
    "SetAutopilotAction",
    "SetTrafficLightAction",
    "SetTransformAction",
    "SetVehicleLightStateAction",
    "TrackWaypointsAction",
]


class _ActorAction(Action):
    """An action on the simulator's actor."""

    def canBeTakenBy(self, agent: object) -> bool:
        """Return whether the agent is an actor of CARLA."""
        return hasattr(agent, "carlaActor")


class SetAngularVelocityAction(_ActorAction):
    """Set the angular velocity."""

    def __init__(self, angularVel: object) -> None:
        self.angularVel = angularVel

    def applyTo(self, agent: object, simulation: Any) -> None:
        """Set it."""
        simulation.set_angular_velocity(agent, self.angularVel)


class SetTransformAction(_ActorAction):
    """Teleport to a position and heading."""

    def __init__(self, pos: object, heading: float) -> None:
        self.pos, self.heading = pos, heading

    def applyTo(self, agent: object, simulation: Any) -> None:
        """Move the actor."""
        simulation.set_transform(agent, self.pos, self.heading)


class SetAutopilotAction(_ActorAction):
    """Let the simulator's traffic manager drive, or stop doing so."""

    def __init__(self, enabled: bool, **options: Any) -> None:
        if not isinstance(enabled, bool):
            raise RuntimeError(f"the autopilot is on (True) or off (False), not {enabled!r}")
        self.enabled = enabled
        self.options = options

    def applyTo(self, agent: object, simulation: Any) -> None:
        """Set it."""
        simulation.set_autopilot(agent, self.enabled, **self.options)


class SetVehicleLightStateAction(_ActorAction):
    """Set the lights of a vehicle."""

    def __init__(self, vehicleLightState: object) -> None:
        self.vehicleLightState = vehicleLightState

    def applyTo(self, agent: Any, simulation: object) -> None:
        """Set them."""
        agent.carlaActor.set_light_state(self.vehicleLightState)


class SetTrafficLightAction(_ActorAction):
    """Set the traffic light that governs a vehicle, if it is near enough."""

    def __init__(self, color: str, distance: float = 100, group: bool = False) -> None:
        if color not in ("green", "yellow", "red", "off", "unknown"):
            raise RuntimeError(f"a traffic light is green, yellow, red, off or unknown, not {color!r}")
        self.color, self.distance, self.group = color, distance, group

    def applyTo(self, agent: object, simulation: Any) -> None:
        """Set it."""
        simulation.set_closest_traffic_light(agent, self.color, self.distance)


class TrackWaypointsAction(_ActorAction):
    """Steer towards the next of some waypoints."""

    def __init__(self, waypoints: Any, cruising_speed: float = 10) -> None:
        self.waypoints, self.cruising_speed = tuple(waypoints), cruising_speed

    def applyTo(self, agent: object, simulation: Any) -> None:
        """Set the controls."""
        simulation.track_waypoints(agent, self.waypoints, self.cruising_speed)
