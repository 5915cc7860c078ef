"""Bases of simulators for the driving domain."""

import math
from typing import Any, ClassVar

from scenic.domains.driving.controllers import PIDLateralController, PIDLongitudinalController
from scenic.simulators.simulation import Simulation
from scenic.simulators.simulator import Simulator

__all__ = ["DrivingSimulation", "DrivingSimulator"]

Controllers = tuple[PIDLongitudinalController, PIDLateralController]


class DrivingSimulation(Simulation):
    """A simulation of traffic.

    Behaviors plan paths and speeds, and turn them into steering and pedals by what the simulation says of its cars. A simulation
    that overrides one of the methods for controllers, such as `getLaneFollowingControllers`, drives its cars by these.

    Attributes:
        steering_lead: steps until steering that has been set begins to turn the way of a car.

    """

    steering_lead: float = 0.0
    _car_gains: ClassVar[dict[str, tuple[float, float, float]]] = {
        "keep": (0.2, 0.1, 0.0),
        "turn": (0.8, 0.2, 0.0),
        "change": (0.08, 0.3, 0.0),
    }

    def has_own_controllers(self, name: str) -> bool:
        """Return whether the simulation overrides a method for controllers."""
        return getattr(type(self), name) is not getattr(DrivingSimulation, name)

    def _controllers(self, agent: Any, kind: str, others: tuple[float, float, float]) -> Controllers:
        is_car = bool(getattr(agent, "isCar", False))
        dt = float(self.timestep)
        along = (0.5, 0.1, 0.7) if is_car else (0.25, 0.025, 0.0)
        return (
            PIDLongitudinalController(*along, dt=dt),
            PIDLateralController(*(self._car_gains[kind] if is_car else others), dt=dt),
        )

    def steering_for(self, agent: Any, curvature: float) -> float:
        """The position of the steering wheel, -1 (left) to 1 (right), by which an agent drives a curve.

        A car turns about its rear axle by ``tan(angle of the front wheels) / wheelbase``.

        Args:
            agent: the agent.
            curvature: of its way, in 1/m, positive to the left.

        """
        angle: float = math.atan(curvature * agent.wheelbase) / agent.maxSteeringAngle
        return min(1.0, max(-1.0, -angle))

    def curvature_of(self, agent: Any, steering: float) -> float:
        """The curvature (1/m, positive to the left) that an agent drives by a position of the steering wheel."""
        return math.tan(-steering * float(agent.maxSteeringAngle)) / float(agent.wheelbase)

    def pivot_of(self, agent: Any) -> float:
        """Metres from the middle of an agent back to the point about which it turns: the rear axle."""
        return float(agent.wheelbase) / 2

    def pedal_for(self, agent: Any, acceleration: float) -> float:
        """The throttle (0 to 1), or the brake (-1 to 0), by which an agent reaches an acceleration in m/s^2."""
        most = agent.maxAcceleration if acceleration > 0 else agent.maxDeceleration
        return min(1.0, max(-1.0, acceleration / float(most)))

    def acceleration_of(self, agent: Any, pedal: float) -> float:
        """The acceleration (m/s^2) of an agent by a throttle (0 to 1) or brake (-1 to 0)."""
        return pedal * float(agent.maxAcceleration if pedal > 0 else agent.maxDeceleration)

    def getLaneFollowingControllers(self, agent: Any) -> Controllers:
        """Controllers that keep an agent in its lane."""
        return self._controllers(agent, "keep", (0.2, 0.1, 0.0))

    def getTurningControllers(self, agent: Any) -> Controllers:
        """Controllers that take an agent round a turn."""
        return self._controllers(agent, "turn", (0.4, 0.1, 0.0))

    def getLaneChangingControllers(self, agent: Any) -> Controllers:
        """Controllers that take an agent to another lane."""
        return self._controllers(agent, "change", (0.1, 0.3, 0.0))


class DrivingSimulator(Simulator):
    """A simulator of traffic."""
