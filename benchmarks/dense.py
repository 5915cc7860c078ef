"""Scenes in which hardly any candidate passes: ``python -m benchmarks.dense [NAME ...] [--lanes N]``.

For each scenario: processor seconds a scene, log10 of its probability, and effective sample size, made by `Scenario.sample(approximate=N)`; where
rejection finds scenes at all within ten seconds, its seconds a scene, too. Run by hand on a quiet machine; nothing here is a test.
"""

import argparse
import math
import time

import scenic
from scenic.runtime.sampling.rejection_report import Exhausted

PROGRAMS = {
    "30 mugs": """
table = RectangularRegion((0, 0), 0, 1, 1.4)
for i in range(30):
    new Object in table, with width 0.1, with length 0.1, with height 0.1, with shape CylinderShape()
""",
    "60 mugs": """
table = RectangularRegion((0, 0), 0, 1, 1.4)
for i in range(60):
    new Object in table, with width 0.08, with length 0.08, with height 0.1, with shape CylinderShape()
""",
    "200 boxes in a bin": """
bin = BoxRegion(dimensions=(2, 2, 1))
for i in range(200):
    new Object in bin, with width 0.1, with length 0.1, with height 0.1, with regionContainedIn bin
""",
    "100 cars on 50 lots": """
for lot in range(50):
    for car in range(2):
        new Object at (30 * lot + Range(-4, 4), Range(-4, 4)), facing Range(0, 360) deg, with width 2, with length 4.5
""",
    "chain of 40 regions": """
places = [new Point in CircularRegion((i, 0), 1.2) for i in range(40)]
things = [new Object at place, with width 0.2, with length 0.2 for place in places]
for one, other in zip(things, things[1:]):
    require 0.3 < (distance from one to other) < 1.5
""",
}

PATIENCE = 10
"""Seconds that rejection gets."""


def rejection(scenario: "scenic.Scenario") -> float | None:
    """Seconds a scene by rejection; ``None`` where it finds none in the time."""
    begun, found = time.process_time(), 0
    for result in scenario.stream(200, seed=1, time_limit=PATIENCE, max_attempts=10**9):
        if isinstance(result, Exhausted):
            break
        found += 1
    return (time.process_time() - begun) / found if found else None


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("names", nargs="*", help="some of the scenarios")
    parser.add_argument("--lanes", type=int, default=512, help="scenes made together")
    arguments = parser.parse_args()
    for name in arguments.names or PROGRAMS:
        scenario = scenic.scenarioFromString(PROGRAMS[name])
        exact = rejection(scenario)
        start_time = time.process_time()
        (scene,) = scenario.sample(1, seed=1, approximate=arguments.lanes)
        seconds_spent = (time.process_time() - start_time) / arguments.lanes
        approximation = scene.approximation
        assert approximation is not None
        by_rejection = "none found" if exact is None else f"{exact * 1e3:.2f} ms"
        print(
            f"{name:20} {seconds_spent * 1e3:9.2f} ms a scene (rejection: {by_rejection}), log10 of probability "
            f"{approximation.log_probability / math.log(10):.1f}, effective sample size {approximation.effective:.0f} of {approximation.lanes}, "
            f"{approximation.sweeps} sweeps, correlation {approximation.correlation:.2f}",
            flush=True,
        )


if __name__ == "__main__":
    main()
