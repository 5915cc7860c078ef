"""Proofs that posed solids touch or do not, from the cells of `voxels` alone, for mixed meshes at once.

The tables of all meshes lie side by side, so that entries of different meshes are looked at together.
"""

from collections.abc import Sequence
from typing import Any, Final

import numpy as np
import numpy.typing as npt

from scenic.runtime.geometry.affine import AffineMaps
from scenic.runtime.geometry.meshes.cells import PADDING
from scenic.runtime.geometry.meshes.mesh import Mesh
from scenic.runtime.geometry.meshes.voxels import COVER_BOXES, RESOLUTION, voxels
from scenic.runtime.geometry.poses import Booleans, Floats, Indices

_STEP: Final = RESOLUTION + 1
_WEIGHTS: Final = np.array([[_STEP**2], [_STEP], [1]])
"""Change of the index into the table of counts for one step along each axis."""


class ProofTable:
    """Facts about the cells of several closed unit meshes; entries name meshes by their number."""

    def __init__(self, meshes: Sequence[Mesh]) -> None:
        known = [mesh.derived(voxels) for mesh in meshes]
        self._solid = _in_line([item.solid for item in known])
        self._filled = _in_line([item.filled for item in known])
        # Indexed by coordinate, member and mesh; meshes with fewer members repeat their first.
        self._probes = np.stack([item.probes.T for item in known], axis=-1)
        cover = [_padded(item.cover, COVER_BOXES) for item in known]
        self._middle = np.stack([boxes.mean(axis=1).T for boxes in cover], axis=-1)
        self._half = np.stack([(boxes[:, 1] - boxes[:, 0]).T / 2 for boxes in cover], axis=-1)

    def contact(self, moving: Indices, still: Indices, maps: AffineMaps, points: slice) -> Booleans:
        """Return whether one of the probing ``points`` of a moving mesh lies in a solid cell of a still one, ``(n,)``.

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
        """Return whether all boxes that cover a moving mesh lie in empty cells of a still one, ``(n,)``."""
        centre = maps.columns(_gathered(self._middle, moving))
        reach = maps.reaches(_gathered(self._half, moving))
        near: Booleans = np.logical_or.reduce(self.near_filled(still, centre, reach), axis=0)
        return ~near

    def in_solid(self, still: Indices, points: Floats) -> Booleans:
        """Return whether points ``(3, ..., n)`` in the frames of still meshes ``(n,)`` lie in solid cells, ``(..., n)``."""
        where = np.flatnonzero(_all_axes(np.abs(points) <= 0.5))
        cell = ((points.reshape(3, -1).take(where, axis=1) + 0.5) * RESOLUTION).astype(np.intp)
        x, y, z = np.minimum(cell, RESOLUTION - 1, out=cell)
        index = ((still[where % len(still)] * RESOLUTION + x) * RESOLUTION + y) * RESOLUTION + z
        return _scattered(self._solid[index], where, points.shape[1:])

    def near_filled(self, still: Indices, centre: Floats, reach: Floats) -> Booleans:
        """Return whether boxes reach into cells of still meshes that are not empty, ``(..., n)``.

        Args:
            still: mesh numbers, ``(n,)``.
            centre: the boxes' centres in the frames of the still meshes, ``(3, ..., n)``.
            reach: half the boxes' extents, likewise.

        """
        where = np.flatnonzero(_all_axes(np.abs(centre) <= reach + (0.5 + PADDING)))
        middle, half = (part.reshape(3, -1).take(where, axis=1) for part in (centre, reach))
        middle += 0.5
        half += PADDING
        # Cells before the first and behind the last count as those. Indexed by end, axis and box.
        ends = np.stack([middle - half, middle + half])
        ends *= RESOLUTION
        np.maximum(ends, 0, out=ends)
        np.minimum(ends, RESOLUTION - 1, out=ends)
        cells = ends.astype(np.intp)
        cells[1] += 1
        x, y, z = (cells * _WEIGHTS).transpose(1, 0, 2)
        index = x[:, np.newaxis, np.newaxis] + (y[:, np.newaxis] + (z + still[where % len(still)] * _STEP**3))
        counts = self._filled[index]
        for _ in range(3):
            counts = counts[1] - counts[0]
        return _scattered(counts > 0, where, centre.shape[1:])


def _in_line(tables: Sequence[npt.NDArray[Any]]) -> npt.NDArray[Any]:
    """Return the elements of tables, one table after the other. One alone is not copied: it is large."""
    flat = [table.ravel() for table in tables]
    return flat[0] if len(flat) == 1 else np.concatenate(flat)


def _all_axes(each: Booleans) -> Booleans:
    x, y, z = each
    result: Booleans = x & y & z
    return result


def _scattered(values: Booleans, where: Indices, shape: tuple[int, ...]) -> Booleans:
    """The values at these places, in C order, of an array of that shape that is false elsewhere."""
    result = np.zeros(shape, dtype=np.bool_)
    result.ravel()[where] = values
    return result


def _padded(items: Floats, length: int) -> Floats:
    """Return the first ``length`` items; repeats the first one if there are fewer."""
    return np.concatenate([items, np.repeat(items[:1], max(length - len(items), 0), axis=0)])[:length]


def _gathered(table: Floats, numbers: Indices) -> Floats:
    """Return the coordinates ``(3, k, n)`` of the members of each entry's mesh."""
    return table.take(numbers, axis=2)
