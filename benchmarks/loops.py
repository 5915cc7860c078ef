"""``generate()`` in a loop, beside another implementation: ``python -m benchmarks.loops --reference PATH --meshes FOLDER``.

PATH is called as in `benchmarks.compare`. Ours reads position, angles and sizes of every object of every scene; the other
implementation's time is that of ``generate`` alone. Both run in processes of their own, in turns. FOLDER holds the meshes of
``loops/large_meshes.scenic`` and ``mesh_on_slab.scenic``. Run by hand on a quiet machine; nothing here is a test.
"""

import argparse
import json
import random
import shlex
import statistics
import subprocess
import sys
import time
from pathlib import Path
from typing import Any

HERE = Path(__file__).parent
PROGRAMS = ("ten_boxes", "large_meshes", "mesh_on_slab", "four_cars")
LOOP = 200
BATCH = 500
THEIRS = 200
"""Scenes of the other implementation in a turn: some cost a hundred times as much as most, and its first ones warm up."""


def child(path: str, folder: str) -> None:
    """What our fresh process does: prints milliseconds a scene as JSON."""
    import scenic

    parameters = {"folder": folder} if "mesh" in Path(path).name else {}
    scenario = scenic.scenarioFromFile(path, params=parameters)

    def read(scenes: Any) -> None:
        for scene in scenes:
            for item in scene.objects:
                tuple(item.position), item.yaw, item.pitch, item.roll, item.width, item.length, item.height

    def each(function: Any, count: int) -> float:
        begun = time.perf_counter()
        function()
        return (time.perf_counter() - begun) / count * 1e3

    random.seed(3)
    batch = each(lambda: read(scenario.sample(BATCH, seed=3)), BATCH)
    read(scenario.generate()[0] for _ in range(LOOP // 2))
    loop = each(lambda: read(scenario.generate()[0] for _ in range(LOOP)), LOOP)
    steady = each(lambda: read(scenario.sample(LOOP, seed=9)), LOOP)
    print(json.dumps({"batch": batch, "loop": loop, "steady": steady}))


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--reference", required=True, help="command of the other implementation")
    parser.add_argument("--meshes", required=True, help="folder of meshes")
    parser.add_argument("--turns", type=int, default=2)
    parser.add_argument("--child", help=argparse.SUPPRESS)
    arguments = parser.parse_args()
    if arguments.child:
        child(arguments.child, arguments.meshes)
        return
    print(f"{'program':14} {'reference':>10} {'generate':>10} {'sample':>10} {'ratios':>14}   steady")
    for name in PROGRAMS:
        path = str(HERE / "loops" / f"{name}.scenic")
        theirs, ours = [], []
        for turn in range(arguments.turns):
            extra = ["--param", f"folder={json.dumps(arguments.meshes)}"] if "mesh" in name else []
            command = [
                *shlex.split(arguments.reference),
                path,
                "-n",
                str(THEIRS),
                "--seed",
                str(turn),
                "--time",
            ]
            shown = subprocess.run([*command, *extra], capture_output=True, text=True, check=True).stdout
            seconds = [row["seconds"] for row in map(json.loads, shown.splitlines()) if "seconds" in row]
            theirs.append(statistics.fmean(seconds[1:]) * 1e3)
            mine = [sys.executable, "-m", "benchmarks.loops", "--child", path, "--reference", "-"]
            done = subprocess.run(
                [*mine, "--meshes", arguments.meshes],
                cwd=HERE.parent,
                capture_output=True,
                text=True,
                check=True,
            )
            ours.append(json.loads(done.stdout))
        reference = statistics.median(theirs)
        loop, batch, steady = (
            statistics.median(row[key] for row in ours) for key in ("loop", "batch", "steady")
        )
        print(
            f"{name:14} {reference:8.2f}ms {loop:8.3f}ms {batch:8.3f}ms "
            f"{reference / loop:6.0f}x{reference / batch:6.0f}x {loop / steady:8.2f}"
        )


if __name__ == "__main__":
    main()
