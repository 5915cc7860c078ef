"""Loops over groups of different lengths, written as flat arrays in bounded pieces."""

from collections.abc import Iterator
from typing import NamedTuple

import numpy as np

from scenic.runtime.geometry.poses import Booleans, Floats, Indices


class Groups(NamedTuple):
    """Groups of consecutive elements: where each begins and how many it has, ``(n,)`` each."""

    starts: Indices
    counts: Indices

    def take(self, chosen: Indices) -> "Groups":
        """These groups."""
        return Groups(self.starts[chosen], self.counts[chosen])


def expand(counts: Indices) -> tuple[Indices, Indices]:
    """For groups of ``counts`` members: the group of each member, and its number within the group."""
    owner = np.repeat(np.arange(len(counts)), counts)
    offset = np.arange(len(owner)) - np.repeat(np.cumsum(counts) - counts, counts)
    return owner, offset


def first_of_each(keys: Indices) -> Indices:
    """Return the index of the first occurrence of each key, in ascending order of the keys."""
    # NumPy's `unique` does it, too, at the price of importing a quarter of NumPy when it is first called.
    order = np.argsort(keys, kind="stable")
    return order[_changes(keys[order])]


def distinct(numbers: Indices) -> Indices:
    """Return the different ones of integers of any shape, ascending."""
    ordered = np.sort(numbers, axis=None)
    return ordered[_changes(ordered)]


def _changes(ordered: Indices) -> Indices:
    """Return the indices at which a sorted array changes its value, including the first."""
    result = np.ones(len(ordered), dtype=np.bool_)
    np.not_equal(ordered[1:], ordered[:-1], out=result[1:])
    return np.flatnonzero(result)


def group_starts(keys: Indices, groups: int) -> Indices:
    """Return the starts of the groups 0, 1, ... in ascending ``keys``, and the end of the last: ``(groups + 1,)``."""
    return np.searchsorted(keys, np.arange(groups + 1))


def pieces(counts: Indices, most: int) -> Iterator[slice]:
    """Consecutive slices of the groups with about ``most`` members each, and at least one group."""
    total = np.cumsum(counts)
    start = 0
    while start < len(counts):
        before = int(total[start - 1]) if start else 0
        end = max(int(np.searchsorted(total, before + most, side="right")), start + 1)
        yield slice(start, end)
        start = end


def rows(count: int, width: int, most: int) -> Iterator[slice]:
    """Yield slices of ``count`` rows; each contains about ``most`` elements at ``width`` elements a row."""
    step = max(1, most // max(width, 1))
    for start in range(0, count, step):
        yield slice(start, min(start + step, count))


def choose(owner: Indices, weights: Floats, groups: int, numbers: Floats) -> tuple[Indices, Floats, Booleans]:
    """For each group, the member that a uniform number chooses by its weight.

    Args:
        owner: the group of each member, ascending.
        weights: of the members, not negative.
        groups: how many there are.
        numbers: uniform in (0, 1), one for each group.

    Returns:
        The members ``(groups,)``, the shares of their weights at which the numbers lie, uniform in [0, 1], and which groups have a
        member of a weight above 0.

    """
    starts = np.searchsorted(owner, np.arange(groups))
    counts = np.diff(np.append(starts, len(owner)))
    # A row for each group: its sums depend on no other group, in any bit.
    table = np.zeros((groups, max(int(counts.max(initial=0)), 1)))
    table[owner, np.arange(len(owner)) - starts[owner]] = weights
    sums = np.cumsum(table, axis=1)
    target = numbers * sums[:, -1]
    column = np.minimum((sums <= target[:, np.newaxis]).sum(axis=1), np.maximum(counts - 1, 0))
    every = np.arange(groups)
    before = np.where(column > 0, sums[every, column - 1], 0.0)
    weight = table[every, column]
    there = weight > 0
    share = np.where(there, (target - before) / np.where(there, weight, 1.0), 0.0)
    return np.minimum(starts + column, max(len(owner) - 1, 0)), np.clip(share, 0.0, 1.0), there
