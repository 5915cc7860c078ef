"""Crowds: seconds of loading, milliseconds of the first scene, and of each of many, as processor time.

Run as ``python -m benchmarks.crowds [MAP] [--only WORDS]``. ``MAP`` is an OpenDRIVE file, in which cars are anywhere on the road and
pedestrians anywhere on sidewalks. Squares grow with the number of boxes in them: 448 square metres for each. Crowds of which exact
scenes take too long are made as ``--approximate`` makes them.
"""

import argparse
import math
import time
from collections.abc import Iterator
from typing import Any

import scenic
from scenic.runtime.sampling.rejection_report import Exhausted

APPROXIMATE = ("300 cars", "1000 cars")
"""Programs of which approximate scenes are made."""

BUDGET = 6.0
"""Seconds of sampling after which a program gets no more scenes."""


def programs(road_map: str | None) -> Iterator[tuple[str, str]]:
    """The programs by name."""
    if road_map is not None:
        model = f"param map = localPath({road_map!r})\nmodel scenic.domains.driving.model\n"
        for count in (10, 20, 50, 100, 200, 300, 1000):
            yield f"{count} cars", f"{model}ego = new Car\nfor i in range({count - 1}):\n    new Car\n"
        for count in (10, 50, 100, 200):
            yield f"{count} pedestrians", f"{model}for i in range({count}):\n    new Pedestrian\n"
    for count in (10, 30, 100, 300, 1000):
        side = math.sqrt(448 * count)
        text = (
            f"workspace = Workspace(RectangularRegion((0, 0), 0, {side}, {side}))\n"
            f"for i in range({count}):\n    new Object in workspace, facing Range(0, 360) deg\n"
        )
        yield f"{count} turned boxes", text
    yield "100 chairs in 20 rooms", ROOMS


ROOMS = """
for row in range(4):
    for column in range(5):
        x, y = 8 * column, 8 * row
        room = RectangularRegion((x, y), 0, 7.6, 7.6)
        new Object at (x - 3.9, y), with width 0.2, with length 8, with height 3, with allowCollisions True
        new Object at (x, y - 3.9), with width 7.6, with length 0.2, with height 3
        table = new Object at (x, y), with width 1.6, with length 0.8
        for seat in range(5):
            new Object in room, with width 0.5, with length 0.5, facing Range(0, 360) deg, with regionContainedIn room
"""


def main() -> None:
    """Print a line for each program."""
    parser = argparse.ArgumentParser(description="Measure crowds.")
    parser.add_argument("map", nargs="?", help="an OpenDRIVE file")
    parser.add_argument("--only", default="", help="measure programs with this in their names")
    arguments = parser.parse_args()
    scenic.scenarioFromString("ego = new Object at (Range(0, 1), 0)").sample(1, seed=0)
    for name, text in programs(arguments.map):
        if arguments.only not in name:
            continue
        start_time = time.process_time()
        scenario = scenic.scenarioFromString(text)
        loaded = time.process_time()
        if name in APPROXIMATE:
            scenario.sample(2, seed=0, approximate=2)
        else:
            scenario.sample(1, seed=0)
        first = time.process_time()
        scene_count = attempts = 0
        while time.process_time() - first < BUDGET and attempts < 200:
            count = min(20, max(1, attempts))
            limits: dict[str, Any] = {"approximate": 20} if name in APPROXIMATE else {"time_limit": 60}
            results = scenario.stream(count, first=attempts, seed=1, **limits)
            scene_count += sum(not isinstance(result, Exhausted) for result in results)
            attempts += count
        seconds_spent = (time.process_time() - first) / max(scene_count, 1)
        print(
            f"{name:24} {loaded - start_time:6.2f} s {1000 * (first - loaded):8.1f} ms {1000 * seconds_spent:8.2f} ms {scene_count:4} of {attempts}",
            flush=True,
        )


if __name__ == "__main__":
    main()
