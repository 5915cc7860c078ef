"""Drivers that obey the rules of the road, and drivers that ignore some of them."""

from pathlib import Path
from typing import Any

import numpy as np
import pytest

import scenic
from scenic.domains.driving.roads import Network
from scenic.domains.driving.signals import LightTimes, TrafficLights, phases_of
from scenic.language.errors import InvalidScenarioError
from tests.maps import cross

LIGHT = '<signal id="7" s="99" t="-4" zOffset="3" orientation="+" dynamic="yes" country="OpenDRIVE" type="{type}" subtype="-1"/>'


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    made = tmp_path_factory.mktemp("rules")
    (made / "cross.xodr").write_text(cross(arm=100, half=15))
    (made / "light.xodr").write_text(cross(arm=100, half=15, signal=LIGHT.format(type="1000001")))
    (made / "stop.xodr").write_text(cross(arm=100, half=15, signal=LIGHT.format(type="206")))
    (made / "yield.xodr").write_text(cross(arm=100, half=15, signal=LIGHT.format(type="205")))
    return made


def simulated(folder: Path, text: str, map: str, steps: int, lights: str = "{}") -> Any:
    program = (
        f"param map = localPath('{map}.xodr')\nparam traffic_lights = {lights}\n"
        f"model scenic.simulators.newtonian.driving_model\n{text}"
    )
    scenario = scenic.scenarioFromString(program, filename=str(folder / "main.scenic"), mode2D=True)
    done = scenario.getSimulator().simulate(scenario.sample(1, seed=1)[0], maxSteps=steps)
    assert done is not None
    return done


def places(done: Any, number: int = 0) -> Any:
    return np.array([tuple(state.positions[number])[:2] for state in done.trajectory])


# Road 1 comes from the east: traffic to the west keeps to y = 1.75, its line is at x = 15.
WEST = "ego = new Car at (80, 1.75), facing 90 deg, with speed 10, with behavior DriveByRulesBehavior(10{more})\n"


def test_a_red_light_is_halted_for_and_a_green_one_is_not(folder: Path) -> None:
    red = places(simulated(folder, WEST.format(more=""), "light", 150, "{'states': {'7': 'red'}}"))
    # The front stops one metre before the line.
    assert 15.2 < red[-1, 0] - 2.25 < 17
    assert np.abs(np.diff(red[-10:, 0])).max() < 1e-6
    green = places(simulated(folder, WEST.format(more=""), "light", 150, "{'states': {'7': 'green'}}"))
    assert np.abs(green[-1]).max() > 30
    speeds = np.hypot(*np.diff(green, axis=0).T) * 10
    assert speeds[green[1:, 0] > 60].min() > 9


def test_the_red_light_runner_runs_it(folder: Path) -> None:
    done = simulated(
        folder, WEST.format(more=", ignore={'signals'}"), "light", 100, "{'states': {'7': 'red'}}"
    )
    assert places(done)[-1, 0] < 15


def test_a_light_changes_and_the_car_goes_on(folder: Path) -> None:
    lights = "{'green': 5, 'yellow': 2, 'all_red': 8, 'offset': 7}"
    text = WEST.format(more="") + "record simulation().signalState(network.signals[0]) as state\n"
    done = simulated(folder, text, "light", 250, lights)
    states = [value for _, value in done.result.records["state"]]
    assert set(states[:79]) == {"red"}
    assert set(states[82:128]) == {"green"}
    assert np.abs(places(done)[-1]).max() > 30


def test_a_stop_sign_is_a_full_stop(folder: Path) -> None:
    way = places(simulated(folder, WEST.format(more=""), "stop", 200))
    standing = np.hypot(*np.diff(way, axis=0).T) < 0.01
    assert standing.any()
    assert 15.2 < way[1:][standing][0, 0] - 2.25 < 18
    assert np.abs(way[-1]).max() > 20, "it goes on"
    ignoring = places(simulated(folder, WEST.format(more=", ignore='signs'"), "stop", 100))
    assert np.hypot(*np.diff(ignoring, axis=0).T).min() > 0.1


def test_priority_is_given_at_a_sign_and_to_the_right(folder: Path) -> None:
    # From the north, so from the right of a car to the west.
    other = (
        "start = network.laneAt((-1.75, 60))\nm = [m for m in start.maneuvers if m.type is ManeuverType.STRAIGHT][0]\n"
        "new Car at (-1.75, {y}), facing 180 deg, with speed 10, with behavior DriveByRulesBehavior(10)\n"
    )
    for town in ("yield", "cross"):
        done = simulated(folder, WEST.format(more="") + other.format(y=82), town, 220)
        ego, right = places(done), places(done, 1)
        inside = [np.flatnonzero(np.abs(way).max(axis=1) < 13) for way in (ego, right)]
        assert inside[1][0] < inside[0][0]
        assert np.hypot(*(ego - right).T).min() > 3.4, "they pass on neighbouring lanes"


def test_pedestrians_are_let_across_and_others_are_not_waited_for(folder: Path) -> None:
    town = Network.fromFile(folder / "cross.xodr")
    assert town.crossings == ()
    crosswalk = (
        '<objects><object id="3" type="crosswalk" s="60" t="0" hdg="0"><outline>'
        '<cornerRoad s="58" t="-4"/><cornerRoad s="62" t="-4"/><cornerRoad s="62" t="4"/><cornerRoad s="58" t="4"/>'
        "</outline></object></objects>"
    )
    text = (folder / "cross.xodr").read_text().replace("</lanes></road>", f"</lanes>{crosswalk}</road>", 1)
    (folder / "crossing.xodr").write_text(text)
    walker = "new Pedestrian at (55, {y}), facing {turn} deg, with regionContainedIn None, with behavior WalkTo((55, -6), 1.0)\n"
    car = WEST.format(more="").replace("(80, 1.75)", "(100, 1.75)")
    done = simulated(folder, car + walker.format(y=6, turn=180), "crossing", 200)
    ego, person = places(done), places(done, 1)
    assert np.hypot(*(ego - person).T).min() > 2
    assert np.hypot(*np.diff(ego, axis=0).T).min() < 0.05
    free = places(simulated(folder, car, "crossing", 60))
    assert np.hypot(*np.diff(free, axis=0).T).min() > 0.8


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("ignore={'signal'}", "there is no rule 'signal' to ignore"),
        ("ignore='speeding'", "there is no rule 'speeding' to ignore"),
    ],
)
def test_unknown_rules_are_errors(folder: Path, text: str, message: str) -> None:
    with pytest.raises(InvalidScenarioError, match=message):
        simulated(folder, WEST.format(more=f", {text}"), "cross", 3)


@pytest.mark.parametrize(
    ("lights", "message"),
    [
        ({"gren": 5}, "no entry 'gren'"),
        ({"green": -1}, "must be seconds"),
        ({"states": {"77": "red"}}, "the light '77', which the map does not have"),
        ({"states": {"7": "blue"}}, "not a colour"),
    ],
)
def test_wrong_lights_are_errors(folder: Path, lights: dict[str, Any], message: str) -> None:
    with pytest.raises(InvalidScenarioError, match=message):
        TrafficLights(Network.fromFile(folder / "light.xodr"), LightTimes.of(lights))


def test_lights_can_be_set_and_frozen(folder: Path) -> None:
    town = Network.fromFile(folder / "light.xodr")
    (signal,) = town.signals
    lights = TrafficLights(town, LightTimes.of({"green": 10, "yellow": 3, "all_red": 2}))
    assert phases_of(town.intersections[0]) == ((signal,),)

    def at(time: float) -> str:
        lights.time = time
        return lights.get(signal)

    assert [at(time) for time in (0, 9.9, 10.1, 13.1, 15.1)] == ["green", "green", "yellow", "red", "green"]
    lights.set(signal, "red")
    assert at(20) == "red"
    assert at(26) == "yellow", "what was set lasts until the light would change"
    lights.freeze(True)
    assert at(500) == "yellow"
    lights.freeze(False)
    assert [at(time) for time in (501, 503)] == ["yellow", "red"]
