"""The choice of an exact way to draw from the components of a finite problem.

Ways are tried from the strongest on: elimination where the structure is narrow, a list where solutions are few, values that
differ. Where none takes all constraints, the strongest ones that one can take are met by the draw, and the others are left to
chance: what is drawn follows the law given the former, so that rejection by the latter gives the law given all.
"""

from collections.abc import Mapping, Sequence
from typing import Final

import numpy as np
from numpy.typing import NDArray

from scenic.analysis.finite.constraint_network import (
    Constraint,
    FiniteProblem,
    Reduced,
    components,
    consistent,
    merged,
)
from scenic.analysis.finite.differing import bounded
from scenic.analysis.finite.elimination import eliminate, ordered
from scenic.analysis.finite.listing import solutions
from scenic.analysis.finite.matching import matchable
from scenic.analysis.finite.occupying import Exclusive, exclusives, occupied
from scenic.analysis.finite.tables import Mask
from scenic.dataclass import dataclass
from scenic.graph.finite import FiniteLaw, Listed, Sequential

__all__ = ["Component", "Drawn", "solve"]

GAIN: Final = 0.8
"""A component is drawn if at most this share of all combinations is left."""

MOST_TRIED: Final = 256
"""Constraints of a component, at most, of which the strongest are chosen."""


@dataclass(frozen=True, slots=True, eq=False)
class Drawn:
    """Variables that are drawn together.

    Attributes:
        variables: the numbers of the draws.
        values: of each the values that are left.
        law: chooses among these.
        passed: the inner variables for which the law takes numbers, in order, after those of the draws.
        numbers: for each number that the law takes, the variable that it belongs to, if it is one.
        share: the share of the prior weight that is left.
        way: how they are drawn, in words.

    """

    variables: tuple[int, ...]
    values: tuple[NDArray[np.intp], ...]
    law: FiniteLaw
    numbers: tuple[int | None, ...]
    share: float
    way: str


@dataclass(frozen=True, slots=True, eq=False)
class Component:
    """A component of a problem: what was found out about it.

    Attributes:
        variables: the numbers of its draws.
        domains: of each the values that may occur, as a mask.
        constraints: its constraints.
        drawn: how its draws are made; empty where that gains nothing, or nothing is allowed.
        met: the constraints that the draws meet always.
        solutions: the number of combinations, if they are listed.
        share: the share of the prior weight that is left: 0 if it has no solution.

    """

    variables: tuple[int, ...]
    domains: Mapping[int, Mask]
    constraints: tuple[Constraint, ...]
    drawn: tuple[Drawn, ...]
    met: tuple[Constraint, ...]
    share: float
    solutions: int | None = None


def solve(problem: FiniteProblem) -> list[Component]:
    """The components of a problem, each with a way to draw it."""
    return [_solved(problem, group) for group in components(problem.constraints)]


def _solved(problem: FiniteProblem, constraints: Sequence[Constraint]) -> Component:
    scope = sorted({variable for constraint in constraints for variable in constraint.scope})
    domains: dict[int, Mask] = {variable: problem.weights[variable] > 0 for variable in scope}
    draws = tuple(variable for variable in scope if variable < problem.draws)
    every = tuple(constraints)
    tables = merged(table for constraint in constraints for table in constraint.tables)
    nothing = Component(draws, domains, every, (), every, 0.0)
    if not consistent(tables, domains):
        return nothing
    while True:
        reduced = Reduced(problem, every, domains)
        best = _exact(reduced, every)
        if best is not None:
            break
        sets = list(exclusives(reduced))
        before = sum(int(mask.sum()) for mask in domains.values())
        if not _strike_unmatched(reduced, sets, domains):
            return nothing
        if sum(int(mask.sum()) for mask in domains.values()) == before:
            best = _strongest(reduced, sets)
            break
        if not consistent(tables, domains):
            return nothing
    share_of_values = float(np.prod([reduced.weights[variable].sum() for variable in draws]))
    share = float(np.prod([drawn.share for drawn in best[0]])) if best[0] else share_of_values
    if share <= 0:
        return nothing
    law = best[0][0].law if best[0] else None
    count = len(law.rows) if isinstance(law, Listed) else None
    draws_made = best[0] if share <= GAIN else ()
    return Component(draws, domains, every, draws_made, best[1] if draws_made else (), share, count)


def _exact(
    reduced: Reduced, constraints: tuple[Constraint, ...]
) -> tuple[tuple[Drawn, ...], tuple[Constraint, ...]] | None:
    """Return draws that meet all constraints, by elimination or from a list; ``None`` where neither is possible."""
    eliminated = _eliminated(reduced, constraints)
    if eliminated is not None:
        return (eliminated,), constraints
    listed = _listed(reduced, constraints)
    return None if listed is None else (listed, constraints)


def _strike_unmatched(reduced: Reduced, sets: Sequence[Exclusive], domains: dict[int, Mask]) -> bool:
    """Strike out of ``domains`` the values that no choice of different labels has; return whether there is one."""
    for exclusive in sets:
        left = matchable(exclusive.labels)
        if left is None:
            return False
        for bundle, rows, mask in zip(exclusive.bundles, exclusive.rows, left.values(), strict=True):
            for place, variable in enumerate(bundle):
                alive = np.zeros_like(domains[variable])
                alive[reduced.values[variable][rows[mask, place]]] = True
                domains[variable] = domains[variable] & alive
    return True


def _eliminated(reduced: Reduced, constraints: Sequence[Constraint]) -> Drawn | None:
    """Return the way by elimination, if tables remain small."""
    tables = reduced.tables(constraints)
    scopes = [frozenset(table.scope) for table in tables]
    variables_in_tables = frozenset().union(*scopes) if scopes else frozenset[int]()
    draws = [variable for variable in reduced.draws if any(variable in item.scope for item in constraints)]
    scopes += [frozenset((variable,)) for variable in draws if variable not in variables_in_tables]
    order = ordered(scopes, reduced.sizes)
    if order is None:
        return None
    elimination = eliminate(tables, reduced.weights, order)
    law = Sequential(elimination.steps, tuple(draws))
    numbers = tuple(step.variable for step in elimination.steps)
    return Drawn(
        tuple(draws),
        tuple(reduced.values[variable] for variable in draws),
        law,
        numbers,
        elimination.weight,
        "by elimination",
    )


def _listed(reduced: Reduced, constraints: Sequence[Constraint]) -> tuple[Drawn, ...] | None:
    """The way by a list of all solutions, if these are few."""
    tables = reduced.tables(constraints)
    coupled_variables = frozenset[int]().union(*(table.scope for table in tables))
    draws = [variable for variable in reduced.draws if variable in coupled_variables]
    rows = solutions(
        tables, {variable: reduced.sizes[variable] for variable in sorted(coupled_variables)}, draws
    )
    if rows is None:
        return None
    logarithms = np.zeros(len(rows))
    for place, variable in enumerate(draws):
        logarithms += np.log(reduced.weights[variable])[rows[:, place]]
    order = np.lexsort(rows.T[::-1])
    cumulative = np.cumsum(np.exp(logarithms[order]))
    share = float(cumulative[-1]) if len(rows) else 0.0
    draw = Drawn(
        tuple(draws),
        tuple(reduced.values[variable] for variable in draws),
        Listed(rows[order], cumulative / (share or 1.0)),
        (draws[0],),
        share,
        "from a list",
    )
    return draw, *(
        _alone(reduced, variable) for variable in reduced.draws if variable not in coupled_variables
    )


def _alone(reduced: Reduced, variable: int) -> Drawn:
    """Return a variable of which values were struck out, by itself."""
    weights = reduced.weights[variable]
    step = eliminate([], {variable: weights}, [variable])
    return Drawn(
        (variable,),
        (reduced.values[variable],),
        Sequential(step.steps, (variable,)),
        (variable,),
        float(weights.sum()),
        "values struck out",
    )


def _strongest(
    reduced: Reduced, sets: Sequence[Exclusive]
) -> tuple[tuple[Drawn, ...], tuple[Constraint, ...]]:
    """Return draws that meet the strongest constraints, by elimination alone, or after values that differ."""
    # What values that were struck out have decided holds however the others are drawn.
    always_met = [constraint for constraint in reduced.constraints if not reduced.tables([constraint])]
    ways = [_relaxed(reduced, reduced.constraints, frozenset())]
    for exclusive in sets:
        drawn, met_here = _differing(reduced, exclusive)
        if drawn is not None:
            others, more = _relaxed(reduced, reduced.constraints, frozenset(drawn.variables))
            ways.append(((drawn, *others), (*met_here, *more)))
    drawn_best, met_best = min(ways, key=lambda way: float(np.prod([drawn.share for drawn in way[0]])))
    return drawn_best, tuple(dict.fromkeys([*met_best, *always_met]))


def _differing(reduced: Reduced, exclusive: Exclusive) -> tuple[Drawn | None, tuple[Constraint, ...]]:
    """Return the way by values of which each occurs at most once, and the constraints that it meets always."""
    occupation = occupied(reduced, exclusive)
    if occupation is not None:
        values = tuple(reduced.values[variable] for variable in occupation.variables)
        way = "each value at most once"
        return Drawn(
            occupation.variables, values, occupation.law, occupation.numbers, occupation.weight, way
        ), occupation.met
    differ = bounded(exclusive.labels, reduced.weights) if exclusive.are_single else None
    if differ is None:
        return None, ()
    values = tuple(reduced.values[variable] for variable in differ.variables)
    numbers = (None,) * differ.law.numbers
    way = "each value at most once, under a bound"
    return Drawn(differ.variables, values, differ.law, numbers, differ.weight, way), ()


def _relaxed(
    reduced: Reduced, constraints: Sequence[Constraint], without: frozenset[int]
) -> tuple[tuple[Drawn, ...], tuple[Constraint, ...]]:
    """Return the way by elimination that takes as many constraints as possible, the strongest first, none about some variables."""
    free = [constraint for constraint in constraints if not constraint.scope & without]
    free.sort(key=_strength)
    selection: list[Constraint] = []
    for constraint in free[:MOST_TRIED]:
        tables = reduced.tables([*selection, constraint])
        if ordered([frozenset(table.scope) for table in tables], reduced.sizes) is not None:
            selection.append(constraint)
    draws = []
    for group in components(selection):
        draw = _eliminated(reduced, group)
        if draw is not None:
            draws.append(draw)
    covered_variables = {variable for draw in draws for variable in draw.variables} | without
    # What was struck out of the values of the others is met, too.
    draws += [_alone(reduced, variable) for variable in reduced.draws if variable not in covered_variables]
    return tuple(draws), tuple(selection)


def _strength(constraint: Constraint) -> float:
    """The share of combinations that a constraint allows, roughly: small for a strong one."""
    return float(constraint.tables[-1].allowed.mean())
