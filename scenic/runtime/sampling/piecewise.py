"""Scenes put together from components, each of which has attempts of its own.

A scene is, of each component, the first attempt that passes its checks. All components are tried together first: alike nodes
of a hundred parking lots are evaluated in one call. Those that have found nothing go on alone.
"""

import time
from collections.abc import Callable, Iterable, Iterator, Sequence
from copy import copy
from dataclasses import replace
from itertools import islice
from typing import Any, Final

import numpy as np
from numpy.typing import NDArray

from scenic.dataclass import dataclass
from scenic.graph.batch import Batch
from scenic.graph.draws import LaneOwners, NumberSource, attempt_keys, scene_keys, seed_word
from scenic.runtime.geometry.ragged import expand
from scenic.runtime.sampling.apart import Apart
from scenic.runtime.sampling.components import Components
from scenic.runtime.sampling.composed import Composed
from scenic.runtime.sampling.crowd_chains import is_loose, settle
from scenic.runtime.sampling.engine import Accepted, CandidateError, Engine, FinishedLanes
from scenic.runtime.sampling.halving import Tree
from scenic.runtime.sampling.joining import Joined, join
from scenic.runtime.sampling.pairing import pair
from scenic.runtime.sampling.pending import SceneTask
from scenic.runtime.sampling.profiling import Meter, Profile
from scenic.runtime.sampling.rejection_report import Approximation, Exhausted, joined

__all__ = ["PiecewiseEngine"]

_BLOCK: Final = 1024
"""Scenes looked for at a time."""

_FORESEEN: Final = (8, 256)
"""Scenes looked for at first, and at most, where nobody knows how many are wanted."""

_FORESIGHT_SECONDS: Final = 0.0125
"""Longest time of a block of scenes after which the next block is always four times as large; after that time
the next block only grows while the earlier blocks together took four times as long."""

_LONGEST_SECONDS: Final = 1.0
"""Time of a block of scenes from which later blocks do not grow."""

_TOGETHER: Final = 32
"""Lanes in which all components are tried together."""

_FAILED: Final = -1
"""In the place of an attempt: the first one that nothing rejects has failed."""


@dataclass(frozen=True, slots=True)
class _Limits:
    """Limits on the effort for a scene; see `Engine.scenes`. ``approximate``: crowds are moved until they are nearly of their law."""

    attempts: int
    lanes: int | None = None
    deadline: float | None = None
    approximate: bool = False


class _Block:
    """Scenes that are looked for together.

    ``attempts`` ``(n, leaves)`` are those that were accepted, 0 where none is known yet. ``missing`` and ``errors`` tell, by scene, why
    it was not found; nothing is known of scenes from ``end`` on.
    """

    def __init__(self, tasks: Sequence[tuple[int, int]], leaves: int) -> None:
        self.tasks = tasks
        self.attempts = np.zeros((len(tasks), leaves), dtype=np.int64)
        self.missing: dict[int, Exhausted] = {}
        self.errors: dict[int, list[CandidateError]] = {}
        self.end = len(tasks)
        self.reports: list[Approximation] = []


class PiecewiseEngine:
    """Samples a plan component by component; has the interface of `Engine` as far as scenes are looked for.

    Args:
        whole: the engine of the whole plan.
        components: its components.

    """

    def __init__(self, whole: Engine, components: Components) -> None:
        self._whole = whole
        self._components = components
        self._engines: list[Engine | None] = [None] * len(components.plans)
        self._whole_ones = [number for number, tree in enumerate(components.trees) if tree is None]
        """The components that are not divided."""
        plans = [components.plans[number] for number in self._whole_ones]
        self._nodes = tuple(
            dict.fromkeys(node for plan in plans for check in plan.checks for node in check.nodes)
        )

    @property
    def count(self) -> int:
        """The number of components."""
        return len(self._engines)

    @property
    def engines(self) -> list[Engine]:
        """An engine for each component."""
        return [self._engine(number) for number in range(self.count)]

    def prepare(self) -> None:
        """Make what the first round would otherwise wait for."""
        self._whole.prepare()
        if self._nodes:
            self._whole.make_ready(self._nodes)

    def driven(self, source: Callable[[LaneOwners], NumberSource]) -> "PiecewiseEngine":
        """The same with other draws (`Engine.driven`)."""
        other = copy(self)
        other._whole = self._whole.driven(source)
        other._engines = [engine.driven(source) for engine in self.engines]
        return other

    def metered(self, meter: Meter) -> "PiecewiseEngine":
        """Return the same with a meter of what it does (`Engine.metered`)."""
        other = copy(self)
        other._whole = self._whole.metered(meter)
        other._engines = [engine.metered(meter) for engine in self.engines]
        return other

    def profile(self, scenes: int) -> Profile:
        """Return the measurements of the meter while a number of scenes were found; candidates of all components are counted together."""
        return self._whole.profile(scenes)

    def scenes(
        self,
        tasks: Iterable[tuple[int, int]],
        *,
        max_attempts: int,
        lanes: int | None = None,
        deadline: float | None = None,
    ) -> Iterator[Accepted | Exhausted]:
        """The scenes of ``tasks``, in order; as `Engine.scenes`, with ``max_attempts`` for each component."""
        waiting, limits = iter(tasks), _Limits(max_attempts, lanes, deadline)
        while block := list(islice(waiting, _BLOCK)):
            yield from self._block(block, limits)

    def can_approximate(self) -> bool:
        """Return whether crowds that can be moved are all that makes scenes rare."""
        crowds = [tree for tree in self._components.trees if isinstance(tree, Apart)]
        others = [self._engine(number) for number in self._whole_ones]
        return (
            bool(crowds)
            and len(crowds) + len(others) == self.count
            and all(map(is_loose, crowds))
            and all(engine.rehearsal() > 0 for engine in others)
        )

    def approximate(
        self, tasks: Sequence[tuple[int, int]], *, max_attempts: int, together: int
    ) -> Iterator[Accepted | Exhausted]:
        """The scenes of ``tasks``, in order, with crowds that are only nearly of their law (`can_approximate`)."""
        limits = _Limits(max_attempts, approximate=True)
        for start in range(0, len(tasks), together):
            yield from self._block(tasks[start : start + together], limits)

    def foresee(
        self, tasks: Iterable[tuple[int, int]], *, max_attempts: int, more: bool = True
    ) -> Iterator[Accepted | Exhausted]:
        """The same for tasks without end, of which nobody knows how many are wanted."""
        waiting, limits = iter(tasks), _Limits(max_attempts)
        size = _FORESEEN[0] if more else 1
        seconds = 0.0
        while tasks_here := list(islice(waiting, size)):
            start_time = time.thread_time()
            block = self._block(tasks_here, limits)
            first = next(block)  # which takes the time of all of them
            last = time.thread_time() - start_time
            seconds += last
            yield first
            yield from block
            # A larger block that nobody wants takes at most about as long as all before, and mostly hardly longer than the last.
            if last < _FORESIGHT_SECONDS or (last < _LONGEST_SECONDS and 4 * last <= seconds):
                size = min(4 * size, _FORESEEN[1])

    def accepted(self, seed: int, numbers: NDArray[np.int64], attempts: NDArray[np.int64]) -> list[Accepted]:
        """Scenes of a seed of which the accepted attempts ``(n, leaves)`` are known; no check is made again."""
        return self._finished([(seed, int(k)) for k in numbers], attempts)

    def _engine(self, number: int) -> Engine:
        engine = self._engines[number]
        if engine is None:
            engine = self._engines[number] = self._whole.of_part(self._components.plans[number])
        return engine

    def _block(self, tasks: Sequence[tuple[int, int]], limits: _Limits) -> Iterator[Accepted | Exhausted]:
        block = _Block(tasks, self._components.leaves)
        ahead = 0
        if self._nodes and len(tasks) <= _TOGETHER and (limits.lanes is None or limits.lanes >= len(tasks)):
            ahead = min(limits.attempts, _TOGETHER // len(tasks))
            self._together(block, ahead)
        for number, tree in enumerate(self._components.trees):
            if tree is None:
                self._alone(number, block, ahead, limits)
            else:
                self._joined(tree, block, limits)
        good = [row for row in range(block.end) if row not in block.missing and row not in block.errors]
        approximation = joined(block.reports)
        scenes = iter(self._finished([tasks[row] for row in good], block.attempts[good], approximation))
        for row in range(block.end):
            if row in block.missing:
                yield block.missing[row]
            elif row in block.errors:
                raise min(block.errors[row], key=lambda error: error.check.position)
            else:
                yield next(scenes)
        if block.end < len(tasks):
            yield from self._block(tasks[block.end :], limits)

    def _alone(self, number: int, block: _Block, tried: int, limits: _Limits) -> None:
        """Look for one component of the scenes in which it is missing."""
        mine = block.attempts[: block.end, self._components.places[number]]
        if (mine == _FAILED).any():
            tried, mine[:] = 0, np.where(mine == _FAILED, 0, mine)  # its own engine finds out what failed
        rows = np.flatnonzero(mine == 0).tolist()
        if not rows:
            return
        tasks = [block.tasks[row] for row in rows]
        if tried >= limits.attempts:
            for row, (seed, k) in zip(rows, tasks, strict=True):
                block.missing.setdefault(row, self._whole.given_up(seed, k, tried))
            return
        results = self._engine(number).scenes(
            tasks, max_attempts=limits.attempts, lanes=limits.lanes, deadline=limits.deadline, tried=tried
        )
        for row in rows:
            try:
                result = next(results)
            except CandidateError as error:
                block.errors.setdefault(row, []).append(error)
                block.end = row + 1
                return
            if isinstance(result, Exhausted):
                # All requirements are told of, not only those of the component.
                report = self._whole.report(SceneTask(result.seed, result.k), result.attempts)
                block.missing.setdefault(row, replace(result, report=report))
            else:
                lanes, lane = result
                mine[row] = lanes.attempts[lane]

    def _joined(self, tree: Tree | Apart, block: _Block, limits: _Limits) -> None:
        """Look for a component that is divided."""
        rows = [row for row in range(block.end) if row not in block.missing]
        if not rows:
            return
        tasks = [block.tasks[row] for row in rows]
        options: dict[str, Any] = {
            "max_attempts": limits.attempts,
            "lanes": limits.lanes,
            "deadline": limits.deadline,
        }
        start_time = time.thread_time()
        search_result: Joined
        if isinstance(tree, Apart) and limits.approximate:
            search_result, report = settle(self._whole, tree, tasks, max_attempts=limits.attempts)
            block.reports.append(report)
        elif isinstance(tree, Apart):
            search_result = pair(self._whole, tree, tasks, **options)
        else:
            search_result = join(self._whole, tree, tasks, **options)
        attempt_count, pass_count = (
            int(search_result.tried.sum()),
            int(np.count_nonzero(search_result.attempts[:, 0])),
        )
        self._whole.note_round(attempt_count, pass_count, time.thread_time() - start_time)
        block.attempts[rows, tree.first : tree.stop] = search_result.attempts
        for row, (seed, k), attempt_count, attempts in zip(
            rows, tasks, search_result.tried.tolist(), search_result.attempts, strict=True
        ):
            if not attempts[0]:
                given_up = self._whole.given_up(seed, k, attempt_count)
                reason = "attempts" if search_result.in_time else "time"
                block.missing.setdefault(row, replace(given_up, reason=reason))

    def _together(self, block: _Block, ahead: int) -> None:
        """Make a number of attempts at all components that are not divided."""
        start_time = time.thread_time()
        pending = self._whole.pending(block.tasks)
        owner, offset = expand(np.full(len(block.tasks), ahead, dtype=np.int64))
        batch = self._whole.attempts_at(pending, owner, offset)
        self._whole.evaluate(batch, self._nodes)
        passes = np.ones((len(self._whole_ones), len(owner)), dtype=np.bool_)
        has_fault = np.zeros((len(self._whole_ones), len(owner)), dtype=np.bool_)
        for number, component in enumerate(self._whole_ones):
            plan = self._components.plans[component]
            soft = iter(plan.soft_places or ())
            for index, check in zip(plan.numbers or (), plan.checks, strict=True):
                check_start = time.perf_counter()
                verdict = check.test(batch)
                if check.probability < 1:
                    verdict = verdict.unless(pending.inactive[owner, next(soft)])
                passes[number] &= verdict.passes
                if verdict.failed is not None:
                    has_fault[number] |= verdict.failed
                seconds = time.perf_counter() - check_start
                self._whole.note(index, len(owner), int(np.count_nonzero(verdict.passes)), seconds)
        self._whole.note_round(len(owner), int(passes.all(axis=0).sum()), time.thread_time() - start_time)
        shape = (len(self._whole_ones), len(block.tasks), ahead)
        passes, has_fault = passes.reshape(shape), has_fault.reshape(shape)
        first = passes.argmax(axis=2)
        fails = np.take_along_axis(has_fault, first[..., np.newaxis], axis=2)[..., 0]
        places = [self._components.places[number] for number in self._whole_ones]
        block.attempts[:, places] = np.where(passes.any(axis=2), np.where(fails, _FAILED, first + 1), 0).T

    def _finished(
        self,
        tasks: Sequence[tuple[int, int]],
        attempts: NDArray[np.int64],
        approximation: Approximation | None = None,
    ) -> list[Accepted]:
        """Scenes of known attempts ``(n, leaves)``."""
        if not tasks:
            return []
        seeds, numbers = [seed for seed, _ in tasks], [k for _, k in tasks]
        batch = self._whole.batch(self._source(seeds, numbers, attempts))
        batch.settle(self._whole.plan.outputs)

        def alone(lane: int) -> Batch:
            one = slice(lane, lane + 1)
            return self._whole.batch(self._source(seeds[one], numbers[one], attempts[one]), grouped=False)

        most = attempts.max(axis=1).tolist()
        lanes = FinishedLanes(seeds, numbers, most, batch, alone, attempts, approximation)
        return [(lanes, lane) for lane in range(len(tasks))]

    def _source(
        self, seeds: Sequence[int], numbers: Sequence[int], attempts: NDArray[np.int64]
    ) -> NumberSource:
        words = np.array([seed_word(seed) for seed in seeds], dtype=np.uint64)
        scenes = np.array(numbers, dtype=np.int64)
        keys = scene_keys(words, scenes)
        sources = [
            self._whole.source_of(LaneOwners(words, scenes, mine - 1, attempt_keys(keys, mine - 1)))
            for mine in attempts.T
        ]
        return Composed(sources, self._components.owner)
