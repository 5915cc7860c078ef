"""Distances of bodies: from points to their surfaces, signed by the side, and between two bodies."""

from typing import Final

import numpy as np

from scenic.runtime.geometry.affine import AffineMaps, relative_map
from scenic.runtime.geometry.contact.narrowphase import meshes_intersect
from scenic.runtime.geometry.containment.body_containment import contains_points
from scenic.runtime.geometry.meshes.bodies import Body
from scenic.runtime.geometry.meshes.facetree import Forest
from scenic.runtime.geometry.meshes.mesh import Mesh
from scenic.runtime.geometry.meshes.nearest import NearestPoints, nearest_of, nearest_on_triangles
from scenic.runtime.geometry.poses import Booleans, Floats, Indices, Poses
from scenic.runtime.geometry.ragged import first_of_each
from scenic.runtime.geometry.vectors import cross, dot

_FRONT: Final = 1 << 14
"""Pairs of boxes looked at together."""

_ENTRIES: Final = 1 << 12
"""Pairs of bodies looked at together."""


def to_surface(body: Body, points: Floats, lanes: int, *, within: float = np.inf) -> NearestPoints:
    """The nearest point of the body's surface to each point ``(lanes | 1, 3)``; numbers are those of faces.

    Points that are farther from it than ``within`` (metres) are only known to be, and given as infinitely far.
    """
    distance, nearest = np.empty(lanes), np.empty((lanes, 3))
    number = np.empty(lanes, dtype=np.intp)
    for mesh, lanes_of_mesh in body.by_mesh(lanes):
        poses = body.poses.take(lanes_of_mesh)
        start = np.broadcast_to(points, (lanes, 3))[lanes_of_mesh]
        # A frame that turns and moves with the body, but is not stretched, keeps distances.
        rigid = Poses(poses.position, poses.orientation, np.ones((1, 3)))
        local = np.ascontiguousarray(np.broadcast_to(rigid.to_unit(start), (len(lanes_of_mesh), 3)))
        nearest_on_mesh = mesh.derived(nearest_of).find(local, poses.size, within=within)
        distance[lanes_of_mesh], number[lanes_of_mesh] = nearest_on_mesh.distance, nearest_on_mesh.number
        nearest[lanes_of_mesh] = rigid.to_world(nearest_on_mesh.point)
    return NearestPoints(distance, nearest, number)


def signed(body: Body, points: Floats, lanes: int) -> Floats:
    """The distances of points ``(lanes | 1, 3)`` from the body's surface, ``(lanes,)``; negative inside."""
    distance = to_surface(body, points, lanes).distance
    inside = np.broadcast_to(contains_points(body, points), (lanes,))
    return np.where(inside, -distance, distance)


def to_solid(body: Body, points: Floats, lanes: int) -> Floats:
    """The distances of points ``(lanes | 1, 3)`` from the body, ``(lanes,)``; 0 inside."""
    return np.maximum(signed(body, points, lanes), 0.0)


def between(first: Body, second: Body, lanes: int) -> Floats:
    """The least distances between points of two bodies, ``(lanes,)``; 0 where they collide."""
    result = np.empty(lanes)
    for mesh_a, chosen_a in first.by_mesh(lanes):
        for mesh_b, chosen_b in second.by_mesh(lanes):
            lanes_of_pair = np.intersect1d(chosen_a, chosen_b, assume_unique=True)
            for start in range(0, len(lanes_of_pair), _ENTRIES):
                part = lanes_of_pair[start : start + _ENTRIES]
                poses = first.poses.take(part), second.poses.take(part)
                result[part] = _between(mesh_a, poses[0], mesh_b, poses[1], len(part))
    return result


def _between(mesh_a: Mesh, poses_a: Poses, mesh_b: Mesh, poses_b: Poses, count: int) -> Floats:
    result = np.zeros(count)
    apart = np.flatnonzero(~np.broadcast_to(meshes_intersect(mesh_a, poses_a, mesh_b, poses_b), (count,)))
    if len(apart):
        result[apart] = _Gaps(mesh_a, poses_a.take(apart), mesh_b, poses_b.take(apart), len(apart)).least()
    return result


class _Gaps:
    """The search for the least distance of surfaces, in frames that turn and move with the bodies.

    Branch and bound over pairs of boxes: what a first dive to a pair of leaves gives bounds the distance from above,
    the gap between boxes bounds it from below.
    """

    def __init__(self, mesh_a: Mesh, poses_a: Poses, mesh_b: Mesh, poses_b: Poses, count: int) -> None:
        self._forest = Forest([mesh_a, mesh_b])
        unit = np.ones((1, 3))
        a, b = (Poses(poses.position, poses.orientation, unit) for poses in (poses_a, poses_b))
        self._forth, self._back = _full(relative_map(a, b), count), _full(relative_map(b, a), count)
        self._sizes = [np.broadcast_to(poses.size, (count, 3)) for poses in (poses_a, poses_b)]
        self._squared = np.full(count, np.inf)

    def least(self) -> Floats:
        """Return the distances."""
        count = len(self._squared)
        one, two = (np.full(count, root) for root in self._forest.roots.tolist())
        self._dive(np.arange(count), one, two)
        fronts = [(np.arange(count), one, two)]
        while fronts:
            entry, one, two = fronts.pop()
            if len(entry) > _FRONT:
                half = len(entry) // 2
                fronts.append((entry[half:], one[half:], two[half:]))
                entry, one, two = entry[:half], one[:half], two[:half]
            gap = self._gap(entry, one, two)
            # The least gap of each entry leads to a better bound, which spares many of the other pairs.
            lead = _least_of_each(entry, gap)
            self._dive(entry[lead], one[lead], two[lead])
            near = np.flatnonzero(gap < self._squared[entry])
            entry, one, two, gap = entry[near], one[near], two[near], gap[near]
            ends = self._are_leaves(one, two)
            if ends.any():
                self._improve_in_turns(entry[ends], one[ends], two[ends], gap[ends])
                go_on = ~ends
                entry, one, two = entry[go_on], one[go_on], two[go_on]
            if len(entry):
                fronts.append(self._forest.below(entry, one, two))
        return np.asarray(np.sqrt(self._squared))

    def _improve_in_turns(self, entry: Indices, one: Indices, two: Indices, gap: Floats) -> None:
        """Look at pairs of leaves in the order of their gaps, until none is left that could be nearer."""
        order = np.lexsort((gap, entry))
        entry, one, two, gap = entry[order], one[order], two[order], gap[order]
        most = 1
        while len(entry):
            rank = np.arange(len(entry)) - np.searchsorted(entry, entry)
            now = rank < most
            self._improve(entry[now], one[now], two[now])
            left = ~now & (gap < self._squared[entry])
            entry, one, two, gap = entry[left], one[left], two[left], gap[left]
            most *= 2

    def _are_leaves(self, one: Indices, two: Indices) -> Booleans:
        child = self._forest.child
        result: Booleans = (child[one] < 0) & (child[two] < 0)
        return result

    def _dive(self, entry: Indices, one: Indices, two: Indices) -> None:
        """Bound each distance by a pair of leaves, reached by always taking the pair of boxes with the least gap."""
        while True:
            ends = self._are_leaves(one, two)
            self._improve(entry[ends], one[ends], two[ends])
            entry, one, two = entry[~ends], one[~ends], two[~ends]
            if not len(entry):
                return
            entry, one, two = self._forest.below(entry, one, two)
            lead = _least_of_each(entry, self._gap(entry, one, two))
            entry, one, two = entry[lead], one[lead], two[lead]

    def _gap(self, entry: Indices, one: Indices, two: Indices) -> Floats:
        """Lower bounds of the squared distances between boxes."""
        return np.maximum(
            self._one_way(self._forth.take(entry), *self._box(0, entry, one), *self._box(1, entry, two)),
            self._one_way(self._back.take(entry), *self._box(1, entry, two), *self._box(0, entry, one)),
        )

    def _box(self, side: int, entry: Indices, node: Indices) -> tuple[Floats, Floats]:
        size = self._sizes[side][entry].T
        return self._forest.middle[:, node] * size, self._forest.half[:, node] * size

    def _one_way(
        self, maps: AffineMaps, middle: Floats, half: Floats, still_middle: Floats, still_half: Floats
    ) -> Floats:
        centre, reach = maps.columns(middle), maps.reaches(half)
        total = np.zeros(len(centre[0]))
        for axis in range(3):
            beside = np.abs(centre[axis] - still_middle[axis]) - reach[axis] - still_half[axis]
            beside = np.maximum(beside, 0.0)
            total += beside * beside
        return total

    def _improve(self, entry: Indices, one: Indices, two: Indices) -> None:
        """Put in the distances of the faces of leaves, where they are smaller."""
        if not len(entry):
            return
        entry, first, second = self._forest.faces_of(entry, one, two)
        a = [
            self._forth.take(entry).columns(_scaled(corner, first, self._sizes[0][entry])).T
            for corner in self._forest.corners
        ]
        b = [_scaled(corner, second, self._sizes[1][entry]).T for corner in self._forest.corners]
        np.minimum.at(self._squared, entry, squared_distances(a, b))


def _least_of_each(entry: Indices, gap: Floats) -> Indices:
    """Return the index of the pair with the least gap, for each entry."""
    order = np.lexsort((gap, entry))
    return order[first_of_each(entry[order])]


def squared_distances(a: list[Floats], b: list[Floats]) -> Floats:
    """Return the squared distances ``(m,)`` of triangles that share no point, given three corners ``(m, 3)`` each.

    The nearest points are a corner and a point of the other triangle, or points of two edges.
    """
    result = np.full(len(a[0]), np.inf)
    for these, those in ((a, b), (b, a)):
        for corner in these:
            gap = corner - nearest_on_triangles(corner, *those)
            result = np.minimum(result, dot(gap, gap))
    for i in range(3):
        for j in range(3):
            edges = _squared_between_lines(a[i], a[(i + 1) % 3], b[j], b[(j + 1) % 3])
            result = np.minimum(result, edges)
    return result


def _squared_between_lines(a: Floats, a_end: Floats, b: Floats, b_end: Floats) -> Floats:
    """Return the squared distances of segments whose nearest points lie within both; infinite for others.

    Where one of the nearest points is an end, the end's distance from the other triangle is as small.
    """
    u, v, w = a_end - a, b_end - b, b - a
    normal = cross(u, v)
    square = dot(normal, normal)
    crossing = square > 0
    safe = np.where(crossing, square, 1.0)
    s = dot(cross(w, v), normal) / safe
    t = dot(cross(w, u), normal) / safe
    within = crossing & (s >= 0) & (s <= 1) & (t >= 0) & (t <= 1)
    gap = w + t[:, None] * v - s[:, None] * u
    return np.where(within, dot(gap, gap), np.inf)


def _scaled(corner: Floats, faces: Indices, size: Floats) -> Floats:
    return corner[:, faces] * size.T


def _full(maps: AffineMaps, count: int) -> AffineMaps:
    return maps if len(maps.offset[0]) == count else maps.take(np.zeros(count, dtype=np.intp))
