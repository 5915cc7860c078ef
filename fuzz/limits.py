"""A limit on the time that a property takes: what never answers has to be found, too."""

import signal
import threading
from collections.abc import Iterator
from contextlib import contextmanager
from typing import Final

from fuzz.properties import Violation

__all__ = ["SECONDS", "TooSlow", "time_limit"]

SECONDS: Final = 15.0
"""So much processor time is enough for any property of any text that a run makes, many times over."""


class TooSlow(Violation):
    """A property has not answered in time."""


@contextmanager
def time_limit(seconds: float = SECONDS) -> Iterator[None]:
    """Raises `TooSlow` in what is done here after so many seconds of processor time.

    Only the main thread can be interrupted, and only where the system has such timers; elsewhere there is no limit.
    """
    if not hasattr(signal, "setitimer") or threading.current_thread() is not threading.main_thread():
        yield
        return

    def stop(_number: int, _frame: object) -> None:
        raise TooSlow(f"no answer after {seconds:g} seconds")

    before = signal.signal(signal.SIGVTALRM, stop)
    signal.setitimer(signal.ITIMER_VIRTUAL, seconds)
    try:
        yield
    finally:
        signal.setitimer(signal.ITIMER_VIRTUAL, 0)
        signal.signal(signal.SIGVTALRM, before)
