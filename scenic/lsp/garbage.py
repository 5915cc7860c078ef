"""When the server looks for garbage: while nobody waits for an answer."""

import asyncio
import gc
import time
from typing import Final

__all__ = ["Garbage"]

_PAUSE: Final = 3.0
"""Seconds without a message after which all garbage is looked for."""

_MANY: Final = 1_000_000
"""So many objects may be made before garbage is looked for in any case."""


class Garbage:
    """Stands in for Python's own search, which may come in the middle of an answer and takes longer than that.

    What parsing and checking leave has no cycles: it is gone as soon as nobody holds it.
    """

    def __init__(self) -> None:
        self._last = 0.0
        self._is_due = False
        self._outdated: list[object] = []

    def touched(self) -> None:
        """A message has come; in the event loop only."""
        self._last = time.monotonic()
        if gc.get_count()[0] > _MANY:
            gc.collect()
        if not self._is_due:
            self._is_due = True
            asyncio.get_running_loop().call_later(_PAUSE, self._look)

    def outdate(self, version: object) -> None:
        """Hold a version of a document until the next one is checked: to give back its memory takes a while."""
        self._outdated.append(version)

    def checked(self) -> None:
        """A check is done, and its result is sent."""
        asyncio.get_running_loop().call_soon(self._outdated.clear)

    def _look(self) -> None:
        rest = self._last + _PAUSE - time.monotonic()
        if rest > 0:
            asyncio.get_running_loop().call_later(rest, self._look)
        else:
            self._is_due = False
            gc.collect()
            # What is left lives long: the next search does not go through it.
            gc.freeze()
