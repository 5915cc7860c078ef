"""Regions of cells, and what is drawn, met and held without a scenario of its own."""

import itertools
import random

import numpy as np
import pytest
import trimesh
from scenic.core.distributions import Range, Uniform
from scenic.core.regions import (
    BoxRegion,
    CircularRegion,
    MeshVolumeRegion,
    Region,
    SpheroidRegion,
    UndefinedSamplingException,
    ViewRegion,
    VoxelRegion,
    everywhere,
    nowhere,
    regionFromShapelyObject,
)
from scenic.core.vectors import Orientation, Vector
from scipy import stats

import scenic
from scenic.language.errors import RejectionException, ScenicTypeError, ScenicValueError
from scenic.runtime.geometry.meshes import primitives
from scenic.runtime.geometry.meshes.bodies import Body
from scenic.runtime.geometry.poses import Poses
from scenic.runtime.regions.fields import VectorField
from tests.amounts import amount
from tests.runtime.programs import FALSE_ALARM, draws, params

FILLED = np.array([[[1, 0], [0, 1]], [[1, 1], [0, 0]]], dtype=bool)


def test_a_grid_of_trimesh() -> None:
    region = VoxelRegion(trimesh.voxel.VoxelGrid(FILLED))
    assert region.size == 4
    assert region.AABB == ((-0.5, -0.5, -0.5), (1.5, 1.5, 1.5))
    held = [(0, 0, 0), (0.4, 0.4, 0.4), (-0.4, -0.4, -0.4), (0, 0.6, 1), (0.5, 0, 0.6)]
    assert [region.containsPoint(Vector(*point)) for point in held] == [True] * 5
    assert not any(region.containsPoint(Vector(*point)) for point in [(0, 0, 1), (-0.6, 0, 0), (0, 0, 1.6)])
    assert (region.voxelGrid.matrix == FILLED).all()
    np.testing.assert_allclose(region.voxelGrid.transform, np.eye(4))


def test_cells_of_volumes() -> None:
    box = BoxRegion(dimensions=(2, 2, 2)).voxelized(0.5)
    assert box.size == pytest.approx(125 * 0.125)
    assert box.dilation(1).size > box.size > box.dilation(-1).size == pytest.approx(27 * 0.125)
    ball = SpheroidRegion(dimensions=(2, 2, 2))
    cells = ball.voxelized(0.1)
    assert 4 / 3 * np.pi < cells.size < 4 / 3 * np.pi * 1.1**3 * 1.1
    rng = np.random.default_rng(3)
    points = rng.uniform(-1, 1, (500, 3))
    inside = np.linalg.norm(points, axis=1) <= 0.995
    assert cells.contains_points(points)[inside].all()
    far = np.linalg.norm(points, axis=1) > 1 + 0.1 * 3**0.5
    assert not cells.contains_points(points)[far].any()


def test_draws_are_uniform_over_cells() -> None:
    text = "import trimesh, numpy\n"
    text += f"r = VoxelRegion(trimesh.voxel.VoxelGrid(numpy.array({FILLED.tolist()})))\n"
    text = text.replace("r = VoxelRegion", "from scenic.core.regions import VoxelRegion\nr = VoxelRegion")
    points = np.array([tuple(p) for p in draws(text + "p = new Point in r\nparam x = p.position", n=800)])
    cells, counts = np.unique(np.floor(points + 0.5), axis=0, return_counts=True)
    assert sorted(map(tuple, cells.astype(int))) == sorted(map(tuple, np.argwhere(FILLED)))
    assert stats.chisquare(counts).pvalue > FALSE_ALARM
    rest = points + 0.5 - np.floor(points + 0.5)
    assert stats.kstest(rest.reshape(-1), "uniform").pvalue > FALSE_ALARM


def test_distances_are_those_to_the_boxes() -> None:
    random = np.random.default_rng(1)
    # Of the last two cells that with the nearer middle is the farther one.
    two = np.zeros((9, 2, 2), dtype=bool)
    two[0, 1, 1] = two[8, 0, 0] = True
    for filled, pitch in (
        *((FILLED, (1, 1, 1)), (random.random((6, 4, 5)) < 0.2, (0.2, 1, 4))),
        (two, (0.2, 2, 2)),
    ):
        region = VoxelRegion(trimesh.voxel.VoxelGrid(filled, transform=np.diag([*pitch, 1])))
        points = np.concatenate([np.zeros((1, 3)), random.uniform(-3, 4, (200, 3)) * pitch])
        beside = np.maximum(np.abs(points[:, None] - np.argwhere(filled) * pitch) - np.array(pitch) / 2, 0)
        expected = np.sqrt((beside**2).sum(axis=2)).min(axis=1)
        np.testing.assert_allclose(region.distances(points), expected, atol=1e-12)
        assert (region.gaps(points) <= expected + 1e-12).all()


def test_objects_in_cells() -> None:
    text = (
        "r = BoxRegion(dimensions=(2, 2, 2)).voxelized(0.5)\n"
        "ego = new Object with width 0.1, with length 0.1, with height 0.1\n"
        "p = new Object at (1.22, 0, 0), with width 0.2, with length 0.1, with height 0.1\n"
        "param x = (r.containsObject(ego), r.containsObject(p))"
    )
    assert params(text)["x"] == (True, False)


def test_grids_that_are_none() -> None:
    with pytest.raises(ScenicTypeError, match="voxel grid"):
        VoxelRegion(3)
    with pytest.raises(ScenicValueError, match="filled"):
        VoxelRegion(trimesh.voxel.VoxelGrid(np.zeros((2, 2, 2), dtype=bool)))
    with pytest.raises(ScenicValueError, match="positive"):
        BoxRegion().voxelized(0)


@pytest.mark.parametrize("edge", [1e-5, 3e-7, 1e-7, 1e-20, 1e-300])
def test_cells_may_be_too_many_for_any_integer(edge: float) -> None:
    with pytest.raises(ScenicValueError, match=f"cells of {edge:g} m would be"):
        BoxRegion(position=(3, 2, -1), dimensions=(1, 2, 4)).voxelized(edge)


CONTAINERS = {
    "ball without a ball": "BoxRegion(dimensions=(4, 4, 4)).difference(SpheroidRegion(dimensions=(2, 2, Range(1.99, 2))))",
    "disc without a box": "CircularRegion((0, 0), 2).footprint.difference(BoxRegion(dimensions=(1, Range(1, 1.2), 9)))",
    "disc without a disc": "CircularRegion((0, 0), 2).footprint.difference(CircularRegion((Range(0, 0.1), 0), 0.8).footprint)",
    "two of them": "Uniform(SpheroidRegion(dimensions=(4, 4, 4)), BoxRegion(dimensions=(9, 9, 1)).difference(SpheroidRegion()))",
    "either": "BoxRegion(dimensions=(3, 1, Range(2.9, 3))).union(BoxRegion(dimensions=(1, 9, 1)))",
    "side by side": "RectangularRegion((-1, 0), 0, 2, 2).footprint.union(RectangularRegion((Range(0.9, 1), 0), 0, 2, 2).footprint)",
}


@pytest.mark.parametrize("name", CONTAINERS)
def test_containers_are_kept_in_batches_as_they_are_alone(name: str) -> None:
    """Every scene's object is held when it is asked alone; and about as many points are left as a grid says."""
    text = (
        f"r = {CONTAINERS[name]}\n"
        "ego = new Object at (Range(-2, 2), Range(-2, 2), 0), with width 0.3, with length 0.4, with height 0.2, facing Range(0, 6),"
        " with regionContainedIn r\nparam r = r"
    )
    loaded = scenic.scenarioFromString(text)
    scenes = loaded.sample(amount(20, 60), seed=4)
    for scene in scenes:
        assert scene.params["r"].containsObject(scene.egoObject)
    free = scenic.scenarioFromString(
        text.replace("with regionContainedIn r", "with regionContainedIn everywhere")
    )
    count = amount(30, 60)
    held = [
        scene.params["r"].containsObject(scene.egoObject) for scene in free.sample(amount(100, 150), seed=5)
    ]
    tried = sum(scene.attempts for scene in loaded.sample(count, seed=6))
    share = np.mean(held)
    assert 0.05 < share < 0.95
    if tried > count:  # Containment may also have narrowed the distributions.
        assert stats.binomtest(count, tried, float(share)).pvalue > 1e-6 or count / tried > share


def test_samples_drawn_now() -> None:
    random.seed(3)
    draw = Range(0, 1) + 2
    first = [draw.sample() for _ in range(200)]
    random.seed(3)
    assert first == [draw.sample() for _ in range(200)]
    assert stats.kstest(np.array(first) - 2, "uniform").pvalue > FALSE_ALARM
    assert {Uniform("a", "b").sample() for _ in range(30)} == {"a", "b"}
    point = Region.uniformPointIn(CircularRegion((1, 2), 3)).sample()
    assert CircularRegion((1, 2), 3).containsPoint(point)
    assert isinstance(Vector(Range(0, 1), 2).sample(), Vector)
    region = BoxRegion(dimensions=(Range(1, 2), 1, 1)).sample()
    assert 1 <= region.dimensions.x <= 2
    assert Range(1, 3).supportInterval() == pytest.approx((1, 3))
    assert Range(1, 3).clone() is not None
    with pytest.raises(RejectionException):
        scenic.core.distributions.DiscreteRange(2.2, Range(2.3, 2.4)).sample()


def test_regions_without_uniform_points() -> None:
    for region in (everywhere, CircularRegion((0, 0), 1).footprint):
        with pytest.raises(UndefinedSamplingException):
            region.uniformPointInner()
    with pytest.raises(RejectionException, match="the empty region"):
        nowhere.uniformPointInner()
    assert nowhere.distanceTo(Vector(1, 2, 3)) == np.inf
    assert (everywhere.size, nowhere.size) == (np.inf, 0)


def test_members_that_scripts_use() -> None:
    import shapely

    ego = (
        scenic.scenarioFromString("ego = new Object at (1, 2, 3), facing 90 deg, with width 2, with length 4")
        .sample(1, seed=0)[0]
        .egoObject
    )
    space = ego.occupiedSpace
    np.testing.assert_allclose(space.mesh.bounds, [[-1, 1, 2.5], [3, 3, 3.5]])
    assert space.boundingPolygon.area == pytest.approx(8)
    assert space.getSurfaceRegion().size == pytest.approx(2 * (8 + 2 + 4))
    assert space.isConvex
    assert tuple(space.position) == (1, 2, 3)
    assert Vector(1, 2, 10).distanceTo(ego) == pytest.approx(6.5)
    with pytest.raises(TypeError, match="rotation of SciPy"):
        Orientation((0, 0, 0, 1))
    assert regionFromShapelyObject(shapely.box(0, 0, 2, 3)).area == 6
    corner = MeshVolumeRegion(trimesh.creation.box((1, 1, 1)))
    assert corner.containsPoint(Vector(0.5 + 5e-7, 0.5, 0.5))
    assert not corner.containsPoint(Vector(0.5 + 5e-6, 0.5, 0.5))


@pytest.mark.parametrize("angles", [(6.28, 3.14), (1.5, 3.14), (2, 0.8)])
def test_distances_from_views_are_those_of_their_points(angles: tuple[float, float]) -> None:
    ego = (
        scenic.scenarioFromString(
            f"ego = new Object at (1, 2, 3), facing (0.4, 0.2, 0), with viewAngles {angles}, with visibleDistance 5"
        )
        .sample(1, seed=0)[0]
        .egoObject
    )
    view = ego.visibleRegion
    random.seed(1)
    inner = np.array([tuple(view.uniformPointInner()) for _ in range(amount(1500, 4000))])
    for point in np.random.default_rng(2).uniform(-9, 12, (12, 3)):
        found = view.distanceTo(Vector(*point))
        nearest = np.linalg.norm(inner - point, axis=1).min()
        assert found <= nearest + 1e-6 or view.containsPoint(Vector(*point))
        assert nearest - found < 1.2


def test_views_of_no_observer() -> None:
    view = ViewRegion(10, (1, 1), position=(1, 2, 3), rotation=Orientation.fromEuler(np.pi / 2, 0, 0))
    assert view.containsPoint(Vector(-5, 2, 3))
    assert not view.containsPoint(Vector(5, 2, 3))
    assert not view.containsPoint(Vector(-12, 2, 3))
    assert view.size == pytest.approx(1000 / 3 * 2 * np.sin(0.5), rel=1e-3)
    assert isinstance(
        scenic.scenarioFromString("ego = new Object").sample(1, seed=0)[0].egoObject.visibleRegion, ViewRegion
    )
    with pytest.raises(ScenicValueError, match="greater than 0"):
        ViewRegion(10, (0, 1))


def test_cells_hold_objects_exactly() -> None:
    cells = SpheroidRegion(dimensions=(4, 4, 4)).voxelized(0.25)
    text = "new Object at {}, facing {}, with shape SpheroidShape(), with width 2, with length 2, with height 3.9"
    upright = scenic.scenarioFromString(text.format("(0, 0, 0)", 0)).sample(1, seed=0)[0].objects[0]
    assert cells.containsObject(upright)  # though its box reaches empty cells
    moved = scenic.scenarioFromString(text.format("(0.6, 0, 0.3)", 0)).sample(1, seed=0)[0].objects[0]
    assert not cells.containsObject(moved)
    tilted = (
        scenic.scenarioFromString(text.format("(0, 0, 0)", "(0, 45 deg, 0)")).sample(1, seed=0)[0].objects[0]
    )
    assert cells.containsObject(tilted)


def test_objects_in_cells_agree_with_their_points() -> None:
    rng = np.random.default_rng(4)
    cells = VoxelRegion(trimesh.voxel.VoxelGrid(rng.random((4, 4, 4)) < 0.8))
    text = "new Object at (Range(0, 3), Range(0, 3), Range(0, 3)), facing (Range(0, 3), Range(0, 3), 0), with width 0.4, with length 0.7, with height 0.3"
    answers = set()
    for scene in scenic.scenarioFromString(text).sample(amount(30, 60), seed=1):
        (item,) = scene.objects
        points = np.array([tuple(item.occupiedSpace.uniformPointInner()) for _ in range(60)])
        corners = np.array([tuple(corner) for corner in item.corners])
        held = cells.containsObject(item)
        if held:
            assert cells.contains_points(np.concatenate([points, corners])).all()
        else:
            # Most of what sticks out of cells is hit by some point of a fine grid of the body.
            assert not cells.contains_points(_grid(item)).all()
        answers.add(held)
    assert answers == {True, False}


def _grid(item: object) -> np.ndarray:
    steps = np.stack(np.meshgrid(*[np.linspace(-0.5, 0.5, 33)] * 3), axis=-1).reshape(-1, 3)
    box = item.occupiedSpace.mesh  # type: ignore[attr-defined] # an object of a scene
    one, two, three = (np.array(tuple(getattr(item, side).position)) for side in ("right", "front", "top"))
    middle = np.array(tuple(item.position))  # type: ignore[attr-defined] # likewise
    assert box.is_watertight
    return middle + 2 * steps @ np.array([one - middle, two - middle, three - middle])


def test_the_mesh_of_cells() -> None:
    region = VoxelRegion(trimesh.voxel.VoxelGrid(FILLED))
    mesh = region.mesh
    assert isinstance(mesh, MeshVolumeRegion)
    assert mesh.size == pytest.approx(region.size)
    assert mesh.AABB == region.AABB
    points = np.random.default_rng(1).uniform(-0.7, 1.7, (500, 3))
    held = mesh.contains_points(points, *mesh.fixed_columns("points"))
    assert (held == region.contains_points(points)).all()
    assert region.voxel_points.shape == (4, 3)
    assert region.kdTree.query(region.voxel_points[0])[0] == 0


def test_bodies_beside_cells_touch_those_that_they_reach() -> None:
    """Up to the border of a cell, on every side of it; and no farther."""
    import scenic.core.regions as named
    import trimesh

    filled = np.zeros((2, 3, 1), dtype=bool)
    filled[0, 0] = filled[1, 2] = True
    transform = np.diag([2.0, 1.0, 4.0, 1.0])
    cells = named.VoxelRegion(trimesh.voxel.VoxelGrid(filled, transform=transform))
    for centre in ((0, 0, 0), (2, 2, 0)):
        for axis, half in enumerate((1.0, 0.5, 2.0)):
            for side in (-1, 1):
                for off, met in ((-0.01, True), (0.01, False)):
                    place = np.array(centre, dtype=float)
                    place[axis] += side * (half + 0.1 + off)
                    body = named.BoxRegion(dimensions=(0.2, 0.2, 0.2), position=tuple(place))
                    assert cells.intersects(body) is met
                    assert body.intersects(cells) is met
    assert not cells.intersects(named.BoxRegion(dimensions=(0.5, 0.5, 0.5), position=(2, 0, 0)))


def test_all_points_of_closed_cells_are_held() -> None:
    """Faces, edges and corners, too, but nothing a hair beside them."""
    filled = np.zeros((3, 3, 3), dtype=bool)
    filled[1, 1, 1] = True
    region = VoxelRegion(trimesh.voxel.VoxelGrid(filled, transform=np.diag([0.5, 1, 2, 1])))
    places = np.array(list(itertools.product((-0.5, 0, 0.5), repeat=3)))
    points = (places + 1) * (0.5, 1, 2)
    assert region.contains_points(points).all()
    outer = places[(places != 0).any(axis=1)]
    assert not region.contains_points((outer * (1 + 1e-9) + 1) * (0.5, 1, 2)).any()
    full = VoxelRegion(trimesh.voxel.VoxelGrid(np.ones((2, 2, 2), dtype=bool)))
    assert full.contains_points(np.array(list(itertools.product((-0.5, 0, 0.5, 1, 1.5), repeat=3)))).all()


def test_cells_stand_where_the_grid_is_moved_to() -> None:
    """By its transformation, whose last column is where the middle of the first cell is."""
    transform = np.diag([0.5, 1, 2, 1.0])
    transform[:3, 3] = (10, -20, 30)
    region = VoxelRegion(trimesh.voxel.VoxelGrid(FILLED, transform=transform))
    np.testing.assert_allclose(region.AABB, ((9.75, -20.5, 29), (10.75, -18.5, 33)))
    places = np.array(list(itertools.product(range(2), repeat=3)))
    held = region.contains_points(places * (0.5, 1, 2) + (10, -20, 30))
    np.testing.assert_array_equal(held, FILLED[tuple(places.T)])
    np.testing.assert_allclose(region.voxelGrid.transform, transform)


def test_boxes_of_cells_are_counted_whole() -> None:
    """A box that ends on faces of cells is held where all cells in it are filled."""
    rng = np.random.default_rng(4)
    filled = rng.random((5, 4, 6)) < 0.93
    region = VoxelRegion(trimesh.voxel.VoxelGrid(filled))
    ends = np.sort(np.stack([rng.integers(0, size + 1, (2, 400)) for size in filled.shape], axis=-1), axis=0)
    first, last = ends[:, (ends[0] < ends[1]).all(axis=1)]
    expected = np.array([filled[tuple(map(slice, *pair))].all() for pair in zip(first, last, strict=True)])
    poses = Poses((first + last) / 2 - 0.5, np.array([[0.0, 0, 0, 1]]), (last - first).astype(float))
    body = Body((primitives.box(),), None, poses)
    np.testing.assert_array_equal(region.contains_bodies(body, len(first)), expected)
    assert 0.1 < expected.mean() < 0.9


def test_bodies_that_just_touch_cells_meet_them() -> None:
    """On each face of the first and the last of them."""
    cells = VoxelRegion(trimesh.voxel.VoxelGrid(np.ones((2, 2, 2), dtype=bool)))
    for axis, (off, end) in itertools.product(range(3), ((-1, -0.5), (1, 1.5))):
        place = np.array([0.25, 0.25, 0.25])
        for beyond, met in ((0.0, True), (1e-6, False)):
            place[axis] = end + off * (0.25 + beyond)
            body = BoxRegion((0.5, 0.5, 0.5), tuple(place.tolist()))
            assert cells.intersects(body) is met
            assert body.intersects(cells) is met


def test_cells_grow_and_shrink_by_their_neighbours() -> None:
    """Those that share a face, or whichever are named."""
    random = np.random.default_rng(5)
    filled = random.random((4, 5, 6)) < 0.95
    field = VectorField("f", lambda place: place.x)
    grid = trimesh.voxel.VoxelGrid(filled, transform=np.diag([0.5, 1, 2, 1]))
    region = VoxelRegion(grid, orientation=field)
    across = {(0, 0, 0), (1, 0, 0), (-1, 0, 0)}
    faces = {tuple(way) for way in (*np.eye(3, dtype=int).tolist(), *(-np.eye(3, dtype=int)).tolist())} | {
        (0, 0, 0)
    }
    cells = set(map(tuple, np.argwhere(filled).tolist()))
    for named, steps in ((None, faces), (across, across)):
        structure = None
        if named is not None:
            structure = np.zeros((3, 3, 3), dtype=bool)
            structure[tuple(np.transpose(list(named)) + 1)] = True
        for iterations in (1, 2, -1):
            expected = cells
            for _ in range(abs(iterations)):
                moved = [{tuple(np.add(cell, step).tolist()) for cell in expected} for step in steps]
                expected = set.union(*moved) if iterations > 0 else set.intersection(*moved)
            found = region.dilation(iterations, structure)
            places = np.array(sorted(expected)) * (0.5, 1, 2)
            np.testing.assert_allclose(sorted(found.voxel_points.tolist()), places, atol=1e-12)
            assert found.orientation is field
            assert found.scale.tolist() == [0.5, 1, 2]
    assert region.dilation(0) is region


def test_the_mesh_of_cells_keeps_their_place_field_and_name() -> None:
    field = VectorField("f", lambda place: place.x)
    transform = np.diag([0.5, 1, 2, 1.0])
    transform[:3, 3] = (10, -20, 30)
    grid = trimesh.voxel.VoxelGrid(FILLED, transform=transform)
    mesh = VoxelRegion(grid, orientation=field, name="blocks").mesh
    np.testing.assert_allclose(mesh.AABB, ((9.75, -20.5, 29), (10.75, -18.5, 33)))
    assert mesh.orientation is field
    assert mesh.name == "blocks"
    assert VoxelRegion(grid).mesh.has_orientation is False
    points = (np.random.default_rng(2).uniform(-0.7, 1.7, (300, 3))) * (0.5, 1, 2) + (10, -20, 30)
    held = mesh.contains_points(points, *mesh.fixed_columns("points"))
    np.testing.assert_array_equal(held, VoxelRegion(grid).contains_points(points))


def test_the_middles_of_cells_are_found_by_their_search_tree() -> None:
    transform = np.diag([0.5, 1, 2, 1.0])
    transform[:3, 3] = (10, -20, 30)
    region = VoxelRegion(trimesh.voxel.VoxelGrid(FILLED, transform=transform))
    assert region.scale.tolist() == [0.5, 1, 2]
    middles = np.argwhere(FILLED) * (0.5, 1, 2) + (10, -20, 30)
    np.testing.assert_allclose(region.voxel_points, middles)
    off = 0.1 * np.eye(3)[np.arange(4) % 3]
    distances, numbers = region.kdTree.query(middles + off)
    np.testing.assert_allclose(distances, 0.1)
    assert numbers.tolist() == [0, 1, 2, 3]


@pytest.mark.parametrize("order", [(0, 1, 2), (2, 0, 1), (1, 2, 0)])
def test_each_body_is_asked_of_the_empty_cells_that_it_reaches_itself(order: tuple[int, ...]) -> None:
    """Some of all that the bodies reach together are reached by none, or by one that is not held already."""
    filled = np.ones((9, 3, 3), dtype=bool)
    filled[0, 0, 0] = filled[4, 0, 0] = filled[8, 2, 2] = False
    region = VoxelRegion(trimesh.voxel.VoxelGrid(filled))
    # Each box reaches an empty cell; the ball in the second does not. Nobody reaches that in the middle.
    places = np.array([(0.6, 0.6, 0.6), (6.8, 0.8, 0.8), (7.4, 1.4, 1.4)])[list(order)]
    body = Body(
        (primitives.spheroid(),), None, Poses(places, np.array([[0.0, 0, 0, 1]]), np.full((1, 3), 2.0))
    )
    held = region.contains_bodies(body, 3).tolist()
    assert held == [[False, True, False][number] for number in order]
    alone = [region.contains_bodies(body.take(np.array([lane])), 1)[0] for lane in range(3)]
    assert alone == held
