"""The controls of a car in the built-in simulator."""

import math
from typing import Any

from scenic.dataclass import dataclass
from scenic.domains.driving.actions import Steers, Walks
from scenic.runtime.program.builtins import running_simulation

__all__ = ["Controls", "Driven", "Gait", "Walking"]


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

    def setPosition(self, pos: object, elevation: object) -> None:
        """Teleport to a position."""
        running_simulation().place(self, pos)

    def setOrientation(self, orientation: Any) -> None:
        """Turn to an orientation, of which the plane keeps the heading."""
        running_simulation().turn(self, orientation.yaw)

    def setVelocity(self, vel: object) -> None:
        """Set the velocity in m/s."""
        running_simulation().push(self, vel)


class Driven(_Moved, Steers):
    """A car that is steered."""

    controls: Controls

    def resetControls(self) -> None:
        """Release everything."""
        self.__dict__["controls"] = Controls()

    @property
    def throttle(self) -> float:
        """The present throttle, from 0 to 1."""
        return self._present.throttle

    @property
    def steer(self) -> float:
        """The present steering, from -1 (left) to 1 (right)."""
        return self._present.steering

    @property
    def brake(self) -> float:
        """The present brake, from 0 to 1."""
        return self._present.brake

    @property
    def hand_brake(self) -> bool:
        """True if the hand brake is pulled."""
        return self._present.handbrake > 0

    @property
    def reverse(self) -> bool:
        """True if the car is in reverse gear."""
        return self._present.reverse

    @property
    def _present(self) -> Controls:
        """The controls; of a car that no simulation has moved yet, released."""
        return self.__dict__.get("controls") or Controls()

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


@dataclass(slots=True)
class Gait:
    """Direction (radians, anticlockwise from north) and speed (m/s) that a pedestrian has been commanded, if any."""

    direction: float | None = None
    speed: float | None = None


class Walking(_Moved, Walks):
    """A pedestrian whose velocity is set; direction and speed stay until set again."""

    gait: Gait
    heading: float
    speed: float
    velocity: Any

    def resetGait(self) -> None:
        """Forget direction and speed."""
        self.__dict__["gait"] = Gait()

    def setWalkingDirection(self, heading: float) -> None:
        """Walk on in another direction."""
        self.gait.direction = heading
        self._walk(heading, self.speed if self.gait.speed is None else self.gait.speed)

    def setWalkingSpeed(self, speed: float) -> None:
        """Walk on at another speed; in the direction of the own heading, if no other one has been set."""
        self.gait.speed = speed
        direction = self.gait.direction
        if direction is None:
            x, y, *_ = self.velocity
            direction = math.atan2(-x, y) if math.hypot(x, y) > 1e-9 else self.heading
        self._walk(direction, speed)

    def face(self, heading: float) -> None:
        """Turn to a heading (radians)."""
        running_simulation().turn(self, heading)

    def _walk(self, heading: float, speed: float) -> None:
        self.setVelocity((-speed * math.sin(heading), speed * math.cos(heading), 0.0))
