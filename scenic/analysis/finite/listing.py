"""All solutions of a finite problem, where they are few: tables are joined, one variable after the other."""

from collections.abc import Mapping, Sequence
from typing import Final

import numpy as np
from numpy.typing import NDArray

from scenic.analysis.finite.tables import Mask, Table

__all__ = ["MOST_SOLUTIONS", "solutions"]

MOST_SOLUTIONS: Final = 20_000
"""Solutions, at most."""

MOST_PARTIAL: Final = 200_000
"""Combinations of some of the variables, at most, that are looked at together."""

MOST_WORK: Final = 40_000_000
"""Entries of tables that are looked up for all of them, at most."""

_LARGEST_PROJECTION: Final = 1 << 16


def solutions(
    tables: Sequence[Table], sizes: Mapping[int, int], draws: Sequence[int]
) -> NDArray[np.intp] | None:
    """Return the combinations ``(m, draws)`` of all variables in ``sizes`` that tables allow, without inner variables.

    ``None`` where there are too many, or too many of some of the variables. Inner variables must be fixed by the draws.
    """
    order = _order(tables, sizes)
    columns = {variable: place for place, variable in enumerate(order)}
    rows = np.zeros((1, 0), dtype=np.int16)
    work = 0
    for place, variable in enumerate(order):
        earlier_variables = order[:place]
        is_allowed = np.ones((len(rows), sizes[variable]), dtype=np.bool_)
        for scope, entries in _speaking(tables, variable, frozenset(earlier_variables)):
            work += is_allowed.size
            if work > MOST_WORK:
                return None
            inner = tuple(rows[:, columns[other]].astype(np.intp) for other in scope)
            is_allowed &= entries[inner] if inner else entries[np.newaxis]
        if np.count_nonzero(is_allowed) > MOST_PARTIAL:
            return None
        row, value = np.nonzero(is_allowed)
        rows = np.concatenate([rows[row], value[:, np.newaxis].astype(np.int16)], axis=1)
    if len(rows) > MOST_SOLUTIONS:
        return None
    return rows[:, [columns[variable] for variable in draws]].astype(np.intp)


def _order(tables: Sequence[Table], sizes: Mapping[int, int]) -> list[int]:
    """Return the variables, next always the one that the tables bind most to those before it."""
    left = dict.fromkeys(sizes)
    ordered_variables: set[int] = set()
    order: list[int] = []
    scopes = [(frozenset(table.scope), float(np.log(max(table.allowed.mean(), 1e-9)))) for table in tables]
    while left:
        strength = dict.fromkeys(left, 0.0)
        degree = dict.fromkeys(left, 0.0)
        for scope, selectivity in scopes:
            for variable in scope:
                if variable in left:
                    unknown_count = len(scope - ordered_variables) - 1
                    strength[variable] += (
                        selectivity
                        if unknown_count == 0
                        else selectivity * 0.1 * (len(scope) > unknown_count + 1)
                    )
                    degree[variable] += selectivity
        best = min(
            left,
            key=lambda one: (
                strength[one] + np.log(sizes[one]) * (1 if ordered_variables else 0),
                degree[one],
                one,
            ),
        )
        order.append(best)
        ordered_variables.add(best)
        del left[best]
    return order


def _speaking(tables: Sequence[Table], variable: int, known: frozenset[int]) -> list[tuple[list[int], Mask]]:
    """Return the tables about a variable, given known ones: of each table the known variables, and the entries by them and the variable."""
    pairs = []
    for table in tables:
        if variable not in table.scope:
            continue
        known_variables = [other for other in table.scope if other in known]
        if not known_variables and len(table.scope) > 1 and table.allowed.size > _LARGEST_PROJECTION:
            continue
        others = tuple(
            place for place, other in enumerate(table.scope) if other != variable and other not in known
        )
        entries = np.asarray(table.allowed.any(axis=others) if others else table.allowed)
        scope = [other for other in table.scope if other == variable or other in known]
        entries = np.moveaxis(entries, scope.index(variable), -1)
        if not entries.all():
            pairs.append((known_variables, entries))
    return pairs
