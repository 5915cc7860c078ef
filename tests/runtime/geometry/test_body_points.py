"""What balls and discs bodies hold about their positions, and points drawn from thin ones."""

import numpy as np
import pytest
import shapely
import shapely.affinity

from scenic.runtime.geometry.containment import body_points, distance
from scenic.runtime.geometry.containment.body_containment import contains_points as contains_body_points
from scenic.runtime.geometry.meshes import primitives
from scenic.runtime.geometry.meshes.bodies import Body
from scenic.runtime.geometry.meshes.inside import contains_points
from scenic.runtime.geometry.meshes.mesh import Mesh
from scenic.runtime.geometry.meshes.nearest import nearest_on_triangles
from scenic.runtime.geometry.meshes.prisms import prism
from scenic.runtime.geometry.poses import Poses

from .samples import hollow, random_poses, table

SQUARE = shapely.box(-0.5, -0.5, 0.5, 0.5)
OUTLINES = {
    "square": SQUARE,
    "slanted": shapely.Polygon([(-0.5, -0.2), (0.3, -0.5), (0.5, 0.4), (-0.1, 0.5)]),
    "with a hole beside the middle": SQUARE.difference(shapely.box(0.1, -0.3, 0.4, 0.2)),
    "with a hole in the middle": SQUARE.difference(shapely.box(-0.1, -0.3, 0.4, 0.2)),
    "corner": SQUARE.difference(shapely.box(-0.1, -0.2, 0.5, 0.5)),
    "thick corner": SQUARE.difference(shapely.box(0.2, 0.1, 0.5, 0.5)),
    "two": shapely.MultiPolygon([shapely.box(-0.5, -0.5, 0.1, 0.5), shapely.box(0.2, -0.5, 0.5, 0.5)]),
    "two beside the middle": shapely.MultiPolygon(
        [shapely.box(-0.5, -0.5, -0.1, 0.5), shapely.box(0.2, -0.5, 0.5, 0.5)]
    ),
}


@pytest.mark.parametrize("name", OUTLINES)
def test_discs_about_positions_end_at_the_nearest_edge(name: str) -> None:
    """Whatever the body is stretched to; seen from above, the edge of a hole is an edge, too."""
    mesh = prism(OUTLINES[name], -0.5, 0.5)
    assert mesh is not None
    poses = random_poses(6, 1)
    expected = []
    for width, length, _ in poses.size:
        outline = shapely.affinity.scale(OUTLINES[name], width, length, origin=(0, 0))
        origin = shapely.Point(0, 0)
        expected.append(outline.boundary.distance(origin) if outline.covers(origin) else 0.0)
    assert all(expected) == (name not in {"with a hole in the middle", "corner", "two beside the middle"})
    np.testing.assert_allclose(body_points.planar_inradii(Body((mesh,), None, poses)), expected, atol=1e-12)
    # Among others, and where nothing differs from lane to lane.
    mixed = Body((primitives.box(), mesh), np.arange(6) % 2, poses)
    np.testing.assert_allclose(body_points.planar_inradii(mixed)[1::2], expected[1::2], atol=1e-12)
    alone = Body((mesh,), None, poses.take(np.array([2])))
    np.testing.assert_allclose(body_points.planar_inradii(alone), expected[2:3], atol=1e-12)


@pytest.mark.parametrize("mesh", [primitives.box(), primitives.cone(), table(), hollow()])
def test_balls_about_positions_end_at_the_nearest_face(mesh: Mesh) -> None:
    poses = random_poses(6, 2)
    found = body_points.inradii(Body((mesh,), None, poses))
    for radius, size in zip(found, poses.size, strict=True):
        corners = mesh.triangles * size
        nearest = nearest_on_triangles(np.zeros((len(corners), 3)), *np.moveaxis(corners, 1, 0))
        holds = contains_points(mesh, np.zeros((1, 3)))[0]
        assert radius == pytest.approx(np.linalg.norm(nearest, axis=1).min() if holds else 0.0, abs=1e-12)


def test_points_are_found_in_solids_that_fill_little_of_their_boxes() -> None:
    """A rod from corner to corner: a hundredth of the box, in which a first point rarely lies."""
    start, end = np.array([-0.5, -0.5, -0.5]), np.array([0.5, 0.5, 0.5])
    ring = 0.05 * np.array([(1, -1, 0), (0, 1, -1), (-1, 0, 1)])
    corners = np.concatenate([start + ring, end + ring])
    sides = [(i, (i + 1) % 3, (i + 1) % 3 + 3) for i in range(3)] + [
        (i, (i + 1) % 3 + 3, i + 3) for i in range(3)
    ]
    rod = Mesh(corners, np.array([(0, 2, 1), (3, 4, 5), *sides]))
    rod = (rod if rod.volume > 0 else Mesh(rod.vertices, rod.faces[:, ::-1])).normalized()[0]
    assert 0 < rod.volume < 1.5e-2
    rng = np.random.default_rng(3)
    body = Body((rod,), None, Poses.fixed((1, 2, 3), size=(2, 3, 4)))
    points, found = body_points.draw_points(
        body, rng.random((3, 30)), rng.integers(0, 2**63, 30).astype(np.uint64)
    )
    assert found.all()
    local = (points - (1, 2, 3)) / (2, 3, 4)
    assert contains_points(rod, local).all()
    assert len(np.unique(local[:, 0])) == 30
    assert abs(local.mean()) < 0.2


def test_points_drawn_from_solids_do_not_depend_on_the_company() -> None:
    """Of whatever shape each of them is; where a key is given for all, that counts for each."""
    count, rng = 40, np.random.default_rng(7)
    poses, meshes = random_poses(count, 8), (table(), primitives.box(), hollow(), primitives.cone())
    body = Body(meshes, rng.integers(0, len(meshes), count), poses)
    uniforms, keys = rng.random((3, count)), rng.integers(0, 2**63, count).astype(np.uint64)
    for words in (keys, keys[:1]):
        together, found = body_points.draw_points(body, uniforms, words)
        assert found.all()
        for size in (1, 7):
            for start in range(0, count, size):
                lanes = np.arange(start, min(start + size, count))
                mine = words[lanes] if len(words) > 1 else words
                points, _ = body_points.draw_points(body.take(lanes), uniforms[:, lanes], mine)
                np.testing.assert_array_equal(points, together[lanes])


@pytest.mark.parametrize(
    "shared",
    [(), ("position",), ("orientation",), ("size",), ("position", "orientation", "size")],
    ids="+".join,
)
def test_what_is_measured_of_a_body_is_that_of_the_mesh_of_each_lane(shared: tuple[str, ...]) -> None:
    """Of whatever shapes the others are, and whatever of their poses is the same."""
    meshes, count = (table(), primitives.box(), hollow(), primitives.cone()), 11
    choice, many = np.random.default_rng(9).integers(0, len(meshes), count), random_poses(count, 10)
    names = ("position", "orientation", "size")
    poses = Poses(*(getattr(many, name)[:1] if name in shared else getattr(many, name) for name in names))
    body, points = Body(meshes, choice, poses), np.random.default_rng(11).normal(size=(count, 3))
    for what, ask in {
        "volumes": lambda body, _: [body_points.volumes(body)],
        "areas": lambda body, _: [body_points.areas(body, (2, 1), 0.3), body_points.areas(body, None, 0.3)],
        "bounds": lambda body, _: list(body_points.bounds(body)),
        "balls": lambda body, _: [body_points.inradii(body), body_points.planar_inradii(body)],
        "gaps": lambda body, points: [
            body_points.distances_to_surface(body, points, side, threshold)
            for side, threshold in ((None, 0.0), ((0, -1), 0.2), ((2, 1), 0.9))
        ],
        "faces": lambda body, points: [body_points.nearest_faces(body, points, (2, -1), 0.2)],
        "points in it": lambda body, points: [contains_body_points(body, points)],
        "nearest": lambda body, points: list(distance.to_surface(body, points, len(points))),
        "signed": lambda body, points: [
            distance.signed(body, points, len(points)),
            distance.to_solid(body, points, len(points)),
        ],
    }.items():
        together = ask(body, points)
        for lane in range(count):
            mine = Body((meshes[choice[lane]],), None, poses.take(np.array([lane])))
            for found, alone in zip(together, ask(mine, points[[lane]]), strict=True):
                np.testing.assert_allclose(
                    found[lane], alone[0], atol=1e-12, err_msg=f"{what} of lane {lane}"
                )


def test_lanes_whose_side_has_no_faces_are_infinitely_far_from_it() -> None:
    """And change nothing for the others."""
    count, threshold = 12, 0.9
    poses, points = random_poses(count, 12), np.random.default_rng(13).normal(size=(count, 3))
    body = Body((primitives.box(),), None, poses)
    found = body_points.distances_to_surface(body, points, (2, 1), threshold)
    has_faces = body_points.areas(body, (2, 1), threshold) > 0
    assert 0 < has_faces.sum() < count
    np.testing.assert_array_equal(np.isfinite(found), has_faces)


@pytest.mark.parametrize("tries", [0, 1, 3])
def test_where_no_point_is_found_is_told(tries: int, monkeypatch: pytest.MonkeyPatch) -> None:
    """Lane by lane; of a box the first one always is one."""
    monkeypatch.setattr(body_points, "TRIES", tries)
    count, rng = 60, np.random.default_rng(14)
    poses, meshes = random_poses(count, 15), (table(), primitives.box())
    body = Body(meshes, np.arange(count) % 2, poses)
    uniforms, keys = rng.random((3, count)), rng.integers(0, 2**63, count).astype(np.uint64)
    points, found = body_points.draw_points(body, uniforms, keys)
    local = poses.to_unit(points)
    for number, mesh in enumerate(meshes):
        lanes = np.flatnonzero(body.choice == number)
        held = contains_points(mesh, local[lanes]) | mesh.is_box
        np.testing.assert_array_equal(found[lanes], held)
    assert found[1::2].all()
    assert not found.all()


@pytest.mark.parametrize("side", [None, (0, 1), (1, -1), (2, 1), (2, -1)])
@pytest.mark.parametrize("threshold", [0.3, 2.0])
def test_boxes_of_sides_hold_the_faces_that_look_there(
    side: tuple[int, int] | None, threshold: float
) -> None:
    """Of all faces where a side has none, or is not told."""
    for mesh in (table(), primitives.cone()):
        poses = random_poses(8, 3)
        for lane in range(8):
            alone = poses.take(np.array([lane]))
            corners = alone.to_world(mesh.triangles[None])[0]
            normals = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
            normals /= np.linalg.norm(normals, axis=1, keepdims=True)
            mine = (
                np.ones(len(normals), dtype=bool)
                if side is None
                else side[1] * normals[:, side[0]] >= threshold
            )
            mine = mine if mine.any() else np.ones(len(normals), dtype=bool)
            lower, upper = body_points.side_bounds(Body((mesh,), None, alone), side, threshold)
            np.testing.assert_allclose(lower, corners[mine].min(axis=(0, 1))[None], atol=1e-12)
            np.testing.assert_allclose(upper, corners[mine].max(axis=(0, 1))[None], atol=1e-12)
