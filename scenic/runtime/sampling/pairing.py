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

from scenic.runtime.geometry.ragged import distinct, expand
from scenic.runtime.sampling.alike import Kind
from scenic.runtime.sampling.apart import Apart, attempts_at_kind
from scenic.runtime.sampling.engine import Engine
from scenic.runtime.sampling.joining import Joined, LateError
from scenic.runtime.sampling.meeting import Bodies

__all__ = ["pair"]

Numbers = NDArray[np.int64]
Indices = NDArray[np.intp]

_LEAVES: Final = 1 << 15
"""Groups in the candidates for parts that are made together, about."""

_SCENES: Final = 1 << 15
"""Groups of all scenes that are looked for together, about."""

_MOST_KEPT: Final = 1 << 18
"""Candidates for groups above which those that are not needed any more are forgotten."""

_PLENTY: Final = 1 << 40
"""The number of candidates for the part without a group that stands where there is no other."""

_FAITH: Final = 20.0
"""Number of candidates that the first estimate of the share of those that pass counts for."""


def pair(
    engine: Engine,
    apart: Apart,
    tasks: Sequence[tuple[int, int]],
    *,
    max_attempts: int,
    lanes: int | None = None,
    deadline: float | None = None,
) -> Joined:
    """The first candidates for a component of some scenes that pass all of its checks; as `scenic.runtime.sampling.joining.join`."""
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


class _Level:
    """Candidates for the parts of one level, scene by scene, that have not been used yet, in order.

    Args:
        parts: number of parts in a scene.
        fan: number of parts of the level below that a part consists of.
        width: number of leaves below a part.
        scenes: number of scenes.

    """

    def __init__(self, parts: int, fan: int, width: int, scenes: int) -> None:
        self.parts: Final = parts
        self.fan: Final = fan
        self.width: Final = width
        rows = parts * scenes
        self.kept: Indices = np.full((rows, 2, width), -1, dtype=np.intp)
        self._head = np.zeros(rows, dtype=np.int64)
        self._tail = np.zeros(rows, dtype=np.int64)
        self.judged, self.passed = _FAITH, _FAITH

    @property
    def count(self) -> Numbers:
        """The number of candidates available for each part."""
        return self._tail - self._head

    @property
    def rate(self) -> float:
        """The share of candidates that pass, as estimated so far."""
        return self.passed / self.judged

    def fill(self, rows: Indices) -> None:
        """Parts without a group: there is always a candidate."""
        self._tail[rows] = _PLENTY

    def add(self, rows: Indices, candidates: Indices) -> None:
        """Candidates ``(m, width)`` for parts ``(m,)``, ascending."""
        if not len(rows):
            return
        places = self._tail[rows] + np.arange(len(rows)) - np.searchsorted(rows, rows)
        if places.max() >= self.kept.shape[1]:
            places -= self._head[rows]
            self._make_room(int(places.max()) + 1)
        self.kept[rows, places] = candidates
        self._tail += np.bincount(rows, minlength=len(self._tail))

    def take(self, rows: Indices, counts: Numbers, places: Numbers, owner: Indices) -> Indices:
        """Remove the first ``counts`` candidates for parts; the number ``places`` of those of the part ``rows[owner]``, ``(m, width)``."""
        lanes = rows[owner]
        where = np.minimum(self._head[lanes] + places, self.kept.shape[1] - 1)
        candidates = np.asarray(self.kept[lanes, where])
        self._head[rows] += np.where(self._tail[rows] >= _PLENTY, 0, counts)
        return candidates

    def live(self) -> NDArray[np.bool_]:
        """A mask of the places of candidates that have not been used."""
        places = np.arange(self.kept.shape[1])
        return (places >= self._head[:, np.newaxis]) & (
            places < np.minimum(self._tail, _PLENTY)[:, np.newaxis]
        )

    def _make_room(self, wanted: int) -> None:
        size = self.kept.shape[1]
        while size < wanted:
            size *= 2
        is_filled = self._tail >= _PLENTY
        head = np.where(is_filled, 0, self._head)
        places = np.minimum(head[:, np.newaxis] + np.arange(size), self.kept.shape[1] - 1)
        self.kept = self.kept[np.arange(len(places))[:, np.newaxis], places]
        self._tail = np.where(is_filled, _PLENTY, self._tail - head)
        self._head = np.zeros_like(self._head)


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
        self._pending = engine.pending(tasks)
        self._limit = max_attempts
        # Memory is bounded by candidates for the whole; those for a group take as much less of it.
        self._lanes = max(1, min(_LEAVES, lanes * apart.leaves))
        self._deadline = deadline
        self._scenes = len(tasks)
        self._is_over = np.zeros(len(tasks), dtype=np.bool_)
        self._tried = np.zeros((len(tasks), apart.leaves), dtype=np.int64)
        self._levels = _levels(apart.leaves, apart.bunch, len(tasks))
        self._slots = self._levels[0].parts
        places = np.arange(apart.leaves) * self._slots // apart.leaves
        self._leaf = np.full(self._slots, -1, dtype=np.intp)
        """The group at each leaf of the tree; -1 where there is none."""
        self._leaf[places] = np.arange(apart.leaves)
        self._levels[0].fill(np.flatnonzero(np.tile(self._leaf < 0, len(tasks))))
        self._bodies = Bodies()
        self._made = 0
        """The number of candidates for groups that are known."""
        self._most_made = _MOST_KEPT
        self._attempt: Numbers = np.empty(_LEAVES, dtype=np.int64)
        """The attempts that they are, from 1."""
        self._body: Indices = np.empty(_LEAVES, dtype=np.intp)
        """The first row of the bodies of each."""
        self._size: Indices = np.empty(_LEAVES, dtype=np.intp)
        """The number of its bodies."""
        self._are_single = all(len(kind.objects) == 1 for kind in apart.kinds)
        self._rates = [[_FAITH, _FAITH] for _ in apart.kinds]
        self._member = np.empty(apart.leaves, dtype=np.intp)
        """The number of each group among those of its kind."""
        for kind in apart.kinds:
            self._member[kind.members] = np.arange(len(kind.members))

    def run(self) -> Joined:
        top, in_time = self._levels[-1], True
        try:
            self._supply(len(self._levels) - 1, np.ones(self._scenes, dtype=np.int64))
        except LateError:
            in_time = False
        rows = np.flatnonzero(top.count > 0)
        attempts = np.zeros((self._scenes, self._apart.leaves), dtype=np.int64)
        ones, zeros = np.ones(len(rows), dtype=np.int64), np.zeros(len(rows), dtype=np.int64)
        found = top.take(rows, ones, zeros, np.arange(len(rows)))
        attempts[rows] = self._attempt[found[:, self._leaf >= 0]]
        return Joined(attempts, self._tried.max(axis=1), in_time)

    def _supply(self, number: int, wanted: Numbers) -> None:
        """Find the wanted number of candidates for each part of a level, unless a limit is reached."""
        level = self._levels[number]
        while True:
            rows = np.flatnonzero((level.count < wanted) & ~np.repeat(self._is_over, level.parts))
            if not len(rows):
                return
            if self._deadline is not None and time.monotonic() > self._deadline:
                raise LateError
            missing = (wanted - level.count)[rows]
            if number == 0:
                self._attempt_groups(rows, missing)
                continue
            # What is made ahead may be in vain; but a round costs mostly the same, however few candidates it has.
            room = max(1, min(_LEAVES, self._lanes) // (len(rows) * level.width))
            counts = np.clip(np.ceil(missing / level.rate), 1, np.maximum(missing, room)).astype(np.int64)
            below = np.zeros((len(level.count), level.fan), dtype=np.int64)
            below[rows] = counts[:, np.newaxis]
            self._supply(number - 1, below.ravel())
            alive = ~self._is_over[rows // level.parts]
            self._join(number, rows[alive], counts[alive])
            if self._made > self._most_made:
                self._forget()
                self._most_made = max(_MOST_KEPT, 2 * self._made)

    def _join(self, number: int, rows: Indices, counts: Numbers) -> None:
        """Make the next combinations of candidates for what parts consist of, and keep those in which nothing collides."""
        level, below = self._levels[number], self._levels[number - 1]
        owner, offset = expand(counts)
        pieces = [below.take(level.fan * rows + place, counts, offset, owner) for place in range(level.fan)]
        candidates = np.concatenate(pieces, axis=1)
        begun = time.perf_counter()
        passes = np.empty(len(owner), dtype=np.bool_)
        step = max(1, _LEAVES // level.width)
        for start in range(0, len(owner), step):
            some = slice(start, start + step)
            passes[some] = self._are_apart(candidates[some], below.width)
        good = np.flatnonzero(passes)
        self._engine.note(self._apart.number, len(owner), len(good), time.perf_counter() - begun)
        level.judged += len(owner)
        level.passed += len(good)
        level.add(rows[owner[good]], candidates[good])

    def _are_apart(self, candidates: Indices, width: int) -> NDArray[np.bool_]:
        """Return a mask of the candidates ``(m, leaves)`` of whose parts, ``width`` leaves each, no two collide."""
        lane, place = np.nonzero(candidates >= 0)
        chosen, part = candidates[lane, place], place // width
        if not self._are_single:
            owner, offset = expand(self._size[chosen])
            chosen, lane, part = self._body[chosen][owner] + offset, lane[owner], part[owner]
        return self._bodies.apart(len(candidates), chosen, lane, part, self._apart.may_meet)

    def _attempt_groups(self, rows: Indices, missing: Numbers) -> None:
        """Try the next attempts at groups, about as many as it takes to find those that are missing."""
        scenes, leaves = rows // self._slots, self._leaf[rows % self._slots]
        kinds = self._apart.kind[leaves]
        for number in distinct(kinds).tolist():
            mine = np.flatnonzero(kinds == number)
            judged, passed = self._rates[number]
            ratio = missing[mine] * (judged / passed)
            counts = np.ceil(ratio) if len(mine) <= _LEAVES // 64 else np.floor(ratio)
            self._attempt_kind(number, scenes[mine], leaves[mine], rows[mine], counts.astype(np.int64))

    def _attempt_kind(
        self, number: int, scenes: Indices, leaves: Indices, rows: Indices, counts: Numbers
    ) -> None:
        tried = self._tried[scenes, leaves]
        counts = np.minimum(np.clip(counts, 1, self._lanes), self._limit - tried)
        self._is_over[scenes[counts == 0]] = True
        self._tried[scenes, leaves] += counts
        owner, offset = expand(counts)
        attempts = tried[owner] + offset
        for start in range(0, len(owner), self._lanes):
            part = slice(start, start + self._lanes)
            mine = owner[part]
            good = self._judge(number, scenes[mine], leaves[mine], attempts[part])
            self._rates[number][0] += len(mine)
            self._rates[number][1] += len(good)
            found = self._made - len(good) + np.arange(len(good))
            self._levels[0].add(rows[mine[good]], found[:, np.newaxis])

    def _judge(self, number: int, scenes: Indices, leaves: Indices, attempts: Numbers) -> Indices:
        """Keep the attempts at groups of a kind that pass their checks as candidates; returns their numbers among the attempts."""
        kind: Kind = self._apart.kinds[number]
        member = self._member[leaves]
        batch = attempts_at_kind(self._engine, kind, self._pending, scenes, member, attempts)
        good = batch.rows.copy()
        if not len(good):
            return good
        bodies = [item.body(batch) for item in kind.objects]
        first = self._bodies.add(bodies, kind.numbers[member[good]])
        start, stop = self._made, self._made + len(good)
        if stop > len(self._attempt):
            for name in ("_attempt", "_body", "_size"):
                setattr(self, name, np.resize(getattr(self, name), 2 * stop))
        self._attempt[start:stop] = attempts[good] + 1
        self._body[start:stop] = first
        self._size[start:stop] = len(bodies)
        self._made = stop
        return good

    def _forget(self) -> None:
        """Forget candidates for groups that no part holds any more."""
        used = np.zeros(self._made + 1, dtype=np.bool_)
        for level in self._levels:
            held = level.kept[level.live()]
            used[held[held >= 0]] = True
        chosen = np.flatnonzero(used[:-1])
        renamed = np.full(len(used), -1, dtype=np.intp)
        renamed[chosen] = np.arange(len(chosen))
        for level in self._levels:
            level.kept = renamed[level.kept]
        owner, offset = expand(self._size[chosen])
        self._bodies.keep(self._body[chosen][owner] + offset)
        self._made = len(chosen)
        for column in (self._attempt, self._size):
            column[: self._made] = column[chosen]
        sizes = self._size[: self._made]
        self._body[: self._made] = np.cumsum(sizes) - sizes


def _levels(leaves: int, bunch: int, scenes: int) -> list[_Level]:
    """The levels of the tree, from its leaves on: ``bunch`` of these together, about, then halves."""
    tops = 1 << max(0, -(-leaves // bunch) - 1).bit_length()
    bunch = -(-leaves // tops)
    levels = [_Level(tops * bunch, 1, 1, scenes)]
    if bunch > 1:
        levels.append(_Level(tops, bunch, bunch, scenes))
    while levels[-1].parts > 1:
        levels.append(_Level(levels[-1].parts // 2, 2, 2 * levels[-1].width, scenes))
    return levels
