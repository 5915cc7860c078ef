"""Candidates for groups that only meet: the accepted attempts at each group of each scene, in order, with their bodies.

All attempts at groups of one kind are lanes of one batch (`scenic.runtime.sampling.alike`).
"""

from collections.abc import Sequence
from typing import Final

import numpy as np
from numpy.typing import NDArray

from scenic.runtime.geometry.ragged import distinct, expand
from scenic.runtime.sampling.alike import GroupKind
from scenic.runtime.sampling.apart import Apart, attempts_at_kind
from scenic.runtime.sampling.engine import Engine
from scenic.runtime.sampling.group_collisions import Bodies

__all__ = ["LEAVES", "GroupCandidates", "Queues"]

Numbers = NDArray[np.int64]
Indices = NDArray[np.intp]

LEAVES: Final = 1 << 15
"""Groups in the candidates that are evaluated together, about."""

_PLENTY: Final = 1 << 40
"""The number of candidates for the part without a group that stands where there is no other."""

FAITH: Final = 20.0
"""Number of candidates that the first estimate of the share of those that pass counts for."""


class Queues:
    """Queues of candidates for the parts of one level that have not been used yet, scene by scene.

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
        self.judged, self.passed = FAITH, FAITH

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
        """Append candidates ``(m, width)`` to the queues of the parts ``(m,)``, which are ascending."""
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


class GroupCandidates:
    """The candidates for the groups of some scenes.

    Args:
        engine: of the whole plan.
        apart: the groups.
        tasks: which scenes: seeds, and numbers in the run of a seed.
        max_attempts: candidates tried for one group of one scene.
        lanes: candidates for the whole in one batch at most.
        slots: the group at each of a number of places in a scene, -1 where there is none, ``(slots,)``.

    """

    def __init__(
        self,
        engine: Engine,
        apart: Apart,
        tasks: Sequence[tuple[int, int]],
        max_attempts: int,
        lanes: int,
        slots: Indices,
    ) -> None:
        self._engine = engine
        self._apart = apart
        self._pending = engine.pending(tasks)
        self._limit = max_attempts
        # Memory is bounded by candidates for the whole; those for a group take as much less of it.
        self.lanes: Final = max(1, min(LEAVES, lanes * apart.leaves))
        """Candidates for a group in one batch at most."""
        self.is_over: Final = np.zeros(len(tasks), dtype=np.bool_)
        """A mask of the scenes in which a group has reached its limit of attempts."""
        self.tried: Final = np.zeros((len(tasks), apart.leaves), dtype=np.int64)
        """The number of attempts at each group of each scene."""
        self._leaf = slots
        self.queues: Final = Queues(len(slots), 1, 1, len(tasks))
        """Candidates for the group of each slot that have not been used."""
        self.queues.fill(np.flatnonzero(np.tile(slots < 0, len(tasks))))
        self.bodies: Final = Bodies()
        self.count = 0
        """The number of candidates that are known."""
        self._attempt: Numbers = np.empty(LEAVES, dtype=np.int64)
        self._body: Indices = np.empty(LEAVES, dtype=np.intp)
        """The first row of the bodies of each."""
        self._size: Indices = np.empty(LEAVES, dtype=np.intp)
        """The number of its bodies."""
        self._are_single = all(len(kind.objects) == 1 for kind in apart.kinds)
        self.rates: Final = [[FAITH, FAITH] for _ in apart.kinds]
        """The attempts at groups of each kind that were judged, and that passed."""
        self._member = np.empty(apart.leaves, dtype=np.intp)
        """The number of each group among those of its kind."""
        for kind in apart.kinds:
            self._member[kind.members] = np.arange(len(kind.members))

    def attempts(self, chosen: Indices) -> Numbers:
        """The attempts, from 1, that some candidates are."""
        return self._attempt[chosen]

    def spread(self, chosen: Indices) -> tuple[Indices, Indices]:
        """The rows of the bodies of candidates ``(n,)``, and the place of each one's candidate among these."""
        if self._are_single:
            return chosen, np.arange(len(chosen))
        owner, offset = expand(self._size[chosen])
        return self._body[chosen][owner] + offset, owner

    def supply(self, rows: Indices, missing: Numbers) -> None:
        """Try the next attempts at the groups of some slots, about as many as it takes to find those that are missing."""
        slots = len(self._leaf)
        scenes, leaves = rows // slots, self._leaf[rows % slots]
        kinds = self._apart.kind[leaves]
        for number in distinct(kinds).tolist():
            mine = np.flatnonzero(kinds == number)
            judged_count, passed_count = self.rates[number]
            ratio = missing[mine] * (judged_count / passed_count)
            counts = np.ceil(ratio) if len(mine) <= LEAVES // 64 else np.floor(ratio)
            self._attempt_kind(number, scenes[mine], leaves[mine], rows[mine], counts.astype(np.int64))

    def _attempt_kind(
        self, number: int, scenes: Indices, leaves: Indices, rows: Indices, counts: Numbers
    ) -> None:
        attempts_so_far = self.tried[scenes, leaves]
        counts = np.minimum(np.clip(counts, 1, self.lanes), self._limit - attempts_so_far)
        self.is_over[scenes[counts == 0]] = True
        self.tried[scenes, leaves] += counts
        owner, offset = expand(counts)
        attempts = attempts_so_far[owner] + offset
        for start in range(0, len(owner), self.lanes):
            part = slice(start, start + self.lanes)
            mine = owner[part]
            good = self._judge(number, scenes[mine], leaves[mine], attempts[part])
            self.rates[number][0] += len(mine)
            self.rates[number][1] += len(good)
            passing = self.count - len(good) + np.arange(len(good))
            self.queues.add(rows[mine[good]], passing[:, np.newaxis])

    def _judge(self, number: int, scenes: Indices, leaves: Indices, attempts: Numbers) -> Indices:
        """Keep the attempts at groups of a kind that pass their checks as candidates; returns their numbers among the attempts."""
        kind: GroupKind = self._apart.kinds[number]
        member = self._member[leaves]
        batch = attempts_at_kind(self._engine, kind, self._pending, scenes, member, attempts)
        good = batch.rows.copy()
        if not len(good):
            return good
        bodies = [item.body(batch) for item in kind.objects]
        first = self.bodies.add(bodies, kind.numbers[member[good]])
        start, stop = self.count, self.count + len(good)
        if stop > len(self._attempt):
            for name in ("_attempt", "_body", "_size"):
                setattr(self, name, np.resize(getattr(self, name), 2 * stop))
        self._attempt[start:stop] = attempts[good] + 1
        self._body[start:stop] = first
        self._size[start:stop] = len(bodies)
        self.count = stop
        return good

    def forget(self, held: Sequence[Indices]) -> Indices:
        """Forget candidates that are neither waiting nor held; returns the new numbers of all, -1 of the forgotten and of -1."""
        is_used = np.zeros(self.count + 1, dtype=np.bool_)
        for each in (*held, self.queues.kept[self.queues.live()]):
            is_used[each[each >= 0]] = True
        numbers = np.flatnonzero(is_used[:-1])
        new_number = np.full(len(is_used), -1, dtype=np.intp)
        new_number[numbers] = np.arange(len(numbers))
        self.queues.kept = new_number[self.queues.kept]
        owner, offset = expand(self._size[numbers])
        self.bodies.keep(self._body[numbers][owner] + offset)
        self.count = len(numbers)
        for column in (self._attempt, self._size):
            column[: self.count] = column[numbers]
        sizes = self._size[: self.count]
        self._body[: self.count] = np.cumsum(sizes) - sizes
        return new_number
