"""Narrowing the cube to what the requirements allow, by interval arithmetic forward and backward (HC4).

Bounds go up from the axes to the conditions, which must be true, and back down through the operations' inverses, until
nothing moves (Benhamou, Goualard, Granvilliers and Puget, "Revising hull and box consistency", ICLP 1999). What remains
are boxes of cube axes, jointly, so that the law conditioned on the requirements is the same as before; a point is
dropped only if it certainly meets not all of them. In a dropped point a condition may have raised an exception instead of
being false; those scenes are lost either way.

All work is counted, never timed: the result decides which scenes a seed gives.
"""

import math
from collections import Counter
from collections.abc import Mapping, Sequence
from types import MappingProxyType
from typing import Final

import numpy as np
from numpy.typing import NDArray

from scenic.analysis.boxes import Boxes
from scenic.analysis.facts import Fact
from scenic.analysis.paving import POINTS, RARE, pave_by_trial, share_that_may_hold
from scenic.dataclass import dataclass
from scenic.graph import bounding
from scenic.graph.bounds import Bounds, Floats
from scenic.graph.domain import Domain
from scenic.graph.kinds import Kind
from scenic.graph.node import Graph, Node

Mask = NDArray[np.bool_]

ROUNDS: Final = 40
"""Passes over the graph for one set of boxes, at most."""

FIRST_ROUNDS: Final = 2
"""Passes after which contraction may stop: what one learns of inner nodes may help the next."""

CANDIDATES: Final = 1000
"""Candidates whose cost measures what narrowing may cost."""

TIMES: Final = 100
"""The work of narrowing, at most, over that of these candidates; bounds of a box are one element, as values of a lane are."""

MOST_WORK: Final = 5_000_000
"""Elements, at most, whatever the program (but for the first passes)."""

COSTLY: Final = 200_000
"""Elements after which a paving ends that has little left to gain."""

SCENES: Final = 50
"""Paving may take, at most, the work of the candidates that so many scenes need without it."""

OFTEN: Final = 0.25
"""The share of candidates that meet all conditions from which on paving, which would save three of four at most, must be nearly free."""

LEAST_WORK: Final = 30_000
"""Elements that paving may always cost where fewer meet them: some hundredths of a second."""

FREE: Final = 8_000
"""Elements that are nearly free: some milliseconds."""

FIXED: Final = 64
"""Elements that looking at a node costs, however few boxes there are."""

PROGRESS: Final = 1e-3
"""Contraction continues while some axis of some box loses at least this share."""

LARGEST_PAVING: Final = 256
"""Boxes of a paving, at most."""

SPLITS: Final = 16
"""Number of times that all boxes of a paving are split, at most."""

PATIENCE: Final = 4
"""Splits after which a paving ends that has lost nothing: most programs gain nothing by it, and shall not pay for all of it."""

STRIKES: Final = 2
"""Groups of conditions of one shape that gain nothing by it, after which others of that shape are left as they are."""

LARGEST_ENUMERATION: Final = 1024
"""Combinations of discrete values, at most, that are looked at one by one, where conditions are about nothing else."""

SPLIT_AXES: Final = 8
"""Conditions on more axes than these are not paved: too few boxes would fall to each."""

LARGEST_GROUP: Final = 32
"""Conditions of one group, at most, that are looked at one by one where the group is about too many axes."""

FEW_POINTS: Final = 64
"""Number of points that estimate how often a condition may hold."""

GAIN: Final = 0.7
"""Pavings are used if they leave less than this share of their hull together."""

FACTOR_GAIN: Final = 0.9
"""And only those that leave less than this share each."""


@dataclass(frozen=True, slots=True, eq=False)
class Pruning:
    """The result of contraction: the part of the cube that is left, and conditions that no point of the cube meets.

    Where ``impossible`` is not empty the domain is the whole cube.
    """

    domain: Domain
    impossible: tuple[Fact, ...]


def prune(graph: Graph, conditions: Sequence[Fact]) -> Domain:
    """Return the part of the cube in which the conditions can hold; the whole cube where they cannot hold at all."""
    return contract(graph, conditions).domain


def contract(
    graph: Graph, conditions: Sequence[Fact], met: Mapping[Node, Mask] = MappingProxyType({})
) -> Pruning:
    """Narrow the cube of ``graph`` to where all conditions can hold. Never samples.

    Args:
        graph: what the conditions are about.
        conditions: what must hold.
        met: which of some candidates met a condition, ``(n,)``, where that is known: what most of them meet is not paved.

    """
    network = _Network(graph, conditions)
    whole = Domain.whole(graph.dimension)
    if not network.axes:
        return Pruning(whole, _impossible_alone(graph, conditions))
    boxes = network.contract(Boxes(whole.lower, whole.upper))
    if len(boxes.lower) == 0:
        return Pruning(whole, _impossible_alone(graph, conditions))
    pavings = _pave(graph, conditions, boxes, met)
    if pavings is None:
        return Pruning(whole, _impossible_alone(graph, conditions))
    return Pruning(_product(boxes, pavings), ())


def surviving(graph: Graph, condition: Fact, boxes: Boxes) -> Mask:
    """Return the boxes ``(m,)`` in which a condition may hold, as far as bounds show."""
    _, alive = _Network(graph, [condition])._narrow(boxes)
    mask = np.zeros(len(boxes), dtype=np.bool_)
    mask[alive] = True
    return mask


def _pave(
    graph: Graph, conditions: Sequence[Fact], hull: Boxes, met: Mapping[Node, Mask]
) -> list[Boxes] | None:
    """Pavings of the hull, each of axes of its own: of groups of conditions that share no axis with other groups.

    ``None`` where some group cannot hold.
    """
    groups, work = independent(conditions), _work(graph, _share_met(conditions, met))
    if work > FREE:
        groups = [part for group in groups for part in _small_groups(graph, group, hull, met)]
    pavings: list[Boxes] = []
    vain: Counter[tuple[int, ...]] = Counter()
    for group in groups:
        if _share_met(group, met) >= FACTOR_GAIN:
            continue
        network = _Network(graph, group, work // len(groups))
        shape = len(group), len(network.inner), len(network.axes)
        if vain[shape] == STRIKES:
            continue
        paving = network.pave(hull)
        if len(paving.lower) == 0:
            return None
        axes = np.array(list(network.axes.values()), dtype=np.intp)
        vain[shape] += paving.volume(axes) > FACTOR_GAIN * hull.volume(axes)
        pavings.append(paving)
    return pavings


def _work(graph: Graph, share: float) -> int:
    """Return how many elements paving may evaluate where candidates meet all conditions with probability ``share``; 0 if that is not known."""
    if share >= OFTEN:
        return FREE
    candidates = min(TIMES * CANDIDATES, SCENES / share if share else math.inf)
    return max(LEAST_WORK, min(MOST_WORK, int(candidates * len(graph.nodes))))


def _share_met(conditions: Sequence[Fact], met: Mapping[Node, Mask]) -> float:
    """The share of candidates that met all of some conditions; 0 where that is not known."""
    masks = [met.get(condition.node) for condition in conditions]
    known = [mask for mask in masks if mask is not None]
    return float(np.mean(np.logical_and.reduce(known))) if len(known) == len(masks) else 0.0


def _small_groups(graph: Graph, group: list[Fact], hull: Boxes, met: Mapping[Node, Mask]) -> list[list[Fact]]:
    """The group itself; if it is about too many axes to be paved, groups of those of its conditions that seldom hold.

    A condition that often holds, as that things lie in a wide room, tells little, but joins all that is asked of them.
    """
    if len(group) == 1 or len(_Network(graph, group).axes) <= SPLIT_AXES or len(group) > LARGEST_GROUP:
        return [group]
    seldom = []
    is_whole = float((hull.upper - hull.lower).prod()) > 1 - PROGRESS
    for condition in group:
        if is_whole and _share_met([condition], met) >= RARE:
            continue  # in a narrower hull it may be met less often
        network = _Network(graph, [condition])
        axes = np.array(sorted(network.axes.values()), dtype=np.intp)
        if 0 < len(axes) <= SPLIT_AXES and share_that_may_hold(network.once, hull, axes, FEW_POINTS) < RARE:
            seldom.append(condition)
    return independent(seldom)


def independent(conditions: Sequence[Fact]) -> list[list[Fact]]:
    """The conditions in groups, in order, such that no axis is below conditions of two of them."""
    leader: dict[Node, int] = {}
    groups: dict[int, list[Fact]] = {}
    for number, condition in enumerate(conditions):
        axes = [node for node in nodes_below([condition.node]) if node.is_axis]
        group_numbers = sorted({leader[axis] for axis in axes if axis in leader})
        mine = group_numbers[0] if group_numbers else number
        for other in group_numbers[1:]:
            groups[mine] += groups.pop(other)
        groups.setdefault(mine, []).append(condition)
        other_numbers = set(group_numbers[1:])
        leader = (
            {axis: mine if group in other_numbers else group for axis, group in leader.items()}
            if other_numbers
            else leader
        )
        leader.update(dict.fromkeys(axes, mine))
    return list(groups.values())


def _product(hull: Boxes, pavings: Sequence[Boxes]) -> Domain:
    """Return the part of the cube that lies in all pavings; a paving that is hardly smaller than its hull is replaced by the hull."""
    lower, upper = hull.lower.copy(), hull.upper.copy()
    unions: list[tuple[Mask, Boxes]] = []
    left = 1.0
    for paving in pavings:
        least, most = paving.lower.min(axis=0), paving.upper.max(axis=0)
        is_narrow = (paving.lower != hull.lower).any(axis=0) | (paving.upper != hull.upper).any(axis=0)
        lower[0, is_narrow], upper[0, is_narrow] = least[is_narrow], most[is_narrow]
        share = paving.volume(is_narrow) / float((most - least)[is_narrow].prod())
        if share < FACTOR_GAIN:
            unions.append((is_narrow, paving))
            left *= share
    if left >= GAIN:
        return Domain(lower, upper)
    # The axes of the first union are as it says, those of no union as in the hull; each other union is a factor.
    factors = []
    for is_narrow, paving in unions[1:]:
        factors.append(Domain(np.where(is_narrow, paving.lower, 0.0), np.where(is_narrow, paving.upper, 1.0)))
        lower[0, is_narrow], upper[0, is_narrow] = 0.0, 1.0
    is_narrow, paving = unions[0]
    return Domain(
        np.where(is_narrow, paving.lower, lower), np.where(is_narrow, paving.upper, upper), tuple(factors)
    )


def _impossible_alone(graph: Graph, conditions: Sequence[Fact]) -> tuple[Fact, ...]:
    """Return the conditions that are impossible by themselves, or all of them where it takes several."""
    whole = Domain.whole(graph.dimension)
    alone = []
    for condition in conditions:
        network = _Network(graph, [condition])
        if len(network.contract(Boxes(whole.lower, whole.upper)).lower) == 0:
            alone.append(condition)
    if alone:
        return tuple(alone)
    left = _Network(graph, conditions).contract(Boxes(whole.lower, whole.upper))
    impossible = len(left.lower) == 0 or _pave(graph, conditions, left, {}) is None
    return tuple(conditions) if impossible else ()


def _moved(before: Boxes, after: Boxes, alive: Mask) -> bool:
    """Return whether some axis of a remaining box lost enough to continue."""
    old = before.upper[alive] - before.lower[alive]
    new = after.upper[alive] - after.lower[alive]
    return bool((new < (1 - PROGRESS) * old).any())


def nodes_below(conditions: Sequence[Node]) -> list[Node]:
    """Return the nodes below some conditions that readings of bounds look at, operands first."""
    order: dict[Node, None] = {}
    stack = [(node, 0) for node in reversed(conditions)]
    while stack:
        node, position = stack.pop()
        if node in order:
            continue
        operands = node.operation.bounding(node.operands, node.payload)
        if position < len(operands):
            stack.append((node, position + 1))
            stack.append((operands[position], 0))
        else:
            order[node] = None
    return list(order)


def _evaluated(conditions: Sequence[Node]) -> set[Node]:
    """Return the nodes that are evaluated wherever the conditions are: what has no value there has no solution."""
    found, stack = set(conditions), list(conditions)
    while stack:
        node = stack.pop()
        if node.operation.strict:
            new = [operand for operand in node.operands if operand not in found]
            found.update(new)
            stack.extend(new)
    return found


def _never_empty(bounds: Bounds) -> Bounds:
    """Return bounds that are infinite in the boxes where the given ones are empty: the value may not be needed there."""
    empty = bounds.empty()
    if not empty.any():
        return bounds
    empty = empty if bounds.lower.ndim == 1 else empty[:, np.newaxis]
    return Bounds(np.where(empty, -np.inf, bounds.lower), np.where(empty, np.inf, bounds.upper))


class _Network:
    """The nodes below some conditions that readings of bounds look at, in the order of evaluation."""

    def __init__(self, graph: Graph, conditions: Sequence[Fact], work: int = MOST_WORK) -> None:
        self.conditions = [condition.node for condition in conditions]
        self.order = nodes_below(self.conditions)
        self.axes = {node: graph.axes[node] for node in self.order if node.is_axis}
        self.inner = [node for node in self.order if not node.is_axis and not node.is_constant]
        self.evaluated = _evaluated(self.conditions)
        self._work = work
        self._cuts: dict[int, Floats] = {}
        """Of the axes of discrete distributions, by number: where the value changes."""
        for node in self.inner:
            cuts = None if node.operation.cuts is None else node.operation.cuts(node.payload, node.operands)
            if cuts is not None:
                axis = next(operand for operand in node.operands if operand.is_axis)
                self._cuts[self.axes[axis]] = cuts

    def contract(self, boxes: Boxes, first: int = FIRST_ROUNDS) -> Boxes:
        """Return the boxes narrowed, in more than ``first`` passes at least; those that hold no solution are left out."""
        return self._narrow(boxes, first)[0]

    def _narrow(self, boxes: Boxes, first: int = 0) -> tuple[Boxes, NDArray[np.intp]]:
        """Return the boxes narrowed as `contract` does, and which of them are left."""
        cost = max(1, len(self.inner)) * (FIXED + len(boxes))
        rounds = max(FIRST_ROUNDS, min(ROUNDS, self._work // cost))
        state = _State(self, boxes)
        for number in range(rounds):
            before = boxes
            self._work -= cost
            with np.errstate(all="ignore"):
                state.forward()
                state.backward()
            boxes = state.boxes(before)
            if not state.alive.any():
                break
            if number >= first and not _moved(before, boxes, state.alive):
                break
        alive = np.flatnonzero(state.alive)
        return boxes.taken(alive), alive

    def once(self, boxes: Boxes) -> Boxes:
        """Return the boxes narrowed as long as that helps."""
        return self.contract(boxes, first=0)

    def pave(self, boxes: Boxes) -> Boxes:
        """Split boxes along the axes below the conditions and narrow the parts, up to a number of boxes."""
        axes = np.array(sorted(self.axes.values()))
        if not 0 < len(axes) <= SPLIT_AXES or len(self.inner) * (FIXED + POINTS) > self._work:
            return boxes
        are_few = self._combinations() <= LARGEST_ENUMERATION
        share = 1.0 if are_few else share_that_may_hold(self.once, boxes, axes)
        if share >= FACTOR_GAIN and not are_few:
            return boxes
        if share < RARE:
            costly = self._work - COSTLY
            return pave_by_trial(
                self._narrow,
                boxes,
                axes,
                share,
                self._cuts,
                lambda: self._work <= costly,
                lambda: self._work <= 0,
            )
        volume = boxes.volume(axes)
        patience, largest = PATIENCE, LARGEST_PAVING
        if are_few:
            patience, largest = SPLITS, LARGEST_ENUMERATION
        for number in range(SPLITS):
            if not 0 < len(boxes.lower) <= largest // 2 or self._work <= 0:
                break
            if number == patience and boxes.volume(axes) > (1 - PROGRESS) * volume:
                break
            halves, whole = self._halved(boxes, axes)
            if not len(halves.lower):
                break
            halves = self.once(halves)
            boxes = Boxes(
                np.concatenate([whole.lower, halves.lower]), np.concatenate([whole.upper, halves.upper])
            )
        return boxes

    def _combinations(self) -> float:
        """The number of combinations of values of the axes; infinite if an axis is continuous."""
        return math.prod(
            len(self._cuts[axis]) + 1 if axis in self._cuts else math.inf for axis in self.axes.values()
        )

    def _halved(self, boxes: Boxes, axes: NDArray[np.intp]) -> tuple[Boxes, Boxes]:
        """Return both halves of each box, cut along its widest axis, and the boxes that cannot be halved.

        Axes of discrete distributions are cut between two of their values.
        """
        lower, upper = boxes.lower[:, axes], boxes.upper[:, axes]
        widths, ends, starts = upper - lower, (lower + upper) / 2, (lower + upper) / 2
        for column, axis in enumerate(axes.tolist()):
            cuts = self._cuts.get(axis)
            if cuts is None:
                continue
            first = np.searchsorted(cuts, lower[:, column], side="right")
            last = np.searchsorted(cuts, upper[:, column], side="right")
            widths[:, column] = np.where(first < last, widths[:, column], 0.0)
            if len(cuts):
                starts[:, column] = cuts[np.minimum((first + last) // 2, len(cuts) - 1)]
                ends[:, column] = np.nextafter(starts[:, column], 0.0)
        splits = widths.max(axis=1) > 0
        rows, widest = np.flatnonzero(splits), widths[splits].argmax(axis=1)
        left, right = boxes.upper[rows].copy(), boxes.lower[rows].copy()
        each = np.arange(len(rows))
        left[each, axes[widest]] = ends[rows, widest]
        right[each, axes[widest]] = starts[rows, widest]
        halves = Boxes(np.concatenate([boxes.lower[rows], right]), np.concatenate([left, boxes.upper[rows]]))
        return halves, Boxes(boxes.lower[~splits], boxes.upper[~splits])


class _State:
    """Bounds of every node over a set of boxes, tightened pass by pass."""

    def __init__(self, network: _Network, boxes: Boxes) -> None:
        self._network = network
        self.alive: Mask = np.ones(len(boxes.lower), dtype=np.bool_)
        """Boxes in which all conditions may still hold."""
        self._bounds: dict[Node, Bounds] = {}
        """Bounds known so far, by node; an entry is replaced only by narrower bounds, so that unchanged nodes
        are not read again."""
        self._forward: dict[Node, list[Bounds | None]] = {}
        self._inverse: dict[Node, tuple[list[Bounds | None], Sequence[Bounds | None]]] = {}
        self._told: dict[tuple[Node, int], tuple[Bounds, Mask]] = {}
        for node in network.order:
            if node.is_axis:
                axis = network.axes[node]
                self._bounds[node] = Bounds(boxes.lower[:, axis].copy(), boxes.upper[:, axis].copy())
            elif node.is_constant:
                bounds = bounding.of_constant(node)
                if bounds is not None:
                    self._bounds[node] = bounds

    def forward(self) -> None:
        """From the operands to the results, and on to the conditions, which must hold."""
        for node in self._network.inner:
            operands = [self._bounds.get(operand) for operand in node.operands]
            if _same(self._forward.get(node), operands):
                continue
            self._forward[node] = operands
            new = bounding.forward(node, operands)
            if new is not None:
                self._narrow(node, new if node in self._network.evaluated else _never_empty(new))
        for node in self._network.conditions:
            if node.kind is Kind.BOOLEAN:
                self._narrow(node, Bounds.exactly(1.0))

    def backward(self) -> None:
        """Narrow operands from the conditions down to the axes, through nodes that every solution evaluates."""
        masks: dict[Node, Mask] = dict.fromkeys(self._network.conditions, np.ones_like(self.alive))
        for node in reversed(self._network.inner):
            mask = masks.get(node)
            if mask is None or not mask.any():
                continue
            parts = self._inverted(node)
            for position, (operand, part) in enumerate(zip(node.operands, parts, strict=True)):
                here = mask
                if part is not None:
                    here = mask & (np.True_ if node.operation.strict else _speaks(part))
                    last_call = self._told.get((node, position))
                    if (
                        last_call is None
                        or last_call[0] is not part
                        or not np.array_equal(last_call[1], here)
                    ):
                        self._told[node, position] = part, here
                        self._narrow(operand, _only(here, part))
                elif not node.operation.strict:
                    continue
                masks[operand] = masks[operand] | here if operand in masks else here

    def _inverted(self, node: Node) -> Sequence[Bounds | None]:
        """Return bounds of the node's operands, derived from the node's own bounds by the inverse of its operation."""
        inverse, result = node.operation.inverse, self._bounds.get(node)
        operands = [self._bounds.get(operand) for operand in node.operands]
        nothing = [None] * len(operands)
        if inverse is None or result is None:
            return nothing
        blind = node.operation.strict and not node.operation.partial
        if blind and any(operand is None for operand in operands):
            return nothing
        last_result = self._inverse.get(node)
        if last_result is not None and _same(last_result[0], [result, *operands]):
            return last_result[1]
        parts = [
            bounding.integral(operand.kind, part)
            for operand, part in zip(node.operands, inverse(node.payload, result, *operands), strict=True)
        ]
        self._inverse[node] = [result, *operands], parts
        return parts

    def _narrow(self, node: Node, new: Bounds) -> None:
        old = self._bounds.get(node)
        if old is not None:
            if old.lower.shape[1:] != new.lower.shape[1:]:
                return
            new = old.meet(new)
            if (new.lower == old.lower).all() and (new.upper == old.upper).all():
                return
        # A value that is no number has come from an operation on infinities: nothing is known.
        new = Bounds(
            np.where(np.isnan(new.lower), -np.inf, new.lower),
            np.where(np.isnan(new.upper), np.inf, new.upper),
        )
        self.alive = self.alive & ~new.empty()
        self._bounds[node] = new

    def boxes(self, before: Boxes) -> Boxes:
        """Return the boxes as the bounds of the axes now are."""
        lower, upper = before.lower.copy(), before.upper.copy()
        for node, axis in self._network.axes.items():
            lower[:, axis], upper[:, axis] = self._bounds[node].lower, self._bounds[node].upper
        self.alive = self.alive & (lower <= upper).all(axis=1)
        # A single point of an axis keeps a little volume, so that it can still be drawn.
        point = lower == upper
        lower = np.where(point & (upper == 1), np.nextafter(lower, 0), lower)
        upper = np.where(point & (upper < 1), np.nextafter(upper, 1), upper)
        return Boxes(lower, upper)


def _same(before: Sequence[Bounds | None] | None, now: Sequence[Bounds | None]) -> bool:
    """Return whether bounds are the same objects as when they were last read."""
    return before is not None and all(a is b for a, b in zip(before, now, strict=True))


def _speaks(part: Bounds | None) -> Mask:
    """Return a mask of the boxes for which a non-strict inverse bounds an operand, so that the operand is evaluated there."""
    if part is None:
        return np.zeros(1, dtype=np.bool_)
    finite = np.isfinite(part.lower) | np.isfinite(part.upper) | (part.lower > part.upper)
    return np.asarray(finite if finite.ndim == 1 else finite.any(axis=1))


def _only(mask: Mask, part: Bounds | None) -> Bounds:
    assert part is not None
    wide = mask if part.lower.ndim == 1 else mask[:, np.newaxis]
    return Bounds(np.where(wide, part.lower, -np.inf), np.where(wide, part.upper, np.inf))
