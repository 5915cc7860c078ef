"""Regions that move with the sample, beside another implementation: ``python -m benchmarks.regions --reference PATH``.

PATH is called as in `benchmarks.compare`. For each program of `benchmarks.regions.programs`, the table shows milliseconds a scene of
``sample(200)`` with its first call, ours and theirs in turns, each in a process of its own, and their ratio. Theirs is the time of
``generate`` alone. The last lines hold the geometric mean of the ratios and the least one.

Run by hand on a quiet machine; nothing here is a test.
"""

import argparse
import json
import math
import os
import shlex
import statistics
import subprocess
import sys
import tempfile
import time
from pathlib import Path

from benchmarks.regions.programs import QUESTIONS, REGIONS, program

SCENES = 200


def child(path: str) -> None:
    """Run in a fresh process: print our milliseconds a scene."""
    import scenic

    scenario = scenic.scenarioFromFile(path)
    begun = time.perf_counter()
    scenario.sample(SCENES, seed=1)
    print((time.perf_counter() - begun) / SCENES * 1e3)


def ours(path: str) -> float:
    """Milliseconds a scene in a fresh process."""
    command = [sys.executable, "-m", "benchmarks.regions", "--child", path]
    done = subprocess.run(command, capture_output=True, text=True, check=True)
    return float(done.stdout)


def theirs(command: str, path: str, scenes: int, seed: int) -> float:
    """Milliseconds a scene of the other implementation; not a number where it refuses the program."""
    arguments = [*shlex.split(command), path, "-n", str(scenes), "--seed", str(seed), "--time"]
    # The other implementation may have our import name: it must not find our tree.
    environment = {name: value for name, value in os.environ.items() if name != "PYTHONPATH"}
    shown = subprocess.run(
        [*arguments, "--observe", "x=1"], capture_output=True, text=True, check=False, env=environment
    )
    rows = [json.loads(line) for line in shown.stdout.splitlines() if line.startswith("{")]
    seconds = [row["seconds"] for row in rows if "seconds" in row]
    return statistics.fmean(seconds) * 1e3 if seconds else math.nan


def main() -> None:
    """Print the table."""
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("--reference", metavar="PATH", help="command of the other implementation")
    parser.add_argument("--turns", type=int, default=1)
    parser.add_argument("--scenes", type=int, default=SCENES, help="how many the reference samples in a turn")
    parser.add_argument("--region", action="append", choices=REGIONS, help="only this one; repeatable")
    parser.add_argument("--question", action="append", choices=QUESTIONS, help="only this one; repeatable")
    parser.add_argument("--child", help=argparse.SUPPRESS)
    parser.add_argument("--laws", action="store_true", help="compare laws with plain rejection, not times")
    options = parser.parse_args()
    if options.laws:
        from benchmarks.regions import laws

        sys.exit(0 if laws.main(options.region, options.question) else 1)
    if options.child:
        child(options.child)
        return
    ratios = []
    with tempfile.TemporaryDirectory() as folder:
        path = str(Path(folder) / "program.scenic")
        for region in options.region or REGIONS:
            for question in options.question or QUESTIONS:
                Path(path).write_text(program(region, question))
                mine, other = [], []
                for turn in range(options.turns):
                    if options.reference:
                        other.append(theirs(options.reference, path, options.scenes, turn))
                    mine.append(ours(path))
                reference = statistics.median(other) if other else math.nan
                ratio = reference / statistics.median(mine)
                if not math.isnan(ratio):
                    ratios.append(ratio)
                print(
                    f"{region:26} {question:20} {statistics.median(mine):8.3f}ms {reference:9.3f}ms {ratio:7.0f}x",
                    flush=True,
                )
    if ratios:
        print(
            f"geometric mean {math.exp(statistics.fmean(map(math.log, ratios))):.0f}x, least {min(ratios):.1f}x"
        )


if __name__ == "__main__":
    main()
