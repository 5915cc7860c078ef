"""Exact convex parts, beside the solids that they make up."""

from pathlib import Path

import numpy as np
import pytest
import trimesh
from scipy.spatial import ConvexHull

from scenic.runtime.geometry.meshes.exact_parts import exact_parts

MESHES = Path(__file__).parents[3] / "examples" / "meshes"


def in_unit_box(mesh: trimesh.Trimesh) -> trimesh.Trimesh:
    return trimesh.Trimesh((mesh.vertices - mesh.bounds.mean(axis=0)) / mesh.extents, mesh.faces)


def check(mesh: trimesh.Trimesh) -> int:
    """The number of parts, 0 if there are none; they have the solid's volume in sum, and no point of one is outside the solid; so they do not overlap either."""
    parts = exact_parts(np.asarray(mesh.vertices), np.asarray(mesh.faces), 96)
    if parts is None:
        return 0
    volumes = [ConvexHull(part).volume for part in parts]
    assert sum(volumes) == pytest.approx(mesh.volume, rel=3e-4)
    generator = np.random.default_rng(3)
    points = np.concatenate([generator.dirichlet(np.ones(len(part)), 20) @ part for part in parts])
    outside = points[~mesh.contains(points)]
    assert not len(outside) or trimesh.proximity.closest_point(mesh, outside)[1].max() < 1e-4
    return len(parts)


@pytest.mark.parametrize("name", ["shelf", "cabinet", "dining_table", "hillside"])
def test_furniture_is_divided_exactly(name: str) -> None:
    assert check(in_unit_box(trimesh.load(MESHES / f"{name}.obj", force="mesh"))) > 1


def test_unions_of_turned_boxes_are_divided_exactly() -> None:
    divided = 0
    for seed in range(12):
        generator = np.random.default_rng(seed)
        boxes = []
        for _ in range(2 + seed % 4):
            box = trimesh.creation.box(generator.uniform(0.2, 1.5, 3))
            box.apply_transform(trimesh.transformations.rotation_matrix(generator.uniform(0, 3), [0, 0, 1]))
            boxes.append(box.apply_translation(generator.uniform(-0.4, 0.4, 3)))
        divided += check(in_unit_box(trimesh.boolean.union(boxes, engine="manifold"))) > 0
    assert divided >= 9  # where faces hardly miss each other, there may be no parts


def test_curved_hollows_have_no_exact_parts() -> None:
    bowl = trimesh.boolean.difference(
        [
            trimesh.creation.icosphere(3, 0.5),
            trimesh.creation.icosphere(3, 0.4).apply_translation((0, 0, 0.2)),
        ],
        engine="manifold",
    )
    assert exact_parts(np.asarray(bowl.vertices), np.asarray(bowl.faces), 64) is None
