"""Work beside the event loop: in threads, answered by futures, and given up when nobody wants the answer any more."""

import threading
from collections.abc import Callable
from concurrent.futures import Future, InvalidStateError, ThreadPoolExecutor
from typing import Final, TypeAlias, TypeVar

from scenic.ide.snapshot import Cancelled

__all__ = ["GoOn", "Workers"]

_T = TypeVar("_T")

GoOn: TypeAlias = Callable[[], None]
"""Called by work now and then: lets the event loop go first, and raises `Cancelled` if the answer is not wanted."""

_COURTESY: Final = 0.05
"""So many seconds work waits at a time for an event loop that is busy, with which it shares one processor."""


class Workers:
    """Threads that do work in its order. ``idle`` is set while the event loop waits for messages."""

    def __init__(self, name: str, idle: threading.Event, *, threads: int = 1) -> None:
        self._idle = idle
        self._threads = ThreadPoolExecutor(threads, thread_name_prefix=name)

    def begin(self, work: Callable[[GoOn], _T]) -> Future[_T]:
        """Have work done. Its future can be cancelled, or given an error, also while the work is under way."""
        future: Future[_T] = Future()

        def go_on() -> None:
            self._idle.wait(_COURTESY)
            if future.done():
                raise Cancelled

        def run() -> None:
            if future.done():
                return
            try:
                result = work(go_on)
            except Cancelled:
                return
            except Exception as error:  # noqa: BLE001 - whoever waits for the answer is told
                _settle(lambda error=error: future.set_exception(error))  # type: ignore[misc]
            else:
                _settle(lambda: future.set_result(result))

        self._threads.submit(run)
        return future


def _settle(answer: Callable[[], None]) -> None:
    try:
        answer()
    except InvalidStateError:
        return  # Somebody has cancelled it a moment ago.
