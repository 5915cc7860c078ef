"""When the server looks for garbage: while nobody waits for an answer."""

import gc
import time
from typing import Final

from scenic.lsp.loop import Loop

__all__ = ["Garbage"]

_PAUSE: Final = 3.0
"""Seconds without a message after which all garbage is looked for."""

_MANY: Final = 300_000
"""So many objects may be made before the young ones are looked at in any case."""

_OFTEN: Final = 100
"""After so many checks, all garbage is looked for."""


class Garbage:
    """Stands in for Python's own search, which may come in the middle of an answer and takes longer than that.

    Nearly all garbage is what parsing leaves: young, and found quickly once a check is done.
    """

    def __init__(self, loop: Loop) -> None:
        self._loop = loop
        self._last = 0.0
        self._is_due = False
        self._checks = 0

    def touched(self) -> None:
        """A message has come; in the loop's thread only."""
        self._last = time.monotonic()
        if gc.get_count()[0] > _MANY:
            gc.collect(1)
        if not self._is_due:
            self._is_due = True
            self._loop.call_later(_PAUSE, self._look)

    def checked(self) -> None:
        """A check is done, and its result is sent."""
        self._checks += 1
        if self._checks % _OFTEN:
            gc.collect(0)
        else:
            gc.collect()

    def _look(self) -> None:
        rest = self._last + _PAUSE - time.monotonic()
        if rest > 0:
            self._loop.call_later(rest, self._look)
        else:
            self._is_due = False
            gc.collect()
