"""Runs that were kept, made again: those of a search, and simulations of ``scenic simulate -o``."""

import tempfile
from collections.abc import Mapping, Sequence
from dataclasses import field
from pathlib import Path
from typing import TYPE_CHECKING, Any, Final, cast

from scenic.batch.folders.file_digests import file_digests
from scenic.batch.folders.folder import check_files
from scenic.batch.keeping import Form, about_file
from scenic.batch.simulations import Simulations, SimulationSettings
from scenic.dataclass import dataclass
from scenic.falsification.comparing import file_departures, row_departures
from scenic.falsification.evaluating import Evaluation, RunTask
from scenic.falsification.lineages import Ancestry, Held, Lineage, lineages_of
from scenic.falsification.objectives import Objective, ObjectiveError
from scenic.falsification.search_folder import folders_of, kind_of, read_rows
from scenic.falsification.space import space_of
from scenic.language.errors import Located, MissingFileError

if TYPE_CHECKING:
    from scenic.formats.course_page import PoseTape
    from scenic.formats.course_pictures import StatePictures
    from scenic.runtime.scenes.scenario import Scenario
    from scenic.simulators.simulation import Simulation
    from scenic.simulators.simulator import Simulator

__all__ = ["KeptRun", "ReplayError", "ReplayedRun", "kept_run", "program_of", "replay"]

_FORMS: Final = ("jsonl", "parquet", "xosc", "xml")


class ReplayError(Located):
    """A run that is not kept, or cannot be made again."""

    code = "SC609"


@dataclass(frozen=True, slots=True)
class KeptRun:
    """A run as it was kept.

    Attributes:
        number: of the run in its search, or of the simulation in its seed.
        origin: how to load the program: ``file``, ``options`` of `scenic.load`, and ``simulator``.
        settings: everything else that the run depends on.
        row: of a search, what was kept of the run; ``None`` of a simulation.
        trajectory: the file of its states, if there is one.
        scene: the file of its scene, if there is one.
        lineage: of a run that was made by moves, those.

    """

    number: int
    origin: Mapping[str, Any]
    settings: Mapping[str, Any]
    row: Mapping[str, Any] | None
    trajectory: Path | None = None
    scene: Path | None = None
    lineage: Lineage | None = None

    @property
    def form(self) -> Form:
        """The format of the trajectory."""
        return cast("Form", "jsonl" if self.trajectory is None else self.trajectory.suffix[1:])


@dataclass(slots=True)
class ReplayedRun:
    """A run that was made again.

    Attributes:
        about: what came of it: the row of a search, or the document about a simulation.
        departures: where it differs from what was kept, in words; empty if it is the same, bit by bit.
        unknown: what could not be compared, in words.
        page: the text of a page that shows it, where that was wanted and there is something to show.
        pictures: its states as images, likewise.
        version: in words, where another version of this library has made the run that was kept; else ``None``.

    """

    about: Mapping[str, Any]
    departures: list[str] = field(default_factory=list)
    unknown: list[str] = field(default_factory=list)
    page: str | None = None
    pictures: "StatePictures | None" = None
    version: str | None = None


def kept_run(path: Path, number: int | None = None, *, worst: int | None = None) -> KeptRun:
    """The run at a path.

    Args:
        path: the folder of a search or an estimate, of one of its counterexamples, or of simulations; or the file of a simulation.
        number: which run of the folder; by default the worst of a search, and the first of simulations.
        worst: the run's place among those of a search, from 1 for the run of the least value.

    Raises:
        ReplayError: there is no such run.

    """
    if not path.exists():
        raise MissingFileError(f"cannot read '{path}': there is no such file or folder")
    is_search = path.is_dir() and kind_of(path) is not None
    if worst is not None and not is_search:
        raise ReplayError(
            f"'{path}' is no folder of a search or an estimate, so that none of its runs is the worst",
            help="name the folder that `scenic falsify -o` or `scenic estimate -o` has written, or a run by its number",
        )
    if path.is_file():
        return _simulation(path)
    if is_search:
        return _searched(path, number, worst)
    if path.parent.name == "counterexamples" and path.name.isdigit() and number is None:
        return _searched(path.parent.parent, int(path.name), None)
    files = sorted(file for form in _FORMS for file in path.glob(f"simulation-*.{form}"))
    matches = [item for item in files if number is None or int(item.stem.rpartition("-")[2]) == number]
    if not files and (searches := folders_of(path)):
        raise ReplayError(
            f"'{path}' holds the searches of a sweep", help=f"name one of them: '{searches[0]}'"
        )
    if not matches:
        raise ReplayError(
            f"'{path}' holds no run" if number is None else f"'{path}' holds no run {number}",
            help="name a folder that `scenic falsify -o`, `scenic estimate -o` or `scenic simulate -o` has written, or a file in it",
        )
    return _simulation(matches[0])


def _searched(folder: Path, number: int | None, worst: int | None) -> KeptRun:
    kind = kind_of(folder)
    if kind is None:
        raise ReplayError(f"'{folder}' holds neither a search nor an estimate")
    manifest = kind.document(folder)
    first = int(manifest.get("first", 0))
    rows = {row["run"]: row for row in read_rows(folder, first)}
    if not rows:
        raise ReplayError(
            f"'{folder}' holds no run", help=f"the {kind.noun} has not finished any: --resume goes on with it"
        )
    if number is None:
        rows_with_values = [row for row in rows.values() if row["values"] is not None]
        rows_by_value = sorted(rows_with_values, key=lambda row: min(map(float, row["values"]))) or [
            rows[first]
        ]
        if worst is not None and worst > len(rows_by_value):
            raise ReplayError(
                f"'{folder}' holds {len(rows_by_value)} runs with a value, fewer than {worst}",
                help=f"the worst run is --worst 1, the best one --worst {len(rows_by_value)}",
            )
        number = int(rows_by_value[(worst or 1) - 1]["run"])
    if number not in rows:
        raise ReplayError(
            f"'{folder}' holds no run {number}", help=f"it holds runs {first} to {first + len(rows) - 1}"
        )
    kept_folder = folder / "counterexamples" / f"{number:04d}"
    file, scene = kept_folder / "simulation.jsonl", kept_folder / "scene.json"
    return KeptRun(
        number,
        _origin(manifest, folder),
        manifest,
        rows[number],
        file if file.exists() else None,
        scene if scene.exists() else None,
        lineages_of(rows.values())[number] if rows[number].get("move") is not None else None,
    )


def _simulation(file: Path) -> KeptRun:
    form = cast("Form", file.suffix[1:] if file.suffix[1:] in _FORMS else "jsonl")
    try:
        about = about_file(file, form)
        number, settings = int(about["k"]), dict(about["settings"])
    except (OSError, ValueError, KeyError, TypeError):
        raise ReplayError(
            f"'{file}' holds no simulation that says how it was made",
            help="name a file that `scenic simulate -o` has written, or the folder of a search",
        ) from None
    return KeptRun(number, _origin(about, file), settings, None, file)


def _origin(about: Mapping[str, object], place: Path) -> Mapping[str, Any]:
    origin = about.get("origin")
    if not isinstance(origin, dict):
        raise ReplayError(
            f"'{place}' does not say of which program it is: it is older than `scenic replay`",
            help="make it again by the command that has written it",
        )
    return origin


def program_of(run: KeptRun) -> Path:
    """The file of a run's program; raises `ReplayError` if it is not there."""
    file = Path(run.origin["file"])
    if not file.is_file():
        was_text = str(file).startswith("<")
        raise ReplayError(
            "the program of the run was a text in Python, not a file"
            if was_text
            else f"the program of the run, '{file}', is not there",
            help=f"{'save it as a file, and name that' if was_text else 'name it'}: --program FILE.scenic",
        )
    return file


def replay(
    run: KeptRun,
    scenario: "Scenario",
    simulator: "str | Simulator | None" = None,
    *,
    objectives: Sequence[Objective] | None = None,
    shown: bool = False,
    accept_changes: bool = False,
) -> ReplayedRun:
    """Make a run again, and compare it with what was kept.

    Args:
        run: the run.
        scenario: its program.
        simulator: a simulator in place of that of the run.
        objectives: those of the search, where functions of Python are among them; without them, its values are not compared.
        shown: whether there will be a page and pictures.
        accept_changes: whether files that decide the scenes may have changed since; the changes are among the departures then.

    Raises:
        ObjectiveError: the objective cannot be evaluated.
        ReplayError: the run cannot be made again.

    """
    before = run.origin.get("files", {})
    changes = check_files(
        Path(run.origin["file"]), ReplayError, before, file_digests(scenario), accepted=accept_changes
    )
    with tempfile.TemporaryDirectory() as folder:
        if run.row is None:
            repetition = _simulate_again(run, scenario, simulator, shown, Path(folder))
        else:
            repetition = _search_again(run, run.row, scenario, simulator, objectives, shown, Path(folder))
    before, now = run.origin.get("scenic"), scenario.origin["scenic"]
    if before != now:
        repetition.version = f"kept by Scenic {before or 'of an earlier version'}, made again by {now}"
    repetition.departures[:0] = changes
    if run.settings.get("program") != scenario.digest:
        repetition.departures.insert(0, "the program or its parameters have changed since")
    return repetition


class _Shown:
    """Takes the pictures of a simulation, when it has run."""

    def __init__(self) -> None:
        self.pictures: StatePictures | None = None

    def __call__(self, simulation: "Simulation", tape: "PoseTape") -> None:
        from scenic.formats.course_pictures import StatePictures

        self.pictures = StatePictures.of_course(simulation, tape)


def _search_again(
    run: KeptRun,
    row: Mapping[str, Any],
    scenario: "Scenario",
    simulator: "str | Simulator | None",
    objectives: Sequence[Objective] | None,
    shown: bool,
    folder: Path,
) -> ReplayedRun:
    settings = run.settings
    goals = run.origin.get("objectives")
    if objectives is None and goals is not None:
        objectives = [Objective(**goal) for goal in goals]
    space = space_of(scenario, settings["space"])
    numbers = {int(address, 16): value for address, value in row.get("numbers", {}).items()}
    is_guided = settings.get("guide") is not None
    # All draws were searched, also those on which nothing depends.
    axes_searched = {item.address for item in space.coordinates}
    if not is_guided and not axes_searched <= numbers.keys() <= axes_searched | scenario.idle_draws:
        raise ReplayError(
            "the program draws other values than when it was searched",
            help="replay the run with the program as it was, or search again",
        )
    watcher = _Shown()
    simulations = None
    if settings["simulator"] != "none":
        running = SimulationSettings(settings["seed"], settings["steps"], settings["timestep"], tries=1)
        simulations = _simulations(run, scenario, simulator, running)
    evaluation = Evaluation(
        scenario,
        simulations,
        (Objective(function=_anything),) if objectives is None else tuple(objectives),
        space,
        settings["seed"],
        float("inf"),  # so that whatever comes out is kept
        folder,
        watcher if shown else None,
        1 if is_guided else None,
    )
    row_again = _made_again(run, scenario, evaluation, numbers)
    new_folder = folder / "counterexamples" / f"{run.number:04d}"
    result = ReplayedRun(row_again)
    if objectives is None:
        # The value is known from the row alone.
        result.unknown.append(
            f"the value: the objective was a function of Python, `{settings['objectives'][0]}`"
        )
        if row_again["values"] is not None:
            row_again.update({name: row[name] for name in ("values", "status")})
    elif row_again["values"] is not None:
        is_violation = min(map(float, row_again["values"])) <= settings["threshold"]
        row_again["status"] = "counterexample" if is_violation else "held"
    result.departures += row_departures(row, row_again)
    course, scene = new_folder / "simulation.jsonl", new_folder / "scene.json"
    if run.trajectory is not None and course.exists():
        result.departures += file_departures(
            run.trajectory, course, run.form, without=("requirements", "tries")
        )
    is_kept = simulations is None and run.scene is not None and scene.exists()
    if is_kept and run.scene is not None and run.scene.read_bytes() != scene.read_bytes():
        result.departures.append("the scene differs from the one that was kept")
    if shown:
        result.pictures = watcher.pictures
        _show(result, new_folder, scenario)
    return result


def _made_again(
    run: KeptRun, scenario: "Scenario", evaluation: Evaluation, numbers: Mapping[int, float]
) -> dict[str, Any]:
    """Return the row of a run that was made again; ``numbers`` are the draws that were chosen."""
    held_data = run.settings.get("held")
    task = RunTask(run.number, numbers)
    if held_data is not None or run.lineage is not None:
        ancestry = Ancestry(
            scenario, run.settings["seed"], None if held_data is None else Held.from_data(held_data)
        )
        task = ancestry.task(run.lineage or Lineage(run.number))
    row = evaluation(task) if evaluation.simulations is not None else next(evaluation.static(task))
    if row["status"] == "objective":
        raise ObjectiveError(row["error"], help=row["help"])
    return row


def _anything(_result: object) -> float:
    """Stand for an objective that is not known: a value that is kept."""
    return 0.0


def _show(result: ReplayedRun, made: Path, scenario: "Scenario") -> None:
    """Take the page of a simulation, or make page and picture of a scene."""
    page, scene = made / "play.html", made / "scene.json"
    if page.exists():
        result.page = page.read_text(encoding="utf-8")
    elif scene.exists():
        from scenic.formats.course_pictures import StatePictures
        from scenic.formats.html import Page

        simulation = scenario.replay(scene)
        whole = Page(f"run {made.name}")
        whole.add(simulation)
        result.page, result.pictures = whole.text(), StatePictures(simulation)


def _simulations(
    run: KeptRun,
    scenario: "Scenario",
    simulator: "str | Simulator | None",
    running: SimulationSettings,
    **options: Any,
) -> Simulations:
    """Return what simulates a run; raises `ReplayError` if the simulator was made in Python."""
    before = run.settings["simulator"]
    simulator_name = run.origin.get("simulator", before)
    simulations = Simulations(scenario, simulator or simulator_name, running, **options)
    # A search keeps the name that was given, which may be none, and else the class, as simulations do.
    if simulator is None and before not in (None, simulator_name, type(simulations.simulator).__name__):
        raise ReplayError(
            f"the run was simulated by an object of the class `{before}`, which its files do not hold",
            help="name the simulator: --simulator MODULE:CLASS; in Python: `replay(run, scenario, simulator)`",
        )
    return simulations


def _simulate_again(
    run: KeptRun, scenario: "Scenario", simulator: "str | Simulator | None", shown: bool, folder: Path
) -> ReplayedRun:
    settings = run.settings
    running = SimulationSettings(
        settings["seed"],
        settings["maxSteps"],
        settings["timestep"],
        settings["tries"],
        sobol=settings.get("sobol", False),
        keep_violations=settings.get("keep_violations", False),
    )
    watcher = _Shown()
    options = {"shown": True, "watcher": watcher} if shown else {}
    batch = _simulations(run, scenario, simulator, running, folder=folder, form=run.form, **options)
    row = batch(run.number)
    if row.about is None:
        words = row.missing if row.error is None else row.error.message
        return ReplayedRun({}, [f"now there is no simulation: {words}"])
    assert run.trajectory is not None
    trajectory = folder / f"simulation-{run.number:04d}.{run.form}"
    result = ReplayedRun(row.about, file_departures(run.trajectory, trajectory, run.form))
    if row.page is not None:
        from scenic.formats.course_page import course_page

        result.page = course_page(f"simulation {run.number}", [row.page])
        result.pictures = watcher.pictures
    return result
