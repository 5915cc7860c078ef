"""Overhead of handing out work to many workers: ``python -m benchmarks.scheduling [--workers N] [--seconds S] [--dask]``.

A job goes through all that scenes go through: it is cut into pieces, which are handed out, collected, put in order and written to a
file. In place of sampling the workers sleep, a hundredth of a second for each scene. Workers are threads of this
process, or with ``--dask`` threads of the worker process of a Dask cluster, which together need little of a processor.

Prints the overhead (the time beyond that of workers who never wait), the processor time of this process with the number of pieces that it
could handle in a second, and the peak of memory. With
``--straggler`` scene 0 takes half of the time of the run: what waits for it is limited, and so is the memory. Run by hand;
nothing here is a test.
"""

import argparse
import contextlib
import json
import resource
import subprocess
import sys
import tempfile
import time
from collections.abc import Iterator, Sequence
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass
from functools import partial
from pathlib import Path
from types import SimpleNamespace
from typing import Any

from scenic.batch.engines import BatchEngine, DaskCluster, OverExecutor
from scenic.batch.scenes import Job, in_processes

COST = 0.01
"""Seconds that a scene takes."""


@dataclass(frozen=True)
class Sleeper:
    """A scenario that sleeps in place of sampling; scene 0 takes ``straggle`` seconds more."""

    straggle: float = 0.0

    def stream(self, n: int, *, first: int, **_: Any) -> Iterator[SimpleNamespace]:
        """Scenes that have no content."""
        time.sleep(n * COST + (self.straggle if first == 0 else 0.0))
        for k in range(first, first + n):
            yield SimpleNamespace(k=k, attempts=1)


def encode(size: int, _: Sleeper, scenes: Sequence[Any]) -> bytes:
    """So many bytes for each scene."""
    return b"x" * (size * len(scenes))


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--workers", type=int, default=200)
    parser.add_argument("--seconds", type=float, default=20.0, help="what the run takes without overhead")
    parser.add_argument("--bytes", type=int, nargs="+", default=[100, 2000], help="of a scene")
    parser.add_argument("--dask", action="store_true")
    parser.add_argument("--straggler", action="store_true")
    arguments = parser.parse_args()
    with _engine(arguments.workers, dask=arguments.dask) as engine:
        _measured(engine, arguments.workers, 1.0, 10, 0.0)  # threads start, connections are made
        for size in arguments.bytes:
            straggle = arguments.seconds / 2 if arguments.straggler else 0.0
            print(_measured(engine, arguments.workers, arguments.seconds, size, straggle), flush=True)


@contextlib.contextmanager
def _engine(workers: int, *, dask: bool) -> Iterator[BatchEngine]:
    if not dask:
        with ThreadPoolExecutor(workers) as executor:
            yield OverExecutor(executor, workers)
        return
    with tempfile.TemporaryDirectory() as folder, contextlib.ExitStack() as stack:
        place = Path(folder) / "scheduler.json"
        common = ("--no-dashboard", "--scheduler-file", str(place))
        for name, options in (
            ("dask_scheduler", ("--host", "127.0.0.1", "--port", "0")),
            ("dask_worker", ("--no-nanny", "--nthreads", str(workers))),
        ):
            process = subprocess.Popen(
                [sys.executable, "-m", f"distributed.cli.{name}", *common, *options],
                stderr=subprocess.DEVNULL,
                stdout=subprocess.DEVNULL,
            )
            stack.callback(process.wait)
            stack.callback(process.kill)
            while not place.exists():
                time.sleep(0.1)
        cluster = stack.enter_context(DaskCluster(_address(place)))
        while cluster.jobs < workers:
            time.sleep(0.5)
        yield cluster


def _address(place: Path) -> str:
    return str(json.loads(place.read_text())["address"])


def _measured(engine: BatchEngine, workers: int, seconds: float, size: int, straggle: float) -> str:
    from benchmarks import scheduling  # workers of other processes do not know `__main__`

    count = int(workers * seconds / COST)
    job = Job(seed=1, first=0, last=count, max_attempts=None, deadline=None)
    scenario: Any = scheduling.Sleeper(straggle)
    pieces = done = 0
    start_time = time.perf_counter()
    seconds_spent = time.process_time()
    with tempfile.TemporaryFile() as file:
        for made in in_processes(scenario, partial(scheduling.encode, size), job, engine):
            file.write(memoryview(made.encoded))
            file.flush()
            pieces += 1
            done = made.job.last
    took, seconds_spent = time.perf_counter() - start_time, time.process_time() - seconds_spent
    assert done == count
    peak = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 1024
    return (
        f"{workers} workers, {count:,} scenes of {size:,} bytes in {pieces:,} pieces: {took:.2f} s, overhead {took / seconds - 1:.1%}; "
        f"{seconds_spent / pieces * 1000:.2f} ms of processor time a piece (up to {pieces / seconds_spent:,.0f} pieces/s), peak memory {peak:.0f} MiB"
    )


if __name__ == "__main__":
    main()
