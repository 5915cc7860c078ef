"""The motion of cars that follow lanes, change lanes and follow each other: comfortable, and on the road."""

import math
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import shapely

import scenic
from benchmarks.motion import Course
from scenic.domains.driving.paths import PathPieces
from scenic.domains.driving.planning import MotionPlan
from scenic.domains.driving.roads import Network
from scenic.language.errors import InvalidScenarioError
from tests.maps import RoadText, cross, lane, lanes, line, map_text, piece, straight, two_way


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    made = tmp_path_factory.mktemp("motion")
    (made / "cross.xodr").write_text(cross(arm=100, half=15))
    (made / "straight.xodr").write_text(straight(400))
    return made


def simulated(folder: Path, text: str, map: str = "straight", steps: int = 150, step: float = 0.1) -> Any:
    program = f"param map = localPath('{map}.xodr')\nmodel scenic.simulators.newtonian.driving_model\n{text}"
    scenario = scenic.scenarioFromString(program, filename=str(folder / "main.scenic"), mode2D=True)
    scene = scenario.sample(1, seed=1)[0]
    done = scenario.getSimulator().simulate(scene, maxSteps=steps, timestep=step)
    assert done is not None
    return done


def course(done: Any, number: int = 0) -> Course:
    places = np.array([tuple(state.positions[number])[:2] for state in done.trajectory])
    headings = np.array([state.orientations[number].yaw for state in done.trajectory])
    return Course(places, headings, done.timestep)


def speeds(motion: Course) -> Any:
    return np.hypot(*motion.velocities.T)


@pytest.mark.parametrize("step", [0.02, 0.1])
def test_turns_are_braked_for_before_they_begin(folder: Path, step: float) -> None:
    text = """
start = network.laneAt((-60, -1.75))
m = [m for m in start.maneuvers if m.type is ManeuverType.RIGHT_TURN][0]
ego = new Car at (-110, -1.75), facing -90 deg, with speed 12,
    with behavior FollowTrajectoryBehavior(12, [m.startLane, m.connectingLane, m.endLane], turn_speed=20)
"""
    motion = course(simulated(folder, text, "cross", steps=round(16 / step), step=step))
    side, along = motion.accelerations
    assert np.abs(side).max() == pytest.approx(3.0, abs=0.1)
    assert motion.jerk.max() < 8
    inside = np.abs(motion.places[1:-1]).max(axis=1) < 14
    assert along[inside].min() > -1.0
    assert along.min() == pytest.approx(-2.5, abs=0.3)


def test_a_lane_that_closes_within_a_road_leads_nowhere(tmp_path: Path) -> None:
    closing = '<width sOffset="0" a="3.5" b="0" c="-0.0065625" d="0.000109375"/>'
    whole = lanes("", lane(-1, after=-1)).replace("</laneSection>", "").replace("</right>", "")
    first = whole + lane(-2, width=closing) + "</right></laneSection>"
    second = lanes("", lane(-1, after=-1)).replace('s="0"', 's="40"')
    road, after = RoadText("1", 150, line(0, 0, 0, 150)), RoadText("2", 100, line(150, 0, 0, 100))
    one_after_the_other(road, after)
    road.lanes, after.lanes = first + second, lanes("", lane(-1, before=-1))
    (tmp_path / "pocket.xodr").write_text(map_text([road, after]))
    network = Network.fromFile(tmp_path / "pocket.xodr")
    pocket = network.laneAt((5, -5.25))
    assert pocket.centerline.length < 45
    assert not MotionPlan(network, pocket).choices


def test_a_behavior_takes_over_the_steering_and_braking_of_the_one_before(folder: Path) -> None:
    text = """
behavior Twice():
    do FollowLaneBehavior(4) for 1.05 seconds
    do FollowLaneBehavior(4)
ego = new Car at (100, -1.75), facing -90 deg, with speed 15, with behavior Twice()
"""
    motion = course(simulated(folder, text, steps=60))
    assert motion.jerk[5:].max() < 6.5
    assert motion.accelerations[1].min() > -3.2


def test_a_behavior_takes_over_the_acceleration_of_the_one_before(folder: Path) -> None:
    text = """
behavior Twice():
    do FollowLaneBehavior(20) for 3 seconds
    do FollowLaneBehavior(4)
ego = new Car at (20, -1.75), facing -90 deg, with speed 4, with behavior Twice()
"""
    motion = course(simulated(folder, text, steps=70))
    assert motion.accelerations[1].max() > 1.8
    assert motion.accelerations[1].min() > -2.8
    assert motion.jerk.max() < 6.5


@pytest.mark.parametrize("step", [0.02, 0.1])
def test_a_behavior_goes_on_along_the_way_of_the_one_before(folder: Path, step: float) -> None:
    # All ways begin alike: nothing else tells which one the car has taken.
    text = """
start = network.laneAt((-60, -1.75))
m = [m for m in start.maneuvers if m.type is ManeuverType.LEFT_TURN][0]
behavior Two():
    do FollowTrajectoryBehavior(8, [m.startLane, m.connectingLane, m.endLane]) until self.position.x > -14
    do FollowLaneBehavior(8)
ego = new Car at (-60, -1.75), facing -90 deg, with speed 8, with behavior Two()
"""
    motion = course(simulated(folder, text, "cross", steps=round(14 / step), step=step))
    assert motion.places[-1, 1] > 15
    assert motion.jerk.max() < 8


@pytest.mark.parametrize("step", [0.02, 0.1])
def test_a_lane_change_in_a_bend_ends_with_the_steering_of_the_bend(tmp_path: Path, step: float) -> None:
    two = lanes("", lane(-1) + lane(-2))
    bend = piece(0, 0, 0, 300, '<arc curvature="-0.01"/>')
    (tmp_path / "bend.xodr").write_text(map_text([RoadText("1", 300, bend, two)]))
    text = """
section = network.lanes[0].sections[0]
behavior Change():
    do LaneChangeBehavior(section, target_speed=15)
    do FollowLaneBehavior(15)
ego = new Car on network.lanes[1].centerline.pointAlongBy(20), with speed 15, with behavior Change
"""
    motion = course(simulated(tmp_path, text, "bend", steps=round(9 / step), step=step))
    assert motion.jerk.max() < 8
    assert np.abs(motion.accelerations[0]).max() < 3.5


def test_cars_keep_within_the_road_where_lanes_open_and_close(tmp_path: Path) -> None:
    # The outer lane opens over the first forty metres, and closes over the last forty, after which the inner one goes on alone.
    records = "".join(
        f'<width sOffset="{s}" a="{a}" b="0" c="{c!r}" d="{d!r}"/>'
        for s, a, c, d in (
            (0, 0, 3 * 3.5 / 1600, -2 * 3.5 / 64000),
            (40, 3.5, 0.0, 0.0),
            (110, 3.5, -3 * 3.5 / 1600, 2 * 3.5 / 64000),
        )
    )
    road = RoadText("1", 150, line(0, 0, 0, 150))
    after = RoadText("2", 100, line(150, 0, 0, 100))
    text = one_after_the_other(road, after)
    inner, outer = lane(-1, after=-1), lane(-2, width=records)
    road.lanes, after.lanes = lanes("", inner + outer), lanes("", lane(-1, before=-1))
    text = map_text([road, after])
    (tmp_path / "taper.xodr").write_text(text)
    program = """
ego = new Car at (6, -1.78), facing -90 deg, with speed 10, with regionContainedIn None,
    with behavior FollowLaneBehavior(15, network.roads[0].lanes[0])
"""
    done = simulated(tmp_path, program, "taper", steps=170)
    motion = course(done)
    region = Network.fromFile(tmp_path / "taper.xodr").drivableRegion.polygons.buffer(0.02)
    corners = motion.corners().reshape(-1, 2)
    assert shapely.contains_xy(region, *corners.T).all()
    middle = motion.places[np.abs(motion.places[:, 0] - 75) < 20]
    assert np.abs(middle[:, 1] + 5.25).max() < 0.05, "it is in the outer lane in between"
    assert motion.places[-1, 0] > 200, "it goes on in the other lane"
    assert abs(motion.places[-1, 1] + 1.75) < 0.05
    assert motion.jerk.max() < 8


def one_after_the_other(*pieces: RoadText) -> str:
    """A map of roads of two lanes, each of which ends where the next one begins."""
    for number, road in enumerate(pieces):
        first, last = number == 0, number == len(pieces) - 1
        road.lanes = two_way(not first, not last, sidewalk=False)
        if not first:
            road.link += (
                f'<predecessor elementType="road" elementId="{pieces[number - 1].id}" contactPoint="end"/>'
            )
        if not last:
            road.link += (
                f'<successor elementType="road" elementId="{pieces[number + 1].id}" contactPoint="start"/>'
            )
    return map_text(pieces)


def test_paths_do_not_bend_sharply_where_long_lanes_meet(tmp_path: Path) -> None:
    bend = piece(80, 0, 0, 60, '<arc curvature="0.025"/>')
    (tmp_path / "two.xodr").write_text(
        one_after_the_other(RoadText("1", 80, line(0, 0, 0, 80)), RoadText("2", 60, bend))
    )
    network = Network.fromFile(tmp_path / "two.xodr")
    plan = MotionPlan(network, network.laneAt((20, -1.75)))
    plan.choose(plan.choices[0])
    assert plan.path.length > 100
    steps = np.diff(plan.path.along)
    assert steps.min() > 0.45
    assert np.abs(plan.path.curvatures).max() < 0.027
    assert np.abs(np.diff(plan.path.curvatures)).max() < 0.01


def test_a_car_in_the_second_half_of_a_lane_that_comes_back_stays_on_it(tmp_path: Path) -> None:
    # A hairpin: the first half of the lane, which the path has at first, passes nearer to the car than where it ends.
    arc = 25 * math.pi / 2
    turn = piece(60, 0, 0, arc, f'<arc curvature="{1 / 12.5!r}"/>', s=60)
    shape = line(0, 0, 0, 60) + turn + line(60, 25, math.pi, 60, s=60 + arc)
    (tmp_path / "bend.xodr").write_text(
        one_after_the_other(RoadText("1", 120 + arc, shape), RoadText("2", 60, line(0, 25, math.pi, 60)))
    )
    text = "ego = new Car at (40, 26.75), facing 90 deg, with speed 5, with behavior FollowLaneBehavior(5)\n"
    motion = course(simulated(tmp_path, text, "bend", steps=60))
    assert np.abs(motion.places[:, 1] - 26.75).max() < 0.1


@pytest.mark.parametrize("step", [0.02, 0.1])
def test_a_car_stops_at_the_end_of_the_network_and_its_behavior_ends(folder: Path, step: float) -> None:
    text = (
        "ego = new Car at (300, -1.75), facing -90 deg, with speed 10, with behavior FollowLaneBehavior(15)\n"
    )
    done = simulated(folder, text, steps=round(20 / step), step=step)
    motion = course(done)
    assert motion.places[-1, 0] + 2.25 == pytest.approx(399, abs=0.5)
    assert speeds(motion)[-1] == 0
    assert motion.jerk.max() < 8
    assert done.result.actions[-1].get(done.objects[0], ()) == ()


def test_a_lane_change_takes_its_time_and_ends_on_the_centerline(folder: Path) -> None:
    text = """
section = network.laneSectionAt((300, 1.75))
behavior Change():
    do LaneChangeBehavior(section, is_oppositeTraffic=True, target_speed=15, duration=5)
    terminate
ego = new Car at (50, -1.75), facing -90 deg, with speed 15, with behavior Change
"""
    done = simulated(folder, text)
    motion = course(done)
    assert 5.0 <= done.currentTime * 0.1 <= 5.5
    assert motion.places[-1, 1] == pytest.approx(1.75, abs=0.05)
    assert abs(motion.headings[-1] - motion.headings[0]) < 0.01
    # The peak of the acceleration of least jerk over d metres is 5.77 d / T^2.
    assert np.abs(motion.accelerations[0]).max() == pytest.approx(5.77 * 3.5 / 25, rel=0.1)


def test_nobody_brakes_for_a_lane_change_in_the_time_that_is_asked(folder: Path) -> None:
    text = """
section = network.laneSectionAt((300, 1.75))
behavior Change():
    do LaneChangeBehavior(section, is_oppositeTraffic=True, target_speed=15, duration=3.2)
    terminate
ego = new Car at (50, -1.75), facing -90 deg, with speed 15, with behavior Change
"""
    done = simulated(folder, text)
    assert 3.2 <= done.currentTime * 0.1 <= 3.6
    assert speeds(course(done)).min() > 14.8


@pytest.fixture(scope="module")
def two_lanes(folder: Path) -> str:
    """A road of two lanes in one direction, the outer one along y = -5.25."""
    road = RoadText("1", 500, line(0, 0, 0, 500), lanes("", lane(-1) + lane(-2)))
    (folder / "two_lanes.xodr").write_text(map_text([road]))
    return "two_lanes"


def test_lane_changes_that_follow_each_other_are_no_reason_to_brake(folder: Path, two_lanes: str) -> None:
    text = """
inner, outer = network.laneAt((20, -1.75)), network.laneAt((20, -5.25))
behavior Twice():
    do LaneChangeBehavior(inner, target_speed=25, duration=3) for 1.5 seconds
    do LaneChangeBehavior(outer, target_speed=25, duration=3)
    do FollowLaneBehavior(25)
ego = new Car at (50, -5.25), facing -90 deg, with speed 25, with behavior Twice
"""
    motion = course(simulated(folder, text, two_lanes, steps=80))
    assert motion.accelerations[1].min() > -0.5
    assert np.abs(motion.accelerations[0]).max() < 3.5
    assert abs(motion.places[-1, 1] + 5.25) < 0.05


def test_a_car_goes_on_as_soon_as_the_one_that_cut_in_is_far_enough(folder: Path, two_lanes: str) -> None:
    text = """
behavior CutIn():
    do LaneChangeBehavior(network.laneAt((20, -5.25)), target_speed=25)
    do FollowLaneBehavior(25)
ego = new Car at (50, -5.25), facing -90 deg, with speed 22, with behavior FollowLaneBehavior(22, follow_gap=1.5)
new Car at (50, -1.75), facing -90 deg, with speed 25, with behavior CutIn
"""
    motion = speeds(course(simulated(folder, text, two_lanes, steps=120)))
    assert motion.min() < 20, "it brakes while the other car is beside it"
    assert motion.min() > 8
    assert motion[-1] > 15


def test_a_truck_takes_a_turn_along_a_curve_that_it_can_drive(folder: Path) -> None:
    (folder / "narrow.xodr").write_text(cross(arm=100, half=7))
    text = """
start = network.laneAt((-60, -1.75))
m = [m for m in start.maneuvers if m.type is ManeuverType.RIGHT_TURN][0]
ego = new Truck at (-60, -1.75), facing -90 deg, with speed 8, with regionContainedIn None,
    with behavior FollowTrajectoryBehavior(8, [m.startLane, m.connectingLane, m.endLane])
"""
    motion = course(simulated(folder, text, "narrow", steps=170))
    assert motion.places[-1, 1] < -30
    assert motion.jerk.max() < 8
    after = motion.places[motion.places[:, 1] < -22]
    assert np.abs(after[:, 0] + 1.75).max() < 0.1


@pytest.mark.parametrize("behavior", ["FollowLaneBehavior(-5)", "DriveByRulesBehavior(-5)"])
def test_a_negative_speed_is_none(folder: Path, behavior: str) -> None:
    done = simulated(
        folder,
        f"ego = new Car at (50, -1.75), facing -90 deg, with speed 3, with behavior {behavior}\n",
        steps=60,
    )
    assert speeds(course(done))[-1] == pytest.approx(0, abs=0.01)
    assert done.notes[0] == (0, 0, "is to reach -5 m/s, which is taken as 0: behaviors drive forward")


def test_a_change_to_a_lane_of_the_other_direction_is_an_error(folder: Path) -> None:
    text = """
section = network.laneSectionAt((300, 1.75))
behavior Change():
    do LaneChangeBehavior(section) for 3 seconds
ego = new Car at (50, -1.75), facing -90 deg, with behavior {}
"""
    for behavior, number in (("LaneChangeBehavior(section)", 4), ("Change()", 3)):
        with pytest.raises(InvalidScenarioError, match="other direction") as caught:
            simulated(folder, text.format(behavior))
        span = caught.value.span
        assert span is not None
        assert span.line == number + 3
        assert text.format(behavior).split("\n")[number][span.column : span.end_column] == "section"


@pytest.mark.parametrize(
    "behavior", ["FollowVehicleBehavior(ego, 1.5, 15)", "FollowLaneBehavior(15, follow_gap=1.5)"]
)
def test_a_car_keeps_its_gap_to_a_slower_one(folder: Path, behavior: str) -> None:
    text = f"""
ego = new Car at (100, -1.75), facing -90 deg, with speed 6, with behavior FollowLaneBehavior(6)
new Car at (50, -1.75), facing -90 deg, with speed 15, with behavior {behavior}
new Car at (120, 1.75), facing 90 deg, with behavior FollowLaneBehavior(8)
"""
    done = simulated(folder, text, steps=350)
    lead, follower = course(done, 0), course(done, 1)
    gaps = lead.places[:, 0] - follower.places[:, 0] - 4.5
    assert gaps.min() > 4
    # At equal speed the model keeps s0 + v T.
    assert gaps[-1] == pytest.approx(2 + 6 * 1.5, rel=0.1)


def test_cars_beside_behind_and_oncoming_do_not_stop_anybody(folder: Path) -> None:
    text = """
ego = new Car at (100, -1.75), facing -90 deg, with behavior DriveAvoidingCollisions(10)
new Car at (101, 1.75), facing 90 deg
new Car at (130, 1.75), facing 90 deg, with behavior FollowLaneBehavior(8)
new Car at (92, -1.75), facing -90 deg
"""
    assert speeds(course(simulated(folder, text, steps=80)))[-1] == pytest.approx(10, abs=0.1)


def test_a_resumed_behavior_goes_on_from_where_the_car_is(folder: Path) -> None:
    text = """
section = network.laneSectionAt((300, 1.75))
behavior Swerve():
    try:
        do FollowLaneBehavior(12)
    interrupt when 100 < self.position.x < 101:
        do LaneChangeBehavior(section, is_oppositeTraffic=True, target_speed=12) for 2 seconds
ego = new Car at (60, -1.75), facing -90 deg, with speed 12, with behavior Swerve
"""
    motion = course(simulated(folder, text, steps=150))
    assert np.abs(motion.accelerations[0]).max() < 3.5
    assert motion.places[:, 1].max() > -1
    assert abs(abs(motion.places[-1, 1]) - 1.75) < 0.05


@pytest.mark.parametrize(("width", "moves"), [("3.5", 5), ("9", 1)])
def test_u_turns_use_the_width_of_the_road(folder: Path, width: str, moves: int) -> None:
    (folder / "wide.xodr").write_text(straight(200).replace('a="3.5"', f'a="{width}"'))
    half = float(width) / 2
    text = f"""
behavior Turn():
    do UTurnBehavior()
    terminate
ego = new Car at (100, {-half}), facing -90 deg, with speed 3, with behavior Turn
"""
    done = simulated(folder, text, "wide", steps=400)
    motion = course(done)
    assert np.abs(motion.corners()[:, :, 1]).max() < float(width) + 0.05, "it stays on the road"
    assert motion.headings[-1] - motion.headings[0] == pytest.approx(np.pi, abs=0.02)
    assert motion.places[-1, 1] == pytest.approx(half, abs=0.1)
    along = np.einsum(
        "ij,ij->i",
        motion.velocities,
        np.column_stack([-np.sin(motion.headings), np.cos(motion.headings)])[1:],
    )
    assert motion.jerk.max() < 8
    signs = np.sign(along[np.abs(along) > 0.05])
    assert 1 + int((np.diff(signs) != 0).sum()) == moves


def test_a_fast_car_slows_down_before_it_turns_round(folder: Path) -> None:
    text = """
behavior Turn():
    do UTurnBehavior()
    terminate
ego = new Car at (50, -1.75), facing -90 deg, with speed 12, with behavior Turn
"""
    motion = course(simulated(folder, text, steps=300))
    assert np.abs(motion.corners()[:, :, 1]).max() < 3.55, "it stays on the road"
    assert np.abs(motion.accelerations[0]).max() < 3.5
    assert motion.headings[-1] - motion.headings[0] == pytest.approx(np.pi, abs=0.05)


def test_u_turns_need_lanes_of_the_other_direction(folder: Path) -> None:
    content = straight(200)
    begin, end = content.index("<left>"), content.index("</left>") + len("</left>")
    (folder / "one_way.xodr").write_text(content[:begin] + content[end:])
    with pytest.raises(InvalidScenarioError, match="no lanes of the other direction"):
        simulated(
            folder,
            "ego = new Car at (100, -1.75), facing -90 deg, with behavior UTurnBehavior()\n",
            "one_way",
        )


@pytest.mark.parametrize("kind", ["Bicycle", "Motorcycle", "Truck", "Bus"])
def test_other_vehicles_are_driven_by_the_same_behaviors(folder: Path, kind: str) -> None:
    text = f"ego = new {kind} at (100, -1.75), facing -90 deg, with behavior FollowLaneBehavior(8)\nrecord ego.height as height\n"
    done = simulated(folder, text)
    assert speeds(course(done))[-1] == pytest.approx(8, abs=0.1)
    assert 1.5 < done.result.records["height"][0][1] < 3.5


def test_what_has_no_steering_wheel_cannot_be_driven(folder: Path) -> None:
    text = "ego = new Pedestrian at (100, -1.75), with regionContainedIn None, with behavior FollowLaneBehavior\n"
    with pytest.raises(InvalidScenarioError, match="cannot be driven"):
        simulated(folder, text)


def test_pieces_along_routes_are_shared_and_the_last_ones_kept() -> None:
    pieces = PathPieces()
    lines = [np.array([[0.0, 0.0], [30.0, 0.0]]), np.array([[30.0, 0.0], [60.0, 5.0]])]
    first = pieces.along(lines)
    assert pieces.along([line.copy() for line in lines]) is first
    other = pieces.along([lines[0], lines[1] + [0.0, 0.5]])
    assert not np.array_equal(other.points, first.points)
    for number in range(256):
        pieces.along([np.array([[0.0, 0.0], [3.0, number / 99]])])
    again = pieces.along(lines)
    assert again is not first
    assert np.array_equal(again.points, first.points)
    assert np.array_equal(again.curvatures, first.curvatures)
