"""Tables as the constraints of a finite problem: what they leave of each variable, and its independent components."""

from collections.abc import Iterable, Sequence
from typing import Final

import numpy as np

from scenic.analysis.finite.tables import Mask, Table
from scenic.dataclass import dataclass
from scenic.graph.bounds import Floats

__all__ = ["Constraint", "FiniteProblem", "Reduced", "aligned", "components", "consistent", "merged"]

ROUNDS: Final = 64
"""Passes over the tables that strike out values, at most."""


@dataclass(frozen=True, slots=True, eq=False)
class Constraint:
    """The demand of one check: tables that hold together.

    Attributes:
        tables: the tables.
        check: the number of the check among those of the plan.
        exact: whether the tables allow just what passes, and not only what may pass.

    """

    tables: tuple[Table, ...]
    check: int
    exact: bool = True

    @property
    def scope(self) -> frozenset[int]:
        """The numbers of the variables."""
        return frozenset(variable for table in self.tables for variable in table.scope)


@dataclass(frozen=True, slots=True, eq=False)
class FiniteProblem:
    """Variables with weights of their values, and constraints.

    Attributes:
        weights: of each variable the weights of its values; of inner variables ones.
        draws: the number of variables that are draws; those after them are inner.
        constraints: the constraints.

    """

    weights: tuple[Floats, ...]
    draws: int
    constraints: tuple[Constraint, ...]


def aligned(table: Table, scope: Sequence[int]) -> Mask:
    """Return the entries of a table with dimensions for another, wider scope: of length 1 where it says nothing."""
    order = sorted(range(len(table.scope)), key=lambda place: scope.index(table.scope[place]))
    entries = table.allowed.transpose(order)
    mine = iter(entries.shape)
    return entries.reshape([next(mine) if variable in table.scope else 1 for variable in scope])


def merged(tables: Iterable[Table]) -> list[Table]:
    """Return the tables, those over the same variables as one; without those that allow everything."""
    groups: dict[frozenset[int], list[Table]] = {}
    for table in tables:
        if not table.allowed.all():
            groups.setdefault(frozenset(table.scope), []).append(table)
    result = []
    for group in groups.values():
        scope = group[0].scope
        combinations = group[0].allowed
        for other in group[1:]:
            combinations = combinations & aligned(other, scope)
        result.append(Table(scope, np.asarray(combinations)))
    return result


def components(constraints: Sequence[Constraint]) -> list[list[Constraint]]:
    """The constraints in groups that share no variable, in order."""
    groups: dict[int, tuple[set[int], list[Constraint]]] = {}
    owner: dict[int, int] = {}
    for number, constraint in enumerate(constraints):
        scope = set(constraint.scope)
        group_numbers = sorted({owner[variable] for variable in scope if variable in owner})
        members: list[Constraint] = []
        for other in group_numbers:
            more, theirs = groups.pop(other)
            scope |= more
            members += theirs
        target = group_numbers[0] if group_numbers else number
        groups[target] = scope, [*members, constraint]
        owner.update(dict.fromkeys(scope, target))
    return [members for _, members in groups.values()]


def consistent(tables: Sequence[Table], domains: dict[int, Mask]) -> bool:
    """Strike out of ``domains`` the values that some table allows with none of the others; return whether each has some left."""
    reading: dict[int, list[int]] = {}
    for number, table in enumerate(tables):
        for variable in table.scope:
            reading.setdefault(variable, []).append(number)
    waiting = dict.fromkeys(range(len(tables)))
    budget = ROUNDS * max(1, len(tables))
    while waiting and budget:
        budget -= 1
        number = next(iter(waiting))
        del waiting[number]
        table = tables[number]
        entries = table.allowed
        for place, variable in enumerate(table.scope):
            shape = [1] * entries.ndim
            shape[place] = -1
            entries = entries & domains[variable].reshape(shape)
        for place, variable in enumerate(table.scope):
            others = tuple(axis for axis in range(entries.ndim) if axis != place)
            left = domains[variable] & entries.any(axis=others)
            if not np.array_equal(left, domains[variable]):
                domains[variable] = left
                if not left.any():
                    return False
                waiting.update(dict.fromkeys(reading[variable]))
    return True


class Reduced:
    """A component whose variables have only the values that are left.

    Args:
        problem: the problem.
        constraints: those of the component.
        domains: of each of its variables the values that are left, as a mask.

    """

    def __init__(
        self, problem: FiniteProblem, constraints: Sequence[Constraint], domains: dict[int, Mask]
    ) -> None:
        self.values = {variable: np.flatnonzero(mask) for variable, mask in domains.items()}
        self.sizes = {variable: len(values) for variable, values in self.values.items()}
        self.weights = {
            variable: problem.weights[variable][values] for variable, values in self.values.items()
        }
        self.draws = sorted(variable for variable in domains if variable < problem.draws)
        self.constraints = constraints

    def tables(self, constraints: Sequence[Constraint]) -> list[Table]:
        """Return the tables of some constraints over the values that are left."""
        found = []
        for table in dict.fromkeys(table for constraint in constraints for table in constraint.tables):
            places = np.ix_(*(self.values[variable] for variable in table.scope))
            found.append(Table(table.scope, table.allowed[places]))
        return merged(found)
