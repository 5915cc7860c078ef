"""What two regions have in common, for every pair of kinds: against the distances between points of one and the other.

One of two regions moves past the other. Where no drawn point of either is near the other one, they are apart; where one is in the
other, also when that has moved a little, they meet. What they share and what is left of one holds the drawn points that
it must, and has the share of the size that these say.
"""

import itertools
from collections.abc import Callable
from typing import Any

import numpy as np
import pytest
import scenic.core.regions as named
import shapely
import trimesh
from scipy.spatial.transform import Rotation

from scenic.language.errors import InvalidScenarioError, ScenicTypeError
from scenic.runtime.geometry.meshes import primitives
from scenic.runtime.geometry.poses import Floats
from scenic.runtime.regions.base import Region
from scenic.runtime.regions.combinations import DifferenceRegion, IntersectionRegion, UnionRegion
from scenic.runtime.regions.composite import Composite
from scenic.runtime.regions.fields import VectorField
from scenic.runtime.regions.lines import LineRegion
from scenic.runtime.regions.planar import Footprint, PlanarRegion
from scenic.runtime.regions.spaces import Workspace, nowhere
from scenic.runtime.values.values import Orientation, Vector
from tests.amounts import amount
from tests.runtime.programs import thing

TILT = Orientation.fromEuler(0.7, 0.4, -0.3)
FRAME = shapely.Polygon([(-2, -1.5), (2, -1.5), (2, 1.5), (-2, 1.5)], [[(-1, -1), (1, -1), (1, 1), (-1, 1)]])
BEND = [(-2, -1), (0, 1), (1.5, -0.5)]
PIPE = [(-2, -1, -1.2), (0.5, 1, 0.4), (1, 0.2, 0.4), (1.5, -1, 2)]
SPOTS = [(0, 0, 0), (0.7, 0.1, 0.4), (-1.5, 1.2, 0), (0.2, -0.4, -0.9)]
SHELL = trimesh.creation.box((1.5, 2.5, 2))
HORSESHOE = trimesh.creation.extrude_polygon(
    shapely.Polygon([(0, 0), (3, 0), (3, 2), (2, 2), (2, 1), (1, 1), (1, 2), (0, 2)]), 1
)
Make = Callable[[float, float, float], Region]


def moved(points: Any, x: float, y: float, z: float = 0) -> list[Any]:
    return (np.array(points) + [x, y, z][: len(points[0])]).tolist()


KINDS: dict[str, Make] = {
    "disc": lambda x, y, z: named.CircularRegion(Vector(x, y, z), 1.5),
    "rectangle": lambda x, y, z: named.RectangularRegion(Vector(x, y, z), 0.5, 3, 1),
    "frame": lambda x, y, z: named.PolygonalRegion(polygon=shapely.affinity.translate(FRAME, x, y), z=z),
    "column": lambda x, y, z: named.RectangularRegion(Vector(x, y, z), 0.5, 3, 1).footprint,
    "polyline": lambda x, y, z: named.PolylineRegion(moved(BEND, x, y)),
    "path": lambda x, y, z: named.PathRegion(moved(PIPE, x, y, z)),
    "points": lambda x, y, z: named.PointSetRegion("points", moved(SPOTS, x, y, z)),
    "box": lambda x, y, z: named.BoxRegion((3, 1, 2), Vector(x, y, z), TILT),
    "ball": lambda x, y, z: named.SpheroidRegion((3, 1.5, 2), Vector(x, y, z), TILT),
    "mesh": lambda x, y, z: named.MeshVolumeRegion(HORSESHOE, position=Vector(x, y, z), rotation=TILT),
    "shell": lambda x, y, z: named.MeshSurfaceRegion(SHELL, position=Vector(x, y, z), rotation=TILT),
    "either": lambda x, y, z: UnionRegion(
        named.BoxRegion((1, 1, 1), Vector(x - 1, y, z)), named.SpheroidRegion((1, 1, 1), Vector(x + 1, y, z))
    ),
    "cells": lambda x, y, z: named.BoxRegion((2, 1, 1.5), Vector(x, y, z)).voxelized(0.5),
    "workspace": lambda x, y, z: Workspace(named.BoxRegion((2, 2, 1), Vector(x, y, z))),
}
FLAT = {"polyline"}
"""Lie on the ground wherever they are moved."""
PAIRS = list(itertools.combinations_with_replacement(KINDS, 2))
WAYS = {
    "aside": [(x, 0.4 * x, 0.0) for x in (-7, -2.6, -1.4, 0.2, 0.8, 2.7)],
    "up": [(0.15, 0.1, z) for z in (-1.7, -0.8, 0.3, 1.1, 6)],
}


def columns_of(region: Region) -> list[Any]:
    return region.fixed_columns("the region")


def cloud(region: Region, count: int = amount(100, 250)) -> Floats:
    """Points of a region; of a column, those near the ground."""
    random = np.random.default_rng(1)
    if isinstance(region, Footprint):
        points = cloud(region.region, count).copy()
        points[:, 2] = random.uniform(-9, 9, len(points))
        return points
    if isinstance(region, LineRegion):
        return np.concatenate(
            [
                start + np.linspace(0, 1, count)[:, np.newaxis] * (end - start)
                for start, end in zip(region.pieces.starts, region.pieces.ends, strict=True)
            ]
        )
    numbers = random.random((region.draws, count))
    keys = random.integers(0, 1 << 60, count).astype(np.uint64)
    points, known = region.draw_points(numbers, keys, *columns_of(region))
    return points if known is None else points[known]


def gap(one: Region, other: Region) -> float:
    """The distance between two regions, or more where points are few."""
    found = [
        float(np.min(first.distances(cloud(second), *columns_of(first))))
        for first, second in ((one, other), (other, one))
    ]
    return min(found)


def exactly(region: Region, points: Floats) -> Any:
    return region.distances(points, *columns_of(region)) < 1e-9


UNKNOWN = {
    *(("disc", "shell"), ("rectangle", "shell"), ("frame", "shell")),
    *(("polyline", "shell"), ("path", "shell"), ("path", "path"), ("polyline", "path")),
}
"""Of these it is not known whether they meet."""

DENSE = {"ball", "shell", "either", "cells", "mesh"}
"""Of these, only pairs with simpler ones are looked at: they are made of the same faces and parts."""


@pytest.mark.parametrize(
    ("first", "second"), [pair for pair in PAIRS if pair[0] == pair[1] or not DENSE.issuperset(pair)]
)
def test_regions_that_move_past_each_other(first: str, second: str) -> None:
    standing, told = KINDS[first](0, 0, 0), 0
    for place in itertools.chain(*WAYS.values()):
        if second in FLAT and place[2]:
            continue
        one = KINDS[second](*place)
        if (first, second) in UNKNOWN:
            with pytest.raises(NotImplementedError):
                standing.intersects(one)
            return
        found = standing.intersects(one)
        assert one.intersects(standing) is found
        least = gap(standing, one)
        if least > (0.35 if standing.dimension >= 2 and one.dimension >= 2 else 0.05):
            assert found is False
            told += 1
        elif least < 1e-9:
            assert found is True
            told += 1
    assert told


SHARED = [(0.6, 0.24, 0.0), (0.15, 0.1, 0.3), (0.15, 0.1, -0.25), (9.0, 0.0, 0.0)]
COARSE = 0.08
"""Metres: balls have flat faces, and discs corners, where they are combined."""
NUDGES = [np.zeros(3), *(sign * 2 * COARSE * axis for axis in np.eye(3) for sign in (-1, 1))]


def distances(region: Region, points: Floats) -> Any:
    return region.distances(points, *columns_of(region))


def deep(region: Region, points: Floats) -> Any:
    """Which points are in a region and not near its border; of one of the plane, in it and not near its outline."""
    flat = np.array([1, 1, 0 if isinstance(region, PlanarRegion) else 1])
    return np.all([distances(region, points + nudge * flat) < 1e-9 for nudge in NUDGES], axis=0)


@pytest.mark.parametrize(
    ("first", "second"), [pair for pair in PAIRS if pair[0] != pair[1] and not DENSE.issuperset(pair)]
)
def test_what_regions_share(first: str, second: str) -> None:
    for place in SHARED:
        if second in FLAT and place[2]:
            continue
        one, other = KINDS[first](0, 0, 0), KINDS[second](*place)
        for a, b in ((one, other), (other, one)):
            points = cloud(a)
            common, rest = a.intersect(b), a.difference(b)
            if not isinstance(common, Composite) and a.dimension <= b.dimension:
                inner = points[deep(b, points)]
                if len(inner):
                    assert (distances(common, inner) < COARSE).all()
            if not isinstance(common, Composite | Footprint) and common is not nowhere:
                drawn = cloud(common)
                assert max(distances(a, drawn).max(), distances(b, drawn).max()) < 1e-6
            if not isinstance(rest, Composite):
                outer = points[distances(b, points) > 2 * COARSE]
                if len(outer):
                    assert (distances(rest, outer) < COARSE).all()
                if rest is not nowhere:
                    drawn = cloud(rest)
                    assert distances(a, drawn).max() < 1e-6
                    assert not deep(b, drawn).any()


HOLDERS: dict[str, Region] = {
    "disc": named.CircularRegion(Vector(0.2, 0, 0), 3.2),
    "column": named.RectangularRegion(Vector(0, 0, 5), 0.3, 6, 7).footprint,
    "box": named.BoxRegion((6, 7, 5), Vector(0.2, 0, 0), Orientation.fromEuler(0.3, 0.1, 0)),
    "ball": named.SpheroidRegion((7, 8, 7)),
}


@pytest.mark.parametrize("holder", HOLDERS)
@pytest.mark.parametrize("kind", KINDS)
def test_regions_that_move_out_of_one(holder: str, kind: str) -> None:
    whole = HOLDERS[holder]
    answers = set()
    for place in [(x, 0.4 * x, z) for x in (0, 0.5, 1.1, 1.7, 2.6, 5, 12) for z in (0.0, 0.4)]:
        part = KINDS[kind](*place)
        try:
            found = whole.containsRegion(part)
        except NotImplementedError:
            answers.add(None)
            continue
        far = float(whole.distances(cloud(part), *columns_of(whole)).max())
        if far > 1e-6:
            assert found is False
        elif kind not in ("frame", "shell"):  # of these few drawn points are at the ends
            near = KINDS[kind](place[0] + 0.3, place[1] + 0.12, place[2])
            if whole.distances(cloud(near), *columns_of(whole)).max() < 1e-9:
                assert found is True
        answers.add(found)


@pytest.mark.parametrize("first", range(3))
@pytest.mark.parametrize("second", range(3))
def test_any_edge_may_be_the_one_that_crosses(first: int, second: int) -> None:
    """Of two triangles one edge each meets the other one; which corner is named first says nothing."""
    flat = np.array([(0, 0, 0), (4, 0, 0), (0, 4, 0)])
    steep = np.array([(2, 1, -1), (2, 1, 1), (2, -3, 0.1)])

    def sheet(corners: np.ndarray, start: int) -> Region:
        mesh = trimesh.Trimesh(np.roll(corners, start, axis=0), [(0, 1, 2)], process=False)
        return named.MeshSurfaceRegion(mesh, centerMesh=False)

    one = sheet(flat, first)
    assert one.intersects(sheet(steep, second))
    assert sheet(steep, second).intersects(one)
    for beside in ((0, -1.2, 0), (0, 0, 1.2), (-3, 0, 0)):
        assert not one.intersects(sheet(steep + beside, second))


@pytest.mark.parametrize("axis", range(3))
def test_a_flat_surface_keeps_its_place(axis: int) -> None:
    """A sheet at 2 along an axis, moved, turned and stretched: where its middle and its corners are says SciPy."""
    corners = np.roll(np.array([(2, 0, 0), (2, 4, 0), (2, 4, 1), (2, 0, 1.0)]), axis, axis=1)
    mesh = trimesh.Trimesh(corners, [(0, 1, 2), (0, 2, 3)], process=False)
    size = np.ptp(corners, axis=0)
    for stretch in (1.0, 1.5):
        region = named.MeshSurfaceRegion(mesh, tuple(stretch * size), (5, 6, 7), TILT, centerMesh=False)
        # What is flat has no extent to be stretched, nor has the way to it.
        factors = np.where(size > 0, stretch, 1.0)
        turn = Rotation.from_quat([TILT.x, TILT.y, TILT.z, TILT.w])
        world = turn.apply(corners * factors) + np.array([5, 6, 7])
        lower, upper = region.AABB
        np.testing.assert_allclose((lower, upper), (world.min(axis=0), world.max(axis=0)), atol=1e-9)
    plain = named.MeshSurfaceRegion(mesh, centerMesh=False)
    np.testing.assert_array_equal(plain.AABB, (corners.min(axis=0), corners.max(axis=0)))
    assert plain.distanceTo(Vector(*corners.mean(axis=0))) == 0


ORIENTED: dict[str, Callable[[Any], Region]] = {
    "polygon": lambda field: named.PolygonalRegion([(0, 0), (3, 0), (3, 2), (0, 2)], orientation=field),
    "box": lambda field: named.BoxRegion((3, 4, 5), (1, 1, 1), orientation=field),
    "ball": lambda field: named.SpheroidRegion((4, 3, 5), (1.5, 1, 0.5), orientation=field),
    "points": lambda field: named.PointSetRegion("p", [(1, 1, 0), (2, 0.5, 0)], orientation=field),
    "path": lambda field: named.PathRegion(points=[(0, 0.5, 0), (2, 1, 0)], orientation=field),
    "line": lambda field: named.PolylineRegion([(0, 0.5), (2, 1)], orientation=field),
}


@pytest.mark.parametrize("first", ORIENTED)
@pytest.mark.parametrize("second", ORIENTED)
def test_what_is_left_of_two_regions_has_the_field_of_the_first_with_any(first: str, second: str) -> None:
    """Section 8: an intersection takes that of the first region, else that of the second; a difference that of the first."""
    f, g = (VectorField(name, lambda place: place.x) for name in "fg")
    for one, two in ((f, g), (f, None), (None, g)):
        a, b = ORIENTED[first](one), ORIENTED[second](two)
        both, left = a.intersect(b), a.difference(b)
        if both is not nowhere:
            assert both.orientation is (f if one else g)
        if left is not nowhere:
            assert left.orientation is one


@pytest.mark.parametrize("first", ORIENTED)
@pytest.mark.parametrize("second", ORIENTED)
def test_unions_of_others_than_regions_of_the_plane_have_no_field(first: str, second: str) -> None:
    f, g = (VectorField(name, lambda place: place.x) for name in "fg")
    both = ORIENTED[first](f).union(ORIENTED[second](g))
    assert both.has_orientation is (first == second == "polygon")
    assert (both.orientation is None) is not both.has_orientation
    part = both.intersect(named.BoxRegion((1, 1, 1), (1, 1, 0)))
    assert isinstance(part, Composite) or part.has_orientation is both.has_orientation


@pytest.mark.parametrize(
    "points", [[(-9, 0.5, 1), (0, 0.5, 1), (0, 9, 1)], [(-9, 0.5, 0), (0, 0.5, 0), (0, 9, 0)]]
)
@pytest.mark.parametrize("kind", [named.PathRegion, named.PolylineRegion])
def test_the_pieces_of_a_line_keep_their_directions(kind: Any, points: list[Any]) -> None:
    if kind is named.PolylineRegion:
        points = [(x, y) for x, y, _ in points]
    z = points[0][2] if len(points[0]) == 3 else 0
    inside = kind(points=points).intersect(named.BoxRegion((2, 2, 4)))
    assert inside.length == pytest.approx(1.5)
    for place, yaw in (((-0.7, 0.5, z), -np.pi / 2), ((0, 0.8, z), 0.0)):
        assert inside.orientation[Vector(*place)].yaw == pytest.approx(yaw)


@pytest.mark.parametrize("height", [0, 2])
def test_an_edge_that_two_polygons_share_has_their_field(height: float) -> None:
    f, g = (VectorField(name, lambda place: place.x) for name in "fg")
    for one, two, expected in ((f, g, f), (f, None, f), (None, g, g)):
        left = named.PolygonalRegion([(0, 0), (1, 0), (1, 1), (0, 1)], z=height, orientation=one)
        right = named.PolygonalRegion([(1, 0), (2, 0), (2, 1), (1, 1)], z=height, orientation=two)
        edge = left.intersect(right)
        assert isinstance(edge, LineRegion)
        assert edge.length == pytest.approx(1)
        assert edge.orientation is expected
        assert (edge.box()[0][0, 2], edge.box()[1][0, 2]) == (height, height)
        beyond = named.PolygonalRegion([(1, 1), (2, 1), (2, 2), (1, 2)], z=height, orientation=two)
        corner = left.intersect(beyond)
        assert corner.points.tolist() == [[1, 1, height]]
        assert corner.orientation is expected


def test_unions_of_a_polygon_and_a_line_hold_both() -> None:
    square = named.PolygonalRegion([(0, 0), (1, 0), (1, 1), (0, 1)])
    line = named.PolylineRegion([(0.5, 0.5), (4, 0.5)])
    for both in (square.union(line), line.union(square)):
        assert both.containsPoint(Vector(0.2, 0.2, 0)) is True
        assert both.containsPoint(Vector(3, 0.5, 0)) is True
        assert both.containsPoint(Vector(3, 0.6, 0)) is False
        assert both.distanceTo(Vector(5, 0.5, 0)) == pytest.approx(1)
        # Of members of unlike dimension points are drawn from the larger ones.
        assert cloud(both)[:, 0].max() <= 1


def test_members_of_the_plane_hold_points_at_their_height_alone() -> None:
    """Also those of members of combinations, whoever is asked."""
    disc, ball = named.CircularRegion(Vector(0, 0, 0), 1), named.SpheroidRegion((2, 2, 2), Vector(9, 0, 0))
    either = UnionRegion(disc, ball)
    both, rest = IntersectionRegion(either, named.BoxRegion((4, 4, 30))), DifferenceRegion(either, ball)
    for region in (disc, either, both, rest, UnionRegion(both, rest)):
        for height, met in ((0, True), (5, False)):
            point = named.PointSetRegion("point", [(0.2, 0.1, height), (40, 40, 40)])
            assert region.intersects(point) is met
            assert point.intersects(region) is met
            assert (point.intersect(region) is not nowhere) is met
            assert len(point.difference(region).points) == 2 - met
            assert region.containsRegion(named.PointSetRegion("one", point.points[:1])) is met
    # What is above and below a disc is left of a box without it.
    left = DifferenceRegion(named.BoxRegion((2, 2, 8)), either)
    assert np.hypot(*cloud(left)[:, :2].T).min() < 0.3


def stretched(more: float) -> dict[str, tuple[Region, Region]]:
    """Regions, and others that stick out of them by so much."""
    square = named.RectangularRegion((1, 2, 3), 0, 4, 2)
    longer = shapely.box(-1, 1, 3 + more, 3)
    solid = named.BoxRegion((4 + more, 2, 1), (1 + more / 2, 2, 7))
    return {
        "disc": (named.CircularRegion((1, 2, 3), 2), named.CircularRegion((1, 2, 3), 2 + more)),
        "rectangle": (square, named.PolygonalRegion(polygon=longer, z=3)),
        "column of a column": (square.footprint, named.PolygonalFootprintRegion(longer)),
        "column of a solid": (square.footprint, solid),
        "column of a polygon": (square.footprint, named.PolygonalRegion(polygon=longer, z=-8)),
        "solid": (named.BoxRegion((4, 2, 2)), named.PathRegion([(-1, 0, 0.5), (2 + more, 0, 0.5)])),
    }


@pytest.mark.parametrize("name", stretched(0))
def test_regions_hold_what_sticks_out_by_less_than_the_tolerance(name: str) -> None:
    for more, tolerance, expected in (
        (0.0, 0.0, True),
        (0.0, 0.1, True),
        (1e-3, 0.0, False),
        (0.05, 0.04, False),
        (0.05, 0.06, True),
    ):
        whole, part = stretched(more)[name]
        assert whole.containsRegion(part, tolerance) is expected


@pytest.mark.parametrize(
    ("points", "met"),
    [
        ([(0, 0, 2), (0, 0, 1)], True),  # up to the plane, or from it
        ([(0, 0, 1), (0.5, 0, -4)], True),
        ([(0, 0, 2), (0, 0, 1.001)], False),
        ([(1, 0, 2), (1, 0, 0)], True),  # through the border
        ([(1.001, 0, 2), (1.001, 0, 0)], False),
        ([(-3, 0, 0), (3, 0, 2)], True),
        ([(-3, 0, 2), (3, 0, -2)], False),  # over the square it is below the plane
        ([(-3, 0, 0), (9, 0, 2)], False),
        ([(-3, 0.5, 1), (3, 0.5, 1)], True),  # level
        ([(0.5, 0.5, 1), (0.5, 5, 1)], True),
        ([(-3, 5, 1), (3, 5, 1)], False),
        ([(-3, 0, 1.001), (3, 0, 1.001)], False),
        ([(9, 9, 9), (9, 9, 1), (0, 0, 1)], True),
        ([(9, 9, 9), (9, 9, 0), (0, 0, 0)], False),
    ],
)
def test_paths_through_a_plane(points: list[Any], met: bool) -> None:
    square = named.RectangularRegion((0, 0, 1), 0, 2, 2)
    path = named.PathRegion(points)
    for one, other in ((path, square), (square, path)):
        assert one.intersects(other) is met


@pytest.mark.parametrize("turn", [Orientation(), TILT])
@pytest.mark.parametrize("solid", ["box", "ball"])
def test_lines_through_edges_and_corners_of_a_solid(solid: str, turn: Orientation) -> None:
    """From every vertex to that opposite to it, through the middles of edges, and where two triangles make a face."""
    mesh = primitives.box() if solid == "box" else primitives.spheroid()
    kind = named.BoxRegion if solid == "box" else named.SpheroidRegion
    size, place = np.array([2.0, 4, 3]), np.array([1.0, -2, 3])
    region = kind(tuple(size), tuple(place), turn)
    pairs = mesh.triangles[:, [0, 1, 2]] + mesh.triangles[:, [1, 2, 0]]
    ways = np.unique(np.concatenate([mesh.vertices, pairs.reshape(-1, 3) / 2]), axis=0)
    if solid == "ball":
        ways = ways[[0, 300]]
    rotation = Rotation.from_quat(turn.q)
    for way in ways * size:
        half = rotation.apply(way)
        path = named.PathRegion([(place - 3 * half).tolist(), (place + 2 * half).tolist()])
        assert path.intersects(region) is True
        inside = path.intersect(region)
        assert isinstance(inside, LineRegion)
        assert inside.length == pytest.approx(2 * np.linalg.norm(half), rel=1e-6)


@pytest.mark.parametrize("scale", [1e-3, 1e-2, 1.0, 1e3])
@pytest.mark.parametrize("solid", ["box", "ball"])
def test_lines_are_cut_alike_at_every_scale(solid: str, scale: float) -> None:
    """Also where segments and faces are some millimetres long."""
    kind = named.BoxRegion if solid == "box" else named.SpheroidRegion
    region = kind((scale, scale, scale), rotation=TILT)
    way = Rotation.from_quat(TILT.q).apply([0, 1, 0]) * scale
    path = named.PathRegion([(share * way).tolist() for share in (-1.2, -0.7, -0.3, 0.2, 0.6, 0.9)])
    inside = path.intersect(region)
    assert isinstance(inside, LineRegion)
    assert inside.length == pytest.approx(scale)
    assert path.difference(region).containsPoint(Vector(*(0.55 * way))) is True
    lower, upper = inside.box()
    np.testing.assert_allclose(np.abs([lower[0], upper[0]]), np.abs([way, way]) / 2, rtol=1e-6)


@pytest.mark.parametrize("side", ["left", "right", "front", "back", "top", "bottom"])
def test_sides_meet_the_columns_that_they_are_in(side: str) -> None:
    """Walls, which have no extent seen from above, as well as floors."""
    item = thing("ego = new Object at (1, 2, 3), with width 2, with length 4, with height 6")
    region = getattr(item, f"{side}Surface")
    lower, upper = np.array(region.AABB)
    for x, y in itertools.product((-0.08, 0.03, 1.2, 1.97), (0.03, 1.7, 3.97, 4.08)):
        column = named.RectangularRegion((x, y), 0, 0.1, 0.1).footprint
        near = bool((np.abs([x, y] - np.clip([x, y], lower[:2], upper[:2])) <= 0.05).all())
        assert region.intersects(column) is near
        assert column.intersects(region) is near
    if side in ("top", "bottom"):
        assert region.boundingPolygon.area == pytest.approx(8)
    else:
        with pytest.raises(InvalidScenarioError, match="no outline"):
            region.boundingPolygon  # noqa: B018 - asking is the test


@pytest.mark.parametrize("operation", ["intersect", "union", "difference", "intersects", "containsRegion"])
def test_what_is_no_region_has_nothing_in_common_with_one(operation: str) -> None:
    with pytest.raises(ScenicTypeError, match=rf"^`{operation}`: expected a region, not .*'wall'"):
        getattr(named.BoxRegion(), operation)("wall")


def test_columns_of_several_parts_keep_them_all() -> None:
    left, right = (named.RectangularRegion((x, 0, 4), 0, 2, 2).footprint for x in (-2, 2))
    wide = named.RectangularRegion((0, 0), 0, 4, 1).footprint
    both = left.union(right)
    for region, area in ((both, 8), (both.intersect(wide), 2), (both.difference(wide), 6)):
        assert isinstance(region, Footprint)
        assert region.polygons.area == pytest.approx(area)
        for x, z in ((-1.5, 4), (1.5, -7)):
            assert region.containsPoint(Vector(x, 0, z)) is (area != 6)
            assert region.containsPoint(Vector(x, 0.8, z)) is (area != 2)
        assert region.containsPoint(Vector(0, 0, 4)) is False


@pytest.mark.parametrize("height", [0, 2])
def test_several_edges_that_polygons_share_look_along_themselves(height: float) -> None:
    plate = named.PolygonalRegion([(0, 0), (4, 0), (4, 3), (0, 3)], z=height)
    around = named.PolygonalRegion(
        polygon=shapely.box(-9, -9, 9, 9).difference(shapely.box(0, 0, 4, 4)), z=height
    )
    for edges in (plate.intersect(around), around.intersect(plate)):
        assert isinstance(edges, LineRegion)
        assert edges.length == pytest.approx(4 + 3 + 3)
        assert (edges.box()[0][0, 2], edges.box()[1][0, 2]) == (height, height)
        for place, along in (((2, 0, height), (1, 0)), ((0, 2, height), (0, 1)), ((4, 1, height), (0, 1))):
            yaw = edges.orientation[Vector(*place)].yaw
            assert abs(-np.sin(yaw) * along[0] + np.cos(yaw) * along[1]) == pytest.approx(1)


def test_a_path_of_several_chains_meets_what_one_of_them_meets() -> None:
    far, near = [(9, 9, 0), (9, 8, 1)], [(-3, 0.5, 7), (3, 0.5, 8)]
    column = named.RectangularRegion((0, 0), 0, 2, 2).footprint
    plate, box = named.RectangularRegion((0, 0, 7.5), 0, 2, 2), named.BoxRegion((2, 2, 2), (0, 0, 7))
    for chains, met in (([far, near], True), ([near, far], True), ([far], False), ([far, far[::-1]], False)):
        path = named.PathRegion(polylines=chains)
        for region in (column, plate, box):
            assert path.intersects(region) is met
            assert region.intersects(path) is met


@pytest.mark.parametrize("height", [-1.5, 0, 1.5])
def test_what_is_left_of_a_disc_without_a_ball_is_outside_it_at_that_height(height: float) -> None:
    """A ball of radius 2, whose cut at 1.5 has a radius of 1.32."""
    rest = named.CircularRegion((0, 0, height), 3).difference(named.SpheroidRegion((4, 4, 4)))
    for x, met in ((0.5, False), (1.6, height != 0), (2.3, True), (3.5, False)):
        spot = named.CircularRegion((x, 0, height), 0.1)
        assert rest.intersects(spot) is met
        assert spot.intersects(rest) is met
    assert rest.intersects(named.CircularRegion((2.3, 0, height + 1), 0.1)) is False


@pytest.mark.parametrize("number", range(4))
def test_each_of_many_members_counts(number: int) -> None:
    """Of a union that only one of four members meets, and of an intersection that only one of four leaves out."""
    places = [(0, 0, 0), (5, 0, 0), (0, 5, 0), (0, 0, 5)]
    parts: list[Region] = [named.BoxRegion((2, 2, 2), place) for place in places]
    parts[1] = named.SpheroidRegion((2, 2, 2), places[1])
    union = UnionRegion(*parts)
    place = Vector(*places[number])
    spot, item = (
        named.BoxRegion((0.5, 0.5, 0.5), place),
        thing(f"ego = new Object at {places[number]}, with width 0.5, with length 0.5, with height 0.5"),
    )
    for other in (spot, item.occupiedSpace, named.PointSetRegion("p", [place])):
        assert union.intersects(other) is other.intersects(union) is True
    assert union.containsPoint(place) is union.containsObject(item) is True
    assert union.distanceTo(place + Vector(1.5, 0, 0)) == pytest.approx(0.5)
    assert distances(parts[number], cloud(union)).min() < 1e-9
    assert [union.AABB[side][axis] for side in (0, 1) for axis in range(3)] == [-1, -1, -1, 6, 6, 6]
    # What one of the members misses is not in all of them.
    wide: list[Region] = [named.SpheroidRegion((9, 9, 9)), *(named.BoxRegion((9, 9, 9)) for _ in range(3))]
    wide[number] = named.BoxRegion((9, 9, 9), (6, 0, 0))
    common = IntersectionRegion(*wide)
    for x, held in ((0, False), (3, True)):
        probe = named.BoxRegion((0.5, 0.5, 0.5), (x, 0, 0))
        assert common.intersects(probe) is probe.intersects(common) is held
        assert common.containsPoint(Vector(x, 0, 0)) is held
        assert common.footprint.containsPoint(Vector(x, 0, 0)) is held
    assert cloud(common)[:, 0].min() >= 1.5


@pytest.mark.parametrize("kind", [named.PathRegion, named.PolylineRegion])
def test_a_solid_holds_a_line_in_it_whatever_rounding_makes_of_its_pieces(kind: Any) -> None:
    box = named.BoxRegion((6, 6, 6), (0.1, 0.2, 0.3), TILT)
    for seed in range(12):
        points = np.random.default_rng(seed).uniform(-1.5, 1.5, (9, 3))
        points[:, 2] *= kind is named.PathRegion
        line = kind(points.tolist())
        assert box.containsRegion(line) is True
        longer = kind([*points.tolist(), [9, 9, 0]])
        assert box.containsRegion(longer) is False


@pytest.mark.parametrize("turn", [Orientation(), TILT])
def test_a_solid_holds_itself_however_it_is_made(turn: Orientation) -> None:
    box = named.BoxRegion((1.1, 2.3, 3.7), (0.1, 0.2, 0.3), turn)
    unit = trimesh.creation.box()
    same = named.MeshVolumeRegion(unit, (1.1, 2.3, 3.7), (0.1, 0.2, 0.3), turn)
    larger = named.MeshVolumeRegion(unit, (1.1, 2.3, 3.71), (0.1, 0.2, 0.3), turn)
    for one, other in itertools.product((box, same), repeat=2):
        assert one.containsRegion(other) is True
        assert larger.containsRegion(other) is True
    for one in (box, same):
        assert one.containsRegion(larger) is False


@pytest.mark.parametrize("yaw", [0.3, 0.7, 1.1, 2.0])
def test_rounding_leaves_nothing_of_a_solid_without_the_same_one(yaw: float) -> None:
    """A box that is given by its other side, and one that is put together of two halves."""
    place, turn = Vector(0.1, 0.2, 0.3), Orientation.fromEuler(yaw, 0, 0)
    box = named.BoxRegion((1.1, 2.3, 3.7), place, turn)
    aside = named.BoxRegion((2.3, 1.1, 3.7), place, Orientation.fromEuler(yaw + np.pi / 2, 0, 0))
    low, high = (
        named.BoxRegion((1.1, 2.3, 1.85), place + Vector(0, 0, part).rotatedBy(turn), turn)
        for part in (-0.925, 0.925)
    )
    for one, other in itertools.permutations((box, aside, low.union(high)), 2):
        assert one.containsRegion(other) is True
    assert low.containsRegion(box) is high.containsRegion(box) is False
