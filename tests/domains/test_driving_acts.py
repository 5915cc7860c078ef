"""What actions, helper functions and behaviors do at the borders of their meaning."""

import math
import random
from pathlib import Path
from typing import Any

import pytest

import scenic
from scenic.simulators.newtonian import NewtonianSimulation
from tests.maps import cross, straight


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    made = tmp_path_factory.mktemp("acts")
    (made / "cross.xodr").write_text(cross(arm=100, half=15))
    (made / "straight.xodr").write_text(straight(400))
    return made


def simulated(folder: Path, text: str, map: str = "straight", steps: int = 60, seed: int = 1) -> Any:
    program = f"param map = localPath('{map}.xodr')\nmodel scenic.simulators.newtonian.driving_model\n{text}"
    scenario = scenic.scenarioFromString(program, filename=str(folder / "main.scenic"), mode2D=True)
    random.seed(seed)  # from which the seed of the simulation is drawn
    done = scenario.getSimulator().simulate(scenario.sample(1, seed=seed)[0], maxSteps=steps)
    assert done is not None
    return done


def test_a_constant_throttle_lasts(folder: Path) -> None:
    text = "ego = new Car at (20, -1.75), facing -90 deg, with behavior ConstantThrottleBehavior(0.5)\nrecord ego.speed as v\n"
    speeds = [value for _, value in simulated(folder, text, steps=50).result.records["v"]]
    # 5.6 m/s^2 at full throttle, in steps of 0.1 s.
    assert speeds == pytest.approx([0.28 * step for step in range(51)])


def test_a_velocity_is_set_as_a_vector(folder: Path) -> None:
    text = """
behavior Slide():
    take SetVelocityAction(1, 2)
ego = new Pedestrian at (100, 60), with behavior Slide, with regionContainedIn None
"""
    states = simulated(folder, text, steps=10).trajectory
    assert tuple(states[-1][0]) == pytest.approx((101, 62, 0))


@pytest.mark.parametrize("side", [1, -1])
@pytest.mark.parametrize("kind", ["Pedestrian", "Car"])
def test_crossing_actors_meet_the_other_one_from_either_side(folder: Path, side: int, kind: str) -> None:
    text = f"""
from scenic.simulators.carla.behaviors import CrossingBehavior
behavior Cruise():
    while True:
        take SetSpeedAction(8)
ego = new Car at (150, 1.75), facing 90 deg, with behavior Cruise
other = new {kind} at (100, 1.75 + {side * 6}), facing {90 + 90 * side} deg, with regionContainedIn None,
    with requireVisible False, with behavior CrossingBehavior(ego, 1, 40)
"""
    states = simulated(folder, text, steps=70).trajectory
    assert min(a.distanceTo(b) for a, b in states) < 1.0, "both are at the crossing of their ways at once"
    assert states[5][1].y == pytest.approx(1.75 + side * 6), "it waits until the other one is near"


def test_another_object_is_seen_however_near_it_is(folder: Path) -> None:
    text = """
ego = new Car at (100, -1.75), facing -90 deg, with allowCollisions True
new Object at (100.05, -1.75), with width 0.1, with length 0.1, with allowCollisions True, with regionContainedIn None
record withinDistanceToAnyObjs(ego, 5) as near
record withinDistanceToAnyCars(ego, 5) as car
"""
    records = simulated(folder, text, steps=2).result.records
    assert all(value for _, value in records["near"])
    assert not any(value for _, value in records["car"])


def test_walking_forward_ends_at_an_end_of_the_sidewalk(folder: Path) -> None:
    text = "ego = new Pedestrian at (388, -4.5), facing 30 deg, with behavior WalkForwardBehavior\n"
    ends = set()
    for seed in range(6):
        states = simulated(folder, text, steps=140, seed=seed).trajectory
        assert max(abs(state[0].y + 4.5) for state in states) < 0.5
        away = states[-1][0].x - 388
        ends.add(math.copysign(1, away))
        assert away == pytest.approx(11, abs=0.3) or away == pytest.approx(-14, abs=0.3)
    assert ends == {1.0, -1.0}


def test_turns_use_their_own_controllers_inside_intersections(
    folder: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    used: list[tuple[float, float]] = []
    original = NewtonianSimulation.getTurningControllers

    def noting(self: Any, agent: Any) -> Any:
        longitudinal, lateral = original(self, agent)
        step = lateral.run_step

        def run_step(cte: float) -> float:
            used.append((agent.position.x, agent.position.y))
            return step(cte)

        lateral.run_step = run_step
        return longitudinal, lateral

    monkeypatch.setattr(NewtonianSimulation, "getTurningControllers", noting)
    text = """
start = network.laneAt((-60, -1.75))
m = [m for m in start.maneuvers if m.type is ManeuverType.LEFT_TURN][0]
ego = new Car at (-50, -1.75), facing -90 deg, with behavior FollowTrajectoryBehavior(6, [start, m.connectingLane, m.endLane])
"""
    simulated(folder, text, "cross", steps=200)
    assert len(used) > 20
    assert all(max(abs(x), abs(y)) < 15 for x, y in used)
