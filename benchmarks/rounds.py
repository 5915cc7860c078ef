"""Cost of a round of the engine, by lanes: ``python -m benchmarks.rounds [PROGRAM ...]``.

A round takes so many candidates through all checks. Without programs: ten and a hundred boxes in a cube, a desk, and the
furnished room with toys. Prints milliseconds of processor time, medians of repeated rounds after the first ones, and with
``--memory`` the most memory that a process took for one round of 4,096 lanes with 200 boxes.
"""

import argparse
import statistics
import subprocess
import sys
import time
from pathlib import Path
from typing import Any

from scenic.runtime.sampling.engine import Engine
from scenic.runtime.sampling.pace import Round
from scenic.runtime.sampling.pending import Pending

HERE = Path(__file__).parent
LANES = (16, 64, 256, 4096)
SETTLING = 4
"""Rounds that are not counted: plans are made in them."""


def boxes(count: int, side: float) -> str:
    """A program of unit boxes that face the middle of a cube."""
    return (
        f"workspace = Workspace(BoxRegion(dimensions=({side}, {side}, {side})))\n"
        f"for _ in range({count}):\n    new Object in workspace, facing directly toward (0, 0, 0)\n"
    )


class OfSize:
    """A pace that never changes."""

    def __init__(self, lanes: int) -> None:
        self.most = lanes

    def choose(self, *_arguments: Any, **_options: Any) -> Round:
        return Round(self.most, 1)

    def add(self, *_arguments: Any) -> None:
        """Nothing is learned."""


def milliseconds(engine: Engine, lanes: int, rounds: int) -> float:
    """The median of a round's cost."""
    inner: Any = engine
    inner._pace = OfSize(lanes)
    times = []
    for seed in range(rounds + SETTLING):
        pending = Pending(inner._chances, inner._soft_places)
        pending.add([(seed, number) for number in range(lanes)])
        start_time = time.thread_time()
        inner._round(pending, {}, 10**6, lanes, lanes, more=False)
        times.append(time.thread_time() - start_time)
    return statistics.median(times[SETTLING:]) * 1e3


def memory() -> float:
    """Mebibytes that a process has taken at most."""
    lines = Path("/proc/self/status").read_text().splitlines()
    return next(int(line.split()[1]) for line in lines if line.startswith("VmHWM")) / 1024


def main() -> None:
    import scenic

    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("programs", nargs="*", type=Path)
    parser.add_argument("--memory", action="store_true")
    parser.add_argument("--child", action="store_true", help=argparse.SUPPRESS)
    arguments = parser.parse_args()
    if arguments.child:
        before = memory()
        engine = scenic.scenarioFromString(boxes(200, 300))._sampler.engine
        milliseconds(engine, LANES[-1], 1)
        print(
            f"200 boxes, {LANES[-1]} lanes: {memory():.0f} MiB, {before:.0f} of them before anything is loaded"
        )
        return
    if arguments.memory:
        subprocess.run([sys.executable, "-m", "benchmarks.rounds", "--child"], check=True)
        return
    scenarios = {str(path): scenic.scenarioFromFile(path) for path in arguments.programs} or {
        "10 boxes": scenic.scenarioFromString(boxes(10, 100)),
        "100 boxes": scenic.scenarioFromString(boxes(100, 215)),
        "desk": scenic.scenarioFromFile(HERE.parent / "examples" / "indoor" / "desk.scenic"),
        "room": scenic.scenarioFromFile(HERE / "room_with_toys.scenic"),
    }
    print(f"{'':24}" + "".join(f"{lanes:>9}" for lanes in LANES))
    for name, scenario in scenarios.items():
        costs = [
            milliseconds(scenario._sampler.engine, lanes, 12 if lanes < LANES[-1] else 5) for lanes in LANES
        ]
        print(f"{name:24}" + "".join(f"{cost:9.2f}" for cost in costs), flush=True)


if __name__ == "__main__":
    main()
