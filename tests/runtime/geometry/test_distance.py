import itertools

import numpy as np
import pytest
import shapely
import trimesh
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.optimize import minimize, nnls
from scipy.spatial import ConvexHull

from scenic.runtime.geometry.contact import scalar_bodies as single
from scenic.runtime.geometry.contact.depth import convex_depth, convex_gap
from scenic.runtime.geometry.containment import distance
from scenic.runtime.geometry.flat.segments import Segments
from scenic.runtime.geometry.meshes.bodies import Body
from scenic.runtime.geometry.meshes.nearest import nearest_on_triangles
from scenic.runtime.geometry.poses import Poses

from .samples import (
    SHAPES,
    bumpy,
    common_volume,
    in_batches,
    random_poses,
    solid,
    table,
    world_vertices,
    yawed,
)

COUNT = 40


@settings(max_examples=60, deadline=None)
@given(st.integers(0, 10**6))
def test_nearest_points_of_triangles(seed):
    rng = np.random.default_rng(seed)
    corners = rng.normal(size=(3, 1, 3))
    if seed % 3 == 0:
        corners[2] = corners[1]  # a segment
    if seed % 6 == 0:
        corners[1:] = corners[0]  # a point
    point = rng.normal(size=(1, 3)) * 2
    found = nearest_on_triangles(point, *corners)[0]

    def place(weights):
        return (1 - weights.sum()) * corners[0, 0] + weights[0] * corners[1, 0] + weights[1] * corners[2, 0]

    def squared(weights):
        return ((place(weights) - point[0]) ** 2).sum()

    best = min(
        minimize(
            squared,
            start,
            bounds=[(0, 1)] * 2,
            constraints={"type": "ineq", "fun": lambda weights: 1 - weights.sum()},
            method="SLSQP",
            options={"ftol": 1e-14},
        ).fun
        for start in ([0.3, 0.3], [0.0, 0.0])
    )
    assert ((found - point[0]) ** 2).sum() == pytest.approx(best, abs=1e-7)


@pytest.mark.parametrize("name", SHAPES)
def test_points_and_surfaces(name):
    mesh = SHAPES[name]()
    poses = random_poses(COUNT, 1, spread=0.4)
    points = np.random.default_rng(2).uniform(-0.7, 0.7, (COUNT, 3))
    body = Body((mesh,), None, poses)
    found = distance.to_surface(body, points, COUNT)
    signs = distance.signed(body, points, COUNT)
    np.testing.assert_allclose(np.abs(signs), found.distance)
    np.testing.assert_allclose(np.linalg.norm(points - found.point, axis=1), found.distance, rtol=1e-9)
    np.testing.assert_array_equal(distance.to_solid(body, points, COUNT), np.maximum(signs, 0))
    for within in (0.0, float(np.median(found.distance)), float(found.distance.max())):
        near = distance.to_surface(body, points, COUNT, within=within).distance
        np.testing.assert_array_equal(near <= within, found.distance <= within)
        np.testing.assert_array_equal(near[near <= within], found.distance[near <= within])
    inside = 0
    for entry in range(COUNT):
        world = trimesh.Trimesh(world_vertices(mesh, poses, entry), mesh.faces, process=False)
        triangles = world.triangles
        each = np.linalg.norm(
            trimesh.triangles.closest_point(triangles, np.tile(points[entry], (len(triangles), 1)))
            - points[entry],
            axis=1,
        )
        assert found.distance[entry] == pytest.approx(each.min(), abs=1e-12)
        assert each[found.number[entry]] == pytest.approx(each.min(), abs=1e-12)
        assert (signs[entry] < 0) == (world.contains(points[entry : entry + 1])[0])
        inside += int(signs[entry] < 0)
    assert 0 < inside < COUNT


def test_what_is_exactly_as_far_as_asked_is_found():
    """Also at no distance at all; a hair farther it is not."""
    body = Body((table(),), None, Poses.fixed((1, 2, 3), size=(2, 4, 1)))
    ways = np.eye(3)[[0, 0, 1, 1, 2, 2]] * np.array([1, -1] * 3)[:, None]
    place = ways * (1, 2, 0.5) + (1, 2, 3) + np.where(ways == 0, (0.875, -1.75, 0.453125), 0)
    for gap in (0.0, 2.0**-40, 0.25, 3.0):
        near = distance.to_surface(body, place + gap * ways, 6, within=gap)
        np.testing.assert_array_equal(near.distance, gap)
        assert (near.number >= 0).all()
        if gap:
            near = distance.to_surface(body, place + gap * ways, 6, within=gap * (1 - 1e-6))
            np.testing.assert_array_equal(near.distance, np.inf)
            assert (near.number == -1).all()


PAIRS = [
    ("box", "box"),
    ("box", "cone"),
    ("table", "spheroid"),
    ("cylinder", "table"),
    ("bumpy", "bumpy"),
    ("hollow", "cone"),
]


@pytest.mark.parametrize(("first", "second"), PAIRS)
def test_bodies(first, second):
    seed = PAIRS.index((first, second))
    mesh_a, mesh_b = SHAPES[first](), SHAPES[second]()
    a, b = random_poses(COUNT, seed, spread=1.0), random_poses(COUNT, seed + 50, spread=1.0)
    found = distance.between(Body((mesh_a,), None, a), Body((mesh_b,), None, b), COUNT)
    back = distance.between(Body((mesh_b,), None, b), Body((mesh_a,), None, a), COUNT)
    np.testing.assert_allclose(found, back, atol=1e-12)
    for entry in range(COUNT):
        if found[entry] == 0:
            assert common_volume(mesh_a, a, mesh_b, b, entry) > 0
        else:
            gap = solid(mesh_a, a, entry).min_gap(solid(mesh_b, b, entry), 10.0)
            assert found[entry] == pytest.approx(gap, abs=1e-6)
    assert 0 < (found == 0).mean() < 1


def test_a_body_inside_another_is_at_no_distance():
    outer, inner = (
        Body((SHAPES["box"](),), None, yawed((0, 0, 0))),
        Body((table(),), None, yawed((0, 0, 0), 0, (0.1,) * 3)),
    )
    assert distance.between(outer, inner, 1) == 0
    cavity = Body((SHAPES["hollow"](),), None, yawed((0, 0, 0)))
    assert distance.between(cavity, inner, 1)[0] == pytest.approx(0.2)


def test_choices_and_fixed_bodies():
    meshes = (SHAPES["box"](), table())
    choice = np.arange(9) % 2
    poses = random_poses(9, 5, spread=3)
    still = Body((SHAPES["cone"](),), None, yawed((0, 0, 0)))
    found = distance.between(Body(meshes, choice, poses), still, 9)
    for lane in range(9):
        alone = Body((meshes[choice[lane]],), None, poses.take(np.array([lane])))
        assert distance.between(still, alone, 1)[0] == pytest.approx(found[lane], abs=1e-12)


@pytest.mark.parametrize("what", ["position", "orientation", "size"])
def test_lanes_that_differ_in_one_thing_alone(what):
    count = 5
    a, b = random_poses(count, 21, spread=0.2), yawed((0, 0, 2.2), 0.3, (0.5, 1, 0.7))
    parts = {
        name: getattr(a, name) if name == what else getattr(a, name)[:1]
        for name in ("position", "orientation", "size")
    }
    one, other = (
        Body((mesh,), None, poses) for mesh, poses in ((table(), Poses(**parts)), (SHAPES["cone"](), b))
    )
    found = distance.between(one, other, count)
    np.testing.assert_allclose(distance.between(other, one, count), found, atol=1e-12)
    for lane in range(count):
        alone = one.take(np.array([lane]))
        alone = Body(alone.meshes, None, Poses(*(getattr(alone.poses, name) for name in parts)))
        assert distance.between(alone, other, 1)[0] == pytest.approx(found[lane], abs=1e-12)
    assert len(np.unique(found)) == count


@pytest.mark.parametrize("batch", [1, 7])
def test_batches_do_not_matter(batch):
    a, b = random_poses(60, 6, spread=1), random_poses(60, 7, spread=1)
    points = np.random.default_rng(8).normal(size=(60, 3))

    def gaps(lanes):
        bodies = Body((bumpy(2),), None, a.take(lanes)), Body((table(),), None, b.take(lanes))
        return distance.between(*bodies, len(lanes))

    def signs(lanes):
        return distance.signed(Body((bumpy(2),), None, a.take(lanes)), points[lanes], len(lanes))

    for function in (gaps, signs):
        np.testing.assert_array_equal(in_batches(function, 60, batch), function(np.arange(60)))


def test_lines():
    """Long lines, through the tree, and short ones: the same as shapely, and the first of two segments that meet."""
    rng = np.random.default_rng(9)
    lines = [np.cumsum(rng.normal(size=(length, 2)), axis=0) for length in (2, 50, 400)]
    points = rng.normal(size=(300, 2)) * 15
    for chosen in (lines, lines[:1], lines[:2]):
        segments = Segments.of_chains([np.c_[line, np.zeros(len(line))].tolist() for line in chosen])
        distance, number, place = segments.nearest(np.c_[points, np.zeros(300)])
        oracle = shapely.MultiLineString([line.tolist() for line in chosen])
        np.testing.assert_allclose(distance, shapely.distance(oracle, shapely.points(points)), atol=1e-12)
        ends = shapely.linestrings(np.stack([segments.starts[number, :2], segments.ends[number, :2]], axis=1))
        np.testing.assert_allclose(shapely.distance(ends, shapely.points(place[:, :2])), 0, atol=1e-12)
    vertices = np.c_[lines[2][1:-1], np.zeros(398)]
    distance, number, place = Segments.of_chains([np.c_[lines[2], np.zeros(400)].tolist()]).nearest(vertices)
    np.testing.assert_array_equal(number, np.arange(398))
    np.testing.assert_allclose(place, vertices, atol=1e-12)


def test_chains_apart_are_told_apart_at_their_ends():
    """Of many segments as of few: at the start of a chain the last segment of the one before does not count."""
    chains = [[(x + 200 * number, float((x + number) % 2), number) for x in range(60)] for number in range(3)]
    whole = Segments.of_chains(chains)
    assert len(whole.starts) > 96
    places = np.array([chain[end] for chain in chains for end in (0, 1, 30, -1)], dtype=float)
    offsets = np.array([(0, 0, 0), (-0.5, -0.2, 0), (0, 0, 1), (0.4, -0.3, 0)])
    points = (places[:, None] + offsets).reshape(-1, 3)
    distance, number, place = whole.nearest(points)
    expected = whole._nearest_of_all(points)
    np.testing.assert_allclose(distance, expected[0], atol=1e-12)
    np.testing.assert_allclose(place, expected[2], atol=1e-12)
    joint = (place == whole.starts[number]).all(axis=1) | (place == whole.ends[number]).all(axis=1)
    np.testing.assert_array_equal(number[~joint], expected[1][~joint])
    # Where chains begin there is nothing before.
    for chain, first in zip(chains, (0, 59, 118), strict=True):
        assert whole.nearest(np.array([chain[0]], dtype=float))[1].tolist() == [first]
        assert whole.nearest(np.array([chain[1]], dtype=float))[1].tolist() == [first]


def least_norm(points: np.ndarray) -> float:
    """The distance from the origin to the hull of points, by weights that are not negative and add up to 1."""
    heavy = 1e4
    weights, _ = nnls(np.vstack([points.T, np.full(len(points), heavy)]), np.array([0, 0, 0, heavy]))
    return float(np.linalg.norm(points.T @ (weights / weights.sum())))


def differences(first: np.ndarray, second: np.ndarray) -> np.ndarray:
    return (first[:, np.newaxis] - second).reshape(-1, 3)


def test_distances_of_single_triangles() -> None:
    """Whichever corners and edges are nearest: no other face makes up for a pair that is left out."""
    rng, count = np.random.default_rng(5), 150
    a, b = rng.normal(size=(2, count, 3, 3))
    b += 2.5 * rng.normal(size=(count, 1, 3))
    a[::5, :, 2], b[::5, :, 2] = 0.0, 1.0  # parallel
    a[1::5, 2] = 0.5 * (a[1::5, 0] + a[1::5, 1])  # without an area
    found = distance.squared_distances(list(a.swapaxes(0, 1)), list(b.swapaxes(0, 1)))
    expected = np.array([least_norm(differences(*pair)) for pair in zip(a, b, strict=True)])
    apart = expected > 0.05
    assert apart.sum() > 100
    np.testing.assert_allclose(np.sqrt(found[apart]), expected[apart], atol=1e-5)


@pytest.mark.parametrize("corners", [(4, 4), (4, 8), (30, 5), (120, 120)])
def test_depths_and_gaps_of_convex_solids(corners: tuple[int, int]) -> None:
    """Against the hull of all differences; few corners, and many on round bodies, which take many rounds."""
    rng = np.random.default_rng(6)
    met, apart = 0, 0
    for number in range(40):
        first, second = (rng.normal(size=(count, 3)) for count in corners)
        if corners[0] > 100:
            first, second = (part / np.linalg.norm(part, axis=1, keepdims=True) for part in (first, second))
        first *= rng.uniform(0.3, 2, 3)
        second += rng.normal(size=3) * (0.3, 1.0, 2.5)[number % 3]
        between = differences(first, second)
        offset = float(ConvexHull(between).equations[:, 3].max())
        if offset < -1e-6:
            met += 1
            assert convex_depth(first, second) == pytest.approx(-offset, abs=1e-7)
            assert convex_depth(second, first) == pytest.approx(-offset, abs=1e-7)
        elif offset > 1e-3:
            apart += 1
            expected = least_norm(between)
            assert convex_gap(first, second) == pytest.approx(expected, abs=1e-4)
            assert convex_gap(second, first) == pytest.approx(expected, abs=1e-4)
    assert min(met, apart) >= 5


def test_gaps_of_boxes_in_symmetrical_positions() -> None:
    """Whose nearest points lie on edges and corners of the simplices that are looked at; from whichever corner they are."""
    corners = np.array(list(itertools.product((-0.5, 0.5), repeat=3)))
    rng = np.random.default_rng(8)
    for offset in itertools.product((-2, -1, 0, 0.5, 3), repeat=3):
        gap = float(np.linalg.norm(np.maximum(np.abs(offset) - 1, 0)))
        if gap > 0:
            first, second = rng.permutation(corners), rng.permutation(corners) + offset
            assert convex_gap(first, second) == pytest.approx(gap, abs=1e-9)


def test_depths_of_cubes_by_hand() -> None:
    """The least way out, along whichever axis it is; nothing where they only touch or are apart."""
    corners = np.array(list(itertools.product((-0.5, 0.5), repeat=3)))
    for offset, depth in (
        ((0, 0, 0), 1),
        ((0.75, 0, 0), 0.25),
        ((0.75, -0.875, 0), 0.125),
        ((0, 0, -0.5), 0.5),
        ((1, 0, 0), 0),
        ((1, 1, -1), 0),
        ((1.5, 0, 0), 0),
        ((0.25, -1.125, 0.5), 0),
    ):
        assert convex_depth(corners, corners + np.array(offset)) == pytest.approx(depth, abs=1e-9)


def test_what_lies_in_one_plane_has_no_depth() -> None:
    """Along an axis or tilted: what has no thickness is left by no way at all. What has one is left by the nearest."""
    cube = np.array(list(itertools.product((-0.5, 0.5), repeat=3)))
    square = cube * (1, 1, 0)
    assert convex_depth(square, square + np.array([0.25, 0.5, 0])) == 0
    tilted = square @ np.linalg.qr(np.random.default_rng(1).normal(size=(3, 3)))[0]
    assert convex_depth(tilted, tilted) == pytest.approx(0, abs=1e-9)
    assert convex_depth(square, cube + np.array([0, 0, 0.375])) == pytest.approx(0.125)


def test_gaps_of_two_bodies_are_those_over_lanes() -> None:
    """As far as one pair alone is decided: nothing is said of what is not convex, or so near that it may touch."""
    shapes = [SHAPES[name]() for name in ("box", "cone")]
    rng = np.random.default_rng(9)
    said, met = 0, 0
    for a, b in itertools.product(shapes, repeat=2):
        poses = [random_poses(12, int(rng.integers(1000)), spread=0.7) for _ in range(2)]
        expected = distance.between(
            *(Body((mesh,), None, pose) for mesh, pose in zip((a, b), poses, strict=True)), 12
        )
        for lane in range(12):
            one, other = (
                single.placed(
                    *(tuple(part[lane].tolist()) for part in (pose.position, pose.orientation, pose.size)),
                    mesh,
                )
                for mesh, pose in zip((a, b), poses, strict=True)
            )
            found = single.gap(one, other)
            if found is not None:
                assert found == pytest.approx(expected[lane], abs=1e-7)
                said += found > 0
                met += found == 0
            else:
                assert expected[lane] == pytest.approx(0, abs=1e-7)
    assert min(said, met) >= 5
    cube = SHAPES["box"]()
    still = (0.0, 0.0, 0.0, 1.0)
    places = [
        single.placed((x, 0.0, 0.0), still, (1.0, 1.0, 1.0), cube) for x in (0.0, 0.5, 1.0, 1.0 + 1e-13, 1.25)
    ]
    assert [single.gap(places[0], place) for place in places] == [0, 0, None, None, 0.25]
    far = single.placed((9.0, 0.0, 0.0), still, (1.0, 1.0, 1.0), table())
    assert [single.gap(*pair) for pair in ((places[0], far), (far, places[0]), (far, far))] == [None] * 3
