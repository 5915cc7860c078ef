"""Steps of driving programs beside another implementation: ``python -m benchmarks.driving_steps --scenic COMMAND``.

COMMAND is the other one's own command line, such as ``ENVIRONMENT/bin/scenic``. The programs of ``examples/driving`` for the built-in
simulator are simulated in 2D mode by both, with what is replaced in `benchmarks.driving`. The table shows milliseconds a step, of the
least of `--turns` runs, in turns, and the ratio; the last line their geometric mean. Loading and sampling do not count. The other one draws
each step by default, which `--render` leaves so. Run by hand; nothing here is a test.
"""

import argparse
import math
import os
import random
import re
import statistics
import subprocess
import tempfile
import time
from pathlib import Path
from typing import Final

import scenic
from benchmarks.driving import prepared

ENDED: Final = re.compile(r"at time step (\d+) because.*?Ran simulation in ([\d.]+) seconds", re.DOTALL)


def theirs(command: str, path: Path, steps: int) -> float | None:
    """Seconds a step of the other implementation; ``None`` if it does not run the program."""
    given = ["--simulate", "--count", "1", "--time", str(steps), "--2d", "--seed", "1", "-v", "2"]
    environment = {key: value for key, value in os.environ.items() if key != "PYTHONPATH"}
    done = subprocess.run(
        [command, str(path), *given],
        capture_output=True,
        text=True,
        timeout=300,
        env={**environment, "SDL_VIDEODRIVER": "dummy"},
        check=False,
    )
    found = ENDED.search(done.stdout + done.stderr)
    return None if found is None else float(found[2]) / int(found[1])


def ours(path: Path, steps: int) -> float:
    """Seconds a step of ours."""
    scenario = scenic.scenarioFromFile(str(path), mode2D=True)
    scene, simulator = scenario.sample(1, seed=1)[0], scenario.getSimulator()
    seconds = []
    for _ in range(3):  # the first one imports and plans
        random.seed(1)
        begun = time.perf_counter()
        done = simulator.simulate(scene, maxSteps=steps)
        assert done is not None
        seconds.append((time.perf_counter() - begun) / done.currentTime)
    return min(seconds)


def main() -> None:
    """Print the table."""
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("--scenic", required=True, help="command of the other implementation")
    parser.add_argument("--steps", type=int, default=200)
    parser.add_argument("--turns", type=int, default=2)
    parser.add_argument("--render", action="store_true", help="let the other one draw")
    given = parser.parse_args()
    ratios = []
    with tempfile.TemporaryDirectory() as folder:
        for path in prepared(Path(folder)):
            text = path.read_text(encoding="utf-8")
            if "newtonian" not in text:
                continue
            path.write_text(("" if given.render else "param render = False\n") + text, encoding="utf-8")
            pairs = [
                (theirs(given.scenic, path, given.steps), ours(path, given.steps)) for _ in range(given.turns)
            ]
            other = min((first for first, _ in pairs if first is not None), default=None)
            own = min(second for _, second in pairs)
            if other is None:
                print(f"{path.stem:20} does not run in the other one", flush=True)
                continue
            ratios.append(other / own)
            print(f"{path.stem:20} {other * 1e3:8.2f} {own * 1e3:8.3f} {other / own:7.1f}", flush=True)
    mean = math.exp(statistics.fmean(map(math.log, ratios)))
    print(f"{'mean':38} {mean:7.1f}, least {min(ratios):.1f}")


if __name__ == "__main__":
    main()
