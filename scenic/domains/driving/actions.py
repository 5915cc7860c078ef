"""Actions of cars and pedestrians in one step (sections 5.1 and 5.2 of the driving specification)."""

import math
from typing import Any

from scenic.runtime.values.values import Vector, to_orientation, to_vector
from scenic.simulators.actions import Action

__all__ = [
    "OffsetAction",
    "RegulatedControlAction",
    "SetBrakeAction",
    "SetHandBrakeAction",
    "SetOrientationAction",
    "SetPositionAction",
    "SetReverseAction",
    "SetSpeedAction",
    "SetSteerAction",
    "SetThrottleAction",
    "SetVelocityAction",
    "SetWalkingDirectionAction",
    "SetWalkingSpeedAction",
    "SteeringAction",
    "Steers",
    "WalkingAction",
    "Walks",
]


class Steers:
    """Agents with throttle, brakes and a steering wheel; a simulator's model implements the methods."""

    def setThrottle(self, throttle: float) -> None:
        """Set the throttle, 0 to 1."""
        raise NotImplementedError

    def setSteering(self, steering: float) -> None:
        """Set the steering wheel, -1 (left) to 1 (right)."""
        raise NotImplementedError

    def setBraking(self, braking: float) -> None:
        """Set the brake, 0 to 1."""
        raise NotImplementedError

    def setHandbrake(self, handbrake: bool) -> None:
        """Pull or release the hand brake."""
        raise NotImplementedError

    def setReverse(self, reverse: bool) -> None:
        """Put the gear into reverse or forward."""
        raise NotImplementedError


class Walks:
    """Agents that walk; by default their velocity is set."""

    def setWalkingDirection(self, heading: float) -> None:
        """Walk on in another direction (radians, anticlockwise from north) at the present speed."""
        agent: Any = self
        agent.setVelocity(_velocity(heading, agent.speed))

    def setWalkingSpeed(self, speed: float) -> None:
        """Walk on at another speed (m/s); from rest in the direction of the own heading."""
        agent: Any = self
        x, y, _ = agent.velocity
        moving = math.hypot(x, y) > 1e-9
        agent.setVelocity(_velocity(math.atan2(-x, y) if moving else agent.heading, speed))

    def face(self, heading: float) -> None:
        """Turn to a heading (radians); nothing to do where a simulator turns those who walk itself."""


def _velocity(heading: float, speed: float) -> Vector:
    velocity: Vector = Vector(-speed * math.sin(heading), speed * math.cos(heading), 0)
    return velocity


class SetPositionAction(Action):
    """Teleport to a position."""

    def __init__(self, pos: object) -> None:
        self.pos = to_vector(pos, "the position")

    def applyTo(self, agent: Any, simulation: object) -> None:
        """Move the agent."""
        agent.setPosition(self.pos, agent.elevation)


class SetOrientationAction(Action):
    """Turn to an orientation, or to a heading (radians, anticlockwise from north)."""

    def __init__(self, orientation: object) -> None:
        self.orientation = to_orientation(orientation)

    def applyTo(self, agent: Any, simulation: object) -> None:
        """Turn the agent."""
        agent.setOrientation(self.orientation)


class OffsetAction(Action):
    """Teleport by an offset in the agent's own frame (metres)."""

    def __init__(self, offset: object) -> None:
        self.offset = offset

    def applyTo(self, agent: Any, simulation: object) -> None:
        """Move the agent."""
        agent.setPosition(agent.relativePosition(self.offset), agent.elevation)


class SetVelocityAction(Action):
    """Set the velocity (m/s)."""

    def __init__(self, xVel: float, yVel: float, zVel: float = 0) -> None:
        self.xVel, self.yVel, self.zVel = xVel, yVel, zVel

    def applyTo(self, agent: Any, simulation: object) -> None:
        """Set it."""
        agent.setVelocity(Vector(self.xVel, self.yVel, self.zVel))


class SetSpeedAction(Action):
    """Set the speed along the own heading (m/s)."""

    def __init__(self, speed: float) -> None:
        self.speed = speed

    def applyTo(self, agent: Any, simulation: object) -> None:
        """Set it."""
        agent.setVelocity(_velocity(agent.heading, self.speed))


class SteeringAction(Action):
    """Base of actions of agents that steer."""

    def canBeTakenBy(self, agent: object) -> bool:
        """Return whether the agent steers."""
        return isinstance(agent, Steers)


class SetThrottleAction(SteeringAction):
    """Set the throttle, 0 to 1."""

    def __init__(self, throttle: float) -> None:
        self.throttle = _within("throttle", throttle, 0, 1)

    def applyTo(self, agent: Any, simulation: object) -> None:
        """Set it."""
        agent.setThrottle(self.throttle)


class SetSteerAction(SteeringAction):
    """Set the steering wheel, -1 (left) to 1 (right)."""

    def __init__(self, steer: float) -> None:
        self.steer = _within("steer", steer, -1, 1)

    def applyTo(self, agent: Any, simulation: object) -> None:
        """Set it."""
        agent.setSteering(self.steer)


class SetBrakeAction(SteeringAction):
    """Set the brake, 0 to 1."""

    def __init__(self, brake: float) -> None:
        self.brake = _within("brake", brake, 0, 1)

    def applyTo(self, agent: Any, simulation: object) -> None:
        """Set it."""
        agent.setBraking(self.brake)


class SetHandBrakeAction(SteeringAction):
    """Pull or release the hand brake."""

    def __init__(self, handBrake: bool) -> None:
        self.handbrake = _flag("hand brake", handBrake)

    def applyTo(self, agent: Any, simulation: object) -> None:
        """Set it."""
        agent.setHandbrake(self.handbrake)


class SetReverseAction(SteeringAction):
    """Put the gear into reverse or forward."""

    def __init__(self, reverse: bool) -> None:
        self.reverse = _flag("reverse gear", reverse)

    def applyTo(self, agent: Any, simulation: object) -> None:
        """Set it."""
        agent.setReverse(self.reverse)


class RegulatedControlAction(SteeringAction):
    """Throttle, brake and steering from the signals of controllers.

    Args:
        throttle: positive for throttle, negative for the brake.
        steer: wanted steering, positive to the right.
        past_steer: the steering applied before, from which one step differs by at most 0.1.
        max_throttle: limit of the throttle.
        max_brake: limit of the brake.
        max_steer: limit of the steering.

    Attributes:
        steer: the steering that is applied.

    """

    def __init__(
        self,
        throttle: float,
        steer: float,
        past_steer: float,
        max_throttle: float = 0.5,
        max_brake: float = 0.5,
        max_steer: float = 0.8,
    ) -> None:
        if throttle > 0:
            self.throttle, self.brake = min(throttle, max_throttle), 0.0
        else:
            self.throttle, self.brake = 0.0, min(-throttle, max_brake)
        if steer is not past_steer:
            steer = min(max(steer, past_steer - 0.1), past_steer + 0.1)
        self.steer = min(max(steer, -max_steer), max_steer)

    def applyTo(self, agent: Any, simulation: object) -> None:
        """Set all three."""
        agent.setThrottle(self.throttle)
        agent.setBraking(self.brake)
        agent.setSteering(self.steer)


class WalkingAction(Action):
    """Base of actions of agents that walk."""

    def canBeTakenBy(self, agent: object) -> bool:
        """Return whether the agent walks."""
        return isinstance(agent, Walks)


class SetWalkingDirectionAction(WalkingAction):
    """Walk in a direction (radians, anticlockwise from north).

    Args:
        heading: the direction.
        face: turn towards it, too, instead of keeping the own heading.

    """

    def __init__(self, heading: float, face: bool = False) -> None:
        self.heading = heading
        self.face = face

    def applyTo(self, agent: Any, simulation: object) -> None:
        """Set it."""
        if self.face:
            agent.face(self.heading)
        agent.setWalkingDirection(self.heading)


class SetWalkingSpeedAction(WalkingAction):
    """Walk at a speed (m/s)."""

    def __init__(self, speed: float) -> None:
        self.speed = speed

    def applyTo(self, agent: Any, simulation: object) -> None:
        """Set it."""
        agent.setWalkingSpeed(self.speed)


def _within(what: str, value: float, low: float, high: float) -> float:
    if not low <= value <= high:
        raise RuntimeError(f"{what} must be between {low} and {high}, not {value}")
    return value


def _flag(what: str, value: bool) -> bool:
    if not isinstance(value, bool):
        raise RuntimeError(f"{what} must be True or False, not {value!r}")
    return value
