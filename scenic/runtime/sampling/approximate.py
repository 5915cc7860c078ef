"""Scenes that rejection would hardly find: many lanes side by side, one object after the other (sequential Monte Carlo).

A *block* holds the draws that an object adds to those before it. Block after block is drawn from its law in every lane; lanes
that fail a check which can be decided by now are lost, and others take their places (Del Moral, Doucet and Jasra, "Sequential
Monte Carlo samplers", 2006; lanes are drawn until as many live as before: LeGland and Oudjane, 2005). Moves of single blocks
that keep the law (Metropolis and Hastings) make copies differ again. With more lanes the law comes as close to the
program's as one likes. The share of lanes that live at each block gives the probability of the scenario.
"""

import math
from collections.abc import Callable, Iterator, Sequence
from typing import Final

import numpy as np
from numpy.typing import NDArray

from scenic.dataclass import dataclass
from scenic.graph.batch import Batch
from scenic.graph.draws import (
    Counter,
    NumberSource,
    Points,
    Words,
    attempt_keys,
    scene_keys,
    seed_word,
)
from scenic.graph.node import Node
from scenic.runtime.sampling.checks import Check, CollisionCheck
from scenic.runtime.sampling.draw_blocks import Reads, blocks, merged, pieces
from scenic.runtime.sampling.engine import Accepted, CandidateError, Engine, FinishedLanes
from scenic.runtime.sampling.pending import SceneTask
from scenic.runtime.sampling.rejection_report import CORRELATED, Approximation, Exhausted

__all__ = ["approximated"]

_LIVELY: Final = 0.35
"""Blocks are moved once this share of lanes, or less, has lived since they were moved last."""

_STEPS: Final = (0.5, 0.1, 0.02)
"""Step sizes of moves along an axis of the cube; a step of 0.5 draws the coordinate again."""

_OTHERS: Final = 4
"""Number of sweeps among which one uses another step than the best one so far."""

_OBJECTS: Final = 16
"""Objects are evaluated in multiples of this number, in the order of the program, so that a few schedules serve all checks."""

_SWEEPS: Final = (4, 60)
"""Sweeps at the end, at least and at most."""


@dataclass(frozen=True, slots=True)
class _Block:
    """Draws that are made together: numbers and words by address, and the checks that look at them."""

    numbers: tuple[int, ...]
    words: tuple[int, ...]
    decided: tuple[Check, ...]
    """Checks that can be made once the block is there, and not before."""
    moved: tuple[tuple[int, Check], ...]
    """Checks that may change with it, each with the number of the block that decides it."""


_Move = tuple[_Block, tuple[Check, ...]]
"""A block, and what has to hold after it was moved."""


class _Blocks:
    """The blocks of a plan, and the checks of their moves when only the first ones are there."""

    def __init__(self, blocks: Sequence[_Block]) -> None:
        self.blocks: Final = tuple(blocks)
        self._moves: dict[int, tuple[_Move, ...]] = {}

    def moves(self, last: int) -> tuple[_Move, ...]:
        """The blocks up to number ``last`` that checks look at, each with those that are decided by then."""
        moves = self._moves.get(last)
        if moves is None:
            found = (
                (block, tuple(merged(check for number, check in block.moved if number <= last)))
                for block in self.blocks[: last + 1]
            )
            moves = self._moves[last] = tuple(move for move in found if move[1])
        return moves


class _GaveUpError(Exception):
    """A block could not be drawn within the limit of candidates."""


def approximated(
    engine: Engine,
    seed: int,
    first: int,
    count: int,
    *,
    lanes: int,
    max_attempts: int,
    checks: Sequence[Check],
    fixing: Callable[[NumberSource], NumberSource] = lambda source: source,
) -> Iterator[Accepted | Exhausted]:
    """Scenes ``first`` to ``first + count`` of a seed, in order; scene ``k`` is lane ``k % lanes`` of block ``k // lanes``.

    Args:
        engine: of the whole plan.
        seed: any integer.
        first: number of the first scene.
        count: how many.
        lanes: scenes that are made together.
        max_attempts: candidates for each lane and block of draws, on average, before all are given up.
        checks: those of the plan, or of its components, which are the same but for what cannot fail.
        fixing: puts fixed draws in the place of some.

    Raises:
        CandidateError: a scene failed that nothing rejects.

    """
    sampler = _Sampler(engine, max_attempts, checks, fixing)
    for group in range(first // lanes, -(-(first + count) // lanes)):
        numbers = range(max(first, group * lanes), min(first + count, (group + 1) * lanes))
        try:
            lanes_of_group = sampler.group(seed, group, lanes)
        except _GaveUpError:
            report = engine.report(SceneTask(seed, numbers.start), 200)
            yield from (Exhausted(seed, k, max_attempts, "attempts", report) for k in numbers)
            continue
        yield from ((lanes_of_group, k - group * lanes) for k in numbers)


class _Sampler:
    """Makes groups of scenes of one plan."""

    def __init__(
        self,
        engine: Engine,
        max_attempts: int,
        checks: Sequence[Check],
        fixing: Callable[[NumberSource], NumberSource],
    ) -> None:
        self._engine = engine
        self._checks = checks
        self._fixing = fixing
        self._max_attempts = max_attempts
        plan = engine.plan
        self._soft = [check for check in plan.checks if check.probability < 1]
        self._reads = Reads(plan.graph, plan.domain)
        self._plans: dict[frozenset[int], _Blocks] = {}
        self._objects = _Objects(checks)

    def group(self, seed: int, group: int, lanes: int) -> FinishedLanes:
        """The scenes ``group * lanes`` to ``(group + 1) * lanes`` of a seed."""
        scenes = np.arange(group * lanes, (group + 1) * lanes, dtype=np.int64)
        inactive = self._engine.pending([(seed, k) for k in scenes.tolist()]).inactive
        state = _State(self._reads, lanes)
        reports = []
        # Whether soft requirements have to hold is decided before anything else: lanes that differ in it do not compete.
        patterns, which = np.unique(inactive, axis=0, return_inverse=True)
        for number, pattern in enumerate(patterns):
            members = np.flatnonzero(which.ravel() == number)
            random = np.random.Generator(np.random.Philox(key=[int(seed_word(seed)), (group << 8) + number]))
            part, report = self._run(random, len(members), frozenset(np.flatnonzero(pattern).tolist()))
            state.put(members, part)
            reports.append(report)
        attempts = [max(1, round(sum(1 / share for share in report.survival))) for report in reports]
        found_attempts = [attempts[number] for number in which.ravel().tolist()]
        keys = attempt_keys(
            scene_keys(np.repeat(seed_word(seed), lanes), scenes), np.zeros(lanes, dtype=np.int64)
        )
        batch = self._engine.batch(self._fixing(state.source(keys)))
        batch.settle(self._engine.plan.outputs)
        self._raise_failures(state, keys, scenes, inactive)

        def alone(lane: int) -> Batch:
            one = np.array([lane])
            return self._engine.batch(self._fixing(state.source(keys).take(one)), grouped=False)

        return FinishedLanes(
            [seed] * lanes,
            scenes.tolist(),
            found_attempts,
            batch,
            alone,
            approximation=_joined(reports, lanes),
        )

    def _raise_failures(
        self, state: "_State", keys: Words, scenes: NDArray[np.int64], inactive: NDArray[np.bool_]
    ) -> None:
        """Raise the error of the first scene in which a requirement failed."""
        batch = self._engine.batch(self._fixing(state.source(keys)))
        failures: list[tuple[int, int, Check]] = []
        soft = 0
        for check in self._engine.plan.checks:
            batch.need(check.nodes)
            verdict = check.test(batch)
            if check.probability < 1:
                verdict, soft = verdict.unless(inactive[:, soft]), soft + 1
            if verdict.failed is not None and verdict.failed.any():
                failures.append((int(verdict.failed.argmax()), check.position, check))
        if failures:
            lane, _, check = min(failures, key=lambda item: item[:2])
            one = self._engine.batch(self._fixing(state.source(keys).take(np.array([lane]))), grouped=False)
            check.test(one)
            error = CandidateError(check, int(scenes[lane]), 0)
            error.__cause__ = next((one.errors[node] for node in check.nodes if node in one.errors), None)
            raise error

    def _run(
        self, random: np.random.Generator, lanes: int, inactive: frozenset[int]
    ) -> tuple["_State", Approximation]:
        """Sample a number of lanes in which the soft requirements ``inactive`` need not hold."""
        plan = self._plan(inactive)
        state = _State(self._reads, lanes)
        roots, pace = np.arange(lanes), _Steps()
        survival: list[float] = []
        log_probability, since = 0.0, 1.0
        blocks = plan.blocks
        for number, block in enumerate(blocks):
            ancestors, attempts = self._extend(random, state, block)
            roots = roots[ancestors]
            share = 1.0 if attempts == lanes else max(lanes - 1, 1) / max(attempts - 1, 1)
            survival.append(share)
            log_probability += math.log(share)
            since *= share
            if since < _LIVELY and number + 1 < len(blocks):
                since = 1.0
                self._sweep(random, state, plan.moves(number), pace)
        start, correlation, sweeps = state.copy(), 1.0, 0
        moves = plan.moves(len(blocks) - 1)
        if min(survival, default=1.0) == 1.0:
            moves, correlation = (), 0.0  # no lane was lost: all are independent
        while moves and sweeps < _SWEEPS[1]:
            self._sweep(random, state, moves, pace)
            sweeps += 1
            if sweeps >= _SWEEPS[0]:
                correlation = _correlation(
                    [start.correlation(state, place) for block, _ in moves for place in block.numbers],
                    lanes,
                )
                if correlation < CORRELATED:
                    break
        sizes = np.bincount(roots, minlength=lanes)
        descent = float(np.square(sizes).sum()) / lanes
        effective = lanes / (1 + (descent - 1) * correlation**2)
        report = Approximation(lanes, log_probability, effective, tuple(survival), sweeps, correlation)
        return state, report

    def _extend(
        self, random: np.random.Generator, state: "_State", block: _Block
    ) -> tuple[NDArray[np.intp], int]:
        """Draw a block in lanes until as many live as there are; who each one's ancestor is, and how many were tried."""
        lanes = len(state)
        if not block.decided:
            state.redraw(random, block, 0.5)
            return np.arange(lanes), lanes
        survivors: list[_State] = []
        ancestors: list[NDArray[np.intp]] = []
        missing, attempts = lanes, 0
        while missing:
            if attempts >= self._max_attempts * lanes:
                raise _GaveUpError
            order = random.permutation(
                lanes
            )  # systematic: of lanes that weigh the same each comes once in a round
            trial = state.take(order)
            trial.redraw(random, block, 0.5)
            good = np.flatnonzero(self._passes(trial, block.decided))[:missing]
            attempts += int(good[-1]) + 1 if len(good) == missing else lanes
            missing -= len(good)
            survivors.append(trial.take(good))
            ancestors.append(order[good])
        state.become(survivors)
        return np.concatenate(ancestors), attempts

    def _sweep(
        self, random: np.random.Generator, state: "_State", moves: Sequence[_Move], pace: "_Steps"
    ) -> None:
        """Move each block of each lane once, where all checks still hold after it."""
        step, move_count = pace.step, 0
        for block, checks in moves:
            trial = state.copy()
            trial.redraw(random, block, step)
            # All draws of a block have the law of the cube before and after, so that a move is good if its lane is.
            good = np.flatnonzero(self._passes(trial, checks))
            state.put_block(good, trial, block)
            move_count += len(good)
        pace.learn(step, move_count / max(1, len(moves) * len(state)))

    def _passes(self, state: "_State", checks: Sequence[Check]) -> NDArray[np.bool_]:
        """Return a mask of the lanes that pass all checks."""
        passes = np.ones(len(state), dtype=np.bool_)
        if not checks:
            return passes
        batch = self._engine.batch(self._fixing(state.source(np.zeros(len(state), dtype=np.uint64))))
        batch.need(self._objects.below(checks))
        for check in sorted(checks, key=lambda item: item.cost):
            batch.need(check.nodes)
            alive = check.test(batch).passes
            passes[batch.rows[~alive]] = False
            batch.keep(alive)
            if not len(batch):
                break
        return passes

    def _plan(self, inactive: frozenset[int]) -> _Blocks:
        """The blocks of the plan without some soft requirements, by their numbers among these."""
        plan = self._plans.get(inactive)
        if plan is None:
            left_out = {id(self._soft[number]) for number in inactive}
            checks = [check for check in self._checks if id(check) not in left_out]
            plan = self._plans[inactive] = _Blocks(_blocks_of(self._reads, checks))
        return plan


_EXCESS: Final = 8
"""By so much, over the number of lanes, the largest of many squares exceeds what chance lets expect in one of fifty cases."""


def _correlation(found: Sequence[float], lanes: int) -> float:
    """Return a measure of how strongly a sweep's numbers depend on the previous ones, from their correlations
    over ``lanes`` lanes.

    Numbers that depend on nothing have correlations, too, with a mean square of 1 over the number of lanes. What is left without these is
    the larger of two: of the mean square, which tells whether lanes move at all, and of the largest, which tells whether some block stays.
    """
    if not found:
        return 0.0
    squares = np.square(found)
    mean = float(squares.mean()) - 1 / lanes
    largest = float(squares.max()) - (2 * math.log(1 + len(found)) + _EXCESS) / lanes
    return math.sqrt(max(0.0, mean, largest))


def _joined(reports: Sequence[Approximation], lanes: int) -> Approximation:
    """The report of lanes that were made apart."""
    if len(reports) == 1:
        return reports[0]
    shares = [report.lanes / lanes for report in reports]
    mean = sum(
        share * math.exp(report.log_probability) for share, report in zip(shares, reports, strict=True)
    )
    return Approximation(
        lanes,
        math.log(mean) if mean else -math.inf,
        sum(report.effective for report in reports),
        min((report.survival for report in reports), key=math.prod),
        max(report.sweeps for report in reports),
        max(report.correlation for report in reports),
    )


class _Objects:
    """The objects of some checks, in order."""

    def __init__(self, checks: Sequence[Check]) -> None:
        collisions = [check for check in checks if isinstance(check, CollisionCheck)]
        objects = list({id(item): item for check in collisions for item in check.objects}.values())
        self._place = {id(item): place for place, item in enumerate(objects)}
        self._nodes = [item.all for item in objects]
        self._made: dict[int, tuple[Node, ...]] = {}

    def below(self, checks: Sequence[Check]) -> tuple[Node, ...]:
        """The nodes of the first objects, up to the last one that some checks of collisions look at, and a few more."""
        object_numbers = [
            self._place[id(item)]
            for check in checks
            if isinstance(check, CollisionCheck)
            for item in (check.objects[0], check.objects[-1])
        ]
        count = -(-(max(object_numbers, default=-1) + 1) // _OBJECTS)
        if count not in self._made:
            self._made[count] = tuple(node for nodes in self._nodes[: count * _OBJECTS] for node in nodes)
        return self._made[count]


class _Steps:
    """Step sizes for the moves of the next sweep: mostly the step that has moved lanes furthest so far, now
    and then another.
    """

    def __init__(self) -> None:
        self._reached: dict[float, float] = {}
        self._sweeps = 0

    @property
    def step(self) -> float:
        """The step of the next sweep."""
        if len(self._reached) < len(_STEPS) or self._sweeps % _OTHERS == _OTHERS - 1:
            return _STEPS[self._sweeps % len(_STEPS)]
        return max(_STEPS, key=lambda step: self._reached[step])

    def learn(self, step: float, accepted: float) -> None:
        """Take a sweep into account in which that share of moves was good."""
        self._sweeps += 1
        self._reached[step] = accepted * step**2


def _blocks_of(reads: Reads, checks: Sequence[Check]) -> list[_Block]:
    """The draws in blocks: those of one object after the other, then of one check after the other, then the rest."""
    parts, units = pieces(reads, checks)
    words = frozenset(reads.words)
    news = blocks([*units, reads.everything])
    number_of = {place: number for number, new in enumerate(news) for place in new}
    deciding = [(max((number_of[place] for place in part.read), default=0), part) for part in parts]
    return [
        _Block(
            tuple(sorted(new - words)),
            tuple(sorted(new & words)),
            tuple(merged(part.check for last, part in deciding if last == number)),
            tuple((last, part.check) for last, part in deciding if part.read & new),
        )
        for number, new in enumerate(news)
    ]


class _State:
    """The draws of lanes: numbers of the unit interval and words ``(n,)`` by address."""

    def __init__(self, reads: Reads, lanes: int) -> None:
        addresses = [*reads.numbers, *(place for place, _ in reads.boxes)]
        self._numbers: dict[int, NDArray[np.float64]] = {place: np.full(lanes, 0.5) for place in addresses}
        self._words: dict[int, Words] = {place: np.zeros(lanes, dtype=np.uint64) for place in reads.words}
        self._lanes = lanes

    def __len__(self) -> int:
        return self._lanes

    def _made(self, numbers: dict[int, NDArray[np.float64]], words: dict[int, Words], lanes: int) -> "_State":
        other = object.__new__(_State)
        other._numbers, other._words, other._lanes = numbers, words, lanes
        return other

    def copy(self) -> "_State":
        """Another state that shares columns until they are redrawn."""
        return self._made(dict(self._numbers), dict(self._words), self._lanes)

    def take(self, lanes: NDArray[np.intp]) -> "_State":
        """Return some of the lanes."""
        return self._made(
            {place: column[lanes] for place, column in self._numbers.items()},
            {place: column[lanes] for place, column in self._words.items()},
            len(lanes),
        )

    def become(self, parts: Sequence["_State"]) -> None:
        """The lanes of several states one after the other."""
        for place in self._numbers:
            self._numbers[place] = np.concatenate([part._numbers[place] for part in parts])
        for place in self._words:
            self._words[place] = np.concatenate([part._words[place] for part in parts])

    def put(self, lanes: NDArray[np.intp], part: "_State") -> None:
        """Copy lanes from another state, one after the other."""
        for place, column in part._numbers.items():
            self._numbers[place][lanes] = column
        for place, words in part._words.items():
            self._words[place][lanes] = words

    def put_block(self, lanes: NDArray[np.intp], other: "_State", block: _Block) -> None:
        """Copy a block of some lanes from another state of the same lanes."""
        for place in block.numbers:
            column = self._numbers[place].copy()
            column[lanes] = other._numbers[place][lanes]
            self._numbers[place] = column
        for place in block.words:
            words = self._words[place].copy()
            words[lanes] = other._words[place][lanes]
            self._words[place] = words

    def redraw(self, random: np.random.Generator, block: _Block, step: float) -> None:
        """Draw a block again, within ``step`` of its place; words are drawn at random, if ``step`` is 0.5."""
        for place in block.numbers:
            shift = random.uniform(-step, step, self._lanes)
            self._numbers[place] = np.clip((self._numbers[place] + shift) % 1.0, 2.0**-60, 1 - 2.0**-53)
        if step == _STEPS[0]:
            for place in block.words:
                self._words[place] = random.integers(0, 2**64, self._lanes, dtype=np.uint64, endpoint=False)

    def correlation(self, other: "_State", place: int) -> float:
        """The correlation of a number here and in another state of the same lanes."""
        here, there = self._numbers[place], other._numbers[place]
        spread = float(here.std() * there.std())
        if spread == 0:
            return 0.0
        return float(((here - here.mean()) * (there - there.mean())).mean()) / spread

    def source(self, keys: Words) -> Points:
        """Return the source of the lanes."""
        return Points(self._numbers, Counter(keys), self._words)
