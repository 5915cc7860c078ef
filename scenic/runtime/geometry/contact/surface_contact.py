"""Contacts of the surfaces of posed meshes, for many pairs of different meshes at once.

Exact up to rounding: trees of boxes name the pairs of faces that may meet, and those are compared by separating
axes. Each mesh stays in its unit frame; what is known of it there serves all sizes and poses.
"""

from collections.abc import Iterator, Sequence
from typing import Final

import numpy as np

from scenic.runtime.geometry.affine import AffineMaps
from scenic.runtime.geometry.contact.fronts import Front
from scenic.runtime.geometry.contact.triangles import Corners, separated_by_edges
from scenic.runtime.geometry.meshes.facetree import Forest
from scenic.runtime.geometry.poses import Booleans, Floats, Indices
from scenic.runtime.geometry.ragged import expand, pieces

_FIRST: Final = 4
"""Pairs of faces of an entry compared first; each further turn takes four times as many, until one pair touches."""

_LEAST: Final = 1 << 9
"""So many are compared together where there are: fewer take as long."""

_CHUNK: Final = 1 << 12
"""Pairs of faces compared together, so that the temporary columns stay in the processor's cache."""

_PAIRS: Final = 1 << 15
"""Pairs of leaves compared together."""

_GRID: Final = 1 << 10
"""Pairs of leaves of an entry from which on they are compared without those of others."""

_SLACK: Final = 1e-14
"""Gap, in parts of the faces' size and distance from the origin, up to which they touch: rounding."""

_Group = tuple[Indices, Indices, Indices]
"""Pairs of leaves of entries: each time which entry, the one leaf and the other."""


class Surfaces:
    """The surfaces of several unit meshes, given by the trees of their faces; entries name meshes by their numbers."""

    def __init__(self, forest: Forest) -> None:
        self._forest = forest

    def touch(self, first: Indices, second: Indices, forth: AffineMaps, back: AffineMaps) -> Booleans:
        """The mask of pairs of surfaces that share a point, ``(n,)``.

        Args:
            first: mesh numbers, ``(n,)``.
            second: mesh numbers, ``(n,)``.
            forth: the maps from the unit frame of the first mesh to that of the second.
            back: the maps the other way.

        """
        result = np.zeros(len(first), dtype=np.bool_)
        for faces in self._forest.near_faces(first, second, forth, back, result):
            self._settle(result, *faces, forth, back)
        return result

    def touch_among(self, front: Front, chosen: Indices, forth: AffineMaps, back: AffineMaps) -> Booleans:
        """The mask of pairs of surfaces that share a point, ``(n,)``, where it is known which of their leaves may.

        Args:
            front: those leaves.
            chosen: the pairs that are looked at; the others count as apart.
            forth: as in `touch`.
            back: the maps the other way.

        """
        result = np.zeros(len(front.touching), dtype=np.bool_)
        for owner, one, two in _together(self._near_leaves(front, chosen)):
            self._settle(result, *self._forest.faces_of(chosen[owner], one, two), forth, back)
        return result

    def _near_leaves(self, front: Front, chosen: Indices) -> Iterator[_Group]:
        """All pairs of leaves whose boxes meet in both frames, in groups (place in ``chosen``, first leaf, second leaf)."""
        first, second = (groups.take(chosen) for groups in front.leaves())
        pairs = first.counts * second.counts
        boxes = self._forest.middle.take(front.leaf, axis=1), self._forest.half.take(front.leaf, axis=1)
        images = front.centre, front.reach
        few = np.flatnonzero(pairs <= _GRID)
        for part in pieces(pairs[few], _PAIRS):
            owner, offset = expand(pairs[few[part]])
            owner = few[owner + part.start]
            width = second.counts[owner]
            one, two = first.starts[owner] + offset // width, second.starts[owner] + offset % width
            near = _near(images, one, boxes, two)
            near = near[_near(images, two[near], boxes, one[near])]
            yield owner[near], front.leaf[one[near]], front.leaf[two[near]]
        # A grid of rows and columns takes no index for each pair.
        for place in np.flatnonzero(pairs > _GRID).tolist():
            rows, columns = (
                slice(start, start + count)
                for start, count in (
                    (int(groups.starts[place]), int(groups.counts[place])) for groups in (first, second)
                )
            )
            one, two = np.nonzero(
                _grid_near(images, rows, boxes, columns) & _grid_near(images, columns, boxes, rows).T
            )
            yield np.full(len(one), place), front.leaf[rows][one], front.leaf[columns][two]

    def _settle(
        self,
        result: Booleans,
        entry: Indices,
        one: Indices,
        two: Indices,
        forth: AffineMaps,
        back: AffineMaps,
    ) -> None:
        """Mark the entries of which a pair of faces touches."""
        for part in _turns(entry):
            some = part[~result[entry[part]]]
            touching = self._touching(entry[some], one[some], two[some], forth, back)
            result[entry[some[touching]]] = True

    def _touching(
        self, entry: Indices, one: Indices, two: Indices, forth: AffineMaps, back: AffineMaps
    ) -> Indices:
        """Return the indices of the pairs of faces that share a point."""
        first, second = (self._forest.corners.take(faces, axis=2) for faces in (one, two))
        left = self._cut_plane(first, two, second, forth, entry)
        entry, first, second = entry[left], first.take(left, axis=2), second.take(left, axis=2)
        more = self._cut_plane(second, one[left], first, back, entry)
        left, entry, first, second = (
            left[more],
            entry[more],
            first.take(more, axis=2),
            second.take(more, axis=2),
        )
        images = forth.take(entry).columns(first.swapaxes(0, 1)).swapaxes(0, 1)
        return left[~separated_by_edges(images, second)]

    def _cut_plane(
        self, corners: Corners, other: Indices, on_plane: Corners, maps: AffineMaps, entry: Indices
    ) -> Indices:
        """The pairs in which the corners, taken through the maps, are not all on one side of the other face's plane."""
        x, y, z = sides = self._forest.normals.take(other, axis=1)
        map_ = maps.take(entry)
        # The plane is taken back through the map: n (M p + o - q) = (M^T n) p + n (o - q).
        normal = x * map_.matrix[0] + y * map_.matrix[1] + z * map_.matrix[2]
        offset = map_.offset - on_plane[0]
        height = x * offset[0] + y * offset[1] + z * offset[2]
        sizes, far = np.abs(sides), np.abs(offset)
        slack = sizes[0] * far[0] + sizes[1] * far[1] + sizes[2] * far[2]
        slack += np.abs(normal[0]) + np.abs(normal[1]) + np.abs(normal[2])
        slack *= _SLACK
        a, b, c = normal[0] * corners[:, 0] + normal[1] * corners[:, 1] + normal[2] * corners[:, 2] + height
        highest = np.maximum(np.maximum(a, b), c)
        lowest = np.minimum(np.minimum(a, b), c)
        return np.flatnonzero((lowest <= slack) & (highest >= -slack))


def _near(moving: tuple[Floats, Floats], one: Indices, still: tuple[Floats, Floats], two: Indices) -> Indices:
    """Return the indices of pairs of boxes, ``one`` of the moving and ``two`` of the still ones, that
    overlap.

    Boxes are given by their middles and half extents, ``(3, k)`` each.
    """
    (centre, reach), (middle, half) = moving, still
    x, y, z = (
        np.abs(centre[axis][one] - middle[axis][two]) <= reach[axis][one] + half[axis][two]
        for axis in range(3)
    )
    return np.flatnonzero(x & y & z)


def _grid_near(
    moving: tuple[Floats, Floats], one: slice, still: tuple[Floats, Floats], two: slice
) -> Booleans:
    """Return the same for each of ``one`` and each of ``two``, ``(len(one), len(two))``."""
    (centre, reach), (middle, half) = moving, still
    x, y, z = (
        np.abs(centre[axis, one, np.newaxis] - middle[axis, two])
        <= reach[axis, one, np.newaxis] + half[axis, two]
        for axis in range(3)
    )
    result: Booleans = x & y & z
    return result


def _together(groups: Iterator[_Group]) -> Iterator[_Group]:
    """Groups of enough pairs each, but for the last."""
    parts: list[_Group] = []
    total = 0
    for group in groups:
        parts.append(group)
        total += len(group[0])
        if total >= _CHUNK:
            yield _joined(parts)
            parts, total = [], 0
    if parts:
        yield _joined(parts)


def _joined(parts: Sequence[_Group]) -> _Group:
    owner, one, two = (np.concatenate(columns) for columns in zip(*parts, strict=True))
    return owner, one, two


def _turns(entry: Indices) -> Iterator[Indices]:
    """Indices of pairs: the first few of each entry, then more and more of the rest."""
    if len(entry) <= _CHUNK // 4:
        yield np.arange(len(entry))
        return
    order = np.argsort(entry, kind="stable")
    entries = entry[order]
    starts = np.flatnonzero(np.diff(entries, prepend=-1))
    rank = np.arange(len(order)) - np.repeat(starts, np.diff(starts, append=len(order)))
    count, most = 0, max(_FIRST, _LEAST // len(starts))
    while count < len(order):
        indices = order[(rank >= count) & (rank < count + most)]
        if not len(indices):
            return
        for start in range(0, len(indices), _CHUNK):
            yield indices[start : start + _CHUNK]
        count += most
        most *= 4
