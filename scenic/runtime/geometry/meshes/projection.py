"""Projection of points onto a side of a body's surface (section 9.5 of the specification), in double precision.

Lines are taken into the unit frame of the mesh, where the parameter along the line stays the same. Small
meshes are compared face by face; for large ones a grid names the few faces a line may meet.
"""

from typing import Final

import numpy as np

from scenic.runtime.geometry.meshes.bodies import Body
from scenic.runtime.geometry.meshes.facegrid import face_grid
from scenic.runtime.geometry.meshes.mesh import Mesh
from scenic.runtime.geometry.meshes.nearest import nearest_on_triangles
from scenic.runtime.geometry.meshes.surface import Side, face_normals, side_contains
from scenic.runtime.geometry.poses import Booleans, Floats, Indices, Poses
from scenic.runtime.geometry.ragged import first_of_each, rows
from scenic.runtime.geometry.vectors import cross, dot, length

TOLERANCE: Final = 1e-6
"""Metres within which a point is on a surface."""

_FEW_FACES: Final = 64
"""Faces up to which every face is compared."""

_CHUNK: Final = 1 << 18
"""Pairs of line and face looked at together."""

_EDGE: Final = 1e-12
"""By how much, in parts of a face, a line may pass beside an edge: no line slips between two faces."""


def project(
    body: Body, side: Side, threshold: float, points: Floats, directions: Floats, lanes: int
) -> tuple[Indices, Floats]:
    """The faces ``(lanes,)`` and the points of the world ``(lanes, 3)`` where points land.

    A point within `TOLERANCE` of the side stays where it is; otherwise it moves along its direction or
    against it, to the nearest point of the side. The face is -1, and the point means nothing, where the line
    misses the side.

    Args:
        body: the body.
        side: axis and sign, or ``None`` for the whole surface.
        threshold: what ``sign`` times the component of the normal must reach.
        points: ``(lanes | 1, 3)``.
        directions: ``(lanes | 1, 3)``, of any length; a line of direction 0 misses.
        lanes: the number of lanes.

    """
    faces = np.full(lanes, -1, dtype=np.intp)
    travel = np.zeros(lanes)
    for mesh, lanes_of_mesh in body.by_mesh(lanes):
        poses = body.poses.take(lanes_of_mesh)
        start, way = (part if len(part) == 1 else part[lanes_of_mesh] for part in (points, directions))
        faces[lanes_of_mesh] = _faces_near(mesh, poses, side, threshold, start, len(lanes_of_mesh))
        left = np.flatnonzero(faces[lanes_of_mesh] < 0)
        if len(left):
            hits = _nearest_hits(mesh, poses, side, threshold, start, way, left)
            faces[lanes_of_mesh[left]], travel[lanes_of_mesh[left]] = hits
    return faces, points + travel[:, None] * directions


def landing_points(body: Body, faces: Indices, points: Floats, directions: Floats) -> Floats:
    """Return the points ``(n, 3)`` at which lines meet the planes of given faces: `project`, once the faces are known.

    A point within `TOLERANCE` of its face stays where it is.
    """
    lanes = max(len(faces), len(points), len(directions), len(body))
    faces = np.broadcast_to(faces, (lanes,))
    normals = face_normals(body, faces)
    travel = np.zeros(lanes)
    for mesh, lanes_of_mesh in body.by_mesh(lanes):
        start, way = (np.broadcast_to(part, (lanes, 3))[lanes_of_mesh] for part in (points, directions))
        corners = body.poses.take(lanes_of_mesh).to_world(mesh.triangles[np.maximum(faces[lanes_of_mesh], 0)])
        height = dot(normals[lanes_of_mesh], corners[:, 0] - start)
        rate = dot(normals[lanes_of_mesh], way)
        distance = length(start - nearest_on_triangles(start, corners[:, 0], corners[:, 1], corners[:, 2]))
        moves = (distance > TOLERANCE) & (rate != 0)
        travel[lanes_of_mesh] = np.where(moves, height / np.where(moves, rate, 1.0), 0.0)
    return points + travel[:, None] * directions


def near_surface(
    body: Body,
    side: Side,
    threshold: float,
    points: Floats,
    lanes: int,
    tolerance: float = TOLERANCE,
) -> Booleans:
    """The mask ``(lanes,)`` of points ``(lanes | 1, 3)`` within the tolerance of the side."""
    result = np.zeros(lanes, dtype=np.bool_)
    for mesh, lanes_of_mesh in body.by_mesh(lanes):
        poses = body.poses.take(lanes_of_mesh)
        start = points if len(points) == 1 else points[lanes_of_mesh]
        result[lanes_of_mesh] = (
            _faces_near(mesh, poses, side, threshold, start, len(lanes_of_mesh), tolerance) >= 0
        )
    return result


def _faces_near(
    mesh: Mesh,
    poses: Poses,
    side: Side,
    threshold: float,
    points: Floats,
    count: int,
    tolerance: float = TOLERANCE,
) -> Indices:
    """The first face of the side within the tolerance of each point, ``(count,)``; -1 if there is none."""
    local = np.broadcast_to(poses.to_unit(points), (count, 3))
    size = np.broadcast_to(poses.size, (count, 3))
    reach = tolerance / size
    result = np.full(count, -1, dtype=np.intp)
    few = _few_faces(mesh, poses, side, threshold)
    for part in rows(count, 1, _CHUNK // _FEW_FACES):
        if few is not None:
            entry, face = _all_pairs(part, few)
        else:
            entry, face = mesh.derived(face_grid).near_points(local[part], reach[part])
            entry = entry + part.start
        widest = reach[entry].max(axis=1)
        offset = local[entry] - mesh.triangles[face, 0]
        # The plane is close in the world only if it is close in the unit frame, where the smallest extent rules.
        close = np.flatnonzero(np.abs(dot(mesh.normals[face], offset)) <= widest)
        entry, face = entry[close], face[close]
        close = np.flatnonzero(side_contains(mesh, poses, side, threshold, entry, face))
        entry, face = entry[close], face[close]
        if len(entry):
            corners = [mesh.triangles[face, corner] * size[entry] for corner in range(3)]
            place = local[entry] * size[entry]
            distance = length(place - nearest_on_triangles(place, *corners))
            within = np.flatnonzero(distance <= tolerance)
            first = within[first_of_each(entry[within])]
            result[entry[first]] = face[first]
    return result


def _nearest_hits(
    mesh: Mesh,
    poses: Poses,
    side: Side,
    threshold: float,
    points: Floats,
    directions: Floats,
    chosen: Indices,
) -> tuple[Indices, Floats]:
    """Return for each of the chosen entries the face hit first, or -1, and the signed way there in directions."""
    poses_here = poses.take(chosen)
    start, way = (part if len(part) == 1 else part[chosen] for part in (points, directions))
    local = np.broadcast_to(poses_here.to_unit(start), (len(chosen), 3))
    course = np.broadcast_to(poses_here.directions_to_unit(way), (len(chosen), 3))
    faces, travel = np.full(len(chosen), -1, dtype=np.intp), np.zeros(len(chosen))
    few = _few_faces(mesh, poses_here, side, threshold)
    for part in rows(len(chosen), 1, _CHUNK // _FEW_FACES):
        if few is not None:
            entry, face = _all_pairs(part, few)
        else:
            moving = np.flatnonzero((course[part] != 0).any(axis=1)) + part.start
            line, face = mesh.derived(face_grid).along_lines(local[moving], course[moving])
            entry = moving[line]
        hits, distance = _crossings(mesh, local[entry], course[entry], face)
        entry, face, distance = entry[hits], face[hits], distance[hits]
        belongs = side_contains(mesh, poses_here, side, threshold, entry, face)
        entry, face, distance = entry[belongs], face[belongs], distance[belongs]
        order = np.lexsort((face, np.abs(distance), entry))
        first = order[first_of_each(entry[order])]
        faces[entry[first]], travel[entry[first]] = face[first], distance[first]
    return faces, travel


def _few_faces(mesh: Mesh, poses: Poses, side: Side, threshold: float) -> Indices | None:
    """The faces to compare one by one, if they are few: those of the side, where that is the same in all lanes."""
    if len(mesh.faces) > _FEW_FACES:
        return None
    faces = np.arange(len(mesh.faces))
    if len(poses) > 1:
        return faces
    return faces[side_contains(mesh, poses, side, threshold, np.zeros_like(faces), faces)]


def _all_pairs(part: slice, faces: Indices) -> tuple[Indices, Indices]:
    entries = np.arange(part.start, part.stop)
    return np.repeat(entries, len(faces)), np.tile(faces, len(entries))


def _crossings(mesh: Mesh, points: Floats, directions: Floats, faces: Indices) -> tuple[Booleans, Floats]:
    """Return whether lines ``(m, 3)`` cross faces ``(m,)``, and at what parameter.

    Moeller and Trumbore, "Fast, minimum storage ray/triangle intersection", J. Graphics Tools 2(1), 1997;
    closed at the edges.
    """
    a = mesh.triangles[faces, 0]
    ab, ac = mesh.triangles[faces, 1] - a, mesh.triangles[faces, 2] - a
    p = cross(directions, ac)
    determinant = dot(ab, p)
    scale = length(directions) * length(ab) * length(ac)
    crosses = np.abs(determinant) > _EDGE * scale
    inverse = 1 / np.where(crosses, determinant, 1.0)
    offset = points - a
    u = dot(offset, p) * inverse
    q = cross(offset, ab)
    v = dot(directions, q) * inverse
    # What rounding does to u and v grows with the distance to the face and where the line grazes it.
    slack = _EDGE * (1 + length(offset) * scale * np.abs(inverse) / np.maximum(length(ab), 1e-300))
    hits = crosses & (u >= -slack) & (v >= -slack) & (u + v <= 1 + slack)
    return hits, dot(ac, q) * inverse
