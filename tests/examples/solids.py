"""The solids of a scene, made again from what its file format says: the engine's own geometry is not used."""

import functools
from pathlib import Path
from typing import Any

import manifold3d
import numpy as np
import trimesh
from manifold3d import Manifold

from scenic.formats.json_lines import scene_document

MESHES = Path(__file__).parents[2] / "examples" / "meshes"


@functools.cache
def unit_mesh(kind: str, path: str | None = None) -> trimesh.Trimesh:
    """A mesh that fills the unit box about the origin."""
    match kind:
        case "box":
            mesh = trimesh.creation.box()
        case "cylinder":
            mesh = trimesh.creation.cylinder(0.5, 1, sections=24)
        case "cone":
            mesh = trimesh.creation.cone(0.5, 1, sections=24)
        case "spheroid":
            mesh = trimesh.creation.icosphere(subdivisions=3, radius=0.5)
        case "mesh":
            mesh = trimesh.load(path, force="mesh")
    assert mesh.is_volume
    low, high = mesh.bounds
    mesh.apply_translation(-(low + high) / 2)
    mesh.apply_scale(1 / (high - low))
    return mesh


class Thing:
    """One object of a scene's document, as a solid."""

    def __init__(self, entry: dict[str, Any]) -> None:
        self.name: str | None = entry["name"]
        self.class_name: str = entry["class"]
        self.position = np.array(entry["position"])
        self.size = np.array(entry["size"])
        self.entry = entry
        x, y, z, w = entry["quaternion"]
        self.rotation = trimesh.transformations.quaternion_matrix([w, x, y, z])[:3, :3]
        mesh = unit_mesh(entry["shape"]["kind"], entry["shape"].get("path"))
        self.vertices = (mesh.vertices * self.size) @ self.rotation.T + self.position
        self.faces = mesh.faces

    @property
    def solid(self) -> Manifold:
        made = Manifold(
            manifold3d.Mesh64(
                np.ascontiguousarray(self.vertices), np.ascontiguousarray(self.faces, dtype=np.uint64)
            )
        )
        assert made.status() == manifold3d.Error.NoError
        assert made.volume() > 0
        return made

    @property
    def bounds(self) -> tuple[np.ndarray, np.ndarray]:
        return self.vertices.min(axis=0), self.vertices.max(axis=0)

    @property
    def bottom(self) -> float:
        return float(self.vertices[:, 2].min())

    @property
    def top(self) -> float:
        return float(self.vertices[:, 2].max())

    def local(self, point: np.ndarray) -> np.ndarray:
        """A place as this object sees it: to its right, ahead of it, above it."""
        return self.rotation.T @ (point - self.position)


def things(scene: Any) -> list[Thing]:
    return [Thing(entry) for entry in scene_document(scene)["objects"]]


def by_name(scene: Any) -> dict[str, Thing]:
    return {thing.name: thing for thing in things(scene) if thing.name}


def overlap(first: Thing, second: Thing) -> float:
    """The volume that two solids share, in cubic metres."""
    return float((first.solid ^ second.solid).volume())


def boxes_overlap(first: Thing, second: Thing) -> bool:
    (low, high), (other_low, other_high) = first.bounds, second.bounds
    return bool(np.all(low < other_high) and np.all(other_low < high))
