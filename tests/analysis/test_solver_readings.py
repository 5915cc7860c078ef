"""Solver readings against the values of their operations, one operation at a time, at operands where decisions flip."""

import itertools
from fractions import Fraction

import numpy as np
import pytest
import z3
from graph.programs import CASES, B, I, P, Q, S, U, V
from graph.readings import has, kind_of, values_of

from scenic.analysis.solver_terms import SolverTerms
from scenic.graph.kinds import Kind
from scenic.graph.operations import TABLE
from scenic.graph.operations.solver_readings import componentwise
from tests.each import each

VALUES = {
    S: (-2.5, -1.0, -0.5, 0.0, 0.5, 1.0, 2.0, 3.25),
    I: (-7, -3, -1, 0, 1, 2, 3, 5),
    B: (False, True),
    P: (0.25, 2.0),
    U: (0.125, 0.75),
    V: ((0.0, 0.0, 0.0), (3.0, -4.0, 12.0), (0.5, 0.0, -1.0), (-1.0, -1.0, 0.25)),
    Q: ((0.0, 0.0, 0.0, 1.0), (0.6, 0.0, 0.0, -0.8), (0.5, -0.5, 0.5, 0.5)),
}
MOST = 24
"""Combinations of operands of a case, at most."""

LEFT_OPEN = {
    *("power", "floor divide", "modulo", "round", "getitem", "sin", "cos", "tan", "normalize angle"),
    *("azimuth", "altitude", "normalized", "euler"),
}
"""Which value of these it is the solver may leave open, even where it knows all operands."""


def operands_of(case):
    """Columns of operands: all combinations of the values above, or some of them."""
    options = [range(part[1]) if isinstance(part, tuple) else VALUES[part] for part in case.operands]
    rows = list(itertools.product(*options))
    if len(rows) > MOST:
        rows = [
            rows[place] for place in np.random.default_rng(len(rows)).choice(len(rows), MOST, replace=False)
        ]
    kinds = [kind_of(part) for part in case.operands]
    return [
        np.array(column, dtype=kind.dtype)
        for column, kind in zip(zip(*rows, strict=True), kinds, strict=True)
    ]


class Asked:
    """The solver's terms of an operation at operands of which it knows everything."""

    def __init__(self, terms, case, row, fixed):
        """``fixed`` says which operands are constants; the others are unknowns that equal their values."""
        self.terms = terms
        terms.definitions.clear()
        terms.supports.clear()
        self.ties = []
        parts = [
            self._operand(part, value, constant)
            for part, value, constant in zip(case.operands, row, fixed, strict=True)
        ]
        self.result = TABLE[case.name].solver(self.terms, case.payload, *parts)

    def _operand(self, part, value, constant):
        kind = kind_of(part)
        if part == U:
            free = self.terms.fresh(Kind.SCALAR)
            self.terms.define((free > self.terms.real(0)) & (free < self.terms.real(1)))
            return free
        if kind.trailing:
            return tuple(self._number(S, item, constant) for item in value.tolist())
        return self._number(kind, value.item(), constant)

    def _number(self, kind, value, constant):
        exact = self.terms.truth(value) if kind is B else self.terms.real(value)
        if constant:
            return exact
        free = self.terms.fresh(kind)
        self.ties.append(free == exact)
        return free

    def may_be(self, value):
        """Whether the result may be (all but) this value."""
        if self.result is None:
            return True
        solver = z3.Solver(ctx=self.terms.context)
        solver.set("rlimit", 2_000_000)
        solver.add(*self.terms.definitions, *(term for term, _ in self.terms.supports), *self.ties)
        parts = self.result if isinstance(self.result, tuple) else [self.result]
        for term, number in zip(parts, np.atleast_1d(value).tolist(), strict=True):
            if z3.is_bool(term):
                solver.add(term == self.terms.truth(bool(number)))
            else:
                exact, slack = Fraction(number), Fraction(1e-9) * (1 + abs(Fraction(number)))
                solver.add(term >= self._exactly(exact - slack), term <= self._exactly(exact + slack))
        return solver.check() != z3.unsat

    def _exactly(self, fraction):
        return z3.RealVal(f"{fraction.numerator}/{fraction.denominator}", self.terms.context)


SOLVED = [case for case in CASES if has(case, "solver")]


@each(SOLVED)
def test_the_solver_allows_the_value_and_no_other(case):
    columns = operands_of(case)
    values, fine = values_of(case, columns)
    terms, count = SolverTerms(), len(case.operands)
    for row in zip(*columns, strict=True):  # of what fails, too, something can be said
        Asked(terms, case, row, (True,) * count)
    lanes = np.flatnonzero(fine & np.isfinite(values.reshape(len(fine), -1)).all(axis=1))
    assert len(lanes)
    told = U not in case.operands and Q not in case.operands and case.name not in LEFT_OPEN
    # All of them constants, all unknown, and the last one a constant as exponents and divisors mostly are.
    known = [(True,) * count, (False,) * count, *([(*(False,) * (count - 1), True)] if count > 1 else [])]
    boolean = values.ndim == 1 and set(values[lanes]) <= {0.0, 1.0}
    for place, lane in enumerate(lanes):
        # An operand of which nothing is known has no term: of orientations there are constants only.
        fixed = (True,) * count if Q in case.operands else known[place % len(known)]
        asked = Asked(terms, case, [column[lane] for column in columns], fixed)
        assert asked.may_be(values[lane]), (fixed, [column[lane] for column in columns], values[lane])
        if told and asked.result is not None:
            other = 1 - values[lane] if boolean else values[lane] + 0.5
            assert not asked.may_be(other), (fixed, [column[lane] for column in columns], other)


LIMITS = {
    "sin": 1,
    "cos": 1,
    "normalize angle": np.pi,
    "azimuth": np.pi,
    "altitude": np.pi / 2,
    "normalized": 1,
}
"""Between which two numbers, one the negative of the other, values of operations lie whose solver reading knows no more."""


@pytest.mark.parametrize("case", [case for case in SOLVED if case.name in LIMITS], ids=str)
def test_the_solver_knows_limits_of_what_it_leaves_open(case):
    limit, terms = LIMITS[case.name], SolverTerms()
    columns = operands_of(case)
    values, fine = values_of(case, columns)
    for lane in np.flatnonzero(fine)[:3]:
        asked = Asked(terms, case, [column[lane] for column in columns], (False,) * len(columns))
        assert asked.may_be(values[lane])
        for beyond in (limit + 0.01, -limit - 0.01):
            places = np.eye(3) if values.ndim > 1 else [1.0]
            assert not any(asked.may_be(beyond * np.asarray(place)) for place in places)


@pytest.mark.parametrize("side", [0, 1])
def test_a_truth_value_beside_a_vector_counts_as_three_numbers(side):
    reading = componentwise(
        lambda terms, a, b: (a.sort().name(), b.sort().name()), (True, False), (False, True)
    )
    terms = SolverTerms()
    operands = [tuple(map(terms.real, (1.0, 2.0, 3.0))), terms.truth(True)]
    assert reading(terms, None, *operands[:: 1 - 2 * side]) == (("Real", "Real"),) * 3
