"""The first of many polygons that holds a point, beside asking each."""

import numpy as np
import shapely
from hypothesis import given, settings
from hypothesis import strategies as st

from scenic.runtime.geometry.flat.cell_index import CellIndex

grid = st.integers(-4, 4).map(lambda number: number / 2)
boxes = st.builds(
    lambda x, y, w, h: shapely.box(x, y, x + w, y + h),
    grid,
    grid,
    st.sampled_from([0.5, 1, 6]),
    st.sampled_from([0.25, 1, 6]),
)
triangles = st.tuples(grid, grid, grid, grid).map(
    lambda n: shapely.Polygon([(n[0], n[1]), (n[2], n[1]), (n[2], n[3])])
)


@settings(max_examples=60)
@given(st.lists(boxes | triangles, min_size=1, max_size=12))
def test_it_is_the_first_that_holds_the_point(polygons: list[shapely.Polygon]) -> None:
    x, y = (part.ravel() for part in np.meshgrid(np.arange(-6, 9, 0.5), np.arange(-6, 9, 0.5)))
    x, y = np.append(x, np.nan), np.append(y, 0)
    index = CellIndex(polygons)
    found = index.first_at(x, y)
    assert [index.first_of(*place) for place in zip(x.tolist(), y.tolist(), strict=True)] == found.tolist()
    held = np.array([shapely.intersects_xy(polygon, x, y) for polygon in polygons])
    expected = np.where(held.any(axis=0), held.argmax(axis=0), len(polygons))
    assert (found == expected).all()


def test_none_and_empty_polygons() -> None:
    x = np.zeros(2)
    assert CellIndex([]).first_at(x, x).tolist() == [0, 0]
    assert CellIndex([]).first_of(0.0, 0.0) == 0
    assert CellIndex([shapely.Polygon(), shapely.box(0, 0, 1, 1)]).first_at(x, x).tolist() == [1, 1]
