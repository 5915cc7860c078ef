"""Webots: its world model, the supervisor's side against a fake of the documented interface, and worlds read back."""

import json
import runpy
import sys
from pathlib import Path
from types import ModuleType
from typing import Any

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

import scenic
from scenic.formats.webots import write_world
from scenic.language.errors import (
    ScenicValueError,
    SimulationCreationError,
    SimulationError,
    SpecifierError,
    UnsupportedError,
)
from scenic.simulators.webots.simulator import WebotsSimulator
from tests.cli.commands import run_here
from tests.simulators.fake_webots import Node, Supervisor, node_of
from tests.simulators.webots_worlds import corners_of, read_world

MODEL = "model scenic.simulators.webots.model\n"


def scene_of(text: str, **options: Any) -> Any:
    return scenic.scenarioFromString(MODEL + text, **options).sample(1, seed=0)[0]


def of_class(scene: Any, name: str) -> list[Any]:
    return [thing for thing in scene.objects if type(thing).__name__ == name]


def test_the_model_brings_names_of_its_own_modules() -> None:
    scene = scene_of(
        "ego = new Object2D at toVector((toScalar(math.sqrt(1)), 2))\n"
        "assert issubclass(OffsetAction, Action) and pickle.dumps\n"
        "param area = numpy.prod(trimesh.creation.box((1, 2, 3)).extents), axes = utils.Axes.__name__\n"
    )
    assert tuple(scene.egoObject.position) == (1, 2, 0)
    assert (scene.params["area"], scene.params["axes"]) == (pytest.approx(6), "Axes")


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
        Node(name, battery=[], customData="", controller="void") for name in ("ROVER", "ROVER_1", "ROVER_2")
    ]
    WebotsSimulator(Supervisor(*nodes)).simulate(scene, maxSteps=1)
    assert [node.getPosition()[0] for node in nodes] == [0, 3, 6]
    assert nodes[0].fields["battery"].value == [1, 2, 3]
    assert nodes[0].fields["customData"].value == "seed 4"
    assert [node.fields["controller"].value for node in nodes] == ["drive", "void", "other"]
    assert [node.restarts for node in nodes] == [0, 0, 0]  # Webots starts a controller that is another one
    WebotsSimulator(Supervisor(*nodes)).simulate(scene, maxSteps=1)
    assert [node.restarts for node in nodes] == [1, 0, 0]
    assert nodes[1].fields["physics"].value.fields["density"].value == 200
    assert all(node.resets for node in nodes)
    with pytest.raises(SimulationCreationError, match="no node with the DEF name ROVER_1"):
        WebotsSimulator(Supervisor(nodes[0])).simulate(scene, maxSteps=1)
    numbered = [
        Node(name, battery=[], customData="", controller="void") for name in ("ROVER_0", "ROVER_1", "ROVER_2")
    ]
    WebotsSimulator(Supervisor(*numbered)).simulate(scene, maxSteps=1)
    assert [node.getPosition()[0] for node in numbered] == [0, 3, 6]
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
        url = cone.text.split('url [ "')[1].split('"')[0]
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
    (ground,) = of_class(scene, "Ground")
    heights = np.array(ground.heights)
    assert heights.shape == (21, 41)
    assert heights[14, 24] == pytest.approx(0.5)  # at (1, 2)
    assert heights[10, 12] == pytest.approx(0.2)  # at (-2, 0)
    # Its width (4 m, standard deviation 1 m) lies along y, since it is turned by 90 degrees.
    assert heights[16, 24] == pytest.approx(0.5 * np.exp(-0.5))
    assert heights[14, 29] == 0
    assert ground.height == pytest.approx(0.6)
    with pytest.raises(NotImplementedError, match="heightAt"):
        scene_of("ego = new Ground with terrain (new Terrain,)\n")


def test_terrain_may_be_random() -> None:
    text = (
        "class Bump(Hill):\n"
        "    position: new Point in RectangularRegion((0, 0, 0), 0, 8, 8)\n"
        "    width: Range(1, 2)\n    length: Range(1, 2)\n    height: Range(0.5, 1)\n"
        "bumps = [new Bump for _ in range(3)]\n"
        "ego = new Ground with terrain bumps, with gridSize 15\n"
        "rock = new WebotsObject on ego.topSurface, with width 0.01, with length 0.01, with height 0.01\n"
    )
    scenes = scenic.scenarioFromString(MODEL + text).sample(5, seed=0)
    assert len({scene.egoObject.height for scene in scenes}) == 5
    for scene in scenes:
        ground, bumps = scene.egoObject, of_class(scene, "Bump")
        (rock,) = of_class(scene, "WebotsObject")
        across = np.linspace(-5, 5, 15)
        wanted = np.zeros((15, 15))
        for bump in bumps:
            dx, dy = across - bump.position.x, across[:, None] - bump.position.y
            inside = (abs(dx) <= bump.width / 2) & (abs(dy) <= bump.length / 2)
            profile = np.exp(-8 * ((dx / bump.width) ** 2 + (dy / bump.length) ** 2))
            wanted += np.where(inside, bump.height * profile, 0)
        assert np.allclose(ground.heights, wanted)
        assert ground.height == pytest.approx(wanted.max() + 0.1)
        # Its base is half its height below its position; the rock lies on the surface between points of the grid.
        above = rock.position.z - 0.005 + ground.height / 2 - 0.1
        column, row = (np.clip(int((place + 5) / 10 * 14), 0, 13) for place in tuple(rock.position)[:2])
        cell = wanted[row : row + 2, column : column + 2]
        assert cell.min() - 1e-3 <= above <= cell.max() + 1e-3


def test_terrain_of_ones_own_and_the_ground_may_be_random() -> None:
    text = (
        "class Slope(Terrain):\n    rise: Range(0.1, 0.2)\n"
        "    def heightAt(self, point):\n        return self.rise * (point[0] + 5)\n"
        "slope = new Slope\n"
        "ego = new Ground with terrain (slope,), with gridSizeX 3, with gridSizeY 2, with width Range(4, 8)\n"
    )
    for scene in scenic.scenarioFromString(MODEL + text).sample(3, seed=0):
        ground, (slope,) = scene.egoObject, of_class(scene, "Slope")
        row = [slope.rise * (x + 5) for x in (-ground.width / 2, 0, ground.width / 2)]
        assert np.allclose(ground.heights, [row, row])
        assert ground.height == pytest.approx(row[-1] + 0.1)


def test_parts_of_a_terrain_are_in_the_workspace_and_touch_nothing() -> None:
    text = (
        "workspace = Workspace(RectangularRegion((0, 0, 0), 0, 10, 10))\n"
        "hill = new Hill at (Range(0, 8), 0), with width 4, with length 4\n"
        "ego = new WebotsObject at (0, 0, 0)\n"
    )
    scenes = scenic.scenarioFromString(MODEL + text).sample(30, seed=0)
    places = [of_class(scene, "Hill")[0].position.x for scene in scenes]
    assert max(places) <= 3
    assert min(places) < 1  # it may be where the ego is


def test_sampling_works_in_both_modes_and_simulating_says_where() -> None:
    text = "ego = new WebotsObject at 1 @ 2, with webotsType 'CAR'\nground = new Ground at 30 @ 0\n"
    assert scene_of(text, mode2D=True).objects[0].elevation is None
    scene = scene_of("ego = new WebotsObject at (1, 2, 3)\n")
    assert scene.objects[0].elevation == 3
    with pytest.raises(SpecifierError, match="elevation"):
        scene_of("ego = new WebotsObject with elevation 3\n")
    with pytest.raises(UnsupportedError, match="inside Webots"):
        scenic.scenarioFromString(MODEL + text).getSimulator().simulate(scene)


RUN = """
behavior Push():
    while True:
        take ApplyForceAction((0, 3, 0), relative=True)
class Rock(WebotsObject):
    webotsType: 'ROCK'
ego = new WebotsObject at (Range(0, 1), 0, 1), facing 90 deg, with webotsName 'CRATE', with rotationOffset (90 deg, 0, 0),
    with behavior Push, with battery (5, 6, 7)
new Rock at (Range(10, 11), 5, 1)
new Rock at (Range(10, 11), 8, 1)
new WebotsObject at (20, 0, 1), with webotsAdhoc {}, with velocity (0, 0, 2)
pillar = new Object at (30, 0, 1)
record (ego.position.x, ego.speed, ego.battery[0], pillar.position.x) as state
"""


def test_a_simulation_runs_and_the_next_one_begins_from_the_same_world() -> None:
    crate = Node("CRATE", mass=1.5, battery=[9.0, 9.0, 9.0])
    rocks = [Node("ROCK_0"), Node("ROCK_1")]
    supervisor = Supervisor(crate, *rocks)
    simulator = WebotsSimulator(supervisor)
    scenes = scenic.scenarioFromString(MODEL + RUN).sample(2, seed=0)
    runs = []
    for scene in (scenes[0], scenes[1], scenes[0]):
        lifted: list[float] = []
        simulation = simulator.simulate(
            scene,
            maxSteps=50,
            timestep=0.032,
            on_state=lambda run, *_, kept=lifted: kept.append(run.objects[3].position.z),
        )
        runs.append(simulation.result.records["state"])
        # The force acts ahead of the object, which faces -x, whatever the axes of its node.
        start = scene.egoObject.position.x
        for step, (x, speed, charge, far) in runs[-1]:
            assert speed == pytest.approx(2 * 0.032 * step)
            assert x == pytest.approx(start - 2 * 0.032**2 * step * (step + 1) / 2)
            assert (charge, far) == (5, 30)
        assert lifted[-1] == pytest.approx(1 + 2 * 50 * 0.032)
        assert [rock.getPosition() for rock in rocks] == [
            list(thing.position) for thing in of_class(scene, "Rock")
        ]
        assert crate.joints == [pytest.approx(50 * 0.032)]  # and not a multiple: it began at 0 again
        assert supervisor.children[1:] == [crate, *rocks]
    assert runs[2] == runs[0] != runs[1]
    assert supervisor.milliseconds == 3 * 50 * 32


def test_calls_come_in_an_order_that_webots_understands(monkeypatch: pytest.MonkeyPatch) -> None:
    scene = scene_of(
        "ego = new WebotsObject at (0, 0, 1), with webotsName 'A', with controller 'drive', with customData 'seed 4'\n"
        "new WebotsObject at (3, 0, 1), with webotsAdhoc {}\n"
    )
    node = Node("A", customData="", controller="drive")
    supervisor = Supervisor(node)
    names = {id(node): "A", id(supervisor): "supervisor", id(supervisor.root.fields["children"]): "children"}
    names |= {id(field): name for name, field in node.fields.items()}
    calls: list[str] = []

    def logged(name: str, call: Any) -> Any:
        def method(self: Any, *given: Any) -> Any:
            calls.append(f"{names.get(id(self), 'new')}.{name}")
            return call(self, *given)

        return method

    for cls in (Node, type(node.fields["rotation"]), Supervisor):
        for name in dir(cls):
            if name.startswith(("set", "import", "save", "load", "reset", "restart", "remove", "step")):
                monkeypatch.setattr(cls, name, logged(name, getattr(cls, name)))
    simulator = WebotsSimulator(supervisor)
    setting = [
        "customData.setSFString",
        *("translation.setSFVec3f", "rotation.setSFRotation", "A.resetPhysics", "A.setVelocity"),
        "A.restartController",
        "children.importMFNodeFromString",
        *("new.setSFVec3f", "new.setSFRotation", "new.resetPhysics", "new.setVelocity"),
        *("supervisor.step", "supervisor.step"),
        "new.remove",
    ]
    simulator.simulate(scene, maxSteps=2)
    assert calls == ["A.saveState", *setting]
    calls.clear()
    simulator.simulate(scene, maxSteps=2)
    assert calls == ["A.loadState", *setting]


def test_a_requirement_ends_a_simulation_and_the_world_is_clean() -> None:
    scene = scene_of(RUN + "require always ego.position.x > -0.5\n")
    crate = Node("CRATE", mass=0.3, battery=[])
    supervisor = Supervisor(crate, Node("ROCK"), Node("ROCK_1"))
    simulator = WebotsSimulator(supervisor)
    assert simulator.simulate(scene, maxSteps=50, maxIterations=2) is None
    assert len(supervisor.children) == 4
    # A set-up that fails half way leaves nothing either.
    lost = Supervisor(crate, Node("ROCK"))
    made = scene_of(
        "ego = new WebotsObject at (25, 0, 1), with webotsAdhoc {}\n" + RUN.replace("ego", "crate")
    )
    with pytest.raises(SimulationCreationError, match="ROCK_1"):
        WebotsSimulator(lost).simulate(made, maxSteps=1)
    assert len(lost.children) == 3


def test_heights_go_into_the_grids_of_a_running_world() -> None:
    scene = scene_of(
        "hill = new Hill at (1, 0), with width 4, with length 4\n"
        "ego = new Ground with terrain (hill,), with gridSizeX 5, with gridSizeY 3\n"
    )
    grids = [
        Node(
            "", "ElevationGrid", xDimension=0, yDimension=0, xSpacing=1.0, ySpacing=1.0, height=[1.0] * count
        )
        for count in (0, 40)
    ]
    shape = Node("", "Shape", geometry=grids[0])
    node = Node("GROUND", "Solid", children=[shape], boundingObject=grids[1])
    WebotsSimulator(Supervisor(node)).simulate(scene, maxSteps=1)
    for grid in grids:
        values = {name: field.value for name, field in grid.fields.items()}
        assert values.pop("height") == np.ravel(scene.egoObject.heights).tolist()
        assert values == {"xDimension": 5, "yDimension": 3, "xSpacing": 2.5, "ySpacing": 5}
    with pytest.raises(SimulationCreationError, match="has no ElevationGrid"):
        WebotsSimulator(Supervisor(Node("GROUND", "Solid"))).simulate(scene, maxSteps=1)


def test_mistakes_have_codes_and_say_what_to_do() -> None:
    with pytest.raises(UnsupportedError, match="no module `controller`") as outside:
        WebotsSimulator()
    assert "controller of a supervisor" in str(outside.value.help)
    with pytest.raises(SimulationCreationError, match="not a supervisor") as plain:
        WebotsSimulator(Supervisor(is_one=False))
    assert "`supervisor`" in str(plain.value.help)
    twice = scene_of(
        "ego = new WebotsObject at (0, 0, 1), with webotsName 'A'\nnew WebotsObject at (3, 0, 1), with webotsName 'A'\n"
    )
    with pytest.raises(SimulationCreationError, match="same node A") as same:
        WebotsSimulator(Supervisor(Node("A"))).simulate(twice, maxSteps=1)
    assert same.value.span is not None
    assert same.value.span.line == 3
    one = scene_of("ego = new WebotsObject at (0, 0, 1), with webotsName 'A'\n")
    with pytest.raises(SimulationError, match="Webots ended"):
        WebotsSimulator(Supervisor(Node("A"), ends_after=40)).simulate(one, maxSteps=5)
    nameless = scene_of("ego = new WebotsObject at (0, 0, 1)\n")
    with pytest.raises(SimulationCreationError, match="object_0"):
        WebotsSimulator(Supervisor()).simulate(nameless, maxSteps=1)
    listed = scene_of("ego = new WebotsObject at (0, 0, 1), with webotsAdhoc True\n")
    with pytest.raises(SimulationCreationError, match="must be a mapping"):
        WebotsSimulator(Supervisor()).simulate(listed, maxSteps=1)
    far = scene_of(
        "behavior Go():\n    take OffsetAction((0, 1, 0))\nego = new Object at (0, 0, 1), with behavior Go\n"
    )
    with pytest.raises(SimulationError, match="no node with a translation"):
        WebotsSimulator(Supervisor()).simulate(far, maxSteps=1)


@pytest.mark.parametrize(
    ("objects", "message"),
    [
        ("with webotsName 'A'\nnew WebotsObject at (3, 0, 1), with webotsName 'A'", "has the DEF name A of"),
        ("with webotsName 'FLOOR'", "DEF name FLOOR of a node of every written world"),
        ("with webotsName 'my rover'", "'my rover' of .* is not a DEF name"),
    ],
)
def test_worlds_with_wrong_names_are_not_written(objects: str, message: str, tmp_path: Path) -> None:
    scene = scene_of(f"ego = new WebotsObject at (0, 0, 1), {objects}\n")
    with pytest.raises(ScenicValueError, match=message):
        scene.save(tmp_path / "room.wbt")
    assert not any(tmp_path.iterdir())


def test_the_example_programs_compile_sample_and_run() -> None:
    folder = Path(__file__).parents[2] / "examples" / "webots"
    mars, generic = (scenic.load(folder / f"{name}.scenic") for name in ("mars", "generic"))
    assert [type(thing).__name__ for thing in mars.sample(1, seed=1)[0].objects].count("Pipe") == 2
    crate = Node("CRATE")
    WebotsSimulator(Supervisor(crate)).simulate(generic.sample(1, seed=1)[0], maxSteps=3)
    assert crate.forces == [([0, 60, 0], False)] * 3


def test_the_room_of_the_vacuum_is_that_of_the_case_study() -> None:
    examples = Path(__file__).parents[2] / "examples"
    first, second = ((examples / name / "vacuum.scenic").read_text() for name in ("vacuum", "webots"))
    start, end = "right = new Wall", "mutate couch, coffee\n"
    rooms = [text[text.index(start) : text.index(end)] for text in (first, second)]
    assert rooms[0].replace("\n\n", "\n") == rooms[1].replace("\n\n", "\n")


def test_the_case_studies_are_worlds_too(tmp_path: Path) -> None:
    folder = Path(__file__).parents[2] / "examples" / "webots"
    (room,) = scenic.load(folder / "vacuum.scenic", params={"numToys": 2}).sample(1, seed=1)
    room.save(tmp_path / "room.wbt")
    nodes = read_world(tmp_path / "room.wbt")[5:]
    check_places(nodes, room.objects, tmp_path)
    assert len(nodes) == len(room.objects)
    (robot,) = (node for node in nodes if node["DEF"] == "VACUUM")
    assert robot["type"] == "IRobotCreate"
    assert robot["customData"] == str(room.egoObject.controllerSeed)
    assert robot["translation"][2] == pytest.approx(0, abs=1e-3)
    assert sum("physics" in node for node in nodes) == 12
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


def check_places(nodes: Any, things: Any, folder: Path) -> None:
    """Check that nodes are where the objects of a scene are, and that solids are as large."""
    for node, thing in zip(nodes, things, strict=True):
        turn = thing.orientation
        wanted = Rotation.from_quat([turn.x, turn.y, turn.z, turn.w])
        wanted *= Rotation.from_euler("ZXY", getattr(thing, "rotationOffset", (0, 0, 0)))
        x, y, z, angle = node["rotation"]
        found = Rotation.from_rotvec(np.array([x, y, z]) * angle)
        assert (wanted.inv() * found).magnitude() < 1e-9
        shift = tuple(getattr(thing, "positionOffset", (0, 0, 0)))
        place = np.array(node["translation"])
        assert np.allclose(place, np.add(tuple(thing.position), shift), rtol=0, atol=1e-9)
        if node["type"] != "Solid":
            continue
        assert node["children"][0]["geometry"] == node["boundingObject"]
        size = np.array([thing.width, thing.length, thing.height])
        low, high = corners_of(node["boundingObject"], folder)
        assert np.allclose(high - low, size, rtol=0, atol=1e-9)
        if node["boundingObject"]["type"] == "ElevationGrid":
            # Its origin is a corner at height 0; the solid is about the position all the same.
            assert np.allclose((low + high) / 2 + place, tuple(thing.position), rtol=0, atol=1e-9)
        else:
            assert np.allclose(low, -size / 2, rtol=0, atol=1e-9)


def test_worlds_have_the_objects_where_they_are(tmp_path: Path) -> None:
    (tmp_path / "worlds").mkdir()
    program = tmp_path / "room.scenic"
    program.write_text(
        MODEL + "ego = new WebotsObject at (1, 2, 3), facing (30 deg, 20 deg, 10 deg), with density 50\n"
        "ball = new Object at (Range(4, 5), 0, 1), with shape SpheroidShape()\n"
        "new Object at (-3, 0, 1), facing 200 deg, with shape ConeShape(), with height 2, with color (1, 0, 0, 0.25)\n"
        "new WebotsObject at (0, -4, 0.5), with webotsProto 'Create', with controller 'clean', with customData '\"7\"', with battery (1, 2, 3),"
        " with positionOffset (0, 0, -0.5), with rotationOffset (90 deg, 0, 0)\n"
        "new Ground at (20, 0, 0), with terrain (new Hill with width 4,)\n"
    )
    done = run_here(
        ["sample", program, "-n", 2, "--seed", 1, "-o", tmp_path / "worlds" / "room.wbt"], folder=tmp_path
    )
    assert done.returncode == 0, done.stderr
    for number, scene in enumerate(scenic.load(program).sample(2, seed=1)):
        file = tmp_path / "worlds" / f"room-{number:03d}.wbt"
        assert file.read_text().startswith('#VRML_SIM R2023a utf8\nEXTERNPROTO "../protos/Create.proto"\n')
        world = read_world(file)
        kinds = [node["type"] for node in world[:5]]
        assert kinds == ["WorldInfo", "Viewpoint", "Background", "DirectionalLight", "Solid"]
        things = world[5:]
        assert [node["DEF"] for node in things] == ["object_0", "object_1", "object_2", "object_3", "GROUND"]
        check_places(things, [thing for thing in scene.objects if thing.render], file.parent)
        box, ball, cone, robot, ground = things
        assert box["physics"] == {"type": "Physics", "density": 50.0, "mass": -1.0}
        assert box["boundingObject"] == {"type": "Box", "size": [1.0, 1.0, 1.0]}
        assert ball["boundingObject"]["type"] == "Sphere"
        assert "physics" not in ball
        assert cone["children"][0]["appearance"]["transparency"] == 0.75
        assert cone["boundingObject"]["type"] == "Mesh"
        assert (robot["type"], robot["controller"], robot["customData"]) == ("Create", "clean", '"7"')
        assert robot["battery"] == [1, 2, 3]
        grid = ground["boundingObject"]
        assert grid["type"] == "ElevationGrid"
        assert np.allclose(grid["height"], np.ravel(of_class(scene, "Ground")[0].heights))
        # The grid's corner is that of the ground, and its height 0 is the base's upper side.
        assert ground["translation"][:2] == pytest.approx([15, -5])


SHAPES = """
for shape in (BoxShape(), CylinderShape(), ConeShape(), SpheroidShape()):
    new Object at (Range(0, 100), Range(0, 100), 5), with shape shape, with width 2, with length 2, with height 2, facing Range(0, 90) deg
    new Object at (Range(0, 100), Range(0, 100), 5), with shape shape, with width 1, with length 2, with height 3, with mass 5
new Object at (50, 50, -5), with shape BoxShape(initial_rotation=(0, 0, 45 deg)), with width 0.001, with length 3000
new Object at (-5, 50, 5), facing (180 deg, 0, 0), with color (1, 1, 1, 0)
ego = new Object at (-5, 60, 5), facing (0, 180 deg, 90 deg), with render False
"""


def test_every_shape_is_written_as_it_is(tmp_path: Path) -> None:
    for scene in scenic.scenarioFromString(SHAPES).sample(3, seed=2):
        scene.save(tmp_path / "shapes.wbt")
        nodes = read_world(tmp_path / "shapes.wbt")[5:]
        check_places(nodes, [thing for thing in scene.objects if thing.render], tmp_path)
        kinds = [node["boundingObject"]["type"] for node in nodes]
        assert kinds == ["Box", "Box", "Cylinder", "Mesh", "Mesh", "Mesh", "Sphere", "Mesh", "Mesh", "Box"]


def test_a_written_supervisor_runs_the_program_in_its_world(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    program = tmp_path / "push.scenic"
    program.write_text(
        MODEL
        + "param side = 2\n"
        + RUN.replace("webotsName 'CRATE'", "webotsProto 'Crate'").replace(
            "(30, 0, 1)", "(globalParameters.side, 9, 1)"
        )
        + "terminate after 4 steps\n"
    )
    scene = scenic.load(program, params={"side": 30}).sample(3, seed=5)[2]
    monkeypatch.chdir(tmp_path)
    world = tmp_path / "worlds" / "push.wbt"
    write_world(scene, world, program=program.name, params={"side": 30})
    nodes = [node_of(node) for node in read_world(world)]
    assert [node.name for node in nodes[4:]] == [
        "FLOOR",
        "object_0",
        "ROCK_0",
        "ROCK_1",
        "object_4",
        "SCENIC",
    ]
    assert nodes[-1].fields["supervisor"].value
    script = tmp_path / "controllers" / "scenic_supervisor" / "scenic_supervisor.py"
    assert nodes[-1].fields["controller"].value == script.stem
    supervisor = Supervisor(*nodes)
    module = ModuleType("controller")
    module.Supervisor = lambda: supervisor  # type: ignore[attr-defined] # as the module of Webots
    monkeypatch.setitem(sys.modules, "controller", module)
    monkeypatch.chdir(script.parent)  # as Webots does
    runpy.run_path(str(script))
    crate = supervisor.getFromDef("object_0")
    assert crate is not None
    assert len(crate.forces) == 4
    assert crate.getPosition() == pytest.approx(list(scene.egoObject.position))
    assert supervisor.children == nodes
    assert "params={'side': 30}" in script.read_text()
