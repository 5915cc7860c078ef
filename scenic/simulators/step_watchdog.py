"""Notices code of a program that runs on and on without waiting, and names its line."""

import signal
import sys
import threading
import time
import warnings
from collections.abc import Callable
from types import FrameType
from typing import Any, Final

from scenic.language.errors import StuckBehaviorError, StuckBehaviorWarning

__all__ = ["STUCK_AFTER", "Watch", "patience"]

STUCK_AFTER: Final = 10.0
"""Seconds that code of a program may run in one step before that is worth a warning."""


_DELAYS: Final = 5
"""Number of times that a process which hardly ran in the meantime gets as many seconds again."""


def patience() -> float:
    """Return the seconds in force: those that a script has set as ``scenic.core.dynamics.stuckBehaviorWarningTimeout``, else `STUCK_AFTER`."""
    return float(getattr(sys.modules.get("scenic.core.dynamics"), "stuckBehaviorWarningTimeout", STUCK_AFTER))


class Watch:
    """Within this the program's code runs for one step.

    In the main thread of a system with interval timers a signal interrupts the code; elsewhere a thread only tells of it.

    Args:
        seconds: how long it may take.
        place: describes a frame: the behavior or similar that runs in it, and its line. Each is ``None`` if unknown.
        is_error: raise `StuckBehaviorError` instead of warning; only where a signal can interrupt the code.
        throughout: let the timer run on between steps, until `release`, which saves the time of setting it for each step, and tells
            up to half of the seconds later; only where what runs between steps bears an interruption.

    """

    def __init__(
        self,
        seconds: float,
        place: Callable[[FrameType], tuple[str | None, str | None]],
        *,
        is_error: bool,
        throughout: bool = False,
    ) -> None:
        self._seconds = seconds
        self._place = place
        self._is_error = is_error
        self._throughout = throughout
        self._before: Any = None
        self._timer: threading.Timer | None = None
        self._is_set = False
        self._delays = 0
        self._begun: float | None = None
        """The time at which the present step began; ``None`` between steps."""
        self._enough = 0.0
        """Processor time from which on the code has run while the timer did."""

    def __enter__(self) -> None:
        if not self._seconds:
            return
        self._begun, self._delays = time.monotonic(), 0
        if not self._is_set:
            self._set()

    def __exit__(self, *_details: object) -> None:
        self._begun = None
        if not self._throughout:
            self.release()

    def _set(self) -> None:
        if threading.current_thread() is not threading.main_thread():
            self._timer = threading.Timer(self._seconds, self._tell, (threading.get_ident(),))
            self._timer.daemon = True
            self._timer.start()
        elif hasattr(signal, "setitimer") and signal.getitimer(signal.ITIMER_REAL)[0] == 0:
            if self._before is None:
                self._before = signal.signal(signal.SIGALRM, self._alarm)
            self._wait(self._seconds)

    def _wait(self, seconds: float) -> None:
        self._enough, self._is_set = time.process_time() + seconds / 2, True
        signal.setitimer(signal.ITIMER_REAL, seconds)

    def release(self) -> None:
        """Stop the timer."""
        if self._timer is not None:
            self._timer.cancel()
            self._timer = None
        if self._before is not None:
            signal.setitimer(signal.ITIMER_REAL, 0)
            signal.signal(signal.SIGALRM, self._before)
            self._before, self._is_set = None, False

    def _message(self, frame: FrameType | None) -> str:
        runner, line = (None, None) if frame is None else self._place(frame)
        where = f", at {line}" if runner is not None and line is not None else ""
        return (
            f"{runner or line or 'the program'} has run for {self._seconds:g} s within one step of the simulation{where}; "
            "is there a loop without `take` or `wait`?"
        )

    def _alarm(self, _number: int, frame: FrameType | None) -> None:
        self._is_set = False
        if self._begun is None:
            return  # The next step sets it again.
        passed = time.monotonic() - self._begun
        if passed < 0.99 * self._seconds:  # set in an earlier step
            self._wait(max(self._seconds - passed, self._seconds / 2))
            return
        # On a busy or suspended machine the clock goes on while the code does not run.
        if time.process_time() < self._enough and self._delays < _DELAYS:
            self._delays, self._is_set = self._delays + 1, True
            signal.setitimer(signal.ITIMER_REAL, self._seconds)
            return
        if self._is_error:
            raise StuckBehaviorError(self._message(frame))
        warnings.warn(self._message(frame), StuckBehaviorWarning, stacklevel=2)

    def _tell(self, thread: int) -> None:
        warnings.warn(self._message(sys._current_frames().get(thread)), StuckBehaviorWarning, stacklevel=1)
