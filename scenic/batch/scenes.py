"""Many scenes, made by several processes: in order, and the same whatever their number.

A worker gets a run of scene numbers and returns the scenes in encoded form (their JSON Lines, or the numbers of their accepted
candidates). Any worker may make any run, since a scene is a function of the seed and its number. A worker that dies is
replaced, and its run is made again.
"""

import time
from collections.abc import Callable, Iterable, Iterator, Sequence
from dataclasses import replace
from functools import partial
from pickle import PickleBuffer
from typing import TYPE_CHECKING, Any, Final

import numpy as np

from scenic.batch.engines import BatchEngine, OverExecutor, Processes
from scenic.dataclass import dataclass
from scenic.graph.points import PointSet, Sobol
from scenic.language.errors import Located, RejectionException
from scenic.runtime.sampling.rejection_report import Exhausted
from scenic.runtime.scenes.scenario import Scenario
from scenic.runtime.scenes.scene import Scene

if TYPE_CHECKING:
    from concurrent.futures import Executor

    from _typeshed import ReadableBuffer

_FIRST: Final = 16
"""Scenes of the first piece of a job that a process makes; later ones follow what these took."""

_SECONDS: Final = 0.8
"""Intended seconds for a piece: starting a piece costs some hundredths, and an interruption loses the pieces under way."""

_SMALLEST: Final = 6
"""The smallest pieces are such a part of the usual one: more would take longer to start than to make."""

_FEWEST: Final = 32
"""The same for few workers, of which one may be at a piece that takes long."""

_LONGEST: Final = 4096
"""Scenes of a piece, at most: what has to be kept until those before it are there."""

_TRIES: Final = 3

_SPREAD: Final = 8
"""Pieces for each worker, at most, from the first that is not there to the last under way: more would fill the memory."""

Encode = Callable[[Scenario, Sequence[Scene]], bytes]
"""Turns some scenes of a scenario into bytes; it must be picklable where processes are not forked."""

LONGEST: Final = 1024
"""Scenes encoded together, at most."""


class WorkerDiedError(Located):
    """A process that sampled died again and again."""

    code = "SC610"


@dataclass(frozen=True, slots=True)
class Job:
    """Scenes to sample: ``first`` to ``last`` (exclusive) of a seed, within limits.

    ``deadline`` is a time of `time.monotonic`; ``source`` gives random numbers that are not hashed, and ``approximate`` scenes
    are made so many together (see `Scenario.stream`).
    """

    seed: int
    first: int
    last: int
    max_attempts: int | None
    deadline: float | None
    source: PointSet | None = None
    approximate: int | None = None


def method_of(points: str | None) -> dict[str, Any]:
    """Return the settings of a job whose scenes a manifest says to be made of ``sobol`` points, or ``approximate N``."""
    if points is not None and points.startswith("approximate "):
        return {"approximate": int(points.removeprefix("approximate "))}
    return {"source": Sobol() if points == "sobol" else None}


@dataclass(frozen=True, slots=True)
class Made:
    """The result of a job: encoded scenes, scenes not found, and whether the parent has to make it to show an error."""

    job: Job
    encoded: "ReadableBuffer"
    missing: tuple[Exhausted, ...]
    attempts: int = 0
    seconds: float = 0.0
    failed: bool = False
    died: int | None = None


def results_of(scenario: Scenario, job: Job) -> Iterator[Scene | Exhausted]:
    """The scenes of a job, or why one was not found."""
    limit = None if job.deadline is None else max(1e-3, job.deadline - time.monotonic())
    return scenario.stream(
        job.last - job.first,
        seed=job.seed,
        first=job.first,
        max_attempts=job.max_attempts,
        time_limit=limit,
        source=job.source,
        approximate=job.approximate,
    )


def encoded_here(scenario: Scenario, encode: Encode, job: Job, *, most: int = LONGEST) -> Iterator[Made]:
    """The results of a job, in order, in pieces of ``most`` scenes that this process makes; raises whatever sampling raises."""
    block: list[Scene] = []
    first, due = job.first, time.monotonic() + _SECONDS

    def made(missing: tuple[Exhausted, ...], last: int) -> Made:
        attempts = sum(scene.attempts for scene in block) + sum(item.attempts for item in missing)
        part = replace(job, first=first, last=last)
        return Made(part, encode(scenario, block) if block else b"", missing, attempts)

    for result in results_of(scenario, job):
        if isinstance(result, Exhausted):
            yield made((result,), result.k + 1)
        else:
            block.append(result)
            if len(block) < most and time.monotonic() < due:
                continue
            yield made((), result.k + 1)
        block.clear()
        first, due = result.k + 1, time.monotonic() + _SECONDS
    if block:
        yield made((), job.last)


def _alone(scenario: Scenario, encode: Encode, job: Job, result: Scene | Exhausted) -> Made:
    """The result of the part of a job that is one scene."""
    part = replace(job, first=result.k, last=result.k + 1)
    if isinstance(result, Exhausted):
        return Made(part, b"", (result,), result.attempts)
    return Made(part, encode(scenario, [result]), (), result.attempts)


def _make(scenario: Scenario, encode: Encode, job: Job) -> Made:
    text, attempts = bytearray(), 0
    missing: list[Exhausted] = []
    block: list[Scene] = []
    start_time = time.monotonic()
    try:
        for result in results_of(scenario, job):
            attempts += result.attempts
            if isinstance(result, Exhausted):
                missing.append(result)
                continue
            block.append(result)
            if len(block) == LONGEST:
                text += encode(scenario, block)
                block.clear()
        if block:
            text += encode(scenario, block)
    except Exception:  # noqa: BLE001 - the parent makes the job again, and shows the error with its place
        return Made(job, b"", (), failed=True)
    return Made(job, PickleBuffer(text), tuple(missing), attempts, time.monotonic() - start_time)


def sampled_in_processes(
    scenario: Scenario,
    n: int,
    *,
    seed: int,
    processes: int,
    first: int = 0,
    max_attempts: int | None = None,
    time_limit: float | None = None,
    source: PointSet | None = None,
    executor: "Executor | None" = None,
) -> Iterator[Scene]:
    """Scenes ``first`` to ``first + n`` of a seed, found by several processes: our own, or those of ``executor``.

    Workers return the numbers of each scene's accepted candidates. The parent evaluates these candidates alone.

    Raises:
        RejectionException: if a scene is not found within the limits.
        WorkerDiedError: if processes keep dying.

    """
    deadline = None if time_limit is None else time.monotonic() + time_limit
    job = Job(seed, first, first + n, max_attempts, deadline, source)
    engine = Processes(processes) if executor is None else OverExecutor(executor, max(2, processes))
    for block in in_processes(scenario, _accepted_attempts, job, engine):
        if block.missing:
            raise RejectionException(block.missing[0].message())
        numbers = np.arange(block.job.first, block.job.last, dtype=np.int64)
        attempts = np.frombuffer(bytes(block.encoded), dtype=np.int64).reshape(len(numbers), -1)
        attempts = attempts[:, 0] if attempts.shape[1] == 1 else attempts
        yield from scenario.found(seed, numbers, attempts, source=source)


def _accepted_attempts(_: Scenario, scenes: Sequence[Scene]) -> bytes:
    return np.array([scene.component_attempts for scene in scenes], dtype=np.int64).tobytes()


def in_processes(scenario: Scenario, encode: Encode, job: Job, engine: BatchEngine) -> Iterator[Made]:
    """The results of a job, in order, in pieces that the workers of an engine make.

    Raises `WorkerDiedError` where processes keep dying, and whatever sampling raises.
    """
    yield from _ordered(scenario, encode, _Pieces(job, engine), engine)


class _Pieces:
    """A job in pieces that take about as long each, smaller ones at the end, so that all processes end together."""

    def __init__(self, job: Job, engine: BatchEngine) -> None:
        self._job = job
        self._engine = engine
        self._size = self._usual = _FIRST

    def __iter__(self) -> Iterator[Job]:
        job, first = self._job, self._job.first
        while first < job.last:
            left = job.last - first
            fair = -(-left // (2 * self._engine.jobs))
            last = first + min(left, self._size, max(fair, self._usual // _SMALLEST))
            yield replace(job, first=first, last=last)
            first = last

    def learn(self, made: Made) -> None:
        """Take into account what a piece took."""
        count = made.job.last - made.job.first
        self._size = max(1, min(_LONGEST, int(count * _SECONDS / max(made.seconds, 1e-6))))
        self._usual = max(self._usual, self._size)


def _ordered(scenario: Scenario, encode: Encode, pieces: _Pieces, engine: BatchEngine) -> Iterator[Made]:
    waiting: dict[int, Made] = {}
    upcoming = 0
    for index, block in _made(scenario, encode, pieces, engine):
        if block.seconds:
            pieces.learn(block)
        waiting[index] = block
        while upcoming in waiting:
            ready = waiting.pop(upcoming)
            upcoming += 1
            if ready.died is not None:
                ready = _again(scenario, encode, ready, engine)
            if ready.failed:
                # Raises what the worker met, here where it can be shown with its place, after what comes before.
                for result in results_of(scenario, ready.job):
                    yield _alone(scenario, encode, ready.job, result)
            else:
                yield ready


def _made(
    scenario: Scenario, encode: Encode, pieces: Iterable[Job], engine: BatchEngine
) -> Iterator[tuple[int, Made]]:
    """The results of pieces as they come, with the numbers of the pieces."""
    return engine.run(
        partial(_make, scenario, encode),
        pieces,
        lost=lambda piece, code: Made(piece, b"", (), died=code),
        spread=max(_FEWEST, _SPREAD * engine.jobs),
    )


def _again(scenario: Scenario, encode: Encode, made: Made, engine: BatchEngine) -> Made:
    """Return a piece whose worker died, made by another one."""
    code = made.died
    for _ in range(_TRIES):
        ((_, again),) = _made(scenario, encode, [made.job], engine)
        if again.died is None:
            return again
        code = again.died
    raise WorkerDiedError(
        f"the process that samples scene {made.job.first} dies, with exit code {code}",
        help="it may lack memory: sample with fewer processes (-j 1), or try that scene alone (--first)",
    )
