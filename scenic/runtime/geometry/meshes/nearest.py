"""The nearest points of many triangles or segments, by a tree of boxes and in double precision.

Segments are triangles that have collapsed, so that surfaces and lines share one index.
"""

from typing import Final, NamedTuple

import numpy as np
import numpy.typing as npt

from scenic.runtime.geometry.meshes.facetree import FaceTree, face_tree, tree_of
from scenic.runtime.geometry.meshes.mesh import Mesh
from scenic.runtime.geometry.poses import Floats, Indices
from scenic.runtime.geometry.ragged import expand, first_of_each
from scenic.runtime.geometry.vectors import cross, dot, length

_FRONT: Final = 1 << 15
"""Pairs of point and box looked at together."""


class NearestPoints(NamedTuple):
    """The nearest point of each query.

    Attributes:
        distance: ``(n,)``, metres.
        point: where it is, ``(n, 3)``.
        number: of the triangle or segment that it belongs to, ``(n,)``; -1 where nothing was found.

    """

    distance: Floats
    point: Floats
    number: Indices


class Nearest:
    """An index of triangles ``(f, 3, 3)``, at least one."""

    def __init__(self, triangles: npt.ArrayLike, *, tree: FaceTree | None = None) -> None:
        self._corners: Final = np.asarray(triangles, dtype=np.float64)
        self._tree: Final = tree_of(self._corners) if tree is None else tree
        self._inner: Final = len(self._tree.starts) - 2

    def find(self, points: Floats, scale: Floats | None = None, *, within: float = np.inf) -> NearestPoints:
        """The nearest points of all that is indexed.

        Args:
            points: where to look from, ``(n, 3)``.
            scale: factors ``(n | 1, 3)`` by which all that is indexed is stretched first.
            within: metres; points that are farther than this from everything are only known to be (infinitely far).

        """
        count = len(points)
        size = np.ones((count, 3)) if scale is None else np.broadcast_to(scale, (count, 3))
        if np.isfinite(within):
            # What is just as far counts, so a little more is looked at; the distances found are exact.
            square_distance = np.full(count, np.nextafter((within * (1 + 1e-9)) ** 2, np.inf))
            nearest, number = np.zeros((count, 3)), np.full(count, -1, dtype=np.intp)
        else:
            square_distance, nearest, number = self._dive(points, size)
        fronts = [(np.arange(count), np.zeros(count, dtype=np.intp))]
        while fronts:
            entry, node = fronts.pop()
            if len(entry) > _FRONT:
                half = len(entry) // 2
                fronts.append((entry[half:], node[half:]))
                entry, node = entry[:half], node[:half]
            near = self._gap(points[entry], size[entry], node) < square_distance[entry]
            entry, node = entry[near], node[near]
            leaves = node >= self._inner
            if leaves.any():
                self._improve(points, size, entry[leaves], node[leaves], square_distance, nearest, number)
                entry, node = entry[~leaves], node[~leaves]
            if len(entry):
                fronts.append((np.repeat(entry, 2), np.stack([2 * node + 1, 2 * node + 2], axis=1).ravel()))
        return NearestPoints(np.where(number < 0, np.inf, length(points - nearest)), nearest, number)

    def _dive(self, points: Floats, size: Floats) -> tuple[Floats, Floats, Indices]:
        """Squared distances, nearest points and numbers in the leaf that is reached by always taking the nearer box."""
        node = np.zeros(len(points), dtype=np.intp)
        while True:
            go_on = np.flatnonzero(node < self._inner)
            if not len(go_on):
                break
            left, right = 2 * node[go_on] + 1, 2 * node[go_on] + 2
            near, far = (self._gap(points[go_on], size[go_on], side) for side in (left, right))
            node[go_on] = np.where(near <= far, left, right)
        square_distance = np.full(len(points), np.inf)
        nearest, number = np.zeros((len(points), 3)), np.zeros(len(points), dtype=np.intp)
        self._improve(points, size, np.arange(len(points)), node, square_distance, nearest, number)
        return square_distance, nearest, number

    def _gap(self, points: Floats, size: Floats, node: Indices) -> Floats:
        """The squared distances of points from boxes."""
        middle, half = self._tree.middle.take(node, axis=1), self._tree.half.take(node, axis=1)
        total = np.zeros(len(node))
        for axis in range(3):
            beside = np.abs(points[:, axis] - size[:, axis] * middle[axis]) - size[:, axis] * half[axis]
            beside = np.maximum(beside, 0.0)
            total += beside * beside
        return total

    def _improve(
        self,
        points: Floats,
        size: Floats,
        entry: Indices,
        node: Indices,
        squared: Floats,
        nearest: Floats,
        number: Indices,
    ) -> None:
        """Put in what the triangles of leaves offer, where it is nearer."""
        leaf = node - self._inner
        owner, offset = expand(self._tree.starts[leaf + 1] - self._tree.starts[leaf])
        face = self._tree.faces[self._tree.starts[leaf][owner] + offset]
        query = entry[owner]
        corners = [self._corners[face, corner] * size[query] for corner in range(3)]
        candidates = nearest_on_triangles(points[query], *corners)
        gap = points[query] - candidates
        distance = dot(gap, gap)
        order = np.lexsort((face, distance, query))
        improvements = order[first_of_each(query[order])]
        improvements = improvements[distance[improvements] < squared[query[improvements]]]
        query = query[improvements]
        squared[query] = distance[improvements]
        nearest[query] = candidates[improvements]
        number[query] = face[improvements]


def nearest_of(mesh: Mesh) -> Nearest:
    """Return the index of a mesh. Get it as ``mesh.derived(nearest_of)``."""
    return Nearest(mesh.triangles, tree=mesh.derived(face_tree))


def nearest_on_triangles(points: Floats, a: Floats, b: Floats, c: Floats) -> Floats:
    """The points ``(m, 3)`` of triangles with corners ``(m, 3)`` each that are nearest to points ``(m, 3)``."""
    ab, ac = b - a, c - a
    normal = cross(ab, ac)
    square = dot(normal, normal)
    proper = square > 0
    inside = proper.copy()
    for first, second in ((a, b), (b, c), (c, a)):
        inside &= dot(cross(second - first, points - first), normal) >= 0
    height = dot(normal, points - a) / np.where(proper, square, 1.0)
    result = points - height[:, None] * normal
    outside = np.flatnonzero(~inside)
    if len(outside):
        p = points[outside]
        best = np.full(len(outside), np.inf)
        nearest_on_edges = np.zeros((len(outside), 3))
        for first, second in ((a, b), (b, c), (c, a)):
            on_edge = _nearest_on_segments(p, first[outside], second[outside])
            gap = p - on_edge
            distance = dot(gap, gap)
            closer = distance < best
            best = np.where(closer, distance, best)
            nearest_on_edges = np.where(closer[:, None], on_edge, nearest_on_edges)
        result[outside] = nearest_on_edges
    return result


def _nearest_on_segments(points: Floats, start: Floats, end: Floats) -> Floats:
    along = end - start
    square = dot(along, along)
    part = np.clip(dot(points - start, along) / np.where(square > 0, square, 1.0), 0.0, 1.0)
    return start + part[:, None] * along
