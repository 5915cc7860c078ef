"""Division of a component into groups that only meet: things each of which is valid by itself, unless two collide.

Draws that hang together by objects or requirements are a group (`scenic.runtime.sampling.alike`). Where all that joins groups is that
their objects must not collide, the law of a scene is the product of the groups' own laws, conditioned on no collision; so each
group is drawn until its own checks hold, and the groups are put together by halves (`scenic.runtime.sampling.pairing`).
"""

import time
from collections.abc import Sequence
from typing import Final

import numpy as np
from numpy.typing import NDArray

from scenic.dataclass import dataclass
from scenic.graph.batch import Batch
from scenic.graph.draws import LaneOwners, attempt_keys
from scenic.graph.node import Node
from scenic.runtime.geometry.ragged import expand
from scenic.runtime.sampling.alike import Aliased, Group, GroupKind, kinds_of
from scenic.runtime.sampling.checks import Check, CollisionCheck, Mask
from scenic.runtime.sampling.draw_blocks import Reads
from scenic.runtime.sampling.engine import Engine, Plan
from scenic.runtime.sampling.group_collisions import Bodies
from scenic.runtime.sampling.halving import JointCheck
from scenic.runtime.sampling.pending import Pending

__all__ = ["Apart", "attempts_at_kind", "rehearsed", "separated"]

FEWEST: Final = 4
"""Groups of a component that is divided so, at least."""

TRIED: Final = 512
"""Candidates for a group of each kind of which some must pass."""

OFTEN: Final = 0.8
"""The share of candidates of a crowd above which it is not divided."""

BUNCHED: Final = 0.05
"""The share of bunches of groups, put together at once, in which two collide, about."""

_MEMBERS: Final = 256
"""Groups of a kind that are rehearsed at a time."""

MOST_KINDS: Final = 16
"""Kinds of groups, at most, whatever their number: each is evaluated by itself."""


@dataclass(frozen=True, slots=True, eq=False)
class Apart:
    """Groups that only meet, each of which is a leaf of a component.

    Attributes:
        first: number of the first leaf.
        draws: the addresses of the draws of each leaf.
        kinds: the kinds of the groups.
        kind: the number of the kind of each group, ``(groups,)``.
        may_meet: which objects of different groups must not collide, ``(objects, objects)``.
        number: of the check of collisions among those of the whole plan.
        bunch: how many groups together hardly ever collide.
        crowding: how many others a group collides with on average where each is drawn by itself.

    """

    first: int
    draws: tuple[frozenset[int], ...]
    kinds: tuple[GroupKind, ...]
    kind: NDArray[np.intp]
    may_meet: NDArray[np.bool_]
    number: int
    bunch: int
    crowding: float

    @property
    def leaves(self) -> int:
        """The number of leaves."""
        return len(self.draws)

    @property
    def stop(self) -> int:
        """One more than the number of the last leaf."""
        return self.first + len(self.draws)

    def owners(self) -> dict[int, int]:
        """The numbers of the leaves that draws belong to, by address."""
        return {place: leaf for leaf, mine in enumerate(self.draws, self.first) for place in mine}


def separated(engine: Engine, plan: Plan, reads: Reads, leaf: int) -> Apart | None:
    """Return the division of a component into groups that only meet; ``None`` where it is not of that form.

    The leaves are numbered from ``leaf``.
    """
    collisions = [place for place, check in enumerate(plan.checks) if isinstance(check, CollisionCheck)]
    if len(collisions) != 1:
        return None
    (place,) = collisions
    check = plan.checks[place]
    assert isinstance(check, CollisionCheck)
    below = [reads.of(item.all) for item in check.objects]
    if any(not mine and not item.is_fixed for mine, item in zip(below, check.objects, strict=True)):
        return None
    joins = _Union()
    for mine in below:
        joins.add(mine)
    others = [(number, reads.of(one.nodes)) for number, one in enumerate(plan.checks) if number != place]
    for _, mine in others:
        joins.add(mine)
    groups = joins.groups()
    if len(groups) < FEWEST:
        return None
    owner = {draw: number for number, mine in enumerate(groups) for draw in mine}
    group_of = np.array([owner[next(iter(mine))] if mine else -1 for mine in below], dtype=np.intp)
    new_groups = _groups(
        plan,
        place,
        check,
        groups,
        group_of,
        [(number, owner[next(iter(mine))] if mine else 0) for number, mine in others],
    )
    kinds = kinds_of(new_groups, engine.plan.graph, engine.plan.domain)
    if len(kinds) > max(MOST_KINDS, len(groups) // 4) or not all(_passes(engine, kind) for kind in kinds):
        return None
    kind_of = np.empty(len(groups), dtype=np.intp)
    for number, kind in enumerate(kinds):
        kind_of[kind.members] = number
    one, two = check.pairs.T
    between = (group_of[one] != group_of[two]) & (group_of[one] >= 0) & (group_of[two] >= 0)
    may_meet = np.zeros((len(check.objects), len(check.objects)), dtype=np.bool_)
    may_meet[one[between], two[between]] = may_meet[two[between], one[between]] = True
    numbers = range(len(plan.checks)) if plan.numbers is None else plan.numbers
    chance = _chance_to_collide(engine, kinds, len(groups), may_meet)
    bunch = int(np.clip(np.sqrt(2 * BUNCHED / chance), 2, len(groups)))
    crowding = chance * np.count_nonzero(may_meet) / len(groups)
    return Apart(leaf, tuple(groups), tuple(kinds), kind_of, may_meet, numbers[place], bunch, crowding)


def _chance_to_collide(
    engine: Engine, kinds: Sequence[GroupKind], groups: int, may_meet: NDArray[np.bool_]
) -> float:
    """Return the share of pairs of bodies of different groups that collide though they must not, by candidates for some groups."""
    bodies = Bodies()
    pending = engine.pending([(0, k) for k in range(TRIED)])
    for kind in kinds:
        count = max(2, TRIED * len(kind.members) // groups)
        member = np.arange(count) * len(kind.members) // count
        scenes = np.arange(count) % TRIED
        batch = attempts_at_kind(engine, kind, pending, scenes, member, np.ones(count, dtype=np.int64))
        if len(batch.rows):
            bodies.add([item.body(batch) for item in kind.objects], kind.numbers[member[batch.rows]])
    pairs, collisions = bodies.pairs(may_meet)
    return (collisions + 0.5) / (pairs + 1)


def _groups(
    plan: Plan,
    place: int,
    collisions: CollisionCheck,
    draws: Sequence[frozenset[int]],
    group_of: NDArray[np.intp],
    others: Sequence[tuple[int, int]],
) -> list[Group]:
    """The groups with the checks that each makes by itself; ``others`` are checks, by number, and the groups that they belong to."""
    soft = [number for number, check in enumerate(plan.checks) if check.probability < 1]
    soft_places = dict(
        zip(soft, range(len(soft)) if plan.soft_places is None else plan.soft_places, strict=True)
    )
    numbers = range(len(plan.checks)) if plan.numbers is None else plan.numbers
    checks_of_group: list[list[tuple[int, Check]]] = [[] for _ in draws]
    for number, group in others:
        checks_of_group[group].append((number, plan.checks[number]))
    one, two = (group_of[collisions.pairs[:, side]] for side in (0, 1))
    inner = np.flatnonzero((one == two) | (one < 0) | (two < 0))
    inner = inner[np.maximum(one, two)[inner] >= 0]
    pairs: dict[int, list[int]] = {}
    for pair, group in zip(inner.tolist(), np.maximum(one, two)[inner].tolist(), strict=True):
        pairs.setdefault(group, []).append(pair)
    for group, mine in pairs.items():
        checks_of_group[group].append((place, collisions.of_pairs(collisions.pairs[mine])))
    members: list[list[int]] = [[] for _ in draws]
    for number, group in enumerate(group_of.tolist()):
        if group >= 0:
            members[group].append(number)
    return [
        Group(
            mine,
            tuple(
                JointCheck(check, numbers[number], soft_places.get(number))
                for number, check in sorted(checks, key=lambda item: (item[1].cost, item[0]))
            ),
            tuple(collisions.objects[number] for number in objects),
            tuple(objects),
        )
        for mine, checks, objects in zip(draws, checks_of_group, members, strict=True)
    ]


def _passes(engine: Engine, kind: GroupKind) -> bool:
    """Return whether some candidate for the first group of a kind passes its checks."""
    pending = engine.pending([(0, k) for k in range(TRIED)])
    scenes, zero = np.arange(TRIED), np.zeros(TRIED, dtype=np.intp)
    return len(attempts_at_kind(engine, kind, pending, scenes, zero, zero)) > 0


def attempts_at_kind(
    engine: Engine,
    kind: GroupKind,
    pending: Pending,
    scenes: NDArray[np.intp],
    member: NDArray[np.intp],
    attempts: NDArray[np.int64],
) -> Batch:
    """A batch of attempts ``(n,)`` at groups ``member`` ``(n,)`` of a kind, in some of the pending scenes, without those that fail a check."""
    batch = _batch(engine, kind, pending, scenes, member, attempts)
    for place, joint in enumerate(kind.joints):
        if not len(batch.rows):
            return batch  # operations need not work on no lane at all
        start_time = time.perf_counter()
        batch.need(joint.check.nodes)
        verdict = joint.check.test(batch)
        if joint.soft_place is not None:
            here = batch.rows
            verdict = verdict.unless(pending.inactive[scenes[here], kind.soft_places[member[here], place]])
        alive = verdict.passes
        engine.note(joint.number, len(alive), int(np.count_nonzero(alive)), time.perf_counter() - start_time)
        batch.keep(alive)
    if len(batch.rows):
        batch.need(_nodes(kind))
    return batch


def _batch(
    engine: Engine,
    kind: GroupKind,
    pending: Pending,
    scenes: NDArray[np.intp],
    member: NDArray[np.intp],
    attempts: NDArray[np.int64],
) -> Batch:
    lanes = LaneOwners(
        pending.seed[scenes], pending.k[scenes], attempts, attempt_keys(pending.key[scenes], attempts)
    )
    source = Aliased(engine.source_of(lanes), kind.addresses, kind.table, member)
    return engine.batch(source, domain=kind.domain)


def _nodes(kind: GroupKind) -> list[Node]:
    """Return the nodes of the bodies of a kind."""
    return [node for item in kind.objects for node in item.all]


def rehearsed(engine: Engine, apart: Apart) -> tuple[dict[int, Mask], int]:
    """The candidates of a rehearsal, made group by group instead of whole.

    Returns:
        Which of them meet each check of a group but for collisions, by its number in the plan, and how many meet all checks.

    """
    pending, count = engine.pending([(0, 0)]), engine.rehearsed_of
    bodies = Bodies()
    results: dict[int, Mask] = {}
    passes = np.ones(count, dtype=np.bool_)
    first, lane, part = [], [], []
    for kind in apart.kinds:
        for members in np.array_split(np.arange(len(kind.members)), -(-len(kind.members) // _MEMBERS)):
            member, attempts = np.repeat(members, count), np.tile(np.arange(count), len(members))
            batch = _batch(engine, kind, pending, np.zeros_like(member), member, attempts)
            batch.need([*(node for joint in kind.joints for node in joint.check.nodes), *_nodes(kind)])
            for place, joint in enumerate(kind.joints):
                holds = joint.check.test(batch).holds.reshape(len(members), count)
                passes &= holds.all(axis=0)
                if not isinstance(joint.check, CollisionCheck):
                    results |= zip(kind.checks[members, place].tolist(), holds, strict=True)
            row = bodies.add([item.body(batch) for item in kind.objects], kind.numbers[member])
            owner, offset = expand(np.full(len(row), len(kind.objects)))
            first.append(row[owner] + offset)
            lane.append(attempts[owner])
            part.append(kind.members[member[owner]])
    bodies_tested, lanes, parts = (np.concatenate(each) for each in (first, lane, part))
    order = np.argsort(lanes, kind="stable")
    passes &= bodies.apart(count, bodies_tested[order], lanes[order], parts[order], apart.may_meet)
    return results, int(np.count_nonzero(passes))


class _Union:
    """Sets of draws, joined where they share one; in the order of their first appearance."""

    def __init__(self) -> None:
        self._sets: dict[int, set[int]] = {}
        self._owner: dict[int, int] = {}
        self._count = 0

    def add(self, draws: frozenset[int]) -> None:
        """Join draws, and all that is joined with one of them."""
        if not draws:
            return
        owners = sorted({self._owner[place] for place in draws if place in self._owner})
        target = owners[0] if owners else self._count
        whole = self._sets.setdefault(target, set())
        self._count += not owners
        for number in owners[1:]:
            draws_of_other = self._sets.pop(number)
            whole |= draws_of_other
            self._owner.update(dict.fromkeys(draws_of_other, target))
        whole |= draws
        self._owner.update(dict.fromkeys(draws, target))

    def groups(self) -> list[frozenset[int]]:
        """The sets."""
        return [frozenset(self._sets[number]) for number in sorted(self._sets)]
