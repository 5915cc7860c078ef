"""Finds divided components (`scenic.runtime.sampling.halving`): parts by themselves, then pairs of them.

Of each part of a scene there is one sequence of candidates that pass the checks within it: those of a leaf are its accepted
attempts, in order; those of two halves are the pairs, first with first, second with second, that pass the checks between
them. The first of the whole is the scene. So a scene depends neither on how many are looked for together, nor on how many
candidates for a part are made ahead.
"""

import time
from collections.abc import Sequence
from typing import Final

import numpy as np
from numpy.typing import NDArray

from scenic.dataclass import dataclass
from scenic.graph.draws import LaneOwners, NumberSource, attempt_keys
from scenic.runtime.geometry.ragged import expand
from scenic.runtime.sampling.composed import Composed
from scenic.runtime.sampling.engine import Engine
from scenic.runtime.sampling.halving import Tree
from scenic.runtime.sampling.pending import Pending

__all__ = ["Joined", "LateError", "join"]

Numbers = NDArray[np.int64]

_MANY: Final = 4
"""Leaves from which on they are tried side by side."""

_TURNS: Final = 8
"""Times that this is done, at most; those that miss candidates then go on by themselves."""

_FAITH: Final = 20
"""Number of candidates that an estimate counts for that was made before any candidate was tried."""


@dataclass(frozen=True, slots=True)
class Joined:
    """The findings about a component.

    Attributes:
        attempts: of each scene the accepted attempts at the leaves, from 1, ``(n, leaves)``; 0 where none was found.
        tried: how many candidates for a leaf were tried, the most of all leaves, ``(n,)``.
        in_time: whether all scenes that were not found reached their limit of attempts.

    """

    attempts: Numbers
    tried: Numbers
    in_time: bool


def join(
    engine: Engine,
    tree: Tree,
    tasks: Sequence[tuple[int, int]],
    *,
    max_attempts: int,
    lanes: int | None = None,
    deadline: float | None = None,
) -> Joined:
    """Return the first candidates for a component of some scenes that pass all of its checks.

    Args:
        engine: of the whole plan.
        tree: how the component is divided.
        tasks: which scenes: seeds, and numbers in the run of a seed.
        max_attempts: candidates tried for one leaf of one scene.
        lanes: candidates in one batch at most; changes speed and memory, never the scenes.
        deadline: a time of `time.monotonic` after which nothing more is looked for.

    """
    return _Search(engine, tree, tasks, max_attempts, lanes or engine.most_lanes, deadline).run()


class LateError(Exception):
    """Raised when no time is left."""


class _Queue:
    """Candidates for a part of scenes that have not been used yet, in order."""

    def __init__(self, tree: Tree, scenes: int) -> None:
        self.tree: Final = tree
        self.tried: Final = np.zeros(scenes, dtype=np.int64)
        """Attempts at a leaf, or pairs of candidates for the halves, so far."""
        self._kept = np.zeros((scenes, 4, tree.leaves), dtype=np.int64)
        self._head = np.zeros(scenes, dtype=np.int64)
        self._tail = np.zeros(scenes, dtype=np.int64)
        self._judged, self._passed = float(_FAITH), _FAITH * tree.chance

    @property
    def count(self) -> Numbers:
        """The number of candidates available for each scene."""
        return self._tail - self._head

    @property
    def rate(self) -> float:
        """The share of candidates that pass, as estimated so far."""
        return self._passed / self._judged

    def learn(self, judged: int, passed: int) -> None:
        """Take into account how many candidates have passed."""
        self._judged += judged
        self._passed += passed

    def add(self, scenes: NDArray[np.intp], candidates: Numbers) -> None:
        """Append candidates ``(m, leaves)`` to the queues of the scenes ``(m,)``, which are ascending."""
        if not len(scenes):
            return
        rank = np.arange(len(scenes)) - np.searchsorted(scenes, scenes)
        if (self._tail[scenes] + rank).max() >= self._kept.shape[1]:
            self._make_room(int((self.count[scenes] + rank).max()) + 1)
        self._kept[scenes, self._tail[scenes] + rank] = candidates
        self._tail += np.bincount(scenes, minlength=len(self._tail))

    def at(self, scenes: NDArray[np.intp], places: NDArray[np.int64]) -> Numbers:
        """Candidates ``(m, leaves)`` at places in the queues of scenes."""
        return np.asarray(self._kept[scenes, self._head[scenes] + places])

    def drop(self, scenes: NDArray[np.intp], counts: Numbers) -> None:
        """So many candidates for scenes have been used."""
        self._head[scenes] += counts

    def _make_room(self, wanted: int) -> None:
        size = self._kept.shape[1]
        while size < 2 * wanted:
            size *= 2
        places = np.minimum(self._head[:, np.newaxis] + np.arange(size), self._kept.shape[1] - 1)
        self._kept = self._kept[np.arange(len(places))[:, np.newaxis], places]
        self._tail, self._head = self.count, np.zeros_like(self._head)


class _Search:
    def __init__(
        self,
        engine: Engine,
        tree: Tree,
        tasks: Sequence[tuple[int, int]],
        max_attempts: int,
        lanes: int,
        deadline: float | None,
    ) -> None:
        self._engine = engine
        self._pending: Pending = engine.pending(tasks)
        self._owner = tree.owners()
        self._limit = max_attempts
        self._lanes = lanes
        self._deadline = deadline
        self._is_over = np.zeros(len(tasks), dtype=np.bool_)
        self._tree = tree
        self._queues: dict[int, _Queue] = {}
        """By the identity of parts, which live as long as the tree."""
        parts = [tree]
        while parts:
            part = parts.pop()
            self._queues[id(part)] = _Queue(part, len(tasks))
            parts += part.halves or ()

    def run(self) -> Joined:
        scenes = len(self._is_over)
        root, in_time = self._queues[id(self._tree)], True
        try:
            self._supply(root, np.ones(scenes, dtype=np.int64))
        except LateError:
            in_time = False
        has_result = root.count > 0
        attempts = np.zeros((scenes, self._tree.leaves), dtype=np.int64)
        where = np.flatnonzero(has_result)
        attempts[where] = root.at(where, np.zeros(len(where), dtype=np.int64))
        leaves = [queue.tried for queue in self._queues.values() if queue.tree.halves is None]
        return Joined(attempts, np.maximum.reduce(leaves), in_time)

    def _supply(self, queue: _Queue, wanted: Numbers) -> None:
        """Find the wanted number of candidates for a part of each scene, unless a limit is reached."""
        while True:
            scenes = np.flatnonzero((queue.count < wanted) & ~self._is_over)[: self._lanes]
            if not len(scenes):
                return
            if self._deadline is not None and time.monotonic() > self._deadline:
                raise LateError
            missing = (wanted - queue.count)[scenes]
            counts = np.clip(np.ceil(missing / queue.rate), 1, max(1, self._lanes // len(scenes))).astype(
                np.int64
            )
            lanes, candidates = self._next(queue, scenes, counts)
            good = np.flatnonzero(self._passes(queue.tree, lanes, candidates))
            queue.learn(len(lanes), len(good))
            queue.add(lanes[good], candidates[good])

    def _supply_together(self, leaves: Sequence[_Queue], wanted: Numbers) -> None:
        """Try attempts at many leaves side by side, of scenes that miss candidates for one: alike checks are made together."""
        if len(leaves) < _MANY:
            return
        for _ in range(_TURNS):
            missing = np.max([wanted - leaf.count for leaf in leaves], axis=0)
            scenes = np.flatnonzero((missing > 0) & ~self._is_over)
            attempts = np.max([leaf.tried[scenes] for leaf in leaves], axis=0)
            scenes = scenes[attempts < self._limit]
            if not len(scenes):
                return
            if self._deadline is not None and time.monotonic() > self._deadline:
                raise LateError
            rate = min(leaf.rate for leaf in leaves)
            scenes = scenes[: self._lanes]
            room = np.min([self._limit - leaf.tried[scenes] for leaf in leaves], axis=0)
            counts = np.ceil(missing[scenes] / rate) + 1
            counts = np.clip(counts, 1, np.minimum(max(1, self._lanes // len(scenes)), room)).astype(np.int64)
            owner, offset = expand(counts)
            lanes = scenes[owner]
            candidates = np.stack([leaf.tried[lanes] + offset + 1 for leaf in leaves], axis=1)
            passes = self._pass_each([leaf.tree for leaf in leaves], lanes, candidates)
            for number, leaf in enumerate(leaves):
                good = np.flatnonzero(passes[number])
                leaf.tried[scenes] += counts
                leaf.learn(len(lanes), len(good))
                leaf.add(lanes[good], candidates[good, number : number + 1])

    def _pass_each(
        self, trees: Sequence[Tree], lanes: NDArray[np.intp], candidates: Numbers
    ) -> NDArray[np.bool_]:
        """Return a mask ``(leaves, m)`` of the candidates ``(m, leaves)`` for leaves that pass the checks of these."""
        passes = np.ones((len(trees), len(lanes)), dtype=np.bool_)
        joints = [(number, joint) for number, tree in enumerate(trees) for joint in tree.joints]
        if not joints:
            return passes
        batch = self._engine.batch(self._source(trees, lanes, candidates))
        batch.need(dict.fromkeys(node for _, joint in joints for node in joint.check.nodes))
        for number, joint in joints:
            start_time = time.perf_counter()
            verdict = joint.check.test(batch)
            if joint.soft_place is not None:
                verdict = verdict.unless(self._pending.inactive[lanes, joint.soft_place])
            passes[number] &= verdict.passes
            count = int(np.count_nonzero(verdict.passes))
            self._engine.note(joint.number, len(lanes), count, time.perf_counter() - start_time)
        return passes

    def _next(
        self, queue: _Queue, scenes: NDArray[np.intp], counts: Numbers
    ) -> tuple[NDArray[np.intp], Numbers]:
        """Return the next candidates for a part, at most so many for each of some scenes: whose they are, and attempts ``(m, leaves)``."""
        if queue.tree.halves is None:
            counts = np.minimum(counts, self._limit - queue.tried[scenes])
            self._is_over[scenes[counts == 0]] = True
            owner, offset = expand(counts)
            lanes = scenes[owner]
            candidates = (queue.tried[lanes] + offset + 1)[:, np.newaxis]
        else:
            halves = [self._queues[id(half)] for half in queue.tree.halves]
            needs = np.zeros(len(self._is_over), dtype=np.int64)
            needs[scenes] = counts
            self._supply_together([half for half in halves if half.tree.halves is None], needs)
            for half in halves:
                self._supply(half, needs)
            counts = np.where(self._is_over[scenes], 0, counts)
            owner, offset = expand(counts)
            lanes = scenes[owner]
            candidates = np.concatenate([half.at(lanes, offset) for half in halves], axis=1)
            for half in halves:
                half.drop(scenes, counts)
        queue.tried[scenes] += counts
        return lanes, candidates

    def _passes(self, tree: Tree, lanes: NDArray[np.intp], candidates: Numbers) -> NDArray[np.bool_]:
        """Return a mask of the candidates ``(m, leaves)`` for a part of scenes ``(m,)`` that pass the checks of the part."""
        passes = np.ones(len(lanes), dtype=np.bool_)
        if not tree.joints or not len(lanes):
            return passes
        batch = self._engine.batch(self._source([tree], lanes, candidates))
        for joint in tree.joints:
            start_time = time.perf_counter()
            batch.need(joint.check.nodes)
            verdict = joint.check.test(batch)
            if joint.soft_place is not None:
                verdict = verdict.unless(self._pending.inactive[lanes[batch.rows], joint.soft_place])
            alive = verdict.passes
            self._engine.note(
                joint.number, len(alive), int(np.count_nonzero(alive)), time.perf_counter() - start_time
            )
            passes[batch.rows[~alive]] = False
            batch.keep(alive)
            if not len(batch):
                break
        return passes

    def _source(self, trees: Sequence[Tree], lanes: NDArray[np.intp], candidates: Numbers) -> NumberSource:
        """The draws of candidates for parts: of each leaf those of its attempt."""
        pending = self._pending
        seeds, scenes, keys = pending.seed[lanes], pending.k[lanes], pending.key[lanes]
        sources = [
            self._engine.source_of(LaneOwners(seeds, scenes, mine, attempt_keys(keys, mine)))
            for mine in (candidates - 1).T
        ]
        leaves = [leaf for tree in trees for leaf in range(tree.first, tree.stop)]
        if leaves == list(range(leaves[0], leaves[0] + len(leaves))):
            return Composed(sources, self._owner, leaves[0])
        place = {leaf: number for number, leaf in enumerate(leaves)}
        owner = {draw: place[leaf] for draw, leaf in self._owner.items() if leaf in place}
        return Composed(sources, owner)
