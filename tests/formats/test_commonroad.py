"""CommonRoad files: they satisfy the schema, and commonroad-io reads the facts of network and simulation from them."""

import math
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import scenic
from scenic.formats.commonroad.scenario_files import CommonRoadFile, commonroad_about
from scenic.language.errors import UnsupportedError
from scenic.simulators.newtonian import NewtonianSimulator
from tests.cli.commands import run_here
from tests.maps import cross

commonroad = pytest.importorskip("commonroad")

LIGHT = '<signal id="{id}" s="{s}" t="-5" zOffset="4" orientation="+" dynamic="yes" type="{type}" subtype="-1" country="DE"/>'
HEAD = """
param map = {map!r}
param use2DMap = True
model scenic.simulators.newtonian.driving_model
"""
TRAFFIC = """
param traffic_lights = {'green': 1.0, 'yellow': 0.5, 'all_red': 0.3, 'offset': 0.2}
ego = new Car at (50, 1.75), facing 90 deg, with behavior FollowLaneBehavior(), with speed 5
new Truck at (-30, -1.75), facing -90 deg, with behavior FollowLaneBehavior(target_speed=4), with speed 4
new Bicycle at (1.75, -40), facing 180 deg, with behavior FollowLaneBehavior(is_oppositeTraffic=True)
new Pedestrian at (40, 4.5), with velocity (1, 0, 0)
new Object at (20, 20), facing 30 deg, with shape CylinderShape(), with width 2, with length 1, with regionContainedIn None
"""


@pytest.fixture(scope="module")
def town(tmp_path_factory: pytest.TempPathFactory) -> Path:
    path = tmp_path_factory.mktemp("commonroad") / "small_town.xodr"
    kind = '<type s="0" type="town"><speed max="36" unit="km/h"/></type>'
    signals = LIGHT.format(id=7, s=58, type=1000001) + LIGHT.format(id=8, s=20, type=206)
    text = cross(signal=signals).replace("<planView>", f"{kind}<planView>")
    path.write_text(
        text.replace("</header>", "").replace(
            'revMinor="4"/>', 'revMinor="6"><offset x="100" y="-20" z="3" hdg="0.5"/></header>'
        )
    )
    return path


def read(content: Path | bytes) -> tuple[Any, Any]:
    """The scenario and its only planning problem, as commonroad-io reads them."""
    from commonroad.common.file_reader import CommonRoadFileReader
    from lxml import etree

    xsd = Path(commonroad.__file__).parent / "common" / "xml_definition_files" / "XML_commonRoad_XSD.xsd"
    schema = etree.XMLSchema(etree.parse(str(xsd)))
    data = content if isinstance(content, bytes) else content.read_bytes()
    schema.assertValid(etree.fromstring(data))
    scenario, problems = CommonRoadFileReader(data).open()
    [problem] = problems.planning_problem_dict.values()
    return scenario, problem


def scene_of(town: Path, text: str) -> Any:
    [scene] = scenic.scenarioFromString(HEAD.format(map=str(town)) + text, mode2D=False).sample(1, seed=1)
    return scene


def test_simulations_are_read_back(town: Path, tmp_path: Path) -> None:
    file = CommonRoadFile(tmp_path / "run.xml")
    colors: list[str] = []
    rows: list[Any] = []

    def see(simulation: Any, poses: Any, _: Any) -> None:
        file.add(simulation, poses)
        [light] = [item for item in simulation.scene.workspace.network.signals if item.isTrafficLight]
        colors.append(simulation.signalState(light))
        rows.append(
            [
                (*position, o.yaw, *thing.velocity)
                for (position, o), thing in zip(poses, simulation.objects, strict=True)
            ]
        )

    done = NewtonianSimulator().simulate(scene_of(town, TRAFFIC), maxSteps=30, on_state=see)
    file.finish(done, {"k": 3, "words": "a--b"})
    assert commonroad_about(tmp_path / "run.xml") == {"k": 3, "words": "a--b"}
    scenario, problem = read(tmp_path / "run.xml")
    assert scenario.dt == pytest.approx(0.1)
    things = sorted(scenario.obstacles, key=lambda item: item.obstacle_id)
    assert [item.obstacle_type.value for item in things] == ["truck", "bicycle", "pedestrian", "unknown"]
    assert [item.obstacle_role.value for item in things] == ["dynamic", "dynamic", "dynamic", "static"]
    for number, thing in enumerate(things[:3], 1):
        for step, row in enumerate(rows):
            x, y, _, yaw, vx, vy, _ = row[number]
            state = thing.state_at_time(step)
            assert state.position == pytest.approx([x, y], abs=1e-8)
            assert math.remainder(state.orientation - yaw - math.pi / 2, 2 * math.pi) == pytest.approx(
                0, abs=1e-8
            )
            assert state.velocity == pytest.approx(vy * math.cos(yaw) - vx * math.sin(yaw), abs=1e-8)
    outline = things[3].occupancy_at_time(5).shapely_object
    assert outline.centroid.coords[0] == pytest.approx((20, 20), abs=1e-6)
    assert outline.area == pytest.approx(math.pi / 2, rel=0.02)
    [light] = scenario.lanelet_network.traffic_lights
    assert [light.get_state_at_time_step(step).value for step in range(31)] == colors
    assert len(set(colors)) == 3
    # The ego is the planning problem: its own drive reaches the goal.
    assert problem.initial_state.position == pytest.approx(rows[0][0][:2])
    assert problem.initial_state.velocity == pytest.approx(5)
    goal = problem.goal.state_list[0]
    assert goal.position.shapely_object.centroid.coords[0] == pytest.approx(rows[-1][0][:2])
    assert (goal.time_step.start, goal.time_step.end) == (20, 30)


def test_networks_are_read_back(town: Path, tmp_path: Path) -> None:
    from commonroad.scenario.traffic_sign import SupportedTrafficSignCountry
    from commonroad.scenario.traffic_sign_interpreter import TrafficSignInterpreter

    from scenic.formats.commonroad.scenario_files import write_scene

    scene = scene_of(town, "ego = new Car at (50, 1.75), facing 90 deg\n")
    network = scene.workspace.network
    write_scene(scene, tmp_path / "scene.cr.xml")
    scenario, problem = read(tmp_path / "scene.cr.xml")
    roads = scenario.lanelet_network
    assert len(roads.lanelets) == len(network.laneSections) + len(network.sidewalks)
    limits = TrafficSignInterpreter(SupportedTrafficSignCountry.ZAMUNDA, roads)
    for section in network.laneSections:
        twins = [
            item
            for item in roads.lanelets
            if item.left_vertices.shape == section.left.shape
            and np.allclose(item.left_vertices, section.left, atol=1e-5)
        ]
        assert len(twins) == 1 or section.lane.is_connecting
        twin = twins[0]
        assert np.allclose(twin.right_vertices, section.right, atol=1e-5)
        onward = {id(item.connectingLane or item.endLane) for item in section.lane.maneuvers}
        assert len(twin.successor) == len(onward)
        for key in twin.successor:
            assert twin.center_vertices[-1] == pytest.approx(
                roads.find_lanelet_by_id(key).center_vertices[0], abs=1e-3
            )
            assert twin.lanelet_id in roads.find_lanelet_by_id(key).predecessor
        if section._laneToLeft is not None:
            other = roads.find_lanelet_by_id(twin.adj_left)
            assert twin.adj_left_same_direction == (section._laneToLeft.isForward == section.isForward)
            assert other.adj_left == twin.lanelet_id
        limit = limits.speed_limit(frozenset([twin.lanelet_id]))
        assert limit == (None if section.speedLimit is None else pytest.approx(section.speedLimit))
    [light] = roads.traffic_lights
    [stopped] = [item for item in roads.lanelets if item.stop_line is not None]
    assert stopped.traffic_lights == {light.traffic_light_id}
    assert sorted(
        kind.name
        for kind in {
            item.traffic_sign_element_id
            for key in stopped.traffic_signs
            for item in roads.find_traffic_sign_by_id(key).traffic_sign_elements
        }
    ) == ["MAX_SPEED", "STOP"]
    # The stop sign comes first on the way: at s = 20 of a lane from x = 70.
    assert sorted([stopped.stop_line.start[0], stopped.stop_line.end[0]]) == pytest.approx([50, 50], abs=1e-3)
    [crossing] = roads.intersections
    assert len(crossing.incomings) == 4
    for incoming in crossing.incomings:
        assert [
            len(item)
            for item in (incoming.outgoing_right, incoming.outgoing_straight, incoming.outgoing_left)
        ] == [1, 1, 1]
    # The goal of a scene is where the lane leads.
    assert problem.goal.lanelets_of_goal_position
    moved = roads.location.geo_transformation
    assert (moved.x_translation, moved.y_translation, moved.z_rotation) == (100, -20, 0.5)


def test_refusals_say_why(tmp_path: Path) -> None:
    from scenic.formats.commonroad.scenario_files import write_scene

    [scene] = scenic.scenarioFromString("ego = new Object\n").sample(1, seed=0)
    with pytest.raises(UnsupportedError, match="road network"):
        write_scene(scene, tmp_path / "scene.cr.xml")
    town = tmp_path / "town.xodr"
    town.write_text(cross())
    with pytest.raises(UnsupportedError, match="ego"):
        write_scene(scene_of(town, "new Car\n"), tmp_path / "scene.cr.xml")
    made = """
scenario Late():
    setup:
        new Car at (-30, -1.75), facing -90 deg
scenario Main():
    setup:
        ego = new Car at (50, 1.75), facing 90 deg
    compose:
        wait
        do Late()
"""
    file = CommonRoadFile(tmp_path / "run.xml")
    done = NewtonianSimulator().simulate(
        scene_of(town, made), maxSteps=4, on_state=lambda run, poses, _: file.add(run, poses)
    )
    with pytest.raises(UnsupportedError, match="made during the simulation"):
        file.finish(done, {})
    assert not list(tmp_path.glob("*.xml"))


def test_the_commands_write_and_go_on(town: Path, tmp_path: Path) -> None:
    program = tmp_path / "p.scenic"
    program.write_text(
        HEAD.format(map=str(town)) + "ego = new Car at (50, 1.75), facing 90 deg, with speed 5\n"
    )
    command: list[object] = ["simulate", "--2d", "--seed", "1", "--time", "5", str(program), "-n", "2"]
    command += ["-o", str(tmp_path / "out"), "--resume", "--format", "commonroad"]
    files = [tmp_path / "out" / f"simulation-{k:04d}.xml" for k in (0, 1)]
    for _ in range(2):
        done = run_here(command)
        assert done.returncode == 0, done.stderr
        written = [file.stat().st_mtime_ns for file in files]
    assert [file.stat().st_mtime_ns for file in files] == written, "the second run keeps the files"
    again = run_here(["replay", str(tmp_path / "out"), "1"])
    assert "the same as kept" in again.stdout
    done = run_here(["sample", "--2d", str(program), "-n", "2", "-o", str(tmp_path / "scene.cr.xml")])
    assert done.returncode == 0, done.stderr
    names = sorted(file.name for file in tmp_path.glob("*.cr.xml"))
    assert names == ["scene-000.cr.xml", "scene-001.cr.xml"]
    for file in (*files, *tmp_path.glob("*.cr.xml")):
        read(file)
