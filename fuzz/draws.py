"""Sources of the generator's decisions: Hypothesis, which can shrink them, or a plain source of random numbers.

Both give whole numbers, one for each decision, so that the decisions that a plain source made can be given to Hypothesis
to be made again (`replayed`). That is what happens once a program breaks a property: making a program with Hypothesis
takes ten times as long as with a plain source.
"""

import random
from collections.abc import Callable, Iterable, Sequence
from functools import cache
from typing import Final, Protocol, TypeVar

from hypothesis import strategies as st
from hypothesis.database import ExampleDatabase, choices_to_bytes
from hypothesis.strategies import DrawFn, SearchStrategy

__all__ = ["Draws", "HypothesisDraws", "RandomDraws", "replayed"]

_Made = TypeVar("_Made")


class Draws(Protocol):
    """A source of decisions."""

    def number(self, below: int) -> int:
        """A number from 0 to ``below - 1``. Smaller ones should mean simpler things: shrinking leads to them."""

    def part(self, make: Callable[[str], _Made], rule: str) -> _Made:
        """Return ``make(rule)`` as a separate part: shrinking tries to leave out parts, or to replace one by another."""


class RandomDraws:
    """Plain random numbers; ``choices`` holds those given so far."""

    def __init__(self, seed: int) -> None:
        self._random: Final = random.Random(seed).random
        self.choices: list[int] = []

    def number(self, below: int) -> int:
        if below == 1:
            return 0
        number = int(self._random() * below)
        self.choices.append(number)
        return number

    def part(self, make: Callable[[str], _Made], rule: str) -> _Made:
        return make(rule)

    def pick(self, below: int) -> int:
        """A number that is not noted."""
        return int(self._random() * below)

    def extend(self, choices: Iterable[int]) -> None:
        """Note choices that were made before, as if they had been made now."""
        self.choices += choices


class HypothesisDraws:
    """Numbers drawn from Hypothesis."""

    def __init__(self, draw: DrawFn) -> None:
        self._draw: Final = draw

    def number(self, below: int) -> int:
        return 0 if below == 1 else self._draw(_below(below))

    def part(self, make: Callable[[str], _Made], rule: str) -> _Made:
        return self._draw(_part(make, rule))


@cache
def _below(bound: int) -> SearchStrategy[int]:
    return st.integers(0, bound - 1)


@st.composite
def _part(draw: DrawFn, make: Callable[[str], _Made], rule: str) -> _Made:
    # Hypothesis wants ``draw`` to be used; ``make`` uses the one around it, which draws from the same source.
    assert draw is not None
    return make(rule)


def replayed(choices: Sequence[int]) -> ExampleDatabase:
    """Return a database of one example: with it and `hypothesis.Phase.reuse`, a test begins with these choices."""
    return _Replay(choices_to_bytes(choices))


class _Replay(ExampleDatabase):
    """A database for Hypothesis that always returns one example, and stores nothing."""

    def __init__(self, example: bytes) -> None:
        super().__init__()
        self._example = example

    def fetch(self, key: bytes) -> Iterable[bytes]:
        # Under the key itself Hypothesis keeps what it need not shrink any more, under this one what it should.
        return (self._example,) if key.endswith(b".secondary") else ()

    def save(self, key: bytes, value: bytes) -> None:
        pass

    def delete(self, key: bytes, value: bytes) -> None:
        pass
