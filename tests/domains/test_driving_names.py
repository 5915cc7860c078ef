"""Names of the driving domain that public programs use (sections 1.3, 1.7 and 2.1 of its specification): where they are, what they are."""

import importlib
import warnings
from pathlib import Path
from typing import Any

import pytest

import scenic
from scenic.domains.driving.roads import Network
from scenic.language.errors import RejectionException
from tests.maps import cross

ELEMENTS = "NetworkElement LinearElement Road LaneGroup Lane RoadSection LaneSection Sidewalk Shoulder PedestrianCrossing Intersection"
ACTIONS = (
    "SetPositionAction OffsetAction SetVelocityAction SetSpeedAction SetThrottleAction SetSteerAction SetBrakeAction"
    " SetHandBrakeAction SetReverseAction RegulatedControlAction SetWalkingDirectionAction SetWalkingSpeedAction"
    " SteeringAction WalkingAction Steers Walks"
)
BEHAVIORS = (
    "ConstantThrottleBehavior AccelerateForwardBehavior WalkForwardBehavior FollowLaneBehavior FollowTrajectoryBehavior"
    " TurnBehavior LaneChangeBehavior DriveAvoidingCollisions"
)
CONTROLLERS = "PIDLongitudinalController PIDLateralController"
IMPORTED = {
    "scenic.domains.driving.roads": f"{ELEMENTS} Network Signal Maneuver VehicleType ManeuverType",
    "scenic.domains.driving.actions": ACTIONS,
    "scenic.domains.driving.controllers": CONTROLLERS,
    "scenic.domains.driving.simulators": "DrivingSimulator DrivingSimulation",
    "scenic.domains.driving.workspace": "DrivingWorkspace",
    "scenic.domains.driving.openscenario": "toOpenScenario",
    "scenic.formats.opendrive": "OpenDriveWorkspace OpenDriveWarning",
}
REGIONS = "road curb sidewalk shoulder intersection roadOrShoulder"
CLASSES = "DrivingObject Vehicle Car NPCCar Pedestrian"
QUESTIONS = "withinDistanceToAnyCars withinDistanceToAnyObjs withinDistanceToAnyPedestrians withinDistanceToObjsInLane"
MODEL = (
    f"network {REGIONS} roadDirection Network Road Lane LaneSection LaneGroup Intersection PedestrianCrossing NetworkElement"
    f" ManeuverType Color RejectionException is2DMode RGBSensor SSSensor {CLASSES} {QUESTIONS} {ACTIONS} {BEHAVIORS}"
    f" {CONTROLLERS} concatenateCenterlines"
)
VEHICLES = {
    "Car": ("car", (2, 4.5, 1.5)),
    "NPCCar": ("car", (2, 4.5, 1.5)),
    "Bicycle": ("bicycle", (1, 2, 1.5)),
    "Motorcycle": ("motorcycle", (1, 2, 1.5)),
    "Truck": ("truck", (2.5, 7.5, 3)),
    "Van": ("van", (2, 5, 2)),
    "Bus": ("bus", (4, 10, 4)),
    "Pedestrian": ("walker", (0.5, 0.5, 1.5)),
}
"""CARLA's classes of actors: their categories of blueprints, and their sizes where a blueprint is unknown."""
PROPS = {
    name: "".join(f"_{letter.lower()}" if letter.isupper() else letter for letter in name).lstrip("_")
    for name in [
        "Trash",
        "Cone",
        "Debris",
        "VendingMachine",
        "Chair",
        "BusStop",
        "Advertisement",
        "Garbage",
        "Container",
        "Table",
        "Barrier",
        "PlantPot",
        "Mailbox",
        "Gnome",
        "CreasedBox",
        "Case",
        "Box",
        "Bench",
        "Barrel",
        "Kiosk",
        "IronPlate",
        "TrafficWarning",
    ]
} | {"ATM": "atm"}
LIGHTS = (
    "withinDistanceToRedYellowTrafficLight withinDistanceToTrafficLight getClosestTrafficLightStatus"
    " setClosestTrafficLightStatus getTrafficLightStatus setTrafficLightStatus setAllIntersectionTrafficLightsStatus"
    " freezeTrafficLights unfreezeTrafficLights"
)
CARLA = f"{MODEL} {' '.join([*VEHICLES, *PROPS])} CarlaActor Prop AutopilotBehavior WalkBehavior CrossingBehavior {LIGHTS}"
MODELS = {
    "scenic.domains.driving.model": MODEL,
    "scenic.simulators.newtonian.driving_model": MODEL,
    "scenic.simulators.carla.model": CARLA,
}
NETWORK = (
    "elements roads connectingRoads allRoads laneGroups lanes intersections crossings sidewalks shoulders roadSections"
    " laneSections driveOnLeft tolerance drivableRegion walkableRegion roadRegion laneRegion intersectionRegion crossingRegion"
    " sidewalkRegion curbRegion shoulderRegion roadDirection pickledExt findPointIn elementAt laneAt laneSectionAt laneGroupAt"
    " roadAt intersectionAt crossingAt sidewalkAt shoulderAt nominalDirectionsAt fromFile fromOpenDrive fromPickle dumpPickle"
    " show"
)
ANY = (
    "polygon orientation name uid id network vehicleTypes speedLimit tags nominalDirectionsAt buffer difference intersect"
    " uniformPointInner"
)
LINEAR = "centerline leftEdge rightEdge _successor _predecessor successor predecessor flowFrom"
OWN = {
    "Road": (
        "lanes forwardLanes backwardLanes laneGroups sections signals crossings sidewalks sidewalkRegion is1Way sectionAt"
        " laneSectionAt laneAt laneGroupAt crossingAt shiftLanes"
    ),
    "LaneGroup": "road lanes curb _sidewalk _bikeLane _shoulder _opposite sidewalk bikeLane shoulder opposite laneAt",
    "Lane": "group road sections adjacentLanes maneuvers sectionAt",
    "RoadSection": "road lanes forwardLanes backwardLanes lanesByOpenDriveID laneAt",
    "LaneSection": (
        "lane group road openDriveID isForward adjacentLanes _laneToLeft _laneToRight _fasterLane _slowerLane laneToLeft"
        " laneToRight fasterLane slowerLane shiftedBy"
    ),
    "Sidewalk": "road crossings",
    "Shoulder": "road group",
    "Intersection": "roads incomingLanes outgoingLanes maneuvers signals crossings is3Way is4Way isSignalized hasTrafficLights"
    " maneuversAt",
}  # fmt: skip


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    made = tmp_path_factory.mktemp("names")
    (made / "cross.xodr").write_text(cross(arm=150, half=15))
    return made


def compiled(folder: Path, model: str, text: str) -> scenic.Scenario:
    program = f"param map = localPath('cross.xodr')\nmodel {model}\n{text}"
    return scenic.scenarioFromString(program, filename=str(folder / "main.scenic"), mode2D=True)


def test_modules_have_their_names() -> None:
    for module, names in IMPORTED.items():
        found = importlib.import_module(module)
        for name in names.split():
            assert isinstance(getattr(found, name), type) or name == "toOpenScenario", (module, name)
    with pytest.raises(AttributeError):
        importlib.import_module("scenic.formats.opendrive").Nothing  # noqa: B018


@pytest.mark.parametrize("model", MODELS)
def test_models_have_their_names(folder: Path, model: str) -> None:
    names = sorted(set(MODELS[model].split()))
    lines = "".join(f"from {model} import {name}\n" for name in names)
    listed = {
        name: words.replace(" ", ", ") for name, words in (("r", REGIONS), ("b", BEHAVIORS), ("c", CLASSES))
    }
    asked = (
        f"param regions = [{listed['r']}]\n"
        f"param behaviors = [B.__name__ for B in ({listed['b']})]\n"
        f"param classes = [C.__mro__ for C in ({listed['c']})]\n"
        f"import {model} as model_itself\nparam missing = [n for n in {names!r} if not hasattr(model_itself, n)]\n"
    )
    [scene] = compiled(folder, model, f"{lines}{asked}ego = new Car\nparam space = workspace\n").sample(
        1, seed=1
    )
    found = scene.params
    assert found["missing"] == []
    network = scene.objects[0].roadNetwork
    expected = [
        network.drivableRegion, network.curbRegion, network.sidewalkRegion, network.shoulderRegion, network.intersectionRegion,
    ]  # fmt: skip
    assert found["regions"][:5] == expected
    assert found["behaviors"] == BEHAVIORS.split()
    assert found["space"].minimumZoomSize == 20
    anything, vehicle, car, npc, pedestrian = found["classes"]
    for lineage in (vehicle, car, npc, pedestrian):
        assert any(cls.__name__ == "DrivingObject" for cls in lineage)
    assert "Vehicle" in {cls.__name__ for cls in car}
    assert "Car" in {cls.__name__ for cls in npc}
    assert "Vehicle" not in {cls.__name__ for cls in pedestrian}
    assert anything[0].__name__ == "DrivingObject"


def test_elements_have_their_attributes(folder: Path) -> None:
    network = Network.fromFile(folder / "cross.xodr")
    assert not [name for name in NETWORK.split() if not hasattr(network, name)]
    kinds = set()
    for element in network.elements.values():
        kind = type(element).__name__
        kinds.add(kind)
        names = f"{ANY} {OWN[kind]} {'' if kind == 'Intersection' else LINEAR}"
        for name in names.split():
            try:
                value = getattr(element, name)
            except RejectionException:
                assert getattr(element, f"_{name}") is None
            else:
                assert not isinstance(value, list), name
    assert kinds == set(OWN) - {"Shoulder"}
    [inter] = network.intersections
    for turn in inter.maneuvers:
        assert turn.intersection is inter
        assert turn in inter.maneuversAt(turn.connectingLane.centerline.midpoint)
        assert all(other in inter.maneuvers for other in turn.conflictingManeuvers)
        assert all(other.endLane.road is turn.startLane.road for other in turn.reverseManeuvers)


def test_networks_are_kept_in_files_without_code(folder: Path) -> None:
    network = Network.fromFile(folder / "cross.xodr")
    file = folder / f"kept{Network.pickledExt}"
    network.dumpPickle(file, b"digest")
    again = Network.fromPickle(file, b"digest")
    assert list(again.elements) == list(network.elements)
    assert again.tolerance == network.tolerance
    with pytest.raises(Network.DigestMismatchError):
        Network.fromPickle(file, b"another")
    file.write_bytes(b"cos\nsystem\n(S'true'\ntR.")
    with pytest.raises(ValueError, match="load the map itself"):
        Network.fromPickle(file)


def test_the_workspace_of_a_map(folder: Path) -> None:
    from scenic.formats.opendrive import OpenDriveWarning, OpenDriveWorkspace

    with warnings.catch_warnings():
        warnings.simplefilter("error", OpenDriveWarning)
        made: Any = OpenDriveWorkspace(folder / "cross.xodr")
    network = made.network
    assert made.drivable_region is network.drivableRegion
    assert made.sidewalk_region is network.sidewalkRegion
    assert made.intersection_region is network.intersectionRegion
    assert made.road_direction is network.roadDirection
    road = network.roads[0]
    assert made.lane_sec_dict[road.id][0][-1] is road.forwardLanes.lanes[0].sections[0]
    broken = (
        (folder / "cross.xodr").read_text().replace("<junction ", '<road id="900" length="0"/><junction ', 1)
    )
    (folder / "broken.xodr").write_text(broken)
    with pytest.warns(OpenDriveWarning):
        OpenDriveWorkspace(folder / "broken.xodr", 5, 0.1)


def test_cameras_take_the_options_of_any_simulator(folder: Path) -> None:
    text = (
        "ego = new Car with sensors {'a': RGBSensor(offset=(1, 0, 2), width=32, height=16, attributes={'fov': 60}),"
        " 'b': SSSensor(convert='CityScapesPalette')}"
    )
    [scene] = compiled(folder, "scenic.simulators.carla.model", text).sample(1, seed=1)
    cameras = scene.objects[0].sensors
    assert cameras["a"].attributes == {"fov": 60}
    assert cameras["b"].attributes == {"convert": "CityScapesPalette"}
    assert cameras["b"].getObservation() is None


def test_every_class_and_blueprint_of_carla_is_sampled(folder: Path) -> None:
    from scenic.simulators.carla.blueprints import CATALOGUE

    kinds = {**{name: kind for name, (kind, _) in VEHICLES.items()}, **PROPS}
    free = "with regionContainedIn None, with allowCollisions True, with requireVisible False"
    lines = ["ego = new Car"]
    for name, kind in kinds.items():
        lines.append(f"new {name} {free}")
        for number, blueprint in enumerate(CATALOGUE[kind]):
            if name != "NPCCar":
                lines.append(f"new {name} at ({number}, 0), {free}, with blueprint {blueprint!r}")
    scenario = compiled(folder, "scenic.simulators.carla.model", "\n".join(lines))
    drawn: dict[str, set[str]] = {name: set() for name in kinds}
    for scene in scenario.sample(40, seed=1):
        for item in scene.objects:
            name = type(item).__name__
            assert (item.width, item.length, item.height) == CATALOGUE[kinds[name]][item.blueprint]
            drawn[name].add(item.blueprint)
    for name, kind in kinds.items():
        # Cars of the two classes are drawn; each of the others stands there, too.
        assert name == "NPCCar" or drawn[name] == set(CATALOGUE[kind])
        assert len(drawn[name]) > 1 or len(CATALOGUE[kind]) == 1
    assert set(kinds.values()) == set(CATALOGUE)


def test_sizes_of_unknown_blueprints(folder: Path) -> None:
    lines = [
        f"new {name} at (0, 0), with regionContainedIn None, with allowCollisions True, with blueprint 'own'"
        for name in VEHICLES
    ]
    scenario = compiled(folder, "scenic.simulators.carla.model", "ego = new Car\n" + "\n".join(lines))
    [scene] = scenario.sample(1, seed=1)
    for item in scene.objects[1:]:
        assert (item.width, item.length, item.height) == VEHICLES[type(item).__name__][1]


WAYS = """
behavior Way():
    do FollowLaneBehavior(target_speed=8) until withinDistanceToAnyObjs(self, 10)
    do AutopilotBehavior(enabled=True, speed=30)

inter = Uniform(*filter(lambda i: i.is4Way or i.is3Way, network.intersections))
turn = Uniform(*filter(lambda m: m.type is ManeuverType.LEFT_TURN, inter.maneuvers))
ego = new Car on turn.startLane.centerline, with behavior Way, with rolename 'hero'
adult = new Pedestrian on sidewalk, with behavior CrossingBehavior(ego, 1, 12, final_speed=0)
child = new Pedestrian on sidewalk, with behavior WalkForwardBehavior(speed=1.2)
other = new Pedestrian on sidewalk, with behavior WalkBehavior(maxSpeed=2)
cyclist = new Bicycle on turn.endLane.centerline, with behavior CrossingBehavior(ego)
cones = [new Cone following roadDirection from ego for d, with snapToGround False for d in (12, 16, 20)]
new TrafficWarning following roadDirection from ego for 25, with regionContainedIn None
require (distance from ego to inter) > 30
require (distance from ego to adult) < 60
param weather = Uniform('ClearNoon', 'HardRainSunset')
"""


def test_a_program_of_carla_with_traffic_walkers_and_props(folder: Path) -> None:
    scenario = compiled(folder, "scenic.simulators.carla.model", WAYS)
    for scene in scenario.sample(10, seed=2):
        ego, adult, *_ = scene.objects
        assert ego.rolename == "hero"
        assert ego.distanceTo(adult.position) < 60
        assert scene.params["weather"] in ("ClearNoon", "HardRainSunset")
        assert scene.params["timestep"] == 0.1
        assert [item.physics for item in scene.objects[5:]] == [False] * 4
