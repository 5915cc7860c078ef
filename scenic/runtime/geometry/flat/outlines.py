"""Bodies seen from above and cut by level planes, as shapely geometries: one for each lane.

Every function is elementwise: the geometry of a lane depends on that lane alone.
"""

from typing import Final, Protocol

import numpy as np
import numpy.typing as npt

from scenic.runtime.geometry.meshes.bodies import Body
from scenic.runtime.geometry.meshes.mesh import Mesh
from scenic.runtime.geometry.meshes.prisms import shadow
from scenic.runtime.geometry.poses import Booleans, Floats, Indices, Poses
from scenic.runtime.geometry.ragged import distinct, rows

Geometries = npt.NDArray[np.object_]
"""Shapely geometries ``(n,)``; empty polygons where there is nothing."""

_CHUNK: Final = 1 << 18
"""Combinations of lane and vertex looked at together."""

_INSET: Final = 1e-9
"""By how much, relative to the height of a body, a plane through its lowest or highest face is moved into it."""


def shadows(body: Body, lanes: Indices) -> Geometries:
    """Return the outlines ``(n,)`` of the body seen from above, in some lanes."""
    import shapely

    result: Geometries = np.empty(len(lanes), dtype=np.object_)
    part = body.take(lanes) if len(body) > 1 else body
    for mesh, lanes_of_mesh in part.by_mesh(len(lanes)):
        if mesh.is_convex:
            result[lanes_of_mesh] = _hulls_of(mesh, part.poses, lanes_of_mesh)
        else:
            standing = np.broadcast_to(upright(part.poses.take(lanes_of_mesh)), len(lanes_of_mesh))
            result[lanes_of_mesh[standing]] = _standing(mesh, part.poses, lanes_of_mesh[standing])
            lanes_of_mesh = lanes_of_mesh[~standing]
            for some in rows(len(lanes_of_mesh), 3 * len(mesh.faces), _CHUNK):
                triangles = _triangles(mesh, part.poses, lanes_of_mesh[some])
                result[lanes_of_mesh[some]] = shapely.union_all(triangles, axis=1)
    return result


class Area(Protocol):
    """An area of the plane in each of some lanes."""

    def meets_geometries(self, geometries: Geometries, rows: Indices) -> Booleans:
        """Return whether shapely geometries ``(k,)`` meet the areas of the lanes with the numbers ``rows``, ``(k,)``."""

    def meets_points(self, points: Floats, rows: Indices) -> Booleans:
        """Return whether some of the points ``(k, m, 2)`` lie in the areas of the lanes with the numbers ``rows``, ``(k,)``."""


def shadows_meet(body: Body, lanes: Indices, area: Area) -> Booleans:
    """Return whether the outlines of a body seen from above meet an area, in some lanes, ``(n,)``.

    Triangles are compared one by one, and only where neither the convex hull nor a vertex of the body decides.
    """
    result: Booleans = np.zeros(len(lanes), dtype=np.bool_)
    part = body.take(lanes) if len(body) > 1 else body
    for mesh, lanes_of_mesh in part.by_mesh(len(lanes)):
        if mesh.is_convex:
            result[lanes_of_mesh] = area.meets_geometries(
                _hulls_of(mesh, part.poses, lanes_of_mesh), lanes_of_mesh
            )
            continue
        standing = np.broadcast_to(upright(part.poses.take(lanes_of_mesh)), len(lanes_of_mesh))
        upright_ones, left = lanes_of_mesh[standing], lanes_of_mesh[~standing]
        if len(upright_ones):
            outlines = _standing(mesh, part.poses, upright_ones)
            result[upright_ones] = area.meets_geometries(outlines, upright_ones)
        if len(left):
            left = left[area.meets_geometries(_hulls_of(mesh, part.poses, left), left)]
        corners = mesh.vertices[distinct(mesh.faces)]
        for some in rows(len(left), len(corners), _CHUNK):
            places = _placed(part.poses, left[some], corners)[..., :2]
            result[left[some]] = area.meets_points(places, left[some])
        left = left[~result[left]]
        for some in rows(len(left), 3 * len(mesh.faces), _CHUNK):
            triangles = _triangles(mesh, part.poses, left[some])
            row, face = np.nonzero(triangles != None)  # noqa: E711 - elementwise
            meets = area.meets_geometries(triangles[row, face], left[some][row])
            result[left[some][row[meets]]] = True
    return result


def _hulls_of(mesh: Mesh, poses: Poses, lanes: Indices) -> Geometries:
    """Return the convex hulls ``(n,)`` of a mesh seen from above."""
    corners = mesh.hull.vertices
    result: Geometries = np.empty(len(lanes), dtype=np.object_)
    for some in rows(len(lanes), len(corners), _CHUNK):
        result[some] = hulls(_placed(poses, lanes[some], corners)[..., :2])
    return result


def _triangles(mesh: Mesh, poses: Poses, lanes: Indices) -> Geometries:
    """Return the faces of a mesh seen from above, ``(n, faces)``; ``None`` for those that stand upright."""
    import shapely

    flat = _placed(poses, lanes, mesh.vertices)[..., :2][:, mesh.faces]
    first, second = flat[:, :, 1] - flat[:, :, 0], flat[:, :, 2] - flat[:, :, 0]
    proper = first[..., 0] * second[..., 1] != first[..., 1] * second[..., 0]
    result: Geometries = np.full(proper.shape, None, dtype=np.object_)
    result[proper] = shapely.polygons(flat[proper])
    return result


def _standing(mesh: Mesh, poses: Poses, lanes: Indices) -> Geometries:
    """Return the outlines from above of a mesh that stands upright: all are images of one."""
    import shapely

    outline = mesh.derived(shadow)
    points = shapely.get_coordinates(outline)
    level = np.column_stack([points, np.zeros(len(points))])
    result: Geometries = np.full(len(lanes), outline, dtype=np.object_)
    for some in rows(len(lanes), len(points), _CHUNK):
        world = _placed(poses, lanes[some], level)[..., :2]
        result[some] = shapely.set_coordinates(result[some].copy(), world.reshape(-1, 2))
    return result


def cuts(body: Body, lanes: Indices, heights: Floats) -> Geometries:
    """Return the areas ``(n,)`` where the body meets level planes at ``heights``, ``(n | 1,)``, in some lanes."""
    import shapely

    result: Geometries = np.full(len(lanes), shapely.Polygon(), dtype=np.object_)
    part = body.take(lanes) if len(body) > 1 else body
    levels = np.broadcast_to(heights, len(lanes))
    for mesh, every in part.by_mesh(len(lanes)):
        for some in rows(len(every), len(mesh.faces), _CHUNK):
            lanes_of_mesh = every[some]
            world = _placed(part.poses, lanes_of_mesh, mesh.vertices)
            heights_of_corners = world[:, distinct(mesh.faces), 2]
            low, high = heights_of_corners.min(axis=1), heights_of_corners.max(axis=1)
            crossing = np.flatnonzero((low <= levels[lanes_of_mesh]) & (levels[lanes_of_mesh] <= high))
            inset = _INSET * np.maximum(1.0, high - low)[crossing]
            level = np.clip(levels[lanes_of_mesh[crossing]], low[crossing] + inset, high[crossing] - inset)
            sections = _cut(mesh, world[crossing], level)
            result[lanes_of_mesh[crossing]] = sections
    return result


def _cut(mesh: Mesh, world: Floats, level: Floats) -> Geometries:
    """Return the areas where planes meet a mesh with vertices ``(n, v, 3)``."""
    import shapely

    edges, sides = mesh.derived(_edges)
    start, end = world[:, edges[:, 0]], world[:, edges[:, 1]]
    below, above = start[..., 2] < level[:, None], end[..., 2] < level[:, None]
    crosses = below != above
    rise = np.where(crosses, end[..., 2] - start[..., 2], 1.0)
    share = ((level[:, None] - start[..., 2]) / rise)[..., None]
    points = start[..., :2] + share * (end[..., :2] - start[..., :2])
    if mesh.is_convex:
        owner, number = np.nonzero(crosses)
        crossing_points = shapely.multipoints(points[owner, number], indices=owner)
        return np.asarray(shapely.convex_hull(crossing_points), dtype=np.object_)
    # A face whose corners lie on both sides is cut along a segment between two of its edges.
    cut = crosses[:, sides]
    owner, face = np.nonzero(cut.any(axis=2))
    order = np.argsort(~cut[owner, face], axis=1, kind="stable")[:, :2]
    ends = points[owner[:, None], sides[face[:, None], order]]
    lines = shapely.multilinestrings(shapely.linestrings(ends), indices=owner)
    return np.asarray(shapely.build_area(lines), dtype=np.object_)


def _edges(mesh: Mesh) -> tuple[Indices, Indices]:
    """Return the edges ``(e, 2)`` of a mesh, and those of each face ``(f, 3)``."""
    pairs = np.sort(mesh.faces[:, [0, 1, 1, 2, 2, 0]].reshape(-1, 2), axis=1)
    edges, numbers = np.unique(pairs, axis=0, return_inverse=True)
    return edges, numbers.reshape(-1, 3)


def hulls(points: Floats) -> Geometries:
    """The convex hulls of points ``(n, k, 2)``."""
    import shapely

    # A line through all points has the same hull, and is made at once where many points are made one by one.
    return np.asarray(shapely.convex_hull(shapely.linestrings(points)), dtype=np.object_)


def upright(poses: Poses) -> Booleans:
    """Return whether the unit frames stand upright, ``(n | 1,)``: whether they are turned about the vertical alone."""
    result: Booleans = (poses.orientation[:, 0] == 0) & (poses.orientation[:, 1] == 0)
    return result


def _placed(poses: Poses, lanes: Indices, points: Floats) -> Floats:
    world = poses.take(lanes).to_world(points[np.newaxis])
    return np.broadcast_to(world, (len(lanes), *world.shape[1:]))


__all__ = ["Area", "Geometries", "cuts", "hulls", "shadows", "shadows_meet", "upright"]
