"""Trials in processes of their own, which end whatever the programs do: endless loops, much memory, `os._exit`."""

import multiprocessing
import os
import signal
import sys
import tempfile
import threading
import time
from collections.abc import Iterator, Sequence
from contextlib import suppress
from multiprocessing.connection import Connection, wait
from typing import IO, TYPE_CHECKING, Any, Final

from scenic.language.diagnostics import Diagnostic
from scenic.trying.answer import PHASES, Trial, answer, failed_answer

if TYPE_CHECKING:
    from multiprocessing.process import BaseProcess

__all__ = ["tried"]

_GRACE: Final = 5.0
"""Seconds beyond the limit of a trial until its process is ended: it notices the limit itself between candidates."""
_LONGEST_OUTPUT: Final = 4000
"""Characters of what a program prints that an answer contains."""
_LARGEST_FILE: Final = 256 << 20
"""Bytes of a file that a program may write."""
_INTERVAL: Final = 0.5
"""Seconds between looks for the parent of a process."""
_FACTOR: Final = 3
"""A trial may take this many times its limit: for loading, sampling and simulating."""


class _Worker:
    """A process that tries programs one after the other."""

    def __init__(self) -> None:
        context: Any = multiprocessing.get_context("fork" if sys.platform == "linux" else "spawn")
        self.connection, there = context.Pipe()
        self.process: BaseProcess = context.Process(target=_serve, args=(there, self.connection), daemon=True)
        self.process.start()
        there.close()
        self.number: int | None = None
        self.deadline = 0.0

    def give(self, number: int, trial: Trial) -> None:
        """Begin a trial."""
        self.number = number
        self.deadline = time.monotonic() + _FACTOR * trial.limits.seconds + _GRACE
        self.connection.send(trial)

    def end(self) -> None:
        """End the process with all that it has started."""
        self.connection.close()
        if self.process.pid is not None and hasattr(os, "killpg"):
            with suppress(ProcessLookupError, PermissionError):
                os.killpg(self.process.pid, signal.SIGKILL)
        self.process.kill()
        self.process.join()


def tried(trials: Sequence[Trial], jobs: int = 1) -> Iterator[dict[str, Any]]:
    """The answers about programs, in order, made by ``jobs`` processes. **Runs the programs.**"""
    answers: dict[int, dict[str, Any]] = {}
    waiting = list(enumerate(trials))[::-1]
    workers = [_Worker() for _ in range(min(jobs, len(trials)))]
    due = 0
    try:
        while due < len(trials):
            for worker in workers:
                if worker.number is None and waiting:
                    worker.give(*waiting.pop())
            busy = [worker for worker in workers if worker.number is not None]
            patience = max(0.0, min(worker.deadline for worker in busy) - time.monotonic())
            ready = wait([worker.connection for worker in busy], patience)
            for worker in busy:
                assert worker.number is not None
                number, late = worker.number, time.monotonic() > worker.deadline
                if worker.connection in ready:
                    try:
                        answers[number] = worker.connection.recv()
                        worker.number = None
                        continue
                    except (EOFError, OSError):
                        pass
                elif not late:
                    continue
                answers[number] = _ended(trials[number], worker, late=late)
                workers[workers.index(worker)] = _Worker()
            while due in answers:
                yield answers.pop(due)
                due += 1
    finally:
        for worker in workers:
            worker.end()


def _ended(trial: Trial, worker: _Worker, *, late: bool) -> dict[str, Any]:
    """The answer about a program whose process has ended, or has to be."""
    worker.end()
    if late:
        problem = Diagnostic(
            "SC608",
            f"the program still ran {_FACTOR * trial.limits.seconds + _GRACE:g} s after the trial began",
            help="look for a loop without end, or raise the limit by `--seconds`",
        )
    else:
        problem = Diagnostic(
            "SC610",
            f"the process that ran the program ended with code {worker.process.exitcode}",
            help="the program may need more memory (`--memory`), or end the process itself",
        )
    return failed_answer(trial, PHASES[2], problem)


def _serve(connection: Connection, other: Connection) -> None:
    """Answer trials until the connection is closed; what programs print is part of the answers."""
    other.close()
    with suppress(OSError):
        os.setsid()
    threading.Thread(target=_end_with, args=(os.getppid(),), daemon=True).start()
    signal.signal(signal.SIGINT, signal.SIG_IGN)
    home, memory_before = os.getcwd(), _address_space()
    with tempfile.TemporaryFile() as output:
        for number in (1, 2):
            os.dup2(output.fileno(), number)
        sys.stdin = open(os.devnull, encoding="utf-8")  # noqa: SIM115 - they last as long as the process
        sys.stdout = open(1, "w", encoding="utf-8", errors="replace", closefd=False)  # noqa: SIM115
        sys.stderr = open(2, "w", encoding="utf-8", errors="replace", closefd=False)  # noqa: SIM115
        while True:
            try:
                trial: Trial = connection.recv()
            except (EOFError, OSError):
                return
            _limit("RLIMIT_AS", memory_before + trial.limits.memory)
            # What a program prints is a file, which must not fill the disk.
            _limit("RLIMIT_FSIZE", _LARGEST_FILE)
            output.seek(0)
            output.truncate()
            connection.send(_answered(trial, output))
            os.chdir(home)


def _end_with(parent: int) -> None:
    """End this process, and all that it has started, soon after its parent has ended."""
    while os.getppid() == parent:
        time.sleep(_INTERVAL)
    if hasattr(os, "killpg"):
        os.killpg(os.getpid(), signal.SIGKILL)
    os._exit(1)


def _answered(trial: Trial, output: IO[bytes]) -> dict[str, Any]:
    """The answer to a trial, whatever the program does that leaves the process alive."""
    from scenic.trying.time_limits import within_seconds

    try:
        with within_seconds(trial.limits.seconds):
            result = answer(trial)
    except Exception as error:  # noqa: BLE001 - a batch goes on after a fault of ours
        problem = Diagnostic(
            "SC999",
            f"internal error: {type(error).__name__}: {error}",
            help="this is a fault of scenic, not of your program; please report it with the program",
        )
        result = failed_answer(trial, PHASES[2], problem)
    sys.stdout.flush()
    sys.stderr.flush()
    output.seek(0)
    text = output.read(4 * _LONGEST_OUTPUT).decode(errors="replace")[:_LONGEST_OUTPUT]
    return {**result, "output": text}


def _address_space() -> int:
    """Return the bytes that this process has mapped: memory that a fork inherits does not count for the programs it tries."""
    try:
        with open("/proc/self/statm", encoding="ascii") as file:
            return int(file.read().split()[0]) * os.sysconf("SC_PAGE_SIZE")
    except OSError:  # Only Linux tells, and only there are processes forked.
        return 0


def _limit(name: str, size: int) -> None:
    try:
        import resource
    except ImportError:  # There are no such limits on Windows.
        return
    kind: int = getattr(resource, name)
    _, hard = resource.getrlimit(kind)
    resource.setrlimit(kind, (size if hard == resource.RLIM_INFINITY else min(size, hard), hard))
