"""A limit on the time of Python code that runs in this thread, with the place in the program that was reached."""

import signal
from collections.abc import Iterator
from contextlib import contextmanager
from types import FrameType

from scenic.compiler.tracebacks import locate
from scenic.language.errors import Located

__all__ = ["TrialTimeError", "within_seconds"]


class TrialTimeError(Located):
    """A program that runs longer than its trial may take."""

    code = "SC608"


@contextmanager
def within_seconds(seconds: float) -> Iterator[None]:
    """Raise `TrialTimeError` in the code that runs after a number of seconds, if the system supports it."""
    if not hasattr(signal, "setitimer"):
        yield
        return

    def end(_number: int, frame: FrameType | None) -> None:
        place = None if frame is None else locate(frame)
        # A program that catches the exception meets the next one soon.
        signal.setitimer(signal.ITIMER_REAL, 1.0)
        raise TrialTimeError(
            f"the program still runs after {seconds:g} s",
            span=None if place is None else place.span,
            filename=None if place is None else place.filename,
            help="look for a loop without end, or raise the limit by `--seconds`",
        )

    before = signal.signal(signal.SIGALRM, end)
    signal.setitimer(signal.ITIMER_REAL, seconds)
    try:
        yield
    finally:
        signal.setitimer(signal.ITIMER_REAL, 0)
        signal.signal(signal.SIGALRM, before)
