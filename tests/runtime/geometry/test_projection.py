import itertools

import numpy as np
import pytest
import trimesh

from scenic.runtime.geometry.containment import body_points
from scenic.runtime.geometry.meshes import primitives, projection, surface
from scenic.runtime.geometry.meshes.bodies import Body
from scenic.runtime.geometry.meshes.mesh import Mesh
from scenic.runtime.geometry.meshes.nearest import nearest_on_triangles
from scenic.runtime.geometry.poses import Poses

from .samples import SHAPES, bumpy, in_batches, random_poses, table, world_vertices, yawed

SIDES = [None, (2, 1), (2, -1), (0, 1), (1, -1)]


def brute_force(mesh, poses, entry, side, threshold, point, direction):
    """The nearest crossing of the line with the side in the world, face by face; ``None`` if there is none."""
    placed = trimesh.Trimesh(world_vertices(mesh, poses, entry), mesh.faces, process=False)
    normals = placed.face_normals
    chosen = np.arange(len(normals))
    if side is not None:
        chosen = np.flatnonzero(side[1] * normals[:, side[0]] >= threshold)
    hits = []
    for face in chosen:
        rate = normals[face] @ direction
        if abs(rate) < 1e-14:
            continue
        a, b, c = placed.triangles[face]
        travel = (a - point) @ normals[face] / rate
        at = point + travel * direction
        if all((np.cross(v - u, at - u) @ normals[face]) >= -1e-14 for u, v in ((a, b), (b, c), (c, a))):
            hits.append((abs(travel), travel))
    return point + min(hits)[1] * direction if hits else None


@pytest.mark.parametrize("side", SIDES)
@pytest.mark.parametrize("name", ["box", "cone", "table", "bumpy"])
def test_against_brute_force(name, side):
    mesh, poses = SHAPES[name](), random_poses(24, 40)
    rng = np.random.default_rng(41)
    points = poses.position + rng.uniform(-0.8, 0.8, (24, 3))
    for directions in (np.array([[0, 0, 1.0]]), rng.normal(size=(24, 3))):
        body = Body((mesh,), None, poses)
        faces, landed = projection.project(body, side, 0.4, points, directions, 24)
        again = projection.landing_points(body, faces, points, directions)
        for entry in range(24):
            direction = directions[entry % len(directions)]
            expected = brute_force(mesh, poses, entry, side, 0.4, points[entry], direction)
            assert (faces[entry] >= 0) == (expected is not None)
            if expected is not None:
                np.testing.assert_allclose(landed[entry], expected, atol=1e-9)
                np.testing.assert_allclose(again[entry], expected, atol=1e-9)


def test_large_meshes_need_no_luck():
    """Lines through vertices and along edges of a mesh with a grid, and lines parallel to its layers."""
    mesh = bumpy(4)
    assert len(mesh.faces) > projection._FEW_FACES
    body = Body((mesh,), None, Poses.fixed((0, 0, 0)))
    targets = np.concatenate([mesh.vertices[::7], mesh.triangles[::11, :2].mean(axis=1)])
    for direction in ((0, 0, 1), (1, 0, 0), (0, 1, 0), (1, 1, 0), (0.3, -0.2, 0.7)):
        way = np.array([direction], dtype=float)
        start = targets + 1.5e-3 * way
        faces, landed = projection.project(body, None, 0, start, way, len(targets))
        assert (faces >= 0).all()
        assert (
            np.linalg.norm(landed - start, axis=1) <= np.linalg.norm(targets - start, axis=1) + 1e-9
        ).all()


def test_far_away_points_and_long_directions():
    body = Body((primitives.box(),), None, yawed((0, 0, 0), 0.3, (4, 4, 0.1)))
    start = np.array([(0.5, -0.25, 1e6), (0.5, -0.25, -1e6), (100, 0, 1)])
    faces, landed = projection.project(body, (2, 1), 0.5, start, np.array([[0, 0, 1e-3]]), 3)
    np.testing.assert_allclose(landed[:2], [(0.5, -0.25, 0.05)] * 2, atol=1e-9)
    np.testing.assert_array_equal(landed[:2, :2], start[:2, :2])
    assert faces[2] == -1


def test_nearest_over_both_ways():
    body = Body((table(),), None, yawed((0, 0, 0.5)))
    start = np.array([(0, 0, 0.85), (0, 0, 0.95), (0, 0, 0.1), (0, 0, 3)])
    _, landed = projection.project(body, None, 0, start, np.array([[0, 0, -2.0]]), 4)
    # The top of the table is the slab from 0.9 to 1; inside it, above and below are equally near.
    assert landed[0, 2] == pytest.approx(0.9)
    assert landed[1, 2] == pytest.approx(0.9) or landed[1, 2] == pytest.approx(1.0)
    np.testing.assert_allclose(landed[2:, 2], [0.9, 1.0])


@pytest.mark.parametrize("name", SHAPES)
def test_points_on_the_surface_stay(name):
    """Also where the direction runs along the face, so that no line crosses it."""
    mesh, poses = SHAPES[name](), random_poses(200, 42)
    rng = np.random.default_rng(43)
    body = Body((mesh,), None, poses)
    faces = surface.draw_faces(body, None, 0, rng.random(200), 200)
    points = surface.face_points(body, faces, *rng.random((2, 200)))
    corners = [surface.face_points(body, faces, np.array([first]), np.array([0.5])) for first in (0.0, 1.0)]
    for directions in (rng.normal(size=(200, 3)), corners[1] - corners[0]):
        found, landed = projection.project(body, None, 0, points, directions, 200)
        assert (found >= 0).all()
        np.testing.assert_array_equal(landed, points)
        np.testing.assert_array_equal(projection.landing_points(body, found, points, directions), points)


@pytest.mark.parametrize("name", ["box", "cylinder", "table", "hollow", "spheroid"])
def test_points_on_another_side_move(name):
    """Points stay only on the side that is asked for; in lanes of one body, of which others miss or stay."""
    mesh = SHAPES[name]()
    turn = random_poses(1, 51).orientation
    body = Body((mesh,), None, Poses(np.array([[1.0, 2, 3]]), turn, np.array([[1.0, 2, 0.5]])))
    count = 90
    rng = np.random.default_rng(52)
    faces = {sign: surface.draw_faces(body, (2, sign), 0.0, rng.random(count), count) for sign in (1, -1)}
    top, bottom = (surface.face_points(body, faces[sign], *rng.random((2, count))) for sign in (1, -1))
    kind = np.arange(count) % 4
    start = np.select([kind[:, None] == 0, kind[:, None] == 1], [top, bottom], bottom + np.array([0.0, 0, 9]))
    start[kind == 3] += (0, 50, 0)  # beside the body
    found, landed = projection.project(body, (2, 1), 0.0, start, np.array([[0, 0, 0.7]]), count)
    np.testing.assert_array_equal(landed[kind == 0], top[kind == 0])
    assert (found[kind == 3] == -1).all()
    rest = (kind == 1) | (kind == 2)
    assert (found[rest] >= 0).all()
    assert surface.side_contains(mesh, body.poses, (2, 1), 0.0, np.zeros(count, dtype=int), found)[
        kind < 3
    ].all()
    np.testing.assert_allclose(landed[rest, :2], start[rest, :2], atol=1e-12)
    assert (np.abs(landed[rest] - start[rest])[:, 2] > 1e-3).mean() > 0.9
    near = projection.near_surface(body, (2, 1), 0.0, start, count)
    np.testing.assert_array_equal(near[kind < 2], (np.abs(landed - start)[:, 2] == 0)[kind < 2])
    assert not near[kind > 1].any()


def test_lanes_of_several_meshes_are_those_of_each_alone():
    """Some points stay on the surface, some are moved, some miss."""
    meshes, rng = (primitives.box(), table(), primitives.cone()), np.random.default_rng(54)
    choice, poses = np.arange(30) % 3, random_poses(30, 55)
    body = Body(meshes, choice, poses)
    faces = surface.draw_faces(body, None, 0, rng.random(30), 30)
    points = surface.face_points(body, faces, *rng.random((2, 30)))
    points[rng.random(30) < 0.6] += (0, 0, 0.1)
    points[rng.random(30) < 0.2] += (90, 0, 0)
    found, landed = projection.project(body, None, 0, points, np.array([[0, 0, 1.0]]), 30)
    assert len({*np.sign(found + 0.5)}) == 2
    for lane in range(30):
        own = Body((meshes[choice[lane]],), None, poses.take([lane]))
        face, place = projection.project(own, None, 0, points[[lane]], np.array([[0, 0, 1.0]]), 1)
        assert face[0] == found[lane]
        np.testing.assert_array_equal(place[0], landed[lane])


def test_lanes_without_a_direction_miss():
    """And change nothing for the others; with many faces, too."""
    for mesh in (table(), bumpy(3)):
        poses = random_poses(40, 53)
        body = Body((mesh,), None, poses)
        start = poses.position + np.random.default_rng(54).uniform(-0.4, 0.4, (40, 3))
        ways = np.random.default_rng(55).normal(size=(40, 3))
        faces, landed = projection.project(body, None, 0, start, ways, 40)
        still = np.arange(40) % 3 == 0
        found, place = projection.project(body, None, 0, start, np.where(still[:, None], 0.0, ways), 40)
        assert (found[still] == -1).all()
        np.testing.assert_array_equal(found[~still], faces[~still])
        np.testing.assert_array_equal(place[~still], landed[~still])
        assert (found[~still] >= 0).any()
        assert (projection.project(body, None, 0, start, np.zeros((1, 3)), 40)[0] == -1).all()


def test_landing_points_of_which_some_parts_are_the_same_for_all():
    """Faces, points, directions and bodies, one or many of each: as if each lane had its own."""
    count, rng = 4, np.random.default_rng(56)
    poses = random_poses(count, 57)
    parts = (
        rng.integers(0, len(table().faces), count),
        rng.normal(size=(count, 3)),
        rng.normal(size=(count, 3)),
    )
    for many in itertools.product((False, True), repeat=4):
        some = [part if wide else part[:1] for part, wide in zip(parts, many[1:], strict=True)]
        body = Body((table(),), None, poses if many[0] else poses.take([0]))
        found = projection.landing_points(body, *some)
        assert len(found) == (count if any(many) else 1)
        for lane in range(len(found)):
            own = Body(body.meshes, None, poses.take([lane if many[0] else 0]))
            alone = [part[[lane if len(part) > 1 else 0]] for part in some]
            np.testing.assert_array_equal(projection.landing_points(own, *alone)[0], found[lane])


def test_near_surface_against_distances():
    mesh, poses = bumpy(2), random_poses(60, 44)
    rng = np.random.default_rng(45)
    body = Body((mesh,), None, poses)
    faces = surface.draw_faces(body, None, 0, rng.random(60), 60)
    points = surface.face_points(body, faces, *rng.random((2, 60)))
    normals = surface.face_normals(body, faces)
    for shift, expected in ((0.5e-6, True), (-0.9e-6, True), (1e-3, False)):
        moved = points + shift * normals
        found = projection.near_surface(body, None, 0, moved, 60)
        for entry in range(60):
            placed = trimesh.Trimesh(world_vertices(mesh, poses, entry), mesh.faces, process=False)
            distance = trimesh.proximity.closest_point_naive(placed, moved[entry : entry + 1])[1][0]
            assert found[entry] == (distance <= 1e-6)
            if expected:
                assert found[entry]


@pytest.mark.parametrize("name", SHAPES)
@pytest.mark.parametrize("scale", [(1, 1, 1), (1e-5, 1e-5, 1e-5), (1e-5, 1, 1), (1, 2e-5, 1), (3, 1, 1e-5)])
def test_what_is_near_the_surface_of_small_and_flat_bodies(name, scale):
    """As near in every direction, also beyond the body's box, and of bodies hardly larger than the tolerance."""
    count = 40
    mesh, some = SHAPES[name](), random_poses(count, 49)
    body = Body((mesh,), None, Poses(some.position, some.orientation, some.size * scale))
    rng = np.random.default_rng(50)
    ways = rng.normal(size=(count, 3))
    ways *= rng.uniform(0, 2.5e-6, (count, 1)) / np.linalg.norm(ways, axis=1, keepdims=True)
    faces = rng.integers(0, len(mesh.faces), count)
    faces[::2] = np.argmax(mesh.triangles[:, :, 2].sum(axis=1))  # the topmost
    points = surface.face_points(body, faces, *rng.random((2, count))) + ways
    found = projection.near_surface(body, None, 0, points, count)
    for entry in range(count):
        corners = world_vertices(mesh, body.poses, entry)[mesh.faces]
        beside = np.broadcast_to(points[entry], (len(corners), 3))
        gap = np.linalg.norm(nearest_on_triangles(beside, *corners.swapaxes(0, 1)) - beside, axis=1).min()
        assert found[entry] == (gap <= 1e-6) or abs(gap - 1e-6) < 1e-11
    assert 0 < found.mean() < 1


@pytest.mark.parametrize("mesh", [primitives.box(), bumpy(3)], ids=["small", "large"])
@pytest.mark.parametrize("batch", [1, 7, 512])
def test_batches_do_not_matter(mesh, batch):
    count = 200
    poses = random_poses(count, 47)
    rng = np.random.default_rng(48)
    points, ways = poses.position + rng.uniform(-0.5, 0.5, (count, 3)), rng.normal(size=(count, 3))
    # Every third point is on a side already, if there is one where the body is turned that way.
    every = Body((mesh,), None, poses)
    on_side = surface.draw_faces(every, (2, 1), 0.2, rng.random(count), count)
    points[::3] = surface.face_points(every, on_side, *rng.random((2, count)))[::3]

    def answers(lanes):
        body = Body((mesh,), None, poses.take(lanes))
        faces, landed = projection.project(body, (2, 1), 0.2, points[lanes], ways[lanes], len(lanes))
        return np.column_stack([faces, landed])

    np.testing.assert_array_equal(in_batches(answers, count, batch), answers(np.arange(count)))


def split(mesh: Mesh, face: int, edge: int, *, first: bool) -> Mesh:
    """The mesh with a vertex in the middle of an edge of one face alone: between it and the other there is a face without area."""
    a, b, c = np.roll(mesh.faces[face], -edge).tolist()
    middle = len(mesh.vertices)
    vertices = np.vstack([mesh.vertices, (mesh.vertices[a] + mesh.vertices[b]) / 2])
    others = np.delete(mesh.faces, face, axis=0).tolist()
    halves, between = [(a, middle, c), (middle, b, c)], [(a, b, middle)]
    return Mesh(vertices, [*between, *others, *halves] if first else [*others, *halves, *between])


@pytest.mark.parametrize("first", [False, True])
@pytest.mark.parametrize("face", [0, 4, 8, 11])
def test_faces_without_area_belong_to_no_side(face: int, first: bool) -> None:
    """Where they are, others of the surface are, too; to no answer do they matter."""
    plain, rng = primitives.box(), np.random.default_rng(face)
    way = np.array([[0.3, -0.2, 0.7]])
    for edge in range(3):
        mesh = split(plain, face, edge, first=first)
        assert mesh.is_volume
        assert (mesh.areas == 0).sum() == 1
        poses = Poses.fixed((1, 2, 3), random_poses(1, edge).orientation, (2, 3, 1))
        bodies = [Body((some,), None, poses) for some in (plain, mesh)]
        corners = poses.to_world(plain.triangles[face])
        ends = np.roll(corners, -edge, axis=0)[:2]
        share = rng.random((20, 1))
        points = ends[0] * share + ends[1] * (1 - share)
        for side in SIDES:
            answers = []
            for body in bodies:
                faces, landed = projection.project(body, side, 0.2, points, way, 20)
                known = faces >= 0
                answers.append(
                    [
                        known,
                        landed[known],
                        projection.near_surface(body, side, 0.2, points, 20),
                        np.linalg.norm(surface.face_normals(body, faces), axis=1)[known] > 0.5,
                        *(body_points.side_bounds(body, side, 0.2) if side else ()),
                    ]
                )
            for usual, found in zip(*answers, strict=True):
                np.testing.assert_allclose(found, usual, atol=1e-12)
