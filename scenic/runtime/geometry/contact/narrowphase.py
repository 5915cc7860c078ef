"""Contacts of posed solids, decided on their meshes.

Steps from cheap to dear, each on what the ones before leave open: oriented boxes apart; one solid beyond a face of
the other's box; points of one solid found
in solid cells of the other; boxes that cover one solid found in empty cells of the other; surfaces that touch; one
solid wholly inside the other. What a step says of an entry depends on that entry alone, and a proof from cells
never says anything else than the exact test.
"""

import time
from collections.abc import Iterable, Sequence
from functools import cached_property
from typing import Final

import numpy as np

from scenic.dataclass import dataclass
from scenic.runtime.geometry.affine import AffineMaps, relative_map
from scenic.runtime.geometry.contact.broadphase import boxes_overlap
from scenic.runtime.geometry.contact.cell_proofs import ProofTable
from scenic.runtime.geometry.contact.fronts import Fronts
from scenic.runtime.geometry.contact.surface_contact import Surfaces
from scenic.runtime.geometry.meshes.facetree import Forest, face_tree
from scenic.runtime.geometry.meshes.inside import contains_points
from scenic.runtime.geometry.meshes.mesh import Mesh
from scenic.runtime.geometry.meshes.voxels import PROBES, seconds_to_make, voxels
from scenic.runtime.geometry.poses import Booleans, Floats, Indices, Poses
from scenic.runtime.geometry.ragged import distinct, expand, rows

_STAGES: Final = (slice(3), slice(3, 16), None, slice(16, None))
"""Probing points looked at one group after the other; ``None`` is the proof that solids are apart."""

_MOST_LEAVES: Final = 1 << 16
"""Pairs of near leaves of an entry up to which each is looked at; for more of them the trees are descended together."""

_MOST_CORNERS: Final = 1 << 12
"""Vertices of a mesh up to which its hull is compared with the faces of boxes."""

_APART: Final = 1e-9
"""Distance beyond a face, in units of the box, above which a solid counts as beyond it: the exact test says the same there."""

_CHUNK: Final = 1 << 17
"""Combinations of entry and probing point looked at together."""
_TRIED: Final = 16
"""Largest number of exact tests made together before it is decided again whether proofs pay; fewer at first."""


def recall(meshes: Iterable[Mesh]) -> None:
    """Make ready closed unit meshes that are to be compared, where earlier runs left on disk what takes long.

    The first comparison need not wait for it then.
    """
    for mesh in dict.fromkeys(meshes):
        if not mesh.is_box and seconds_to_make(mesh) == 0:
            mesh.derived(voxels)
            mesh.derived(face_tree)
            _ = mesh.component_vertices


class Solids:
    """Several closed unit meshes, made ready for comparing them; entries name them by their numbers.

    Args:
        meshes: the meshes.
        patience: seconds that exact tests may take until the cells are made; by default as long as making them takes.

    """

    def __init__(self, meshes: Sequence[Mesh], *, patience: float | None = None) -> None:
        self.meshes: Final = tuple(meshes)
        self.are_boxes: Final = np.array([mesh.is_box for mesh in meshes])
        self._spent = 0.0
        self._patience = patience

    @cached_property
    def _corners(self) -> tuple[Floats | None, ...]:
        """The corners of the meshes' hulls; none of boxes, of which all is known, and of large meshes, whose hulls are dear."""
        return tuple(
            None if mesh.is_box or len(mesh.vertices) > _MOST_CORNERS else mesh.outermost
            for mesh in self.meshes
        )

    @cached_property
    def _forest(self) -> Forest:
        return Forest(self.meshes)

    @cached_property
    def _surfaces(self) -> Surfaces:
        return Surfaces(self._forest)

    @cached_property
    def _fronts(self) -> Fronts:
        return Fronts(self._forest, self._proofs)

    @cached_property
    def _proofs(self) -> ProofTable:
        return ProofTable(self.meshes)

    @property
    def _can_prove(self) -> bool:
        """Return whether cells probably pay: exact tests have taken as long as making the cells would."""
        if self._patience is None:
            self._patience = sum(seconds_to_make(mesh) for mesh in self.meshes)
        return self._spent >= self._patience

    @cached_property
    def _parts(self) -> tuple[Indices, Indices, Floats]:
        """A vertex of each connected surface, mesh by mesh: where those of each begin, how many, all of them."""
        vertices = [mesh.component_vertices for mesh in self.meshes]
        counts = np.array([len(part) for part in vertices], dtype=np.intp)
        return np.cumsum(counts) - counts, counts, np.concatenate(vertices)

    def intersect(self, first: Indices, first_poses: Poses, second: Indices, second_poses: Poses) -> Booleans:
        """Return whether solids share a point, ``(n,)``; touching counts, up to rounding.

        Args:
            first: mesh numbers, ``(n,)``.
            first_poses: ``n`` or 1 of them.
            second: mesh numbers, ``(n,)``.
            second_poses: ``n`` or 1 of them.

        """
        result = np.broadcast_to(boxes_overlap(first_poses, second_poses), first.shape).copy()
        open_ = np.flatnonzero(result & ~(self.are_boxes[first] & self.are_boxes[second]))
        if len(open_):
            first, second = first[open_], second[open_]
            a, b = first_poses.take(open_), second_poses.take(open_)
            together, left = self.prove(first, a, second, b)
            which = np.flatnonzero(left)
            if len(which):
                together[which] = self.touch(first[which], a.take(which), second[which], b.take(which))
            result[open_] = together
        return result

    def prove(
        self, first: Indices, first_poses: Poses, second: Indices, second_poses: Poses
    ) -> tuple[Booleans, Booleans]:
        """Return the masks of entries that are proved to share a point ``(n,)``, and of those that remain open ``(n,)``; at least one entry is given.

        Cells prove nothing until exact tests have taken as long as cells take to make: only then are they made.
        """
        count = len(first)
        pairs = _Pairs.of(first, first_poses, second, second_poses)
        together = np.zeros(count, dtype=np.bool_)
        left = np.flatnonzero(~_either(self._beyond_a_face(*pairs.ways)))
        for stage in _STAGES if self._can_prove else ():
            if not len(left):
                break
            is_decided = self._stage(stage, pairs.take(left))
            together[left[is_decided]] = stage is not None
            left = left[~is_decided]
        remains = np.zeros(count, dtype=np.bool_)
        remains[left] = True
        return together, remains

    def _beyond_a_face(self, moving: Indices, still: Indices, maps: AffineMaps) -> Booleans:
        """Return a mask ``(n,)`` of the pairs whose moving solid lies beyond a face of the still one's box, the likeliest face.

        So does nearly all that stands or lies on a table.
        """
        result = np.zeros(len(moving), dtype=np.bool_)
        for number in distinct(moving).tolist():
            points = self._corners[number]
            if points is None:
                continue
            which = np.flatnonzero(moving == number)
            map_ = maps.take(which)
            gaps = np.abs(map_.offset) - 0.5 * np.abs(map_.matrix).sum(axis=1)
            axis, each = gaps.argmax(axis=0), np.arange(len(which))
            offset = map_.offset[axis, each]
            x, y, z = np.where(offset < 0, -1.0, 1.0) * map_.matrix[axis, :, each].T
            nearest = (points[:, :1] * x + points[:, 1:2] * y + points[:, 2:] * z).min(axis=0)
            result[which] = np.abs(offset) + nearest > 0.5 + _APART
        return result

    def _stage(self, points: slice | None, pairs: "_Pairs") -> Booleans:
        """Return a mask ``(n,)`` of the pairs that a stage decides."""
        moving, still, maps = pairs.ways
        if points is None:
            return _either(self._proofs.distance(moving, still, maps))
        result = np.empty(len(moving), dtype=np.bool_)
        every = np.arange(len(moving))
        for part in rows(len(moving), points.stop or PROBES, _CHUNK):
            result[part] = self._proofs.contact(moving[part], still[part], maps.take(every[part]), points)
        return _either(result)

    def touch(self, first: Indices, first_poses: Poses, second: Indices, second_poses: Poses) -> Booleans:
        """Return the same as `intersect`, by the exact test, for entries (at least one) that `prove` leaves open.

        Should proofs come to pay on the way, they are tried on what is left.
        """
        if self._can_prove:
            return self._touch(first, first_poses, second, second_poses)
        result = np.empty(len(first), dtype=np.bool_)
        left = np.arange(len(first))
        count = 1
        while len(left) and not self._can_prove:
            part, left = left[:count], left[count:]
            count = min(2 * count, _TRIED)
            start_time = time.thread_time()
            result[part] = self._touch(
                first[part], first_poses.take(part), second[part], second_poses.take(part)
            )
            self._spent += time.thread_time() - start_time
        if len(left):
            a, b = first_poses.take(left), second_poses.take(left)
            result[left], open_ = self.prove(first[left], a, second[left], b)
            which = np.flatnonzero(open_)
            if len(which):
                part = left[which]
                result[part] = self._touch(first[part], a.take(which), second[part], b.take(which))
        return result

    def _touch(self, first: Indices, first_poses: Poses, second: Indices, second_poses: Poses) -> Booleans:
        pairs = _Pairs.of(first, first_poses, second, second_poses)
        touching = self._meet(pairs) if self._can_prove else self._surfaces_touch(pairs)
        apart = np.flatnonzero(~touching)
        if len(apart):
            touching[apart] = _either(self._some_part_inside(*pairs.take(apart).ways))
        return touching

    def _meet(self, pairs: "_Pairs") -> Booleans:
        """Return the mask of the entries whose surfaces share a point, and of some of those where one solid reaches into the other."""
        front = self._fronts.find(*pairs.ways)
        result = front.touching
        first, second = front.leaves()
        products = np.where(result, 0, first.counts * second.counts)
        are_many = products > _MOST_LEAVES
        few, many = np.flatnonzero((products > 0) & ~are_many), np.flatnonzero(are_many)
        if len(few):
            result |= self._surfaces.touch_among(front, few, pairs.forth, pairs.back)
        if len(many):
            result[many] = self._surfaces_touch(pairs.take(many))
        return result

    def _surfaces_touch(self, pairs: "_Pairs") -> Booleans:
        return self._surfaces.touch(pairs.first, pairs.second, pairs.forth, pairs.back)

    def surfaces_touch(
        self, first: Indices, first_poses: Poses, second: Indices, second_poses: Poses
    ) -> Booleans:
        """Return whether the surfaces share a point, ``(n,)``."""
        return self._surfaces_touch(_Pairs.of(first, first_poses, second, second_poses))

    def some_part_inside(
        self, inner: Indices, inner_poses: Poses, outer: Indices, outer_poses: Poses
    ) -> Booleans:
        """Return whether a connected surface of ``inner`` lies in ``outer``, ``(n,)``, given that the surfaces do not touch."""
        return self._some_part_inside(inner, outer, relative_map(inner_poses, outer_poses))

    def _some_part_inside(self, inner: Indices, outer: Indices, maps: AffineMaps) -> Booleans:
        starts, counts, vertices = self._parts
        entry, offset = expand(counts[inner])
        x, y, z = vertices[starts[inner][entry] + offset].T
        images = maps.take(entry).columns((x, y, z))
        near = np.ones(len(entry), dtype=np.bool_)
        for column in images:
            near &= np.abs(column) <= 0.5
        which = np.flatnonzero(near)
        if self._can_prove and len(which):
            # Rays are dear: what lies in an empty cell needs none.
            there = np.stack([column[which] for column in images])
            which = which[self._proofs.near_filled(outer[entry[which]], there, np.zeros_like(there))]
        points = np.stack([column[which] for column in images], axis=1)
        result = np.zeros(len(inner), dtype=np.bool_)
        numbers = outer[entry[which]]
        for number in distinct(numbers).tolist():
            members = np.flatnonzero(numbers == number)
            inside = contains_points(self.meshes[number], points[members])
            result[entry[which[members[inside]]]] = True
        return result


@dataclass(frozen=True, slots=True)
class _Pairs:
    """Posed solids, two by two: numbers of their meshes and the maps between their unit frames both ways."""

    first: Indices
    second: Indices
    forth: AffineMaps
    back: AffineMaps

    @classmethod
    def of(cls, first: Indices, first_poses: Poses, second: Indices, second_poses: Poses) -> "_Pairs":
        forth, back = relative_map(first_poses, second_poses), relative_map(second_poses, first_poses)
        return cls(first, second, forth, back)

    def take(self, chosen: Indices) -> "_Pairs":
        """These pairs."""
        return _Pairs(
            self.first[chosen], self.second[chosen], self.forth.take(chosen), self.back.take(chosen)
        )

    @property
    def ways(self) -> tuple[Indices, Indices, AffineMaps]:
        """Moving and still meshes and the maps from those to these: all pairs, then all of them the other way round."""
        moving = np.concatenate([self.first, self.second])
        still = np.concatenate([self.second, self.first])
        return moving, still, self.forth.followed_by(self.back)


def _either(ways: Booleans) -> Booleans:
    """Return a mask ``(n,)`` of the pairs for which a mask ``(2 n,)`` of both ways is true in either way."""
    first, second = ways.reshape(2, -1)
    return first | second


def meshes_intersect(mesh_a: Mesh, poses_a: Poses, mesh_b: Mesh, poses_b: Poses) -> Booleans:
    """Return whether the solids of two closed unit meshes share a point, ``(n,)``; touching counts, up to rounding."""
    numbers = np.zeros(max(len(poses_a), len(poses_b)), dtype=np.intp)
    return Solids([mesh_a, mesh_b]).intersect(numbers, poses_a, numbers + 1, poses_b)
