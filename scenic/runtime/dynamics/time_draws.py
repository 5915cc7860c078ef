"""Random numbers of one simulation: each a function of where in the program, and when, it is drawn.

The address of a draw is the running scenario, the agent whose behavior draws, the place in the program, and how many
draws there have been at that address before. So an agent that draws more than before changes nothing for the others, and a
simulation can be repeated, replayed from what was drawn, or driven by numbers from elsewhere.
"""

import hashlib
from collections.abc import Callable, Hashable, Mapping
from typing import NamedTuple, Protocol

from scenic.graph.draws import address

__all__ = ["Draw", "Draws", "Recorded", "Seeded", "Source"]


class Draw(NamedTuple):
    """A draw of a simulation in words: who draws, where and when.

    ``scenario`` numbers the running scenarios in the order in which they were made ready, from 1, the top-level one; ``agent`` is
    the place of the object whose behavior draws among those of the simulation, ``None`` for scenarios and monitors.
    ``line`` and ``column`` are the text of the line that draws and the place in it; ``occurrence`` counts the draws that have
    all these in common, and ``step`` those of the simulation.
    """

    scenario: int
    agent: int | None
    line: str
    column: int
    occurrence: int
    step: int


class Source(Protocol):
    """Gives numbers from (0, 1) by address."""

    def draw(self, place: int, what: Draw) -> float:
        """The number at an address of 64 bits."""

    def word(self, place: int) -> int:
        """Return 64 random bits at an address."""


class Seeded:
    """Numbers by hashing the address with a key.

    Args:
        key: of the simulation; any bytes of at most 64.

    """

    def __init__(self, key: bytes) -> None:
        self.key = key

    def draw(self, place: int, what: Draw) -> float:
        """The number at an address."""
        # 52 bits and a half: never 0 or 1.
        return ((self.word(place) >> 12) + 0.5) * 2.0**-52

    def word(self, place: int) -> int:
        """Return 64 random bits at an address."""
        digest = hashlib.blake2b(place.to_bytes(8, "little"), digest_size=8, key=self.key).digest()
        return int.from_bytes(digest, "little")


class Recorded:
    """The numbers of an earlier simulation, and those of another source where there are none.

    ``missing`` is called before the first number that is taken from elsewhere.
    """

    def __init__(
        self, numbers: Mapping[int, float], otherwise: Source, missing: Callable[[], None] = lambda: None
    ) -> None:
        self._numbers = dict(numbers)
        self._otherwise = otherwise
        self._missing = missing

    def word(self, place: int) -> int:
        """Return 64 random bits at an address."""
        return self._otherwise.word(place)

    def draw(self, place: int, what: Draw) -> float:
        """The number at an address."""
        number = self._numbers.pop(place, None)
        if number is not None:
            return number
        if self._numbers:
            # Not exhausted, and yet something else is drawn: the replay goes another way.
            self._missing()
        return self._otherwise.draw(place, what)


class Draws:
    """The source that the distributions of a running simulation draw from.

    Args:
        source: of the numbers.
        where: the scenario and the agent that draw, and the name of the place in the program (text of the line, column).
        now: the step of the simulation.
        keep: whether to remember what was drawn.
        on_random: called for each random number that is used.

    """

    def __init__(
        self,
        source: Source,
        where: Callable[[], tuple[int, int | None, tuple[str, int] | None]],
        now: Callable[[], int],
        *,
        keep: bool = True,
        on_random: Callable[[], None] | None = None,
    ) -> None:
        self._source = source
        self._on_random = on_random
        self._where = where
        self._now = now
        self._counts: dict[int, dict[Hashable, int]] = {}
        self._keep = keep
        self.made: list[tuple[int, float]] = []
        """Addresses and numbers so far, in order, if they are kept."""

    def random(self) -> float:
        """The next number, from (0, 1)."""
        self.report_use()
        where = self._where()
        scenario, agent, name = where
        counts = self._counts.setdefault(scenario, {})
        count = counts.get(where, 0)
        counts[where] = count + 1
        place = address(where, count)
        what = Draw(scenario, agent, *(name or ("", 0)), count, self._now())
        number = self._source.draw(place, what)
        if self._keep:
            self.made.append((place, number))
        return number

    def report_use(self) -> None:
        """Report that a random number is used, drawn here or by a generator that was seeded here."""
        if self._on_random is not None:
            self._on_random()

    def forget(self, scenario: int) -> None:
        """The scenario of this number will draw no more."""
        self._counts.pop(scenario, None)

    def seed(self, purpose: str) -> int:
        """Return 64 random bits for other purposes than a distribution; they are not among the recorded draws."""
        return self._source.word(address(purpose))
