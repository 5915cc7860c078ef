"""Shrinking of failing texts of unknown origin: lines are removed, then tokens, then characters."""

import re
from collections.abc import Callable, Sequence
from typing import Final

__all__ = ["shrunk"]

_UNITS: Final = (
    re.compile(r"[^\n]*\n|[^\n]+"),
    re.compile(r"\n[ \t\f]*|[ \t\f]+|\w+|[^\w\s]|\s"),
    re.compile(r".", re.DOTALL),
)
"""Lines, rough tokens, characters."""
_MOST: Final = 2000
"""So many texts are tried."""


def shrunk(text: str, fails: Callable[[str], bool], *, most: int = _MOST) -> str:
    """Return a part of ``text`` for which ``fails`` holds as it does for ``text``, after trying at most ``most`` others."""
    budget = most

    def still_fails(candidate: str) -> bool:
        nonlocal budget
        budget -= 1
        return budget >= 0 and fails(candidate)

    before = None
    while text != before and budget > 0:
        before = text
        for unit in _UNITS:
            text = "".join(_without_needless(unit.findall(text), still_fails))
    return text


def _without_needless(units: Sequence[str], fails: Callable[[str], bool]) -> list[str]:
    """Leaves out runs of units, from long ones to single ones."""
    remaining = list(units)
    size = len(remaining)
    while size > 1:
        size = (size + 1) // 2
        start = 0
        while start < len(remaining):
            rest = remaining[:start] + remaining[start + size :]
            if len(rest) < len(remaining) and fails("".join(rest)):
                remaining = rest
            else:
                start += size
    return remaining
