"""Defects of other readers and behaviors that have no better place (section 9 of the driving specification, by its tags)."""

import math
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import shapely

import scenic
from scenic.domains.driving.planning import MotionPlan
from scenic.domains.driving.roads import Network, VehicleType
from tests.maps import RoadText, cross, lane, lanes, line, map_text, piece, straight

WIDE = '<width sOffset="0" a="3.5" b="0" c="0" d="0"/>'


def network(tmp_path: Path, text: str, **options: Any) -> Network:
    path = tmp_path / "map.xodr"
    path.write_text(text)
    return Network.fromFile(path, **options)


def test_backward_lanes_are_ordered_from_the_curb_and_bounded_by_it(tmp_path: Path) -> None:
    """D105, D106."""
    section = lanes(left=lane(3) + lane(2) + lane(1), right=lane(-1) + lane(-2) + lane(-3))
    [road] = network(tmp_path, map_text([RoadText("1", 100.0, line(0, 0, 0, 100), section)])).roads
    for group, side in ((road.forwardLanes, -1), (road.backwardLanes, 1)):
        assert group is not None
        assert [part.sections[0].openDriveID for part in group.lanes] == [3 * side, 2 * side, side]
        for edge, y in ((group.curb, 10.5), (group.rightEdge, 10.5), (group.leftEdge, 0)):
            assert {abs(point[1]) for point in edge.points} == {y}
        assert shapely.Polygon([*group.left, *group.right[::-1]]).area == pytest.approx(1050)
    assert [part.openDriveID for part in road.sections[0].lanes] == [-3, -2, -1, 1, 2, 3]


def test_lines_repeat_no_point(tmp_path: Path) -> None:
    """D107."""
    pieces = line(0, 0, 0, 50) + piece(50, 0, 0, 50, '<arc curvature="0.01"/>', 50.0)
    found = network(tmp_path, map_text([RoadText("1", 100.0, pieces)]))
    for element in (*found.roads, *found.lanes, *found.laneGroups, *found.sidewalks):
        for part in (element.line, element.left, element.right):
            assert np.hypot(*np.diff(part, axis=0).T).min() > 1e-6


def test_lanes_know_who_may_use_them(tmp_path: Path) -> None:
    """D112."""
    bikes = lane(-2, "biking", '<width sOffset="0" a="1.5" b="0" c="0" d="0"/>')
    fast = lane(-1, width=f'{WIDE}<speed sOffset="0" max="72" unit="km/h"/>')
    found = network(tmp_path, map_text([RoadText("1", 100.0, line(0, 0, 0, 100), lanes("", fast + bikes))]))
    [group] = found.laneGroups
    assert group.bikeLane.vehicleTypes == {VehicleType.BICYCLE}
    assert group.lanes[0].vehicleTypes == {VehicleType.CAR}
    assert group.lanes[0].speedLimit == pytest.approx(20)


@pytest.mark.parametrize("surplus", [0.001, 0.02])
def test_curves_may_be_shorter_than_they_are_declared(tmp_path: Path, surplus: float) -> None:
    """D117."""
    shape = '<paramPoly3 aU="0" bU="50" cU="0" dU="0" aV="0" bV="0" cV="0" dV="0"/>'
    text = map_text([RoadText("1", 50 + surplus, piece(0, 0, 0, 50 + surplus, shape))])
    [road] = network(tmp_path, text).roads
    assert road.polygon.area == pytest.approx(350, rel=1e-3)


def test_widths_count_where_they_are_given_and_chords_stay_near_curves(tmp_path: Path) -> None:
    """D120."""
    widths = "".join(
        f'<width sOffset="{start}" a="{width}" b="0" c="0" d="0"/>'
        for start, width in ((0, 3), (50, 6), (51, 3))
    )
    text = map_text([RoadText("1", 100.0, line(0, 0, 0, 100), lanes("", lane(-1, width=widths)))])
    assert network(tmp_path, text).roads[0].polygon.area == pytest.approx(303, abs=0.05)
    arc = map_text([RoadText("1", 150.0, piece(0, 0, 0, 150, '<arc curvature="0.02"/>'))])
    for most in (0.01, 0.001):
        [road] = network(tmp_path, arc, max_error=most).roads
        middles = (road.line[1:] + road.line[:-1]) / 2
        assert np.abs(np.hypot(*(middles - [0, 50]).T) - 50).max() < 1.1 * most


def test_junction_0_is_one(tmp_path: Path) -> None:
    """D123."""
    text = cross()
    for words in ('junction="9"', 'elementId="9"', 'junction id="9"'):
        text = text.replace(words, words.replace("9", "0"))
    found = network(tmp_path, text)
    [inter] = found.intersections
    assert (inter.id, len(inter.maneuvers), len(found.roads)) == (0, 12, 4)
    assert all(road._successor is inter for road in found.roads)


def test_roads_are_ordered_by_the_ends_that_touch_the_intersection(tmp_path: Path) -> None:
    """D124. The other end of the bent road lies beyond the next road."""
    found = network(tmp_path, cross(bent=2))
    assert found.problems == ()
    [inter] = found.intersections
    far = found.elements["road2"].line[-1]  # type: ignore[attr-defined] # a road has a line
    assert math.degrees(math.atan2(far[1], far[0])) % 360 > 185
    first = [road.id for road in inter.roads].index(1)
    assert [road.id for road in (*inter.roads[first:], *inter.roads[:first])] == [1, 2, 3, 4]
    assert len(inter.maneuvers) == 12


def test_nothing_beside_a_map_is_read_or_written(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """D125."""
    monkeypatch.setenv("SCENIC_CACHE", "on")
    monkeypatch.setenv("SCENIC_CACHE_DIR", str(tmp_path / "store"))
    folder = tmp_path / "maps"
    folder.mkdir()
    (folder / "map.snet").write_bytes(b"cos\nabort\n(tR.")
    for length in (80, 81):
        assert len(network(folder, straight(length)).roads) == 1
    assert sorted(file.name for file in folder.iterdir()) == ["map.snet", "map.xodr"]


def test_a_lane_change_goes_on_into_the_intersection_once(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """D133."""
    (tmp_path / "map.xodr").write_text(cross(arm=60, half=15))
    chosen: list[str] = []
    original = MotionPlan.choose

    def noting(self: MotionPlan, choice: Any) -> None:
        chosen.append(choice.startLane.uid)
        original(self, choice)

    monkeypatch.setattr(MotionPlan, "choose", noting)
    text = (
        "param map = localPath('map.xodr')\nmodel scenic.simulators.newtonian.driving_model\n"
        "own = network.laneAt((-40, -1.75))\n"
        "ego = new Car at (-24, 1.75), facing -90 deg, with velocity (3, 0),\n"
        "    with behavior LaneChangeBehavior(own.sections[0], target_speed=3)\n"
    )
    scenario = scenic.scenarioFromString(text, filename=str(tmp_path / "main.scenic"), mode2D=True)
    done = scenario.getSimulator().simulate(scenario.sample(1, seed=1)[0], maxSteps=60)
    places = [state[0].x for state in done.trajectory]
    assert sum(-18 < x < -15 for x in places) > 3, "several steps are near the intersection"
    assert len(chosen) == 1
