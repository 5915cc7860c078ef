"""Scenes put together from halves beside plain rejection: ``python -m benchmarks.divided [NAME ...] [--scenes N]``.

Every component of each program is divided as far as possible (`scenic.runtime.sampling.halving`), whether or not that pays. Their
scenes and those of plain rejection must have one law: Kolmogorov and Smirnov's test of each number that scenes show, and of a
mixture of them; p below 0.001 over the number of tests counts as a difference. What rejection never finds is compared with
approximate scenes, made many together, and the lots with components of one lot each. Prints processor time a scene, too. Nothing here is a test.
"""

import argparse
import time
from collections.abc import Mapping
from types import MappingProxyType
from typing import Final

import numpy as np
from scipy import stats

import scenic
from benchmarks.dense import PROGRAMS as DENSE
from benchmarks.law_programs import programs as programs_of_laws
from benchmarks.laws import rows_of
from scenic.runtime.sampling.components import components_of, divided
from scenic.runtime.sampling.piecewise import PiecewiseEngine

DISCS: Final = """
table = RectangularRegion((0, 0), 0, 1, 1.4)
for i in range({}):
    new Object in table, with width 0.15, with length 0.15, with height 0.1, with shape CylinderShape()
"""

CHAIN: Final = """
places = [new Point in CircularRegion((i, 0), 1.2) for i in range({})]
things = [new Object at place, with width 0.2, with length 0.2 for place in places]
for one, other in zip(things, things[1:]):
    require 0.3 < (distance from one to other) < 1.5
"""

OWN: Final[Mapping[str, str]] = MappingProxyType(
    {
        "10 discs": DISCS.format(10),
        "16 discs": DISCS.format(16),
        "100 cars on 50 lots": DENSE["100 cars on 50 lots"],
        "chain of 6 regions": CHAIN.format(6),
        "chain of 40 regions": DENSE["chain of 40 regions"],
        "softly in order": """
a, b, c, d = Range(0, 1), Range(0, 1), Range(0, 1), Range(0, 1)
require[0.7] a < b
require[0.4] b < c
require a + c < 1
require b < d
param v = [a, b, c, d]
""",
        "a ring of boxes": """
things = [new Object in CircularRegion((0, 0), 3), facing Range(0, 360) deg, with width 1, with length 2 for i in range(6)]
for i in range(6):
    require (distance from things[i] to things[i - 1]) < 4
""",
        "relative to each other": """
ego = new Object in RectangularRegion((0, 0), 0, 9, 9)
one = new Object at ego offset by (Range(1, 4), Range(-3, 3))
two = new Object at one offset by (Range(-4, 4), Range(-3, 3))
require two.x > ego.x
require one.y + two.y > ego.y
""",
        "polygons": """
yard = PolygonalRegion([(0, 0), (9, 0), (4, 1), (0, 9)])
things = [new Object in yard, with regionContainedIn yard, with width Range(0.3, 0.8) for i in range(4)]
require things[0].x > things[3].x
""",
        "numbers": """
a, b, c, d = (DiscreteRange(0, 9) for i in range(4))
require a + b > 9
require c * d > 12
require (a + b + c + d) % 3 == 0
param v = [a, b, c, d]
""",
        "boxes in a small crate": """
crate = BoxRegion(dimensions=(3, 3, 2))
for i in range(3):
    new Object in crate, facing (Range(0, 360) deg, Range(0, 20) deg, 0), with height 0.6, with regionContainedIn crate
""",
    }
)  # fmt: skip

SHARED: Final = (
    "corridor_follow", "corridor_meeting", "cut_in_gap", "docking_bearing", "table_either", "varied 7, 3.5", "varied 8, 2",
    "lots 1", "drones apart", "a polygon", "one of three", "five in a circle", "mutated", "soft and hard",
)  # fmt: skip
"""Some of the programs of `benchmarks.law_programs`."""


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("names", nargs="*", help="some of the programs")
    parser.add_argument("--scenes", type=int, default=1000, help="of each program, found in either way")
    arguments = parser.parse_args()
    others = programs_of_laws()
    texts = {**OWN, **{name: others[name].text for name in SHARED}}
    tests, least = 0, {}
    for name in arguments.names or texts:
        scenario = scenic.scenarioFromString(texts[name])
        sampler = scenario._sampler
        engine = sampler.engine
        components = divided(engine, components_of(engine.plan), always=True)
        if components is None:
            print(f"{name:24} cannot be divided", flush=True)
            continue
        sampler._finder, sampler._may_divide = PiecewiseEngine(engine, components), False
        rare = name == "chain of 40 regions"
        scenes = arguments.scenes // 4 if rare else arguments.scenes
        start_time = time.process_time()
        ours = rows_of(scenario.sample(scenes, seed=1))
        seconds_a_scene = (time.process_time() - start_time) / scenes
        by_components = name == "100 cars on 50 lots"
        sampler._finder = PiecewiseEngine(engine, components_of(engine.plan)) if by_components else engine
        start_time = time.process_time()
        scenes_found = (
            scenario.sample(2048, seed=2, approximate=2048)
            if rare
            else scenario.sample(scenes, seed=2, max_attempts=10**7)
        )
        theirs = rows_of(scenes_found)
        plain = (time.process_time() - start_time) / len(scenes_found)
        mixture = np.arange(1, ours.shape[1] + 1)[:, np.newaxis] % 7 - 2.6
        columns = zip((*ours.T, *(ours @ mixture).T), (*theirs.T, *(theirs @ mixture).T), strict=True)
        values = [float(stats.ks_2samp(one, other).pvalue) for one, other in columns]
        tests += len(values)
        least[name] = min(values)
        print(
            f"{name:24} {components.leaves:3} leaves in {len(components.plans):2} components, {seconds_a_scene * 1e3:8.2f} ms a scene, "
            f"{'approximately' if rare else 'by rejection'} {plain * 1e3:8.2f} ms; {len(values)} tests, least p {least[name]:.4f}",
            flush=True,
        )
    differing = [name for name, value in least.items() if value < 1e-3 / tests]
    print(f"{len(least)} programs, {tests} tests: {len(differing)} differ {differing}")


if __name__ == "__main__":
    main()
