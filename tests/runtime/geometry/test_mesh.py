import copy
import itertools
import pickle

import numpy as np
import pytest
import trimesh
from scipy.spatial import ConvexHull

from scenic.language.errors import MeshError
from scenic.runtime.geometry.meshes import primitives
from scenic.runtime.geometry.meshes.mesh import Mesh

from .samples import FILES, SHAPES, hollow, placed, real_meshes, table, unit_mesh


@pytest.mark.parametrize("name", SHAPES)
def test_unit_meshes_are_volumes_in_the_unit_cube(name):
    mesh = SHAPES[name]()
    np.testing.assert_array_equal(mesh.bounds, [[-0.5] * 3, [0.5] * 3])
    assert mesh.is_volume
    assert 0 < mesh.volume <= 1


def test_known_volumes():
    assert primitives.box().volume == pytest.approx(1)
    assert primitives.cylinder(24).volume == pytest.approx(24 / 2 * np.sin(2 * np.pi / 24) / 4)
    assert primitives.cone().volume == pytest.approx(32 / 2 * np.sin(2 * np.pi / 32) / 4 / 3)
    assert primitives.spheroid().volume == pytest.approx(np.pi / 6, rel=0.01)
    assert hollow().volume == pytest.approx(1 - 1 / 8)
    assert table().volume == pytest.approx(0.1 + 4 * 0.1 * 0.1 * 0.9)


@pytest.mark.parametrize("place", [(1e6, -2e6, 3e6), (-1e3, 0, 0)])
def test_volumes_of_little_solids_far_away(place):
    for shape in (primitives.box, primitives.cone, table, hollow):
        found = placed(shape(), place, (2**-7, 2**-8, 2**-6))
        assert found.volume == pytest.approx(shape().volume * 2**-21, rel=1e-6)
        assert found.is_volume


@pytest.mark.parametrize(
    ("name", "convex", "box"),
    [
        ("box", True, True),
        ("cylinder", True, False),
        ("cone", True, False),
        ("spheroid", True, False),
        ("table", False, False),
        ("hollow", False, False),
        ("bumpy", False, False),
    ],
)
def test_convex_and_box(name, convex, box):
    mesh = SHAPES[name]()
    assert (mesh.is_convex, mesh.is_box) == (convex, box)


def test_solids_of_several_bodies_are_not_convex():
    """However convex each of them is, and each of them a box."""
    for shape in (primitives.box, primitives.cylinder, primitives.spheroid):
        one, other = (placed(shape(), (x, 0, 0), (1, 1, 1)) for x in (0, 1.5))
        faces = np.concatenate([one.faces, other.faces + len(one.vertices)])
        pair = Mesh(np.concatenate([one.vertices, other.vertices]), faces)
        assert pair.is_volume
        assert not pair.is_convex
        assert not pair.is_box
        assert pair.hull.volume > 1.2 * pair.volume


def test_solids_of_very_many_faces_may_be_convex():
    """Which is then found by the hull."""
    ball = trimesh.creation.icosphere(subdivisions=4)
    found = Mesh(ball.vertices, ball.faces)
    assert found.is_convex
    assert len(found.hull.vertices) == len(ball.vertices)
    assert found.hull.volume == pytest.approx(found.volume, rel=1e-12)


def test_is_box_only_for_whole_boxes():
    cube = primitives.box()
    wedge = Mesh(cube.vertices, [(0, 1, 3), (0, 3, 2), (0, 2, 6), (1, 6, 3), (2, 3, 6), (0, 6, 1)])
    assert wedge.is_volume
    assert not wedge.is_box


@pytest.mark.parametrize("name", SHAPES)
def test_hull_matches_its_planes(name):
    mesh = SHAPES[name]()
    hull = mesh.hull
    heights = hull.vertices @ hull.planes[:, :3].T + hull.planes[:, 3]
    assert heights.max() < 1e-10
    assert (heights.max(axis=0) > -1e-10).all()
    oracle = ConvexHull(mesh.vertices)
    assert oracle.volume == pytest.approx(hull.volume)
    assert {tuple(row) for row in mesh.vertices[oracle.vertices]} <= {tuple(row) for row in hull.vertices}


def test_normals_and_areas():
    cube = primitives.box()
    np.testing.assert_allclose(np.abs(cube.normals).sum(axis=1), 1)
    assert cube.areas.sum() == pytest.approx(6)
    outwards = (cube.normals * cube.triangles.mean(axis=1)).sum(axis=1)
    assert (outwards > 0).all()


@pytest.mark.parametrize("size", [1e-6, 1.0, 1e6])
def test_normals_and_convexity_do_not_depend_on_the_size(size):
    """Nor do faces without area have a normal."""
    for name in ("cone", "table", "bumpy"):
        mesh = SHAPES[name]()
        scaled = Mesh(mesh.vertices * size, mesh.faces)
        np.testing.assert_allclose(scaled.normals, mesh.normals, atol=1e-12)
        assert (scaled.is_volume, scaled.is_convex) == (True, mesh.is_convex)
    flat = Mesh(size * np.array([(0, 0, 0), (1, 1, 1), (2, 2, 2), (1, 0, 0)]), [(0, 1, 2), (0, 1, 3)])
    np.testing.assert_allclose(flat.normals, [(0, 0, 0), (0, 0.5**0.5, -(0.5**0.5))], atol=1e-12)


def test_component_vertices():
    assert len(hollow().component_vertices) == 2
    assert len(table().component_vertices) == 1


def test_flat_meshes_stay_flat():
    square = Mesh([(0, 0, 2), (4, 0, 2), (4, 1, 2), (0, 1, 2)], [(0, 1, 2), (0, 2, 3)])
    unit, centre, extents = square.normalized()
    np.testing.assert_array_equal(extents, [4, 1, 0])
    np.testing.assert_array_equal(centre, [2, 0.5, 2])
    np.testing.assert_array_equal(unit.bounds, [[-0.5, -0.5, 0], [0.5, 0.5, 0]])


@pytest.mark.parametrize("low", [-0.5, -0.7])
@pytest.mark.parametrize("high", [0.5, 1.5])
def test_all_axes_fill_the_unit_cube_exactly(low, high):
    """Also where some of the borders are those of the unit cube already."""
    for axis in range(3):
        lower, upper = np.full(3, -0.5), np.full(3, 0.5)
        lower[axis], upper[axis] = low, high
        middles = np.random.default_rng(axis).uniform(lower, upper, (20, 3))
        corners = np.concatenate([[lower, upper], middles])
        unit, centre, extents = Mesh(corners, [(0, 1, 2), (3, 4, 5)]).normalized()
        np.testing.assert_array_equal(unit.bounds, [[-0.5] * 3, [0.5] * 3])
        np.testing.assert_allclose(unit.vertices * extents + centre, corners, atol=1e-15)
        np.testing.assert_allclose(extents, upper - lower, atol=1e-15)


def test_extreme_vertices_reach_the_unit_cube_whatever_the_rounding():
    rng = np.random.default_rng(4)
    for _ in range(200):
        corners = rng.normal(size=(4, 3)) * rng.uniform(1e-3, 1e3, 3) + rng.normal(size=3)
        beside = [np.nextafter(corners.min(axis=0), np.inf), np.nextafter(corners.max(axis=0), -np.inf)]
        unit = Mesh(np.vstack([corners, beside]), [(0, 1, 2), (3, 4, 5)]).normalized()[0]
        np.testing.assert_array_equal(unit.bounds, [[-0.5] * 3, [0.5] * 3])


def test_normalizing_undoes_placing():
    moved = placed(table(), (3, -200, 1e-3), (7, 1e-4, 0.3))
    unit, centre, extents = moved.normalized()
    np.testing.assert_allclose(unit.vertices, table().vertices, atol=1e-9)
    np.testing.assert_allclose(unit.vertices * extents + centre, moved.vertices, rtol=1e-14)


@pytest.mark.parametrize(
    ("vertices", "faces", "message"),
    [
        (np.zeros((3, 3)), [(0, 1, 3)], "outside 0 to 2"),
        (np.zeros((3, 3)), [(0, 1, -1)], "outside 0 to 2"),
        (np.zeros((3, 3)), np.zeros((0, 3)), "no triangles"),
        ([(0, 0, 0), (1, 0, 0), (0, np.nan, 0)], [(0, 1, 2)], "not finite"),
        (np.zeros((3, 2)), [(0, 1, 2)], "needs arrays"),
        (np.zeros((3, 3)), [0, 1, 2], "needs arrays"),
        (np.zeros((3, 3)), [(0, 1, 2, 2)], "needs arrays"),
        (np.zeros(9), [(0, 1, 2)], "needs arrays"),
    ],
)
def test_bad_arrays_are_refused(vertices, faces, message):
    with pytest.raises(MeshError, match=message):
        Mesh(vertices, faces)


def test_meshes_cannot_be_changed():
    mesh = Mesh(np.eye(3), [(0, 1, 2)])
    for array in (mesh.vertices, mesh.faces, mesh.bounds, mesh.areas):
        with pytest.raises(ValueError, match="read-only"):
            array[0] = 1


def test_derived_data_is_made_once():
    calls = []
    mesh = Mesh(np.eye(3), [(0, 1, 2)])

    def build(given):
        calls.append(given)
        return len(given.faces)

    assert mesh.derived(build) == mesh.derived(build) == 1
    assert calls == [mesh]


def test_derived_data_of_functions_of_one_name_is_told_apart():
    def build(factor):
        def built(mesh):
            return factor * len(mesh.faces)

        return built

    mesh, other = Mesh(np.eye(3), [(0, 1, 2)]), Mesh(np.eye(3), [(0, 1, 2), (0, 2, 1)])
    once, twice = build(1), build(2)
    assert [some.derived(ask) for some in (mesh, other) for ask in (once, twice)] == [1, 2, 2, 4]
    assert [some.derived(ask) for some in (other, mesh) for ask in (twice, once)] == [4, 2, 2, 1]


@real_meshes
@pytest.mark.parametrize("path", FILES, ids=lambda path: path.name)
def test_real_meshes_are_volumes(path):
    mesh = unit_mesh(path)
    assert mesh.is_volume
    np.testing.assert_array_equal(mesh.bounds, [[-0.5] * 3, [0.5] * 3])
    assert mesh.volume <= ConvexHull(mesh.vertices).volume * (1 + 1e-12)


@pytest.mark.parametrize("depth", [1e-2, 1e-4, 1e-6])
def test_a_slight_dent_is_none_of_the_hull(depth):
    """And a slight peak is."""
    corners = np.array([(x, y, z) for x in (-0.5, 0.5) for y in (-0.5, 0.5) for z in (-0.5, 0.5)])
    faces = [face for face in primitives.box().faces.tolist() if set(face) not in ({1, 5, 7}, {1, 7, 3})]
    rim = [(1, 5), (5, 7), (7, 3), (3, 1)]
    for sign in (-1, 1):
        vertices = np.vstack([corners, [0, 0, 0.5 + sign * depth]])
        mesh = Mesh(vertices, np.array([*faces, *((a, b, 8) for a, b in rim)]))
        assert mesh.is_volume
        assert mesh.volume == pytest.approx(1 + sign * depth / 3)
        assert mesh.is_convex is (sign > 0)
        assert mesh.hull.volume == pytest.approx(1 + max(sign, 0) * depth / 3, abs=1e-12)
        assert len(mesh.hull.vertices) == (9 if sign > 0 else 8)
        heights = vertices @ mesh.hull.planes[:, :3].T + mesh.hull.planes[:, 3]
        assert (heights <= 1e-11).all()


def test_digests_tell_vertices_and_faces_apart() -> None:
    cube = primitives.box()
    meshes = [cube, Mesh(cube.vertices, cube.faces[::-1]), Mesh(cube.vertices[::-1], cube.faces)]
    assert len({mesh.digest for mesh in meshes}) == 3
    assert Mesh(cube.vertices, cube.faces).digest == cube.digest


def test_a_mesh_keeps_what_it_was_made_of() -> None:
    """Whatever becomes of the arrays that it was made of; and those stay the caller's."""
    cube = primitives.box()
    vertices = np.array(cube.vertices, dtype=np.float64, order="C")
    faces = np.array(cube.faces, dtype=np.intp, order="C")
    mesh = Mesh(vertices, faces)
    vertices += 3
    faces[0] = 0
    np.testing.assert_array_equal(mesh.vertices, cube.vertices)
    np.testing.assert_array_equal(mesh.faces, cube.faces)
    for kept in (mesh.vertices, mesh.faces):
        with pytest.raises(ValueError, match="read-only"):
            kept[0] = 0


def test_the_unit_meshes_are_the_solids_that_they_are_called() -> None:
    """Vertices by their coordinates; no vertex is unused, and no face but those of the surface."""
    halves = (-0.5, 0.5)
    assert {tuple(row) for row in primitives.box().vertices.tolist()} == {
        (x, y, z) for x in halves for y in halves for z in halves
    }
    rims = {}
    for sections in (24, 32):
        angles = 2 * np.pi * np.arange(sections) / sections
        rims[sections] = 0.5 * np.stack([np.cos(angles), np.sin(angles)], axis=1)
    cylinder, cone = primitives.cylinder().vertices, primitives.cone().vertices
    np.testing.assert_allclose(cylinder[:48, :2], np.concatenate([rims[24]] * 2), atol=1e-15)
    assert cylinder[:, 2].tolist() == [-0.5] * 24 + [0.5] * 24 + [-0.5, 0.5]
    np.testing.assert_array_equal(cylinder[0], (0.5, 0, -0.5))
    np.testing.assert_allclose(cone[:32, :2], rims[32], atol=1e-15)
    np.testing.assert_array_equal(cone[32:], [(0, 0, -0.5), (0, 0, 0.5)])
    assert (cone[:32, 2] == -0.5).all()
    for mesh in (primitives.box(), primitives.cylinder(), primitives.cone(), primitives.spheroid()):
        np.testing.assert_array_equal(np.unique(mesh.faces), np.arange(len(mesh.vertices)))
        assert ((mesh.normals * mesh.triangles.mean(axis=1)).sum(axis=1) > 0.1).all()
        assert mesh.areas.min() > 1e-3
        middle = mesh.triangles.mean(axis=1)
        assert len({tuple(row) for row in np.round(middle, 9).tolist()}) == len(mesh.faces)


def test_the_ball_is_a_finely_divided_icosahedron() -> None:
    """Turned so that its twelve corners lie in the planes of two axes; as trimesh divides one."""
    ball = primitives.spheroid()
    oracle = trimesh.creation.icosphere(subdivisions=3, radius=0.5)
    np.testing.assert_allclose(np.linalg.norm(ball.vertices, axis=1), 0.5, atol=1e-15)
    counts = np.bincount(ball.faces.ravel())
    assert sorted(counts.tolist()) == [5] * 12 + [6] * 630
    corners = np.sort(np.abs(ball.vertices[counts == 5]), axis=1)
    golden = (1 + 5**0.5) / 2
    np.testing.assert_allclose(
        corners, np.broadcast_to(0.5 * np.array([0, 1, golden]) / (1 + golden**2) ** 0.5, (12, 3))
    )
    assert ball.volume == pytest.approx(oracle.volume, rel=1e-12)
    np.testing.assert_allclose(np.sort(ball.areas), np.sort(oracle.area_faces), rtol=1e-9)
    found, expected = (
        {tuple(row) for row in (np.round(vertices, 9) + 0.0).tolist()}
        for vertices in (ball.vertices, oracle.vertices)
    )
    assert found == expected


def test_copies_of_a_mesh_are_the_mesh_and_carry_nothing_derived_elsewhere() -> None:
    mesh = Mesh(table().vertices, table().faces)
    assert copy.copy(mesh) is mesh
    assert copy.deepcopy([mesh])[0] is mesh
    mesh.derived(lambda given: lambda: given)  # which nothing can pickle
    again = pickle.loads(pickle.dumps(mesh))
    np.testing.assert_array_equal(again.vertices, mesh.vertices)
    np.testing.assert_array_equal(again.faces, mesh.faces)
    assert again != mesh
    assert again.digest == mesh.digest
    assert repr(mesh) == f"<Mesh of {len(mesh.vertices)} vertices, {len(mesh.faces)} faces>"


def test_what_is_no_solid_is_not_convex_however_convex_it_looks() -> None:
    cube = primitives.box()
    for faces in (
        cube.faces[1:],
        cube.faces[:, ::-1],
        np.concatenate([cube.faces[:1, ::-1], cube.faces[1:]]),
        np.concatenate([cube.faces[1:], cube.faces[1:2]]),  # as much as a cube, by its signed volume
    ):
        mesh = Mesh(cube.vertices, faces)
        assert (mesh.is_volume, mesh.is_convex, mesh.is_box) == (False, False, False)


def test_meshes_do_not_change_with_the_arrays_that_they_are_made_of() -> None:
    """Nor are those locked."""
    vertices, faces = np.array(primitives.box().vertices), np.array(primitives.box().faces)
    mesh = Mesh(vertices, faces)
    vertices[:], faces[:] = 7, 0
    assert mesh.volume == pytest.approx(1)
    np.testing.assert_array_equal(mesh.triangles, primitives.box().triangles)


@pytest.mark.parametrize("far", [(50.0, 0.0, 0.0), (0.0, 0.0, 0.0)])
def test_vertices_that_no_face_uses_are_none_of_the_solid(far: tuple[float, float, float]) -> None:
    """They take no part in hulls, in what is convex and in what is a surface of its own."""
    for shape in (primitives.box, primitives.cylinder):
        own = shape()
        mesh = Mesh(np.vstack([[far], own.vertices, [far]]), own.faces + 1)
        assert mesh.is_convex
        assert mesh.volume == pytest.approx(own.volume)
        np.testing.assert_allclose(
            np.sort(mesh.hull.vertices, axis=0), np.sort(own.hull.vertices, axis=0), atol=1e-15
        )
        assert len(mesh.component_vertices) == 1
        assert np.abs(mesh.outermost).max() <= 0.5
        assert mesh.is_box is (own.is_box and not any(far))  # the box that it is in holds them, too


@pytest.mark.parametrize("order", list(itertools.permutations(range(3))), ids=str)
def test_the_outermost_vertices_of_a_flat_mesh_are_all_of_them(order: tuple[int, ...]) -> None:
    """Whichever corner of a face they are."""
    corners = np.array([(0, 0, 1), (2, 0, 1), (0, 3, 2), (2, 3, 2)], dtype=float)
    faces = np.array([(0, 1, 2), (1, 3, 2)])[:, order]
    for count in (1, 2):
        found = Mesh(corners[: count + 2], faces[:count]).outermost
        assert sorted(found.tolist()) == sorted(corners[: count + 2].tolist())
