"""300 steps of every behavior: within half a metre of the lane's middle on straight lanes, a metre in curves, at its usual speeds."""

import math
import re
from pathlib import Path

import pytest
import shapely

import scenic
from tests.maps import RoadText, cross, lane, lanes, line, map_text, piece, straight, two_way

AHEAD = "facing -90 deg, with behavior"
OWN = f"ego = new Car at (20, -1.75), {AHEAD}"
TURN = """
turn = Uniform(*filter(lambda m: m.type is ManeuverType.{kind}, network.intersections[0].incomingLanes[0].maneuvers))
way = [turn.startLane, turn.connectingLane, turn.endLane]
behavior Through():
    {steps}
ego = new Car on turn.startLane.centerline, with speed 6, with behavior Through
require 60 < (distance from ego to intersection) < 65
"""
FOLLOWED = "do FollowTrajectoryBehavior(6, way, turn_speed={speed})"
CHANGE = f"""
behavior Change():
    do FollowLaneBehavior({{speed}}) for 3 seconds
    do LaneChangeBehavior(self.laneSection.fasterLane, target_speed={{speed}})
    do FollowLaneBehavior({{speed}})
ego = new Car at (20, -5.25), with speed {{speed}}, {AHEAD} Change
"""

CASES = {
    "follow": ("straight", f"{OWN} FollowLaneBehavior()", 0.5, 0),
    "follow from beside": ("straight", f"ego = new Car at (20, -2.2), {AHEAD} FollowLaneBehavior()", 0.5, 0),
    "follow fast": ("straight", f"{OWN} FollowLaneBehavior(25)", 0.5, 0),
    "follow the oncoming lane": (
        "straight",
        "lane = [l for l in network.lanes if not l.sections[0].isForward][0]\n" + f"ego = new Car at (20, 1.75), {AHEAD} FollowLaneBehavior(10, lane, True)",
        0.5,
        0,
    ),
    "avoid collisions": ("straight", f"{OWN} DriveAvoidingCollisions()", 0.5, 0),
    "follow a way": ("straight", f"{OWN} FollowTrajectoryBehavior(10, [network.laneAt((20, -1.75))])", 0.5, 0),
    "constant throttle": ("straight", f"{OWN} ConstantThrottleBehavior(0.2)", 0.5, 0),
    "accelerate": ("straight", f"{OWN} AccelerateForwardBehavior()", 0.5, 0),
    "change lanes": ("two", CHANGE.format(speed=10), 0.5, 90),
    "change lanes fast": ("two", CHANGE.format(speed=20), 0.5, 90),
    "walk": ("straight", "ego = new Pedestrian at (200, -4.5), with behavior WalkForwardBehavior", 0.5, 0),
    "a curve of 30 m": ("curve", f"{OWN} FollowLaneBehavior()", 1.0, 0),
    "a way to the left": (
        "cross", TURN.format(kind="LEFT_TURN", steps=FOLLOWED.format(speed="None")), 1.0, 0,
    ),
    "a way to the right": (
        "cross", TURN.format(kind="RIGHT_TURN", steps=FOLLOWED.format(speed=4)), 1.0, 0,
    ),
    "turn": (
        "cross", TURN.format(kind="LEFT_TURN", steps=f"{FOLLOWED.format(speed=6)} until self in intersection\n    do TurnBehavior(way)\n    do FollowTrajectoryBehavior(6, way)"), 1.0, 0,
    ),
    "a lane that turns": ("turns", "ego = new Car at (100, 1.75), facing 90 deg, with behavior FollowLaneBehavior()", 1.0, 0),
}  # fmt: skip


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    made = tmp_path_factory.mktemp("accuracy")
    bend = 30 * math.radians(120)
    end = 60 + 30 * math.sin(bend / 30), 30 - 30 * math.cos(bend / 30)
    bent = (
        line(0, 0, 0, 60)
        + piece(60, 0, 0, bend, f'<arc curvature="{1 / 30!r}"/>', 60.0)
        + line(*end, bend / 30, 300, 60 + bend)
    )
    crossing = cross(arm=200, half=15)
    maps = {
        "straight": straight(2000),
        "two": map_text([RoadText("1", 2000.0, line(0, 0, 0, 2000), lanes("", lane(-1) + lane(-2)))]),
        "curve": map_text([RoadText("1", 360 + bend, bent, two_way(False, False))]),
        "cross": crossing,
        # From road 1 there is no way straight ahead.
        "turns": re.sub(r'<connection id="1" .*?</connection>', "", crossing),
    }
    for name, text in maps.items():
        (made / f"{name}.xodr").write_text(text)
    return made


@pytest.mark.parametrize("name", CASES)
def test_behaviors_keep_to_the_middle(folder: Path, name: str) -> None:
    road_map, text, limit, begin = CASES[name]
    program = (
        f"param map = localPath('{road_map}.xodr')\nmodel scenic.simulators.newtonian.driving_model\n{text}\n"
    )
    scenario = scenic.scenarioFromString(program, filename=str(folder / "main.scenic"), mode2D=True)
    for seed in (1, 2):
        [scene] = scenario.sample(1, seed=seed)
        network = scene.objects[0].roadNetwork
        done = scenario.getSimulator().simulate(scene, maxSteps=300)
        assert done is not None
        elements = network.sidewalks if name == "walk" else network.lanes
        middles = shapely.MultiLineString([element.line for element in elements])
        places = [shapely.Point(state[0].x, state[0].y) for state in done.trajectory]
        assert places[0].distance(places[-1]) > 25
        assert max(middles.distance(place) for place in places[begin:]) <= limit
