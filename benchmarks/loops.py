"""``generate()`` in a loop, beside another implementation: ``python -m benchmarks.loops --reference PATH --meshes FOLDER``.

PATH is called as in `benchmarks.compare`. Ours reads position, angles and sizes of every object of every scene; the other
implementation's time is that of ``generate`` alone. Shown are the first 200 scenes of a loop, all that it takes to begin with
included, beside its first 200; the next 1,000, and ``sample(500)`` as the first call, beside its scenes from the second on. Both
run in processes of their own, in turns. FOLDER holds the meshes of
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
LONG = 1000
"""Number of scenes of the second loop: more than may have been sampled ahead when it begins."""
BATCH = 500
THEIRS = 200
"""Scenes of the other implementation in a turn: some cost a hundred times as much as most, and its first one warms up."""


def child(path: str, folder: str, kind: str) -> None:
    """The work of our fresh process: prints milliseconds a scene as JSON."""
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
    figures = {}
    if kind == "batch":
        figures["batch"] = each(lambda: read(scenario.sample(BATCH, seed=3)), BATCH)
    else:
        for name, count in (("first", LOOP), ("loop", LONG)):
            figures[name] = each(
                lambda count=count: read(scenario.generate()[0] for _ in range(count)), count
            )
        figures["steady"] = statistics.median(
            each(lambda seed=seed: read(scenario.sample(LOOP, seed=seed)), LOOP) for seed in range(9, 14)
        )
    print(json.dumps(figures))


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--reference", required=True, help="command of the other implementation")
    parser.add_argument("--meshes", required=True, help="folder of meshes")
    parser.add_argument("--turns", type=int, default=2)
    parser.add_argument("--program", action="append", choices=PROGRAMS, help="only this one")
    parser.add_argument("--child", nargs=2, help=argparse.SUPPRESS)
    arguments = parser.parse_args()
    if arguments.child:
        path, kind = arguments.child
        child(path, arguments.meshes, kind)
        return
    print(
        f"{'program':14} {'reference':>10} {'its first':>10} {'first loop':>16} {'loop':>16} {'sample':>16}"
        "   loop / steady batch"
    )
    for name in arguments.program or PROGRAMS:
        path = str(HERE / "loops" / f"{name}.scenic")
        theirs, theirs_first, ours = [], [], []
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
            theirs_first.append(statistics.fmean(seconds) * 1e3)
            row = {}
            for kind in ("batch", "loop"):
                mine = [sys.executable, "-m", "benchmarks.loops", "--child", path, kind, "--reference", "-"]
                mine += ["--meshes", arguments.meshes]
                done = subprocess.run(mine, cwd=HERE.parent, capture_output=True, text=True, check=True)
                row.update(json.loads(done.stdout))
            ours.append(row)
        reference, reference_first = statistics.median(theirs), statistics.median(theirs_first)
        typical = {key: statistics.median(row[key] for row in ours) for key in ours[0]}
        beside = {"first": reference_first, "loop": reference, "batch": reference}
        cells = [f"{typical[key]:7.3f}ms {other / typical[key]:5.0f}x" for key, other in beside.items()]
        print(
            f"{name:14} {reference:8.2f}ms {reference_first:8.2f}ms {' '.join(cells)}"
            f" {typical['loop'] / typical['steady']:8.2f}"
        )


if __name__ == "__main__":
    main()
