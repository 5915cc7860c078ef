"""Actions that the simulators of this package understand, each where it has an object of that kind."""

from abc import abstractmethod
from collections.abc import Mapping
from typing import Any, ClassVar, Final

from scenic.runtime.values.values import to_scalar, to_vector
from scenic.simulators.actions import Action

__all__ = [
    "DRAG",
    "GRAVITY",
    "POINTS",
    "Command",
    "Fly",
    "SetAcceleration",
    "SetSteering",
    "SetThrottle",
    "SetVelocity",
    "SetWheelSpeeds",
    "model_of",
]

GRAVITY: Final = 9.81
"""Metres per second squared."""

DRAG: Final = 0.3
"""Of a quadrotor: acceleration against its velocity, per second."""

POINTS: Final = ("point", "free", "guided")
"""Models that are moved by a velocity or an acceleration."""


class Command(Action):
    """An action for agents of some models."""

    models: ClassVar[tuple[str, ...]]

    def canBeTakenBy(self, agent: object) -> bool:
        """Return whether the agent's model understands the command."""
        return model_of(agent) in self.models

    def applyTo(self, agent: object, simulation: Any) -> None:
        """Give the command; it stays in force until the next one."""
        simulation.command(agent, self.commands())

    @abstractmethod
    def commands(self) -> Mapping[str, float]:
        """Return the settings that it makes, by name."""


class SetVelocity(Command):
    """Move with this velocity (metres per second, global frame).

    Where there are forces, it is the velocity at that moment for a free body, and lasting for a guided one.
    """

    models = POINTS

    def __init__(self, velocity: object) -> None:
        self.velocity = to_vector(velocity, "SetVelocity")

    def commands(self) -> Mapping[str, float]:
        x, y, z = self.velocity
        return {"vx": x, "vy": y, "vz": z, "ax": 0.0, "ay": 0.0, "az": 0.0}

    def __repr__(self) -> str:
        return f"SetVelocity({self.velocity})"


class SetAcceleration(Command):
    """Accelerate so (metres per second squared, global frame)."""

    models = POINTS

    def __init__(self, acceleration: object) -> None:
        self.acceleration = to_vector(acceleration, "SetAcceleration")

    def commands(self) -> Mapping[str, float]:
        x, y, z = self.acceleration
        return {"ax": x, "ay": y, "az": z}

    def __repr__(self) -> str:
        return f"SetAcceleration({self.acceleration})"


class SetWheelSpeeds(Command):
    """Speeds of the left and the right wheel (metres per second), whose distance is the object's width."""

    models = ("differential",)

    def __init__(self, left: float, right: float) -> None:
        self.left = to_scalar(left, "SetWheelSpeeds")
        self.right = to_scalar(right, "SetWheelSpeeds")

    def commands(self) -> Mapping[str, float]:
        return {"left": self.left, "right": self.right}

    def __repr__(self) -> str:
        return f"SetWheelSpeeds({self.left:g}, {self.right:g})"


class SetThrottle(Command):
    """Acceleration along the heading (metres per second squared, negative to brake; no vehicle brakes into reverse)."""

    models = ("bicycle",)

    def __init__(self, acceleration: float) -> None:
        self.acceleration = to_scalar(acceleration, "SetThrottle")

    def commands(self) -> Mapping[str, float]:
        return {"throttle": self.acceleration}

    def __repr__(self) -> str:
        return f"SetThrottle({self.acceleration:g})"


class SetSteering(Command):
    """Angle of the front wheels (radians, positive to the left), clipped to 0.6."""

    models = ("bicycle",)

    def __init__(self, angle: float) -> None:
        self.angle = to_scalar(angle, "SetSteering")

    def commands(self) -> Mapping[str, float]:
        return {"steering": max(-0.6, min(0.6, self.angle))}

    def __repr__(self) -> str:
        return f"SetSteering({self.angle:g})"


class Fly(Command):
    """Thrust along the quadrotor's own up (metres per second squared; gravity is 9.81), attitude, rate of turning.

    Pitch and roll are radians, ``turn`` is radians per second.
    """

    models = ("quadrotor",)

    def __init__(self, thrust: float = GRAVITY, pitch: float = 0, roll: float = 0, turn: float = 0) -> None:
        self.thrust, self.pitch, self.roll, self.turn = (
            to_scalar(value, "Fly") for value in (thrust, pitch, roll, turn)
        )

    def commands(self) -> Mapping[str, float]:
        return {"thrust": self.thrust, "pitch": self.pitch, "roll": self.roll, "turn": self.turn}

    def __repr__(self) -> str:
        return f"Fly({self.thrust:g}, {self.pitch:g}, {self.roll:g}, {self.turn:g})"


def model_of(obj: object) -> str:
    """Return the model of an object."""
    return str(getattr(obj, "dynamics", "point"))
