"""Boxes, outlines and sizes of regions of the plane, turned, at some height, and with one parameter random at a time."""

import math
from typing import Any

import numpy as np
import pytest
import scenic.core.regions as named
import shapely
from scipy.spatial.transform import Rotation

from scenic.language.errors import ScenicTypeError
from scenic.runtime.geometry.meshes import primitives
from scenic.runtime.geometry.meshes.bodies import Body
from scenic.runtime.geometry.poses import Floats, Poses
from scenic.runtime.regions.base import Region
from scenic.runtime.regions.choice import RegionChoice
from scenic.runtime.regions.circular import DISC_POINT
from scenic.runtime.regions.combinations import IntersectionRegion
from scenic.runtime.regions.spaces import Workspace
from scenic.runtime.values.values import Vector
from tests.runtime.programs import draws, params, thing

PLACE = Vector(1, -2, 3)


def arc(radius: float, heading: float, angle: float) -> Floats:
    """Points of a sector: its centre, and many of its arc."""
    ways = heading + np.linspace(-angle / 2, angle / 2, 20_001)
    points = np.column_stack([-radius * np.sin(ways), radius * np.cos(ways)])
    return np.vstack([points, np.zeros(2)]) + np.array([PLACE.x, PLACE.y])


def rectangle(width: float, length: float, heading: float) -> Floats:
    corners = np.array([(x, y, 0) for x in (-width / 2, width / 2) for y in (-length / 2, length / 2)])
    turned: Floats = Rotation.from_euler("z", heading).apply(corners)[:, :2] + [PLACE.x, PLACE.y]
    return turned


SECTORS = [
    (2.0, 0.3, 0.5),
    (1.5, -2.8, 1.4),
    (2.0, 0.9, 4.0),
    (3.0, 1.0, 6.0),
    (1.0, 3.0, 7.0),
    (2.0, -1.6, 3.3),
]
SHAPES: dict[str, tuple[Region, Floats]] = {
    "disc": (named.CircularRegion(PLACE, 1.25), arc(1.25, 0, 2 * math.pi)),
    "rectangle": (named.RectangularRegion(PLACE, 0.6, 5, 2), rectangle(5, 2, 0.6)),
    "polygon": (
        named.PolygonalRegion([(0, 0), (4, 1), (1, 5)], z=3),
        np.array([(0, 0), (4, 1), (1, 5)], dtype=float),
    ),
    **{
        f"sector {number}": (named.SectorRegion(PLACE, *values), arc(*values))
        for number, values in enumerate(SECTORS)
    },
}


@pytest.mark.parametrize("name", SHAPES)
def test_boxes_and_outlines(name: str) -> None:
    region, points = SHAPES[name]
    flat: Any = region
    low, high = np.array(region.AABB)
    np.testing.assert_allclose(low, [*points.min(axis=0), 3], atol=1e-6)
    np.testing.assert_allclose(high, [*points.max(axis=0), 3], atol=1e-6)
    covered = flat.polygons
    whole = (
        shapely.MultiPoint(points).convex_hull if "sector" not in name else shapely.Polygon(points).buffer(0)
    )
    if whole.area > 0 and name != "sector 4":  # whose ends overlap
        assert covered.symmetric_difference(whole).area < 3e-3 * whole.area
        assert flat.area == pytest.approx(whole.area, rel=1e-5)
    assert shapely.distance(covered, shapely.points(points)).max() < 2e-3
    (x, y, z), radius = tuple(flat.circumcircle[0]), float(flat.circumcircle[1])
    far = np.hypot(*(points - [x, y]).T).max()
    assert z == 3
    assert far <= radius + 1e-6
    assert flat.footprint.containsPoint(Vector(x, y, 99)) == region.containsPoint(Vector(x, y, 3))


@pytest.mark.parametrize("number", range(len(SECTORS)))
def test_sectors_hold_their_centre_and_both_ends(number: int) -> None:
    radius, heading, angle = SECTORS[number]
    region = named.SectorRegion(PLACE, radius, heading, angle)
    assert region.containsPoint(PLACE) is True or bool(region.containsPoint(PLACE))
    for side in (-1, 1):
        for off, held in ((-1e-6, True), (1e-6, angle >= 2 * math.pi)):
            way = heading + side * (angle / 2 + off)
            point = Vector(PLACE.x - 0.9 * radius * math.sin(way), PLACE.y + 0.9 * radius * math.cos(way), 3)
            assert bool(region.containsPoint(point)) is held
    assert region.size == pytest.approx(min(angle, 2 * math.pi) / 2 * radius**2)


def test_rectangles_in_numbers() -> None:
    region = named.RectangularRegion(PLACE, 0.6, 5, 2)
    assert (region.hw, region.hl, region.inradius) == (2.5, 1, 1)
    assert named.RectangularRegion(PLACE, 0.6, 2, 5).inradius == 1
    assert region.radius == pytest.approx(math.hypot(2.5, 1))
    turned = Rotation.from_euler("z", 0.6).apply([(2.5, 1, 0), (-2.5, 1, 0), (-2.5, -1, 0), (2.5, -1, 0)])
    np.testing.assert_allclose(np.array(region.corners), turned + tuple(PLACE), atol=1e-12)


@pytest.mark.parametrize("text", ["0.6", "Range(0.6, 0.7)", "0"])
def test_points_of_turned_rectangles(text: str) -> None:
    """They fill it to its corners, in its frame."""
    program = f"h = {text}\nregion = RectangularRegion((1, -2, 3), h, 5, 2)\np = new Point in region\nparam x = (h, *p.position)\n"
    found = np.array(draws(program, n=600), dtype=float)
    local = np.array(
        [Rotation.from_euler("z", -heading).apply([x - 1, y + 2, z - 3]) for heading, x, y, z in found]
    )
    assert (np.abs(local) <= np.array([2.5, 1, 0]) + 1e-9).all()
    assert (np.abs(local).max(axis=0)[:2] > np.array([2.3, 0.92])).all()
    assert abs(np.corrcoef(local[:, 0], local[:, 1])[0, 1]) < 0.2


def boxes(places: Floats) -> Body:
    return Body(
        (primitives.box(),),
        None,
        Poses(places, np.tile([0.0, 0, 0, 1], (len(places), 1)), np.full((1, 3), 0.2)),
    )


@pytest.mark.parametrize(
    ("region", "columns"),
    [
        (named.RectangularRegion(PLACE, 0.6, 5, 2), ([(1, -2, 3)], [0.6], [5, 4, 3, 5], [2])),
        (named.RectangularRegion(PLACE, 0.6, 5, 2), ([(1, -2, 3)], [0.6, 0.1, 0.6, 2], [5], [2])),
        (named.SectorRegion(PLACE, 3, 0.6, 2), ([(1, -2, 3)], [3, 2, 3, 4], [0.6], [2])),
        (named.SectorRegion(PLACE, 3, 0.6, 2), ([(1, -2, 3)], [3], [0.6, 3, 0.6, 0], [2, 1, 2, 3])),
        (named.CircularRegion(PLACE, 3), ([(1, -2, 3)], [3, 2, 1, 2.5])),
    ],
)
def test_bodies_in_regions_that_differ_from_lane_to_lane(region: Region, columns: Any) -> None:
    arrays = [np.array(column, dtype=float) for column in columns]
    places = np.array([(1, -1, 3), (1, 0.1, 3), (2.6, -1, 3), (0.2, 0.2, 3)], dtype=float)
    together = region.contains_bodies(boxes(places), 4, *arrays)
    # One body for all lanes, and each with its own.
    for body, wanted in ((boxes(places[:1]), np.repeat(places[:1], 4, axis=0)), (boxes(places), places)):
        found = np.broadcast_to(region.contains_bodies(body, 4, *arrays), 4)
        for lane in range(4):
            mine = [array if len(array) == 1 else array[[lane]] for array in arrays]
            alone = region.contains_bodies(boxes(wanted[[lane]]), 1, *mine)
            assert found[lane] == alone[0]
    assert 0 < np.sum(together) < 4


def test_a_sector_is_as_round_as_its_resolution_says() -> None:
    for angle in (1.0, 4.0, 6.2):
        region: Any = named.SectorRegion(PLACE, 2, 0.3, angle, resolution=16)
        missing = angle / 2 * 4 - region.polygons.area
        # A step of the arc takes at most a quarter turn over the resolution.
        step = math.pi / 2 / 16
        assert 0 < missing <= angle / step * 2 * (step - math.sin(step)) * 1.2


def test_bounds_of_points_of_a_disc_are_on_both_sides() -> None:
    from scenic.graph.bounds import Bounds

    assert DISC_POINT.bounds is not None
    half = Bounds(np.array([0.0]), np.array([0.25]))
    found = DISC_POINT.bounds(None, half, Bounds(np.array([0.0]), np.array([1.0])))
    np.testing.assert_allclose(found.lower[0], [-0.5, -0.5, 0], atol=1e-12)
    np.testing.assert_allclose(found.upper[0], [0.5, 0.5, 0], atol=1e-12)
    assert found.lower[0, 0] <= -0.5
    assert found.upper[0, 0] >= 0.5


# Workspaces, and what is not known


FIELD = "f = VectorField('f', lambda p: 1.2)\nr = PolygonalRegion([(-9, -9), (9, -9), (9, 9), (-9, 9)], orientation=f)\n"


def test_workspaces_orient_as_the_region_that_they_are_made_of() -> None:
    for region in ("r", "Workspace(r)", "Workspace(Workspace(r))"):
        text = f"{FIELD}workspace = Workspace(r)\nplace = {region}\nego = new Object in place\n"
        assert thing(text).heading == pytest.approx(1.2)
        assert thing(f"{FIELD}ego = new Object on {region}\n").heading == pytest.approx(1.2)


def test_workspaces_measure_and_combine_as_their_region() -> None:
    disc = named.CircularRegion(PLACE, 2)
    room = Workspace(disc)
    assert room.size == disc.size
    assert room.AABB == disc.AABB
    assert room.dimensionality == 2
    assert type(room.footprint) is type(disc.footprint)
    assert room.footprint.containsPoint(Vector(1, -2, 50))
    box = named.BoxRegion((2, 2, 2), PLACE)
    assert type(room.intersect(box)) is type(disc.intersect(box))
    assert room.intersects(box) is True
    assert room.containsRegion(named.CircularRegion(PLACE, 1)) is True


def test_what_may_find_no_point_may_not_in_a_workspace_either() -> None:
    side = thing("ego = new Object").topSurface
    assert side.may_find_none
    assert Workspace(side).may_find_none
    assert RegionChoice(0, [named.BoxRegion(), Workspace(side)]).may_find_none
    assert not RegionChoice(0, [named.BoxRegion(), Workspace(named.BoxRegion())]).may_find_none


def test_sizes_that_are_not_known() -> None:
    common = IntersectionRegion(named.CircularRegion(PLACE, 2), named.BoxRegion((9, 9, 9)))
    assert common.size is None
    with pytest.raises(ScenicTypeError):
        params("r = CircularRegion((0, 0), Range(1, 2))\nparam x = r.size\n")
