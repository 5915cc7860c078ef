"""Loads of driving programs of the usual kinds: ``python -m benchmarks.driving_loads MAP [--only WORDS]``.

Printed are processor seconds of a load with analysis and without, and candidates and milliseconds of a scene, likewise.
"""

import argparse
import statistics
import time
from importlib import import_module
from typing import Any, Final

import scenic
from scenic.runtime.sampling.rejection_report import Exhausted

PROGRAMS: Final[dict[str, str]] = {
    "intersection, conflicting maneuvers": """
intersec = Uniform(*network.intersections)
startLane = Uniform(*intersec.incomingLanes)
ego_maneuver = Uniform(*startLane.maneuvers)
other_maneuver = Uniform(*ego_maneuver.conflictingManeuvers)
ego = new Car on ego_maneuver.startLane.centerline
other = new Car on other_maneuver.startLane.centerline
require (distance from ego to intersec) < 25
require (distance from other to intersec) < 25
""",
    "left turn at 4-way": """
fourWay = filter(lambda i: i.is4Way, network.intersections)
intersec = Uniform(*fourWay)
maneuver = Uniform(*filter(lambda m: m.type is ManeuverType.LEFT_TURN, intersec.maneuvers))
spot = new OrientedPoint in maneuver.startLane.centerline
ego = new Car at spot
oncoming = Uniform(*maneuver.conflictingManeuvers)
other = new Car on oncoming.startLane.centerline
require 5 <= (distance from ego to intersec) <= 30
require (distance from other to intersec) <= 40
""",
    "lane change beside slower car": """
laneSecsWithRightLane = []
for lane in network.lanes:
    for laneSec in lane.sections:
        if laneSec._laneToRight != None and laneSec.isForward == laneSec.laneToRight.isForward:
            laneSecsWithRightLane.append(laneSec)
section = Uniform(*laneSecsWithRightLane)
ego = new Car on section.centerline
lead = new Car following roadDirection from ego for Range(10, 25)
require (distance from lead to intersection) > 20
require (distance from ego to intersection) > 40
require lead.laneSection is section
""",
    "adjacent lane of drawn lane": """
lane = Uniform(*network.lanes)
ego = new Car on lane.centerline
require ego.laneSection.laneToLeft.isForward == ego.laneSection.isForward
side = new Car left of ego by Range(1.5, 4), with regionContainedIn ego.laneSection.laneToLeft
""",
    "pedestrian crossing behind parked car": """
ego = new Car
spot = new OrientedPoint on visible curb
parked = new Car left of spot by 0.25, facing Range(-5, 5) deg relative to roadDirection
ped = new Pedestrian ahead of parked by Range(1, 3), with regionContainedIn None
require (distance from ego to parked) > 10
require (distance to intersection) > 30
""",
    "oncoming car": """
ego = new Car
other = new Car on visible road, with roadDeviation Range(-10, 10) deg
require (relative heading of other) > 150 deg or (relative heading of other) < -150 deg
require (distance to other) < 50
""",
    "platoon in one lane": """
ego = new Car
c1 = new Car ahead of ego by Range(5, 15)
c2 = new Car ahead of c1 by Range(5, 15)
c3 = new Car ahead of c2 by Range(5, 15)
require c3.lane is ego.lane
require (distance to intersection) > 60
""",
    "bumper to bumper": """
depth = 4
laneGap = 3.5
carGap = Range(1, 3)
laneShift = Range(-2, 2)
wiggle = Range(-5 deg, 5 deg)
def carAheadOfCar(car, gap, offsetX=0, wiggle=0):
    pos = new OrientedPoint at (front of car) offset by (offsetX, gap), facing resample(wiggle) relative to roadDirection
    return new Car ahead of pos
def createPlatoonAt(car, numCars, model=None, dist=carGap, shift=(-0.5, 0.5), wiggle=0):
    cars = [car]
    lastCar = car
    for i in range(numCars-1):
        center = follow roadDirection from (front of lastCar) for resample(dist)
        pos = new OrientedPoint right of center by Range(*shift), facing resample(wiggle) relative to roadDirection
        lastCar = new Car ahead of pos
        cars.append(lastCar)
    return cars
ego = new Car with visibleDistance 60
modelDist = 5
leftCar = carAheadOfCar(ego, laneShift + carGap, offsetX=-laneGap, wiggle=wiggle)
createPlatoonAt(leftCar, depth, dist=carGap, wiggle=wiggle)
midCar = carAheadOfCar(ego, resample(carGap), wiggle=wiggle)
createPlatoonAt(midCar, depth, dist=carGap, wiggle=wiggle)
rightCar = carAheadOfCar(ego, resample(laneShift) + resample(carGap), offsetX=laneGap, wiggle=wiggle)
createPlatoonAt(rightCar, depth, dist=carGap, wiggle=wiggle)
""",
    "badly parked car": """
ego = new Car
spot = new OrientedPoint on visible curb
badAngle = Uniform(1, -1) * Range(10, 20) deg
parked = new Car left of spot by 0.5, facing badAngle relative to roadDirection
""",
    "right turn with crossing pedestrian": """
intersec = Uniform(*filter(lambda i: i.is3Way or i.is4Way, network.intersections))
m = Uniform(*filter(lambda m: m.type is ManeuverType.RIGHT_TURN, intersec.maneuvers))
ego = new Car on m.startLane.centerline
ped = new Pedestrian right of m.endLane.centerline.start by Range(2, 6), with regionContainedIn None
require (distance from ego to intersec) < 20
require (distance from ped to intersec) < 15
""",
    "lead car brakes, three lanes": """
three = filter(lambda s: s._laneToLeft is not None and s._laneToRight is not None, [sec for r in network.roads for lane in r.lanes for sec in lane.sections])
sec = Uniform(*three)
ego = new Car on sec.centerline
lead = new Car ahead of ego by Range(6, 20)
left = new Car on sec.laneToLeft.centerline
right = new Car on sec.laneToRight.centerline
require (distance from ego to left) < 20
require (distance from ego to right) < 20
require (distance from ego to intersection) > 15
""",
    "opposite lane overtaking": """
two = [s for g in network.laneGroups if g._opposite is not None for l in g.lanes for s in l.sections]
sec = Uniform(*two)
ego = new Car on sec.centerline
slow = new Car following roadDirection from ego for Range(8, 20)
onc = new Car on sec.group.opposite.lanes[0].centerline
require (distance from slow to onc) > 30
require (distance from ego to onc) < 100
require abs(relative heading of onc from ego) > 150 deg
""",
    "cars on different arms": """
i = Uniform(*network.intersections)
a = Uniform(*i.incomingLanes)
b = Uniform(*i.incomingLanes)
c = Uniform(*i.incomingLanes)
require a.road is not b.road
require b.road is not c.road
require a.road is not c.road
ego = new Car on a.centerline
x = new Car on b.centerline
y = new Car on c.centerline
require (distance from ego to i) < 30
require (distance from x to i) < 30
require (distance from y to i) < 30
""",
    "visible lead in a curve": """
ego = new Car
lead = new Car following roadDirection from ego for Range(15, 40)
require abs(relative heading of lead) > 10 deg
require (distance to intersection) > 20
require ego can see lead
""",
}

SCENES: Final = (30, 10)
"""Scenes with analysis, and without."""

MOST: Final = 20_000
"""Candidates for a scene, at most."""


def main() -> None:
    """Print a line for each program, and the median of the loads."""
    parser = argparse.ArgumentParser(description="Measure loads of driving programs.")
    parser.add_argument("map", help="an OpenDRIVE file")
    parser.add_argument("--only", default="", help="measure programs with this in their names")
    arguments = parser.parse_args()
    head = f"param map = localPath({arguments.map!r})\nmodel scenic.domains.driving.model\n"
    scenic.scenarioFromString(f"{head}ego = new Car\n").sample(1, seed=0)
    translator: Any = import_module("scenic.syntax.translator")
    loads: list[float] = []
    for name, text in PROGRAMS.items():
        if arguments.only not in name:
            continue
        figures = []
        for prune, scenes in zip((True, False), SCENES, strict=True):
            start_time = time.process_time()
            translator.usePruning = prune
            scenario = scenic.scenarioFromString(head + text)
            loaded = time.process_time()
            results = list(scenario.stream(scenes, seed=1, max_attempts=MOST))
            seconds_spent = 1000 * (time.process_time() - loaded) / scenes
            attempts = sum(result.attempts for result in results) / scenes
            scene_count = sum(not isinstance(result, Exhausted) for result in results)
            figures.append(
                f"{loaded - start_time:6.2f} s {attempts:8.1f} candidates {seconds_spent:8.2f} ms {scene_count:3} found"
            )
            if prune:
                loads.append(loaded - start_time)
        print(f"{name:40} {'   without: '.join(figures)}", flush=True)
    print(f"median of loads {statistics.median(loads):.2f} s, longest {max(loads):.2f} s")


if __name__ == "__main__":
    main()
