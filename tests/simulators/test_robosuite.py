"""Programs of the world model of robosuite: sampled without the package, and simulated where it is installed."""

from pathlib import Path

import numpy as np
import pytest

import scenic
from scenic.language.errors import Located, ScenicError, SimulationCreationError

HEAD = "model scenic.simulators.robosuite.model\n"

BLOCK = """<mujoco><worldbody><body><freejoint/>
<geom type='box' size='0.02 0.03 0.04'/><geom type='sphere' size='0.02' pos='0 0 0.06'/></body></worldbody></mujoco>"""

PROGRAMS = {
    "things": """
table = new Table
for cls in (Cube, Ball, Cylinder, Capsule):
    new cls on table, facing Range(0, 360) deg
ego = new Panda
""",
    "groceries": """
table = new Table
for cls in (Bottle, Can, Milk, Cereal, Bread, Lemon):
    new cls on table
ego = new Sawyer
""",
    "hammer": """
table = new Table
new Hammer on table, facing Range(0, 360) deg, with density 500
ego = new UR5e
""",
    "two tables": """
left = new Table at (0, -0.6, 0.775), with width 0.5, with length 0.5
right = new Table at (0, 0.6, 0.575), with width 0.6, with length 0.4, facing 20 deg
new Box on left
new Box on right, with width 0.08, with color (0, 0, 1)
ego = new IIWA
""",
    "no table": """
new Cube at (0.1, 0.2, 0.02)
ego = new Kinova3
""",
    "pegs": "table = new PegsArena\nnew Cube at (Range(-0.1, -0.05), 0, 0.8205)\nego = new Panda\n",
    "bins": "bins = new BinsArena\nnew Can at (0.1, -0.25, 0.9)\nego = new Panda at (-0.5, -0.1, 0.45)\n",
    "two robots": """
table = new Table
new Milk on table
ego = new PandaRobot at (0, -0.81, 0.45), facing 0 deg
new SawyerRobot at (0, 0.81, 0.45), facing 180 deg
""",
    "custom": f"""
table = new Table
new CustomObject on table, with mjcf {BLOCK!r}
new RoboSuiteObject on table, with shape ConeShape((0.06, 0.06, 0.1))
new Box on table, with dynamics 'static', facing 30 deg
ego = new Panda with initial_qpos (0, 0.3, 0, -2.2, 0, 2.5, 0.8)
""",
    "baxter": "table = new Table\nnew Lemon on table\nego = new Baxter\n",
}


@pytest.mark.parametrize("name", PROGRAMS)
def test_programs_are_sampled_without_robosuite(name: str) -> None:
    scenario = scenic.scenarioFromString(HEAD + PROGRAMS[name])
    (scene,) = scenario.sample(1, seed=1)
    assert scene.egoObject.robot_type


def test_shapes_of_custom_objects_come_from_their_mjcf() -> None:
    pytest.importorskip("mujoco")
    program = f"{HEAD}ego = new CustomObject with mjcf {BLOCK!r}"
    thing = scenic.scenarioFromString(program).sample(1, seed=1)[0].egoObject
    assert (thing.width, thing.length, thing.height) == pytest.approx((0.04, 0.06, 0.12), abs=1e-3)


def test_broken_mjcf_is_refused() -> None:
    pytest.importorskip("mujoco")
    with pytest.raises(Located, match="<string>:2:7: MuJoCo cannot read the description"):
        scenic.scenarioFromString(f"{HEAD}ego = new CustomObject with mjcf '<mujoco><worldbod/></mujoco>'")


@pytest.mark.parametrize("name", PROGRAMS)
def test_poses_are_kept_and_steps_run(name: str) -> None:
    pytest.importorskip("robosuite")
    from scenic.simulators.robosuite import RobosuiteSimulator

    (scene,) = scenic.scenarioFromString(HEAD + PROGRAMS[name]).sample(1, seed=1)
    simulation = RobosuiteSimulator().simulate(scene, maxSteps=50)
    assert simulation is not None
    assert simulation.result is not None
    assert len(simulation.result.trajectory) == 51
    for place, thing in zip(simulation.result.trajectory[0], scene.objects, strict=True):
        assert tuple(place) == pytest.approx(tuple(thing.position), abs=1e-6)
    assert np.isfinite([tuple(place) for place in simulation.result.trajectory[-1]]).all()


def run(program: str, steps: int = 20, **settings: object) -> object:
    pytest.importorskip("robosuite")
    from scenic.simulators.robosuite import RobosuiteSimulator

    (scene,) = scenic.scenarioFromString(HEAD + program).sample(1, seed=1)
    return RobosuiteSimulator(**settings).simulate(scene, maxSteps=steps)


def test_the_arm_lifts_a_cube() -> None:
    done = run(
        """
table = new Table
cube = new Cube at (0.05, 0.1, 0.8205)
ego = new Panda with behavior PickAndLift(cube)
record final cube.position.z as height
""",
        100,
    )
    assert done.result.records["height"] > 0.88


def test_named_controllers_act() -> None:
    done = run(
        """
behavior Turn():
    while True:
        take JointPositionAction((1, 0, 0, 0, 0, 0, 0), gripper=-1)
table = new Table
ego = new Panda with controller_config 'JOINT_POSITION', with behavior Turn
record final ego.joint_positions[0] as turn
""",
        20,
    )
    assert done.result.records["turn"] > 0.1


def test_objects_of_own_tasks_get_the_poses_of_variables() -> None:
    done = run("cube = new Cube at (0.1, 0.05, 0.83)\nego = new Panda\n", 2, use_environment="Lift")
    assert tuple(done.result.trajectory[0][1]) == pytest.approx((0.1, 0.05, 0.83))
    assert done.result.trajectory[-1][1].z < 0.825


@pytest.mark.parametrize(
    ("program", "settings", "message"),
    [
        ("ego = new Cube\n", {}, "robosuite needs a robot"),
        ("ego = new Panda\n", {"use_environment": "Lit"}, "robosuite has no environment 'Lit'"),
        ("cup = new Cube\nego = new Panda\n", {"use_environment": "Lift"}, "has no object 'cup'"),
        ("ego = new Panda with controller_config 'JOINT'\n", {}, "robosuite has no controllers 'JOINT'"),
        ("new Table with arena 'bin'\nego = new Panda\n", {}, "robosuite has no arena 'bin'"),
    ],
)
def test_mistakes_are_refused(program: str, settings: dict[str, object], message: str) -> None:
    with pytest.raises(SimulationCreationError, match=message):
        run(program, **settings)


def test_without_the_package_a_command_says_how_to_install_it(monkeypatch: pytest.MonkeyPatch) -> None:
    import sys

    monkeypatch.setitem(sys.modules, "robosuite", None)
    from scenic.simulators.robosuite import RobosuiteSimulator

    (scene,) = scenic.scenarioFromString(HEAD + "ego = new Panda").sample(1, seed=1)
    with pytest.raises(ScenicError, match="needs the package robosuite"):
        RobosuiteSimulator().simulate(scene, maxSteps=1)


def test_a_file_is_read_from_the_folder_of_the_program(tmp_path: Path) -> None:
    pytest.importorskip("mujoco")
    (tmp_path / "block.xml").write_text(BLOCK)
    (tmp_path / "scene.scenic").write_text(f"{HEAD}ego = new CustomObject with mjcf 'block.xml'\n")
    thing = scenic.load(tmp_path / "scene.scenic").sample(1, seed=1)[0].egoObject
    assert thing.height == pytest.approx(0.12, abs=1e-3)
