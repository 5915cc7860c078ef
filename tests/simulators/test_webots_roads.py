"""Roads and guideways of Webots worlds: worlds of our own, with directions and regions derived by hand."""

import json
import math
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from scipy.spatial.transform import Rotation
from shapely.geometry import Point

import scenic
from scenic.formats.webots_reading import WorldError, read_world
from scenic.language.errors import InvalidScenarioError
from scenic.simulators.webots.road.streets import streets_of

HEAD = """from scenic.simulators.webots.road.world import setLocalWorld
setLocalWorld(__file__, 'town.wbt')
from scenic.simulators.webots.road.model import *
"""

CROSSING = """#VRML_SIM R2023a utf8
EXTERNPROTO "webots://projects/objects/road/protos/Road.proto"
WorldInfo { info [ "a crossing" ] basicTimeStep 16 }
Viewpoint { position 0 0 50 }
DEF WEST Road {  # three lanes, two of them eastwards
  translation -50 0 0.02
  id "1"
  width 9
  numberOfLanes 3
  numberOfForwardLanes 2
  wayPoints [ 0 0 0, 40.02 0 0 ]
}
Road { translation 0 10 0 id "2" width 6 wayPoints [ 0 0 0 0 40 0 ] rightBorder FALSE roadBorderWidth [ 2 ] }
Crossroad {
  id "3"
  shape [ -10 -4.5 0 10 -4.5 0 10 10 0 -10 10 0 -10 4.5 0 ]
  connectedRoadIDs [ "1" "2" ]
}
Group { children [ PedestrianCrossing { translation 0 20 0 rotation 0 0 1 1.5707963267948966 size 3 8 } ] }
"""

RING = """#VRML_SIM R2023a utf8
WorldInfo { }
CurvedRoadSegment { id "a" width 8 curvatureRadius 30 totalAngle 3.141592653589793 subdivision 64 }
CurvedRoadSegment { id "b" rotation 0 0 1 3.141592653589793 width 8 curvatureRadius 30 totalAngle 3.141592653589793 subdivision 64 }
StraightRoadSegment { id "c" translation 34 0 0 width 8 length 20 }
"""


def direction(lanes: Any, x: float, y: float) -> float | None:
    """The heading, in degrees, of the lane at a place."""
    found = [math.degrees(heading) for polygon, heading in lanes if polygon.contains(Point(x, y))]
    return found[0] if found else None


def streets(folder: Path, text: str) -> Any:
    (folder / "town.wbt").write_text(text)
    return streets_of(read_world(folder / "town.wbt"))


def compiled(folder: Path, world: str, text: str) -> scenic.Scenario:
    (folder / "town.wbt").write_text(world)
    return scenic.scenarioFromString(HEAD + text, filename=str(folder / "program.scenic"), mode2D=True)


def test_a_crossing(tmp_path: Path) -> None:
    found = streets(tmp_path, CROSSING)
    west, north = found.streets
    # Lanes of 3 m from y = -4.5: two to the east (heading -90), one to the west.
    assert [direction(west.lanes, -30, y) for y in (-3, 0, 3)] == pytest.approx([-90, -90, 90])
    # North: traffic keeps right.
    assert direction(north.lanes, 1.5, 30) == pytest.approx(0)
    assert abs(direction(north.lanes, -1.5, 30) or 0) == pytest.approx(180)
    # The ends of the borders, 2 cm beyond the crossroad, are moved to its corners.
    assert west.surface.bounds == pytest.approx((-50, -4.5, -10, 4.5))
    assert west.curbs[0][-1] == pytest.approx((-10, -4.5))
    # Both curbs run with their traffic.
    assert west.curbs[1][0] == pytest.approx((-10, 4.5))
    assert [each.bounds for each in west.sidewalks] == [
        pytest.approx((-50, -5.3, -9.98, -4.5)),
        pytest.approx((-50, 4.5, -9.98, 5.3)),
    ]
    assert [each.bounds for each in north.sidewalks] == [pytest.approx((-5, 10, -3, 50))]
    (crossing,) = found.crossings
    assert crossing.bounds == pytest.approx((-4, 18.5, 4, 21.5))


def test_a_ring(tmp_path: Path) -> None:
    found = streets(tmp_path, RING)
    lanes = [lane for street in found.streets for lane in street.lanes]
    # Anticlockwise outside (right of the way), clockwise inside.
    for angle in (0.5, 2.0, 4.0, 5.5):
        for radius, turn in ((32, 0.0), (28, 180.0)):
            heading = direction(lanes, radius * math.cos(angle), radius * math.sin(angle))
            assert heading is not None
            gap = (heading - math.degrees(angle) - turn + 180) % 360 - 180
            assert abs(gap) < 2
    area = sum(street.surface.area for street in found.streets[:2])
    assert area == pytest.approx(math.pi * (34**2 - 26**2), rel=1e-3)
    assert found.streets[2].surface.bounds == pytest.approx((34, -4, 54, 4))


def test_traffic_keeps_left(tmp_path: Path) -> None:
    found = streets(tmp_path, CROSSING.replace('"a crossing"', '"England" "left-hand traffic"'))
    assert [direction(found.streets[0].lanes, -30, y) for y in (-3, 0, 3)] == pytest.approx([90, -90, -90])


@pytest.mark.parametrize(
    ("header", "axes", "places"),
    [
        ("R2023a", None, lambda x, y: f"{x} {y} 7"),
        ("R2021b", None, lambda x, y: f"{y} 7 {x}"),
        ("R2023a", "NUE", lambda x, y: f"{y} 7 {x}"),
        ("R2023a", "EUN", lambda x, y: f"{x} 7 {y}"),
    ],
)
def test_axes(tmp_path: Path, header: str, axes: str | None, places: Any) -> None:
    """A road from (5, 10) to the north, whatever the axes; the heights of 7 m and 14 m are dropped."""
    info = "" if axes is None else f'coordinateSystem "{axes}"'
    text = (
        f'#VRML_SIM {header} utf8\nWorldInfo {{ {info} }}\nRoad {{ id "1" width 6 translation {places(5, 10)}'
        f" wayPoints [ {places(0, 0)} {places(0, 30)} ] }}\n"
    )
    (street,) = streets(tmp_path, text).streets
    assert street.surface.bounds == pytest.approx((2, 10, 8, 40))
    assert direction(street.lanes, 6, 20) == pytest.approx(0)


def test_scenes(tmp_path: Path) -> None:
    scenario = compiled(
        tmp_path,
        CROSSING,
        "ego = new SmallCar on nonIntersection\nbus = new Bus on nonIntersection\nwalker = new Pedestrian\n"
        "cone = new TrafficCone on intersection\nbike = new Motorcycle with roadDeviation 10 deg\n"
        "new OilBarrel on sidewalk\nnew WorkBarrier on curb\nnew SolidBox on crossing\n",
    )
    found = streets(tmp_path, CROSSING)
    lanes = [lane for street in found.streets for lane in street.lanes]
    for scene in scenario.sample(5, seed=1):
        ego, bus, walker, cone, bike, *_ = scene.objects
        for car in (ego, bus):
            heading = direction(lanes, car.position.x, car.position.y)
            assert heading is not None
            assert math.cos(car.heading - math.radians(heading)) == pytest.approx(1)
        assert (bus.width, bus.length, bus.webotsType) == (3, 10, "Bus")
        assert ego.model.name in {"BmwX5", "CitroenCZero", "LincolnMKZ", "RangeRoverSportSVR", "ToyotaPrius"}
        assert tuple(ego.cameraOffset) == (0, ego.length / 2, 0)
        assert found.crossroads[0].contains(Point(cone.position.x, cone.position.y))
        assert bike.width == 1
        places = [*found.streets[0].sidewalks, *found.streets[1].sidewalks, *found.crossings]
        assert any(each.buffer(1e-6).contains(Point(walker.position.x, walker.position.y)) for each in places)


@pytest.mark.parametrize("axes", ["ENU", "NUE", "EUN"])
def test_scenes_are_added_to_their_world(tmp_path: Path, axes: str) -> None:
    """Read back, poses agree, and the world's own nodes are as they were."""
    world = CROSSING
    if axes != "ENU":
        world = f'#VRML_SIM R2023a utf8\nWorldInfo {{ coordinateSystem "{axes}" }}\nRoad {{ id "1" wayPoints [ 0 0 0 50 0 0 ] }}\n'
    scenario = compiled(tmp_path, world, "ego = new BmwX5 on nonIntersection\nnew TrafficCone on road\n")
    scene = scenario.sample(1, seed=2)[0]
    scene.save(tmp_path / "out.wbt")
    written, before = read_world(tmp_path / "out.wbt"), read_world(tmp_path / "town.wbt")
    own = [node for node in written.nodes if node.kind not in ("BmwX5", "TrafficCone")]
    assert own == list(before.nodes)
    if axes == "ENU":
        assert 'EXTERNPROTO "webots://projects/vehicles/protos/bmw/BmwX5.proto"' in written.text
    for kind, thing in zip(("BmwX5", "TrafficCone"), scene.objects, strict=True):
        (node,) = written.of(kind)
        place = written.matrix.T @ node.vector("translation", ())
        assert place == pytest.approx(tuple(thing.position), abs=1e-6)
        *axis, angle = node.vector("rotation", ())
        turn = written.matrix.T @ Rotation.from_rotvec(np.array(axis) * angle).as_matrix() @ written.matrix
        # What is ahead of a vehicle is along the axis that points east.
        ahead = turn @ ((1, 0, 0) if kind == "BmwX5" else (0, 1, 0))
        assert ahead == pytest.approx((-math.sin(thing.heading), math.cos(thing.heading), 0), abs=1e-6)


@pytest.mark.parametrize(
    ("world", "message"),
    [
        ("", "not a world of Webots"),
        ("#VRML_SIM R2023a utf8\nRoad { id \n", "the file ends within a node"),
        ('#VRML_SIM R2023a utf8\nRoad { id "1" wayPoints [ 0 0 0 ] }\n', "1 way points"),
        ('#VRML_SIM R2023a utf8\nRoad { id "1" wayPoints [ 0 0 ] }\n', "three for each point"),
        ("#VRML_SIM R2023a utf8\nWorldInfo { }\n", "has no roads"),
        ('#VRML_SIM R2023a utf8\nWorldInfo { coordinateSystem "XYZ" }\n', "coordinate system"),
    ],
)
def test_worlds_that_cannot_be_used(tmp_path: Path, world: str, message: str) -> None:
    with pytest.raises(InvalidScenarioError, match=message) as caught:
        compiled(tmp_path, world, "ego = new Car\n")
    assert caught.value.code == "SC620"


def test_a_program_without_a_world(tmp_path: Path) -> None:
    with pytest.raises(RuntimeError, match="has not set a world"):
        scenic.scenarioFromString(
            "from scenic.simulators.webots.road.model import *\nego = new Car\n", mode2D=True
        )
    with pytest.raises(RuntimeError, match="has not set an intersection"):
        scenic.scenarioFromString("from scenic.simulators.webots.guideways.model import *\n", mode2D=True)
    with pytest.raises(WorldError, match="cannot be read"):
        read_world(tmp_path / "missing.wbt")


def test_guideways(tmp_path: Path) -> None:
    """At the equator a thousandth of a degree is 111.32 m to the east and 110.57 m to the north."""

    def way(id: int, *, west: bool = False) -> dict[str, Any]:
        low, high = (0.00003, 0.00006) if west else (0, 0.00003)
        line = [(0.0, 0.001), (0.0, 0.0)] if west else [(0.0, 0.0), (0.0, 0.001)]
        left, right = (low, high) if west else (high, low)
        return {
            "id": id,
            "direction": "straight",
            "origin_lane": {"lane_id": id},
            "median": line,
            "left_border": [(left, longitude) for _, longitude in line],
            "right_border": [(right, longitude) for _, longitude in line],
        }

    data = {
        "main_gw": way(1),
        "vehicle_gw": [way(2, west=True)],
        "bicycle_gw": [],
        "rail_gw": [],
        "crosswalks": [way(3)],
        "conflict_zones": [{"polygon": [(0, 0), (0, 0.0001), (0.0001, 0.0001)]}],
    }
    (tmp_path / "x.json").write_text(json.dumps(data))
    scenario = scenic.scenarioFromString(
        "from scenic.simulators.webots.guideways.intersection import setLocalIntersection\n"
        "setLocalIntersection(__file__, 'x.json')\nfrom scenic.simulators.webots.guideways.model import *\n"
        "ego = new Car on intersection.mainGuideway.region\nother = new Car on intersection.guidewayWithID(2).region\n"
        "new Marker on intersection.crosswalks[0]\nparam bounds = road.polygons.bounds\n",
        filename=str(tmp_path / "program.scenic"),
        mode2D=True,
    )
    scene = scenario.sample(1, seed=1)[0]
    ego, other, marker = scene.objects
    assert scene.params["bounds"] == pytest.approx((0, 0, 111.32, 6.634), abs=0.01)
    assert (math.degrees(ego.heading), math.degrees(other.heading)) == pytest.approx((-90, 90))
    assert 0 <= ego.position.y <= 3.32 <= other.position.y <= 6.64
    assert 0 <= marker.position.y <= 3.32
    (tmp_path / "x.json").write_text(json.dumps({**data, "main_gw": {}}))
    with pytest.raises(InvalidScenarioError, match="`median` is missing"):
        scenic.scenarioFromString(
            "from scenic.simulators.webots.guideways.intersection import setLocalIntersection\n"
            "setLocalIntersection(__file__, 'x.json')\nfrom scenic.simulators.webots.guideways.model import *\n",
            filename=str(tmp_path / "program.scenic"),
            mode2D=True,
        )
