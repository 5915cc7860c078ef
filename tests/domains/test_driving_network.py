"""The road network of a map: elements, their order and neighbours, links, maneuvers, lookups."""

import math
import os
import random
import re
from pathlib import Path

import numpy as np
import pytest
import shapely
from scipy.special import fresnel

from scenic.domains.driving.lookups import Finder
from scenic.domains.driving.roads import ManeuverType, Network, VehicleType
from scenic.formats.opendrive.xml_tree import MapError
from scenic.language.errors import RejectionException
from scenic.runtime.values.values import Vector
from tests.maps import RoadText, cross, lane, lanes, line, map_text, piece, straight, two_way

MAPS = os.environ.get("SCENIC_TEST_MAPS")


def network(tmp_path: Path, text: str, **options: object) -> Network:
    path = tmp_path / "map.xodr"
    path.write_text(text)
    return Network.fromFile(path, **options)


@pytest.fixture(scope="module")
def crossing(tmp_path_factory: pytest.TempPathFactory) -> Network:
    light = '<signal id="5" s="50" t="-4" type="1000001" country="OpenDRIVE" orientation="+"/>'
    return network(tmp_path_factory.mktemp("cross"), cross(signal=light))


def test_a_road_has_lanes_in_both_directions(tmp_path: Path) -> None:
    found = network(tmp_path, straight())
    [road] = found.roads
    assert found.problems == ()
    assert sorted(found.elements) == [
        "road1", "road1_backward", "road1_forward", "road1_lane0", "road1_lane1", "road1_sec0", "road1_sec0_lane-1",
        "road1_sec0_lane1", "road1_sidewalkBackward", "road1_sidewalkForward",
    ]  # fmt: skip
    assert road.id == 1
    assert road.polygon.area == pytest.approx(700)
    assert found.sidewalkRegion.area == pytest.approx(400)
    forward, backward = road.forwardLanes, road.backwardLanes
    assert forward is not None
    assert backward is not None
    assert (forward.opposite, backward.opposite) == (backward, forward)
    assert list(forward.lanes[0].centerline.points) == [(0, -1.75, 0), (100, -1.75, 0)]
    assert list(backward.lanes[0].centerline.points) == [(100, 1.75, 0), (0, 1.75, 0)]
    assert list(forward.curb.points) == [(0, -3.5, 0), (100, -3.5, 0)]
    assert list(backward.curb.points) == [(100, 3.5, 0), (0, 3.5, 0)]
    assert forward.sidewalk.road is road
    section = road.sections[0]
    assert [part.openDriveID for part in section.lanes] == [-1, 1]
    # Numbered from right to left, whatever the order in the file.
    assert [(part.uid, part.id) for part in road.lanes] == [
        ("road1_lane0", "road1_lane0"),
        ("road1_lane1", "road1_lane1"),
    ]
    right, left = section.lanes
    assert right.laneToLeft is left
    assert left.laneToLeft is right
    assert right._fasterLane is None
    with pytest.raises(RejectionException, match="no lane to its right"):
        _ = right.laneToRight
    assert right.shiftedBy(1) is left
    assert left.adjacentLanes == (right,)


def test_directions_follow_traffic(tmp_path: Path) -> None:
    found = network(tmp_path, straight())
    east, west = -math.pi / 2, math.pi / 2
    assert found.roadDirection[Vector(50, -1, 0)].yaw == pytest.approx(east)
    assert found.roadDirection[Vector(50, 1, 0)].yaw == pytest.approx(west)
    assert found.roadDirection[Vector(50, 80, 0)].yaw == 0
    lanes = found.lanes
    assert found.laneAt((50, -1)) is lanes[1] or found.laneAt((50, -1)) is lanes[0]
    assert found.laneAt((50, -3.53)) is found.laneAt((50, -3.4)), "within the tolerance"
    assert found.laneAt((50, -3.6)) is None
    assert found.elementAt((50, -4)) is found.sidewalks[0]
    with pytest.raises(RejectionException, match="nothing there"):
        found.laneAt((50, 50), reject="nothing there")


def test_left_hand_traffic_is_the_other_way_round(tmp_path: Path) -> None:
    found = network(tmp_path, straight(attributes='rule="LHT"'))
    assert found.driveOnLeft
    assert found.roadDirection[Vector(50, 1, 0)].yaw == pytest.approx(-math.pi / 2)
    [road] = found.roads
    assert road.forwardLanes is not None
    assert list(road.forwardLanes.curb.points) == [(0, 3.5, 0), (100, 3.5, 0)]
    section = road.forwardLanes.lanes[0].sections[0]
    assert section._laneToRight is not None
    assert section._laneToLeft is None


def test_maneuvers_of_a_crossing(crossing: Network) -> None:
    [inter] = crossing.intersections
    assert inter.is4Way
    assert not inter.is3Way
    assert inter.isSignalized
    assert inter.hasTrafficLights
    assert [road.id for road in inter.roads] in ([1, 2, 3, 4], [2, 3, 4, 1], [3, 4, 1, 2], [4, 1, 2, 3])
    assert len(inter.maneuvers) == 12
    starts = [maneuver.startLane for maneuver in inter.maneuvers]
    assert starts == [lane for lane in dict.fromkeys(starts) for _ in range(3)]
    ends = [lane.centerline.points[-1] for lane in inter.incomingLanes]
    headings = [math.atan2(-x, y) for x, y, _ in ends]
    assert headings == sorted(headings)
    kinds = [maneuver.type for maneuver in inter.maneuvers]
    for kind in (ManeuverType.STRAIGHT, ManeuverType.LEFT_TURN, ManeuverType.RIGHT_TURN):
        assert kinds.count(kind) == 4
    for maneuver in inter.maneuvers:
        assert maneuver.startLane in inter.incomingLanes
        assert maneuver.endLane in inter.outgoingLanes
        assert maneuver.connectingLane is not None
        assert maneuver.connectingLane._predecessor is maneuver.startLane
        assert maneuver.connectingLane._successor is maneuver.endLane
        assert maneuver.startLane.maneuvers.count(maneuver) == 1
        assert maneuver.connectingLane.maneuvers[0].type is ManeuverType.STRAIGHT
        gap = np.hypot(*(maneuver.startLane.line[-1] - maneuver.connectingLane.line[0]))
        assert gap < 1e-6
    # A lane leaving the crossing comes from the last connection that leads into it.
    assert all(lane._predecessor is not None for lane in inter.outgoingLanes)
    straight_on = next(item for item in inter.maneuvers if item.type is ManeuverType.STRAIGHT)
    lines = {id(item): shapely.LineString(item.connectingLane.line) for item in inter.maneuvers}
    expected = [
        item
        for item in inter.maneuvers
        if item.startLane is not straight_on.startLane and lines[id(item)].intersects(lines[id(straight_on)])
    ]
    assert list(straight_on.conflictingManeuvers) == expected
    assert {item.endLane.road for item in straight_on.reverseManeuvers} == {straight_on.startLane.road}
    for road in crossing.roads:
        assert road._successor is inter
        assert road.forwardLanes is not None
        assert road.forwardLanes._successor is inter


def test_turn_types_follow_the_accumulated_angle() -> None:
    from scenic.domains.driving.enumerations import turned

    angles = np.linspace(0, math.radians(200), 50)
    assert turned(np.stack([np.cos(angles), np.sin(angles)], axis=1)) == pytest.approx(
        math.radians(196), abs=0.05
    )


def test_lookups_agree_with_shapely(crossing: Network) -> None:
    rng = np.random.default_rng(3)
    places = rng.uniform(-80, 80, (4000, 2))
    finder = Finder(crossing.lanes, crossing.tolerance)
    found = finder.near(places)
    for place, index in zip(places, found, strict=True):
        point = shapely.Point(place)
        inside = [i for i, lane in enumerate(crossing.lanes) if lane.polygon.intersects(point)]
        close = [
            i for i, lane in enumerate(crossing.lanes) if lane.polygon.distance(point) <= crossing.tolerance
        ]
        assert index == (inside or close or [len(crossing.lanes)])[0]


def test_road_direction_over_many_points_is_that_of_one(crossing: Network) -> None:
    rng = np.random.default_rng(4)
    points = np.column_stack([rng.uniform(-75, 75, (500, 2)), np.zeros(500)])
    headings, known = crossing.roadDirection.headings(points)
    assert known.all()
    for point, heading in zip(points, headings, strict=True):
        assert crossing.roadDirection.headings(point[None])[0][0] == heading
        element = crossing.findPointIn(tuple(point), (*crossing.intersections, *crossing.roads))
        expected = 0 if element is None else element.headings_at(point[None, :2])[0]
        assert heading == pytest.approx(expected)


def test_ways_against_traffic_are_divided_by_their_length(tmp_path: Path) -> None:
    """Along an arc, by steps of at most 5 m; by four steps the end of 60 m would be 2 m beside the lane's middle."""
    import scenic

    arc = piece(0, 0, 0, 100.0, '<arc curvature="0.005"/>')
    found = network(tmp_path, map_text([RoadText("1", 100.0, arc, two_way(False, False))]))
    [lane] = [item for item in found.lanes if item.sections[0].isForward]
    start = lane.line[-1]
    end = found.roadDirection.followFrom(Vector(*map(float, start), 0), -60)
    assert lane.centerline.distanceTo(end) < 1
    program = (
        f"param map = {str(tmp_path / 'map.xodr')!r}\nmodel scenic.domains.driving.model\n"
        f"ego = new Car following roadDirection from {tuple(map(float, start))} for Uniform(-60, -60.0),\n"
        "    with regionContainedIn None\n"
    )
    [scene] = scenic.scenarioFromString(program, mode2D=True).sample(1, seed=1)
    assert scene.egoObject.position.distanceTo(end) < 1e-9


def test_every_point_of_the_road_has_a_lane(crossing: Network) -> None:
    rng = np.random.default_rng(5)
    places = crossing.roadRegion.outline.sample(*rng.random((3, 5000)))
    assert (Finder(crossing.lanes, 0).holding(places) < len(crossing.lanes)).all()


def test_lanes_follow_links_through_sections(tmp_path: Path) -> None:
    """A lane that ends by merging leads into the lane that takes it up."""
    first = lanes(left="", right=lane(-1, after=-1) + lane(-2, after=-1))
    second = lanes(left="", right=lane(-1, before=-1)).replace('s="0"', 's="50"')
    found = network(tmp_path, map_text([RoadText("a-b", 100.0, line(0, 0, 0, 100), first + second)]))
    [road] = found.roads
    assert road.id == "a-b"
    merging, main = road.lanes
    assert [section.openDriveID for section in main.sections] == [-1, -1]
    assert main.sections[0].successor is main.sections[1]
    assert merging._successor is main
    assert merging.sections[0]._successor is main.sections[1]
    assert main.polygon.area == pytest.approx(350)
    assert road.is1Way


def clothoid(length: float, curvature: float) -> tuple[float, float]:
    """The end of a spiral that begins straight, by Fresnel integrals."""
    scale = math.sqrt(math.pi * length / curvature)
    sine, cosine = fresnel(length / scale)
    return scale * cosine, scale * sine


@pytest.mark.parametrize(
    ("shape", "length", "end"),
    [
        ('<arc curvature="0.02"/>', 50.0, (42.073549, 22.984884)),
        ('<spiral curvStart="0" curvEnd="0.04"/>', 50.0, clothoid(50.0, 0.04)),
        ('<poly3 a="0" b="0" c="0.01" d="0"/>', 20.0, None),
        ('<paramPoly3 aU="0" bU="50" cU="0" dU="0" aV="0" bV="0" cV="10" dV="0"/>', 51.3, None),
        (
            '<paramPoly3 pRange="arcLength" aU="0" bU="1" cU="0" dU="0" aV="0" bV="0" cV="0.004" dV="0"/>',
            50.0,
            None,
        ),
    ],
)
def test_every_kind_of_curve_makes_a_road(
    tmp_path: Path, shape: str, length: float, end: tuple[float, float] | None
) -> None:
    found = network(
        tmp_path, map_text([RoadText("1", length, piece(0, 0, 0, length, shape), two_way(False, False))])
    )
    [road] = found.roads
    assert shapely.LineString(road.line).length == pytest.approx(length, rel=2e-3)
    assert road.polygon.area == pytest.approx(7 * length, rel=5e-3)
    if end is not None:
        assert road.line[-1] == pytest.approx(end, abs=2e-3)


def test_signals_count_where_they_are_valid(tmp_path: Path) -> None:
    """A light that is valid for no lane of its own road counts where other roads refer to it, as exporters write it."""
    light = '<signal id="5" s="1" t="4" type="1000001" country="OpenDRIVE" orientation="+"><validity fromLane="0" toLane="0"/></signal>'
    reference = '<signals><signalReference id="5" s="9" t="0" orientation="+"/></signals>'
    far = RoadText("8", 20.0, line(500, 0, 0, 20), rest=f"<signals>{light}</signals>")
    text = (
        cross()
        .replace("</lanes></road>", f"</lanes>{reference}</road>", 1)
        .replace("<junction", f"{far}<junction", 1)
    )
    found = network(tmp_path, text)
    assert found.problems == ()
    [inter] = found.intersections
    assert inter.hasTrafficLights
    assert [signal.openDriveID for signal in inter.signals] == ["5"]
    assert found.elements["road8"].signals == ()


BROKEN = {
    "namespace": map_text([RoadText("1", 20.0, line(0, 0, 0, 20))], namespace=' xmlns="http://code.asam.net/x"'),
    "length off": map_text(
        [RoadText("1", 40.0, line(0, 0, 0, 19.99) + line(20, 0, 0, 20, 20.0), two_way(False, False))]
    ),
    "zero length": map_text(
        [
            RoadText(
                "1", 20.0,
                piece(0, 0, 0, 0.0, '<spiral curvStart="0" curvEnd="1"/>') + line(0, 0, 0, 20), two_way(False, False),
            )
        ]
    ),
    "negative width": straight().replace('a="3.5" b="0"', 'a="3.5" b="-0.05"'),
    "no width": straight().replace('<width sOffset="0" a="2" b="0" c="0" d="0"/>', "", 1),
    "border": straight().replace('width sOffset="0" a="2"', 'border sOffset="0" a="5.5"', 1),
    "user data first": straight().replace("<line/>", "<userData/><line/>"),
    "first s not 0": straight().replace('s="0.0" x', 's="5.0" x'),
    "missing link": straight(link='<successor elementType="road" elementId="77" contactPoint="start"/>'),
    "missing junction": straight(link='<successor elementType="junction" elementId="77"/>'),
    "lane twice": straight().replace('<lane id="-1"', '<lane id="-1" type="driving"></lane><lane id="-1"'),
    "width twice": straight().replace("<width", '<width sOffset="0" a="3" b="0" c="0" d="0"/><width', 1),
    "width without a coefficient": straight().replace(' c="0"', "", 1),
    "late width": straight().replace('width sOffset="0"', 'width sOffset="20"', 1),
    "two shapes": straight().replace("<line/>", '<line/><arc curvature="1"/>'),
    "no type": straight().replace(' type="driving"', "", 1),
    "link without contact": straight(link='<successor elementType="road" elementId="1"/>'),
    "link without id": straight(link='<successor elementType="road" contactPoint="end"/>'),
    "two links": straight(link=2 * '<successor elementType="junction" elementId="77"/>'),
    "junction without connections": straight().replace("</OpenDRIVE>", '<junction id="3"/></OpenDRIVE>'),
}  # fmt: skip


@pytest.mark.parametrize("name", BROKEN)
def test_one_fault_costs_at_most_its_part(tmp_path: Path, name: str) -> None:
    found = network(tmp_path, BROKEN[name])
    assert len(found.roads) == 1
    assert found.roads[0].polygon.is_valid
    quiet = {"namespace", "border", "user data first"}
    assert (not found.problems) == (name in quiet), found.problems
    for problem in found.problems:
        assert problem.span is not None
        assert problem.code.startswith("SC62")


def test_numbers_out_of_all_measure_cost_their_road(tmp_path: Path) -> None:
    """A length that would take hours to sample leaves out the road, not the map."""
    endless = RoadText("2", 1e9, piece(0, 50, 0, 1e9, '<arc curvature="0.1"/>'))
    text = map_text([RoadText("1", 100.0, line(0, 0, 0, 100)), endless])
    found = network(tmp_path, text)
    assert [road.id for road in found.roads] == [1]
    assert "road 2 is left out" in found.problems[0].message


def test_linked_lanes_that_lie_apart_are_reported(tmp_path: Path) -> None:
    after = '<successor elementType="road" elementId="2" contactPoint="start"/>'
    before = '<predecessor elementType="road" elementId="1" contactPoint="end"/>'
    for gap, count, area in ((0.0, 0, 1400), (0.5, 0, 1403.5), (9.0, 1, 1400)):
        roads = [
            RoadText("1", 100.0, line(0, 0, 0, 100), link=after),
            RoadText("2", 100.0, line(100 + gap, 0, 0, 100), link=before),
        ]
        found = network(tmp_path, map_text(roads))
        assert len(found.problems) == count, found.problems
        assert all("though it leads into it" in problem.message for problem in found.problems)
        assert found.drivableRegion.area == pytest.approx(area)
        without = network(tmp_path, map_text(roads), fill_gaps=False)
        assert without.drivableRegion.area == pytest.approx(1400)


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("", "not well-formed"),
        ("<osm/>", "root of the file is <osm>"),
        ("<OpenDRIVE><road", "not well-formed"),
        ("<OpenDRIVE/>", "no road"),
        (straight().replace('type="driving"', 'type="median"'), "no lane for traffic"),
        ('<!DOCTYPE a [<!ENTITY b "c">]><OpenDRIVE>&b;</OpenDRIVE>', "entity"),
        (straight().replace("3.5", "0"), "no lane for traffic"),
    ],
)
def test_what_is_no_map_is_one_error(tmp_path: Path, text: str, message: str) -> None:
    with pytest.raises(MapError, match=message) as caught:
        network(tmp_path, text)
    assert caught.value.filename is not None


def test_files_that_are_not_there(tmp_path: Path) -> None:
    (tmp_path / "town.xodr").write_text(straight())
    assert len(Network.fromFile(tmp_path / "town").roads) == 1
    with pytest.raises(FileNotFoundError, match=r"there are town\.xodr"):
        Network.fromFile(tmp_path / "city.xodr")
    with pytest.raises(IsADirectoryError):
        Network.fromFile(tmp_path)
    with pytest.raises(ValueError, match="not a map that scenic reads"):
        Network.fromFile(tmp_path / "town.osm")
    with pytest.raises(TypeError, match="did you mean 'tolerance'"):
        Network.fromFile(tmp_path / "town.xodr", tolerence=1)


def test_crossings_come_from_crosswalks(tmp_path: Path) -> None:
    corners = "".join(
        f'<cornerRoad id="{i}" s="{s}" t="{t}" dz="0" height="1"/>'
        for i, (s, t) in enumerate([(48, -3.5), (52, -3.5), (52, 3.5), (48, 3.5)])
    )
    objects = f'<objects><object type="crosswalk" id="4" s="50" t="0"><outline>{corners}</outline></object></objects>'
    found = network(tmp_path, straight(rest=objects))
    [crossing] = found.crossings
    assert crossing.polygon.area == pytest.approx(28)
    assert crossing.vehicleTypes == {VehicleType.PEDESTRIAN}
    assert crossing.parent is found.roads[0]
    assert {crossing.startSidewalk, crossing.endSidewalk} == set(found.sidewalks)
    assert found.crossingAt((50, 0)) is crossing
    assert found.walkableRegion.area == pytest.approx(428)


def test_speed_limits_and_tags(tmp_path: Path) -> None:
    found = network(tmp_path, straight(rest='<type s="0" type="town"><speed max="36" unit="km/h"/></type>'))
    assert found.lanes[0].speedLimit == pytest.approx(10)
    assert found.roads[0].tags == {"town"}


def test_elevation_is_that_of_the_profile(tmp_path: Path) -> None:
    rest = '<elevationProfile><elevation s="0" a="2" b="0.1" c="0" d="0"/></elevationProfile>'
    found = network(tmp_path, straight(rest=rest))
    assert found.elevationAt((50, 1, 0)) == pytest.approx(7)
    assert found.elevationAt((50, 100, 0)) is None


def test_drawings_show_all_elements(crossing: Network) -> None:
    from xml.etree import ElementTree

    root = ElementTree.fromstring(crossing.svg())
    titles = {item.text for item in root.iter("{http://www.w3.org/2000/svg}title")}
    assert {road.uid for road in crossing.allRoads} <= titles


def _variants(text: str, count: int, seed: int) -> list[str]:
    """Copies of a map, each with one thing broken: attributes dropped, numbers not finite, elements repeated or cut."""
    rng = random.Random(seed)
    attributes = list(re.finditer(r' (\w+)="([^"]*)"', text))
    elements = list(re.finditer(r"<(\w+)[^<>]*/>", text))
    made = []
    for _ in range(count):
        item = rng.choice(attributes)
        kind = rng.randrange(5)
        if kind == 0:
            made.append(text[: item.start()] + text[item.end() :])
        elif kind == 1:
            value = rng.choice(["nan", "inf", "-1e300", "", "x", "1e9"])
            made.append(text[: item.start(2)] + value + text[item.end(2) :])
        elif kind == 2:
            item = rng.choice(elements)
            made.append(text[: item.end()] + item[0] + text[item.end() :])
        elif kind == 3:
            item = rng.choice(elements)
            made.append(text[: item.start()] + text[item.end() :])
        else:
            made.append(text[: rng.randrange(len(text))])
    return made


@pytest.mark.parametrize("seed", range(4))
def test_broken_variants_give_no_traceback(tmp_path: Path, seed: int) -> None:
    for text in _variants(cross(), 30, seed):
        try:
            found = network(tmp_path, text)
        except MapError:
            continue
        assert all(element.polygon.is_valid for element in found.elements.values())


@pytest.mark.skipif(MAPS is None, reason="needs SCENIC_TEST_MAPS, the folder of real maps")
@pytest.mark.parametrize(
    ("town", "lanes", "elements", "areas"),
    [
        ("Town02", 88, 504, (10_019, 8_449, 1_570)),
        ("Town06", 424, None, (85_541, 66_562, 18_979)),
        ("Town07", 280, None, (19_761, 14_835, 4_928)),
        ("Town10HD", 168, None, (17_370, 10_874, 6_496)),
        ("Town04", 454, None, (108_661, 86_738, 21_950)),
    ],
)
def test_real_towns(town: str, lanes: int, elements: int | None, areas: tuple[float, float, float]) -> None:
    found = Network.fromFile(Path(MAPS or "") / f"{town}.xodr")
    assert len(found.lanes) == lanes
    assert elements is None or len(found.elements) == elements
    regions = (found.drivableRegion, found.roadRegion, found.intersectionRegion)
    for region, area in zip(regions, areas, strict=True):
        assert region.area == pytest.approx(area, rel=0.005)
    places = found.roadRegion.outline.sample(*np.random.default_rng(6).random((3, 20_000)))
    assert (Finder(found.lanes, found.tolerance).near(places) < len(found.lanes)).all()


@pytest.mark.skipif(MAPS is None, reason="needs SCENIC_TEST_MAPS, the folder of real maps")
@pytest.mark.parametrize(("town", "lights"), [("Town01", 12), ("Town04", 12)])
def test_traffic_lights_of_real_towns(town: str, lights: int) -> None:
    found = Network.fromFile(Path(MAPS or "") / f"{town}.xodr")
    assert sum(inter.isSignalized for inter in found.intersections) == lights
