"""Effect of analysis on the distributions: ``python -m benchmarks.narrowing [--reference PATH]``.

For each program in ``narrowing/``: candidates a scene with the distributions narrowed before sampling and without, and milliseconds a
scene (load not included), beside another implementation, called as in `benchmarks.compare`, that gets half a minute for ten scenes.
Run by hand on a quiet machine; nothing here is a test.
"""

import argparse
import json
import shlex
import statistics
import subprocess
import time
from pathlib import Path

import scenic
from scenic.graph.domain import Domain
from scenic.language.errors import RejectionException

HERE = Path(__file__).parent
SCENES = 500
THEIRS = 10
PATIENCE = 30


def ours(path: Path, *, prune: bool) -> tuple[float, float] | None:
    """Candidates and milliseconds a scene; ``None`` if 100,000 candidates were too few for one of them."""
    scenario = scenic.scenarioFromFile(str(path))
    if not prune:
        scenario = scenario.within(Domain.whole(scenario.outline.graph.dimension))
    start_time = time.perf_counter()
    try:
        scenes = scenario.sample(SCENES, seed=1)
    except RejectionException:
        return None
    seconds_spent = time.perf_counter() - start_time
    return statistics.fmean(scene.attempts for scene in scenes), seconds_spent / SCENES * 1e3


def theirs(command: str, path: Path) -> float | None:
    """Milliseconds a scene; ``None`` if it found none."""
    arguments = [*shlex.split(command), str(path), "-n", str(THEIRS), "--seed", "1", "--time"]
    try:
        shown = subprocess.run(
            arguments, capture_output=True, text=True, check=False, timeout=PATIENCE
        ).stdout
    except subprocess.TimeoutExpired as late:
        shown = (late.stdout or b"").decode()
    rows = [json.loads(line) for line in shown.splitlines() if line.startswith("{")]
    seconds = [row["seconds"] for row in rows if "seconds" in row]
    return statistics.fmean(seconds) * 1e3 if seconds else None


def shown(number: float | None, form: str) -> str:
    return "none" if number is None else format(number, form)


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--reference", help="command of the other implementation")
    arguments = parser.parse_args()
    print(f"{'program':20} {'candidates':>10} {'unpruned':>10} {'ms':>8} {'unpruned':>10} {'reference':>10}")
    for path in sorted((HERE / "narrowing").glob("*.scenic")):
        narrowed, whole = ours(path, prune=True) or (None, None), ours(path, prune=False) or (None, None)
        other = theirs(arguments.reference, path) if arguments.reference else None
        print(
            f"{path.stem:20} {shown(narrowed[0], '10.2f')} {shown(whole[0], '.1f'):>10} {shown(narrowed[1], '8.4f')}"
            f" {shown(whole[1], '.3f'):>10} {shown(other, '.1f'):>10}",
            flush=True,
        )


if __name__ == "__main__":
    main()
