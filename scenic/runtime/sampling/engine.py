"""The sampling engine: lanes of candidates through the checks, the first that passes becomes the scene.

A lane is an attempt at a scene. Lanes of many scenes run side by side; how many attempts at one scene run ahead follows
the measured cost and acceptance (`scenic.runtime.sampling.pace`), and so does the order of the checks. What comes out does
not depend on any of that: a scene is its first attempt, in order, that passes every check, and the draws of each attempt
are fixed in advance by their addresses (`scenic.graph.draws`).
"""

import time
from collections.abc import Callable, Iterable, Iterator, Sequence
from contextlib import suppress
from copy import copy
from dataclasses import field
from functools import partial
from itertools import islice, repeat
from typing import Any

import numpy as np
from numpy.typing import NDArray

from scenic.dataclass import dataclass
from scenic.graph.batch import Batch
from scenic.graph.domain import Domain
from scenic.graph.draws import Counter, LaneOwners, NumberSource, attempt_keys, scene_keys, seed_word
from scenic.graph.kinds import Codec
from scenic.graph.node import Graph, Node
from scenic.graph.schedule import Scheduler
from scenic.language.errors import Located, RejectionException, ScenicError
from scenic.runtime.geometry.ragged import expand, first_of_each
from scenic.runtime.sampling.checks import Check, CheckVerdict, Mask, joined
from scenic.runtime.sampling.pace import Pace
from scenic.runtime.sampling.pending import Pending, SceneTask, soft_address
from scenic.runtime.sampling.profiling import Meter, Profile
from scenic.runtime.sampling.rejection_report import Approximation, Exhausted, RejectionReport, rejection_rows
from scenic.runtime.sampling.stages import Stage, Stages

DEFAULT_LANES = 4096
REPORT_CANDIDATES = 1000

_FIRST_FORESEEN = 8
"""Scenes looked for at first where it is not known how many are wanted: a round of a few more costs hardly more."""

_FIRST_LANES = (8 * _FIRST_FORESEEN, 512)
"""Sizes of a first round: of a loop, and of a batch."""

_REHEARSED_LANES = 64
"""Candidates of a rehearsal."""

_MOST_FORESEEN = 256
"""Scenes looked for at a time, at most, where it is not known how many are wanted."""

_FORESIGHT_SECONDS = 0.05
"""Processor time that looking for them may take."""

BATCH_BYTES = 1 << 27
"""Lanes are bounded so that the columns of a batch take at most about this much memory."""

BODY_BYTES = 400
"""Memory that the placement of one object takes in one lane."""


_KEPT_BYTES = (1 << 25) - (1 << 13)
"""Nearly the largest block by which glibc sets its limits."""


def _keep_freed_memory() -> None:
    """Let the C library keep the memory of columns that are freed for those that come next.

    Otherwise the system takes it back and gives it out again, zeroed, many times in a round: up to a fifth of the time, by
    where blocks happen to lie. glibc's limits follow the largest block freed so far (mallopt(3), M_MMAP_THRESHOLD). Nobody
    writes to this one, so it takes no memory; other allocators have limits of their own.
    """
    np.empty(_KEPT_BYTES, dtype=np.uint8)


@dataclass(frozen=True, slots=True)
class Plan:
    """The plan of sampling: the graph, where in the cube, what must hold, and the nodes that a scene is made of."""

    graph: Graph
    domain: Domain
    checks: Sequence[Check]
    outputs: Sequence[Node]
    codec: Codec
    bodies: int = 0
    """The number of objects, which bounds memory."""
    numbers: tuple[int, ...] | None = None
    """Of a part of a plan: the numbers of its checks in the whole."""
    soft_places: tuple[int, ...] | None = None
    """Of a part of a plan: the numbers of its soft checks among those of the whole."""
    evaluated: Sequence[Node] | None = None
    """Of a part of a plan: the nodes that it needs."""

    @property
    def draws(self) -> int:
        """Number of random numbers that a candidate takes."""
        nodes = self.graph.nodes if self.evaluated is None else self.evaluated
        return sum(node.is_drawn for node in nodes)

    @property
    def lane_bytes(self) -> int:
        """About how much memory one lane takes."""
        nodes = self.graph.nodes if self.evaluated is None else self.evaluated
        numbers = sum(int(np.prod(node.kind.trailing, dtype=int)) for node in nodes if not node.is_constant)
        return 8 * numbers + BODY_BYTES * self.bodies


@dataclass(frozen=True, slots=True, eq=False)
class FinishedLanes:
    """The scenes that a round has found: the lanes of a finished batch.

    ``seeds``, ``numbers`` and ``attempts`` tell of each lane which scene it is, and after how many candidates it was
    found. ``alone`` makes a batch of one lane, to look at its draws. Where a scene is put together from components, ``components``
    ``(n, components)`` tells after how many attempts each was found, and ``attempts`` the largest of these. ``approximation`` tells
    how approximate scenes came about (`scenic.runtime.sampling.approximate`). ``shared`` is for what
    is made of all scenes of the batch together: it lives as long as one of them.
    """

    seeds: Sequence[int]
    numbers: Sequence[int]
    attempts: Sequence[int]
    batch: Batch
    alone: Callable[[int], Batch]
    components: NDArray[np.int64] | None = None
    approximation: Approximation | None = None
    shared: dict[object, Any] = field(default_factory=dict)

    def task(self, lane: int) -> SceneTask:
        """The scene's seed and number."""
        return SceneTask(self.seeds[lane], self.numbers[lane])

    def again(self, lane: int) -> Batch:
        """Return a batch of that lane alone."""
        return self.alone(lane)

    def is_active(self, lane: int, place: int, probability: float) -> bool:
        """Return whether a soft requirement, number ``place`` among those that are checked, had to hold in the scene."""
        seeds = np.array([seed_word(self.seeds[lane])], dtype=np.uint64)
        keys = scene_keys(seeds, np.array([self.numbers[lane]], dtype=np.int64))
        where = np.array([soft_address(place)], dtype=np.uint64)
        return bool(Counter(keys).uniforms(where)[0, 0] < probability)


Accepted = tuple[FinishedLanes, int]
"""A scene: one of those that a round has found. (There are many of them; a class of their own would cost more.)"""


class CandidateError(Exception):
    """An error in an attempt that no requirement rejects.

    ``check`` is where it came up and ``__cause__`` the error that the program's own values raised.
    """

    def __init__(self, check: Check, k: int, attempt: int) -> None:
        super().__init__(f"{check.label} failed in attempt {attempt} of scene {k}")
        self.check = check
        self.k = k
        self.attempt = attempt


class Engine:
    """Samples scenes of a plan. It is kept as long as its plan: it knows what rounds and checks cost.

    Args:
        plan: what to sample.
        source: gives the draws of lanes; by default they are hashed.
        grouped: whether alike nodes are evaluated together; changes speed, never a scene.

    """

    def __init__(
        self,
        plan: Plan,
        source: Callable[[LaneOwners], NumberSource] = lambda lanes: Counter(lanes.keys),
        *,
        grouped: bool = True,
    ) -> None:
        _keep_freed_memory()
        self.plan = plan
        self._source = source
        self._grouped = grouped
        self.candidates = 0
        """Candidates tried so far."""
        self.passed = 0
        """Candidates that met every requirement."""
        self.seconds = 0.0
        """Processor time of all rounds so far."""
        self.rehearsed: int | None = None
        """Number of candidates of the rehearsal that passed; `None` where no rehearsal went through all checks."""
        self.rehearsed_of = _REHEARSED_LANES
        """Number of candidates of a rehearsal."""
        self.met: dict[int, Mask] = {}
        """Candidates of the rehearsal that met a check, by the number of the check; only of checks that it could ask."""
        self._pace = Pace(
            max(64, min(DEFAULT_LANES, BATCH_BYTES // max(1, plan.lane_bytes))),
            any(node.runs_python for node in plan.graph.nodes),
        )
        self._scheduler = Scheduler(plan.graph, grouped=grouped)
        self._single = Scheduler(plan.graph, grouped=False)
        self._stages = Stages(plan.checks, plan.outputs, self._scheduler)
        self._meter: Meter | None = None
        self._soft = [index for index, check in enumerate(plan.checks) if check.probability < 1]
        self._numbers = range(len(plan.checks)) if plan.numbers is None else plan.numbers
        self._soft_places = range(len(self._soft)) if plan.soft_places is None else plan.soft_places
        self._chances = np.array([plan.checks[index].probability for index in self._soft])

    def prepare(self) -> None:
        """Make what the first round would otherwise wait for."""
        self._rehearse()
        self._stages.renew()
        for lanes in _FIRST_LANES:
            self._stages.expected(lanes)

    def _rehearse(self) -> None:
        """Take candidates that nobody sees through the checks.

        This makes now what is made once: imports of libraries, tables of meshes and regions. It also measures, for the first
        round, what checks cost and how many candidates pass. Python code of the program is not called, and what
        depends on it is left out. A problem is left to the first round, which raises it if scenes are wanted.
        """
        scheduler, checks, outputs = self._scheduler, self.plan.checks, self.plan.outputs
        keys = _attempts(SceneTask(0, 0), np.arange(_REHEARSED_LANES, dtype=np.int64)).keys
        start_time = time.thread_time()
        batch = self.batch(Counter(keys))
        nodes = (*outputs, *(node for check in checks for node in check.nodes))
        clear = scheduler.without_python(nodes)
        with suppress(ScenicError), np.errstate(all="ignore"):
            if len(clear) < len(nodes):
                constant_nodes = set(clear)
                batch.need(clear)
                for index, check in enumerate(checks):
                    if constant_nodes.issuperset(check.nodes):
                        self._note(index, check.test(batch))
                return
            stages = self._stages.expected(_FIRST_LANES[-1])
            for stage in stages:
                batch.follow(stage.schedule, stage.nodes)
                for index in stage.checks:
                    self._note(index, checks[index].test(batch))
            middle_time = time.thread_time()
            self._pace.add(len(keys), 0, middle_time - start_time)
            # What the first turn has made, the second one finds: that one is measured.
            batch = self.batch(Counter(keys))
            self._judge(batch, stages[:-1], None)
            self.rehearsed = len(batch)
            self._pace.add(len(keys), len(batch), time.thread_time() - middle_time)

    def _note(self, index: int, verdict: CheckVerdict) -> None:
        self.met[index] = verdict.holds if verdict.failed is None else verdict.holds & ~verdict.failed

    def scenes(
        self,
        tasks: Iterable[tuple[int, int]],
        *,
        max_attempts: int,
        lanes: int | None = None,
        deadline: float | None = None,
        tried: int = 0,
    ) -> Iterator[Accepted | Exhausted]:
        """The scenes of ``tasks``, in order.

        Args:
            tasks: which scenes: seeds, and numbers in the run of a seed.
            max_attempts: candidates tried for one scene before it is given up.
            lanes: candidates in one batch at most; changes speed and memory, never the scenes.
            deadline: a time of `time.monotonic` after which the scenes not yet found are given up.
            tried: candidates of each scene that are known to be rejected.

        Raises:
            CandidateError: a candidate failed that nothing rejects.

        """
        most = self._pace.most if lanes is None else lanes
        return self._results(tasks, max_attempts, most, lambda _: (most, most * 3 // 2), deadline, tried)

    def foresee(
        self, tasks: Iterable[tuple[int, int]], *, max_attempts: int, more: bool = True
    ) -> Iterator[Accepted | Exhausted]:
        """Return the same as `scenes` for tasks without end, of which nobody knows how many are wanted.

        A few are looked for at first (one, unless ``more`` are expected to be wanted), then more at a time the more have
        been wanted, as long as that takes little time.
        """
        before = self.seconds

        def window(given: int) -> tuple[int, int]:
            likely = _FIRST_FORESEEN if more else 1
            if given:
                # A round costs mostly the same whatever its size. So much is found in vain, if nobody wants more, as takes
                # about as long as all before.
                fixed_cost, _ = self._pace.cost()
                likely = max(32 * given, self._pace.scenes_within(fixed_cost + self.seconds - before))
            # Where a round that finds next to nothing takes longer, so may one that finds many.
            patience = max(_FORESIGHT_SECONDS, 2 * self._pace.cost()[0])
            scene_count = min(likely, _MOST_FORESEEN, self._pace.scenes_within(patience))
            return scene_count, scene_count * 3 // 2 if given >= _MOST_FORESEEN else scene_count

        return self._results(tasks, max_attempts, self._pace.most, window, None)

    def _results(
        self,
        tasks: Iterable[tuple[int, int]],
        max_attempts: int,
        most: int,
        window: Callable[[int], tuple[int, int]],
        deadline: float | None,
        tried: int = 0,
    ) -> Iterator[Accepted | Exhausted]:
        """Scenes in order; rounds have at most ``most`` lanes.

        ``window`` says, when so many have been given, how many scenes are looked for at a time, and how many these may be
        together with those found already that wait for an earlier one. Where these are more, one that takes many attempts
        does not hold up the others at once; where not, less is found in vain.
        """
        waiting = iter(tasks)
        pending = Pending(self._chances, self._soft_places, tried)
        results: dict[int, Accepted | Exhausted | CandidateError] = {}
        upcoming = 0
        more = True
        while True:
            scene_count, room = window(upcoming)
            missing = min(scene_count, room - len(results)) - len(pending)
            if missing > 0 and more:
                new_tasks = list(islice(waiting, missing))
                pending.add(new_tasks)
                more = len(new_tasks) == missing
            if not len(pending):
                return
            if deadline is not None and time.monotonic() > deadline:
                every = np.ones(len(pending), dtype=np.bool_)
                self._give_up(pending, every, "time", results)
                pending.leave(every)
            else:
                self._round(
                    pending, results, max_attempts, scene_count, most, more=more and room > scene_count
                )
            while (result := results.pop(upcoming, None)) is not None:
                if type(result) is not tuple and isinstance(result, CandidateError):
                    raise result
                yield result
                upcoming += 1

    def driven(self, source: Callable[[LaneOwners], NumberSource]) -> "Engine":
        """The engine with other draws; it knows, and learns, what rounds and checks cost together with this one."""
        other = copy(self)
        other._source = source
        return other

    def metered(self, meter: Meter) -> "Engine":
        """Return the engine with a meter of what it does; it knows, and learns, what rounds and checks cost together with this one."""
        other = copy(self)
        other._meter = meter
        return other

    def profile(self, scenes: int) -> Profile:
        """Return the measurements of this engine's meter while it found a number of scenes."""
        assert self._meter is not None
        return self._meter.profile(scenes, self.plan.checks, self._scheduler)

    # One round

    def _round(
        self,
        pending: Pending,
        done: dict[int, Accepted | Exhausted | CandidateError],
        max_attempts: int,
        wanted: int,
        most: int,
        *,
        more: bool,
    ) -> None:
        start_time = time.thread_time()
        round_size = self._pace.choose(min(len(pending), wanted), most, more=more)
        active = slice(round_size.scenes)
        counts = np.minimum(round_size.ahead, max_attempts - pending.attempts[active])
        owner, offset = expand(counts)
        attempts = pending.attempts[owner] + offset
        batch = self.attempts_at(pending, owner, attempts)
        *stages, last = self._stages.order(len(batch))
        failures = self._judge(batch, stages, pending.inactive[owner] if self._soft else None)
        pending.attempts[active] += counts
        rows = batch.rows
        first = first_of_each(owner[rows])
        failure_numbers = failures[rows]
        self.candidates += len(owner)
        pass_count = int((failure_numbers < 0).sum())
        self.passed += pass_count
        is_finished = np.zeros(len(pending), dtype=np.bool_)
        is_finished[owner[rows[first]]] = True
        for row in rows[first[failure_numbers[first] >= 0]].tolist():
            scene = int(owner[row])
            check = self.plan.checks[int(failures[row])]
            done[int(pending.number[scene])] = self._error(check, pending.task(scene), int(attempts[row]))
        good = first[failure_numbers[first] < 0]
        scenes = self._completed(batch, last, good, pending, owner, attempts)
        done.update(zip(pending.number[owner[rows[good]]].tolist(), scenes, strict=True))
        hopeless = ~is_finished & (pending.attempts >= max_attempts)
        self._give_up(pending, hopeless, "attempts", done)
        pending.leave(is_finished | hopeless)
        seconds = time.thread_time() - start_time
        self.seconds += seconds
        self._pace.add(len(owner), pass_count, seconds)
        if self._meter is not None:
            self._meter.round(len(owner), pass_count, seconds)

    def _completed(
        self,
        batch: Batch,
        last: Stage,
        good: NDArray[np.intp],
        pending: Pending,
        owner: NDArray[np.intp],
        attempts: NDArray[np.int64],
    ) -> list[Accepted]:
        """Complete the scenes of the accepted lanes, ``good`` among those that are left in the batch."""
        if not len(good):
            return []
        rows = batch.rows[good]
        batch.keep(good)
        batch.follow(last.schedule, last.nodes)
        batch.settle(last.nodes)
        scenes = owner[rows]
        lanes = self._found(
            pending.given[scenes].tolist(), pending.k[scenes].tolist(), (attempts[rows] + 1).tolist(), batch
        )
        return list(zip(repeat(lanes), range(len(scenes))))

    def first_candidates(
        self, tasks: Sequence[tuple[int, int]]
    ) -> list[tuple[int, Accepted | CandidateError]]:
        """Return the first candidates for some scenes, each evaluated once: those that nothing rejects, with their places, in order."""
        start_time = time.thread_time()
        pending = self.pending(tasks)
        owner = np.arange(len(tasks))
        batch = self.attempts_at(pending, owner, pending.attempts)
        *stages, last = self._stages.order(len(batch))
        failures = self._judge(batch, stages, pending.inactive if self._soft else None)
        rows = batch.rows
        is_failure = failures[rows] >= 0
        results: dict[int, Accepted | CandidateError] = {
            row: self._error(self.plan.checks[int(failures[row])], pending.task(row), 0)
            for row in rows[is_failure].tolist()
        }
        good = np.flatnonzero(~is_failure)
        scenes = self._completed(batch, last, good, pending, owner, pending.attempts)
        results.update(zip(rows[good].tolist(), scenes, strict=True))
        seconds = time.thread_time() - start_time
        self.candidates += len(owner)
        self.passed += len(rows)
        self.seconds += seconds
        self._pace.add(len(owner), len(rows), seconds)
        return sorted(results.items())

    def lanes_for(self, scenes: int) -> int:
        """The number of candidates that are best evaluated together where so many scenes are wanted."""
        chosen = self._pace.choose(scenes, self._pace.most, more=False)
        return chosen.scenes * chosen.ahead

    def replay(
        self, source: NumberSource, task: SceneTask, attempts: int, kind: Callable[..., Batch] = Batch
    ) -> Accepted:
        """The scene of given draws, one lane of points of the cube; no check is made again.

        ``kind`` makes its batch, as `Batch` does.
        """
        arguments, rejections = (self._single, source, self.plan.codec), (RejectionException,)
        batch = kind(*arguments, rejections=rejections)
        batch.settle(self.plan.outputs)
        alone = partial(Batch, *arguments, rejections=rejections)
        return FinishedLanes([task.seed], [task.k], [attempts], batch, lambda _lane: alone()), 0

    def accepted(self, seed: int, numbers: NDArray[np.int64], attempts: NDArray[np.int64]) -> list[Accepted]:
        """Scenes of a seed of which the accepted candidates are known; no check is made again.

        Args:
            seed: their seed.
            numbers: which scenes of the seed, ``(n,)``.
            attempts: how many candidates were tried for each, the accepted one included, ``(n,)``.

        """
        seeds = np.repeat(seed_word(seed), len(numbers))
        keys = attempt_keys(scene_keys(seeds, numbers), attempts - 1)
        batch = self.batch(self._source(LaneOwners(seeds, numbers, attempts - 1, keys)))
        batch.settle(self.plan.outputs)
        lanes = self._found([seed] * len(numbers), numbers.tolist(), attempts.tolist(), batch)
        return [(lanes, lane) for lane in range(len(numbers))]

    def _found(
        self, seeds: Sequence[int], numbers: Sequence[int], attempts: Sequence[int], batch: Batch
    ) -> FinishedLanes:
        def alone(lane: int) -> Batch:
            return self._alone(SceneTask(seeds[lane], numbers[lane]), attempts[lane] - 1)

        return FinishedLanes(seeds, numbers, attempts, batch, alone)

    @property
    def most_lanes(self) -> int:
        """Candidates that fit into memory together."""
        return self._pace.most

    def trial(self, tasks: Sequence[tuple[int, int]]) -> int:
        """Number of the first candidates for some scenes that meet every requirement."""
        pending = self.pending(tasks)
        batch = self.attempts_at(pending, np.arange(len(tasks)), pending.attempts)
        *stages, _ = self._stages.order(len(batch))
        failures = self._judge(batch, stages, pending.inactive if self._soft else None)
        return int(np.count_nonzero(failures[batch.rows] < 0))

    def rehearsal(self) -> int:
        """Number of the candidates of a rehearsal that meet every requirement."""
        keys = _attempts(SceneTask(0, 0), np.arange(_REHEARSED_LANES, dtype=np.int64)).keys
        batch = self.batch(Counter(keys))
        *stages, _ = self._stages.order(len(batch))
        failures = self._judge(batch, stages, None)
        return int(np.count_nonzero(failures[batch.rows] < 0))

    # What scenes put together from components need (`scenic.runtime.sampling.piecewise`)

    def of_part(self, plan: Plan) -> "Engine":
        """An engine for a part of the plan, with the same draws."""
        return Engine(plan, self._source, grouped=self._grouped)

    def source_of(self, lanes: LaneOwners) -> NumberSource:
        """The random numbers of some lanes."""
        return self._source(lanes)

    def pending(self, tasks: Sequence[tuple[int, int]]) -> Pending:
        """Scenes to be looked for."""
        pending = Pending(self._chances, self._soft_places)
        pending.add(tasks)
        return pending

    def attempts_at(self, pending: Pending, owner: NDArray[np.intp], attempts: NDArray[np.int64]) -> Batch:
        """Return a batch of lanes: attempts ``(n,)`` at the scenes ``owner`` ``(n,)`` among the pending ones."""
        keys = attempt_keys(pending.key[owner], attempts)
        return self.batch(self._source(LaneOwners(pending.seed[owner], pending.k[owner], attempts, keys)))

    def note(self, number: int, lanes: int, passed: int, seconds: float) -> None:
        """Report to the meter the number of lanes that a check has tested."""
        if self._meter is not None:
            self._meter.check(number, lanes, passed, seconds)

    def note_round(self, lanes: int, passed: int, seconds: float) -> None:
        """Let the meter know of a round."""
        self.seconds += seconds
        if self._meter is not None:
            self._meter.round(lanes, passed, seconds)

    def evaluate(self, batch: Batch, nodes: tuple[Node, ...]) -> None:
        """Evaluate nodes in a new batch; their values can be read until the next call."""
        (schedule,) = self._scheduler.chain([nodes])
        batch.follow(schedule, nodes)

    def make_ready(self, nodes: tuple[Node, ...]) -> None:
        """Make what `evaluate`, and the scenes after it, would otherwise wait for."""
        self._scheduler.chain([nodes])
        self._scheduler.after(self._scheduler.start, tuple(self.plan.outputs))

    def given_up(self, seed: int, k: int, attempts: int) -> Exhausted:
        """The report on a scene that was not found among a number of candidates."""
        return Exhausted(seed, k, attempts, "attempts", self.report(SceneTask(seed, k), attempts))

    def batch(self, source: NumberSource, *, grouped: bool = True, domain: Domain | None = None) -> Batch:
        """Return a batch of lanes whose draws come from a source, in the plan's domain unless another one is given."""
        return Batch(
            self._scheduler if grouped else self._single,
            source,
            self.plan.codec,
            domain=self.plan.domain if domain is None else domain,
            rejections=(RejectionException,),
            meter=None if self._meter is None else self._meter.step,
        )

    def _judge(
        self, batch: Batch, stages: Sequence[Stage], inactive: NDArray[np.bool_] | None
    ) -> NDArray[np.intp]:
        """Run the checks, leaving in the batch the lanes that none rejects.

        Returns for each first lane the check, first in the program, at which it fails with an error (-1 for none).
        """
        checks = self.plan.checks
        failures = np.full(len(batch), -1, dtype=np.intp)
        failed_at = np.full(len(batch), np.iinfo(np.int64).max, dtype=np.int64)
        for stage in stages:
            if len(batch) == 0:
                break
            start_time = time.thread_time()
            try:
                batch.follow(stage.schedule, stage.nodes)
            except Located as error:
                self._place(error, batch, stage)
                raise
            seconds_of_stage = (time.thread_time() - start_time) / len(stage.checks)
            rows = batch.rows
            alive = np.ones(len(rows), dtype=np.bool_)
            for index in stage.checks:
                check = checks[index]
                start_time = time.thread_time()
                verdict = check.test(batch)
                if inactive is not None and check.probability < 1:
                    verdict = verdict.unless(inactive[rows, self._soft.index(index)])
                passes = verdict.passes
                if verdict.failed is not None:
                    place = check.position * len(checks) + index  # checks of one position by their numbers
                    earlier = verdict.failed & (place < failed_at[rows])
                    failures[rows[earlier]] = index
                    failed_at[rows[earlier]] = place
                seconds = seconds_of_stage + time.thread_time() - start_time
                pass_count = int(np.count_nonzero(passes))
                self._stages.measure(index, len(rows), seconds, pass_count)
                if self._meter is not None:
                    self._meter.check(self._numbers[index], len(rows), pass_count, seconds - seconds_of_stage)
                alive &= passes
            if not alive.all():
                batch.keep(alive)
        return failures

    def _place(self, error: Located, batch: Batch, stage: Stage) -> None:
        """Give an error of an operation the place of the first check, in program order, that has it when made alone."""
        for check in sorted(
            (self.plan.checks[index] for index in stage.checks), key=lambda each: each.position
        ):
            try:
                check.test(self.batch(batch.source))
            except Located:
                error.at((check.span, check.filename))
                return

    # Scenes, errors, reports

    def _alone(self, task: SceneTask, attempt: int) -> Batch:
        return self.batch(self.source(task, attempt), grouped=False)

    def source(self, task: SceneTask, attempt: int) -> NumberSource:
        """The random numbers of one attempt at a scene."""
        return self._source(LaneOwners.of(task.seed, task.k, attempt))

    def _error(self, check: Check, task: SceneTask, attempt: int) -> CandidateError:
        """Return the error of a lane, found by evaluating it alone."""
        batch = self._alone(task, attempt)
        check.test(batch)
        error = CandidateError(check, task.k, attempt)
        error.__cause__ = next((batch.errors[node] for node in check.nodes if node in batch.errors), None)
        return error

    def _give_up(
        self,
        pending: Pending,
        which: NDArray[np.bool_],
        reason: str,
        done: dict[int, Accepted | Exhausted | CandidateError],
    ) -> None:
        for row in np.flatnonzero(which).tolist():
            task, attempts = pending.task(row), int(pending.attempts[row])
            done[int(pending.number[row])] = Exhausted(
                task.seed, task.k, attempts, reason, self.report(task, attempts)
            )

    def report(self, task: SceneTask, attempts: int) -> RejectionReport:
        """Each check's share in the rejections among the first attempts at a scene.

        Every check is evaluated on every candidate, so the figures are facts of the program and not of the order in
        which the engine happens to make the checks.
        """
        count = max(1, min(attempts, REPORT_CANDIDATES))
        size = self._pace.most
        batches = [
            [
                part
                for check in self.plan.checks
                for part in check.parts(self.batch(self._source(_attempts(task, numbers))))
            ]
            for numbers in np.split(np.arange(count, dtype=np.int64), range(size, count, size))
        ]
        return RejectionReport(count, rejection_rows(list(map(joined, zip(*batches, strict=True)))))


def _attempts(task: SceneTask, numbers: NDArray[np.int64]) -> LaneOwners:
    """Lanes of some attempts at a scene."""
    seeds = np.repeat(seed_word(task.seed), len(numbers))
    scenes = np.repeat(np.int64(task.k), len(numbers))
    return LaneOwners(seeds, scenes, numbers, attempt_keys(scene_keys(seeds, scenes), numbers))
