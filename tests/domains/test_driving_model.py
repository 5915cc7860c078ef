"""The driving world model: where cars and pedestrians are, what they know of the road, and how they behave."""

import math
import sys
from pathlib import Path
from types import ModuleType, SimpleNamespace
from typing import Any

import numpy as np
import pytest
import shapely

import scenic
from scenic.domains.driving.roads import Network
from tests.maps import cross, straight

SIMULATED = "scenic.simulators.newtonian.driving_model"


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    made = tmp_path_factory.mktemp("driving")
    (made / "cross.xodr").write_text(cross(arm=100, half=15))
    (made / "straight.xodr").write_text(straight(1000))
    return made


def compiled(
    folder: Path, text: str, model: str = "scenic.domains.driving.model", map: str = "cross"
) -> scenic.Scenario:
    program = f"param map = localPath('{map}.xodr')\nmodel {model}\n{text}"
    return scenic.scenarioFromString(program, filename=str(folder / "main.scenic"), mode2D=True)


def test_temporal_requirements_measure_distances_to_the_objects_of_scenes_and_simulations(
    folder: Path,
) -> None:
    scenario = compiled(
        folder,
        "ego = new Car at (-20, -2), with regionContainedIn None\n"
        "require always ego.distanceToClosest(Car) > 12\n"
        "require always withinDistanceToAnyCars(ego, 30)\n"
        "other = new Car at (Range(-20, 40), -2), with regionContainedIn None\n"
        "record ego.distanceToClosest(Car) as away\n",
        "scenic.simulators.newtonian.driving_model",
    )
    gaps = [scene.objects[1].position.x + 20 for scene in scenario.sample(20, seed=1)]
    assert 12 < min(gaps) < 20 < 25 < max(gaps) < 30
    scene, _ = scenario.generate()
    simulation = scenario.getSimulator().simulate(scene, maxSteps=1)
    assert 12 < simulation.result.records["away"][0][1] < 30


def test_cars_are_on_the_road_and_face_along_it(folder: Path) -> None:
    scenario = compiled(folder, "ego = new Car\nother = new Car\n")
    network: Network = scenario.objects[0].roadNetwork
    road = network.drivableRegion.polygons
    for scene in scenario.sample(40, seed=1):
        for car in scene.objects:
            assert road.buffer(0.01).contains(shapely.Point(*car.position[:2]))
            assert car.heading == pytest.approx(network.roadDirection[car.position].yaw)
            assert car.elevation is None
            assert (car.width, car.length) == (2, 4.5)
            assert all(0 <= part <= 1 for part in car.color)
            assert car.isCar
            assert car.isVehicle
            assert not car.isPedestrian


def test_positions_on_the_road_are_uniform_by_area(folder: Path) -> None:
    scenario = compiled(folder, "ego = new Car with regionContainedIn None\n")
    network: Network = scenario.objects[0].roadNetwork
    points = np.array([scene.egoObject.position[:2] for scene in scenario.sample(2000, seed=2)])
    inside = shapely.contains_xy(network.intersections[0].polygon, *points.T).mean()
    share = network.intersectionRegion.area / network.drivableRegion.area
    assert inside == pytest.approx(share, abs=4 * math.sqrt(share * (1 - share) / 2000))


def test_pedestrians_are_on_sidewalks(folder: Path) -> None:
    scenario = compiled(folder, "ego = new Pedestrian\n")
    network: Network = scenario.objects[0].roadNetwork
    for scene in scenario.sample(20, seed=1):
        assert network.sidewalkAt(scene.egoObject.position) is not None


def test_elements_of_random_objects(folder: Path) -> None:
    scenario = compiled(
        folder,
        "ego = new Car\nparam lane = ego.lane.uid, crossing = ego._crossing, group = ego.laneGroup.uid\n"
        "require ego.road is ego.lane.road\nrequire ego._intersection is None\n",
    )
    network: Network = scenario.objects[0].roadNetwork
    for scene in scenario.sample(20, seed=3):
        assert scene.params["lane"] == network.laneAt(scene.egoObject).uid
        assert scene.params["crossing"] is None
        assert scene.params["group"] == network.laneGroupAt(scene.egoObject).uid


def test_random_elements_are_drawn_uniformly(folder: Path) -> None:
    scenario = compiled(
        folder,
        "inter = Uniform(*network.intersections)\n"
        "start = Uniform(*inter.incomingLanes)\n"
        "m = Uniform(*filter(lambda m: m.type is ManeuverType.LEFT_TURN, start.maneuvers))\n"
        "param start = m.startLane.uid, end = m.endLane.uid\n"
        "ego = new Car in m.startLane.centerline\n"
        "require 5 <= (distance to inter) <= 25\n",
    )
    scenes = scenario.sample(400, seed=4)
    network: Network = scenario.objects[0].roadNetwork
    counts: dict[str, int] = {}
    for scene in scenes:
        start, end = (network.elements[scene.params[key]] for key in ("start", "end"))
        assert any(m.startLane is start and m.endLane is end for m in network.intersections[0].maneuvers)
        counts[start.uid] = counts.get(start.uid, 0) + 1
        assert start.centerline.distanceTo(scene.egoObject.position) < 1e-6
        assert 5 <= network.intersections[0].distanceTo(scene.egoObject.position) <= 25
    assert len(counts) == 4
    assert all(60 < count < 145 for count in counts.values())


def test_following_the_road_direction(folder: Path) -> None:
    scenario = compiled(
        folder,
        "ego = new Car at (500, -1.75)\nahead = new Car following roadDirection from ego for Range(10, 20)\n"
        "behind = new Car following roadDirection for Range(-40, -10)\n",
        map="straight",
    )
    for scene in scenario.sample(20, seed=1):
        _, ahead, behind = scene.objects
        assert 510 <= ahead.position.x <= 520
        assert 460 <= behind.position.x <= 490
        assert ahead.position.y == pytest.approx(-1.75)


def test_missing_maps_are_told(tmp_path: Path) -> None:
    def failure(text: str) -> str:
        with pytest.raises(Exception) as caught:  # noqa: PT011 - several classes
            scenic.scenarioFromString(text, filename=str(tmp_path / "main.scenic"), mode2D=True)
        return str(caught.value)

    model = "model scenic.domains.driving.model\nego = new Car\n"
    assert "needs a map" in failure(model)
    assert "there is no map" in failure(f"param map = localPath('none.xodr')\n{model}")
    assert "is a folder" in failure(f"param map = localPath('.')\n{model}")


def distances(simulation: Any, network: Network) -> list[float]:
    """How far the ego is from the middle of the nearest lane, at each step."""
    lines = shapely.MultiLineString([lane.line for lane in network.lanes])
    return [lines.distance(shapely.Point(*state[0][:2])) for state in simulation.trajectory]


@pytest.mark.parametrize(
    ("behavior", "map", "place", "limit"),
    [
        ("FollowLaneBehavior(target_speed=8)", "straight", "(20, -1.75)", 0.1),
        ("FollowLaneBehavior(target_speed=8)", "straight", "(20, -2.5)", 0.8),
        ("FollowLaneBehavior(target_speed=6)", "cross", "(-100, -1.75)", 1.0),
        ("DriveAvoidingCollisions(target_speed=8)", "straight", "(20, -1.75)", 0.1),
    ],
)
def test_cars_stay_in_their_lanes(folder: Path, behavior: str, map: str, place: str, limit: float) -> None:
    scenario = compiled(folder, f"ego = new Car at {place}, with behavior {behavior}\n", SIMULATED, map)
    for seed in range(3):
        [scene] = scenario.sample(1, seed=seed)
        done = scenario.getSimulator().simulate(scene, maxSteps=150, name=str(seed))
        away = distances(done, scene.objects[0].roadNetwork)
        assert max(away) <= limit
        moved = sum(a[0].distanceTo(b[0]) for a, b in zip(done.trajectory, done.trajectory[1:], strict=False))
        assert moved > 60


@pytest.mark.parametrize("turn", ["LEFT_TURN", "RIGHT_TURN", "STRAIGHT"])
def test_trajectories_are_followed_to_their_end(folder: Path, turn: str) -> None:
    scenario = compiled(
        folder,
        f"m = Uniform(*filter(lambda m: m.type is ManeuverType.{turn}, network.intersections[0].maneuvers))\n"
        "way = [m.startLane, m.connectingLane, m.endLane]\n"
        "ego = new Car on m.startLane.centerline, with behavior FollowTrajectoryBehavior(6, way)\n"
        "require 20 <= (distance to network.intersections[0]) <= 40\nparam end = m.endLane.uid\n",
        SIMULATED,
    )
    [scene] = scenario.sample(1, seed=3)
    network: Network = scene.objects[0].roadNetwork
    done = scenario.getSimulator().simulate(scene, maxSteps=260)
    assert network.laneAt(done.trajectory[-1][0]) is network.elements[scene.params["end"]]
    assert max(distances(done, network)) < 1.7


def test_lane_changes_reach_the_other_lane(folder: Path) -> None:
    scenario = compiled(
        folder,
        "behavior Change():\n    do LaneChangeBehavior(self.laneSection.laneToLeft, True, 8)\n"
        "ego = new Car at (50, -1.75), with behavior Change(), with velocity (8, 0, 0)\n",
        SIMULATED,
        "straight",
    )
    [scene] = scenario.sample(1, seed=1)
    done = scenario.getSimulator().simulate(scene, maxSteps=300)
    assert any(abs(state[0].y - 1.75) < 0.15 for state in done.trajectory)


def test_cars_brake_for_others(folder: Path) -> None:
    scenario = compiled(
        folder,
        "ego = new Car at (50, -1.75), with behavior DriveAvoidingCollisions(8, 12)\n"
        "new Car at (100, -1.75)\nrecord final ego.speed as speed\n",
        SIMULATED,
        "straight",
    )
    [scene] = scenario.sample(1, seed=1)
    done = scenario.getSimulator().simulate(scene, maxSteps=150)
    assert done.result.records["speed"] == pytest.approx(0, abs=1e-6)
    assert done.trajectory[-1][0].x < 95


def test_walkers_walk_from_rest(folder: Path) -> None:
    scenario = compiled(
        folder,
        "behavior Go():\n    take SetWalkingSpeedAction(2)\n    while True: wait\n"
        "ego = new Pedestrian at (50, -4.5), facing -90 deg, with behavior Go()\n",
        SIMULATED,
        "straight",
    )
    [scene] = scenario.sample(1, seed=1)
    done = scenario.getSimulator().simulate(scene, maxSteps=10)
    assert done.trajectory[-1][0].x == pytest.approx(52, abs=0.21)


@pytest.mark.parametrize(
    ("action", "words"),
    [("SetThrottleAction(1.5)", "between 0 and 1"), ("SetSteerAction(-2)", "between -1 and 1"),
     ("SetReverseAction(1)", "True or False")],
)  # fmt: skip
def test_actions_check_their_arguments(action: str, words: str) -> None:
    from scenic.domains.driving import actions

    with pytest.raises(RuntimeError, match=words):
        eval(action, vars(actions))


def test_steering_changes_by_a_tenth_at_most() -> None:
    from scenic.domains.driving.actions import RegulatedControlAction

    action = RegulatedControlAction(0.9, 1.0, 0.2)
    assert (action.throttle, action.brake) == (0.5, 0.0)
    assert action.steer == pytest.approx(0.3)
    assert RegulatedControlAction(-0.7, 0, 0).brake == 0.5


CARLA = """
ego = new Car on Uniform(*network.lanes).centerline, with behavior FollowLaneBehavior(8)
bike = new Bicycle at (0, 0), with regionContainedIn None, with behavior CrossingBehavior(ego, 2, 15)
walker = new Pedestrian with behavior WalkForwardBehavior(speed=1)
bin = new Trash
require (distance from ego to bike) > 20
assert warnings.warn and issubclass(SimulatorInterfaceWarning, UserWarning)
param town = map_town, categories = blueprints.carModels
"""


def test_carla_programs_sample_without_the_simulator(folder: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    from scenic.simulators.carla.blueprints import CATALOGUE

    scenario = compiled(folder, CARLA, "scenic.simulators.carla.model")
    for scene in scenario.sample(5, seed=1):
        ego, bike, walker, trash = scene.objects
        assert CATALOGUE["car"][ego.blueprint] == (ego.width, ego.length, ego.height)
        assert bike.blueprint in CATALOGUE["bicycle"]
        assert walker.blueprint in CATALOGUE["walker"]
        assert trash.physics is False
        assert scene.params["carla_map"] == scene.params["town"] == "cross"
        assert scene.params["categories"] == tuple(CATALOGUE["car"])
    monkeypatch.setitem(sys.modules, "carla", None)
    with pytest.raises(scenic.ScenicError, match="needs the package carla"):
        scenario.getSimulator().simulate(scene, maxSteps=1)


class _Record(SimpleNamespace):
    """A value of the client's interface: its keywords as attributes."""


class _Actor:
    def __init__(self, transform: Any, is_walker: bool) -> None:
        self.transform = transform
        self.bounding_box = _Record(extent=_Record(x=2.3, y=1.0, z=0.8))
        self.velocity = _Record(x=0.0, y=0.0, z=0.0)
        self.controls: list[Any] = []
        self.destroyed = False
        self.is_walker = is_walker

    def set_simulate_physics(self, enabled: bool) -> None: ...
    def get_transform(self) -> Any:
        return self.transform

    def get_velocity(self) -> Any:
        return self.velocity

    def get_angular_velocity(self) -> Any:
        return _Record(x=0.0, y=0.0, z=0.0)

    def set_target_velocity(self, velocity: Any) -> None:
        self.velocity = velocity

    def apply_control(self, control: Any) -> None:
        self.controls.append(_Record(**vars(control)))

    def destroy(self) -> None:
        self.destroyed = True


class _World:
    def __init__(self) -> None:
        self.actors: list[_Actor] = []
        self.ticks = 0
        self.settings = _Record(synchronous_mode=False, fixed_delta_seconds=None, no_rendering_mode=False)

    def get_settings(self) -> Any:
        return self.settings

    def apply_settings(self, settings: Any) -> None:
        self.settings = settings

    def get_blueprint_library(self) -> Any:
        def found(name: str) -> list[Any]:
            return [_Record(id=name, has_attribute=lambda _: True, set_attribute=lambda *_: None)]

        return _Record(filter=found)

    def ground_projection(self, _location: Any, _distance: float) -> Any:
        return _Record(location=_Record(z=3.0))

    def try_spawn_actor(self, blueprint: Any, transform: Any) -> _Actor:
        self.actors.append(_Actor(transform, blueprint.id.startswith("walker")))
        return self.actors[-1]

    def set_weather(self, weather: Any) -> None:
        self.weather = weather

    def tick(self) -> None:
        self.ticks += 1
        for actor in self.actors:
            for axis in "xyz":
                place = actor.transform.location
                setattr(place, axis, getattr(place, axis) + 0.1 * getattr(actor.velocity, axis))


def test_the_adapter_speaks_to_the_documented_client(folder: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    world = _World()
    fake: Any = ModuleType("carla")
    for name in ("Location", "Rotation", "Vector3D", "VehicleControl", "WalkerControl"):
        setattr(fake, name, _Record)
    fake.Transform = lambda location, rotation: _Record(
        location=location, rotation=_Record(pitch=0.0, roll=0.0, **vars(rotation))
    )
    fake.WeatherParameters = _Record(ClearNoon="clear noon")
    manager = _Record(set_synchronous_mode=lambda _: None, get_port=lambda: 8000)
    fake.Client = lambda *_: _Record(
        set_timeout=lambda _: None,
        get_available_maps=lambda: ["/Game/Maps/cross"],
        load_world=lambda _: world,
        get_trafficmanager=lambda _: manager,
    )
    monkeypatch.setitem(sys.modules, "carla", fake)
    scenario = compiled(
        folder,
        "param weather = 'ClearNoon'\n"
        "behavior Go():\n    take SetThrottleAction(0.4), SetSteerAction(-0.1)\n    while True: wait\n"
        "ego = new Car at (50, -1.75), facing -90 deg, with velocity (5, 0, 0), with behavior Go()\n"
        "record final ego.position as place\n",
        "scenic.simulators.carla.model",
    )
    [scene] = scenario.sample(1, seed=1)
    simulator = scenario.getSimulator()
    done = simulator.simulate(scene, maxSteps=10)
    [actor] = world.actors
    assert world.weather == "clear noon"
    assert world.settings.synchronous_mode
    assert world.settings.fixed_delta_seconds == 0.1
    assert actor.transform.rotation.yaw == pytest.approx(0)
    assert actor.transform.location.y == pytest.approx(1.75)
    assert actor.controls[0].throttle == 0.4
    assert actor.controls[0].steer == -0.1
    assert actor.destroyed
    assert done.result.records["place"].x == pytest.approx(55)
    assert done.result.records["place"].y == pytest.approx(-1.75)
    simulator.destroy()
    assert not world.settings.synchronous_mode
