"""Arguments of calls that are under way in several places, numbered in their order."""

from collections.abc import Iterable
from typing import Generic, TypeVar

__all__ = ["Upcoming"]

_Argument = TypeVar("_Argument")


class Upcoming(Generic[_Argument]):
    """Arguments that are given out in order, each when there is a place for it.

    Args:
        arguments: taken one by one, so that later ones may depend on earlier results.
        spread: how far ahead of the oldest argument that is under way others are given out. A consumer that
            puts results in order keeps at most this many. No limit if ``None``.

    """

    def __init__(self, arguments: Iterable[_Argument], spread: int | None = None) -> None:
        self._arguments = enumerate(arguments)
        self._spread = spread
        self._under_way: dict[int, None] = {}  # in order, as they are given out
        self._given = 0

    def __len__(self) -> int:
        """Return how many are under way."""
        return len(self._under_way)

    def take(self) -> tuple[int, _Argument] | None:
        """The next argument with its number; ``None`` if there is none, or the oldest has to be finished first."""
        if self._spread is not None and self._under_way:
            oldest = next(iter(self._under_way))
            if self._given - oldest >= self._spread:
                return None
        upcoming = next(self._arguments, None)
        if upcoming is not None:
            self._given += 1
            self._under_way[upcoming[0]] = None
        return upcoming

    def finish(self, number: int) -> None:
        """Note that the result of an argument is there."""
        del self._under_way[number]
