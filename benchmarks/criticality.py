"""Measures of criticality beside CommonRoad's: ``python -m benchmarks.criticality --crime PYTHON [-n 200]``.

A car follows another one along a road at random speeds and distances. Each simulation is written as a CommonRoad file, which
commonroad-crime reads in an environment of its own (``python -m venv ENV; ENV/bin/pip install commonroad-crime``; it needs other
versions of packages than the extra ``commonroad``). The table shows for headway (as a distance), time to collision and required
deceleration how many values there are, how many of these are finite, and the greatest difference.

Its measures take the lanelet's direction as an angle from the x axis, so that the road leads along it (but for a ten-thousandth: a zero
counts as missing there); it rounds values to hundredths, which is switched off; and it asks cars that fall behind to brake, so
that decelerations are compared where a car comes nearer. Pairs count until their boxes meet.
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
from scenic.formats.commonroad.files import commonroad_document, document_text
from scenic.formats.commonroad.obstacles import Course, State, state_of
from scenic.simulators.newtonian import NewtonianSimulator
from tests.maps import RoadText, line, map_text, two_way

STEPS: Final = 10
NEVER: Final = 1e6
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
ego = new Car at (Range(20, 60), -1.75 + Range(-0.3, 0.3)), facing -90 deg, with behavior Go(Range(5, 30)),
    with length Range(3.5, 6)
new Car at (ego.position.x + Range(12, 90), -1.75 + Range(-0.3, 0.3)), facing -90 deg, with behavior Go(Range(2, 30)),
    with length Range(3.5, 12)
"""
ORACLE: Final = """
import json, logging, sys
logging.disable(logging.CRITICAL)
from commonroad.common.file_reader import CommonRoadFileReader
from commonroad_crime.data_structure.configuration import CriMeConfiguration
from commonroad_crime.measure import HW, TTC, ALongReq
import commonroad_crime.utility.general as general
general.int_round = lambda value, digits: value
for file in sys.argv[1:]:
    scenario, _ = CommonRoadFileReader(file).open(lanelet_assignment=True)
    config = CriMeConfiguration()
    ids = sorted(item.obstacle_id for item in scenario.obstacles)
    config.acceleration.acceleration_mode = 1
    config.update(ego_id=ids[0], sce=scenario)
    rows = []
    found = [Measure(config) for Measure in (HW, TTC, ALongReq)]
    for step in range(FIRST, 10):
        values = [measure.compute(ids[1], step, verbose=False) for measure in found]
        rows.append([float(value) for value in values])
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
    road_map.write_text(map_text([RoadText("1", 1200, line(0, 0, 1e-4, 1200), two_way(False, False))]))
    scenario = scenic.scenarioFromString(
        PROGRAM.format(map=str(road_map)), mode2D=False, params={"use2DMap": True}
    )
    random.seed(7)
    files, ours = [], []
    for number, scene in enumerate(scenario.sample(count, seed=7)):
        watch = Watch()
        NewtonianSimulator().simulate(scene, maxSteps=STEPS, on_state=watch.see)
        courses = [
            Course(thing, tuple(states[index] for states in watch.states))
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
    given = parser.parse_args()
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        files, ours = simulations(folder, given.number)
        (folder / "oracle.py").write_text(ORACLE)
        command = [str(given.crime), str(folder / "oracle.py"), *map(str, files)]
        answers = subprocess.run(command, check=True, capture_output=True, text=True).stdout.splitlines()
    theirs = [json.loads(line) for line in answers if line.startswith("[[")]
    print("| measure | values | finite | greatest difference |\n|---|---|---|---|")
    for index, label in enumerate(NAMES):
        pairs = [
            # Required acceleration there, deceleration here.
            (own[index], abs(other[index]))
            for rows, others in zip(ours, theirs, strict=True)
            for own, other in zip(rows, others, strict=True)
            if own[0] > 0 and (index < 2 or math.isfinite(own[1]))
        ]
        # Differences of speeds are as exact there as files are: a collision in a century is none.
        finite = [(own, other) for own, other in pairs if own < NEVER or other < NEVER]
        worst = max((abs(own - other) for own, other in finite), default=0.0)
        print(f"| {label} | {len(pairs)} | {len(finite)} | {worst:.2g} |")


if __name__ == "__main__":
    main()
