"""A simulator for tests: objects drift, and anything is an action."""

from collections.abc import Mapping, Sequence
from typing import Any

from scenic.runtime.scenes.scene import Scene
from scenic.runtime.values.values import Vector
from scenic.simulators.simulation import Simulation
from scenic.simulators.simulator import Simulator

__all__ = ["DummySimulation", "DummySimulator"]


class DummySimulation(Simulation):
    """Every object moves by ``drift`` metres along Y in each step; actions have no effect."""

    def __init__(self, scene: Scene, drift: float = 0, **options: Any) -> None:
        self.drift = drift
        super().__init__(scene, **options)

    def createObjectInSimulator(self, obj: object) -> None:
        """There is nothing to do."""

    def actionsAreCompatible(self, agent: object, actions: Sequence[object]) -> bool:
        """Any are."""
        return True

    def executeActions(self, allActions: Mapping[Any, Sequence[Any]]) -> None:
        """Nothing happens."""

    def step(self) -> None:
        """Let all objects drift."""
        if self.drift:
            for obj in self.objects:
                x, y, z = obj.position
                obj.__dict__["position"] = Vector.of((x, y + self.drift, z))

    def getProperties(self, obj: Any, properties: Any) -> Mapping[str, Any]:
        """Return the values of the properties."""
        stored = obj.__dict__
        return {name: stored[name] for name in properties}


class DummySimulator(Simulator):
    """Makes dummy simulations.

    Args:
        drift: metres along Y that objects move in each step.
        timestep: seconds in a step, where `simulate` does not say (1 if ``None``).

    """

    deterministic = True

    def __init__(self, drift: float = 0, timestep: float | None = None) -> None:
        super().__init__()
        self.drift = drift
        self.timestep = timestep

    def createSimulation(
        self, scene: Scene, *, timestep: float | None = None, **options: Any
    ) -> DummySimulation:
        """Return a simulation that has run."""
        seconds = self.timestep if timestep is None else timestep
        return DummySimulation(scene, drift=self.drift, timestep=seconds, **options)
