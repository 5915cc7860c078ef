"""Many simulations of a scenario, made by several processes, each a function of seed and number alone."""

import random
import re
from collections.abc import Generator, Iterator, Mapping, Sequence
from contextlib import AbstractContextManager, closing, nullcontext
from dataclasses import replace
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING, Any, Final

from scenic.batch.engines import BatchEngine, OverExecutor, Processes
from scenic.batch.folders.file_digests import files_of_origin
from scenic.batch.keeping import Form, SimulationRecord, Watcher, about_file, is_whole
from scenic.batch.simulation_folders import SimulationFolder
from scenic.dataclass import dataclass
from scenic.language.diagnostics import Diagnostic, Severity
from scenic.runtime.ground.arguments import check_seconds, whole_number

if TYPE_CHECKING:
    from concurrent.futures import Executor

    from scenic.runtime.sampling.rejection_report import Exhausted
    from scenic.runtime.scenes.scenario import Scenario
    from scenic.simulators.numbered_simulations import Numbered
    from scenic.simulators.simulator import Simulator

__all__ = [
    "FailedSimulationError",
    "SimulationRow",
    "SimulationSettings",
    "Simulations",
    "is_violated",
    "nothing_happens",
    "simulated",
]

_TRIES: Final = 3
"""Processes that may die at a simulation until it counts as failed."""

_NOTHING_KEPT: Final = (
    "nothing of this simulation is kept; make room or name another place, and give the same command again"
)


@dataclass(frozen=True, slots=True)
class SimulationSettings:
    """Settings of simulations; everything here but ``stuck_after`` decides the results."""

    seed: int
    max_steps: int | None = 100
    timestep: float | None = None
    """Seconds in a step; the simulator's own if ``None``."""
    tries: int = 20
    """Simulations tried of one scene before it is given up as rejected."""
    stuck_after: float = 10.0
    """Seconds that the program may run within one step."""
    keep_violations: bool = False
    """True if a simulation that violates a requirement runs to its end, rather than being rejected."""
    sobol: bool = False
    """True if scenes and simulations are rows of Sobol's sequence."""

    def options(self) -> dict[str, Any]:
        """Return the arguments of `simulate_number` that decide what comes out."""
        options: dict[str, Any] = {
            "seed": self.seed,
            "maxSteps": self.max_steps,
            "timestep": self.timestep,
            "tries": self.tries,
        }
        if self.keep_violations:
            options["keep_violations"] = True
        return {**options, "sobol": True} if self.sobol else options


@dataclass(frozen=True, slots=True)
class SimulationRow:
    """The outcome of simulation ``k``: exactly one of ``about``, ``missing`` and ``error`` is set.

    Attributes:
        k: its number in the run of the seed.
        about: the document about the whole simulation (`scenic.formats.trajectories.course_document`): steps, why it ended,
            verdicts and robustness of requirements, records.
        page: data for the page that plays it, if one is wanted.
        missing: why there is no simulation (no scene was found, or all tries were rejected).
        rejections: the reasons that rejected the tries with their counts, the most frequent first.
        exhausted: the requirements that kept a scene from being found, where none was.
        error: what went wrong.

    """

    k: int
    about: Mapping[str, Any] | None = None
    page: Mapping[str, Any] | None = None
    missing: str | None = None
    rejections: tuple[tuple[str, int], ...] = ()
    error: Diagnostic | None = None
    exhausted: "Exhausted | None" = None


class FailedSimulationError(RuntimeError):
    """A simulation that failed; ``row`` identifies it, and its ``error`` has the reason."""

    def __init__(self, row: SimulationRow) -> None:
        assert row.error is not None
        super().__init__(f"simulation {row.k} failed: {row.error.message}")
        self.row = row


class Simulations:
    """Makes simulations of a scenario by their numbers.

    Args:
        scenario: what to simulate; other processes compile its program for themselves.
        simulator: the name of a simulator (see `choose_simulator`), or a simulator, which must be picklable where other
            processes are not forked.
        running: how simulations run.
        folder: where trajectories are kept, if anywhere.
        form: the format of their files.
        shown: whether rows carry data for a page.
        only_violations: whether only simulations that violate a requirement are kept in the folder and shown.
        watcher: called with each of these simulations, in this process.

    Raises:
        SimulatorChoiceError: if there is no such simulator.

    """

    def __init__(
        self,
        scenario: "Scenario",
        simulator: "str | Simulator | None",
        running: SimulationSettings,
        *,
        folder: Path | None = None,
        form: Form = "jsonl",
        shown: bool = False,
        only_violations: bool = False,
        watcher: Watcher | None = None,
    ) -> None:
        self._watcher = watcher
        self._only_violations = only_violations
        self._scenario = scenario
        self._named = simulator
        self._running = running
        self._folder = folder
        self._form: Form = form
        self._shown = shown
        self._simulator: Simulator | None = None
        self._looking_back: bool | None = None
        self.origin = {**scenario.origin, "simulator": self.named, **files_of_origin(scenario)}
        """The way to load the program again, and the digests of the files that decide what comes out."""
        self.simulator  # noqa: B018 - raises at once what is wrong with it

    def __getstate__(self) -> dict[str, Any]:
        # A process that starts afresh makes its own simulator.
        return {**self.__dict__, "_simulator": None}

    @property
    def simulator(self) -> "Simulator":
        """The simulator of this process."""
        from scenic.simulators.simulator import Simulator

        if isinstance(self._named, Simulator):
            return self._named
        if self._simulator is None:
            self._simulator = self._choose(self._named)
        return self._simulator

    @property
    def named(self) -> str | None:
        """The name of the simulator as it was given, if it was."""
        from scenic.simulators.simulator import Simulator

        return None if isinstance(self._named, Simulator) else self._named

    def _choose(self, name: str | None) -> "Simulator":
        from scenic.runtime.python.importing import beside, forget_stranger
        from scenic.simulators.numbered_simulations import choose_simulator

        # A simulator of the user's own may lie beside the program, like everything that the program imports.
        folder = Path(self._scenario.filename).absolute().parent
        module, colon, _ = (name or "").partition(":")
        if colon:
            forget_stranger(module, folder)
        with beside(folder):
            return choose_simulator(name, self._scenario)

    def course_options(self) -> dict[str, Any]:
        """Return the arguments of `Simulator.simulate` that say how a simulation runs."""
        running = self._running
        return {
            "maxSteps": running.max_steps,
            "timestep": running.timestep,
            "stuck_after": running.stuck_after,
        }

    def rows(
        self, numbers: Sequence[int], engine: BatchEngine | None = None
    ) -> Generator[SimulationRow, None, None]:
        """The simulations of these numbers, in any order, as the engine (else this process) makes them."""
        if engine is None or len(numbers) < 2:
            yield from map(self, numbers)
            return
        left = list(numbers)
        for tries in range(_TRIES, 0, -1):
            gone: set[int] = set()

            def lost(k: int, code: int, gone: set[int] = gone) -> SimulationRow:
                gone.add(k)
                return _lost(k, code)

            for _, row in engine.run(self, left, lost=lost):
                if row.k not in gone or tries == 1:
                    yield row
            left = sorted(gone)
            if not left:
                return

    def opened(self, *, resume: bool, accept_changes: bool = False) -> AbstractContextManager[object]:
        """Return the folder, locked within a ``with`` block; nothing where simulations are not kept. See `SimulationFolder`."""
        if self._folder is None:
            return nullcontext()
        settings = {
            **self._settings(),
            "form": self._form,
            "kept": "violations" if self._only_violations else "all",
        }
        return SimulationFolder(
            self._folder, settings, self.origin, resume=resume, accept_changes=accept_changes
        )

    def known(self, k: int) -> SimulationRow | None:
        """Return simulation ``k`` as an earlier run has kept it whole, if that was of the same program, seed and settings."""
        path = self._file(k)
        if path is None or self._shown:
            return None
        try:
            document = about_file(path, self._form)
            if not isinstance(document, dict) or document.get("settings") != self._settings():
                return None
            if self._form == "jsonl" and not is_whole(path, document["steps"]):
                return None
        except (OSError, ValueError, KeyError):
            return None
        return SimulationRow(k, about=document)

    def _file(self, k: int) -> Path | None:
        return None if self._folder is None else self._folder / f"simulation-{k:04d}.{self._form}"

    def _settings(self) -> dict[str, Any]:
        """Return what a simulation depends on beside its number."""
        return {
            "program": self._scenario.digest,
            "simulator": type(self.simulator).__name__,
            **self._running.options(),
        }

    def __call__(self, k: int) -> SimulationRow:
        """Make simulation ``k`` and its file. Raises nothing but interruptions."""
        try:
            return self._one(k)
        except SystemExit as error:
            message = (
                f"the simulator or the program has asked for the end of the process (exit code {error.code})"
            )
            return SimulationRow(k, error=Diagnostic("SC503", message, help="raise an exception instead"))
        except Exception as error:  # noqa: BLE001 - it is reported, and the other simulations go on
            return SimulationRow(k, error=_failure(error))

    def _one(self, k: int) -> SimulationRow:
        from scenic.formats.trajectories import course_document

        keeping = SimulationRecord(self._file(k), self._form, shown=self._shown, watcher=self._watcher)
        with closing(keeping) as keeper:
            result = self._simulated(k, keeper)
            simulation = result.simulation
            if simulation is None:
                return SimulationRow(
                    k,
                    missing=_why_missing(result),
                    rejections=result.rejections,
                    exhausted=result.exhausted,
                )
            about = {
                **course_document(simulation, k=k, tries=result.tries),
                "settings": self._settings(),
                "origin": self.origin,
            }
            is_kept = not self._only_violations or is_violated(about)
            return SimulationRow(k, about=about, page=keeper.finish(simulation, about) if is_kept else None)

    def _simulated(self, k: int, kept: SimulationRecord) -> "Numbered":
        """Run simulation ``k``, with its whole course in memory if the program's text looks back at it.

        Code elsewhere may do so, too: then the simulation is made again. Each simulation decides this for itself, so that
        files do not depend on which simulations a process makes.
        """
        from scenic.simulators.numbered_simulations import simulate_number
        from scenic.simulators.results import NotKeptError

        simulate = partial(
            simulate_number,
            self._scenario,
            self.simulator,
            k=k,
            stuck_after=self._running.stuck_after,
            stuck_is_error=True,
            beginning=kept.begin,
            enableReplay=False,
            **self._running.options(),
        )
        if self._looks_back():
            return simulate(keep_course=True)
        try:
            result = simulate(keep_course=False)
        except Exception as error:
            if not (kept.looked_back() or NotKeptError.behind(error)):
                raise
        else:
            if not kept.looked_back():
                return result
        return simulate(keep_course=True)

    def _looks_back(self) -> bool:
        """Return whether the program's text names something that needs the whole course."""
        if self._looking_back is None:
            self._looking_back = any(name in self._scenario.text for name in ("trajectory", "actionSequence"))
        return self._looking_back


def nothing_happens(scenario: "Scenario", simulator: "Simulator") -> Diagnostic | None:
    """Return SC407 if nothing moves in any simulation of a scenario: no object has a behavior or a velocity, and none falls."""
    from scenic.runtime.values.values import is_random

    if type(simulator).__name__ not in _WITHOUT_FALLING or _RUNS.search(scenario.text):
        return None
    for thing in scenario.objects:
        velocities = (thing.velocity, thing.angularVelocity)
        if thing.behavior is not None or any(is_random(each) or any(each) for each in velocities):
            return None
    return Diagnostic(
        "SC407",
        "nothing happens in this simulation: no object has a behavior",
        severity=Severity.WARNING,
        help="give an object a behavior: `with behavior FollowLaneBehavior()`",
    )


_WITHOUT_FALLING: Final = frozenset({"KinematicSimulator", "NewtonianSimulator", "DummySimulator"})
"""Simulators in which what has no behavior and no velocity stays where it is."""
_RUNS: Final = re.compile(r"\b(?:compose|monitor)\b")
"""Words of programs in which more may happen than their objects do."""


def is_violated(about: Mapping[str, Any]) -> bool:
    """Return whether a simulation, by the document about it, violates a requirement or leaves one unmet at its end."""
    return any(item["verdict"] in ("FALSE", "PRESUMABLY_FALSE") for item in about["requirements"])


def simulated(
    scenario: "Scenario",
    n: int,
    *,
    seed: int | None = None,
    first: int = 0,
    simulator: "str | Simulator | None" = None,
    max_steps: int | None = 100,
    timestep: float | None = None,
    tries: int = 20,
    keep_violations: bool = False,
    shown: bool = False,
    folder: str | Path | None = None,
    resume: bool = False,
    processes: int = 1,
    executor: "Executor | None" = None,
) -> list[SimulationRow]:
    """Simulate scenes ``first`` to ``first + n`` of a seed.

    Args:
        scenario: the scenario.
        n: how many simulations.
        seed: any integer (drawn from Python's ``random`` if not given); simulation ``k`` of a seed is always the same.
        first: the number of the first one.
        simulator: ``kinematic``, ``mujoco``, ``dummy``, ``MODULE:CLASS`` or a simulator; the program's own by default.
        max_steps: steps of a simulation at most.
        timestep: seconds in a step; the simulator's own if not given.
        tries: simulations tried of one scene before it is given up as rejected.
        keep_violations: let simulations that violate a requirement run to their end, rather than reject them.
        shown: let each row carry what a page needs to play it, so that notebooks do.
        folder: where trajectories are kept: a new folder, or one without simulations.
        resume: whether to go on with the simulations that the folder holds, which must be of the same program, seed and settings.
        processes: how many processes simulate. Changes speed, never what comes out.
        executor: runs the simulations in place of processes of our own, ``processes`` at a time.

    Returns:
        The rows of all simulations, in order.

    Raises:
        ValueError: for a number or time that is not allowed.
        FailedSimulationError: if the program or the simulator fails in one of them.
        SimulatorChoiceError: if there is no such simulator.
        SimulationFolderError: if the folder holds other simulations, or some that are not to be gone on with.

    """
    n, first = whole_number(n, "n", 0), whole_number(first, "first", 0)
    seed = None if seed is None else whole_number(seed, "seed")
    processes, tries = whole_number(processes, "processes", 1), whole_number(tries, "tries", 1)
    max_steps = whole_number(max_steps, "max_steps", 0)
    check_seconds(timestep, "timestep")
    place = None if folder is None else Path(folder)
    running = SimulationSettings(
        random.getrandbits(63) if seed is None else seed,
        max_steps,
        timestep,
        tries,
        keep_violations=keep_violations,
    )
    batch = Simulations(scenario, simulator, running, folder=place, shown=shown)
    numbers = range(first, first + n)
    engine: BatchEngine | None = None
    if executor is not None:
        engine = OverExecutor(executor, max(2, processes))
    elif processes > 1:
        engine = Processes(processes)
    with batch.opened(resume=resume):
        row_of = {row.k: row for row in _known(batch, numbers)}
        with closing(batch.rows([k for k in numbers if k not in row_of], engine)) as rows:
            for row in rows:
                if row.error is not None:
                    raise FailedSimulationError(row)
                row_of[row.k] = row
    return [row_of[k] for k in numbers]


def _known(batch: Simulations, numbers: Sequence[int]) -> Iterator[SimulationRow]:
    return (row for k in numbers if (row := batch.known(k)) is not None)


def _failure(error: Exception) -> Diagnostic:
    from scenic.failures import diagnose
    from scenic.formats.files import OutputError

    diagnostic = diagnose(error)
    if diagnostic is None:
        message = f"{type(error).__name__}: {error}"
        diagnostic = Diagnostic("SC503", message, help="the simulator raised this")
    if isinstance(error, OutputError) or (isinstance(error, OSError) and error.filename is not None):
        diagnostic = replace(diagnostic, help=_NOTHING_KEPT)
    return diagnostic


def _why_missing(numbered: "Numbered") -> str:
    """Return the reason why there is no simulation of a number, in words."""
    if not numbered.has_scene:
        return "no scene found"
    if numbered.is_random:
        return f"rejected ({numbered.tries} tried)"
    return f"rejected ({numbered.tries} tried: another would be the same simulation again, for nothing in it is random)"


def _lost(k: int, code: int) -> SimulationRow:
    message = f"the process of simulation {k} died (exit code {code})"
    advice = "its simulator may crash or lack memory: use fewer processes (-j 1), or try this simulation alone (--first)"
    return SimulationRow(k, error=Diagnostic("SC503", message, help=advice))
