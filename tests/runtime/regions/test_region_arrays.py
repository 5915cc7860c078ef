"""Regions that move with the sample, asked in arrays: against exact answers lane by lane, and the same in any company."""

import itertools
from typing import Any

import numpy as np
import pytest
import shapely
from numpy.typing import NDArray

from scenic.graph import quaternions
from scenic.runtime.geometry.flat.outlines import cuts, shadows
from scenic.runtime.geometry.meshes import booleans, polytopes, primitives
from scenic.runtime.geometry.meshes.bodies import Body
from scenic.runtime.geometry.meshes.mesh import Mesh
from scenic.runtime.geometry.meshes.prisms import prism, shadow, slice_at
from scenic.runtime.geometry.poses import Poses
from scenic.runtime.regions.base import Region
from scenic.runtime.regions.circular import CircularRegion
from scenic.runtime.regions.combinations import DifferenceRegion, IntersectionRegion, UnionRegion
from scenic.runtime.regions.planar import Footprint, PolygonalRegion
from scenic.runtime.regions.rectangular import RectangularRegion
from scenic.runtime.regions.sectors import SectorRegion
from scenic.runtime.regions.volumes import BoxRegion, SpheroidRegion
from tests.amounts import amount

LANES = 96
CORNER = shapely.Polygon([(0, 0), (3, 0), (3, 1), (1, 1), (1, 3), (0, 3)])
RING = shapely.Point(0, 0).buffer(2).difference(shapely.Point(0, 0).buffer(1))


def unit(polygon: Any) -> Mesh:
    solid = prism(polygon, 0, 1)
    assert solid is not None
    return solid.normalized()[0]


MESHES = {
    "box": primitives.box(),
    "ball": primitives.spheroid(),
    "corner": unit(CORNER),
    "ring": unit(RING),
}


def bodies(mesh: Mesh, random: np.random.Generator, *, level: bool) -> Body:
    """Bodies of random sizes about the origin, some upright; all near the plane z = 0, or anywhere."""
    turn = random.normal(size=(LANES, 4))
    turn[::2, :2] = 0
    turn /= np.linalg.norm(turn, axis=1)[:, np.newaxis]
    place = random.uniform(-4, 4, (LANES, 3))
    if level:
        place[:, 2] = random.uniform(-0.3, 0.3, LANES)
    return Body((mesh,), None, Poses(place, turn, random.uniform(0.4, 2, (LANES, 3))))


def world(body: Body, lane: int) -> Mesh:
    (mesh,) = body.meshes
    vertices = body.poses.take(np.array([lane])).to_world(mesh.vertices[np.newaxis])[0]
    return Mesh(vertices, mesh.faces)


@pytest.mark.parametrize("name", MESHES)
def test_outlines_and_cuts_are_those_of_each_solid(name: str) -> None:
    body = bodies(MESHES[name], np.random.default_rng(1), level=True)
    some = np.arange(0, LANES, amount(10, 5))
    heights = np.random.default_rng(2).normal(size=LANES) * 0.9
    seen, cut = shadows(body, some), cuts(body, some, heights[some])
    found = 0
    for number, lane in enumerate(some.tolist()):
        solid = world(body, lane)
        assert shadow(solid).symmetric_difference(seen[number]).area < 1e-7
        assert slice_at(solid, heights[lane]).symmetric_difference(cut[number]).area < 1e-6
        found += not cut[number].is_empty
    assert 0 < found < len(some)


def columns_of(kind: str, random: np.random.Generator) -> tuple[Region, list[NDArray[np.float64]]]:
    """A region of the plane with columns of parameters that all vary."""
    center = np.concatenate([random.uniform(-2, 2, (LANES, 2)), np.zeros((LANES, 1))], axis=1)
    heading = random.uniform(-4, 4, LANES)
    if kind == "disc":
        return CircularRegion((0, 0), 1), [center, random.uniform(0.5, 3, LANES)]
    if kind == "rectangle":
        sizes = random.uniform(1, 5, (2, LANES))
        return RectangularRegion((0, 0), 0, 1, 1), [center, heading, *sizes]
    if kind == "sector":
        columns = [center, random.uniform(1, 4, LANES), heading, random.uniform(0.3, 7, LANES)]
        return SectorRegion((0, 0), 1, 0, 1), columns
    return PolygonalRegion(polygon=shapely.affinity.translate(CORNER, -1, -1)), []


def shape(region: Any, columns: list[NDArray[np.float64]], lane: int) -> Any:
    """The polygon of a region of the plane in a lane, by shapely alone."""
    row = [column[lane] if len(column) > 1 else column[0] for column in columns]
    if isinstance(region, CircularRegion):
        return shapely.Point(row[0][:2]).buffer(row[1], quad_segs=256)
    if isinstance(region, RectangularRegion):
        (x, y, _), heading, width, length = row
        box = shapely.box(-width / 2, -length / 2, width / 2, length / 2)
        turned = shapely.affinity.rotate(box, heading, origin=(0, 0), use_radians=True)
        return shapely.affinity.translate(turned, x, y)
    if isinstance(region, SectorRegion):
        (x, y, _), radius, heading, angle = row
        if angle >= 2 * np.pi:
            return shapely.Point(x, y).buffer(radius, quad_segs=256)
        ways = heading + np.linspace(-angle / 2, angle / 2, 500)
        arc = np.column_stack([x - radius * np.sin(ways), y + radius * np.cos(ways)])
        return shapely.Polygon([(x, y), *arc])
    return region.outline.polygon


KINDS = ("disc", "rectangle", "sector", "polygon")
ROUND = 2e-3
"""Metres by which a polygon may differ from the disc that it stands for, or twice that."""


def certain(found: NDArray[np.bool_], thick: NDArray[np.bool_], thin: NDArray[np.bool_]) -> None:
    """Asserts answers that neither a slightly larger nor a slightly smaller region changes; most are such."""
    clear = thick == thin
    assert clear.mean() > 0.9
    np.testing.assert_array_equal(found[clear], thick[clear])


@pytest.mark.parametrize("mesh", ["box", "corner"])
@pytest.mark.parametrize("kind", KINDS)
def test_regions_of_the_plane_meet_bodies(kind: str, mesh: str) -> None:
    random = np.random.default_rng(3)
    region, columns = columns_of(kind, random)
    body = bodies(MESHES[mesh], random, level=True)
    polygons = [shape(region, columns, lane) for lane in range(LANES)]
    every = np.arange(LANES)
    for asked, parts in ((region, cuts(body, every, np.zeros(1))), (region.footprint, shadows(body, every))):
        found = asked.meets_bodies(body, LANES, *columns)
        thick, thin = (
            np.array([p.buffer(d).intersects(part) for p, part in zip(polygons, parts, strict=True)])
            for d in (ROUND, -ROUND)
        )
        certain(found, thick, thin)
        assert 0.1 < found.mean() < 0.95


@pytest.mark.parametrize("kind", ["disc", "rectangle", "sector"])
def test_regions_of_the_plane_hold_bodies(kind: str) -> None:
    random = np.random.default_rng(4)
    region, columns = columns_of(kind, random)
    small = bodies(MESHES["corner"], random, level=True)
    body = Body(
        small.meshes, None, Poses(small.poses.position / 2, small.poses.orientation, small.poses.size / 3)
    )
    found = region.contains_bodies(body, LANES, *columns)
    seen = shadows(body, np.arange(LANES))
    polygons = [shape(region, columns, lane) for lane in range(LANES)]
    thick, thin = (
        np.array([p.buffer(d).covers(part) for p, part in zip(polygons, seen, strict=True)])
        for d in (ROUND, -ROUND)
    )
    certain(found, thick, thin)
    assert 0.05 < found.mean() < 0.95


JOINS = {
    IntersectionRegion: shapely.intersection,
    UnionRegion: shapely.union,
    DifferenceRegion: shapely.difference,
}


@pytest.mark.parametrize("kind", JOINS)
@pytest.mark.parametrize(("one", "two"), list(itertools.product(KINDS[:3], KINDS)))
def test_combinations_in_the_plane(kind: Any, one: str, two: str) -> None:
    """Bodies that they meet and hold, and distances, are those of the polygons."""
    random = np.random.default_rng(5)
    (first, mine), (second, others) = columns_of(one, random), columns_of(two, random)
    region, columns = kind(first, second), [*mine, *others]
    body = bodies(MESHES["box"], random, level=True)
    pairs = [(shape(first, mine, lane), shape(second, others, lane)) for lane in range(LANES)]
    thin, thick = [], []
    for a, b in pairs:
        hole = kind is DifferenceRegion
        thin.append(JOINS[kind](a.buffer(-ROUND), b.buffer(ROUND if hole else -ROUND)))
        thick.append(JOINS[kind](a.buffer(ROUND), b.buffer(-ROUND if hole else ROUND)))
    cut, seen = cuts(body, np.arange(LANES), np.zeros(1)), shadows(body, np.arange(LANES))
    met = region.meets_bodies(body, LANES, *columns)
    certain(met, shapely.intersects(thick, cut), shapely.intersects(thin, cut))
    held = region.contains_bodies(body, LANES, *columns)
    certain(held, shapely.covers(thick, seen), shapely.covers(thin, seen))
    points = np.concatenate([random.uniform(-5, 5, (LANES, 2)), np.full((LANES, 1), 0.5)], axis=1)
    found = region.distances(points, *columns)
    for lane in range(LANES):
        beside = [shapely.Point(points[lane, :2]).distance(part) for part in (thick[lane], thin[lane])]
        if np.isfinite(beside).all():
            assert beside[0] - 1e-9 <= np.sqrt(found[lane] ** 2 - 0.25) <= beside[1] + 0.05


def planes_of(body: Body) -> NDArray[np.float64]:
    found = polytopes.half_spaces(body.meshes[0], body.poses)
    assert found is not None
    return found


def test_polytopes_meet_where_their_meshes_do() -> None:
    random = np.random.default_rng(6)
    three = [bodies(MESHES["box"], random, level=False) for _ in range(3)]
    for body in three:
        body.poses.position[:] *= 0.3
    found = polytopes.edges(polytopes.joined(*map(planes_of, three))).valid.any(axis=1)
    for lane in range(LANES):
        solid = booleans.intersection([world(body, lane) for body in three])
        volume = 0.0 if solid is None else solid.volume
        assert found[lane] == (volume > 0) or volume < 1e-6
    assert 0.05 < found.mean() < 0.9


def test_distances_to_what_is_left_of_solids_are_those_to_many_points_of_it() -> None:
    """Never more than to any point of the region, and reached."""
    random = np.random.default_rng(7)
    a, b = bodies(MESHES["box"], random, level=False), bodies(MESHES["box"], random, level=False)
    for body in (a, b):
        body.poses.position[:] *= 0.1
        body.poses.size[:] += 1
    boxes = [body.poses for body in (a, b)]
    first, second = BoxRegion((1, 1, 1)), BoxRegion((1, 1, 1))
    mine, others = ([poses.size, poses.position, poses.orientation] for poses in boxes)
    radius = random.uniform(0.3, 1.5, LANES)
    ball = [np.repeat(2 * radius[:, np.newaxis], 3, axis=1), boxes[1].position, np.array([[0, 0, 0, 1.0]])]
    points = random.uniform(-3, 3, (LANES, 3))
    cloud = random.uniform(-0.5, 0.5, (4000, 3))
    for region, columns in (
        (IntersectionRegion(first, second), [*mine, *others]),
        (DifferenceRegion(first, second), [*mine, *others]),
        (DifferenceRegion(first, SpheroidRegion((1, 1, 1))), [*mine, *ball]),
    ):
        found = region.distances(points, *columns)
        decided = np.isfinite(found)
        assert decided.mean() > 0.7
        for lane in np.flatnonzero(decided)[:30].tolist():
            row = [column if len(column) == 1 else column[[lane]] for column in columns]
            places = mine[1][lane] + quaternions.rotate(mine[2][[lane]], cloud * mine[0][lane])
            inside = places[region.contains_points(places, *row)]
            if len(inside) > 200:
                least = np.linalg.norm(inside - points[lane], axis=1).min()
                assert found[lane] <= least + 1e-9
                assert found[lane] >= least - 0.6


@pytest.mark.parametrize("kind", JOINS)
def test_lanes_are_alike_in_any_company(kind: Any) -> None:
    random = np.random.default_rng(8)
    tilted = bodies(MESHES["box"], random, level=True)
    points = random.uniform(-5, 5, (LANES, 3))
    pairs = [*itertools.product(KINDS[:3], KINDS)]
    for one, two in pairs[:: 1 + len(pairs) // 5]:
        (first, mine), (second, others) = columns_of(one, random), columns_of(two, random)
        region, columns = kind(first, second), [*mine, *others]
        met = region.meets_bodies(tilted, LANES, *columns)
        held, far = region.contains_bodies(tilted, LANES, *columns), region.distances(points, *columns)
        for size in (1, 7):
            for start in range(0, 3 * size, size):
                some = np.arange(start, start + size)
                rows = [column[some] for column in columns]
                np.testing.assert_array_equal(met[some], region.meets_bodies(tilted.take(some), size, *rows))
                np.testing.assert_array_equal(
                    held[some], region.contains_bodies(tilted.take(some), size, *rows)
                )
                np.testing.assert_array_equal(far[some], region.distances(points[some], *rows))


def test_footprints_are_columns() -> None:
    """A hole that is cut into a container of the plane reaches through all heights."""
    disc, hole = CircularRegion((0, 0, 0), 3), CircularRegion((0, 0, 0), 1)
    ring = DifferenceRegion(disc, hole)
    body = Body((primitives.box(),), None, Poses.fixed((0, 0, 9)))
    rows = ring.fixed_columns("the test")
    assert not ring.contains_bodies(body, 1, *rows)[0]
    assert isinstance(disc.footprint, Footprint)
