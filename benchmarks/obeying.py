"""Cars that obey the rules of the road on a map: ``python -m benchmarks.obeying MAP ... [--cars 30] [--seconds 300] [--runner]``.

All cars drive by `DriveByRulesBehavior` in three dimensions, so that a bridge is no collision. A line shows:

pairs   pairs of cars whose boxes have overlapped, at heights less than a car's apart
red     entries into an intersection by a light that is red, found again from the courses and the plan of the lights
mean    mean speed over all cars and steps, m/s, beside a third of the mean of the limits where the cars were
stand   the longest time that a car has stood, s, beside two cycles of the lights; cars at an end of the network are left out
us      processor time of a step of a car, µs

With ``--runner`` the first car ignores lights: then red lights are run, by it alone. Run by hand; nothing here is a test.
"""

import argparse
import random
import time
from collections.abc import Mapping
from pathlib import Path
from typing import Any

import numpy as np
import shapely
from numpy.typing import NDArray

import scenic
from scenic.domains.driving.signals import LightTimes, TrafficLights

Floats = NDArray[np.float64]

LENGTH, WIDTH, HEIGHT = 4.5, 2.0, 1.5
STANDING = 0.1
"""Speed (m/s) below which a car stands."""


def program(road_map: Path, cars: int, *, runner: bool, times: Mapping[str, float] | None = None) -> str:
    """The program of cars that obey, of which the first one may run red lights."""
    car = "new Car on Uniform(*lanes).centerline, with requireVisible False, with behavior DriveByRulesBehavior({})\n"
    first = car.format("ignore={'signals'}" if runner else "")
    return (
        f"param map = {str(road_map)!r}, traffic_lights = {dict(times or {})!r}\nmodel scenic.simulators.newtonian.driving_model\n"
        "lanes = [lane for road in network.roads for lane in road.lanes if lane.centerline.length > 15]\n"
        f"ego = {first}" + (cars - 1) * car.format("")
    )


def boxes(places: Floats, headings: Floats) -> Any:
    """The outlines of cars at places ``(n, 3)``."""
    along = np.stack([-np.sin(headings), np.cos(headings)], axis=-1) * (LENGTH / 2)
    side = np.stack([np.cos(headings), np.sin(headings)], axis=-1) * (WIDTH / 2)
    flat = places[:, :2]
    corners = [flat + along + side, flat + along - side, flat - along - side, flat - along + side]
    return shapely.polygons(np.stack(corners, axis=1))


def overlapping(places: Floats, headings: Floats) -> dict[tuple[int, int], int]:
    """The pairs of cars that have overlapped, with the first step, from places ``(steps, cars, 3)``."""
    pairs: dict[tuple[int, int], int] = {}
    ones, others = np.triu_indices(places.shape[1], 1)
    for step, (now, turned) in enumerate(zip(places, headings, strict=True)):
        delta = now[ones] - now[others]
        near = np.flatnonzero(
            (np.hypot(delta[:, 0], delta[:, 1]) < LENGTH + 1) & (np.abs(delta[:, 2]) < HEIGHT)
        )
        if not len(near):
            continue
        outlines = boxes(now, turned)
        met = near[shapely.intersects(outlines[ones[near]], outlines[others[near]])]
        for item in met.tolist():
            pairs.setdefault((int(ones[item]), int(others[item])), step)
    return pairs


def reds(
    network: Any, lights: TrafficLights, places: Floats, headings: Floats, step: float
) -> list[tuple[int, float]]:
    """The cars, and times, that have entered an intersection by a red light: their front has passed the end of the lane before it."""
    ends = {}
    for way in network.maneuvers:
        signals = [signal for signal in way.signals if signal.isTrafficLight]
        if signals and way.connectingLane is not None:
            ends.setdefault(way.startLane.uid, (way.startLane, []))[1].append(signals)
    lanes = [
        (lane, ways, shapely.Polygon(lane.polygon.convex_hull.buffer(0.3))) for lane, ways in ends.values()
    ]
    ahead = np.stack([-np.sin(headings), np.cos(headings)], axis=-1) * (LENGTH / 2)
    fronts = places[..., :2] + ahead
    run = []
    for lane, ways, _ in lanes:
        end, before = lane.line[-1], lane.line[-2]
        along = (end - before) / np.hypot(*(end - before))
        beyond = (fronts - end) @ along
        beside = np.abs((fronts - end) @ np.array([-along[1], along[0]]))
        height = lane.elevationAt((float(end[0]), float(end[1]))) or 0.0
        level = np.abs(places[..., 2] - float(height)) < 3
        headed = np.cos(headings - np.arctan2(-along[0], along[1])) > 0.7
        passed = (beyond[:-1] <= 0) & (beyond[1:] > 0) & (beside[1:] < 1.5) & level[1:] & headed[1:]
        for moment, car in np.argwhere(passed).tolist():
            lights.time = (moment + 1) * step
            # Of an approach with several lights some may be for other ways.
            if all(lights.get(signal) == "red" for signals in ways for signal in signals):
                run.append((car, lights.time))
    return run


def longest_stand(places: Floats, ends: Any, step: float) -> tuple[float, int]:
    """The longest time in seconds that a car has stood away from ends of the network, and its number."""
    speeds = np.hypot(*np.moveaxis(np.diff(places[..., :2], axis=0), -1, 0)) / step
    best, which = 0.0, 0
    for car in range(places.shape[1]):
        if ends is not None and shapely.distance(ends, shapely.points(places[-1, car, :2])) < 6:
            continue
        still = np.flatnonzero(np.diff(np.concatenate([[0], (speeds[:, car] < STANDING).astype(int), [0]])))
        lengths = (still[1::2] - still[::2]) * step
        if len(lengths) and lengths.max() > best:
            best, which = float(lengths.max()), car
    return best, which


def measured(road_map: Path, given: Any) -> str:
    """The line of a map."""
    times = {} if given.green is None else {"green": given.green}
    scenario = scenic.scenarioFromString(program(road_map, given.cars, runner=given.runner, times=times))
    scene = scenario.sample(1, seed=given.seed)[0]
    random.seed(given.seed)
    start_time = time.process_time()
    steps = round(given.seconds / given.step)
    done = scenario.getSimulator().simulate(scene, maxSteps=steps, timestep=given.step)
    seconds_spent = time.process_time() - start_time
    assert done is not None
    places = np.array([[tuple(position) for position in state.positions] for state in done.trajectory])
    headings = np.array([[turn.yaw for turn in state.orientations] for state in done.trajectory])
    network = scene.workspace.network
    lights = TrafficLights(network, LightTimes.of(times))
    last = [
        shapely.points(lane.line[-1])
        for lane in network.lanes
        if not lane.maneuvers and not lane.is_connecting
    ]
    pairs = overlapping(places, headings)
    run = reds(network, lights, places, headings, given.step)
    stand, stander = longest_stand(places, shapely.union_all(last) if last else None, given.step)
    speed = np.hypot(*np.moveaxis(np.diff(places[..., :2], axis=0), -1, 0)).mean() / given.step
    seen = [
        network.speedLimitAt(tuple(place[:2])) for place in places[:: round(5 / given.step)].reshape(-1, 3)
    ]
    limit = float(np.mean([item for item in seen if item is not None] or [13.9]))
    by_others = sorted({car for car, _ in run} - {0}) if given.runner else [car for car, _ in run]
    notes = [f"pair {pair} at {step * given.step:.1f} s" for pair, step in list(pairs.items())[:5]]
    notes += [f"red by {car} at {moment:.1f} s" for car, moment in run[:5]]
    return (
        f"{road_map.stem:10} {given.cars:4d} {given.seconds:6g} {len(pairs):6d} {len(run):4d}"
        f"{f' ({len(by_others)} by others)' if given.runner else ''} {speed:6.2f}/{limit / 3:4.2f} "
        f"{stand:6.1f}/{2 * lights.longest_cycle:5.1f} {seconds_spent / steps / given.cars * 1e6:6.1f}"
        + (f"   {'; '.join(notes)}" if notes else "")
        + f"   longest stand: car {stander}"
    )


def main() -> None:
    """Print a table."""
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("maps", type=Path, nargs="+")
    parser.add_argument("--cars", type=int, default=30)
    parser.add_argument("--seconds", type=float, default=300)
    parser.add_argument("--step", type=float, default=0.1)
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--green", type=float, help="seconds of green of a phase of the lights")
    parser.add_argument("--runner", action="store_true", help="the first car ignores lights")
    arguments = parser.parse_args()
    print(f"{'map':10} {'cars':>4} {'s':>6} {'pairs':>6} {'red':>4} {'mean':>11} {'stand':>12} {'us':>6}")
    for road_map in arguments.maps:
        print(measured(road_map, arguments), flush=True)


if __name__ == "__main__":
    main()
