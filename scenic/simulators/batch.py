"""Many simulations of a scenario, each a function of seed and number alone."""

from dataclasses import dataclass
from importlib import import_module
from typing import Any

from scenic.language.errors import Located
from scenic.runtime.sampling.report import Exhausted
from scenic.runtime.scenario import Scenario
from scenic.simulators.simulation import Simulation
from scenic.simulators.simulator import Simulator

__all__ = ["Numbered", "SimulatorChoiceError", "choose_simulator", "simulate_number"]


class SimulatorChoiceError(Located):
    """A simulator that cannot be had."""

    code = "SC604"


@dataclass(frozen=True, slots=True)
class Numbered:
    """Simulation ``k`` of a seed: none if there is no scene or all tries were rejected."""

    k: int
    seed: int
    tries: int
    simulation: Simulation | None
    has_scene: bool = True


def choose_simulator(name: str | None, scenario: Scenario) -> Simulator:
    """The simulator of a name: ``kinematic``, ``mujoco``, ``dummy`` or ``MODULE:CLASS``; by default the program's own, or ``kinematic``.

    Raises `SimulatorChoiceError`.
    """
    if name is None:
        if scenario.has_simulator:
            own: Simulator = scenario.getSimulator()
            return own
        name = "kinematic"
    places = {
        "kinematic": "scenic.simulators.kinematic:KinematicSimulator",
        "mujoco": "scenic.simulators.mujoco:MujocoSimulator",
        "dummy": "scenic.simulators.dummy:DummySimulator",
    }
    module, colon, cls = places.get(name, name).partition(":")
    if not colon:
        raise SimulatorChoiceError(
            f"there is no simulator {name!r}",
            help="use kinematic, mujoco, dummy, or MODULE:CLASS for one of your own",
        )
    try:
        simulator: Simulator = getattr(import_module(module), cls)()
    except (ImportError, AttributeError, TypeError) as error:
        raise SimulatorChoiceError(f"the simulator {name!r} cannot be made: {error}") from error
    return simulator


def simulate_number(
    scenario: Scenario,
    simulator: Simulator,
    *,
    seed: int,
    k: int,
    tries: int = 1,
    max_attempts: int | None = None,
    **options: Any,
) -> Numbered:
    """Simulate scene ``k`` of a seed, again with other draws while it is rejected; ``options`` are those of `simulate`."""
    (scene,) = scenario.stream(1, seed=seed, first=k, max_attempts=max_attempts)
    if isinstance(scene, Exhausted):
        return Numbered(k, seed, 0, None, has_scene=False)
    for number in range(1, tries + 1):
        key = f"{seed}:{k}:{number}".encode()
        done = simulator.simulate(scene, name=f"{k}", key=key, keep_poses=True, robustness=True, **options)
        if done is not None:
            return Numbered(k, seed, number, done)
    return Numbered(k, seed, tries, None)
