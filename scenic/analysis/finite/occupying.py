"""Values that occupy labels (seats, slots, hours of rooms), none of which is occupied twice, together with what else binds them.

Variables whose values exclude each other are found by their tables (`scenic.analysis.finite.differing`); several variables that always
stand together, such as the hour and the room of a lesson, count as one *bundle*. What else is required of a bundle, or of several, is
met by joining them: a *group* has the combinations of its variables that are possible, each of which occupies a set of labels. The
law is exact by dynamic programming over sets of used labels (M. Held and R. Karp, "A dynamic programming approach to sequencing
problems", 1962, count the same states), whatever the weights, and however many places are forbidden.
"""

import math
from collections.abc import Iterator, Mapping, Sequence
from itertools import combinations
from typing import Final

import numpy as np
from numpy.typing import NDArray

from scenic.analysis.finite.constraint_network import Constraint, Reduced
from scenic.analysis.finite.differing import labelled
from scenic.analysis.finite.listing import solutions
from scenic.analysis.finite.tables import Table
from scenic.dataclass import dataclass
from scenic.graph.draws import Floats
from scenic.graph.finite import Distinct

__all__ = ["Exclusive", "Occupied", "exclusives", "occupied"]

MOST_LABELS: Final = 20
"""Labels, at most, of which sets are counted."""

MOST_WORK: Final = 50_000_000
"""Sets of labels times combinations of a group, at most, for all groups together."""

MOST_IN_BUNDLE: Final = 128
"""Values of a bundle, at most."""

MOST_IN_GROUP: Final = 2048
"""Combinations of a group, at most."""

MOST_JOINED: Final = 256
"""Constraints, at most, that are tried to be met by joining groups."""


@dataclass(frozen=True, slots=True, eq=False)
class Exclusive:
    """Bundles of variables whose values exclude each other.

    Attributes:
        bundles: the variables of each bundle.
        rows: of each bundle the possible combinations ``(m, variables)``.
        labels: of each bundle, by its number, the labels of its combinations.
        met: the constraints that say that no label occurs twice.

    """

    bundles: tuple[tuple[int, ...], ...]
    rows: tuple[NDArray[np.intp], ...]
    labels: Mapping[int, NDArray[np.intp]]
    met: tuple[Constraint, ...]

    @property
    def are_single(self) -> bool:
        """Return whether each bundle is a variable, whose number is the bundle's."""
        return all(len(bundle) == 1 for bundle in self.bundles)


@dataclass(frozen=True, slots=True, eq=False)
class Occupied:
    """Groups of variables that occupy labels.

    Attributes:
        variables: the numbers of the variables.
        law: chooses their values.
        numbers: for each number that the law takes, the variable that it belongs to.
        weight: the share of all combinations that the law chooses from.
        met: the constraints that the choices meet.

    """

    variables: tuple[int, ...]
    law: Distinct
    numbers: tuple[int, ...]
    weight: float
    met: tuple[Constraint, ...]


def exclusives(reduced: Reduced) -> Iterator[Exclusive]:
    """Yield the sets of variables that exclude each other: single ones, and bundles of such that always stand together."""
    singles = [(variable,) for variable in reduced.draws]
    for bundles in (singles, _bundled(reduced)):
        if bundles is not None:
            exclusive = _exclusive(reduced, bundles)
            if exclusive is not None:
                yield exclusive


def _bundled(reduced: Reduced) -> list[tuple[int, ...]] | None:
    """The draws in bundles, of those that the same tables of more than two variables read; ``None`` where all are single."""
    draws = set(reduced.draws)
    scopes = {
        frozenset(table.scope)
        for constraint in reduced.constraints
        for table in constraint.tables
        if len(table.scope) > 2 and draws.issuperset(table.scope)
    }
    reading: dict[int, list[int]] = {}
    for number, scope in enumerate(sorted(scopes, key=sorted)):
        for variable in scope:
            reading.setdefault(variable, []).append(number)
    bundles: dict[tuple[int, ...], list[int]] = {}
    for variable in reduced.draws:
        key = tuple(reading.get(variable, [-1 - variable]))
        bundles.setdefault(key, []).append(variable)
    found: list[tuple[int, ...]] = []
    for mine in bundles.values():
        fits = math.prod(reduced.sizes[variable] for variable in mine) <= MOST_IN_BUNDLE
        found += [tuple(mine)] if fits else [(variable,) for variable in mine]
    return None if len(found) == len(reduced.draws) else found


def _exclusive(reduced: Reduced, bundles: Sequence[tuple[int, ...]]) -> Exclusive | None:
    """Return the bundles whose values exclude each other, named by their first variables."""
    bundle_of = {variable: bundle for bundle in bundles for variable in bundle}
    rows: dict[int, NDArray[np.intp]] = {}
    for bundle in bundles:
        sizes = [reduced.sizes[variable] for variable in bundle]
        rows[bundle[0]] = np.stack([axis.ravel() for axis in np.indices(sizes)], axis=1)
    pairs: dict[frozenset[int], list[tuple[Constraint, Table, Table]]] = {}
    for constraint in reduced.constraints:
        tables = reduced.tables([constraint])
        if len(tables) == 1 and bundle_of.keys() >= set(tables[0].scope):
            between = frozenset(bundle_of[variable][0] for variable in tables[0].scope)
            if len(between) == 2:
                whole = _between(between, tables[0], bundle_of, rows)
                pairs.setdefault(between, []).append((constraint, tables[0], whole))
    best = {between: max(options, key=_exclusion) for between, options in pairs.items()}
    labels = labelled(
        [whole for _, _, whole in best.values()], {first: len(mine) for first, mine in rows.items()}
    )
    if labels is None:
        return None
    pair_tables = [best[frozenset(pair)] for pair in combinations(labels, 2)]
    met_constraints = [constraint for constraint, _, _ in pair_tables]
    table_by_scope = {frozenset(table.scope): table for _, table, _ in pair_tables}
    for constraint in reduced.constraints:
        for table in reduced.tables([constraint])[:2]:
            other = table_by_scope.get(frozenset(table.scope))
            if other is not None and constraint not in met_constraints and _implies(other, table):
                met_constraints.append(constraint)
    first_bundles = [bundle_of[first] for first in labels]
    return Exclusive(
        tuple(first_bundles), tuple(rows[first] for first in labels), labels, tuple(met_constraints)
    )


def _exclusion(option: tuple[Constraint, Table, Table]) -> tuple[bool, int, float]:
    """Return how much a table says that values of two bundles exclude each other: class by class, of as many values as possible."""
    excluded = ~option[2].allowed
    classes = np.unique(excluded, axis=0)
    values = np.count_nonzero(excluded.any(axis=0)) + np.count_nonzero(excluded.any(axis=1))
    return bool(classes.sum(axis=0).max() <= 1), int(values), -float(excluded.mean())


def _implies(one: Table, other: Table) -> bool:
    order = [other.scope.index(variable) for variable in one.scope]
    return bool((other.allowed.transpose(order) | ~one.allowed).all())


def _between(
    pair: frozenset[int],
    table: Table,
    bundle_of: Mapping[int, tuple[int, ...]],
    rows: Mapping[int, NDArray[np.intp]],
) -> Table:
    """Return a table over the combinations of two bundles."""
    one, two = sorted(pair)
    places = []
    for variable in table.scope:
        bundle = bundle_of[variable]
        values = rows[bundle[0]][:, bundle.index(variable)]
        places.append(values[:, np.newaxis] if bundle[0] == one else values[np.newaxis, :])
    return Table((one, two), np.asarray(table.allowed[tuple(places)]))


@dataclass(frozen=True, slots=True, eq=False)
class _Group:
    """Variables that are drawn together.

    Attributes:
        bundles: the numbers of the bundles among them.
        variables: their numbers, ascending; inner ones after the draws.
        constraints: what binds them.
        rows: the possible combinations of the draws, ``(m, draws)``.
        bits: the labels of each, as bits, ``(m,)``.

    """

    bundles: tuple[int, ...]
    variables: tuple[int, ...]
    constraints: tuple[Constraint, ...]
    rows: NDArray[np.intp]
    bits: NDArray[np.int64]

    @property
    def sets(self) -> int:
        """The number of different sets of labels."""
        return len(np.unique(self.bits))


def occupied(reduced: Reduced, exclusive: Exclusive) -> Occupied | None:
    """Return the draw of exclusive bundles as groups; ``None`` where there are too many labels.

    The groups meet as many of the other constraints as they can while they remain small.
    """
    width = 1 + max(int(mine.max()) for mine in exclusive.labels.values())
    if width > MOST_LABELS:
        return None
    grouping = _Grouping(reduced, exclusive, width)
    groups, met_constraints = grouping.grouped()
    order = sorted(groups, key=lambda group: (-len(group.bundles), group.variables))
    draws = [[variable for variable in group.variables if variable in grouping.draws] for group in order]
    weights = tuple(_weights(reduced, mine, group.rows) for mine, group in zip(draws, order, strict=True))
    completions = _completions(order, weights, width)
    members = [variable for mine in draws for variable in mine]
    law = Distinct(
        tuple(group.rows for group in order),
        tuple(group.bits for group in order),
        weights,
        completions,
        tuple(int(place) for place in np.argsort(members)),
    )
    numbers = tuple(mine[0] for mine in draws)
    return Occupied(
        tuple(sorted(members)), law, numbers, float(completions[0]), (*exclusive.met, *met_constraints)
    )


class _Grouping:
    """Joins bundles to groups."""

    def __init__(self, reduced: Reduced, exclusive: Exclusive, width: int) -> None:
        self.draws: Mapping[int, None] = dict.fromkeys(reduced.draws)
        self._reduced = reduced
        self._exclusive = exclusive
        self._width = width
        self._bits = [np.int64(1) << mine.astype(np.int64) for mine in exclusive.labels.values()]

    def grouped(self) -> tuple[list[_Group], list[Constraint]]:
        """The groups, and the constraints that they meet by themselves."""
        groups = []
        for number, bundle in enumerate(self._exclusive.bundles):
            group = self._group((number,), bundle, ())
            assert group is not None
            groups.append(group)
        identities_met = {id(constraint) for constraint in self._exclusive.met}
        waiting = [one for one in self._reduced.constraints if id(one) not in identities_met]
        waiting.sort(key=lambda constraint: constraint.tables[-1].allowed.mean())
        met_constraints: list[Constraint] = []
        attempts = 0
        progress = True
        while progress and attempts < MOST_JOINED:
            progress = False
            for constraint in list(waiting):
                groups_in_scope = [group for group in groups if constraint.scope & set(group.variables)]
                if not groups_in_scope:
                    continue
                waiting.remove(constraint)
                attempts += 1
                others = [group for group in groups if group not in groups_in_scope]
                whole = self._joined(groups_in_scope, constraint)
                if whole is not None and self._work([*others, whole]) <= MOST_WORK:
                    groups = [*others, whole]
                    met_constraints.append(constraint)
                    progress = True
                if attempts == MOST_JOINED:
                    break
        return groups, met_constraints

    def _joined(self, groups: Sequence[_Group], constraint: Constraint) -> _Group | None:
        bundles = tuple(sorted(number for group in groups for number in group.bundles))
        variables = {variable for group in groups for variable in group.variables} | constraint.scope
        constraints = tuple(one for group in groups for one in group.constraints)
        return self._group(bundles, sorted(variables), (*constraints, constraint))

    def _group(
        self, bundles: tuple[int, ...], variables: Sequence[int], constraints: tuple[Constraint, ...]
    ) -> _Group | None:
        """The group of some variables, ``None`` where it has too many combinations."""
        reduced, exclusive = self._reduced, self._exclusive
        mine = set(variables)
        inner = [one for one in exclusive.met if len(bundles) > 1 and one.scope <= mine]
        tables = reduced.tables([*constraints, *inner])
        draws = [variable for variable in variables if variable in self.draws]
        rows = solutions(tables, {variable: reduced.sizes[variable] for variable in variables}, draws)
        if rows is None or len(rows) > MOST_IN_GROUP:
            return None
        rows = rows[np.lexsort(rows.T[::-1])]
        bits = np.zeros(len(rows), dtype=np.int64)
        for number in bundles:
            bundle = exclusive.bundles[number]
            sizes = [reduced.sizes[variable] for variable in bundle]
            places = [rows[:, draws.index(variable)] for variable in bundle]
            bits |= self._bits[number][np.ravel_multi_index(tuple(places), sizes)]
        return _Group(bundles, tuple(variables), constraints, rows, bits)

    def _work(self, groups: Sequence[_Group]) -> int:
        """The number of steps that counting the completions takes."""
        count, work = 0, 0
        for group in sorted(groups, key=lambda group: (-len(group.bundles), group.variables)):
            work += math.comb(self._width, min(count, self._width)) * group.sets
            count += len(group.bundles)
        return work


def _weights(reduced: Reduced, variables: Sequence[int], rows: NDArray[np.intp]) -> Floats:
    """Return the weights of combinations of the values of some variables."""
    weights = np.ones(len(rows))
    for place, variable in enumerate(variables):
        weights = weights * reduced.weights[variable][rows[:, place]]
    return weights


def _completions(groups: Sequence[_Group], weights: Sequence[Floats], width: int) -> Floats:
    """The weight of all choices of the groups that are left, for each set of used labels."""
    counts = _set_bits(width)
    label_count = sum(len(group.bundles) for group in groups)
    completions = np.zeros(1 << width)
    completions[counts == label_count] = 1.0
    for group, each in zip(reversed(groups), reversed(weights), strict=True):
        label_count -= len(group.bundles)
        sets = np.flatnonzero(counts == label_count)
        masks, place = np.unique(group.bits, return_inverse=True)
        sums = np.bincount(place.ravel(), weights=each, minlength=len(masks))
        for mask, weight in zip(masks.tolist(), sums.tolist(), strict=True):
            free = sets[sets & mask == 0]
            completions[free] += weight * completions[free | mask]
    return completions


def _set_bits(width: int) -> NDArray[np.int8]:
    """The number of bits that are set in each number of ``width`` bits."""
    counts = np.zeros(1, dtype=np.int8)
    for _ in range(width):
        counts = np.concatenate([counts, counts + np.int8(1)])
    return counts
