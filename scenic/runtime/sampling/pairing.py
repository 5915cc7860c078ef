"""Finds groups that only meet (`scenic.runtime.sampling.apart`): each by itself, then pairs, pairs of pairs, up to the whole.

The groups stand at the leaves of a balanced tree: at its bottom as many are put together at once as hardly ever collide, above two at
a time. Of each part of a scene there is one sequence of candidates: of a group its accepted attempts, in order; of what consists of
parts the combinations, first with first, second with second, in which nothing of one collides with anything of another. The first of the root is the scene. That is rejection at each level, so that the law stays that of the
program (Arratia and DeSalvo, "Probabilistic divide-and-conquer", 2016), and a scene does not depend on how many are looked for
together, nor on how many candidates for a part are made ahead. All parts of one level are rows of the same arrays, and all
attempts at groups of one kind lanes of one batch.
"""

import time
from collections.abc import Sequence
from typing import Final

import numpy as np
from numpy.typing import NDArray

from scenic.runtime.geometry.ragged import expand
from scenic.runtime.sampling.apart import Apart
from scenic.runtime.sampling.engine import Engine
from scenic.runtime.sampling.group_candidates import LEAVES, GroupCandidates, Queues
from scenic.runtime.sampling.joining import Joined, LateError

__all__ = ["pair"]

Numbers = NDArray[np.int64]
Indices = NDArray[np.intp]

_SCENES: Final = 1 << 15
"""Groups of all scenes that are looked for together, about."""

_MOST_KEPT: Final = 1 << 18
"""Candidates for groups above which those that are not needed any more are forgotten."""


def pair(
    engine: Engine,
    apart: Apart,
    tasks: Sequence[tuple[int, int]],
    *,
    max_attempts: int,
    lanes: int | None = None,
    deadline: float | None = None,
) -> Joined:
    """Return the first candidates for a component of some scenes that pass all of its checks; as `scenic.runtime.sampling.joining.join`."""
    step = max(1, _SCENES // apart.leaves)
    most = engine.most_lanes if lanes is None else lanes
    parts = [
        _Search(engine, apart, tasks[start : start + step], max_attempts, most, deadline).run()
        for start in range(0, len(tasks), step)
    ]
    return Joined(
        np.concatenate([part.attempts for part in parts]),
        np.concatenate([part.tried for part in parts]),
        all(part.in_time for part in parts),
    )


class _Search:
    def __init__(
        self,
        engine: Engine,
        apart: Apart,
        tasks: Sequence[tuple[int, int]],
        max_attempts: int,
        lanes: int,
        deadline: float | None,
    ) -> None:
        self._engine = engine
        self._apart = apart
        self._deadline = deadline
        self._scenes = len(tasks)
        self._levels = _levels(apart.leaves, apart.bunch, len(tasks))
        slots = self._levels[0].parts
        leaf = np.full(slots, -1, dtype=np.intp)
        leaf[np.arange(apart.leaves) * slots // apart.leaves] = np.arange(apart.leaves)
        self._is_leaf = leaf >= 0
        self._candidates = GroupCandidates(engine, apart, tasks, max_attempts, lanes, leaf)
        self._levels[0] = self._candidates.queues
        self._most_made = _MOST_KEPT

    def run(self) -> Joined:
        top, in_time = self._levels[-1], True
        try:
            self._supply(len(self._levels) - 1, np.ones(self._scenes, dtype=np.int64))
        except LateError:
            in_time = False
        rows = np.flatnonzero(top.count > 0)
        attempts = np.zeros((self._scenes, self._apart.leaves), dtype=np.int64)
        ones, zeros = np.ones(len(rows), dtype=np.int64), np.zeros(len(rows), dtype=np.int64)
        candidates = top.take(rows, ones, zeros, np.arange(len(rows)))
        attempts[rows] = self._candidates.attempts(candidates[:, self._is_leaf])
        return Joined(attempts, self._candidates.tried.max(axis=1), in_time)

    def _supply(self, number: int, wanted: Numbers) -> None:
        """Find the wanted number of candidates for each part of a level, unless a limit is reached."""
        level = self._levels[number]
        while True:
            rows = np.flatnonzero((level.count < wanted) & ~np.repeat(self._candidates.is_over, level.parts))
            if not len(rows):
                return
            if self._deadline is not None and time.monotonic() > self._deadline:
                raise LateError
            missing = (wanted - level.count)[rows]
            if number == 0:
                self._candidates.supply(rows, missing)
                continue
            # What is made ahead may be in vain; but a round costs mostly the same, however few candidates it has.
            room = max(1, min(LEAVES, self._candidates.lanes) // (len(rows) * level.width))
            counts = np.clip(np.ceil(missing / level.rate), 1, np.maximum(missing, room)).astype(np.int64)
            below = np.zeros((len(level.count), level.fan), dtype=np.int64)
            below[rows] = counts[:, np.newaxis]
            self._supply(number - 1, below.ravel())
            alive = ~self._candidates.is_over[rows // level.parts]
            self._join(number, rows[alive], counts[alive])
            if self._candidates.count > self._most_made:
                self._forget()
                self._most_made = max(_MOST_KEPT, 2 * self._candidates.count)

    def _join(self, number: int, rows: Indices, counts: Numbers) -> None:
        """Make the next combinations of candidates for what parts consist of, and keep those in which nothing collides."""
        level, below = self._levels[number], self._levels[number - 1]
        owner, offset = expand(counts)
        pieces = [below.take(level.fan * rows + place, counts, offset, owner) for place in range(level.fan)]
        candidates = np.concatenate(pieces, axis=1)
        start_time = time.perf_counter()
        passes = np.empty(len(owner), dtype=np.bool_)
        step = max(1, LEAVES // level.width)
        for start in range(0, len(owner), step):
            some = slice(start, start + step)
            passes[some] = self._are_apart(candidates[some], below.width)
        good = np.flatnonzero(passes)
        self._engine.note(self._apart.number, len(owner), len(good), time.perf_counter() - start_time)
        level.judged += len(owner)
        level.passed += len(good)
        level.add(rows[owner[good]], candidates[good])

    def _are_apart(self, candidates: Indices, width: int) -> NDArray[np.bool_]:
        """Return a mask of the candidates ``(m, leaves)`` of whose parts, ``width`` leaves each, no two collide."""
        lane, place = np.nonzero(candidates >= 0)
        chosen, owner = self._candidates.spread(candidates[lane, place])
        lane, part = lane[owner], place[owner] // width
        return self._candidates.bodies.apart(len(candidates), chosen, lane, part, self._apart.may_meet)

    def _forget(self) -> None:
        """Forget candidates for groups that no part holds any more."""
        upper = self._levels[1:]
        new_numbers = self._candidates.forget([level.kept[level.live()] for level in upper])
        for level in upper:
            level.kept = new_numbers[level.kept]


def _levels(leaves: int, bunch: int, scenes: int) -> list[Queues]:
    """The levels of the tree, from its leaves on: ``bunch`` of these together, about, then halves."""
    tops = 1 << max(0, -(-leaves // bunch) - 1).bit_length()
    bunch = -(-leaves // tops)
    levels = [Queues(tops * bunch, 1, 1, scenes)]
    if bunch > 1:
        levels.append(Queues(tops, bunch, bunch, scenes))
    while levels[-1].parts > 1:
        levels.append(Queues(levels[-1].parts // 2, 2, 2 * levels[-1].width, scenes))
    return levels
