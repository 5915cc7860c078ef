"""Running of ``sample``, ``simulate`` and ``falsify``: locks, workers, a progress bar, the end by a signal, an exit code."""

import signal
import sys
import threading
import time
from collections.abc import Callable, Iterable, Iterator
from contextlib import ExitStack, contextmanager
from pathlib import Path
from types import FrameType
from typing import TYPE_CHECKING, Final, TypeAlias

from scenic.batch.folders.lock import locked
from scenic.cli.output import has_colours

if TYPE_CHECKING:
    from scenic.batch.engines import BatchEngine
    from scenic.runtime.scenes.scenario import Scenario

__all__ = [
    "NOT_ALL",
    "Advance",
    "announce_seed",
    "batch_run",
    "ended_by_signals",
    "engine_of",
    "find_convex_parts",
    "progress_bar",
]

Advance: TypeAlias = Callable[[int, int], None]
"""Takes how many more results are done, and the candidates that they took."""

_PATIENCE: Final = 5.0
"""Seconds without a result after which a hint is printed."""

NOT_ALL: Final = 3
"""Exit code: some scenes were not found within the limits."""


@contextmanager
def engine_of(jobs: int, dask: str | None) -> "Iterator[BatchEngine | None]":
    """The place where scenes are sampled; ``None`` is this process."""
    from scenic.batch.engines import DaskCluster, Processes

    if dask is None:
        yield Processes(jobs) if jobs > 1 else None
        return
    with DaskCluster(dask) as cluster:
        yield cluster


@contextmanager
def batch_run(
    count: int,
    doing: str,
    *,
    jobs: int,
    dask: str | None,
    shown: bool,
    places: Iterable[Path] = (),
    hint: str | None = None,
) -> "Iterator[tuple[Advance, BatchEngine | None]]":
    """Provide what a batch needs around it: locks of its files, an end by signals, a progress bar, the engine.

    Args:
        count: how many results are to be made.
        doing: for the progress bar.
        jobs: the number of processes.
        dask: the address of a cluster to use instead.
        shown: whether there is a progress bar, on a terminal.
        places: single files that nobody else may write meanwhile.
        hint: what to say on a terminal when nothing has been made for a few seconds; ``None`` for nothing.

    """
    with ExitStack() as stack:
        for place in places:
            stack.enter_context(locked(place))
        stack.enter_context(ended_by_signals())
        advance = stack.enter_context(progress_bar(count, doing, shown=shown))
        if hint is not None and sys.stderr.isatty():
            advance = stack.enter_context(_impatient(advance, hint))
        yield advance, stack.enter_context(engine_of(jobs, dask))


@contextmanager
def _impatient(advance: Advance, hint: str) -> Iterator[Advance]:
    """Print a hint when nothing has been made for `_PATIENCE` seconds."""
    timer = threading.Timer(_PATIENCE, lambda: sys.stderr.write(f"{hint}\n"))
    timer.daemon = True
    timer.start()

    def advance_and_be_quiet(scenes: int, attempts: int) -> None:
        if scenes:
            timer.cancel()
        advance(scenes, attempts)

    try:
        yield advance_and_be_quiet
    finally:
        timer.cancel()


@contextmanager
def progress_bar(count: int, doing: str, *, shown: bool) -> Iterator[Advance]:
    """Show a progress bar on the error stream if that is a terminal: what is being done, how much of it, rate, acceptance, time left."""
    if not (shown and sys.stderr.isatty()):
        yield lambda _scenes, _attempts: None
        return
    from rich.console import Console
    from rich.progress import BarColumn, MofNCompleteColumn, Progress, TextColumn, TimeRemainingColumn

    columns = (
        TextColumn(doing),
        BarColumn(),
        MofNCompleteColumn(),
        TextColumn("{task.fields[rate]}"),
        TimeRemainingColumn(),
    )
    console = Console(file=sys.stderr, no_color=not has_colours(sys.stderr))
    start_time = time.monotonic()
    scene_count = attempt_count = 0
    with Progress(*columns, console=console, transient=True, redirect_stdout=False) as progress:
        task = progress.add_task(doing, total=count, rate="")

        def advance(scenes: int, attempts: int) -> None:
            nonlocal scene_count, attempt_count
            if attempts:
                scene_count, attempt_count = scene_count + scenes, attempt_count + attempts
            seconds = max(time.monotonic() - start_time, 1e-6)
            rate = (
                f"{scene_count / seconds:.3g}/s, {scene_count / attempt_count:.2g} accepted"
                if attempt_count
                else ""
            )
            progress.update(task, advance=scenes, rate=rate)

        yield advance


def find_convex_parts(scenario: "Scenario") -> None:
    """Search for convex parts of a program's meshes that no run has found so far, with a progress bar."""
    from scenic.batch.part_search import meshes_without_parts, search_parts

    meshes = meshes_without_parts(scenario)
    if meshes:
        with progress_bar(len(meshes), "finding convex parts of meshes", shown=True) as advance:
            search_parts(meshes, advance)


def announce_seed(seed: int, things: str) -> None:
    """Show the seed that was drawn for some things."""
    sys.stderr.write(f"seed {seed} (the same {things} again: --seed {seed})\n")


class _Terminated(BaseException):
    """SIGTERM has come. `SystemExit` would count as the program's own where its functions are being called."""


@contextmanager
def ended_by_signals() -> Iterator[None]:
    """Makes a polite request to end (SIGTERM) leave no half-written file behind, as Ctrl-C does not."""

    def end(_number: int, _frame: FrameType | None) -> None:
        raise _Terminated

    try:
        before = signal.signal(signal.SIGTERM, end)
    except ValueError:  # not in the main thread, where nobody can be interrupted
        yield
        return
    try:
        yield
    except _Terminated:
        raise SystemExit(128 + signal.SIGTERM) from None
    finally:
        signal.signal(signal.SIGTERM, before)
