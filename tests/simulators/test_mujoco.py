"""The MuJoCo simulator, against the formulas of mechanics."""

import importlib.util
import json
import math
import multiprocessing
import sys
from collections.abc import Iterator
from itertools import product
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import trimesh

import scenic
from scenic.language.errors import (
    InvalidScenarioError,
    SimulationCreationError,
    SimulationError,
    UnsupportedError,
)
from scenic.runtime.values.values import Vector
from tests.cli.commands import run_here

if importlib.util.find_spec("mujoco") is None:
    pytest.skip("needs the extra [mujoco]", allow_module_level=True)

from scenic.simulators.mujoco import MujocoSimulation, MujocoSimulator
from scenic.simulators.simulation import Simulation

MODEL = "model scenic.simulators.mujoco.model\n"
G = 9.81
STEP = 0.002
MESHES = Path(__file__).parents[2] / "examples" / "meshes"


def scene_of(text: str, seed: int = 0) -> Any:
    return scenic.scenarioFromString(MODEL + text).sample(1, seed=seed)[0]


def run(text: str, steps: int, *, timestep: float = 0.05, **options: Any) -> Any:
    done = MujocoSimulator(**options).simulate(
        scene_of(text), maxSteps=steps, timestep=timestep, keep_poses=True, key=b"1"
    )
    assert done is not None
    return done


def told(action: str) -> str:
    """A behavior that does one thing, and then nothing."""
    return f"behavior B():\n    take {action}\n    while True:\n        wait\n"


def last(done: Any, number: int = 0) -> tuple[np.ndarray[Any, Any], Any]:
    position, orientation = done.poses[-1][number]
    return np.array(tuple(position)), orientation


def records(done: Any, name: str) -> list[Any]:
    return [tuple(value) if isinstance(value, Vector) else value for _, value in done.records[name]]


# Bodies


@pytest.mark.parametrize("timestep", [0.02, 0.1])
def test_bodies_fall_as_the_integrator_says(timestep: float) -> None:
    done = run(
        "ego = new Body at (0, 0, 30), with velocity (1, 2, 3)\n", round(2 / timestep), timestep=timestep
    )
    count = round(2 / STEP)
    # Velocity first, then place: the sum of n velocities.
    height = 30 + 3 * 2 - G * STEP**2 * count * (count + 1) / 2
    np.testing.assert_allclose(last(done)[0], [2, 4, height], rtol=0, atol=1e-9)


def test_boxes_rest_with_their_weight_on_the_ground() -> None:
    seen: dict[str, float] = {}

    class Weighing(MujocoSimulation):
        def destroy(self) -> None:
            import mujoco

            force, total = np.empty(6), 0.0
            for number in range(self.data.ncon):
                mujoco.mj_contactForce(self.model, self.data, number, force)
                total += force[0]
            seen["force"] = total
            super().destroy()

    class Scale(MujocoSimulator):
        def createSimulation(self, scene: Any, **options: Any) -> MujocoSimulation:
            return Weighing(scene, **{**options, "timestep": 0.05})

    done = Scale().simulate(
        scene_of("ego = new Body at (0, 0, 0.3), with mass 7, with height 0.5\n"), maxSteps=60
    )
    assert done is not None
    assert done.trajectory[-1][0].z == pytest.approx(0.25, abs=2e-4)
    assert seen["force"] == pytest.approx(7 * G, rel=1e-6)


@pytest.mark.parametrize(("friction", "speed"), [(0.2, 2), (0.5, 3)])
def test_friction_stops_what_slides(friction: float, speed: float) -> None:
    size = "with width 1, with length 1, with height 0.2"
    done = run(
        f"ego = new Body at (0, 0, 0.1), {size}, with velocity ({speed}, 0, 0), with friction {friction}\n",
        60,
    )
    assert last(done)[0][0] == pytest.approx(speed**2 / (2 * friction * G), rel=0.01)
    assert last(done)[0][1] == pytest.approx(0, abs=1e-6)


@pytest.mark.parametrize(("friction", "slides"), [(0.3, True), (0.45, False)])
def test_friction_decides_who_stays_on_a_slope(friction: float, slides: bool) -> None:
    angle = 0.38  # its tangent is 0.4
    up = 0.05 + 0.05 + 1e-4
    text = f"""
slope = new Fixture at (0, 0, 5), with width 3, with length 20, with height 0.1, facing (0, {angle}, 0)
ego = new Body at (0, {-math.sin(angle) * up}, {5 + math.cos(angle) * up}), facing (0, {angle}, 0), with height 0.1, with friction {friction},
    with width 1, with length 1
"""
    done = run(text, 20)
    begin = np.array(tuple(done.poses[0][0][0]))
    way = float(np.linalg.norm(last(done)[0] - begin))
    down = G * (math.sin(angle) - friction * math.cos(angle))
    if slides:
        assert way == pytest.approx(down / 2, rel=0.03)
    else:
        assert way < 5e-3


def test_momentum_is_kept_in_a_collision() -> None:
    text = """
ego = new Body at (-2, 0, 0), with velocity (3, 0, 0), with mass 2, with shape SpheroidShape()
other = new Body at (0, 0.4, 0), with mass 5, facing 20 deg
record ego.velocity as v
record other.velocity as w
record other.angularVelocity as turning
"""
    done = run(text, 40, gravity=0.0, ground=None)
    total = 2 * np.array(records(done, "v")) + 5 * np.array(records(done, "w"))
    np.testing.assert_allclose(total, np.tile([6, 0, 0], (41, 1)), atol=1e-9)
    assert np.linalg.norm(records(done, "w")[-1]) > 0.5
    assert abs(records(done, "turning")[-1][2]) > 0.1


def test_forces_and_torques_accelerate() -> None:
    text = (
        told("ApplyForce((0, 6, 0), (0, 0, 1))")
        + "ego = new Body with mass 3, with width 2, with length 1, with behavior B\n"
        + "record ego.velocity as v\nrecord ego.angularVelocity as w\nrecord ego.angularSpeed as s\n"
    )
    done = run(text, 40, gravity=0.0, ground=None)
    inertia = 3 * (2**2 + 1**2) / 12
    np.testing.assert_allclose(records(done, "v")[-1], [0, 6 / 3 * 2, 0], atol=1e-9)
    np.testing.assert_allclose(records(done, "w")[-1], [0, 0, 2 / inertia], atol=1e-9)
    assert records(done, "s")[-1] == pytest.approx(2 / inertia)
    assert last(done)[1].yaw == pytest.approx(2**2 / inertia / 2, rel=0.01)


def test_acceleration_lasts_until_the_next_one() -> None:
    text = """
behavior B():
    take SetAcceleration((1, 0, 0))
    wait for 19 steps
    take SetAcceleration((0, 0, 0))
    while True:
        wait
ego = new Body with mass 7, with behavior B
record ego.velocity as v
"""
    done = run(text, 40, gravity=0.0, ground=None)
    assert records(done, "v")[20][0] == pytest.approx(1)
    assert records(done, "v")[40][0] == pytest.approx(1)


@pytest.mark.parametrize(
    ("shape", "size", "volume"),
    [
        ("BoxShape()", (1, 2, 0.5), 1.0),
        ("SpheroidShape()", (1, 2, 3), math.pi),
        ("CylinderShape()", (2, 2, 0.5), math.pi / 2),
        ("CylinderShape(sections=4)", (2, 2, 0.5), 1.0),
        ("BoxShape(initial_rotation=(45 deg, 0, 0))", (1, 1, 1), 0.5),
    ],
)
def test_density_gives_the_mass_of_the_form(
    shape: str, size: tuple[float, float, float], volume: float, masses: dict[int, float]
) -> None:
    width, length, height = size
    text = f"ego = new Body with shape {shape}, with width {width}, with length {length}, with height {height}, with density 3\n"
    MassReading(masses).simulate(scene_of(text), maxSteps=0)
    assert masses[0] == pytest.approx(3 * volume)


class MassReading(MujocoSimulator):
    def __init__(self, found: dict[int, float]) -> None:
        super().__init__()
        self.found = found

    def createSimulation(self, scene: Any, **options: Any) -> MujocoSimulation:
        found = self.found

        class Reading(MujocoSimulation):
            def destroy(self) -> None:
                for number in range(1, self.model.nbody):
                    found[number - 1] = float(self.model.body_mass[number])
                super().destroy()

        return Reading(scene, **{**options, "timestep": 0.05})


@pytest.fixture
def masses() -> dict[int, float]:
    return {}


def test_meshes_have_their_own_volume_and_rest_on_their_hull(masses: dict[int, float]) -> None:
    path = MESHES / "toy_duck.obj"
    text = f"ego = new Body with shape MeshShape.fromFile({str(path)!r}), with density 800, at (0, 0, 1)\n"
    MassReading(masses).simulate(scene_of(text), maxSteps=0)
    mesh = trimesh.load_mesh(path)
    assert masses[0] == pytest.approx(800 * mesh.volume, rel=1e-4)
    done = run(text, 200)
    hull = mesh.convex_hull.vertices
    hull = hull - mesh.bounds.mean(axis=0)
    position, turn = last(done)
    assert float((turn.r.apply(hull) + position)[:, 2].min()) == pytest.approx(0, abs=1e-3)
    # It has come to rest on something flat, not on a point.
    before = np.array(tuple(done.poses[-20][0][0]))
    assert np.linalg.norm(position - before) < 1e-3


BIN = [((0, 0, 0.05), (1, 1, 0.1))] + [
    (place, size)
    for sign in (-1, 1)
    for place, size in (
        ((sign * 0.45, 0, 0.5), (0.1, 1, 0.8)),
        ((0, sign * 0.45, 0.5), (0.8, 0.1, 0.8)),
    )
]


@pytest.fixture(scope="module")
def bin_file(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Path]:
    """An open box with walls of 0.1 m, 1 m wide and 0.9 m high, whose parts are searched once for all tests."""
    parts = []
    for place, size in BIN:
        part = trimesh.creation.box(size)
        part.apply_translation(place)
        parts.append(part)
    path: Path = tmp_path_factory.mktemp("meshes") / "bin.obj"
    trimesh.boolean.union(parts).export(path)
    with pytest.MonkeyPatch.context() as patch:
        patch.setenv("SCENIC_CACHE", "on")
        patch.setenv("SCENIC_CACHE_DIR", str(path.parent))
        yield path


@pytest.mark.parametrize("dynamics", ["static", "free"])
@pytest.mark.parametrize("turn", ["0", "180 deg"])
def test_what_falls_into_a_bin_lies_in_it(
    bin_file: Path, masses: dict[int, float], dynamics: str, turn: str
) -> None:
    text = (
        f"ego = new Object with shape MeshShape.fromFile({str(bin_file)!r}), at (0, 0, 0.45), with roll {turn}, "
        f"with width 1, with length 1, with height 0.9, with dynamics '{dynamics}', with density 200\n"
        "new Body at (0.1, 0.05, 1.4), with shape SpheroidShape(), with width 0.2, with length 0.2, with height 0.2\n"
    )
    done = run(text, 60)
    height = last(done, 1)[0][2]
    # The right way up it takes the ball in; upside down its bottom is above.
    assert height == pytest.approx(0.2 if turn == "0" else 1.0, abs=2e-3)
    assert last(done)[0][2] == pytest.approx(0.45, abs=2e-3)
    if dynamics == "free":
        MassReading(masses).simulate(scene_of(text), maxSteps=0)
        volume = 1 * 1 * 0.9 - 0.8 * 0.8 * 0.8
        assert masses[0] == pytest.approx(200 * volume, rel=1e-6)


def test_what_does_not_collide_has_no_parts_that_do(bin_file: Path) -> None:
    text = (
        f"ego = new Object with shape MeshShape.fromFile({str(bin_file)!r}), at (0, 0, 0.45), with dynamics 'static', "
        "with width 1, with length 1, with height 0.9, with collides False\n"
        "new Body at (0.1, 0.05, 1.4), with shape SpheroidShape(), with width 0.2, with length 0.2, with height 0.2\n"
    )
    assert last(run(text, 60), 1)[0][2] == pytest.approx(0.1, abs=2e-3)


def test_without_the_library_hulls_touch(bin_file: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setitem(sys.modules, "coacd", None)
    # A round hollow, which has no exact parts.
    finer = bin_file.with_name("bowl.obj")
    hollow = trimesh.creation.icosphere(3, 0.42).apply_translation((0, 0, 0.45))
    trimesh.boolean.difference([trimesh.creation.box((1, 1, 0.9)), hollow]).export(finer)
    text = (
        f"ego = new Object with shape MeshShape.fromFile({str(finer)!r}), at (0, 0, 0.45), with dynamics 'static', "
        "with width 1, with length 1, with height 0.9\n"
        "new Body at (0.1, 0.05, 1.4), with shape SpheroidShape(), with width 0.2, with length 0.2, with height 0.2\n"
    )
    with pytest.warns(UserWarning, match="the package coacd is missing"):
        done = run(text, 60)
    assert last(done, 1)[0][2] == pytest.approx(1.0, abs=2e-3)


def test_a_hand_reaches_the_parts_of_what_it_holds(bin_file: Path) -> None:
    """Not the hull: a hand within the bin, far from its walls, holds nothing."""
    for x, holds in (("0", False), ("0.345", True)):
        text = (
            told("Grasp(bin)")
            + f"ego = new Gripper at ({x}, 0, 0.6), with behavior B\n"
            + f"bin = new Body with shape MeshShape.fromFile({str(bin_file)!r}), at (0, 0, 0.45), with width 1, "
            "with length 1, with height 0.9\nrecord ego.holding as held\n"
        )
        assert records(run(text, 3), "held")[-1] is holds


def test_turned_frames_are_kept() -> None:
    text = "ego = new Body with parentOrientation (0.4, 0.2, 0.1), facing 0.3, with angularVelocity (0, 0, 0.5)\n"
    done = run(text, 4, gravity=0.0, ground=None)
    begin, end = done.poses[0][0][1].r, last(done)[1].r
    turned = (end * begin.inv()).as_rotvec()
    np.testing.assert_allclose(turned, [0, 0, 0.1], atol=1e-9)


def test_grounds() -> None:
    lying = "ego = new Body at (0, 0, 0)\n"
    assert last(run(lying, 20))[0][2] == pytest.approx(0, abs=1e-3)
    assert last(run(lying, 20, ground=-3))[0][2] < -1.5
    assert last(run(lying, 20, ground=None))[0][2] < -4
    floor = "floor = new Fixture at (0, 0, -1), with width 9, with length 9, with height 0.2\n"
    assert last(run(lying + floor, 60, ground=None))[0][2] == pytest.approx(-0.4, abs=1e-3)
    through = "ego = new Body with collides False\n"
    assert last(run(through, 20))[0][2] < -4


# Robots


def test_robots_drive_on_arcs() -> None:
    text = told("SetWheelSpeeds(0.2, 0.3)") + (
        "ego = new Robot at (0, 0, 0.06), facing 90 deg, with behavior B\n"
        "record ego.speed as v\nrecord ego.angularVelocity as w\n"
    )
    done = run(text, 200)
    radius = 0.25 / (0.1 / 0.35)
    assert records(done, "v")[-1] == pytest.approx(0.25, rel=0.01)
    assert records(done, "w")[-1][2] == pytest.approx(0.1 / 0.35, rel=0.01)
    places = np.array([tuple(poses[0][0])[:2] for poses in done.poses[20:]])
    # The circle through the places by linear least squares: x² + y² = 2 a x + 2 b y + c.
    system = np.column_stack([2 * places, np.ones(len(places))])
    a, b, c = np.linalg.lstsq(system, (places**2).sum(axis=1), rcond=None)[0]
    assert math.sqrt(c + a * a + b * b) == pytest.approx(radius, rel=0.01)
    # To the left of one who looks along -X lies -Y.
    assert b == pytest.approx(-radius, rel=0.05)


def test_robots_stand_still_and_push() -> None:
    text = told("SetWheelSpeeds(0.4, 0.4)") + (
        "ego = new Robot at (0, 0, 0.06), with behavior B\n"
        "box = new Body at (0, 0.6, 0.1), with width 0.2, with length 0.2, with height 0.2, with density 100, with friction 0.3\n"
        "other = new Robot at (3, 0, 0.06)\n"
    )
    done = run(text, 80)
    assert last(done, 1)[0][1] > 1
    np.testing.assert_allclose(last(done, 2)[0], [3, 0, 0.06], atol=1e-3)


def test_grippers_hold_and_release() -> None:
    text = """
cup = new Body at (0, 0, 0.05), with width 0.1, with length 0.1, with height 0.1
far = new Body at (3, 0, 0.05), with width 0.1, with length 0.1, with height 0.1
behavior B():
    take Grasp(far)
    take SetVelocity((0, 0, -0.5))
    while self.position.z - 0.05 > cup.position.z + 0.06:
        wait
    take SetVelocity((0, 0, 0)), Grasp(cup)
    wait
    take SetVelocity((0.2, 0, 0.2))
    wait for 40 steps
    take Release()
    wait for 20 steps
    terminate
ego = new Gripper at (0, 0, 0.6), with behavior B
record ego.holding as held
record cup.position as cup
record ego.position as hand
record far.position as far
"""
    done = run(text, 150)
    held, cup, hand = records(done, "held"), np.array(records(done, "cup")), np.array(records(done, "hand"))
    first, until = held.index(True), len(held) - held[::-1].index(True)
    assert not any(held[until:])
    between = cup[first + 1 : until] - hand[first + 1 : until]
    assert np.ptp(between, axis=0).max() < 0.01
    assert cup[until - 1][2] - cup[first][2] == pytest.approx(0.2 * 40 * 0.05, rel=0.1)
    assert cup[-1][2] == pytest.approx(0.05, abs=2e-3), "it has fallen"
    np.testing.assert_allclose(records(done, "far")[-1], [3, 0, 0.05], atol=1e-3)


@pytest.mark.parametrize("taker", ["first", "second"])
def test_of_two_grippers_each_may_hold_the_other(taker: str) -> None:
    """Whichever was there first, and whoever else could hold it."""
    held = "second" if taker == "first" else "first"
    small = "with width 0.1, with length 0.1, with height 0.1"
    text = f"""
behavior Take():
    if self is {taker}:
        take Grasp({held})
        wait for 5 steps
        take Release()
    take SetVelocity((0, 0.5, 0))
    wait for 10 steps
first = new Gripper at (0, 0, 1), {small}, with behavior Take
second = new Gripper at (0.12, 0, 1), {small}, with behavior Take
ego = first
record ({taker}.holding, {held}.holding) as held
"""
    done = run(text, 20)
    states = records(done, "held")
    assert (True, False) in states
    assert states[0] == states[-1] == (False, False)
    assert not any(other for _, other in states)


def test_what_is_to_be_held_may_be_named_when_the_gripper_is_made() -> None:
    small = "with width 0.1, with length 0.1, with height 0.1"
    text = (
        f"behavior Hold(action):\n    take action\ncup = new Body at (0, 0, 0.88), {small}\n"
        f"ego = new Gripper at (0, 0, 1), {small}, with behavior Hold(Grasp(cup))\nrecord ego.holding as held\n"
    )
    assert records(run(text, 2), "held") == [False, True, True]


def test_guided_bodies_do_not_fall() -> None:
    done = run(told("SetVelocity((0, 1, 0.5))") + "ego = new Gripper at (0, 0, 2), with behavior B\n", 40)
    np.testing.assert_allclose(last(done)[0], [0, 2, 3], atol=0.03)


def test_guided_bodies_keep_their_acceleration() -> None:
    action = "(SetVelocity((0, 1, 0)), SetAcceleration((0.5, -1, 0.25)))"
    done = run(told(action) + "ego = new Gripper at (0, 0, 2), with behavior B\n", 40)
    np.testing.assert_allclose(last(done)[0], [1, 0, 2.5], atol=0.05)


def test_quadrotors_hover_tilt_and_turn() -> None:
    hovering = run("ego = new Quadrotor at (0, 0, 5)\n", 40)
    np.testing.assert_allclose(last(hovering)[0], [0, 0, 5], atol=1e-6)
    tilted = run(
        told("Fly(pitch=-0.2, turn=0.5)") + "ego = new Quadrotor at (0, 0, 9), with behavior B\n", 40
    )
    assert last(tilted)[1].pitch == pytest.approx(-0.2, abs=0.01)
    assert last(tilted)[1].yaw == pytest.approx(1, abs=0.02)
    assert last(tilted)[0][1] > 1, "a pitch down is an acceleration ahead"


def test_programs_of_the_kinematic_simulator_run_here() -> None:
    text = """
from scenic.simulators.kinematic import *
behavior B():
    take SetWheelSpeeds(0.5, 0.4)
    while True:
        wait
ego = new Object at (0, 0, 0.1), with dynamics 'differential', with width 0.4, with length 0.5, with height 0.2, with behavior B
"""
    scene = scenic.scenarioFromString(text).sample(1, seed=0)[0]
    from scenic.simulators.kinematic import KinematicSimulator

    ends = []
    for simulator in (KinematicSimulator(), MujocoSimulator()):
        done = simulator.simulate(scene, maxSteps=60, timestep=0.05, keep_poses=True)
        assert done is not None
        ends.append(last(done))
    assert ends[0][0] == pytest.approx(ends[1][0], abs=0.05)
    assert ends[0][1].yaw == pytest.approx(ends[1][1].yaw, abs=0.05)


@pytest.mark.parametrize("size", [(0.4, 0.9, 0.5), (0.9, 0.3, 0.9), (1.2, 2.0, 0.4)])
def test_wheels_and_casters_of_robots_are_within_their_box(size: tuple[float, float, float]) -> None:
    import mujoco

    width, length, height = size
    text = f"ego = new Object at (0, 0, 5), with dynamics 'differential', with width {width}, with length {length}, with height {height}\n"
    simulation = MujocoSimulation(
        scene_of(text), key=b"1", deferred=True, maxSteps=1, timestep=0.05, name="one"
    )
    simulation.begin()
    model = simulation.model
    data = mujoco.MjData(model)
    mujoco.mj_forward(model, data)
    parts: dict[int, list[Any]] = {
        int(mujoco.mjtGeom.mjGEOM_ELLIPSOID): [],
        int(mujoco.mjtGeom.mjGEOM_SPHERE): [],
    }
    for kind, place, extent in zip(model.geom_type, data.geom_xpos - [0, 0, 5], model.geom_size, strict=True):
        if int(kind) in parts:
            parts[int(kind)].append((place, extent if extent[1] else np.full(3, extent[0])))
    wheels, casters = parts.values()
    radius = min(height / 2, length / 4)
    for place, extent in wheels:
        assert extent[1] == extent[2] == pytest.approx(radius)
        assert abs(place[0]) + extent[0] == pytest.approx(width / 2)
        np.testing.assert_allclose(place[1:], [0, radius - height / 2], atol=1e-9)
    for place, extent in casters:
        assert abs(place[1]) + extent[1] == pytest.approx(length / 2)
        assert -height / 2 < place[2] - extent[2] < -height / 2 + 0.05 * radius
    assert sorted(np.sign(place[0]) for place, _ in wheels) == [-1, 1]
    assert sorted(np.sign(place[1]) for place, _ in casters) == [-1, 1]


# One simulation is one value


BOUNCING = """
behavior B():
    while True:
        take ApplyForce((Range(-30, 30), Range(-30, 30), 0))
ego = new Body at (0, 0, 1), with width 0.3, with length 0.3, with height 0.3, with density 100, with behavior B
for i in range(4):
    new Body at (Range(-3, 3), Range(-3, 3), 0.3 + i), facing (Range(0, 1), Range(0, 1), 0), with width 0.4, with height 0.3
"""


def courses(deferred: list[Simulation]) -> list[Any]:
    going = list(deferred)
    for simulation in going:
        simulation.begin()
    while going:
        going = [simulation for simulation in going if simulation.advanceOnce()]
    return [simulation.poses for simulation in deferred]


def test_equal_draws_give_equal_courses_alone_and_interleaved() -> None:
    scene = scene_of(BOUNCING)
    options: dict[str, Any] = {"maxSteps": 40, "timestep": 0.05, "keep_poses": True, "name": "one"}
    (alone,) = courses([MujocoSimulation(scene, key=b"1", deferred=True, **options)])
    first, other, second = courses(
        [MujocoSimulation(scene, key=key, deferred=True, **options) for key in (b"1", b"2", b"1")]
    )
    assert alone == first == second
    assert alone != other


def test_simulations_are_replayed() -> None:
    scenario = scenic.scenarioFromString(MODEL + BOUNCING)
    scene = scenario.sample(1, seed=5)[0]
    done = MujocoSimulator().simulate(scene, maxSteps=20, enableDivergenceCheck=True)
    assert done is not None
    data = scenario.simulationToBytes(done)
    again = scenario.simulationFromBytes(data, MujocoSimulator(), maxSteps=20, enableDivergenceCheck=True)
    assert again.trajectory == done.trajectory


def test_objects_may_come_later() -> None:
    text = """
scenario Main():
    setup:
        ego = new Body at (0, 0, 2), with velocity (1, 0, 0)
    compose:
        wait for 10 steps
        do Later() for 10 steps
scenario Later():
    setup:
        new Robot at (5, 5, 0.06)
"""
    late = run(text, 30)
    assert [len(poses) for poses in late.poses[9:12]] == [1, 2, 2]
    alone = run("ego = new Body at (0, 0, 2), with velocity (1, 0, 0)\n", 20)
    np.testing.assert_allclose(last(late)[0], last(alone)[0], atol=1e-9)
    np.testing.assert_allclose(last(late, 1)[0], [5, 5, 0.06], atol=1e-3)


ACTING = """
behavior Acting(*actions):
    for action in actions:
        take action
        wait
small = 0.1
class Small(Body):
    width: small
    length: small
    height: small
scenario Main():
    setup:
        cup = new Small at (0, 0, 1.2), facing (20 deg, 30 deg, 0), with density 10
        ego = new Gripper at (0, 0, 1), with width small, with length small, with height small, with reach 0.2,
            with behavior Acting(SetVelocity((0, 0, 0.2)), Grasp(cup), SetVelocity((0.3, 0, 0.1)))
        new Gripper at (5, 0, 1), with behavior Acting(SetVelocity((0.2, 0, 0)), SetAcceleration((0.5, 0.2, 0)))
        new Robot at (10, 0, 0.06), with behavior Acting(SetWheelSpeeds(0.3, 0.5))
        new Small at (15, 0, 1), with mass 4, with behavior Acting(ApplyForce((0, 3, 40), (0, 0, 0.1)))
        new Quadrotor at (20, 0, 5), with behavior Acting(Fly(11, 0.1, 0.2, 0.4))
        record ego.holding as held
    compose:
        wait for 8 steps
        {late}
        while True:
            wait
scenario Later():
    setup:
        new Gripper at (50, 50, 0.5)
        new Robot at (60, 50, 0.06)
    compose:
        wait
"""


def test_what_acts_goes_on_while_others_come() -> None:
    """What is held stays where it is in the hand, and all commands are in force."""
    alone, late = (run(ACTING.format(late=text), 14) for text in ("pass", "do Later()"))
    assert [len(poses) for poses in late.poses[7:10]] == [6, 8, 8]
    assert records(alone, "held") == records(late, "held") == [False] * 3 + [True] * 12
    for first, second in zip(alone.poses, late.poses, strict=True):
        for (place, turn), (other, other_turn) in zip(first, second, strict=False):
            np.testing.assert_allclose(tuple(place), tuple(other), atol=1e-9)
            assert turn.approxEq(other_turn, 1e-9)


def test_the_command_simulates(tmp_path: Path) -> None:
    (tmp_path / "program.scenic").write_text(MODEL + BOUNCING)
    for folder, jobs in (("one", 1), ("two", 2)):
        options = ["-n", 2, "--seed", 3, "--time", 10, "--simulator", "mujoco", "-j", jobs, "-o", folder]
        done = run_here(["simulate", "program.scenic", *options], folder=tmp_path)
        assert (done.returncode, done.stdout.count(": 10 steps,")) == (0, 2), done.stderr
    for name in ("simulation-0000.jsonl", "simulation-0001.jsonl"):
        first, second = ((tmp_path / folder / name).read_text() for folder in ("one", "two"))
        assert first == second
        assert json.loads(first.splitlines()[0])["settings"]["simulator"] == "MujocoSimulator"


# What goes wrong


@pytest.mark.parametrize(
    ("properties", "message"),
    [
        ("with dynamics 'walker'", "no dynamics 'walker'"),
        ("with mass -1", "the mass of .* must be a positive number, not -1"),
        ("with density 'lead'", "the density of .* must be a positive number"),
        ("with friction -0.1", "the friction of"),
        ("with dynamics 'differential', with wheelRadius 2", "the wheels of .* do not fit"),
        ("with mass 1e-18", "MuJoCo cannot make the scene: .*mass"),
        (
            "with shape ConeShape(), with width 1e-9, with length 1e-9, with height 1e-9",
            "cannot make the scene",
        ),
    ],
)
def test_scenes_that_cannot_be_made(properties: str, message: str) -> None:
    with pytest.raises(SimulationCreationError, match=message) as caught:
        run(f"ego = new Body {properties}\n", 1)
    assert caught.value.code == "SC504"
    assert caught.value.help


def test_the_object_that_cannot_be_made_is_shown() -> None:
    with pytest.raises(SimulationCreationError) as caught:
        run("other = new Body at (9, 9)\nego = new Body\nnew Body at (5, 5),\n    with mass -1\n", 1)
    assert caught.value.line == 4
    late = """
scenario Main():
    setup:
        ego = new Body
    compose:
        wait
        do Later()
scenario Later():
    setup:
        new Body at (3, 3), with mass -1
"""
    with pytest.raises(SimulationCreationError) as caught:
        run(late, 9)
    assert caught.value.line == 11


def test_instability_is_told_and_leaves_no_file(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    text = told("SetVelocity((1e12, 0, 0))") + "ego = new Body\nball = new Body at (9, 0), with behavior B\n"
    with pytest.raises(SimulationError, match="unstable in step 0, where `ball` moved fastest") as caught:
        run(text, 5)
    assert caught.value.code == "SC505"
    assert list(tmp_path.iterdir()) == []


def test_actions_of_other_bodies_are_refused() -> None:
    with pytest.raises(InvalidScenarioError, match="cannot take these actions"):
        run(told("Grasp(self)") + "ego = new Body with behavior B\n", 2)
    with pytest.raises(InvalidScenarioError, match="cannot take these actions"):
        run(told("ApplyForce((0, 0, 1))") + "ego = new Fixture with behavior B\n", 2)


def test_without_the_library_the_extra_is_named(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setitem(sys.modules, "mujoco", None)
    with pytest.raises(UnsupportedError, match="needs the package mujoco-core") as caught:
        MujocoSimulator()
    assert "scenic-lang[mujoco]" in str(caught.value.help)


@pytest.mark.parametrize(
    "options", [{"timestep": 0}, {"physics_step": math.nan}, {"ground": "sea"}, {"images": "film"}]
)
def test_arguments_are_checked(options: dict[str, Any]) -> None:
    with pytest.raises(ValueError, match=r"must be"):
        MujocoSimulator(**options)


# Images

SEEING = """
from scenic import RGBSensor, DepthSensor, SSSensor
ego = new Robot at (0, 0, 0.06), with sensors {
    'front': RGBSensor(offset=(0, 0.2, 0.1), width=64, height=48),
    'depth': DepthSensor(offset=(0, 0.2, 0.1), width=64, height=48),
    'parts': SSSensor(offset=(0, 0.2, 0.1), width=64, height=48)}
ball = new Body at (0.3, 3, 1), with shape SpheroidShape(), with width 0.5, with length 0.5, with height 0.5, with color (1, 0, 0)
record ego.observations['front'] as front
record ego.observations['depth'] as depth
record ego.observations['parts'] as parts
"""


def test_cameras_see_what_falls() -> None:
    done = run(SEEING, 6)
    parts = [value for _, value in done.records["parts"]]
    rows = [np.flatnonzero((image["instance"] == 2).any(axis=1)).mean() for image in parts]
    assert rows == sorted(rows), "it falls in the image"
    assert rows[-1] > rows[0] + 1
    assert set(np.unique(parts[0]["semantic"])) == {0, 2}
    depth = done.records["depth"][0][1]
    hidden = np.isinf(depth)
    np.testing.assert_array_equal(hidden, parts[0]["instance"] == 0)
    assert depth[~hidden].min() == pytest.approx(2.55, abs=0.02)
    image = done.records["front"][0][1]
    assert image.shape == (48, 64, 3)
    assert image[parts[0]["instance"] == 2].mean(axis=0)[0] > 100


def drawn_by_library() -> dict[str, np.ndarray] | str:
    """The images that the library draws, or why it cannot."""
    try:
        records = run(SEEING, 0, images="gl").records
    except UnsupportedError as error:
        return error.message
    return {name: records[name][0][1] for name in ("depth", "front")}


def test_the_renderer_of_the_library_agrees_with_rays() -> None:
    # In a process of its own: drivers of graphics may bring a solver of theirs, which ours in one process with it dies of.
    with multiprocessing.get_context("spawn").Pool(1) as pool:
        drawn = pool.apply(drawn_by_library)
    if isinstance(drawn, str):
        pytest.skip(f"no graphics library: {drawn}")
    cast = run(SEEING, 0)
    ball = cast.records["parts"][0][1]["instance"] == 2
    inner = ball & np.roll(ball, 1, 0) & np.roll(ball, -1, 0) & np.roll(ball, 1, 1) & np.roll(ball, -1, 1)
    np.testing.assert_allclose(drawn["depth"][inner], cast.records["depth"][0][1][inner], atol=0.02)
    assert np.isinf(drawn["depth"][0]).all()
    red = drawn["front"]
    assert (red[inner][:, 0] > 2 * red[inner][:, 1]).all()


@pytest.mark.parametrize(
    ("width", "wheel", "mass"), [(0.35, 0.04, 3.0), (0.6, 0.1, 3.0), (0.35, 0.04, 20.0), (0.5, 0.07, 0.5)]
)
def test_robots_make_good_a_difference_of_speed_in_the_time_they_say(
    width: float, wheel: float, mass: float
) -> None:
    """As what approaches exponentially does, in a twentieth of a second, whatever their size; wheels turn, too, and slow it a little."""
    size = f"with width {width}, with length {width}, with height {2.5 * wheel}"
    text = told("SetWheelSpeeds(0.1, 0.1)") + (
        f"ego = new Robot at (0, 0, {1.25 * wheel}), {size}, with wheelRadius {wheel}, with mass {mass}, with behavior B\n"
        "record ego.speed as v\n"
    )
    speeds = np.array(records(run(text, 12, timestep=0.02), "v")) / 0.1
    # From the second step on, when the wheels have got their grip.
    constant = -0.02 / np.polyfit(np.arange(2, 8), np.log(1 - speeds[2:8]), 1)[0] / 0.02 * 0.02
    assert constant == pytest.approx(0.05, rel=0.15)


@pytest.mark.parametrize("shape", ["BoxShape()", "ConeShape()"])
@pytest.mark.parametrize("size", [(0.2, 0.8, 0.1), (0.8, 0.2, 0.3), (0.1, 0.3, 0.6)])
def test_quadrotors_of_any_form_reach_their_attitude_critically_damped(
    shape: str, size: tuple[float, float, float]
) -> None:
    """About each axis alike: a spring whose constant is 100 per second squared, without overshoot."""
    width, length, height = size
    for turn in ("pitch", "roll"):
        text = told(f"Fly({turn}=0.1)") + (
            f"ego = new Quadrotor at (0, 0, 9), with shape {shape}, with width {width}, with length {length}, "
            f"with height {height}, with behavior B\nrecord ego.{turn} as angle\n"
        )
        angles = np.array(records(run(text, 10, timestep=0.05), "angle"))
        time = 0.05 * np.arange(11)
        np.testing.assert_allclose(angles, 0.1 * (1 - (1 + 10 * time) * np.exp(-10 * time)), atol=2e-3)


def test_friction_is_that_of_sliding_alone() -> None:
    """What resists spinning and rolling is as MuJoCo has it for all bodies."""
    done = run("ego = new Body at (0, 0, 1), with friction 0.4\nnew Body at (5, 0, 1)\n", 0)
    own, usual = (done.model.geom(f"object {number}").friction.tolist() for number in (0, 1))
    assert own == [0.4, *usual[1:]]


def test_a_gripper_lets_go_of_all_that_it_holds() -> None:
    small = "with width 0.06, with length 0.06, with height 0.06, with reach 0.05"
    text = f"""
behavior B():
    take Grasp(left), Grasp(right)
    wait for 10 steps
    take Release()
    wait for 20 steps
aside = new Body at (5, 0, 0.5)
left = new Body at (-0.115, 0, 1), facing (40 deg, 20 deg, 10 deg), {small}
right = new Body at (0.1, 0, 1), {small}
ego = new Gripper at (0, 0, 1), with width 0.1, with reach 0.05, with behavior B
record ego.holding as held
record (left.position.z, right.position.z) as z
record (left.yaw, left.pitch, left.roll) as turn
"""
    done = run(text, 31)
    # As it stood when it was taken.
    for angles in records(done, "turn")[:10]:
        assert angles == pytest.approx(np.radians([40, 20, 10]), abs=0.02)
    heights = records(done, "z")
    assert min(heights[10]) > 0.95
    assert max(heights[-1]) < 0.2
    assert not records(done, "held")[-1]


@pytest.mark.parametrize("speed", [0.4, -0.2])
def test_a_robot_that_begins_with_a_speed_keeps_it(speed: float) -> None:
    """Its wheels turn already, and its drive is told so."""
    text = f"ego = new Robot at (0, 0, 0.06), facing 90 deg, with velocity ({-speed}, 0, 0)\nrecord ego.velocity as v\n"
    velocities = np.array(records(run(text, 20, timestep=0.01), "v"))
    np.testing.assert_allclose(velocities[:, 0], -speed, rtol=0.05)
    np.testing.assert_allclose(velocities[:, 1:], 0, atol=0.05)


@pytest.mark.parametrize(
    ("timestep", "most", "count"),
    [(0.05, 0.002, 25), (0.05, 0.02, 3), (0.1, 0.03, 4), (0.001, 0.002, 1), (0.3, 0.1, 3)],
)
def test_steps_of_the_physics_are_no_longer_than_allowed(timestep: float, most: float, count: int) -> None:
    done = run("ego = new Body at (0, 0, 50)\n", 3, timestep=timestep, physics_step=most)
    assert done.model.opt.timestep == pytest.approx(timestep / count)
    assert done.model.opt.timestep <= most * (1 + 1e-9)
    assert done.data.time == pytest.approx(3 * timestep)


@pytest.mark.parametrize("mass", [0.2, 1.0, 5.0])
def test_quadrotors_fly_alike_whatever_their_mass(mass: float) -> None:
    """Thrust and drag are told as accelerations: dv/dt = a - 0.3 v, from rest."""
    text = (
        told("Fly(thrust=11.81)")
        + f"ego = new Quadrotor at (0, 0, 9), with mass {mass}, with behavior B\nrecord ego.velocity.z as v\n"
    )
    speeds = np.array(records(run(text, 20), "v"))
    np.testing.assert_allclose(speeds, 2 / 0.3 * (1 - np.exp(-0.3 * 0.05 * np.arange(21))), atol=0.01)


def test_parts_that_are_flat_have_no_volume() -> None:
    from scenic.runtime.geometry.meshes.convex_parts import _volume

    box = np.array(list(product((0.0, 1.0), (0.0, 2.0), (0.0, 3.0))))
    assert _volume(box) == pytest.approx(6)
    for flat in (box * [1, 1, 0], box * [0, 1, 1] + [0.5, 0, 0], box[:3]):
        assert _volume(flat) == 0


def test_a_robot_feels_what_touches_its_sides_and_not_the_floor() -> None:
    scene = scene_of(
        "behavior Go():\n"
        "    while True:\n"
        "        take SetWheelSpeeds(0.4, 0.4)\n"
        "ego = new Robot at (0, 0, 0.06), with behavior Go\n"
        "new Fixture at (-0.3, 0.6, 0.1), with width 0.5, with length 0.1, with height 0.2\n"
        "record ego.touches as touches\n"
    )
    done = MujocoSimulator(timestep=0.1).simulate(scene, maxSteps=20, key=b"k")
    felt = [places for _, places in done.result.records["touches"]]
    first = next(step for step, places in enumerate(felt) if places)
    # The wall's face is at y = 0.55, and the robot's front 0.175 ahead of its middle.
    assert 8 <= first <= 13
    assert not any(felt[:first])
    for place in felt[first]:
        assert -0.1751 < place.x < 0.01
        assert place.y == pytest.approx(0.175, abs=0.01)


def test_bodies_at_rest_sleep_until_something_touches_them() -> None:
    scene = scene_of(
        "behavior Push():\n    while True:\n        take SetWheelSpeeds(0.5, 0.5)\n"
        "ego = new Robot at (0, -1, 0.06), with behavior Push()\n"
        "box = new Body at (0, 0, 0.1), with width 0.2, with length 0.2, with height 0.2, with density 50\n"
        "far = new Body at (3, 0, 0.1), with width 0.2, with length 0.2, with height 0.2\n"
        "record (box.position.y, far.position) as places\n"
    )
    asleep: list[int] = []

    def look(simulation: Any, _poses: Any, _actions: Any) -> None:
        asleep.append(int((simulation.data.tree_asleep >= 0).sum()))

    done = MujocoSimulator(sleep=True).simulate(scene, maxSteps=80, on_state=look)
    places = [value for _, value in done.result.records["places"]]
    assert max(asleep) == 2
    assert asleep[-1] == 1  # the box has woken
    assert places[20][0] == pytest.approx(0, abs=1e-3)
    assert places[-1][0] > 0.5
    assert tuple(places[-1][1]) == pytest.approx((3, 0, 0.1), abs=1e-3)


def test_a_car_drives_the_curve_that_its_front_wheels_ask_for() -> None:
    scene = scene_of(
        "behavior Drive():\n"
        "    take SetThrottle(1.5), SetSteering(0)\n"
        "    for i in range(19):\n"
        "        wait\n"
        "    take SetThrottle(0), SetSteering(0.2)\n"
        "    for i in range(59):\n"
        "        wait\n"
        "    take SetThrottle(-2), SetSteering(0)\n"
        "    while True:\n"
        "        wait\n"
        "ego = new Car at (0, 0, 0.76), with behavior Drive()\n"
        "record ego.speed as speed\n"
        "record ego.position as place\n"
        "record ego.yaw as yaw\n"
    )
    records = MujocoSimulator(timestep=0.1).simulate(scene, maxSteps=110).records
    speeds = dict(records["speed"])
    yaws, places = dict(records["yaw"]), dict(records["place"])
    assert speeds[20] == pytest.approx(3, rel=0.05)
    assert abs(places[20].x) < 0.05
    # A turn of speed times curvature, about tan(0.2) / wheelbase.
    turned = (yaws[70] - yaws[40]) / 3
    assert turned == pytest.approx(3 * math.tan(0.2) / (0.6 * 4.3), rel=0.08)
    assert speeds[110] == pytest.approx(0, abs=0.05)
    assert all(place.z == pytest.approx(0.75, abs=0.04) for place in places.values())
