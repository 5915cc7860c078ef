"""The end of Python code of a program that runs longer than a time limit."""

import signal
from collections.abc import Iterator
from contextlib import contextmanager
from types import FrameType
from typing import Final

from scenic.language.errors import Located

__all__ = ["PATIENCE", "TimeLimitError", "limited"]

PATIENCE: Final = 10.0
"""Seconds after the time limit until candidates under way are given up; the engine itself looks at the time between rounds."""


@contextmanager
def limited(seconds: float | None, what: str, help: str) -> Iterator[None]:
    """Ends Python code of a program that runs longer than a number of seconds, if the system supports it.

    Raises `TimeLimitError` with the place that was reached; ``what`` says what was done for too long.
    """
    if seconds is None or not hasattr(signal, "setitimer"):
        yield
        return

    def end(_number: int, frame: FrameType | None) -> None:
        from scenic.compiler.tracebacks import locate

        raise _TimeIsOver(None if frame is None else locate(frame))

    try:
        before = signal.signal(signal.SIGALRM, end)
    except ValueError:  # not in the main thread
        yield
        return
    signal.setitimer(signal.ITIMER_REAL, seconds)
    try:
        yield
    except _TimeIsOver as over:
        (place,) = over.args
        raise TimeLimitError(
            what,
            span=None if place is None else place.span,
            filename=None if place is None else place.filename,
            help=help,
        ) from None
    finally:
        signal.setitimer(signal.ITIMER_REAL, 0)
        signal.signal(signal.SIGALRM, before)


class _TimeIsOver(BaseException):
    """Raised wherever the program is; no exception that it catches."""


class TimeLimitError(Located):
    """A program that runs longer than the time limit."""

    code = "SC608"
