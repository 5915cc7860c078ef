"""Several processes beside one: ``python -m benchmarks.processes [--scenes N] [--turns T] [--dask] [PROGRAM]``.

Wall-clock seconds of ``scenic sample -n N -j 1``, of the same with ``-j 2``, and of two runs of half as many scenes side by side that
know nothing of each other: the most that two processes can give on the machine. With ``--dask`` also those of a Dask cluster of two
workers, which is there before. Medians of turns, by the clock on a quiet machine.

Beside them stands the processor time of all processes of a run, that of the cluster included, on a busy machine as well: what is
more than with ``-j 1`` is overhead, and bounds the gain. Run by hand; nothing here is a test.
"""

import argparse
import os
import resource
import statistics
import subprocess
import sys
import tempfile
import time
from pathlib import Path

HERE = Path(__file__).parent
TICK = os.sysconf("SC_CLK_TCK")


class Cluster:
    """A Dask cluster of two workers on this machine."""

    def __init__(self, folder: str) -> None:
        place = Path(folder) / "scheduler.json"
        common = ("--no-dashboard", "--scheduler-file", str(place))
        self._processes = [
            subprocess.Popen(
                [sys.executable, "-m", f"distributed.cli.dask_{name}", *common, *options],
                cwd=HERE.parent,
                stdout=subprocess.DEVNULL,
                stderr=subprocess.DEVNULL,
            )
            for name, options in (
                ("scheduler", ("--host", "127.0.0.1", "--port", "0")),
                *[("worker", ("--no-nanny", "--nthreads", "1"))] * 2,
            )
        ]
        from distributed import Client

        with Client(scheduler_file=str(place), set_as_default=False) as client:
            client.wait_for_workers(2, timeout=60)
            self.address: str = client.scheduler.address

    def spent(self) -> float:
        """Seconds of processor time so far."""
        fields = [
            Path(f"/proc/{process.pid}/stat").read_text().rpartition(")")[2].split()
            for process in self._processes
        ]
        return sum(int(item[11]) + int(item[12]) for item in fields) / TICK

    def stop(self) -> None:
        """End it."""
        for process in self._processes:
            process.kill()
            process.wait()


def seconds(program: str, runs: list[list[str]], cluster: Cluster | None = None) -> tuple[float, float]:
    """Time that commands take which begin together, and their processor time with that of the cluster."""
    with tempfile.TemporaryDirectory() as folder:
        before = 0.0 if cluster is None else cluster.spent()
        used = _of_children()
        start_time = time.perf_counter()
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
        took = time.perf_counter() - start_time
        return took, _of_children() - used + (0.0 if cluster is None else cluster.spent() - before)


def _of_children() -> float:
    """Processor time of all child processes that have ended, and of theirs."""
    usage = resource.getrusage(resource.RUSAGE_CHILDREN)
    return usage.ru_utime + usage.ru_stime


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument(
        "program", nargs="?", default=str(HERE.parent / "examples" / "indoor" / "desk.scenic")
    )
    parser.add_argument("--scenes", type=int, default=60_000)
    parser.add_argument("--turns", type=int, default=5)
    parser.add_argument("--dask", action="store_true", help="measure a Dask cluster of two workers, too")
    arguments = parser.parse_args()
    whole, half = ["-n", str(arguments.scenes)], ["-n", str(arguments.scenes // 2), "-j", "1"]
    runs: dict[str, tuple[list[list[str]], Cluster | None]] = {
        "-j 1": ([[*whole, "-j", "1"]], None),
        "-j 2": ([[*whole, "-j", "2"]], None),
        "two runs of half of it": ([half, half], None),
    }
    with tempfile.TemporaryDirectory() as folder:
        cluster = Cluster(folder) if arguments.dask else None
        try:
            if cluster is not None:
                runs["--dask, two workers"] = ([[*whole, "--dask", cluster.address]], cluster)
                seconds(arguments.program, *runs["--dask, two workers"])  # libraries are loaded
            turns = [
                {name: seconds(arguments.program, *run) for name, run in runs.items()}
                for _ in range(arguments.turns)
            ]
        finally:
            if cluster is not None:
                cluster.stop()
    print(f"{'':24} {'seconds':>8} {'times less':>10} {'processor':>10} {'overhead':>9} {'at most':>8}")
    for name in runs:
        took, seconds_spent = (statistics.median(turn[name][kind] for turn in turns) for kind in (0, 1))
        gain = statistics.median(turn["-j 1"][0] / turn[name][0] for turn in turns)
        more = statistics.median(turn[name][1] / turn["-j 1"][1] for turn in turns)
        bound = f"{2 / more:8.2f}" if name != "-j 1" else f"{'':8}"
        print(f"{name:24} {took:8.2f} {gain:10.2f} {seconds_spent:10.2f} {more - 1:9.1%} {bound}")


if __name__ == "__main__":
    main()
