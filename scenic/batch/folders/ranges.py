"""Parts of a numbered whole: each holds a range of numbers, and is named by it."""

from collections.abc import Iterable, Sequence
from itertools import pairwise

__all__ = ["gaps", "part_name", "ranges_to_make"]

Range = tuple[int, int]
"""The first number, and the number after the last."""


def part_name(numbers: Range) -> str:
    """The name of a part without its suffix: parts with different numbers have different names, which sort as the numbers do."""
    first, last = numbers
    return f"part-{first:08d}-{last - 1:08d}"


def gaps(whole: Range, parts: Iterable[Range]) -> list[Range]:
    """Return the ranges of ``whole`` that no part holds; the parts do not overlap."""
    first, last = whole
    bounds = [(first, first), *sorted(parts), (last, last)]
    return [
        (max(first, before), min(last, after))
        for (_, before), (after, _) in pairwise(bounds)
        if max(first, before) < min(last, after)
    ]


def ranges_to_make(whole: Range, size: int, parts: Sequence[Range]) -> list[Range]:
    """The gaps of ``whole`` between parts, cut at every ``size`` numbers from its first on."""
    first = whole[0]
    return [
        (max(start, begin), min(stop, begin + size))
        for start, stop in gaps(whole, parts)
        for begin in range(first + (start - first) // size * size, stop, size)
    ]
