"""``scenic simulate``: simulations of a program, their trajectories, and what became of its requirements."""

import faulthandler
import json
import secrets
import sys
from collections.abc import Generator, Mapping
from contextlib import closing
from dataclasses import replace
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING, Any, Final

import click

from scenic.cli import workers
from scenic.cli.options import program_options, seconds, sobol_option
from scenic.cli.output import CLEAN, FINDINGS, show_diagnostics
from scenic.cli.sample import NOT_ALL, _ended_by_signals, _progress
from scenic.cli.sinks import check_page
from scenic.formats.files import OutputError
from scenic.language.diagnostics import Diagnostic

if TYPE_CHECKING:
    from scenic.formats.course_page import PoseTape
    from scenic.formats.trajectories import TrajectoryFile
    from scenic.simulators.batch import Numbered
    from scenic.simulators.simulation import OnState, Poses, Simulation

__all__ = ["simulate"]

_FIRST_LINE: Final = 1 << 24
"""The longest first line of a file of ours that is looked at."""


_NOTHING_KEPT: Final = (
    "nothing of this simulation is kept; make room or name another place, and give the same command again"
)


class _Work:
    """What makes simulations by their numbers; each process loads the program for itself."""

    def __init__(
        self,
        loading: Mapping[str, Any],
        simulator: str | None,
        running: Mapping[str, Any],
        folder: Path | None,
        form: str,
        whole: bool,
    ) -> None:
        self._loading = loading
        self._simulator = simulator
        self._running = running
        self._folder = folder
        self._form = form
        self._whole = whole
        self._made: Any = None
        self._named: bool | None = None

    def __getstate__(self) -> dict[str, Any]:
        # Not what cannot go to a process that starts afresh.
        return {**self.__dict__, "_made": None}

    def load(self) -> tuple[Any, Any]:
        """The scenario and the simulator; raises what is wrong with either."""
        if self._made is None:
            from scenic.pipeline import load
            from scenic.runtime.python.importing import beside, forget_stranger
            from scenic.simulators.batch import choose_simulator

            scenario = load(**self._loading)
            # A simulator of one's own may lie beside the program, like everything that the program imports.
            folder = Path(self._loading["path"]).absolute().parent
            module, colon, _ = (self._simulator or "").partition(":")
            if colon:
                forget_stranger(module, folder)
            with beside(folder):
                self._made = scenario, choose_simulator(self._simulator, scenario)
        made: tuple[Any, Any] = self._made
        return made

    def file(self, k: int) -> Path | None:
        """Where simulation ``k`` is kept."""
        return None if self._folder is None else self._folder / f"simulation-{k:04d}.{self._form}"

    def _looks_back(self) -> bool:
        """Whether the program's text has the name of something that all of the course is needed for."""
        if self._named is None:
            text = Path(self._loading["path"]).read_bytes()
            self._named = any(name in text for name in (b"trajectory", b"actionSequence"))
        return self._named

    def known(self, k: int) -> dict[str, Any] | None:
        """What an earlier run has kept of simulation ``k``, if that was of the same program, seed and settings."""
        path = self.file(k)
        if path is None or self._whole:
            return None
        try:
            found = self._about(path)
        except (OSError, ValueError):
            return None
        if not isinstance(found, dict) or found.get("settings") != self.settings():
            return None
        return found

    def _about(self, path: Path) -> Any:
        """What a file says of the whole simulation."""
        if self._form == "parquet":
            from scenic.formats.trajectory_tables import parquet_about

            return parquet_about(path)
        with path.open(encoding="utf-8") as stream:
            return json.loads(stream.readline(_FIRST_LINE))

    def settings(self) -> dict[str, Any]:
        """What a simulation depends on beside its number."""
        scenario, simulator = self.load()
        running = {name: value for name, value in self._running.items() if name != "stuck_after"}
        return {"program": scenario.digest, "simulator": type(simulator).__name__, **running}

    def __call__(self, k: int) -> dict[str, Any]:
        """Make simulation ``k`` and its file; says what came of it. Raises nothing but interruptions."""
        try:
            return self._one(k)
        except SystemExit as error:
            message = (
                f"the simulator or the program has asked for the end of the process (exit code {error.code})"
            )
            return {"k": k, "error": Diagnostic("SC503", message, help="raise an exception instead")}
        except Exception as error:  # noqa: BLE001 - it is reported, and the other simulations go on
            from scenic.pipeline import diagnose

            found = diagnose(error)
            if found is None:
                message = f"{type(error).__name__}: {error}"
                found = Diagnostic("SC503", message, help="the simulator raised this")
            if isinstance(error, OutputError) or (isinstance(error, OSError) and error.filename is not None):
                found = replace(found, help=_NOTHING_KEPT)
            return {"k": k, "error": found}

    def _one(self, k: int) -> dict[str, Any]:
        from scenic.formats.trajectories import course_document

        with closing(_Kept(self.file(k), self._form, self._whole)) as kept:
            numbered = self._simulated(k, kept)
            done = numbered.simulation
            if done is None:
                what = f"rejected ({numbered.tries} tried)" if numbered.has_scene else "no scene found"
                return {"k": k, "missing": what, "rejections": numbered.rejections}
            about = {**course_document(done, k=k, tries=numbered.tries), "settings": self.settings()}
            return {"k": k, "about": about, "page": kept.finish(done, about)}

    def _simulated(self, k: int, kept: "_Kept") -> "Numbered":
        """Simulation ``k``, with its whole course in memory if the program's text tells that it looks back at it.

        Code elsewhere may do so, too: then it is made again. Each decides for itself, so that files do not depend on
        which simulations a process makes.
        """
        from scenic.simulators.batch import simulate_number
        from scenic.simulators.results import NotKeptError

        scenario, simulator = self.load()
        simulate = partial(
            simulate_number,
            scenario,
            simulator,
            k=k,
            stuck_is_error=True,
            beginning=kept.begin,
            enableReplay=False,
            **self._running,
        )
        if self._looks_back():
            return simulate(keep_course=True)
        try:
            numbered = simulate(keep_course=False)
        except Exception as error:
            if not (kept.looked_back() or NotKeptError.behind(error)):
                raise
        else:
            if not kept.looked_back():
                return numbered
        return simulate(keep_course=True)


class _Kept:
    """What is kept of a simulation while it runs, and again from the beginning when it is tried again.

    Args:
        path: the file of its trajectory, if there is to be one.
        form: of that file, ``jsonl`` or ``parquet``.
        shown: whether it goes onto a page.

    """

    def __init__(self, path: Path | None, form: str, shown: bool) -> None:
        self._path = path
        self._form = form
        self._shown = shown
        self._file: TrajectoryFile | None = None
        self._tape: PoseTape | None = None
        self._simulation: Simulation | None = None
        self._looked_back = False

    def begin(self) -> "OnState":
        """What is to be called with each state of a try."""
        from scenic.formats.course_page import PoseTape
        from scenic.formats.trajectories import LinesFile
        from scenic.formats.trajectory_tables import ParquetFile

        self.close()
        self.looked_back()
        if self._path is not None:
            self._file = ParquetFile(self._path) if self._form == "parquet" else LinesFile(self._path)
        self._tape = PoseTape() if self._shown else None
        return self._add

    def _add(self, simulation: "Simulation", poses: "Poses", actions: Mapping[Any, Any]) -> None:
        from scenic.formats.trajectories import step_document

        self._simulation = simulation
        if self._file is not None:
            self._file.add(step_document(simulation, poses, actions))
        if self._tape is not None:
            self._tape.add(poses)

    def looked_back(self) -> bool:
        """Whether a try asked for more of its course than was kept."""
        from scenic.simulators.results import Latest

        if self._simulation is not None:
            courses = self._simulation.trajectory, self._simulation.actionSequence
            self._looked_back |= any(isinstance(course, Latest) and course.missed for course in courses)
        return self._looked_back

    def finish(self, simulation: "Simulation", about: Mapping[str, Any]) -> dict[str, Any] | None:
        """Complete the file; what the page needs."""
        from scenic.formats.course_page import course_data

        if self._file is not None:
            self._file.finish(about)
        return None if self._tape is None else course_data(simulation, self._tape)

    def close(self) -> None:
        """Give up what is not finished."""
        if self._file is not None:
            self._file.close()
            self._file = None


@click.command()
@click.argument("file", metavar="FILE")
@click.option(
    "-n",
    "count",
    metavar="N",
    type=click.IntRange(min=1),
    default=1,
    help="How many simulations.  [default: 1]",
)
@click.option(
    "--first",
    metavar="K",
    type=click.IntRange(min=0),
    default=0,
    help="Number of the first one.  [default: 0]",
)
@click.option(
    "--seed",
    metavar="S",
    type=int,
    help="Simulations of one seed are always the same. Without it, one is drawn and shown.",
)
@click.option(
    "--simulator",
    metavar="NAME",
    help="kinematic, mujoco, dummy, or MODULE:CLASS.  [default: the program's, else kinematic]",
)
@click.option(
    "--time",
    "max_steps",
    metavar="STEPS",
    type=click.IntRange(min=0),
    default=100,
    help="Steps of a simulation at most.  [default: 100]",
)
@click.option(
    "--timestep",
    metavar="T",
    type=float,
    callback=seconds,
    help="Seconds in a step.  [default: the simulator's]",
)
@click.option(
    "--tries",
    metavar="M",
    type=click.IntRange(min=1),
    default=20,
    help="Simulate a scene so often before giving it up as rejected.  [default: 20]",
)
@sobol_option
@click.option(
    "--step-limit",
    metavar="T",
    type=float,
    callback=seconds,
    default=10.0,
    help="Seconds that the program may run within one step.  [default: 10]",
)
@program_options
@click.option(
    "-j", "jobs", metavar="J", type=click.IntRange(min=1), default=1, help="Processes.  [default: 1]"
)
@click.option(
    "-o",
    "--output",
    metavar="DIR",
    type=click.Path(path_type=Path),
    help="Keep the trajectories in this folder; those that are there already are not made again.",
)
@click.option(
    "--format",
    "form",
    type=click.Choice(["jsonl", "parquet"]),
    default="jsonl",
    show_default=True,
    help="How to keep them: JSON Lines, or columns (needs the extra `parquet`).",
)
@click.option(
    "--view",
    metavar="PAGE.html",
    type=click.Path(path_type=Path),
    help="Make a page that plays the simulations.",
)
def simulate(
    file: str,
    count: int,
    first: int,
    seed: int | None,
    simulator: str | None,
    max_steps: int,
    timestep: float | None,
    tries: int,
    sobol: bool,
    step_limit: float,
    parameters: Mapping[str, Any],
    scenario: str | None,
    model: str | None,
    mode_2d: bool,
    jobs: int,
    output: Path | None,
    form: str,
    view: Path | None,
) -> int:
    """Simulate scenes of a program.

    Simulation K of a seed is always the same, whatever the number of processes. Files are complete or absent, so that a run
    that was ended can be called again and goes on.

    Exit codes: 0 success, 1 the program has errors, 2 wrong usage, 3 some simulations were rejected (the others are
    there), 130 interrupted.
    """
    from scenic.formats.files import make_folder, write

    # What a library of a simulator does may end the process without a word.
    if not faulthandler.is_enabled() and sys.stderr is sys.__stderr__:
        faulthandler.enable()
    if view is not None:
        check_page(view)
    if form == "parquet":
        from scenic.formats.trajectory_tables import parquet_support

        parquet_support()
    if output is not None:
        make_folder(output)
    is_drawn = seed is None
    seed = secrets.randbits(32) if seed is None else seed
    loading = {
        "path": Path(file),
        "params": parameters,
        "model": model,
        "scenario": scenario,
        "mode2D": mode_2d,
    }
    running = {
        "seed": seed,
        "maxSteps": max_steps,
        "timestep": timestep,
        "tries": tries,
        "stuck_after": step_limit,
        **({"sobol": True} if sobol else {}),
    }
    work = _Work(loading, simulator, running, output, form, view is not None)
    work.load()
    if is_drawn:
        sys.stderr.write(f"seed {seed} (the same simulations again: --seed {seed})\n")
    numbers = range(first, first + count)
    found: dict[int, dict[str, Any]] = {
        k: {"k": k, "about": about, "page": None} for k in numbers if (about := work.known(k)) is not None
    }
    missing = [k for k in numbers if k not in found]
    with (
        _ended_by_signals(),
        _progress(len(missing), shown=not sys.stdout.isatty()) as advance,
        closing(_rows(work, missing, jobs)) as rows,
    ):
        for row in rows:
            found[row["k"]] = row
            advance(1, 1)
    code = CLEAN
    for k in numbers:
        code = max(code, _show(found[k]))
    if view is not None:
        from scenic.formats.course_page import course_page

        made = [found[k]["page"] for k in numbers if "about" in found[k]]
        if made:
            write(view, course_page(Path(file).name, made).encode())
    failed = any("error" in row for row in found.values())
    return FINDINGS if failed else code


def _rows(work: _Work, numbers: list[int], jobs: int) -> Generator[dict[str, Any], None, None]:
    if jobs == 1 or len(numbers) < 2:
        yield from map(work, numbers)
        return
    for _, row in workers.run(work, numbers, jobs=jobs, lost=_lost):
        yield row


def _lost(k: int, code: int) -> dict[str, Any]:
    return {"k": k, "error": Diagnostic("SC503", f"the process of simulation {k} died (exit code {code})")}


def _show(row: Mapping[str, Any]) -> int:
    """Print what came of a simulation; the exit code that it asks for."""
    k = row["k"]
    if "error" in row:
        sys.stderr.write(f"simulation {k} failed:\n")
        show_diagnostics([row["error"]])
        return FINDINGS
    if "missing" in row:
        print(f"simulation {k}: {row['missing']}")
        for reason, times in row["rejections"]:
            print(f"  {reason}: {times} {'try' if times == 1 else 'tries'}")
        return NOT_ALL
    about = row["about"]
    print(f"simulation {k}: {about['steps']} steps, {about['reason']}")
    for item in about["requirements"]:
        verdict = "not evaluated" if item["verdict"] is None else item["verdict"].lower().replace("_", " ")
        margin = item["robustness"]
        by = f", robustness {margin:.4g}" if isinstance(margin, float) else ""
        print(f"  {item['label']}: {verdict}{by}")
    return CLEAN
