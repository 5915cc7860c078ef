"""``scenic sample -j``: JSON Lines of many scenes, made by several processes, in order and the same whatever their number.

A worker gets a run of scene numbers and answers with their lines; which worker makes which run changes nothing, since a scene
is a function of the seed and its number. A worker that dies is replaced, and its run is made again.
"""

import json
import time
from collections.abc import Iterable, Iterator
from dataclasses import dataclass, replace
from functools import partial
from pickle import PickleBuffer
from typing import TYPE_CHECKING, Final

from scenic.formats.growing import GrowingFile
from scenic.formats.json_lines import SceneLines
from scenic.graph.points import Sobol
from scenic.language.errors import Located
from scenic.runtime.sampling.report import Exhausted
from scenic.runtime.scenes.scenario import Scenario
from scenic.runtime.scenes.scene import Scene

if TYPE_CHECKING:
    from _typeshed import ReadableBuffer

_FIRST: Final = 16
"""Scenes of the first piece of a job that a process makes; later ones follow what these took."""

_SECONDS: Final = 0.8
"""What a piece should take: starting one costs some hundredths, and an interruption loses those under way."""

_SMALLEST: Final = 6
"""The smallest pieces are such a part of the usual one: more would take longer to start than to make."""

_LONGEST: Final = 4096
"""Scenes of a piece, at most: what has to be kept until those before it are there."""

_TRIES: Final = 3


class ResumeError(Located):
    """Lines that a run cannot go on with."""

    code = "SC609"


class WorkerDiedError(Located):
    """A process that sampled died again and again."""

    code = "SC610"


@dataclass(frozen=True, slots=True)
class Job:
    """What to sample: scenes ``first`` to ``last`` (exclusive) of a seed, within limits.

    ``deadline`` is a time of `time.monotonic`; ``sobol`` says that the scenes are rows of Sobol's sequence.
    """

    seed: int
    first: int
    last: int
    max_attempts: int | None
    deadline: float | None
    sobol: bool = False


@dataclass(frozen=True, slots=True)
class Made:
    """What came of a job: lines, scenes not found, and whether it has to be made by the parent, to show an error."""

    job: Job
    lines: "ReadableBuffer"
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
        source=Sobol() if job.sobol else None,
    )


def continued(
    grown: GrowingFile, digest: str, seed: int | None, first: int, count: int, *, points: str | None = None
) -> tuple[int | None, int]:
    """The seed of the run that is resumed, and how many of its scenes are done.

    ``points`` is what scenes are made of, if not of random numbers. Raises `ResumeError` where the lines are of another program, of other options or of another run.
    """
    kept = grown.kept()
    if not kept:
        return seed, 0
    try:
        head, last = (json.loads(line) for line in (kept[0], kept[-1]))
        made, begun, reached = (head["digest"], int(head["seed"])), int(head["k"]), int(last["k"])
        same = made == (last["digest"], int(last["seed"]))
        alike = head.get("points") == last.get("points") == points
    except (ValueError, KeyError, TypeError) as error:
        raise ResumeError(f"'{grown.path}' does not hold scenes of an earlier run ({error})") from error
    if made[0] != digest:
        raise ResumeError(
            f"'{grown.path}' holds scenes of another program, or of the same with other options",
            help="the program has changed since: sample to a new file",
        )
    if not alike:
        raise ResumeError(
            f"'{grown.path}' holds scenes of other random numbers",
            help="give --sobol as in the run that is resumed, or leave it away as there",
        )
    if not same or (seed is not None and seed != made[1]) or not first <= begun or reached >= first + count:
        raise ResumeError(
            f"'{grown.path}' holds scenes {begun} to {reached} of seed {made[1]}, which this run does not make",
            help="give the same --seed, --first and -n as before, or a larger -n",
        )
    return made[1], reached + 1 - first


def _alone(lines: SceneLines, job: Job, result: Scene | Exhausted) -> Made:
    """What comes of the part of a job that is one scene."""
    part = replace(job, first=result.k, last=result.k + 1)
    if isinstance(result, Exhausted):
        return Made(part, b"", (result,), result.attempts)
    return Made(part, lines.encoded(result), (), result.attempts)


def _make(scenario: Scenario, lines: SceneLines, job: Job) -> Made:
    text, missing, attempts = bytearray(), [], 0
    begun = time.monotonic()
    try:
        for result in results_of(scenario, job):
            attempts += result.attempts
            if isinstance(result, Exhausted):
                missing.append(result)
            else:
                text += lines.encoded(result)
    except Exception:  # noqa: BLE001 - the parent makes the job again, and shows the error with its place
        return Made(job, b"", (), failed=True)
    return Made(job, PickleBuffer(text), tuple(missing), attempts, time.monotonic() - begun)


def in_processes(scenario: Scenario, lines: SceneLines, job: Job, jobs: int) -> Iterator[Made]:
    """What comes of a job, in order, in pieces that several processes make.

    Raises `WorkerDiedError` where processes keep dying, and whatever sampling raises.
    """
    yield from _ordered(scenario, lines, _Pieces(job, jobs), jobs, tries=_TRIES)


class _Pieces:
    """A job in pieces that take about as long each, smaller ones at the end, so that all processes end together."""

    def __init__(self, job: Job, jobs: int) -> None:
        self._job = job
        self._jobs = jobs
        self._size = self._usual = _FIRST

    def __iter__(self) -> Iterator[Job]:
        job, first = self._job, self._job.first
        while first < job.last:
            left = job.last - first
            fair = -(-left // (2 * self._jobs))
            last = first + min(left, self._size, max(fair, self._usual // _SMALLEST))
            yield replace(job, first=first, last=last)
            first = last

    def learn(self, made: Made) -> None:
        """Take into account what a piece took."""
        count = made.job.last - made.job.first
        self._size = max(1, min(_LONGEST, int(count * _SECONDS / max(made.seconds, 1e-6))))
        self._usual = max(self._usual, self._size)


def _ordered(
    scenario: Scenario, lines: SceneLines, pieces: _Pieces, jobs: int, *, tries: int
) -> Iterator[Made]:
    waiting: dict[int, Made] = {}
    upcoming = 0
    for index, made in _made(scenario, lines, pieces, jobs):
        if made.seconds:
            pieces.learn(made)
        waiting[index] = made
        while upcoming in waiting:
            ready = waiting.pop(upcoming)
            upcoming += 1
            if ready.died is not None:
                ready = _again(scenario, lines, ready, tries)
            if ready.failed:
                # Raises what the worker met, here where it can be shown with its place, after what comes before.
                for result in results_of(scenario, ready.job):
                    yield _alone(lines, ready.job, result)
            else:
                yield ready


def _made(
    scenario: Scenario, lines: SceneLines, pieces: Iterable[Job], jobs: int
) -> Iterator[tuple[int, Made]]:
    """What comes of pieces in several processes, as it comes, with their numbers."""
    from scenic.cli import workers  # a sixteenth of a start, which one process can do without

    return workers.run(
        partial(_make, scenario, lines),
        pieces,
        jobs=jobs,
        lost=lambda piece, code: Made(piece, b"", (), died=code),
    )


def _again(scenario: Scenario, lines: SceneLines, made: Made, tries: int) -> Made:
    """A piece whose worker died, made by another one."""
    code = made.died
    for _ in range(tries):
        ((_, again),) = _made(scenario, lines, [made.job], 1)
        if again.died is None:
            return again
        code = again.died
    raise WorkerDiedError(
        f"the process that samples scene {made.job.first} dies, with exit code {code}",
        help="it may lack memory: sample with fewer processes (-j 1), or try that scene alone (--first)",
    )
