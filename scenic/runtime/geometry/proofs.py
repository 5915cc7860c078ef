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
        inside = self.in_solid(still, maps.columns(_gathered(self._probes[:, points], moving)))
        result: Booleans = np.logical_or.reduce(inside, axis=0)
        return result

    def distance(self, moving: Indices, still: Indices, maps: AffineMaps) -> Booleans:
        """Whether all boxes that cover a moving mesh lie in empty cells of a still one, ``(n,)``."""
        centre = maps.columns(_gathered(self._middle, moving))
        reach = maps.reaches(_gathered(self._half, moving))
        near: Booleans = np.logical_or.reduce(self.near_filled(still, centre, reach), axis=0)
        return ~near

    def in_solid(self, still: Indices, points: Columns) -> Booleans:
        """Whether points, of coordinates ``(..., n)`` in the frames of still meshes ``(n,)``, lie in solid cells."""
        x, y, z = points
        near = (np.abs(x) <= 0.5) & (np.abs(y) <= 0.5) & (np.abs(z) <= 0.5)
        where = np.flatnonzero(near)
        index = still[where % len(still)] if near.ndim > 1 else still[where]
        for part in points:
            cell = ((part.ravel()[where] + 0.5) * RESOLUTION).astype(np.intp)
            index = index * RESOLUTION + np.minimum(cell, RESOLUTION - 1)
        return _scattered(self._solid[index], where, near.shape)

    def near_filled(self, still: Indices, centre: Columns, reach: Columns) -> Booleans:
        """Whether boxes reach into cells of still meshes that are not empty.

        Args:
            still: mesh numbers, ``(n,)``.
            centre: the boxes' centres, of coordinates ``(..., n)``, in the frames of the still meshes.
            reach: half the boxes' extents, likewise.

        """
        near: Booleans = np.abs(centre[0]) <= reach[0] + (0.5 + PADDING)
        for axis in (1, 2):
            near &= np.abs(centre[axis]) <= reach[axis] + (0.5 + PADDING)
        where = np.flatnonzero(near)
        low, high = [], []
        for axis in range(3):
            middle, half = centre[axis].ravel()[where], reach[axis].ravel()[where] + PADDING
            weight = _STEP ** (2 - axis)
            # Cells before the first and behind the last count as those.
            below = np.clip((middle - half + 0.5) * RESOLUTION, 0, RESOLUTION - 1)
            above = np.clip((middle + half + 0.5) * RESOLUTION, 0, RESOLUTION - 1)
            low.append(below.astype(np.intp) * weight)
            high.append((above.astype(np.intp) + 1) * weight)
        owner = still[where % len(still)] if near.ndim > 1 else still[where]
        base = owner * _STEP**3
        count = np.zeros(len(where), dtype=np.int32)
        for corner in np.ndindex(2, 2, 2):
            x, y, z = ((high if top else low)[axis] for axis, top in enumerate(corner))
            value = self._filled[base + x + y + z]
            count += value if sum(corner) % 2 else -value
        return _scattered(count > 0, where, near.shape)


def _scattered(values: Booleans, where: Indices, shape: tuple[int, ...]) -> Booleans:
    """The values at these places, in C order, of an array of that shape that is false elsewhere."""
    result = np.zeros(shape, dtype=np.bool_)
    result.ravel()[where] = values
    return result


def _padded(items: Floats, length: int) -> Floats:
    """The first ``length`` items; repeats the first one if there are fewer."""
    return np.concatenate([items, np.repeat(items[:1], max(length - len(items), 0), axis=0)])[:length]


def _gathered(table: Floats, numbers: Indices) -> Columns:
    """The coordinates, each ``(k, n)``, of the members of each entry's mesh."""
    return table[0][:, numbers], table[1][:, numbers], table[2][:, numbers]
