"""Nearest points of regions, parts of lines, and the way along a field."""

import math

import pytest
import shapely

from scenic.language.errors import ScenicValueError
from scenic.runtime.regions.circular import CircularRegion
from scenic.runtime.regions.fields import VectorField
from scenic.runtime.regions.lines import PathRegion, PolylineRegion
from scenic.runtime.regions.planar import PolygonalRegion
from scenic.runtime.regions.rectangular import RectangularRegion
from scenic.runtime.regions.scattered import PointSetRegion
from scenic.runtime.regions.volumes import BoxRegion, SpheroidRegion
from scenic.runtime.values.values import Vector, to_vector

LINE = PolylineRegion([(0, 0), (4, 0), (4, 4)])


@pytest.mark.parametrize(
    ("region", "point", "nearest"),
    [
        (CircularRegion((0, 0, 2), 1), (3, 0, 5), (1, 0, 2)),
        (CircularRegion((0, 0, 2), 1), (0.5, 0, 5), (0.5, 0, 2)),
        (RectangularRegion((0, 0), 0, 2, 4), (5, 1), (1, 1, 0)),
        (PolygonalRegion([(0, 0), (2, 0), (2, 2), (0, 2)], z=1), (3, 3, 0), (2, 2, 1)),
        (BoxRegion(dimensions=(2, 2, 2)), (5, 0, 0.5), (1, 0, 0.5)),
        (SpheroidRegion(dimensions=(2, 2, 2)), (0, 0, 5), (0, 0, 1)),
        (LINE, (2, 3), (4, 3, 0)),
        (PathRegion([(0, 0, 0), (0, 0, 4)]), (1, 0, 3), (0, 0, 3)),
        (PointSetRegion("p", [(0, 0, 0), (5, 5, 5)]), (4, 4, 4), (5, 5, 5)),
    ],
)
def test_the_nearest_point(region: object, point: object, nearest: tuple[float, ...]) -> None:
    found = region.closestPointTo(point)  # type: ignore[attr-defined]
    assert tuple(found) == pytest.approx(nearest)


def test_parts_of_lines() -> None:
    assert LINE.midpoint == Vector(4, 0, 0)
    assert LINE.reverse().points == ((4, 4, 0), (4, 0, 0), (0, 0, 0))
    assert abs(LINE.reverse().orientation[Vector(4, 2, 0)].yaw) == pytest.approx(math.pi)
    assert LINE.substring(1, 5).points == ((1, 0, 0), (4, 0, 0), (4, 1, 0))
    assert LINE.substring(0.5, 1, normalized=True).points == ((4, 0, 0), (4, 4, 0))
    with pytest.raises(ScenicValueError, match="no part"):
        LINE.substring(2, 2)


def test_the_way_along_a_field() -> None:
    field = VectorField("f", lambda place: place.x / 4)
    places = field.followFromTrajectory((1, 2), 20, stepSize=4)
    assert len(places) == 6
    assert tuple(places[-1]) == pytest.approx(tuple(field.followFrom((1, 2), 20, stepSize=4)))


def test_points_of_shapely_are_vectors() -> None:
    assert to_vector(shapely.Point(1, 2)) == Vector(1, 2, 0)
    assert to_vector(shapely.Point(1, 2, 3)) == Vector(1, 2, 3)
