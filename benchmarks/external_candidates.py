"""A loop of `generate()` of a driving program with ten external parameters, of which one candidate in about 500 passes three filters:

    python -m benchmarks.external_candidates MAP [--scenes 20] [--reference COMMAND]

MAP is a road map (Town01 was measured). COMMAND is called as in `benchmarks.compare`, and needs VerifAI in its environment. Both run in processes of
their own. Prints, of each, the processor time from the start of the process to the first scene, candidates a scene, and milliseconds of
processor time a candidate of the later scenes; and the ratio.
"""

import argparse
import json
import resource
import shlex
import subprocess
import sys
import tempfile
from collections.abc import Sequence
from pathlib import Path
from typing import Any, Final

PROGRAM: Final = """
param map = localPath({map!r})
param verifaiSamplerType = 'halton'
model scenic.domains.driving.model
param ego_speed = VerifaiRange(5, 20)
param other_speed = VerifaiRange(5, 20)
param brake = VerifaiRange(0.5, 1)
param reaction = VerifaiRange(0, 1)
rain, fog = VerifaiRange(0, 1), VerifaiRange(0, 1)
param rain = rain, fog = fog
param safety = VerifaiRange(2, 6)
param ahead = VerifaiRange(10, 60)
param behind = VerifaiRange(10, 60)
param shift = VerifaiRange(-1, 1)
behavior Drive(speed):
    do FollowLaneBehavior(target_speed=speed)
lane = Uniform(*network.lanes)
spot = new OrientedPoint on lane.centerline
ego = new Car at spot offset by globalParameters.shift @ 0, with behavior Drive(globalParameters.ego_speed)
other = new Car following roadDirection from ego for globalParameters.ahead, with behavior Drive(globalParameters.other_speed)
third = new Car following roadDirection from ego for -globalParameters.behind
require (distance from ego to intersection) < 15
require rain + fog < 0.25
require 40 <= (distance from ego to other) <= 46
"""

CHILD: Final = """
import json, sys, time
import scenic
scenario = scenic.scenarioFromFile(sys.argv[1], mode2D=True)
for _ in range(int(sys.argv[2])):
    scene, tried = scenario.generate(maxIterations=100_000)
    print(json.dumps({"iterations": tried, "processor": time.process_time()}))
"""


def run(arguments: Sequence[str]) -> tuple[list[dict[str, Any]], float]:
    """The rows that a command prints for scenes, and its processor time in seconds."""
    before = resource.getrusage(resource.RUSAGE_CHILDREN)
    done = subprocess.run(arguments, capture_output=True, text=True, check=False)
    after = resource.getrusage(resource.RUSAGE_CHILDREN)
    rows = [json.loads(line) for line in done.stdout.splitlines()]
    if not rows or any("iterations" not in row for row in rows):
        raise SystemExit(f"{shlex.join(arguments)}: {done.stdout[-500:]}{done.stderr[-500:]}")
    return rows, after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime


def show(name: str, first: float, rows: Sequence[dict[str, Any]], later: float) -> float:
    """Print a line, and return milliseconds a candidate."""
    tried = [row["iterations"] for row in rows]
    each = 1000 * later / sum(tried[1:])
    print(
        f"{name:<10} first scene {first:6.2f} s   {sum(tried) / len(tried):6.0f} candidates a scene   {each:8.3f} ms a candidate"
    )
    return each


def main() -> None:
    """Print a line for each implementation."""
    options = argparse.ArgumentParser(description=__doc__)
    options.add_argument("map", type=Path)
    options.add_argument("--scenes", type=int, default=20)
    options.add_argument("--reference")
    options.add_argument("--reference-scenes", type=int, default=4)
    arguments = options.parse_args()
    with tempfile.TemporaryDirectory() as folder:
        program = str(Path(folder) / "program.scenic")
        Path(program).write_text(PROGRAM.format(map=str(arguments.map.resolve())))
        run([sys.executable, "-c", CHILD, program, "1"])  # which keeps the map's network
        rows, whole = run([sys.executable, "-c", CHILD, program, str(arguments.scenes)])
        first = rows[0]["processor"]
        ours = show("scenic", first, rows, rows[-1]["processor"] - first)
        if arguments.reference:
            command = [*shlex.split(arguments.reference), program, "--2d", "--observe", "x=1", "-n"]
            _, first = run([*command, "1"])
            rows, whole = run([*command, str(arguments.reference_scenes)])
            theirs = show("reference", first, rows, whole - first)
            print(f"ratio {theirs / ours:.1f}")


if __name__ == "__main__":
    main()
