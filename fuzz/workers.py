"""Runs on several processors: each worker takes every n-th round, and the reports are put together."""

import contextlib
import faulthandler
import math
import multiprocessing
import os
import queue
import signal
import sys
import time
import traceback
from collections.abc import Callable, Sequence
from dataclasses import dataclass, field
from typing import Any, Final

from fuzz.properties import OF_PROGRAMS, OF_TEXTS, Case, Property
from fuzz.session import FORMULAS, MUTANTS, PROGRAMS, Failure, Report, fault_of, run_round
from fuzz.shrinking import shrunk
from fuzz.temporal import OF_FORMULAS

__all__ = ["Budget", "Slate", "WorkerDied", "run", "usable_processors"]

_PATIENCE: Final = 0.2
_ROOM: Final = 1 << 20
"""Bytes for the text that a worker is trying, and before it for its length."""
_LENGTH: Final = 8
_ATTEMPTS: Final = 60
"""So many shorter texts are tried to see whether a worker dies of them; each needs a process."""
_ENOUGH: Final = 120.0
"""Seconds after which a worker with a single text is taken for a dead one."""


@dataclass(frozen=True, slots=True)
class Budget:
    """The amount of work: until the time ``deadline`` (of `time.time`), and at most the given numbers of programs and mutants.

    Round ``k`` has the seed ``seed + k``. If ``first``, a worker stops when it has found something, and the others after their rounds.
    ``only`` names the properties to be tried; without names, all are.
    """

    seed: int
    deadline: float = math.inf
    programs: int | None = None
    mutants: int | None = None
    first: bool = False
    only: frozenset[str] = frozenset()

    def chosen(self, properties: Sequence[Property]) -> tuple[Property, ...]:
        """Return the properties, among ``properties``, that the budget selects."""
        return tuple(each for each in properties if not self.only or each.name in self.only)

    def round(self, number: int) -> tuple[int, int] | None:
        """Return the numbers of programs and mutants of round ``number``; ``None`` if the round is not to be run."""
        if self.programs is None and self.mutants is None:
            return PROGRAMS, MUTANTS
        programs, mutants = self.programs or 0, self.mutants or 0
        rounds = max(1, -(-programs // PROGRAMS), -(-mutants // PROGRAMS))
        if number >= rounds:
            return None
        return _share(programs, rounds, number), _share(mutants, rounds, number)


def _share(total: int, parts: int, number: int) -> int:
    return total * (number + 1) // parts - total * number // parts


@dataclass(frozen=True, slots=True)
class WorkerDied:
    """A worker that ended without a report, as one does whose interpreter crashes.

    ``text`` is what it was trying; if ``again``, that ends other processes, too, and is as short as was found.
    """

    worker: int
    exit_code: int | None
    seed: int
    """The seed of the round in which the worker ended."""
    reason: str = ""
    text: str = ""
    again: bool = False
    found_at: float = field(default_factory=time.time, compare=False)
    """When it died, before the text was shrunk (by `time.time`)."""

    def __str__(self) -> str:
        text = f"worker {self.worker} died with exit code {self.exit_code} in the round with seed {self.seed}"
        return f"{text}\n{self.reason}".rstrip()


def usable_processors() -> int:
    """The number of processors that this process may use."""
    if hasattr(os, "sched_getaffinity"):
        return len(os.sched_getaffinity(0))
    return os.cpu_count() or 1


def run(
    budget: Budget, *, jobs: int, on_failure: Callable[[Failure], None]
) -> tuple[Report, tuple[WorkerDied, ...]]:
    """Run rounds until the budget is spent, or the user interrupts; ``on_failure`` is called immediately for each new failure.

    ``jobs`` processes share the work; with none, this one does it all.
    """
    if jobs == 0:
        report = Report()
        with contextlib.suppress(KeyboardInterrupt):
            _rounds(report, budget, 0, 1, on_failure=on_failure)
        return report, ()
    return _Team(budget, jobs, on_failure).run()


def _rounds(
    report: Report,
    budget: Budget,
    first: int,
    step: int,
    *,
    on_failure: Callable[[Failure], None],
    should_stop: Callable[[], bool] = lambda: False,
    begin: Callable[[int], None] = lambda _seed: None,
    trying: Callable[[str], None] = lambda _text: None,
) -> None:
    number = first
    while (sizes := budget.round(number)) is not None:
        remaining = budget.deadline - time.time()
        if remaining <= 0 or should_stop():
            return
        begin(budget.seed + number)
        reported_count = len(report.failures)
        run_round(
            report,
            seed_of_round=budget.seed + number,
            until=time.monotonic() + remaining,
            programs=sizes[0],
            mutants=sizes[1],
            formulas=FORMULAS if budget.chosen(OF_FORMULAS) else 0,
            of_programs=budget.chosen(OF_PROGRAMS),
            of_texts=budget.chosen(OF_TEXTS),
            of_formulas=budget.chosen(OF_FORMULAS),
            first=budget.first,
            trying=trying,
        )
        for failure in report.failures[reported_count:]:
            on_failure(failure)
        if budget.first and report.failures:
            return
        number += step


class _Team:
    """Worker processes, and their messages."""

    def __init__(self, budget: Budget, jobs: int, on_failure: Callable[[Failure], None]) -> None:
        # New interpreters: what this one has in memory is not to matter.
        context = self._context = multiprocessing.get_context("spawn")
        self._messages: Any = context.Queue()
        self._stop: Any = context.Event()
        self._slates = [Slate(context.RawArray("B", _ROOM)) for _ in range(jobs)]
        self._processes: list[Any] = [
            context.Process(
                target=_work, args=(number, jobs, budget, self._messages, self._stop, slate), daemon=True
            )
            for number, slate in enumerate(self._slates)
        ]
        self._budget = budget
        self._seeds = [budget.seed + number for number in range(jobs)]
        self._on_failure = on_failure
        self._first = budget.first
        self._report = Report()
        self._waiting = set(range(jobs))
        self._died: list[WorkerDied] = []

    def run(self) -> tuple[Report, tuple[WorkerDied, ...]]:
        for process in self._processes:
            process.start()
        has_interrupt = False
        while self._waiting:
            try:
                self._listen()
            except KeyboardInterrupt:
                if has_interrupt:
                    break
                # The workers end their round; a second interruption ends them.
                has_interrupt = True
                self._stop.set()
        for process in self._processes:
            if process.is_alive() and self._waiting:
                process.terminate()
            process.join()
        return self._report, tuple(self._died)

    def _listen(self) -> None:
        try:
            worker, message = self._messages.get(timeout=_PATIENCE)
        except queue.Empty:
            for number in sorted(self._waiting):
                process = self._processes[number]
                if not process.is_alive() and self._messages.empty():
                    self._lose(number, process.exitcode)
            return
        match message:
            case int():
                self._seeds[worker] = message
            case Failure():
                if not any(earlier.signature == message.signature for earlier in self._report.failures):
                    self._report.failures.append(message)
                    self._on_failure(message)
                    if self._first:
                        self._stop.set()
            case Report():
                self._waiting.discard(worker)
                # Its failures are known.
                message.failures.clear()
                self._report.merge(message)
            case str():
                self._lose(worker, None, message)

    def _lose(self, worker: int, exit_code: int | None, reason: str = "") -> None:
        if worker not in self._waiting:
            return
        self._waiting.discard(worker)
        died_at = time.time()
        text = self._slates[worker].read()
        again = not reason and self._dies(text)
        if again:
            text = shrunk(text, self._dies, most=_ATTEMPTS)
        if self._first:
            self._stop.set()
        self._died.append(WorkerDied(worker, exit_code, self._seeds[worker], reason, text, again, died_at))

    def _dies(self, text: str) -> bool:
        """Return whether a process crashes on a text, or does not end."""
        process = self._context.Process(target=_try_alone, args=(text, self._budget), daemon=True)
        process.start()
        process.join(_ENOUGH)
        if process.is_alive():
            process.kill()
        process.join()
        return bool(process.exitcode)


class Slate:
    """Memory that processes share, as an array of bytes, where a worker writes down what it is about to try."""

    def __init__(self, memory: Any) -> None:
        self._memory = memory

    def write(self, text: str) -> None:
        """Write a text in place of the one before; of one that is too long, the beginning."""
        view = memoryview(self._memory).cast("B")
        data = text[: (len(view) - _LENGTH) // 4].encode("utf-8", "surrogatepass")
        view[:_LENGTH] = len(data).to_bytes(_LENGTH, "little")
        view[_LENGTH : _LENGTH + len(data)] = data

    def read(self) -> str:
        """The text written last."""
        view = memoryview(self._memory).cast("B")
        length = int.from_bytes(view[:_LENGTH], "little")
        return bytes(view[_LENGTH : _LENGTH + length]).decode("utf-8", "surrogatepass")


def _try_alone(text: str, budget: Budget) -> None:
    """Try a text that a worker died of on all properties, in a process of its own. What they raise does not matter."""
    case = Case(text, thorough=True)
    for each in budget.chosen((*OF_PROGRAMS, *OF_FORMULAS)):
        fault_of(each, case)


def _work(number: int, jobs: int, budget: Budget, messages: Any, stop: Any, slate: Slate) -> None:
    """Run the rounds of a worker process."""
    faulthandler.enable()
    # The process that started it decides what an interruption means.
    signal.signal(signal.SIGINT, signal.SIG_IGN)
    report = Report()
    # If that is killed, nobody is left to report to.
    parent = os.getppid()
    try:
        _rounds(
            report,
            budget,
            number,
            jobs,
            on_failure=lambda failure: messages.put((number, failure)),
            should_stop=lambda: stop.is_set() or os.getppid() != parent,
            begin=lambda seed: messages.put((number, seed)),
            trying=slate.write,
        )
        messages.put((number, report))
    except Exception:  # noqa: BLE001 - the process that started this one tells of it
        messages.put((number, traceback.format_exc()))
    sys.stdout.flush()
