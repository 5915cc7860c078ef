"""Kills of ``scenic sample -o FOLDER/ --resume`` at random moments, with a second writer beside it in half of them.

Usage: ``python -m benchmarks.kills [COUNT [SEED]]``. Each round kills a command several times, ends it once, and compares the folder, byte
for byte, with one that nothing has interrupted. The second writer has another seed, or is the same command; it starts when the first has
the lock, which is killed after the second has been refused or has ended. Prints the counts, and exits with 1 at the first fault.
"""

import json
import random
import subprocess
import sys
import tempfile
import time
from collections import Counter
from contextlib import suppress
from pathlib import Path

PROGRAM = """
import time
def wait(v):
    time.sleep(0.006)
    return v < 0.7
ego = new Object with foo Range(0, 1)
require wait(ego.foo)
"""

ROUND = 10
"""Kills until a command is let end."""


def command(program: Path, folder: Path, *more: str) -> list[str]:
    """Return the words of a command that makes a data set of 1,500 scenes in some 13 seconds."""
    words = [
        sys.executable,
        "-m",
        "scenic",
        "sample",
        str(program),
        "-n",
        "1500",
        "--format",
        "jsonl",
        "--part-size",
        "200",
    ]
    return [*words, "-o", f"{folder}/", *more]


def contents(folder: Path) -> dict[str, bytes]:
    """Return the files of a data set but its manifest, which holds times."""
    return {
        path.name: path.read_bytes()
        for path in folder.iterdir()
        if path.name not in ("manifest.json", ".lock")
    }


def campaign(count: int, seed: int) -> Counter[str]:
    """Return the number of kills, of refusals of the second writer, and of rounds that came to the same bytes."""
    rng = random.Random(seed)
    counts: Counter[str] = Counter()
    with tempfile.TemporaryDirectory() as name:
        place = Path(name)
        program = place / "slow.scenic"
        program.write_text(PROGRAM)
        subprocess.run(command(program, place / "whole", "--seed", "5"), check=True, capture_output=True)
        expected = contents(place / "whole")
        folder = place / "killed"
        while counts["kills"] < count:
            number = counts["kills"]
            jobs = str(rng.choice([1, 2]))
            first = subprocess.Popen(
                command(program, folder, "--seed", "5", "--resume", "-j", jobs),
                stdout=subprocess.DEVNULL,
                stderr=subprocess.DEVNULL,
            )
            if number % 2 and holds(first, folder):
                counts[f"second writer {second_writer(program, folder, first, rng.choice('56'))}"] += 1
            else:
                time.sleep(rng.uniform(0.3, 3.0))
            has_ended = first.poll() is not None
            first.kill()
            first.wait()
            counts["ended before the kill" if has_ended else "kills"] += 1
            if has_ended or number % ROUND == ROUND - 1:
                finish(program, folder)
                if contents(folder) != expected:
                    raise SystemExit(f"kill {number}: the folder differs: {sorted(contents(folder))}")
                counts["the same bytes"] += 1
                clear(folder)
    return counts


def holds(process: "subprocess.Popen[bytes]", folder: Path) -> bool:
    """Wait until a process has written its name into the lock of a folder; return whether it has before its end."""
    while process.poll() is None:
        with suppress(OSError, ValueError):
            if json.loads((folder / ".lock").read_bytes())["process"] == process.pid:
                return True
        time.sleep(0.005)
    return False


def second_writer(program: Path, folder: Path, first: "subprocess.Popen[bytes]", seed: str) -> str:
    """Run a second command while a first one writes; return how it ended. Its end without a refusal is a fault while the first lives."""
    second = subprocess.run(
        command(program, folder, "--seed", seed, "--resume"), capture_output=True, text=True, check=False
    )
    has_ended = first.poll() is not None
    if second.returncode == 0 and not (has_ended and seed == "5"):
        raise SystemExit(f"a second writer with seed {seed} has written beside the first one")
    if "SC615" in second.stderr and f"process {first.pid} on " in second.stderr:
        return "refused: the first one holds the lock"
    if "SC612" in second.stderr and has_ended:
        return "refused after the end of the first one: another data set"
    if second.returncode == 0:
        return "went on after the end of the first one"
    raise SystemExit(second.stderr)


def finish(program: Path, folder: Path) -> None:
    """Let a command end, and verify its folder."""
    done = subprocess.run(
        command(program, folder, "--seed", "5", "--resume"), capture_output=True, text=True, check=False
    )
    if done.returncode != 0:
        raise SystemExit(done.stderr)
    verified = subprocess.run(
        [sys.executable, "-m", "scenic", "dataset", "verify", str(folder), "--share", "10%"],
        capture_output=True,
        text=True,
        check=False,
    )
    if verified.returncode != 0:
        raise SystemExit(verified.stdout + verified.stderr)


def clear(folder: Path) -> None:
    """Remove the files of a folder."""
    for path in folder.iterdir() if folder.exists() else ():
        path.unlink()


if __name__ == "__main__":
    numbers = [int(word) for word in sys.argv[1:3]]
    for what, times in sorted(campaign(*[*numbers, *[110, 1][len(numbers) :]]).items()):
        print(f"{what}: {times}")
