"""Quality of motion on maps, beside the bounds of the driving domain: ``python -m benchmarks.motion [--map MAP ...] [--runs ...]``.

A line shows a map, a target speed (m/s), a time step (s) and, of its runs:

centre, corner  cars whose centre, or a corner, leaves the drivable region; corners where the lane's radius is at least 6 m,
                once the whole car has been on the region
tight           cars of which a corner leaves it within 6 m of a sharper bend
d99, d99str     99th percentile of the distance from the lanes' centerlines, and that on straights, m; where a lane of less than
                2.5 m opens or closes, from the line nearer to the lane beside on which a car has room
a_lat, jerk     largest lateral acceleration, m/s², and jerk, m/s³
flips           changes of sign of the yaw rate besides those of the planned path's curvature, a minute
brake           cars that brake by over 0.5 m/s² within the intersection
us              processor time of a step of a car, µs

Runs: `lanes` (16 cars follow lanes for a minute from random places, and pass through each other), `turns` (every maneuver of
every intersection from 40 m before to 20 m after it, at 10 and 15 m/s), `changes` (a lane change from every lane section that has
a neighbour, at 10 and 20 m/s). Maps: files, or names of those in the folder of the variable SCENIC_TEST_MAPS; by default all of
them, and those of the examples. Run by hand; nothing here is a test.
"""

import argparse
import os
import sys
from collections.abc import Iterator, Sequence
from pathlib import Path
from typing import Any

import shapely

from benchmarks.motion.driving import changing, following, maneuvers, turning
from benchmarks.motion.figures import BOUNDS, Figures, Run, figures_of
from scenic.domains.driving.roads import Network

STEPS = (0.02, 0.05, 0.1)
SPEEDS = {"lanes": (5.0, 10.0, 20.0, 30.0), "turns": (10.0, 15.0), "changes": (10.0, 20.0)}
EXAMPLES = Path(__file__).parents[2] / "examples" / "driving"
BATCH = 60
"""Maneuvers that are driven at a time."""


def _maps(named: Sequence[str]) -> list[Path]:
    folder = Path(os.environ.get("SCENIC_TEST_MAPS", "."))
    paths = [*sorted(folder.glob("*.xodr")), *sorted(EXAMPLES.glob("*.xodr"))]
    if not named:
        return paths
    chosen = []
    for name in named:
        path = next((item for item in paths if item.stem == name), Path(name))
        if not path.exists():
            sys.exit(f"no map {name}: give a file, or one of {', '.join(item.stem for item in paths)}")
        chosen.append(path)
    return chosen


def _runs(
    kind: str, network: Any, road_map: Path, speed: float, step: float, given: Any
) -> tuple[list[Run], float]:
    if kind == "lanes":
        return following(road_map, speed, step, given.cars, given.seconds, given.seed)
    if kind == "changes":
        return changing(network, road_map, speed, step)
    ways = maneuvers(network)
    runs: list[Run] = []
    seconds_spent = 0.0
    for begin in range(0, len(ways), BATCH):
        part, each = turning(road_map, speed, step, ways[begin : begin + BATCH])
        runs += part
        seconds_spent = max(seconds_spent, each)
    return runs, seconds_spent


def _table(given: Any) -> Iterator[tuple[str, Figures]]:
    for road_map in _maps(given.map):
        network = Network.fromFile(road_map)
        region = network.drivableRegion.polygons.buffer(0.02)
        shapely.prepare(region)
        for kind in given.runs:
            for speed in given.speeds or SPEEDS[kind]:
                for step in given.steps:
                    runs, seconds_spent = _runs(kind, network, road_map, speed, step, given)
                    if not runs:
                        continue
                    figures = figures_of(runs, region, seconds_spent)
                    yield f"{road_map.stem:10} {kind:7} {len(runs):3d} {speed:5g} {step:5g}", figures
                    if given.plots:
                        from benchmarks.motion.plots import plot

                        plot(runs[:10], given.plots / f"{road_map.stem}_{kind}_{speed:g}_{step:g}.png")


def main() -> None:
    """Print a table."""
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("--map", nargs="+", default=[], help="names or files of maps; all by default")
    parser.add_argument("--runs", nargs="+", choices=list(SPEEDS), default=list(SPEEDS))
    parser.add_argument("--speeds", type=float, nargs="+")
    parser.add_argument("--steps", type=float, nargs="+", default=STEPS)
    parser.add_argument("--cars", type=int, default=16)
    parser.add_argument("--seconds", type=float, default=60)
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--plots", type=Path, help="folder for plots of ten cars each")
    arguments = parser.parse_args()
    print(f"{'map':10} {'runs':11} {'speed':>5} {'step':>5} {Figures.head()}")
    lines = held = 0
    for name, figures in _table(arguments):
        misses = figures.misses()
        lines, held = lines + 1, held + (not misses)
        print(f"{name} {figures.row()}{'   misses ' + ', '.join(misses) if misses else ''}", flush=True)
    print(
        f"{held} of {lines} lines hold: "
        + ", ".join(f"{name} <= {bound:g}" for name, bound in BOUNDS.items())
    )


if __name__ == "__main__":
    main()
