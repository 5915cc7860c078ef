"""Actions of agents in one step."""

from abc import ABC, abstractmethod

from scenic.runtime.python.value_holders import Carrier

__all__ = ["Action"]


class Action(Carrier, ABC):
    """Base of actions. In a simulation, an action made by the program before it contains sampled values."""

    def canBeTakenBy(self, agent: object) -> bool:
        """Return whether an agent is able to take the action."""
        return True

    @abstractmethod
    def applyTo(self, agent: object, simulation: object) -> None:
        """Take effect, before the simulator's next step."""
