"""Facts of the road on small maps with one feature each: left-hand traffic, crossings, tags, the header's offset."""

import math
from pathlib import Path
from typing import Any
from xml.etree import ElementTree

import pytest

import scenic
from scenic.domains.driving.enumerations import ManeuverType
from scenic.domains.driving.roads import Network
from tests.maps import RoadText, cross, lane, lanes, line, map_text, straight

OUTLINE = "<outline>{}</outline>"


def network(folder: Path, text: str) -> Any:
    (folder / "map.xodr").write_text(text)
    return Network.fromFile(folder / "map.xodr", useCache=False)


def four_lanes(attributes: str = "") -> str:
    """A road of 200 m along the x axis with two lanes and a shoulder on each side."""
    left, right = (
        "".join(
            lane(side * number, kind) for number, kind in ((1, "driving"), (2, "driving"), (3, "shoulder"))
        )
        for side in (1, -1)
    )
    return map_text([RoadText("1", 200.0, line(0, 0, 0, 200), lanes(left, right), attributes=attributes)])


@pytest.mark.parametrize(("attributes", "left"), [('rule="LHT"', True), ('rule="RHT"', False), ("", False)])
def test_faster_lanes_lie_toward_the_middle_and_curbs_outside(
    tmp_path: Path, attributes: str, left: bool
) -> None:
    town = network(tmp_path, four_lanes(attributes))
    assert town.driveOnLeft == left
    [road] = town.roads
    for group in road.laneGroups:
        outer, inner = group.lanes
        assert abs(outer.line[0][1]) > abs(inner.line[0][1])
        assert outer.sections[0].fasterLane is inner.sections[0]
        assert inner.sections[0]._fasterLane is None
        assert inner.sections[0].slowerLane is outer.sections[0]
        # Traffic below the x axis goes east where it keeps right, and west where it keeps left.
        eastward = outer.line[-1][0] > outer.line[0][0]
        assert eastward == ((outer.line[0][1] < 0) != left)
        assert inner.orientation[inner.centerline.points[0]].yaw == pytest.approx(
            -math.pi / 2 if eastward else math.pi / 2
        )
        assert abs(group.curb.points[0][1]) == pytest.approx(10.5), "beyond the shoulder"
        side = outer.sections[0]._laneToRight if left else outer.sections[0]._laneToLeft
        assert side is inner.sections[0]
        oncoming = inner.sections[0]._laneToRight if left else inner.sections[0]._laneToLeft
        assert oncoming is not None
        assert oncoming.isForward != inner.sections[0].isForward


def test_cars_keep_left_where_traffic_does(tmp_path: Path) -> None:
    (tmp_path / "map.xodr").write_text(four_lanes('rule="LHT"'))
    program = f"""
param map = {str(tmp_path / "map.xodr")!r}
model scenic.simulators.newtonian.driving_model
behavior Overtake():
    do FollowLaneBehavior(target_speed=10) for 1 seconds
    do LaneChangeBehavior(self.laneSection.fasterLane, target_speed=10)
    do FollowLaneBehavior(target_speed=10)
ego = new Car at (20, 5.25), facing roadDirection, with behavior Overtake, with speed 10
"""
    scenario = scenic.scenarioFromString(program, mode2D=True)
    [scene] = scenario.sample(1, seed=1)
    done = scenario.getSimulator().simulate(scene, maxSteps=80)
    assert done is not None
    ways = [state.positions[0] for state in done.trajectory]
    assert ways[-1][0] > 80
    assert ways[9][1] == pytest.approx(5.25, abs=0.1)
    assert ways[-1][1] == pytest.approx(1.75, abs=0.1)


def crosswalk(corners: list[tuple[float, float]]) -> str:
    text = "".join(f'<cornerRoad s="{s}" t="{t}" dz="0" height="0"/>' for s, t in corners)
    return (
        f'<objects><object type="crosswalk" id="4" s="0" t="0"><outline>{text}</outline></object></objects>'
    )


def test_crossings_of_roads_conflict_with_what_passes(tmp_path: Path) -> None:
    walk = crosswalk([(50, -4), (53, -4), (53, 4), (50, 4)])
    text = cross().replace("</lanes><signals", "</lanes>" + walk + "<signals", 1)
    text = text if walk in text else text.replace("</lanes></road>", f"</lanes>{walk}</road>", 1)
    town = network(tmp_path, text)
    [crossing] = town.crossings
    [inter] = town.intersections
    assert crossing.parent is town.roads[0]
    assert crossing in town.roads[0].crossings
    assert set(crossing.conflictingManeuvers) == {
        item for item in inter.maneuvers if town.roads[0] in (item.startLane.road, item.endLane.road)
    }
    assert len(crossing.conflictingManeuvers) == 6


def test_crossings_of_junctions_conflict_with_their_ways(tmp_path: Path) -> None:
    # Over the western half of the way from west to east, which others enter only further on.
    text = cross()
    number = next(
        index
        for index, (i, j) in enumerate([(i, j) for i in range(4) for j in range(4) if i != j])
        if (i, j) == (2, 0)
    )
    head, tail = text.split(f'id="{100 + number}"', 1)
    walk = crosswalk([(1, -4), (3, -4), (3, 4), (1, 4)])
    town = network(
        tmp_path, head + f'id="{100 + number}"' + tail.replace("</lanes></road>", f"</lanes>{walk}</road>", 1)
    )
    [inter] = town.intersections
    [crossing] = town.crossings
    assert crossing.parent is inter
    assert crossing in inter.crossings
    west = next(road for road in town.roads if road.id == 3)
    assert set(crossing.conflictingManeuvers) == {
        item for item in inter.maneuvers if west in (item.startLane.road, item.endLane.road)
    }


def test_conflicting_maneuvers_cross_each_other(tmp_path: Path) -> None:
    [inter] = network(tmp_path, cross()).intersections
    kinds = {kind: [item for item in inter.maneuvers if item.type is kind] for kind in ManeuverType}
    # A right turn meets only those that end in its lane: straight on from its left, and the left turn from across.
    for turn in kinds[ManeuverType.RIGHT_TURN]:
        assert {item.endLane for item in turn.conflictingManeuvers} == {turn.endLane}
        assert sorted(item.type.name for item in turn.conflictingManeuvers) == ["LEFT_TURN", "STRAIGHT"]
    for way in kinds[ManeuverType.STRAIGHT]:
        opposite = [item for item in way.reverseManeuvers if item.type is ManeuverType.STRAIGHT]
        assert not set(opposite) & set(way.conflictingManeuvers)
    for maneuver in inter.maneuvers:
        assert all(maneuver in other.conflictingManeuvers for other in maneuver.conflictingManeuvers)
        assert maneuver not in maneuver.conflictingManeuvers


def test_tags_are_types_of_roads_lanes_and_junctions(tmp_path: Path) -> None:
    text = (
        four_lanes()
        .replace("<planView>", '<type s="0" type="rural"/><planView>')
        .replace('id="-2" type="driving"', 'id="-2" type="exit"')
    )
    town = network(tmp_path, text)
    [road] = town.roads
    assert road.tags == {"rural"}
    assert {item.sections[0].openDriveID: item.tags for item in town.lanes} == {
        1: {"rural", "driving"}, 2: {"rural", "driving"}, -1: {"rural", "driving"}, -2: {"rural", "exit"},
    }  # fmt: skip
    group = '<junctionGroup id="1" type="roundabout"><junctionReference junction="9"/></junctionGroup></OpenDRIVE>'
    assert network(tmp_path, cross()).intersections[0].tags == frozenset()
    assert network(tmp_path, cross().replace("</OpenDRIVE>", group)).intersections[0].tags == {"roundabout"}


@pytest.mark.parametrize(
    ("kind", "drivable", "sidewalks", "shoulders", "bicycles"),
    [
        ("biking", 3, 0, 2, 1),
        ("curb", 3, 0, 2, 0),
        ("walking", 3, 1, 2, 0),
        ("slipLane", 4, 0, 2, 0),
        ("restricted", 3, 0, 2, 0),
        ("parking", 3, 0, 2, 0),
    ],
)
def test_lanes_belong_where_their_types_say(
    tmp_path: Path, kind: str, drivable: int, sidewalks: int, shoulders: int, bicycles: int
) -> None:
    town = network(tmp_path, four_lanes().replace('id="-2" type="driving"', f'id="-2" type="{kind}"'))
    assert len(town.lanes) == drivable
    assert (len(town.sidewalks), len(town.shoulders)) == (sidewalks, shoulders)
    assert sum(group._bikeLane is not None for group in town.laneGroups) == bicycles
    width = 7.0 if kind == "parking" else 3.5
    assert min(item.polygon.area for item in town.shoulders) == pytest.approx(3.5 * 200)
    assert max(item.polygon.area for item in town.shoulders) == pytest.approx(width * 200)


def test_exports_apply_the_offset_of_the_header(tmp_path: Path) -> None:
    from scenic.domains.driving.openscenario import toOpenScenario

    offset = '<header revMajor="1" revMinor="6"><offset x="100" y="-20" z="3" hdg="0.5"/></header>'
    (tmp_path / "map.xodr").write_text(straight(100).replace('<header revMajor="1" revMinor="4"/>', offset))
    program = f"""
param map = {str(tmp_path / "map.xodr")!r}
model scenic.simulators.newtonian.driving_model
ego = new Car at (20, -1.75), facing roadDirection, with speed 5
"""
    scenario = scenic.scenarioFromString(program, mode2D=True)
    [scene] = scenario.sample(1, seed=1)
    done = scenario.getSimulator().simulate(scene, maxSteps=5)
    text = ElementTree.tostring(toOpenScenario(done).get_element())
    places = [item.attrib for item in ElementTree.fromstring(text).iter("WorldPosition")]
    # The rear axle, 1.35 m behind the middle; eastward traffic, turned by half a radian.
    x, y = 20 - 1.35, -1.75
    assert float(places[0]["x"]) == pytest.approx(x * math.cos(0.5) - y * math.sin(0.5) + 100)
    assert float(places[0]["y"]) == pytest.approx(x * math.sin(0.5) + y * math.cos(0.5) - 20)
    assert float(places[0]["z"]) == pytest.approx(3)
    assert float(places[0]["h"]) == pytest.approx(0.5)
