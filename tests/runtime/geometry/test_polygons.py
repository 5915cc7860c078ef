import numpy as np
import pytest
import shapely
from scipy.stats import chi2

from scenic.runtime.geometry.flat.polygons import Polygons

HOLED = shapely.Polygon(
    [(0, 0), (4, 0), (4, 3), (2, 1.5), (0, 3)], [[(1, 0.5), (1.5, 0.5), (1.5, 1), (1, 1)]]
)
SEVERAL = shapely.MultiPolygon([HOLED, shapely.box(10, 10, 11, 10.5)])


@pytest.mark.parametrize("polygon", [HOLED, SEVERAL, shapely.box(0, 0, 1, 2)])
def test_points_are_uniform(polygon):
    polygons = Polygons(polygon)
    x, y = polygons.sample(*np.random.default_rng(70).random((3, 40_000))).T
    assert polygons.polygon.buffer(1e-12).contains(shapely.points(x, y)).all()
    minx, miny, maxx, maxy = polygon.bounds
    cells = [
        shapely.box(
            minx + i * (maxx - minx) / 8,
            miny + j * (maxy - miny) / 8,
            minx + (i + 1) * (maxx - minx) / 8,
            miny + (j + 1) * (maxy - miny) / 8,
        )
        for i in range(8)
        for j in range(8)
    ]
    wanted = np.array([cell.intersection(polygon).area for cell in cells]) / polygon.area * 40_000
    column = np.minimum((x - minx) / (maxx - minx) * 8, 7).astype(int)
    row = np.minimum((y - miny) / (maxy - miny) * 8, 7).astype(int)
    seen = np.bincount(column * 8 + row, minlength=64)
    used = wanted > 5
    statistic = ((seen - wanted)[used] ** 2 / wanted[used]).sum()
    assert chi2.sf(statistic, used.sum() - 1) > 1e-6


def test_contains():
    polygons = Polygons(HOLED)
    x = np.array([2, 1.25, 0, 1, 2, 5, 2])
    y = np.array([0.2, 0.75, 0, 0.75, 1.5, 1, 2])
    np.testing.assert_array_equal(polygons.contains(x, y), [True, False, True, True, True, False, False])


@pytest.mark.parametrize("polygon", [HOLED, SEVERAL, shapely.box(0, 0, 4, 3)])
def test_one_point_or_disc_is_held_as_many_are(polygon):
    """Also on corners and edges, and of polygons that were asked before."""
    polygons = Polygons(polygon)
    corners = shapely.get_coordinates(polygon)
    rng = np.random.default_rng(71)
    places = np.concatenate([corners, (corners[1:] + corners[:-1]) / 2, rng.uniform(-1, 12, (60, 2))])
    radii = np.where(np.arange(len(places)) % 3, rng.uniform(0, 1, len(places)), 1e-3)
    for _ in range(2):
        one = [polygons.holds_point(x, y) for x, y in places.tolist()]
        discs = [polygons.holds_disc(*place, radius) for place, radius in zip(places, radii, strict=True)]
        np.testing.assert_array_equal(polygons.contains(*places.T), one)
        np.testing.assert_array_equal(polygons.holds_discs(*places.T, radii), discs)
    assert all(one[: len(corners)])
    expected = [
        polygon.contains(shapely.Point(place).buffer(r)) for place, r in zip(places, radii, strict=True)
    ]
    np.testing.assert_array_equal(discs, expected)


def test_what_sticks_out_by_rounding_is_held_nearly():
    """As far at corners as along edges; inside a hole it is the same."""
    square = Polygons(shapely.box(0, 0, 4, 3).difference(shapely.box(1, 1, 2, 2)))
    outwards = np.array([(-1, 0), (0, -1), (-1, -1)])
    for corner, sign in (((0, 0), 1), ((4, 3), -1), ((1, 1), -1), ((2, 2), 1)):
        for off, held in ((0.9e-9, True), (-0.9e-9, True), (1.1e-9, False)):
            if corner in ((1, 1), (2, 2)) and off > 1e-9:
                places = np.array(corner) + sign * off * outwards[2:]  # beside a notch, not beyond its corner
            else:
                places = np.array(corner) + sign * off * outwards
            assert (square.nearly_contains(*places.T) == held).all(), (corner, off)
            triangles = np.stack(
                [places, *[np.broadcast_to(p, places.shape) for p in ((0.5, 2.5), (0.5, 2.7))]], axis=1
            )
            if sign == 1 and corner == (0, 0):
                assert square.covers_triangles(triangles) == held
                np.testing.assert_array_equal(square.covers_hulls(triangles), [held] * 3)


def test_convex_corners():
    clockwise = [(0, 0), (0, 1), (1, 1), (1, 0)]
    np.testing.assert_array_equal(
        Polygons.of_points(clockwise).convex_corners,
        shapely.orient_polygons(shapely.Polygon(clockwise)).exterior.coords[:-1],
    )
    assert Polygons(HOLED).convex_corners is None
    assert Polygons(SEVERAL).convex_corners is None
    assert Polygons.of_points([(0, 0), (2, 0), (1, 0.5), (2, 2)]).convex_corners is None


def test_area_and_union():
    assert Polygons(SEVERAL).area == pytest.approx(HOLED.area + 0.5)
    joined = Polygons.union([Polygons(shapely.box(0, 0, 1, 1)), Polygons(shapely.box(1.1, 0, 2, 1))], 0.1)
    assert joined.polygon.geom_type == "Polygon"
    assert joined.area == pytest.approx(2, rel=1e-3)


@pytest.mark.parametrize(
    ("polygon", "message"),
    [
        (shapely.Polygon(), "empty"),
        (shapely.Polygon([(0, 0), (1, 1), (1, 0), (0, 1)]), "not valid: Self-intersection"),
        (shapely.Point(0, 0), "not a value of type `Point`"),
        ("square", "not a value of type `str`"),
        (shapely.Polygon([(0, 0), (1, 1), (2, 2)]), "empty|not valid"),
    ],
)
def test_bad_polygons(polygon, message):
    with pytest.raises(ValueError, match=message):
        Polygons(polygon)


def test_too_few_points():
    with pytest.raises(ValueError, match="at least three points, not 2"):
        Polygons.of_points([(0, 0), (1, 1)])


def test_height_is_dropped():
    assert not Polygons(shapely.Polygon([(0, 0, 5), (1, 0, 5), (0, 1, 5)])).polygon.has_z


@pytest.mark.parametrize("polygon", [HOLED, SEVERAL])
def test_distances_and_limits_agree_with_those_of_shapely(polygon):
    polygons, rng = Polygons(polygon), np.random.default_rng(71)
    x, y = rng.uniform(-2, 13, (2, 3_000))
    corners = shapely.get_coordinates(polygon)  # on the edge, the distance is 0
    x, y = np.append(x, corners[:, 0]), np.append(y, corners[:, 1])
    expected = shapely.distance(polygon, shapely.points(x, y))
    assert (polygons.distances(x, y) == expected).all()
    assert [
        polygons.distance(*place) for place in zip(x.tolist(), y.tolist(), strict=True)
    ] == expected.tolist()
    limits = np.append(rng.uniform(0, 5, 3_000), np.zeros(len(corners)))
    assert (polygons.lie_farther(x, y, limits) == (expected > limits)).all()
