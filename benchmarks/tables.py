"""Choices among thousands of constants, and regions of thousands of cells: ``python -m benchmarks.tables``.

Tells the processor time of loading each program (nothing is imported any more then), what a candidate costs with 4,096 lanes in a
round, what a scene that is read costs beyond that, and the most memory that a process takes which samples 4,096 scenes. Each
program beside the same one with a single place, or a single cell. Nothing here is a test.
"""

import argparse
import json
import statistics
import subprocess
import sys
import time
from pathlib import Path
from typing import Any

PLACES = """\
import random
rng = random.Random(3)
def place():
    return new OrientedPoint at (rng.uniform(-500, 500), rng.uniform(-500, 500)), facing rng.uniform(-3, 3)
ego = new Object at Uniform(*[place() for _ in range({count})])
"""
CELLS = """\
import random
import shapely
rng = random.Random(3)
def cell(x, y):
    return shapely.box(x, y, x + 4, y + 4), rng.uniform(-3, 3)
cells = [cell(5 * (i % 100), 5 * (i // 100)) for i in range({count})]
field = PolygonalVectorField("streets", cells)
map = PolygonalRegion(polygon=shapely.MultiPolygon([polygon for polygon, _ in cells]), orientation=field)
for _ in range({objects}):
    new Object in map, with width 0.5, with length 0.5, with allowCollisions True
"""
REGIONS = """\
import random
rng = random.Random(3)
def cell(x, y):
    heading = rng.uniform(-3, 3)
    field = VectorField("street", lambda _: heading)
    return PolygonalRegion([(x, y), (x + 4, y), (x + 4, y + 4), (x, y + 4)], orientation=field)
map = PolygonalRegion.unionAll([cell(5 * (i % 100), 5 * (i // 100)) for i in range({count})])
new Object in map, with width 0.5, with length 0.5
"""
OPTIONS = """\
x = Uniform(*[new OrientedPoint at (Range(i, i + 1), Normal(i, 2)), facing Range(0, 1) for i in range({count})])
ego = new Object at x, facing x.heading
"""
PROGRAMS = {
    "1 random place": OPTIONS.format(count=1),
    "1,000 random places": OPTIONS.format(count=1000),
    "1 place": PLACES.format(count=1),
    "3,000 places": PLACES.format(count=3000),
    "5,000 regions joined": REGIONS.format(count=5000),
    "1 cell": CELLS.format(count=1, objects=1),
    "5,000 cells": CELLS.format(count=5000, objects=1),
    "5,000 cells, 4 objects": CELLS.format(count=5000, objects=4),
}
LANES = 4096


def child(name: str) -> None:
    """Measure one program in this fresh process: prints JSON."""
    import scenic

    scenic.scenarioFromString("new Object at (Range(0, 1), 0)").sample(2, seed=1)
    clock = time.process_time
    start_time = clock()
    scenario = scenic.scenarioFromString(PROGRAMS[name])
    load = clock() - start_time

    def sampled(seed: int) -> Any:
        return scenario.sample(LANES, seed=seed, lanes=LANES)

    sampled(0)
    memory = int(
        next(row for row in Path("/proc/self/status").read_text().splitlines() if "VmHWM" in row).split()[1]
    )
    sampling, reading = [], []
    for seed in range(1, 6):
        start_time = clock()
        scenes = sampled(seed)
        sampling.append((clock() - start_time) / sum(scene.attempts for scene in scenes))
        start_time = clock()
        for scene in scenes:
            for item in scene.objects:
                tuple(item.position), item.yaw, item.pitch, item.roll, item.width, item.length, item.height
        reading.append((clock() - start_time) / LANES)
    figures = (load, statistics.median(sampling) * 1e6, statistics.median(reading) * 1e6, memory / 1024)
    print(json.dumps(figures))


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--child", help=argparse.SUPPRESS)
    parser.add_argument("--turns", type=int, default=3)
    arguments = parser.parse_args()
    if arguments.child:
        child(arguments.child)
        return
    print(f"{'program':24} {'load, s':>8} {'us a candidate':>15} {'us to read':>11} {'MiB':>6}")
    for name in PROGRAMS:
        command = [sys.executable, "-m", "benchmarks.tables", "--child", name]
        runs = [
            json.loads(subprocess.run(command, capture_output=True, text=True, check=True).stdout)
            for _ in range(arguments.turns)
        ]
        load, candidate, read, memory = map(statistics.median, zip(*runs, strict=True))
        print(f"{name:24} {load:8.2f} {candidate:15.1f} {read:11.1f} {memory:6.0f}")


if __name__ == "__main__":
    main()
