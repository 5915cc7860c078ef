"""Ways that cars and pedestrians are told: trajectories, pure pursuit, walking."""

import math
from itertools import pairwise
from pathlib import Path
from typing import Any

import pytest
import shapely

import scenic
from scenic.domains.driving.controllers import PurePursuitLateralController
from scenic.domains.driving.followed_lines import FollowedLine
from scenic.domains.driving.roads import Network
from scenic.domains.driving.trajectories import Route, Trajectory
from tests.maps import RoadText, cross, map_text, piece, straight, two_way


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    made = tmp_path_factory.mktemp("ways")
    (made / "cross.xodr").write_text(cross(arm=100, half=15))
    (made / "straight.xodr").write_text(straight(1000))
    round_road = piece(0, 0, 0, 250, '<arc curvature="0.02"/>')
    (made / "round.xodr").write_text(map_text([RoadText("1", 250, round_road, two_way(False, False))]))
    return made


def simulated(folder: Path, text: str, map: str = "straight", steps: int = 150) -> Any:
    program = f"param map = localPath('{map}.xodr')\nmodel scenic.simulators.newtonian.driving_model\n{text}"
    scenario = scenic.scenarioFromString(program, filename=str(folder / "main.scenic"), mode2D=True)
    done = scenario.getSimulator().simulate(scenario.sample(1, seed=1)[0], maxSteps=steps)
    assert done is not None
    return done


def test_places_ahead_on_a_line() -> None:
    line = FollowedLine(Trajectory([(0, 0), (10, 0), (10, 10)]))
    assert line.signed_distance((4, 1, 0)) == pytest.approx(1)
    assert line.progress == pytest.approx(4)
    assert line.ahead(3) == pytest.approx((7, 0))
    assert line.ahead(8) == pytest.approx((10, 2))
    assert line.ahead(-2) == pytest.approx((2, 0))
    assert line.ahead(-6) == pytest.approx((-2, 0)), "before the start"
    assert line.ahead(20) == pytest.approx((10, 14)), "after the end"


@pytest.mark.parametrize(
    ("place", "oncoming", "heading"), [((30, -2.25), False, -90), ((900, -1.25), True, 90)]
)
def test_pure_pursuit_reaches_the_line(
    folder: Path, place: tuple[float, float], oncoming: bool, heading: int
) -> None:
    text = (
        f"ego = new Car at {place}, facing {heading} deg, with lateralController PurePursuitLateralController(),\n"
        f"    with behavior FollowLaneBehavior(target_speed=10, laneToFollow=network.laneAt((30, -1.75)), is_oppositeTraffic={oncoming})\n"
    )
    states = simulated(folder, text).trajectory
    assert abs(states[0][0].y + 1.75) == pytest.approx(0.5)
    assert abs(states[-1][0].y + 1.75) < 0.02
    assert abs(states[-1][0].x - states[0][0].x) > 100


@pytest.mark.parametrize("controller", ["None", "PurePursuitLateralController()"])
def test_cars_follow_curves_within_a_metre(folder: Path, controller: str) -> None:
    text = (
        f"ego = new Car at (4, -1.65), facing -86 deg, with lateralController {controller},\n"
        "    with behavior FollowLaneBehavior(target_speed=8)\n"
    )
    done = simulated(folder, text, "round", steps=200)
    lanes = Network.fromFile(folder / "round.xodr").lanes
    middle = shapely.MultiLineString([lane.line for lane in lanes])
    away = [middle.distance(shapely.Point(state[0].x, state[0].y)) for state in done.trajectory]
    assert max(away) < (1.0 if controller == "None" else 0.25)


@pytest.mark.parametrize("speed", [8, 10, 14, 20, 25])
def test_lane_changes_settle_without_swinging(folder: Path, speed: int) -> None:
    text = f"""
behavior Change():
    section = network.laneSectionAt((500, 1.75))
    do LaneChangeBehavior(section, is_oppositeTraffic=True, target_speed={speed})
    do FollowLaneBehavior({speed}, laneToFollow=section.lane, is_oppositeTraffic=True)
ego = new Car at (20, -1.75), facing -90 deg, with speed {speed}, with behavior Change
"""
    aside = [state[0].y for state in simulated(folder, text, steps=250).trajectory]
    assert max(aside) < 1.75 + 0.5
    arrival = next(index for index, y in enumerate(aside) if y > 1.65)
    assert arrival < 60
    assert min(aside[arrival:]) > 1.75 - 0.5
    assert abs(aside[-1] - 1.75) < 0.1


def test_pure_pursuit_drives_the_arc_through_the_place_ahead() -> None:
    class Agent:
        position, heading, speed = (0.0, 0.0, 0.0), 0.0, 0.0

    # On a circle of radius 20 every place ahead is on the arc with the curvature 1/20.
    points = [(20 * math.cos(t) - 20, 20 * math.sin(t)) for t in (k / 400 for k in range(-100, 600))]
    controller = PurePursuitLateralController(lookahead=5)
    assert controller.curvature(Agent(), FollowedLine(Trajectory(points))) == pytest.approx(1 / 20, rel=1e-3)
    with pytest.raises(ValueError, match="lookahead"):
        PurePursuitLateralController(lookahead=0)


def test_trajectories_have_speeds(folder: Path) -> None:
    text = (
        "way = Trajectory([(50, -1.75), (150, -1.75), (400, -1.75)], speeds=[5, 12, 12])\n"
        "ego = new Car at (50, -1.75), facing -90 deg, with speed 5, with behavior FollowTrajectoryBehavior(trajectory=way)\n"
    )
    states = simulated(folder, text, steps=200).trajectory
    speeds = {round(a[0].x): 10 * (b[0].x - a[0].x) for a, b in pairwise(states)}
    near = {x: speeds[min(speeds, key=lambda key: abs(key - x))] for x in (70, 100, 130, 200)}
    assert near == pytest.approx({70: 6.4, 100: 8.5, 130: 10.6, 200: 12}, abs=1.2)
    assert list(near.values()) == sorted(near.values())


def test_lanes_and_trajectories_are_followed_alike(folder: Path) -> None:
    courses = []
    for way in (
        "[start, m.connectingLane, m.endLane]",
        "Trajectory.through([start, m.connectingLane, m.endLane])",
    ):
        text = (
            "start = network.laneAt((-60, -1.75))\n"
            "m = [m for m in start.maneuvers if m.type is ManeuverType.LEFT_TURN][0]\n"
            f"ego = new Car at (-60, -1.75), facing -90 deg, with behavior FollowTrajectoryBehavior(6, {way})\n"
        )
        courses.append(simulated(folder, text, "cross", steps=220).trajectory)
    for one, other in zip(*courses, strict=True):
        assert one[0].distanceTo(other[0]) < 1e-6
    assert courses[0][-1][0].y > 20


@pytest.mark.parametrize("trajectory", ["[]", "None", "'ahead'", "[3]"])
def test_other_trajectories_are_refused(trajectory: str) -> None:
    with pytest.raises(TypeError, match="lanes or lines in a list that is not empty"):
        Route({"[]": [], "None": None, "'ahead'": "ahead", "[3]": [3]}[trajectory])


def test_trajectories_check_their_points() -> None:
    with pytest.raises(ValueError, match="at least two"):
        Trajectory([(0, 0)])
    with pytest.raises(ValueError, match="as many speeds"):
        Trajectory([(0, 0), (1, 0)], [1])


def test_walking_along_a_path(folder: Path) -> None:
    text = (
        "ego = new Pedestrian at (100, -4.5), facing 0 deg, with behavior WalkPath([(104, -4.5), (104, -4), (110, -4)], 1.5),\n"
        "    with regionContainedIn None\n"
    )
    states = simulated(folder, text, steps=90).trajectory
    way = shapely.LineString([(100, -4.5), (104, -4.5), (104, -4), (110, -4)])
    assert max(way.distance(shapely.Point(s[0].x, s[0].y)) for s in states) < 0.1
    assert states[-1][0].distanceTo(states[-5][0]) == 0
    assert states[-1][0].x == pytest.approx(110, abs=0.1)
    assert states[20][0].distanceTo(states[10][0]) == pytest.approx(1.5, abs=0.01)
    for before, after in pairwise(states):
        if after[0].distanceTo(before[0]) > 1e-6:
            east, north = after[0].x - before[0].x, after[0].y - before[0].y
            assert after.orientations[0].yaw == pytest.approx(math.atan2(-east, north)), (
                "they face the way they walk"
            )


@pytest.mark.parametrize(("face", "heading"), [("", 0.5), (", face=True", 1.0)])
def test_a_direction_of_walking_turns_those_who_are_asked_to_face_it(
    folder: Path, face: str, heading: float
) -> None:
    text = (
        f"behavior Go():\n    while True:\n        take SetWalkingDirectionAction(1.0{face}), SetWalkingSpeedAction(1)\n"
        "ego = new Pedestrian at (100, -4.5), facing 0.5, with behavior Go, with regionContainedIn None\n"
    )
    states = simulated(folder, text, steps=3).trajectory
    assert states[-1].orientations[0].yaw == pytest.approx(heading)
    assert states[-1][0].x - states[0][0].x == pytest.approx(-0.3 * math.sin(1.0))


def test_walking_to_a_place(folder: Path) -> None:
    text = "ego = new Pedestrian at (100, -4.5), facing 90 deg, with behavior WalkTo((100, 4.5)), with regionContainedIn None\n"
    states = simulated(folder, text, steps=80).trajectory
    assert states[-1][0].y == pytest.approx(4.5, abs=0.1)
    assert max(abs(s[0].x - 100) for s in states) < 1e-6


def test_walkers_go_around_what_stands_there(folder: Path) -> None:
    text = (
        "ego = new Pedestrian at (100, 60), facing 0 deg, with behavior Walk([(112, 60)]), with regionContainedIn None\n"
        "new Object at (105, 60), with regionContainedIn None, with requireVisible False\nnew Object at (108, 61), with regionContainedIn None, with requireVisible False\n"
    )
    done = simulated(folder, text, steps=160)
    boxes = [shapely.box(104.5, 59.5, 105.5, 60.5), shapely.box(107.5, 60.5, 108.5, 61.5)]
    steps = [shapely.Point(s[0].x, s[0].y) for s in done.trajectory]
    assert min(box.distance(step) for box in boxes for step in steps) > 0.4
    assert done.trajectory[-1][0].x == pytest.approx(112, abs=0.15)
    speeds = {round(10 * a[0].distanceTo(b[0]), 6) for a, b in pairwise(done.trajectory)}
    assert max(speeds) <= 1.8


def test_walkers_have_speeds_of_their_own(folder: Path) -> None:
    walker = "new Pedestrian at (100, {y}), with behavior Walk([(130, {y})]), with regionContainedIn None\n"
    text = "ego = " + "".join(walker.format(y=y) for y in (60, 70, 80))
    first, last = (simulated(folder, text, steps=20).trajectory[state] for state in (0, -1))
    speeds = [b.distanceTo(a) / 2 for a, b in zip(first, last, strict=True)]
    assert len({round(speed, 6) for speed in speeds}) == 3
    assert min(speeds) >= 0.8
    assert max(speeds) <= 1.8


def test_walkers_yield_to_cars(folder: Path) -> None:
    text = """
behavior Cruise():
    while True:
        take SetSpeedAction(8)
ego = new Pedestrian at (100, -6), facing 0 deg, with behavior Walk([(100, 6)], 1.4), with regionContainedIn None
car = new Car at (70, -1.75), facing -90 deg, with speed 8, with behavior Cruise
"""
    states = simulated(folder, text, steps=160).trajectory
    apart = [
        shapely.box(c.x - 2.25, c.y - 1, c.x + 2.25, c.y + 1).distance(shapely.Point(p.x, p.y))
        for p, c in states
    ]
    assert min(apart) > 0.5
    assert any(a[0].distanceTo(b[0]) == 0 for a, b in pairwise(states[3:100])), "it waits"
    assert states[-1][0].y == pytest.approx(6, abs=0.1)


def test_turning_actions(folder: Path) -> None:
    text = """
behavior Turn():
    take SetOrientationAction(90 deg)
    take SetOrientationAction(Orientation.fromEuler(-45 deg, 0, 0))
ego = new Car at (100, -1.75), facing 0 deg, with behavior Turn, with speed 3, with regionContainedIn None
record ego.heading as heading
"""
    done = simulated(folder, text.replace("Orientation.fromEuler(-45 deg, 0, 0)", "-45 deg"), steps=4)
    headings = [math.degrees(value) for _, value in done.result.records["heading"]]
    assert headings[:3] == pytest.approx([0, 90, -45])
