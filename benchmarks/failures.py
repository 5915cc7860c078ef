"""Data sets after failures, beside undisturbed runs: ``python -m benchmarks.failures [--kills N] [--few N] [--only NAME...]``.

Runs the commands for real and kills a worker, the command itself or the scheduler of a Dask cluster with SIGKILL, at moments drawn from a
seed. Then the command is given again with ``--resume``, and the bytes of all files are compared with those of a run with
``-j 1`` that nothing disturbed. The other cases are full disks (a small ``tmpfs``, which needs the rights to mount it) and
workers with another version of the package, or with other code of the same version. Linux alone.

Prints a row for each case: kills, runs that went on by themselves, codes of the errors, equal folders. A trial that differs is
described below the table, and the exit code is 1.
"""

import argparse
import contextlib
import hashlib
import json
import os
import random
import re
import shutil
import signal
import subprocess
import sys
import tempfile
import time
from collections import Counter
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import Final

HERE: Final = Path(__file__).resolve().parent
EXAMPLES: Final = HERE.parent / "examples"
SIZE: Final = ("--image-size", "160x120")

CAMERA: Final = (
    "sample",
    str(EXAMPLES / "sensors" / "surveillance.scenic"),
    "--seed",
    "1",
    "--camera",
    "ego",
)

JOBS: Final = {
    "parquet": ("sample", str(EXAMPLES / "indoor" / "desk.scenic"), "--seed", "1", "-n", "16000", "--part-size", "4000"),
    "jsonl": (
        *("sample", str(EXAMPLES / "indoor" / "desk.scenic"), "--seed", "1", "-n", "12000", "--part-size", "5000"),
        *("--format", "jsonl"),
    ),
    "images": (*CAMERA, *SIZE, "-n", "30", "--part-size", "9"),
    "tar": (*CAMERA, *SIZE, "-n", "30", "--part-size", "9", "--format", "tar"),
    "simulations": ("simulate", str(EXAMPLES / "driving" / "bypassing.scenic"), "--seed", "1", "-n", "12"),
}  # fmt: skip
"""Commands without engine and output, by what they make."""

PATIENCE: Final = 240
"""Seconds after which a command counts as stuck."""

TRIES: Final = 8
"""Runs that may end before the moment of a kill, until the kill is given up."""


@dataclass
class Ended:
    """The end of a command: its exit code and what it wrote to its error stream."""

    code: int | str
    told: str

    @property
    def diagnosed(self) -> str:
        """The code of the error, or the last line where there is none."""
        found = re.findall(r"\b(?:error|warning)\[?\s*(SC\d+)|\b(SC\d{3})\b", self.told)
        return (
            (found[0][0] or found[0][1])
            if found
            else (self.told.strip().splitlines() or ["nothing told"])[-1]
        )


class Command:
    """A command of the package, under way in a session of its own."""

    def __init__(self, arguments: Sequence[str], output: Path, *more: str) -> None:
        self._told = tempfile.TemporaryFile("w+")  # noqa: SIM115 - `end` closes it
        self.process = subprocess.Popen(
            [sys.executable, "-m", "scenic", *arguments, "-o", f"{output}/", *more],
            cwd=HERE.parent,
            stdout=subprocess.DEVNULL,
            stderr=self._told,
            start_new_session=True,
        )

    def end(self) -> Ended:
        """Wait for the end."""
        try:
            code: int | str = self.process.wait(PATIENCE)
        except subprocess.TimeoutExpired:
            self.process.kill()
            code = "stuck"
        self._told.seek(0)
        output = self._told.read()
        self._told.close()
        return Ended(code, output)

    def workers(self) -> list[int]:
        """Its child processes."""
        return children(self.process.pid)

    def orphans(self) -> list[int]:
        """The processes of its session that are left a while after its end."""
        for _ in range(50):
            left = [pid for pid in processes() if session(pid) == self.process.pid]
            if not left:
                return []
            time.sleep(0.1)
        return left


def processes() -> list[int]:
    """All processes."""
    return [int(path.name) for path in Path("/proc").iterdir() if path.name.isdigit()]


def children(pid: int) -> list[int]:
    """The child processes of a process; none if it has ended."""
    try:
        return [int(word) for word in Path(f"/proc/{pid}/task/{pid}/children").read_text().split()]
    except OSError:
        return []


def session(pid: int) -> int | None:
    """The session of a process that has not ended."""
    try:
        rest = Path(f"/proc/{pid}/stat").read_text().rpartition(")")[2].split()
    except OSError:
        return None
    return None if rest[0] == "Z" else int(rest[3])


class Cluster:
    """A Dask scheduler and two workers of one thread, as processes of this machine."""

    def __init__(self, folder: Path, *, path: Sequence[Path] = ()) -> None:
        self._folder = folder
        self._path = path
        """Folders that the second worker finds packages in first."""
        self._file = folder / f"scheduler-{len(path)}.json"
        self.scheduler: subprocess.Popen[bytes] | None = None
        self.workers: list[subprocess.Popen[bytes]] = []

    @property
    def address(self) -> str:
        """The address of the scheduler, after `mend`."""
        return str(json.loads(self._file.read_text())["address"])

    def mend(self) -> None:
        """Start what is not running."""
        if self.scheduler is None or self.scheduler.poll() is not None:
            self.stop()
            self._file.unlink(missing_ok=True)
            self.scheduler = self._started(
                "dask_scheduler", "--host", "127.0.0.1", "--port", "0", "--no-show"
            )
            while not self._file.exists():
                time.sleep(0.1)
        alive = [worker for worker in self.workers if worker.poll() is None]
        alive += [
            self._started("dask_worker", "--no-nanny", "--nthreads", "1", path=self._path[:number])
            for number in range(len(alive), 2)
        ]
        self.workers = alive
        self._wait()

    def _wait(self) -> None:
        from distributed import Client

        with Client(self.address, set_as_default=False) as client:
            client.wait_for_workers(2, timeout=60)

    def _started(self, name: str, *options: str, path: Sequence[Path] = ()) -> "subprocess.Popen[bytes]":
        return subprocess.Popen(
            [
                *(
                    sys.executable,
                    "-m",
                    f"distributed.cli.{name}",
                    "--no-dashboard",
                    "--scheduler-file",
                    str(self._file),
                ),
                *options,
            ],
            cwd=self._folder,
            env={**os.environ, "PYTHONPATH": os.pathsep.join(map(str, [*path, HERE.parent]))},
            stdout=subprocess.DEVNULL,
            stderr=subprocess.DEVNULL,
        )

    def stop(self) -> None:
        """End all of it."""
        for process in (*self.workers, self.scheduler):
            if process is not None:
                process.kill()
                process.wait()
        self.workers, self.scheduler = [], None


@dataclass
class Case:
    """The results of the trials of a case."""

    name: str
    kills: int = 0
    alone: int = 0
    """Runs that ended well without a second command."""
    equal: int = 0
    codes: Counter[str] = field(default_factory=Counter)
    faults: list[str] = field(default_factory=list)

    def row(self) -> str:
        """The row of the table."""
        codes = ", ".join(f"{code} {count}" for code, count in sorted(self.codes.items())) or "-"
        return f"{self.name:34} {self.kills:5d} {self.alone:5d}  {codes:24} {self.equal:5d}"


def content(folder: Path) -> dict[str, str]:
    """Digests of all files of a folder; of the manifest without what differs between runs."""
    digests = {}
    for path in sorted(folder.rglob("*")):
        if not path.is_file():
            continue
        data = path.read_bytes()
        if path.name == "manifest.json":
            document = json.loads(data)
            for name in ("seconds", "command", "source"):
                document.pop(name)
            data = json.dumps(document, sort_keys=True).encode()
        digests[str(path.relative_to(folder))] = hashlib.sha256(data).hexdigest()
    return digests


def differences(found: dict[str, str], wanted: dict[str, str]) -> list[str]:
    """Differences between the files that were found and those that are wanted."""
    return [
        *(f"{name} is missing" for name in wanted if name not in found),
        *(f"{name} is left over" for name in found if name not in wanted),
        *(f"{name} differs" for name in wanted if name in found and found[name] != wanted[name]),
    ]


class Trials:
    """Runs that are disturbed, each compared with one that is not."""

    def __init__(self, folder: Path, seed: int) -> None:
        self._folder = folder
        self._random = random.Random(seed)
        self._wanted: dict[str, dict[str, str]] = {}
        self.cluster = Cluster(folder)
        self.cases: list[Case] = []

    def wanted(self, job: str) -> dict[str, str]:
        """The files of an undisturbed run."""
        if job not in self._wanted:
            place = self._folder / f"{job}-undisturbed"
            ended = Command(JOBS[job], place, "-j", "1").end()
            if ended.code != 0:
                sys.exit(f"{job}: {ended.told}")
            self._wanted[job] = content(place)
        return self._wanted[job]

    def case(self, name: str) -> Case:
        """A new case."""
        self.cases.append(Case(name))
        return self.cases[-1]

    def engine(self, name: str) -> tuple[str, ...]:
        """The options of an engine, which is there after this."""
        if name == "-j 2":
            return ("-j", "2")
        self.cluster.mend()
        return ("--dask", self.cluster.address)

    def kills(self, job: str, engine: str, victim: str, count: int) -> None:
        """Kill ``victim`` in ``count`` runs."""
        case = self.case(f"{job}, {engine}: {victim}")
        self.wanted(job)
        begun = time.monotonic()
        self._undisturbed(job, engine, case)
        length = time.monotonic() - begun
        for _ in range(count):
            length = self._kill(job, engine, victim, length, case)
        print(case.row(), flush=True)

    def _undisturbed(self, job: str, engine: str, case: Case) -> None:
        place = self._fresh()
        ended = Command(JOBS[job], place, *self.engine(engine)).end()
        case.faults += [f"undisturbed: {what}" for what in differences(content(place), self.wanted(job))]
        if ended.code:
            case.faults.append(f"undisturbed: {ended.told}")

    def _fresh(self) -> Path:
        place = self._folder / "disturbed"
        shutil.rmtree(place, ignore_errors=True)
        return place

    def _kill(self, job: str, engine: str, victim: str, length: float, case: Case) -> float:
        """One kill; returns how long a run takes as far as is known now."""
        share = self._random.uniform(0.05, 0.95)
        for _ in range(TRIES):
            place = self._fresh()
            options = self.engine(engine)
            command = Command(JOBS[job], place, *options)
            with contextlib.suppress(subprocess.TimeoutExpired):
                command.process.wait(share * length)
            targets = self._targets(command, victim)
            if command.process.poll() is None and targets:
                break
            command.end()
            length *= 0.9
        else:
            case.faults.append(f"{TRIES} runs ended before {share:.0%} of {length:.1f} s")
            return length
        os.kill(self._random.choice(targets), signal.SIGKILL)
        case.kills += 1
        ended = command.end()
        where = f"after {share * length:.2f} s"
        if orphans := command.orphans():
            case.faults.append(f"{where}: processes {orphans} are left")
            for pid in orphans:
                os.kill(pid, signal.SIGKILL)
        if ended.code == 0:
            case.alone += 1
        else:
            if victim != "command":
                case.codes[ended.diagnosed] += 1
            more = ("--resume",) if JOBS[job][0] == "sample" else ()
            again = Command(JOBS[job], place, *self.engine(engine), *more).end()
            if again.code != 0:
                case.faults.append(f"{where}, again: exit code {again.code}: {again.told}")
        wrong = differences(content(place), self.wanted(job))
        case.equal += not wrong
        case.faults += [f"{where}: {what}" for what in wrong]
        return length

    def _targets(self, command: Command, victim: str) -> list[int]:
        if victim == "command":
            return [command.process.pid]
        if victim == "scheduler":
            assert self.cluster.scheduler is not None
            return [self.cluster.scheduler.pid]
        mine = command.workers()
        return mine or [worker.pid for worker in self.cluster.workers]

    def full_disk(self, job: str, kilobytes: int) -> None:
        """Make a data set where there is not room for it, then room, then the rest."""
        case = self.case(f"{job}, -j 2: full disk ({kilobytes} kB)")
        wanted = self.wanted(job)
        place = self._folder / "disk"
        place.mkdir(exist_ok=True)
        subprocess.run(["mount", "-t", "tmpfs", "-o", f"size={kilobytes}k", "none", str(place)], check=True)
        try:
            ended = Command(JOBS[job], place / "data", "-j", "2").end()
            case.kills += 1
            if ended.code == 0:
                case.faults.append("the disk was large enough")
            case.codes[ended.diagnosed] += 1
            if "no space left" not in ended.told:
                case.faults.append(f"the message does not say why: {ended.told}")
            subprocess.run(["mount", "-o", "remount,size=200m", str(place)], check=True)
            more = ("--resume",) if JOBS[job][0] == "sample" else ()
            again = Command(JOBS[job], place / "data", "-j", "2", *more).end()
            if again.code != 0:
                case.faults.append(f"again: exit code {again.code}: {again.told}")
            wrong = differences(content(place / "data"), wanted)
            case.equal += not wrong
            case.faults += wrong
        finally:
            subprocess.run(["umount", str(place)], check=True)
        print(case.row(), flush=True)

    def other_worker(self, job: str, name: str, path: Path, told: str) -> None:
        """Let one of the workers find another package in ``path``; then mend the cluster, and resume."""
        case = self.case(f"{job}, --dask: {name}")
        wanted, place = self.wanted(job), self._fresh()
        cluster = Cluster(self._folder, path=[path])
        try:
            cluster.mend()
            ended = Command(JOBS[job], place, "--dask", cluster.address).end()
        finally:
            cluster.stop()
        case.kills += 1
        case.codes[ended.diagnosed] += 1
        if ended.code in (0, "stuck") or not re.search(told, ended.told):
            case.faults.append(f"exit code {ended.code}, told: {ended.told}")
        more = ("--resume",) if JOBS[job][0] == "sample" else ()
        again = Command(JOBS[job], place, *self.engine("--dask"), *more).end()
        if again.code != 0:
            case.faults.append(f"again: exit code {again.code}: {again.told}")
        wrong = differences(content(place), wanted)
        case.equal += not wrong
        case.faults += wrong
        print(case.row(), flush=True)


def other_version(folder: Path) -> Path:
    """A folder in which the package has another version."""
    about = folder / "version" / "scenic_lang-9.9.9.dist-info"
    about.mkdir(parents=True)
    (about / "METADATA").write_text("Metadata-Version: 2.1\nName: scenic-lang\nVersion: 9.9.9\n")
    return about.parent


def other_code(folder: Path) -> Path:
    """A folder in which the package has the same version, and objects another base."""
    place = folder / "code"
    shutil.copytree(HERE.parent / "scenic", place / "scenic", ignore=shutil.ignore_patterns("__pycache__"))
    path = place / "scenic" / "runtime" / "instances" / "objects.py"
    text = path.read_text()
    changed = text.replace('operate("negative", self.height), 2)', 'operate("negative", self.height), 3)')
    if changed == text:
        sys.exit(f"no base of objects in {path}")
    path.write_text(changed)
    return place


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--kills", type=int, default=10, help="kills of each kind with scenes")
    parser.add_argument("--few", type=int, default=3, help="kills of each kind with images and simulations")
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument(
        "--only", nargs="+", default=[*JOBS, "disk", "versions"], choices=[*JOBS, "disk", "versions"]
    )
    arguments = parser.parse_args()
    with tempfile.TemporaryDirectory() as name, _stopped(Trials(Path(name), arguments.seed)) as trials:
        print(f"{'case':34} {'kills':>5} {'alone':>5}  {'codes':24} {'equal':>5}")
        for job in JOBS:
            if job not in arguments.only:
                continue
            count = arguments.kills if job == "parquet" else arguments.few
            for engine, victims in (
                ("--dask", ("worker", "command", "scheduler")),
                ("-j 2", ("worker", "command")),
            ):
                for victim in victims:
                    trials.kills(job, engine, victim, count)
        if "disk" in arguments.only:
            for job, size in (
                ("parquet", 700),
                ("jsonl", 9000),
                ("images", 500),
                ("tar", 500),
                ("simulations", 300),
            ):
                trials.full_disk(job, size)
        if "versions" in arguments.only:
            version, code = other_version(Path(name)), other_code(Path(name))
            for job in ("parquet", "simulations"):
                trials.other_worker(job, "other version", version, r"scenic.*9\.9\.9")
                trials.other_worker(job, "other code", code, r"program|graph")
    faults = [f"{case.name}: {fault}" for case in trials.cases for fault in case.faults]
    print("\n".join(["", *faults]) if faults else "\nno trial differs")
    sys.exit(1 if faults else 0)


@contextlib.contextmanager
def _stopped(trials: Trials) -> Iterator[Trials]:
    try:
        yield trials
    finally:
        trials.cluster.stop()


if __name__ == "__main__":
    main()
