"""Variables of which no two may have the same value: seats, slots, numbers that differ.

Values get *labels*, so that two variables exclude each other where their labels are equal. For more labels than sets can be counted
of (`scenic.analysis.finite.occupying`), draws follow a bound of the weights, and some of them are rejected.
"""

import math
from collections.abc import Mapping, Sequence
from typing import Final

import numpy as np
from numpy.typing import NDArray

from scenic.analysis.finite.tables import Table
from scenic.dataclass import dataclass
from scenic.graph.bounds import Floats
from scenic.graph.finite import BoundedDistinct

__all__ = ["Differing", "bounded", "labelled"]

MOST_BOUNDED_LABELS: Final = 64
"""Values in all, at most."""

LEAST: Final = 3
"""Variables, at least: two have a table of their own."""


@dataclass(frozen=True, slots=True, eq=False)
class Differing:
    """Variables that differ, drawn under a bound.

    Attributes:
        variables: their numbers.
        law: chooses their values.
        weight: the share of all combinations that the law takes, including those that it rejects.

    """

    variables: tuple[int, ...]
    law: BoundedDistinct
    weight: float


def labelled(tables: Sequence[Table], sizes: Mapping[int, int]) -> dict[int, NDArray[np.intp]] | None:
    """Return the labels of the values of variables, from 0 on, any two of which exclude each other where labels are equal.

    Returns the largest such set of variables that is met, ``None`` where there is none.
    """
    pairs: dict[frozenset[int], Table] = {
        frozenset(table.scope): table for table in tables if len(table.scope) == 2
    }
    neighbours: dict[int, set[int]] = {}
    for pair in pairs:
        one, other = pair
        neighbours.setdefault(one, set()).add(other)
        neighbours.setdefault(other, set()).add(one)
    starts = sorted(neighbours, key=lambda variable: (-len(neighbours[variable]), variable))
    for start in starts[:LEAST]:
        labels = _labelled(start, neighbours, pairs, sizes)
        if len(labels) >= LEAST:
            number = {
                label: place
                for place, label in enumerate(sorted({i for row in labels.values() for i in row}))
            }
            return {
                member: np.array([number[label] for label in labels[member]], dtype=np.intp)
                for member in sorted(labels)
            }
    return None


def _labelled(
    start: int,
    neighbours: Mapping[int, set[int]],
    pairs: Mapping[frozenset[int], Table],
    sizes: Mapping[int, int],
) -> dict[int, list[int]]:
    """A set of variables around one, each pair of which differs, with labels of their values."""
    labels: dict[int, list[int]] = {start: list(range(sizes[start]))}
    width = sizes[start]
    for variable in sorted(neighbours[start]):
        if not all(variable in neighbours[member] for member in labels):
            continue
        mine: list[int] = []
        label_count = width
        for value in range(sizes[variable]):
            clashes = {
                member: {
                    theirs[place]
                    for place in np.flatnonzero(~_row(pairs[frozenset((member, variable))], variable, value))
                }
                for member, theirs in labels.items()
            }
            labels_around = set().union(*clashes.values())
            if len(labels_around) > 1:
                break
            label = labels_around.pop() if labels_around else label_count
            label_count += label == label_count
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
        if len(mine) == sizes[variable]:
            labels[variable] = mine
            width = label_count
    return labels


def _row(table: Table, variable: int, value: int) -> np.ndarray[tuple[int], np.dtype[np.bool_]]:
    entries = table.allowed if table.scope[0] == variable else table.allowed.T
    return np.asarray(entries[value])


def bounded(labels: Mapping[int, NDArray[np.intp]], weights: Mapping[int, Floats]) -> Differing | None:
    """Return the draw of variables that differ, under a bound, so that choices may clash; ``None`` where they have too many labels."""
    width = 1 + max(int(mine.max()) for mine in labels.values())
    if width > MOST_BOUNDED_LABELS:
        return None
    members = tuple(labels)
    labels_in_order = tuple(labels.values())
    mine = tuple(weights[member] for member in members)
    if width < len(members):
        return Differing(members, BoundedDistinct(labels_in_order, mine, width, np.zeros(0, np.intp)), 0.0)
    clash = np.array([values.argmax() for values in mine], dtype=np.intp)
    common_labels = np.intersect1d(labels_in_order[0], labels_in_order[1])
    if not len(common_labels):
        return None
    for place in (0, 1):
        clash[place] = np.flatnonzero(labels_in_order[place] == common_labels[0])[0]
    law = BoundedDistinct(labels_in_order, mine, width, clash)
    largest = [
        np.bincount(here, weights=each).max() for here, each in zip(labels_in_order, mine, strict=True)
    ]
    return Differing(members, law, math.exp(law.bound + float(np.log(largest).sum())))
