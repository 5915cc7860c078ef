"""Collisions of many bodies over many lanes, cheap tests first.

A lane that is lost is not looked at again; that saves work and changes no answer.
"""

from collections.abc import Sequence
from typing import Final, NamedTuple

import numpy as np
import numpy.typing as npt

from scenic.runtime.geometry.contact.broadphase import CellMap, boxes_overlap, near_pairs
from scenic.runtime.geometry.contact.crowd import Crowd
from scenic.runtime.geometry.contact.narrowphase import Solids
from scenic.runtime.geometry.meshes.bodies import Body
from scenic.runtime.geometry.poses import Booleans, Indices, Poses
from scenic.runtime.geometry.ragged import rows

__all__ = ["Body", "Collider", "Collisions", "Poses", "collide"]

_CHUNK: Final = 1 << 18
"""Combinations of body and lane looked at together, a few bytes each."""

_BOXES: Final = 1 << 14
"""Combinations of body and lane whose world boxes are computed together."""

_MOST_ENTRIES: Final = 1 << 18
"""Overlapping world boxes collected before they are looked at closely."""

_STEP: Final = 1 << 12
"""Entries looked at closely together: few enough for the processor's cache and for losing lanes early."""

_FEW: Final = 32
"""Entries that are tested exactly beside others, needed or not: a test of its own costs as much, for any number."""

_LIKELY: Final = (0.25, 0.5)
"""Distances of centres over the sum of the radii below which a collision is likely; only an order."""


class Collisions(NamedTuple):
    """The collisions that were found.

    Attributes:
        free: lanes in which no pair collides, ``(n,)``.
        pairs: which of the pairs collide in which lane, ``(n, p)``; ``None`` unless asked for.

    """

    free: Booleans
    pairs: Booleans | None


def collide(
    bodies: Sequence[Body], pairs: npt.ArrayLike | None, lanes: int, *, exhaustive: bool = False
) -> Collisions:
    """Return whether bodies collide, lane by lane: `Collider.test` for a single batch."""
    return Collider(bodies, pairs).test(bodies, lanes, exhaustive=exhaustive)


class Collider:
    """Tests one cast of bodies batch after batch; what is fixed is looked at once.

    Args:
        bodies: the bodies of any batch; only which are fixed, and those themselves, matter.
        pairs: the pairs of bodies to look at, ``(p, 2)`` indices in any order, without duplicates; all pairs if
            ``None``.

    """

    def __init__(self, bodies: Sequence[Body], pairs: npt.ArrayLike | None = None) -> None:
        count = len(bodies)
        is_fixed = np.array([body.is_fixed for body in bodies], dtype=np.bool_)
        self._moving = np.flatnonzero(~is_fixed)
        self._fixed = np.flatnonzero(is_fixed)
        # Moving bodies first, as `near_pairs` wants them.
        self._order = np.concatenate([self._moving, self._fixed])
        self.pairs: Final = _all_pairs(count) if pairs is None else _as_pairs(pairs)
        place = np.empty(count, dtype=np.intp)
        place[self._order] = np.arange(count)
        self._wanted: Booleans | None = None
        if pairs is not None:
            self._wanted = np.zeros((count, count), dtype=np.bool_)
            one, two = place[self.pairs].T
            self._wanted[one, two] = self._wanted[two, one] = True
        self._still = (
            Crowd.of([bodies[index] for index in self._fixed.tolist()]) if len(self._fixed) else None
        )
        self._solids: Solids | None = None
        self.fixed_collisions: Final = self._fixed_pairs()
        """The fixed bodies that collide with each other, ``(c, 2)``, the smaller number first."""

    def test(self, bodies: Sequence[Body] | Crowd, lanes: int, *, exhaustive: bool = False) -> Collisions:
        """Return whether the bodies collide, lane by lane.

        Args:
            bodies: the same cast as ever, in this batch; or, stacked, those of them that are not fixed.
            lanes: the number of lanes.
            exhaustive: whether to find all colliding pairs of all lanes instead of one of each lane.

        """
        free = np.ones(lanes, dtype=np.bool_)
        entries: list[_Entries] | None = [] if exhaustive else None
        if len(self.fixed_collisions):
            free[:] = False
        if len(self._moving) and (exhaustive or free.any()):
            crowd = bodies
            if not isinstance(crowd, Crowd):
                crowd = Crowd.of([crowd[index] for index in self._moving.tolist()])
            if self._still is not None:
                crowd = crowd.followed_by(self._still)
            solids = self._solids_of(crowd)
            _Search(crowd, solids, len(self._moving), self._wanted, free, entries).run()
        return Collisions(free, None if entries is None else self._matrix(entries, lanes))

    def _solids_of(self, crowd: Crowd) -> Solids:
        """Return the precomputed tables of a crowd's meshes; they are kept while the meshes stay the same."""
        if self._solids is None or self._solids.meshes != crowd.meshes:
            self._solids = Solids(crowd.meshes)
        return self._solids

    def _fixed_pairs(self) -> Indices:
        if self._still is None:
            return np.empty((0, 2), dtype=np.intp)
        wanted_pairs = None
        if self._wanted is not None:
            wanted_pairs = self._wanted[len(self._moving) :, len(self._moving) :]
        entries: list[_Entries] = []
        solids = self._solids_of(self._still)
        _Search(
            self._still, solids, len(self._fixed), wanted_pairs, np.ones(1, dtype=np.bool_), entries
        ).run()
        pairs = [np.stack([self._fixed[part.first], self._fixed[part.second]], axis=1) for part in entries]
        return np.concatenate([np.empty((0, 2), dtype=np.intp), *pairs])

    def _matrix(self, found: list["_Entries"], lanes: int) -> Booleans:
        """Return a mask ``(lanes, pairs)`` of the pairs of objects that collide in each lane."""
        count = len(self._order)
        low, high = np.sort(self.pairs, axis=1).T
        keys = low * count + high
        order = np.argsort(keys)
        result = np.zeros((lanes, len(keys)), dtype=np.bool_)

        def column(one: Indices, two: Indices) -> Indices:
            key = np.minimum(one, two) * count + np.maximum(one, two)
            return order[np.searchsorted(keys, key, sorter=order)]

        for part in found:
            result[part.lane, column(self._order[part.first], self._order[part.second])] = True
        result[:, column(*self.fixed_collisions.T)] = True
        return result


def _as_pairs(pairs: npt.ArrayLike) -> Indices:
    return np.asarray(pairs, dtype=np.intp).reshape(-1, 2)


def _all_pairs(count: int) -> Indices:
    return np.stack(np.triu_indices(count, 1), axis=1)


class _Entries(NamedTuple):
    """Pairs that may collide: bodies and lane, each ``(e,)``."""

    first: Indices
    second: Indices
    lane: Indices

    def where(self, chosen: Booleans | Indices | slice) -> "_Entries":
        return _Entries(self.first[chosen], self.second[chosen], self.lane[chosen])


class _Search:
    """One look at a crowd.

    Args:
        crowd: the bodies.
        solids: their meshes.
        moving: how many of them are not fixed; they come first.
        wanted: which pairs matter, ``(m, m)``; all if ``None``.
        free: lanes still without a collision, ``(n,)``; kept up to date.
        found: where to put collisions if all are wanted; otherwise ``None``, and a lane is left at the first.

    """

    def __init__(
        self,
        crowd: Crowd,
        solids: Solids,
        moving: int,
        wanted: Booleans | None,
        free: Booleans,
        found: list[_Entries] | None,
    ) -> None:
        self._crowd = crowd
        self._moving = moving
        self._wanted = wanted
        self._free = free
        self._found = found
        self._radius = crowd.radius()
        self._solids = solids

    def run(self) -> None:
        """Record collisions; if they are not all wanted, one for each lane that has any."""
        if len(self._crowd) < 2:
            return
        cells = CellMap.around(self._crowd.position.values)
        step = max(1, _CHUNK // len(self._crowd))
        for start in range(0, len(self._free), step):
            self._chunk(start, min(start + step, len(self._free)), cells)

    def _chunk(self, start: int, stop: int, cells: CellMap) -> None:
        width = -(-(stop - start) // 8) * 8
        shape = (3, len(self._crowd), width)
        lower, upper = np.full(shape, 255, dtype=np.uint8), np.zeros(shape, dtype=np.uint8)
        for part in rows(stop - start, len(self._crowd), _BOXES):
            low, high = self._crowd.boxes(slice(start + part.start, start + part.stop))
            cells.put(low, lower[:, :, part])
            cells.put(high, upper[:, :, part])
        batches: list[_Entries] = []
        total = 0
        for first, second, lane in near_pairs(lower, upper, self._moving):
            entries = _Entries(first, second, lane + start)
            if self._wanted is not None:
                entries = entries.where(self._wanted[first, second])
            batches.append(entries)
            total += len(entries.lane)
            if total >= _MOST_ENTRIES:
                self._settle(batches)
                batches, total = [], 0
        if total:
            self._settle(batches)

    def _settle(self, collected: list[_Entries]) -> None:
        """Decide about entries: those that look like collisions first, since they spare others of the lane."""
        entries = self._alive(_joined(collected))
        allow = self._crowd.allow
        if allow.values.any():
            is_allowed = allow.at(entries.first, entries.lane) | allow.at(entries.second, entries.lane)
            entries = entries.where(~is_allowed)
        open_entries = []
        for group in self._by_likelihood(entries):
            for part in rows(len(group.lane), 1, _STEP):
                piece = self._alive(group.where(part))
                if len(piece.lane):
                    open_entries.append(self._quick(piece))
        if open_entries:
            self._decide(self._alive(_joined(open_entries)))

    def _by_likelihood(self, entries: _Entries) -> list[_Entries]:
        if len(entries.lane) <= _STEP or self._found is not None:
            return [entries]
        position, radius = self._crowd.position, self._radius
        offset = position.at(entries.first, entries.lane) - position.at(entries.second, entries.lane)
        reach = radius.at(entries.first, entries.lane) + radius.at(entries.second, entries.lane)
        x, y, z = offset.T
        level = np.searchsorted(_LIKELY, np.sqrt(x * x + y * y + z * z) / reach)
        return [entries.where(level == number) for number in range(len(_LIKELY) + 1)]

    def _alive(self, entries: _Entries) -> _Entries:
        return entries if self._found is not None else entries.where(self._free[entries.lane])

    def _record(self, entries: _Entries) -> None:
        self._free[entries.lane] = False
        if self._found is not None:
            self._found.append(entries)

    def _quick(self, entries: _Entries) -> _Entries:
        """Record what oriented boxes and proofs say of at least one entry; returns what they leave open."""
        poses_a, poses_b = (self._crowd.poses(body, entries.lane) for body in (entries.first, entries.second))
        near = boxes_overlap(poses_a, poses_b)
        mesh_a, mesh_b = self._meshes(entries)
        are_boxes = self._solids.are_boxes
        boxes = near & are_boxes[mesh_a] & are_boxes[mesh_b]
        self._record(entries.where(boxes))
        near &= ~boxes
        if self._found is None:
            near &= self._free[entries.lane]
        which = np.flatnonzero(near)
        entries = entries.where(which)
        if not len(which):
            return entries
        together, remains = self._solids.prove(
            mesh_a[which], poses_a.take(which), mesh_b[which], poses_b.take(which)
        )
        self._record(entries.where(together))
        return entries.where(remains)

    def _meshes(self, entries: _Entries) -> tuple[Indices, Indices]:
        mesh = self._crowd.mesh
        return mesh.at(entries.first, entries.lane), mesh.at(entries.second, entries.lane)

    def _decide(self, entries: _Entries) -> None:
        """The exact test: at first one entry of each lane, then more, since the first collision settles the lane."""
        most = 1
        while len(entries.lane):
            now = np.ones(len(entries.lane), dtype=np.bool_)
            if self._found is None:
                order = np.argsort(entries.lane, kind="stable")
                lanes = entries.lane[order]
                now[order] = np.arange(len(order)) - np.searchsorted(lanes, lanes) < most
                if np.count_nonzero(~now) <= _FEW:
                    now[:] = True
            current = entries.where(now)
            mesh_a, mesh_b = self._meshes(current)
            together = self._solids.touch(
                mesh_a,
                self._crowd.poses(current.first, current.lane),
                mesh_b,
                self._crowd.poses(current.second, current.lane),
            )
            self._record(current.where(together))
            entries = self._alive(entries.where(~now))
            most *= 2


def _joined(parts: list[_Entries]) -> _Entries:
    return (
        parts[0]
        if len(parts) == 1
        else _Entries(*(np.concatenate(columns) for columns in zip(*parts, strict=True)))
    )
