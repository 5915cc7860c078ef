"""Parts of a plan that have nothing to do with each other.

Draws and checks form a graph: a check joins the draws that it reads. Checks that cannot fail, and pairs of objects that are
always apart, join nothing. Each connected component is a sampling problem of its own; given the requirements, what one
draws is independent of the others, so that each may be looked for alone (`scenic.runtime.sampling.piecewise`).
"""

from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import replace
from itertools import accumulate
from typing import Any, Final

import numpy as np
from numpy.typing import NDArray

from scenic.dataclass import dataclass
from scenic.graph.bounding import over, overall
from scenic.graph.bounds import Bounds
from scenic.graph.node import Graph, Node
from scenic.graph.node_forms import Forms
from scenic.runtime.geometry.ragged import distinct
from scenic.runtime.sampling.apart import Apart, separated
from scenic.runtime.sampling.checks import Check, CollisionCheck, NodeCheck, ObjectNodes
from scenic.runtime.sampling.draw_blocks import Reads
from scenic.runtime.sampling.engine import Engine, Plan
from scenic.runtime.sampling.halving import SELDOM, Divider, Tree, may_fault

__all__ = ["Components", "components_of", "crowd_of", "divided"]

CROWD: Final = 64
"""Moving objects from which on a program is a crowd."""

_MARGIN: Final = 1e-9
"""Relative: what rounding may add to distances and sizes, with room to spare."""


@dataclass(frozen=True, slots=True)
class Components:
    """The components of a plan, in the order of their first checks.

    ``plans`` have the checks of one each. A component has one *leaf*, a set of draws with an attempt number of its own, or those of the
    tree into which it is divided. ``owner`` says to which leaf the draw at an address belongs; draws that no check reads, and are not
    there, to the first.
    """

    plans: tuple[Plan, ...]
    owner: Mapping[int, int]
    trees: tuple[Tree | Apart | None, ...]

    @property
    def leaves(self) -> int:
        """The number of leaves."""
        return sum(1 if tree is None else tree.leaves for tree in self.trees)

    @property
    def places(self) -> list[int]:
        """The number of the first leaf of each component."""
        counts = [1 if tree is None else tree.leaves for tree in self.trees]
        return [0, *accumulate(counts)][:-1]


def divided(engine: Engine, components: Components | None, *, always: bool = False) -> Components | None:
    """The components of the plan of an engine, with those divided where that pays (`scenic.runtime.sampling.halving`).

    Args:
        engine: of the whole plan.
        components: what `components_of` says of the plan.
        always: divide them whether or not that pays.

    """
    components_before = components or Components((engine.plan,), {}, (None,))
    reads = Reads(engine.plan.graph, engine.plan.domain)
    divider = Divider(engine, components_before.plans, reads, always=always)
    trees: list[Tree | Apart | None] = []
    leaf = 0
    for plan in components_before.plans:
        tree: Tree | Apart | None = None
        if not may_fault(plan):
            if not always and (len(components_before.plans) == 1 or _passes_seldom(engine, plan)):
                tree = separated(engine, plan, reads, leaf)
            tree = tree or divider.divide(plan, leaf)
        trees.append(tree)
        leaf += 1 if tree is None else tree.leaves
    if not any(trees):
        return components
    new_components = Components(components_before.plans, {}, tuple(trees))
    places = new_components.places
    owner = {place: places[number] for place, number in components_before.owner.items()}
    for tree in trees:
        owner |= tree.owners() if tree is not None else {}
    return Components(components_before.plans, owner, new_components.trees)


def crowd_of(engine: Engine) -> Apart | None:
    """Return the division of a plan of one component that is a crowd: so many groups that only meet that each is looked at by itself."""
    plan = engine.plan
    moving = [
        item
        for check in plan.checks
        if isinstance(check, CollisionCheck)
        for item in check.objects
        if not item.is_fixed
    ]
    if len(moving) < CROWD or may_fault(plan):
        return None
    return separated(engine, plan, Reads(plan.graph, plan.domain), 0)


def _passes_seldom(engine: Engine, plan: Plan) -> bool:
    """Return whether few of those candidates pass by which the whole is judged, so that other components do not matter."""
    return engine.of_part(plan).rehearsal() <= SELDOM * engine.rehearsed_of


def components_of(plan: Plan) -> Components | None:
    """The components of a plan; ``None`` where all hangs together."""
    joins = _Joins(plan)
    others: list[Check] = []
    for check in plan.checks:
        if isinstance(check, CollisionCheck):
            for item in check.objects:
                joins.add(item.all)
        else:
            others.append(check)
    for check in others:
        # Bounds cost more than what they save, but where something hangs on them.
        if not joins.would_join(check.nodes) or not _always_holds(check, overall(check.nodes[0])):
            joins.add(check.nodes)
    return None if joins.count < 2 else _split(plan)


def _split(plan: Plan) -> Components | None:
    joins, bounds = _Joins(plan), _Known(plan)
    meetings = [
        (index, _Meeting(check, check.pairs[_may_meet(check, bounds)], joins))
        for index, check in enumerate(plan.checks)
        if isinstance(check, CollisionCheck)
    ]
    rows: list[tuple[int, int, Check]] = []
    for index, check in enumerate(plan.checks):
        if isinstance(check, CollisionCheck):
            continue
        # Bounds cost more than what they save, but where something hangs on them.
        if not joins.would_join(check.nodes) or not _always_holds(check, bounds(check.nodes[0])):
            rows.append((index, joins.add(check.nodes), check))
    rows += [(index, member, check) for index, meeting in meetings for member, check in meeting.parts(joins)]
    rows.sort(key=_index)
    groups: dict[int, list[tuple[int, Check]]] = {}
    for index, member, check in rows:
        groups.setdefault(joins.leader(member) if joins.has_draws(member) else -1, []).append((index, check))
    constant_rows = groups.pop(-1, [])
    if len(groups) < 2:
        return None
    numbers = {leader: number for number, leader in enumerate(groups)}
    first, *others = groups.values()
    places = {
        index: place
        for place, index in enumerate(i for i, item in enumerate(plan.checks) if item.probability < 1)
    }
    plans = tuple(
        _part(plan, group, places) for group in (sorted([*constant_rows, *first], key=_index), *others)
    )
    owner: dict[int, int] = {}
    for node, leader in joins.draws():
        if leader in numbers:
            owner[plan.graph.address(node)] = numbers[leader]
    for places_of_factor, factor in zip(plan.domain.addresses(), joins.factors, strict=True):
        if factor is not None and joins.leader(factor) in numbers:
            owner.update(dict.fromkeys(places_of_factor.tolist(), numbers[joins.leader(factor)]))
    return Components(plans, owner, (None,) * len(plans))


def _index(item: tuple[Any, ...]) -> Any:
    return item[0]


class _Meeting:
    """The pairs of a check of collisions that may meet, whose objects' draws are joined."""

    def __init__(self, check: CollisionCheck, pairs: NDArray[np.intp], joins: "_Joins") -> None:
        self._check = check
        self._pairs = pairs
        self._members = np.zeros(len(check.objects), dtype=np.intp)
        moves = np.zeros(len(check.objects), dtype=np.bool_)
        for item in distinct(pairs).tolist():
            self._members[item] = joins.add(check.objects[item].all)
            moves[item] = joins.has_draws(int(self._members[item]))
        one, two = pairs.T
        # Of a pair of which one does not move the other one decides where it belongs.
        self._own = self._members[np.where(moves[one], one, two)]
        both = moves[one] & moves[two]
        for first, second in _chained(one[both], two[both], len(check.objects)).tolist():
            joins.join(int(self._members[first]), int(self._members[second]))

    def parts(self, joins: "_Joins") -> Iterator[tuple[int, CollisionCheck]]:
        """The checks of the pairs of each component, with members of these, when all is joined."""
        own, place = np.unique(self._own, return_inverse=True)
        leaders = np.array([joins.leader(member) for member in own.tolist()], dtype=np.intp)[place]
        for leader in distinct(leaders).tolist():
            mine = leaders == leader
            whole = mine.all() and len(mine) == len(self._check.pairs)
            yield leader, self._check if whole else self._check.of_pairs(self._pairs[mine])


def _chained(one: NDArray[np.intp], two: NDArray[np.intp], count: int) -> NDArray[np.intp]:
    """Return pairs ``(m, 2)``, fewer than ``count``, that connect what given pairs connect."""
    label = np.arange(count)
    while not (same := label[one] == label[two]).all():
        one, two = one[~same], two[~same]
        least = np.minimum(label[one], label[two])
        np.minimum.at(label, label[one], least)
        np.minimum.at(label, label[two], least)
        while not (label == label[label]).all():
            label = label[label]
    followers = np.flatnonzero(label != np.arange(count))
    return np.stack([label[followers], followers], axis=1)


def _part(plan: Plan, group: Sequence[tuple[int, Check]], places: Mapping[int, int]) -> Plan:
    checks = tuple(check for _, check in group)
    return replace(
        plan,
        checks=checks,
        outputs=(),
        bodies=sum(len(check.objects) for check in checks if isinstance(check, CollisionCheck)),
        numbers=tuple(index for index, _ in group),
        soft_places=tuple(places[index] for index, check in group if check.probability < 1),
        evaluated=Graph(node for check in checks for node in check.nodes).nodes,
    )


def _always_holds(check: Check, bounds: Bounds | None) -> bool:
    """Return whether bounds of its node show that a check passes in every lane, and nothing below it may fail."""
    if (
        not isinstance(check, NodeCheck)
        or bounds is None
        or bounds.lower.shape != (1,)
        or bounds.lower[0] < 1
    ):
        return False
    return not any(
        node.operation.may_fault(node.operands, node.payload, node.kind)
        or node.operation.may_reject(node.operands, node.payload, node.kind)
        for node in Graph([check.node]).nodes
    )


class _Known:
    """Bounds of nodes over the part of the cube that is sampled, computed once for nodes of one form."""

    def __init__(self, plan: Plan) -> None:
        self._axes = plan.graph.axes
        self._hull = plan.domain.hull
        self._known: dict[Node, Bounds | None] = {}
        self._answers: dict[int, Bounds | None] = {}
        lower, upper = self._hull[0][0].tolist(), self._hull[1][0].tolist()
        axes = self._axes
        self._forms = Forms(lambda node: (lower[axes[node]], upper[axes[node]]) if node.is_axis else None)

    def __call__(self, node: Node) -> Bounds | None:
        form = self._forms.number(node)
        if form not in self._answers:
            self._answers[form] = over([node], self._axes, *self._hull, self._known)[node]
        return self._answers[form]


def _may_meet(check: CollisionCheck, bounds: _Known) -> NDArray[np.bool_]:
    """Return a mask of the pairs of objects that may meet, judged by balls around the bounds of their positions."""
    spans = [_span(item, bounds) for item in check.objects]
    lower, upper = np.array([span[0] for span in spans]), np.array([span[1] for span in spans])
    radius = np.array([span[2] for span in spans])
    one, other = check.pairs.T
    with np.errstate(invalid="ignore"):
        gap = np.maximum(lower[one] - upper[other], lower[other] - upper[one])
        reach = (radius[one] + radius[other]) * (1 + _MARGIN)
        apart = np.square(np.maximum(gap, 0)).sum(axis=1) * (1 - _MARGIN) > np.square(reach)
    return ~np.asarray(apart)


def _span(item: ObjectNodes, bounds: _Known) -> tuple[NDArray[np.float64], NDArray[np.float64], float]:
    """Return bounds of an object's position, and the largest distance of its points from there: a mesh does
    not leave its box.
    """
    position, size = bounds(item.position), bounds(item.size)
    nowhere = np.full(3, np.inf)
    if position is None or size is None or position.lower.shape != (1, 3) or size.upper.shape != (1, 3):
        return -nowhere, nowhere, np.inf
    most = np.maximum(np.abs(size.lower[0]), np.abs(size.upper[0]))
    return position.lower[0], position.upper[0], float(np.linalg.norm(most)) / 2


class _Joins:
    """Union-find over draws: each set of nodes that is added joins the draws it depends on."""

    def __init__(self, plan: Plan) -> None:
        self._owner: dict[Node, int] = {}
        self._leaders: list[int] = []
        self._drawing: list[bool] = []
        self._random: dict[Node, bool] = {}
        for node in plan.graph.nodes:
            self._random[node] = node.is_drawn or any(self._random[operand] for operand in node.operands)
        axes = list(plan.graph.axes)
        self.factors = [
            self.add([axes[number] for number in numbers.tolist()]) if len(numbers) else None
            for numbers in plan.domain.joined_axes()
        ]
        """The sets of axes that are narrowed together, part by part."""

    @property
    def count(self) -> int:
        """The number of separate sets of draws."""
        return len({self.leader(member) for member in range(len(self._leaders)) if self._drawing[member]})

    def add(self, nodes: Iterable[Node]) -> int:
        """A set of nodes, whose draws are joined; its number."""
        member = len(self._leaders)
        self._leaders.append(member)
        self._drawing.append(False)
        stack = list(nodes)
        while stack:
            node = stack.pop()
            if not self._random[node]:
                continue
            self._drawing[member] = True
            owner = self._owner.get(node)
            if owner is not None:
                self.join(owner, member)
                continue
            self._owner[node] = member
            stack.extend(node.operands)
        return member

    def would_join(self, nodes: Iterable[Node]) -> bool:
        """Return whether adding a set of nodes would join draws that are apart yet."""
        leaders: set[int | Node] = set()
        nodes_done: set[Node] = set()
        stack = list(nodes)
        while stack and len(leaders) < 2:
            node = stack.pop()
            if node in nodes_done or not self._random[node]:
                continue
            nodes_done.add(node)
            if node in self._owner:
                leaders.add(self.leader(self._owner[node]))
            elif node.is_drawn:
                leaders.add(node)
            else:
                stack.extend(node.operands)
        return len(leaders) > 1

    def has_draws(self, member: int) -> bool:
        """Return whether any draw is below a set."""
        return self._drawing[member]

    def leader(self, member: int) -> int:
        """The number that stands for all that is joined with a set."""
        while self._leaders[member] != member:
            self._leaders[member] = self._leaders[self._leaders[member]]
            member = self._leaders[member]
        return member

    def join(self, one: int, other: int) -> None:
        """Join two sets; one without draws joins nothing."""
        if self._drawing[one] and self._drawing[other]:
            first, second = sorted((self.leader(one), self.leader(other)))
            self._leaders[second] = first

    def draws(self) -> list[tuple[Node, int]]:
        """All draws below the sets, with the leaders of these."""
        return [(node, self.leader(member)) for node, member in self._owner.items() if node.is_drawn]
