"""Recursive division of a component into halves where hardly any candidate passes its checks.

Candidates for a half that pass the checks within it are found apart from those for the other half. Pairs of them are
candidates for the whole, of which only the checks between the halves are asked; one that fails loses two halves, not all
that was found within each. That is rejection at each level, so that the law stays that of the program (Arratia and DeSalvo,
"Probabilistic divide-and-conquer", 2016). A chain of n things takes a power of n candidates, not the n-th power of something.

Estimates of how often each check holds decide where to divide, and whether that pays; both are made by counts.
"""

from collections.abc import Sequence
from typing import Final

import numpy as np
from numpy.typing import NDArray

from scenic.dataclass import dataclass
from scenic.graph.batch import Batch
from scenic.graph.node import Graph
from scenic.runtime.sampling.blocks import Piece, Reads, blocks, merged, pieces
from scenic.runtime.sampling.checks import Check
from scenic.runtime.sampling.engine import Engine, Plan

__all__ = ["Joint", "Tree", "any_passes", "divide"]

CANDIDATES: Final = 128
"""Candidates on which it is estimated how often each check holds."""

TRIED: Final = 1024
"""Candidates for a component none of which may pass, or it is not divided."""

RARE: Final = 1e-3
"""A component is divided if fewer candidates pass, by the estimates."""

GAIN: Final = 5
"""The factor by which draws must become fewer then."""

OVERHEAD: Final = 0.5
"""The cost of a candidate for a part beside its draws, in blocks of draws."""

MOST_BLOCKS: Final = 256
"""Blocks of draws of a component, at most."""

_LEAST: Final = -600.0
"""Logarithms of probabilities below are taken for this."""


@dataclass(frozen=True, slots=True)
class Joint:
    """A check that is made of candidates for a part.

    Attributes:
        check: the check.
        number: of the check among those of the whole plan.
        soft_place: of a soft requirement: its number among these.

    """

    check: Check
    number: int
    soft_place: int | None


@dataclass(frozen=True, slots=True)
class Tree:
    """A part of a component: a leaf with draws of its own, or two halves.

    Attributes:
        first: number of its first leaf.
        stop: one more than that of its last leaf.
        draws: of a leaf: the addresses of its draws.
        joints: checks that read draws of it, and not of one half alone.
        chance: how often candidates pass these, as far as is known before any was tried.
        halves: none of a leaf.

    """

    first: int
    stop: int
    draws: frozenset[int]
    joints: tuple[Joint, ...]
    chance: float
    halves: tuple["Tree", "Tree"] | None = None

    @property
    def leaves(self) -> int:
        """The number of leaves."""
        return self.stop - self.first

    def owners(self) -> dict[int, int]:
        """The numbers of the leaves that draws belong to, by address."""
        if self.halves is None:
            return dict.fromkeys(self.draws, self.first)
        return {**self.halves[0].owners(), **self.halves[1].owners()}


def divide(engine: Engine, plans: Sequence[Plan], *, always: bool = False) -> list[Tree | None]:
    """The division of components, ``None`` where that does not pay; leaves are numbered throughout.

    Args:
        engine: of the whole plan.
        plans: its components.
        always: divide as far as possible, whether or not that pays.

    """
    pending = engine.pending([(0, k) for k in range(CANDIDATES)])
    batch = engine.attempts_at(pending, np.arange(CANDIDATES), np.zeros(CANDIDATES, dtype=np.int64))
    engine.evaluate(
        batch, tuple(dict.fromkeys(node for plan in plans for check in plan.checks for node in check.nodes))
    )
    reads = Reads(engine.plan.graph, engine.plan.domain)
    trees: list[Tree | None] = []
    leaf = 0
    for plan in plans:
        tree = None if _may_fault(plan) else _divided(plan, reads, batch, leaf, always)
        if tree is not None and not always:
            part = engine if plan is engine.plan else engine.of_part(plan)
            if any_passes(part):
                tree = None
        trees.append(tree)
        leaf += 1 if tree is None else tree.leaves
    return trees


def any_passes(engine: Engine) -> bool:
    """Return whether any of some candidates passes all checks of a plan; if so, it is not worth to be divided."""
    return engine.trial([(0, k) for k in range(min(TRIED, engine.most_lanes))]) > 0


def _divided(plan: Plan, reads: Reads, batch: Batch, leaf: int, always: bool) -> Tree | None:
    """Return the division of a component as a tree of halves, estimated on a batch of candidates, or ``None``
    if dividing does not pay.

    The leaves are numbered from ``leaf``.
    """
    found, units = pieces(reads, plan.checks)
    read = frozenset[int]().union(*(piece.read for piece in found))
    news = blocks(unit & read for unit in units)
    if not 1 < len(news) <= MOST_BLOCKS:
        return None
    parts = [check.parts(batch) for check in plan.checks]
    holds = np.array(
        [
            np.logical_and.reduce([parts[piece.number][pair].holds for pair in piece.pairs or (0,)])
            for piece in found
        ]
    )
    if holds.all(axis=0).any() and not always:
        return None
    number_of = {place: number for number, new in enumerate(news) for place in new}
    spans = [
        (min(mine), max(mine)) if (mine := [number_of[place] for place in piece.read]) else (0, 0)
        for piece in found
    ]
    chances = [
        1 - piece.check.probability * (1 - max(float(mine.mean()), 0.5 / CANDIDATES))
        for piece, mine in zip(found, holds, strict=True)
    ]
    within = _within(len(news), spans, np.log(chances))
    cost, cuts = _cheapest(within, always)
    whole = float(within[0, len(news)])
    pays = whole < np.log(RARE) and len(news) * np.exp(-whole) > GAIN * cost
    if not pays and not always:
        return None
    soft = [index for index, check in enumerate(plan.checks) if check.probability < 1]
    places = range(len(soft)) if plan.soft_places is None else plan.soft_places
    soft_places = dict(zip(soft, places, strict=True))
    numbers = range(len(plan.checks)) if plan.numbers is None else plan.numbers
    ordered = sorted(zip(found, spans, strict=True), key=lambda item: item[0].check.cost)

    def tree(start: int, stop: int, leaf: int) -> Tree:
        cut = int(cuts[start, stop])
        halves = None
        if cut:
            first = tree(start, cut, leaf)
            halves = first, tree(cut, stop, first.stop)
        own = [
            piece
            for piece, (low, high) in ordered
            if start <= low and high < stop and (not cut or low < cut <= high)
        ]
        chance = within[start, stop] - (within[start, cut] + within[cut, stop] if cut else 0.0)
        return Tree(
            leaf,
            halves[1].stop if halves else leaf + 1,
            frozenset[int]().union(*news[start:stop]),
            _joints(own, numbers, soft_places),
            float(np.exp(chance)),
            halves,
        )

    return tree(0, len(news), leaf)


def _joints(own: Sequence[Piece], numbers: Sequence[int], soft_places: dict[int, int]) -> tuple[Joint, ...]:
    """The checks of pieces, with pairs of one check together again."""
    together: dict[int, list[Check]] = {}
    for piece in own:
        together.setdefault(piece.number, []).append(piece.check)
    return tuple(
        Joint(check, numbers[number], soft_places.get(number))
        for number, checks in together.items()
        for check in merged(checks)
    )


def _may_fault(plan: Plan) -> bool:
    """Return whether a value that a check reads may fail to be computed: then no part of a scene can be judged alone."""
    nodes = Graph(node for check in plan.checks for node in check.nodes).nodes
    return any(node.operation.may_fault(node.operands, node.payload, node.kind) for node in nodes)


def _within(count: int, spans: Sequence[tuple[int, int]], logs: NDArray[np.float64]) -> NDArray[np.float64]:
    """Logarithms ``(count + 1, count + 1)`` of the chance that all checks within blocks ``i`` to ``j`` hold."""
    table = np.zeros((count + 1, count + 1))
    for (low, high), log in zip(spans, logs.tolist(), strict=True):
        table[low, high + 1] += log
    table = np.cumsum(table, axis=1)
    return np.maximum(np.cumsum(table[::-1], axis=0)[::-1], _LEAST)


def _cheapest(within: NDArray[np.float64], always: bool) -> tuple[float, NDArray[np.intp]]:
    """Return the least cost of a scene, in blocks of draws, and for blocks ``i`` to ``j`` the place to cut (0: do not cut).

    With ``always`` they are cut wherever there are two.
    """
    count = len(within) - 1
    cost = np.zeros((count + 1, count + 1))
    cuts = np.zeros((count + 1, count + 1), dtype=np.intp)
    for length in range(1, count + 1):
        for start in range(count + 1 - length):
            stop = start + length
            cost[start, stop] = (length + OVERHEAD) * np.exp(-within[start, stop])
            if length == 1:
                continue
            cut = np.arange(start + 1, stop)
            between = within[start, stop] - within[start, cut] - within[cut, stop]
            divided = (cost[start, cut] + cost[cut, stop] + length + OVERHEAD) * np.exp(
                np.minimum(-between, -_LEAST)
            )
            best = int(divided.argmin())
            if divided[best] < cost[start, stop] or always:
                cost[start, stop], cuts[start, stop] = divided[best], cut[best]
    return float(cost[0, count]), cuts
