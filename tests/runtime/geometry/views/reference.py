"""Visibility by the letter of the specification: every ray of the view, every triangle of the world, no shortcuts."""

import math

import numpy as np
import numpy.typing as npt
from scipy.spatial.transform import Rotation

from scenic.runtime.geometry.meshes.bodies import Body
from scenic.runtime.geometry.meshes.mesh import Mesh
from scenic.runtime.geometry.views.observers import Views

Array = npt.NDArray[np.float64]

SLACK = 1e-9


def mesh_of(body: Body, lane: int) -> Mesh:
    choice = 0 if body.choice is None else int(body.choice[lane if len(body.choice) > 1 else 0])
    return body.meshes[choice]


def row(column: npt.NDArray, lane: int) -> npt.NDArray:
    return column[lane if len(column) > 1 else 0]


def to_world(body: Body, lane: int, points: Array) -> Array:
    poses = body.poses
    turn = Rotation.from_quat(row(poses.orientation, lane))
    return turn.apply(points * row(poses.size, lane)) + row(poses.position, lane)


def triangles(body: Body, lane: int) -> Array:
    mesh = mesh_of(body, lane)
    return to_world(body, lane, mesh.vertices)[mesh.faces]


def winding(points: Array, faces: Array) -> Array:
    """How often closed surfaces wind round points (van Oosterom and Strackee, 1983)."""
    a, b, c = (faces[None, :, i] - points[:, None] for i in range(3))
    la, lb, lc = (np.linalg.norm(x, axis=-1) for x in (a, b, c))
    top = (a * np.cross(b, c)).sum(axis=-1)
    bottom = la * lb * lc + (a * b).sum(-1) * lc + (b * c).sum(-1) * la + (c * a).sum(-1) * lb
    return 2 * np.arctan2(top, bottom).sum(axis=1) / (4 * np.pi)


def first_hits(origin: Array, directions: Array, faces: Array) -> Array:
    """The first meeting of each ray with any triangle, in lengths of the direction; infinite for none."""
    result = np.full(len(directions), np.inf)
    for a, b, c in faces:
        matrix = np.stack([directions, *np.broadcast_arrays(a - b, a - c, directions)[:2]], axis=-1)
        right = np.broadcast_to((a - origin)[:, None], (len(directions), 3, 1))
        determinant = np.linalg.det(matrix)
        good = np.abs(determinant) > 1e-14
        solved = np.linalg.solve(np.where(good[:, None, None], matrix, np.eye(3)), right)[..., 0]
        t, u, v = solved[:, 0], solved[:, 1], solved[:, 2]
        hit = good & (t >= 0) & (u >= -1e-12) & (v >= -1e-12) & (u + v <= 1 + 1e-12)
        result = np.where(hit & (t < result), t, result)
    return result


def window(views: Views, lane: int) -> tuple[float, float]:
    h, v = row(views.angles, lane)
    return (
        2 * math.pi if h >= 2 * math.pi - 0.017 else float(h),
        math.pi if v >= math.pi - 0.017 else float(v),
    )


def sees_point(views: Views, point: Array, occluders: list[Body], lane: int) -> bool:
    camera = row(views.camera, lane)
    offset = point - camera
    distance = float(np.linalg.norm(offset))
    if distance == 0:
        return True
    if distance > row(views.distance, lane) * (1 + SLACK):
        return False
    x, y, z = Rotation.from_quat(row(views.orientation, lane)).inv().apply(offset)
    h, v = window(views, lane)
    azimuth = (math.atan2(y, x) - math.pi / 2 + math.pi) % (2 * math.pi) - math.pi
    upright = math.hypot(x, y) <= SLACK * abs(z)
    if not upright and abs(azimuth) > h / 2 + SLACK:
        return False
    if abs(math.atan2(z, math.hypot(x, y))) > v / 2 + SLACK:
        return False
    return all(first_hits(camera, offset[None], triangles(body, lane))[0] > 1 + SLACK for body in occluders)


def grid(views: Views, lane: int, distance: float) -> Array:
    """All rays of a view in its frame."""
    h, v = window(views, lane)
    scale = distance if row(views.scaling, lane) else 1.0
    density = float(row(views.density, lane)) * scale
    columns, lines = row(views.count, lane)
    scaled = columns == 0
    columns = columns or max(1, math.ceil(math.degrees(h) * density - 1e-9))
    lines = lines or max(1, math.ceil(math.degrees(v) * density - 1e-9))
    rays = []
    for j in range(int(lines)):
        altitude = -v / 2 + (j + 0.5) * v / lines
        across = max(1, round(columns * math.cos(altitude))) if scaled else int(columns)
        azimuth = -h / 2 + (np.arange(across) + 0.5) * h / across
        rays.append(
            np.stack([-np.sin(azimuth), np.cos(azimuth), np.full(across, math.tan(altitude))], axis=-1)
        )
    found = np.concatenate(rays)
    return found / np.linalg.norm(found, axis=1, keepdims=True)


def sees_body(views: Views, target: Body, occluders: list[Body], lane: int) -> bool:
    camera = row(views.camera, lane)
    position = row(target.poses.position, lane)
    faces = triangles(target, lane)
    if abs(winding(camera[None], faces)[0]) > 0.5:
        return True
    own_centre = abs(winding(position[None], faces)[0]) > 0.5
    if own_centre and sees_point(views, position, occluders, lane):
        return True
    rays = Rotation.from_quat(row(views.orientation, lane)).apply(
        grid(views, lane, float(np.linalg.norm(position - camera)))
    )
    met = first_hits(camera, rays, faces)
    candidates = met <= row(views.distance, lane) * (1 + SLACK)
    rays, met = rays[candidates], met[candidates]
    for body in occluders:
        free = first_hits(camera, rays, triangles(body, lane)) > met * (1 + SLACK)
        rays, met = rays[free], met[free]
    return bool(len(rays))
