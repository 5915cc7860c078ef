"""The search: ask a sampler for points, evaluate them, and tell it their values."""

import math
import random
import time
from collections.abc import Callable, Generator, Mapping, Sequence
from contextlib import closing, nullcontext
from dataclasses import field
from pathlib import Path
from typing import TYPE_CHECKING, Any, Final

import numpy as np

from scenic.batch.engines import BatchEngine, Processes
from scenic.batch.folders.file_digests import files_of_origin
from scenic.batch.simulations import Simulations, SimulationSettings
from scenic.dataclass import dataclass
from scenic.falsification.evaluating import Evaluation, Failures, RunTask, SearchError, evaluated
from scenic.falsification.objectives import Objective
from scenic.falsification.samplers import make_sampler
from scenic.falsification.samplers.search_sampler import NoMorePointsError
from scenic.falsification.search_folder import SearchFolder
from scenic.falsification.space import Floats, Space, space_of, worded
from scenic.language.errors import InvalidScenarioError
from scenic.statistics.confidence_intervals import exact_interval

if TYPE_CHECKING:
    from scenic.runtime.scenes.scenario import Scenario
    from scenic.simulators.simulator import Simulator

__all__ = ["FalsificationResult", "SearchError", "SearchPlan", "falsify", "search"]

_GENERATION: Final = 8
"""Number of points requested at a time, if a sampler has no preference and simulations take long."""

_STATIC_GENERATION: Final = 512
"""The same for scenes by themselves."""


@dataclass(frozen=True)
class SearchPlan:
    """Everything that decides what a search finds."""

    seed: int
    sampler: str = "cma"
    sampler_options: Mapping[str, Any] | None = None
    objectives: tuple[Objective, ...] = (Objective(),)
    threshold: float = 0.0
    space: str = "auto"
    batch: int | None = None
    simulator: "str | Simulator | None" = None
    is_static: bool = False
    max_steps: int | None = 100
    timestep: float | None = None

    def settings(self, scenario: "Scenario") -> dict[str, Any]:
        """Return the same as plain data."""
        simulator = (
            self.simulator
            if self.simulator is None or isinstance(self.simulator, str)
            else type(self.simulator).__name__
        )
        return {
            "program": scenario.digest,
            "file": scenario.filename,
            "seed": self.seed,
            "sampler": self.sampler,
            "sampler options": dict(self.sampler_options or {}),
            "objectives": [item.label for item in self.objectives],
            "threshold": self.threshold,
            "space": self.space,
            "batch": self.batch,
            "simulator": "none" if self.is_static else simulator,
            "steps": self.max_steps,
            "timestep": self.timestep,
            "units": space_of(scenario, self.space).units,
            "origin": {
                **scenario.origin,
                **files_of_origin(scenario),
                "objectives": self._goals(),
                "simulator": self.simulator if isinstance(self.simulator, str) else None,
            },
        }

    def _goals(self) -> list[dict[str, str | bool | None]] | None:
        """Return the objectives as plain data, unless one of them is a function."""
        if any(item.function is not None for item in self.objectives):
            return None
        return [
            {"name": item.name, "expression": item.expression, "is_verdict": item.is_verdict}
            for item in self.objectives
        ]


@dataclass
class FalsificationResult:
    """The result of a search.

    Attributes:
        rows: one mapping for each run: its number ``run``, ``status`` (held, counterexample, rejected, failed), ``values`` of the
            objectives, ``point`` (values by name), ``numbers`` (of draws, by address in hexadecimal digits).
        objectives: the names of the objectives.
        folder: where it is kept.
        units: the units of a point's values, by name; none of values whose unit is not known.

    """

    rows: list[dict[str, Any]]
    objectives: tuple[str, ...]
    folder: Path | None = None
    units: Mapping[str, str] = field(default_factory=dict)

    def point(self, row: Mapping[str, Any]) -> list[str]:
        """The point of a run, for readers."""
        return [worded(name, value, self.units.get(name, "")) for name, value in row["point"].items()]

    @property
    def counterexamples(self) -> list[dict[str, Any]]:
        """The runs that failed, the worst first."""
        found = [row for row in self.rows if row["status"] == "counterexample"]
        return sorted(found, key=lambda row: min(map(float, row["values"])))

    @property
    def evaluated(self) -> int:
        """Number of runs that have a value."""
        return sum(row["values"] is not None for row in self.rows)

    @property
    def best(self) -> dict[str, Any] | None:
        """The run with the least value."""
        known = [row for row in self.rows if row["values"] is not None]
        return min(known, key=lambda row: min(map(float, row["values"])), default=None)

    @property
    def is_blind(self) -> bool:
        """Lack of guidance: all values are plus or minus infinity, so that only the truth is known."""
        known = [min(map(float, row["values"])) for row in self.rows if row["values"] is not None]
        return bool(known) and not any(map(math.isfinite, known))

    def share(self, confidence: float = 0.95) -> tuple[float, float, float]:
        """The share of counterexamples, and the ends of its interval; see `exact_interval`."""
        total, failed = self.evaluated, len(self.counterexamples)
        if total == 0:
            return math.nan, 0.0, 1.0
        return failed / total, *exact_interval(failed, total, confidence)

    def front(self) -> list[dict[str, Any]]:
        """The runs than which no other is at least as small in all objectives and smaller in one (Pareto's)."""
        pairs = [(tuple(map(float, row["values"])), row) for row in self.rows if row["values"] is not None]
        return [
            row
            for values, row in pairs
            if not any(
                other != values and all(a <= b for a, b in zip(other, values, strict=True))
                for other, _ in pairs
            )
        ]


@dataclass
class SearchLimits:
    """When a search ends."""

    runs: int
    stop_after: int | None = None
    time_limit: float | None = None
    told: Callable[[dict[str, Any]], None] = field(default=lambda _row: None)
    """Called with each finished run, in order."""


def search(
    scenario: "Scenario",
    plan: SearchPlan,
    limits: SearchLimits,
    *,
    engine: BatchEngine | None = None,
    folder: SearchFolder | None = None,
) -> FalsificationResult:
    """Search a scenario, going on with what the folder holds.

    Results depend on the plan alone: points are asked for and told in generations of a fixed size.

    Raises:
        ObjectiveError: the objective cannot be evaluated.
        OutputError: the folder cannot be written; what has finished is kept.
        SamplerError: there is no such sampler.
        SearchError: ten runs in a row failed.
        SearchFolderError: the folder holds another search.

    """
    with nullcontext() if folder is None else folder:
        return _search(scenario, plan, limits, engine, folder)


def _search(
    scenario: "Scenario",
    plan: SearchPlan,
    limits: SearchLimits,
    engine: BatchEngine | None,
    folder: SearchFolder | None,
) -> FalsificationResult:
    space = space_of(scenario, plan.space)
    if not len(space):
        raise InvalidScenarioError(
            "there is nothing to search: nothing in the program is random",
            help="draw something by `Range`, or `VerifaiRange`",
        )
    sampler = make_sampler(plan.sampler, space, plan.seed, plan.sampler_options)
    simulations = None
    if not plan.is_static:
        simulations = Simulations(
            scenario, plan.simulator, SimulationSettings(plan.seed, plan.max_steps, plan.timestep, tries=1)
        )
    evaluation = Evaluation(
        scenario,
        simulations,
        plan.objectives,
        space,
        plan.seed,
        plan.threshold,
        None if folder is None else folder.path,
    )
    result = FalsificationResult(
        [],
        tuple(item.label for item in plan.objectives),
        None if folder is None else folder.path,
        space.units,
    )
    kept_rows = [] if folder is None else folder.rows
    deadline = None if limits.time_limit is None else time.monotonic() + limits.time_limit
    failures = Failures()
    while len(result.rows) < limits.runs:
        if deadline is not None and time.monotonic() > deadline:
            break
        if limits.stop_after is not None and len(result.counterexamples) >= limits.stop_after:
            break
        size = plan.batch or sampler.batch or (_STATIC_GENERATION if plan.is_static else _GENERATION)
        try:
            points = sampler.ask(size)
        except NoMorePointsError:
            break
        first = len(result.rows)
        run_count = min(len(points), limits.runs - first)
        rows_of_batch = kept_rows[first : first + run_count]
        rows = list(rows_of_batch)
        with closing(_evaluated(evaluation, points, first, len(rows_of_batch), run_count, engine)) as parts:
            for part in parts:
                if folder is not None:
                    folder.add(part)
                rows.extend(part)
        for row in rows:
            failures.note(row)
            limits.told(row)
        result.rows.extend(rows)
        values = np.array([_told(row) for row in rows], dtype=np.float64)
        sampler.tell(points[: len(rows)], values)
    return result


def _told(row: Mapping[str, Any]) -> float:
    return math.nan if row["values"] is None else min(map(float, row["values"]))


def _evaluated(
    evaluation: Evaluation, points: Floats, first: int, done: int, wanted: int, engine: BatchEngine | None
) -> Generator[list[dict[str, Any]]]:
    """The rows of points ``done`` to ``wanted`` of a generation whose first run has the number ``first``.

    They come in order, some at a time, as soon as those before them are there.
    """
    if done >= wanted:
        return
    space, numbers = evaluation.space, evaluation.space.numbers(points)

    def whole(row: dict[str, Any], place: int) -> dict[str, Any]:
        row["point"] = _point(space, points[place])
        row["numbers"] = {
            f"{item.address:016x}": float(numbers[place, k]) for k, item in enumerate(space.coordinates)
        }
        return row

    if evaluation.simulations is None:
        together = evaluation.together(first + done, numbers[done:wanted])
        yield [whole(row, place) for place, row in enumerate(together, done)]
        return
    tasks = [
        RunTask(
            first + place,
            {item.address: float(numbers[place, k]) for k, item in enumerate(space.coordinates)},
        )
        for place in range(done, wanted)
    ]
    with closing(evaluated(evaluation, tasks, engine if len(tasks) > 1 else None)) as rows:
        for place, row in enumerate(rows, done):
            yield [whole(row, place)]


def _point(space: Space, point: Floats) -> dict[str, float]:
    return {item.label: item.value(float(point[k])) for k, item in enumerate(space.coordinates)}


def falsify(
    scenario: "Scenario",
    simulator: "str | Simulator | None" = None,
    *,
    objective: "str | Objective | Callable[[Any], float] | Sequence[Any] | None" = None,
    minimize: str | None = None,
    sampler: str = "cma",
    sampler_options: Mapping[str, Any] | None = None,
    n: int = 1000,
    seed: int | None = None,
    threshold: float = 0.0,
    stop_after: int | None = None,
    time_limit: float | None = None,
    space: str = "auto",
    batch: int | None = None,
    max_steps: int | None = 100,
    timestep: float | None = None,
    static: bool = False,
    processes: int = 1,
    folder: str | Path | None = None,
    resume: bool = False,
) -> FalsificationResult:
    """Search for scenes, or for simulations, in which an objective is at most ``threshold``.

    Args:
        scenario: what to search.
        simulator: the name of a simulator, or one; the program's own by default.
        objective: the name of a requirement, of a record or of a parameter, a function of a simulation's result (or of a scene), an
            `Objective`, or several of these; by default the least robustness of all temporal requirements.
        minimize: an expression over records, or over parameters.
        sampler: the name of a sampler; see `scenic.falsification.samplers`.
        sampler_options: its options.
        n: runs at most.
        seed: any integer; drawn from Python's ``random`` if not given.
        threshold: largest value of a counterexample.
        stop_after: counterexamples after which the search ends.
        time_limit: seconds after which no new generation of points begins.
        space: ``external``, ``scene``, or ``auto``: external parameters if there are any, else all draws of the scene.
        batch: points that the sampler gives at a time; results depend on it.
        max_steps: steps of a simulation at most.
        timestep: seconds in a step.
        static: search scenes alone, without simulations.
        processes: number of processes that simulate; changes speed, never results.
        folder: folder that stores runs and counterexamples.
        resume: continue the search in the folder.

    """
    objective_list = (
        [] if objective is None else list(objective) if isinstance(objective, list | tuple) else [objective]
    )
    objectives = [_objective(item) for item in objective_list]
    if minimize is not None:
        objectives.append(Objective(expression=minimize))
    plan = SearchPlan(
        random.getrandbits(63) if seed is None else seed,
        sampler,
        sampler_options,
        tuple(objectives) or (Objective(),),
        threshold,
        space,
        batch,
        simulator,
        static,
        max_steps,
        timestep,
    )
    search_folder = (
        None if folder is None else SearchFolder(Path(folder), plan.settings(scenario), resume=resume)
    )
    engine = Processes(processes) if processes > 1 else None
    return search(
        scenario, plan, SearchLimits(n, stop_after, time_limit), engine=engine, folder=search_folder
    )


def _objective(item: Any) -> Objective:
    if isinstance(item, Objective):
        return item
    return Objective(name=item) if isinstance(item, str) else Objective(function=item)
