"""The actions of LGSVL's actors; that simulator is discontinued, so that they do nothing anywhere."""

from scenic.domains.driving.actions import *  # noqa: F403 - programs import them from here
from scenic.simulators.actions import Action

__all__ = ["CancelWaypointsAction", "FollowWaypointsAction", "SetDestinationAction", "TrackWaypointsAction"]


class _ActorAction(Action):
    """An action of an actor of LGSVL."""

    def canBeTakenBy(self, agent: object) -> bool:
        """Return whether the agent is an actor of LGSVL."""
        return hasattr(agent, "lgsvlObject")

    def applyTo(self, agent: object, simulation: object) -> None:
        """Raises `NotImplementedError`: nothing runs LGSVL."""
        raise NotImplementedError("LGSVL is discontinued: its actions cannot be taken")


class SetDestinationAction(_ActorAction):
    """Drive to a destination."""

    def __init__(self, dest: object) -> None:
        self.dest = dest


class FollowWaypointsAction(_ActorAction):
    """Follow waypoints."""

    def __init__(self, waypoints: object) -> None:
        self.waypoints = waypoints


class CancelWaypointsAction(_ActorAction):
    """Follow waypoints no more."""


class TrackWaypointsAction(_ActorAction):
    """Steer along waypoints at a cruising speed in m/s."""

    def __init__(self, waypoints: object, cruising_speed: float = 10) -> None:
        self.waypoints, self.cruising_speed = waypoints, cruising_speed
