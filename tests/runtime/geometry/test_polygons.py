import numpy as np
import pytest
import shapely
from scipy.stats import chi2

from scenic.runtime.geometry.polygons import Polygons

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
