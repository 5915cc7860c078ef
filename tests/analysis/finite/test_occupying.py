"""Values that occupy labels, with other constraints: the law against enumeration."""

from collections.abc import Callable, Sequence
from itertools import combinations, product

import numpy as np
from hypothesis import given
from hypothesis import strategies as st

from scenic.analysis.finite.constraint_network import Constraint, FiniteProblem, Reduced
from scenic.analysis.finite.occupying import Occupied, exclusives, occupied
from scenic.analysis.finite.tables import Table

POINTS = 16
"""Numbers of each group of a law on which its choices are counted."""


def constraint(sizes: Sequence[int], scope: tuple[int, ...], holds: Callable[..., bool]) -> Constraint:
    allowed = np.array(
        [bool(holds(*row)) for row in product(*(range(sizes[variable]) for variable in scope))]
    )
    return Constraint((Table(scope, allowed.reshape([sizes[variable] for variable in scope])),), 0)


@st.composite
def problems(draw: st.DrawFn) -> FiniteProblem:
    """Three things at places that differ, or at places and times that differ as pairs, with sizes, and more that binds them."""
    places = draw(st.integers(3, 5))
    times = draw(st.sampled_from([1, 2]))
    sizes = [places] * 3 + [times if times > 1 else 3] * 3
    numbers = st.integers(1, 4)
    weights = tuple(
        np.array(draw(st.lists(numbers, min_size=size, max_size=size)), dtype=float) for size in sizes
    )
    constraints = []
    for one, two in combinations(range(3), 2):
        if times == 1:
            constraints.append(constraint(sizes, (one, two), lambda a, b: a != b))
        else:
            scope = (one, 3 + one, two, 3 + two)
            constraints.append(constraint(sizes, scope, lambda a, s, b, t: (a, s) != (b, t)))
    scopes = st.sampled_from([(0, 1), (2, 5), (3, 0), (1, 4), (0, 2), (4, 5)])
    for scope in draw(st.lists(scopes, max_size=3, unique=True)):
        shape = tuple(sizes[variable] for variable in scope)
        entries = draw(st.lists(st.booleans(), min_size=shape[0] * shape[1], max_size=shape[0] * shape[1]))
        constraints.append(
            Constraint((Table(scope, np.array(entries).reshape(shape) | np.eye(*shape, dtype=bool)),), 1)
        )
    return FiniteProblem(tuple(each / each.sum() for each in weights), 6, tuple(constraints))


def allows(constraints: Sequence[Constraint], row: dict[int, int]) -> bool:
    return all(
        table.allowed[tuple(row[variable] for variable in table.scope)]
        for one in constraints
        for table in one.tables
    )


def expected(problem: FiniteProblem, found: Occupied) -> dict[tuple[int, ...], float]:
    """The weights of the combinations that the met constraints allow."""
    values = [range(len(problem.weights[variable])) for variable in found.variables]
    result = {}
    for row in product(*values):
        if allows(found.met, dict(zip(found.variables, row, strict=True))):
            each = zip(found.variables, row, strict=True)
            result[row] = float(np.prod([problem.weights[variable][value] for variable, value in each]))
    return result


@given(problems())
def test_the_law_is_that_of_enumeration(problem: FiniteProblem) -> None:
    scope = sorted({variable for one in problem.constraints for variable in one.scope})
    reduced = Reduced(
        problem, problem.constraints, {variable: problem.weights[variable] > 0 for variable in scope}
    )
    drawn = [each for each in (occupied(reduced, one) for one in exclusives(reduced)) if each is not None]
    assert drawn
    for found in drawn:
        assert len(found.met) >= 3
        exact = expected(problem, found)
        total = sum(exact.values())
        np.testing.assert_allclose(found.weight, total, rtol=1e-9, atol=1e-12)
        if total == 0:
            continue
        middle = (np.arange(POINTS) + 0.5) / POINTS
        points = np.stack([axis.ravel() for axis in np.meshgrid(*[middle] * found.law.numbers)])
        rows, counts = np.unique(found.law.choose(points), axis=1, return_counts=True)
        assert {tuple(row) for row in rows.T.tolist()} <= set(exact)
        for row, count in zip(rows.T.tolist(), counts.tolist(), strict=True):
            # A choice has an interval of each number given the ones before, cut at points of the grid.
            assert abs(count / points.shape[1] - exact[tuple(row)] / total) <= found.law.numbers / POINTS


def test_things_that_stand_together_are_joined_and_all_is_met() -> None:
    sizes = [6] * 6 + [2] * 6
    constraints = [
        constraint(sizes, (i, 6 + i, j, 6 + j), lambda a, s, b, t: (a, s) != (b, t))
        for i, j in combinations(range(6), 2)
    ]
    constraints += [constraint(sizes, (i, i + 1), lambda a, b: a < b) for i in (0, 2, 4)]
    problem = FiniteProblem(tuple(np.full(size, 1 / size) for size in sizes), 12, tuple(constraints))
    reduced = Reduced(problem, constraints, {v: problem.weights[v] > 0 for v in range(12)})
    (found,) = (each for each in (occupied(reduced, one) for one in exclusives(reduced)) if each is not None)
    assert len(found.met) == len(constraints)
    assert found.law.numbers == 3
    rows = found.law.choose(np.random.default_rng(0).random((3, 500))).T
    assert all(allows(constraints, dict(enumerate(row))) for row in rows.tolist())
