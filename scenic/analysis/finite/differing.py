"""Variables of which no two may have the same value: seats, slots, numbers that differ.

Their law is exact by dynamic programming over the set of values that are used (M. Held and R. Karp, "A dynamic programming
approach to sequencing problems", 1962, count the same states), whatever the weights, and however many places are forbidden.
For more values than that can count, draws follow a bound of the weights, and some of them are rejected.
"""

import math
from collections.abc import Mapping, Sequence
from typing import Final

import numpy as np
from numpy.typing import NDArray

from scenic.analysis.finite.tables import Table
from scenic.dataclass import dataclass
from scenic.graph.bounds import Floats
from scenic.graph.finite import BoundedDistinct, Distinct

__all__ = ["Differing", "differing"]

MOST_LABELS: Final = 20
"""Values in all, at most, of which sets are counted."""

MOST_BOUNDED_LABELS: Final = 64
"""Values in all, at most."""

LEAST: Final = 3
"""Variables, at least: two have a table of their own."""


@dataclass(frozen=True, slots=True, eq=False)
class Differing:
    """Variables that differ.

    Attributes:
        variables: their numbers.
        law: chooses their values.
        weight: the share of all combinations that the law takes, including those that it rejects.
        scopes: the scopes of the tables that its choices meet, if they do always.

    """

    variables: tuple[int, ...]
    law: Distinct | BoundedDistinct
    weight: float
    scopes: frozenset[frozenset[int]]


def differing(tables: Sequence[Table], weights: Mapping[int, Floats]) -> Differing | None:
    """The largest set of variables found of which no two may have values of one label; ``None`` where there is none."""
    pairs: dict[frozenset[int], Table] = {
        frozenset(table.scope): table for table in tables if len(table.scope) == 2
    }
    neighbours: dict[int, set[int]] = {}
    for pair in pairs:
        one, other = pair
        neighbours.setdefault(one, set()).add(other)
        neighbours.setdefault(other, set()).add(one)
    tried: set[int] = set()
    for start in sorted(neighbours, key=lambda variable: (-len(neighbours[variable]), variable)):
        if start in tried:
            continue
        found = _labelled(start, neighbours, pairs, weights)
        if found is not None:
            return found
        tried.add(start)
        if len(tried) == LEAST:
            break
    return None


def _labelled(
    start: int,
    neighbours: Mapping[int, set[int]],
    pairs: Mapping[frozenset[int], Table],
    weights: Mapping[int, Floats],
) -> Differing | None:
    """A set of variables around one, each pair of which differs, with labels of their values."""
    labels: dict[int, list[int]] = {start: list(range(len(weights[start])))}
    width = len(weights[start])
    for variable in sorted(neighbours[start]):
        if not all(variable in neighbours[member] for member in labels):
            continue
        mine: list[int] = []
        used = width
        for value in range(len(weights[variable])):
            clashes = {
                member: {
                    theirs[place]
                    for place in np.flatnonzero(~_row(pairs[frozenset((member, variable))], variable, value))
                }
                for member, theirs in labels.items()
            }
            named = set().union(*clashes.values())
            if len(named) > 1:
                break
            label = named.pop() if named else used
            used += label == used
            # Whoever has the label clashes with the value, in all places that have it.
            if any(
                (label in theirs) != (label in clashes[member])
                or any(
                    (there == label)
                    == bool(_row(pairs[frozenset((member, variable))], variable, value)[place])
                    for place, there in enumerate(theirs)
                )
                for member, theirs in labels.items()
            ):
                break
            mine.append(label)
        if len(mine) == len(weights[variable]):
            labels[variable] = mine
            width = used
    if len(labels) < LEAST:
        return None
    return _solved(labels, weights)


def _set_bits(width: int) -> np.ndarray[tuple[int], np.dtype[np.int8]]:
    """The number of bits that are set in each number of ``width`` bits."""
    counts = np.zeros(1, dtype=np.int8)
    for _ in range(width):
        counts = np.concatenate([counts, counts + np.int8(1)])
    return counts


def _row(table: Table, variable: int, value: int) -> np.ndarray[tuple[int], np.dtype[np.bool_]]:
    entries = table.allowed if table.scope[0] == variable else table.allowed.T
    return np.asarray(entries[value])


def _solved(labels: Mapping[int, list[int]], weights: Mapping[int, Floats]) -> Differing | None:
    every = sorted({label for mine in labels.values() for label in mine})
    width = len(every)
    if width > MOST_BOUNDED_LABELS:
        return None
    number = {label: place for place, label in enumerate(every)}
    members = sorted(labels)
    placed = [np.array([number[label] for label in labels[member]], dtype=np.intp) for member in members]
    mine = tuple(weights[member] for member in members)
    if width > MOST_LABELS:
        return _bounded(members, tuple(placed), mine, width)
    counts = _set_bits(width)
    completions = np.zeros(1 << width)
    completions[counts == len(members)] = 1.0
    for place in range(len(members) - 1, -1, -1):
        sums = np.bincount(placed[place], weights=weights[members[place]], minlength=width)
        sets = np.flatnonzero(counts == place)
        for label in np.flatnonzero(sums > 0).tolist():
            free = sets[(sets >> label) & 1 == 0]
            completions[free] += sums[label] * completions[free | (1 << label)]
    weight = float(completions[0])
    law = Distinct(tuple(placed), mine, completions)
    scopes = frozenset(
        frozenset((one, other)) for place, one in enumerate(members) for other in members[:place]
    )
    return Differing(tuple(members), law, weight, scopes)


def _bounded(
    members: Sequence[int], labels: tuple[NDArray[np.intp], ...], weights: tuple[Floats, ...], width: int
) -> Differing | None:
    """The same for many labels: the choices may clash, so that no table is met always."""
    if width < len(members):
        return Differing(
            tuple(members), BoundedDistinct(labels, weights, width, np.zeros(0, np.intp)), 0.0, frozenset()
        )
    clash = np.array([values.argmax() for values in weights], dtype=np.intp)
    shared = np.intersect1d(labels[0], labels[1])
    if not len(shared):
        return None
    for place in (0, 1):
        clash[place] = np.flatnonzero(labels[place] == shared[0])[0]
    law = BoundedDistinct(labels, weights, width, clash)
    largest = [np.bincount(mine, weights=each).max() for mine, each in zip(labels, weights, strict=True)]
    return Differing(tuple(members), law, math.exp(law.bound + float(np.log(largest).sum())), frozenset())
