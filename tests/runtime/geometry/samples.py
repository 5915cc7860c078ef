"""Meshes, poses and independent oracles that the geometry tests share."""

import os
from functools import cache
from pathlib import Path

import manifold3d
import numpy as np
import pytest
import trimesh
from scipy.spatial.transform import Rotation

from scenic.graph import quaternions
from scenic.runtime.geometry.meshes import primitives
from scenic.runtime.geometry.meshes.booleans import difference, union
from scenic.runtime.geometry.meshes.loading import load_mesh
from scenic.runtime.geometry.meshes.mesh import Mesh
from scenic.runtime.geometry.poses import Poses

FOLDER = os.environ.get("SCENIC_TEST_MESHES")
FILES = sorted(Path(FOLDER).iterdir()) if FOLDER else []
real_meshes = pytest.mark.skipif(not FILES, reason="SCENIC_TEST_MESHES names no folder of meshes")


def placed(mesh: Mesh, position, size) -> Mesh:
    return Mesh(mesh.vertices * np.asarray(size, dtype=float) + position, mesh.faces)


@cache
def table() -> Mesh:
    """A unit mesh: a top on four legs."""
    legs = [
        placed(primitives.box(), (x, y, -0.05), (0.1, 0.1, 0.9)) for x in (-0.4, 0.4) for y in (-0.4, 0.4)
    ]
    return union([placed(primitives.box(), (0, 0, 0.45), (1, 1, 0.1)), *legs]).normalized()[0]


@cache
def hollow() -> Mesh:
    """A unit mesh: a box with a closed cavity of half its extents."""
    return difference(primitives.box(), [placed(primitives.box(), (0, 0, 0), (0.5, 0.5, 0.5))])


@cache
def bumpy(subdivisions: int = 4) -> Mesh:
    """A unit mesh: a star-shaped solid with many faces."""
    sphere = trimesh.creation.icosphere(subdivisions=subdivisions)
    x, y, z = sphere.vertices.T
    radius = 1 + 0.3 * np.sin(4 * x) * np.cos(3 * y) + 0.1 * np.sin(7 * z)
    return Mesh(sphere.vertices * radius[:, None], sphere.faces).normalized()[0]


@cache
def unit_mesh(path: Path) -> Mesh:
    return load_mesh(path).normalized()[0]


SHAPES = {
    "box": primitives.box,
    "cylinder": primitives.cylinder,
    "cone": primitives.cone,
    "spheroid": primitives.spheroid,
    "table": table,
    "hollow": hollow,
    "bumpy": lambda: bumpy(2),
}


def random_poses(count: int, seed: int, *, spread=1.0, sizes=(0.3, 1.5), same_size=False) -> Poses:
    rng = np.random.default_rng(seed)
    orientation = rng.normal(size=(count, 4))
    orientation /= np.linalg.norm(orientation, axis=1, keepdims=True)
    size = rng.uniform(*sizes, size=(1 if same_size else count, 3))
    return Poses(rng.uniform(-spread, spread, (count, 3)), orientation, size)


def yawed(position, yaw=0.0, size=(1, 1, 1)) -> Poses:
    return Poses.fixed(position, quaternions.from_euler(yaw, 0, 0), size)


def world_vertices(mesh: Mesh, poses: Poses, entry: int) -> np.ndarray:
    """The vertices of one entry in the world, by SciPy's rotations."""
    position, orientation, size = (
        part[entry if len(part) > 1 else 0] for part in (poses.position, poses.orientation, poses.size)
    )
    return Rotation.from_quat(orientation).apply(mesh.vertices * size) + position


def solid(mesh: Mesh, poses: Poses, entry: int) -> manifold3d.Manifold:
    vertices = np.ascontiguousarray(world_vertices(mesh, poses, entry))
    result = manifold3d.Manifold(manifold3d.Mesh64(vertices, np.array(mesh.faces, dtype=np.uint64)))
    assert result.status() == manifold3d.Error.NoError
    return result


def common_volume(mesh_a: Mesh, poses_a: Poses, mesh_b: Mesh, poses_b: Poses, entry: int) -> float:
    return (solid(mesh_a, poses_a, entry) ^ solid(mesh_b, poses_b, entry)).volume()


def gap(mesh_a: Mesh, poses_a: Poses, mesh_b: Mesh, poses_b: Poses, entry: int) -> float:
    """The distance between the surfaces, up to 0.1."""
    return solid(mesh_a, poses_a, entry).min_gap(solid(mesh_b, poses_b, entry), 0.1)


def in_batches(function, count: int, batch: int) -> list:
    return np.concatenate(
        [np.atleast_1d(function(np.arange(i, min(i + batch, count)))) for i in range(0, count, batch)]
    )
