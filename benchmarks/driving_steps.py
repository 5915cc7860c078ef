"""Simulations of driving programs beside another implementation: ``python -m benchmarks.driving_steps --scenic COMMAND``.

COMMAND is the other one's own command line, such as ``ENVIRONMENT/bin/scenic``; beside it lies its Python. The programs of
``examples/driving`` for the built-in simulator are simulated in 2D mode by both, with what is replaced in `benchmarks.driving`.

The first table shows milliseconds of processor time a step, and ratios: one script (`SCRIPT`) runs in both, by names that both have, and
takes the least of `--turns` runs of one scene, in which behaviors plan, too. Loading and sampling do not count, nor does what the
first of the runs imports. The other one draws each step by default, and waits for the clock between steps; so it is run without
(``param render = False``) and, with ``--render``, also as it is by default. The last lines hold geometric means and the least.

``--commands`` shows the whole command instead, from its start to its end, by default options: processor seconds and seconds by the clock.
Run by hand; nothing here is a test.
"""

import argparse
import json
import math
import os
import resource
import statistics
import subprocess
import sys
import tempfile
import time
from collections.abc import Sequence
from pathlib import Path
from typing import Any, Final

from benchmarks.driving import prepared

SCRIPT: Final = """
import json, random, sys, time
import scenic
path, steps, turns = sys.argv[1], *map(int, sys.argv[2:])
random.seed(1)
scenario = scenic.scenarioFromFile(path, mode2D=True)
simulator, rows = scenario.getSimulator(), []
while not rows:
    scene, _ = scenario.generate(maxIterations=1000000)
    for _ in range(turns):
        random.seed(1)
        begun = time.process_time()
        done = simulator.simulate(scene, maxSteps=steps, maxIterations=1)
        if done is None:
            break
        rows.append([done.currentTime, time.process_time() - begun])
print(json.dumps(rows))
"""


def seconds_a_step(python: str, path: Path, steps: int, turns: int) -> float:
    """Return the least processor seconds of a step of a program, in a fresh process of an implementation."""
    environment = {key: value for key, value in os.environ.items() if key != "PYTHONPATH"}
    done = subprocess.run(
        [python, "-c", SCRIPT, str(path), str(steps), str(turns)],
        capture_output=True,
        text=True,
        timeout=600,
        cwd=path.parent,
        env={**environment, "SDL_VIDEODRIVER": "dummy"},
        check=False,
    )
    if done.returncode != 0:
        return math.nan
    least: float = min(seconds / count for count, seconds in json.loads(done.stdout.splitlines()[-1]))
    return least


def of_command(command: Sequence[str]) -> tuple[float, float]:
    """Return the processor seconds of a command, and those by the clock."""
    environment = {key: value for key, value in os.environ.items() if key != "PYTHONPATH"}
    before, begun = resource.getrusage(resource.RUSAGE_CHILDREN), time.perf_counter()
    done = subprocess.run(
        command,
        capture_output=True,
        timeout=600,
        env={**environment, "SDL_VIDEODRIVER": "dummy"},
        check=False,
    )
    after, clock = resource.getrusage(resource.RUSAGE_CHILDREN), time.perf_counter() - begun
    if done.returncode != 0:
        return math.nan, math.nan
    return after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime, clock


def rows_of(given: argparse.Namespace, path: Path) -> list[tuple[float, float]]:
    """Return the figures of a program in the columns of the table: each of the other one, and ours."""
    if given.commands:
        steps = str(given.steps)
        other = of_command(
            [given.scenic, str(path), "--simulate", "--count", "1", "--time", steps, "--2d", "--seed", "1"]
        )
        scenic = str(Path(sys.executable).with_name("scenic"))
        own = of_command([scenic, "simulate", str(path), "-n", "1", "--time", steps, "--2d", "--seed", "1"])
        return list(zip(other, own, strict=True))
    python = str(Path(given.scenic).with_name("python"))
    text = path.read_text(encoding="utf-8")
    silent = path.with_name(f"{path.stem}_silent.scenic")
    silent.write_text("param render = False\n" + text, encoding="utf-8")
    own_seconds = seconds_a_step(sys.executable, silent, given.steps, given.turns)
    columns = [(seconds_a_step(python, silent, given.steps, given.turns), own_seconds)]
    if given.render:
        # It waits for the clock: few steps do.
        columns.append((seconds_a_step(python, path, min(given.steps, 60), 2), own_seconds))
    return columns


def table(given: argparse.Namespace, programs: Sequence[Path]) -> None:
    """Print the table."""
    unit, scale = ("s", 1.0) if given.commands else ("ms", 1e3)
    words = ("processor", "clock") if given.commands else ("a step", "a step, drawn")
    ratios: list[list[float]] = [[], []]
    for path in programs:
        columns = rows_of(given, path)
        cells = [f"{path.stem:20}"]
        for word, (other, own), of_column in zip(words, columns, ratios, strict=False):
            cells.append(f"{word}: {other * scale:8.2f} {own * scale:8.3f} {unit} {other / own:6.1f}")
            if not math.isnan(other / own):
                of_column.append(other / own)
        print("   ".join(cells), flush=True)
    for word, of_column in zip(words, ratios, strict=True):
        if of_column:
            mean = math.exp(statistics.fmean(map(math.log, of_column)))
            print(f"{word}: mean {mean:.1f}, least {min(of_column):.1f}, of {len(of_column)} programs")


def main() -> None:
    """Print the table."""
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("--scenic", required=True, help="command of the other implementation")
    parser.add_argument("--steps", type=int, default=200)
    parser.add_argument("--turns", type=int, default=6)
    parser.add_argument("--render", action="store_true", help="also let the other one draw")
    parser.add_argument("--commands", action="store_true", help="measure whole commands instead")
    parser.add_argument("--program", action="append", help="only this one")
    given: Any = parser.parse_args()
    with tempfile.TemporaryDirectory() as folder:
        programs = [
            path for path in prepared(Path(folder)) if "newtonian" in path.read_text(encoding="utf-8")
        ]
        table(given, [path for path in programs if path.stem in (given.program or [path.stem])])


if __name__ == "__main__":
    main()
