"""Roads in space: what stands on them, against the polynomials of the file, evaluated by hand."""

import math
import os
from collections import Counter
from pathlib import Path
from xml.etree import ElementTree

import numpy as np
import pytest

import scenic
from scenic.domains.driving.elevation import Elevation
from scenic.domains.driving.roads import Network
from scenic.runtime.values.values import vector
from tests.maps import RoadText, line, map_text, piece, straight, two_way

MAPS = os.environ.get("SCENIC_TEST_MAPS")
MODEL = "model scenic.simulators.newtonian.driving_model\n"


def cubic(tag: str, *rows: tuple[float, ...]) -> str:
    return "".join(f'<{tag} s="{s}" a="{a}" b="{b}" c="{c}" d="{d}"/>' for s, a, b, c, d in rows)


def heights(profile: str = "", lateral: str = "") -> str:
    elevation = f"<elevationProfile>{profile}</elevationProfile>" if profile else ""
    return elevation + (f"<lateralProfile>{lateral}</lateralProfile>" if lateral else "")


def scenario(tmp_path: Path, text: str, program: str, **options: object) -> scenic.Scenario:
    path = tmp_path / "map.xodr"
    path.write_text(text)
    return scenic.scenarioFromString(MODEL + program, params={"map": str(path)}, **options)


PROFILE = ((0.0, 2.0, 0.0, 0.001, 0.0), (40.0, 3.6, 0.08, -0.0015, 0.00001))
TILT = ((0.0, 0.02, 0.001, 0.0, 0.0), (50.0, 0.07, -0.002, 0.0, 0.0))
CURVATURE = 1 / 60


def value(rows: tuple[tuple[float, ...], ...], s: float) -> float:
    start, a, b, c, d = [row for row in rows if row[0] <= s][-1]
    ds = s - start
    return a + b * ds + c * ds**2 + d * ds**3


def surface(x: float, y: float) -> float:
    """The height of the curved road of `curved` at a place: it turns left about (0, 60)."""
    angle = math.atan2(x, 60 - y)
    s, t = 60 * angle, 60 - math.hypot(x, 60 - y)
    return value(PROFILE, s) + t * math.tan(value(TILT, s))


def curved() -> str:
    shape = piece(0, 0, 0, 90.0, f'<arc curvature="{CURVATURE!r}"/>')
    rest = heights(cubic("elevation", *PROFILE), cubic("superelevation", *TILT))
    return map_text([RoadText("1", 90.0, shape, two_way(False, False), rest=rest)])


def normal(x: float, y: float) -> np.ndarray:
    step = 1e-4
    slope = [
        (surface(x + step, y) - surface(x - step, y)) / (2 * step),
        (surface(x, y + step) - surface(x, y - step)) / (2 * step),
    ]
    found = np.array([-slope[0], -slope[1], 1.0])
    return found / np.linalg.norm(found)


def test_things_stand_on_a_curved_and_tilted_road(tmp_path):
    """By every way to be placed: base point on the surface, vertical along its normal, heading along the lane."""
    found = scenario(
        tmp_path,
        curved(),
        "ego = new Car\n"
        "new Car on Uniform(*network.lanes).centerline, with regionContainedIn everywhere, with allowCollisions True\n"
        "new Car on Uniform(*network.lanes), with regionContainedIn everywhere, with allowCollisions True\n"
        "new Car on road, with regionContainedIn everywhere, with allowCollisions True\n"
        "new Pedestrian on sidewalk, with regionContainedIn everywhere, with allowCollisions True\n"
        "new Car on ego.lane, with regionContainedIn everywhere, with allowCollisions True\n",
    )
    pitches = []
    for scene in found.sample(12, seed=1):
        for thing in scene.objects:
            up = np.array(tuple(thing.position.offsetRotated(thing.orientation, vector(0, 0, 1)))) - tuple(
                thing.position
            )
            base = np.array(tuple(thing.position)) - up * (thing.height / 2)
            assert base[2] == pytest.approx(surface(base[0], base[1]), abs=2e-3)
            np.testing.assert_allclose(up, normal(base[0], base[1]), atol=2e-3)
            pitches.append(thing.orientation.pitch)
            across = 60 - math.hypot(base[0], 60 - base[1])
            if thing.isVehicle and abs(across) > 0.1:
                east = math.atan2(base[0], 60 - base[1])
                wanted = east + math.copysign(math.pi / 2, across)  # the right lane goes with the road
                assert math.cos(thing.orientation.yaw - wanted) > 0.999
    assert max(pitches) - min(pitches) > 0.1


def test_the_height_is_that_of_the_polynomials(tmp_path):
    path = tmp_path / "map.xodr"
    path.write_text(curved())
    network = Network.fromFile(path)
    assert not network.is_elevated
    for share in np.linspace(0.02, 0.98, 25):
        for across in (-5.4, -1.0, 0.3, 5.4):
            angle = share * 1.5
            radius = 60 - across
            x, y = radius * math.sin(angle), 60 - radius * math.cos(angle)
            assert network.elevationAt((x, y)) == pytest.approx(surface(x, y), abs=1e-4)


def test_crossfall_falls_outwards(tmp_path):
    lateral = '<crossfall side="right" s="0" a="0" b="0" c="0" d="0"/><crossfall side="left" s="0" a="0.05" b="0" c="0" d="0"/><crossfall side="both" s="50" a="0.02" b="0" c="0" d="0"/>'
    text = straight(100.0, rest=heights("", lateral))
    path = tmp_path / "map.xodr"
    path.write_text(text)
    network = Network.fromFile(path)
    for x, y, wanted in (
        (20, 3, -3 * math.tan(0.05)),
        (20, -3, 0),
        (80, 3, -3 * math.tan(0.02)),
        (80, -3, -3 * math.tan(0.02)),
    ):
        assert network.elevationAt((x, y)) == pytest.approx(wanted, abs=1e-9)


def test_shapes_across_are_added_and_go_over_into_each_other(tmp_path):
    rows = (  # s, t, and the cubic of the distance from t
        (20.0, -4.0, 0.1, 0.05, 0.0, 0.0),
        (20.0, 0.0, 0.3, -0.02, -0.01, 0.002),
        (60.0, -2.0, 0.0, 0.1, 0.02, -0.01),
    )
    lateral = cubic("superelevation", *TILT) + "".join(
        f'<shape s="{s}" t="{t}" a="{a}" b="{b}" c="{c}" d="{d}"/>' for s, t, a, b, c, d in rows
    )
    path = tmp_path / "map.xodr"
    path.write_text(straight(100.0, rest=heights(cubic("elevation", *PROFILE), lateral)))
    network = Network.fromFile(path)
    assert not network.problems

    def across(place: float, t: float) -> float:
        cubics = [row[1:] for row in rows if row[0] == place]
        return value(tuple(cubics), t) if t >= cubics[0][0] else cubics[0][1]

    def surface(s: float, t: float) -> float:
        share = min(max((s - 20) / 40, 0), 1)
        shape = (1 - share) * across(20.0, t) + share * across(60.0, t)
        return value(PROFILE, s) + t * math.tan(value(TILT, s)) + shape

    for s, t in ((5, 3), (20, -3), (35, 1), (35, -3), (59, -1), (80, 3), (80, -3.4)):
        assert network.elevationAt((s, t)) == pytest.approx(surface(s, t), abs=1e-9)
        step = 1e-5
        wanted = [surface(s + step, t) - surface(s - step, t), surface(s, t + step) - surface(s, t - step)]
        (found,) = network.levels.elevation.gradients(np.array([0]), np.array([[s, t]]))
        if s != 20:
            assert found == pytest.approx(np.array(wanted) / (2 * step), abs=1e-6)


def bridge() -> str:
    """Road 2 passes 6 m above road 1."""
    roads = [
        RoadText("1", 100.0, line(0, 0, 0, 100), two_way(False, False)),
        RoadText(
            "2",
            100.0,
            line(50, -50, math.pi / 2, 100),
            two_way(False, False),
            rest=heights(cubic("elevation", (0.0, 6.0, 0.0, 0.0, 0.0))),
        ),
    ]
    return map_text(roads)


def test_a_bridge_and_the_road_below_are_two_places(tmp_path):
    free = ", with regionContainedIn everywhere, with allowCollisions True"
    found = scenario(
        tmp_path,
        bridge(),
        f"ego = new Car on road{free}\n"
        f"new Car on network.elements['road1'].lanes[0]{free}\n"
        f"new Car on network.elements['road2'].lanes[0]{free}\n"
        "require abs(ego.position.x - 50) < 3.5 and abs(ego.position.y) < 3.5\n"
        "param lane = ego.lane.road.uid\n",
    )
    network = found.workspace.network
    one, two = network.elements["road1"], network.elements["road2"]
    assert {frozenset(pair) for pair in network.levels.pairs} == {frozenset({0, 1})}
    where = Counter()
    for scene in found.sample(60, seed=1):
        ego, low, high = scene.objects
        level = "road1" if ego.position.z < 3 else "road2"
        where[level] += 1
        assert scene.params["lane"] == level
        assert ego.lane.road.uid == level
        assert (low.position.z, high.position.z) == (
            pytest.approx(0.75, abs=1e-3),
            pytest.approx(6.75, abs=1e-3),
        )
        assert (one.containsPoint(low.position), two.containsPoint(low.position)) == (True, False)
        assert (one.containsPoint(high.position), two.containsPoint(high.position)) == (False, True)
    # Both decks have the same area there: 60 draws, within four standard deviations.
    assert 15 <= where["road1"] <= 45
    at = vector(50, 0, 5.5)
    assert network.roadAt(at) is two
    assert network.roadAt(vector(50, 0, 0)) is one
    assert float(one.distanceTo(at)) == pytest.approx(1.0)  # of 5.5 m, 4.5 count as room above the road
    assert float(two.distanceTo(at)) == 0
    assert network.drivableRegion.size == pytest.approx(2 * 700)
    points = np.random.default_rng(1).uniform((0, -50, -6), (100, 50, 12), (400, 3))
    for element in (one, two, two.lanes[0]):
        height = network.levels.elevation.heights(
            np.full(len(points), network.road_number(element.uid[:5])), element.nearest(points)[:, :2]
        )
        above = np.maximum(np.abs(points[:, 2] - height) - 4.5, 0)
        assert element.distances(points) == pytest.approx(np.hypot(element.beside(points), above))


@pytest.mark.parametrize(("height", "is_in_the_way"), [(6.75, False), (0.75, True)])
def test_who_stands_on_a_bridge_is_not_in_the_way_below_it(tmp_path, height, is_in_the_way):
    found = scenario(
        tmp_path,
        bridge(),
        "model scenic.simulators.newtonian.driving_model\nfrom scenic.domains.driving.measures import bumper_gap\n"
        "ego = new Car at (10, -1.75, 0.75), facing -90 deg, with speed 10, with behavior FollowLaneBehavior(10, follow_gap=1.5)\n"
        f"other = new Car at (50, -1.75, {height}), facing -90 deg\n"
        "record initial bumper_gap(ego, other) as gap\n",
    )
    done = found.getSimulator().simulate(found.sample(1, seed=1)[0], maxSteps=60)
    speeds = np.diff([state.positions[0].x for state in done.trajectory]) * 10
    assert (speeds.min() < 2) == is_in_the_way
    assert done.result.records["gap"] == pytest.approx(35.5 if is_in_the_way else math.inf, abs=1e-3)


def test_following_the_direction_of_traffic_goes_uphill(tmp_path):
    text = straight(100.0, rest=heights(cubic("elevation", (0.0, 0.0, 0.1, 0.0, 0.0))))
    found = scenario(
        tmp_path,
        text,
        "ego = new Car on network.roads[0].forwardLanes.lanes[0].centerline, with regionContainedIn everywhere\n"
        "new Car following roadDirection from ego for 20, with regionContainedIn everywhere\n"
        "require ego.position.x < 70\n",
    )
    for scene in found.sample(5, seed=2):
        ego, other = scene.objects
        assert math.dist(tuple(ego.position), tuple(other.position)) == pytest.approx(20, abs=1e-6)
        assert other.position.z - ego.position.z == pytest.approx(20 * math.sin(math.atan(0.1)), abs=1e-6)
        assert other.orientation.pitch == pytest.approx(math.atan(0.1))


def test_points_of_a_random_lane_lie_on_the_ground(tmp_path):
    """Computed over lanes, they are what calls on the drawn lane give."""
    text = straight(100.0, rest=heights(cubic("elevation", (0.0, 0.0, 0.1, 0.0, 0.0))))
    found = scenario(
        tmp_path,
        text,
        "line, way = Uniform(*network.lanes).centerline, Range(-50, 50)\n"
        "ego = new Car on road\n"
        "param line = line, way = way, along = line.pointAlongBy(way), beside = line.project(ego.position)\n"
        "param closest = line.closestPointTo(ego.position), signed = line.signedDistanceTo(ego.position)\n",
    )
    for scene in found.sample(20, seed=2):
        (ego,), given = scene.objects, scene.params
        line = given["line"]
        assert given["along"] == line.pointAlongBy(given["way"])
        assert given["along"].z == pytest.approx(given["along"].x * 0.1)
        assert given["beside"] == given["closest"] == line.project(ego.position)
        assert given["beside"].z == pytest.approx(given["beside"].x * 0.1)
        assert given["signed"] == line.signedDistanceTo(ego.position)
        assert abs(given["signed"]) == pytest.approx(math.dist(given["beside"][:2], ego.position[:2]))


def test_a_car_drives_up_a_hill(tmp_path):
    text = straight(200.0, rest=heights(cubic("elevation", (0.0, 0.0, 0.0, 0.0005, 0.0))))
    found = scenario(
        tmp_path,
        text,
        "ego = new Car on network.roads[0].forwardLanes.lanes[0].centerline, with speed 10, with behavior FollowLaneBehavior(target_speed=10)\n"
        "require ego.position.x < 40\n",
    )
    scene, _ = found.generate(maxIterations=100)
    simulation = found.getSimulator().simulate(scene, maxSteps=60)
    for state in simulation.trajectory:
        x, _, z = state.positions[0]
        # The middle is half a metre off the road along its normal when it starts; it keeps its height.
        assert z == pytest.approx(0.0005 * x**2 + 0.75, abs=5e-3)
    assert simulation.trajectory[-1].orientations[0].pitch == pytest.approx(math.atan(0.001 * x), abs=1e-2)
    assert x > 60


def test_many_points_are_drawn_at_once(tmp_path, monkeypatch):
    """Heights are asked for in columns: a few calls, however many the scenes are."""
    found = scenario(
        tmp_path,
        curved(),
        "ego = new Car\nnew Car on Uniform(*network.lanes).centerline, with allowCollisions True\n",
    )
    calls = []
    real = Elevation.heights
    monkeypatch.setattr(
        Elevation,
        "heights",
        lambda self, roads, places: calls.append(len(places)) or real(self, roads, places),
    )
    assert len(list(found.sample(400, seed=1))) == 400
    assert len(calls) < 100
    assert max(calls) >= 100


def test_flat_maps_have_no_levels_above_each_other(tmp_path):
    path = tmp_path / "map.xodr"
    path.write_text(straight(100.0))
    levels = Network.fromFile(path).levels
    assert levels.pairs == set()
    assert not levels.stacked(np.zeros((3, 2))).any()


def test_two_dimensions_refuse_heights(tmp_path):
    path = tmp_path / "map.xodr"
    path.write_text(curved())
    with pytest.raises(RuntimeError, match="flat"):
        scenic.scenarioFromString(
            MODEL + "ego = new Car", params={"map": str(path), "use2DMap": False}, mode2D=True
        )


# Real maps


class FileRoad:
    """A road as its file says: the reference line integrated in steps of 5 cm, its polynomials evaluated one by one."""

    def __init__(self, road: ElementTree.Element) -> None:
        rows = []
        for item in road.findall("planView/geometry"):
            s, x, y, heading, length = (float(item.get(name)) for name in ("s", "x", "y", "hdg", "length"))
            shape = item[0]
            first = float(shape.get("curvature", shape.get("curvStart", 0)))
            last = float(shape.get("curvature", shape.get("curvEnd", 0)))
            steps = max(2, math.ceil(length / 0.05))
            for index in range(steps):
                ds = length / steps
                along = (index + 0.5) * ds
                rows.append((s + index * ds, x, y, heading))
                middle = heading + (first + (last - first) * along / length) * ds / 2
                x, y = x + ds * math.cos(middle), y + ds * math.sin(middle)
                heading += (first + (last - first) * along / length) * ds
        self.rows = np.array(rows)
        self.profile = self.cubics(road.findall("elevationProfile/elevation"))
        self.tilt = self.cubics(road.findall("lateralProfile/superelevation"))

    @staticmethod
    def cubics(items):
        return tuple(
            tuple(float(item.get(name)) for name in ("s", "a", "b", "c", "d")) for item in items
        ) or ((0.0, 0.0, 0.0, 0.0, 0.0),)

    def height(self, x: float, y: float) -> float:
        s, px, py, heading = self.rows[np.hypot(self.rows[:, 1] - x, self.rows[:, 2] - y).argmin()]
        ahead = (x - px) * math.cos(heading) + (y - py) * math.sin(heading)
        left = (y - py) * math.cos(heading) - (x - px) * math.sin(heading)
        s = s + ahead
        return value(self.profile, max(s, self.profile[0][0])) + left * math.tan(
            value(self.tilt, max(s, self.tilt[0][0]))
        )


@pytest.mark.skipif(MAPS is None, reason="needs SCENIC_TEST_MAPS, the folder of real maps")
@pytest.mark.parametrize("name", ["Town04", "Town07"])
def test_cars_stand_on_real_roads(name):
    path = Path(MAPS) / f"{name}.xodr"
    roads = {road.get("id"): road for road in ElementTree.parse(path).getroot().findall("road")}
    found = scenic.scenarioFromString(
        MODEL + "lane = Uniform(*network.lanes)\n"
        "ego = new Car on lane.centerline, with regionContainedIn everywhere\n"
        "param road = lane.road.uid\n",
        params={"map": str(path)},
    )
    records = {}
    spread = []
    for scene in found.sample(40, seed=3):
        (car,) = scene.objects
        down = tuple(car.position.offsetRotated(car.orientation, vector(0, 0, -car.height / 2)))
        uid = scene.params["road"].removeprefix("road")
        if uid not in records:
            records[uid] = FileRoad(roads[uid])
        assert down[2] == pytest.approx(records[uid].height(down[0], down[1]), abs=5e-3)
        spread.append(down[2])
    assert max(spread) - min(spread) > 0.5
