"""Which lanes have bodies that collide: many bodies over many lanes, cheap tests first.

A lane that is lost is not looked at again; that saves work and changes no answer.
"""

from dataclasses import dataclass
from typing import Any, Final, NamedTuple

import numpy as np
import numpy.typing as npt

from scenic.graph import quaternions
from scenic.runtime.geometry.bodies import Body
from scenic.runtime.geometry.broadphase import boxes_overlap, overlapping_pairs
from scenic.runtime.geometry.mesh import Mesh
from scenic.runtime.geometry.narrowphase import meshes_intersect, quick_tests, solids_touch
from scenic.runtime.geometry.poses import Booleans, Floats, Indices, Poses
from scenic.runtime.geometry.proofs import ProofTable
from scenic.runtime.geometry.ragged import rows

__all__ = ["Body", "Collisions", "Poses", "collide"]

_CHUNK: Final = 1 << 18
"""Combinations of body and lane looked at together: bounds the memory by some 100 MB."""

_MOST_ENTRIES: Final = 1 << 18
"""Overlapping world boxes collected before they are looked at closely."""

_STEP: Final = 1 << 12
"""Entries looked at closely together: few enough for the processor's cache and for losing lanes early."""

_LIKELY: Final = (0.2, 0.6)
"""Parts of the smaller world box inside the other one above which a collision is likely; only an order."""


@dataclass(frozen=True, slots=True)
class Collisions:
    """What `collide` found.

    Attributes:
        free: lanes in which no pair collides, ``(n,)``.
        pairs: which pairs collide in which lane, ``(n, p)``; ``None`` unless asked for.

    """

    free: Booleans
    pairs: Booleans | None


def collide(
    bodies: tuple[Body, ...] | list[Body], pairs: npt.ArrayLike, lanes: int, *, exhaustive: bool = False
) -> Collisions:
    """Whether bodies collide, lane by lane.

    Args:
        bodies: the bodies.
        pairs: the pairs of bodies to look at, ``(p, 2)`` indices.
        lanes: the number of lanes.
        exhaustive: whether to find all colliding pairs of all lanes instead of one of each lane.

    """
    wanted = np.asarray(pairs, dtype=np.intp).reshape(-1, 2)
    free = np.ones(lanes, dtype=np.bool_)
    found = np.zeros((lanes, len(wanted)), dtype=np.bool_) if exhaustive else None
    fixed = np.array([body.is_fixed for body in bodies], dtype=np.bool_)
    decided = fixed[wanted[:, 0]] & fixed[wanted[:, 1]]
    for pair in np.flatnonzero(decided):
        if _fixed_pair_collides(bodies[wanted[pair, 0]], bodies[wanted[pair, 1]]):
            free[:] = False
            if found is None:
                return Collisions(free, None)
            found[:, pair] = True
    numbers = _pair_numbers(wanted, ~decided, len(bodies))
    moving = np.flatnonzero((numbers >= 0).any(axis=0) | (numbers >= 0).any(axis=1))
    if len(moving):
        world = _World([bodies[index] for index in moving], numbers[np.ix_(moving, moving)])
        step = max(1, _CHUNK // len(moving))
        for start in range(0, lanes, step):
            part = slice(start, min(start + step, lanes))
            view = None if found is None else found[part]
            _Lanes(world, part, lanes, free[part], view).search()
    return Collisions(free, found)


def _fixed_pair_collides(a: Body, b: Body) -> bool:
    if a.allow[0] or b.allow[0]:
        return False
    mesh_a, mesh_b = (body.meshes[0 if body.choice is None else int(body.choice[0])] for body in (a, b))
    lower_a, upper_a = a.poses.bounds()
    lower_b, upper_b = b.poses.bounds()
    if (lower_a > upper_b).any() or (lower_b > upper_a).any():
        return False
    return bool(meshes_intersect(mesh_a, a.poses, mesh_b, b.poses)[0])


def _pair_numbers(wanted: Indices, chosen: Booleans, count: int) -> Indices:
    """The number of each chosen pair at (smaller body, larger body), -1 elsewhere: ``(count, count)``."""
    numbers = np.full((count, count), -1, dtype=np.intp)
    which = np.flatnonzero(chosen)
    low, high = wanted[which].min(axis=1), wanted[which].max(axis=1)
    numbers[low, high] = which
    return numbers


class _Entries(NamedTuple):
    """Pairs that may collide: bodies, lane (within the chunk) and number of the pair, each ``(e,)``."""

    first: Indices
    second: Indices
    lane: Indices
    pair: Indices

    def where(self, chosen: Booleans | Indices) -> "_Entries":
        return _Entries(self.first[chosen], self.second[chosen], self.lane[chosen], self.pair[chosen])


class _World:
    """The bodies that take part, and the numbers of the pairs that matter."""

    def __init__(self, bodies: list[Body], numbers: Indices) -> None:
        self.bodies = bodies
        self.numbers = numbers
        meshes = list(dict.fromkeys(mesh for body in bodies for mesh in body.meshes))
        known = {mesh: number for number, mesh in enumerate(meshes)}
        self.meshes = meshes
        self.mesh_numbers = [np.array([known[mesh] for mesh in body.meshes]) for body in bodies]
        self.constant_size = np.array([body.poses.constant_size for body in bodies])
        self.are_boxes = np.array([mesh.is_box for mesh in meshes])
        self.proofs = None if self.are_boxes.all() else ProofTable(meshes)


class _Lanes:
    """The bodies in a chunk of lanes, as columns over (body, lane), and what is found out about the lanes."""

    def __init__(
        self, world: _World, part: slice, lanes: int, free: Booleans, found: Booleans | None
    ) -> None:
        self._world = world
        self._free = free
        self._found = found
        self._width = part.stop - part.start
        count = len(world.bodies)
        shape = (count, self._width)
        self._position, self._size = np.empty((3, *shape)), np.empty((3, *shape))
        self._orientation = np.empty((4, *shape))
        self._allow = np.empty(shape, dtype=np.bool_)
        self._mesh = np.empty(shape, dtype=np.intp)
        for index, body in enumerate(world.bodies):
            poses = body.poses
            self._position[:, index] = _rows(poses.position, part, lanes).T
            self._size[:, index] = _rows(poses.size, part, lanes).T
            self._orientation[:, index] = _rows(poses.orientation, part, lanes).T
            self._allow[index] = _rows(body.allow, part, lanes)
            chosen = 0 if body.choice is None else _rows(body.choice, part, lanes)
            self._mesh[index] = world.mesh_numbers[index][chosen]
        matrix = quaternions.to_matrix(np.moveaxis(self._orientation, 0, -1))
        self._matrix = np.moveaxis(matrix, (-2, -1), (0, 1))

    def search(self) -> None:
        """Record collisions; if they are not all wanted, one for each lane that has any."""
        collected: list[_Entries] = []
        total = 0
        lower, upper = self._bounds()
        for first, second, lane in overlapping_pairs(lower, upper):
            entries = _Entries(first, second, lane, self._world.numbers[first, second])
            allowed = self._allow[first, lane] | self._allow[second, lane]
            collected.append(entries.where(~allowed & (entries.pair >= 0)))
            total += len(lane)
            if total >= _MOST_ENTRIES:
                self._settle(collected, lower, upper)
                collected, total = [], 0
        if collected:
            self._settle(collected, lower, upper)

    def _bounds(self) -> tuple[Floats, Floats]:
        half = 0.5 * self._size
        reach = np.empty_like(half)
        for i in range(3):
            row = np.abs(self._matrix[i])
            reach[i] = row[0] * half[0] + row[1] * half[1] + row[2] * half[2]
        return self._position - reach, self._position + reach

    def _settle(self, collected: list[_Entries], lower: Floats, upper: Floats) -> None:
        """Decide about entries: those that look like collisions first, since they spare others of the lane."""
        entries = _Entries(*(np.concatenate(columns) for columns in zip(*collected, strict=True)))
        entries = self._alive(entries)
        likelihood = np.searchsorted(_LIKELY, self._penetration(entries, lower, upper))
        open_entries = []
        for group in (entries.where(likelihood == level) for level in range(len(_LIKELY), -1, -1)):
            for part in rows(len(group.lane), 1, _STEP):
                piece = self._alive(_Entries(*(column[part] for column in group)))
                if len(piece.lane):
                    open_entries.append(self._quick(piece))
        if open_entries:
            left = _Entries(*(np.concatenate(columns) for columns in zip(*open_entries, strict=True)))
            for group, mesh_a, mesh_b, constant_size in self._sorted(self._alive(left)):
                self._decide(group, mesh_a, mesh_b, constant_size)

    def _alive(self, entries: _Entries) -> _Entries:
        return entries if self._found is not None else entries.where(self._free[entries.lane])

    def _record(self, entries: _Entries) -> None:
        self._free[entries.lane] = False
        if self._found is not None:
            self._found[entries.lane, entries.pair] = True

    def _penetration(self, entries: _Entries, lower: Floats, upper: Floats) -> Floats:
        """The part of the smaller extents over which the world boxes overlap, the product over the axes."""
        first = entries.first * self._width + entries.lane
        second = entries.second * self._width + entries.lane
        result = np.ones(len(first))
        for axis in range(3):
            low, high = lower[axis].ravel(), upper[axis].ravel()
            low_a, high_a, low_b, high_b = low[first], high[first], low[second], high[second]
            overlap = np.minimum(high_a, high_b) - np.maximum(low_a, low_b)
            result *= overlap / np.minimum(high_a - low_a, high_b - low_b)
        return result

    def _quick(self, entries: _Entries) -> _Entries:
        """Record what oriented boxes and proofs say of at least one entry; returns what they leave open."""
        poses_a, poses_b = self._poses(entries.first, entries.lane), self._poses(entries.second, entries.lane)
        near = boxes_overlap(poses_a, poses_b)
        mesh_a, mesh_b = self._meshes(entries)
        boxes = near & self._world.are_boxes[mesh_a] & self._world.are_boxes[mesh_b]
        self._record(entries.where(boxes))
        near &= ~boxes
        if self._found is None:
            near &= self._free[entries.lane]
        which = np.flatnonzero(near)
        entries = entries.where(which)
        if not len(which) or self._world.proofs is None:
            return entries
        together, remains = quick_tests(
            self._world.proofs, mesh_a[which], poses_a.take(which), mesh_b[which], poses_b.take(which)
        )
        self._record(entries.where(together))
        return entries.where(remains)

    def _meshes(self, entries: _Entries) -> tuple[Indices, Indices]:
        return self._mesh[entries.first, entries.lane], self._mesh[entries.second, entries.lane]

    def _sorted(self, entries: _Entries) -> list[tuple[_Entries, Mesh, Mesh, bool]]:
        """The entries by meshes and by whether both sizes are constant; the quick ones first."""
        meshes, constant = self._world.meshes, self._world.constant_size
        mesh_a, mesh_b = self._meshes(entries)
        rigid = constant[entries.first] & constant[entries.second]
        groups = []
        for key in np.unique(np.stack([mesh_a, mesh_b, rigid], axis=1), axis=0).tolist():
            chosen = (mesh_a == key[0]) & (mesh_b == key[1]) & (rigid == key[2])
            groups.append((entries.where(chosen), meshes[key[0]], meshes[key[1]], bool(key[2])))
        # Meshes of random size have to be indexed anew for each entry.
        return sorted(groups, key=lambda group: (not group[3], len(group[1].faces) + len(group[2].faces)))

    def _decide(self, entries: _Entries, mesh_a: Mesh, mesh_b: Mesh, constant_size: bool) -> None:
        """The exact test, for one entry of each lane at a time, since the first collision settles the lane."""
        entries = self._alive(entries)
        while len(entries.lane):
            now = np.ones(len(entries.lane), dtype=np.bool_)
            if self._found is None:
                now[:] = False
                now[np.unique(entries.lane, return_index=True)[1]] = True
            current = entries.where(now)
            together = solids_touch(
                mesh_a,
                self._poses(current.first, current.lane, constant_size),
                mesh_b,
                self._poses(current.second, current.lane, constant_size),
            )
            self._record(current.where(together))
            entries = self._alive(entries.where(~now))

    def _poses(self, body: Indices, lane: Indices, constant_size: bool = False) -> Poses:
        flat = body * self._width + lane
        columns = (self._position, self._orientation, self._size, self._matrix)
        position, orientation, size, matrix = (
            np.take(column.reshape(*column.shape[:-2], -1), flat, axis=-1) for column in columns
        )
        poses = Poses(position.T, orientation.T, size.T, constant_size)
        return poses.with_matrix(np.moveaxis(matrix, -1, 0))


def _rows(column: npt.NDArray[Any], part: slice, lanes: int) -> npt.NDArray[Any]:
    return column if len(column) == 1 != lanes else column[part]
