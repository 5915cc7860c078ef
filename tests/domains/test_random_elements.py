"""Random elements of a road network: no sample asks Python, and what is drawn is what Python would have found."""

import statistics
from collections import Counter

import numpy as np
import pytest
from scipy.stats import chisquare

import scenic
from scenic.graph.bounds import Bounds
from scenic.graph.operation import Call
from scenic.language.errors import RejectionException
from scenic.runtime.python import opaque
from scenic.runtime.values.access import _PLACE_IN_ALL
from tests.maps import cross

ROADS = """
param map = MAP
model scenic.domains.driving.model
inter = Uniform(*filter(lambda i: i.maneuvers, network.intersections))
turn = Uniform(*filter(lambda m: m.type is not ManeuverType.U_TURN, inter.maneuvers))
other = Uniform(*filter(lambda m: m.startLane is not turn.startLane, turn.conflictingManeuvers))
ego = new Car on turn.startLane.centerline, with color [0, 0, 0], with regionContainedIn None,
    with way [turn.startLane, turn.connectingLane, turn.endLane]
second = new Car at other.startLane.centerline[-1], with color [0, 0, 0], with regionContainedIn None,
    with allowCollisions True
param turn = turn, other = other, lane = ego._lane, section = ego._laneSection, group = ego._laneGroup
param count = len(inter.maneuvers), end = turn.endLane.centerline[-1], road = second.road
require (distance from ego to inter) > 5
require ego._lane is turn.startLane
require network.laneAt(second) is not None
"""


@pytest.fixture(scope="module")
def program(tmp_path_factory):
    """The text above on a map of one crossing."""
    path = tmp_path_factory.mktemp("maps") / "crossing.xodr"
    path.write_text(cross(), encoding="utf-8")
    return ROADS.replace("MAP", repr(str(path)))


def test_no_sample_calls_python(program, monkeypatch):
    scenario = scenic.scenarioFromString(program, mode2D=True)

    def called(*_arguments):
        raise AssertionError("Python was called for a sample")

    monkeypatch.setattr(opaque.Calls, "results", called)
    assert len(scenario.sample(20, seed=1)) == 20


def test_what_is_drawn_is_what_python_finds(program):
    scenes = scenic.scenarioFromString(program, mode2D=True).sample(300, seed=1)
    turns = Counter()
    for scene in scenes:
        ego, second = scene.objects
        found = scene.params
        turn, other = found["turn"], found["other"]
        network = turn.startLane.network
        turns[turn] += 1
        assert turn.type.name != "U_TURN"
        assert other in turn.conflictingManeuvers
        assert other.startLane is not turn.startLane
        assert list(ego.way) == [turn.startLane, turn.connectingLane, turn.endLane]
        assert found["lane"] is network.laneAt(ego) is turn.startLane
        assert found["section"] is network.laneSectionAt(ego)
        assert found["group"] is network.laneGroupAt(ego)
        assert found["road"] is network.roadAt(second)
        assert found["count"] == len(turn.intersection.maneuvers)
        assert tuple(found["end"]) == tuple(turn.endLane.centerline.points[-1])
    possible = [turn for turn in scenes[0].params["turn"].intersection.maneuvers if turn.conflictingManeuvers]
    assert set(turns) == {turn for turn in possible if turn.type.name != "U_TURN"}


def test_what_an_element_lacks_rejects_the_samples_that_draw_it(program):
    text = program.split("inter =")[0] + (
        "lane = Uniform(*network.lanes)\n"
        "ego = new Car at lane.successor.centerline[-1], with regionContainedIn None\n"
        "param lane = lane, ways = len(lane.maneuvers)\n"
    )
    scenes = scenic.scenarioFromString(text, mode2D=True).sample(100, seed=2)
    assert all(scene.params["lane"]._successor is not None for scene in scenes)
    assert any(scene.attempts > 1 for scene in scenes)


def test_none_on_the_way_rejects(program):
    text = program.split("inter =")[0] + (
        "move = Uniform(*[m for lane in network.lanes for m in lane.maneuvers])\n"
        "ego = new Car on move.connectingLane.centerline, with regionContainedIn None\n"
        "param move = move\n"
    )
    for scene in scenic.scenarioFromString(text, mode2D=True).sample(50, seed=2):
        assert scene.params["move"].connectingLane is not None


def test_an_element_that_no_place_has(program):
    text = program.split("inter =")[0] + "ego = new Car at (Range(5000, 6000), 0)\nparam lane = ego.lane\n"
    with pytest.raises(RejectionException):
        scenic.scenarioFromString(text, mode2D=True).generate(maxIterations=50)


@pytest.mark.parametrize(
    ("text", "counts"),
    [
        ("inter = Uniform(*filter(lambda i: i.is3Way, network.intersections))", "line 4 left 0 of 1"),
        (
            """inter = Uniform(*network.intersections, *network.intersections)
none = filter(lambda m: m.startLane is m.endLane, inter.maneuvers)
turn = Uniform(*none)""",
            "line 5 left 0 of 24",
        ),
    ],
)
def test_a_filter_that_leaves_nothing_says_so(program, text, counts):
    with pytest.raises(scenic.InvalidScenarioError, match=counts):
        scenic.scenarioFromString(program.split("inter =")[0] + text + "\nego = new Car\n", mode2D=True)


def test_bounds_of_places_in_lists_hold_them():
    lengths = (3, 0, 1, 7)
    random = np.random.default_rng(1)
    index, draw = np.sort(random.integers(0, 4, (2, 500)), axis=0), np.sort(random.random((2, 500)), axis=0)
    bounds = _PLACE_IN_ALL.bounds(lengths, Bounds(*index.astype(float)), Bounds(*draw))
    for _ in range(20):
        shares = random.random((2, 500))
        mine = np.floor(index[0] + shares[0] * (index[1] - index[0] + 1)).clip(*index).astype(int)
        number = draw[0] + shares[1] * (draw[1] - draw[0])
        call = Call((500,), lengths, [None, None])
        place = _PLACE_IN_ALL.batch(call, mine, number)
        lists, numbers = _PLACE_IN_ALL.inverse(
            lengths,
            Bounds(place.astype(float), place.astype(float)),
            Bounds(*index.astype(float)),
            Bounds(*draw),
        )
        there = np.array(lengths)[mine] > 0
        assert ((bounds.lower <= place) & (place <= bounds.upper))[there].all()
        assert ((lists.lower <= mine) & (mine <= lists.upper))[there].all()
        assert ((numbers.lower <= number) & (number <= numbers.upper))[there].all()
    known = (index[0] == 3) & (index[1] == 3)
    assert (bounds.upper - bounds.lower)[known].min() < 6


def test_which_elements_are_the_same_is_known_before_sampling(program):
    lines = program.splitlines()[:3]
    text = "\n".join(
        [
            *lines,
            "one, two, three = (Uniform(*network.lanes) for i in range(3))",
            "ego = new Object in one",
            "require one.road is two.road and one is not two",
            "require three is network.lanes[2] or three is one.group",
            "param one = one, two = two, three = three",
        ]
    )
    scenario = scenic.scenarioFromString(text, mode2D=True)
    lanes = scenario.sample(1, seed=1)[0].params["one"].network.lanes
    pairs = {(one, two) for one in lanes for two in lanes if one.road is two.road and one is not two}
    scenes = scenario.sample(40 * len(pairs), seed=1)
    found = Counter((scene.params["one"], scene.params["two"]) for scene in scenes)
    assert set(found) == pairs
    assert chisquare(list(found.values())).pvalue > 1e-4
    assert {scene.params["three"] for scene in scenes} == {lanes[2]}
    assert statistics.mean(scene.attempts for scene in scenes) < 0.2 * len(lanes) ** 3 / len(pairs)
