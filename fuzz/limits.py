"""Time limits for a property on one text: an endless run is a failure like any other, and does not end the fuzzer."""

import signal
import threading
from collections.abc import Iterator
from contextlib import contextmanager
from types import FrameType
from typing import Final

__all__ = ["SECONDS", "TookTooLongError", "limited"]

SECONDS: Final = 20.0
"""Processor time for one property and one text, a thousand times what the dearest of them takes."""


class TookTooLongError(BaseException):
    """The time is over. No `Exception`, which the compiler or a tool may catch."""


@contextmanager
def limited(seconds: float) -> Iterator[None]:
    """Raise `TookTooLongError` in the block after ``seconds`` of processor time.

    Where there is no such timer (on Windows, and outside the main thread) nothing is limited.
    """
    if not hasattr(signal, "setitimer") or threading.current_thread() is not threading.main_thread():
        yield
        return
    before = signal.signal(signal.SIGVTALRM, _end)
    signal.setitimer(signal.ITIMER_VIRTUAL, seconds)
    try:
        yield
    finally:
        signal.setitimer(signal.ITIMER_VIRTUAL, 0)
        signal.signal(signal.SIGVTALRM, before)


def _end(_signal: int, _frame: FrameType | None) -> None:
    raise TookTooLongError
