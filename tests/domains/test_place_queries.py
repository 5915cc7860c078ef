"""Questions about places along a way: always the answer that geometry gives."""

import math
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest
import shapely
import shapely.affinity
from hypothesis import given, settings
from hypothesis import strategies as st

from scenic.domains.driving.followed_lines import FollowedLine
from scenic.domains.driving.place_queries import InsideWatch, Nearness
from scenic.domains.driving.roads import Network
from scenic.runtime.shapes.shapes import BoxShape
from scenic.runtime.values.values import Vector
from tests.maps import cross

STEPS = st.lists(st.tuples(st.floats(-3, 3), st.floats(-3, 3)), min_size=1, max_size=60)


@pytest.fixture(scope="module")
def crossing(tmp_path_factory: pytest.TempPathFactory) -> Network:
    path = tmp_path_factory.mktemp("watching") / "cross.xodr"
    path.write_text(cross(arm=60, half=15))
    return Network.fromFile(path)


def walked(steps: list[tuple[float, float]], start: tuple[float, float]) -> list[tuple[float, float]]:
    ways = np.cumsum([start, *steps], axis=0)
    return [(float(x), float(y)) for x, y in ways]


@settings(max_examples=60, deadline=None)
@given(STEPS, st.sampled_from([0.0, 1e-9, 3.0, 10.0]))
def test_nearness_is_that_of_the_polygon(crossing: Network, steps: list[Any], limit: float) -> None:
    [intersection] = crossing.intersections
    watch, point_watch = Nearness(intersection), Nearness(Vector(20, 0, 0))
    for x, y in walked(steps, (22.0, -1.75)):
        away = intersection.polygon.distance(shapely.Point(x, y))
        assert watch.closer_than(limit, (x, y, 0)) == (away < limit)
        assert point_watch.closer_than(limit, (x, y, 0)) == (math.hypot(x - 20, y) < limit)


@settings(max_examples=60, deadline=None)
@given(STEPS, st.floats(-math.pi, math.pi), st.floats(0.5, 6))
def test_being_inside_is_that_of_the_whole_outline(
    crossing: Network, steps: list[Any], heading: float, length: float
) -> None:
    [intersection] = crossing.intersections
    agent = SimpleNamespace(
        roadNetwork=crossing, width=2.0, length=length, heading=heading, shape=BoxShape(), position=None
    )
    inside = InsideWatch(agent)
    polygon = intersection.polygon
    for x, y in walked(steps, (14.0, -1.75)):
        agent.position = Vector(x, y, 0)
        outline = shapely.affinity.translate(
            shapely.affinity.rotate(
                shapely.box(-1, -length / 2, 1, length / 2), heading, (0, 0), use_radians=True
            ),
            x,
            y,
        )
        if abs(polygon.boundary.distance(outline)) > 1e-9 or not polygon.contains(outline):
            assert inside() == polygon.covers(outline)


def test_the_way_to_a_line_counts_for_nothing() -> None:
    line = FollowedLine(SimpleNamespace(points=[(0, 0, 0.0), (30, 40, 0.0), (30, 60, 0.0)]))
    for along, aside in ((-20, 1.5), (-20, -1.5), (-0.1, 0)):
        place = (0.6 * along - 0.8 * aside, 0.8 * along + 0.6 * aside, 0.0)
        assert line.signed_distance(place) == pytest.approx(aside)
        assert line.progress == 0
    assert line.signed_distance((28, 75, 0.0)) == pytest.approx(2)


@settings(max_examples=60, deadline=None)
@given(st.lists(st.floats(-1, 1), min_size=2, max_size=80), st.floats(-4, 4))
def test_signed_distances_along_a_way(turns: list[float], aside: float) -> None:
    headings = np.cumsum(turns) * 0.15
    points = np.concatenate(
        [[[0.0, 0.0]], np.cumsum(np.column_stack((np.cos(headings), np.sin(headings))) * 5, axis=0)]
    )
    line = FollowedLine(SimpleNamespace(points=[(x, y, 0.0) for x, y in points]))
    whole = shapely.LineString(points)
    for share in np.linspace(0, 0.98, 60):
        along = share * whole.length
        here, ahead = whole.interpolate(along), whole.interpolate(min(along + 0.1, whole.length))
        way = math.atan2(ahead.y - here.y, ahead.x - here.x)
        x, y = here.x - aside * math.sin(way), here.y + aside * math.cos(way)
        found = line.signed_distance((x, y, 0.0))
        nearest = whole.distance(shapely.Point(x, y))
        assert abs(found) >= nearest - 1e-9
        assert abs(found) == pytest.approx(nearest, abs=1e-6) or abs(aside) > 3, "far from tight turns"
        if abs(aside) > 1e-3 and abs(abs(found) - abs(aside)) < 1e-6:
            assert math.copysign(1, found) == math.copysign(1, aside)
