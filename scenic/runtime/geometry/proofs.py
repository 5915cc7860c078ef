"""Proofs that posed solids touch or do not, from the cells of `voxels` alone, for mixed meshes at once.

The tables of all meshes lie side by side, so that entries of different meshes are looked at together.
"""

from collections.abc import Sequence
from typing import Final

import numpy as np

from scenic.runtime.geometry.affine import AffineMaps, Columns
from scenic.runtime.geometry.cells import PADDING
from scenic.runtime.geometry.mesh import Mesh
from scenic.runtime.geometry.poses import Booleans, Floats, Indices
from scenic.runtime.geometry.voxels import COVER_BOXES, RESOLUTION, voxels

_STEP: Final = RESOLUTION + 1


class ProofTable:
    """What is known of the cells of several closed unit meshes; entries name meshes by their number."""

    def __init__(self, meshes: Sequence[Mesh]) -> None:
        known = [mesh.derived(voxels) for mesh in meshes]
        self._solid = np.concatenate([item.solid.ravel() for item in known])
        self._filled = np.concatenate([item.filled.ravel() for item in known])
        # Indexed by coordinate, member and mesh; meshes with fewer members repeat their first.
        self._probes = np.stack([item.probes.T for item in known], axis=-1)
        cover = [_padded(item.cover, COVER_BOXES) for item in known]
        self._middle = np.stack([boxes.mean(axis=1).T for boxes in cover], axis=-1)
        self._half = np.stack([(boxes[:, 1] - boxes[:, 0]).T / 2 for boxes in cover], axis=-1)

    def contact(self, moving: Indices, still: Indices, maps: AffineMaps, points: slice) -> Booleans:
        """Whether one of the probing ``points`` of a moving mesh lies in a solid cell of a still one, ``(n,)``.

        Args:
            moving: mesh numbers, ``(n,)``.
            still: mesh numbers, ``(n,)``.
            maps: from the unit frames of the moving meshes into those of the still ones.
            points: which of the probes; the deepest come first, those on the surface last.

        """
        x, y, z = maps.columns(_gathered(self._probes[:, points], moving))
        near = (np.abs(x) <= 0.5) & (np.abs(y) <= 0.5) & (np.abs(z) <= 0.5)
        where = np.flatnonzero(near)
        result = np.zeros(len(moving), dtype=np.bool_)
        entry = where % len(moving)
        index = still[entry]
        for part in (x, y, z):
            cell = ((part.ravel()[where] + 0.5) * RESOLUTION).astype(np.intp)
            index = index * RESOLUTION + np.minimum(cell, RESOLUTION - 1)
        result[entry[self._solid[index]]] = True
        return result

    def distance(self, moving: Indices, still: Indices, maps: AffineMaps) -> Booleans:
        """Whether all boxes that cover a moving mesh lie in empty cells of a still one, ``(n,)``."""
        centre = maps.columns(_gathered(self._middle, moving))
        reach = maps.reaches(_gathered(self._half, moving))
        near = np.ones(centre[0].shape, dtype=np.bool_)
        for axis in range(3):
            near &= np.abs(centre[axis]) <= reach[axis] + (0.5 + PADDING)
        where = np.flatnonzero(near)
        entry = where % len(moving)
        low, high = [], []
        for axis in range(3):
            middle, half = centre[axis].ravel()[where], reach[axis].ravel()[where] + PADDING
            weight = _STEP ** (2 - axis)
            # Cells before the first and behind the last count as those.
            below = np.clip((middle - half + 0.5) * RESOLUTION, 0, RESOLUTION - 1)
            above = np.clip((middle + half + 0.5) * RESOLUTION, 0, RESOLUTION - 1)
            low.append(below.astype(np.intp) * weight)
            high.append((above.astype(np.intp) + 1) * weight)
        base = still[entry] * _STEP**3
        count = np.zeros(len(where), dtype=np.int32)
        for corner in np.ndindex(2, 2, 2):
            x, y, z = ((high if top else low)[axis] for axis, top in enumerate(corner))
            value = self._filled[base + x + y + z]
            count += value if sum(corner) % 2 else -value
        result = np.ones(len(moving), dtype=np.bool_)
        result[entry[count > 0]] = False
        return result


def _padded(items: Floats, length: int) -> Floats:
    """The first ``length`` items; repeats the first one if there are fewer."""
    return np.concatenate([items, np.repeat(items[:1], max(length - len(items), 0), axis=0)])[:length]


def _gathered(table: Floats, numbers: Indices) -> Columns:
    """The coordinates, each ``(k, n)``, of the members of each entry's mesh."""
    return table[0][:, numbers], table[1][:, numbers], table[2][:, numbers]
