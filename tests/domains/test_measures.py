"""Measures of critical traffic, compared with closed formulas."""

import math
from pathlib import Path
from typing import Any

import pytest
import shapely

import scenic
from scenic.domains.driving.measures import PostEncroachment, post_encroachment_time
from tests.maps import cross, straight

LIGHT = '<signal id="7" s="99" t="-4" zOffset="3" orientation="+" dynamic="yes" country="OpenDRIVE" type="1000001" subtype="-1"/>'


def simulated(folder: Path, text: str, town: str, steps: int, head: str = "") -> Any:
    (folder / "map.xodr").write_text(town)
    program = (
        f"param map = localPath('map.xodr')\n{head}model scenic.simulators.newtonian.driving_model\n"
        f"from scenic.domains.driving.measures import *\n{text}"
    )
    scenario = scenic.scenarioFromString(program, filename=str(folder / "main.scenic"), mode2D=True)
    done = scenario.getSimulator().simulate(scenario.sample(1, seed=1)[0], maxSteps=steps)
    assert done is not None
    return done


def records(done: Any, name: str) -> list[Any]:
    return [value for _, value in done.result.records[name]]


def test_times_and_gaps_to_the_car_ahead(tmp_path: Path) -> None:
    text = """
behavior Cruise(v):
    while True:
        take SetSpeedAction(v)
ego = new Car at (50, -1.75), facing -90 deg, with speed 15, with velocity (15, 0), with behavior Cruise(15)
lead = new Car at (100, -1.75), facing -90 deg, with velocity (10, 0), with behavior Cruise(10)
beside = new Car at (80, 1.75), facing 90 deg
record bumper_gap(ego, lead) as gap
record time_to_collision(ego, lead) as ttc
record time_headway(ego, lead) as headway
record required_deceleration(ego, lead) as braking
record time_to_collision(ego, beside) as aside
record time_to_collision(lead, ego) as behind
record distance_to_lane_border(ego) as border
"""
    done = simulated(tmp_path, text, straight(400), 40)
    for step, gap in enumerate(records(done, "gap")):
        assert gap == pytest.approx(50 - 4.5 - 0.5 * step, abs=1e-6)
        assert records(done, "ttc")[step] == pytest.approx(gap / 5)
        assert records(done, "headway")[step] == pytest.approx(gap / 15)
        assert records(done, "braking")[step] == pytest.approx(25 / (2 * gap))
    assert set(records(done, "aside")) == set(records(done, "behind")) == {math.inf}
    assert records(done, "border")[0] == pytest.approx(0.75)


def test_cars_in_contact_have_no_time_left(tmp_path: Path) -> None:
    """A turned car that comes from beside: its corner is beside the other's, then ahead by less, then in it."""
    text = """
ego = new Car at (50, -1.75), facing -90 deg, with velocity (10, 0), with allowCollisions True
beside = new Car at (53, 1.2), facing -80 deg, with velocity (10, 0), with allowCollisions True
touching = new Car at (49.5, 0), facing -90 deg, with velocity (12, 0), with allowCollisions True
record time_to_collision(ego, beside) as beside
record bumper_gap(ego, beside) as gap
record time_to_collision(ego, touching) as touching
"""
    done = simulated(tmp_path, text, straight(400), 0)
    ego, beside, _ = (shapely.Polygon([(x, y) for x, y, *_ in item.corners[:4]]) for item in done.objects)
    (gap,) = records(done, "gap")
    assert gap in (math.inf, pytest.approx(ego.distance(beside)))
    assert gap > 0
    assert records(done, "beside") == [math.inf]
    assert records(done, "touching") == [0.0]


@pytest.mark.parametrize(("y", "border"), [(-1.75, 0.75), (-1.25, 0.25), (-0.75, -0.25), (-3.0, -0.5)])
def test_distances_to_lane_borders(tmp_path: Path, y: float, border: float) -> None:
    text = (
        f"ego = new Car at (50, {y}), facing -90 deg, with regionContainedIn None\n"
        "record distance_to_lane_border(ego) as border\n"
    )
    done = simulated(tmp_path, text, straight(100), 1)
    assert records(done, "border")[0] == pytest.approx(border)


def boxes(places: list[tuple[float, float]]) -> list[Any]:
    return [shapely.box(x - 1, y - 1, x + 1, y + 1) for x, y in places]


def test_post_encroachment_times() -> None:
    east = boxes([(t, 0) for t in range(-20, 21)])
    assert PostEncroachment(east, boxes([(0, t - 10) for t in range(-20, 21)]), 0.1).time == pytest.approx(
        0.6
    )
    assert PostEncroachment(east, boxes([(0, t) for t in range(-20, 21)]), 0.1).time == 0
    assert PostEncroachment(east, boxes([(30, t) for t in range(-20, 21)]), 0.1).time == math.inf


@pytest.mark.parametrize("ignore", ["()", "{'signals'}"])
def test_red_lights_that_are_run_are_counted(tmp_path: Path, ignore: str) -> None:
    text = (
        f"ego = new Car at (60, 1.75), facing 90 deg, with speed 10, with behavior DriveByRulesBehavior(10, ignore={ignore})\n"
        "other = new Car at (-60, -30), with regionContainedIn None\nrecord is_running_red(ego) as red\n"
    )
    head = "param traffic_lights = {'states': {'7': 'red'}}\n"
    done = simulated(tmp_path, text, cross(arm=100, half=15, signal=LIGHT), 100, head)
    # The car is 4.5 m long, and may be slowing down for a turn from 10 m/s.
    assert sum(records(done, "red")) in ((0,) if ignore == "()" else (4, 5, 6, 7, 8))
    ego, other = done.scene.objects
    assert post_encroachment_time(done, ego, other) == math.inf
