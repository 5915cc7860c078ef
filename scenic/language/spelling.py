"""Distances of names, for "did you mean" and for warnings about misspelt properties."""

import re
from collections.abc import Iterable
from functools import lru_cache
from typing import Final

__all__ = [
    "distance",
    "is_slip",
    "nearest",
    "nearest_attribute",
    "nearest_option",
    "nearest_property",
    "related",
]


def distance(first: str, second: str, *, limit: int) -> int:
    """Number of single edits that turn one name into the other, or ``limit + 1`` if there are more than ``limit``.

    An edit inserts, deletes or replaces a character, or swaps two neighbours (the restricted Damerau-Levenshtein
    distance; the recurrence is that of Wagner and Fischer with the transposition of Lowrance and Wagner).
    """
    if abs(len(first) - len(second)) > limit:
        return limit + 1
    # Each edit gets rid of one character that the other name does not have.
    if len(set(first).difference(second)) > limit or len(set(second).difference(first)) > limit:
        return limit + 1
    return _distance_of_similar(first, second, limit)


@lru_cache(4096)  # While a program is written, most of its names stay the same.
def _distance_of_similar(first: str, second: str, limit: int) -> int:
    before_last: list[int] = []
    last = list(range(len(second) + 1))
    for i, a in enumerate(first, 1):
        row = [i]
        for j, b in enumerate(second, 1):
            best = min(last[j] + 1, row[j - 1] + 1, last[j - 1] + (a != b))
            if i > 1 and j > 1 and a == second[j - 2] and b == first[i - 2]:
                best = min(best, before_last[j - 2] + 1)
            row.append(best)
        if min(row) > limit:
            return limit + 1
        before_last, last = last, row
    return min(last[-1], limit + 1)


def is_slip(name: str, meant: str) -> bool:
    """Return whether ``name`` is hardly anything else than ``meant`` mistyped.

    That is one letter too many, missing, or swapped with its neighbour, in names of four letters or more; or a wrong
    one, but not the first, in names of six or more. Digits tell names apart, so they must agree.
    """
    if len(name) < 4 or (abs(len(name) - len(meant)) > 1 and name.isascii() and meant.isascii()):
        return False
    if _digits(name) != _digits(meant):
        return False
    if name.lower() == meant.lower():
        return True
    if distance(name, meant, limit=1) > 1:
        return False
    return len(name) != len(meant) or sorted(name) == sorted(meant) or (len(name) > 5 and name[0] == meant[0])


def _digits(name: str) -> str:
    return "".join(character for character in name if character.isdigit())


def nearest(name: str, candidates: Iterable[str], *, limit: int | None = None) -> str | None:
    """Return the candidate closest to ``name``, or ``None`` if none is close.

    Close means at most ``limit`` edits away; without a limit, a third of the name's length. So names of one or two
    letters are close to nothing but themselves in other letter case.
    Among equally close ones those that begin in the same letter case come first, then alphabetical order decides, so that
    messages do not vary.
    """
    reach = len(name) // 3 if limit is None else limit
    best = None
    for candidate in sorted(candidates, key=lambda each: (each[:1].isupper() != name[:1].isupper(), each)):
        edits = distance(name.lower(), candidate.lower(), limit=reach)
        if edits <= reach and candidate != name:
            best, reach = candidate, edits - 1
            if reach < 0:
                break
    return best


_WORD: Final = re.compile(r"[A-Z]?[a-z0-9]+|[A-Z]+(?![a-z])")


def related(name: str, candidates: Iterable[str]) -> str | None:
    """Return the only candidate that has all words of ``name``, or whose words ``name`` all has: ``leftLane`` for ``laneToLeft``.

    Words are those of names written in capitals or with underscores. ``None`` if several candidates are equally near.
    """
    words = _words(name)
    best: list[str] = []
    fewest = (_MOST_OTHER_WORDS + 1, False)
    for candidate in candidates:
        others = _words(candidate)
        if candidate == name or not words or not others or not (words <= others or others <= words):
            continue
        # A longer name is meant more often than a shorter one.
        distance_in_words = (len(words ^ others), not words <= others)
        if distance_in_words < fewest:
            best, fewest = [candidate], distance_in_words
        elif distance_in_words == fewest:
            best.append(candidate)
    return best[0] if len(best) == 1 else None


_MOST_OTHER_WORDS: Final = 2


def _words(name: str) -> frozenset[str]:
    return frozenset(word.lower().removesuffix("s") for word in _WORD.findall(name))


def nearest_option(name: str, options: Iterable[str]) -> str | None:
    """Return the one of a few options that is probably meant: the only one that begins so, or the nearest, one edit away if it is short."""
    known = list(options)
    begun = [each for each in known if name and each.lower().startswith(name.lower())]
    if len(begun) == 1:
        return begun[0]
    return nearest(name, known, limit=max(1, len(name) // 3))


def nearest_property(name: str, known: Iterable[str]) -> str | None:
    """Return the property that is probably meant by a name that is none: at most two edits away, unless the name is very short."""
    return nearest(name, known, limit=2) if len(name) > _SHORTEST else None


_SHORTEST = 3
"""Names of so few letters are near to all others."""


def nearest_attribute(error: BaseException) -> str | None:
    """Return the public attribute that is probably meant where one is missing; ``None`` for errors of other kinds."""
    if not isinstance(error, AttributeError) or not isinstance(error.name, str) or error.obj is None:
        return None
    return nearest(error.name, (name for name in dir(error.obj) if not name.startswith("_")))
