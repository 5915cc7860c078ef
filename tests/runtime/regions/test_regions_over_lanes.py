"""Regions of random parameters, asked and drawn from with the columns that parameters have: each lane is a region of its own."""

import math
from typing import Any

import numpy as np
import pytest
import scenic.core.regions as named
from numpy.typing import NDArray
from scipy import stats

from scenic.graph.bounds import Bounds
from scenic.language.errors import InvalidScenarioError
from scenic.runtime.geometry.meshes import primitives
from scenic.runtime.geometry.meshes.bodies import Body, Poses
from scenic.runtime.regions import composite
from scenic.runtime.regions.algebra import meets_bodies
from scenic.runtime.regions.base import Region
from scenic.runtime.regions.choice import RegionChoice
from scenic.runtime.regions.circular import CircularRegion
from scenic.runtime.regions.combinations import DifferenceRegion, IntersectionRegion, UnionRegion
from scenic.runtime.regions.rectangular import RectangularRegion
from scenic.runtime.regions.scattered import GridRegion
from scenic.runtime.regions.volumes import BoxRegion, SpheroidRegion
from tests.runtime.programs import (
    FALSE_ALARM,
    assert_same_rotation,
    draws,
    euler,
    failure,
    rotation,
    scenario,
)

N = 4000


def drawn(region: Region, *columns: Any, n: int = N) -> tuple[NDArray[np.float64], Any]:
    """Points of a region in lanes, with its columns or those of its fixed parameters."""
    random = np.random.default_rng(4)
    given = columns or tuple(region.fixed_columns("the test"))
    keys = random.integers(0, 1 << 63, n, dtype=np.uint64)
    return region.draw_points(random.random((region.draws, n)), keys, *given)


def rows(region: Region) -> list[Any]:
    return region.fixed_columns("the test")


def assert_share(found: Any, share: float) -> None:
    count = int(np.count_nonzero(found))
    assert stats.binomtest(count, len(found), share).pvalue > FALSE_ALARM


def test_points_of_a_union_are_uniform_where_members_overlap() -> None:
    """A draw that is given up for lying in two members is repeated in any member, not in the same one."""
    whole, half = RectangularRegion((1, 0), 0, 2, 1), RectangularRegion((0.5, 0), 0, 1, 1)
    for members in ((whole, half), (half, whole), (half, whole, half)):
        points, found = drawn(UnionRegion(*members))
        assert found.all()
        assert_share(points[:, 0] < 1, 1 / 2)
        assert stats.kstest(points[:, 0] / 2, "uniform").pvalue > FALSE_ALARM


def test_members_of_lower_dimension_do_not_thin_a_union() -> None:
    """The cells of a grid hold points although only their middles are drawn."""
    grid = GridRegion("cells", [[0]], 1, 1, 0.5, 0)
    whole = RectangularRegion((1, 0), 0, 2, 1)
    assert grid.dimension < whole.dimension
    for members in ((whole, grid), (grid, whole)):
        points, _ = drawn(UnionRegion(*members))
        assert_share(points[:, 0] < 1, 1 / 2)


def test_points_of_an_intersection_come_from_its_thinnest_member() -> None:
    ball, disc = SpheroidRegion((4, 4, 4), (0, 0, 1)), CircularRegion((1, 0, 1), 2)
    for members in ((ball, disc), (disc, ball)):
        region = IntersectionRegion(*members)
        points, found = drawn(region, n=200)
        assert found.all()
        assert region.dimension == 2
        assert (points[:, 2] == 1).all()
        assert (np.hypot(points[:, 0], points[:, 1]) <= 2).all()
        assert (np.hypot(points[:, 0] - 1, points[:, 1]) <= 2).all()


def test_what_a_member_does_not_find_is_not_drawn(monkeypatch: pytest.MonkeyPatch) -> None:
    """Nothing is left of a disc without a larger one in every second lane; and the origin is no stand-in."""
    monkeypatch.setattr(composite, "TRIES", 40)
    radius = np.where(np.arange(40) % 2, 3.0, 0.5)
    disc, hole, far = CircularRegion((0, 0), 1), CircularRegion((0, 0), 1), CircularRegion((9, 9), 1)
    left = DifferenceRegion(disc, hole)
    columns = [*rows(disc), rows(hole)[0], radius, *rows(hole)[2:], *rows(far)]
    region = DifferenceRegion(left, far)
    points, found = drawn(region, *columns, n=40)
    np.testing.assert_array_equal(found, radius < 1)
    distance = np.hypot(points[:, 0], points[:, 1])[found]
    assert ((distance > 0.5) & (distance <= 1)).all()
    choice = RegionChoice(0, [left, disc])
    index = (np.arange(40) // 2 % 2).astype(np.int64)
    points, found = drawn(choice, index, *columns[: len(left.parameters)], *rows(disc), n=40)
    np.testing.assert_array_equal(found, (radius < 1) | (index == 1))


def test_footprints_of_combinations_hold_at_every_height() -> None:
    low, high = CircularRegion((0, 0, 0), 2), CircularRegion((1, 0, 0), 2)
    places = np.array([(x, 0.0, z) for x in (-1.5, 0.5, 2.5, 5.0) for z in (0.0, 7.0)])
    expected = {
        IntersectionRegion: [False, True, False, False],
        UnionRegion: [True, True, True, False],
        DifferenceRegion: [True, False, False, False],
    }
    for kind, inside in expected.items():
        footprint = kind(low, high).footprint
        assert footprint.dimension == low.footprint.dimension
        found = footprint.contains_points(places, *rows(footprint))
        np.testing.assert_array_equal(found, np.repeat(inside, 2))
        found = composite.exactly_contains(footprint, places, rows(footprint))
        np.testing.assert_array_equal(found, np.repeat(inside, 2))


def test_members_of_a_random_union_hold_a_body_together() -> None:
    """A box across the seam of two squares, which in some lanes leave a gap between them."""
    program = (
        "gap = Uniform(-0.5, 0, 0.5)\n"
        "room = RectangularRegion((-2, 0), 0, 4, 4).union(RectangularRegion((2 + gap, 0), 0, 4, 4))\n"
        "box = new Object with width 2, with length 1, with regionContainedIn everywhere\n"
        "param x = (room.containsObject(box), gap)\n"
    )
    assert set(draws(program, n=24)) == {(True, -0.5), (True, 0), (False, 0.5)}


def test_lanes_of_a_union_are_those_of_its_columns() -> None:
    """Some bodies a member holds alone; the lanes that are left are looked at with their own parameters and shapes."""
    program = (
        "gap, x = Uniform(-0.25, 0.5), Uniform(-2.5, 0.1)\n"
        "room = RectangularRegion((-2, 0), 0, 4, 4).union(RectangularRegion((2 + gap, 0), 0, 4, 4))\n"
        "thing = new Object at (x, 0, 0), with width 2, with length 1, with shape Uniform(BoxShape(), CylinderShape()), "
        "with regionContainedIn everywhere\n"
        "param x = (room.containsObject(thing), gap, x)\n"
    )
    found = draws(program, n=48)
    assert [held for held, _, _ in found] == [x < -1 or gap < 0 for _, gap, x in found]
    assert len(set(found)) == 4


def test_gaps_of_a_choice_are_those_of_the_drawn_region() -> None:
    """A container of the plane is no farther from what is above it."""
    disc, plate = CircularRegion((0, 0, 0), 1), CircularRegion((10, 0, 0), 2)
    index = np.array([0, 1, 0, 1])
    places = np.array([(4.0, 0, 5), (4.0, 0, 5), (0.5, 0, 5), (0.5, 0, 5)])
    columns = (index, *rows(disc), *rows(plate))
    found = RegionChoice(0, [disc, plate]).gaps(places, *columns)
    np.testing.assert_allclose(found, [3, 4, 0, 7.5])


def two_bodies(first: Any, second: Any) -> Body:
    """Unit cubes in two lanes."""
    turn = np.tile((0.0, 0.0, 0.0, 1.0), (2, 1))
    return Body(
        (primitives.box(),), None, Poses(np.array([first, second], dtype=float), turn, np.ones((2, 3)))
    )


def test_cells_hold_the_body_of_each_lane() -> None:
    grid = GridRegion("cells", [[0, 0, 1]], 2, 2, 0, 0)
    free, blocked = (1, 0, 0), (3.2, 0, 0)
    for places, expected in (((free, blocked), [True, False]), ((blocked, free), [False, True])):
        np.testing.assert_array_equal(grid.contains_bodies(two_bodies(*places), 2), expected)


def test_regions_meet_the_shape_of_each_lane() -> None:
    """A ball near a corner of a unit cube does not meet the ellipsoid that fills the cube."""
    cube, ball = primitives.box(), primitives.spheroid()
    corner = BoxRegion((0.2, 0.2, 0.2), (0.5, 0.5, 0.5))
    for choice in ([0, 1, 0], [1, 0, 1]):
        body = Body((cube, ball), np.array(choice), Poses.fixed((0, 0, 0)))
        found = meets_bodies(corner, body, 3, rows(corner))
        np.testing.assert_array_equal(found, [number == 0 for number in choice])


def test_points_of_a_drawn_side_are_uniform() -> None:
    """Both coordinates on the top of one of two boxes: of the face and of the place on it as little as of each other."""
    text = (
        "a = new Object at (0, 0), with regionContainedIn everywhere\n"
        "b = new Object at (5, 0), with regionContainedIn everywhere\n"
        "p = new Point in Uniform(a.topSurface, b.topSurface)\nparam x = tuple(p.position)\n"
    )
    values = np.array(draws(text, n=1500))
    np.testing.assert_allclose(values[:, 2], 0.5)
    assert_share(values[:, 0] > 2.5, 1 / 2)
    for axis in np.where(values[:, 0] > 2.5, values[:, 0] - 5, values[:, 0]), values[:, 1]:
        assert stats.kstest(axis + 0.5, "uniform").pvalue > FALSE_ALARM
    cells = np.histogram2d(
        np.remainder(values[:, 0] + 0.5, 5), values[:, 1] + 0.5, bins=3, range=[[0, 1]] * 2
    )[0]
    assert stats.chisquare(cells.ravel()).pvalue > FALSE_ALARM


WALLS = """\
box = new Object facing {yaw} deg, with regionContainedIn everywhere, with sideComponentThresholds {thresholds}
param x = tuple(side.intersects(CUBE) for side in (box.leftSurface, box.rightSurface, box.backSurface, box.frontSurface, \
box.bottomSurface, box.topSurface))
"""
UP = "(-0.5, 0.5)"


@pytest.mark.parametrize(
    ("yaw", "x", "y", "touched"),
    [
        (0, UP, UP, "left"),
        (45, UP, UP, "left back"),  # the components of the wall's normal are 0.71
        (45, "(-0.8, 0.5)", UP, "back"),
        (45, UP, "(-0.8, 0.5)", "left"),
        (45, "(-0.8, 0.5)", "(-0.8, 0.5)", ""),
        (45, "(-0.5, 0.8)", "(-0.5, 0.8)", "left back"),
    ],
)
def test_sides_have_the_faces_that_pass_their_thresholds(yaw: int, x: str, y: str, touched: str) -> None:
    """Asked by a small cube at the middle of the wall that looks to the left, and with the turned box also to the back."""
    half = 0.5 * np.cos(np.deg2rad(yaw))
    cube = f"BoxRegion(dimensions=(0.1, 0.1, 0.1), position=({-half}, {-0.5 * np.sin(np.deg2rad(yaw))}, 0))"
    text = WALLS.format(yaw=yaw, thresholds=f"({x}, {y}, {UP})").replace("CUBE", cube)
    (found,) = draws(text, n=1)
    names = ("left", "right", "back", "front", "bottom", "top")
    assert [name for name, meets in zip(names, found, strict=True) if meets] == touched.split()


def test_a_side_ends_where_its_faces_end() -> None:
    """What holds a corner of the bottom alone does not meet the top; sides without faces meet nothing."""
    text = (
        "box = new Object facing 45 deg, with regionContainedIn everywhere, with sideComponentThresholds {}\n"
        "corner = BoxRegion(dimensions=(0.2, 0.2, 0.2), position=(0, 0.7071, -0.5))\n"
        "param x = (box.bottomSurface.intersects(corner), box.topSurface.intersects(corner), "
        "box.topSurface.intersects(box.leftSurface), box.leftSurface.intersects(box.topSurface))\n"
    )
    assert draws(text.format("((-0.5, 0.5), (-0.5, 0.5), (-0.5, 0.5))"), n=1) == [(True, False, True, True)]
    none = text.format("((-0.8, 0.8), (-0.5, 0.5), (-0.5, 0.5))")
    assert draws(none, n=1) == [(True, False, False, False)]
    assert isinstance(failure(none + "param y = box.leftSurface.mesh\n"), InvalidScenarioError)


def test_boxes_of_sides() -> None:
    """Of the side itself where the object is fixed."""
    (found,) = draws(
        "box = new Object with width 4\nparam x = (box.topSurface.AABB, box.surface.AABB)\n", n=1
    )
    np.testing.assert_allclose(found, [[(-2, -0.5, 0.5), (2, 0.5, 0.5)], [(-2, -0.5, -0.5), (2, 0.5, 0.5)]])


def test_fields_of_combinations() -> None:
    """Where regions overlap the first one tells; what is left of a line keeps the way that it goes if that is the first."""
    text = (
        "one, two = VectorField('one', lambda p: 1), VectorField('two', lambda p: 2)\n"
        "a = RectangularRegion((0, 0), 0, 4, 4)\n"
        "a, b = (PolygonalRegion(polygon=Polygon([(x, 0), (x + 4, 0), (x + 4, 4), (x, 4)]), orientation=field) "
        "for x, field in ((0, one), (2, two)))\n"
        "line = PolylineRegion([(-1, 1), (9, 1)])\n"
        "ab, ba = a.union(b), b.union(a)\n"
        "param x = (*(r.orientation[place].yaw for r in (ab, ba) for place in ((1, 1), (3, 1), (5, 1))), "
        "line.intersect(a).orientation[(1, 1)].yaw, a.intersect(line).orientation[(1, 1)].yaw, "
        "a.intersect(b).orientation[(3, 1)].yaw, b.intersect(a).orientation[(3, 1)].yaw)\n"
    )
    (found,) = draws("from shapely import Polygon\n" + text, n=1)
    assert found == pytest.approx((1, 1, 2, 1, 2, 2, -math.pi / 2, 1, 1, 2))


@pytest.mark.parametrize("kind", ["UnionRegion", "IntersectionRegion", "DifferenceRegion"])
@pytest.mark.parametrize("height", ["3", "Range(3, 4)"])
def test_combinations_have_the_field_and_the_name_that_they_are_given(kind: str, height: str) -> None:
    """In the place of those of their members, which may be random."""
    text = (
        f"from scenic.core.regions import {kind}\n"
        "one, two = VectorField('one', lambda p: 1), VectorField('two', lambda p: 2)\n"
        f"box = BoxRegion((4, 4, {height}), orientation=one)\nball = SpheroidRegion((2, 2, 2), (1.5, 0, 0), orientation=one)\n"
        f"place = {kind}(box, ball, orientation=two, name='place')\n"
        "ego = new Object in place\nparam place = place\n"
    )
    for found in scenario(text).sample(3, seed=1):
        assert found.objects[0].heading == pytest.approx(2)
        assert found.params["place"].orientation[(1, 0, 0)].yaw == 2
        assert found.params["place"].name == "place"


@pytest.mark.parametrize("width", ["2", "Range(2, 3)"])
def test_a_field_takes_the_place_of_the_normals_of_a_surface(width: str) -> None:
    """Where points are drawn from it and where they land on it; without a field, nothing does."""
    text = (
        "import trimesh\nfield, cube = VectorField('f', lambda p: 0.1 * p.x + 0.2 * p.y), trimesh.creation.box()\n"
        f"made = [MeshSurfaceRegion(cube, ({width}, 2, 2), orientation=way) for way in (field, True, None)]\n"
        "param x = [(p.position, p.orientation) for r in made "
        "for p in ((new OrientedPoint in r), (new OrientedPoint at (0.3, 0.4, 5), on r))]\n"
    )
    for found in draws(text, n=6):
        for number, (place, orientation) in enumerate(found):
            if number % 2:
                assert tuple(place) == pytest.approx((0.3, 0.4, 1))
            if number < 2:
                assert_same_rotation(orientation, euler(0.1 * place.x + 0.2 * place.y))
            elif number < 4:
                normal = np.array(place) / np.maximum(np.abs(place).max(), 1)
                up = rotation(orientation).apply([0, 0, 1])
                assert np.abs(up).max() == pytest.approx(1)
                assert up @ normal > 0.6
            else:
                assert_same_rotation(orientation, euler(0))


def test_a_line_may_have_the_directions_of_another_one() -> None:
    """Those of the segment that is nearest, not its own."""
    text = (
        "other = PolylineRegion([(0, 1), (4, 1), (4, -9)])\n"
        "line = PolylineRegion([(0, 0), (0, 9), (9, 9), (9, 0), (0, 0)], orientation=other.orientation)\n"
        "path = PathRegion([(9, 0, 0), (0, 0, 0)], orientation=other.orientation)\n"
        "points = [new OrientedPoint in r for r in (line, path)]\n"
        "param x = [(p.x, p.y, p.heading) for p in points]\n"
    )
    for found in draws(text, n=20):
        for x, y, heading in found:
            if y == 0:
                expected = -math.pi / 2 if x < 3 else math.pi
                assert math.remainder(heading - expected, 2 * math.pi) == pytest.approx(0, abs=1e-9)


def test_directions_of_projections_are_kept() -> None:
    """Things go to a wall along its own direction, also to that of its surface or volume."""
    text = (
        "import trimesh\n"
        "box = trimesh.creation.box()\n"
        "wall = MeshSurfaceRegion(box, dimensions=(2, 8, 8), onDirection=(1, 0, 0))\n"
        "block = BoxRegion((2, 8, 8), onDirection=(1, 0, 0))\n"
        "one = new Point at (-5, 2, 1), on wall\n"
        "two = new Point at (-5, 2, 1), on block\n"
        "three = new Point at (-5, 2, 1), on block.getVolumeRegion()\n"
        "four = new Point at (0, 2, -9), on MeshSurfaceRegion(box, dimensions=(2, 8, 8))\n"
        "param x = [tuple(p.position) for p in (one, two, three, four)]\n"
    )
    (found,) = draws(text, n=1)
    np.testing.assert_allclose(found, [(-1, 2, 1)] * 3 + [(0, 2, -4)], atol=1e-9)


def test_bounds_of_points_on_a_fixed_side_are_those_of_its_corners() -> None:
    """The top of a table that is far from the origin, and of another extent along each axis."""
    program = scenario(
        "base = new Object at (10, 2.5, 5), with width 4, with length 2, with height 1\n"
        "thing = new Point on base.topSurface\nparam x = thing.position\n"
    )
    (node,) = (node for node in program.outline.graph.nodes if node.operation.name == "point of triangles")
    assert node.operation.bounds is not None
    unit = Bounds(np.zeros(3), np.ones(3))
    found = node.operation.bounds(node.payload, unit, unit, unit)
    np.testing.assert_allclose(found.lower, [(8, 1.5, 5.5)] * 3)
    np.testing.assert_allclose(found.upper, [(12, 3.5, 5.5)] * 3)
    assert (found.lower <= (8, 1.5, 5.5)).all()
    assert (found.upper >= (12, 3.5, 5.5)).all()


@pytest.mark.parametrize(
    "volume", ["BoxRegion((2, 4, 6))", "MeshVolumeRegion(trimesh.creation.box(), dimensions=(2, 4, 6))"]
)
def test_what_is_in_a_volume_or_on_its_border_stays_there(volume: str) -> None:
    """Whatever the direction is: along a face, an edge or a diagonal, outwards, or none."""
    places = [(0, 0, 0), (1, 0, 0), (1, 2, 0), (1, 2, 3), (-1, -2, -3), (0.5, 2, -1)]
    ways = [(0, 0, 1), (1, 0, 0), (0, 1, 0), (1, 2, 3), (1, 2, 0), (0, 0, 0)]
    text = f"import trimesh\nroom = {volume}\n" + "".join(
        f"class P{number}(Point):\n    onDirection: {way}\n" for number, way in enumerate(ways)
    )
    points = ", ".join(
        f"(new P{number} at {place}, on room)" for number in range(len(ways)) for place in places
    )
    text += f"points = [{points}]\nparam x = [tuple(p.position) for p in points]\n"
    assert draws(text, n=1) == [places * len(ways)]


@pytest.mark.parametrize("volume", ["BoxRegion((2, 2, 2))", "SpheroidRegion((2, 2, 2))"])
def test_fixed_places_land_along_each_direction_that_is_drawn(volume: str) -> None:
    text = (
        f"room = {volume}\nclass P(Point):\n    onDirection: Uniform((0, 0, 1), (1, 1, 9), (1, 0, 0))\n"
        "p = new P at (0, 0, 4), on room\nparam x = p\n"
    )
    found = {tuple(p.onDirection): tuple(p.position) for p in draws(text, n=40)}
    assert found.keys() == {(0, 0, 1), (1, 1, 9)}, "the third misses"
    if volume.startswith("Box"):
        expected: Any = (-1 / 3, -1 / 3, 1)
    else:
        # The first of (0, 0, 4) - s (1, 1, 9) on the unit sphere.
        s = (72 - math.sqrt(72**2 - 4 * 83 * 15)) / (2 * 83)
        expected = (-s, -s, 4 - 9 * s)
    assert found[0, 0, 1] == pytest.approx((0, 0, 1), abs=0.01)
    assert found[1, 1, 9] == pytest.approx(expected, abs=0.01)


def test_radii_of_balls_in_boxes_and_ellipsoids() -> None:
    (found,) = draws("param x = (BoxRegion((3, 2, 5)).inradius, SpheroidRegion((3, 7, 4)).inradius)\n", n=1)
    assert found == (1, 1.5)


def test_members_of_the_plane_count_at_their_height_alone() -> None:
    """In draws: discs above each other share no point, and neither thins the other in their union."""
    low, high = CircularRegion((0, 0, 0), 2), CircularRegion((1, 0, 3), 2)
    for members in ((low, high), (high, low)):
        _, found = drawn(IntersectionRegion(*members), n=30)
        assert not found.any()
        points, found = drawn(DifferenceRegion(*members), n=300)
        assert found.all()
        assert (points[:, 2] == members[0].center.z).all()
        middle = (members[0].center.x + members[1].center.x) / 2
        assert_share(np.hypot(points[:, 0] - middle, points[:, 1]) < 1.5, 1.5**2 / 2**2)
        points, found = drawn(UnionRegion(*members), n=600)
        assert found.all()
        assert_share(points[:, 2] == 3, 1 / 2)
        at_low = points[points[:, 2] == 0]
        assert_share(np.hypot(at_low[:, 0] - 1, at_low[:, 1]) < 1, 1 / 4)


@pytest.mark.parametrize("width", ["2", "Range(2, 2.001)"])
def test_every_face_of_every_side_is_drawn_from_and_landed_on(width: str) -> None:
    """Both triangles of each, whatever their numbers are, where the object is fixed and where it is not."""
    sides = {
        "left": (0, -1),
        "right": (0, 1),
        "back": (1, -1),
        "front": (1, 1),
        "bottom": (2, -1),
        "top": (2, 1),
    }
    corners = [(-0.3, -0.4), (-0.3, 0.4), (0.3, -0.4), (0.3, 0.4)]
    lines = []
    for axis, sign in sides.values():
        for first, second in corners:
            start = np.insert([first, second], axis, sign * 7.0)
            way = np.insert([0.0, 0.0], axis, 1.0)
            lines.append((tuple(start.tolist()), tuple(way.tolist())))
    text = (
        f"box = new Object at (0, 0, 0), with width {width}, with length 2, with height 2, with regionContainedIn everywhere\n"
        f"names, lines, surface = {list(sides)}, {lines}, box.surface\n"
        "sides = [getattr(box, name + 'Surface') for name in names]\n"
        "param drawn = [(new Point in side).position for side in sides], anywhere = (new Point in surface).position\n"
        "param landed = [(surface if n % 2 else sides[n // 4]).project(Vector(*start), way)[0] for n, (start, way) in enumerate(lines)]\n"
    )
    where, ways = [], {name: [] for name in sides}
    for item in scenario(text).sample(40, seed=3):
        for (name, (axis, sign)), place in zip(sides.items(), item.params["drawn"], strict=True):
            assert place[axis] == pytest.approx(sign, abs=1e-3)
            ways[name].append(np.delete(tuple(place), axis))
        where.append(tuple(np.round(tuple(item.params["anywhere"]), 3)))
        for (start, way), place in zip(lines, item.params["landed"], strict=True):
            expected = np.where(np.array(way) == 1, np.sign(start), start)
            np.testing.assert_allclose(tuple(place), expected, atol=1e-3)
    for places in map(np.array, ways.values()):
        # On both sides of either diagonal, of which one is the seam of the triangles.
        for across in (places[:, 0] - places[:, 1], places[:, 0] + places[:, 1]):
            assert (across < 0).any()
            assert (across > 0).any()
    assert (
        len({(axis, place[axis]) for place in where for axis in range(3) if abs(abs(place[axis]) - 1) < 2e-3})
        >= 5
    )


@pytest.mark.parametrize("target", ["box", "box.occupiedSpace", "box.topSurface", "BoxRegion((9, 9, 2))"])
def test_a_direction_alone_may_be_random_where_things_land(target: str) -> None:
    """The thing that falls, and what it falls on, are the same in all scenes."""
    text = (
        "box = new Object at (0, 0, 0), with width 9, with length 9, with height 2, with allowCollisions True\n"
        "slope = Range(-0.5, 0.5)\n"
        f"o = new Object at (0, 0, 5), on {target}, with onDirection (slope, 0, 1), with allowCollisions True\n"
        "param x = (slope, o.position.x, o.position.z)\n"
    )
    found = draws(text, n=12)
    assert len({slope for slope, _, _ in found}) == 12
    for slope, x, z in found:
        assert x == pytest.approx(-4 * slope)
        assert z == pytest.approx(1.5 + 0.5e-4)


def test_a_choice_among_lines_asks_one_that_looks_as_another_of_that() -> None:
    text = (
        "other = PolylineRegion([(0, 0), (9, 0)])\n"
        "one = PolylineRegion([(0, 5), (0, 9)], orientation=other.orientation)\n"
        "two = PolylineRegion([(20, 5), (20, 9)])\n"
        "p = new OrientedPoint in Uniform(one, two)\nparam x = (p.position.x, p.heading)\n"
    )
    found = draws(text, n=12)
    assert {x for x, _ in found} == {0, 20}
    for x, heading in found:
        assert heading == pytest.approx(-math.pi / 2 if x == 0 else 0)


def test_what_is_in_view_meets_others_as_the_mesh_of_the_view_does() -> None:
    """Combinations of which a view is the first member, or the second, or the other one."""
    view = named.ViewRegion(5, (math.pi / 2, math.pi / 2))
    box = BoxRegion((8, 4, 8), (0, 4, 0))
    close, near, aside, behind, far = (
        BoxRegion((0.5, 0.5, 0.5), place)
        for place in ((0, 1, 0), (0, 3, 0), (-3.5, 2.5, 0), (0, -1, 0), (0, 5.7, 0))
    )
    for part, wanted in (
        (IntersectionRegion(view, box), (False, True, False, False, False)),
        (IntersectionRegion(box, view), (False, True, False, False, False)),
        (DifferenceRegion(box, view), (False, False, True, False, True)),
        (DifferenceRegion(view, box), (True, False, False, False, False)),
    ):
        for other, met in zip((close, near, aside, behind, far), wanted, strict=True):
            assert part.intersects(other) is met
            assert other.intersects(part) is met
    # A hollow box in view, and one that is not.
    for place, met in ((4, True), (-4, False)):
        shell = DifferenceRegion(BoxRegion((2, 2, 2), (0, place, 0)), BoxRegion((1, 1, 1), (0, place, 0)))
        assert shell.intersects(view) is view.intersects(shell) is met
