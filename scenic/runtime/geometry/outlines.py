"""Bodies seen from above and cut by level planes, as shapely geometries: one for each lane.

Every function is elementwise: the geometry of a lane depends on that lane alone.
"""

from typing import Final

import numpy as np
import numpy.typing as npt

from scenic.runtime.geometry.bodies import Body
from scenic.runtime.geometry.mesh import Mesh
from scenic.runtime.geometry.poses import Booleans, Floats, Indices, Poses
from scenic.runtime.geometry.prisms import shadow
from scenic.runtime.geometry.ragged import distinct, rows

Geometries = npt.NDArray[np.object_]
"""Shapely geometries ``(n,)``; empty polygons where there is nothing."""

_CHUNK: Final = 1 << 18
"""Combinations of lane and vertex looked at together."""

_INSET: Final = 1e-9
"""By how much, relative to the height of a body, a plane through its lowest or highest face is moved into it."""


def shadows(body: Body, lanes: Indices) -> Geometries:
    """The outlines ``(n,)`` of the body seen from above, in some lanes."""
    import shapely

    result: Geometries = np.empty(len(lanes), dtype=np.object_)
    part = body.take(lanes) if len(body) > 1 else body
    for mesh, chosen in part.by_mesh(len(lanes)):
        if mesh.is_convex:
            corners = mesh.hull.vertices
            for some in rows(len(chosen), len(corners), _CHUNK):
                world = _placed(part.poses, chosen[some], corners)
                result[chosen[some]] = hulls(world[..., :2])
        else:
            standing = np.broadcast_to(upright(part.poses.take(chosen)), len(chosen))
            result[chosen[standing]] = _standing(mesh, part.poses, chosen[standing])
            chosen = chosen[~standing]
            for some in rows(len(chosen), 3 * len(mesh.faces), _CHUNK):
                world = _placed(part.poses, chosen[some], mesh.vertices)[..., :2]
                flat = world[:, mesh.faces]
                first, second = flat[:, :, 1] - flat[:, :, 0], flat[:, :, 2] - flat[:, :, 0]
                proper = first[..., 0] * second[..., 1] != first[..., 1] * second[..., 0]
                triangles = np.where(proper, shapely.polygons(flat), None)
                result[chosen[some]] = shapely.union_all(triangles, axis=1)
    return result


def _standing(mesh: Mesh, poses: Poses, lanes: Indices) -> Geometries:
    """The outlines from above of a mesh that stands upright: all are images of one."""
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
    """The areas ``(n,)`` where the body meets level planes at ``heights``, ``(n | 1,)``, in some lanes."""
    import shapely

    result: Geometries = np.full(len(lanes), shapely.Polygon(), dtype=np.object_)
    part = body.take(lanes) if len(body) > 1 else body
    levels = np.broadcast_to(heights, len(lanes))
    for mesh, every in part.by_mesh(len(lanes)):
        for some in rows(len(every), len(mesh.faces), _CHUNK):
            chosen = every[some]
            world = _placed(part.poses, chosen, mesh.vertices)
            used = world[:, distinct(mesh.faces), 2]
            low, high = used.min(axis=1), used.max(axis=1)
            met = np.flatnonzero((low <= levels[chosen]) & (levels[chosen] <= high))
            inset = _INSET * np.maximum(1.0, high - low)[met]
            level = np.clip(levels[chosen[met]], low[met] + inset, high[met] - inset)
            found = _cut(mesh, world[met], level)
            result[chosen[met]] = found
    return result


def _cut(mesh: Mesh, world: Floats, level: Floats) -> Geometries:
    """The areas where planes meet a mesh with vertices ``(n, v, 3)``."""
    import shapely

    edges, sides = mesh.derived(_edges)
    start, end = world[:, edges[:, 0]], world[:, edges[:, 1]]
    below, above = start[..., 2] < level[:, None], end[..., 2] < level[:, None]
    crossed = below != above
    rise = np.where(crossed, end[..., 2] - start[..., 2], 1.0)
    share = ((level[:, None] - start[..., 2]) / rise)[..., None]
    points = start[..., :2] + share * (end[..., :2] - start[..., :2])
    if mesh.is_convex:
        owner, number = np.nonzero(crossed)
        gathered = shapely.multipoints(points[owner, number], indices=owner)
        return np.asarray(shapely.convex_hull(gathered), dtype=np.object_)
    # A face whose corners lie on both sides is cut along a segment between two of its edges.
    cut = crossed[:, sides]
    owner, face = np.nonzero(cut.any(axis=2))
    order = np.argsort(~cut[owner, face], axis=1, kind="stable")[:, :2]
    ends = points[owner[:, None], sides[face[:, None], order]]
    lines = shapely.multilinestrings(shapely.linestrings(ends), indices=owner)
    return np.asarray(shapely.build_area(lines), dtype=np.object_)


def _edges(mesh: Mesh) -> tuple[Indices, Indices]:
    """The edges ``(e, 2)`` of a mesh, and those of each face ``(f, 3)``."""
    pairs = np.sort(mesh.faces[:, [0, 1, 1, 2, 2, 0]].reshape(-1, 2), axis=1)
    edges, numbers = np.unique(pairs, axis=0, return_inverse=True)
    return edges, numbers.reshape(-1, 3)


def hulls(points: Floats) -> Geometries:
    """The convex hulls of points ``(n, k, 2)``."""
    import shapely

    count, size = points.shape[:2]
    owner = np.repeat(np.arange(count), size)
    gathered = shapely.multipoints(points.reshape(-1, 2), indices=owner)
    return np.asarray(shapely.convex_hull(gathered), dtype=np.object_)


def upright(poses: Poses) -> Booleans:
    """Whether the unit frames stand upright, ``(n | 1,)``: whether they are turned about the vertical alone."""
    result: Booleans = (poses.orientation[:, 0] == 0) & (poses.orientation[:, 1] == 0)
    return result


def _placed(poses: Poses, lanes: Indices, points: Floats) -> Floats:
    world = poses.take(lanes).to_world(points[np.newaxis])
    return np.broadcast_to(world, (len(lanes), *world.shape[1:]))


__all__ = ["Geometries", "cuts", "hulls", "shadows", "upright"]
