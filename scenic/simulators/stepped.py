"""Simulations that their caller advances, a step at a time."""

from types import TracebackType
from typing import Any, Self

from scenic.simulators.results import SimulationResult
from scenic.simulators.simulation import Simulation

__all__ = ["SteppedSimulation", "TerminatedSimulationException"]


class TerminatedSimulationException(Exception):
    """A simulation that has ended was advanced."""


class SteppedSimulation:
    """A simulation that makes a step whenever `advance` is called; all other attributes are those of the simulation.

    Args:
        simulation: one that was made with ``deferred=True`` and has not begun.

    """

    def __init__(self, simulation: Simulation) -> None:
        self.simulation = simulation

    @property
    def result(self) -> SimulationResult | None:
        """The result, once the simulation has ended."""
        return self.simulation.result

    def __getattr__(self, name: str) -> Any:
        return getattr(self.simulation, name)

    def advance(self) -> bool:
        """Make one step; false once the simulation has ended.

        Raises:
            TerminatedSimulationException: the simulation has ended before.

        """
        if self.simulation.is_over:
            raise TerminatedSimulationException("the simulation has ended; read its `result`")
        return self.simulation.advanceOnce()

    def terminateSimulation(self, reason: str = "terminated by the caller") -> None:
        """End the simulation at the present step, with a result; nothing happens if it has ended."""
        if not self.simulation.is_over:
            self.simulation.end(reason)

    def cleanup(self) -> None:
        """Give up a simulation that has not ended: it gets no result, and the files of its records are removed."""
        if not self.simulation.is_over:
            self.simulation.cancel()

    def __enter__(self) -> Self:
        self.simulation.begin()
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        self.cleanup()
