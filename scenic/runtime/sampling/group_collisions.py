"""Collisions between groups of bodies whose places are known: many combinations of groups at a time."""

from collections.abc import Sequence
from typing import Final

import numpy as np
from numpy.typing import NDArray

from scenic.runtime.geometry.contact.narrowphase import Solids
from scenic.runtime.geometry.meshes.bodies import Body
from scenic.runtime.geometry.meshes.mesh import Mesh
from scenic.runtime.geometry.poses import Booleans, Floats, Indices, Poses
from scenic.runtime.geometry.ragged import expand, rows

__all__ = ["Bodies"]

_MARGIN: Final = 1e-6
"""Relative: what rounding may do to distances, with room to spare."""

_STEP: Final = 1 << 13
"""Pairs that are looked at closely together, since one collision settles the rest of a combination."""

_FIRST: Final = 1024
"""Rows of a store that is new."""


class Bodies:
    """Bodies at known places, in rows that are numbered as they come."""

    def __init__(self) -> None:
        self._count = 0
        self._places: Floats = np.empty((_FIRST, 11))
        """Position, orientation, size and radius of each."""
        self._mesh: Indices = np.empty(_FIRST, dtype=np.intp)
        self._allow: Booleans = np.empty(_FIRST, dtype=np.bool_)
        self._thing: Indices = np.empty(_FIRST, dtype=np.intp)
        self._meshes: dict[Mesh, int] = {}
        self._solids = Solids(())

    def __len__(self) -> int:
        return self._count

    def add(self, bodies: Sequence[Body], things: Indices) -> Indices:
        """Add some bodies in each of some lanes; ``things`` ``(n, bodies)`` says which object each one is.

        Returns:
            The numbers of the rows of the first body, ``(n,)``; those of the others follow.

        """
        lanes, members = things.shape
        start, stop = self._count, self._count + lanes * members
        self._reserve(stop)
        for member, body in enumerate(bodies):
            mine = slice(start + member, stop, members)
            poses = body.poses
            self._places[mine, 0:3] = poses.position
            self._places[mine, 3:7] = poses.orientation
            self._places[mine, 7:10] = poses.size
            numbers = np.array([self._number(mesh) for mesh in body.meshes], dtype=np.intp)
            self._mesh[mine] = numbers[0 if body.choice is None else body.choice]
            self._allow[mine] = body.allow
            self._thing[mine] = things[:, member]
        size = self._places[start:stop, 7:10]
        self._places[start:stop, 10] = 0.5 * np.sqrt(np.square(size).sum(axis=1))
        self._count = stop
        return np.arange(start, stop, members) if members else np.full(lanes, start)

    def keep(self, chosen: Indices) -> None:
        """Keep these rows only; they are numbered anew, in their order."""
        for column in (self._places, self._mesh, self._allow, self._thing):
            column[: len(chosen)] = column[chosen]
        self._count = len(chosen)

    def apart(
        self, lanes: int, chosen: Indices, lane: Indices, part: Indices, may_meet: Booleans
    ) -> Booleans:
        """Return whether no two bodies of different parts collide, in each lane, ``(lanes,)``.

        Args:
            lanes: their number.
            chosen: rows of bodies, ``(n,)``.
            lane: their lanes, ``(n,)``.
            part: numbers of the parts that they belong to, ``(n,)``.
            may_meet: which objects must not collide, ``(objects, objects)``.

        """
        free = np.ones(lanes, dtype=np.bool_)
        first, second = self._near(chosen, lane, part)
        one, two, lane = chosen[first], chosen[second], lane[first]
        is_relevant = self._forbidden(one, two, may_meet)
        one, two, lane = one[is_relevant], two[is_relevant], lane[is_relevant]
        for step in rows(len(lane), 1, _STEP):
            left = np.flatnonzero(free[lane[step]]) + step.start
            if len(left):
                collides = self._collide(one[left], two[left])
                free[lane[left[collides]]] = False
        return free

    def meetings(
        self, chosen: Indices, lane: Indices, part: Indices, is_new: Booleans, may_meet: Booleans
    ) -> tuple[Indices, Indices]:
        """Return the places in ``chosen`` of the bodies that collide, pair by pair, where one of them at least is new.

        The arguments are those of `apart`; ``is_new`` ``(n,)`` masks the new bodies.
        """
        first, second = self._near(chosen, lane, part)
        may_collide = is_new[first] | is_new[second]
        may_collide &= self._forbidden(chosen[first], chosen[second], may_meet)
        first, second = first[may_collide], second[may_collide]
        collision_parts = [
            self._collide(chosen[first[step]], chosen[second[step]]) for step in rows(len(first), 1, _STEP)
        ]
        collides = np.concatenate([np.empty(0, dtype=np.bool_), *collision_parts])
        return first[collides], second[collides]

    def pairs(self, may_meet: Booleans) -> tuple[int, int]:
        """The number of pairs of bodies that may meet, and of those that do, each body with all others."""
        every = np.arange(len(self))
        one, two = self._near(every, np.zeros_like(every), every)
        wanted = self._forbidden(one, two, may_meet)
        counts = np.bincount(self._thing[: len(self)], minlength=len(may_meet))
        total = int(counts @ may_meet @ counts) // 2
        return total, int(np.count_nonzero(self._collide(one[wanted], two[wanted]))) if wanted.any() else 0

    def _forbidden(self, one: Indices, two: Indices, may_meet: Booleans) -> Booleans:
        """Return a mask of the pairs of rows whose bodies must not collide."""
        may = may_meet[self._thing[one], self._thing[two]]
        return np.asarray(may & ~self._allow[one] & ~self._allow[two])

    def _near(self, chosen: Indices, lane: Indices, part: Indices) -> tuple[Indices, Indices]:
        """The pairs of places in ``chosen``, of one lane and different parts, whose spheres may share a point.

        Bodies are sorted along one axis, lane by lane, and compared with those that follow within reach.
        """
        if len(chosen) < 2:
            none = np.empty(0, dtype=np.intp)
            return none, none
        places = self._places[chosen]
        lowest, highest = np.nanmin(places[:, :2], axis=0), np.nanmax(places[:, :2], axis=0)
        along = int(highest[1] - lowest[1] > highest[0] - lowest[0])
        reach = 2 * float(np.nanmax(places[:, 10])) * (1 + _MARGIN)
        stride = float(highest[along] - lowest[along]) + 2 * reach
        keys = places[:, along] - lowest[along] + lane * stride
        reach += 1e-9 * stride * float(lane[-1] + 1)
        order = np.argsort(keys, kind="stable")
        keys = keys[order]
        first = np.arange(len(keys))
        counts = np.searchsorted(keys, keys + reach, side="right") - first - 1
        owner, offset = expand(np.maximum(counts, 0))
        one, two = order[owner], order[owner + offset + 1]
        apart = part[one] != part[two]
        one, two = one[apart], two[apart]
        x, y, z = ((places[one, axis] - places[two, axis]) for axis in range(3))
        most = (places[one, 10] + places[two, 10]) * (1 + _MARGIN)
        close = x * x + y * y + z * z <= most * most
        return one[close], two[close]

    def _collide(self, one: Indices, two: Indices) -> Booleans:
        if len(self._solids.meshes) != len(self._meshes):
            self._solids = Solids(tuple(self._meshes))
        return self._solids.intersect(self._mesh[one], self._poses(one), self._mesh[two], self._poses(two))

    def _poses(self, chosen: Indices) -> Poses:
        places = self._places[chosen]
        return Poses(places[:, 0:3], places[:, 3:7], places[:, 7:10])

    def _number(self, mesh: Mesh) -> int:
        return self._meshes.setdefault(mesh, len(self._meshes))

    def _reserve(self, wanted: int) -> None:
        size = len(self._mesh)
        if wanted <= size:
            return
        size = max(2 * size, wanted)
        for name in ("_places", "_mesh", "_allow", "_thing"):
            old: NDArray[np.generic] = getattr(self, name)
            new = np.empty((size, *old.shape[1:]), dtype=old.dtype)
            new[: self._count] = old[: self._count]
            setattr(self, name, new)
