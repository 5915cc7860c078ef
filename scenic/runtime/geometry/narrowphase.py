"""Whether two posed solids share a point, decided on their meshes.

Steps from cheap to dear, each on what the ones before leave open: oriented boxes apart; points known to lie
inside one solid found in solid cells of the other; boxes that cover one solid found in empty cells of the
other; surfaces that touch, by FCL; one solid wholly inside the other. What a step says of an entry depends on
that entry alone.
"""

from typing import Final

import numpy as np

from scenic.graph import quaternions
from scenic.runtime.geometry.affine import relative_map
from scenic.runtime.geometry.broadphase import boxes_overlap
from scenic.runtime.geometry.facegrid import face_grid
from scenic.runtime.geometry.fcl import SizedSurfaces, Surface
from scenic.runtime.geometry.inside import contains_points
from scenic.runtime.geometry.mesh import Mesh
from scenic.runtime.geometry.poses import Booleans, Floats, Indices, Poses
from scenic.runtime.geometry.proofs import ProofTable
from scenic.runtime.geometry.ragged import rows

_FEW_POINTS: Final = 3
"""Interior points, the deepest ones, that prove most collisions."""

_CHUNK: Final = 1 << 12
"""Entries looked at together, so that the temporary columns stay in the processor's cache."""

_MANY_FACES: Final = 20_000
"""Faces above which a mesh is indexed only around the other body."""

_CULLING_MARGIN: Final = 1e-6
"""How far outside the unit cube of the larger mesh faces of the smaller one are still kept."""


def meshes_intersect(mesh_a: Mesh, poses_a: Poses, mesh_b: Mesh, poses_b: Poses) -> Booleans:
    """Whether the solids share a point, ``(n,)``; touching counts, up to rounding.

    Both are closed unit meshes. Which frame the comparison works in depends on whether both poses are of
    constant size, and on the numbers of faces.
    """
    result = boxes_overlap(poses_a, poses_b)
    if mesh_a.is_box and mesh_b.is_box:
        return result
    table = ProofTable([mesh_a, mesh_b])
    near = np.flatnonzero(result)
    for part in rows(len(near), 1, _CHUNK):
        entries = near[part]
        zeros = np.zeros(len(entries), dtype=np.intp)
        together, left = quick_tests(table, zeros, poses_a.take(entries), zeros + 1, poses_b.take(entries))
        if left.any():
            entries = entries[left]
            together[left] = solids_touch(mesh_a, poses_a.take(entries), mesh_b, poses_b.take(entries))
        result[near[part]] = together
    return result


def quick_tests(
    table: ProofTable, meshes_a: Indices, poses_a: Poses, meshes_b: Indices, poses_b: Poses
) -> tuple[Booleans, Booleans]:
    """Which of at least one entries are proved to collide ``(n,)``, and which remain open ``(n,)``."""
    forth, back = relative_map(poses_a, poses_b), relative_map(poses_b, poses_a)
    together = np.zeros(len(meshes_a), dtype=np.bool_)
    left = np.arange(len(meshes_a))
    ways = ((meshes_a, meshes_b, forth), (meshes_b, meshes_a, back))
    for points in (slice(_FEW_POINTS), slice(_FEW_POINTS, None), None):
        for moving, still, maps in ways:
            if not len(left):
                break
            chosen = maps.take(left)
            if points is None:
                left = left[~table.distance(moving[left], still[left], chosen)]
            else:
                proved = table.contact(moving[left], still[left], chosen, points)
                together[left[proved]] = True
                left = left[~proved]
    remains = np.zeros(len(meshes_a), dtype=np.bool_)
    remains[left] = True
    return together, remains


def solids_touch(mesh_a: Mesh, poses_a: Poses, mesh_b: Mesh, poses_b: Poses) -> Booleans:
    """Whether the solids share a point, ``(n,)``, without any of the quick tests."""
    touching = surfaces_touch(mesh_a, poses_a, mesh_b, poses_b)
    apart = np.flatnonzero(~touching)
    if len(apart):
        a, b = poses_a.take(apart), poses_b.take(apart)
        touching[apart] = some_part_inside(mesh_a, a, mesh_b, b) | some_part_inside(mesh_b, b, mesh_a, a)
    return touching


def surfaces_touch(mesh_a: Mesh, poses_a: Poses, mesh_b: Mesh, poses_b: Poses) -> Booleans:
    """Whether the surfaces share a point, ``(n,)``, by FCL."""
    most = max(len(mesh_a.faces), len(mesh_b.faces))
    if poses_a.constant_size and poses_b.constant_size and most <= _MANY_FACES:
        return _rigid_surfaces_touch(mesh_a, poses_a, mesh_b, poses_b)
    if len(mesh_a.faces) >= len(mesh_b.faces):
        return _mapped_surfaces_touch(mesh_a, poses_a, mesh_b, poses_b)
    return _mapped_surfaces_touch(mesh_b, poses_b, mesh_a, poses_a)


def _rigid_surfaces_touch(mesh_a: Mesh, poses_a: Poses, mesh_b: Mesh, poses_b: Poses) -> Booleans:
    """With indices that serve all entries, in the frame of the first body."""
    still, moving = mesh_a.derived(SizedSurfaces), mesh_b.derived(SizedSurfaces)
    back = quaternions.conjugate(poses_a.orientation)
    count = max(len(poses_a), len(poses_b))
    position = quaternions.rotate(back, poses_b.position - poses_a.position)
    position = np.ascontiguousarray(np.broadcast_to(position, (count, 3)))
    orientation = np.broadcast_to(quaternions.multiply(back, poses_b.orientation), (count, 4))
    size_a = np.broadcast_to(poses_a.size, (count, 3))
    size_b = np.broadcast_to(poses_b.size, (count, 3))
    result = np.empty(count, dtype=np.bool_)
    for entry in range(count):
        other = moving.at(size_b[entry])
        other.place(position[entry], orientation[entry])
        result[entry] = still.at(size_a[entry]).touches(other)
    return result


def _mapped_surfaces_touch(large: Mesh, large_poses: Poses, small: Mesh, small_poses: Poses) -> Booleans:
    """In the unit frame of the larger mesh, whose index serves all sizes: affine maps keep intersections."""
    affine = relative_map(small_poses, large_poses)
    limit = 0.5 + _CULLING_MARGIN
    result = np.zeros(len(affine.offset[0]), dtype=np.bool_)
    for entry in range(len(result)):
        vertices = affine.of_entry(entry, small.vertices)
        outside = np.concatenate([vertices > limit, vertices < -limit], axis=1)[small.faces]
        near = ~np.logical_and.reduce(outside, axis=1).any(axis=1)
        if near.any():
            faces = small.faces[near]
            still = _surface_around(large, vertices[faces])
            result[entry] = still is not None and still.touches(Surface.of_faces(vertices, faces))
    return result


def _surface_around(mesh: Mesh, triangles: Floats) -> Surface | None:
    """An index of at least the faces of the unit mesh near some triangles; ``None`` if there are none.

    Indexing a large mesh takes seconds, so only the faces in question are indexed, unless they are many.
    """
    if len(mesh.faces) > _MANY_FACES:
        faces = mesh.derived(face_grid).sharing_cells(triangles)
        if not len(faces):
            return None
        if len(faces) <= _MANY_FACES:
            corners = mesh.triangles[faces].reshape(-1, 3)
            return Surface(corners, np.arange(len(corners)).reshape(-1, 3))
    return mesh.derived(SizedSurfaces).at(np.ones(3))


def some_part_inside(inner: Mesh, inner_poses: Poses, outer: Mesh, outer_poses: Poses) -> Booleans:
    """Whether a connected surface of ``inner`` lies in ``outer``, given that the surfaces do not touch."""
    x, y, z = (inner.component_vertices[:, i, None] for i in range(3))
    points = relative_map(inner_poses, outer_poses).columns((x, y, z))
    inside = contains_points(outer, np.stack([part.ravel() for part in points], axis=1))
    result: Booleans = np.logical_or.reduce(inside.reshape(points[0].shape), axis=0)
    return result
