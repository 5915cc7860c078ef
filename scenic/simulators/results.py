"""What a simulation leaves: its course, and how it ended."""

from collections.abc import Mapping, Sequence
from enum import Enum
from typing import Any

__all__ = ["ActionsTaken", "SimulationResult", "TerminationType"]


class TerminationType(Enum):
    """Why a simulation ended."""

    timeLimit = "reached simulation time limit"
    scenarioComplete = "the top-level scenario finished"
    simulationTerminationCondition = "a simulation termination condition was met"
    terminatedByMonitor = "a monitor terminated the simulation"
    terminatedByBehavior = "a behavior terminated the simulation"
    terminatedByUser = "manually terminated by user"


class ActionsTaken(dict[Any, tuple[Any, ...]]):
    """What each agent did in a step; whatever else is asked for, an object without a behavior perhaps, did nothing."""

    def __missing__(self, key: Any) -> tuple[Any, ...]:
        return ()


class SimulationResult:
    """The course of a simulation.

    Attributes:
        trajectory: the state at each step, the first included; a state holds the positions of the objects.
        actions: for each step what each agent did.
        records: recorded values by name.
        terminationType: why it ended.
        terminationReason: the same in words.
        requirements: what became of each requirement.

    """

    def __init__(
        self,
        trajectory: Sequence[Any],
        actions: Sequence[Mapping[Any, Any]],
        terminationType: TerminationType,
        terminationReason: str,
        records: Mapping[str, Any],
        requirements: Sequence[Any] = (),
    ) -> None:
        self.trajectory = tuple(trajectory)
        self.actions = tuple(actions)
        self.terminationType = terminationType
        self.terminationReason = str(terminationReason)
        self.records = dict(records)
        self.requirements = tuple(requirements)

    @property
    def finalState(self) -> Any:
        """The last state."""
        return self.trajectory[-1]
