import itertools

import numpy as np
import pytest
import trimesh
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.stats import chi2

from scenic.graph import quaternions
from scenic.runtime.geometry.meshes import primitives, surface
from scenic.runtime.geometry.meshes.bodies import Body
from scenic.runtime.geometry.poses import Poses

from .samples import SHAPES, bumpy, in_batches, random_poses, table, world_vertices

SIDES = [None, (0, 1), (0, -1), (1, 1), (1, -1), (2, 1), (2, -1)]
FALSE_ALARM = 1e-6  # of each chi-square test; seeds are fixed, so a failure is a change of the code


def body_of(mesh, poses) -> Body:
    return Body((mesh,), None, poses)


def world(mesh, poses, entry) -> trimesh.Trimesh:
    return trimesh.Trimesh(world_vertices(mesh, poses, entry), mesh.faces, process=False)


def expected_areas(mesh, poses, entry, side, threshold) -> np.ndarray:
    placed = world(mesh, poses, entry)
    if side is None:
        return placed.area_faces
    axis, sign = side
    return placed.area_faces * (sign * placed.face_normals[:, axis] >= threshold)


def check_uniform(faces, areas):
    count = len(faces)
    assert areas[np.unique(faces)].all(), "a face outside the side was drawn"
    expected = areas / areas.sum() * count
    # Small faces are counted together, so that the statistic is close to its limit.
    order = np.argsort(expected)
    groups = np.empty(len(expected), dtype=int)
    groups[order] = np.floor(np.cumsum(expected[order]) / max(10, count / 200)).astype(int)
    seen = np.bincount(groups, weights=np.bincount(faces, minlength=len(areas)))
    wanted = np.bincount(groups, weights=expected)
    seen, wanted = seen[wanted > 0], wanted[wanted > 0]
    statistic = ((seen - wanted) ** 2 / wanted).sum()
    assert chi2.sf(statistic, max(len(wanted) - 1, 1)) > FALSE_ALARM


@pytest.mark.parametrize("side", SIDES)
@pytest.mark.parametrize("name", ["box", "cone", "table", "bumpy"])
def test_draws_are_uniform_by_area_of_the_world(name, side):
    mesh, poses = SHAPES[name](), random_poses(1, 20)
    uniforms = np.random.default_rng(21).random(20_000)
    faces = surface.draw_faces(body_of(mesh, poses), side, 0.4, uniforms, 20_000)
    check_uniform(faces, expected_areas(mesh, poses, 0, side, 0.4))


@pytest.mark.parametrize("side", [None, (2, 1), (0, -1)])
def test_each_entry_has_its_own_side(side):
    mesh, poses = bumpy(2), random_poses(12, 22)
    uniforms = np.random.default_rng(23).random((800, 12))
    draws = np.array([surface.draw_faces(body_of(mesh, poses), side, 0.5, row, 12) for row in uniforms])
    for entry in range(12):
        check_uniform(draws[:, entry], expected_areas(mesh, poses, entry, side, 0.5))


@pytest.mark.parametrize("side", SIDES)
def test_entries_of_one_size_are_each_as_alone(side):
    """Turned differently, or of the same turn and different sizes: each has the faces that it has alone."""
    count = 40
    uniforms = np.random.default_rng(31).random(count)
    poses = random_poses(count, 32)
    for mesh in (table(), bumpy(2)):
        for some in (
            Poses(poses.position, poses.orientation, poses.size[:1]),
            Poses(poses.position, poses.orientation, np.repeat(poses.size[:1], count, axis=0)),
            Poses(poses.position, poses.orientation[:1], poses.size),
            Poses(
                poses.position,
                poses.orientation[[0, 1] * (count // 2)],
                poses.size[[0, 0, 1, 1] * (count // 4)],
            ),
            Poses(poses.position, poses.orientation[:1], poses.size[:1]),
        ):
            faces = surface.draw_faces(body_of(mesh, some), side, 0.5, uniforms, count)
            normals = surface.mean_normals(body_of(mesh, some), side, 0.5, count)
            for lane in range(0, count, 3):
                one = np.array([lane])
                mine = body_of(mesh, some.take(one))
                assert surface.draw_faces(mine, side, 0.5, uniforms[one], 1)[0] == faces[lane]
                np.testing.assert_array_equal(surface.mean_normals(mine, side, 0.5, 1)[0], normals[lane])
                if faces[lane] >= 0:
                    assert expected_areas(mesh, some, lane, side, 0.5)[faces[lane]] > 0


def test_meshes_of_several_blocks():
    mesh, poses = bumpy(5), random_poses(2, 24)
    assert len(mesh.faces) > 2 * surface._BLOCK
    for entry in range(2):
        some = poses.take(np.array([entry]))
        faces = surface.draw_faces(
            body_of(mesh, some), (2, 1), 0.5, np.random.default_rng(25).random(50_000), 50_000
        )
        check_uniform(faces, expected_areas(mesh, poses, entry, (2, 1), 0.5))


def test_draws_follow_the_uniform_number():
    """Faces are laid out in order: the inverse transform, which pruning relies on."""
    body = body_of(bumpy(5), random_poses(1, 26))
    uniforms = np.sort(np.random.default_rng(27).random(5000))
    faces = surface.draw_faces(body, (2, 1), 0.5, uniforms, 5000)
    assert (np.diff(faces) >= 0).all()
    for extreme in (1e-300, np.nextafter(1, 0)):
        last = surface.draw_faces(body, (2, 1), 0.5, np.array([extreme]), 1)
        assert surface.side_contains(bumpy(5), body.poses, (2, 1), 0.5, np.zeros(1, dtype=int), last)[0]


@pytest.mark.parametrize("side", SIDES)
@pytest.mark.parametrize("alike", [False, True])
def test_the_least_and_the_greatest_numbers_draw_faces_of_the_side(side, alike):
    """Not those before the first or behind the last, of bodies of one size as of many sizes."""
    for mesh in (primitives.box(), primitives.cone(), table(), bumpy(2)):
        poses = random_poses(200, 39)
        if alike:
            poses = Poses(poses.position, poses.orientation[:1], poses.size[:1])
        body = body_of(mesh, poses)
        usual = surface.draw_faces(body, side, 0.5, np.full(200, 0.5), 200)
        for extreme in (1e-300, np.nextafter(1, 0)):
            faces = surface.draw_faces(body, side, 0.5, np.array([extreme]), 200)
            np.testing.assert_array_equal(faces < 0, usual < 0)
            known = np.flatnonzero(faces >= 0)
            assert surface.side_contains(mesh, poses, side, 0.5, known, faces[known]).all()


def test_no_faces():
    body = body_of(primitives.spheroid(), random_poses(5, 28))
    uniforms = np.full(5, 0.5)
    assert (surface.draw_faces(body, (2, 1), 1.5, uniforms, 5) == -1).all()
    np.testing.assert_array_equal(surface.mean_normals(body, (2, 1), 1.5, 5), [[0, 0, 1]] * 5)


def test_top_of_a_turned_box_at_threshold_one():
    """The normal of the top is up exactly, but for rounding."""
    yaw = np.random.default_rng(29).uniform(-3, 3, 200)
    poses = Poses(np.zeros((1, 3)), quaternions.from_euler(yaw, 0, 0), np.array([[0.3, 0.7, 1.9]]))
    faces = surface.draw_faces(body_of(primitives.box(), poses), (2, 1), 1.0, np.full(200, 0.7), 200)
    assert set(faces) == {11}


def test_points_are_uniform_on_their_faces():
    body = body_of(primitives.box(), random_poses(1, 30))
    uniforms = np.random.default_rng(31).random((2, 20_000))
    points = surface.face_points(body, np.full(20_000, 4), *uniforms)
    corners = world_vertices(primitives.box(), body.poses, 0)[primitives.box().faces[4]]
    bary = trimesh.triangles.points_to_barycentric(np.broadcast_to(corners, (20_000, 3, 3)), points)
    assert bary.min() > -1e-9
    # Each of the four triangles cut off by the middles of the edges holds a quarter of the points.
    cells = np.where((bary > 0.5).any(axis=1), bary.argmax(axis=1), 3)
    seen = np.bincount(cells, minlength=4)
    assert chi2.sf(((seen - 5000) ** 2 / 5000).sum(), 3) > FALSE_ALARM


@pytest.mark.parametrize("name", SHAPES)
def test_points_and_normals_are_those_of_the_world(name):
    mesh, poses = SHAPES[name](), random_poses(40, 32)
    rng = np.random.default_rng(33)
    faces = rng.integers(0, len(mesh.faces), 40)
    points = surface.face_points(body_of(mesh, poses), faces, *rng.random((2, 40)))
    normals = surface.face_normals(body_of(mesh, poses), faces)
    for entry in range(40):
        placed = world(mesh, poses, entry)
        np.testing.assert_allclose(normals[entry], placed.face_normals[faces[entry]], atol=1e-9)
        corner = placed.triangles[faces[entry], 0]
        assert abs(np.dot(points[entry] - corner, normals[entry])) < 1e-12


@pytest.mark.parametrize("side", SIDES)
def test_mean_normals(side):
    mesh, poses = bumpy(2), random_poses(8, 34)
    means = surface.mean_normals(body_of(mesh, poses), side, 0.3, 8)
    for entry in range(8):
        placed = world(mesh, poses, entry)
        areas = expected_areas(mesh, poses, entry, side, 0.3)
        if side is None:
            np.testing.assert_array_equal(means[entry], (0, 0, 1))
        else:
            expected = (placed.face_normals * areas[:, None]).sum(axis=0)
            np.testing.assert_allclose(means[entry], expected, atol=1e-9)


@settings(max_examples=60)
@given(st.integers(0, 10**6))
def test_preferred_orientations(seed):
    """Local Z is the normal, and no direction in the face is nearer to north than local Y."""
    mesh, poses = table(), random_poses(1, seed)
    face = np.array([seed % len(mesh.faces)])
    orientation = surface.face_orientations(body_of(mesh, poses), face)
    normal = surface.face_normals(body_of(mesh, poses), face)[0]
    np.testing.assert_allclose(quaternions.rotate(orientation, [0, 0, 1])[0], normal, atol=1e-12)
    ahead = quaternions.rotate(orientation, [0, 1, 0])[0]
    angles = np.linspace(0, 2 * np.pi, 721)
    right = quaternions.rotate(orientation, [1, 0, 0])[0]
    others = np.outer(np.cos(angles), ahead) + np.outer(np.sin(angles), right)
    assert (others[:, 1] <= ahead[1] + 1e-12).all()


def test_orientations_of_level_and_vertical_faces():
    box = body_of(primitives.box(), Poses.fixed((0, 0, 0)))
    ahead = quaternions.rotate(surface.face_orientations(box, np.arange(12)), [0, 1, 0])
    north, up = (0, 1, 0), (0, 0, 1)
    np.testing.assert_allclose(ahead, [north] * 4 + [up] * 4 + [north] * 4, atol=1e-15)
    np.testing.assert_array_equal(surface.face_orientations(box, np.array([11])), [[0, 0, 0, 1]])


def test_choices_of_meshes():
    meshes = (primitives.box(), primitives.cone(), bumpy(2))
    choice = np.arange(30) % 3
    poses = random_poses(30, 35)
    rng = np.random.default_rng(36)
    uniforms = rng.random((3, 30))
    mixed = Body(meshes, choice, poses)
    faces = surface.draw_faces(mixed, (2, 1), 0.2, uniforms[0], 30)
    points = surface.face_points(mixed, faces, *uniforms[1:])
    for number, mesh in enumerate(meshes):
        lanes = np.flatnonzero(choice == number)
        alone = body_of(mesh, poses.take(lanes))
        expected = surface.draw_faces(alone, (2, 1), 0.2, uniforms[0, lanes], len(lanes))
        np.testing.assert_array_equal(faces[lanes], expected)
        np.testing.assert_array_equal(
            points[lanes], surface.face_points(alone, expected, *uniforms[1:, lanes])
        )


@pytest.mark.parametrize("alike", ["all", "turns", "sizes"])
def test_choices_of_meshes_of_which_many_lanes_are_alike(alike):
    """Their lanes are drawn together, mesh by mesh: each as alone."""
    meshes, count = (primitives.box(), primitives.cone(), bumpy(2)), 30
    choice = np.random.default_rng(45).integers(0, 3, count)
    many, kind = random_poses(count, 46), np.arange(count) % 2
    poses = Poses(
        many.position,
        many.orientation[:1] if alike != "sizes" else many.orientation[kind],
        many.size[:1] if alike != "turns" else many.size[kind],
    )
    mixed = Body(meshes, choice, poses)
    uniforms = np.random.default_rng(47).random(count)
    for side in SIDES:
        faces = surface.draw_faces(mixed, side, 0.4, uniforms, count)
        normals = surface.mean_normals(mixed, side, 0.4, count)
        for lane in range(0, count, 2):
            alone = body_of(meshes[choice[lane]], poses.take([lane]))
            assert surface.draw_faces(alone, side, 0.4, uniforms[[lane]], 1)[0] == faces[lane]
            np.testing.assert_array_equal(surface.mean_normals(alone, side, 0.4, 1)[0], normals[lane])


@pytest.mark.parametrize("number", [0.25, 0.5, 0.75])
def test_numbers_between_two_faces_draw_the_same_one_however_many_are_drawn(number):
    """Of a cube every quarter of a side's area ends with a face, up to no rounding at all."""
    places = np.zeros((1, 3)), np.array([[0.0, 0, 0, 1]])
    doubling = 2.0 ** np.arange(8)[:, np.newaxis] * np.ones(3)
    apart = surface.draw_faces(
        body_of(primitives.box(), Poses(*places, doubling)), (2, 1), 0.5, np.array([number]), 8
    )
    one = body_of(primitives.box(), Poses(*places, doubling[:1]))
    together = surface.draw_faces(one, (2, 1), 0.5, np.full(8, number), 8)
    np.testing.assert_array_equal(apart, together)
    np.testing.assert_array_equal(together, 10 if number < 0.5 else 11)


def test_the_top_of_a_turned_box_is_a_side_at_threshold_one():
    """And one that leans by a little more than rounding is none, as for draws."""
    yaw = np.random.default_rng(48).uniform(-3, 3, 200)
    poses = Poses(np.zeros((1, 3)), quaternions.from_euler(yaw, 0, 0), np.array([[0.3, 0.7, 1.9]]))
    entries, faces = np.repeat(np.arange(200), 12), np.tile(np.arange(12), 200)
    found = surface.side_contains(primitives.box(), poses, (2, 1), 1.0, entries, faces)
    np.testing.assert_array_equal(found, faces >= 10)
    leaning = Poses(poses.position, quaternions.from_euler(yaw, 1e-5, 0), poses.size)
    assert not surface.side_contains(primitives.box(), leaning, (2, 1), 1.0, entries, faces).any()
    assert (
        surface.draw_faces(body_of(primitives.box(), leaning), (2, 1), 1.0, np.full(200, 0.7), 200) == -1
    ).all()


def test_one_face_of_many_bodies_and_many_faces_of_one():
    """Whatever is the same for all lanes is as if each had it."""
    poses, count = random_poses(6, 49), 6
    faces, first, second = np.arange(6) * 3, *np.random.default_rng(50).random((2, 6))
    for mine in (poses, poses.take([2])):
        for face, one, other in itertools.product(
            (faces, faces[:1]), (first, first[:1]), (second, second[:1])
        ):
            body = body_of(table(), mine)
            points = surface.face_points(body, face, one, other)
            lanes = max(len(mine), len(face), len(one), len(other))
            assert len(points) == lanes
            for lane in range(lanes):
                parts = [part[[lane if len(part) > 1 else 0]] for part in (face, one, other)]
                alone = body_of(table(), mine.take([lane if len(mine) > 1 else 0]))
                np.testing.assert_array_equal(surface.face_points(alone, *parts)[0], points[lane])
    assert len(surface.face_normals(body_of(table(), poses), faces[:1])) == count


@pytest.mark.parametrize("mesh", [table(), bumpy(5)], ids=["small", "large"])
@pytest.mark.parametrize("batch", [1, 7, 512])
def test_batches_do_not_matter(mesh, batch):
    """Also where some lanes share size and orientation, which is a quicker path."""
    count = 100
    poses = random_poses(count, 37)
    poses.size[::4] = poses.size[0]
    poses.orientation[::4] = poses.orientation[0]
    uniforms = np.random.default_rng(38).random(count)
    for part in ("draw_faces", "mean_normals"):

        def answers(lanes, part=part):
            body = body_of(mesh, poses.take(lanes))
            if part == "draw_faces":
                return surface.draw_faces(body, (2, 1), 0.3, uniforms[lanes], len(lanes))
            return surface.mean_normals(body, (2, 1), 0.3, len(lanes))

        whole = answers(np.arange(count))
        np.testing.assert_array_equal(in_batches(answers, count, batch), whole)
        np.testing.assert_array_equal(answers(np.arange(0, count, 4)), whole[::4])


@pytest.mark.parametrize("off", [1e-1, 1e-4, 1e-6])
@pytest.mark.parametrize("name", ["yaw", "pitch"])
def test_faces_nearly_across_the_north_look_as_nearly_north_as_they_can(off, name):
    """Only where the normal itself is north, up counts."""
    angles = (off, 0, 0) if name == "yaw" else (0, off, 0)
    for size in ((1, 1, 1), (3, 0.5, 20)):
        box = body_of(primitives.box(), Poses.fixed((5, 6, 7), quaternions.from_euler(*angles), size))
        normals = surface.face_normals(box, np.arange(12))
        ahead = quaternions.rotate(surface.face_orientations(box, np.arange(12)), [0, 1, 0])
        across = np.abs(normals[:, 1]) > 0.9
        assert across.sum() == 4
        beside = normals[across][:, [0, 2]] * -np.sign(normals[across][:, 1:2])
        expected = beside / np.linalg.norm(beside, axis=1, keepdims=True)
        np.testing.assert_allclose(ahead[across][:, [0, 2]], expected, atol=off * off + 1e-7)
        np.testing.assert_allclose(ahead[across][:, 1], off, rtol=1e-2)
