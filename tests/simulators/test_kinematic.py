"""The kinematic simulator, against closed solutions."""

import math
from typing import Any

import pytest

import scenic
from scenic.language.errors import InvalidScenarioError, SimulationCreationError
from scenic.simulators.commands import DRAG, GRAVITY
from scenic.simulators.kinematic import KinematicSimulator

HEAD = "from scenic.simulators.kinematic import *\n"


def run(text: str, steps: int, timestep: float = 0.1) -> Any:
    scene = scenic.scenarioFromString(HEAD + text).sample(1, seed=0)[0]
    done = KinematicSimulator().simulate(scene, maxSteps=steps, timestep=timestep, keep_poses=True)
    assert done is not None
    return done


def driven(action: str, properties: str, steps: int = 20, timestep: float = 0.1) -> Any:
    text = f"behavior B():\n    take {action}\n    while True:\n        wait\nego = new Object with behavior B, {properties}\n"
    return run(text, steps, timestep)


def last(done: Any) -> tuple[Any, Any]:
    position, orientation = done.poses[-1][0]
    return position, orientation


@pytest.mark.parametrize("timestep", [0.1, 0.5])
def test_points_fall_as_parabolas(timestep: float) -> None:
    steps = round(2 / timestep)
    done = driven("SetVelocity((1, 0, 5)), SetAcceleration((0, 2, -9.81))", "with speed 0", steps, timestep)
    x, y, z = last(done)[0]
    assert (x, y, z) == pytest.approx((2, 4, 10 - 9.81 * 2))


@pytest.mark.parametrize("timestep", [0.1, 0.5])
def test_two_wheels_turn_on_a_circle(timestep: float) -> None:
    properties = "with dynamics 'differential', with width 0.5, facing 90 deg"
    done = driven("SetWheelSpeeds(1, 1.5)", properties, round(3 / timestep), timestep)
    radius, angle = 1.25, 3.0
    position, orientation = last(done)
    # To the left of one who looks along -X lies -Y.
    assert tuple(position) == pytest.approx((-radius * math.sin(angle), -radius * (1 - math.cos(angle)), 0))
    assert math.cos(orientation.yaw - math.pi / 2 - angle) == pytest.approx(1)


def test_bicycles_steer_by_their_base_and_brake_to_a_stop() -> None:
    done = driven("SetSteering(0.3)", "with dynamics 'bicycle', with length 5, with speed 3", 100, 0.05)
    radius = 0.6 * 5 / math.tan(0.3)
    center = (-radius, 0)
    for poses in done.poses:
        assert math.dist(center, tuple(poses[0][0])[:2]) == pytest.approx(radius)
    done = driven("SetThrottle(-2)", "with dynamics 'bicycle', with speed 3", 100, 0.05)
    assert last(done)[0].y == pytest.approx(9 / 4, abs=0.01)


@pytest.mark.parametrize(("speed", "throttle"), [(0, -2), (1, -2), (0, -1e-9)])
def test_vehicles_brake_to_a_stop_and_stand(speed: float, throttle: float) -> None:
    done = driven(f"SetThrottle({throttle})", f"with dynamics 'bicycle', with speed {speed}", 20)
    position, _ = last(done)
    assert position.y == pytest.approx(speed**2 / abs(2 * throttle), abs=0.05)
    assert done.objects[0].speed == speed  # of the scene
    assert done.poses[-1] == done.poses[-2]


def test_vehicles_that_roll_back_may_be_stopped() -> None:
    """By a forward throttle, which then goes on; only braking ends in a stop."""
    done = driven("SetThrottle(2)", "with dynamics 'bicycle', with velocity (0, -1, 0)", 20)
    assert last(done)[0].y == pytest.approx(-2 + 2 * 2**2 / 2)


def test_a_new_velocity_ends_an_acceleration() -> None:
    text = (
        "behavior B():\n    take SetAcceleration((1, 2, 3))\n    take SetVelocity((1, 0, 0))\n"
        "    while True:\n        wait\nego = new Object with behavior B\n"
    )
    places = [poses[0][0] for poses in run(text, 5, timestep=1.0).poses]
    assert tuple(places[1]) == (0.5, 1, 1.5)
    assert [tuple(place) for place in places[2:]] == [(1.5 + n, 1, 1.5) for n in range(4)]


@pytest.mark.parametrize("turn", [0.5, -0.5, 3.0, -3.0])
@pytest.mark.parametrize("model", ["differential", "quadrotor"])
def test_rates_of_turning_are_told_with_their_sign_and_headings_within_half_a_turn(
    model: str, turn: float
) -> None:
    action = f"SetWheelSpeeds({-turn / 2}, {turn / 2})" if model == "differential" else f"Fly(turn={turn})"
    text = (
        f"behavior B():\n    take {action}\n    while True:\n        wait\n"
        f"ego = new Object with behavior B, with dynamics '{model}', with width 1\n"
        "record (ego.angularVelocity, ego.angularSpeed, ego.yaw, ego.heading) as turns\n"
    )
    _, *turns = run(text, 9, timestep=0.5).records["turns"]
    for step, (velocity, speed, yaw, heading) in turns:
        assert tuple(velocity) == pytest.approx((0, 0, turn))
        assert speed == pytest.approx(abs(turn))
        assert -math.pi < yaw <= math.pi
        assert yaw == pytest.approx(heading)
        assert math.remainder(yaw - turn * 0.5 * step, 2 * math.pi) == pytest.approx(0, abs=1e-9)


@pytest.mark.parametrize("model", ["point", "differential", "bicycle", "quadrotor"])
def test_what_faces_south_goes_on_facing_south(model: str) -> None:
    text = f"ego = new Object with dynamics '{model}', facing 180 deg, with speed 2\nrecord (ego.yaw, ego.position) as course\n"
    for _, (yaw, place) in run(text, 3).records["course"]:
        assert yaw == math.pi
        assert place.y <= 0


@pytest.mark.parametrize("velocity", ["(3, 4, 0)", "(0, 0, 5)", "(0, -3, 4)"])
def test_speeds_are_those_in_space(velocity: str) -> None:
    done = run(f"ego = new Object with velocity {velocity}\nrecord ego.speed as speeds\n", 2)
    assert [speed for _, speed in done.records["speeds"][1:]] == [5, 5]


@pytest.mark.parametrize(
    ("action", "shown"),
    [
        ("SetWheelSpeeds(1, 2.5)", "SetWheelSpeeds(1, 2.5)"),
        ("SetVelocity((1, 2))", "SetVelocity(Vector(1, 2, 0))"),
        ("SetAcceleration((0, 1, 2))", "SetAcceleration(Vector(0, 1, 2))"),
        ("SetThrottle(-2)", "SetThrottle(-2)"),
        ("SetSteering(0.1)", "SetSteering(0.1)"),
        ("Fly(1, 2, 3, 4)", "Fly(1, 2, 3, 4)"),
        ("Fly(turn=1)", "Fly(9.81, 0, 0, 1)"),
    ],
)
def test_commands_show_what_they_were_made_of(action: str, shown: str) -> None:
    from scenic.simulators import kinematic

    assert repr(eval(action, vars(kinematic))) == shown


def test_quadrotors_hover_and_have_a_final_speed() -> None:
    done = driven("Fly()", "with dynamics 'quadrotor', at (0, 0, 5)", 50)
    assert tuple(last(done)[0]) == pytest.approx((0, 0, 5))
    done = driven("Fly(thrust=0)", "with dynamics 'quadrotor', at (0, 0, 500)", 600)
    places = [poses[0][0].z for poses in done.poses]
    assert (places[-1] - places[-2]) / 0.1 == pytest.approx(-GRAVITY / DRAG, rel=1e-4)
    done = driven("Fly(roll=0.2)", "with dynamics 'quadrotor'", 10)
    assert last(done)[0].x > 0.1


def test_turned_frames_are_kept() -> None:
    done = driven("SetVelocity((1, 0, 0))", "with parentOrientation (0.4, 0.2, 0.1), facing 0.3", 3)
    first = done.poses[0][0][1]
    assert last(done)[1].approxEq(first, 1e-9)


def test_objects_without_actions_keep_their_velocity() -> None:
    done = run("ego = new Object with velocity (1, 2, 0)\nother = new Object at (9, 9)\n", 10)
    assert tuple(done.poses[-1][0][0]) == pytest.approx((1, 2, 0))
    assert tuple(done.poses[-1][1][0]) == (9, 9, 0)


def test_models_of_other_simulators_are_points_here() -> None:
    done = run(
        "ego = new Object with dynamics 'static', with speed 3\nnew Object at (9, 9), with dynamics 'free', with speed 3\n",
        10,
    )
    assert tuple(done.poses[-1][0][0]) == (0, 0, 0)
    assert tuple(done.poses[-1][1][0]) == pytest.approx((9, 12, 0))
    with pytest.raises(InvalidScenarioError, match="cannot take these actions"):
        driven("SetVelocity((1, 1))", "with dynamics 'static'")


def test_cameras_see_what_moves() -> None:
    text = """
from scenic import SSSensor
ego = new Object with sensors {'parts': SSSensor(width=32, height=24)}
new Object at (0, 5, 0), with speed 10
record ego.observations['parts'] as parts
"""
    sizes = [(image["instance"] == 2).sum() for _, image in run(text, 5).records["parts"]]
    assert sizes == sorted(sizes, reverse=True)
    assert sizes[-1] < 0.5 * sizes[0]


def test_commands_of_another_model_are_refused() -> None:
    with pytest.raises(InvalidScenarioError, match="cannot take these actions"):
        driven("SetSteering(0.1)", "with dynamics 'point'")
    with pytest.raises(SimulationCreationError, match="unknown dynamics 'jet'"):
        driven("SetVelocity((1, 1))", "with dynamics 'jet'")
