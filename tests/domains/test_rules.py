"""Drivers that obey the rules of the road, and drivers that ignore some of them."""

import math
import random
import re
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import scenic
from scenic.domains.driving.enumerations import ManeuverType
from scenic.domains.driving.right_of_way import Claim, RightOfWay, comes_first
from scenic.domains.driving.roads import Network
from scenic.domains.driving.roundabouts import roundabouts
from scenic.domains.driving.signals import LightTimes, TrafficLights, phases_of
from scenic.formats.embedding import embedded_simulation
from scenic.formats.trajectories import course_document
from scenic.language.errors import InvalidScenarioError
from tests.maps import cross, mirrored

ROUNDABOUT = Path(scenic.__file__).parents[1] / "examples" / "driving" / "roundabout.xodr"
LIGHT = '<signal id="7" s="99" t="-4" zOffset="3" orientation="+" dynamic="yes" country="OpenDRIVE" type="{type}" subtype="-1"/>'


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    made = tmp_path_factory.mktemp("rules")
    (made / "cross.xodr").write_text(cross(arm=100, half=15))
    (made / "wide.xodr").write_text(cross(arm=100, half=30))
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
    halted = simulated(folder, WEST.format(more=""), "light", 210, "{'states': {'7': 'red'}}")
    ((step, number, words),) = halted.notes
    assert (step, number) == (210, 0)
    assert re.fullmatch(r"stands since \d+\.\d s, at the light '7'", words)
    red = places(halted)
    # The front stops one metre before the line.
    assert 15.2 < red[-1, 0] - 2.25 < 17
    assert np.abs(np.diff(red[-10:, 0])).max() < 1e-6
    green = places(simulated(folder, WEST.format(more=""), "light", 150, "{'states': {'7': 'green'}}"))
    assert np.abs(green[-1]).max() > 30
    speeds = np.hypot(*np.diff(green, axis=0).T) * 10
    assert speeds[green[1:, 0] > 60].min() > 9


LEFT = """
own = network.laneAt((80, 1.75))
left = [m for m in own.maneuvers if m.type is ManeuverType.LEFT_TURN][0]
"""


@pytest.mark.parametrize(
    "trajectory", ["[own, left.connectingLane, left.endLane]", "(left,)", "[left.endLane]"]
)
def test_a_car_that_obeys_takes_the_ways_of_its_trajectory(folder: Path, trajectory: str) -> None:
    text = LEFT + WEST.format(more=f", trajectory={trajectory}")
    motion = places(simulated(folder, text, "light", 200, "{'states': {'7': 'green'}}"))
    # From the east to the left is to the south.
    assert motion[-1, 1] < -40
    assert abs(motion[-1, 0]) < 3
    held = places(simulated(folder, text, "light", 150, "{'states': {'7': 'red'}}"))
    assert 15.2 < held[-1, 0] - 2.25 < 17


def test_a_trajectory_must_be_one_that_can_be_driven(folder: Path) -> None:
    text = LEFT + WEST.format(more=",\n    trajectory=[left.endLane, own]")
    with pytest.raises(InvalidScenarioError, match="does not follow") as caught:
        simulated(folder, text, "cross", 2)
    span = caught.value.span
    assert span is not None
    line = text.split("\n")[span.line - 4]
    assert line[span.column : span.end_column] == "[left.endLane, own]", "the argument is marked, not the car"
    with pytest.raises(
        InvalidScenarioError, match=r"is 95 m from road3_lane., in which its trajectory begins"
    ):
        simulated(folder, LEFT + WEST.format(more=", trajectory=[network.laneAt((-35, -1.75))]"), "cross", 2)
    with pytest.raises(TypeError, match="lanes or maneuvers"):
        simulated(folder, LEFT + WEST.format(more=", trajectory=own"), "cross", 2)


def test_a_car_that_obeys_begins_between_the_lanes_of_an_intersection(folder: Path) -> None:
    text = "ego = new Car at (4.91, 6.32), facing 100 deg, with behavior DriveByRulesBehavior\nrecord ego._lane as lane\n"
    done = simulated(folder, text, "wide", 150)
    assert done.result.records["lane"][0][1] is None
    assert np.abs(places(done)[-1]).max() > 30


def test_a_car_that_is_moved_elsewhere_halts_for_the_light_there(folder: Path) -> None:
    text = """
behavior Moved():
    try:
        do DriveByRulesBehavior(10)
    interrupt when simulation().currentTime == 10:
        take SetPositionAction((80, 1.75)), SetOrientationAction(Orientation.fromEuler(90 deg, 0, 0))
        take SetSpeedAction(8)
ego = new Car at (-100, -1.75), facing -90 deg, with speed 8, with behavior Moved
"""
    motion = places(simulated(folder, text, "light", 200, "{'states': {'7': 'red'}}"))
    assert motion[15, 0] > 70
    assert 15.2 < motion[-1, 0] - 2.25 < 17


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


def test_colors_of_lights_are_kept_for_films(folder: Path) -> None:
    text = """
behavior Switch():
    do WaitBehavior() for 2 seconds
    take SetTrafficLightAction(network.signals[0], 'green')
    do WaitBehavior() for 5 seconds
    take FreezeTrafficLightsAction()
    do WaitBehavior() for 2 seconds
ego = new Car at (80, 1.75), facing 90 deg, with behavior Switch
record simulation().signalState(network.signals[0]) as state
"""
    text = text.replace("WaitBehavior()", "FollowLaneBehavior(0)")
    lights = "{'green': 2, 'yellow': 1, 'all_red': 1, 'offset': 2.5}"
    done = simulated(folder, "from scenic.domains.driving.signals import *\n" + text, "light", 100, lights)
    (signal,) = (item for item in done.scene.workspace.network.signals if item.isTrafficLight)
    shown = [colors[signal.uid] for colors in done.light_course]
    # What is set is seen in the next state.
    recorded = [color for _, color in done.result.records["state"]]
    assert shown == recorded[: len(shown)]
    assert set(shown) == {"red", "yellow", "green"}
    assert len({id(colors) for colors in done.light_course}) < 15
    assert "lamps" in embedded_simulation(done)


def test_whoever_begins_in_an_intersection_holds_its_way(folder: Path) -> None:
    text = """
ego = new Car at (15.5, 1.75), facing 90 deg, with behavior DriveByRulesBehavior(8)
new Car at (-1.75, 34), facing 180 deg, with speed 5, with behavior DriveByRulesBehavior(8)
"""
    random.seed(1)
    done = simulated(folder, text, "cross", 90)
    apart = np.hypot(*(places(done, 0) - places(done, 1)).T)
    assert apart.min() > 3


def test_a_stop_sign_is_a_full_stop(folder: Path) -> None:
    way = places(simulated(folder, WEST.format(more=""), "stop", 200))
    standing = np.hypot(*np.diff(way, axis=0).T) < 0.01
    assert standing.any()
    assert 15.2 < way[1:][standing][0, 0] - 2.25 < 18
    assert np.abs(way[-1]).max() > 20, "it goes on"
    ignoring = places(simulated(folder, WEST.format(more=", ignore='signs'"), "stop", 100))
    assert np.hypot(*np.diff(ignoring, axis=0).T).min() > 0.1


def ways(town: Any) -> dict[tuple[int, ManeuverType], Any]:
    return {(way.startLane.road.id, way.type): way for way in town.maneuvers}


def test_priority_by_signs_turns_and_from_the_right(folder: Path) -> None:
    straight, left = ManeuverType.STRAIGHT, ManeuverType.LEFT_TURN
    # Road 1 comes from the east, 2 from the north, 3 from the west, 4 from the south.
    found = ways(Network.fromFile(folder / "cross.xodr"))
    own = found[1, straight]
    assert comes_first(found[2, straight], own)
    assert not comes_first(found[4, straight], own)
    assert comes_first(found[3, straight], found[1, left])
    assert not comes_first(found[3, left], own)
    for sign in ("yield", "stop"):
        found = ways(Network.fromFile(folder / f"{sign}.xodr"))
        assert comes_first(found[4, straight], found[1, straight])
        assert not comes_first(found[1, straight], found[2, straight])


def test_priority_where_traffic_keeps_left(folder: Path) -> None:
    (folder / "left.xodr").write_text(mirrored(cross(arm=100, half=15)))
    town = Network.fromFile(folder / "left.xodr")
    assert town.driveOnLeft
    found = ways(town)
    straight = found[1, ManeuverType.STRAIGHT]
    assert comes_first(found[3, ManeuverType.STRAIGHT], found[1, ManeuverType.RIGHT_TURN])
    assert not comes_first(found[3, ManeuverType.RIGHT_TURN], straight)
    assert not comes_first(found[3, ManeuverType.STRAIGHT], found[1, ManeuverType.LEFT_TURN])
    # Road 4 comes from the north in the mirror: from the right of who drives to the west.
    assert comes_first(found[4, ManeuverType.STRAIGHT], straight)
    assert not comes_first(found[2, ManeuverType.STRAIGHT], straight)


def test_traffic_that_keeps_left_is_the_mirror_image(folder: Path) -> None:
    car = "new Car at ({}, {}), facing {} deg, with speed 8, with behavior DriveByRulesBehavior()\n"
    text = ROUNDABOUT.read_text()
    (folder / "ring.xodr").write_text(text)
    (folder / "mirror.xodr").write_text(mirrored(text))
    random.seed(1)
    right = simulated(folder, "ego = " + car.format(70, 1.75, 90) + car.format(-1.75, 60, 180), "ring", 200)
    random.seed(1)
    left = simulated(folder, "ego = " + car.format(70, -1.75, 90) + car.format(-1.75, -60, 0), "mirror", 200)
    for number in range(2):
        assert places(left, number) == pytest.approx(places(right, number) * (1, -1), abs=1e-6)
    assert np.abs(places(right)[-1]).max() > 30


@pytest.mark.parametrize("sign", ["205", "274"])
def test_traffic_on_the_ring_of_a_roundabout_comes_first(folder: Path, sign: str) -> None:
    (folder / "round.xodr").write_text(ROUNDABOUT.read_text().replace('type="205"', f'type="{sign}"'))
    town = Network.fromFile(folder / "round.xodr")
    (ring,) = roundabouts(town)
    roads = {lane.road.uid for lane in ring.lanes}
    pairs = [(a, b) for a in town.maneuvers for b in a.conflictingManeuvers]
    mixed = [(a, b) for a, b in pairs if a.startLane.road.uid in roads and b.startLane.road.uid not in roads]
    assert len(mixed) >= 4
    assert all(comes_first(a, b) and not comes_first(b, a) for a, b in mixed)


def test_ways_are_taken_in_order(folder: Path) -> None:
    found = ways(Network.fromFile(folder / "cross.xodr"))
    own, right = found[1, ManeuverType.STRAIGHT], found[2, ManeuverType.STRAIGHT]
    cars = object(), object()

    def claim(number: int, way: Any, eta: float, since: float = math.inf, at: float = 10.0) -> Claim:
        return Claim(cars[number], way, eta, since, at, must_wait=False)

    rights = RightOfWay()
    rights.announce(claim(1, right, 4.0))
    assert not rights.take(claim(0, own, 3.0)), "somebody comes from the right"
    assert rights.take(claim(0, own, 0.4)), "but not soon"
    assert not rights.take(claim(1, right, 1.0)), "the way is taken"
    rights.leave(cars[0], own)
    assert rights.take(claim(1, right, 1.0))
    rights.leave(cars[1], right)
    # All wait for each other: the one that has waited longest goes.
    rights.announce(claim(1, right, 0.5, since=5.0))
    assert not rights.take(claim(0, own, 0.5, since=6.0))
    assert rights.take(claim(0, own, 0.5, since=2.0))


def test_cars_that_meet_at_a_crossing_do_not_touch(folder: Path) -> None:
    text = WEST.format(more="") + "".join(
        f"new Car at ({x}, {y}), facing {turn} deg, with speed 10, with behavior DriveByRulesBehavior(10)\n"
        for x, y, turn in ((-1.75, 82, 180), (1.75, -80, 0), (-79, -1.75, -90))
    )
    done = simulated(folder, text, "cross", 450)
    courses = [places(done, number) for number in range(4)]
    assert all(np.abs(course[-1]).max() > 20 for course in courses)
    apart = min(np.hypot(*(a - b).T).min() for number, a in enumerate(courses) for b in courses[:number])
    assert apart > 3.3, "they pass on neighbouring lanes"


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


def test_it_is_noted_why_a_car_stands(folder: Path) -> None:
    done = simulated(folder, WEST.format(more=""), "light", 750, "{'states': {'7': 'red'}}")
    ((step, number, text),) = done.notes
    assert number == 0
    assert text.endswith("at the light '7'")
    assert step / 10 > 59.9 + float(text.split()[2])
    assert course_document(done, k=0, tries=1)["notes"] == [{"step": step, "object": 0, "text": text}]


def test_it_is_noted_behind_whom_a_car_stands(folder: Path) -> None:
    text = (
        "ego = new Car at (80, 1.75), facing 90 deg, with behavior {}\nnew Car at (60, 1.75), facing 90 deg\n"
    )
    for behavior in ("DriveByRulesBehavior()", "FollowLaneBehavior(10, follow_gap=1)"):
        done = simulated(folder, text.format(behavior), "light", 700, "{'states': {'7': 'red'}}")
        ((_, number, words),) = done.notes
        assert (number, words.split(", ", 1)[1]) == (0, "behind Car 1, which is in its way")


def test_it_is_noted_where_the_network_ends(folder: Path) -> None:
    text = "ego = new Car at (-60, 1.75), facing 90 deg, with behavior FollowLaneBehavior(15)\n"
    done = simulated(folder, text, "cross", 200)
    ((_, number, words),) = done.notes
    assert (number, words) == (
        0,
        f"stands where {done.scene.workspace.network.laneAt((-60, 1.75)).uid} ends: no lane follows it",
    )
    assert "notes" not in course_document(simulated(folder, text, "cross", 20), k=0, tries=1)
