"""The sampling engine: lanes of candidates through the checks, the first that passes becomes the scene.

A lane is an attempt of a scene. Lanes of many scenes run side by side; how many attempts of one scene run ahead follows
the measured acceptance. What comes out does not depend on any of that: scene ``k`` is its first attempt, in order, that
passes every check, and each attempt's point of the cube is fixed in advance (`scenic.runtime.sampling.streams`).
"""

import math
import time
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

from scenic.graph.batch import Batch
from scenic.graph.domain import Domain
from scenic.graph.kinds import Codec, Column
from scenic.graph.node import Graph, Node
from scenic.language.errors import RejectionException
from scenic.runtime.sampling.checks import Check
from scenic.runtime.sampling.report import Exhausted, RejectionReport, RejectionRow
from scenic.runtime.sampling.streams import SOFT, Streams

DEFAULT_LANES = 4096
REPORT_CANDIDATES = 1000
FIRST_LANES = 256
"""Candidates of the first round, before their cost is known."""

CHEAP_ROUND = 0.02
"""Seconds up to which the length of a round does not matter."""

ROUND_SECONDS = 2.0
"""Rounds are cut to about this time, so that limits and interrupts are noticed soon."""


@dataclass(frozen=True, slots=True)
class Plan:
    """What to sample: the graph, where in the cube, what must hold, and the nodes that a scene is made of."""

    graph: Graph
    domain: Domain
    checks: Sequence[Check]
    outputs: Sequence[Node]
    codec: Codec


@dataclass(frozen=True, slots=True)
class Accepted:
    """A scene's values: one lane of the columns of the plan's outputs."""

    seed: int
    k: int
    attempts: int
    columns: Mapping[Node, Column]
    lane: int


class CandidateError(Exception):
    """An error in an attempt that no earlier requirement rejects.

    ``check`` is where it came up and ``__cause__`` the error that the program's own values raised.
    """

    def __init__(self, check: Check, k: int, attempt: int) -> None:
        super().__init__(f"{check.label} failed in attempt {attempt} of scene {k}")
        self.check = check
        self.k = k
        self.attempt = attempt


@dataclass(slots=True)
class _Measured:
    """Running cost (seconds a lane) and pass rate of a check, to order the checks by."""

    lanes: float = 0.0
    seconds: float = 0.0
    passed: float = 0.0

    def add(self, lanes: int, seconds: float, passed: int) -> None:
        # Old measurements fade, since costs change with what other checks have already computed.
        self.lanes = 0.8 * self.lanes + lanes
        self.seconds = 0.8 * self.seconds + seconds
        self.passed = 0.8 * self.passed + passed


@dataclass(slots=True)
class _Pending:
    """A scene under way: how many of its attempts have been made, and which soft requirements hold for it."""

    k: int
    attempts: int = 0
    inactive: NDArray[np.bool_] | None = None


@dataclass(slots=True)
class Engine:
    """Samples scenes of a plan.

    Args:
        plan: what to sample.
        seed: seed of the scenes.
        lanes: candidates in one batch; changes speed and memory, never the scenes.

    """

    plan: Plan
    seed: int
    lanes: int = DEFAULT_LANES
    candidates: int = 0
    accepted: int = 0
    _seconds: float = 0.0  # a candidate, in the last round
    _streams: Streams = field(init=False)
    _measured: list[_Measured] = field(init=False)
    _soft: list[int] = field(init=False)

    def __post_init__(self) -> None:
        self._streams = Streams(self.seed)
        self._measured = [_Measured() for _ in self.plan.checks]
        self._soft = [index for index, check in enumerate(self.plan.checks) if check.probability < 1]

    def scenes(
        self, first: int, count: int, *, max_attempts: int, deadline: float | None = None
    ) -> Iterator[Accepted | Exhausted]:
        """Scenes ``first`` to ``first + count``, in order.

        ``deadline`` is a time of `time.monotonic` after which the scenes not yet found are given up. Raises
        `CandidateError`.
        """
        waiting = iter(range(first, first + count))
        pending: list[_Pending] = []
        done: dict[int, Accepted | Exhausted | CandidateError] = {}
        upcoming = first
        left = count
        while left:
            width = min(left, self._scenes_at_once())
            while len(pending) < width:
                k = next(waiting, None)
                if k is None:
                    break
                pending.append(self._start(k))
            if deadline is not None and time.monotonic() > deadline:
                for scene in [*pending, *(_Pending(k) for k in waiting)]:
                    done[scene.k] = self._give_up(scene, "time")
                pending = []
            else:
                found = self._round(pending[:width], max_attempts)
                for scene in pending[:width]:
                    if scene.k in found:
                        done[scene.k] = found[scene.k]
                    elif scene.attempts >= max_attempts:
                        done[scene.k] = self._give_up(scene, "attempts")
                pending = [scene for scene in pending if scene.k not in done]
            while upcoming in done:
                result = done.pop(upcoming)
                if isinstance(result, CandidateError):
                    raise result
                yield result
                upcoming += 1
                left -= 1

    # One round

    def _acceptance(self) -> float:
        """Estimated probability that a candidate is accepted; falls while none is."""
        return (self.accepted + 0.5) / (self.candidates + 1)

    def _scenes_at_once(self) -> int:
        ahead = max(1, math.ceil(0.2 / self._acceptance()))
        return max(1, self._width() // ahead)

    def _attempts_each(self, scenes: int) -> int:
        # What runs past the first success is wasted, and a round has a cost of its own: cheap candidates run far
        # enough ahead to be likely to find each scene at once, dear ones only as far as the round's cost is worth.
        expected = 1 / self._acceptance()
        affordable = 0.0 if self._seconds == 0 else CHEAP_ROUND / (self._seconds * scenes)
        ahead = min(3 * expected, max(0.5 * expected, affordable))
        return max(1, min(self._width() // scenes, math.ceil(ahead)))

    def _width(self) -> int:
        """Lanes of a round: fewer than allowed only where candidates are slow to evaluate."""
        if self._seconds == 0:
            return min(self.lanes, FIRST_LANES)
        return max(1, min(self.lanes, int(ROUND_SECONDS / self._seconds)))

    def _round(self, pending: Sequence[_Pending], max_attempts: int) -> dict[int, Accepted | CandidateError]:
        begun = time.perf_counter()
        each = self._attempts_each(len(pending))
        counts = [min(each, max_attempts - scene.attempts) for scene in pending]
        owner = np.repeat(np.arange(len(pending)), counts)
        scenes = np.array([scene.k for scene in pending], dtype=np.int64)[owner]
        starts = np.array([scene.attempts for scene in pending], dtype=np.int64)
        firsts = np.concatenate([[0], np.cumsum(counts)[:-1]]).astype(np.int64)
        attempts = starts[owner] + np.arange(len(owner)) - firsts[owner]
        batch = self._batch(scenes, attempts)
        inactive = self._inactive(pending, owner)
        failures = self._survivors(batch, inactive)
        for scene, made in zip(pending, counts, strict=True):
            scene.attempts += made
        self.candidates += len(owner)
        self._seconds = (time.perf_counter() - begun) / len(owner)
        rows = batch.rows
        _, positions = np.unique(owner[rows], return_index=True)
        failed = failures[rows[positions]]
        self.accepted += int((failed < 0).sum())
        found: dict[int, Accepted | CandidateError] = {}
        for row in rows[positions[failed >= 0]].tolist():
            check = self.plan.checks[int(failures[row])]
            found[int(scenes[row])] = self._error(check, int(scenes[row]), int(attempts[row]))
        good = positions[failed < 0]
        if len(good):
            batch.keep(good)
            columns = {node: batch.column(node) for node in self.plan.outputs}
            for lane, row in enumerate(rows[good].tolist()):
                k = int(scenes[row])
                found[k] = Accepted(self.seed, k, int(attempts[row]) + 1, columns, lane)
        return found

    def _batch(self, scenes: NDArray[np.int64], attempts: NDArray[np.int64]) -> Batch:
        rows = self._streams.matrix(scenes, attempts, self.plan.domain.width)
        return Batch(
            self.plan.graph, self.plan.domain.place(rows), self.plan.codec, rejections=(RejectionException,)
        )

    def _survivors(self, batch: Batch, inactive: NDArray[np.bool_] | None) -> NDArray[np.intp]:
        """Run the checks, leaving in the batch the lanes that pass; returns for each first lane the check at which it
        fails with an error (-1 for none).
        """
        checks = self.plan.checks
        failures = np.full(len(batch), -1, dtype=np.intp)
        failed_at = np.full(len(batch), np.iinfo(np.int64).max, dtype=np.int64)
        for index in self._order():
            if len(batch) == 0:
                break
            check = checks[index]
            begun = time.perf_counter()
            verdict = check.test(batch)
            passes = verdict.holds
            rows = batch.rows
            if inactive is not None and check.probability < 1:
                passes = passes | inactive[rows, self._soft.index(index)]
            if verdict.failed is not None:
                bad = verdict.failed
                if inactive is not None and check.probability < 1:
                    bad = bad & ~inactive[rows, self._soft.index(index)]
                first = bad & (check.position < failed_at[rows])
                failures[rows[first]] = index
                failed_at[rows[first]] = check.position
                passes = passes | bad
            # A lane that failed at an earlier place of the program is past rejecting.
            passes = passes | (failed_at[rows] < check.position)
            lanes = len(batch)
            batch.keep(passes)
            self._measured[index].add(lanes, time.perf_counter() - begun, len(batch))
        return failures

    def _order(self) -> list[int]:
        """The checks by cost for what they reject, fallible ones before all that follow them in the program."""
        checks = self.plan.checks

        def price(index: int) -> float:
            measured = self._measured[index]
            if measured.lanes < 64:
                return checks[index].cost * 1e-7 / 0.5
            rejected = 1 - measured.passed / measured.lanes
            return measured.seconds / measured.lanes / max(rejected, 1e-4)

        waiting = sorted(range(len(checks)), key=lambda index: (price(index), index))
        barriers = sorted(
            (index for index in waiting if checks[index].fallible), key=lambda i: checks[i].position
        )
        if not barriers:
            return waiting
        order: list[int] = []
        for barrier in barriers:
            for index in waiting:
                before = checks[index].position <= checks[barrier].position
                if before and index not in order and index != barrier:
                    order.append(index)
            if barrier not in order:
                order.append(barrier)
        return order + [index for index in waiting if index not in order]

    # Soft requirements, errors, reports

    def _start(self, k: int) -> _Pending:
        if not self._soft:
            return _Pending(k)
        draws = self._streams.rows(k, SOFT, 0, 1, len(self._soft))[0]
        chances = np.array([self.plan.checks[index].probability for index in self._soft])
        return _Pending(k, inactive=draws >= chances)

    def _inactive(self, pending: Sequence[_Pending], owner: NDArray[np.intp]) -> NDArray[np.bool_] | None:
        if not self._soft:
            return None
        return np.array([scene.inactive for scene in pending], dtype=np.bool_)[owner]

    def _error(self, check: Check, k: int, attempt: int) -> CandidateError:
        """The error of a lane, found by evaluating it alone."""
        batch = self._batch(np.array([k]), np.array([attempt]))
        check.test(batch)
        error = CandidateError(check, k, attempt)
        error.__cause__ = next((batch.errors[node] for node in check.nodes() if node in batch.errors), None)
        return error

    def _give_up(self, scene: _Pending, reason: str) -> Exhausted:
        return Exhausted(self.seed, scene.k, scene.attempts, reason, self.report(scene.k, scene.attempts))

    def report(self, k: int, attempts: int) -> RejectionReport:
        """Each check's share in the rejections among the first attempts of a scene.

        Every check is evaluated on every candidate, so the figures are facts of the program and not of the order in
        which the engine happens to make the checks.
        """
        count = max(1, min(attempts, REPORT_CANDIDATES))
        batches = [
            [
                part
                for check in self.plan.checks
                for part in check.parts(self._batch(np.full(len(numbers), k), numbers))
            ]
            for numbers in np.split(np.arange(count), range(self.lanes, count, self.lanes))
        ]
        rejected = np.array(
            [~np.concatenate([part.holds for part in parts]) for parts in zip(*batches, strict=True)]
        )
        alone = rejected & (rejected.sum(axis=0) == 1) if len(rejected) else rejected
        rows = [
            RejectionRow(part.label, part.span, float(mine.mean()), float(only.mean()))
            for part, mine, only in zip(batches[0], rejected, alone, strict=True)
        ]
        return RejectionReport(count, tuple(row for row in rows if row.rejected > 0))
