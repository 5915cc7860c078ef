"""The driver of a car: controllers that follow a line, and the steering applied so far."""

from copy import deepcopy
from typing import Any, Final

from scenic.domains.driving.actions import RegulatedControlAction, SetSteerAction
from scenic.domains.driving.lines import FollowedLine
from scenic.runtime.program.builtins import running_simulation

__all__ = ["Driver"]


_GRIP: Final = 6.0
"""The lateral acceleration (m/s^2) that drivers do not exceed: about what tyres hold on a wet road."""


class Driver:
    """Decides throttle, brake and steering of a car, step by step.

    The controllers are those of the simulation, or those that the car has as properties. What the car has steered last is
    carried over from the behavior before, so that steering never jumps.

    Args:
        agent: the car.

    """

    def __init__(self, agent: Any) -> None:
        self._agent = agent
        self._past = _applied(agent)
        self._longitudinal: Any = None
        self._lateral: Any = None

    def keep_lane(self) -> None:
        """Take fresh controllers for following a lane."""
        self._take(*running_simulation().getLaneFollowingControllers(self._agent))

    def turn(self) -> None:
        """Take fresh controllers for turns in intersections."""
        self._take(*running_simulation().getTurningControllers(self._agent))

    def change_lane(self) -> None:
        """Take fresh controllers for changing lanes."""
        self._take(*running_simulation().getLaneChangingControllers(self._agent))

    def _take(self, longitudinal: Any, lateral: Any) -> None:
        own = (
            getattr(self._agent, "longitudinalController", None),
            getattr(self._agent, "lateralController", None),
        )
        # A controller has a state of its own: each behavior and each simulation begins with that of the property.
        self._longitudinal = longitudinal if own[0] is None else deepcopy(own[0])
        self._lateral = lateral if own[1] is None else deepcopy(own[1])

    def follow(self, line: FollowedLine, speed: float, *, oncoming: bool = False) -> RegulatedControlAction:
        """The action of one step.

        Args:
            line: what to follow.
            speed: the speed to reach, m/s.
            oncoming: drive against the direction of the line.

        """
        agent = self._agent
        steers = getattr(self._lateral, "curvature", None)
        if steers is None:
            away = line.signed_distance(agent.position)
            steering = self._lateral.run_step(-away if oncoming else away)
        else:
            steering = running_simulation().steering_for(agent, steers(agent, line, oncoming=oncoming))
        # Sharper curves than the tyres hold would only make a fast car swing about the line.
        sharpest = _GRIP / max(agent.speed, 1.0) ** 2
        most = abs(running_simulation().steering_for(agent, sharpest))
        steering = min(max(steering, -most), most)
        throttle = self._longitudinal.run_step(speed - agent.speed)
        action = RegulatedControlAction(throttle, steering, self._past)
        self._past = action.steer
        return action


def _applied(agent: Any) -> float:
    """The steering that an agent has been given in the last step; 0 if none."""
    for action in reversed(agent.lastActions):
        if isinstance(action, RegulatedControlAction | SetSteerAction):
            return action.steer
    return 0.0
