"""Groups of draws that are alike: the same values, checks and bodies, made of other draws.

A crowd of a hundred cars is a hundred groups of one *kind*. Attempts at all of them are evaluated as lanes of one batch, by the
nodes of the first: each lane reads the draws of its own group, at the addresses that correspond. As operations act on each lane by
itself, that gives the values that the group's own nodes have, to the last bit.
"""

from collections.abc import Hashable, Iterator, Sequence

import numpy as np
from numpy.typing import NDArray

from scenic.dataclass import dataclass
from scenic.graph.domain import Domain
from scenic.graph.draws import Counter, NumberSource, Words, mix, open_unit
from scenic.graph.node import Graph, Node
from scenic.runtime.geometry.ragged import distinct
from scenic.runtime.sampling.checks import CollisionCheck, ObjectNodes
from scenic.runtime.sampling.halving import JointCheck
from scenic.runtime.shapes.shapes import Shape

__all__ = ["Aliased", "Group", "GroupKind", "kinds_of"]


@dataclass(frozen=True, slots=True, eq=False)
class Group:
    """Draws that hang together, with the checks that read no others.

    Attributes:
        draws: the addresses of the draws.
        joints: the checks.
        objects: the objects that depend on the draws.
        numbers: the numbers of the objects among all that may collide.

    """

    draws: frozenset[int]
    joints: tuple[JointCheck, ...]
    objects: tuple[ObjectNodes, ...]
    numbers: tuple[int, ...]


@dataclass(frozen=True, slots=True, eq=False)
class GroupKind:
    """Groups that are alike, evaluated by the nodes of the first.

    Attributes:
        members: the numbers of the groups, ascending, ``(m,)``.
        joints: the checks of the first.
        objects: the objects of the first.
        numbers: the numbers of the objects of each group, ``(m, objects)``.
        domain: what its draws are narrowed to.
        addresses: addresses of the first group's draws, ascending, ``(d,)``.
        table: the corresponding addresses of all groups, ``(d, m)``.
        checks: the numbers of each group's checks among those of the whole plan, ``(m, joints)``.
        soft_places: the numbers of each group's soft requirements among all of them, ``(m, joints)``; -1 for others.

    """

    members: NDArray[np.intp]
    joints: tuple[JointCheck, ...]
    objects: tuple[ObjectNodes, ...]
    numbers: NDArray[np.intp]
    domain: Domain
    addresses: Words
    table: Words
    checks: NDArray[np.intp]
    soft_places: NDArray[np.intp]


class Aliased:
    """The source of lanes each of which is an attempt at one group of a kind, by the addresses of the first group.

    Args:
        source: the draws of the lanes.
        addresses: those of the first group, ascending, ``(d,)``.
        table: the corresponding ones of all groups, ``(d, m)``.
        member: the number of each lane's group among these, ``(n,)``.

    """

    def __init__(
        self, source: NumberSource, addresses: Words, table: Words, member: NDArray[np.intp]
    ) -> None:
        self._source = source
        self._addresses = addresses
        self._table = table
        self._member = member

    def __len__(self) -> int:
        return len(self._source)

    def take(self, lanes: NDArray[np.intp]) -> "Aliased":
        return Aliased(self._source.take(lanes), self._addresses, self._table, self._member[lanes])

    def uniforms(self, addresses: Words) -> NDArray[np.float64]:
        rows = self._rows(addresses)
        if isinstance(self._source, Counter):
            return open_unit(self._hashed(self._source, rows))
        result = np.empty((len(addresses), len(self)))
        for lanes, part, places in self._parts(rows):
            result[:, lanes] = part.uniforms(places)
        return result

    def uniform_each(self, addresses: Words) -> NDArray[np.float64]:
        return self._source.uniform_each(self._table[self._rows(addresses), self._member])

    def words(self, addresses: Words) -> Words:
        rows = self._rows(addresses)
        if isinstance(self._source, Counter):
            return self._hashed(self._source, rows)
        result = np.empty((len(addresses), len(self)), dtype=np.uint64)
        for lanes, part, places in self._parts(rows):
            result[:, lanes] = part.words(places)
        return result

    def _hashed(self, source: Counter, rows: NDArray[np.intp]) -> Words:
        with np.errstate(over="ignore"):
            return mix(source.keys + self._table[rows][:, self._member])

    def _rows(self, addresses: Words) -> NDArray[np.intp]:
        return np.searchsorted(self._addresses, addresses)

    def _parts(self, rows: NDArray[np.intp]) -> Iterator[tuple[NDArray[np.intp], NumberSource, Words]]:
        for number in distinct(self._member).tolist():
            lanes = np.flatnonzero(self._member == number)
            yield lanes, self._source.take(lanes), self._table[rows, number]


def kinds_of(groups: Sequence[Group], graph: Graph, domain: Domain) -> list[GroupKind]:
    """The kinds of groups, in the order of the first group of each."""
    narrowing = domain.narrowing()
    kinds: dict[Hashable, list[tuple[int, _Form]]] = {}
    for number, group in enumerate(groups):
        form = _form(group, graph, domain, narrowing)
        kinds.setdefault(form.likeness, []).append((number, form))
    return [_kind(groups, members, graph, domain) for members in kinds.values()]


@dataclass(frozen=True, slots=True, eq=False)
class _Form:
    """The form of a group, equal for alike ones; its draws in order, and the parts of the domain that narrow them."""

    likeness: Hashable
    nodes: tuple[Node, ...]
    parts: tuple[int, ...]


def _form(group: Group, graph: Graph, domain: Domain, narrowing: Sequence[Sequence[int]]) -> _Form:
    roots = [node for joint in group.joints for node in _roots(joint)]
    roots += [node for item in group.objects for node in item.all]
    nodes = Graph(roots).nodes
    number = {node: place for place, node in enumerate(nodes)}
    rows: list[Hashable] = [tuple(number[root] for root in roots)]
    rows += [_likeness(joint, group) for joint in group.joints]
    parts: dict[int, int] = {}
    for node in nodes:
        if node.is_constant:
            rows.append((node.kind, _constant(node)))
        elif node.is_axis:
            rows.append(_narrowed(graph.axes[node], domain, narrowing, parts))
        elif node.is_drawn:
            rows.append("key")
        else:
            rows.append((node.likeness, node.limits, tuple(number[operand] for operand in node.operands)))
    return _Form(tuple(rows), tuple(node for node in nodes if node.is_drawn), tuple(parts))


def _roots(joint: JointCheck) -> Sequence[Node]:
    return joint.check.nodes


def _likeness(joint: JointCheck, group: Group) -> Hashable:
    check = joint.check
    own: Hashable = None
    if isinstance(check, CollisionCheck):
        place = {id(item): number for number, item in enumerate(group.objects)}
        own = tuple(place.get(id(item), id(item)) for item in check.objects), check.pairs.tobytes()
    return type(check), check.probability, joint.soft_place is None, own


def _constant(node: Node) -> Hashable:
    value = node.value
    return ("mesh", id(value.mesh)) if isinstance(value, Shape) else node.payload.key


def _narrowed(
    axis: int, domain: Domain, narrowing: Sequence[Sequence[int]], parts: dict[int, int]
) -> Hashable:
    """Return the bounds of an axis in the domain; ``parts`` numbers the parts of the domain in the order of their first appearance."""
    result: list[Hashable] = []
    for part in narrowing[axis]:
        place = parts.setdefault(part, len(parts))
        if part >= len(domain.parts):
            result.append(("finite", part))
        else:
            one = domain.parts[part]
            result.append((place, one.lower[:, axis].tobytes(), one.upper[:, axis].tobytes()))
    return ("axis", *result)


def _kind(
    groups: Sequence[Group], members: Sequence[tuple[int, _Form]], graph: Graph, domain: Domain
) -> GroupKind:
    first, form = members[0]
    axes = np.array([graph.axes[node] for node in form.nodes if node.is_axis], dtype=np.intp)
    part_of_domain, new_addresses = domain.along(axes)
    table = {
        graph.address(node): [graph.address(each.nodes[place]) for _, each in members]
        for place, node in enumerate(form.nodes)
    }
    # Boxes are chosen by the numbers of a group's own parts of the domain; what is chosen jointly is alike for all.
    common_places = [place for places in part_of_domain.addresses() for place in places.tolist()]
    table |= {place: [place] * len(members) for place in common_places}
    parts = sorted(range(len(form.parts)), key=form.parts.__getitem__)
    box_places = domain.addresses()
    for address, place in zip(new_addresses, parts, strict=False):
        table[address] = [int(box_places[each.parts[place]][0]) for _, each in members]
    addresses = np.array(sorted(table), dtype=np.uint64)
    groups_of_members = [groups[number] for number, _ in members]
    return GroupKind(
        np.array([number for number, _ in members], dtype=np.intp),
        groups[first].joints,
        groups[first].objects,
        _rows([group.numbers for group in groups_of_members]),
        part_of_domain,
        addresses,
        np.array([table[place] for place in sorted(table)], dtype=np.uint64).reshape(-1, len(members)),
        _rows([[joint.number for joint in group.joints] for group in groups_of_members]),
        _rows(
            [
                [-1 if joint.soft_place is None else joint.soft_place for joint in group.joints]
                for group in groups_of_members
            ]
        ),
    )


def _rows(numbers: Sequence[Sequence[int]]) -> NDArray[np.intp]:
    return np.array(numbers, dtype=np.intp).reshape(len(numbers), -1)
