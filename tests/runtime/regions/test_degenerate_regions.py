"""Regions where a rule has a special case: holes in the middle, full turns, several members, mirrored grids, level paths."""

import math
import random
from typing import Any

import numpy as np
import pytest
import scenic.core.regions as named
import shapely
import trimesh
from scipy import stats

from scenic.graph.bounds import Bounds
from scenic.language.errors import (
    InvalidScenarioError,
    RejectionException,
    ScenicTypeError,
    ScenicValueError,
)
from scenic.runtime.geometry.meshes import primitives
from scenic.runtime.geometry.meshes.bodies import Body
from scenic.runtime.geometry.poses import Poses
from scenic.runtime.regions.choice import RegionChoice
from scenic.runtime.regions.combinations import DifferenceRegion, IntersectionRegion, UnionRegion
from scenic.runtime.regions.composite import exactly_contains
from scenic.runtime.regions.fields import (
    PiecewiseVectorField,
    PolygonalVectorField,
    PolyhedronVectorField,
    VectorField,
)
from scenic.runtime.regions.spaces import Workspace, nowhere
from scenic.runtime.values.values import Orientation, Vector
from tests.runtime.programs import FALSE_ALARM, draws, failure, params, scenario

TILT = Orientation.fromEuler(0.7, 0.4, -0.3)
SQUARE_RING = shapely.box(-3, -2, 3, 2).difference(shapely.box(-1, -1, 1, 1))


@pytest.mark.parametrize(
    ("polygon", "radius"),
    [
        (SQUARE_RING, 0.0),
        (shapely.box(-3, -2, 3, 2), 2.0),
        (shapely.box(-3, -2, 3, 2).difference(shapely.box(0.5, -1, 1, 1)), 0.5),
        (shapely.MultiPolygon([shapely.box(0, 0, 1, 1), shapely.box(3, 3, 4, 4)]), 0.0),
        (shapely.Polygon([(0, 0), (6, 0), (6, 1), (1, 1), (1, 6), (0, 6)]), 0.0),
    ],
)
def test_the_middle_of_a_polygon_may_lie_in_a_hole_or_notch(polygon: shapely.Geometry, radius: float) -> None:
    assert named.PolygonalRegion(polygon=polygon).inradius == pytest.approx(radius)


@pytest.mark.parametrize("angle", [0.5, 4.0, 2 * math.pi, 7.0, 11.0])
def test_sectors_are_drawn_evenly_over_their_angle(angle: float) -> None:
    """An angle beyond a full turn is a full turn: nowhere is drawn from twice."""
    heading, count = 0.8, 40_000
    region = named.SectorRegion(Vector(1, 2, 3), 2, heading, angle)
    columns = region.fixed_columns("a test")
    points, _ = region.draw_points(
        np.random.default_rng(1).random((2, count)), np.zeros(count, np.uint64), *columns
    )
    x, y, z = (points - np.array([1, 2, 3])).T
    assert (z == 0).all()
    turned = np.angle(np.exp(1j * (np.arctan2(-x, y) - heading)))
    wide = min(angle, 2 * math.pi)
    assert (np.abs(turned) <= wide / 2 + 1e-9).all()
    shares = np.histogram(turned, 16, (-wide / 2, wide / 2))[0]
    assert (np.abs(shares - count / 16) < 6 * math.sqrt(count / 16)).all()
    assert np.hypot(x, y).max() <= 2
    assert (np.hypot(x, y) < 1).mean() == pytest.approx(0.25, abs=0.015)
    assert region.size == pytest.approx(wide / 2 * 4)


def grid(spacing: tuple[float, float]) -> named.GridRegion:
    cells = np.zeros((4, 5))
    cells[1, 2] = cells[3, 0] = 1
    return named.GridRegion("grid", cells, *spacing, 0.5, -1)


@pytest.mark.parametrize("spacing", [(2.0, 1.0), (-2.0, 1.0), (2.0, -1.0), (-0.5, -3.0)])
def test_grids_may_run_either_way(spacing: tuple[float, float]) -> None:
    region = grid(spacing)
    lower, upper = region.container_box()
    points = np.random.default_rng(2).uniform(-15, 15, (4000, 3))
    inside = region.contains_points(points)
    # Each cell reaches half a spacing about its point.
    centres, half = np.array(region.points), np.abs(spacing) / 2
    near = (np.abs(points[:, np.newaxis, :2] - centres[:, :2]) <= half).all(axis=2).any(axis=1)
    np.testing.assert_array_equal(inside, near)
    assert (points[inside] >= lower).all()
    assert (points[inside] <= upper).all()
    np.testing.assert_allclose((upper - lower)[0, :2], np.ptp(centres[:, :2], axis=0) + 2 * half)
    for cell in ((0, 0), (4, 3), (2, 1)):
        place = region.gridToPoint(cell)
        assert region.pointToGrid((place[0] + 0.4 * spacing[0], place[1] - 0.4 * spacing[1])) == cell
        assert region.containsPoint(Vector(*place, 0)) is (cell != (2, 1))
    assert region.pointToGrid(region.gridToPoint((5, 0))) is None
    assert region.pointToGrid(region.gridToPoint((0, -1))) is None


@pytest.mark.parametrize("spacing", [(2.0, 1.0), (-2.0, 1.0)])
def test_no_body_stands_over_an_obstacle_of_a_grid(spacing: tuple[float, float]) -> None:
    """Not even one whose corners are all in free cells."""
    region = grid(spacing)
    middle = np.array([*region.gridToPoint((2, 1)), 0])
    sizes = np.array([(2 * 2.2, 2.2, 1), (2 * 2.2, 0.5, 1), (1.2, 0.4, 1), (1.2, 0.4, 1), (9, 4, 1)])
    offsets = np.array([(0, 0, 0), (0, 1, 0), (2, 0, 0), (0, 0, 7), (0, 0, 0)])
    body = Body((primitives.box(),), None, Poses(middle + offsets, np.array([[0.0, 0, 0, 1]]), sizes))
    assert region.contains_bodies(body, 5).tolist() == [False, True, True, False, False]


def test_members_of_members_are_all_there_when_drawn() -> None:
    """Of three and four regions with random parameters, in any order of combination."""
    text = """
a, b = CircularRegion((0, 0), Range(1, 2)), CircularRegion((10, 0), Range(1, 2))
c, d = RectangularRegion((20, 0), 0, Range(1, 2), 3), RectangularRegion((30, 0), 0, 2, Range(2, 3))
wide = CircularRegion((0, 0), Range(4, 5))
half, upper = RectangularRegion((5, 0), 0, 10, Range(20, 21)), RectangularRegion((0, 5), 0, Range(20, 21), 10)
places = ((0, 0), (10, 0), (20, 0), (30, 0), (40, 0))
unions = (a.union(b).union(c).union(d), a.union(b.union(c).union(d)), d.union(c).union(b.union(a)))
cuts = (wide.intersect(half).intersect(upper), upper.intersect(wide.intersect(half)), half.intersect(upper).intersect(wide))
param x = tuple(tuple(u.containsPoint(p) for p in places) for u in unions), u = unions
param y = tuple(tuple(r.containsPoint(p) for p in ((1, 1), (-1, 1), (1, -1), (3.9, 3.9))) for r in cuts), r = cuts
"""
    for seed in range(3):
        found = params(text, seed=seed) if seed == 0 else params(text)
        assert found["x"] == ((True, True, True, True, False),) * 3
        assert found["y"] == ((True, False, False, False),) * 3
        for region in found["u"]:
            held = [region.containsPoint(Vector(x, 0, 0)) for x in (0, 10, 20, 30, 40)]
            assert held == [True, True, True, True, False]
        for region in found["r"]:
            held = [region.containsPoint(Vector(x, y, 0)) for x, y in ((1, 1), (-1, 1), (1, -1), (3.9, 3.9))]
            assert held == [True, False, False, False]


def test_combinations_of_three_kinds_lie_in_their_boxes() -> None:
    ball = named.SpheroidRegion(dimensions=(3, 9, 5), position=(1, 12, 3), rotation=TILT)
    box = named.BoxRegion(dimensions=(4, 8, 2), position=(1, 8, 3), rotation=TILT)
    cells = named.CircularRegion(Vector(2, 9, 0), 2.5).footprint
    rng = np.random.default_rng(3)
    points = rng.uniform((-4, 3, -2), (6, 18, 8), (20_000, 3))
    held = [region.contains_points(points, *region.fixed_columns("a test")) for region in (ball, box, cells)]
    for region, expected in (
        (IntersectionRegion(ball, box, cells), held[0] & held[1] & held[2]),
        (IntersectionRegion(cells, ball, box), held[0] & held[1] & held[2]),
        (UnionRegion(ball, box, cells), held[0] | held[1] | held[2]),
    ):
        columns = region.fixed_columns("a test")
        np.testing.assert_array_equal(region.contains_points(points, *columns), expected)
        lower, upper = region.box(*columns)
        assert (points[expected] >= lower).all()
        assert (points[expected] <= upper).all()
        gaps = region.gaps(points, *columns)
        assert (gaps[expected] <= 1e-9).all()


def test_paths_over_and_under_a_footprint_are_cut_at_its_border() -> None:
    disc = named.CircularRegion(Vector(1, 0, 7), 2)
    for chain, length in (
        ([(-5, 0, 5), (6, 0, 5)], 4.0),
        ([(1, -9, 0), (1, 9, 0)], 4.0),
        ([(-5, 0, 0), (7, 0, 24)], 4 * math.sqrt(5)),
        ([(1, 0, -3), (1, 0, 8)], 11.0),
        ([(1, 1, -3), (1, 1, 8), (9, 1, 8)], 11 + math.sqrt(3)),
    ):
        path = named.PathRegion(chain)
        for part in (path.intersect(disc.footprint), disc.footprint.intersect(path)):
            assert part.length == pytest.approx(length, rel=1e-3)
            heights = [point[2] for line in part.chains for point in line]
            assert min(heights) >= min(point[2] for point in chain) - 1e-9
            assert max(heights) <= max(point[2] for point in chain) + 1e-9
    beside = named.PathRegion([(-5, 3, 5), (6, 3, 5)]).intersect(disc.footprint)
    assert isinstance(beside, named.EmptyRegion)


def test_footprints_with_holes_and_parts_cut_solids() -> None:
    box = named.BoxRegion(dimensions=(4, 3, 2))
    two = shapely.MultiPolygon([shapely.box(-3, -3, -1, 3), shapely.box(1, -3, 3, 3)])
    for polygon, area in (
        (SQUARE_RING, 12 - 4),
        (two, 6.0),
        (SQUARE_RING.union(shapely.box(-0.5, -0.5, 0.5, 0.5)), 9.0),
    ):
        column = named.PolygonalFootprintRegion(polygon)
        assert box.intersect(column).size == pytest.approx(2 * area)
        assert column.intersect(box).size == pytest.approx(2 * area)
        assert box.difference(column).size == pytest.approx(2 * (12 - area))
        bounded = column.boundFootprint(5, 3)
        assert bounded.size == pytest.approx(3 * polygon.area)
        np.testing.assert_allclose(np.array(bounded.AABB)[:, 2], [3.5, 6.5])


def test_whether_volumes_are_convex() -> None:
    frame = named.BoxRegion(dimensions=(4, 4, 4)).difference(named.BoxRegion(dimensions=(2, 2, 9)))
    assert named.BoxRegion().isConvex is True
    assert named.SpheroidRegion().isConvex is True
    assert frame.isConvex is False
    assert frame.getSurfaceRegion().isConvex is False
    assert named.BoxRegion().getSurfaceRegion().isConvex is True
    assert named.CircularRegion(Vector(0, 0, 0), 1).footprint.isConvex is True
    assert named.PolygonalFootprintRegion(SQUARE_RING).isConvex is False


def test_fields_have_their_default_where_no_cell_is() -> None:
    cell, field = shapely.box(0, 0, 1, 1), VectorField("own", lambda _point: 0.25)
    flat = named.PolygonalRegion(polygon=cell, orientation=field)
    solid = named.BoxRegion(position=(0.5, 0.5, 0))
    for make in (
        lambda default: PolygonalVectorField("f", [(cell, 0.25)], defaultHeading=default),
        lambda default: PolygonalVectorField(
            "f", [(cell, None)], lambda _point: 0.25, defaultHeading=default
        ),
        lambda default: PiecewiseVectorField("f", [flat], defaultHeading=default),
        lambda default: PolyhedronVectorField("f", [(solid, 0.25)], defaultHeading=default),
        lambda default: PolyhedronVectorField("f", [(solid, None)], lambda _point: 0.25, default),
    ):
        for default in (0.5, 0.0):
            known = make(default)
            assert known[Vector(0.5, 0.5, 0)].yaw == pytest.approx(0.25)
            assert known[Vector(3, 0.5, 0)].yaw == pytest.approx(default)
        unknown = make(None)
        assert unknown[Vector(0.5, 0.5, 0)].yaw == pytest.approx(0.25)
        with pytest.raises(RejectionException):
            unknown[Vector(3, 0.5, 0)]


def test_cells_of_heading_0_have_a_heading() -> None:
    """The function is for those that have none."""
    cell, solid = shapely.box(0, 0, 1, 1), named.BoxRegion(position=(0.5, 0.5, 0))
    for field in (
        PolygonalVectorField("f", [(cell, 0.0), (cell, None)], lambda _point: 0.25),
        PolyhedronVectorField("f", [(solid, 0.0), (solid, None)], lambda _point: 0.25),
    ):
        assert field[Vector(0.5, 0.5, 0)].yaw == 0


@pytest.mark.parametrize(
    ("distance", "size", "steps", "count"),
    [(12, 5, None, 4), (21, 5, None, 5), (20, 5, None, 4), (30, 1, None, 30), (30, 1, 2, 2), (3, 5, 7, 7)],
)
def test_ways_along_fields_are_cut_into_as_many_steps(
    distance: float, size: float, steps: int | None, count: int
) -> None:
    """At least four, none longer than the size; or the number that was asked for."""
    asked: list[Vector] = []

    def value(point: Vector) -> float:
        asked.append(point)
        return 0.1 * point.y

    VectorField("f", value).followFrom(Vector(0, 0, 0), distance, steps, size)
    assert len(asked) == count
    place = np.zeros(2)
    for point in asked:
        assert (point.x, point.y) == pytest.approx(place)
        heading = 0.1 * place[1]
        place = place + distance / count * np.array([-math.sin(heading), math.cos(heading)])


def test_ways_along_polygons_of_random_length_end_where_fixed_ones_do() -> None:
    text = """
from shapely.geometry import box
F = PolygonalVectorField('f', [(box(-50, 0, 50, 7), 0.5), (box(-50, 7, 50, 90), -0.75)], minSteps=3, defaultStepSize=2)
way = Uniform(Range(0.5, 20), 8, 10)
param x = (way, F.followFrom((1, 1), way), F.followFrom((1, 1), way, steps=4), F.followFrom((1, 1), way, stepSize=0.5))
"""
    field = PolygonalVectorField(
        "f",
        [(shapely.box(-50, 0, 50, 7), 0.5), (shapely.box(-50, 7, 50, 90), -0.75)],
        minSteps=3,
        defaultStepSize=2,
    )
    start = Vector(1, 1, 0)
    for way, by_default, by_number, by_size in draws(text, n=12):
        for found, expected in (
            (by_default, field.followFrom(start, way)),
            (by_number, field.followFrom(start, way, 4)),
            (by_size, field.followFrom(start, way, stepSize=0.5)),
        ):
            assert tuple(found) == pytest.approx(tuple(expected), abs=1e-9)


@pytest.mark.parametrize(
    "made",
    ["a.union(b)", "a.intersect(b)", "b.union(c).intersect(a)", "c.intersect(a.union(b))", "a.difference(b)"],
)
def test_fixed_and_random_members_are_asked_about_a_fixed_point(made: str) -> None:
    """Of some members there is a column, of others a single row."""
    text = (
        "a, b = CircularRegion((0, 0), Range(1, 2)), CircularRegion((0, 1), 1)\n"
        "c = BoxRegion(dimensions=(3, 3, Range(3, 4)))\n"
        f"r = {made}\n"
        "p = new Point in r\n"
        "param a = a.radius, held = [r.containsPoint(q) for q in ((0, 0), (0, 1.5), (1.2, 0.5), (5, 5))], p = p.position, r = r\n"
        "param above = r.footprint.containsPoint((0, 1.2, 0.5))\n"
    )
    for item in scenario(text).sample(9, seed=1):
        found = item.params
        places = np.array([(0, 0), (0, 1.5), (1.2, 0.5), (5, 5), (0, 1.2)])
        a = np.hypot(*places.T) <= found["a"]
        b = np.hypot(*(places - [0, 1]).T) <= 1
        c = (np.abs(places) <= 1.5).all(axis=1)
        expected = {
            "a.union(b)": a | b,
            "a.intersect(b)": a & b,
            "b.union(c).intersect(a)": (b | c) & a,
            "c.intersect(a.union(b))": c & (a | b),
            "a.difference(b)": a & ~b,
        }[made].tolist()
        assert [*found["held"], found["above"]] == expected
        assert found["r"].containsPoint(found["p"])


def test_distances_and_boxes_of_fixed_and_random_members() -> None:
    text = (
        "a, b = CircularRegion((0, 0), Range(1, 2)), BoxRegion(dimensions=(2, 2, 2), position=(4, 0, 0))\n"
        "param a = a.radius, x = a.union(b).distanceTo((2.5, 0)), y = b.union(a).distanceTo((-5, 0))\n"
    )
    for item in scenario(text).sample(9, seed=1):
        radius = item.params["a"]
        assert item.params["x"] == pytest.approx(min(2.5 - radius, 0.5))
        assert item.params["y"] == pytest.approx(5 - radius)
    disc, box = (
        named.CircularRegion(Vector(0, 0, 0), 2),
        named.BoxRegion(position=(1, 1, 0), dimensions=(4, 2, 3)),
    )
    centre, radius = disc.fixed_columns("a test")
    columns = [centre, radius * np.array([0.5, 1.0, 1.5]), *box.fixed_columns("a test")]
    for region, lower, upper in (
        (
            UnionRegion(disc, box),
            [(-1, -1, -1.5), (-2, -2, -1.5), (-3, -3, -1.5)],
            [(3, 2, 1.5), (3, 2, 1.5), (3, 3, 1.5)],
        ),
        (
            IntersectionRegion(disc, box),
            [(-1, 0, 0), (-1, 0, 0), (-1, 0, 0)],
            [(1, 1, 0), (2, 2, 0), (3, 2, 0)],
        ),
    ):
        found = region.box(*columns)
        np.testing.assert_allclose(found[0], lower)
        np.testing.assert_allclose(found[1], upper)


def test_a_surface_in_a_tilted_plane_has_a_box() -> None:
    corners = np.array([(0, 0, 0), (2, 0, 1), (0, 3, 0), (2, 3, 1)], dtype=float)
    sheet = named.MeshSurfaceRegion(trimesh.Trimesh(corners, [(0, 1, 2), (1, 3, 2)]), centerMesh=False)
    np.testing.assert_allclose(sheet.AABB, [corners.min(axis=0), corners.max(axis=0)], atol=1e-12)


@pytest.mark.parametrize("height", [-0.5, 2])
def test_a_line_of_the_plane_warns_of_heights_that_it_drops(height: float) -> None:
    with pytest.warns(UserWarning, match="the z of its points is dropped"):
        line = named.PolylineRegion([(0, 0), (1, 0, height)])
    assert line.points == ((0, 0, 0), (1, 0, 0))


@pytest.mark.parametrize("heading", [-3, -0.5, 0, 0.5, 2.5])
def test_a_sector_holds_its_tip(heading: float) -> None:
    """And what is a hair within, or beside, its straight edges and its arc."""
    sector = named.SectorRegion(Vector(1, 2, 3), 2, heading, 0.3)
    assert sector.containsPoint(Vector(1, 2, 3)) is True
    assert sector.containsPoint(Vector(1, 2, -9)) is True
    for reach, turned, inside in (
        (2 - 1e-9, 0.0, True), (2 + 1e-9, 0.0, False), (1, 0.15 - 1e-9, True), (1, 0.15 + 1e-9, False),
        (1, 1e-9 - 0.15, True), (1, -1e-9 - 0.15, False), (1, math.pi, False),
    ):  # fmt: skip
        way = heading + turned
        place = Vector(1 - reach * math.sin(way), 2 + reach * math.cos(way), 3)
        assert sector.containsPoint(place) is inside
        assert (sector.distanceTo(place) == 0) is inside


def test_the_box_of_an_empty_intersection_is_a_point() -> None:
    """Nothing is in it, and nothing breaks."""
    near, far = named.BoxRegion((2, 2, 2)), named.BoxRegion((2, 2, 2), (9, 9, 9))
    for both in (IntersectionRegion(near, far), IntersectionRegion(far, near)):
        columns = both.fixed_columns("a test")
        lower, upper = both.box(*columns)
        assert (lower <= upper).all()
        found = both.extent(*(Bounds(column, column) for column in columns))
        assert found is not None
        assert (found.lower <= found.upper).all()
        assert both.containsPoint(Vector(0, 0, 0)) is False
        assert both.size is None


def test_unions_with_what_is_of_lower_dimension_are_drawn_from() -> None:
    """Whatever is not known of the size of that."""
    text = (
        "ball = SpheroidRegion((2, 2, Range(1, 2)))\n"
        "lens = CircularRegion((5, 0), Range(1, 2)).intersect(CircularRegion((6, 0), 1))\n"
        "param x = ((new Point in ball.union(lens)).position, (new Point in lens.union(ball)).position)\n"
    )
    assert all(place.norm() <= 1 for places in draws(text, n=8) for place in places)
    assert isinstance(failure(text.replace("ball.union(lens)", "lens.union(lens)")), ScenicTypeError)


def test_boxes_of_sectors_are_those_of_their_points() -> None:
    """Of any heading and angle, with the tip, both ends of the arc, and where that goes straight along an axis."""
    random = np.random.default_rng(6)
    count = 60
    heading, angle = random.uniform(-9, 9, count), random.uniform(0, 8, count)
    heading[:8], angle[:8] = np.arange(-4, 4) * math.pi / 4, np.repeat([math.pi / 2, math.pi], 4)
    centre, radius = random.normal(size=(count, 3)), random.uniform(0.5, 3, count)
    region = named.SectorRegion((0, 0, 0), 1, 0, 1)
    lower, upper = region.box(centre, radius, heading, angle)
    share = np.linspace(-0.5, 0.5, 2001)[:, np.newaxis]
    ways = heading + share * np.minimum(angle, 2 * math.pi)
    x, y = (np.vstack([np.zeros(count), part]) for part in (-radius * np.sin(ways), radius * np.cos(ways)))
    np.testing.assert_allclose(
        lower - centre, np.stack([x.min(axis=0), y.min(axis=0), 0 * radius], axis=1), atol=1e-4
    )
    np.testing.assert_allclose(
        upper - centre, np.stack([x.max(axis=0), y.max(axis=0), 0 * radius], axis=1), atol=1e-4
    )


@pytest.mark.parametrize("turn", [Orientation(), TILT])
def test_lines_along_faces_and_edges_of_a_box_are_in_it(turn: Orientation) -> None:
    """Its faces belong to it; a line a millimetre beside one is not cut."""
    box, place = named.BoxRegion((2, 4, 3), (1, 2, 3), turn), Vector(1, 2, 3)

    def path(*points: tuple[float, float, float]) -> named.PathRegion:
        return named.PathRegion([Vector(*point).rotatedBy(turn) + place for point in points])

    for line, length in (
        (path((-5, 0.3, 1.4999999), (5, 0.3, 1.4999999)), 2),
        (path((-5, 0.3, 1.501), (5, 0.3, 1.501)), 0),
        (path((0.2, -9, 1), (0.2, 9, 1), (0.4, 9, 1), (0.4, 0, 1)), 6),
        (path((0.2, 0, 1), (0.2, 1, 1)), 1),
        (path((0.2, 0, 1), (0.2, 1, 1), (0.2, 1, 9)), 1.5),
    ):
        inside = line.intersect(box)
        assert (0 if inside is named.nowhere else inside.length) == pytest.approx(length, abs=1e-6)
        assert line.intersects(box) is (length > 0)


def test_combinations_of_three_regions_are_drawn_from_uniformly() -> None:
    """Each of three members cuts something off, or adds a third."""
    squares = [named.RectangularRegion((x, 0), 0, 2, 2) for x in (0, 1.5, 3)]
    ends = [named.RectangularRegion((0, y), 0, 4, 4) for y in (0, 1, 1.5)]
    random = np.random.default_rng(7)
    for region, wanted in (
        (UnionRegion(*squares), shapely.box(-1, -1, 4, 1)),
        (IntersectionRegion(*ends), shapely.box(-2, -0.5, 2, 2)),
        (IntersectionRegion(*ends[::-1]), shapely.box(-2, -0.5, 2, 2)),
    ):
        points, found = region.draw_points(
            random.random((region.draws, 3000)),
            random.integers(0, 1 << 62, 3000).astype(np.uint64),
            *region.fixed_columns("a test"),
        )
        assert found is not None
        assert found.all()
        left, bottom, right, top = wanted.bounds
        x, y = (points[:, 0] - left) / (right - left), (points[:, 1] - bottom) / (top - bottom)
        for part in (x, y):
            assert stats.kstest(part, "uniform").pvalue > FALSE_ALARM


@pytest.mark.parametrize("kind", [named.PolylineRegion, named.PathRegion])
def test_points_drawn_now_from_a_line_have_its_direction(kind: type) -> None:
    field = VectorField("f", lambda place: place.x)
    for orientation, expected in ((True, lambda _x: math.pi / 2), (field, lambda x: x), (None, None)):
        line = kind([(1, 0, 0), (-2, 0, 0)], orientation=orientation)
        assert line.has_orientation is (orientation is not None)
        for _ in range(3):
            point = line.uniformPointInner()
            assert -2 <= point.x <= 1
            if expected is None:
                assert not hasattr(point, "heading")
            else:
                assert point.heading == pytest.approx(expected(point.x))


def test_points_of_parts_that_are_hard_to_hit_are_tried_anew() -> None:
    """Of a region that knows no law of its own points, drawn at once."""
    big, small = (
        named.SpheroidRegion(dimensions=(4, 4, 4)),
        named.BoxRegion(position=(1.7, 1.7, 1.7), dimensions=(1.4, 1.4, 1.4)),
    )
    region = IntersectionRegion(big, small)
    random.seed(3)
    for _ in range(25):
        point = region.uniformPointInner()
        assert big.containsPoint(point)
        assert small.containsPoint(point)


def test_a_fixed_point_is_or_is_not_on_each_of_many_sides() -> None:
    text = (
        "box = new Object at (Uniform(0, 1, 2), 0, 0), with width 2\nego = new Object at (50, 50, 50)\n"
        "require (3, 0, 0) in box.rightSurface\nparam x = box.position.x\n"
    )
    assert {item.params["x"] for item in scenario(text).sample(12, seed=1)} == {2}


@pytest.mark.parametrize("nested", [False, True])
def test_workspaces_are_combined_as_what_they_are_made_of(nested: bool) -> None:
    """To what has a closed form, however often they are wrapped; and in combinations that are named as such."""
    disc, box = named.CircularRegion((1, 0, 2), 2), named.BoxRegion((2, 2, 6), (2, 0, 2))
    room = Workspace(Workspace(disc)) if nested else Workspace(disc)
    for operation in ("intersect", "union", "difference"):
        for one, other, same in ((room, box, (disc, box)), (box, room, (box, disc))):
            found, expected = getattr(one, operation)(other), getattr(same[0], operation)(same[1])
            assert type(found) is type(expected)
            assert found.size == expected.size
    assert room.intersects(box) is box.intersects(room) is True
    assert room.containsRegion(named.CircularRegion((1, 0, 2), 1)) is True
    # One of the plane is at its height alone, wrapped or not.
    for z, held in ((2, True), (2.5, False)):
        for whole in (IntersectionRegion(room, box), IntersectionRegion(box, room)):
            columns = whole.fixed_columns("a test")
            assert exactly_contains(whole, np.array([[1.5, 0, z]]), columns).tolist() == [held]


@pytest.mark.parametrize("kind", [named.CircularRegion, named.RectangularRegion, named.PolygonalRegion])
def test_the_height_of_a_plane_is_kept_up_to_rounding_on_both_sides(kind: type) -> None:
    arguments = {
        named.CircularRegion: ((1, 0, 2), 2),
        named.RectangularRegion: ((1, 0, 2), 0.1, 4, 4),
        named.PolygonalRegion: ([(-1, -2), (3, -2), (3, 2), (-1, 2)], None, 2),
    }
    region = kind(*arguments[kind])
    for off, held in ((9e-7, True), (-9e-7, True), (1.1e-6, False), (-1.1e-6, False), (-3, False)):
        place = np.array([[1.0, 0, 2 + off]])
        assert exactly_contains(region, place, region.fixed_columns("a test")).tolist() == [held]


def test_joined_polygons_lie_at_the_height_of_the_first() -> None:
    low, high = (named.CircularRegion((x, 0, z), 2) for x, z in ((0, 1.5), (9, 4)))
    for parts, height in (((low, high), 1.5), ((high, low), 4)):
        joined = named.PolygonalRegion.unionAll(iter(parts))
        assert joined.z == height
        assert {point[2] for point in joined.points} == {height}


@pytest.mark.parametrize("height", [-2, 0, 2])
def test_what_polygons_share_lies_at_their_height(height: float) -> None:
    """An area, several, an edge, several edges, a corner; also below the ground."""
    square = named.PolygonalRegion(polygon=shapely.box(0, 0, 4, 4), z=height)
    others = {
        "areas": [shapely.box(1, 1, 2, 9), shapely.box(3, 1, 4, 9)],
        "edges": [shapely.box(4, 0, 5, 1), shapely.box(4, 2, 5, 3)],
        "corners": [shapely.box(4, 4, 5, 5), shapely.box(-1, 4, 0, 5)],
    }
    for parts in others.values():
        for shape in (parts[0], shapely.MultiPolygon(parts)):
            common = square.intersect(named.PolygonalRegion(polygon=shape, z=height))
            lower, upper = common.AABB
            assert lower[2] == upper[2] == height
            assert common.containsPoint(common.uniformPointInner())
    assert square.intersect(named.PolygonalRegion(polygon=shapely.box(0, 0, 4, 4), z=-height or 1)) is nowhere


def test_every_chain_of_a_path_is_cut_by_a_column() -> None:
    """However high or low it runs, and whichever comes first."""
    column = named.RectangularRegion((0, 0, 5), 0, 2, 2).footprint
    chains = [[(-9, 0.5, z), (9, 0.5, z + 1)] for z in (0.0, -70, 40)]
    for order in ((0, 1, 2), (1, 2, 0), (2, 1, 0)):
        path = named.PathRegion(polylines=[chains[number] for number in order])
        for part in (path.intersect(column), column.intersect(path)):
            assert part.length == pytest.approx(3 * 2 * math.hypot(1, 1 / 18))


@pytest.mark.parametrize(
    "make",
    [
        lambda size: named.CircularRegion((0, 0), size),
        lambda size: named.SectorRegion((0, 0), size, 0, 1),
        lambda size: named.SectorRegion((0, 0), 1, 0, size),
        lambda size: named.RectangularRegion((0, 0), 0, size, 1),
        lambda size: named.RectangularRegion((0, 0), 0, 1, size),
        *(
            lambda size, kind=kind, axis=axis: kind(tuple(np.where(np.arange(3) == axis, size, 1.0)))
            for kind in (named.BoxRegion, named.SpheroidRegion)
            for axis in range(3)
        ),
        *(
            lambda size, axis=axis: named.MeshVolumeRegion(
                trimesh.creation.box(), tuple(np.where(np.arange(3) == axis, size, 1.0))
            )
            for axis in range(3)
        ),
        *(
            lambda size, axis=axis: named.MeshSurfaceRegion(
                trimesh.creation.box(), tuple(np.where(np.arange(3) == axis, size, 1.0))
            )
            for axis in range(3)
        ),
        lambda size: named.ViewRegion(4, (size, 1)),
        lambda size: named.ViewRegion(4, (1, size)),
        lambda size: named.BoxRegion().voxelized(size),
    ],
)
def test_no_size_is_negative_or_no_number(make: Any) -> None:
    for size in (-1.0, math.nan):
        with pytest.raises(ScenicValueError):
            make(size)
    make(1.0)


def test_a_choice_among_a_plane_and_a_volume_stands_on_every_height_of_the_plane() -> None:
    disc, box = named.CircularRegion((0, 0, 1), 2), named.BoxRegion((2, 2, 2), (9, 0, 0))
    for options in ((disc, box), (box, disc), (box, box, disc)):
        column = RegionChoice(0, options).footprint
        index = np.array([options.index(disc), options.index(box)])
        columns = [value for option in options for value in option.fixed_columns("a test")]
        places = np.array([(0.5, 0, 70), (9, 0, 70)])
        for height, held in ((70, [True, False]), (0.5, [True, True])):
            places[:, 2] = height
            assert exactly_contains(column, places, [index, *columns]).tolist() == held
    volumes = RegionChoice(0, [box, named.SpheroidRegion()])
    assert volumes.footprint is volumes


def test_what_one_of_several_may_be_anywhere_has_no_extent() -> None:
    disc, box = named.CircularRegion((0, 0, 1), 2), named.BoxRegion((2, 2, 2), (9, 0, 0))
    known = [[Bounds(column, column) for column in region.fixed_columns("a test")] for region in (disc, box)]
    unknown = [[None] * len(each) for each in known]
    for first, second, told in (
        (known[0], known[1], True),
        (known[0], unknown[1], False),
        (unknown[0], known[1], False),
        (unknown[0], unknown[1], False),
    ):
        both = [*first, *second]
        for name in ("extent", "container_extent"):
            choice = getattr(RegionChoice(0, [disc, box]), name)(Bounds(np.zeros(1), np.ones(1)), *both)
            union = getattr(UnionRegion(disc, box), name)(*both)
            common = getattr(IntersectionRegion(disc, box), name)(*both)
            assert (choice is not None) is (union is not None) is told
            # Of an intersection any member tells, of a difference the first.
            assert (common is None) is (first is unknown[0] and second is unknown[1])
            left = getattr(DifferenceRegion(disc, box), name)(*both)
            assert (left is None) is (first is unknown[0])


def test_all_of_space_may_be_a_member() -> None:
    """Of a combination that is named as such: what bounds the others, and what is left."""
    box = named.BoxRegion((2, 2, 2), (9, 0, 0))
    for region in (IntersectionRegion(named.everywhere, box), IntersectionRegion(box, named.everywhere)):
        point, _ = region.uniform_placement()
        assert point is not None
        assert box.containsPoint(region.uniformPointInner())
        assert region.dimension == 3
    with pytest.raises(InvalidScenarioError):
        IntersectionRegion(named.everywhere, named.everywhere).uniform_placement()


def test_second_draws_of_a_union_are_as_fair_as_first_ones() -> None:
    """Whether a point that lies in several members counts is decided by a number that has decided nothing else."""
    whole, half = named.RectangularRegion((1, 0), 0, 2, 1), named.RectangularRegion((0.5, 0), 0, 1, 1)
    rng, count = np.random.default_rng(12), 60_000
    for members in ((whole, half), (half, whole), (half, half, whole)):
        union = UnionRegion(*members)
        points, _ = union.draw_points(
            rng.random((union.draws, count)),
            rng.integers(0, 1 << 62, count).astype(np.uint64),
            *union.fixed_columns("a test"),
        )
        left = int(np.count_nonzero(points[:, 0] < 1))
        assert stats.binomtest(left, count, 0.5).pvalue > FALSE_ALARM


def test_the_segment_nearest_in_space() -> None:
    path = named.PathRegion(polylines=[[(0, 0, 0), (4, 0, 0)], [(0, 1, 5), (0, 5, 9)]])
    for place, ends in (((0, 2, 6), ((0, 1, 5), (0, 5, 9))), ((0, 2, 0), ((0, 0, 0), (4, 0, 0)))):
        assert tuple(map(tuple, path.nearestSegmentTo(Vector(*place)))) == ends


def test_lines_that_shapely_has_in_space_lie_in_the_plane() -> None:
    line = named.PolylineRegion(polyline=shapely.LineString([(0, 0, 1), (4, 0, 2), (4, 3, 7)]))
    assert line.length == pytest.approx(7)
    assert {point[2] for point in line.points} == {0}


def test_volumes_of_surfaces_are_where_these_are() -> None:
    mesh = trimesh.creation.box((1, 2, 4))
    mesh.apply_translation((3, -1, 2))
    for centered in (True, False):
        surface = named.MeshSurfaceRegion(mesh, (2, 3, 5), (1, 2, 3), TILT, centerMesh=centered)
        volume = surface.getVolumeRegion()
        np.testing.assert_allclose(volume.AABB, surface.AABB)
        np.testing.assert_allclose(volume.getSurfaceRegion().AABB, surface.AABB)
        assert volume.size == pytest.approx(30)
        assert surface.size == pytest.approx(2 * (6 + 10 + 15))


@pytest.mark.parametrize(
    "make",
    [
        lambda **more: named.BoxRegion((2, 2, 2), **more),
        lambda **more: named.SpheroidRegion((2, 2, 2), **more),
        lambda **more: named.MeshVolumeRegion(trimesh.creation.box((2, 2, 2)), **more),
        lambda **more: named.MeshSurfaceRegion(trimesh.creation.box((2, 2, 2)), **more),
    ],
)
def test_things_land_along_their_own_direction_before_that_of_the_region(make: Any) -> None:
    place, along, up = Vector(0.1, 0.2, 0.3), (1, 0, 0), (0, 0, 1)
    outside = place + Vector(-5, 0, 0)
    sideways = make(onDirection=along)
    assert sideways.projectVector(outside, None).x < -0.9
    assert make(onDirection=up).projectVector(outside, along) == sideways.projectVector(outside, None)
    assert sideways.projectVector(outside, up) is None
    assert sideways.projectVector(place + Vector(0, 0, 9), up).z > 0.9
    # Where it lands it looks as the field of the region says there.
    field = VectorField("f", lambda point: 0.5 + point.x)
    landed, orientation = make(onDirection=along, orientation=field).project(outside, None)
    assert orientation.yaw == pytest.approx(0.5 + landed.x)


def test_cells_of_a_grid_meet_where_rounding_says() -> None:
    """A point between two cells is of that which `pointToGrid` names, beside the grid of none."""
    cells = np.array([[0, 1, 0, 1, 0], [1, 0, 1, 0, 1]])
    region = named.GridRegion("g", cells, 2, 1, 0.5, -1)
    for column in np.arange(-1, 5.5, 0.5):
        for row in np.arange(-1, 2.5, 0.5):
            place = Vector(0.5 + 2 * column, -1 + row, 3)
            cell = region.pointToGrid(place)
            free = cell is not None and cells[cell[1], cell[0]] == 0
            assert region.containsPoint(place) is bool(free)
            inside = -0.5 <= column <= 4.5 and -0.5 <= row <= 1.5
            assert cell is None or inside


def test_a_leaning_body_needs_free_cells_under_all_of_its_corners() -> None:
    """Seen from above: those of its bottom as those of its top."""
    cells = np.zeros((9, 9))
    cells[:, 4] = 1
    region = named.GridRegion("g", cells, 1, 1, 0, 0)
    for side in (-1, 1):
        lean = Orientation.fromEuler(0, 0, side * 0.4)
        for x, z in ((4 + side * 1.6, 0), (4 - side * 1.6, 0)):
            body = Body((primitives.box(),), None, Poses.fixed((x, 4, z), lean.q, (0.5, 0.5, 6)))
            assert region.contains_bodies(body, 1).tolist() == [False]
            upright = Body((primitives.box(),), None, Poses.fixed((x, 4, z), size=(0.5, 0.5, 6)))
            assert region.contains_bodies(upright, 1).tolist() == [True]


def test_what_has_no_bounds_has_no_box() -> None:
    """However many of its sides are bounded."""
    disc = named.CircularRegion((0, 0, 1), 2)
    for region in (
        disc.footprint,
        named.everywhere,
        Workspace(disc.footprint),
        disc.footprint.union(named.BoxRegion()),
    ):
        with pytest.raises(ScenicTypeError, match="bounding box"):
            region.AABB  # noqa: B018 - asking is the test
    np.testing.assert_allclose(disc.AABB, ((-2, -2, 1), (2, 2, 1)))


@pytest.mark.parametrize("order", [(0, 1), (1, 0)])
def test_points_of_a_column_and_a_solid_are_drawn_from_the_solid(order: tuple[int, int]) -> None:
    """Whichever comes first; and the same in a union with what is thinner."""
    column, ball = named.CircularRegion((1, 0), 1).footprint, named.SpheroidRegion((4, 4, 4))
    parts = [(column, ball)[number] for number in order]
    both = IntersectionRegion(*parts)
    rng = np.random.default_rng(3)
    points, found = both.draw_points(
        rng.random((both.draws, 300)),
        rng.integers(0, 1 << 62, 300).astype(np.uint64),
        *both.fixed_columns("a test"),
    )
    assert found is not None
    assert found.all()
    assert (np.linalg.norm(points, axis=1) <= 2).all()
    assert (np.hypot(points[:, 0] - 1, points[:, 1]) <= 1).all()
    assert np.ptp(points[:, 2]) > 2


def test_nothing_is_drawn_from_a_union_with_what_is_infinite() -> None:
    column, ball = named.CircularRegion((1, 0), 1).footprint, named.SpheroidRegion((4, 4, 4))
    for union in (UnionRegion(column, ball), UnionRegion(ball, column)):
        with pytest.raises(ScenicTypeError, match="not known"):
            union.draw_points(
                np.full((union.draws, 2), 0.5), np.arange(2, dtype=np.uint64), *union.fixed_columns("a test")
            )


def test_dimensions_of_combinations() -> None:
    """Of an intersection the least, of a union the largest, of a difference that of the first."""
    regions = [
        named.PointSetRegion("p", [(0, 0, 0)]),
        named.PathRegion([(0, 0, 0), (1, 1, 1)]),
        named.CircularRegion((0, 0), 1),
        named.BoxRegion(),
        named.everywhere,
    ]
    for one in regions:
        for other in regions:
            assert IntersectionRegion(one, other).dimension == min(one.dimension, other.dimension)
            assert UnionRegion(one, other).dimension == max(one.dimension, other.dimension)
            assert DifferenceRegion(one, other).dimension == one.dimension
            for third in regions:
                dimensions = [region.dimension for region in (one, other, third)]
                assert IntersectionRegion(one, other, third).dimension == min(dimensions)
                assert UnionRegion(one, other, third).dimension == max(dimensions)


def test_what_is_just_as_far_as_the_tolerance_counts() -> None:
    cube = trimesh.creation.box((2, 2, 2))
    for region in (
        named.MeshVolumeRegion(cube, tolerance=0.25),
        named.MeshSurfaceRegion(cube, tolerance=0.25),
        named.PointSetRegion("p", [(1, 0, 0), (-1, 0, 0), (0, 1, 0), (0, -1, 0)], tolerance=0.25),
    ):
        for way in (Vector(1, 0, 0), Vector(-1, 0, 0), Vector(0, 1, 0), Vector(0, -1, 0)):
            assert region.containsPoint(way * 1.25) is True
            assert region.containsPoint(way * 1.2500001) is False


@pytest.mark.parametrize("kind", [IntersectionRegion, UnionRegion, DifferenceRegion])
def test_points_that_are_hard_to_find_do_not_depend_on_how_many_are_looked_for(kind: type) -> None:
    """Many attempts of few lanes are looked at together, one of each where there are many."""
    region = kind(named.RectangularRegion((0, 0), 0, 4, 4), named.RectangularRegion((1, 1), 0, 3, 3))
    rng, count = np.random.default_rng(5), 6000
    numbers, keys = (
        rng.random((region.draws, count)),
        rng.integers(0, 1 << 62, count).astype(np.uint64),
    )
    columns = region.fixed_columns("a test")
    points, _ = region.draw_points(numbers, keys, *columns)
    few = slice(100, 160)
    alone, _ = region.draw_points(numbers[:, few], keys[few], *columns)
    np.testing.assert_array_equal(alone, points[few])


def test_combinations_without_a_direction_give_none() -> None:
    """Even if a member has one."""
    oriented = named.BoxRegion(orientation=VectorField("f", lambda place: place.x))
    plain, place = named.SpheroidRegion(), Vector(0.1, 0.2, 0.3)
    for region in (
        *(UnionRegion(oriented, plain), UnionRegion(plain, oriented), DifferenceRegion(plain, oriented)),
        IntersectionRegion(plain, plain),
    ):
        assert region.has_orientation is False
        assert region.orientation_at(place) is None
