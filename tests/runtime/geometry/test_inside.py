import numpy as np
import pytest

from scenic.runtime.geometry.meshes import primitives
from scenic.runtime.geometry.meshes.inside import contains_lattice, contains_points
from scenic.runtime.geometry.meshes.mesh import Mesh

from .samples import FILES, SHAPES, bumpy, hollow, in_batches, real_meshes, table, unit_mesh


def winding_numbers(mesh: Mesh, points: np.ndarray) -> np.ndarray:
    """Solid angles of all faces (van Oosterom and Strackee), an oracle without rays."""
    corners = mesh.triangles[None] - points[:, None, None]
    a, b, c = (corners[:, :, i] for i in range(3))
    la, lb, lc = (np.linalg.norm(part, axis=2) for part in (a, b, c))
    numerator = np.einsum("nfi,nfi->nf", a, np.cross(b, c))
    ab, bc, ca = (np.einsum("nfi,nfi->nf", u, v) for u, v in ((a, b), (b, c), (c, a)))
    angles = 2 * np.arctan2(numerator, la * lb * lc + ab * lc + bc * la + ca * lb)
    return angles.sum(axis=1) / (4 * np.pi)


@pytest.mark.parametrize("name", SHAPES)
def test_agrees_with_winding_numbers(name):
    mesh = SHAPES[name]()
    points = np.random.default_rng(3).uniform(-0.55, 0.55, (300, 3))
    np.testing.assert_array_equal(contains_points(mesh, points), winding_numbers(mesh, points) > 0.5)


@real_meshes
@pytest.mark.parametrize("path", FILES, ids=lambda path: path.name)
def test_real_meshes_agree_with_winding_numbers(path):
    mesh = unit_mesh(path)
    points = np.random.default_rng(4).uniform(-0.5, 0.5, (60, 3))
    np.testing.assert_array_equal(contains_points(mesh, points), winding_numbers(mesh, points) > 0.5)


def test_vertical_lines_through_vertices_and_edges():
    """The points lie above and below vertices and edges of the mesh, where rays have to be lucky."""
    mesh = primitives.spheroid()
    starts = np.concatenate([mesh.vertices, mesh.triangles.mean(axis=1), mesh.triangles[:, :2].mean(axis=1)])
    for scale in (0.0, 0.5, 0.9, 1.1, 3.0):
        points = starts * (1, 1, scale)
        radii = np.linalg.norm(points, axis=1)
        inside = contains_points(mesh, points)
        assert inside[radii < 0.49].all()
        assert not inside[radii > 0.500001].any()


def test_vertical_lines_beside_edges_by_rounding():
    """A line meets one of the two faces of an edge, from whichever end the edge is looked at."""
    mesh = primitives.spheroid()
    rng = np.random.default_rng(6)
    starts, ends = mesh.triangles[:, 0], mesh.triangles[:, 1]
    shares = rng.uniform(size=(len(starts), 1))
    y = (starts + shares * (ends - starts))[:, 1]
    with np.errstate(divide="ignore", invalid="ignore"):
        columns = [
            a[:, 0] + (y - a[:, 1]) / (b[:, 1] - a[:, 1]) * (b[:, 0] - a[:, 0])
            for a, b in ((starts, ends), (ends, starts))
        ]
    for column in columns:
        for x in (column, np.nextafter(column, 1), np.nextafter(column, -1)):
            chosen = np.flatnonzero(np.hypot(x, y) < 0.47)
            for height, held in ((-0.1, True), (0.1, True), (-0.497, False), (0.497, False)):
                points = np.column_stack([x[chosen], y[chosen], np.full(len(chosen), height)])
                radii = np.linalg.norm(points, axis=1)
                sure = radii < 0.485 if held else radii > 0.5001
                assert sure.sum() > 500
                assert (contains_points(mesh, points[sure]) == held).all()


def test_grid_points_of_a_table():
    """Coordinates coincide with those of vertices, edges and vertical faces."""
    steps = np.linspace(-0.5, 0.5, 21)
    points = np.stack(np.meshgrid(steps, steps, steps + 0.013), axis=-1).reshape(-1, 3)
    x, y, z = points.T
    near_leg = (np.abs(np.abs(x) - 0.4) < 0.05 - 1e-9) & (np.abs(np.abs(y) - 0.4) < 0.05 - 1e-9)
    near_top = (np.abs(x) < 0.5) & (np.abs(y) < 0.5) & (z > 0.4)
    sure_inside = (near_top | near_leg) & (np.abs(z) < 0.5)
    outside_leg = (np.abs(np.abs(x) - 0.4) > 0.05 + 1e-9) | (np.abs(np.abs(y) - 0.4) > 0.05 + 1e-9)
    sure_outside = ((z < 0.4) & outside_leg) | (np.abs(z) > 0.5)
    found = contains_points(table(), points)
    assert found[sure_inside].all()
    assert not found[sure_outside].any()


def test_cavities_are_outside():
    points = np.array([(0, 0, 0), (0.24, 0.24, 0.24), (0.26, 0, 0), (0.4, 0.4, 0.4)])
    np.testing.assert_array_equal(contains_points(hollow(), points), [False, False, True, True])


def test_slivers_nearly_vertical():
    """A wall thinner than rounding of its coordinates' products still separates."""
    cube = primitives.box()
    shift = np.where(cube.vertices[:, 2] > 0, 1e-16, 0.0)
    leaning = Mesh(cube.vertices + np.stack([shift, 0 * shift, 0 * shift], axis=1), cube.faces)
    points = np.array([(0.4999999, 0, 0.2), (0.5000001, 0, 0.2), (-0.4999999, 0.1, -0.3), (-0.500001, 0, 0)])
    np.testing.assert_array_equal(contains_points(leaning, points), [True, False, True, False])


@pytest.mark.parametrize("batch", [1, 7, 512])
def test_batches_do_not_matter(batch):
    points = np.random.default_rng(5).uniform(-0.5, 0.5, (600, 3))
    whole = contains_points(bumpy(3), points)
    np.testing.assert_array_equal(
        in_batches(lambda i: contains_points(bumpy(3), points[i]), 600, batch), whole
    )
    np.testing.assert_array_equal(contains_points(bumpy(3), points[::3]), whole[::3])


@pytest.mark.parametrize("name", SHAPES)
def test_lattices_are_points(name):
    mesh = SHAPES[name]()
    rng = np.random.default_rng(8)
    x, y = rng.uniform(-0.6, 0.6, 20), np.concatenate([np.linspace(-0.5, 0.5, 7), rng.uniform(-0.6, 0.6, 20)])
    z = np.sort(np.concatenate([rng.uniform(-0.6, 0.6, 8), [-0.5, 0.0, 0.5]]))
    points = np.stack(np.meshgrid(x, y, z, indexing="ij"), axis=-1).reshape(-1, 3)
    found = contains_lattice(mesh, x, y, z)
    # On the very border of the mesh's box the two may differ, as all points of its surface may go either way.
    off_border = (np.abs(points) != 0.5).all(axis=1)
    np.testing.assert_array_equal(found.ravel()[off_border], contains_points(mesh, points)[off_border])
    assert 0 < found.mean() < 1


@pytest.mark.parametrize("name", ["box", "table", "hollow", "cylinder"])
def test_lattices_agree_with_points_level_with_faces_and_corners(name):
    """Also where a level of the lattice is exactly that of a face, and a column is that of an edge."""
    mesh = SHAPES[name]()
    axes = [
        np.unique(np.concatenate([np.unique(mesh.vertices[:, axis]), np.linspace(-0.6, 0.6, 9)]))
        for axis in range(3)
    ]
    points = np.stack(np.meshgrid(*axes, indexing="ij"), axis=-1)
    expected = contains_points(mesh, points.reshape(-1, 3)).reshape(points.shape[:3])
    np.testing.assert_array_equal(contains_lattice(mesh, *axes), expected)
