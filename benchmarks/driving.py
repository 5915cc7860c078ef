"""Driving programs beside another implementation: ``python -m benchmarks.driving --reference PATH``.

PATH is called as in `benchmarks.compare`. The programs are those of ``examples/driving``; where one uses what the other does
not know, both run it with that replaced (`REPLACED`). All run in processes of their own; times are processor seconds. For each
program the table shows milliseconds a scene of the other one (without start-up and its first scene), then our load, our
first call ``sample(200)``, further calls ``sample(2000)``, and a loop of ``generate()`` after its first 200 scenes, each with the
ratio; the last lines hold geometric means and the least. Ours reads position and heading of every object of every scene.

The other one gets `--limit` seconds for a program and makes `--scenes` at most. With ``--keep FOLDER`` what it gave is kept there,
and used again. ``--laws`` compares its scenes with as many of ours: the least p-value, over the objects, of a two-sample test of
Kolmogorov and Smirnov of x, y and heading, and of a chi-squared test of which lanes hold the objects, with Bonferroni's
correction. ``--pruning`` needs no other one: candidates a scene with what analysis narrows and without, and the same tests between both.
Run by hand on a quiet machine; nothing here is a test.
"""

import argparse
import json
import math
import os
import random
import resource
import shlex
import statistics
import subprocess
import sys
import tempfile
import time
from collections.abc import Callable, Mapping
from functools import partial
from pathlib import Path
from types import MappingProxyType
from typing import Any, Final

HERE: Final = Path(__file__).parent
EXAMPLES: Final = HERE.parent / "examples" / "driving"
FIRST: Final = 200
BATCH: Final = 2000
STEADY: Final = 1.0
"""Seconds over which further calls are measured: processor clocks may be coarse."""
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


def read(scene: Any) -> list[list[float]]:
    """Position and heading of every object."""
    return [[item.position.x, item.position.y, item.heading] for item in scene.objects]


def timed(work: Callable[[], object]) -> float:
    """Processor seconds."""
    begun = time.process_time()
    work()
    return time.process_time() - begun


def steady(work: Callable[[int], object]) -> float:
    """Mean processor seconds of a call, over calls that take `STEADY` seconds together."""
    spent, calls = 0.0, 0
    while spent < STEADY:
        spent += timed(partial(work, calls))
        calls += 1
    return spent / calls


def child(path: str, kind: str, scenes: int) -> None:
    """The work of our fresh process: prints what was measured, or rows of scenes, as JSON."""
    import scenic
    from scenic.graph.domain import Domain

    figures: dict[str, Any] = {}
    scenarios: list[scenic.Scenario] = []
    figures["load"] = timed(lambda: scenarios.append(scenic.scenarioFromFile(path, mode2D=True)))
    [scenario] = scenarios
    if kind in ("rows", "unpruned"):
        if kind == "unpruned":
            scenario = scenario.within(Domain.whole(scenario.outline.graph.dimension))
        drawn = scenario.sample(scenes, seed=3 if kind == "rows" else 4)
        figures["rows"] = [read(scene) for scene in drawn]
        figures["candidates"] = statistics.fmean(scene.attempts for scene in drawn)
    elif kind == "loop":
        random.seed(3)
        figures["first"] = timed(lambda: [read(scenario.generate()[0]) for _ in range(FIRST)]) / FIRST
        figures["scene"] = steady(lambda _: [read(scenario.generate()[0]) for _ in range(500)]) / 500
    else:
        figures["first"] = timed(lambda: [read(scene) for scene in scenario.sample(FIRST, seed=3)]) / FIRST
        figures["scene"] = (
            steady(lambda call: [read(scene) for scene in scenario.sample(BATCH, seed=4 + call)]) / BATCH
        )
    print(json.dumps(figures))


def ours(path: Path, kind: str, scenes: int = 0) -> Any:
    """The output of a fresh process."""
    command = [sys.executable, "-m", "benchmarks.driving", "--child", str(path), kind, str(scenes)]
    done = subprocess.run(command, cwd=HERE.parent, capture_output=True, text=True, check=True)
    return json.loads(done.stdout)


def _run(command: str, path: Path, scenes: int, limit: float) -> tuple[list[Any], float]:
    """Lines that the other implementation prints within a time limit, and its processor seconds."""
    extra = ["-n", str(scenes), "--seed", "1", "--2d", "--time", "--max-iterations", "1000000"]
    environment = {key: value for key, value in os.environ.items() if key != "PYTHONPATH"}
    before = resource.getrusage(resource.RUSAGE_CHILDREN)
    with tempfile.TemporaryFile("w+") as output:
        running = subprocess.Popen(
            [*shlex.split(command), str(path), *extra],
            stdout=output,
            stderr=subprocess.DEVNULL,
            env={**environment, "PYTHONUNBUFFERED": "1"},
        )
        try:
            running.wait(limit)
        except subprocess.TimeoutExpired:
            running.kill()
            running.wait()
        output.seek(0)
        lines = output.read().splitlines()
    after = resource.getrusage(resource.RUSAGE_CHILDREN)
    rows = []
    for line in lines:
        try:
            rows.append(json.loads(line))
        except ValueError:  # cut off
            continue
    return rows, after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime


def theirs(given: argparse.Namespace, path: Path) -> Any:
    """Scenes of the other implementation, and processor seconds of a scene and of its start."""
    kept = None if given.keep is None else given.keep / f"{path.stem}.json"
    if kept is not None and kept.is_file():
        return json.loads(kept.read_text())
    first, start = _run(given.reference, path, 1, given.limit)
    rows, total = _run(given.reference, path, given.scenes, given.limit)
    for row in (*first, *rows):
        if "error" in row:
            raise SystemExit(f"{path.name}: {row['error']}")
    scenes = [row["objects"] for row in rows if "objects" in row]
    figures = {
        "start": start,
        "scene": (total - start) / max(len(scenes) - 1, 1),
        "rows": [[[*item["position"][:2], item["heading"]] for item in objects] for objects in scenes],
    }
    if kept is not None:
        kept.parent.mkdir(parents=True, exist_ok=True)
        kept.write_text(json.dumps(figures))
    return figures


def measure(given: argparse.Namespace, programs: list[Path]) -> None:
    """Print the table of times."""
    words = ("load", "first call", "sample(2000)", "loop")
    print(f"{'program':20} {'reference':>16}" + "".join(f"{word:>19}" for word in words))
    ratios: dict[str, list[float]] = {word: [] for word in words}
    for path in programs:
        other = theirs(given, path)
        batch, loop = ours(path, "batch"), ours(path, "loop")
        mine = (batch["load"], batch["first"], batch["scene"], loop["scene"])
        cells = []
        for word, seconds in zip(words, mine, strict=True):
            reference = other["start" if word == "load" else "scene"]
            ratios[word].append(reference / seconds)
            cells.append(f"{seconds * 1e3:10.3f}ms {reference / seconds:5.0f}x")
        count = f"({len(other['rows'])})"
        print(f"{path.stem:20} {other['scene'] * 1e3:8.2f}ms {count:>5} {' '.join(cells)}", flush=True)
    for word, of in (("mean", lambda each: math.exp(statistics.fmean(map(math.log, each)))), ("least", min)):
        print(f"{word:36}" + "".join(f"{of(each):18.1f}x" for each in ratios.values()))


def _least_p(path: Path, mine: Any, other: Any) -> tuple[int, float, str]:
    """Return the number of tests between scenes of two kinds, the least corrected p-value, and its observable."""
    import numpy as np
    from scipy.stats import chi2_contingency, ks_2samp

    from scenic.domains.driving.roads import Network

    road_map = "motorway.xodr" if "motorway.xodr" in path.read_text(encoding="utf-8") else "crossing.xodr"
    lanes = Network.fromFile(EXAMPLES / road_map).lanes
    mine, other = np.array(mine), np.array(other)
    p_values: list[tuple[float, str]] = []
    for number in range(mine.shape[1]):
        for part, word in enumerate(("x", "y", "heading")):
            columns = [np.round(rows[:, number, part], 4) for rows in (mine, other)]
            if part == 2:
                columns = [np.round(np.mod(column + 1e-3, 2 * math.pi), 2) for column in columns]
            if all(np.ptp(column) < 1e-2 for column in columns):
                continue
            p_values.append((float(ks_2samp(*columns).pvalue), f"{word} of object {number}"))
        counts = np.array([_lanes_of(rows[:, number, :2], lanes) for rows in (mine, other)])
        counts = counts[:, counts.sum(axis=0) >= 10]
        if counts.shape[1] > 1:
            p_values.append((float(chi2_contingency(counts).pvalue), f"lane of object {number}"))
    least, where = min(p_values, default=(1.0, "nothing random"))
    return len(p_values), min(1.0, least * max(len(p_values), 1)), where


def compare(given: argparse.Namespace, programs: list[Path]) -> None:
    """Print the least p-value of each program's tests."""
    for path in programs:
        other = theirs(given, path)["rows"]
        tests, least, where = _least_p(path, ours(path, "rows", max(len(other), 300))["rows"], other)
        print(
            f"{path.stem:20} {len(other):5} scenes {tests:3} tests, least p {least:8.2g}  {where}", flush=True
        )


def prune(programs: list[Path]) -> None:
    """Print candidates a scene narrowed and not, and the least p-value of tests between both."""
    print(f"{'program':20} {'unpruned':>10} {'pruned':>10}")
    for path in programs:
        pruned, whole = ours(path, "rows", 500), ours(path, "unpruned", 500)
        tests, least, where = _least_p(path, pruned["rows"], whole["rows"])
        print(
            f"{path.stem:20} {whole['candidates']:10.2f} {pruned['candidates']:10.2f} {tests:5} tests, least p {least:8.2g}  {where}",
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
    parser.add_argument("--scenes", type=int, default=400, help="scenes of the other one, at most")
    parser.add_argument("--limit", type=float, default=120, help="seconds for a program of the other one")
    parser.add_argument("--keep", type=Path, help="folder for what the other one gave")
    parser.add_argument("--laws", action="store_true", help="compare laws instead")
    parser.add_argument("--pruning", action="store_true", help="compare with and without narrowing instead")
    parser.add_argument("--program", action="append", help="only this one")
    parser.add_argument("--child", nargs=3, help=argparse.SUPPRESS)
    arguments = parser.parse_args()
    if arguments.child:
        path, kind, scenes = arguments.child
        child(path, kind, int(scenes))
        return
    if arguments.reference is None and not arguments.pruning:
        parser.error("--reference is needed")
    with tempfile.TemporaryDirectory() as folder:
        programs = prepared(Path(folder))
        if arguments.program:
            programs = [path for path in programs if path.stem in arguments.program]
        if arguments.pruning:
            prune(programs)
        else:
            (compare if arguments.laws else measure)(arguments, programs)


if __name__ == "__main__":
    main()
