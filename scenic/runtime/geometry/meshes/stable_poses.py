"""Poses in which a thrown solid comes to rest on a plane, with their probabilities.

A solid rests on a face of its convex hull above which its centre of mass is. The probability of a face is the share of orientations
from which the solid, let go without speed, ends on the face (K. Goldberg and others, "Part pose statistics", 1999): it falls on the face
below its centre of mass, and rolls from face to face, each time over the edge about which the centre of mass sinks fastest.

The faces of a hull, their corners and their neighbours do not depend on the size of a solid, since a stretched hull is the hull of the
stretched solid. So they are computed once for each mesh, and all else for many sizes together.
"""

from collections.abc import Callable
from functools import lru_cache
from typing import Any, Final

import numpy as np

from scenic.dataclass import dataclass
from scenic.runtime.geometry.meshes.mesh import Mesh
from scenic.runtime.geometry.poses import Floats, Indices
from scenic.runtime.geometry.ragged import rows
from scenic.runtime.geometry.vectors import cross, dot, length

__all__ = ["Footing", "centre_of_mass", "ellipsoid_footing", "hull_footing", "resting_poses"]

_FIRM: Final = np.radians(3.0)
"""Poses that a smaller tilt would end count for those to which it leads."""

_FLAT: Final = 1e-6
"""Difference of the planes of two neighbouring faces below which they are one face."""

_SAME: Final = 1e-9
"""Part of an axis by which another axis of an ellipsoid may be longer and count as equal."""

_FEW: Final = 16
"""Poses at a size that at least one lane of so many has are kept for the next time."""

_CHUNK: Final = 1 << 18
"""Combinations of size and edge looked at together."""


@dataclass(frozen=True, slots=True, eq=False)
class Footing:
    """The faces on which a unit solid can stand, or directions for them.

    Attributes:
        normals: of the faces, unit vectors ``(f, 3)`` outwards.
        corners: of the convex hull, ``(h, 3)``.
        weight: numbers that are looked at for one size.
        shares: computes the probabilities ``(n, f)`` of the faces at sizes ``(n, 3)``.

    """

    normals: Floats
    corners: Floats
    weight: int
    shares: Callable[[Floats], Floats]


@dataclass(frozen=True, slots=True, eq=False)
class _Hull:
    """The convex hull of a unit solid by its plane faces; triangles and edges are in the order of their faces.

    Attributes:
        depths: of the centre of mass below the faces, ``(f,)``.
        normals: of the faces, unit vectors ``(f, 3)`` outwards.
        triangles: into which the faces are cut, ``(t, 3, 3)``, seen from the centre of mass.
        first_triangles: number of the first triangle of each face, ``(f,)``.
        starts: of the edges ``(e, 3)``, likewise; the face is on their left, seen from outside.
        ends: of the edges ``(e, 3)``, likewise.
        first_edges: number of the first edge of each face, ``(f,)``.
        owners: face of each edge ``(e,)``.
        neighbours: face beyond each edge ``(e,)``.

    """

    depths: Floats
    normals: Floats
    triangles: Floats
    first_triangles: Indices
    starts: Floats
    ends: Floats
    first_edges: Indices
    owners: Indices
    neighbours: Indices

    def shares(self, sizes: Floats) -> Floats:
        """Return the probabilities ``(n, f)`` of the faces at sizes ``(n, 3)``."""
        scales = sizes[:, np.newaxis]
        beyond = _beyond(self, scales)
        # The farthest that the centre of mass is outside an edge of each face, negative inside.
        farthest = np.maximum.reduceat(beyond, self.first_edges, axis=1)
        heights = self.depths / length(self.normals / scales)
        margins = np.arctan2(-farthest, heights)
        itself = np.arange(len(self.normals))
        lane, edge = np.nonzero(beyond == farthest[:, self.owners])
        over = np.tile(itself, (len(sizes), 1))
        over[lane, self.owners[edge]] = self.neighbours[edge]
        stands = (margins >= 0) | (margins == margins.max(axis=1, keepdims=True))
        rest = _followed(np.where(stands, itself, over))
        # A solid that is pushed leaves poses that are not firm; where it comes to none that is, it has rolled on a round side.
        firm = margins >= _FIRM
        pose_after_push = _followed(np.where(firm, itself, np.take_along_axis(rest, over, axis=1)))
        goal = np.where(np.take_along_axis(firm, pose_after_push, axis=1), pose_after_push, itself)
        target = np.take_along_axis(goal, rest, axis=1)
        masses = np.add.reduceat(
            _solid_angles(self.triangles * scales[:, np.newaxis]), self.first_triangles, axis=1
        )
        shares = np.zeros_like(masses)
        np.add.at(shares, (np.arange(len(sizes))[:, np.newaxis], target), masses)
        shares /= shares.sum(axis=1, keepdims=True)
        return shares


def _followed(target: Indices) -> Indices:
    """The places ``(n, f)`` to which the targets of each place lead, one after the other, in each row: those that are their own targets."""
    for _ in range(target.shape[1].bit_length()):  # twice as far each time
        target = np.take_along_axis(target, target, axis=1)
    return target


def _beyond(hull: _Hull, scales: Floats) -> Floats:
    """Return the distances ``(n, e)`` by which the centre of mass is outside the edges, seen along the normals of their faces."""
    starts, along = hull.starts * scales, (hull.ends - hull.starts) * scales
    outwards = cross(along, hull.normals[hull.owners] / scales)
    return -dot(starts, outwards) / length(outwards)


def _solid_angles(triangles: Floats) -> Floats:
    """Return the solid angles of triangles ``(..., 3, 3)`` seen from the origin (A. van Oosterom and J. Strackee, 1983)."""
    a, b, c = np.moveaxis(triangles, -2, 0)
    la, lb, lc = length(a), length(b), length(c)
    angles: Floats = 2 * np.arctan2(
        np.abs(dot(a, cross(b, c))), la * lb * lc + dot(a, b) * lc + dot(b, c) * la + dot(c, a) * lb
    )
    return angles


def hull_footing(mesh: Mesh) -> Footing:
    """Return the faces of the convex hull of a unit solid of one density."""
    from scipy.spatial import ConvexHull  # slow to import

    outermost = mesh.outermost
    hull: Any = ConvexHull(outermost)
    middle = centre_of_mass(mesh)
    points, corners = outermost - middle, outermost[hull.vertices]
    face, planes = _faces(hull)
    a, b, c = np.moveaxis(points[hull.simplices], 1, 0)
    inwards = dot(cross(b - a, c - a), hull.equations[:, :3])[:, np.newaxis] < 0
    simplices = np.where(inwards, hull.simplices[:, ::-1], hull.simplices)
    beyond = face[np.where(inwards, hull.neighbors[:, ::-1], hull.neighbors)].ravel()  # opposite each corner
    owners = np.repeat(face, 3)
    rim = np.flatnonzero(owners != beyond)
    rim = rim[np.argsort(owners[rim], kind="stable")]
    order = np.argsort(face, kind="stable")
    numbers = np.arange(len(planes))
    faces = _Hull(
        depths=-(dot(planes[:, :3], middle) + planes[:, 3]),
        normals=planes[:, :3],
        triangles=points[simplices[order]],
        first_triangles=np.searchsorted(face[order], numbers),
        starts=points[simplices[:, [1, 2, 0]].ravel()[rim]],
        ends=points[simplices[:, [2, 0, 1]].ravel()[rim]],
        first_edges=np.searchsorted(owners[rim], numbers),
        owners=owners[rim],
        neighbours=beyond[rim],
    )
    return Footing(faces.normals, corners, len(rim), faces.shares)


def _faces(hull: Any) -> tuple[Indices, Floats]:
    """The plane face of each triangle of a hull of SciPy, and the planes ``(f, 4)`` of the faces, in an order that only they decide."""
    from scipy.sparse import coo_array
    from scipy.sparse.csgraph import connected_components

    planes, count = hull.equations, len(hull.equations)
    one, other = np.repeat(np.arange(count), 3), hull.neighbors.ravel()
    flat = np.flatnonzero((np.abs(planes[one] - planes[other]) < _FLAT).all(axis=1))
    links = coo_array((np.ones(len(flat)), (one[flat], other[flat])), shape=(count, count))
    _, group = connected_components(links, directed=False)
    groups, first = np.unique(group, return_index=True)
    places = np.lexsort(np.round(planes[first], 9).T)
    numbers = np.empty(len(groups), np.intp)
    numbers[places] = np.arange(len(groups))
    return numbers[group], planes[first[places]]


def centre_of_mass(mesh: Mesh) -> Floats:
    """Return the centre of mass ``(3,)`` of a solid of one density, from the tetrahedra between the origin and its faces."""
    a, b, c = np.moveaxis(mesh.triangles, 1, 0)
    volumes = dot(a, cross(b, c))
    centre: Floats = (volumes[:, np.newaxis] * (a + b + c)).sum(axis=0) / (4 * volumes.sum())
    return centre


def ellipsoid_footing(mesh: Mesh) -> Footing:
    """Return the footing of a ball of diameter 1: the vertices of a unit solid inscribed in it stand for the ball.

    A stretched ball rests on its shortest axis.

    Where two or three axes are equal, any direction among them is as good. The vertices are those points of the ellipsoid that the
    solid has, too; those on the shortest axes have the same probability.
    """
    normals = mesh.vertices / length(mesh.vertices)[:, np.newaxis]
    off_axis = np.abs(normals) > _SAME

    def shares(sizes: Floats) -> Floats:
        longer = sizes > sizes.min(axis=1, keepdims=True) * (1 + _SAME)
        stands = ~(off_axis & longer[:, np.newaxis]).any(axis=2)
        equal: Floats = stands / stands.sum(axis=1, keepdims=True)
        return equal

    return Footing(normals, mesh.vertices, len(normals), shares)


def resting_poses(footing: Footing, sizes: Floats, draws: Floats) -> Floats:
    """Stable poses ``(3, n)`` of a solid at sizes ``(n, 3)``, chosen by draws ``(n,)`` from 0 to 1.

    Rows are the angle about X after that about Y (radians), the angle about Y, and the height of the middle of the solid's box (metres).
    """
    result = np.empty((3, len(sizes)))
    left = np.arange(len(sizes))
    while len(left):
        size = sizes[left[0]]
        alike = (sizes[left, 1] == size[1]) & (sizes[left, 2] == size[2]) & (sizes[left, 0] == size[0])
        lanes = left[alike]
        if _FEW * len(lanes) < len(left):
            break
        limits, poses = _known(footing, tuple(size.tolist()))
        result[:, lanes] = poses.take(np.searchsorted(limits, draws[lanes], side="right"), axis=1)
        left = left[~alike]
    for part in rows(len(left), footing.weight, _CHUNK):
        some = left[part]
        limits = _limits(footing, sizes[some])
        faces = (limits <= draws[some, np.newaxis]).sum(axis=1)
        result[:, some] = _poses(footing, sizes[some], faces)
    return result


@lru_cache(maxsize=512)
def _known(footing: Footing, size: tuple[float, ...]) -> tuple[Floats, Floats]:
    """Return cumulative probabilities ``(p,)`` and poses ``(3, p)`` of the faces on which a solid of one size may rest."""
    limits = _limits(footing, np.array([size]))[0]
    faces = np.unique(limits, return_index=True)[1]
    poses = [
        _poses(footing, np.tile(size, (len(faces[part]), 1)), faces[part])
        for part in rows(len(faces), footing.weight, _CHUNK)
    ]
    return limits[faces], np.concatenate(poses, axis=1)


def _limits(footing: Footing, sizes: Floats) -> Floats:
    """Return cumulative probabilities ``(n, f)`` of the faces at sizes ``(n, 3)``; the last possible one is infinite, above any draw."""
    sums = np.cumsum(footing.shares(sizes), axis=1)
    return np.where(sums == sums[:, -1:], np.inf, sums)


def _poses(footing: Footing, sizes: Floats, faces: Indices) -> Floats:
    """Return the poses ``(3, n)`` of a solid that rests on these faces, as `resting_poses` has them."""
    down = footing.normals[faces] / sizes
    down /= length(down)[:, np.newaxis]
    lifts = dot(footing.corners * sizes[:, np.newaxis], down[:, np.newaxis]).max(axis=1)
    return np.stack([np.arcsin(np.clip(-down[:, 1], -1, 1)), np.arctan2(down[:, 0], -down[:, 2]), lifts])
