"""Exact draws from constraints of narrow structure: chains, rings, trees, folds.

Variables are eliminated one after the other (R. Dechter, "Bucket elimination: a unifying framework for reasoning", 1999): of
each remains the table of the weights of its values, given those of its neighbours, which all that was eliminated before
it has been summed into. Drawn in reverse order, each variable follows its law given all constraints.
"""

from collections.abc import Mapping, Sequence
from typing import Final

import numpy as np
from numpy.typing import NDArray

from scenic.analysis.finite.tables import Table
from scenic.dataclass import dataclass
from scenic.graph.bounds import Floats
from scenic.graph.finite import ConditionalChoice

__all__ = ["WIDEST", "Elimination", "eliminate", "ordered"]

WIDEST: Final = 1 << 20
"""Entries of an intermediate table, at most."""

MOST: Final = 1 << 22
"""Entries of all intermediate tables, at most."""


@dataclass(frozen=True, slots=True, eq=False)
class Elimination:
    """The result: the steps of a draw, and the weight of all combinations together."""

    steps: tuple[ConditionalChoice, ...]
    weight: float


def ordered(
    scopes: Sequence[frozenset[int]], sizes: Mapping[int, int], last: int | None = None
) -> list[int] | None:
    """An order in which the variables of some scopes can be eliminated: each time the one that makes the smallest table.

    ``None`` where tables become too large. The variable ``last`` comes after all others.
    """
    neighbours: dict[int, set[int]] = {}
    for scope in scopes:
        for variable in scope:
            neighbours.setdefault(variable, set()).update(scope)
    result: list[int] = []
    total = 0.0

    def entries(variable: int) -> float:
        return float(np.prod([sizes[other] for other in neighbours[variable]], dtype=np.float64))

    costs = {variable: entries(variable) for variable in neighbours}
    while neighbours:
        variable = min(costs, key=lambda one: (one == last, costs[one], one))
        total += costs[variable]
        if costs[variable] > WIDEST or total > MOST:
            return None
        result.append(variable)
        others = neighbours.pop(variable) - {variable}
        del costs[variable]
        for other in others:
            neighbours[other] |= others
            neighbours[other].discard(variable)
        for other in others:
            costs[other] = entries(other)
    return result


def eliminate(tables: Sequence[Table], weights: Mapping[int, Floats], order: Sequence[int]) -> Elimination:
    """Eliminate all variables in an order.

    Args:
        tables: the constraints; variables without any follow their weights.
        weights: of the values of each variable.
        order: all variables.

    Returns:
        The steps that draw them, in reverse order; the weight is 0 if nothing meets the constraints.

    """
    place = {variable: number for number, variable in enumerate(order)}
    buckets: dict[int, list[tuple[tuple[int, ...], NDArray[np.float64]]]] = {
        variable: [] for variable in order
    }
    for table in tables:
        if table.scope:
            buckets[min(table.scope, key=place.__getitem__)].append(
                (table.scope, table.allowed.astype(np.float64))
            )
        elif not table.allowed.all():
            return Elimination((), 0.0)
    logarithm = 0.0
    steps: list[ConditionalChoice] = []
    for variable in order:
        factors = buckets.pop(variable)
        neighbours = tuple(
            sorted(
                {other for scope, _ in factors for other in scope if other != variable}, key=place.__getitem__
            )
        )
        scope = (*neighbours, variable)
        sizes = tuple(len(weights[other]) for other in neighbours)
        product = np.broadcast_to(weights[variable], (*sizes, len(weights[variable]))).copy()
        for theirs, entries in factors:
            product *= _spread(theirs, entries, scope)
        cumulative, sums = _law_of_rows(product.reshape(-1, product.shape[-1]))
        steps.append(ConditionalChoice(variable, neighbours, sizes, cumulative))
        most = float(sums.max(initial=0.0))
        if most <= 0:
            return Elimination((), 0.0)
        logarithm += np.log(most)
        if neighbours:
            buckets[neighbours[0]].append((neighbours, (sums / most).reshape(sizes)))
        else:
            logarithm += np.log(sums[0] / most)
    return Elimination(tuple(reversed(steps)), float(np.exp(logarithm)))


def _law_of_rows(rows: NDArray[np.float64]) -> tuple[Floats, Floats]:
    """Return the law that the weights of each row give, summed up, and the sums of the rows."""
    cumulative = np.cumsum(rows, axis=1)
    sums = cumulative[:, -1].copy()
    cumulative /= np.where(sums > 0, sums, 1.0)[:, np.newaxis]
    # What comes after the last value of positive weight is never reached, whatever rounding does.
    cumulative[(rows[:, ::-1].cumsum(axis=1)[:, ::-1] - rows) <= 0] = 1.0
    return cumulative, sums


def _spread(theirs: Sequence[int], entries: NDArray[np.float64], scope: Sequence[int]) -> NDArray[np.float64]:
    order = sorted(range(len(theirs)), key=lambda place: scope.index(theirs[place]))
    turned = entries.transpose(order)
    mine = iter(turned.shape)
    return turned.reshape([next(mine) if variable in theirs else 1 for variable in scope])
