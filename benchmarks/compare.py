"""Compare with another implementation of the language: ``python -m benchmarks.compare --reference PATH``.

PATH is a command that samples a program and prints what it did, called as

    PATH FILE.scenic -n N --seed S --max-iterations M --time --observe x=1

It prints a line of JSON for each scene with ``iterations`` (candidates drawn) and ``seconds``.

Both implementations sample the same programs, in turns, each time in a process of its own; start-up and compilation are not
counted, and each process first finds a scene that is not counted either. For each program, the table shows medians over the
turns: seconds a scene, candidates a second, and their ratios. Two laws of candidates may differ where one implementation prunes
better; ``--no-prune`` turns ours off.

Run by hand on a quiet machine; nothing here is a test.
"""

import argparse
import json
import platform
import shlex
import statistics
import subprocess
import sys
import time
from dataclasses import dataclass
from importlib.metadata import PackageNotFoundError, version
from pathlib import Path

HERE = Path(__file__).parent
OUR_SCENES = 200
SECONDS = 600
"""Longer than this no process runs."""


@dataclass(frozen=True, slots=True)
class Case:
    """A program to compare on.

    Attributes:
        file: without its ending, beside this module.
        scenes: how many the reference samples in a turn.
        parameters: of the program.
        least: how many times faster a scene is meant to be.

    """

    file: str
    scenes: int
    parameters: tuple[tuple[str, object], ...] = ()
    least: int | None = None


CASES = {
    "room_with_toys": Case("room_with_toys", 20),
    "chairs_at_table": Case("chairs_at_table", 100),
    "overtaking": Case("overtaking", 100),
    "vacuum-0": Case("vacuum", 20, (("toys", 0),), 50),
    "vacuum-1": Case("vacuum", 20, (("toys", 1),), 50),
    "vacuum-4": Case("vacuum", 20, (("toys", 4),), 50),
    "vacuum-16": Case("vacuum", 1, (("toys", 16),), 1000),
    "hidden": Case("hidden", 200, (), 100),
    "hollow": Case("hollow", 400, (), 100),
    "large_meshes": Case("loops/large_meshes", 400, (("folder", None),), 50),
}


@dataclass(frozen=True, slots=True)
class Run:
    """The work of one process."""

    scenes: int
    candidates: int
    seconds: float

    @property
    def seconds_a_scene(self) -> float:
        """Seconds for one accepted scene."""
        return self.seconds / self.scenes if self.scenes else float("nan")

    @property
    def candidates_a_second(self) -> float:
        """Candidates drawn and judged in one second."""
        return self.candidates / self.seconds


def ours(program: str, seed: int, scenes: int, prune: bool, meshes: str) -> Run:
    """Sample with this implementation, in a fresh process."""
    command = [sys.executable, "-m", "benchmarks.compare", "--child", program, "--seed", str(seed)]
    command += ["--our-scenes", str(scenes), "--meshes", meshes, *([] if prune else ["--no-prune"])]
    result = subprocess.run(
        command, cwd=HERE.parent, capture_output=True, text=True, timeout=SECONDS, check=False
    )
    if result.returncode:
        raise SystemExit(f"{program}: our run failed\n{result.stderr}")
    return Run(**json.loads(result.stdout))


def parameters(program: str, meshes: str) -> dict[str, object]:
    """Return the parameters of a case, with the folder of meshes if it takes one."""
    given = dict(CASES[program].parameters)
    return given | ({"folder": meshes} if "folder" in given else {})


def child(program: str, seed: int, scenes: int, prune: bool, meshes: str) -> None:
    """Run one case in a fresh process, and print a `Run` as JSON."""
    from scenic.pipeline import load
    from scenic.runtime.sampling.rejection_report import Exhausted

    file = HERE / f"{CASES[program].file}.scenic"
    scenario = load(file, params=parameters(program, meshes), prune=prune)
    for _ in scenario.stream(1, seed=seed + 1_000_000, max_attempts=None, time_limit=None):
        pass
    started = time.perf_counter()
    scene_count, candidates = 0, 0
    for result in scenario.stream(scenes, seed=seed, max_attempts=None, time_limit=SECONDS / 4):
        candidates += result.attempts
        if not isinstance(result, Exhausted):
            scene_count += 1
            # Scenes make their objects when they are looked at.
            for thing in result.objects:
                (
                    tuple(thing.position),
                    thing.yaw,
                    thing.pitch,
                    thing.roll,
                    thing.width,
                    thing.length,
                    thing.height,
                )
    print(
        json.dumps(
            {"scenes": scene_count, "candidates": candidates, "seconds": time.perf_counter() - started}
        )
    )


def reference(command: str, program: str, seed: int, limit: int, meshes: str) -> Run:
    """Sample with the other implementation."""
    arguments = [
        *shlex.split(command),
        str(HERE / f"{CASES[program].file}.scenic"),
        "-n",
        str(CASES[program].scenes + 1),
        "--seed",
        str(seed),
    ]
    for name, value in parameters(program, meshes).items():
        arguments += ["--param", f"{name}={json.dumps(value)}"]
    arguments += ["--max-iterations", str(limit), "--time", "--observe", "x=1"]
    try:
        result = subprocess.run(arguments, capture_output=True, text=True, timeout=SECONDS, check=False)
        output = result.stdout
    except subprocess.TimeoutExpired as expired:
        output = expired.stdout.decode() if isinstance(expired.stdout, bytes) else expired.stdout or ""
        output = output.rpartition("\n")[0]
    rows = [row for row in map(json.loads, output.splitlines()) if "iterations" in row]
    if not rows:
        raise SystemExit(
            f"{program}: the reference found no scene: {output.strip() or 'nothing was printed'}"
        )
    counted = rows[1:] or rows
    return Run(
        len(counted), sum(row["iterations"] for row in counted), sum(row["seconds"] for row in counted)
    )


def release(name: str) -> str:
    """A package with its version."""
    try:
        return f"{name} {version(name)}"
    except PackageNotFoundError:
        return f"{name} from a checkout"


def machine() -> str:
    """The processor, as far as the system names it."""
    model = platform.processor() or platform.machine()
    try:
        for line in Path("/proc/cpuinfo").read_text().splitlines():
            if line.startswith("model name"):
                model = line.split(":", 1)[1].strip()
                break
    except OSError:
        pass
    return f"{model}, {platform.system()} {platform.release()}"


def main() -> None:
    """Print the table."""
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("--reference", metavar="PATH", help="command of the other implementation")
    parser.add_argument("--repeats", type=int, default=3, help="turns for each program (default 3)")
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument(
        "--max-iterations", type=int, default=3000, help="the reference's limit for one scene"
    )
    parser.add_argument("--our-scenes", type=int, default=OUR_SCENES)
    parser.add_argument("--no-prune", action="store_true")
    parser.add_argument("--program", action="append", choices=CASES, help="only this one; repeatable")
    parser.add_argument("--meshes", default="", help="folder of the meshes of `large_meshes`")
    parser.add_argument("--child", choices=CASES, help=argparse.SUPPRESS)
    options = parser.parse_args()
    prune = not options.no_prune
    if options.child:
        child(options.child, options.seed, options.our_scenes, prune, options.meshes)
        return
    names = ("scenic-lang", "numpy", "scipy")
    print(f"Python {platform.python_version()}, {', '.join(map(release, names))}; {machine()}")
    print(
        f"seed {options.seed}, {options.repeats} turns, medians; ours: {options.our_scenes} scenes a turn, ",
        end="",
    )
    print("pruned" if prune else "not pruned")
    if options.reference:
        print(f"reference: {options.reference}")
    header = f"{'program':18} {'':10} {'scenes':>7} {'cand./scene':>12} {'s/scene':>10} {'cand./s':>12}"
    print(f"\n{header}\n{'-' * len(header)}")
    for program in options.program or CASES:
        if "folder" not in dict(CASES[program].parameters) or options.meshes:
            compare(program, options, prune)


def compare(program: str, options: argparse.Namespace, prune: bool) -> None:
    """Run one program in turns and print its lines."""
    mine: list[Run] = []
    theirs: list[Run] = []
    for turn in range(options.repeats):
        seed = options.seed + turn
        mine.append(ours(program, seed, options.our_scenes, prune, options.meshes))
        if options.reference:
            theirs.append(reference(options.reference, program, seed, options.max_iterations, options.meshes))
    show(program, "ours", mine)
    if theirs:
        show("", "reference", theirs)
        faster = median(theirs, "seconds_a_scene") / median(mine, "seconds_a_scene")
        more = median(mine, "candidates_a_second") / median(theirs, "candidates_a_second")
        least = CASES[program].least
        meant = (
            "" if least is None else f"   meant: {least}x a scene" + (", missed" if faster < least else "")
        )
        print(f"{'':18} {'ratio':10} {'':>7} {'':>12} {faster:>9.0f}x {more:>11.0f}x{meant}", flush=True)


def median(runs: list[Run], what: str) -> float:
    """The median over the turns."""
    return float(statistics.median(getattr(run, what) for run in runs))


def show(program: str, who: str, runs: list[Run]) -> None:
    """Print a line of the table."""
    scenes = sum(run.scenes for run in runs)
    each = sum(run.candidates for run in runs) / scenes if scenes else float("nan")
    print(
        f"{program:18} {who:10} {scenes:>7} {each:>12.1f} {median(runs, 'seconds_a_scene'):>10.4g} "
        f"{median(runs, 'candidates_a_second'):>12,.0f}",
        flush=True,
    )


if __name__ == "__main__":
    main()
