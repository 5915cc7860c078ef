"""Connections of the triangles of a mesh: edges, components, closedness."""

import numpy as np

from scenic.dataclass import dataclass
from scenic.runtime.geometry.poses import Floats, Indices
from scenic.runtime.geometry.ragged import distinct, first_of_each


@dataclass(frozen=True, slots=True)
class EdgeCensus:
    """Counts of the edges of a mesh, which decide whether it bounds a solid.

    Attributes:
        open_edges: edges with a face on one side only (an odd number of faces).
        inconsistent_edges: edges whose faces do not pair up in opposite directions.

    """

    open_edges: int
    inconsistent_edges: int

    @property
    def is_closed(self) -> bool:
        """Return whether the faces form closed surfaces with consistent winding."""
        return self.open_edges == 0 and self.inconsistent_edges == 0


def edge_census(faces: Indices) -> EdgeCensus:
    """Count the edges of ``faces`` ``(f, 3)`` that keep them from bounding a solid."""
    start = faces.ravel()
    end = faces[:, [1, 2, 0]].ravel()
    count = int(faces.max(initial=0)) + 1
    forward = start < end
    key = np.where(forward, start, end) * count + np.where(forward, end, start)
    order = np.argsort(key, kind="stable")
    key, sign = key[order], np.where(forward[order], 1, -1)
    first = np.flatnonzero(np.diff(key, prepend=-1))
    uses = np.diff(first, append=len(key))
    balance = np.add.reduceat(sign, first) if len(first) else np.zeros(0, dtype=np.intp)
    odd = uses % 2 == 1
    return EdgeCensus(int(odd.sum()), int((~odd & (balance != 0)).sum()))


def face_components(faces: Indices, count: int) -> Indices:
    """Return the component ``(f,)``, numbered from 0, of each face of ``(f, 3)`` over ``count`` vertices.

    Faces that share a vertex belong together.
    """
    label = np.arange(count)
    edges = np.concatenate([faces[:, [0, 1]], faces[:, [1, 2]]])
    while len(edges):
        # Each root takes the smallest root beside it; then all point at their roots. Halves the edges or better.
        start, end = label[edges].T
        np.minimum.at(label, np.maximum(start, end), np.minimum(start, end))
        while (label[label] != label).any():
            label = label[label]
        edges = edges[label[edges[:, 0]] != label[edges[:, 1]]]
    roots = label[faces[:, 0]]
    return np.searchsorted(distinct(roots), roots)


def without_unused(vertices: Floats, faces: Indices) -> tuple[Floats, Indices]:
    """Return the mesh with the vertices alone that faces use, in their order."""
    used = distinct(faces)
    return vertices[used], np.searchsorted(used, faces)


def merge_vertices(vertices: Floats, faces: Indices, *, tolerance: float = 0.0) -> tuple[Floats, Indices]:
    """Return the mesh with equal vertices made one, unused vertices and collapsed faces dropped.

    With a positive ``tolerance`` in metres, vertices connected by steps of at most that length are equal; the
    first of them stays.
    """
    is_used = np.zeros(len(vertices), dtype=np.bool_)
    is_used[faces] = True
    corner_numbers = np.flatnonzero(is_used)
    points = vertices[corner_numbers] + 0.0  # turns -0.0 into 0.0, so that the two are equal
    group = _close_groups(points, tolerance) if tolerance > 0 else _equal_groups(points)
    # Groups in the order of their first vertices in the file.
    first = first_of_each(group)
    rank = np.argsort(np.argsort(first))
    group = np.searchsorted(distinct(group), group)
    target = np.zeros(len(vertices), dtype=np.intp)
    target[corner_numbers] = rank[group]
    new_faces = target[faces]
    a, b, c = new_faces.T
    proper = (a != b) & (b != c) & (a != c)
    return points[np.sort(first)], new_faces[proper]


def _equal_groups(points: Floats) -> Indices:
    order = np.lexsort(points.T)
    ordered = points[order]
    new = np.ones(len(order), dtype=np.bool_)
    new[1:] = (ordered[1:] != ordered[:-1]).any(axis=1)
    group = np.empty(len(order), dtype=np.intp)
    group[order] = np.cumsum(new) - 1
    return group


def _close_groups(points: Floats, tolerance: float) -> Indices:
    from scipy.sparse import coo_array
    from scipy.sparse.csgraph import connected_components
    from scipy.spatial import cKDTree

    pairs = cKDTree(points).query_pairs(tolerance, output_type="ndarray")
    near = coo_array(
        (np.ones(len(pairs), dtype=np.int8), (pairs[:, 0], pairs[:, 1])), shape=(len(points),) * 2
    )
    return connected_components(near, directed=False)[1].astype(np.intp)


def signed_volume(vertices: Floats, faces: Indices) -> float:
    """Return the volume enclosed by closed faces; negative where their normals point inwards."""
    centred = vertices - (vertices.min(axis=0) + vertices.max(axis=0)) / 2
    a, b, c = (centred[faces[:, i]] for i in range(3))
    return float(np.sum(a * np.cross(b, c)) / 6)
