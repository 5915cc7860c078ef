"""Many simulations of a scenario, each a function of seed and number alone."""

from collections import Counter
from collections.abc import Callable
from importlib import import_module
from types import MappingProxyType
from typing import Any, Final

from scenic.dataclass import dataclass
from scenic.graph.points import Sobol
from scenic.language.errors import Located, RejectionException
from scenic.language.spelling import nearest_option
from scenic.runtime.dynamics.chosen_draws import driven
from scenic.runtime.sampling.rejection_report import Exhausted
from scenic.runtime.scenes.scenario import Scenario
from scenic.simulators.simulation import OnState, Simulation
from scenic.simulators.simulator import Simulator

__all__ = ["Numbered", "SimulatorChoiceError", "choose_simulator", "simulate_number"]


class SimulatorChoiceError(Located):
    """A simulator that cannot be had."""

    code = "SC604"


@dataclass(frozen=True, slots=True)
class Numbered:
    """Simulation ``k`` of a seed, without a simulation if there is no scene or all tries were rejected."""

    k: int
    seed: int
    tries: int
    simulation: Simulation | None
    exhausted: Exhausted | None = None
    """The reason why no scene was found, if none was."""
    rejections: tuple[tuple[str, int], ...] = ()
    """Reasons for which tries were rejected, and how many each; the most frequent first."""
    is_random: bool = True
    """False if another try would be the same simulation again: the simulator is deterministic, and nothing was drawn."""

    @property
    def has_scene(self) -> bool:
        """True if a scene was found."""
        return self.exhausted is None


def choose_simulator(name: str | None, scenario: Scenario) -> Simulator:
    """The simulator of a name: ``kinematic``, ``mujoco``, ``newtonian``, ``dummy`` or ``MODULE:CLASS``; by default the program's own, or ``kinematic``.

    Raises `SimulatorChoiceError`.
    """
    if name is None and scenario.has_simulator:
        return _checked(scenario.getSimulator(), "what the program names")
    name = name or "kinematic"
    module, colon, cls = _PLACES.get(name, name).partition(":")
    if not (module and colon and cls):
        plain = name.lower()
        similar_name = plain if plain in _PLACES else nearest_option(plain, _PLACES)
        alternative = "or MODULE:CLASS for one of your own"
        raise SimulatorChoiceError(
            f"there is no simulator {name!r}",
            help=f"did you mean `{similar_name}`?"
            if similar_name
            else f"use {', '.join(_PLACES)}, {alternative}",
        )
    try:
        simulator = getattr(import_module(module), cls)()
    except Located:
        raise
    except Exception as error:  # whatever a simulator does when it begins
        words = str(error) or type(error).__name__
        raise SimulatorChoiceError(f"the simulator {name!r} cannot be made: {words}") from error
    return _checked(simulator, repr(name))


_PLACES: Final = MappingProxyType(
    {
        "kinematic": "scenic.simulators.kinematic:KinematicSimulator",
        "mujoco": "scenic.simulators.mujoco:MujocoSimulator",
        "newtonian": "scenic.simulators.newtonian:NewtonianSimulator",
        "dummy": "scenic.simulators.dummy:DummySimulator",
    }
)


def _checked(made: Any, what: str) -> Simulator:
    if not callable(getattr(made, "simulate", None)):
        raise SimulatorChoiceError(
            f"{what} is no simulator, but an object of the class {type(made).__name__}",
            help="simulators derive from `scenic.simulators.simulator.Simulator`",
        )
    simulator: Simulator = made
    return simulator


def simulate_number(
    scenario: Scenario,
    simulator: Simulator,
    *,
    seed: int,
    k: int,
    tries: int = 1,
    max_attempts: int | None = None,
    sobol: bool = False,
    beginning: Callable[[], OnState | None] = lambda: None,
    **options: Any,
) -> Numbered:
    """Simulate scene ``k`` of a seed, again with other draws while it is rejected; ``options`` are those of `simulate`.

    A rejected simulation is not made again if nothing in it is random. ``sobol`` says that scenes and simulations are rows of
    Sobol's sequence. ``beginning`` is called before each try, and gives what is then called with its states.
    """
    points = Sobol() if sobol else None
    (scene,) = scenario.stream(1, seed=seed, first=k, max_attempts=max_attempts, source=points)
    if isinstance(scene, Exhausted):
        return Numbered(k, seed, 0, None, exhausted=scene)
    reasons: Counter[str] = Counter()
    draws: Counter[str] = Counter()
    for number in range(1, tries + 1):
        key = f"{seed}:{k}:{number}".encode()
        if points is not None:
            options["source"] = driven(points, scene.dimension, seed=seed, scene=k, attempt=number - 1)
        simulation = simulator.simulate(
            scene,
            name=f"{k}",
            key=key,
            on_state=beginning(),
            robustness=True,
            on_random=lambda: draws.update(["numbers"]),
            onRejection=lambda error: reasons.update([_reason(error)]),
            **options,
        )
        is_random = bool(draws) or not getattr(simulator, "deterministic", False)
        if simulation is not None or not is_random:
            return Numbered(
                k, seed, number, simulation, rejections=tuple(reasons.most_common()), is_random=is_random
            )
    return Numbered(k, seed, tries, None, rejections=tuple(reasons.most_common()))


def _reason(error: Exception) -> str:
    """Return the reason why a simulation was rejected, in a few words; of a rejection by a value, with its place."""
    notes = getattr(error, "__notes__", ()) if isinstance(error, RejectionException) else ()
    words = str(error) or f"`raise {type(error).__name__}` in the program"
    return ": ".join([words, *notes])
