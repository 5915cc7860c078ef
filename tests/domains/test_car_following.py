"""Leaders on paths: those that geometry finds, object by object."""

import math
from types import SimpleNamespace
from typing import Any

import numpy as np
import shapely
from hypothesis import assume, given, settings
from hypothesis import strategies as st

from scenic.domains.driving.car_following import Course, Traffic, leader_on
from scenic.domains.driving.path_pieces import piece_along
from scenic.domains.driving.paths import Path

ALONG = np.arange(0.0, 300.0, 0.5)
POINTS = np.column_stack([20 * np.sin(ALONG / 60), ALONG])
PATH = Path(piece_along(POINTS))
LINE = shapely.LineString(POINTS)


def thing(x: float, y: float, heading: float, length: float, width: float) -> Any:
    return SimpleNamespace(position=(x, y, 0.0), heading=heading, length=length, width=width)


things = st.builds(
    thing, st.floats(-40, 40), st.floats(5, 295), st.floats(-3, 3), st.floats(0.5, 12), st.floats(0.4, 2.6)
)


@settings(max_examples=150, deadline=None)
@given(st.lists(things, max_size=12), st.integers(0, 400), st.integers(0, 60))
def test_the_first_one_whose_outline_reaches_the_way_leads(
    others: list[Any], index: int, driven: int
) -> None:
    course = Course(PATH, index)
    index += driven  # the course was made some time ago
    x, y = POINTS[index].tolist()
    agent = thing(x, y, 0.0, 4.5, 2.0)
    first = None
    for other in others:
        place = shapely.Point(other.position[:2])
        along, side = LINE.project(place), LINE.distance(place)
        turn = other.heading - PATH.headings[min(int(np.searchsorted(PATH.along, along)), len(POINTS) - 1)]
        half = (other.length * abs(math.sin(turn)) + other.width * abs(math.cos(turn))) / 2
        room = half + 1.3 - side
        ahead = along - PATH.along[index]
        away = math.dist(other.position[:2], (x, y))
        # On the edge, roundings decide.
        assume(abs(room) > 0.2 and abs(ahead) > 1 and abs(ahead - 120) > 13 and abs(away - 120) > 1)
        if room > 0 and 0 < ahead < 120 and away < 120 and (first is None or along < first[0]):
            assume(first is None or abs(along - first[0]) > 0.5)
            first = along, other
    leader = leader_on(PATH, index, agent, Traffic((*others, agent)), course)
    assert (leader and leader.item) is (first and first[1])
    if leader is not None and first is not None:
        assert abs(leader.along - first[0]) < 0.5
