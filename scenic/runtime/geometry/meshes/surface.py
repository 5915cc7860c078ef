"""The sides of a body's surface: which faces belong to them, and uniform points on them.

A face belongs to a side if the component of its unit normal, in the world frame, on the side's axis reaches a
threshold (section 9.6 of the specification). Sizes stretch normals and areas: under a map ``R diag(s)`` the
area vector ``a`` of a face becomes ``R (s_y s_z a_x, s_x s_z a_y, s_x s_y a_z)``. Which faces belong depends
on the size and on one row of R only, so lanes in which these are equal share the work.
"""

from collections.abc import Iterator
from typing import Final, TypeAlias

import numpy as np

from scenic.dataclass import dataclass
from scenic.graph import quaternions
from scenic.runtime.geometry.meshes.bodies import Body
from scenic.runtime.geometry.meshes.mesh import Mesh
from scenic.runtime.geometry.poses import Booleans, Floats, Indices, Poses
from scenic.runtime.geometry.ragged import distinct, rows
from scenic.runtime.geometry.vectors import cross, dot

Side: TypeAlias = tuple[int, int] | None
"""Axis of the world (0 to 2) and sign, or ``None`` for the whole surface."""

_CHUNK: Final = 1 << 16
"""Combinations of lane and face looked at together, so that temporary arrays stay in the processor's cache."""

_BLOCK: Final = 1 << 13
"""Faces whose areas are summed before a block is chosen."""

_SLACK: Final = 1e-12
"""By how much a unit normal may miss the threshold, for rounding."""

_VERTICAL: Final = 1e-9
"""Horizontal length of a face's ahead direction below which north is taken to be along the normal."""


def draw_faces(body: Body, side: Side, threshold: float, uniforms: Floats, lanes: int) -> Indices:
    """Return a random face of the side for each lane, by area in the world, ``(lanes,)``; -1 where it has no faces.

    Args:
        body: the body.
        side: axis and sign.
        threshold: what ``sign`` times the component of the normal must reach.
        uniforms: numbers in (0, 1), ``(lanes | 1,)``.
        lanes: the number of lanes.

    """
    result = np.full(lanes, -1, dtype=np.intp)
    draws = np.broadcast_to(uniforms, (lanes,))
    for mesh, lanes_of_mesh in body.by_mesh(lanes):
        poses = body.poses.take(lanes_of_mesh)
        kinds, kind_of = _stretches(poses, side, len(lanes_of_mesh))
        if len(mesh.faces) <= _BLOCK and 4 * len(kinds.size) > len(lanes_of_mesh):
            result[lanes_of_mesh] = _faces_one_by_one(mesh, kinds, kind_of, threshold, draws[lanes_of_mesh])
            continue
        totals = _block_areas(mesh, kinds, threshold)
        for kind, members in enumerate(_grouped(kind_of, len(kinds.size))):
            areas = np.cumsum(totals[kind])
            if areas[-1] > 0:
                result[lanes_of_mesh[members]] = _chosen_faces(
                    mesh, kinds.of(slice(kind, kind + 1)), threshold, areas, draws[lanes_of_mesh[members]]
                )
    return result


def _faces_one_by_one(
    mesh: Mesh, kinds: "_Stretches", kind_of: Indices, threshold: float, uniforms: Floats
) -> Indices:
    """Return the same as below for lanes that have little in common, and meshes of a single block."""
    result = np.full(len(kind_of), -1, dtype=np.intp)
    for part in rows(len(kind_of), len(mesh.faces), _CHUNK):
        areas = _areas(mesh, slice(None), kinds.of(kind_of[part]), threshold)
        targets = uniforms[part] * np.array([np.add.reduce(row) for row in areas])
        within = np.cumsum(areas, axis=1)
        ends = within[:, -1:]
        faces = np.minimum((within <= targets[:, None]).sum(axis=1), np.argmax(within == ends, axis=1))
        result[part] = np.where(ends[:, 0] > 0, faces, -1)
    return result


def _chosen_faces(
    mesh: Mesh, kind: "_Stretches", threshold: float, areas: Floats, uniforms: Floats
) -> Indices:
    """Draw faces by area: first a block of faces, then one of its faces."""
    targets = uniforms * areas[-1]
    blocks = np.searchsorted(areas, targets, side="right")
    # Rounding may carry the target to the very end; the last block with an area is meant.
    blocks = np.minimum(blocks, int(np.searchsorted(areas, areas[-1], side="left")))
    result = np.empty(len(uniforms), dtype=np.intp)
    for block in distinct(blocks):
        members = np.flatnonzero(blocks == block)
        start = int(block) * _BLOCK
        faces = slice(start, min(start + _BLOCK, len(mesh.faces)))
        within = np.cumsum(_areas(mesh, faces, kind, threshold)[0])
        rest = targets[members] - (areas[block - 1] if block else 0.0)
        numbers = np.searchsorted(within, rest, side="right")
        numbers = np.minimum(numbers, int(np.searchsorted(within, within[-1], side="left")))
        result[members] = start + numbers
    return result


def _block_areas(mesh: Mesh, kinds: "_Stretches", threshold: float) -> Floats:
    """Return the area of the side in each block of faces, ``(u, blocks)``."""
    starts = range(0, len(mesh.faces), _BLOCK)
    result = np.empty((len(kinds.size), len(starts)))
    for number, start in enumerate(starts):
        faces = slice(start, min(start + _BLOCK, len(mesh.faces)))
        for part in rows(len(kinds.size), faces.stop - faces.start, _CHUNK):
            areas = _areas(mesh, faces, kinds.of(part), threshold)
            # One row at a time, since sums over several rows at once may round differently.
            result[part, number] = [np.add.reduce(row) for row in areas]
    return result


def _areas(mesh: Mesh, faces: slice, kinds: "_Stretches", threshold: float) -> Floats:
    """Return the areas in the world of the faces that belong to the side, 0 for the others: ``(u, faces)``."""
    x, y, z = mesh.derived(_area_columns)
    squares = mesh.derived(_squared_area_columns)
    cx, cy, cz = (kinds.cofactors[:, i, None] for i in range(3))
    area = np.sqrt(
        (cx * cx) * squares[0, faces] + (cy * cy) * squares[1, faces] + (cz * cz) * squares[2, faces]
    )
    if kinds.axis is None:
        return area
    ax, ay, az = (kinds.axis[:, i, None] * kinds.cofactors[:, i, None] for i in range(3))
    along = ax * x[faces] + ay * y[faces] + az * z[faces]
    result: Floats = area * (along >= (threshold - _SLACK) * area)
    return result


def _area_columns(mesh: Mesh) -> Floats:
    return np.ascontiguousarray(mesh.area_vectors.T)


def _squared_area_columns(mesh: Mesh) -> Floats:
    return np.ascontiguousarray((mesh.area_vectors * mesh.area_vectors).T)


@dataclass(frozen=True, slots=True)
class _Stretches:
    """The stretching of the mesh, for u kinds of lanes, that decides which faces belong to a side and how large they are.

    Attributes:
        size: ``(u, 3)``.
        axis: the side's outward direction in the frame of the body, ``(u, 3)``; ``None`` for the whole surface.

    """

    size: Floats
    axis: Floats | None

    @property
    def cofactors(self) -> Floats:
        """The factors of the components of area vectors, ``(u, 3)``."""
        x, y, z = self.size.T
        return np.stack([y * z, x * z, x * y], axis=1)

    def of(self, chosen: Indices | slice) -> "_Stretches":
        """Return some of the kinds."""
        return _Stretches(self.size[chosen], None if self.axis is None else self.axis[chosen])


def _stretches(poses: Poses, side: Side, count: int) -> tuple[_Stretches, Indices]:
    """Return the different kinds among the lanes, and the kind of each lane ``(count,)``."""
    size = poses.size
    if side is None:
        keys = size
    else:
        axis = side[1] * poses.matrix[:, side[0], :] + 0.0  # turns -0.0 into 0.0
        length = max(len(size), len(axis))
        keys = np.concatenate(
            [np.broadcast_to(size, (length, 3)), np.broadcast_to(axis, (length, 3))], axis=1
        )
    if (keys == keys[0]).all():
        unique, kind_of = keys[:1], np.zeros(count, dtype=np.intp)
    else:
        unique, kind_of = np.unique(keys, axis=0, return_inverse=True)
    return _Stretches(unique[:, :3], None if side is None else unique[:, 3:]), kind_of.reshape(-1)


def _grouped(kind_of: Indices, kinds: int) -> Iterator[Indices]:
    """Yield the members of each kind."""
    order = np.argsort(kind_of, kind="stable")
    ends = np.searchsorted(kind_of[order], np.arange(1, kinds))
    yield from np.split(order, ends)


def side_contains(
    mesh: Mesh, poses: Poses, side: Side, threshold: float, entries: Indices, faces: Indices
) -> Booleans:
    """Return whether faces ``(m,)`` belong to the side of the mesh in the poses of ``entries`` ``(m,)``; none without area does."""
    proper: Booleans = mesh.areas[faces] > 0
    if side is None:
        return proper
    poses_here = poses.take(entries)
    axis = side[1] * poses_here.matrix[:, side[0], :] + 0.0
    cofactors = _Stretches(poses_here.size, axis).cofactors
    vectors = mesh.area_vectors[faces]
    # The same products in the same order as in `_areas`, so that the two always agree.
    cx, cy, cz = (cofactors[:, i] for i in range(3))
    squares = vectors * vectors
    area = np.sqrt((cx * cx) * squares[:, 0] + (cy * cy) * squares[:, 1] + (cz * cz) * squares[:, 2])
    ax, ay, az = (axis[:, i] * cofactors[:, i] for i in range(3))
    along = ax * vectors[:, 0] + ay * vectors[:, 1] + az * vectors[:, 2]
    return proper & (along >= (threshold - _SLACK) * area)


def mean_normals(body: Body, side: Side, threshold: float, lanes: int) -> Floats:
    """The area-weighted mean of the side's face normals in the world, ``(lanes, 3)``, not normalised.

    (0, 0, 1) where it vanishes (section 9.5 of the specification), or where the side has no faces.
    """
    result = np.empty((lanes, 3))
    for mesh, lanes_of_mesh in body.by_mesh(lanes):
        poses = body.poses.take(lanes_of_mesh)
        kinds, kind_of = _stretches(poses, side, len(lanes_of_mesh))
        sums = np.zeros((len(kinds.size), 3))
        total = np.zeros(len(kinds.size))
        for start in range(0, len(mesh.faces), _BLOCK):
            faces = slice(start, min(start + _BLOCK, len(mesh.faces)))
            columns = mesh.derived(_area_columns)[:, faces]
            for part in rows(len(kinds.size), faces.stop - faces.start, _CHUNK):
                areas = _areas(mesh, faces, kinds.of(part), threshold)
                total[part] += [np.add.reduce(row) for row in areas]
                for axis in range(3):
                    chosen_part = columns[axis] * (areas > 0)
                    sums[part, axis] += [np.add.reduce(row) for row in chosen_part]
        sums *= kinds.cofactors
        length = np.sqrt(dot(sums, sums))
        vanishes = length <= _VERTICAL * total
        world_normals = quaternions.rotate(poses.orientation, sums[kind_of])
        result[lanes_of_mesh] = np.where(vanishes[kind_of, None], (0.0, 0.0, 1.0), world_normals)
    return result


def face_points(body: Body, faces: Indices, first: Floats, second: Floats) -> Floats:
    """Points of faces in the world, ``(n, 3)``, uniform on each.

    Args:
        body: the body.
        faces: face numbers, ``(n,)``; where negative, the point means nothing.
        first: numbers in (0, 1), ``(n | 1,)``.
        second: likewise.

    """
    lanes = max(len(faces), len(first), len(second), len(body))
    faces = np.broadcast_to(faces, (lanes,))
    # The square root makes a strip parallel to the edge opposite the first corner as likely as it is long.
    root, along = (np.broadcast_to(part, (lanes,))[:, None] for part in (np.sqrt(first), second))
    result = np.empty((lanes, 3))
    for mesh, lanes_of_mesh in body.by_mesh(lanes):
        a, b, c = (mesh.triangles[np.maximum(faces[lanes_of_mesh], 0), corner] for corner in range(3))
        r, v = root[lanes_of_mesh], along[lanes_of_mesh]
        result[lanes_of_mesh] = body.poses.take(lanes_of_mesh).to_world(
            (1 - r) * a + r * (1 - v) * b + r * v * c
        )
    return result


def face_normals(body: Body, faces: Indices) -> Floats:
    """Return the unit normals of faces in the world, ``(n, 3)``."""
    lanes = max(len(faces), len(body))
    faces = np.broadcast_to(faces, (lanes,))
    result = np.empty((lanes, 3))
    for mesh, chosen in body.by_mesh(lanes):
        poses = body.poses.take(chosen)
        vectors = mesh.area_vectors[np.maximum(faces[chosen], 0)] * _Stretches(poses.size, None).cofactors
        result[chosen] = _unit(quaternions.rotate(poses.orientation, vectors))
    return result


def face_orientations(body: Body, faces: Indices) -> Floats:
    """Return the preferred orientations of faces, quaternions ``(n, 4)``.

    Local Z is the face's normal; local Y, straight ahead, is the direction in the face nearest to north
    (global +Y), so that yaw is as close to 0 as it can be; up if the normal itself is north or south.
    """
    z = face_normals(body, faces)
    north = np.stack([-z[:, 0] * z[:, 1], 1 - z[:, 1] * z[:, 1], -z[:, 2] * z[:, 1]], axis=1)
    level = z[:, 0] * z[:, 0] + z[:, 2] * z[:, 2] <= _VERTICAL * _VERTICAL
    up = np.stack([-z[:, 0] * z[:, 2], -z[:, 1] * z[:, 2], 1 - z[:, 2] * z[:, 2]], axis=1)
    y = _unit(np.where(level[:, None], up, north))
    return quaternions.from_axes(cross(y, z), y, z)


def _unit(vectors: Floats) -> Floats:
    x, y, z = vectors[:, 0], vectors[:, 1], vectors[:, 2]
    length = np.sqrt(x * x + y * y + z * z)
    return vectors / np.where(length > 0, length, 1.0)[:, None]
