"""Points and bodies over lanes: draws from solids, distances, bounds and measures."""

from typing import Final

import numpy as np

from scenic.graph.draws import mix, open_unit
from scenic.runtime.geometry.containment.distance import to_surface
from scenic.runtime.geometry.meshes import inside
from scenic.runtime.geometry.meshes.bodies import Body
from scenic.runtime.geometry.meshes.mesh import Mesh
from scenic.runtime.geometry.meshes.nearest import nearest_on_triangles
from scenic.runtime.geometry.meshes.prisms import shadow
from scenic.runtime.geometry.meshes.surface import Side, side_contains
from scenic.runtime.geometry.poses import Booleans, Floats, Indices, Poses
from scenic.runtime.geometry.ragged import rows

CHUNK: Final = 1 << 18
"""Pairs of points and faces looked at together."""

TRIES: Final = 20_000
"""Draws of one point before a solid counts as empty."""


def draw_points(body: Body, uniforms: Floats, keys: Floats) -> tuple[Floats, Booleans]:
    """Uniform points ``(n, 3)`` of solids, from numbers ``(3, n)`` and words ``(n,)``, and where one was found.

    A point of the bounding box is drawn until it lies inside: the first with the numbers, further ones keyed by the words.
    """
    lanes = uniforms.shape[1]
    points = np.zeros((lanes, 3))
    has_point = np.zeros(lanes, dtype=np.bool_)
    for mesh, lanes_of_mesh in body.by_mesh(lanes):
        local = uniforms.T[lanes_of_mesh] - 0.5
        is_inside = (
            np.ones(len(lanes_of_mesh), dtype=np.bool_)
            if mesh.is_box
            else inside.contains_points(mesh, local)
        )
        for attempt in range(TRIES):
            missing = np.flatnonzero(~is_inside)
            if not len(missing):
                break
            words = (
                np.asarray(keys)[lanes_of_mesh[missing]]
                if len(keys) > 1
                else np.broadcast_to(keys, len(missing))
            )
            seeds = mix(np.asarray(words, dtype=np.uint64) ^ np.uint64(attempt + 1))
            fresh = np.stack([open_unit(mix(seeds + np.uint64(axis))) for axis in range(3)], axis=-1) - 0.5
            local[missing] = fresh
            is_inside[missing] = inside.contains_points(mesh, fresh)
        points[lanes_of_mesh] = body.poses.take(lanes_of_mesh).to_world(local)
        has_point[lanes_of_mesh] = is_inside
    return points, has_point


def distances_to_surface(body: Body, points: Floats, side: Side, threshold: float) -> Floats:
    """Distances ``(n,)`` of points ``(n | 1, 3)`` from the faces of a side; infinite where it has none."""
    return _nearest(body, points, side, threshold)[0]


def nearest_faces(body: Body, points: Floats, side: Side, threshold: float) -> Indices:
    """The faces ``(n,)`` of a side nearest to points ``(n | 1, 3)``."""
    return _nearest(body, points, side, threshold)[1]


def _nearest(body: Body, points: Floats, side: Side, threshold: float) -> tuple[Floats, Indices]:
    lanes = max(len(body), len(points))
    if side is None:
        nearest_points = to_surface(body, points, lanes)
        return nearest_points.distance, nearest_points.number
    distance, face = np.empty(lanes), np.zeros(lanes, dtype=np.intp)
    for mesh, lanes_of_mesh in body.by_mesh(lanes):
        count = len(mesh.faces)
        step = max(1, CHUNK // count)
        for first in range(0, len(lanes_of_mesh), step):
            part = lanes_of_mesh[first : first + step]
            poses = body.poses.take(part)
            start = np.broadcast_to(points, (lanes, 3))[part]
            corners = np.broadcast_to(poses.to_world(mesh.triangles[np.newaxis]), (len(part), count, 3, 3))
            flat = corners.reshape(-1, 3, 3)
            targets = np.repeat(start, count, axis=0)
            gap = targets - nearest_on_triangles(targets, flat[:, 0], flat[:, 1], flat[:, 2])
            all_distances = np.sqrt((gap * gap).sum(axis=1))
            entries, faces = np.repeat(np.arange(len(part)), count), np.tile(np.arange(count), len(part))
            mine = side_contains(mesh, poses, side, threshold, entries, faces)
            table = np.where(mine, all_distances, np.inf).reshape(len(part), count)
            face[part] = table.argmin(axis=1)
            distance[part] = table.min(axis=1)
    return distance, face


def distances_from_box(body: Body, points: Floats) -> Floats:
    """Distances ``(n,)`` of points from the oriented bounding boxes: never more than those from the solids."""
    local = body.poses.to_unit(points)
    beside = np.maximum(np.abs(local) - 0.5, 0) * body.poses.size
    return np.asarray(np.sqrt((beside * beside).sum(axis=-1)))


_CORNERS: Final = 1 << 18
"""Corners in all lanes that are placed at a time."""


def bounds(body: Body) -> tuple[Floats, Floats]:
    """Return the corners ``(n | 1, 3)`` of the boxes along the axes of the world around solids, exact up to rounding."""
    lanes = len(body)
    lower, upper = np.empty((lanes, 3)), np.empty((lanes, 3))
    for mesh, lanes_of_mesh in body.by_mesh(lanes):
        # Which corner of the hull is farthest depends on how the body is turned.
        corners = mesh.outermost
        for some in rows(len(lanes_of_mesh), len(corners), _CORNERS):
            part = lanes_of_mesh[some]
            world = body.poses.take(part).to_world(corners[np.newaxis])
            lower[part], upper[part] = world.min(axis=1), world.max(axis=1)
    return lower, upper


def side_bounds(body: Body, side: Side, threshold: float) -> tuple[Floats, Floats]:
    """Return the corners ``(1, 3)`` of the box around the faces of a side of one solid; around the whole solid where the side has no faces."""
    ((mesh, _),) = body.by_mesh(1)
    count = len(mesh.faces)
    mine = side_contains(mesh, body.poses, side, threshold, np.zeros(count, dtype=np.intp), np.arange(count))
    if not mine.any():
        return bounds(body)
    corners = mesh.triangles[mine].reshape(1, -1, 3)
    world = body.poses.to_world(corners)
    return world.min(axis=1), world.max(axis=1)


def volumes(body: Body) -> Floats:
    """Return the volumes ``(n | 1,)`` of solids."""
    result = np.empty(len(body))
    size = body.poses.size
    scale = np.broadcast_to(size[:, 0] * size[:, 1] * size[:, 2], len(body))
    for mesh, chosen in body.by_mesh(len(body)):
        result[chosen] = mesh.volume * scale[chosen]
    return result


def areas(body: Body, side: Side, threshold: float) -> Floats:
    """Return the areas ``(n | 1,)`` of the faces of a side."""
    result = np.empty(len(body))
    for mesh, lanes_of_mesh in body.by_mesh(len(body)):
        for lane in lanes_of_mesh.tolist():
            poses = body.poses.take(np.array([lane if len(body.poses) > 1 else 0]))
            world = poses.to_world(mesh.triangles[np.newaxis])[0]
            normal = np.cross(world[:, 1] - world[:, 0], world[:, 2] - world[:, 0])
            mine = side_contains(
                mesh, poses, side, threshold, np.zeros(len(world), np.intp), np.arange(len(world))
            )
            result[lane] = (np.sqrt((normal * normal).sum(axis=1)) / 2)[mine].sum()
    return result


def planar_inradii(body: Body) -> Floats:
    """Radii ``(n | 1,)`` of the largest discs about the positions within the solids seen along their own z; 0 where a position is outside."""
    result = np.empty(len(body))
    for mesh, lanes_of_mesh in body.by_mesh(len(body)):
        edges, is_inside = mesh.derived(_silhouette)
        size = body.poses.take(lanes_of_mesh).size[:, np.newaxis, :2]
        start, end = edges[:, 0] * size, edges[:, 1] * size
        along = end - start
        squares = np.maximum((along * along).sum(axis=2), np.finfo(float).tiny)
        share = np.clip(-(start * along).sum(axis=2) / squares, 0, 1)[..., np.newaxis]
        nearest = start + share * along
        gaps = np.sqrt((nearest * nearest).sum(axis=2)).min(axis=1)
        result[lanes_of_mesh] = gaps if is_inside else 0.0
    return result


def _silhouette(mesh: Mesh) -> tuple[Floats, bool]:
    """The edges ``(k, 2, 2)`` of a mesh seen from above, and whether the origin lies within them."""
    import shapely

    outline = shadow(mesh)
    rings = [np.asarray(ring.coords) for ring in shapely.get_rings(shapely.get_parts(outline))]
    edges = np.concatenate([np.stack([ring[:-1], ring[1:]], axis=1) for ring in rings])
    return edges, bool(outline.covers(shapely.Point(0, 0)))


def inradii(body: Body) -> Floats:
    """Return the radii ``(n | 1,)`` of balls about the positions that the solids contain; 0 where the position is outside."""
    result = np.zeros(len(body))
    for mesh, lanes_of_mesh in body.by_mesh(len(body)):
        poses = body.poses.take(lanes_of_mesh)
        if mesh.is_box:
            result[lanes_of_mesh] = poses.size.min(axis=1) / 2
        elif _holds_origin(mesh):
            result[lanes_of_mesh] = distances_to_surface(
                Body((mesh,), None, Poses(np.zeros((1, 3)), np.array([[0.0, 0, 0, 1]]), poses.size)),
                np.zeros((1, 3)),
                None,
                0.0,
            )
    return result


def _holds_origin(mesh: Mesh) -> bool:
    return bool(inside.contains_points(mesh, np.zeros((1, 3)))[0])
