"""What moves on while it is turned: the kinematic models and MuJoCo's bodies against formulas, where signs and frames differ."""

import importlib.util
import math
from typing import Any

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from scenic.simulators.commands import DRAG, GRAVITY
from tests.simulators.test_kinematic import driven, last, run


def told(properties: str, *names: str) -> str:
    """Properties of ``ego``, and that the simulator's values of some are recorded."""
    return properties + "".join(f"\nrecord final ego.{name} as {name}" for name in names)


@pytest.mark.parametrize("model", ["differential", "bicycle", "point"])
@pytest.mark.parametrize("heading", [0.5, 2.5, -1.9])
def test_what_begins_with_a_speed_goes_where_it_looks(model: str, heading: float) -> None:
    done = run(f"ego = new Object facing {heading}, with dynamics '{model}', with speed 3\n", 10)
    assert tuple(last(done)[0]) == pytest.approx((-3 * math.sin(heading), 3 * math.cos(heading), 0))


def test_what_drives_backward_brakes_only_forward() -> None:
    done = driven("SetThrottle(-1)", "with dynamics 'bicycle', with speed -2", 10)
    assert last(done)[0].y == pytest.approx(-2 - 0.5)


def test_after_an_arc_velocity_and_angles_are_those_at_its_end() -> None:
    """Three quarters of a turn to the right in one step; the angle is told within half a turn."""
    properties = "with dynamics 'differential', with width 0.5, with parentOrientation 0.25"
    names = ("velocity", "heading", "yaw", "angularVelocity", "angularSpeed", "speed")
    done = driven("SetWheelSpeeds(1.5, 1)", told(properties, *names), 1, timestep=1.5 * math.pi)
    found, heading = done.records, 0.25 + 0.5 * math.pi
    assert tuple(found["velocity"]) == pytest.approx((-1.25 * math.sin(heading), 1.25 * math.cos(heading), 0))
    assert (found["heading"], found["yaw"]) == pytest.approx((heading, 0.5 * math.pi))
    assert tuple(found["angularVelocity"]) == pytest.approx((0, 0, -1))
    assert (found["angularSpeed"], found["speed"]) == pytest.approx((1, 1.25))


def test_quadrotors_push_along_their_own_axis() -> None:
    yaw, pitch, roll, thrust, dt = 0.7, 0.3, -0.4, 12.0, 0.5
    done = driven(
        f"Fly(pitch={pitch}, roll={roll}, thrust={thrust})",
        told(told(f"with dynamics 'quadrotor', facing {yaw}", "velocity"), "velocity"),
        1,
        dt,
    )
    up = Rotation.from_euler("ZXY", (yaw, pitch, roll)).apply([0, 0, 1])
    force = thrust * up - [0, 0, GRAVITY]
    decay = math.exp(-DRAG * dt)
    assert tuple(done.records["velocity"]) == pytest.approx(tuple(force / DRAG * (1 - decay)))
    assert tuple(last(done)[0]) == pytest.approx(tuple(force / DRAG * (dt - (1 - decay) / DRAG)))


if importlib.util.find_spec("mujoco") is None:
    pytest.skip("the rest needs the extra [mujoco]", allow_module_level=True)

from scenic.simulators.mujoco import MujocoSimulation, MujocoSimulator  # noqa: E402
from tests.simulators import test_mujoco as mujoco  # noqa: E402


def model_of(text: str) -> dict[str, Any]:
    """Of what MuJoCo makes of a scene: masses of bodies, forms of objects and what cameras see, by name."""
    found: dict[str, Any] = {"mass": {}, "size": {}, "place": {}, "type": {}, "camera": {}}

    class Reading(MujocoSimulation):
        def destroy(self) -> None:
            model = self.model
            for number in range(1, model.nbody):
                found["mass"][model.body(number).name] = float(model.body(number).mass[0])
            for number in range(model.ngeom):
                form = model.geom(number)
                found["size"][form.name] = form.size.tolist()
                found["place"][form.name] = form.pos.tolist()
                found["type"][form.name] = int(form.type[0])
            for number in range(model.ncam):
                found["camera"][number] = (model.cam_pos[number].tolist(), float(model.cam_fovy[number]))
            super().destroy()

    class Making(MujocoSimulator):
        def createSimulation(self, scene: Any, **options: Any) -> MujocoSimulation:
            return Reading(scene, **{**options, "timestep": 0.05})

    Making().simulate(mujoco.scene_of(text), maxSteps=0)
    return found


def test_robots_have_their_mass_and_a_body_above_the_ground() -> None:
    text = "ego = new Robot at (0, 0, 0.2), with mass 7, with width 0.4, with length 0.6, with height 0.4, with wheelRadius 0.1\n"
    found = model_of(text + "new Body at (5, 0, 1), with density 2\n")
    robot = [mass for name, mass in found["mass"].items() if name.startswith("object 0")]
    assert sum(robot) == pytest.approx(7)
    assert found["mass"]["object 1"] == pytest.approx(2)
    # A quarter of a wheel's radius stays free below.
    assert found["size"]["object 0"] == pytest.approx([0.2, 0.3, 0.5 * (0.4 - 0.025)])
    assert found["place"]["object 0"] == pytest.approx([0, 0, 0.0125])


def test_forms_of_one_mesh_have_their_own_sizes() -> None:
    shape = "ConeShape()"
    found = model_of(
        f"ego = new Body with shape {shape}, with density 3\n"
        f"new Body at (5, 0, 0), with shape {shape}, with width 2, with length 3, with density 3\n"
        f"new Body at (9, 0, 0), with shape {shape}, with height 5, with density 3\n"
    )
    assert found["mass"]["object 2"] == pytest.approx(5 * found["mass"]["object 0"])
    first, second = found["mass"]["object 0"], found["mass"]["object 1"]
    assert second == pytest.approx(6 * first)


@pytest.mark.parametrize(
    ("shape", "size", "part"),
    [("SpheroidShape()", (1, 1, 3), 3), ("CylinderShape()", (1, 2, 1), 2), ("CylinderShape()", (2, 1, 1), 2)],
)
def test_forms_that_are_round_in_one_plane_only(shape: str, size: tuple[float, ...], part: float) -> None:
    round_one, other = (
        f"with shape {shape}, with width {x}, with length {y}, with height {z}, with density 3\n"
        for x, y, z in ((1, 1, 1), size)
    )
    found = model_of(f"ego = new Body {round_one}new Body at (5, 0, 0), {other}")
    assert found["mass"]["object 1"] / found["mass"]["object 0"] == pytest.approx(part, rel=0.03)


def test_the_camera_of_an_object_is_mounted_where_the_object_says() -> None:
    text = (
        "from scenic import RGBSensor\n"
        "ego = new Body with visionSensorOffset (0.1, 0.2, 0.3), "
        "with sensors {'front': RGBSensor(width=200, height=100, attributes={'fov': 90})}\n"
    )
    ((place, upward),) = model_of(text)["camera"].values()
    assert place == pytest.approx([0.1, 0.2, 0.3])
    assert upward == pytest.approx(math.degrees(2 * math.atan(0.5)))


def test_the_ground_lies_below_the_lowest_object() -> None:
    """Of a plank that stands upright, its own height does not say how far down it reaches."""
    text = (
        "ego = new Body at (0, 0, 4)\n"
        "new Fixture at (5, 0, 0), facing (20 deg, 90 deg, 0), with length 6, with width 0.2, with height 0.2\n"
    )
    found = model_of(text)
    assert found["place"]["ground"][2] == pytest.approx(-3)


def test_turning_is_told_in_the_frame_of_the_world() -> None:
    """A ball that nothing moves turns on about the same axis, however it is turned itself."""
    text = (
        "ego = new Body with shape SpheroidShape(), facing (0.5, 1.2, 0.3), with angularVelocity (0.1, 0.2, 0.5)\n"
        "record ego.angularVelocity as w\nrecord ego.angularSpeed as rate\nrecord ego.orientation as turn\n"
    )
    done = mujoco.run(text, 4, gravity=0.0, ground=None)
    for turning in mujoco.records(done, "w"):
        np.testing.assert_allclose(turning, (0.1, 0.2, 0.5), atol=1e-6)
    begin, end = done.poses[0][0][1].r, mujoco.last(done)[1].r
    np.testing.assert_allclose((end * begin.inv()).as_rotvec(), [0.02, 0.04, 0.1], atol=1e-6)


def test_quadrotors_have_drag_and_turn_about_the_vertical() -> None:
    falling = mujoco.run(
        mujoco.told("Fly(thrust=0)")
        + "ego = new Quadrotor at (0, 0, 500), with behavior B\nrecord ego.velocity as v\n",
        40,
        ground=None,
    )
    speed = mujoco.records(falling, "v")[-1][2]
    assert speed == pytest.approx(-GRAVITY / DRAG * (1 - math.exp(-DRAG * 2)), rel=0.02)
    turning = mujoco.run(
        mujoco.told("Fly(roll=0.6, turn=1)")
        + "ego = new Quadrotor at (0, 0, 500), with behavior B\nrecord ego.angularVelocity as w\n",
        30,
        ground=None,
    )
    np.testing.assert_allclose(mujoco.records(turning, "w")[-1], (0, 0, 1), atol=0.02)
    turn = mujoco.last(turning)[1]
    assert (turn.pitch, turn.roll) == pytest.approx((0, 0.6), abs=0.02), "it does not lag behind"
