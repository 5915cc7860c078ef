"""Kills of ``scenic sample -o FOLDER/ --resume`` at random moments, with a second writer beside it in half of them.

Usage: ``python -m benchmarks.kills [COUNT [SEED]]``. Each round kills a command several times, ends it once, and compares the folder, byte
for byte, with one that nothing has interrupted. The second writer has another seed, or the same command; it must never end with exit
code 0 unless it is the same command and nobody writes. Prints the counts, and exits with 1 at the first fault.
"""

import random
import subprocess
import sys
import tempfile
import time
from collections import Counter
from pathlib import Path

PROGRAM = """
import time
def wait(v):
    time.sleep(0.004)
    return v < 0.7
ego = new Object with foo Range(0, 1)
require wait(ego.foo)
"""

ROUND = 10
"""Kills until a command is let end."""


def command(program: Path, folder: Path, *more: str) -> list[str]:
    """Return the words of a command that makes a data set of 90 scenes."""
    words = [
        sys.executable,
        "-m",
        "scenic",
        "sample",
        str(program),
        "-n",
        "90",
        "--format",
        "jsonl",
        "--part-size",
        "20",
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
        for number in range(count):
            jobs = str(rng.choice([1, 2]))
            first = subprocess.Popen(
                command(program, folder, "--seed", "5", "--resume", "-j", jobs),
                stdout=subprocess.DEVNULL,
                stderr=subprocess.DEVNULL,
            )
            second = None
            if number % 2:
                other = rng.random() < 0.5
                second = subprocess.Popen(
                    command(program, folder, "--seed", "6" if other else "5", "--resume"),
                    stdout=subprocess.DEVNULL,
                    stderr=subprocess.PIPE,
                    text=True,
                )
            time.sleep(rng.uniform(0.3, 3.0))
            first.kill()
            first.wait()
            counts["kills"] += 1
            if second is not None:
                second.kill() if rng.random() < 0.5 else None
                _, said = second.communicate()
                if "SC614" in said:
                    counts["second writer refused: locked"] += 1
                elif "SC612" in said:
                    counts["second writer refused: another data set"] += 1
                else:
                    counts[f"second writer: exit code {second.returncode}"] += 1
                if other and second.returncode == 0:
                    # It may have been first in an empty folder; then the rest belongs to its seed.
                    counts["folders of the other seed"] += 1
                    finish(program, folder, "6")
                    clear(folder)
                    continue
            if number % ROUND == ROUND - 1:
                seeds = ["5", "6"] if folder.exists() and (folder / "manifest.json").exists() else ["5"]
                if any(finish(program, folder, chosen) and chosen == "5" for chosen in seeds):
                    if contents(folder) != expected:
                        raise SystemExit(f"kill {number}: the folder differs: {sorted(contents(folder))}")
                    counts["the same bytes"] += 1
                clear(folder)
    return counts


def finish(program: Path, folder: Path, seed: str) -> bool:
    """Let a command end, and verify its folder; return whether it fits the folder."""
    done = subprocess.run(
        command(program, folder, "--seed", seed, "--resume"), capture_output=True, text=True, check=False
    )
    if done.returncode != 0:
        if "SC612" not in done.stderr:
            raise SystemExit(done.stderr)
        return False
    verified = subprocess.run(
        [sys.executable, "-m", "scenic", "dataset", "verify", str(folder), "--share", "10%"],
        capture_output=True,
        text=True,
        check=False,
    )
    if verified.returncode != 0:
        raise SystemExit(verified.stdout + verified.stderr)
    return True


def clear(folder: Path) -> None:
    """Remove the files of a folder."""
    for path in folder.iterdir() if folder.exists() else ():
        path.unlink()


if __name__ == "__main__":
    numbers = [int(word) for word in sys.argv[1:3]]
    for what, times in sorted(campaign(*[*numbers, *[110, 1][len(numbers) :]]).items()):
        print(f"{what}: {times}")
