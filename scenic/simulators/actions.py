"""What agents do in one step."""

from abc import ABC, abstractmethod
from typing import Any

__all__ = ["Action"]


class Action(ABC):
    """Base of actions."""

    def canBeTakenBy(self, agent: Any) -> bool:
        """Whether an agent is able to take the action."""
        return True

    @abstractmethod
    def applyTo(self, agent: Any, simulation: Any) -> None:
        """Take effect, before the simulator's next step."""
