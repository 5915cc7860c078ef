"""Division of a component into parts that are found apart, where few candidates pass its checks.

Things that hang together by their draws are *groups*. A candidate that fails for a fault of one group costs the draws of all; so
each group is drawn until its own checks hold, and the checks between groups are made of what was found.

Candidates for a half that pass the checks within it are found apart from those for the other half. Pairs of them are
candidates for the whole, of which only the checks between the halves are asked; one that fails loses two halves, not all
that was found within each. That is rejection at each level, so that the law stays that of the program (Arratia and DeSalvo,
"Probabilistic divide-and-conquer", 2016). A chain of n things takes a power of n candidates, not the n-th power of something.

Estimates of how often each check holds decide where to divide, and whether that pays; both are made by counts.
"""

from collections.abc import Sequence
from functools import cached_property
from itertools import pairwise
from typing import Final

import numpy as np
from numpy.typing import NDArray

from scenic.dataclass import dataclass
from scenic.graph.batch import Batch
from scenic.graph.node import Graph
from scenic.runtime.sampling.checks import Check, CollisionCheck
from scenic.runtime.sampling.draw_blocks import CheckPiece, Reads, blocks, merged, pieces
from scenic.runtime.sampling.engine import Engine, Plan

__all__ = ["Divider", "JointCheck", "Tree", "any_passes", "may_fault"]

CANDIDATES: Final = 128
"""Candidates on which it is estimated how often each check holds."""

TRIED: Final = 1024
"""Candidates for a component none of which may pass, or it is not divided."""

RARE: Final = 1e-3
"""A component is divided into halves of its draws if fewer candidates pass, by the estimates."""

SELDOM: Final = 0.1
"""A component is divided into groups if fewer candidates pass."""

GAIN: Final = 5
"""The factor by which draws must become fewer then."""

GROUP_GAIN: Final = 3
"""The same for groups, which are drawn side by side."""

OVERHEAD: Final = 0.5
"""The cost of a candidate for a part beside its draws, in blocks of draws."""

MOST_BLOCKS: Final = 256
"""Blocks of draws of a component, at most."""

MOST_GROUPS: Final = 2048
"""Groups of draws of a component, at most."""

MOST_PAIRS: Final = 32_000
"""Pairs of objects, at most, of each of which it is estimated how often it collides."""

MOST_CUTS: Final = 64
"""Places, at most, between which cuts are chosen where there are many groups."""

_APART: Final = -1
"""In the place of a cut: all blocks are found by themselves."""

_LEAST: Final = -600.0
"""Logarithms of probabilities below are taken for this."""


@dataclass(frozen=True, slots=True)
class JointCheck:
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
        halves: its parts, two or more; none of a leaf.

    """

    first: int
    stop: int
    draws: frozenset[int]
    joints: tuple[JointCheck, ...]
    chance: float
    halves: tuple["Tree", ...] | None = None

    @property
    def leaves(self) -> int:
        """The number of leaves."""
        return self.stop - self.first

    def owners(self) -> dict[int, int]:
        """The numbers of the leaves that draws belong to, by address."""
        if self.halves is None:
            return dict.fromkeys(self.draws, self.first)
        return {place: leaf for half in self.halves for place, leaf in half.owners().items()}


class Divider:
    """Divides components of a plan, by estimates on a batch of candidates, which is made when it is first needed.

    Args:
        engine: of the whole plan.
        plans: its components.
        reads: the draws of the plan.
        always: divide as far as possible, whether or not that pays.

    """

    def __init__(self, engine: Engine, plans: Sequence[Plan], reads: Reads, *, always: bool = False) -> None:
        self._engine = engine
        self._plans = plans
        self._reads = reads
        self._always = always

    @cached_property
    def _batch(self) -> Batch:
        engine = self._engine
        pending = engine.pending([(0, k) for k in range(CANDIDATES)])
        batch = engine.attempts_at(pending, np.arange(CANDIDATES), np.zeros(CANDIDATES, dtype=np.int64))
        checks = [check for plan in self._plans for check in plan.checks]
        engine.evaluate(batch, tuple(dict.fromkeys(node for check in checks for node in check.nodes)))
        return batch

    def divide(self, plan: Plan, leaf: int) -> Tree | None:
        """Return the division of a component, whose leaves are numbered from ``leaf``; ``None`` where that does not pay."""
        division = _divided(plan, self._reads, self._batch, leaf, self._always)
        if division is None:
            return None
        if not self._always and not division.is_seldom:
            part = self._engine if plan is self._engine.plan else self._engine.of_part(plan)
            if any_passes(part):
                return None
        return division.tree


def any_passes(engine: Engine) -> bool:
    """Return whether any of some candidates passes all checks of a plan; if so, it is not worth to be divided."""
    return engine.trial([(0, k) for k in range(min(TRIED, engine.most_lanes))]) > 0


@dataclass(frozen=True, slots=True)
class _Division:
    """A division that pays; ``is_seldom`` says that candidates are known to pass seldom, though some may."""

    tree: Tree
    is_seldom: bool


def _divided(plan: Plan, reads: Reads, batch: Batch, leaf: int, always: bool) -> _Division | None:
    """Return the division of a component, estimated on a batch of candidates, or ``None`` if dividing does not pay.

    The leaves are numbered from ``leaf``.
    """
    is_large = sum(map(_pairs, plan.checks)) > MOST_PAIRS
    found_pieces, units = pieces(reads, plan.checks, coarse=is_large)
    read = frozenset[int]().union(*(piece.read for piece in found_pieces))
    if is_large:
        holds = np.array([_holds(piece.check, batch) for piece in found_pieces])
    else:
        parts = [check.parts(batch) for check in plan.checks]
        holds = np.array(
            [
                np.logical_and.reduce([parts[piece.number][pair].holds for pair in piece.pairs or (0,)])
                for piece in found_pieces
            ]
        )
    passing = float(holds.all(axis=0).mean()) if len(holds) else 1.0
    ways = [(_grouped(plan, reads, units, read), SELDOM), (blocks(unit & read for unit in units), RARE)]
    for sets, most in ways:
        most_sets = MOST_GROUPS if most == SELDOM else MOST_BLOCKS
        if (
            not 1 < len(sets) <= most_sets
            or (is_large and most == RARE)
            or (passing > (0.0 if most == RARE else most) and not always)
        ):
            continue
        outline_of_plan = _Outline(sets, found_pieces, holds)
        if always or outline_of_plan.pays(most):
            return _Division(_tree(plan, outline_of_plan, leaf, always), most == SELDOM)
    return None


def _pairs(check: Check) -> int:
    return len(check.pairs) if isinstance(check, CollisionCheck) else 0


def _holds(check: Check, batch: Batch) -> NDArray[np.bool_]:
    verdict = check.test(batch)
    return verdict.holds if verdict.failed is None else verdict.holds & ~verdict.failed


def _grouped(
    plan: Plan, reads: Reads, units: Sequence[frozenset[int]], read: frozenset[int]
) -> list[frozenset[int]]:
    """The draws in groups: those of objects that share draws, then what other checks read alone."""
    groups: list[frozenset[int]] = []
    owner: dict[int, int] = {}
    objects = {
        id(item): item for check in plan.checks if isinstance(check, CollisionCheck) for item in check.objects
    }
    for mine in (reads.of(item.all) & read for item in objects.values()):
        group_numbers = sorted({owner[place] for place in mine if place in owner})
        whole = mine.union(*(groups[number] for number in group_numbers))
        for number in group_numbers:
            groups[number] = frozenset()
        target = group_numbers[0] if group_numbers else len(groups)
        if group_numbers:
            groups[target] = whole
        else:
            groups.append(whole)
        owner.update(dict.fromkeys(whole, target))
    groups = [group for group in groups if group]
    return blocks([*groups, *(unit & read for unit in units)])


class _Outline:
    """The blocks of a division, the checks within and between them, and estimates of how often these hold."""

    def __init__(
        self, sets: Sequence[frozenset[int]], found: Sequence[CheckPiece], holds: NDArray[np.bool_]
    ) -> None:
        self.sets = sets
        self.found = found
        number_of = {place: number for number, new in enumerate(sets) for place in new}
        self.spans = [
            (min(mine), max(mine)) if (mine := [number_of[place] for place in piece.read]) else (0, 0)
            for piece in found
        ]
        chances = [
            1 - piece.check.probability * (1 - max(float(mine.mean()), 0.5 / CANDIDATES))
            for piece, mine in zip(found, holds, strict=True)
        ]
        self.within = _within(len(sets), self.spans, np.log(chances))

    def pays(self, most: float) -> bool:
        """Return whether dividing makes draws enough fewer, where at most a share of candidates passes."""
        count = len(self.sets)
        cost, _ = _cheapest(self.within, always=False)
        whole = float(self.within[0, count])
        gain = GROUP_GAIN if most == SELDOM else GAIN
        return bool(whole < np.log(most) and count * np.exp(-whole) > gain * cost)


def _tree(plan: Plan, outlined: _Outline, leaf: int, always: bool) -> Tree:
    within = outlined.within
    _, cuts = _cheapest(within, always)
    soft = [index for index, check in enumerate(plan.checks) if check.probability < 1]
    places = range(len(soft)) if plan.soft_places is None else plan.soft_places
    soft_places = dict(zip(soft, places, strict=True))
    numbers = range(len(plan.checks)) if plan.numbers is None else plan.numbers
    pieces_by_cost = sorted(
        zip(outlined.found, outlined.spans, strict=True), key=lambda item: item[0].check.cost
    )

    def tree(start: int, stop: int, leaf: int, cut: int) -> Tree:
        if cut == _APART:
            edges = list(range(start, stop + 1))
        else:
            edges = [start, cut, stop] if cut else [start, stop]
        halves: list[Tree] = []
        for first, last in pairwise(edges) if cut else ():
            way = 0 if cut == _APART else int(cuts[first, last])
            halves.append(tree(first, last, halves[-1].stop if halves else leaf, way))
        inner = [*pairwise(edges)] if cut else []
        pieces_here = [
            piece
            for piece, (low, high) in pieces_by_cost
            if start <= low and high < stop and not any(first <= low and high < last for first, last in inner)
        ]
        chance = within[start, stop] - sum(within[first, last] for first, last in inner)
        return Tree(
            leaf,
            halves[-1].stop if halves else leaf + 1,
            frozenset[int]().union(*outlined.sets[start:stop]),
            _joints(pieces_here, numbers, soft_places),
            float(np.exp(chance)),
            tuple(halves) or None,
        )

    return tree(0, len(outlined.sets), leaf, int(cuts[0, len(outlined.sets)]))


def _joints(
    own: Sequence[CheckPiece], numbers: Sequence[int], soft_places: dict[int, int]
) -> tuple[JointCheck, ...]:
    """The checks of pieces, with pairs of one check together again."""
    together: dict[int, list[Check]] = {}
    for piece in own:
        together.setdefault(piece.number, []).append(piece.check)
    return tuple(
        JointCheck(check, numbers[number], soft_places.get(number))
        for number, checks in together.items()
        for check in merged(checks)
    )


def may_fault(plan: Plan) -> bool:
    """Return whether a value that a check reads may fail to be computed: then no part of a scene can be judged alone."""
    nodes = Graph(node for check in plan.checks for node in check.nodes).nodes
    return any(node.operation.may_fault(node.operands, node.payload, node.kind) for node in nodes)


def _within(count: int, spans: Sequence[tuple[int, int]], logs: NDArray[np.float64]) -> NDArray[np.float64]:
    """Return logarithms ``(count + 1, count + 1)`` of the chance that all checks within blocks ``i`` to ``j`` hold."""
    table = np.zeros((count + 1, count + 1))
    for (low, high), log in zip(spans, logs.tolist(), strict=True):
        table[low, high + 1] += log
    table = np.cumsum(table, axis=1)
    return np.maximum(np.cumsum(table[::-1], axis=0)[::-1], _LEAST)


def _cheapest(
    within: NDArray[np.float64], always: bool, limit: int = MOST_CUTS
) -> tuple[float, NDArray[np.intp]]:
    """Return the least cost of a scene, in blocks of draws, and for blocks ``i`` to ``j`` the place to cut.

    The place is 0 where they are not cut, and -1 where each block is found by itself, and all are joined at once. With ``always``
    they are cut wherever there are two.
    """
    count = len(within) - 1
    edges = np.arange(count + 1)
    if count > MOST_BLOCKS or not always:
        edges = np.unique(np.round(np.linspace(0, count, min(count, limit) + 1)).astype(np.intp))
    cost = np.zeros((count + 1, count + 1))
    cuts = np.zeros((count + 1, count + 1), dtype=np.intp)
    alone = within[np.arange(count), np.arange(1, count + 1)]
    sums = np.concatenate([[0.0], np.cumsum(alone)])
    costs = np.concatenate([[0.0], np.cumsum((1 + OVERHEAD) * np.exp(-alone))])
    for width in range(1, len(edges)):
        for number in range(len(edges) - width):
            start, stop = int(edges[number]), int(edges[number + width])
            length = stop - start
            cost[start, stop] = (length + OVERHEAD) * np.exp(-within[start, stop])
            if length == 1:
                continue
            apart = costs[stop] - costs[start] + length + OVERHEAD
            apart *= np.exp(min(sums[stop] - sums[start] - within[start, stop], -_LEAST))
            if apart < cost[start, stop] and not always:
                cost[start, stop], cuts[start, stop] = apart, _APART
            cut = edges[number + 1 : number + width]
            if not len(cut):
                continue
            between = within[start, stop] - within[start, cut] - within[cut, stop]
            costs_of_cuts = (cost[start, cut] + cost[cut, stop] + length + OVERHEAD) * np.exp(
                np.minimum(-between, -_LEAST)
            )
            best = int(costs_of_cuts.argmin())
            if costs_of_cuts[best] < cost[start, stop] or always:
                cost[start, stop], cuts[start, stop] = costs_of_cuts[best], cut[best]
    return float(cost[0, count]), cuts
