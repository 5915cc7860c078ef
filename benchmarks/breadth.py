"""The breadth of the language, beside another implementation: ``python -m benchmarks.breadth --reference PATH``.

PATH is called as in `benchmarks.compare`. The programs in ``breadth/`` use fields, lines, polygons, region algebra, mutation, random
containers, meshes as regions, classes and Python code. For each, the table shows milliseconds per accepted scene through ``sample`` and
through a loop of ``generate()``, ours and theirs, with the ratios; the last line holds their geometric means and the least of each.
Ours reads position, angles and sizes of every object of every scene; theirs is the time of ``generate`` alone. All run in processes
of their own, in turns. At the end stands the most memory that sampling 200 objects takes at the default size of batches.

Run by hand on a quiet machine; nothing here is a test.
"""

import argparse
import json
import math
import random
import resource
import shlex
import statistics
import subprocess
import sys
import time
from collections.abc import Callable
from pathlib import Path
from typing import Any

HERE = Path(__file__).parent
PROGRAMS = tuple(sorted(path.stem for path in (HERE / "breadth").glob("*.scenic")))
BATCH = 1000
LOOP = 3000
"""Long enough for several of the times at which a loop samples ahead."""
THEIRS = 200
CROWD = "".join(
    f"thing{i} = new Object at (Range({4 * (i % 20)}, {4 * (i % 20) + 2}), Range({4 * (i // 20)}, {4 * (i // 20) + 2})),"
    " facing Range(0, 6)\n"
    for i in range(200)
)


def child(path: str) -> None:
    """The work of our fresh process: prints milliseconds a scene as JSON."""
    import scenic

    start_time = time.perf_counter()
    scenario = scenic.scenarioFromFile(path)
    load = time.perf_counter() - start_time

    def read(scenes: Any) -> None:
        for scene in scenes:
            for item in scene.objects:
                tuple(item.position), item.yaw, item.pitch, item.roll, item.width, item.length, item.height

    def each(function: Callable[[], object], count: int) -> float:
        start_time = time.perf_counter()
        function()
        return (time.perf_counter() - start_time) / count * 1e3

    random.seed(3)
    scenario.sample(1, seed=1)
    batch = each(lambda: read(scenario.sample(BATCH, seed=3)), BATCH)
    read(scenario.generate()[0] for _ in range(LOOP // 3))
    loop = each(lambda: read(scenario.generate()[0] for _ in range(LOOP)), LOOP)
    print(json.dumps({"load": load * 1e3, "batch": batch, "loop": loop}))


def crowd() -> None:
    """Sample 200 objects and print the most memory that this process has taken, in MB."""
    import scenic

    scenic.scenarioFromString(CROWD).sample(200, seed=1)
    print(resource.getrusage(resource.RUSAGE_SELF).ru_maxrss // 1024)


def ours(path: str) -> Any:
    """The figures of a fresh process."""
    command = [sys.executable, "-m", "benchmarks.breadth", "--child", path]
    done = subprocess.run(command, cwd=HERE.parent, capture_output=True, text=True, check=True)
    return json.loads(done.stdout)


def theirs(command: str, path: str, seed: int) -> float:
    """Milliseconds a scene of the other implementation, the first one left out."""
    arguments = [
        *shlex.split(command),
        path,
        "-n",
        str(THEIRS),
        "--seed",
        str(seed),
        "--time",
        "--observe",
        "x=1",
    ]
    shown = subprocess.run(arguments, capture_output=True, text=True, check=False).stdout
    rows = [json.loads(line) for line in shown.splitlines()]
    seconds = [row["seconds"] for row in rows if "seconds" in row]
    if len(seconds) < 2:
        raise SystemExit(f"{path}: {shown.strip()}")
    return statistics.fmean(seconds[1:]) * 1e3


def main() -> None:
    """Print the table."""
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("--reference", metavar="PATH", help="command of the other implementation")
    parser.add_argument("--turns", type=int, default=2)
    parser.add_argument("--program", action="append", choices=PROGRAMS, help="only this one; repeatable")
    parser.add_argument("--child", help=argparse.SUPPRESS)
    parser.add_argument("--crowd", action="store_true", help=argparse.SUPPRESS)
    options = parser.parse_args()
    if options.child:
        child(options.child)
        return
    if options.crowd:
        crowd()
        return
    print(f"{'program':20} {'load':>8} {'reference':>11} {'sample':>10} {'generate':>10} {'ratios':>15}")
    ratios: list[tuple[float, float]] = []
    for name in options.program or PROGRAMS:
        path = str(HERE / "breadth" / f"{name}.scenic")
        mine, other = [], []
        for turn in range(options.turns):
            if options.reference:
                other.append(theirs(options.reference, path, turn))
            mine.append(ours(path))
        load, batch, loop = (statistics.median(row[key] for row in mine) for key in ("load", "batch", "loop"))
        reference = statistics.median(other) if other else math.nan
        ratios.append((reference / batch, reference / loop))
        print(
            f"{name:20} {load:6.0f}ms {reference:9.2f}ms {batch:8.4f}ms {loop:8.4f}ms "
            f"{ratios[-1][0]:7.0f}x{ratios[-1][1]:6.0f}x",
            flush=True,
        )
    if options.reference:
        means = [math.exp(statistics.fmean(map(math.log, column))) for column in zip(*ratios, strict=True)]
        least = [min(column) for column in zip(*ratios, strict=True)]
        print(f"{'geometric mean':64}{means[0]:6.0f}x{means[1]:6.0f}x")
        print(f"{'least':64}{least[0]:6.0f}x{least[1]:6.0f}x")
    command = [sys.executable, "-m", "benchmarks.breadth", "--crowd"]
    memory = subprocess.run(
        command, cwd=HERE.parent, capture_output=True, text=True, check=True
    ).stdout.strip()
    print(f"200 objects, sampled 200 times at the default size of batches: at most {memory} MB")


if __name__ == "__main__":
    main()
