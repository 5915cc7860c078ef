"""The controls of a car in the built-in simulator."""

from dataclasses import dataclass
from typing import Any

from scenic.domains.driving.actions import Steers, Walks
from scenic.runtime.program.builtins import running_simulation

__all__ = ["Controls", "Driven", "Walking"]


@dataclass(slots=True)
class Controls:
    """Throttle and brake from 0 to 1, steering from -1 (left) to 1 (right); they stay until set again."""

    throttle: float = 0.0
    steering: float = 0.0
    brake: float = 0.0
    handbrake: float = 0.0
    reverse: bool = False


class _Moved:
    """Objects that the simulation moves."""

    def setPosition(self, pos: Any, elevation: Any) -> None:
        """Teleport to a position."""
        running_simulation().place(self, pos)

    def setVelocity(self, vel: Any) -> None:
        """Set the velocity in m/s."""
        running_simulation().push(self, vel)


class Driven(_Moved, Steers):
    """A car that is steered."""

    controls: Controls

    def resetControls(self) -> None:
        """Release everything."""
        self.__dict__["controls"] = Controls()

    def setThrottle(self, throttle: float) -> None:
        """Set the throttle."""
        self.controls.throttle = throttle

    def setSteering(self, steering: float) -> None:
        """Set the steering."""
        self.controls.steering = steering

    def setBraking(self, braking: float) -> None:
        """Set the brake."""
        self.controls.brake = braking

    def setHandbrake(self, handbrake: bool) -> None:
        """Pull or release the hand brake."""
        self.controls.handbrake = float(handbrake)

    def setReverse(self, reverse: bool) -> None:
        """Set the gear."""
        self.controls.reverse = reverse


class Walking(_Moved, Walks):
    """A pedestrian whose velocity is set."""
