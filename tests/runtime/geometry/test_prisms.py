"""Prisms, cuts and shadows against shapely's areas and exact Booleans."""

import numpy as np
import pytest
import shapely
from scipy.spatial.transform import Rotation

from scenic.runtime.geometry.meshes import primitives
from scenic.runtime.geometry.meshes.inside import contains_points
from scenic.runtime.geometry.meshes.mesh import Mesh
from scenic.runtime.geometry.meshes.prisms import prism, shadow, slice_at

from .samples import SHAPES, bumpy, hollow, placed, table

RING = shapely.Polygon(
    [(0, 0), (6, 0), (6, 5), (0, 5)], [[(1, 1), (2, 1), (2, 3), (1, 3)], [(3, 1), (5, 1), (4, 4)]]
)
POLYGONS = {
    "triangle": shapely.Polygon([(0, 0), (0, 2), (3, 1)]),  # clockwise
    "notched": shapely.Polygon([(0, 0), (4, 0), (4, 3), (2, 1), (0, 3)]),
    "ring": RING,
    "two": shapely.MultiPolygon([RING, shapely.box(7, -1, 8, 2)]),
    "three": shapely.MultiPolygon(
        [shapely.box(0, 0, 1, 1), shapely.box(2, 0, 3, 1), shapely.box(0, 2, 3, 4).difference(RING)]
    ),
    "in a hole": RING.union(shapely.box(1.25, 1.5, 1.75, 2.5)),
}


@pytest.mark.parametrize("name", POLYGONS)
def test_prisms_are_solids_over_their_polygons(name: str) -> None:
    polygon, (low, high) = POLYGONS[name], (-0.5, 1.25)
    solid = prism(polygon, low, high)
    assert solid is not None
    assert solid.is_volume
    assert solid.volume == pytest.approx(polygon.area * (high - low), rel=1e-9)
    assert solid.bounds[:, 2].tolist() == [low, high]
    points = np.random.default_rng(1).uniform([-1, -2, -1], [9, 6, 2], (3000, 3))
    inside = shapely.contains_xy(polygon, points[:, 0], points[:, 1])
    inside &= (low < points[:, 2]) & (points[:, 2] < high)
    np.testing.assert_array_equal(contains_points(solid, points), inside)
    for height, part in ((low, polygon), (0.3, polygon), (high, polygon), (1.3, None), (-0.6, None)):
        found = slice_at(solid, height)
        assert found.symmetric_difference(shapely.Polygon() if part is None else part).area < 1e-6
    assert shadow(solid).symmetric_difference(polygon).area < 1e-9


def test_nothing_stands_over_what_has_no_area() -> None:
    assert prism(shapely.Polygon(), 0, 1) is None
    assert prism(shapely.LineString([(0, 0), (1, 1)]), 0, 1) is None
    mixed = shapely.GeometryCollection([shapely.Point(5, 5), shapely.box(0, 0, 2, 1)])
    solid = prism(mixed, 0, 3)
    assert solid is not None
    assert solid.volume == pytest.approx(6)


def moved(mesh: Mesh, size: tuple[float, float, float], angles: tuple[float, float, float]) -> Mesh:
    turned = Rotation.from_euler("zxy", angles).apply(mesh.vertices * size)
    return Mesh(turned + np.array([0.3, -1, 2]), mesh.faces)


@pytest.mark.parametrize("name", SHAPES)
@pytest.mark.parametrize("angles", [(0.0, 0.0, 0.0), (0.4, 0.0, 0.0), (0.4, 0.7, -0.3)])
def test_cuts_and_shadows_of_solids(name: str, angles: tuple[float, float, float]) -> None:
    """A cut holds the points of the plane in the solid, a shadow those below or above a point of the solid."""
    solid = moved(SHAPES[name](), (2, 1.5, 1.2), angles)
    low, high = solid.bounds
    x, y = (grid.ravel() for grid in np.meshgrid(*np.linspace(low[:2] - 0.1, high[:2] + 0.1, 41).T))
    heights = np.linspace(low[2], high[2], 43)[1:-1]
    held = np.zeros(len(x), dtype=bool)
    for number, height in enumerate(heights.tolist()):
        inside = contains_points(solid, np.stack([x, y, np.full_like(x, height)], axis=1))
        held |= inside
        if number % 10 == 3:
            cut = slice_at(solid, height)
            beside = shapely.distance(cut.boundary, shapely.points(x, y)) > 1e-6
            assert (shapely.contains_xy(cut, x, y) == inside)[beside].all()
    seen = shadow(solid)
    assert shapely.contains_xy(seen.buffer(1e-6), x, y)[held].all()
    # What is in the shadow is held at some height, but for what is thinner than the steps.
    inner = seen.buffer(-0.06)
    assert held[shapely.contains_xy(inner, x, y)].all()
    if solid.is_convex:
        hull = shapely.MultiPoint(solid.vertices[:, :2]).convex_hull
        assert seen.symmetric_difference(hull).area < 1e-9


def test_cuts_at_faces_and_beside_the_solid() -> None:
    body = placed(table(), (0, 0, 1), (2, 3, 4))  # from -1 to 3, its top from 2.6
    for height, area in ((3.0, 6.0), (-1.0, 4 * 0.2 * 0.3), (0.0, 4 * 0.2 * 0.3), (2.8, 6.0)):
        assert slice_at(body, height).area == pytest.approx(area, rel=1e-6)
    for height in (3.001, -1.001, 50.0):
        assert slice_at(body, height).is_empty
    cone = primitives.cone()
    for height in (-0.5, -0.2, 0.3):
        assert slice_at(cone, height).area == pytest.approx((0.5 - height) ** 2 * shadow(cone).area, rel=1e-6)
    assert slice_at(hollow(), 0.1).area == pytest.approx(0.75)
    assert len(slice_at(hollow(), 0.1).interiors) == 1
    assert slice_at(bumpy(2), 0.4999).area < 0.02
