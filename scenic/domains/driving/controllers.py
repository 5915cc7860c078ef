"""Controllers of cars (section 5.3 of the driving specification)."""

import math
from collections import deque
from typing import Any

__all__ = ["PIDLateralController", "PIDLongitudinalController", "PurePursuitLateralController"]


class PIDLongitudinalController:
    """Throttle or brake from an error of speed.

    Args:
        K_P: gain of the error.
        K_D: gain of its derivative.
        K_I: gain of its integral over the last 10 steps.
        dt: seconds in a step.

    """

    def __init__(self, K_P: float = 0.5, K_D: float = 0.1, K_I: float = 0.2, dt: float = 0.1) -> None:
        self._gains = (K_P, K_D, K_I)
        self._dt = dt
        self._errors: deque[float] = deque(maxlen=10)

    def run_step(self, speed_error: float) -> float:
        """Return the signal in [-1, 1] for an error in m/s: positive is throttle, negative is brake."""
        errors = self._errors
        errors.append(speed_error)
        derivative = integral = 0.0
        if len(errors) >= 2:
            derivative = (errors[-1] - errors[-2]) / self._dt
            integral = sum(errors) * self._dt
        k_p, k_d, k_i = self._gains
        return _clipped(k_p * speed_error + k_d * derivative + k_i * integral)


class PIDLateralController:
    """Steering from the distance to a line.

    Args:
        K_P: gain of the distance.
        K_D: gain of its derivative.
        K_I: gain of its integral.
        dt: seconds in a step.

    """

    def __init__(self, K_P: float = 0.3, K_D: float = 0.2, K_I: float = 0, dt: float = 0.1) -> None:
        self._gains = (K_P, K_D, K_I)
        self._dt = dt
        self._previous = 0.0
        self._integral = 0.0

    def run_step(self, cte: float) -> float:
        """Return the steering in [-1, 1] for a distance in metres, both positive to the right of the car."""
        self._integral = min(20.0, max(-20.0, self._integral + cte * self._dt))
        derivative = (cte - self._previous) / self._dt
        self._previous = cte
        k_p, k_d, k_i = self._gains
        return _clipped(k_p * cte + k_d * derivative + k_i * self._integral)


class PurePursuitLateralController:
    """Steering towards a place ahead on the line (R. C. Coulter, Implementation of the Pure Pursuit Path Tracking Algorithm, 1992).

    The place is farther ahead the faster the car is. Give it to a car as its property `lateralController`.

    Args:
        lookahead: metres ahead at rest.
        gain: seconds by which the place is farther ahead.

    Raises:
        ValueError: ``lookahead`` is not positive, or ``gain`` negative.

    """

    def __init__(self, lookahead: float = 3.0, gain: float = 0.4) -> None:
        if not (lookahead > 0 and gain >= 0):
            raise ValueError(f"lookahead must be positive and gain not negative, not {lookahead} and {gain}")
        self._lookahead = lookahead
        self._gain = gain

    def curvature(self, agent: Any, line: Any, *, oncoming: bool = False) -> float:
        """The curvature (1/m, positive to the left) of the arc from an agent to the place ahead on a `FollowedLine`."""
        line.signed_distance(agent.position)
        reach = self._lookahead + self._gain * agent.speed
        x, y = line.ahead(-reach if oncoming else reach)
        dx: float = x - agent.position[0]
        dy: float = y - agent.position[1]
        aside: float = -(dx * math.cos(agent.heading) + dy * math.sin(agent.heading))
        return 2 * aside / max(dx * dx + dy * dy, 1e-9)


def _clipped(signal: float) -> float:
    return min(1.0, max(-1.0, signal))
