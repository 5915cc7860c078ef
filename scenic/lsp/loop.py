"""What happens one after the other in the server's main thread, and what runs beside it."""

import heapq
import queue
import threading
import time
from collections.abc import Callable
from itertools import count
from typing import Final, TypeAlias

from scenic.ide.snapshot import Cancelled

__all__ = ["Job", "Loop", "Timer", "Worker"]

Action: TypeAlias = Callable[[], None]
Report: TypeAlias = Callable[[Exception], None]

_NEVER: Final = 3600.0
_COURTESY: Final = 0.05
"""So many seconds work beside the loop waits for it at a time."""
_PATIENCE: Final = 0.1
"""So many seconds a timer that is due waits for actions; then it is its turn, however many there are."""


class Timer:
    """Something that will be done at a time, unless it is called off."""

    __slots__ = ("_action",)

    def __init__(self, action: Action) -> None:
        self._action: Action | None = action

    def cancel(self) -> None:
        """Call it off; does nothing once it is done."""
        self._action = None

    def run(self) -> None:
        """Do it now, unless it was called off."""
        action, self._action = self._action, None
        if action is not None:
            action()


class Loop:
    """Runs actions one at a time: those that any thread hands in, in their order, and those whose time has come."""

    def __init__(self, report: Report) -> None:
        """``report`` is called with what an action or a timer raises; the loop then goes on."""
        self._report = report
        self._actions: queue.SimpleQueue[Action] = queue.SimpleQueue()
        self._timers: list[tuple[float, int, Timer]] = []
        self._count = count()
        self._stopped = False
        self._waiting = threading.Event()

    def put(self, action: Action) -> None:
        """Have an action done after those that are waiting; from any thread."""
        self._actions.put(action)

    def call_later(self, delay: float, action: Action) -> Timer:
        """Have an action done after so many seconds; in the loop's own thread only."""
        timer = Timer(action)
        heapq.heappush(self._timers, (time.monotonic() + delay, next(self._count), timer))
        return timer

    def give_way(self) -> None:
        """Wait until the loop has nothing to do, though not for long; for work beside it, which shares one processor."""
        self._waiting.wait(_COURTESY)

    def stop(self) -> None:
        """End after the present action; in the loop's own thread only."""
        self._stopped = True

    def run(self) -> None:
        """Work until `stop`."""
        while not self._stopped:
            wait = self._timers[0][0] - time.monotonic() if self._timers else _NEVER
            if wait > -_PATIENCE:
                # What is waiting comes before timers: a change that has arrived is seen before a check begins.
                action = self._next(max(0.0, wait))
                if action is not None:
                    self._do(action)
                    continue
            if self._timers and self._timers[0][0] <= time.monotonic():
                self._do(heapq.heappop(self._timers)[2].run)

    def fault(self, error: Exception) -> None:
        """Report what work beside the loop has raised; from any thread."""
        self.put(lambda: self._report(error))

    def _do(self, action: Action) -> None:
        try:
            action()
        except Exception as error:  # noqa: BLE001 - a fault in one action must not end the conversation
            self._report(error)

    def _next(self, patience: float) -> Action | None:
        """The next action; ``None`` if there is none for so many seconds."""
        self._waiting.set()
        try:
            return self._actions.get(timeout=patience)
        except queue.Empty:
            return None
        finally:
            self._waiting.clear()


class Job:
    """Work beside the loop. ``work`` is given the job, to ask it now and then whether to go on."""

    def __init__(self, work: Callable[["Job"], None], loop: Loop) -> None:
        self._work = work
        self._loop = loop
        self._cancelled = threading.Event()

    def cancel(self) -> None:
        """Say that the result is not wanted; from any thread."""
        self._cancelled.set()

    @property
    def is_cancelled(self) -> bool:
        """Whether the result is not wanted any more."""
        return self._cancelled.is_set()

    def go_on(self) -> None:
        """Let the loop go first; raise `Cancelled` if the result is not wanted any more."""
        self._loop.give_way()
        if self._cancelled.is_set():
            raise Cancelled

    def run(self) -> None:
        """Do the work, unless it was cancelled before it began."""
        if not self._cancelled.is_set():
            try:
                self._work(self)
            except Exception as error:  # noqa: BLE001 - the thread has other jobs to do
                self._loop.fault(error)


class Worker:
    """A thread that does jobs in their order."""

    def __init__(self, name: str) -> None:
        self._jobs: queue.SimpleQueue[Job] = queue.SimpleQueue()
        self._name = name
        self._started = False

    def put(self, job: Job) -> None:
        """Have a job done; the thread begins with the first one. In the loop's thread only."""
        if not self._started:
            self._started = True
            threading.Thread(target=self._run, name=self._name, daemon=True).start()
        self._jobs.put(job)

    def _run(self) -> None:
        while True:
            self._jobs.get().run()
