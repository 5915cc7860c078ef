"""When the server looks for garbage: while nobody waits for an answer."""

import gc
import time
from typing import Final

from scenic.lsp.loop import Loop

__all__ = ["Garbage"]

_PAUSE: Final = 3.0
"""Seconds without a message after which garbage is looked for."""

_MOST: Final = 2_000_000
"""So many objects may be made before it is looked for in any case."""


class Garbage:
    """Stands in for Python's own search, which may come in the middle of an answer and takes longer than that."""

    def __init__(self, loop: Loop) -> None:
        self._loop = loop
        self._last = 0.0
        self._is_due = False

    def touched(self) -> None:
        """A message has come; in the loop's thread only."""
        self._last = time.monotonic()
        if gc.get_count()[0] > _MOST:
            gc.collect()
        elif not self._is_due:
            self._is_due = True
            self._loop.call_later(_PAUSE, self._look)

    def _look(self) -> None:
        rest = self._last + _PAUSE - time.monotonic()
        if rest > 0:
            self._loop.call_later(rest, self._look)
        else:
            self._is_due = False
            gc.collect()
