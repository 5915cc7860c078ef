"""Several processes beside one: ``python -m benchmarks.processes [--scenes N] [--turns T] [PROGRAM]``.

Wall-clock seconds of ``scenic sample -n N -j 1``, of the same with ``-j 2``, and of two runs of half as many scenes side by side that
know nothing of each other: the most that two processes can give on the machine. Medians of turns. Run by hand on a quiet machine;
nothing here is a test.
"""

import argparse
import statistics
import subprocess
import sys
import tempfile
import time
from pathlib import Path

HERE = Path(__file__).parent


def seconds(program: str, runs: list[list[str]]) -> float:
    """Return the seconds until commands that start together have ended."""
    with tempfile.TemporaryDirectory() as folder:
        begun = time.perf_counter()
        started = [
            subprocess.Popen(
                [
                    *(sys.executable, "-m", "scenic.cli.main", "sample", program, "--seed", "1"),
                    *("-o", f"{folder}/{number}.jsonl", *options),
                ],
                cwd=HERE.parent,
                stderr=subprocess.PIPE,
                text=True,
            )
            for number, options in enumerate(runs)
        ]
        for process in started:
            _, told = process.communicate()
            if process.returncode:
                sys.exit(told)
        return time.perf_counter() - begun


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument(
        "program", nargs="?", default=str(HERE.parent / "examples" / "indoor" / "desk.scenic")
    )
    parser.add_argument("--scenes", type=int, default=60_000)
    parser.add_argument("--turns", type=int, default=5)
    arguments = parser.parse_args()
    whole, half = ["-n", str(arguments.scenes)], ["-n", str(arguments.scenes // 2), "-j", "1"]
    rows = [
        (
            seconds(arguments.program, [[*whole, "-j", "1"]]),
            seconds(arguments.program, [[*whole, "-j", "2"]]),
            seconds(arguments.program, [half, half]),
        )
        for _ in range(arguments.turns)
    ]
    one, two, apart = map(statistics.median, zip(*rows, strict=True))
    gain, limit = (statistics.median(row[0] / row[place] for row in rows) for place in (1, 2))
    print(
        f"-j 1 {one:.2f} s, -j 2 {two:.2f} s ({gain:.2f} times less), two runs of half of it {apart:.2f} s ({limit:.2f})"
    )


if __name__ == "__main__":
    main()
