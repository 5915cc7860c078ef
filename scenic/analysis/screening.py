"""The choice of conditions that are worth narrowing for, by candidates that were tried.

Conditions that most candidates meet can save few of them, whatever analysis finds. Which conditions remain decides
which scenes a seed gives: so it depends on the program alone, by candidates that are the same at each load.
"""

from collections.abc import Mapping, Sequence
from typing import Final

import numpy as np
from numpy.typing import NDArray

from scenic.analysis.facts import Fact
from scenic.graph.node import Node

__all__ = ["CROWD", "FREQUENT", "seldom_met"]

CROWD: Final = 48
"""Groups from which on each is judged by itself: things of a crowd are drawn apart, each until its own conditions hold."""

FREQUENT: Final = 0.8
"""The share of candidates, at least, that conditions meet together which are left out."""


def seldom_met(groups: Sequence[Sequence[Fact]], met: Mapping[Node, NDArray[np.bool_]]) -> list[list[Fact]]:
    """The groups of conditions without those that are met most often, as long as four of five candidates meet all of the latter.

    Within a group all remain: where some are met, others may be met less often than elsewhere.

    Args:
        groups: conditions, those of different groups about different draws.
        met: which of the candidates met a condition, ``(n,)``; groups with conditions of which this is not known remain.

    """
    masks = {
        number: np.logical_and.reduce([met[fact.node] for fact in group])
        for number, group in enumerate(groups)
        if all(fact.node in met for fact in group)
    }
    left_out: set[int] = set()
    passing = np.True_
    for number in sorted(masks, key=lambda number: -np.count_nonzero(masks[number])):
        passing = passing & masks[number]
        many = len(groups) > CROWD and np.mean(masks[number]) >= FREQUENT
        if np.mean(passing) < FREQUENT and not many:
            break
        left_out.add(number)
    return [list(group) for number, group in enumerate(groups) if number not in left_out]
