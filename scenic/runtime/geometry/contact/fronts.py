"""The parts of two surfaces that come near each other's solids, found by the trees of faces and the cells of `voxels`.

A face whose box lies in empty cells of the other solid touches nothing, and one with a corner in a solid cell
settles that both touch. Boxes are cut in parts where neither is seen, so that the cost grows with how much of the
surfaces is near, not with their product.
"""

from typing import Final, NamedTuple

import numpy as np

from scenic.runtime.geometry.affine import AffineMaps, taken
from scenic.runtime.geometry.contact.cell_proofs import ProofTable
from scenic.runtime.geometry.meshes.facetree import Forest
from scenic.runtime.geometry.poses import Booleans, Floats, Indices
from scenic.runtime.geometry.ragged import Groups, expand, group_starts

_LEVEL: Final = 4
"""The level of the trees at which the search begins: among the boxes above it, some pair is nearly always near."""


_STEP: Final = 3
"""Levels that the search goes down at a time: boxes between them are not looked at."""


class Front(NamedTuple):
    """The parts of surfaces that come near each other.

    Attributes:
        touching: pairs that are seen to touch, ``(n,)``.
        entry: the entry of each leaf that comes near, ascending, ``(k,)``; none of pairs that touch.
        leaf: the node of the forest, ``(k,)``.
        centre: the middle of the box around the leaf's image in the frame of the other solid, ``(3, k)``.
        reach: half that box's extents, ``(3, k)``.

    """

    touching: Booleans
    entry: Indices
    leaf: Indices
    centre: Floats
    reach: Floats

    def leaves(self) -> tuple[Groups, Groups]:
        """Return the ranges of leaves of the first solid of each pair, and of the second."""
        count = len(self.touching)
        starts = group_starts(self.entry, 2 * count)
        starts, counts = starts[:-1], np.diff(starts)
        return Groups(starts[:count], counts[:count]), Groups(starts[count:], counts[count:])


class Fronts:
    """Several unit meshes, made ready for that; entries name them by their numbers."""

    def __init__(self, forest: Forest, proofs: ProofTable) -> None:
        self._forest = forest
        self._proofs = proofs
        self._first, self._counts = forest.level(_LEVEL)

    def find(self, moving: Indices, still: Indices, maps: AffineMaps) -> Front:
        """The leaves of surfaces that reach into cells of solids.

        Args:
            moving: mesh numbers of the surfaces, ``(2 n,)``: those of the first solids of n pairs, then of the second ones.
            still: mesh numbers of the solids, ``(2 n,)``: the others of the pairs.
            maps: from the unit frames of the surfaces into those of the solids.

        """
        forest, proofs = self._forest, self._proofs
        pairs = len(moving) // 2
        touching = np.zeros(pairs, dtype=np.bool_)
        leaves: list[tuple[Indices, Indices, Floats, Floats]] = []
        entry, offset = expand(self._counts[moving])
        node = self._first[moving][entry] + offset
        while len(entry):
            map_, there = maps.take(entry), still[entry]
            corner = map_.columns(taken(forest.corners[0], forest.face[node]))
            touching[entry[proofs.in_solid(there, corner)] % pairs] = True
            centre, reach = map_.columns(taken(forest.middle, node)), map_.reaches(taken(forest.half, node))
            left = np.flatnonzero(proofs.near_filled(there, centre, reach) & ~touching[entry % pairs])
            inner = forest.child[node[left]] >= 0
            ends, left = left[~inner], left[inner]
            leaves.append((entry[ends], node[ends], centre.take(ends, axis=1), reach.take(ends, axis=1)))
            entry, node = entry[left], node[left]
            for _ in range(_STEP):
                entry, node = forest.parts(entry, node)
        entry, leaf, centre, reach = (np.concatenate(parts, axis=-1) for parts in zip(*leaves, strict=True))
        order = np.argsort(entry, kind="stable")
        order = order[~touching[entry[order] % pairs]]
        return Front(
            touching, entry[order], leaf[order], centre.take(order, axis=1), reach.take(order, axis=1)
        )
