"""One table of everything a user waits for: ``python -m benchmarks --reference PATH [--write]``.

PATH is called as in `benchmarks.compare`. Each program is measured by both in turns, each time in a process of its own:

- check: ``scenic check``, beside the reference's parsing of the program;
- first: from the start of the process to the first scene, with the most memory that the process takes;
- scene: each of the scenes after the first.

Then follow the steps of a simulation (`benchmarks.dynamics`), and the operations that take most of the time of our scenes.
Everything is processor time, of the medians over the turns, so that other work on the machine matters less; but for the
reference's scenes, whose time it measures itself, by the clock. Compiled modules are kept, as where a package is installed. ``--write`` puts the table into ``docs/explanation/performance.md``, with machine and date.
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
from collections import Counter
from collections.abc import Sequence
from datetime import UTC, datetime
from pathlib import Path
from typing import Final, NamedTuple

from benchmarks import dynamics
from benchmarks.compare import machine, release
from benchmarks.parse import ordinary_environment
from scenic.pipeline import load

HERE: Final = Path(__file__).parent
PAGE: Final = HERE.parent / "docs/explanation/performance.md"
BEGIN, END = "<!-- begin of the table -->\n", "<!-- end of the table -->\n"
PROGRAMS: Final = (
    *sorted((HERE / "breadth").glob("*.scenic")),
    *(
        HERE / f"{name}.scenic"
        for name in ("room_with_toys", "chairs_at_table", "overtaking", "hidden", "hollow")
    ),
    *(HERE / f"loops/{name}.scenic" for name in ("ten_boxes", "four_cars")),
)
OURS: Final = 400
STEPS: Final = 1000


class Spent(NamedTuple):
    """Processor seconds and the most memory, in MB, that a process took; what it printed."""

    seconds: float
    memory: float
    output: str


def spent(command: Sequence[str]) -> Spent:
    """Run a process to its end."""
    with tempfile.TemporaryFile("w+") as printed:
        process = subprocess.Popen(
            command, cwd=HERE.parent, env=ordinary_environment(), stdout=printed, stderr=subprocess.DEVNULL
        )
        _, status, used = os.wait4(process.pid, 0)
        process.returncode = os.waitstatus_to_exitcode(status)
        printed.seek(0)
        return Spent(used.ru_utime + used.ru_stime, used.ru_maxrss / 1024, printed.read())


def child(path: str, scenes: int) -> None:
    """Our fresh process: prints processor seconds of each scene after the first."""
    scenario = load(path)
    scenario.sample(1, seed=1, max_attempts=None)
    begun = time.process_time()
    for scene in scenario.sample(scenes, seed=2, max_attempts=None):
        for item in scene.objects:
            tuple(item.position), item.yaw, item.pitch, item.roll, item.width, item.length, item.height
    print((time.process_time() - begun) / scenes)


class Row(NamedTuple):
    """The figures of one program, ours or theirs: seconds, seconds, MB, seconds."""

    check: float
    first: float
    memory: float
    scene: float


def ours(path: Path) -> Row:
    """One turn of ours."""
    scenic = [sys.executable, "-m", "scenic"]
    first = spent([*scenic, "sample", str(path), "-n", "1", "--seed", "1"])
    scene = spent([sys.executable, "-m", "benchmarks", "--child", str(path)])
    return Row(spent([*scenic, "check", str(path)]).seconds, first.seconds, first.memory, float(scene.output))


def theirs(command: str, path: Path, scenes: int, seed: int) -> Row:
    """One turn of the other implementation; it measures the time of each scene but the first itself."""
    start = shlex.split(command)
    sampled = [*start, str(path), "--seed", str(seed), "--max-iterations", "100000", "--observe", "x=1"]
    first = spent([*sampled, "-n", "1"])
    more = spent([*sampled, "-n", str(scenes + 1), "--time"]).output
    seconds = [row["seconds"] for row in map(json.loads, more.splitlines()) if "iterations" in row]
    if len(seconds) < 2:
        raise SystemExit(
            f"{path}: the reference found no two scenes: {more.strip() or 'nothing was printed'}"
        )
    scene = statistics.fmean(seconds[1:])
    return Row(spent([*start, "--parse", str(path)]).seconds, first.seconds, first.memory, scene)


def _times(ratio: float) -> str:
    return f"{ratio:,.0f}x" if ratio >= 100 else f"{ratio:.3g}x"


def medians(rows: Sequence[Row]) -> Row:
    """The median of each figure."""
    return Row(*(statistics.median(column) for column in zip(*rows, strict=True)))


def profiled(programs: Sequence[Path]) -> list[str]:
    """The operations that take most of the time of scenes, each program counting alike."""
    shares: Counter[str] = Counter()
    for path in programs:
        profile = load(path).profile(200, seed=1)
        total = sum(row.seconds for row in profile.operations) or 1.0
        for row in profile.operations:
            shares[row.operation] += row.seconds / total / len(programs)
    lines = ["| operation | share of the time |", "|---|---|"]
    return [*lines, *(f"| `{name}` | {share:.0%} |" for name, share in shares.most_common(12))]


def table(options: argparse.Namespace, programs: Sequence[Path]) -> list[str]:
    """The table of programs, and that of geometric means, line by line as it is measured."""
    lines = [
        "| program | check | beside | first scene | beside | MB | beside | a scene | beside |",
        "|---|---|---|---|---|---|---|---|---|",
    ]
    ratios: list[Row] = []
    for path in programs:
        ours(path)  # compiles what it imports, and is not counted
        turns = [
            (ours(path), theirs(options.reference, path, options.scenes, turn))
            for turn in range(options.turns)
        ]
        mine, other = (medians(side) for side in zip(*turns, strict=True))
        ratio = Row(*(b / a for a, b in zip(mine, other, strict=True)))
        ratios.append(ratio)
        lines.append(
            f"| `{path.stem}` | {mine.check:.2f} s | {ratio.check:.1f}x | {mine.first:.2f} s | {ratio.first:.1f}x "
            f"| {mine.memory:.0f} | {ratio.memory:.1f}x | {mine.scene * 1e3:.3g} ms | {_times(ratio.scene)} |"
        )
        print(lines[-1], flush=True)
    for name, of in (
        ("geometric mean", lambda x: math.exp(statistics.fmean(map(math.log, x)))),
        ("least", min),
    ):
        check, first, memory, scene = (of(column) for column in zip(*ratios, strict=True))
        lines.append(f"| {name} | | {check:.1f}x | | {first:.1f}x | | {memory:.1f}x | | {_times(scene)} |")
    return lines


def main() -> None:
    """Print everything, or write it."""
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("--reference", metavar="PATH", help="command of the other implementation")
    parser.add_argument("--turns", type=int, default=3, help="turns for each program (default 3)")
    parser.add_argument("--scenes", type=int, default=60, help="scenes of the reference after its first one")
    parser.add_argument("--program", action="append", help="only the programs of these names; repeatable")
    parser.add_argument("--write", action="store_true", help="write the page of the documentation")
    parser.add_argument("--child", help=argparse.SUPPRESS)
    options = parser.parse_args()
    if options.child:
        child(options.child, OURS)
        return
    if not options.reference:
        parser.error("give the command of the other implementation as --reference")
    options.reference = str(Path(options.reference).resolve())
    programs = [path for path in PROGRAMS if not options.program or path.stem in options.program]
    if not programs:
        parser.error(f"no such program; there are {', '.join(path.stem for path in PROGRAMS)}")
    lines = table(options, programs)
    mine = STEPS / statistics.median(dynamics.ours(STEPS) for _ in range(options.turns))
    other = STEPS / statistics.median(
        dynamics.of_reference(Path(options.reference), STEPS) for _ in range(options.turns)
    )
    lines += [
        "",
        (
            f"Simulation of 20 agents with 3 interrupts each and 5 temporal requirements: {mine:,.0f} steps a second, "
            f"{mine / other:.1f} times the reference's."
        ),
        "",
        *profiled(programs),
        "",
        (
            f"Measured on {datetime.now(UTC):%Y-%m-%d}: {machine()}, {os.cpu_count()} processors, Python "
            f"{sys.version.split()[0]}, {release('numpy')}; turns: {options.turns}; scenes in each: {OURS} of ours, {options.scenes} of the "
            "reference's."
        ),
    ]
    text = "\n".join(lines) + "\n"
    print(text)
    if options.write:
        before, _, rest = PAGE.read_text(encoding="utf-8").partition(BEGIN)
        after = rest.partition(END)[2]
        PAGE.write_text(f"{before}{BEGIN}\n{text}\n{END}{after}", encoding="utf-8")


if __name__ == "__main__":
    main()
