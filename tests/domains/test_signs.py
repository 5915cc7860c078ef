"""Speed limits, signs and lights of maps, and the lanes and maneuvers for which they hold."""

from pathlib import Path
from typing import Any

import pytest

from scenic.domains.driving.enumerations import ManeuverType
from scenic.domains.driving.roads import Network
from tests.maps import RoadText, cross, lane, lanes, line, map_text, straight, two_way


def network(folder: Path, text: str) -> Any:
    (folder / "map.xodr").write_text(text)
    built = Network.fromFile(folder / "map.xodr", useCache=False)
    # Networks from the store are equal.
    again = Network.fromFile(folder / "map.xodr")
    for one, other in zip(built.signals, again.signals, strict=True):
        assert vars(one) | {"network": None} == vars(other) | {"network": None}
    for uid, element in built.elements.items():
        assert element.speedLimitRanges == again.elements[uid].speedLimitRanges
    return built


def limited(rest: str, lane_speed: str = "", length: float = 100) -> str:
    width = '<width sOffset="0" a="3.5" b="0" c="0" d="0"/>'
    content = lanes(lane(1), lane(-1, width=width + lane_speed))
    road = str(RoadText("1", length, line(0, 0, 0, length), content)).replace(
        "<planView>", f"{rest}<planView>"
    )
    return map_text([road])


@pytest.mark.parametrize(
    ("speed", "unit", "limit"),
    [
        ("10", "", 10),
        ("36", "km/h", 10),
        ("30", "mph", 13.4112),
        ("no limit", "", None),
        ("undefined", "", None),
    ],
)
def test_speeds_of_roads_have_units(tmp_path: Path, speed: str, unit: str, limit: float | None) -> None:
    attribute = f'unit="{unit}"' if unit else ""
    town = network(tmp_path, limited(f'<type s="0" type="town"><speed max="{speed}" {attribute}/></type>'))
    for element in (town.roads[0], *town.lanes):
        assert element.speedLimit == (None if limit is None else pytest.approx(limit))
    assert town.speedLimitAt((50, -1.75)) == town.lanes[0].speedLimit
    assert town.roads[0].tags == {"town"}


def test_limits_change_along_a_road_and_its_lanes_override_it(tmp_path: Path) -> None:
    types = (
        '<type s="0" type="town"><speed max="10"/></type><type s="60" type="rural"><speed max="20"/></type>'
    )
    own = '<speed sOffset="30" max="30" unit="m/s"/><speed sOffset="50" max="5"/>'
    town = network(tmp_path, limited(types, own))
    right, left = (
        next(item for item in town.lanes if item.sections[0].openDriveID == key) for key in (-1, 1)
    )
    assert town.roads[0].speedLimitRanges == ((0, 60, 10), (60, 100, 20))
    # Lanes of the other direction count from their own beginning.
    assert left.speedLimitRanges == ((0, 40, 20), (40, 100, 10))
    assert right.speedLimitRanges == ((0, 30, 10), (30, 50, 30), (50, 100, 5))
    assert (right.speedLimit, left.speedLimit, town.roads[0].speedLimit) == (5, 10, 10)
    assert [right.speedLimitAt(s) for s in (10, 40, 90)] == [10, 30, 5]
    assert [town.speedLimitAt((x, y)) for x, y in ((90, 1.75), (40, -1.75), (40, 60))] == [20, 30, None]


SIGN = '<signal id="7" s="{s}" t="4" zOffset="2.5" orientation="{side}" dynamic="no" country="DE" type="{type}" subtype="-1" value="50">{rest}</signal>'


def sign(type: str = "206", side: str = "+", s: float = 40, rest: str = "") -> str:
    return SIGN.format(type=type, side=side, s=s, rest=rest)


@pytest.mark.parametrize(
    ("type", "kinds", "priorities"),
    [
        ("206", "isStopSign", ("stop",)),
        ("205", "isYieldSign", ("yield",)),
        ("1000001", "isTrafficLight", ("trafficLight",)),
        ("274", "isSpeedLimit", ()),
        ("294", "isStopLine", ()),
    ],
)
def test_codes_of_signals(tmp_path: Path, type: str, kinds: str, priorities: tuple[str, ...]) -> None:
    (signal,) = network(tmp_path, straight(100, rest=f"<signals>{sign(type)}</signals>")).signals
    names = ("isStopSign", "isYieldSign", "isTrafficLight", "isSpeedLimit", "isStopLine")
    assert [name for name in names if getattr(signal, name)] == [kinds]
    assert signal.priorities == priorities
    assert (signal.s, signal.t, signal.height, signal.value, signal.orientation) == (40, 4, 2.5, 50, "+")


def test_semantics_come_before_codes(tmp_path: Path) -> None:
    rest = '<semantics><priority type="yield"/></semantics>'
    (signal,) = network(tmp_path, straight(100, rest=f"<signals>{sign('999', rest=rest)}</signals>")).signals
    assert signal.priorities == ("yield",)
    assert signal.isYieldSign


@pytest.mark.parametrize(
    ("side", "validity", "held"),
    [
        ("+", "", {-1}),
        ("-", "", {1}),
        ("none", "", {1, -1}),
        ("+", '<validity fromLane="1" toLane="1"/>', {1}),
    ],
)
def test_signals_hold_for_lanes(tmp_path: Path, side: str, validity: str, held: set[int]) -> None:
    town = network(tmp_path, straight(100, rest=f"<signals>{sign(side=side, rest=validity)}</signals>"))
    (signal,) = town.signals
    lanes = {item.sections[0].openDriveID: item for item in town.lanes}
    assert {key for key, item in lanes.items() if signal.affects(item)} == held
    for key, item in lanes.items():
        point = signal.stoppingPointOn(item)
        assert (point is None) == (key not in held)
        if point is not None:
            assert point.x == pytest.approx(40)


def test_halt_points_lie_ahead_within_reach(tmp_path: Path) -> None:
    town = network(tmp_path, straight(200, rest=f"<signals>{sign(s=120)}</signals>"))
    lane = next(item for item in town.lanes if item.sections[0].isForward)
    assert lane.haltPointAhead((60, -1.75)).x == pytest.approx(120)
    assert lane.haltPointAhead((30, -1.75)) is None, "it is 90 m away"
    assert lane.haltPointAhead((30, -1.75), lookahead=100) is not None
    assert lane.haltPointAhead((121, -1.75)) is None


def test_a_light_controls_the_maneuvers_of_its_approach(tmp_path: Path) -> None:
    light = sign("1000001", "+", 59)
    town = network(tmp_path, cross(signal=light))
    (signal,) = town.signals
    assert {maneuver.startLane.road.id for maneuver in signal.controlledManeuvers} == {1}
    assert len(signal.controlledManeuvers) == 3
    assert all(maneuver.signal is signal for maneuver in signal.controlledManeuvers)
    assert sum(maneuver.signal is not None for maneuver in town.maneuvers) == 3


def test_signals_of_connecting_roads_come_before_those_of_the_approach(tmp_path: Path) -> None:
    reference = '<signals><signalReference id="8" s="0" t="0" orientation="-"><validity fromLane="-1" toLane="-1"/></signalReference></signals>'
    other = (
        sign("1000001", "+", 50)
        .replace('id="7"', 'id="8"')
        .replace("></signal>", '><validity fromLane="0" toLane="0"/></signal>')
    )
    text = cross(signal=sign("1000001", "+", 59) + other)
    # The first connecting road leads from road 1 to road 2, to the left of its traffic.
    head, tail = text.split('id="100"', 1)
    town = network(
        tmp_path, head + 'id="100"' + tail.replace("</lanes></road>", f"</lanes>{reference}</road>", 1)
    )
    own, named = town.signals
    (maneuver,) = named.controlledManeuvers
    assert maneuver.connectingLane.road.id == 100
    assert len(own.controlledManeuvers) == 2
    assert maneuver.type is not ManeuverType.STRAIGHT


def test_signals_name_roads_that_are_not_there(tmp_path: Path) -> None:
    (tmp_path / "map.xodr").write_text(
        straight(100, rest='<signals><signalReference id="99" s="1" t="0" orientation="+"/></signals>')
    )
    problems = Network.fromFile(tmp_path / "map.xodr").problems
    assert [problem.message for problem in problems if "99" in problem.message] == [
        "road 1 refers to signal 99, which is not there: dropped"
    ]


def test_the_offset_of_the_header_is_kept(tmp_path: Path) -> None:
    text = straight(100).replace(
        'revMinor="4"/>', 'revMinor="4"><offset x="100.5" y="-3" z="2" hdg="0.1"/></header>'
    )
    assert network(tmp_path, text).offset == (100.5, -3, 2, 0.1)
    assert two_way()
