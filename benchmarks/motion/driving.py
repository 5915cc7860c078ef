"""Runs of cars on maps: along lanes, through all maneuvers, and from lane to lane."""

import math
import random
import time
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from pathlib import Path
from typing import Any

import numpy as np
import shapely
from numpy.typing import NDArray

import scenic
from benchmarks.motion.courses import Course, Lines
from benchmarks.motion.figures import Run
from scenic.domains.driving import paths
from scenic.domains.driving.following import Driver
from scenic.domains.driving.lane_changing import LaneChanger
from scenic.domains.driving.lane_driving import junctions_of, lanes_along
from scenic.domains.driving.narrow_lanes import line_to_drive, ways_after
from scenic.domains.driving.planning import speeds_of
from scenic.domains.driving.speed_profiles import Comfort
from scenic.runtime.program.builtins import running_simulation

__all__ = ["changing", "following", "maneuvers", "turning"]

Floats = NDArray[np.float64]

BEFORE, AFTER = 40.0, 20.0
"""Metres that are driven before and after intersections."""
EARLIER = 40.0
"""Metres before these within which a car is put on the road: where that is straight, with the steering wheel straight."""
BRAKING = 0.5
"""Deceleration (m/s²) that counts as braking within intersections."""


@contextmanager
def _drivers() -> Iterator[dict[int, list[Driver]]]:
    """The drivers that behaviors make, by the number of their cars, in order."""
    made: dict[int, list[Driver]] = {}
    original = Driver.__init__

    def recorded(self: Driver, agent: Any, *rest: Any, **named: Any) -> None:
        number = next(i for i, item in enumerate(running_simulation().objects) if item is agent)
        made.setdefault(number, []).append(self)
        original(self, agent, *rest, **named)

    Driver.__init__ = recorded  # type: ignore[method-assign] # what behaviors keep to themselves is looked at
    try:
        yield made
    finally:
        Driver.__init__ = original  # type: ignore[method-assign] # as above


def _simulated(
    road_map: Path, cars: str, step: float, seconds: float, seed: int
) -> tuple[list[Course], dict[int, list[Driver]], float]:
    """The courses of a program's cars, their drivers, and processor seconds a step of a car."""
    text = f"param map = {str(road_map)!r}\nmodel scenic.simulators.newtonian.driving_model\n{cars}"
    scenario = scenic.scenarioFromString(text, mode2D=True)
    scene = scenario.sample(1, seed=seed)[0]
    random.seed(seed)
    with _drivers() as drivers:
        start_time = time.process_time()
        done = scenario.getSimulator().simulate(scene, maxSteps=round(seconds / step), timestep=step)
        seconds_spent = time.process_time() - start_time
    assert done is not None
    places = np.array([[tuple(position)[:2] for position in state.positions] for state in done.trajectory])
    headings = np.array([[turn.yaw for turn in state.orientations] for state in done.trajectory])
    count = places.shape[1]
    courses = [Course(places[:, item], headings[:, item], step) for item in range(count)]
    return courses, drivers, seconds_spent / (len(places) - 1) / count


def _indices(course: Course, path: Any) -> list[int]:
    """The points of a planned path at the states of a course."""
    turned = (np.array(path.headings) - course.headings[0] + math.pi) % (2 * math.pi) - math.pi
    # A path may come back to where it was, in another direction, or later in the same one.
    apart = ((path.points() - course.places[0]) ** 2).sum(axis=1) + 25 * turned**2
    index = int(np.flatnonzero(apart < apart.min() + 1.0)[0])
    found = []
    for x, y in course.places.tolist():
        index, _, _ = path.locate(x, y, index)
        found.append(index)
    return found


def _asked(course: Course, path: Any) -> Floats:
    """The curvatures ``(n,)`` of a planned path at the states of a course."""
    return np.array(path.curvatures)[_indices(course, path)]


def _lanes_of(path: Any) -> list[Any]:
    lanes: list[Any] = []
    for _, lane in path.lanes:
        if not lanes or lanes[-1] is not lane:
            lanes.append(lane)
    return lanes


def following(
    road_map: Path, speed: float, step: float, cars: int, seconds: float, seed: int
) -> tuple[list[Run], float]:
    """Cars that follow lanes from random places on centerlines, and pass through each other."""
    car = (
        "lane = Uniform(*lanes)\nnew Car on lane.centerline, facing lane.orientation, with allowCollisions True, "
        f"with behavior FollowLaneBehavior({speed}, lane)\n"
    )
    text = "lanes = [lane for road in network.roads for lane in road.lanes]\n" + cars * car
    text = text.replace("new Car", "ego = new Car", 1)
    courses, drivers, seconds_spent = _simulated(road_map, text, step, seconds, seed)
    runs = []
    for number, course in enumerate(courses):
        path: Any = drivers[number][-1]._path
        backward = getattr(drivers[number][-1], "_backward", False)
        lanes = _lanes_of(path)
        lines = [line_to_drive(lane)[:: -1 if backward else 1] for lane in lanes]
        runs.append(Run(course, Lines(lines, lanes[0].centerline.length + 1), _asked(course, path)))
    return runs, seconds_spent


def maneuvers(network: Any) -> list[Any]:
    """All maneuvers through intersections."""
    return [way for way in network.maneuvers if way.connectingLane is not None]


def _lanes_before(lane: Any, length: float) -> list[Any]:
    """A lane, after lanes before it that are together at least ``length`` metres long, as far as there are some."""
    lanes = [lane]
    while sum(item.centerline.length for item in lanes) < length and len(lanes) < 8:
        before = lanes[0]._predecessor
        if before is None or not hasattr(before, "maneuvers"):
            break
        lanes.insert(0, before)
    return lanes


def _lanes_after(*lanes: Any, length: float) -> list[Any]:
    """Lanes, before lanes after them that are together at least ``length`` metres long, as far as there are some."""
    lanes = list(lanes)
    while sum(item.centerline.length for item in lanes) < length and len(lanes) < 8:
        ways = lanes[-1].maneuvers
        if not ways:
            break
        lanes += [item for item in (ways[0].connectingLane, ways[0].endLane) if item is not None]
    return lanes


def _fastest(
    lanes: Sequence[Any], along: float, speed: float, junction: tuple[float, float] = (0.0, 0.0)
) -> float:
    """The speed, up to the one that is wanted, from which a car at a place can brake comfortably, and before a junction."""
    lines = [line_to_drive(lane) for lane in lanes]
    path = paths.Path(paths.PathPieces().along(lines))
    path.lanes, _ = lanes_along(path, lanes, lines)
    junctions = junctions_of(path)
    comfort = Comfort()
    lengths = np.array(path.along)
    begin = min(max(0, int(np.searchsorted(lengths, along)) - 1), len(lengths) - 3)
    # A car begins with its steering wheel straight.
    slow = math.sqrt(1.0 / max(np.abs(path.curvatures[max(0, begin - 4) : begin + 5]).max(), 1e-6))
    within = (lengths[begin:] >= junction[0]) & (lengths[begin:] < junction[1])
    for start in np.arange(min(speed, slow), 1.0, -0.25):
        # With a tenth to spare.
        _, rates = speeds_of(
            path, begin, speed, 1.1 * float(start), comfort, limits=None, stops=None, junctions=junctions
        )
        braking = np.array(rates)
        # Half a second goes by before a car brakes fully.
        is_comfortable = braking.min() > -1.02 * comfort.deceleration and braking[0] > -0.3
        if is_comfortable and braking[within].min(initial=0.0) > -BRAKING:
            return float(start)
    return 1.0


def _straight(lines: Sequence[Floats], along: float) -> float:
    """Metres along lines to the last place before one around which they are straight; the straightest one if there is none."""
    path = paths.Path(paths.PathPieces().along(lines))
    from scipy.ndimage import maximum_filter1d

    around = maximum_filter1d(np.abs(path.curvatures), 13)
    lengths = np.array(path.along)
    places = np.flatnonzero((lengths <= along) & (lengths > max(2.9, along - EARLIER)))
    if not len(places):
        return along
    straight = places[around[places] < 1 / 200]
    return float(lengths[straight[-1] if len(straight) else places[around[places].argmin()]])


def _car(
    lanes: Sequence[Any],
    along: float,
    speed: float,
    behavior: str,
    *,
    is_ego: bool,
) -> str:
    """The program's line of a car that drives along lines from a place on."""
    lines = [line_to_drive(lane) for lane in lanes]
    line = shapely.LineString(np.concatenate(lines))
    # On the smooth path, in its direction: what a car makes up for at first is no motion along lanes.
    path = paths.Path(paths.PathPieces().along(lines))
    x, y = line.interpolate(min(along, line.length - 0.3)).coords[0]
    index, share, _ = path.locate(x, y, path.nearest(x, y, along))
    share = min(max(share, 0.0), 1.0)
    place, heading = (
        path.place((1 - share) * path.along[index] + share * path.along[index + 1], index),
        ((1 - share) * path.headings[index] + share * path.headings[index + 1]),
    )
    return (
        f"{'ego = ' if is_ego else ''}new Car at {place}, facing {heading!r}, with speed {speed}, "
        f"with regionContainedIn None, with allowCollisions True, with requireVisible False, with behavior {behavior}\n"
    )


def turning(road_map: Path, speed: float, step: float, ways: Sequence[Any]) -> tuple[list[Run], float]:
    """All maneuvers of all intersections, driven once each from 40 m before the intersection to 20 m after it."""
    cars, lanes, lengths = [], [], []
    for way in ways:
        before = _lanes_before(way.startLane, BEFORE + EARLIER)
        after = _lanes_after(way.endLane, length=AFTER + 15)
        whole = [*before, way.connectingLane, *after]
        length = sum(lane.centerline.length for lane in before)
        behavior = (
            f"FollowTrajectoryBehavior({speed}, [network.elements[u] for u in {[lane.uid for lane in whole]}], "
            f"turn_speed={speed})"
        )
        start = _straight([line_to_drive(lane) for lane in whole], max(3.0, length - BEFORE))
        inside = (length, length + way.connectingLane.centerline.length)
        cars.append(_car(whole, start, _fastest(whole, start, speed, inside), behavior, is_ego=not cars))
        lanes.append(whole)
        lengths.append(inside)
    courses, drivers, seconds_spent = _simulated(road_map, "".join(cars), step, 20.0, 1)
    runs = []
    for number, course in enumerate(courses):
        lines = Lines([line_to_drive(lane) for lane in lanes[number]], lengths[number][0])
        along = lines.lengths[lines.indices(course.places)]
        enters, leaves = lengths[number]
        # The behavior ends before the end of its last lane, from where on the car only rolls.
        last = min(leaves + AFTER, float(lines.lengths[-1]) - 7.0)
        end = max(6, int(np.searchsorted(along, last)))
        begin = min(int(np.searchsorted(along, enters - BEFORE)), end - 4)
        course, along = course.part(begin, end), along[begin:end]
        within = np.flatnonzero((along >= enters) & (along < leaves))
        braked = False
        if len(within):
            braked = bool((course.accelerations[1][within[0] : within[-1]] < -BRAKING).any())
        runs.append(Run(course, lines, _asked(course, drivers[number][-1]._path), braked))
    return runs, seconds_spent


def changing(network: Any, road_map: Path, speed: float, step: float) -> tuple[list[Run], float]:
    """Lane changes from the beginning of every lane section to the sections beside it of the same direction."""
    pairs = [
        (section, beside)
        for section in network.laneSections
        for beside in (section._laneToLeft, section._laneToRight)
        if beside is not None and beside.isForward == section.isForward and not section.lane.is_connecting
    ]
    cars = []
    for section, beside in pairs:
        behavior = f"Change(network.elements[{beside.uid!r}], {speed})"
        along = [
            shapely.LineString(lane.line).project(shapely.Point(section.line[0])) + 3.0
            for lane in (section.lane, beside.lane)
        ]
        ways = [(item.connectingLane, item.endLane) for item in ways_after(beside.lane)] or [()]
        # Nobody knows which way the car takes.
        start = min(
            _fastest(_lanes_after(beside.lane, *filter(None, way), length=120.0), along[1], speed)
            for way in ways
        )
        start = min(start, _fastest([section.lane], along[0], speed))
        cars.append(_car([section.lane], along[0], start, behavior, is_ego=not cars))
    if not cars:
        return [], math.nan
    program = (
        "behavior Change(section, speed):\n    do LaneChangeBehavior(section, target_speed=speed)\n"
        "    do FollowLaneBehavior(speed)\n"
    )
    courses, drivers, seconds_spent = _simulated(road_map, program + "".join(cars), step, 12.0, 1)
    runs = []
    for number, course in enumerate(courses):
        changer, *followers = drivers[number]
        assert isinstance(changer, LaneChanger)
        path: Any = changer._path
        if not followers or len(path.along) < 2:
            continue
        lanes = _lanes_of(path)
        lines = Lines([line_to_drive(lane) for lane in lanes], lanes[0].centerline.length + 1)
        start_time = next(
            (i for i, at in enumerate(_indices(course, path)) if path.along[at] >= changer._end), None
        )
        if start_time is None:
            continue
        course = course.part(0, start_time + round(1.0 / step))
        runs.append(Run(course, lines, _asked(course, path), since=start_time))
    return runs, seconds_spent
