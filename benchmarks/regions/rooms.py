"""Vacuum rooms with a safe zone about the robot, beside another implementation: ``python -m benchmarks.regions.rooms --reference PATH``.

PATH is called as in `benchmarks.compare`. Milliseconds of processor time (user and system) a scene, with 0, 4 and 16 toys: ours of
``sample(100)`` with its first call, in a process of its own; theirs the time of a process that samples ``--scenes`` scenes, less that
of a process that samples one, so that import, load and first scene are not counted.
"""

import argparse
import math
import os
import resource
import shlex
import statistics
import subprocess
import sys
import time
from pathlib import Path

SCENES = 100
ROOMS = ("vacuum_room", "safe_zone")
TOYS = (0, 4, 16)


def child(room: str, toys: int) -> None:
    """Run in a fresh process: print our milliseconds a scene."""
    import scenic

    scenario = scenic.scenarioFromFile(_path(room), params={"toys": toys})
    begun = time.process_time()
    scenario.sample(SCENES, seed=1)
    print((time.process_time() - begun) / SCENES * 1e3)


def _path(room: str) -> str:
    return str(Path(__file__).parent / f"{room}.scenic")


def ours(room: str, toys: int) -> float:
    """Milliseconds a scene in a fresh process."""
    command = [sys.executable, "-m", "benchmarks.regions.rooms", "--child", room, str(toys)]
    done = subprocess.run(command, capture_output=True, text=True, check=True)
    return float(done.stdout)


def theirs(command: str, room: str, toys: int, scenes: int, seed: int) -> float:
    """Milliseconds a scene of the other implementation, all but the first."""
    arguments = [*shlex.split(command), _path(room), "--seed", str(seed), "--param", f"toys={toys}"]
    arguments += ["--max-iterations", "1000000", "--observe", "x=1"]
    # The other implementation may have our import name: it must not find our tree.
    environment = {name: value for name, value in os.environ.items() if name != "PYTHONPATH"}
    seconds_spent = []
    for count in (1, scenes):
        before = _spent_by_children()
        subprocess.run([*arguments, "-n", str(count)], capture_output=True, check=True, env=environment)
        seconds_spent.append(_spent_by_children() - before)
    return (seconds_spent[1] - seconds_spent[0]) / (scenes - 1) * 1e3


def _spent_by_children() -> float:
    used = resource.getrusage(resource.RUSAGE_CHILDREN)
    return used.ru_utime + used.ru_stime


def main() -> None:
    """Print the table."""
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("--reference", metavar="PATH", help="command of the other implementation")
    parser.add_argument("--turns", type=int, default=1)
    parser.add_argument("--scenes", type=int, default=20, help="how many the reference samples in a turn")
    parser.add_argument("--room", action="append", choices=ROOMS, help="only this one; repeatable")
    parser.add_argument("--child", nargs=2, help=argparse.SUPPRESS)
    options = parser.parse_args()
    if options.child:
        child(options.child[0], int(options.child[1]))
        return
    for room in options.room or ROOMS:
        for toys in TOYS:
            mine, other = [], []
            for turn in range(options.turns):
                if options.reference:
                    other.append(theirs(options.reference, room, toys, options.scenes, turn))
                mine.append(ours(room, toys))
            reference = statistics.fmean(other) if other else math.nan
            own = statistics.median(mine)
            print(
                f"{room:12} {toys:2} toys {own:8.2f}ms {reference:9.1f}ms {reference / own:6.0f}x", flush=True
            )


if __name__ == "__main__":
    main()
