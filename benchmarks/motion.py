"""Quality of motion: cars that follow lanes on maps, ``python -m benchmarks.motion MAP ... [--speeds 5 10 20 30] [--plots FOLDER]``.

Sixteen cars a map (they pass through each other) drive for a minute from random places on centerlines. A line for each map, speed
and time step shows: states with the centre off the drivable region; states with a corner off it, and the 99th percentile of the
distance from the centerline (both where no lane within 12 m bends by less than 6.5 m), overall and on straights; the largest lateral acceleration and jerk; changes
of sign of the yaw rate (beyond 0.3 m/s² to either side) besides those of the lanes' curvature, a minute; and processor time of a step of a car. With ``--turns``,
every maneuver of every intersection is driven once at 10 and at 15 m/s. Run by hand; nothing here is a test.
"""

import argparse
import math
import sys
import time
from collections.abc import Sequence
from functools import cached_property
from pathlib import Path
from typing import Any

import numpy as np
import shapely
from numpy.typing import NDArray
from scipy.spatial import KDTree

import scenic
from scenic.domains.driving.path_smoothing import curvatures_of, headings_of, resampled
from scenic.domains.driving.planning import path_of_lines
from scenic.domains.driving.roads import Network
from scenic.domains.driving.speed_profiles import Comfort, speeds_in_bends

Floats = NDArray[np.float64]

SIZE = (4.5, 2.0)
BOUNDS = "bounds: 0, 0, 0.25, 0.05, 3.5, 8, 2, 60"
STEPS = (0.02, 0.05, 0.1)


class Lanes:
    """The centerlines of a network as points with heading and curvature."""

    def __init__(self, network: Any) -> None:
        points, headings, curvatures, tight = [], [], [], []
        for lane in network.lanes:
            line = resampled(lane.line)
            if len(line) < 3:
                continue
            steps = headings_of(line)
            width = 4
            smooth = np.convolve(
                np.pad(curvatures_of(line), width, "edge"),
                np.full(2 * width + 1, 1 / (2 * width + 1)),
                "valid",
            )
            points.append(line)
            headings.append(np.append(steps, steps[-1]))
            curvatures.append(smooth)
            tight.append(line[np.abs(smooth) > 1 / 6.5])
        self.points = np.concatenate(points)
        self.headings = np.concatenate(headings)
        self.curvatures = np.concatenate(curvatures)
        self.tree = KDTree(self.points)
        bent = np.concatenate([*tight, np.full((1, 2), 1e9)])
        self.tight = KDTree(bent)
        curved = self.points[np.abs(self.curvatures) > 1 / 400]
        self.curved = KDTree(np.concatenate([curved, np.full((1, 2), 1e9)]))

    def beside(self, places: Floats, headings: Floats) -> tuple[Floats, Floats]:
        """Distance from the nearest centerline in a car's direction, and its curvature, at places ``(n, 2)``."""
        away, near = self.tree.query(places, k=24)
        turned = np.cos(self.headings[near] - headings[:, None])
        away = np.where(turned > 0.7, away, away + 50)
        best = near[np.arange(len(near)), away.argmin(axis=1)]
        delta = places - self.points[best]
        along = self.headings[best]
        return np.abs(delta[:, 0] * np.cos(along) + delta[:, 1] * np.sin(along)), self.curvatures[best]


class Course:
    """The motion of one car: positions ``(n, 2)`` and headings ``(n,)``, ``step`` seconds apart."""

    def __init__(self, places: Floats, headings: Floats, step: float) -> None:
        self.places, self.headings, self.step = places, np.unwrap(headings), step

    @cached_property
    def velocities(self) -> Floats:
        return np.diff(self.places, axis=0) / self.step

    @cached_property
    def accelerations(self) -> tuple[Floats, Floats]:
        """Lateral and longitudinal."""
        change = np.diff(self.velocities, axis=0) / self.step
        heading = self.headings[1:-1]
        return (
            -(change[:, 0] * np.cos(heading) + change[:, 1] * np.sin(heading)),
            change[:, 1] * np.cos(heading) - change[:, 0] * np.sin(heading),
        )

    @cached_property
    def jerk(self) -> Floats:
        lateral, along = (np.diff(item) / self.step for item in self.accelerations)
        return np.hypot(lateral, along)

    def corners(self) -> Floats:
        """``(n, 4, 2)``."""
        sine, cosine = np.sin(self.headings), np.cos(self.headings)
        long, wide = SIZE[0] / 2, SIZE[1] / 2
        offsets = [(-wide, -long), (wide, -long), (wide, long), (-wide, long)]
        return np.stack(
            [
                self.places + np.column_stack([u * cosine - v * sine, u * sine + v * cosine])
                for u, v in offsets
            ],
            axis=1,
        )


def sign_changes(values: Floats, least: float) -> int:
    """Changes of sign between values beyond a threshold."""
    signs = np.sign(values[np.abs(values) > least])
    return int((np.diff(signs) != 0).sum())


def measured(courses: Sequence[Course], lanes: Lanes, region: Any) -> list[float]:
    """The figures of a line."""
    off = corners = states = 0
    distances, straights, lateral, jerks, flips = [], [], [], [], []
    for course in courses:
        states += len(course.places)
        off += int((~shapely.contains_xy(region, *course.places.T)).sum())
        outside = ~shapely.contains_xy(region, *course.corners().reshape(-1, 2).T).reshape(-1, 4).all(axis=1)
        excused = lanes.tight.query(course.places)[0] < 12
        corners += int((outside & ~excused).sum())
        away, curvature = lanes.beside(course.places, course.headings)
        distances.append(away[~excused])
        straights.append(away[lanes.curved.query(course.places)[0] > 10])
        side, _ = course.accelerations
        lateral.append(np.abs(side).max())
        jerks.append(course.jerk.max())
        rate = np.diff(course.headings) / course.step
        speed = np.hypot(*course.velocities.T)
        own = sign_changes(rate * speed, 0.3)
        flips.append(max(0, own - sign_changes(curvature[1:] * speed**2, 0.15)))
    minutes = states * courses[0].step / 60
    straight = np.concatenate(straights)
    return [
        off / states,
        corners / states,
        float(np.percentile(np.concatenate(distances), 99)),
        float(np.percentile(straight, 99)) if len(straight) else math.nan,
        float(max(lateral)),
        float(max(jerks)),
        sum(flips) / minutes,
    ]


def simulated(
    road_map: Path, speed: float, step: float, cars: int, seconds: float, seed: int
) -> tuple[list[Course], float]:
    """The courses of cars, and processor seconds a step of a car."""
    car = f"new Car on Uniform(*lanes).centerline, with regionContainedIn None, with behavior FollowLaneBehavior({speed}), with allowCollisions True\n"
    text = (
        f"param map = {str(road_map)!r}\nmodel scenic.simulators.newtonian.driving_model\n"
        "lanes = [lane for road in network.roads for lane in road.lanes]\n"
        f"ego = {car}" + (cars - 1) * car
    )
    scenario = scenic.scenarioFromString(text, mode2D=True)
    scene = scenario.sample(1, seed=seed)[0]
    begun = time.process_time()
    done = scenario.getSimulator().simulate(scene, maxSteps=round(seconds / step), timestep=step)
    spent = time.process_time() - begun
    assert done is not None
    places = np.array([[tuple(position)[:2] for position in state.positions] for state in done.trajectory])
    headings = np.array([[turn.yaw for turn in state.orientations] for state in done.trajectory])
    courses = [Course(places[:, item], headings[:, item], step) for item in range(cars)]
    return courses, spent / (len(places) - 1) / cars


def lanes_before(lane: Any, length: float) -> list[Any]:
    """A lane, after lanes before it that are together at least ``length`` metres long, as far as there are some."""
    lanes = [lane]
    while sum(item.centerline.length for item in lanes) < length and len(lanes) < 8:
        before = lanes[0]._predecessor
        if before is None or not hasattr(before, "maneuvers"):
            break
        lanes.insert(0, before)
    return lanes


def as_fast_as_possible(before: Sequence[Any], way: Any, along: float, speed: float) -> float:
    """The speed, up to the one that is wanted, from which a car at a place can brake comfortably for all bends ahead."""
    path = path_of_lines([lane.line for lane in (*before, way.connectingLane, way.endLane)])
    lengths = np.array(path.along)
    comfort = Comfort()
    limits = speeds_in_bends(lengths, np.array(path.curvatures), comfort)
    ahead = lengths >= along - 2
    # Half a second at the speed goes by before a car brakes fully.
    free = np.maximum(lengths[ahead] - along - 0.55 * speed, 0.0)
    return float(min(speed, np.sqrt(limits[ahead] ** 2 + 2 * comfort.deceleration * free).min()))


def turns(network: Any, road_map: Path, lanes: Lanes, region: Any, speed: float, step: float) -> str:
    """A line about all maneuvers of all intersections, driven once each from 40 m before the intersection."""
    ways = [
        way
        for way in network.maneuvers
        if way.connectingLane is not None and way.startLane.centerline.length > 5
    ]
    cars = []
    for way in ways:
        before = lanes_before(way.startLane, 45.0)
        line = shapely.LineString(np.concatenate([lane.line for lane in before]))
        along = max(1.0, line.length - 40)
        place, after = (line.interpolate(item).coords[0] for item in (along, along + 0.2))
        heading = math.atan2(place[0] - after[0], after[1] - place[1])
        start = as_fast_as_possible(before, way, along, speed)
        uids = [lane.uid for lane in (*before, way.connectingLane, way.endLane)]
        cars.append(
            f"w = [network.elements[u] for u in {uids}]\n{'ego = ' if not cars else ''}new Car at {place}, "
            f"facing {heading!r}, with speed {start}, with regionContainedIn None, "
            f"with allowCollisions True, with requireVisible False, "
            f"with behavior FollowTrajectoryBehavior({speed}, w, turn_speed={speed})\n"
        )
    text = f"param map = {str(road_map)!r}\nmodel scenic.simulators.newtonian.driving_model\n" + "".join(cars)
    scenario = scenic.scenarioFromString(text, mode2D=True)
    scene = scenario.sample(1, seed=1)[0]
    done = scenario.getSimulator().simulate(scene, maxSteps=round(14 / step), timestep=step)
    assert done is not None
    places = np.array([[tuple(position)[:2] for position in state.positions] for state in done.trajectory])
    headings = np.array([[turn.yaw for turn in state.orientations] for state in done.trajectory])
    centre = corner = tight = braking = 0
    worst = 0.0
    for number, way in enumerate(ways):
        track = places[:, number]
        end = shapely.LineString(way.endLane.line)
        inside = shapely.contains_xy(way.connectingLane.polygon.buffer(1.5), *track.T)
        gone = np.flatnonzero(inside)
        last = min(len(track), int(gone[-1]) + round(2 / step)) if len(gone) else len(track)
        # The behavior ends before the end of its last lane, from where on the car only rolls.
        left = end.length - shapely.line_locate_point(end, shapely.points(track))
        rolling = np.flatnonzero((left < 6) & (np.arange(len(track)) > (gone[-1] if len(gone) else 0)))
        last = min(last, int(rolling[0])) if len(rolling) else last
        course = Course(track[: max(last, 4)], headings[: max(last, 4), number], step)
        off = ~shapely.contains_xy(region, *course.corners().reshape(-1, 2).T).reshape(-1, 4).all(axis=1)
        excused = lanes.tight.query(course.places)[0] < 12
        centre += bool((~shapely.contains_xy(region, *course.places.T)).any())
        corner += bool((off & ~excused).any())
        tight += bool((off & excused).any())
        side, along = course.accelerations
        within = inside[: len(course.places)][1:-1]
        # Ways straight ahead are braked on only for bends after them.
        if way.type.name != "STRAIGHT" and within.any():
            braking += bool((along[within][round(0.5 / step) :] < -1.5).any())
        worst = max(worst, float(np.abs(side).max()))
    return (
        f"{road_map.stem:10} {speed:5g} {step:5g} {len(ways)} maneuvers: centre off {centre}, corner off {corner} "
        f"(and {tight} where a lane bends by less than 6.5 m), braking inside {braking}, lateral {worst:.2f}"
    )


def plot(courses: Sequence[Course], lanes: Lanes, file: Path) -> None:
    """Draw speed, distance from the centerline and lateral acceleration over time."""
    import matplotlib

    matplotlib.use("Agg")
    from matplotlib import pyplot

    figure, axes = pyplot.subplots(3, 1, figsize=(14, 9), sharex=True)
    for course in courses:
        moments = np.arange(len(course.places)) * course.step
        axes[0].plot(moments[1:], np.hypot(*course.velocities.T), lw=0.8)
        axes[1].plot(moments, lanes.beside(course.places, course.headings)[0], lw=0.8)
        axes[2].plot(moments[1:-1], course.accelerations[0], lw=0.8)
    for axis, label in zip(
        axes, ("speed, m/s", "distance from centerline, m", "lateral acceleration, m/s²"), strict=True
    ):
        axis.set_ylabel(label)
        axis.grid(alpha=0.3)
    figure.tight_layout()
    figure.savefig(file, dpi=70)
    pyplot.close(figure)


def main() -> None:
    """Print a table."""
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("maps", type=Path, nargs="+")
    parser.add_argument("--speeds", type=float, nargs="+", default=[5, 10, 20, 30])
    parser.add_argument("--steps", type=float, nargs="+", default=STEPS)
    parser.add_argument("--cars", type=int, default=16)
    parser.add_argument("--seconds", type=float, default=60)
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument(
        "--turns", action="store_true", help="drive every maneuver of the intersections instead"
    )
    parser.add_argument("--plots", type=Path, help="folder for plots of ten cars each")
    given = parser.parse_args()
    head = ("centre", "corner", "d99", "d99str", "a_lat", "jerk", "flips", "us")
    print(f"{'map':10} {'speed':>5} {'step':>5} " + " ".join(f"{name:>7}" for name in head))
    print(f"{'':23}{BOUNDS}")
    for road_map in given.maps:
        network = Network.fromFile(road_map)
        lanes = Lanes(network)
        region = network.drivableRegion.polygons.buffer(0.02)
        shapely.prepare(region)
        for speed in (10.0, 15.0) if given.turns else ():
            print(turns(network, road_map, lanes, region, speed, given.steps[-1]), flush=True)
        for speed in () if given.turns else given.speeds:
            for step in given.steps:
                courses, spent = simulated(road_map, speed, step, given.cars, given.seconds, given.seed)
                figures = [*measured(courses, lanes, region), spent * 1e6]
                print(
                    f"{road_map.stem:10} {speed:5g} {step:5g} "
                    + " ".join(f"{figure:7.3f}" for figure in figures)
                )
                sys.stdout.flush()
                if given.plots:
                    given.plots.mkdir(parents=True, exist_ok=True)
                    plot(courses[:10], lanes, given.plots / f"{road_map.stem}_{speed:g}_{step:g}.png")


if __name__ == "__main__":
    main()
