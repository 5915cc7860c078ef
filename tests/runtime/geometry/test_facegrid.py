import numpy as np
import pytest

from scenic.runtime.geometry.meshes import facegrid
from scenic.runtime.geometry.meshes.facegrid import face_grid
from scenic.runtime.geometry.meshes.nearest import nearest_on_triangles

from .samples import bumpy, table


@pytest.mark.parametrize("mesh", [table(), bumpy(3)], ids=["small", "large"])
def test_near_points_misses_no_face(mesh):
    rng = np.random.default_rng(8)
    points = mesh.vertices[rng.integers(0, len(mesh.vertices), 60)] + rng.uniform(-0.1, 0.1, (60, 3))
    found = set(
        zip(
            *(part.tolist() for part in mesh.derived(face_grid).near_points(points, np.full((60, 3), 0.05))),
            strict=True,
        )
    )
    for number, point in enumerate(points):
        corners = mesh.triangles
        points_here = np.broadcast_to(point, corners[:, 0].shape)
        nearest = nearest_on_triangles(points_here, corners[:, 0], corners[:, 1], corners[:, 2])
        distance = np.linalg.norm(nearest - point, axis=1)
        assert {(number, face) for face in np.flatnonzero(distance <= 0.05).tolist()} <= found


@pytest.mark.parametrize("mesh", [table(), bumpy(3)], ids=["small", "large"])
def test_lines_find_the_faces_they_pass(mesh):
    rng = np.random.default_rng(9)
    faces = rng.integers(0, len(mesh.faces), 200)
    weights = rng.dirichlet((1, 1, 1), 200)
    targets = (weights[:, :, None] * mesh.triangles[faces]).sum(axis=1)
    directions = rng.normal(size=(200, 3))
    directions[:60] = np.eye(3)[np.arange(60) % 3]  # along the layers of the grid
    starts = targets + rng.uniform(-5, 5, (200, 1)) * directions
    lines, found = mesh.derived(face_grid).along_lines(starts, directions)
    pairs = set(zip(lines.tolist(), found.tolist(), strict=True))
    assert len(pairs) == len(lines)
    assert set(enumerate(faces.tolist())) <= pairs


def test_no_lines():
    lines, faces = table().derived(face_grid).along_lines(np.zeros((0, 3)), np.zeros((0, 3)))
    assert (len(lines), len(faces)) == (0, 0)


@pytest.mark.parametrize("most", [1, 500])
def test_how_many_lines_are_looked_at_together_does_not_matter(most, monkeypatch):
    rng = np.random.default_rng(11)
    starts, directions = rng.uniform(-1, 1, (40, 3)), rng.normal(size=(40, 3))
    grid = bumpy(3).derived(face_grid)
    expected = set(zip(*(part.tolist() for part in grid.along_lines(starts, directions)), strict=True))
    monkeypatch.setattr(facegrid, "_CHUNK", most)
    found = grid.along_lines(starts, directions)
    assert set(zip(*(part.tolist() for part in found), strict=True)) == expected
