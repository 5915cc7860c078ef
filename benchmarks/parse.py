"""Measure parsing: ``python -m benchmarks.parse [--reference PATH]``.

PATH is the command that runs another implementation of the language (it is called once, as ``PATH --parse FILE``, so that
it sets itself up). Its parser is then run in its own environment, in one process, beside ours in another: both parse
each text in turns. Each turn gives a pair of times, next to each other; the table shows medians over the turns.

Three tables: lines a second on many texts, the time of texts of growing length (linear or not), and the time of a
whole process. Run by hand on a quiet machine; nothing here is a test.
"""

import argparse
import json
import os
import platform
import shlex
import statistics
import subprocess
import sys
import sysconfig
import tempfile
import time
from collections.abc import Callable, Iterator, Mapping, Sequence
from contextlib import contextmanager
from pathlib import Path
from typing import Final

from benchmarks.compare import machine, release
from benchmarks.programs import KINDS, program
from scenic.compiler.parser import parse

ROOT: Final = Path(__file__).resolve().parent.parent
MODULES: Final = (
    "bisect",
    "shlex",
    "fractions",
    "textwrap",
    "heapq",
    "queue",
    "csv",
    "sched",
    "configparser",
    "json/decoder",
)
LENGTHS: Final = (1_000, 2_000, 5_000, 10_000, 20_000, 25_000, 50_000)
SHORT: Final = 20
SEED: Final = 1

DRIVER: Final = """
import json, sys, time
from scenic.syntax.parser import parse_string
for line in sys.stdin:
    with open(json.loads(line), encoding="utf-8") as file:
        text = file.read()
    start = time.perf_counter()
    try:
        parse_string(text, "exec")
    except Exception as problem:
        print(json.dumps(str(problem) or "refused"), flush=True)
    else:
        print(json.dumps(time.perf_counter() - start), flush=True)
"""
"""Run by the reference's Python: parses each file that it is given, and prints the seconds."""


class Driver:
    """A process that parses files on request."""

    def __init__(self, command: Sequence[str], environment: Mapping[str, str], folder: Path) -> None:
        self._process = subprocess.Popen(
            # The folder is on the path of a Python that is given a module or a program.
            command,
            stdin=subprocess.PIPE,
            stdout=subprocess.PIPE,
            text=True,
            env=environment,
            cwd=folder,
        )

    def seconds(self, path: Path) -> float | None:
        """Return the seconds that parsing takes; ``None`` if the text is refused."""
        assert self._process.stdin is not None
        assert self._process.stdout is not None
        self._process.stdin.write(json.dumps(str(path)) + "\n")
        self._process.stdin.flush()
        answer = json.loads(self._process.stdout.readline())
        return answer if isinstance(answer, float) else None

    def close(self) -> None:
        self._process.communicate()


def child() -> None:
    """Our process: as `DRIVER`."""
    for line in sys.stdin:
        text = Path(json.loads(line)).read_text(encoding="utf-8")
        start = time.perf_counter()
        result = parse(text)
        seconds = time.perf_counter() - start
        print(json.dumps("refused" if result.diagnostics else seconds), flush=True)


def ordinary_environment() -> dict[str, str]:
    """The environment as users have it: compiled modules are kept, and no checkout is on the path."""
    left_out = ("PYTHONDONTWRITEBYTECODE", "PYTHONPATH")
    return {name: value for name, value in os.environ.items() if name not in left_out}


@contextmanager
def ours() -> Iterator[Driver]:
    """Our parser, in a process of its own."""
    driver = Driver(
        [sys.executable, "-m", "benchmarks.parse", "--child"],
        ordinary_environment(),
        ROOT,
    )
    try:
        yield driver
    finally:
        driver.close()


def reference_python(command: str) -> Path:
    """The Python in the environment of the reference, which is set up if need be."""
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / "empty.scenic"
        path.write_text("x = 1\n")
        subprocess.run(
            [*shlex.split(command), "--parse", str(path)],
            check=True,
            stdout=subprocess.DEVNULL,
            env=ordinary_environment(),
        )
    cache = Path(os.environ.get("XDG_CACHE_HOME") or Path.home() / ".cache")
    home = Path(os.environ.get("SCENIC_REFERENCE_HOME") or cache / "scenic-reference-3.1.1")
    python = home / "bin" / "python"
    if not python.exists():
        raise SystemExit(f"the reference's Python is not {python}: set SCENIC_REFERENCE_HOME")
    return python


@contextmanager
def theirs(python: Path) -> Iterator[Driver]:
    """The reference's parser, in a process of its own."""
    driver = Driver([str(python), "-B", "-c", DRIVER], ordinary_environment(), Path(tempfile.gettempdir()))
    try:
        yield driver
    finally:
        driver.close()


# The texts.


def texts(accepted: Callable[[str], bool]) -> Iterator[tuple[str, str]]:
    """Name and text of what is parsed; small cases of tests are put together to larger texts."""
    for folder in ("examples", "benchmarks", "tests/data/recovery", "tests/data/checks"):
        for path in sorted((ROOT / folder).rglob("*.scenic")):
            yield path.relative_to(ROOT).as_posix(), path.read_text(encoding="utf-8")
    for path in sorted((ROOT / "tests/data/grammar").rglob("*.cases")):
        sources = [
            case.partition("\n")[2].partition("\n--\n")[0]
            for case in path.read_text(encoding="utf-8").split("\n== ")[1:]
        ]
        yield (
            path.relative_to(ROOT).as_posix(),
            "".join(f"{each}\n" for each in sources if accepted(f"{each}\n")),
        )
    for number, kind in enumerate((*KINDS, "mixed")):
        for lines in (100, 400, 1950) if kind == "mixed" else (120 + 40 * number, 800 + 200 * number):
            yield f"made up: {kind}", program(kind, lines, SEED)
    for name in MODULES:
        path = Path(sysconfig.get_path("stdlib")) / f"{name}.py"
        yield f"Python's {name}", path.read_text(encoding="utf-8")


def measured(turns: int, path: Path, mine: Driver, other: Driver | None) -> tuple[float, float | None] | None:
    """Median seconds of both, the ratio being that of the pairs; ``None`` if one refuses the text."""
    if mine.seconds(path) is None or (other is not None and other.seconds(path) is None):
        return None
    own, ratios = [], []
    for _ in range(turns):
        # Short runs of ours stand beside one long run of the other.
        seconds = statistics.median(mine.seconds(path) or 0.0 for _ in range(3))
        own.append(seconds)
        if other is not None:
            ratios.append((other.seconds(path) or 0.0) / seconds)
    return statistics.median(own), statistics.median(ratios) if ratios else None


def table_of_texts(turns: int, mine: Driver, other: Driver | None) -> None:
    """Print lines a second on all texts."""
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / "text.scenic"

        def accepted(text: str) -> bool:
            path.write_text(text, encoding="utf-8")
            return mine.seconds(path) is not None and (other is None or other.seconds(path) is not None)

        print(f"{'text':44} {'lines':>6} {'lines/s':>9} {'reference':>10} {'ratio':>7}")
        ratios, refused = [], []
        for name, text in texts(accepted):
            lines = text.count("\n")
            if not 50 <= lines <= 2000:
                continue
            path.write_text(text, encoding="utf-8")
            found = measured(turns, path, mine, other)
            if found is None:
                refused.append(name)
                continue
            seconds, ratio = found
            speed = lines / seconds
            row = f"{name:44} {lines:6} {speed:9,.0f}"
            if ratio is not None:
                ratios.append(ratio)
                row += f" {speed / ratio:10,.0f} {ratio:6.1f}x"
            print(row, flush=True)
        if ratios:
            print(f"{len(ratios)} texts: median {statistics.median(ratios):.1f}x, least {min(ratios):.1f}x")
        if refused:
            print(f"not parsed by both: {', '.join(refused)}")


def table_of_lengths(turns: int, mine: Driver) -> None:
    """Print the time of one kind of text as it grows."""
    print(f"\n{'lines':>7} {'seconds':>9} {'microseconds/line':>18}")
    times = {}
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / "text.scenic"
        for lines in LENGTHS:
            text = program("mixed", lines, SEED)
            path.write_text(text, encoding="utf-8")
            seconds = statistics.median(mine.seconds(path) or 0.0 for _ in range(turns))
            times[lines] = seconds
            print(f"{lines:>7} {seconds:>9.3f} {1e6 * seconds / text.count(chr(10)):>18.2f}", flush=True)
    doubled = [(lines, times[2 * lines] / times[lines]) for lines in LENGTHS if 2 * lines in times]
    print("twice the lines: " + ", ".join(f"{lines} {ratio:.2f}x the time" for lines, ratio in doubled))


def table_of_processes(turns: int, python: Path | None) -> None:
    """Print the time of whole processes, in turns."""
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / "short.scenic"
        text = "\n".join(program("scene", 40, SEED).splitlines()[1 : SHORT - 1])
        path.write_text(f"ego = new Object\n{text}\nnew Object at (20, 20, 20)\n", encoding="utf-8")
        commands = {
            "scenic check": (
                [sys.executable, "-m", "scenic.cli.main", "check", str(path)],
                {"PYTHONPATH": str(ROOT)},
            )
        }
        script = Path(sys.executable).with_name("scenic")
        if script.exists():
            commands["scenic check"] = ([str(script), "check", str(path)], {})
        commands["python -c pass"] = ([sys.executable, "-c", "pass"], {})
        if python is not None:
            commands["reference: import scenic"] = ([str(python), "-c", "import scenic"], {})
        times: dict[str, list[float]] = {name: [] for name in commands}
        for turn in range(turns + 1):
            for name, (command, more) in commands.items():
                start = time.perf_counter()
                done = subprocess.run(
                    command,
                    env={**ordinary_environment(), **more},
                    cwd=folder,
                    capture_output=True,
                    check=False,
                )
                seconds = time.perf_counter() - start
                if done.returncode > 1:
                    raise SystemExit(f"{name} failed\n{done.stderr.decode()}")
                if turn:  # the first one may compile modules
                    times[name].append(seconds)
    print(f"\nwhole processes ({SHORT} lines to check):")
    for name, each in times.items():
        print(f"{name:26} {statistics.median(each):.3f} s")
    if python is not None:
        ratio = statistics.median(times["scenic check"]) / statistics.median(
            times["reference: import scenic"]
        )
        print(f"`scenic check` takes {ratio:.3f} of the reference's time to be imported")


def main() -> None:
    """Print all tables."""
    description, _, epilog = (__doc__ or "").partition("\n")
    parser = argparse.ArgumentParser(
        prog="python -m benchmarks.parse",
        description=description,
        epilog=epilog,
        formatter_class=argparse.RawDescriptionHelpFormatter,
    )
    parser.add_argument(
        "--reference", metavar="PATH", help="another implementation to measure beside this one"
    )
    parser.add_argument("--turns", type=int, default=5)
    parser.add_argument("--child", action="store_true", help=argparse.SUPPRESS)
    options = parser.parse_args()
    if options.child:
        child()
        return
    print(f"Python {platform.python_version()}, {release('scenic-lang')}; {machine()}; {options.turns} turns")
    python = reference_python(options.reference) if options.reference else None
    if options.reference:
        print(f"reference: {options.reference}")
    print()
    with ours() as mine:
        if python is None:
            table_of_texts(options.turns, mine, None)
        else:
            with theirs(python) as other:
                table_of_texts(options.turns, mine, other)
        table_of_lengths(options.turns, mine)
    table_of_processes(2 * options.turns + 1, python)


if __name__ == "__main__":
    main()
