"""The faces of unit meshes in trees of boxes, and the pairs of faces of two posed meshes that may meet.

Trees are made once for each mesh, in its unit frame, and serve every size and pose: boxes of one mesh are taken
into the frame of the other by the affine map between the two, both ways. Many pairs of meshes are walked through
together, level by level, so that the cost of a step is shared by all of them.
"""

from collections.abc import Iterator, Sequence
from typing import Final

import numpy as np

from scenic.dataclass import dataclass
from scenic.runtime.geometry.affine import AffineMaps, taken
from scenic.runtime.geometry.meshes.mesh import Mesh
from scenic.runtime.geometry.poses import Booleans, Floats, Indices
from scenic.runtime.geometry.ragged import expand
from scenic.runtime.geometry.store import kept

_PADDING: Final = 1e-9
"""By how much boxes are widened, in the unit frame: far more than the rounding of coordinates."""

_KIND: Final = "face tree 1"
"""Names what is kept of a mesh."""

_LARGE: Final = 2000
"""Faces above which the order of the leaves is kept on disk."""

_FRONT: Final = 1 << 14
"""Pairs of boxes compared together, so that the temporary columns stay in the processor's cache."""

_SMALL: Final = 1 << 11
"""Pairs up to which both trees are descended two levels at once: then steps cost more than comparisons."""


@dataclass(frozen=True, slots=True)
class FaceTree:
    """A complete binary tree over the faces of a mesh, in heap order.

    Attributes:
        middle: the centres of the boxes, ``(3, nodes)``.
        half: half their extents, a little widened (by enough for unit meshes), ``(3, nodes)``.
        starts: where the faces of each leaf begin in ``faces``, ``(leaves + 1,)``.
        faces: face numbers, leaf by leaf; one or two to a leaf.

    """

    middle: Floats
    half: Floats
    starts: Indices
    faces: Indices


def face_tree(mesh: Mesh) -> FaceTree:
    """Return the tree of a mesh. Get it as ``mesh.derived(face_tree)``."""
    lowest, highest = _boxes(mesh.derived(face_corners))
    if len(mesh.faces) < _LARGE:
        return _boxed(lowest, highest, _sorted(lowest, highest))
    found = kept(_KIND, mesh.digest, lambda: {"faces": _sorted(lowest, highest)})
    return _boxed(lowest, highest, found["faces"])


def tree_of(triangles: Floats) -> FaceTree:
    """Return the tree of triangles ``(f, 3, 3)``, at least one; they may have collapsed to segments or points."""
    lowest, highest = _boxes(np.ascontiguousarray(triangles.transpose(1, 2, 0)))
    return _boxed(lowest, highest, _sorted(lowest, highest))


def face_corners(mesh: Mesh) -> Floats:
    """Return the three corners of all faces, ``(3, 3, f)`` by corner and coordinate. Get them as ``mesh.derived(face_corners)``."""
    vertices = np.ascontiguousarray(mesh.vertices.T)
    return np.stack([vertices.take(mesh.faces[:, number], axis=1) for number in range(3)])


def _boxes(corners: Floats) -> tuple[Floats, Floats]:
    """Return the lowest and the highest corners ``(3, f)`` of the boxes around triangles with corners ``(3, 3, f)``."""
    a, b, c = corners
    return np.minimum(np.minimum(a, b), c), np.maximum(np.maximum(a, b), c)


def _sorted(lowest: Floats, highest: Floats) -> Indices:
    """The triangles in the order of the leaves: each part is cut evenly along the axis on which it is longest."""
    centre = np.ascontiguousarray((lowest + highest).T)
    extent = float(np.ptp(centre, axis=0).max())
    unit_centre = (centre - centre.min(axis=0)) / (extent or 1.0)
    count = len(centre)
    faces = np.arange(count)
    for level in range(_depth(count)):
        starts = _starts(count, level)
        places = unit_centre[faces]
        spread = np.maximum.reduceat(places, starts[:-1]) - np.minimum.reduceat(places, starts[:-1])
        node = np.repeat(np.arange(len(spread)), np.diff(starts))
        along = places[np.arange(count), np.argmax(spread, axis=1)[node]]
        # Coordinates from 0 to 1, so that one number sorts by node first; stable, so that all processors sort alike.
        faces = faces[np.argsort(2.0 * node + along, kind="stable")]
    return faces


def _boxed(lowest: Floats, highest: Floats, faces: Indices) -> FaceTree:
    """Return the tree whose leaves have the triangles in this order."""
    depth = _depth(len(faces))
    starts = _starts(len(faces), depth)
    low, high = (np.empty((3, (2 << depth) - 1)) for _ in range(2))
    # A leaf has one face, or two.
    first, last = faces[starts[:-1]], faces[starts[1:] - 1]
    leaves = slice((1 << depth) - 1, None)
    np.minimum(lowest.take(first, axis=1), lowest.take(last, axis=1), out=low[:, leaves])
    np.maximum(highest.take(first, axis=1), highest.take(last, axis=1), out=high[:, leaves])
    for level in reversed(range(depth)):
        nodes, below = slice((1 << level) - 1, (2 << level) - 1), slice((2 << level) - 1, (4 << level) - 1)
        np.minimum(low[:, below][:, ::2], low[:, below][:, 1::2], out=low[:, nodes])
        np.maximum(high[:, below][:, ::2], high[:, below][:, 1::2], out=high[:, nodes])
    middle = low + high
    middle *= 0.5
    half = np.subtract(high, low, out=high)
    half *= 0.5
    half += _PADDING
    return FaceTree(middle, half, starts, faces)


def _depth(count: int) -> int:
    return count.bit_length() - 1


def _starts(count: int, level: int) -> Indices:
    """Return the starts of the parts, and the end of the last one, when ``count`` faces are divided evenly
    into ``2**level`` parts.
    """
    return (np.arange((1 << level) + 1) * count) >> level


def _first_faces(tree: FaceTree) -> Indices:
    """The place of the first face below each node."""
    levels = [tree.starts[:-1]]
    while len(levels[-1]) > 1:
        levels.append(levels[-1][::2])
    return np.concatenate(levels[::-1])


class Forest:
    """The trees of several meshes side by side; entries name meshes by their numbers."""

    def __init__(self, meshes: Sequence[Mesh]) -> None:
        trees = [mesh.derived(face_tree) for mesh in meshes]
        nodes = np.array([tree.middle.shape[1] for tree in trees])
        sizes = np.array([len(tree.faces) for tree in trees])
        self.roots = np.cumsum(nodes) - nodes
        first_face = np.cumsum(sizes) - sizes
        self.middle: Final = _beside([tree.middle for tree in trees])
        self.half: Final = _beside([tree.half for tree in trees])
        child, start, end = [], [], []
        for tree, root, face in zip(trees, self.roots.tolist(), first_face.tolist(), strict=True):
            leaves = len(tree.starts) - 1
            inner = np.arange(leaves - 1)
            child += [root + 2 * inner + 1, np.full(leaves, -1)]
            start += [np.zeros(leaves - 1, dtype=np.intp), face + tree.starts[:-1]]
            end += [np.zeros(leaves - 1, dtype=np.intp), face + tree.starts[1:]]
        self.child = np.concatenate(child)
        """The first child of each node, the second comes next; -1 for leaves."""
        self.start, self.count = np.concatenate(start), np.concatenate(end) - np.concatenate(start)
        self.corners: Final = _beside(
            [
                mesh.derived(face_corners).take(tree.faces, axis=2)
                for mesh, tree in zip(meshes, trees, strict=True)
            ]
        )
        """The three corners of all faces, ``(3, 3, f)`` by corner and coordinate, in the unit frames of their meshes."""
        self.normals: Final = _normals(self.corners)
        """Normals of all faces as long as twice the areas, ``(3, f)``."""
        self._leaves = np.array([len(tree.starts) - 1 for tree in trees])
        self.face: Final = np.concatenate(
            [face + _first_faces(tree) for face, tree in zip(first_face.tolist(), trees, strict=True)]
        )
        """One of the faces below each node."""

    def level(self, level: int) -> tuple[Indices, Indices]:
        """Return the first node of each mesh's tree at a level, or that of its leaves, and how many there are."""
        width = np.minimum(1 << level, self._leaves)
        return self.roots + width - 1, width

    def near_faces(
        self, first: Indices, second: Indices, forth: AffineMaps, back: AffineMaps, settled: Booleans
    ) -> Iterator[tuple[Indices, Indices, Indices]]:
        """All pairs of faces whose boxes meet in both frames, in groups (entry, first face, second face).

        Args:
            first: mesh numbers, ``(n,)``.
            second: mesh numbers, ``(n,)``.
            forth: the maps from the unit frame of the first mesh to that of the second.
            back: the maps the other way.
            settled: entries of which no more is wanted, ``(n,)``; may change while the groups are read.

        """
        meet = Meeting(self, forth, back)
        fronts = [(np.arange(len(first)), self.roots[first], self.roots[second])]
        while fronts:
            entry, one, two = fronts.pop()
            left = np.flatnonzero(~settled[entry])
            if len(left) > _FRONT:
                # The later half waits: going down first finds what settles entries early.
                half = len(left) // 2
                fronts.append((entry[left[half:]], one[left[half:]], two[left[half:]]))
                left = left[:half]
            entry, one, two = meet(entry[left], one[left], two[left])
            ends = (self.child[one] < 0) & (self.child[two] < 0)
            if ends.any():
                yield self.faces_of(entry[ends], one[ends], two[ends])
                go_on = ~ends
                entry, one, two = entry[go_on], one[go_on], two[go_on]
            if len(entry):
                below = self.below(entry, one, two)
                fronts.append(self.below(*below) if len(below[0]) <= _SMALL else below)

    def parts(self, entry: Indices, node: Indices) -> tuple[Indices, Indices]:
        """Return the children of nodes; leaves stay."""
        child = self.child[node]
        owner, offset = expand((child >= 0) + 1)
        return entry[owner], np.where(child < 0, node, child)[owner] + offset

    def below(self, entry: Indices, one: Indices, two: Indices) -> tuple[Indices, Indices, Indices]:
        """The pairs of the children; a leaf stays beside the children of the other."""
        child_one, child_two = self.child[one], self.child[two]
        wide_one, wide_two = (child_one >= 0) + 1, (child_two >= 0) + 1
        owner, offset = expand(wide_one * wide_two)
        width = wide_two[owner]
        next_one = np.where(child_one < 0, one, child_one)[owner] + offset // width
        next_two = np.where(child_two < 0, two, child_two)[owner] + offset % width
        return entry[owner], next_one, next_two

    def faces_of(self, entry: Indices, one: Indices, two: Indices) -> tuple[Indices, Indices, Indices]:
        """The pairs of the faces of leaves."""
        width = self.count[two]
        owner, offset = expand(self.count[one] * width)
        width = width[owner]
        return (
            entry[owner],
            self.start[one][owner] + offset // width,
            self.start[two][owner] + offset % width,
        )


class Meeting:
    """Tells which boxes of two posed trees meet, looked at in the frames of both.

    Args:
        forest: the trees.
        forth: the maps from the unit frames of the first meshes to those of the second.
        back: the maps the other way.

    """

    def __init__(self, forest: Forest, forth: AffineMaps, back: AffineMaps) -> None:
        self._forest = forest
        self._there, self._here = _Maps(forth), _Maps(back)

    def __call__(self, entry: Indices, one: Indices, two: Indices) -> tuple[Indices, Indices, Indices]:
        """Return the entries whose boxes overlap either way; the boxes are the nodes ``one`` and ``two`` of the trees."""
        near = self._near(self._there, entry, one, two)
        entry, one, two = entry[near], one[near], two[near]
        near = self._near(self._here, entry, two, one)
        return entry[near], one[near], two[near]

    def _near(self, maps: "_Maps", entry: Indices, moving: Indices, still: Indices) -> Indices:
        """Return a mask of the entries in which the box around the image of a moving box overlaps the still box."""
        forest = self._forest
        middle, half = taken(forest.middle, moving), taken(forest.half, moving)
        near: Booleans | None = None
        for axis in range(3):
            matrix, size = maps.matrix[axis], maps.size[axis]
            centre = maps.offset[axis][entry] - forest.middle[axis][still]
            reach = forest.half[axis][still]
            for other in range(3):
                centre += matrix[other][entry] * middle[other]
                reach += size[other][entry] * half[other]
            beside = np.abs(centre, out=centre) <= reach
            near = beside if near is None else near & beside
        assert near is not None
        return np.flatnonzero(near)


class _Maps:
    """Affine maps, and the magnitudes of their coefficients, indexed by row, column and entry."""

    def __init__(self, maps: AffineMaps) -> None:
        self.matrix = maps.matrix
        self.size = np.abs(maps.matrix)
        self.offset = maps.offset


def _beside(parts: Sequence[Floats]) -> Floats:
    return parts[0] if len(parts) == 1 else np.concatenate(parts, axis=-1)


def _normals(corners: Floats) -> Floats:
    x, y, z = corners[1] - corners[0]
    u, v, w = corners[2] - corners[0]
    return np.stack([y * w - z * v, z * u - x * w, x * v - y * u])
