"""Things with joints: descriptions, forward and inverse kinematics, simulations."""

from pathlib import Path
from typing import Any

import numpy as np
import pytest

import scenic
from scenic.language.errors import Located
from scenic.simulators.mujoco import MujocoSimulator
from scenic.simulators.mujoco.articulated import description_of, origin_of
from scenic.simulators.mujoco.kinematics import forward
from scenic.simulators.mujoco.robot_descriptions import DescriptionError, read_description

mujoco = pytest.importorskip("mujoco")

ARM = Path(__file__).parents[2] / "examples" / "arm" / "arm.xml"
DRAWER = ARM.with_name("drawer.xml")
MODEL = "model scenic.simulators.mujoco.model\n"


def bullet_files() -> list[Path]:
    """Descriptions of robots in the data of PyBullet, where it is installed."""
    try:
        import pybullet_data
    except ImportError:
        return []
    names = ("kuka_iiwa/model.urdf", "a1/a1.urdf", "r2d2.urdf", "racecar/racecar.urdf", "pr2_gripper.urdf")
    return [path for name in names if (path := Path(pybullet_data.getDataPath(), name)).is_file()]


@pytest.mark.parametrize("path", [ARM, DRAWER, *bullet_files()], ids=lambda path: path.name)
def test_forward_kinematics_are_those_of_mujoco(path: Path) -> None:
    description = read_description(path)
    model = mujoco.MjModel.from_xml_path(str(path))
    data = mujoco.MjData(model)
    generator, count = np.random.default_rng(1), 100
    values = {
        name: generator.uniform(max(joint.low, -3), min(joint.high, 3), count)
        for name, joint in description.joints.items()
    }
    frames = {
        link.name: forward(link.chain, [values[joint.name] for joint in link.joints])
        for link in description.links[1:]
    }
    for number in range(count):
        for name, column in values.items():
            data.joint(name).qpos[0] = column[number]
        mujoco.mj_kinematics(model, data)
        for name, (places, turns) in frames.items():
            x, y, z, w = turns[number % len(turns)]
            assert np.abs(places[number % len(places)] - data.body(name).xpos).max() < 1e-9
            assert abs(data.body(name).xquat @ np.array([w, x, y, z])) == pytest.approx(1, abs=1e-9)


def loaded(text: str, folder: Path) -> scenic.Scenario:
    return scenic.scenarioFromString(MODEL + text, filename=str(folder / "program.scenic"))


PROGRAM = f"""
table = new Fixture at (0, 0, 0.35), with width 1.4, with length 1.4, with height 0.7
ego = new Articulated on table, facing Range(0, 360) deg, with description r"{ARM}",
    with joints {{'turn': Range(-90, 90) deg, 'lift': Range(-60, -10) deg, 'elbow': -0.5, 'left': 0.02}}
tip = ego.frame('grip')
param tip = tip.position
new Body on table, with width 0.1, with length 0.1, with height 0.1
"""


def test_links_are_objects_where_mujoco_has_them(tmp_path: Path) -> None:
    scenario = loaded(PROGRAM, tmp_path)
    description = description_of(str(ARM))
    model = mujoco.MjModel.from_xml_path(str(ARM))
    data = mujoco.MjData(model)
    for scene in scenario.sample(4, seed=1):
        arm = scene.egoObject
        for name, value in arm.jointValues.items():
            data.joint(name).qpos[0] = value
        mujoco.mj_kinematics(model, data)
        turn = arm.orientation
        matrix = np.empty(9)
        mujoco.mju_quat2Mat(matrix, np.array([turn.w, turn.x, turn.y, turn.z]))
        world = matrix.reshape(3, 3) @ (data.site("grip").xpos - origin_of(description)) + tuple(arm.position)
        assert tuple(scene.params["tip"]) == pytest.approx(world.tolist(), abs=1e-9)
        assert set(arm.links) == {
            "base",
            "shoulder",
            "upper",
            "fore",
            "wrist",
            "hand",
            "left finger",
            "right finger",
        }
        # No link is in the table, on which the base stands.
        assert all(link.position.z > 0.7 for link in arm.links.values())


def test_links_collide_with_others_but_not_with_each_other(tmp_path: Path) -> None:
    text = f"""
ego = new Articulated at (0, 0, 0.04), with description r"{ARM}"
box = new Object at (0, 0, Range(0.1, 1.2)), with width 0.2, with length 0.2, with height 0.2
"""
    heights = [scene.objects[-1].position.z for scene in loaded(text, tmp_path).sample(20, seed=1)]
    # The arm stands straight up, to a height of some 0.85 m.
    assert min(heights) > 0.9


@pytest.mark.parametrize(
    ("text", "message", "hint"),
    [
        ("ego = new Articulated with description 'missing.xml'", "cannot read the description", "MJCF"),
        ("ego = new Articulated with description 'broken.xml'", "MuJoCo cannot read", "repair"),
        ("ego = new Articulated with description 'empty.xml'", "no body that touches others", "geoms"),
        (
            "ego = new Articulated with description 'arm.xml', with joints {'elbo': 1}",
            "no joint 'elbo'",
            "'elbow'",
        ),
        (
            "ego = new Articulated with description 'arm.xml', with joints {'elbow': 4}",
            "cannot be 4",
            "radians",
        ),
        (
            "ego = new Articulated with description 'arm.xml', with joints {'elbow': Range(0, 5)}",
            "from -2.61799 to 2.61799",
            "radians",
        ),
        (
            "ego = new Articulated with description 'arm.xml', with joints 3",
            "values of joints by their names",
            "elbow",
        ),
        ("ego = new Articulated with description 7", "needs the path of an MJCF or URDF file", "arm.xml"),
        (
            "ego = new Articulated with description 'arm.xml'\nx = ego.frame('gripp')",
            "no frame 'gripp'",
            "'grip'",
        ),
        (
            "ego = new Articulated with description 'arm.xml'\nx = ego.link('hant')",
            "no link 'hant'",
            "'hand'",
        ),
    ],
)
def test_mistakes_have_a_place_and_a_remedy(text: str, message: str, hint: str, tmp_path: Path) -> None:
    (tmp_path / "broken.xml").write_text("<mujoco><worldbody><geom type='cube'/></worldbody></mujoco>")
    (tmp_path / "empty.xml").write_text(
        "<mujoco><worldbody><body><joint/><inertial mass='1' pos='0 0 0' diaginertia='1 1 1'/></body></worldbody></mujoco>"
    )
    (tmp_path / "arm.xml").write_bytes(ARM.read_bytes())
    (tmp_path / "program.scenic").write_text(MODEL + text + "\n")
    with pytest.raises(Located, match=message) as caught:
        scenic.load(tmp_path / "program.scenic")
    assert caught.value.code in ("SC614", "SC404")
    assert hint in (caught.value.help or "")
    assert caught.value.span is not None


def test_reaching_agrees_with_a_search_by_brute_force() -> None:
    from scenic.simulators.mujoco.reaching import _arm

    arm = _arm(str(ARM))
    chain = arm.description.frame("grip")
    joints = [joint for segment in chain for joint in segment.joints]
    generator = np.random.default_rng(5)
    tried = forward(chain, [generator.uniform(joint.low, joint.high, 200_000) for joint in joints])[0]
    decided = 0
    for place in generator.uniform((-0.9, -0.9, 0.1), (0.9, 0.9, 1.1), (30, 3)):
        nearest = np.linalg.norm(tried - place, axis=1).min()
        if 0.02 < nearest < 0.06:
            continue  # too near the border for so few tries
        decided += 1
        assert arm.solves("grip", place, down=None, tolerance=0.01) == (nearest <= 0.02)
    assert decided > 20


def test_obstacles_keep_an_arm_away(tmp_path: Path) -> None:
    """A lid over the place is in the way of an arm that comes from above, wherever all of it stands; far away it is not."""
    text = f"""
turn = Range(0, 360) deg
ego = new Articulated at (3, 1, 0.04), facing turn, with description r"{ARM}"
place = new Point at Vector(0, 0.4, 0.2).rotatedBy(turn) + (3, 1, 0)
lid = new Fixture at place.position + (0, 0, Uniform(0.06, 5)), facing turn, with width 0.6, with length 0.6, with height 0.02,
    with allowCollisions True
param free = ego.reaches(place, 'grip', down=True)
param under = ego.reaches(place, 'grip', down=True, avoiding=[lid])
param height = lid.position.z
"""
    scenes = loaded(text, tmp_path).sample(12, seed=2)
    assert all(scene.params["free"] for scene in scenes)
    assert all(scene.params["under"] == (scene.params["height"] > 1) for scene in scenes)
    assert len({scene.params["under"] for scene in scenes}) == 2


def test_only_objects_are_obstacles(tmp_path: Path) -> None:
    text = f"ego = new Articulated with description r'{ARM}'\nparam x = ego.reaches((0, 1, 1), 'grip', avoiding=[3])\n"
    with pytest.raises(Located, match="avoiding") as caught:
        loaded(text, tmp_path)
    assert caught.value.span is not None


def simulated(behavior: str, tmp_path: Path, steps: int, **options: Any) -> Any:
    text = f"""
table = new Fixture at (0, 0, 0.35), with width 1.4, with length 1.4, with height 0.7
cube = new Body at (0.1, 0.1, 0.7201), with width 0.04, with length 0.04, with height 0.04, with density 400, with friction 1.5
goal = Vector(0.3, -0.1, 0.73)
ego = new Articulated at (0, -0.3, 0.7401), with description r"{ARM}", with gripper ('left', 'right'),
    with behavior {behavior}, with joints {{'lift': -20 deg, 'elbow': -60 deg, 'bend': -80 deg}}
record final (distance from cube to goal) as gap
record final ego.jointValues as values
record final ego.jointVelocities as speeds
record final (distance from cube to ego.frame('grip')) as reach
record final ego.links['hand'].position as hand
"""
    scene = loaded(text, tmp_path).sample(1, seed=1)[0]
    return MujocoSimulator(timestep=0.1, **options).simulate(scene, maxSteps=steps)


def test_a_thing_is_picked_and_placed(tmp_path: Path) -> None:
    records = simulated("PickAndPlace(cube, goal, 'grip')", tmp_path, 120).records
    assert records["gap"] < 0.04
    assert records["hand"].z > 0.8


def test_actions_move_joints(tmp_path: Path) -> None:
    behaviors = {
        "SetJointPositions({'turn': 0.5})": ("turn", 0.5, 0.0),
        "SetJointVelocities({'turn': 0.2})": ("turn", 0.4, 0.2),
    }
    for action, (joint, value, speed) in behaviors.items():
        text = f"""
behavior Act():
    take {action}
    while True:
        wait
ego = new Articulated at (0, 0, 0.04), with description r"{ARM}", with behavior Act()
record final ego.jointValues as values
record final ego.jointVelocities as speeds
"""
        scene = loaded(text, tmp_path).sample(1, seed=1)[0]
        records = MujocoSimulator(timestep=0.1).simulate(scene, maxSteps=20).records
        assert records["values"][joint] == pytest.approx(value, abs=0.03)
        assert records["speeds"][joint] == pytest.approx(speed, abs=0.05)


def test_a_robot_may_have_a_description(tmp_path: Path) -> None:
    text = f"""
ego = new Robot at (0, 0, 0.04), with description r"{ARM}", with joints {{'turn': Range(-1, 1)}}
other = new Robot at (2, 0, 0.06)
"""
    (scene,) = loaded(text, tmp_path).sample(1, seed=1)
    robot, wheeled = scene.egoObject, scene.objects[-1]
    assert (robot.dynamics, wheeled.dynamics) == ("articulated", "differential")
    assert set(robot.jointValues) == set(description_of(str(ARM)).joints)
    assert robot.width == pytest.approx(0.16, abs=1e-3)
    assert (wheeled.width, wheeled.height, len(wheeled.links)) == (0.35, 0.12, 0)
    MujocoSimulator(timestep=0.1).simulate(scene, maxSteps=2)


def test_a_gripper_knows_what_it_touches_and_drives_their_torques(tmp_path: Path) -> None:
    text = f"""
behavior Close():
    take SetGripper(0)
    while True:
        wait
block = new Body at (0, 0, 0.85), with width 0.03, with length 0.03, with height 0.03, with density 100, with friction 2
ego = new Articulated at (0, 0, 0.04), with description r"{ARM}", with gripper ('left', 'right'),
    with joints {{'left': 0.03, 'right': 0.03}}, with behavior Close(), with present True
place = ego.frame('grip')
record initial ego.gripperContacts as before
record initial ego.links['hand'].position as hand
record final [thing is block for thing in ego.gripperContacts] as after
record final ego.jointTorques as torques
"""
    tip = (
        scenic.scenarioFromString(
            MODEL + text.replace("0, 0, 0.85", "3, 0, 0.85") + "param tip = place.position\n",
            filename=str(tmp_path / "a.scenic"),
        )
        .sample(1, seed=1)[0]
        .params["tip"]
    )
    scene = loaded(text.replace("0, 0, 0.85", f"{tip.x}, {tip.y}, {tip.z}"), tmp_path).sample(1, seed=1)[0]
    records = MujocoSimulator(timestep=0.05).simulate(scene, maxSteps=6).records
    assert records["before"] == ()
    hand = next(thing for thing in scene.objects if getattr(thing, "linkName", None) == "hand")
    assert tuple(records["hand"]) == pytest.approx(tuple(hand.position), abs=1e-9)
    assert records["after"] == [True]
    # It is squeezed from both sides.
    assert records["torques"]["left"] < -1
    assert records["torques"]["right"] < -1


LOOP = """<robot name="loop"><link name="a"/><link name="b"/>
<joint name="one" type="fixed"><parent link="a"/><child link="b"/></joint>
<joint name="two" type="fixed"><parent link="b"/><child link="a"/></joint></robot>"""
NO_MESH = """<robot name="bare"><link name="a"><collision><geometry><mesh filename="away.obj"/></geometry></collision></link></robot>"""


@pytest.mark.parametrize(
    ("content", "message"),
    [
        (LOOP, "cannot read"),
        (NO_MESH, "away"),
        ("", "cannot read"),
        ("<robot name='none'/>", "it.urdf"),
        ("<mujoco/>", "no body"),
    ],
)
def test_descriptions_that_cannot_be(content: str, message: str, tmp_path: Path) -> None:
    (tmp_path / "it.urdf").write_text(content)
    with pytest.raises(DescriptionError, match=message) as caught:
        loaded("ego = new Robot with description 'it.urdf'\n", tmp_path)
    assert caught.value.help
    assert caught.value.span is not None


@pytest.mark.parametrize(
    ("call", "message"),
    [
        ("SetJointPositions({'elbo': 1})", "no joint 'elbo'"),
        ("MoveTo('gripp', (0, 0.3, 0.3))", "no frame 'gripp'"),
    ],
)
def test_names_that_are_unknown_in_a_simulation(call: str, message: str, tmp_path: Path) -> None:
    text = f"""
behavior Act():
    take {call}
ego = new Articulated at (0, 0, 0.04), with description r"{ARM}", with behavior Act()
"""
    scene = loaded(text, tmp_path).sample(1, seed=1)[0]
    with pytest.raises(DescriptionError, match=message) as caught:
        MujocoSimulator(timestep=0.1).simulate(scene, maxSteps=2)
    assert "did you mean" in (caught.value.help or "")
    assert caught.value.span is not None


def test_the_joints_of_a_gripper_are_joints(tmp_path: Path) -> None:
    text = f"ego = new Articulated at (0, 0, 0.04), with description r'{ARM}', with gripper ('left', 'rigt')"
    with pytest.raises(DescriptionError, match="no joint 'rigt'"):
        loaded(text, tmp_path)


def test_an_unchanged_description_is_read_once(tmp_path: Path) -> None:
    path = tmp_path / "arm.xml"
    path.write_bytes(ARM.read_bytes())
    first = read_description(path)
    assert read_description(path) is first
    with pytest.raises(DescriptionError, match="no joint 'knee'"):
        first.joint("knee")


def test_the_example_stands_as_it_says() -> None:
    """The cup and the open drawer are within reach, and the links of the arm are above the table."""
    (scene,) = scenic.load(ARM.with_name("tidy.scenic")).sample(1, seed=1)
    arm = scene.egoObject
    assert (
        0.12
        <= next(thing for thing in scene.objects if scene.names.get(thing) == "cabinet").jointValues["drawer"]
        <= 0.18
    )
    assert all(link.position.z > 0.7 for link in arm.links.values())
