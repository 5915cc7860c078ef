"""The cells of a regular grid over the unit cube that the faces of a unit mesh touch."""

from collections.abc import Iterator
from typing import Final

import numpy as np

from scenic.runtime.geometry.poses import Floats, Indices
from scenic.runtime.geometry.ragged import expand, pieces
from scenic.runtime.geometry.vectors import dot

_CHUNK: Final = 1 << 18
"""Pairs of face and cell looked at together."""

_FINER: Final = 4
"""Cells on each axis of a coarse cell."""

PADDING: Final = 1e-9
"""By how much cells are widened on every side: far more than the rounding of coordinates in the unit cube."""


def cell_of(points: Floats, resolution: int) -> Indices:
    """The cell of each point ``(..., 3)`` on each axis, clipped to the grid."""
    return np.clip(np.floor((points + 0.5) * resolution).astype(np.intp), 0, resolution - 1)


def touched_cells(triangles: Floats, resolution: int) -> Iterator[tuple[Indices, Indices]]:
    """Pairs (face, cell) that touch, in groups; cells are numbered ``(x * resolution + y) * resolution + z``.

    A cell touching a face by less than `PADDING` counts, so a cell that no pair names is free of the surface.
    The test is the one of Schwarz and Seidel ("Fast parallel surface and solid voxelization on GPUs", ACM
    TOG 29(6), 2010): the cell meets the plane of the face, and the three projections of both overlap.

    Args:
        triangles: ``(f, 3, 3)``, in the unit cube.
        resolution: cells per axis.

    """
    # Written out, since reductions over short axes are slow.
    lowest = np.minimum(np.minimum(triangles[:, 0], triangles[:, 1]), triangles[:, 2])
    highest = np.maximum(np.maximum(triangles[:, 0], triangles[:, 1]), triangles[:, 2])
    first = cell_of(lowest - PADDING, resolution)
    counts = cell_of(highest + PADDING, resolution) - first + 1
    total = counts[:, 0] * counts[:, 1] * counts[:, 2]
    alone = np.flatnonzero(total == 1)  # the face's bounding box is in one cell: nothing to test
    yield alone, _number(first[alone], resolution)
    spread = np.flatnonzero(total > 1)
    if resolution % _FINER == 0 and resolution >= _FINER * _FINER:
        # Large faces are first looked for in coarse cells, each of which holds many of the cells wanted.
        large = np.flatnonzero(total > _FINER**3)
        spread = np.flatnonzero((total > 1) & (total <= _FINER**3))
        for face, coarse in touched_cells(triangles[large], resolution // _FINER):
            for part in pieces(np.full(len(face), _FINER**3), _CHUNK):
                owner, index = _cells_within(coarse[part], resolution)
                faces = large[face[part]]
                touching = _touching(triangles[faces], owner, index, resolution)
                yield faces[owner[touching]], _number(index[touching], resolution)
    for part in pieces(total[spread], _CHUNK):
        faces = spread[part]
        owner, offset = expand(total[faces])
        ny, nz = counts[faces[owner], 1], counts[faces[owner], 2]
        steps = np.stack([offset // (ny * nz), offset // nz % ny, offset % nz], axis=1)
        index = first[faces[owner]] + steps
        touching = _touching(triangles[faces], owner, index, resolution)
        yield faces[owner[touching]], _number(index[touching], resolution)


def _cells_within(coarse: Indices, resolution: int) -> tuple[Indices, Indices]:
    """Return the cells in each of some coarse ones: which coarse one, and the index ``(k, 3)`` of the cell."""
    size = resolution // _FINER
    corner = np.stack([coarse // (size * size), coarse // size % size, coarse % size], axis=1) * _FINER
    steps = np.stack(np.unravel_index(np.arange(_FINER**3), (_FINER,) * 3), axis=1)
    index = (corner[:, None] + steps).reshape(-1, 3)
    return np.repeat(np.arange(len(coarse)), _FINER**3), index


def _number(index: Indices, resolution: int) -> Indices:
    result: Indices = (index[:, 0] * resolution + index[:, 1]) * resolution + index[:, 2]
    return result


def _touching(triangles: Floats, face: Indices, index: Indices, resolution: int) -> Indices:
    """Return the indices of the cells ``(k, 3)`` that touch their faces; ``face`` ``(k,)`` numbers rows of ``triangles``."""
    half = 0.5 / resolution + PADDING
    edges = np.roll(triangles, -1, axis=1) - triangles
    normals = np.cross(edges[:, 0], edges[:, 1])
    reach = half * (np.abs(normals[:, 0]) + np.abs(normals[:, 1]) + np.abs(normals[:, 2]))
    centre = (index + 0.5) / resolution - 0.5
    from_corner = centre - triangles[face, 0]
    near = np.flatnonzero(np.abs(dot(normals[face], from_corner)) <= reach[face])
    return near[_projections_overlap(triangles, edges, face[near], centre[near], half)]


def _projections_overlap(
    triangles: Floats, edges: Floats, face: Indices, centre: Floats, half: float
) -> np.ndarray[tuple[int], np.dtype[np.bool_]]:
    """Return whether no edge line of the face separates it from the cell, in any of the three coordinate planes."""
    result = np.ones(len(face), dtype=np.bool_)
    for u, v in ((0, 1), (1, 2), (2, 0)):
        for i in range(3):
            # The edge's normal in the plane, turned to the side of the opposite corner.
            nu, nv = -edges[:, i, v], edges[:, i, u]
            opposite = triangles[:, (i + 2) % 3] - triangles[:, i]
            side = nu * opposite[:, u] + nv * opposite[:, v]
            sign = np.where(side < 0, -1.0, 1.0)
            slack = half * (np.abs(nu) + np.abs(nv))
            flat = side == 0  # seen edge-on: the line of the edge bounds nothing on one side
            origin = triangles[:, i]
            distance = (nu * sign)[face] * (centre[:, u] - origin[face, u]) + (nv * sign)[face] * (
                centre[:, v] - origin[face, v]
            )
            distance = np.where(flat[face], -np.abs(distance), distance)
            result &= distance >= -slack[face]
    return result
