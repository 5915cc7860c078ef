"""Collisions of simulations as CommonRoad's checker finds them in our files: ``python -m benchmarks.commonroad [-n 1000]``.

Five things (cars, a truck, a bicycle, round and triangular objects) drive across a crossing from random places with random speeds. Each
simulation is written as a CommonRoad file and read by commonroad-io. For each pair of things its checker must say what
`intersects` says at some step. Pairs that touch within a millimetre may differ, since rounding decides them. The table shows
simulations, pairs, pairs that collide, pairs that differ, and the greatest distance by which bodies of such a pair overlap or miss
each other. Needs the extra ``commonroad``.
"""

import argparse
import itertools
import logging
import math
import tempfile
from collections.abc import Iterator
from pathlib import Path
from typing import Any, Final

import shapely

import scenic
from scenic.formats.commonroad.obstacles import ObstacleCourse, State, state_of
from scenic.formats.commonroad.scenario_files import commonroad_document, document_text
from scenic.simulators.newtonian import NewtonianSimulator
from tests.maps import cross

STEPS: Final = 15
NEAR: Final = 1e-3
"""Metres within which pairs may differ."""
PROGRAM: Final = """
param map = {map!r}
model scenic.simulators.newtonian.driving_model
behavior Go(speed):
    while True:
        take SetSpeedAction(speed), SetSteerAction(self.wheel)
class Mover(Car):
    wheel: Range(-0.5, 0.5)
    regionContainedIn: None
    allowCollisions: True
def place():
    return (Range(-12, 12), Range(-12, 12))
ego = new Mover at place(), facing Range(0, 360) deg, with behavior Go(Range(2, 9))
new Mover at place(), facing Range(0, 360) deg, with behavior Go(Range(2, 9)), with length Range(3, 6)
new Truck at place(), facing Range(0, 360) deg, with regionContainedIn None, with allowCollisions True
new Bicycle at place(), facing Range(0, 360) deg, with regionContainedIn None, with allowCollisions True, with velocity (Range(-5, 5), Range(-5, 5))
new Object at place(), with shape CylinderShape(), with width 2, with length 2, with allowCollisions True
"""


class Watch:
    """The states of a simulation, and the pairs of objects that meet in it."""

    def __init__(self) -> None:
        self.states: list[list[State]] = []
        self.pairs: set[tuple[int, int]] = set()

    def see(self, simulation: Any, poses: Any, _: Any) -> None:
        """Keep a state."""
        things = simulation.objects
        self.states.append(
            [state_of(*pose, thing.velocity) for thing, pose in zip(things, poses, strict=True)]
        )
        for one, other in itertools.combinations(range(len(things)), 2):
            if things[one].intersects(things[other]):
                self.pairs.add((one, other))


def simulations(road_map: Path, count: int) -> Iterator[tuple[int, set[tuple[int, int]], bytes]]:
    """Simulations, the pairs of objects that meet in them, and their CommonRoad files."""
    scenario = scenic.scenarioFromString(
        PROGRAM.format(map=str(road_map)), mode2D=False, params={"use2DMap": True}
    )
    simulator = NewtonianSimulator()
    for scene in scenario.sample(count, seed=7):
        watch = Watch()
        simulator.simulate(scene, maxSteps=STEPS, on_state=watch.see)
        courses = [
            ObstacleCourse(thing, tuple(states[index] for states in watch.states))
            for index, thing in enumerate(scene.objects)
        ]
        document = commonroad_document(scene, courses, 0.1, ego_moves=True)
        yield len(courses), watch.pairs, document_text(document)


def obstacles_of(content: bytes) -> list[Any]:
    """The obstacles of a file as commonroad-io reads them, in the order of the scene."""
    from commonroad.common.file_reader import CommonRoadFileReader

    scenario, _ = CommonRoadFileReader(content).open()
    return sorted(scenario.obstacles, key=lambda item: item.obstacle_id)


def body_of(obstacle: Any) -> Any:
    """An obstacle over time for CommonRoad's checker.

    The checker's own conversion, of 2025.4, does not import beside commonroad-io 2026.1.
    """
    from commonroad_dc import pycrcc

    body = pycrcc.TimeVariantCollisionObject(0)
    for step in range(STEPS + 1):
        outline = obstacle.occupancy_at_time(step)
        if hasattr(outline, "length"):
            x, y = outline.center.x, outline.center.y
            part = pycrcc.RectOBB(outline.length / 2, outline.width / 2, outline.orientation, x, y)
        else:
            first, *others = list(outline.shapely_object.exterior.coords)[:-1]
            part = pycrcc.ShapeGroup()
            for second, third in itertools.pairwise(others):
                part.add_shape(pycrcc.Triangle(*first, *second, *third))
        body.append_obstacle(part)
    return body


def overlap(one: Any, other: Any) -> float:
    """The least distance of two obstacles in metres; negative by the greatest depth at which they overlap."""
    least = math.inf
    for step in range(STEPS + 1):
        first, second = (item.occupancy_at_time(step).shapely_object for item in (one, other))
        depth = shapely.maximum_inscribed_circle(cut).length if (cut := first & second).area else 0.0
        least = min(least, first.distance(second) - 2 * depth)
    return least


def compared(count: int) -> tuple[int, int, list[float]]:
    """Numbers of pairs and of those that collide, and the distances of pairs about which the checkers differ."""
    pairs, hits, differing = 0, 0, []
    with tempfile.TemporaryDirectory() as folder:
        road_map = Path(folder) / "crossing.xodr"
        road_map.write_text(cross())
        for things, ours, content in simulations(road_map, count):
            obstacles = obstacles_of(content)
            bodies = [body_of(item) for item in obstacles]
            for one, other in itertools.combinations(range(things), 2):
                theirs = bool(bodies[one].collide(bodies[other]))
                pairs, hits = pairs + 1, hits + theirs
                if theirs != ((one, other) in ours):
                    differing.append(overlap(obstacles[one], obstacles[other]))
    return pairs, hits, differing


def main() -> None:
    """Print the table."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("-n", "--number", type=int, default=1000)
    count = parser.parse_args().number
    logging.disable(logging.WARNING)
    pairs, hits, differing = compared(count)
    most = max(map(abs, differing), default=0.0)
    print("| simulations | pairs | collide | differ | by at most, m |\n|---|---|---|---|---|")
    print(f"| {count:,} | {pairs:,} | {hits:,} | {len(differing)} | {most:.1e} |")
    if most > NEAR:
        raise SystemExit("the checkers differ")


if __name__ == "__main__":
    main()
