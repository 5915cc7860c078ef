"""The results of a simulation: its course, and how it ended."""

from collections.abc import Mapping, Sequence
from enum import Enum
from typing import Any, Self

__all__ = [
    "ActionsTaken",
    "Latest",
    "NotKeptError",
    "SimulationResult",
    "SimulationState",
    "TerminationType",
    "kept",
]


class TerminationType(Enum):
    """The reason why a simulation ended."""

    timeLimit = "reached simulation time limit"
    scenarioComplete = "the top-level scenario finished"
    simulationTerminationCondition = "a simulation termination condition was met"
    terminatedByMonitor = "a monitor terminated the simulation"
    terminatedByBehavior = "a behavior terminated the simulation"
    terminatedByUser = "manually terminated by user"


class ActionsTaken(dict[Any, tuple[Any, ...]]):
    """The actions of each agent in a step; whatever else is asked for, an object without a behavior perhaps, did nothing."""

    def __missing__(self, key: object) -> tuple[Any, ...]:
        return ()


class SimulationState(tuple[Any, ...]):
    """The positions of all objects in one state of a simulation.

    Attributes:
        positions: the same positions, in metres.
        orientations: how the objects stand.

    """

    positions: tuple[Any, ...]
    orientations: tuple[Any, ...]

    def __new__(cls, positions: tuple[Any, ...], orientations: tuple[Any, ...]) -> Self:
        """Make a state that keeps both."""
        made = super().__new__(cls, positions)
        made.positions = positions
        made.orientations = orientations
        return made

    def __getnewargs__(self) -> tuple[tuple[Any, ...], tuple[Any, ...]]:
        return self.positions, self.orientations


class NotKeptError(LookupError):
    """The error for reading a part of a simulation's course that is not kept."""

    @classmethod
    def behind(cls, error: BaseException | None) -> bool:
        """Return whether that is why another error came up."""
        while error is not None:
            if isinstance(error, cls):
                return True
            error = error.__cause__ or error.__context__
        return False


class Latest(Sequence[Any]):
    """A series of which only the newest member is kept.

    Args:
        what: its members are, for messages.

    """

    def __init__(self, what: str) -> None:
        self._what = what
        self._count = 0
        self.newest: list[Any] = []
        """The newest member, if there is one."""
        self.missed = False
        """True if a member that is not kept has been read."""

    def append(self, value: object) -> None:
        """Add the next member."""
        self.newest = [value]
        self._count += 1

    def __len__(self) -> int:
        """Number of entries so far."""
        return self._count

    def __getitem__(self, place: Any) -> Any:
        if self.newest and place in (-1, self._count - 1):
            return self.newest[0]
        self.missed = True
        raise NotKeptError(
            f"of the {self._what} of this simulation only the newest is kept; `keep_course=True` keeps all"
        )


def kept(series: Sequence[object]) -> Sequence[Any]:
    """Return the kept part of a series."""
    return series.newest if isinstance(series, Latest) else series


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
        trajectory: Sequence[object],
        actions: Sequence[Mapping[Any, Any]],
        terminationType: TerminationType,
        terminationReason: str,
        records: Mapping[str, object],
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
