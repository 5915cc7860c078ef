"""Driving programs beside another implementation: ``python -m benchmarks.driving --reference PATH``.

PATH is called as in `benchmarks.compare`. The programs are those of ``examples/driving``; where one uses what the other does
not know, both run it with that replaced (`REPLACED`). For each, the table shows the load, and milliseconds a scene through
``sample(200)``, its first call included, and through a loop of ``generate()``, ours and theirs, with the ratios; the last line
holds their geometric means and the least of each. Ours reads position and heading of every object of every scene; theirs is the
time of ``generate`` alone, from the second scene on. All run in processes of their own, in turns.

With ``--laws N`` it compares N scenes of either instead: the least p-value, over the objects, of a two-sample test of
Kolmogorov and Smirnov of x, y and heading, and of a chi-squared test of which lanes hold the objects, with Bonferroni's
correction. Run by hand on a quiet machine; nothing here is a test.
"""

import argparse
import json
import math
import random
import shlex
import statistics
import subprocess
import sys
import tempfile
import time
from collections.abc import Mapping
from pathlib import Path
from types import MappingProxyType
from typing import Any, Final

HERE: Final = Path(__file__).parent
EXAMPLES: Final = HERE.parent / "examples" / "driving"
BATCH: Final = 200
REPLACED: Final[Mapping[str, tuple[tuple[str, str], ...]]] = MappingProxyType(
    {
        # The other one reads newest blueprint catalogues that have neither bicycles nor motorcycles.
        "carla_bicycle": (("new Bicycle", "new Car"),),
        # It finds no signals in this map.
        "queue": (("require crossing.hasTrafficLights", ""),),
        # In its filters no random value is drawn, so that two lanes are never one; and ways that meet in their ends do not conflict.
        "right_turn": (
            (
                "other_turn = Uniform(*filter(lambda m: m.endLane is turn.endLane, turn.conflictingManeuvers))",
                (
                    "other_turn = Uniform(*filter(lambda m: m.type is ManeuverType.STRAIGHT, crossing.maneuvers))\n"
                    "require other_turn.endLane is turn.endLane"
                ),
            ),
        ),
        "trajectory": (
            ("way = Trajectory([(0, -8.75), (60, -8.75), (110, -5.25), (380, -5.25)], speeds=[12, 12, 15, 15])", ""),
            ("    with lateralController PurePursuitLateralController(lookahead=6),\n", ""),
            ("FollowTrajectoryBehavior(trajectory=way)", "FollowLaneBehavior()"),
        ),
        "walkers": (("Walk([far])", "WalkForwardBehavior()"),),
    }
)  # fmt: skip


def prepared(folder: Path) -> list[Path]:
    """The programs as both run them, beside copies of their maps, in a folder."""
    for road_map in EXAMPLES.glob("*.xodr"):
        (folder / road_map.name).write_bytes(road_map.read_bytes())
    programs = []
    for path in sorted(EXAMPLES.glob("*.scenic")):
        text = path.read_text(encoding="utf-8")
        for old, new in REPLACED.get(path.stem, ()):
            if old not in text:
                raise SystemExit(f"{path.name} has no {old!r} any more")
            text = text.replace(old, new)
        programs.append(folder / path.name)
        programs[-1].write_text(text, encoding="utf-8")
    return programs


def child(path: str, kind: str, scenes: int) -> None:
    """The work of our fresh process: prints what was measured, or rows of scenes, as JSON."""
    import scenic

    begun = time.perf_counter()
    scenario = scenic.scenarioFromFile(path, mode2D=True)
    found: dict[str, Any] = {"load": (time.perf_counter() - begun) * 1e3}

    def read(scene: Any) -> list[list[float]]:
        return [[item.position.x, item.position.y, item.heading] for item in scene.objects]

    random.seed(3)
    begun = time.perf_counter()
    if kind == "loop":
        for _ in range(scenes):
            read(scenario.generate()[0])
    else:
        rows = [read(scene) for scene in scenario.sample(scenes, seed=3)]
        if kind == "rows":
            found["rows"] = rows
    found["scene"] = (time.perf_counter() - begun) / scenes * 1e3
    print(json.dumps(found))


def ours(path: Path, kind: str, scenes: int) -> Any:
    """The output of a fresh process."""
    command = [sys.executable, "-m", "benchmarks.driving", "--child", str(path), kind, str(scenes)]
    done = subprocess.run(command, cwd=HERE.parent, capture_output=True, text=True, check=True)
    return json.loads(done.stdout)


def theirs(command: str, path: Path, scenes: int, seed: int) -> list[Any]:
    """The lines that the other implementation prints: one a scene, and one of its load."""
    extra = ["-n", str(scenes), "--seed", str(seed), "--2d", "--time", "--max-iterations", "1000000"]
    shown = subprocess.run(
        [*shlex.split(command), str(path), *extra], capture_output=True, text=True, check=False
    )
    rows = [json.loads(line) for line in shown.stdout.splitlines()]
    for row in rows:
        if "error" in row:
            raise SystemExit(f"{path.name}: {row['error']}")
    return rows


def measure(command: str, programs: list[Path], turns: int, scenes: int) -> None:
    """Print the table of times."""
    print(f"{'program':20} {'reference':>10} {'load':>17} {'sample(200)':>17} {'loop':>17}")
    ratios: dict[str, list[float]] = {"load": [], "batch": [], "loop": []}
    for path in programs:
        other: dict[str, list[float]] = {"load": [], "scene": []}
        mine: dict[str, list[float]] = {"load": [], "batch": [], "loop": []}
        for turn in range(turns):
            rows = theirs(command, path, scenes, turn)
            seconds = [row["seconds"] for row in rows if "seconds" in row][1:]
            other["scene"].append(statistics.fmean(seconds) * 1e3)
            other["load"].append(sum(row["compile_s"] for row in rows if "compile_s" in row) * 1e3)
            for kind in ("batch", "loop"):
                found = ours(path, kind, BATCH)
                mine[kind].append(found["scene"])
                mine["load"].append(found["load"])
        cells = []
        for kind in ratios:
            reference = statistics.median(other["load" if kind == "load" else "scene"])
            typical = statistics.median(mine[kind])
            ratios[kind].append(reference / typical)
            cells.append(f"{typical:8.3f}ms {reference / typical:5.0f}x")
        print(f"{path.stem:20} {statistics.median(other['scene']):8.2f}ms {' '.join(cells)}", flush=True)
    for word, of in (("mean", lambda each: math.exp(statistics.fmean(map(math.log, each)))), ("least", min)):
        print(f"{word:31}" + " ".join(f"{of(each):16.1f}x" for each in ratios.values()))


def compare(command: str, programs: list[Path], scenes: int) -> None:
    """Print the least p-value of each program's tests."""
    import numpy as np
    from scipy.stats import chi2_contingency, ks_2samp

    from scenic.domains.driving.roads import Network

    for path in programs:
        road_map = "motorway.xodr" if "motorway.xodr" in path.read_text(encoding="utf-8") else "crossing.xodr"
        lanes = Network.fromFile(EXAMPLES / road_map).lanes
        mine = np.array(ours(path, "rows", scenes)["rows"])
        other = np.array(
            [
                [[*item["position"][:2], item["heading"] if "heading" in item else item["yaw"]] for item in row["objects"]]
                for row in theirs(command, path, scenes, 1)
                if "objects" in row
            ]
        )  # fmt: skip
        found: list[tuple[float, str]] = []
        for number in range(mine.shape[1]):
            for part, word in enumerate(("x", "y", "heading")):
                columns = [np.round(rows[:, number, part], 4) for rows in (mine, other)]
                if part == 2:
                    columns = [np.round(np.mod(column + 1e-3, 2 * math.pi), 2) for column in columns]
                if all(np.ptp(column) < 1e-2 for column in columns):
                    continue
                found.append((float(ks_2samp(*columns).pvalue), f"{word} of object {number}"))
            counts = np.array([_lanes_of(rows[:, number, :2], lanes) for rows in (mine, other)])
            counts = counts[:, counts.sum(axis=0) >= 10]
            if counts.shape[1] > 1:
                found.append((float(chi2_contingency(counts).pvalue), f"lane of object {number}"))
        least, where = min(found, default=(1.0, "nothing random"))
        print(
            f"{path.stem:20} {len(found):3} tests, least p {min(1.0, least * max(len(found), 1)):8.2g}  {where}",
            flush=True,
        )


def _lanes_of(places: Any, lanes: Any) -> list[int]:
    """Numbers of places by the lane that holds them first; the last is the number of places outside all lanes."""
    from scenic.domains.driving.lookups import Finder

    found = Finder(lanes, 0.05).near(places)
    return [int((found == number).sum()) for number in range(len(lanes) + 1)]


def main() -> None:
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("--reference", help="command of the other implementation")
    parser.add_argument("--turns", type=int, default=1)
    parser.add_argument("--scenes", type=int, default=20, help="scenes of the other one in a turn")
    parser.add_argument("--laws", type=int, metavar="N", help="compare N scenes of either instead")
    parser.add_argument("--program", action="append", help="only this one")
    parser.add_argument("--child", nargs=3, help=argparse.SUPPRESS)
    given = parser.parse_args()
    if given.child:
        path, kind, scenes = given.child
        child(path, kind, int(scenes))
        return
    if given.reference is None:
        parser.error("--reference is needed")
    with tempfile.TemporaryDirectory() as folder:
        programs = prepared(Path(folder))
        if given.program:
            programs = [path for path in programs if path.stem in given.program]
        if given.laws:
            compare(given.reference, programs, given.laws)
        else:
            measure(given.reference, programs, given.turns, given.scenes)


if __name__ == "__main__":
    main()
