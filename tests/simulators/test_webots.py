"""Webots: its world model, the supervisor's side against a fake of the documented interface, and worlds read back."""

import json
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

import scenic
from scenic.language.errors import (
    InvalidScenarioError,
    SimulationCreationError,
    SpecifierError,
    UnsupportedError,
)
from scenic.simulators.webots.simulator import WebotsSimulator
from tests.cli.commands import run_here
from tests.simulators.fake_webots import Node, Supervisor

MODEL = "model scenic.simulators.webots.model\n"


def scene_of(text: str, **options: Any) -> Any:
    return scenic.scenarioFromString(MODEL + text, **options).sample(1, seed=0)[0]


def test_objects_move_in_worlds_of_any_axes_as_in_ours() -> None:
    text = (
        "ego = new WebotsObject at (1, 2, 3), facing (30 deg, 20 deg, 10 deg), with webotsName 'CAR',"
        " with velocity (1, 2, 0.5), with angularVelocity (0, 0, 0.4), with positionOffset (0, 0, 0.5),"
        " with rotationOffset (90 deg, 0, 10 deg)\n"
        "record (ego.position, ego.orientation, ego.velocity, ego.angularVelocity) as state\n"
    )
    scene = scene_of(text)
    turn = Rotation.from_euler("ZXY", [30, 20, 10], degrees=True)
    for axes in ("ENU", "NUE", "EUN", "UEN"):
        node = Node("CAR")
        supervisor = Supervisor(node, axes=axes)
        done = WebotsSimulator(supervisor).simulate(scene, maxSteps=5, timestep=0.16)
        assert supervisor.milliseconds == 5 * 160
        for step, (position, orientation, velocity, spin) in done.result.records["state"]:
            time = 0.16 * step
            assert tuple(position) == pytest.approx((1 + time, 2 + 2 * time, 3 + 0.5 * time), abs=1e-9), axes
            wanted = Rotation.from_rotvec([0, 0, 0.4 * time]) * turn
            found = Rotation.from_quat([orientation.x, orientation.y, orientation.z, orientation.w])
            assert (wanted.inv() * found).magnitude() < 1e-7, axes
            assert tuple(velocity) == pytest.approx((1, 2, 0.5)), axes
            assert tuple(spin) == pytest.approx((0, 0, 0.4)), axes
    node = Node("CAR")
    WebotsSimulator(Supervisor(node, axes="NUE")).simulate(scene, maxSteps=0)
    assert node.getPosition() == [2, 3.5, 1]
    with pytest.raises(SimulationCreationError, match="coordinate system"):
        WebotsSimulator(Supervisor(axes="XYZ"))


def test_nodes_are_found_by_name_and_type_and_get_their_fields() -> None:
    scene = scene_of(
        "class Rover(WebotsObject):\n    webotsType: 'ROVER'\n    density: 200\n"
        "ego = new Rover at (0, 0, 1), with battery (1, 2, 3), with customData 'seed 4', with controller 'drive'\n"
        "new Rover at (3, 0, 1)\n"
        "new Rover at (6, 0, 1), with controller 'other', with resetController False\n"
    )
    nodes = [
        Node(name, battery=[], customData="", controller="void") for name in ("ROVER", "ROVER_0", "ROVER_1")
    ]
    WebotsSimulator(Supervisor(*nodes)).simulate(scene, maxSteps=1)
    assert [node.getPosition()[0] for node in nodes] == [0, 3, 6]
    assert nodes[0].fields["battery"].value == [1, 2, 3]
    assert nodes[0].fields["customData"].value == "seed 4"
    assert [node.fields["controller"].value for node in nodes] == ["drive", "void", "other"]
    assert [node.restarts for node in nodes] == [1, 0, 0]
    assert nodes[1].fields["physics"].value.fields["density"].value == 200
    assert all(node.resets for node in nodes)
    with pytest.raises(SimulationCreationError, match="no node with the DEF name ROVER_0"):
        WebotsSimulator(Supervisor(nodes[0])).simulate(scene, maxSteps=1)
    with pytest.raises(SimulationCreationError, match="no field 'battery'"):
        WebotsSimulator(Supervisor(Node("ROVER"))).simulate(scene, maxSteps=1)
    with pytest.raises(SimulationCreationError, match="no multiple"):
        WebotsSimulator(Supervisor(*nodes)).simulate(scene, maxSteps=1, timestep=0.02)


def test_objects_are_made_and_removed() -> None:
    scene = scene_of(
        "ego = new WebotsObject at (0, 0, 1), with webotsAdhoc {}, with shape ConeShape(), with color (1, 0, 0)\n"
        "new WebotsObject at (3, 0, 1), with webotsAdhoc {'physics': False}\n"
        "record ego.position.x as x\n"
    )
    supervisor = Supervisor()
    seen: dict[str, Any] = {}

    def look(simulation: Any, _poses: Any, _actions: Any) -> None:
        cone, box = supervisor.children[1:]
        url = cone.text.split('url "')[1].split('"')[0]
        seen.update(url=url, lines=Path(url).read_text().count("\nf "), cone=cone.text, box=box.text)

    WebotsSimulator(supervisor).simulate(scene, maxSteps=1, on_state=look)
    assert seen["lines"] > 10
    assert "physics Physics { density 1000.0" in seen["cone"]
    assert "baseColor 1.0 0.0 0.0" in seen["cone"]
    assert "physics" not in seen["box"]
    assert len(supervisor.children) == 1
    assert not Path(seen["url"]).exists()


def test_actions_move_push_and_write(tmp_path: Path) -> None:
    scene = scene_of(
        "behavior Act():\n"
        "    take OffsetAction((1, 2, 0))\n"
        "    take ApplyForceAction((0, 5, 0), relative=True)\n"
        f"    take WriteFileAction({str(tmp_path / 'plan.json')!r}, {{'goal': [1, 2]}})\n"
        "ego = new WebotsObject at (0, 0, 1), facing 90 deg, with webotsName 'A', with behavior Act\n"
    )
    node = Node("A")
    WebotsSimulator(Supervisor(node, axes="NUE")).simulate(scene, maxSteps=4)
    assert node.getPosition() == pytest.approx([1, 1, -2])  # north, up, east
    assert node.forces == [([5, 0, 0], True)]
    assert json.loads((tmp_path / "plan.json").read_text()) == {"goal": [1, 2]}


def test_ground_has_the_heights_of_its_terrain() -> None:
    scene = scene_of(
        "hills = (new Hill at (1, 2), facing 90 deg, with width 4, with length 2, with height 0.5,"
        " new Hill at (-2, 0), with height 0.2)\n"
        "ground = new Ground at (0, 0, 0), with terrain hills, with gridSizeX 41, with gridSizeY 21\n"
        "ego = new WebotsObject on ground\n"
    )
    ground = scene.objects[1]
    heights = np.array(ground.heights)
    assert heights.shape == (21, 41)
    assert heights[14, 24] == pytest.approx(0.5)  # at (1, 2)
    assert heights[10, 12] == pytest.approx(0.2)  # at (-2, 0)
    # Its width (4 m, standard deviation 1 m) lies along y, since it is turned by 90 degrees.
    assert heights[16, 24] == pytest.approx(0.5 * np.exp(-0.5))
    assert heights[14, 29] == 0
    assert ground.height == pytest.approx(0.6)
    with pytest.raises(InvalidScenarioError, match="terrain of a Ground is random"):
        scene_of("ego = new Ground with terrain (new Hill with height Range(1, 2),)\n")
    with pytest.raises(NotImplementedError, match="heightAt"):
        scene_of("ego = new Ground with terrain (new Terrain,)\n")


def test_sampling_works_in_both_modes_and_simulating_says_where() -> None:
    text = "ego = new WebotsObject at 1 @ 2, with webotsType 'CAR'\nground = new Ground at 30 @ 0\n"
    assert scene_of(text, mode2D=True).objects[0].elevation is None
    scene = scene_of("ego = new WebotsObject at (1, 2, 3)\n")
    assert scene.objects[0].elevation == 3
    with pytest.raises(SpecifierError, match="elevation"):
        scene_of("ego = new WebotsObject with elevation 3\n")
    with pytest.raises(UnsupportedError, match="inside Webots"):
        scenic.scenarioFromString(MODEL + text).getSimulator().simulate(scene)


def test_the_example_programs_compile_sample_and_run() -> None:
    folder = Path(__file__).parents[2] / "examples" / "webots"
    mars, generic = (scenic.load(folder / f"{name}.scenic") for name in ("mars", "generic"))
    assert [type(thing).__name__ for thing in mars.sample(1, seed=1)[0].objects].count("Pipe") == 2
    crate = Node("CRATE")
    WebotsSimulator(Supervisor(crate)).simulate(generic.sample(1, seed=1)[0], maxSteps=3)
    assert crate.forces == [([0, 60, 0], False)] * 3


def test_the_case_studies_are_worlds_too(tmp_path: Path) -> None:
    folder = Path(__file__).parents[2] / "examples" / "webots"
    (room,) = scenic.load(folder / "vacuum.scenic", params={"numToys": 2}).sample(1, seed=1)
    room.save(tmp_path / "room.wbt")
    nodes = nodes_of((tmp_path / "room.wbt").read_text())[5:]
    assert len(nodes) == len(room.objects)
    (robot,) = (node for node in nodes if node["DEF"] == "VACUUM")
    assert robot["type"] == "IRobotCreate"
    assert robot["customData"] == str(room.egoObject.controllerSeed)
    assert robot["translation"][2] == pytest.approx(0, abs=1e-3)
    assert sum("physics" in node for node in nodes) == 10
    assert (tmp_path / "room_meshes").is_dir()
    room.save(tmp_path / "room.scene")
    again = scenic.load(folder / "vacuum.scenic", params={"numToys": 2}).replay(tmp_path / "room.scene")
    assert again.egoObject.position == room.egoObject.position
    (crossing,) = scenic.load(folder / "robots_crossing.scenic").sample(1, seed=1)
    cars = [Node("CAR_0"), Node("CAR_1")]
    done = WebotsSimulator(Supervisor(*cars)).simulate(
        crossing, maxSteps=20, timestep=0.16, keep_violations=True
    )
    assert cars[0].getPosition()[1] - crossing.egoObject.position.y == pytest.approx(20 * 14 * 0.16)
    assert done.currentTime == 20


# Worlds


def nodes_of(text: str) -> list[dict[str, Any]]:
    """A small reader of the format: nodes as mappings of fields to numbers, words, nodes and lists of these."""
    import re

    words = re.findall(r'"(?:[^"\\]|\\.)*"|[{}\[\]]|[^\s{}\[\]"]+', text.partition("\n")[2])
    found = []
    while words:
        if words[0] == "EXTERNPROTO":
            del words[:2]
            continue
        found.append(_node(words))
    return found


def _node(words: list[str]) -> dict[str, Any]:
    node: dict[str, Any] = {}
    if words[0] == "DEF":
        node["DEF"] = words[1]
        del words[:2]
    node["type"] = words.pop(0)
    assert words.pop(0) == "{"
    while words[0] != "}":
        name = words.pop(0)
        assert name.isidentifier(), name
        node[name] = _value(words)
    words.pop(0)
    return node


def _value(words: list[str]) -> Any:
    if words[0] == "[":
        words.pop(0)
        items: list[Any] = []
        while words[0] != "]":
            items.append(_value(words) if len(words) > 1 and words[1] == "{" else _atom(words.pop(0)))
        words.pop(0)
        return items
    if words[1] == "{":
        return _node(words)
    values = [_atom(words.pop(0))]
    while isinstance(values[0], float) and words[0].lstrip("-")[:1].isdigit():
        values.append(_atom(words.pop(0)))
    return values if len(values) > 1 else values[0]


def _atom(word: str) -> Any:
    if word.startswith('"'):
        return word[1:-1]
    return word if word in ("TRUE", "FALSE") else float(word)


def test_worlds_have_the_objects_where_they_are(tmp_path: Path) -> None:
    (tmp_path / "worlds").mkdir()
    program = tmp_path / "room.scenic"
    program.write_text(
        MODEL + "ego = new WebotsObject at (1, 2, 3), facing (30 deg, 20 deg, 10 deg), with density 50\n"
        "ball = new Object at (Range(4, 5), 0, 1), with shape SpheroidShape()\n"
        "new Object at (-3, 0, 1), facing 200 deg, with shape ConeShape(), with height 2, with color (1, 0, 0, 0.25)\n"
        "new WebotsObject at (0, -4, 0.5), with webotsProto 'Create', with controller 'clean', with customData '\"7\"',"
        " with positionOffset (0, 0, -0.5), with rotationOffset (90 deg, 0, 0)\n"
        "new Ground at (20, 0, 0), with terrain (new Hill with width 4,)\n"
    )
    done = run_here(
        ["sample", program, "-n", 2, "--seed", 1, "-o", tmp_path / "worlds" / "room.wbt"], folder=tmp_path
    )
    assert done.returncode == 0, done.stderr
    for number, scene in enumerate(scenic.load(program).sample(2, seed=1)):
        text = (tmp_path / "worlds" / f"room-{number:03d}.wbt").read_text()
        assert text.startswith("#VRML_SIM R2023a utf8\n")
        assert 'EXTERNPROTO "../protos/Create.proto"' in text
        world = nodes_of(text)
        kinds = [node["type"] for node in world[:5]]
        assert kinds == ["WorldInfo", "Viewpoint", "Background", "DirectionalLight", "Solid"]
        things = world[5:]
        assert [node["DEF"] for node in things] == ["object_0", "object_1", "object_2", "object_3", "GROUND"]
        for node, thing in zip(things, scene.objects, strict=True):
            shift = getattr(thing, "positionOffset", (0, 0, 0))
            assert np.allclose(node["translation"], np.add(tuple(thing.position), shift), atol=1e-6)
            x, y, z, angle = node["rotation"]
            turn = thing.orientation
            wanted = Rotation.from_quat([turn.x, turn.y, turn.z, turn.w])
            if node["type"] == "Create":
                wanted *= Rotation.from_euler("Z", 90, degrees=True)
            found = Rotation.from_rotvec(np.array([x, y, z]) * angle)
            assert (wanted.inv() * found).magnitude() < 1e-6
        box, ball, cone, robot, ground = things
        assert box["physics"] == {"type": "Physics", "density": 50.0, "mass": -1.0}
        assert box["boundingObject"] == {"type": "Box", "size": [1.0, 1.0, 1.0]}
        assert ball["boundingObject"]["type"] == "Sphere"
        assert "physics" not in ball
        assert cone["children"][0]["appearance"]["transparency"] == 0.75
        mesh = (tmp_path / "worlds" / cone["boundingObject"]["url"]).read_text()
        corners = np.array([line.split()[1:] for line in mesh.splitlines() if line[0] == "v"], dtype=float)
        assert np.allclose(np.ptp(corners, axis=0), [1, 1, 2], atol=0.02)
        assert (robot["type"], robot["controller"], robot["customData"]) == ("Create", "clean", '\\"7\\"')
        grid = ground["boundingObject"]
        assert grid["type"] == "ElevationGrid"
        assert np.allclose(grid["height"], np.ravel(scene.objects[4].heights))
        # The grid's corner is that of the ground, and its height 0 is the base's upper side.
        assert ground["translation"][:2] == pytest.approx([15, -5])
