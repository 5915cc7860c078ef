"""The action that only vehicles in SUMO can take."""

from typing import Any

from scenic.simulators.actions import Action

__all__ = ["SumoDrivingAction"]


class SumoDrivingAction(Action):
    """Let SUMO's own driver models drive the vehicle for one step.

    Args:
        speedFactor: the speed that is wanted, as a multiple of the speed limit.

    """

    def __init__(self, speedFactor: float = 1.0) -> None:
        if not speedFactor > 0:
            raise RuntimeError(f"a factor of the speed limit must be positive, not {speedFactor}")
        self.speedFactor = float(speedFactor)

    def canBeTakenBy(self, agent: object) -> bool:
        """Return whether the agent is a vehicle."""
        return bool(getattr(agent, "isVehicle", False))

    def applyTo(self, agent: object, simulation: Any) -> None:
        """Leave the vehicle to SUMO."""
        simulation.let_drive(agent, self.speedFactor)
