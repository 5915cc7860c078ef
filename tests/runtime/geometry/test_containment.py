import numpy as np
import pytest
import shapely
import shapely.affinity
from scipy.spatial.transform import Rotation

from scenic.graph import quaternions
from scenic.runtime.geometry.containment import body_containment as containment
from scenic.runtime.geometry.flat.polygons import Polygons
from scenic.runtime.geometry.meshes import primitives
from scenic.runtime.geometry.meshes.bodies import Body
from scenic.runtime.geometry.meshes.mesh import Mesh
from scenic.runtime.geometry.poses import Poses

from .samples import (
    FILES,
    SHAPES,
    hollow,
    in_batches,
    placed,
    random_poses,
    real_meshes,
    solid,
    table,
    unit_mesh,
    world_vertices,
    yawed,
)

MARGIN = 1e-6  # answers this close to the border of a container are not compared


def regular(corners, radius, centre=(0, 0)):
    angles = 2 * np.pi * np.arange(corners) / corners
    return np.stack([np.cos(angles), np.sin(angles)], axis=1) * radius + centre


RING = shapely.Polygon(regular(40, 3), [regular(12, 0.4)])
HOOK = shapely.Polygon([(-3, -3), (3, -3), (3, 3), (1, 3), (1, -1), (-1, -1), (-1, 3), (-3, 3)])
ISLANDS = shapely.MultiPolygon([shapely.box(-4, -4, -0.1, 4), shapely.box(0.1, -4, 4, 4)])


def covers(polygon, mesh, poses, entry):
    """Whether the exact projection, triangle by triangle, lies in a polygon."""
    vertices = world_vertices(mesh, poses, entry)[:, :2]
    triangles = shapely.polygons(vertices[mesh.faces])
    proper = triangles[shapely.area(triangles) > 1e-14]
    shapely.prepare(polygon)
    return polygon.covers(shapely.MultiPoint(vertices)) and shapely.covers(polygon, proper).all()


def check_footprint(mesh, poses, polygon, found):
    inside = 0
    for entry, answer in enumerate(found):
        if covers(polygon.buffer(-MARGIN), mesh, poses, entry):
            assert answer, entry
            inside += 1
        elif not covers(polygon.buffer(MARGIN), mesh, poses, entry):
            assert not answer, entry
    assert 0 < inside < len(found)


@pytest.mark.parametrize("polygon", [RING, HOOK, ISLANDS], ids=["ring", "hook", "islands"])
@pytest.mark.parametrize("name", ["box", "cone", "table"])
def test_polygons_with_holes_and_notches(name, polygon):
    mesh, poses = SHAPES[name](), random_poses(80, 50, spread=2.2)
    found = containment.in_polygons(Body((mesh,), None, poses), Polygons(polygon), 80)
    check_footprint(mesh, poses, polygon, found)


def test_a_body_may_straddle_a_hole():
    """The hull of a table on its side covers a hole that the table itself goes around."""
    pillar = shapely.box(-0.1, -0.3, 0.1, 0.1)
    floor = Polygons(shapely.box(-2, -2, 2, 2).difference(pillar))
    fallen = Poses.fixed((0, 0, 0), quaternions.from_euler(0, np.pi / 2, 0))
    assert containment.in_polygons(Body((table(),), None, fallen), floor, 1)[0]
    upright = yawed((0, 0, 0))
    assert not containment.in_polygons(Body((table(),), None, upright), floor, 1)[0]


@pytest.mark.parametrize("name", SHAPES)
def test_convex_polygons(name):
    mesh = SHAPES[name]()
    count = 150
    poses = random_poses(count, 51, spread=1.5)
    corners = regular(7, 2.0, (0.2, -0.1))
    body = Body((mesh,), None, poses)
    found = containment.in_convex_polygon(body, corners[None], count)
    check_footprint(mesh, poses, shapely.Polygon(corners), found)
    np.testing.assert_array_equal(containment.in_polygons(body, Polygons.of_points(corners), count), found)


def test_polygons_of_their_own():
    """Every lane has another polygon; one without area holds nothing."""
    poses = random_poses(40, 52, sizes=(0.1, 0.5))
    rng = np.random.default_rng(53)
    corners = np.stack(
        [
            regular(5, radius, centre)
            for radius, centre in zip(rng.uniform(0, 1.5, 40), rng.uniform(-0.5, 0.5, (40, 2)), strict=True)
        ]
    )
    corners[0] = 0
    mesh = primitives.cylinder()
    found = containment.in_convex_polygon(Body((mesh,), None, poses), corners, 40)
    assert not found[0]
    assert 0 < found.mean() < 1
    for entry in range(1, 40):
        polygon = shapely.Polygon(corners[entry]).buffer(MARGIN)
        assert found[entry] == covers(polygon, mesh, poses, entry)


@pytest.mark.parametrize("name", SHAPES)
def test_boxes_and_ellipsoids(name):
    mesh, poses = SHAPES[name](), random_poses(150, 54, spread=0.8)
    container = random_poses(1, 55, spread=0.1, sizes=(2.5, 3.5))
    body = Body((mesh,), None, poses)
    arguments = (container.size, container.position, container.orientation, 150)
    in_box = containment.in_box(body, *arguments)
    in_ellipsoid = containment.in_ellipsoid(body, *arguments)
    for entry in range(150):
        back = Rotation.from_quat(container.orientation[0]).inv()
        local = back.apply(world_vertices(mesh, poses, entry) - container.position[0])
        reach = np.abs(local / container.size[0]).max()
        radius = np.linalg.norm(local / container.size[0], axis=1).max()
        assert in_box[entry] == (reach <= 0.5) or abs(reach - 0.5) < MARGIN
        assert in_ellipsoid[entry] == (radius <= 0.5) or abs(radius - 0.5) < MARGIN
    assert 0 < in_ellipsoid.sum() < in_box.sum() < 150


def test_touching_from_inside_is_inside():
    body = Body((primitives.box(),), None, yawed((0.5, 0.5, 0.5)))
    still = np.array([[0.0, 0, 0, 1]])
    assert containment.in_box(body, np.full((1, 3), 2.0), np.zeros((1, 3)), still, 1)[0]
    assert not containment.in_box(body, np.full((1, 3), 1.999), np.zeros((1, 3)), still, 1)[0]
    square = Polygons(shapely.box(-1, -1, 1, 1))
    assert containment.in_polygons(body, square, 1)[0]
    turned = Body((primitives.box(),), None, yawed((0, 0, 0), np.pi / 2, (2, 2, 2)))
    assert containment.in_polygons(turned, square, 1)[0]
    assert containment.in_polygons(body, Polygons(RING.union(shapely.box(-1, -1, 1, 1))), 1)[0]


def test_how_far_bodies_may_stick_out_is_the_same_on_every_axis():
    """A billionth of a metre, however long, turned or thin the container is."""
    sizes = np.array([1000.0, 10.0, 0.1])
    turn = random_poses(1, 61).orientation
    matrix = quaternions.to_matrix(turn)[0]
    inner = np.array([1.0, 0.5, 0.05])
    hollowed = placed(primitives.box(), (0, 0, 0), (1, 1, 1))
    for axis in range(3):
        for side in (1, -1):
            for off, held in ((0.4e-9, True), (4e-9, False), (-1e-6, True), (1e-6, False)):
                local = np.zeros(3)
                local[axis] = side * ((sizes - inner)[axis] / 2 + off)
                body = Body((primitives.box(),), None, Poses((matrix @ local)[None], turn, inner[None]))
                if axis or abs(off) > 1e-7:  # beside a kilometre rounding is as large as that
                    assert containment.in_box(body, sizes[None], np.zeros((1, 3)), turn, 1)[0] == held
                container = Body((hollowed,), None, Poses(np.zeros((1, 3)), turn, sizes[None]))
                if abs(off) > 1e-7:
                    assert containment.in_body(body, container, 1)[0] == held
                # The round one holds it only about its middle.
                little = Body(
                    (primitives.box(),), None, Poses((matrix @ local)[None], turn, inner[None] * 1e-7)
                )
                local[axis] = side * (sizes[axis] / 2 + (1e-4 if off > 1e-7 else -1e-4))
                little = Body(little.meshes, None, Poses((matrix @ local)[None], turn, inner[None] * 1e-7))
                expected = off <= 1e-7
                assert containment.in_ellipsoid(little, sizes[None], np.zeros((1, 3)), turn, 1)[0] == expected


def test_how_far_bodies_may_stick_out_of_flat_ellipsoids_is_the_same_in_every_direction():
    """A billionth of a metre along the normal of the surface, which is the distance from it."""
    sizes = np.array([10.0, 1.0, 0.01])
    turn = random_poses(1, 62).orientation
    matrix = quaternions.to_matrix(turn)[0]
    ways = np.concatenate([np.eye(3), -np.eye(3), np.random.default_rng(63).normal(size=(200, 3))])
    ways /= np.linalg.norm(ways, axis=1, keepdims=True)
    normals = ways / sizes
    normals /= np.linalg.norm(normals, axis=1, keepdims=True)
    for mesh in (primitives.box(), primitives.cone()):
        for off, held in ((-1e-7, True), (0.7e-9, True), (1.4e-9, False), (1e-7, False)):
            places = (ways * sizes / 2 + off * normals) @ matrix.T
            bodies = Body((mesh,), None, Poses(places, turn, np.full((1, 3), 1e-12)))
            found = containment.in_ellipsoid(bodies, sizes[None], np.zeros((1, 3)), turn, len(places))
            assert (found == held).all()


def test_containers_without_volume_hold_nothing():
    body = Body((primitives.box(),), None, yawed((0, 0, 0)))
    sizes = np.array([(2, 2, 2), (2, 0, 2), (-2, 2, 2)], dtype=float)
    still = np.array([[0.0, 0, 0, 1]])
    np.testing.assert_array_equal(
        containment.in_box(body, sizes, np.zeros((1, 3)), still, 3), [True, False, False]
    )
    little = Body((primitives.box(),), None, yawed((0, 0, 0), size=(0.01, 0.01, 0.01)))
    np.testing.assert_array_equal(
        containment.in_ellipsoid(little, sizes, np.zeros((1, 3)), still, 3), [True, False, False]
    )
    square = np.array([[(-1.0, -1), (1, -1), (1, 1), (-1, 1)]])
    flat = np.concatenate([square, square * (1, 0), square * 0])
    np.testing.assert_array_equal(containment.in_convex_polygon(little, flat, 3), [True, False, False])


def outside_volume(inner, inner_poses, outer, outer_poses, entry):
    return (solid(inner, inner_poses, entry) - solid(outer, outer_poses, entry)).volume()


@pytest.mark.parametrize("outer", ["box", "cylinder", "spheroid", "table", "hollow", "bumpy"])
@pytest.mark.parametrize("inner", ["box", "table", "spheroid"])
def test_meshes_in_meshes(inner, outer):
    inside, container = SHAPES[inner](), SHAPES[outer]()
    poses = random_poses(60, 56, spread=1.3, sizes=(0.02, 0.4))
    around = random_poses(60, 57, spread=0.05, sizes=(2, 3))
    # Half of the bodies are put where a table is thick, so that some fit into it.
    thick = np.random.default_rng(58).uniform(-0.48, 0.48, (60, 3)) * (1, 1, 0) + (0, 0, 0.45)
    poses.position[::2] = around.to_world(thick)[::2]
    found = containment.mesh_in_mesh(inside, poses, container, around)
    for entry in range(60):
        out = outside_volume(inside, poses, container, around, entry)
        assert found[entry] == (out < 1e-12)
    assert found.any()
    assert not found.all()


def test_a_body_over_a_cavity_is_not_inside():
    ball = primitives.spheroid()
    # The small one lies in it, the large one holds all of it, the one between them meets its corners.
    for size, expected in ((0.2, False), (0.8, False), (0.95, False)):
        pose = yawed((0, 0, 0), size=(size, size, size))
        assert containment.mesh_in_mesh(ball, pose, hollow(), yawed((0, 0, 0)))[0] == expected
    assert containment.mesh_in_mesh(ball, yawed((0.37, 0, 0), size=(0.2,) * 3), hollow(), yawed((0, 0, 0)))[0]


@pytest.mark.parametrize("outer", ["table", "hollow"])
def test_touching_concave_containers_from_inside_is_inside(outer):
    """Face on face, edge on edge and in a corner; a millionth farther out it is not."""
    cube = primitives.box()
    # In the top of a table of height 1, or the wall of a hollow cube.
    x, y, z = (0.0, 0.0, 0.45) if outer == "table" else (0.375, 0.0, 0.0)
    size = (0.25, 0.5, 0.1) if outer == "table" else (0.25, 0.5, 0.5)
    for corner in ((0, 0), (1, 0), (0, -1), (1, 1)):
        place = np.array([x, y, z])
        free = (0, 1) if outer == "table" else (1, 2)
        for axis, side in zip(free, corner, strict=True):
            place[axis] += side * (0.5 - size[axis] / 2)
        for off, held in ((0.0, True), (-1e-6, True), (1e-6, False)):
            fitting = yawed(tuple(place), size=tuple(np.array(size) * (1 + off)))
            found = containment.mesh_in_mesh(cube, fitting, SHAPES[outer](), yawed((0, 0, 0)))
            assert found[0] == held


def test_bodies_in_bodies_with_choices():
    meshes = (primitives.box(), primitives.spheroid())
    choice = np.array([0, 1, 0, 1])
    around = Body(
        (primitives.box(), bumpy_container()), np.array([0, 0, 1, 1]), yawed((0, 0, 0), size=(1, 1, 1))
    )
    body = Body(meshes, choice, yawed((0, 0, 0), size=(0.9, 0.9, 0.9)))
    np.testing.assert_array_equal(containment.in_body(body, around, 4), [True, True, False, False])


def bumpy_container():
    return SHAPES["bumpy"]()


def test_points_in_bodies():
    poses = random_poses(300, 58)
    points = poses.position + np.random.default_rng(59).uniform(-0.6, 0.6, (300, 3))
    for name in ("box", "spheroid", "table"):
        mesh = SHAPES[name]()
        found = containment.contains_points(Body((mesh,), None, poses), points)
        speck = Poses(points, np.array([[0, 0, 0, 1.0]]), np.full((1, 3), 1e-7))
        inside = containment.mesh_in_mesh(primitives.box(), speck, mesh, poses)
        np.testing.assert_array_equal(found, inside)
        assert 0 < found.mean() < 1


@real_meshes
def test_real_meshes_on_a_floor():
    for number, path in enumerate(FILES):
        mesh, poses = unit_mesh(path), random_poses(12, number, spread=1.5)
        found = containment.in_polygons(Body((mesh,), None, poses), Polygons(RING), 12)
        for entry in range(12):
            grown = RING.buffer(1e-9, join_style="mitre")
            assert found[entry] == covers(grown, mesh, poses, entry)


@pytest.mark.parametrize("batch", [1, 7, 512])
def test_batches_do_not_matter(batch):
    count = 150
    poses = random_poses(count, 60, spread=0.8, sizes=(0.2, 1.2))
    polygons = Polygons(shapely.affinity.scale(HOOK, 0.5, 0.5))
    still = np.array([[0.0, 0, 0, 1]])

    def answers(lanes):
        body = Body((table(),), None, poses.take(lanes))
        size, centre = np.full((1, 3), 2.5), np.zeros((1, 3))
        around = Body((SHAPES["bumpy"](),), None, yawed((0, 0, 0), size=(4, 4, 4)))
        return np.column_stack(
            [
                containment.in_polygons(body, polygons, len(lanes)),
                containment.in_box(body, size, centre, still, len(lanes)),
                containment.in_ellipsoid(body, size, centre, still, len(lanes)),
                containment.in_body(body, around, len(lanes)),
            ]
        )

    whole = answers(np.arange(count))
    np.testing.assert_array_equal(in_batches(answers, count, batch), whole)
    assert (whole.mean(axis=0) > 0).all()
    assert (whole.mean(axis=0) < 1).all()


@pytest.mark.parametrize("place", [0.0, 0.7, 3.0])
def test_a_body_in_parts_is_held_where_all_of_them_are(place):
    """Two cubes apart from each other, whose surfaces do not meet the container's; only the first is always in it."""
    cube = primitives.box()
    for order in (1, -1):
        parts = [cube.vertices * 0.2, cube.vertices * 0.2 + np.array([0.3 + place, 0, 0])][::order]
        faces = np.concatenate([cube.faces, cube.faces + len(cube.vertices)])
        pair, centre, extents = Mesh(np.concatenate(parts), faces).normalized()
        poses = Poses.fixed(centre, size=extents)
        for container in (SHAPES["spheroid"](), SHAPES["bumpy"]()):
            found = containment.mesh_in_mesh(pair, poses, container, Poses.fixed((0, 0, 0), size=(2, 2, 2)))
            assert found.tolist() == [place < 0.5]


def supports(mesh, poses, entry, normals):
    """How far a body reaches from its position in these directions of the plane."""
    return (world_vertices(mesh, poses, entry)[:, :2] @ normals.T).max(axis=0)


@pytest.mark.parametrize("name", SHAPES)
def test_each_edge_of_a_convex_polygon_holds_bodies_for_itself(name):
    """Of all edges one is overstepped or nearly so, often not the one that the box around the body oversteps most."""
    mesh, rng, count, sides = SHAPES[name](), np.random.default_rng(64), 120, 5
    poses = random_poses(count, 65, sizes=(0.2, 2.0))
    lanes, polygons, held = [], [], []
    for entry in range(count):
        angles = 2 * np.pi * (np.arange(sides) + rng.uniform(0, 0.6, sides)) / sides
        normals = np.stack([np.cos(angles), np.sin(angles)], axis=1)
        slack = rng.choice([1e-5, 1e-3, 0.1], sides)
        slack[rng.integers(sides)] = (1, -1)[entry % 2] * 1e-6
        reach = supports(mesh, poses, entry, normals) + slack
        after = np.roll(normals, -1, axis=0)
        ends = np.linalg.solve(
            np.stack([normals, after], axis=1), np.stack([reach, np.roll(reach, -1)], axis=1)[..., None]
        )[..., 0]
        edges = ends - np.roll(ends, 1, axis=0)
        if (normals[:, 0] * edges[:, 1] - normals[:, 1] * edges[:, 0] > 1e-3).all():
            lanes.append(entry)
            polygons.append(ends)
            held.append(entry % 2 == 0)
    assert min(sum(held), len(held) - sum(held)) > 20
    body = Body((mesh,), None, poses.take(np.array(lanes)))
    found = containment.in_convex_polygon(body, np.array(polygons), len(lanes))
    np.testing.assert_array_equal(found, held)
    for lane in range(0, len(lanes), 8):
        alone = body.take(np.array([lane]))
        assert containment.in_polygons(alone, Polygons.of_points(polygons[lane]), 1)[0] == held[lane]


@pytest.mark.parametrize("size", [(0.6, 0.6, 1.0), (2.0, 0.2, 0.5)])
def test_a_hole_counts_wherever_it_is_under_a_body(size):
    """Also under a corner of a box, which reaches farther out than any of its sides."""
    shares = [-0.52, -0.48, -0.3, 0.0, 0.3, 0.48, 0.52]
    for yaw in (0.0, 0.5):
        turn = np.array([[np.cos(yaw), -np.sin(yaw)], [np.sin(yaw), np.cos(yaw)]])
        places = [turn @ (np.array((x, y)) * size[:2]) for x in shares for y in shares]
        floor = shapely.box(-9, -9, 9, 9).difference(shapely.Point(0, 0).buffer(1e-3))
        poses = Poses(
            np.array([(-x, -y, 0.0) for x, y in places]), yawed((0, 0, 0), yaw).orientation, np.array([size])
        )
        expected = [max(abs(x), abs(y)) > 0.5 for x in shares for y in shares]
        for mesh in (primitives.box(), Mesh(primitives.box().vertices[::-1], 7 - primitives.box().faces)):
            found = containment.in_polygons(Body((mesh,), None, poses), Polygons(floor), len(places))
            np.testing.assert_array_equal(found, expected)


def test_how_far_bodies_may_stick_out_of_polygons_is_the_same_along_all_edges():
    """A billionth of a metre, however long the edge is."""
    for extent in ((50.0, 0.02), (0.02, 50.0), (3.0, 3.0)):
        half = np.array(extent) / 2
        room = shapely.box(*-half, *half)
        annex = shapely.box(half[0] - 0.01, -half[1], half[0] + 1, -half[1] + 0.005)
        size = half.min() * np.array([0.5, 0.5, 1])
        for axis, side in ((0, -1), (1, 1)):  # the annex is on the other sides
            for off, held in ((0.6e-9, True), (4e-9, False)):
                place = np.zeros(3)
                place[axis] = side * (half[axis] - size[axis] / 2 + off)
                body = Body((primitives.box(),), None, Poses.fixed(place, size=size))
                for outline in (room, room.union(annex)):
                    assert containment.in_polygons(body, Polygons(outline), 1)[0] == held


@pytest.mark.parametrize("turned", [False, True])
def test_how_far_bodies_may_stick_out_of_solids_is_the_same_in_every_direction(turned):
    """A billionth of a metre across each face, slanted ones and those of concave solids too."""
    sizes, inner = np.array([10.0, 1.0, 0.1]), np.array([0.2, 0.05, 0.01])
    turn = random_poses(1, 66).orientation if turned else np.array([[0.0, 0, 0, 1]])
    matrix = quaternions.to_matrix(turn)[0]
    diagonal = [np.array([x, y, 0.0]) / sizes for x in (1, -1) for y in (1, -1)]
    solids = {
        primitives.cylinder(4): [*diagonal, np.array([0, 0, 1.0]), np.array([0, 0, -1.0])],
        table(): [np.array([0, 0, 1.0]), np.array([1.0, 0, 0]), np.array([0, -1.0, 0])],
    }
    for mesh, normals in solids.items():
        middle = np.array([0, 0, 0.45]) * sizes if mesh is table() else np.zeros(3)
        for normal in normals:
            normal = normal / np.linalg.norm(normal)
            # From the middle of the face inwards.
            top = (mesh.vertices * sizes @ normal).max()
            on_face = middle + normal * (top - middle @ normal)
            if normal[0] and normal[1]:
                on_face = np.array([np.sign(normal[0]) * 2.5, np.sign(normal[1]) * 0.25, 0])
            for off, held in ((0.8e-9, True), (1.3e-9, False)):
                place = on_face + normal * (off - np.abs(normal) @ inner / 2)
                body = Body((primitives.box(),), None, Poses((matrix @ place)[None], turn, inner[None]))
                container = Body((mesh,), None, Poses(np.zeros((1, 3)), turn, sizes[None]))
                assert containment.in_body(body, container, 1)[0] == held, (mesh is table(), normal, off)


def test_corners_count_however_many_there_are():
    """One that sticks out is among the last of more than four thousand, or among the first."""
    count = 4200
    angles = 2 * np.pi * np.arange(count) / count
    rim, after = np.arange(count), (np.arange(count) + 1) % count
    faces = [
        np.stack([rim, after, np.full(count, count)], axis=1),
        np.stack([after, rim, np.full(count, count + 1)], axis=1),
    ]
    corners = np.stack([np.cos(angles), np.sin(angles), 0 * angles], axis=1) / 2
    top = Mesh(np.concatenate([corners, [(0, 0, 0.5), (0, 0, -0.5)]]), np.concatenate(faces))
    # Directions in which only corners beside the farthest along the axes are far out.
    chosen = np.array([2000, 60, 60, 4140, 4140, 2200])
    ways, off = 2 * corners[chosen], np.array([-1, 1, -1, -1, 1, 1]) * 1e-6
    frame = quaternions.from_euler(angles[chosen], 0 * angles[chosen], 0 * angles[chosen])
    centre = (0.5 + off - 4.5)[:, None] * ways
    found = containment.in_box(Body((top,), None, yawed((0, 0, 0))), np.full((1, 3), 9.0), centre, frame, 6)
    np.testing.assert_array_equal(found, off > 0)


def test_points_on_the_surface_of_a_box_are_in_it():
    body = Body((primitives.box(),), None, Poses.fixed((1, 2, 4), size=(2, 4, 8)))
    ways = np.array([(x, y, z) for x in (-1, 0, 1) for y in (-1, 0, 1) for z in (-1, 0, 1)], dtype=float)
    assert containment.contains_points(body, ways * (1, 2, 4) + (1, 2, 4)).all()
    beyond = ways * np.nextafter((1, 2, 4), 9) * (1 + 1e-15) + (1, 2, 4)
    np.testing.assert_array_equal(containment.contains_points(body, beyond), ~ways.any(axis=1))


def test_the_one_mesh_that_a_body_has_in_all_lanes_is_any_of_its_meshes():
    for number, held in ((0, True), (1, False)):
        body = Body((primitives.box(), hollow()), np.array([number]), yawed((0, 0, 0)))
        assert containment.contains_points(body, np.zeros((3, 3))).tolist() == [held] * 3
        assert containment.contains_points(body.take(np.array([0])), np.zeros((1, 3))).tolist() == [held]
        assert [mesh for mesh, _ in body.by_mesh(4)] == [body.meshes[number]]


@pytest.mark.parametrize("alike", ["none", "body", "container"])
def test_each_lane_has_the_answer_of_its_own_shapes(alike):
    """Of bodies and containers of several shapes, or one pose of either for all lanes."""
    count, rng = 24, np.random.default_rng(67)
    inner = (primitives.box(), table(), primitives.spheroid())
    outer = (hollow(), primitives.cylinder(), SHAPES["bumpy"]())
    small = random_poses(count, 68, spread=0.3, sizes=(0.05, 0.6))
    large = random_poses(count, 69, spread=0.1, sizes=(1.5, 3.0))
    if alike == "body":
        small = small.take(np.array([3]))
        small = Poses(small.position, small.orientation, small.size)
    elif alike == "container":
        large = large.take(np.array([3]))
    body = Body(inner, rng.integers(0, 3, count), small)
    container = Body(outer, rng.integers(0, 3, count), large)
    corners = rng.uniform(0.3, 1.2, (count, 1, 1)) * regular(5, 1.0)
    hook = Polygons(shapely.affinity.scale(shapely.affinity.translate(HOOK, 0, 2), 0.3, 0.3, origin=(0, 0)))
    room = large.size * 0.4, large.position, large.orientation

    def answers(body, container, corners, room, lanes):
        return [
            containment.in_body(body, container, lanes),
            containment.in_convex_polygon(body, corners, lanes),
            containment.in_polygons(body, hook, lanes),
            containment.in_box(body, *room, lanes),
            containment.in_ellipsoid(body, *room, lanes),
        ]

    together = answers(body, container, corners, room, count)
    assert alike == "body" or all(0 < found.sum() < count for found in together)
    for lane in range(count):
        one = np.array([lane])
        mine, around = body.take(one), container.take(one)
        own = [part if len(part) == 1 else part[one] for part in room]
        for found, (alone,) in zip(together, answers(mine, around, corners[one], own, 1), strict=True):
            assert found[lane] == alone


def test_long_bodies_in_rooms_that_are_as_long_the_other_way():
    """The room is as wide as a body is long, but not where the body is long; all sides are along the axes."""
    extents = np.array([(x, y, 1.0) for x in (0.2, 1.9, 2.4, 2.9) for y in (0.2, 1.9, 2.4, 2.9)])
    poses = Poses(np.zeros((1, 3)), np.array([[0, 0, 0, 1.0]]), extents)
    for room in ((2.0, 3.0), (3.0, 2.0), (2.5, 2.5)):
        corners = np.array([(-1, -1), (1, -1), (1, 1), (-1, 1)]) * np.array(room) / 2
        expected = (extents[:, :2] < room).all(axis=1)
        for mesh in (primitives.box(), table()):
            found = containment.in_convex_polygon(Body((mesh,), None, poses), corners[None], len(extents))
            np.testing.assert_array_equal(found, expected)
