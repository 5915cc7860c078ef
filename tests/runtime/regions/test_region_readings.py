"""Every class of regions: what its readings over columns say of one another.

The box holds all members, distances are those of the nearest member (they never overstate, grow by at most the way that a point
goes, and are zero on the border), draws are members and uniform, and no answer depends on the company in which it is asked.
"""

import math
from collections.abc import Iterator

import numpy as np
import pytest
import scenic.core.regions as named
import shapely
import trimesh
from scenic.core.vectors import Orientation, Vector
from scipy import stats

from scenic.graph.bounds import Bounds
from scenic.language.errors import UndefinedSamplingException, UnsupportedError
from scenic.runtime.regions import body_regions as bodies
from scenic.runtime.regions import choice, combinations, composite, lines, planar, volumes
from scenic.runtime.regions import view_regions as views
from scenic.runtime.regions.base import Region
from scenic.runtime.regions.drawn import DrawnRegion
from scenic.runtime.regions.fields import VectorField
from scenic.runtime.regions.spaces import Workspace, everywhere, nowhere
from tests.runtime.programs import FALSE_ALARM, scenario

TILT = Orientation.fromEuler(0.7, 0.4, -0.3)
LOOP = [(0, 0), (4, 0), (4, 3), (2, 1), (0, 3)]
RING = shapely.Polygon([(0, 0), (6, 0), (6, 5), (0, 5)], [[(1, 1), (4, 1), (4, 3), (1, 3)]])
HORSESHOE = trimesh.creation.extrude_polygon(
    shapely.Polygon([(0, 0), (3, 0), (3, 2), (2, 2), (2, 1), (1, 1), (1, 2), (0, 2)]), 1
)


def _regions() -> dict[str, Region]:
    box = named.BoxRegion(dimensions=(4, 1, 2), position=(1, -2, 3), rotation=TILT)
    ball = named.SpheroidRegion(dimensions=(3, 1, 5), position=(1, 2, 3), rotation=TILT)
    disc = named.CircularRegion(Vector(2, 1, 0), 3)
    column = named.CircularRegion(Vector(1, -2, 0), 1).footprint
    pillar = named.CircularRegion(Vector(2, 2, 0), 1).footprint
    cells = np.random.default_rng(1).random((4, 3, 5)) < 0.6
    thing = (
        scenario(
            "ego = new Object at (1, 2, 3), facing (0.7, 0.4, -0.3), with width 2, with length 5, with height 0.5, "
            "with viewAngles (100 deg, 60 deg), with visibleDistance 9, with shape ConeShape()"
        )
        .sample(1, seed=0)[0]
        .egoObject
    )
    return {
        "everywhere": everywhere,
        "nowhere": nowhere,
        "workspace": Workspace(box),
        "disc": disc,
        "small sector": named.SectorRegion(Vector(1, 2, 3), 5, -2.5, 0.3),
        "large sector": named.SectorRegion(Vector(1, 2, 0), 2, 0.4, 5),
        "rectangle": named.RectangularRegion(Vector(1, 2, -1), 0.6, 7, 0.5),
        "polygon": named.PolygonalRegion(LOOP),
        "ring": named.PolygonalRegion(polygon=RING, z=2),
        "footprint": named.PolygonalFootprintRegion(RING),
        "a disc's footprint": disc.footprint,
        "polyline": named.PolylineRegion(LOOP),
        "long polyline": named.PolylineRegion([(x / 9, math.sin(x / 9)) for x in range(150)]),
        "path": named.PathRegion(polylines=[[(0, 0, 0), (1, 2, 3), (4, -1, 0)], [(5, 5, 5), (5, 5, 9)]]),
        "points": named.PointSetRegion("points", [(0, 0, 0), (1, 2, 0), (5, -1, 0)]),
        "grid": named.GridRegion("grid", np.array([[0, 1, 0], [1, 0, 1]]), 2, 1, 0.5, -1),
        "box": named.BoxRegion(),
        "tilted box": box,
        "ball": named.SpheroidRegion(),
        "tilted ellipsoid": ball,
        "flat ellipsoid": named.SpheroidRegion(dimensions=(8, 5, 0.05)),
        "mesh": named.MeshVolumeRegion(HORSESHOE, dimensions=(3, 5, 1), position=(1, 2, 3), rotation=TILT),
        "surface": named.MeshSurfaceRegion(
            HORSESHOE, dimensions=(3, 5, 1), position=(1, 2, 3), rotation=TILT
        ),
        "cells": named.VoxelRegion(trimesh.voxel.VoxelGrid(cells, transform=np.diag([0.5, 1, 2, 1]))),
        "space of an object": thing.occupiedSpace,
        "top of an object": thing.topSurface,
        "whole surface of an object": thing.surface,
        "view": thing.visibleRegion,
        "view of all": named.ViewRegion(4, (2 * math.pi, math.pi), position=(1, 1, 1)),
        "wide view": named.ViewRegion(4, (4, 1), position=(1, 1, 1), rotation=TILT),
        "solids' intersection": box.intersect(named.BoxRegion(dimensions=(3, 3, 3), position=(1, -2, 3))),
        "solids' difference": ball.difference(named.BoxRegion(dimensions=(2, 2, 2), position=(1, 2, 4))),
        "solids' union": box.union(ball),
        "discs' difference": disc.difference(named.CircularRegion(Vector(3, 1, 0), 1.5)),
        "prism": box.intersect(column),
        "union of kinds": combinations.UnionRegion(box, ball),
        "intersection of kinds": combinations.IntersectionRegion(ball, pillar),
        "difference of kinds": combinations.DifferenceRegion(ball, pillar),
    }


REGIONS = _regions()
"""At least one of every class, turned, tilted and stretched where it can be."""

UNBOUNDED = {"everywhere", "footprint", "a disc's footprint"}
NOT_DRAWN = UNBOUNDED | {"nowhere"}
BY_CELLS = {"grid"}
"""Holds cells about the points from which distances are told."""

NO_DISTANCE = {"intersection of kinds", "difference of kinds"}
INNER = {"view", "wide view", "view of all"}
"""Distances to these are told to a mesh inside of them, by a thousandth of their reach at most."""

PLANAR = (planar.PlanarRegion,)


def classes(root: type[Region] = Region) -> Iterator[type[Region]]:
    for cls in root.__subclasses__():
        if cls.__module__.startswith("scenic.runtime.") and not cls.__abstractmethods__:
            yield cls
        yield from classes(cls)


def test_every_class_is_here() -> None:
    # A choice has as many forms as options, and is asked through them, as is what is known when it is drawn; what may be seen from
    # near is no region of a program.
    elsewhere = {choice.RegionChoice, DrawnRegion, views.NearView}
    here = {type(region) for region in REGIONS.values()}
    bases = {
        bodies.SideSurface,
        bodies.OccupiedSpace,
        lines.LineRegion,
        planar.Footprint,
        volumes.PlacedVolume,
    }
    missing = set(classes()) - here - elsewhere
    assert not {cls for cls in missing if cls not in bases}


def columns_of(region: Region) -> list[np.ndarray]:
    return region.fixed_columns("a test")


def drawn(region: Region, count: int = 600) -> np.ndarray:
    rng = np.random.default_rng(5)
    uniforms = rng.random((region.draws, count))
    keys = rng.integers(0, 2**63, count).astype(np.uint64)
    points, known = region.draw_points(uniforms, keys, *columns_of(region))
    assert known is None or known.all()
    return np.array(np.broadcast_to(points, (count, 3)))


def around(region: Region, count: int = 800) -> np.ndarray:
    """Points in and about a region, some near its members."""
    rng = np.random.default_rng(6)
    lower, upper = (np.clip(corner[0], -10, 10) for corner in region.box(*columns_of(region)))
    reach = np.maximum(upper - lower, 1)
    spread = rng.uniform(lower - reach, upper + reach, (count, 3))
    near = spread[: count // 2]
    if not isinstance(region, named.AllRegion | named.EmptyRegion | planar.Footprint):
        near = drawn(region, count // 2) + rng.normal(0, 0.3, (count // 2, 3))
    return np.concatenate([spread, near])


def held(region: Region, points: np.ndarray) -> np.ndarray:
    """Which points are members; of the plane, also at its height."""
    return np.broadcast_to(composite.exactly_contains(region, points, columns_of(region)), len(points))


def distances(region: Region, points: np.ndarray) -> np.ndarray:
    return np.broadcast_to(region.distances(points, *columns_of(region)), len(points))


@pytest.mark.parametrize("name", [name for name in REGIONS if name not in NOT_DRAWN])
def test_draws_are_members_in_the_box(name: str) -> None:
    region = REGIONS[name]
    points = drawn(region)
    lower, upper = region.box(*columns_of(region))
    assert (points >= lower - 1e-9).all()
    assert (points <= upper + 1e-9).all()
    if name not in NO_DISTANCE:
        assert distances(region, points) == pytest.approx(0, abs=1e-6)
    if name not in ("surface", "top of an object", "whole surface of an object"):  # thin up to rounding
        assert held(region, points).mean() > 0.999


@pytest.mark.parametrize("name", list(REGIONS))
def test_the_box_holds_all_members(name: str) -> None:
    region = REGIONS[name]
    # What a grid holds are cells about its points, at every height.
    cells = isinstance(region, named.GridRegion)
    lower, upper = (region.container_box if cells else region.box)(*columns_of(region))
    points = around(region)
    points = points[held(region, points)]
    assert (points >= lower - 1e-6).all()
    assert (points <= upper + 1e-6).all()


@pytest.mark.parametrize(
    "name", [name for name in REGIONS if name not in NO_DISTANCE | BY_CELLS | {"nowhere"}]
)
def test_distances_are_those_of_the_nearest_member(name: str) -> None:
    region = REGIONS[name]
    points = around(region)
    found = distances(region, points)
    slack = 0.02 if name in INNER else 1e-6
    members = held(region, points)
    assert (found[members] <= slack).all()
    assert (found[~members] > 0).all() or name == "everywhere"
    # They grow by no more than the way,
    others = points + np.random.default_rng(7).normal(0, 0.5, points.shape)
    ways = np.linalg.norm(others - points, axis=1)
    assert (np.abs(distances(region, others) - found) <= ways + slack).all()
    # they do not overstate,
    if name not in NOT_DRAWN:
        some = drawn(region, 300)
        to_members = np.linalg.norm(points[:, np.newaxis] - some, axis=2).min(axis=1)
        assert (found <= to_members + slack).all()
    # nor understate: there is a member at that distance, so none is nearer.
    steps = np.random.default_rng(8).normal(size=points.shape)
    steps *= (0.999 * np.maximum(found - slack, 0) / np.linalg.norm(steps, axis=1))[:, np.newaxis]
    assert not held(region, points + steps)[found > slack + 1e-9].any()


@pytest.mark.parametrize(
    "name", [name for name in REGIONS if REGIONS[name].dimension == 3 and name not in NO_DISTANCE]
)
def test_the_border_has_distance_zero(name: str) -> None:
    region = REGIONS[name]
    points = around(region)
    members = held(region, points)
    inside, outside = points[members][:100].copy(), points[~members][:100].copy()
    count = min(len(inside), len(outside))
    inside, outside = inside[:count], outside[:count]
    assert count
    for _ in range(50):
        middle = (inside + outside) / 2
        mine = held(region, middle)[:, np.newaxis]
        inside, outside = np.where(mine, middle, inside), np.where(mine, outside, middle)
    assert distances(region, outside) == pytest.approx(0, abs=0.02 if name in INNER else 1e-5)


@pytest.mark.parametrize("name", list(REGIONS))
def test_gaps_are_no_more_than_what_is_missing(name: str) -> None:
    region = REGIONS[name]
    points = around(region)
    gaps = np.broadcast_to(region.gaps(points, *columns_of(region)), len(points))
    inside = np.broadcast_to(region.contains_points(points, *columns_of(region)), len(points))
    assert (gaps >= 0).all()
    assert (gaps[inside] <= 1e-6).all()
    step = np.random.default_rng(9).normal(size=points.shape)
    step *= (0.999 * np.where(np.isfinite(gaps), gaps, 0) / np.linalg.norm(step, axis=1))[:, np.newaxis]
    moved = np.broadcast_to(region.contains_points(points + step, *columns_of(region)), len(points))
    assert not moved[(gaps > 1e-6) & ~inside].any()


@pytest.mark.parametrize("name", list(REGIONS))
def test_no_answer_depends_on_its_company(name: str) -> None:
    region = REGIONS[name]
    points = around(region)
    readings = [region.contains_points, region.gaps]
    if name not in NO_DISTANCE:
        readings.append(region.distances)
    for reading in readings:
        together = np.broadcast_to(reading(points, *columns_of(region)), len(points))
        for part in (points[3:4], points[7:14], points[::5]):
            alone = np.broadcast_to(reading(part, *columns_of(region)), len(part))
            where = [int(np.flatnonzero((points == row).all(axis=1))[0]) for row in part]
            assert alone.tobytes() == together[where].tobytes()


@pytest.mark.parametrize(
    "name", [name for name in REGIONS if REGIONS[name].dimension in (2, 3) and name not in NOT_DRAWN]
)
def test_draws_are_uniform(name: str) -> None:
    """Against points of the box that are members; of surfaces, against draws of their triangles by area."""
    region = REGIONS[name]
    points = drawn(region, 4000)
    lower, upper = (corner[0] for corner in region.box(*columns_of(region)))
    if isinstance(region, bodies.SideSurface):
        pytest.skip("surfaces have tests of their own")
    rng = np.random.default_rng(11)
    tries = rng.uniform(lower, upper, (40_000, 3))
    if isinstance(region, PLANAR):
        tries[:, 2] = region.heights(*columns_of(region))
    others = tries[held(region, tries)]
    assert len(others) > 200
    for _ in range(3):
        way = rng.normal(size=3)
        assert stats.ks_2samp(points @ way, others @ way).pvalue > FALSE_ALARM
    if isinstance(region, Workspace) or not np.isfinite(region.sizes(*columns_of(region))).all():
        return
    share = len(others) / len(tries)
    box = float(np.prod((upper - lower)[: 2 if isinstance(region, PLANAR) else 3]))
    error = 6 * math.sqrt(share * (1 - share) / len(tries)) * box
    assert float(region.sizes(*columns_of(region))[0]) == pytest.approx(share * box, abs=error + 2e-3 * box)


@pytest.mark.parametrize("name", [name for name in REGIONS if name not in UNBOUNDED])
def test_identities_of_sets(name: str) -> None:
    region = REGIONS[name]
    other = named.BoxRegion(dimensions=(3, 4, 5), position=(1, 1, 1), rotation=TILT)
    points = around(region, 300)
    here = np.broadcast_to(region.contains_points(points, *columns_of(region)), len(points))
    there = other.contains_points(points, *columns_of(other))
    exact = held(region, points)
    near = np.zeros(len(points), dtype=bool)
    if name not in NO_DISTANCE | {"nowhere"}:
        near = (
            distances(region, points) < 1e-2
        ) & ~exact  # shapes in the plane are polygons with many corners here
    for made, mine, wanted in (
        (combinations.IntersectionRegion(region, other), here, here & there),
        (combinations.UnionRegion(region, other), here, here | there),
        (combinations.DifferenceRegion(region, other), here, here & ~there),
    ):
        found = np.broadcast_to(made.contains_points(points, *columns_of(made)), len(points))
        assert (found == wanted).all(), mine
    if region.dimension == 3 and name not in INNER:
        for made, wanted in (
            (region.intersect(other), exact & there),
            (region.difference(other), exact & ~there),
        ):
            found = np.broadcast_to(made.contains_points(points, *columns_of(made)), len(points))
            assert (found == wanted)[~near].mean() > 0.99


def test_distances_of_combinations_with_random_parameters() -> None:
    text = """
near = CircularRegion((0, 0), Range(2, 3))
ring = near.difference(CircularRegion((0, 0), Range(0.5, 1)))
lens = near.intersect(RectangularRegion((2, 0), 0, Range(1, 2), 8))
param near = near.radius, d = ring.distanceTo((0, 0)), e = ring.distanceTo((5, 0)), f = lens.distanceTo((-1, 0))
"""
    for item in scenario(text).sample(6, seed=1):
        found = item.params
        assert 0.49 < found["d"] < 1
        assert found["e"] == pytest.approx(5 - found["near"], abs=1e-3)
        assert 2 <= found["f"] <= 2.5


def test_what_has_no_distance_says_so() -> None:
    for name in NO_DISTANCE:
        with pytest.raises(UnsupportedError):
            REGIONS[name].distances(around(REGIONS[name]), *columns_of(REGIONS[name]))


@pytest.mark.parametrize("name", ["space of an object", "mesh", "whole surface of an object", "surface"])
def test_boxes_of_solids_are_exact(name: str) -> None:
    region = REGIONS[name]
    solid = REGIONS["space of an object"] if name == "whole surface of an object" else region
    np.testing.assert_allclose(np.array(region.AABB), solid.mesh.bounds, atol=1e-9)


def test_grids_hold_what_lies_in_their_outer_cells() -> None:
    text = (
        "import numpy\nregion = GridRegion('grid', numpy.zeros((3, 3)), 1, 1, 0, 0)\n"
        "ego = new Object at (Range(-3, 5), Range(-3, 5), Range(-9, 9)), with width 0.1, with length 0.1, with regionContainedIn region"
    )
    places = np.array([tuple(item.egoObject.position) for item in scenario(text).sample(300, seed=1)])
    assert places[:, :2].min() < -0.4
    assert places[:, :2].max() > 2.4
    assert np.ptp(places[:, 2]) > 15


PRIMITIVES = ("contains_points", "distances", "gaps")


def assert_same_readings(one: Region, other: Region) -> None:
    """Two regions of the same parameters hold the same, are as far, as large and as wide, and are drawn from alike."""
    columns, points = columns_of(one), around(one, 20)
    exact = [None if column.dtype == object else Bounds(column, column) for column in columns]
    for name in PRIMITIVES:
        try:
            expected = getattr(one, name)(points, *columns)
        except UnsupportedError:
            continue
        np.testing.assert_array_equal(getattr(other, name)(points, *columns), expected, err_msg=name)
    for name in ("box", "container_box", "sizes"):
        np.testing.assert_array_equal(
            getattr(other, name)(*columns), getattr(one, name)(*columns), err_msg=name
        )
    for name in ("extent", "container_extent"):
        found, known = getattr(other, name)(*exact), getattr(one, name)(*exact)
        assert found is None or known is not None
        if found is not None and known is not None:
            ends = (known.lower, known.upper)
            np.testing.assert_allclose((found.lower, found.upper), ends, atol=2e-6, err_msg=name)
    for name in ("dimension", "dimensionality", "draws", "may_find_none", "tolerance", "is_random"):
        assert getattr(other, name) == getattr(one, name), name
    assert type(other.footprint) is type(one.footprint)
    assert type(other.at_once) is type(one.at_once)
    numbers, keys = np.random.default_rng(3).random((one.draws, 8)), np.arange(8, dtype=np.uint64)
    try:
        expected, known = one.draw_points(numbers, keys, *columns)
    except UndefinedSamplingException:
        return
    found, also = other.draw_points(numbers, keys, *columns)
    np.testing.assert_array_equal(found, expected)
    np.testing.assert_array_equal(
        np.ones(8) if also is None else also, np.ones(8) if known is None else known
    )


@pytest.mark.parametrize("name", REGIONS)
def test_a_workspace_reads_as_the_region_that_it_is_made_of(name: str) -> None:
    region = REGIONS[name]
    space = Workspace(Workspace(region))
    assert_same_readings(region, space)
    assert space.has_orientation is region.has_orientation
    assert space.orientation is region.orientation


ORIENTABLE = {
    "polygon": lambda field: named.PolygonalRegion(LOOP, z=2, orientation=field),
    "box": lambda field: named.BoxRegion((4, 1, 2), (1, -2, 3), TILT, orientation=field),
    "ball": lambda field: named.SpheroidRegion((4, 1, 2), (1, -2, 3), TILT, orientation=field),
    "points": lambda field: named.PointSetRegion("p", [(0, 0, 0), (1, 2, 0)], orientation=field),
    "grid": lambda field: named.GridRegion("g", np.array([[0, 1], [0, 0]]), 2, 1, 0.5, -1, orientation=field),
    "line": lambda field: named.PolylineRegion(LOOP, orientation=field),
    "path": lambda field: named.PathRegion([(0, 0, 0), (1, 2, 3)], orientation=field),
    "mesh": lambda field: named.MeshVolumeRegion(HORSESHOE, orientation=field),
    "surface": lambda field: named.MeshSurfaceRegion(HORSESHOE, orientation=field),
    "cells": lambda field: named.VoxelRegion(trimesh.voxel.VoxelGrid(np.ones((1, 2, 3), bool)), field),
    "cut": lambda field: combinations.IntersectionRegion(REGIONS["ball"], REGIONS["box"], orientation=field),
}


@pytest.mark.parametrize("kind", ORIENTABLE)
def test_a_field_changes_nothing_but_directions(kind: str) -> None:
    field = VectorField("f", lambda place: place.x)
    plain, oriented = ORIENTABLE[kind](None), ORIENTABLE[kind](field)
    assert (plain.has_orientation, oriented.has_orientation) == (False, True)
    assert_same_readings(plain, oriented)


class _Same:
    """A sample in which everything is as it is."""

    def value(self, value: object) -> object:
        return value


@pytest.mark.parametrize("name", REGIONS)
def test_what_is_fixed_is_itself_in_every_scene(name: str) -> None:
    for region in (REGIONS[name], REGIONS[name].footprint, Workspace(REGIONS[name])):
        assert region.sampled(_Same()) is region
