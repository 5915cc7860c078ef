"""Runs that were kept, made again: those of a search, and simulations of ``scenic simulate -o``."""

import json
import tempfile
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import field
from itertools import zip_longest
from pathlib import Path
from typing import TYPE_CHECKING, Any, Final

from scenic.batch.simulations import Running, Simulations
from scenic.dataclass import dataclass
from scenic.falsification.evaluating import Evaluation, Task
from scenic.falsification.objectives import Objective
from scenic.falsification.space import space_of
from scenic.falsification.store import folders_of, manifest_of, read_rows
from scenic.language.errors import Located, MissingFileError

if TYPE_CHECKING:
    from scenic.runtime.scenes.scenario import Scenario

__all__ = ["KeptRun", "Replay", "ReplayError", "kept_run", "replay"]

_COMPARED: Final = ("status", "values", "requirements", "steps")
_LEFT_OUT: Final = ("settings", "origin", "objects", "records")


class ReplayError(Located):
    """A run that is not kept, or cannot be made again."""

    code = "SC609"


@dataclass(frozen=True, slots=True)
class KeptRun:
    """A run as it was kept.

    Attributes:
        number: of the run in its search, or of the simulation in its seed.
        origin: how to load the program: ``file``, ``options`` of `scenic.load`, and for simulations ``simulator``.
        settings: everything else that the run depends on.
        row: of a search, what was kept of the run; ``None`` of a simulation.
        trajectory: the file of its states, if there is one.

    """

    number: int
    origin: Mapping[str, Any]
    settings: Mapping[str, Any]
    row: Mapping[str, Any] | None
    trajectory: Path | None


@dataclass(slots=True)
class Replay:
    """A run that was made again.

    Attributes:
        about: what came of it: the row of a search, or the document about a simulation.
        departures: where it differs from what was kept, in words; empty if it is the same, bit by bit.
        page: the text of a page that plays it, where there is something to play.

    """

    about: Mapping[str, Any]
    departures: list[str] = field(default_factory=list)
    page: str | None = None


def kept_run(path: Path, number: int | None = None) -> KeptRun:
    """The run at a path.

    Args:
        path: the folder of a search, of one of its counterexamples, or of simulations; or the file of a simulation.
        number: which run of the folder; by default the worst of a search, and the first of simulations.

    Raises:
        ReplayError: there is no such run.

    """
    if not path.exists():
        raise MissingFileError(f"cannot read '{path}': there is no such file or folder")
    if path.is_file():
        return _simulation(path)
    if (path / "manifest.json").exists():
        return _searched(path, number)
    if path.parent.name == "counterexamples" and path.name.isdigit() and number is None:
        return _searched(path.parent.parent, int(path.name))
    files = sorted(path.glob("simulation-*.jsonl"))
    wanted = [item for item in files if number is None or int(item.stem.rpartition("-")[2]) == number]
    if not files and (searches := folders_of(path)):
        raise ReplayError(
            f"'{path}' holds the searches of a sweep", help=f"name one of them: '{searches[0]}'"
        )
    if not wanted:
        raise ReplayError(
            f"'{path}' holds no run" if number is None else f"'{path}' holds no run {number}",
            help="name a folder that `scenic falsify -o` or `scenic simulate -o` has written, or a file in it",
        )
    return _simulation(wanted[0])


def _searched(folder: Path, number: int | None) -> KeptRun:
    manifest = manifest_of(folder)
    rows = {row["run"]: row for row in read_rows(folder)}
    if number is None:
        known = [row for row in rows.values() if row["values"] is not None]
        number = min(known, key=lambda row: min(map(float, row["values"])), default={"run": 0})["run"]
    if number not in rows:
        raise ReplayError(
            f"'{folder}' holds no run {number}", help=f"it holds runs 0 to {len(rows) - 1}" if rows else None
        )
    file = folder / "counterexamples" / f"{number:04d}" / "simulation.jsonl"
    return KeptRun(
        number,
        _origin(manifest, folder),
        manifest,
        rows[number],
        file if file.exists() else None,
    )


def _simulation(file: Path) -> KeptRun:
    try:
        with file.open(encoding="utf-8") as stream:
            about = json.loads(stream.readline())
        number, settings = int(about["k"]), dict(about["settings"])
    except (OSError, ValueError, KeyError, TypeError):
        raise ReplayError(
            f"'{file}' holds no simulation that says how it was made",
            help="name a `.jsonl` file that `scenic simulate -o` has written, or the folder of a search",
        ) from None
    return KeptRun(number, _origin(about, file), settings, None, file)


def _origin(about: Mapping[str, Any], place: Path) -> Mapping[str, Any]:
    origin = about.get("origin")
    if not isinstance(origin, dict):
        raise ReplayError(
            f"'{place}' does not say of which program it is: it is older than `scenic replay`",
            help="make it again by the command that has written it",
        )
    return origin


def replay(
    run: KeptRun, scenario: "Scenario", simulator: str | None = None, *, shown: bool = False
) -> Replay:
    """Make a run again, and compare it with what was kept.

    Args:
        run: the run.
        scenario: its program.
        simulator: a simulator in place of that of the run.
        shown: whether a page is made.

    """
    with tempfile.TemporaryDirectory() as folder:
        found = (_search_again if run.row is not None else _simulate_again)(
            run, scenario, simulator, shown, Path(folder)
        )
    if run.settings.get("program") != scenario.digest:
        found.departures.insert(0, "the program or its parameters have changed since")
    return found


def _search_again(
    run: KeptRun, scenario: "Scenario", simulator: str | None, shown: bool, folder: Path
) -> Replay:
    settings, row = run.settings, run.row
    assert row is not None
    goals = run.origin.get("objectives")
    if goals is None:
        raise ReplayError(
            "the objective of the search was a function of Python, which its folder does not hold",
            help="search by the name of a requirement, or by an expression",
        )
    space = space_of(scenario, settings["space"])
    numbers = {int(address, 16): value for address, value in row["numbers"].items()}
    if set(numbers) != {item.address for item in space.coordinates}:
        raise ReplayError(
            "the program draws other values than when it was searched",
            help="replay the run with the program as it was, or search again",
        )
    is_static = settings["simulator"] == "none"
    simulations = None
    if not is_static:
        running = Running(settings["seed"], settings["steps"], settings["timestep"], tries=1)
        simulations = Simulations(scenario, simulator or settings["simulator"], running)
    evaluation = Evaluation(
        scenario,
        simulations,
        tuple(Objective(**goal) for goal in goals),
        space,
        settings["seed"],
        float("inf"),  # so that whatever comes out is kept
        folder,
    )
    if is_static:
        import numpy as np

        points = np.array([[numbers[item.address] for item in space.coordinates]])
        (found,) = evaluation.together(run.number, points)
    else:
        found = evaluation(Task(run.number, numbers))
    if found["values"] is not None:
        failed = min(map(float, found["values"])) <= settings["threshold"]
        found["status"] = "counterexample" if failed else "held"
    made = folder / "counterexamples" / f"{run.number:04d}"
    result = Replay(found, list(_differences(row, found, _COMPARED)))
    result.departures += _compared(
        run.trajectory, made / "simulation.jsonl", without=("requirements", "tries")
    )
    page = made / "play.html"
    if shown and page.exists():
        result.page = page.read_text(encoding="utf-8")
    return result


def _simulate_again(
    run: KeptRun, scenario: "Scenario", simulator: str | None, shown: bool, folder: Path
) -> Replay:
    settings = run.settings
    running = Running(
        settings["seed"],
        settings["maxSteps"],
        settings["timestep"],
        settings["tries"],
        sobol=settings.get("sobol", False),
        keep_violations=settings.get("keep_violations", False),
    )
    batch = Simulations(
        scenario, simulator or run.origin.get("simulator"), running, folder=folder, shown=shown
    )
    found = batch(run.number)
    if found.about is None:
        words = found.missing if found.error is None else found.error.message
        return Replay({}, [f"now there is no simulation: {words}"])
    result = Replay(found.about, _compared(run.trajectory, folder / f"simulation-{run.number:04d}.jsonl"))
    if found.page is not None:
        from scenic.formats.course_page import course_page

        result.page = course_page(f"simulation {run.number}", [found.page])
    return result


def _compared(kept: Path | None, made: Path, *, without: Sequence[str] = ()) -> list[str]:
    """Return where two files of trajectories differ: in what is said of the whole, and the first state that does."""
    if kept is None or not made.exists():
        return []
    with kept.open(encoding="utf-8") as old, made.open(encoding="utf-8") as new:
        about, again = json.loads(old.readline()), json.loads(new.readline())
        found = list(
            _differences(about, again, [name for name in about if name not in (*_LEFT_OUT, *without)])
        )
        things = [item["name"] or f"{item['class']} {k}" for k, item in enumerate(about["objects"])]
        for before, after in zip_longest(old, new):
            if before == after:
                continue
            if before is None or after is None:
                return [*found, "the simulations end at different steps"]
            return [*found, _departure(json.loads(before), json.loads(after), things)]
    return found or list(_differences(about, again, ("records",)))


def _departure(before: Mapping[str, Any], after: Mapping[str, Any], things: Sequence[str]) -> str:
    where = f"from step {before['step']} (time {before['time']:g} s) on"
    for key, words in (("positions", "position"), ("orientations", "orientation")):
        for number, (old, new) in enumerate(zip(before[key], after[key], strict=False)):
            if old != new:
                name = things[number] if number < len(things) else f"object {number}"
                return f"{where} it departs: the {words} of {name} was {old}, now {new}"
    acting = [
        things[int(number)] if int(number) < len(things) else f"object {number}"
        for number in sorted({*before["actions"], *after["actions"]}, key=int)
        if before["actions"].get(number) != after["actions"].get(number)
    ]
    return f"{where} it departs: " + (
        f"the actions of {', '.join(acting)} are others" if acting else "there are other objects"
    )


def _differences(before: Mapping[str, Any], after: Mapping[str, Any], names: Sequence[str]) -> Iterator[str]:
    for name in names:
        if name == "requirements" and before.get(name) and after.get(name):
            old, new = _by_label(before[name]), _by_label(after[name])
            yield from _differences(old, new, list(dict.fromkeys([*old, *new])))
        elif before.get(name) != after.get(name):
            yield f"{name}: was {_short(before.get(name))}, now {_short(after.get(name))}"


def _by_label(requirements: Any) -> dict[str, Any]:
    """Return verdict and robustness by the label of the requirement, however they were kept."""
    items = (
        requirements.items()
        if isinstance(requirements, dict)
        else ((item["label"], item) for item in requirements)
    )
    return {label: [item["verdict"], item["robustness"]] for label, item in items}


def _short(value: Any) -> str:
    text = json.dumps(value)
    return text if len(text) <= 80 else f"{text[:77]}..."
