"""Simulators: what runs scenes."""

from abc import ABC, abstractmethod
from collections.abc import Callable
from typing import Any, Self

from scenic.graph.points import PointSet
from scenic.language.errors import GuardViolation, RejectionException, RejectSimulationException
from scenic.runtime.dynamics.chosen_draws import Sourcing, driven
from scenic.runtime.scenes.scene import Scene
from scenic.simulators.simulation import Simulation
from scenic.simulators.stepped import SteppedSimulation

__all__ = ["Simulator"]


class Simulator(ABC):
    """Runs scenes; a subclass provides `createSimulation`."""

    deterministic = False
    """True if simulations of a scene that draw the same random numbers are the same."""

    def __init__(self, verbosity: int = 0) -> None:
        self._destroyed = False
        self.verbosity = verbosity
        """Default verbosity of simulations, from 0 to 3."""

    def __enter__(self) -> Self:
        return self

    def __exit__(self, *_error: object) -> None:
        if not getattr(self, "_destroyed", False):
            self.destroy()

    def simulate(
        self,
        scene: Scene,
        maxSteps: int | None = None,
        maxIterations: int = 1,
        *,
        timestep: float | None = None,
        name: str | None = None,
        verbosity: int | None = None,
        raiseGuardViolations: bool = False,
        replay: bytes | None = None,
        enableReplay: bool = True,
        enableDivergenceCheck: bool = False,
        divergenceTolerance: float = 0,
        continueAfterDivergence: bool = False,
        allowPickle: bool = False,
        source: PointSet | Sourcing | None = None,
        onRejection: Callable[[Exception], None] | None = None,
        **options: Any,
    ) -> Simulation | None:
        """Simulate a scene until a simulation is not rejected; return ``None`` if all tries are rejected.

        Args:
            scene: what to simulate.
            maxSteps: steps of a simulation at most.
            maxIterations: simulations tried.
            timestep: seconds in a step; the simulator's own if ``None``.
            name: name of the simulation; if several tries are allowed, the number of the try is appended.
            verbosity: amount of output, from 0 to 3; the simulator's if ``None``.
            raiseGuardViolations: let a violated guard that nothing catches be raised, rather than reject the simulation.
            replay: bytes of an earlier simulation's `getReplay`.
            enableReplay: see `Simulation`, as all that follow.
            enableDivergenceCheck: keep and compare states.
            divergenceTolerance: largest difference between numbers that is not a divergence.
            continueAfterDivergence: go on with other draws.
            allowPickle: has no effect.
            source: what random numbers come from, if they are not hashed: `scenic.Sobol`, `scenic.GivenPoints` (the row of the
                scene, behind the numbers of its axes, in the order in which they are drawn) or `scenic.Conditioned`.
            onRejection: called with what rejected a simulation, each time.
            options: for the simulator.

        """
        if getattr(self, "_destroyed", False):
            raise RuntimeError("the simulator has been destroyed")
        if verbosity is None:
            verbosity = getattr(self, "verbosity", 0)
        options |= {
            "timestep": timestep,
            "replay": replay,
            "enableReplay": enableReplay,
            "enableDivergenceCheck": enableDivergenceCheck,
            "divergenceTolerance": divergenceTolerance,
            "continueAfterDivergence": continueAfterDivergence,
            "allowPickle": allowPickle,
            "verbosity": verbosity,
            "raiseGuardViolations": raiseGuardViolations,
        }
        tell = print if verbosity >= 2 else _in_silence
        for iteration in range(1, maxIterations + 1):
            label = str(iteration) if name is None else name if maxIterations == 1 else f"{name}.{iteration}"
            tell(f"  Starting simulation {label}...")
            if source is not None:
                options["source"] = _sourcing(source, scene, iteration - 1)
            try:
                simulation = self._runSingleSimulation(scene, maxSteps, name=label, **options)
            except (RejectSimulationException, RejectionException, GuardViolation) as error:
                if isinstance(error, GuardViolation) and raiseGuardViolations:
                    raise
                if onRejection is not None:
                    onRejection(error)
                tell(f"  Rejected simulation {label} because: {error}")
                continue
            if simulation.result is not None:
                reason = simulation.result.terminationReason
                tell(
                    f"  Simulation {label} ended successfully at time step {simulation.currentTime} because: {reason}"
                )
            return simulation
        return None

    def simulateStepped(
        self, scene: Scene, maxSteps: int | None = None, *, name: str | None = None, **options: Any
    ) -> SteppedSimulation:
        """Return a simulation that the caller advances. It is a context manager: it begins on entry, and is cleaned up on exit.

        Args:
            scene: what to simulate.
            maxSteps: steps at most.
            name: of the simulation.
            options: for the constructor of `Simulation`.

        """
        if getattr(self, "_destroyed", False):
            raise RuntimeError("the simulator has been destroyed")
        options = {"timestep": None, "verbosity": getattr(self, "verbosity", 0), **options}
        return SteppedSimulation(
            self.createSimulation(
                scene, maxSteps=maxSteps, name="1" if name is None else name, deferred=True, **options
            )
        )

    def replay(self, scene: Scene, replay: bytes, **options: Any) -> Simulation | None:
        """Repeat an earlier simulation of a scene, given the bytes of its `getReplay`."""
        return self.simulate(scene, replay=replay, **options)

    def _runSingleSimulation(
        self,
        scene: Scene,
        maxSteps: int | None,
        *,
        name: str,
        verbosity: int,
        raiseGuardViolations: bool = False,
        **options: Any,
    ) -> Simulation:
        return self.createSimulation(scene, maxSteps=maxSteps, name=name, verbosity=verbosity, **options)

    @abstractmethod
    def createSimulation(self, scene: Scene, **options: Any) -> Simulation:
        """Run and return a simulation of a scene; ``options`` are for the constructor of `Simulation`."""

    def destroy(self) -> None:
        """Clean up, once; the simulator cannot be used any more."""
        if getattr(self, "_destroyed", False):
            raise RuntimeError("the simulator has been destroyed already")
        self._destroyed = True


def _sourcing(source: PointSet | Sourcing, scene: Scene, attempt: int) -> Sourcing:
    if callable(source):
        return source
    return driven(source, scene.dimension, seed=scene.seed, scene=scene.k, attempt=attempt)


def _in_silence(_: str) -> None:
    """Take a message and print nothing."""
