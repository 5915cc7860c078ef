"""First hits of rays on bodies: closed form for boxes, Embree and double precision for other meshes.

Rays are taken into the unit frame of the mesh, where the parameter along the ray stays the same; so one index
serves every lane, pose and size. Embree names the face in single precision; where the ray meets it is decided again
in double precision, and where the single-precision answer is in doubt, every face that the ray may meet is looked at.
"""

from typing import Final

import numpy as np

from scenic.dataclass import dataclass
from scenic.runtime.geometry.meshes.bodies import Body
from scenic.runtime.geometry.meshes.embree import RayScene
from scenic.runtime.geometry.meshes.facegrid import face_grid
from scenic.runtime.geometry.meshes.mesh import Mesh
from scenic.runtime.geometry.poses import Booleans, Floats, Indices
from scenic.runtime.geometry.vectors import cross, dot, length
from scenic.runtime.geometry.views.observers import Views

_FEW_FACES: Final = 64
"""Faces up to which every face is compared where Embree's answer is in doubt."""

_CHUNK: Final = 1 << 18
"""Pairs of ray and face looked at together."""

_EDGE: Final = 1e-12
"""By how much, in parts of a face, a ray may pass beside an edge: no ray slips between two faces."""


@dataclass(frozen=True)
class SeenBodies:
    """A body over the lanes as the observers see it.

    Attributes:
        meshes: the meshes with the lanes that have them.
        mesh: number of the mesh in each lane, ``(n,)``.
        origin: the camera in the unit frame of the mesh, ``(n, 3)``.
        turn: matrices from directions in the view's frame to directions in the unit frame, ``(n, 3, 3)``.

    """

    meshes: tuple[Mesh, ...]
    mesh: Indices
    origin: Floats
    turn: Floats

    def rays(self, lane: Indices, directions: Floats) -> tuple[Floats, Floats]:
        """Origins and directions ``(r, 3)`` in the unit frames of rays in the view frames of lanes ``(r,)``."""
        matrix = self.turn[lane]
        x, y, z = directions[:, 0], directions[:, 1], directions[:, 2]
        turned = np.stack(
            [matrix[:, i, 0] * x + matrix[:, i, 1] * y + matrix[:, i, 2] * z for i in range(3)], axis=-1
        )
        return self.origin[lane], turned

    def first(self, lane: Indices, directions: Floats, *, exact: bool = False) -> Floats:
        """Return the distances at which rays first meet the surface, in lengths of their directions,
        ``(r,)``; infinite where they miss it.

        Args:
            lane: whose camera each ray starts from, ``(r,)``.
            directions: in the frame of the lane's view, ``(r, 3)``.
            exact: look at every face that the ray may meet in double precision.

        """
        origins, local_directions = self.rays(lane, directions)
        near, far = box_span(origins, local_directions)
        result = np.full(len(lane), np.inf)
        mesh = self.mesh[lane]
        touches = (far >= 0) & (near <= far * (1 + 1e-9) + 1e-12)
        for number, form in enumerate(self.meshes):
            rays_of_mesh = np.flatnonzero(touches & (mesh == number))
            if not len(rays_of_mesh):
                continue
            if form.is_box:
                entry = near[rays_of_mesh]
                result[rays_of_mesh] = np.where(entry >= 0, entry, far[rays_of_mesh])
            else:
                method = exact_first if exact else _quick_first
                result[rays_of_mesh] = method(
                    form, origins[rays_of_mesh], local_directions[rays_of_mesh], near[rays_of_mesh]
                )
        return result


def place(body: Body, views: Views, lanes: Indices) -> SeenBodies:
    """Return a body as seen in some of the lanes; the views have a row for each of these lanes."""
    poses = body.poses.take(lanes)
    count = len(lanes)
    origin = np.broadcast_to(poses.to_unit(views.camera), (count, 3))
    size = np.broadcast_to(poses.size, (count, 3))
    to_world, from_world = views.matrix, poses.matrix
    turn = np.empty((count, 3, 3))
    for i in range(3):
        for j in range(3):
            total = (
                from_world[:, 0, i] * to_world[:, 0, j]
                + from_world[:, 1, i] * to_world[:, 1, j]
                + from_world[:, 2, i] * to_world[:, 2, j]
            )
            turn[:, i, j] = total / size[:, i]
    choice = np.zeros(1, dtype=np.intp) if body.choice is None else body.choice
    mesh = np.broadcast_to(choice if len(choice) == 1 else choice[lanes], (count,))
    return SeenBodies(body.meshes, mesh, origin, turn)


def box_span(origins: Floats, directions: Floats) -> tuple[Floats, Floats]:
    """Return the parameters at which lines ``(r, 3)`` enter and leave the unit box; a line that leaves before
    it enters misses the box.
    """
    near, far = np.full(len(origins), -np.inf), np.full(len(origins), np.inf)
    with np.errstate(over="ignore"):
        for axis in range(3):
            way = directions[:, axis]
            # A line that runs along the faces meets them infinitely far away, or nowhere if it lies in one.
            inverse = 1 / np.where(np.abs(way) < 1e-300, 1e-300, way)
            low = (-0.5 - origins[:, axis]) * inverse
            high = (0.5 - origins[:, axis]) * inverse
            np.maximum(near, np.minimum(low, high), out=near)
            np.minimum(far, np.maximum(low, high), out=far)
    return near, far


def _quick_first(mesh: Mesh, origins: Floats, directions: Floats, near: Floats) -> Floats:
    """Return the first hits by Embree's faces, `exact_first` where those are in doubt."""
    lengths = length(directions)
    # From where they enter the unit box, so that coordinates stay small.
    starts = origins + np.maximum(near, 0.0)[:, None] * directions
    hits = mesh.derived(ray_scene).first_hits(
        starts.astype(np.float32), (directions / lengths[:, None]).astype(np.float32)
    )
    result = np.full(len(origins), np.inf)
    hit = np.flatnonzero(hits.triangle >= 0)
    crosses, distance = face_crossings(
        mesh, origins[hit], directions[hit], hits.triangle[hit].astype(np.intp)
    )
    result[hit] = distance
    doubtful = hit[~crosses | (distance < 0)]
    if len(doubtful):
        result[doubtful] = exact_first(mesh, origins[doubtful], directions[doubtful], near[doubtful])
    return result


def exact_first(mesh: Mesh, origins: Floats, directions: Floats, near: Floats) -> Floats:
    """Return the parameters ``(r,)`` at which rays ``(r, 3)`` in the unit frame first meet a mesh, in double precision."""
    result = np.full(len(origins), np.inf)
    few = len(mesh.faces) <= _FEW_FACES
    step = max(1, _CHUNK // _FEW_FACES)
    for begin in range(0, len(origins), step):
        part = np.arange(begin, min(begin + step, len(origins)))
        if few:
            ray = np.repeat(part, len(mesh.faces))
            face = np.tile(np.arange(len(mesh.faces)), len(part))
        else:
            # Lines are the same from any of their points; one near the box keeps rounding small.
            from_box = origins[part] + np.maximum(near[part], 0.0)[:, None] * directions[part]
            line, face = mesh.derived(face_grid).along_lines(from_box, directions[part])
            ray = part[line]
        crosses, distance = face_crossings(mesh, origins[ray], directions[ray], face)
        ahead = np.flatnonzero(crosses & (distance >= 0))
        np.minimum.at(result, ray[ahead], distance[ahead])
    return result


def face_crossings(
    mesh: Mesh, origins: Floats, directions: Floats, faces: Indices
) -> tuple[Booleans, Floats]:
    """Return whether lines ``(r, 3)`` cross faces ``(r,)``, closed at the edges, and at what parameter.

    Moeller and Trumbore, "Fast, minimum storage ray/triangle intersection", J. Graphics Tools 2(1), 1997.
    """
    corners = mesh.triangles[faces]
    a = corners[:, 0]
    ab, ac = corners[:, 1] - a, corners[:, 2] - a
    p = cross(directions, ac)
    determinant = dot(ab, p)
    scale = length(directions) * length(ab) * length(ac)
    proper = np.abs(determinant) > _EDGE * scale
    inverse = 1 / np.where(proper, determinant, 1.0)
    offset = origins - a
    q = cross(offset, ab)
    u, v = dot(offset, p) * inverse, dot(directions, q) * inverse
    # What rounding does to u and v grows with the distance to the face and where the ray grazes it.
    slack = _EDGE * (1 + length(offset) * scale * np.abs(inverse) / np.maximum(length(ab), 1e-300))
    crosses = proper & (u >= -slack) & (v >= -slack) & (u + v <= 1 + slack)
    return crosses, dot(ac, q) * inverse


def ray_scene(mesh: Mesh) -> RayScene:
    """Return Embree's index of a unit mesh; callers get it as ``mesh.derived(ray_scene)``."""
    return RayScene(mesh.triangles)
