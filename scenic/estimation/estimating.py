"""Estimates from runs 0, 1, 2, ... of a seed: until there are enough of them for what is asked."""

import random
import time
from collections.abc import Callable, Generator, Iterable, Iterator, Mapping, Sequence
from contextlib import closing, nullcontext
from dataclasses import field
from itertools import count, islice
from pathlib import Path
from typing import TYPE_CHECKING, Any, Final

import numpy as np

from scenic.batch.engines import BatchEngine, OverExecutor, Processes
from scenic.batch.simulations import Simulations, SimulationSettings
from scenic.dataclass import dataclass
from scenic.estimation.asking import asked_of
from scenic.estimation.branching import Branching, is_of_law, rare_of, split
from scenic.estimation.estimate import Asked, Estimate, Tally, requirement_tallies
from scenic.estimation.estimate_folder import EstimateFolder, joined, manifest_of
from scenic.estimation.goals import EstimateError, check_labels, goals_of, requirement_labels
from scenic.estimation.importance_sampling import Guide, guide_of, weighted_of
from scenic.falsification.comparing import row_departures
from scenic.falsification.evaluating import Evaluation, Failures, RunTask, evaluated, evaluated_together
from scenic.falsification.lineages import Ancestry, Held, Lineage
from scenic.falsification.objectives import Objective
from scenic.falsification.search import SearchPlan
from scenic.falsification.search_folder import read_rows
from scenic.falsification.space import Space
from scenic.runtime.ground.arguments import check_seconds, whole_number
from scenic.runtime.sampling.rejection_report import Exhausted
from scenic.runtime.scenes.sampler import DEFAULT_ATTEMPTS
from scenic.statistics.confidence_sequences import is_checked
from scenic.statistics.splitting import Move, Splitting

if TYPE_CHECKING:
    from concurrent.futures import Executor

    from scenic.runtime.scenes.scenario import Scenario
    from scenic.runtime.scenes.scene import Scene
    from scenic.simulators.simulator import Simulator

__all__ = ["Runs", "Stop", "estimate", "estimate_runs", "held_of", "load_estimate"]

_STATIC_TOGETHER: Final = 4096
"""Scenes that are evaluated together, at most."""

_KEPT_TOGETHER: Final = 64
"""Runs that are written to the folder together, at most."""

_KEPT_SECONDS: Final = 2.0
"""Seconds until finished runs are written."""

_SURE: Final = 8
"""Runs after which a requirement must have been seen that no part of the program's beginning states."""


@dataclass(frozen=True)
class Runs:
    """The runs of a program: everything that decides their rows.

    Attributes:
        scenario: the program.
        seed: run ``k`` of a seed is always the same.
        objectives: a run is a counterexample if one of these has a value of at most ``threshold``.
        threshold: that value.
        simulator: the name of a simulator, or one; the program's own by default.
        is_static: whether runs are scenes alone.
        max_steps: steps of a simulation at most.
        timestep: seconds in a step.
        first: number of the first run.
        held: a scene that all runs have.
        budget: runs of a splitting, which decides about them; ``None`` for runs of the program's law.
        guide: where importance sampling draws.

    """

    scenario: "Scenario"
    seed: int
    objectives: tuple[Objective, ...]
    threshold: float = 0.0
    simulator: "str | Simulator | None" = None
    is_static: bool = False
    max_steps: int | None = 100
    timestep: float | None = None
    first: int = 0
    held: Held | None = None
    budget: int | None = None
    guide: Guide | None = None

    def check(self) -> None:
        """Raise `EstimateError` where there are no such runs."""
        check_seconds(self.timestep, "timestep")
        if self.is_static and self.held is not None:
            raise EstimateError(
                "in one scene there is nothing to estimate without simulations", help="leave out --static"
            )
        if self.budget is not None and self.first:
            raise EstimateError(
                "the runs of a splitting begin with number 0", help="leave out --first, or --rare"
            )
        labels = requirement_labels(self.scenario)
        are_verdicts = [item.is_verdict for item in self.objectives]
        if self.is_static and any(are_verdicts):
            raise EstimateError(
                "scenes alone meet all requirements: others are not made",
                help="say by a number what is a counterexample: --static with --objective PARAMETER or --minimize EXPRESSION, and"
                " --threshold; or simulate, without --static",
            )
        if not self.is_static and any(are_verdicts):
            if self.simulator is None and self.scenario.is_timeless:
                raise EstimateError(
                    "nothing in this program happens over time, so that no simulation violates what its scenes meet",
                    help="estimate from its scenes alone: --static with --objective PARAMETER or --minimize EXPRESSION",
                )
            if not labels and not self.scenario.program.invocables:
                raise EstimateError(
                    "the program has no requirement, so that nothing can be violated",
                    help="write `require always ...`, or say what is a counterexample by --minimize EXPRESSION",
                )

    def settings(self) -> dict[str, Any]:
        """Return the settings that decide the rows, as plain data."""
        plan = SearchPlan(
            self.seed, "none", None, self.objectives, self.threshold, "none", None, self.simulator,
            self.is_static, self.max_steps, self.timestep,
        )  # fmt: skip
        return {
            **plan.settings(self.scenario),
            "first": self.first,
            "held": None if self.held is None else self.held.to_data(),
            "budget of the splitting": self.budget,
            "guide": None if self.guide is None else self.guide.to_data(),
        }

    def evaluation(self) -> Evaluation:
        """The evaluation of one run."""
        simulations = None
        if not self.is_static:
            running = SimulationSettings(self.seed, self.max_steps, self.timestep, tries=1)
            simulations = Simulations(self.scenario, self.simulator, running)
        return Evaluation(
            self.scenario, simulations, self.objectives, Space(()), self.seed, self.threshold,
            most_attempts=None if self.guide is None else 1, wants_distances=self.budget is not None,
        )  # fmt: skip


@dataclass
class Stop:
    """The end of runs beside the answer.

    Attributes:
        time_limit: seconds after which no new run begins.
        told: called with each finished run, in order.

    """

    time_limit: float | None = None
    told: Callable[[Mapping[str, Any]], None] = field(default=lambda _row: None)


def estimate_runs(
    runs: Runs,
    asked: Asked,
    stop: Stop | None = None,
    *,
    engine: BatchEngine | None = None,
    folder: EstimateFolder | None = None,
) -> Estimate:
    """Estimate a probability, going on with what the folder holds.

    Raises:
        EstimateError: there is no such requirement, or nothing to estimate.
        EstimateFolderError: the folder holds other runs.
        ObjectiveError: an objective cannot be evaluated.
        OutputError: the folder cannot be written; what has finished is kept.
        SearchError: ten runs in a row failed.

    """
    runs.check()
    with nullcontext() if folder is None else folder:
        return _Course(runs, asked, stop or Stop(), engine, folder).whole()


class _Course:
    """The runs of one estimate, until they are enough."""

    def __init__(
        self, runs: Runs, asked: Asked, stop: Stop, engine: BatchEngine | None, folder: EstimateFolder | None
    ) -> None:
        self._runs, self._asked, self._stop = runs, asked, stop
        self._engine, self._folder = engine, folder
        self._evaluation = runs.evaluation()
        self._ancestry = Ancestry(runs.scenario, runs.seed, runs.held)
        self._rows: list[dict[str, Any]] = []
        self._total = Tally()
        self._failures = Failures()
        self._labels = requirement_labels(runs.scenario)
        self._waiting: list[dict[str, Any]] = []
        self._written = time.monotonic()

    def whole(self) -> Estimate:
        """The estimate."""
        reason = self._go_on()
        if not self._runs.is_static:
            check_labels(self._runs.objectives, self._rows, self._labels)
        is_repeatable = self._made_again()
        history = [self._asked.to_data()] if self._folder is None else self._folder.asked
        folder = None if self._folder is None else self._folder.path
        estimate_made = _estimate_from(self._rows, self._asked, history, self._runs.settings(), folder)
        estimate_made.is_repeatable = is_repeatable
        estimate_made.stop_reason = estimate_made.stop_reason or reason
        return estimate_made

    def _go_on(self) -> str:
        """Make runs until they are enough; returns the words for another end."""
        start_time = time.monotonic()
        kept_rows = [] if self._folder is None else self._folder.rows
        if self._is_enough():
            return ""
        try:
            with closing(self._all_rows(kept_rows)) as rows:
                for place, row in enumerate(rows):
                    if self._folder is not None and place >= len(kept_rows):
                        self._waiting.append(row)
                    self._take(row)
                    self._keep(_KEPT_TOGETHER)
                    if self._is_enough():
                        return ""
                    if (
                        self._stop.time_limit is not None
                        and time.monotonic() - start_time > self._stop.time_limit
                    ):
                        return "the time limit was reached"
        finally:
            self._keep(0)
        return ""

    def _take(self, row: dict[str, Any]) -> None:
        self._rows.append(row)
        if is_of_law(row):
            self._total.add(row)
        self._failures.note(row)
        self._stop.told(row)
        if self._total.runs - self._total.unknown == _SURE and not self._runs.is_static:
            check_labels(self._runs.objectives, self._rows, self._labels)

    def _keep(self, most: int) -> None:
        """Write finished runs if there are more than ``most`` of them, or they have waited long."""
        is_late = time.monotonic() - self._written > _KEPT_SECONDS
        if self._folder is None or not self._waiting or (len(self._waiting) <= most and not is_late):
            return
        self._folder.add(self._waiting)
        self._waiting = []
        self._written = time.monotonic()

    def _is_enough(self) -> bool:
        most = self._asked.runs
        if self._runs.budget is not None:
            return False  # a splitting ends by itself
        if most is not None and len(self._rows) >= most:
            return True
        if self._asked.method == "precision" and not is_checked(self._total.runs):
            return False
        return _answer(self._asked, self._total)[0]

    def _all_rows(self, kept: list[dict[str, Any]]) -> Generator[dict[str, Any]]:
        """Yield the rows of the folder, and new ones from there on."""
        first = self._runs.first
        if self._runs.budget is None:
            yield from kept
            yield from self._new_rows(first + len(kept))
            return
        splitting: Splitting[Lineage] = Splitting(self._runs.seed, self._runs.budget)
        branching = Branching(self._evaluation, self._ancestry, self._engine)

        def make(number: int, moves: Sequence[Move[Lineage]]) -> Iterator[dict[str, Any]]:
            known = kept[number : number + len(moves)]
            yield from known
            if len(known) < len(moves):
                yield from branching.rows(number + len(known), moves[len(known) :])

        row_count = 0
        for row in split(splitting, make, self._runs.threshold):
            row_count += 1
            yield row
        if splitting.pilot.is_flat:
            # Nothing leads to failures: what is left of the budget goes into plain runs.
            yield from kept[row_count:]
            yield from self._new_rows(max(row_count, len(kept)))

    def _new_rows(self, start: int) -> Generator[dict[str, Any]]:
        """Runs of the program's law, or guided ones."""
        most = self._asked.runs
        end = None if most is None else self._runs.first + most
        numbers = count(start) if end is None else range(start, end)
        if self._runs.guide is not None:
            yield from self._guided_rows(self._runs.guide, numbers)
            return
        if self._evaluation.simulations is not None:
            tasks = (self._ancestry.task(Lineage(run)) for run in numbers)
            yield from evaluated(self._evaluation, tasks, self._engine)
            return
        yield from evaluated_together(self._evaluation, _parts(start, end), self._engine)

    def _guided_rows(self, guide: Guide, numbers: Iterable[int]) -> Generator[dict[str, Any]]:
        seed, pending = self._runs.seed, iter(numbers)
        while some := list(islice(pending, _STATIC_TOGETHER // 8)):
            points = np.array([guide.point(seed, run) for run in some])
            weights = guide.proposal.weights(points)
            rows: Iterator[dict[str, Any]]
            if self._evaluation.simulations is None:
                columns = dict(zip(guide.addresses, points.T, strict=True))
                rows = self._evaluation.chosen(some[0], columns, len(some))
            else:
                tasks = [
                    RunTask(run, dict(zip(guide.addresses, map(float, point), strict=True)))
                    for run, point in zip(some, points, strict=True)
                ]
                rows = evaluated(self._evaluation, tasks, self._engine)
            for row, point, weight in zip(rows, points, weights, strict=True):
                addresses_and_numbers = zip(guide.addresses, map(float, point), strict=True)
                row["numbers"] = {f"{address:016x}": number for address, number in addresses_and_numbers}
                row["weight"] = float(weight)
                yield row

    def _made_again(self) -> bool | None:
        """Make the first run once more, to see whether it is the same."""
        row = next((row for row in self._rows if row["status"] != "failed"), None)
        if row is None or self._runs.is_static:
            return None
        numbers = {int(name, 16): number for name, number in row.get("numbers", {}).items()}
        task = RunTask(row["run"], numbers) if numbers else self._ancestry.task(Lineage(row["run"]))
        return not row_departures(row, self._evaluation(task))


def _parts(start: int, end: int | None) -> Iterator[range]:
    """Runs that are evaluated together: few at first, so that an answer which comes early is seen."""
    size = 64
    while end is None or start < end:
        stop = start + size if end is None else min(start + size, end)
        yield range(start, stop)
        start, size = stop, min(2 * size, _STATIC_TOGETHER)


def _answer(asked: Asked, total: Tally) -> tuple[bool, bool | None]:
    """Tell whether there are enough runs for what is asked (a fixed number aside), and the answer of a test."""
    if asked.method == "precision":
        assert asked.precision is not None
        if total.runs == 0:
            return False, None
        return total.interval(asked.confidence, at_any_time=True).half_width <= asked.precision, None
    if asked.method == "bound":
        assert asked.test is not None
        # A run without an outcome may have had either.
        if asked.test.is_at_most(total.violations + total.unknown, total.runs) is True:
            return True, True
        if asked.test.is_at_most(total.violations, total.runs) is False:
            return True, False
    return False, None


def _estimate_from(
    rows: list[dict[str, Any]],
    asked: Asked,
    history: Sequence[Mapping[str, Any]],
    settings: Mapping[str, Any],
    folder: Path | None,
) -> Estimate:
    """The estimate that follows from finished runs."""
    total = Tally()
    for row in filter(is_of_law, rows):
        total.add(row)
    rare, weights = None, None
    if asked.method == "splitting":
        rare = rare_of(rows, int(settings["seed"]), asked.runs or 0, settings["threshold"])
    elif asked.method == "importance sampling":
        weights = weighted_of(rows)
    is_static = settings["simulator"] == "none"
    goals = settings["origin"].get("objectives") or []
    names = [goal["name"] for goal in goals if goal["is_verdict"]]
    tallies = []
    if names and rare is None and weights is None:
        tallies = requirement_tallies(rows, [name for name in names if name is not None])
    enough, answer = _answer(asked, total)
    is_whole = asked.runs is not None and len(rows) >= asked.runs
    is_fixed = asked.method == "fixed number"
    if is_fixed:
        reason = f"all {asked.runs} runs are made" if is_whole else ""
    elif enough:
        reason = "the precision is reached" if asked.method == "precision" else "the test has an answer"
    else:
        reason = f"the {asked.runs} runs that it may take are made" if is_whole else ""
    if rare is not None:
        is_done = rare.is_known and len(rare.logarithms) == len(rare.repetitions)
        reason = "all repetitions are finished" if is_done else reason
        enough = is_done or (rare.is_flat and is_whole)
    if weights is not None:
        enough = is_whole and weights.is_known
    # Whoever has looked before deciding on more runs has not fixed their number in advance.
    has_looked = len({(item["method"], item["runs"]) for item in history}) > 1
    return Estimate(
        asked, rows, int(settings["seed"]), total, tallies,
        at_any_time=not is_fixed or not is_whole or has_looked,
        is_finished=is_whole if is_fixed else enough,
        folder=folder, is_static=is_static, rare=rare, weighted=weights, answer=answer, stop_reason=reason,
    )  # fmt: skip


def load_estimate(folders: Sequence[Path]) -> Estimate:
    """The estimate that one folder keeps, or several of disjoint ranges of runs; raises `EstimateFolderError`."""
    if len(folders) == 1:
        manifest = manifest_of(folders[0])
        history = manifest["asked"]
        question = Asked.from_data(history[-1])
        rows = read_rows(folders[0], manifest["first"])
        return _estimate_from(rows, question, history, manifest, folders[0])
    manifest, rows = joined(folders)
    history = manifest["asked"]
    question = Asked.from_data(history[0])
    if all(item["method"] == "fixed number" for item in history):
        question = Asked("fixed number", question.confidence, sum(item["runs"] for item in history))
        history = [question.to_data()]
    return _estimate_from(rows, question, history, manifest, None)


def estimate(
    scenario: "Scenario",
    simulator: "str | Simulator | None" = None,
    *,
    requirement: str | Sequence[str] | None = None,
    objective: "str | Objective | Callable[[Any], float] | None" = None,
    minimize: str | None = None,
    threshold: float = 0.0,
    n: int | None = None,
    budget: int | None = None,
    confidence: float = 0.95,
    precision: float | None = None,
    at_most: float | None = None,
    good: float | None = None,
    power: float = 0.9,
    seed: int | None = None,
    first: int = 0,
    time_limit: float | None = None,
    max_steps: int | None = 100,
    timestep: float | None = None,
    static: bool = False,
    rare: bool = False,
    follow: str | Path | None = None,
    hold: "Scene | int | None" = None,
    against: "Scenario | None" = None,
    processes: int = 1,
    executor: "Executor | None" = None,
    folder: str | Path | None = None,
    resume: bool = False,
) -> Estimate:
    """Estimate how probable it is that a simulation, or a scene, is a counterexample.

    A fixed number of runs has the interval of Clopper and Pearson (1934), a precision one of a confidence sequence, which holds however often
    one looks. ``at_most`` is decided by Wald's sequential test (1945). Raises `EstimateError` for values that contradict each other.

    Args:
        scenario: the program.
        simulator: the name of a simulator, or one; the program's own by default.
        requirement: labels of requirements, or ``line 3``; a run that violates one of them is a counterexample. By default all.
        objective: instead, the name of a record or of a parameter, a function of a simulation's result (or of a scene).
        minimize: instead, an expression over records, or over parameters.
        threshold: largest value of a counterexample, where there is an objective.
        n: number of runs where it is fixed, 1,000 by default.
        budget: runs at most, with a precision, a bound or rare failures; 10,000 by default of the last, else no limit.
        confidence: chance of the interval to contain the probability, between 0 and 1.
        precision: half the width of the interval to reach.
        at_most: the bound of the probability.
        good: probability at which the answer "at most" comes with chance ``power``; half the bound by default.
        power: that chance.
        seed: any integer; drawn from Python's ``random`` if not given.
        first: number of the first run.
        time_limit: seconds after which no new run begins.
        max_steps: steps of a simulation at most.
        timestep: seconds in a step.
        static: take scenes alone, without simulations.
        rare: failures are rare: make runs that lead to them step by step.
        follow: the folder of a search by the sampler ``ce`` or ``cma``.
        hold: a scene, or the number of one, in which all runs take place: only what is drawn in time varies.
        against: another program, which gets the same runs; the result has its estimate and the comparison, too.
        processes: number of processes that simulate; changes speed, never results.
        executor: runs the simulations in place of processes of our own, ``processes`` at a time.
        folder: folder that stores the runs.
        resume: go on with the runs in the folder.

    """
    question = asked_of(
        runs=n, budget=budget, confidence=confidence, precision=precision, at_most=at_most, good=good, power=power,
        rare=rare, follows=follow is not None,
    )  # fmt: skip
    chosen_seed = random.getrandbits(63) if seed is None else whole_number(seed, "seed")

    def runs_of(program: "Scenario") -> Runs:
        return Runs(
            program, chosen_seed, goals_of(program, requirement or (), objective, minimize), threshold, simulator, static, max_steps, timestep,
            whole_number(first, "first", 0), None if hold is None else held_of(program, hold, chosen_seed),
            question.runs if rare else None, None if follow is None else guide_of(Path(follow), program.digest),
        )  # fmt: skip

    programs = [runs_of(program) for program in (scenario, against) if program is not None]
    return _estimates(programs, question, Stop(time_limit), _engine(processes, executor), folder, resume)


def _engine(processes: int, executor: "Executor | None") -> BatchEngine | None:
    """The place where simulations are made; ``None`` is this process."""
    if executor is not None:
        return OverExecutor(executor, max(2, processes))
    return Processes(processes) if processes > 1 else None


def _estimates(
    programs: Sequence[Runs],
    asked: Asked,
    stop: Stop,
    engine: BatchEngine | None,
    folder: str | Path | None,
    resume: bool,
) -> Estimate:
    """The estimate of one program, or of the first of two that are compared."""
    results = []
    for runs, label in zip(programs, ("first", "second"), strict=False):
        runs.check()
        place = None
        if folder is not None:
            path = Path(folder) if len(programs) == 1 else Path(folder) / label
            place = EstimateFolder(path, runs.settings(), asked.to_data(), resume=resume)
        results.append(estimate_runs(runs, asked, stop, engine=engine, folder=place))
    results[0].other = results[1] if len(results) > 1 else None
    return results[0]


def held_of(scenario: "Scenario", scene: "Scene | int", seed: int) -> Held:
    """The draws of a scene, or of the one of a number; raises `EstimateError` if there is none."""
    if not isinstance(scene, int):
        return Held.of(scene)
    (found,) = scenario.chosen({}, 1, seed=seed, first=scene, max_attempts=DEFAULT_ATTEMPTS)
    if isinstance(found, Exhausted):
        raise EstimateError(
            f"no scene {scene} of the seed {seed} meets the requirements", help=found.message()
        )
    return Held.of(found)
