"""Measures of criticality beside CommonRoad's: ``python -m benchmarks.criticality --crime PYTHON [-n 200]``.

A car follows another one along a road at random speeds and distances. Each simulation is written as a CommonRoad file, which
commonroad-crime reads in an environment of its own (``python -m venv ENV; ENV/bin/pip install commonroad-crime``; it needs other
versions of packages than the extra ``commonroad``). The table shows for headway (as a distance), time to collision and required
deceleration how many values there are, how many of these are finite, and the greatest difference.

What commonroad-crime 0.4.5 computes otherwise, by its source, and what is done about it:

- It moves the front and the rear of cars away from their middle by half a length in x *and* in y (`HW.cal_headway`), which on a road at
  the angle a changes the distance by sin(a) times half of both lengths. The column "as it is" shows what this makes on a road at
  a ten-thousandth: near to contact it is much of the gap, by whose inverse decelerations go. For the other column both ends lie along the
  headings of cars there.
- It takes speeds along the lane as speed times the cosine of the lane's angle from the x axis: the road leads along it. An angle of exactly
  zero counts as missing (`if not ego_orientation`) and gives a required acceleration of zero, hence the ten-thousandth.
- Its cars end at half of their length ahead of their middle, ours where their outline ends along the lane: they lie along the lane.
- It rounds values to hundredths: switched off.
- It asks cars that fall behind to brake, so that decelerations are compared where a car comes nearer; and takes the acceleration of the
  car ahead without its sign, so that cars keep their speeds.

Pairs count until their boxes meet.
"""

import argparse
import json
import math
import random
import subprocess
import tempfile
from pathlib import Path
from typing import Any, Final

import scenic
from scenic.domains.driving import measures
from scenic.formats.commonroad.obstacles import ObstacleCourse, State, state_of
from scenic.formats.commonroad.scenario_files import commonroad_document, document_text
from scenic.simulators.newtonian import NewtonianSimulator
from tests.maps import RoadText, line, map_text, two_way

STEPS: Final = 10
NEVER: Final = 1e6
ANGLE: Final = 1e-4
"""The angle of the road from the x axis, radians."""
FIRST: Final = 3
"""The step from which on cars keep their speeds."""
NAMES: Final = {
    "headway distance": measures.bumper_gap,
    "time to collision": measures.time_to_collision,
    "required deceleration": measures.required_deceleration,
}
PROGRAM: Final = """
param map = {map!r}
model scenic.simulators.newtonian.driving_model
behavior Go(speed):
    while True:
        take SetSpeedAction(speed)
ego = new Car at (Range(20, 60), -1.75 + Range(-0.3, 0.3)), facing -90 deg + {angle}, with behavior Go(Range(5, 30)),
    with length Range(3.5, 6)
new Car at (ego.position.x + Range(12, 90), -1.75 + Range(-0.3, 0.3)), facing -90 deg + {angle}, with behavior Go(Range(2, 30)),
    with length Range(3.5, 12)
"""
ORACLE: Final = """
import json, logging, sys
logging.disable(logging.CRITICAL)
from commonroad.common.file_reader import CommonRoadFileReader
from commonroad_crime.data_structure.configuration import CriMeConfiguration
import numpy
from commonroad_crime.measure import HW, TTC, ALongReq
import commonroad_crime.utility.general as general
import commonroad_crime.utility.solver as solver
general.int_round = lambda value, digits: value
as_it_is = HW.cal_headway
def along_headings(self, verbose=True):
    ends = []
    for car, side in ((self.ego_vehicle, 0.5), (self.other_vehicle, -0.5)):
        state = car.state_at_time(self.time_step)
        ahead = numpy.array([numpy.cos(state.orientation), numpy.sin(state.orientation)])
        ends.append(state.position + side * car.obstacle_shape.length * ahead)
    headway = solver.compute_clcs_distance(self.clcs, *ends)[0]
    return numpy.inf if headway < 0 else headway
for file in sys.argv[1:]:
    scenario, _ = CommonRoadFileReader(file).open(lanelet_assignment=True)
    config = CriMeConfiguration()
    ids = sorted(item.obstacle_id for item in scenario.obstacles)
    config.acceleration.acceleration_mode = 1
    config.update(ego_id=ids[0], sce=scenario)
    rows = []
    kinds = [Measure(config) for Measure in (HW, TTC, ALongReq)]
    for step in range(FIRST, 10):
        values = []
        for HW.cal_headway in (along_headings, as_it_is):
            values += [float(measure.compute(ids[1], step, verbose=False)) for measure in kinds]
        rows.append(values)
    print(json.dumps(rows), flush=True)
""".replace("FIRST", str(FIRST))


class Watch:
    """States and measures of a simulation."""

    def __init__(self) -> None:
        self.states: list[list[State]] = []
        self.rows: list[list[float]] = []

    def see(self, simulation: Any, poses: Any, _: Any) -> None:
        """Keep a state, and what is measured there."""
        car, other = simulation.objects
        things = simulation.objects
        self.states.append(
            [state_of(*pose, thing.velocity) for thing, pose in zip(things, poses, strict=True)]
        )
        self.rows.append([measure(car, other) for measure in NAMES.values()])


def simulations(folder: Path, count: int) -> tuple[list[Path], list[list[list[float]]]]:
    """The files of simulations, and our measures at their steps."""
    road_map = folder / "road.xodr"
    road_map.write_text(map_text([RoadText("1", 1200, line(0, 0, ANGLE, 1200), two_way(False, False))]))
    scenario = scenic.scenarioFromString(
        PROGRAM.format(map=str(road_map), angle=ANGLE), mode2D=False, params={"use2DMap": True}
    )
    random.seed(7)
    files, ours = [], []
    for number, scene in enumerate(scenario.sample(count, seed=7)):
        watch = Watch()
        NewtonianSimulator().simulate(scene, maxSteps=STEPS, on_state=watch.see)
        courses = [
            ObstacleCourse(thing, tuple(states[index] for states in watch.states))
            for index, thing in enumerate(scene.objects)
        ]
        file = folder / f"{number}.xml"
        file.write_bytes(document_text(commonroad_document(scene, courses, 0.1, ego_moves=True)))
        files.append(file)
        ours.append(watch.rows[FIRST:STEPS])
    return files, ours


def main() -> None:
    """Print the table."""
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument(
        "--crime", type=Path, required=True, help="Python of an environment with commonroad-crime"
    )
    parser.add_argument("-n", "--number", type=int, default=200)
    arguments = parser.parse_args()
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        files, ours = simulations(folder, arguments.number)
        (folder / "oracle.py").write_text(ORACLE)
        command = [str(arguments.crime), str(folder / "oracle.py"), *map(str, files)]
        answers = subprocess.run(command, check=True, capture_output=True, text=True).stdout.splitlines()
    theirs = [json.loads(line) for line in answers if line.startswith("[[")]
    print("| measure | values | finite | greatest difference | as it is |\n|---|---|---|---|---|")
    for index, label in enumerate(NAMES):
        counts, worst = [0, 0], []
        for column in (index, index + len(NAMES)):
            *counts, difference = compared(ours, theirs, index, column)
            worst.append(difference)
        print(f"| {label} | {counts[0]} | {counts[1]} | {worst[0]:.2g} | {worst[1]:.2g} |")


def compared(ours: list[Any], theirs: list[Any], index: int, column: int) -> tuple[int, int, float]:
    """The number of values of a measure, that of finite ones, and the greatest difference from a column of the other ones."""
    pairs = [
        # Required acceleration there, deceleration here.
        (own[index], abs(other[column]))
        for rows, others in zip(ours, theirs, strict=True)
        for own, other in zip(rows, others, strict=True)
        if own[0] > 0 and (index < 2 or math.isfinite(own[1]))
    ]
    # Differences of speeds are as exact there as files are: a collision in a century is none.
    finite = [(own, other) for own, other in pairs if own < NEVER or other < NEVER]
    return len(pairs), len(finite), max((abs(own - other) for own, other in finite), default=0.0)


if __name__ == "__main__":
    main()
