"""Bases of simulators for the driving domain."""

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
