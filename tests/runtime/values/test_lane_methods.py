"""Methods of a random choice among objects: no sample calls Python, and each value is that of the drawn object, in every bit."""

import pytest

import scenic
from scenic.language.errors import ScenicTypeError, ScenicValueError
from scenic.runtime.python import opaque
from tests.maps import cross

LINES = """
import math
bends = [PolylineRegion([(k * math.sin(t / k), t / 9) for t in range(2 + 40 * k)]) for k in range(1, 5)]
line = Uniform(*bends, PolylineRegion([(0, 0), (4, 0), (4, 3)]))
way, share, place = Range(-9, 9), Range(-1, 1), (Range(-5, 5), Range(-5, 5), Range(-1, 1))
alone = bends[1]
param line = line, alone = alone, way = way, share = share, place = place
param of_line = [
    line.pointAlongBy(way), line.pointAlongBy(share, normalized=True), line.project(place), line.signedDistanceTo(place),
    line.closestPointTo(place), line.orientation[place], line.orientation.followFrom(place, way), line.orientation.followFrom(place, way, steps=2)]
param of_one = [
    alone.pointAlongBy(way), alone.pointAlongBy(share, normalized=True), alone.project(place), alone.signedDistanceTo(place),
    alone.closestPointTo(place), alone.orientation[place], alone.orientation.followFrom(place, way), alone.orientation.followFrom(place, way, steps=2)]
ego = new Object
"""

ROADS = """
param map = MAP
model scenic.domains.driving.model
lane = Uniform(*network.lanes)
place = new OrientedPoint on lane
way = Range(-3, 12)
param lane = lane, place = place.position, way = way, end = lane.flowFrom(place.position, way)
param far = lane.flowFrom(place.position, way, stepSize=1), along = lane.centerline.pointAlongBy(way)
ego = new Car at lane.centerline.pointAlongBy(Range(1, 5)), with color [0, 0, 0], with regionContainedIn None
"""


def _of(line, params):
    way, share, place = params["way"], params["share"], params["place"]
    field = line.orientation
    return [
        line.pointAlongBy(way),
        line.pointAlongBy(share, normalized=True),
        line.project(place),
        line.signedDistanceTo(place),
        line.closestPointTo(place),
        field[place],
        field.followFrom(place, way),
        field.followFrom(place, way, steps=2),
    ]


def _bits(values):
    return [tuple(value) if hasattr(value, "__iter__") else getattr(value, "q", value) for value in values]


@pytest.fixture
def silent(monkeypatch):
    """Calls of Python on samples fail."""

    def called(*_arguments, **_keywords):
        raise AssertionError("Python was called for a sample")

    monkeypatch.setattr(opaque.Calls, "results", called)
    monkeypatch.setattr(opaque.Calls, "each", called)


@pytest.mark.parametrize("lanes", [1, 7, 512, 4096])
@pytest.mark.usefixtures("silent")
def test_values_equal_those_of_single_calls_in_every_bit(lanes):
    scenes = scenic.scenarioFromString(LINES).sample(min(lanes, 60), seed=3, lanes=lanes)
    for scene in scenes:
        params = scene.params
        assert _bits(params["of_line"]) == _bits(_of(params["line"], params))
        assert _bits(params["of_one"]) == _bits(_of(params["alone"], params))


@pytest.mark.usefixtures("silent")
def test_ways_along_random_lanes(tmp_path):
    path = tmp_path / "crossing.xodr"
    path.write_text(cross(), encoding="utf-8")
    scenario = scenic.scenarioFromString(ROADS.replace("MAP", repr(str(path))), mode2D=True)
    for scene in scenario.sample(40, seed=1):
        lane, place, way = (scene.params[name] for name in ("lane", "place", "way"))
        assert tuple(scene.params["end"]) == tuple(lane.flowFrom(place, way))
        assert tuple(scene.params["far"]) == tuple(lane.flowFrom(place, way, stepSize=1))
        assert tuple(scene.params["along"]) == tuple(lane.centerline.pointAlongBy(way))


@pytest.mark.usefixtures("silent")
def test_fields_of_random_lanes_are_followed_and_faced(tmp_path):
    path = tmp_path / "crossing.xodr"
    path.write_text(cross(), encoding="utf-8")
    text = (
        ROADS.split("lane =")[0].replace("MAP", repr(str(path)))
        + "lane, way = Uniform(*network.lanes), Range(3, 12)\n"
        "ego = new Car on road, facing lane.orientation, with color [0, 0, 0]\n"
        "end = new Point following lane.orientation from ego.position for way\n"
        "param lane = lane, way = way, end = end.position\n"
    )
    scenario = scenic.scenarioFromString(text, mode2D=True)
    for scene in scenario.sample(30, seed=1):
        lane, way, end = (scene.params[name] for name in ("lane", "way", "end"))
        place = scene.egoObject.position
        same = sum(
            a * b for a, b in zip(scene.egoObject.orientation.q, lane.orientation[place].q, strict=True)
        )
        assert abs(same) == pytest.approx(1)
        assert tuple(end) == tuple(lane.orientation.followFrom(place, way))


def test_other_methods_of_random_lanes_are_called_once_for_a_sample(tmp_path, monkeypatch):
    path = tmp_path / "crossing.xodr"
    path.write_text(cross(), encoding="utf-8")
    text = (
        ROADS.split("way =")[0].replace("MAP", repr(str(path)))
        + "ego = new Car on road, with color [0, 0, 0]\n"
        "param lane = lane, nearest = lane.centerline.nearestSegmentTo(ego.position)\n"
        "param directions = lane.nominalDirectionsAt(ego.position), there = lane.nominalDirectionsAt((1, 2))\n"
    )
    scenario = scenic.scenarioFromString(text, mode2D=True)
    lanes = []
    results = opaque.Calls.results

    def counted(calls, absent=None):
        lanes.append(len(calls.present))
        return results(calls, absent)

    monkeypatch.setattr(opaque.Calls, "results", counted)
    (scene,) = scenario.sample(1, seed=1, lanes=1)
    assert len(lanes) == 3 * scene.attempts
    place, lane = scene.egoObject.position, scene.params["lane"]
    assert scene.params["nearest"] == lane.centerline.nearestSegmentTo(place)
    assert [item.q for item in scene.params["directions"]] == [lane.orientation[place].q]
    assert [item.q for item in scene.params["there"]] == [lane.orientation[1, 2].q]


CHOICE = "A = PolylineRegion([(0, 0), (4, 0)])\nB = PolylineRegion([(0, 5), (4, 8)])\nM = Uniform(A, B)\n"


def test_endless_ways_fail_only_where_they_are_drawn():
    text = CHOICE + "way = Uniform(1, 1e9)\nparam end = M.orientation.followFrom((0, 0), way), way = way\n"
    scene = scenic.scenarioFromString(text + "require way < 2\n").sample(1, seed=1)[0]
    assert scene.params["way"] == 1
    endless = scenic.scenarioFromString(text + "require way > 2\n")
    with pytest.raises(ScenicValueError, match="cannot be followed"):
        endless.sample(1, seed=1)


def test_instances_are_places():
    text = (
        CHOICE
        + "ego = new Object at (Range(1, 2), Range(0, 1))\nparam near = M.closestPointTo(ego), one = A.signedDistanceTo(ego), line = M\n"
    )
    for scene in scenic.scenarioFromString(text).sample(3, seed=1):
        place = scene.egoObject.position
        assert scene.params["one"] == place.y
        assert tuple(scene.params["near"]) == tuple(scene.params["line"].closestPointTo(place))


def test_random_settings_are_left_to_python():
    text = (
        CHOICE
        + "param found = M.pointAlongBy(Range(0, 1), Uniform(True, False)), one = A.pointAlongBy(0.5, Uniform(True, True))\n"
    )
    scene = scenic.scenarioFromString(text).sample(1, seed=1)[0]
    assert tuple(scene.params["one"]) == (2, 0, 0)


def test_other_distances_are_refused():
    with pytest.raises(ScenicTypeError, match="a distance along a line"):
        scenic.scenarioFromString(CHOICE + "param x = A.pointAlongBy('far')\n")
