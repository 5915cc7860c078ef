"""The parts of two surfaces that come near each other's solids, found by the trees of faces and the cells of `voxels`.

A face whose box lies in empty cells of the other solid touches nothing, and one with a corner in a solid cell
settles that both touch. Boxes are cut in parts where neither is seen, so that the cost grows with how much of the
surfaces is near, not with their product.
"""

from typing import Final, NamedTuple

import numpy as np

from scenic.runtime.geometry.affine import AffineMaps, taken
from scenic.runtime.geometry.facetree import Forest
from scenic.runtime.geometry.poses import Booleans, Indices
from scenic.runtime.geometry.proofs import ProofTable
from scenic.runtime.geometry.ragged import expand

_LEVEL: Final = 4
"""Where the search begins: of the boxes above, one nearly always comes near."""


class Front(NamedTuple):
    """What comes near.

    Attributes:
        touching: entries that are seen to touch, ``(n,)``.
        entry: the entry of each leaf that comes near, ascending, ``(k,)``; none of entries that touch.
        leaf: the node of the forest, ``(k,)``.

    """

    touching: Booleans
    entry: Indices
    leaf: Indices


class Fronts:
    """Several unit meshes, made ready for that; entries name them by their numbers."""

    def __init__(self, forest: Forest, proofs: ProofTable) -> None:
        self._forest = forest
        self._proofs = proofs
        self._first, self._counts = forest.level(_LEVEL)

    def find(self, moving: Indices, still: Indices, maps: AffineMaps) -> Front:
        """The leaves of surfaces that reach into cells of solids.

        Args:
            moving: mesh numbers of the surfaces, ``(n,)``.
            still: mesh numbers of the solids, ``(n,)``.
            maps: from the unit frames of the surfaces into those of the solids.

        """
        forest, proofs = self._forest, self._proofs
        touching = np.zeros(len(moving), dtype=np.bool_)
        entries, leaves = [], []
        entry, offset = expand(self._counts[moving])
        node = self._first[moving][entry] + offset
        while len(entry):
            map_, there = maps.take(entry), still[entry]
            corner = map_.columns(taken(forest.corners[0], forest.face[node]))
            touching[entry[proofs.in_solid(there, corner)]] = True
            centre, reach = map_.columns(taken(forest.middle, node)), map_.reaches(taken(forest.half, node))
            left = np.flatnonzero(proofs.near_filled(there, centre, reach) & ~touching[entry])
            entry, node = entry[left], node[left]
            inner = forest.child[node] >= 0
            entries.append(entry[~inner])
            leaves.append(node[~inner])
            entry, node = forest.parts(*forest.parts(entry[inner], node[inner]))
        entry, leaf = np.concatenate(entries), np.concatenate(leaves)
        order = np.argsort(entry, kind="stable")
        order = order[~touching[entry[order]]]
        return Front(touching, entry[order], leaf[order])
