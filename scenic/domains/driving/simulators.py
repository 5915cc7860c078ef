"""Bases of simulators for the driving domain."""

import math
from typing import Any

from scenic.domains.driving.controllers import PIDLateralController, PIDLongitudinalController
from scenic.simulators.simulation import Simulation
from scenic.simulators.simulator import Simulator

__all__ = ["DrivingSimulation", "DrivingSimulator"]

Controllers = tuple[PIDLongitudinalController, PIDLateralController]


class DrivingSimulation(Simulation):
    """A simulation of traffic; override its controllers to tune them for the simulator's cars."""

    def _controllers(
        self, agent: Any, car: tuple[float, float, float], others: tuple[float, float, float]
    ) -> Controllers:
        is_car = bool(getattr(agent, "isCar", False))
        dt = float(self.timestep)
        along = (0.5, 0.1, 0.7) if is_car else (0.25, 0.025, 0.0)
        return (
            PIDLongitudinalController(*along, dt=dt),
            PIDLateralController(*(car if is_car else others), dt=dt),
        )

    def steering_for(self, agent: Any, curvature: float) -> float:
        """The position of the steering wheel, -1 (left) to 1, by which an agent drives a curve.

        A car turns about its rear axle by ``tan(angle of the front wheels) / wheelbase``.

        Args:
            agent: the agent.
            curvature: of its way, in 1/m, positive to the left.

        """
        angle: float = math.atan(curvature * agent.wheelbase) / agent.maxSteeringAngle
        return min(1.0, max(-1.0, -angle))

    def getLaneFollowingControllers(self, agent: Any) -> Controllers:
        """Controllers that keep an agent in its lane."""
        return self._controllers(agent, (0.2, 0.1, 0), (0.2, 0.1, 0))

    def getTurningControllers(self, agent: Any) -> Controllers:
        """Controllers that take an agent round a turn."""
        return self._controllers(agent, (0.8, 0.2, 0), (0.4, 0.1, 0))

    def getLaneChangingControllers(self, agent: Any) -> Controllers:
        """Controllers that take an agent to another lane."""
        return self._controllers(agent, (0.08, 0.3, 0), (0.1, 0.3, 0))


class DrivingSimulator(Simulator):
    """A simulator of traffic."""
