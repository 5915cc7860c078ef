"""One run of a search: a scene of a point, its simulation, its value."""

import time
from collections.abc import Generator, Iterable, Iterator, Mapping, Sequence
from contextlib import closing
from pathlib import Path
from typing import TYPE_CHECKING, Any, Final, TypeVar

import numpy as np

from scenic.batch.keeping import SimulationRecord, Watcher
from scenic.dataclass import dataclass
from scenic.falsification.objectives import Objective, ObjectiveError
from scenic.falsification.search_folder import number
from scenic.falsification.space import Floats, Space, decides
from scenic.formats.files import OutputError, make_folder, refusing, write
from scenic.formats.trajectories import course_document
from scenic.graph.draws import Words
from scenic.language.errors import Located
from scenic.runtime.dynamics.chosen_draws import Sourcing
from scenic.runtime.sampling.rejection_report import Exhausted
from scenic.runtime.scenes.sampler import DEFAULT_ATTEMPTS
from scenic.runtime.scenes.scene import Scene

if TYPE_CHECKING:
    from scenic.batch.engines import BatchEngine
    from scenic.batch.simulations import Simulations
    from scenic.runtime.scenes.scenario import Scenario

__all__ = ["Evaluation", "Failures", "RunTask", "SearchError", "checked", "evaluated", "evaluated_together"]

_Result = TypeVar("_Result")

_FAILURES: Final = 10
"""Failing runs in a row that end a batch of runs."""

_SPREAD: Final = 256
"""Runs that are begun before the oldest of them is finished, at most."""

_ATTEMPTS: Final = 1000
"""Number of candidates tried for one point of external parameters, with new values of the other draws each time."""


class SearchError(Located):
    """The error for runs that cannot continue."""

    code = "SC503"


class Failures:
    """Counts failing runs in a row; raises `SearchError` when there are ten."""

    def __init__(self) -> None:
        self._count = 0

    def note(self, row: Mapping[str, Any]) -> None:
        """The next run."""
        self._count = self._count + 1 if row["status"] == "failed" else 0
        if self._count == _FAILURES:
            raise SearchError(
                f"{_FAILURES} runs in a row failed; the last one: {row['error']}",
                help="mend the program or the simulator; finished runs are kept, and --resume goes on",
            )


@dataclass(frozen=True, slots=True)
class RunTask:
    """A run to be made.

    Attributes:
        run: its number.
        numbers: numbers of draws of its scene, by address.
        words: further draws of its scene, by address; ``None`` if only some draws are given, and the others are those of the seed.
        source: draws of the simulation; those of the seed by default.
        scene: number of the scene of the seed; that of the run by default.

    """

    run: int
    numbers: Mapping[int, float]
    words: Mapping[int, int] | None = None
    source: Sourcing | None = None
    scene: int | None = None


@dataclass(frozen=True)
class Evaluation:
    """The evaluation of runs; other processes get it whole.

    Attributes:
        scenario: the scenario.
        simulations: how scenes are simulated; ``None`` if the scenes themselves are searched.
        objectives: what is to become small.
        space: the coordinates of the search.
        seed: of all draws that are not searched.
        threshold: largest value of a counterexample.
        folder: where counterexamples are kept, if anywhere.
        watcher: called with the simulation of each of them, in this process.
        most_attempts: candidates tried for one point; by default as many as its remaining draws may need.
        wants_distances: whether rows have ``distances`` to a failure where these differ from the values.

    """

    scenario: "Scenario"
    simulations: "Simulations | None"
    objectives: tuple[Objective, ...]
    space: Space
    seed: int
    threshold: float
    folder: Path | None = None
    watcher: Watcher | None = None
    most_attempts: int | None = None
    wants_distances: bool = False

    @property
    def attempts(self) -> int:
        """Candidates tried for one point; as many as for any scene if nothing of it is chosen."""
        if self.most_attempts is not None:
            return self.most_attempts
        if not self.space.coordinates:
            return DEFAULT_ATTEMPTS
        return 1 if decides(self.space, self.scenario) else _ATTEMPTS

    def together(self, first: int, numbers: Floats) -> Iterator[dict[str, Any]]:
        """Yield the rows of the scenes of ``numbers`` ``(n, d)``, evaluated as columns; the first scene is run ``first``."""
        by_address = {item.address: numbers[:, place] for place, item in enumerate(self.space.coordinates)}
        return self.chosen(first, by_address, len(numbers))

    def chosen(self, first: int, by_address: Mapping[int, Floats], count: int) -> Iterator[dict[str, Any]]:
        """Yield the rows of scenes of which some draws ``(count,)`` are chosen, by address; the first scene is run ``first``."""
        results = self.scenario.chosen(
            by_address, count, seed=self.seed, first=first, max_attempts=self.attempts
        )
        return self._rows_of(results, first)

    def given(
        self, first: int, numbers: Mapping[int, Floats], words: Mapping[int, Words], count: int
    ) -> Iterator[dict[str, Any]]:
        """Yield the rows of scenes whose draws ``(count,)`` are given, by address; the first scene is run ``first``."""
        return self._rows_of(
            self.scenario.of_draws(numbers, words, count, seed=self.seed, first=first), first
        )

    def _rows_of(self, results: Iterable[Scene | Exhausted], first: int) -> Iterator[dict[str, Any]]:
        for run, result in enumerate(results, first):
            if isinstance(result, Exhausted):
                yield {"run": run, "status": "rejected", "values": None, "attempts": result.attempts}
                continue
            values = [item.of_scene(result) for item in self.objectives]
            if min(values) <= self.threshold and self.folder is not None:
                self._keep_scene(result, self._folder_of(run))
            row = self._row(run, values, result.attempts)
            if self.wants_distances:
                distances = [item.distance_of_scene(result, self.threshold) for item in self.objectives]
                self._add_distances(row, values, distances)
            yield row

    def static(self, task: RunTask) -> Iterator[dict[str, Any]]:
        """Return the row of one scene."""
        return self._rows_of([self._scene(task)], task.run)

    def __call__(self, task: RunTask) -> dict[str, Any]:
        """Return the row of one simulation; it raises nothing but interruptions.

        The status is ``objective`` or ``unwritable`` where the search cannot go on: no objective, or no room for a counterexample.
        """
        start_time = time.perf_counter()
        try:
            row = self._simulated(task)
        except (ObjectiveError, OutputError) as error:
            row = _refusal(task.run, error)
        except Exception as error:  # noqa: BLE001 - it is told in the row, and the search goes on
            words = f"{type(error).__name__}: {error}"
            row = {"run": task.run, "status": "failed", "values": None, "error": words}
        row["seconds"] = round(time.perf_counter() - start_time, 4)
        return row

    def _simulated(self, task: RunTask) -> dict[str, Any]:
        assert self.simulations is not None
        scene = self._scene(task)
        if isinstance(scene, Exhausted):
            return {"run": task.run, "status": "rejected", "values": None, "attempts": scene.attempts}
        waiting = None if self.folder is None else self.folder / f".run-{task.run:06d}.jsonl"
        keeping = SimulationRecord(waiting, "jsonl", shown=waiting is not None, watcher=self.watcher)
        with closing(keeping) as keeper:
            reasons: list[str] = []
            simulation = self.simulations.simulator.simulate(
                scene,
                name=str(task.run),
                key=f"{self.seed}:{task.run}:1".encode(),
                robustness=True,
                keep_violations=True,
                stuck_is_error=True,
                enableReplay=False,
                on_state=keeper.begin(),
                onRejection=lambda error: reasons.append(str(error)),
                source=task.source,
                **self.simulations.course_options(),
            )
            if simulation is None:
                return {
                    "run": task.run,
                    "status": "rejected",
                    "values": None,
                    "attempts": scene.attempts,
                    "error": reasons[-1] if reasons else None,
                }
            values = [item.of_simulation(simulation.result, scene.params) for item in self.objectives]
            row = self._row(task.run, values, scene.attempts)
            if self.wants_distances:
                distances = [
                    item.distance_of_simulation(simulation.result, scene.params, self.threshold)
                    for item in self.objectives
                ]
                self._add_distances(row, values, distances)
            about = course_document(simulation, k=task.run, tries=1)
            row["requirements"] = {
                item["label"]: {"verdict": item["verdict"], "robustness": _plain(item["robustness"])}
                for item in about["requirements"]
            }
            row["steps"] = about["steps"]
            if row["status"] == "counterexample" and waiting is not None:
                self._keep_course(scene, keeper, simulation, about, task.run, waiting)
            return row

    def _scene(self, task: RunTask) -> Scene | Exhausted:
        """The scene of a run."""
        columns = {place: np.array([value]) for place, value in task.numbers.items()}
        number = task.run if task.scene is None else task.scene
        if task.words is None:
            (scene,) = self.scenario.chosen(
                columns, 1, seed=self.seed, first=number, max_attempts=self.attempts
            )
        else:
            words = {place: np.array([word], dtype=np.uint64) for place, word in task.words.items()}
            (scene,) = self.scenario.of_draws(columns, words, 1, seed=self.seed, first=number)
        return scene

    def _row(self, run: int, values: Sequence[float], attempts: int) -> dict[str, Any]:
        failed = min(values) <= self.threshold
        return {
            "run": run,
            "status": "counterexample" if failed else "held",
            "values": [number(value) for value in values],
            "attempts": attempts,
        }

    def _add_distances(
        self, row: dict[str, Any], values: Sequence[float], distances: Sequence[float]
    ) -> None:
        """Add the distances to a failure where they are not the values less the threshold."""
        if any(far != value - self.threshold for far, value in zip(distances, values, strict=True)):
            row["distances"] = [number(far) for far in distances]

    def _folder_of(self, run: int) -> Path:
        assert self.folder is not None
        folder = self.folder / "counterexamples" / f"{run:04d}"
        make_folder(folder)
        return folder

    def _keep_scene(self, scene: Scene, folder: Path) -> None:
        scene.save(folder / "scene.json")

    def _keep_course(
        self,
        scene: Scene,
        kept: SimulationRecord,
        done: Any,
        about: Mapping[str, object],
        run: int,
        waiting: Path,
    ) -> None:
        from scenic.formats.course_page import course_page

        folder = self._folder_of(run)
        self._keep_scene(scene, folder)
        page = kept.finish(done, about)
        with refusing(waiting):
            waiting.replace(folder / "simulation.jsonl")
        if page is not None:
            write(folder / "play.html", course_page(f"run {run}", [page]).encode())


def _plain(value: object) -> Any:
    return number(value) if isinstance(value, float) else value


def checked(row: dict[str, Any]) -> dict[str, Any]:
    """Return a row, unless it says why the runs cannot go on; raises `ObjectiveError` or ``OutputError``."""
    if row["status"] == "objective":
        raise ObjectiveError(row["error"], help=row["help"])
    if row["status"] == "unwritable":
        raise OutputError(
            row["error"], help=row["help"] or "make room; finished runs are kept, and --resume goes on"
        )
    return row


def evaluated(
    evaluation: Evaluation, tasks: Iterable[RunTask], engine: "BatchEngine | None"
) -> Generator[dict[str, Any]]:
    """The rows of runs in order, each as soon as it and those before it are there."""
    if engine is None:
        yield from map(checked, map(evaluation, tasks))
        return
    yield from map(checked, _in_order(engine.run(evaluation, tasks, lost=_lost, spread=_SPREAD)))


def evaluated_together(
    evaluation: Evaluation, parts: Iterable[range], engine: "BatchEngine | None"
) -> Generator[dict[str, Any]]:
    """The rows of scenes of the seed, in order; those of one part are evaluated as columns."""
    function = _Together(evaluation)
    if engine is None:
        for part in parts:
            yield from map(checked, function(part))
        return
    for rows in _in_order(engine.run(function, parts, lost=_lost_together, spread=_SPREAD)):
        yield from map(checked, rows)


@dataclass(frozen=True)
class _Together:
    """Evaluates scenes of the seed; other processes get it whole."""

    evaluation: Evaluation

    def __call__(self, part: range) -> list[dict[str, Any]]:
        """The rows of some runs; of the first alone if an objective cannot be evaluated."""
        try:
            return list(self.evaluation.together(part.start, np.zeros((len(part), 0))))
        except (ObjectiveError, OutputError) as error:
            return [_refusal(part.start, error)]


def _in_order(results: Iterable[tuple[int, _Result]]) -> Iterator[_Result]:
    """The results of an engine by their places, each as soon as it and those before it are there."""
    waiting: dict[int, _Result] = {}
    due = 0
    for place, result in results:
        waiting[place] = result
        while due in waiting:
            yield waiting.pop(due)
            due += 1


def _refusal(run: int, error: ObjectiveError | OutputError) -> dict[str, Any]:
    """The row of a run after which there cannot be more."""
    return {
        "run": run,
        "status": "objective" if isinstance(error, ObjectiveError) else "unwritable",
        "values": None,
        "error": error.message,
        "help": error.help,
    }


def _lost(task: RunTask, code: int) -> dict[str, Any]:
    return _lost_run(task.run, code)


def _lost_together(part: range, code: int) -> list[dict[str, Any]]:
    return [_lost_run(run, code) for run in part]


def _lost_run(run: int, code: int) -> dict[str, Any]:
    return {"run": run, "status": "failed", "values": None, "error": f"its process died (exit code {code})"}
