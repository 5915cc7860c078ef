"""When the server looks for garbage: while nobody waits for an answer."""

import asyncio
import gc
import time
from typing import Final

__all__ = ["Garbage"]

_PAUSE: Final = 3.0
"""Seconds without a message after which all garbage is looked for."""

_MANY: Final = 60_000
"""So many objects may be made before the young ones are looked at in any case."""

_BREATH: Final = 0.05
"""Seconds after a check without a message after which the young objects are looked at."""

_OFTEN: Final = 100
"""Number of checks between full garbage collections."""


class Garbage:
    """Stands in for Python's own search, which may come in the middle of an answer and takes longer than that.

    Nearly all garbage is what parsing leaves: young, and found quickly once a check is done.
    """

    def __init__(self) -> None:
        self._last = 0.0
        self._is_due = False
        self._checks = 0

    def touched(self) -> None:
        """A message has come; in the event loop only."""
        self._last = time.monotonic()
        if gc.get_count()[0] > _MANY:
            gc.collect(1)
        if not self._is_due:
            self._is_due = True
            asyncio.get_running_loop().call_later(_PAUSE, self._look)

    def checked(self) -> None:
        """A check is done, and its result is sent."""
        self._checks += 1
        if self._checks % _OFTEN == 0:
            gc.collect()
        else:
            # What is asked about the new version comes first.
            asyncio.get_running_loop().call_later(_BREATH, self._look_at_young)

    def _look_at_young(self) -> None:
        if time.monotonic() - self._last >= _BREATH:
            gc.collect(0)

    def _look(self) -> None:
        rest = self._last + _PAUSE - time.monotonic()
        if rest > 0:
            asyncio.get_running_loop().call_later(rest, self._look)
        else:
            self._is_due = False
            gc.collect()
