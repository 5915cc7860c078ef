"""The z3 solver behind typed functions: terms for the solver readings, and checks within a budget.

Everything lives in a z3 context of its own, so that two analyses cannot disturb each other and equal questions cost equal
counts. Numbers are real terms throughout; whole numbers are integers seen as reals.
"""

from collections.abc import Sequence
from enum import Enum, unique
from fractions import Fraction
from importlib.util import find_spec
from typing import Any, Final

from scenic.graph.kinds import Kind

Term = Any
"""A z3 expression; z3 has no types of its own."""

BUDGET: Final = 1_000_000
"""z3's resource count for one question, at most; questions about sums take a few hundred."""

TOTAL: Final = 20_000_000
"""The count for all questions about one set of formulas, after which nothing more is decided."""


def has_solver() -> bool:
    """Return whether the solver's library is installed."""
    try:
        return find_spec("z3") is not None
    except ValueError:  # what stands in its place has no origin
        return False


@unique
class SolverAnswer(Enum):
    """The answer of the solver about a set of formulas."""

    POSSIBLE = "possible"
    IMPOSSIBLE = "impossible"
    UNKNOWN = "unknown"


class SolverTerms:
    """The terms of `scenic.graph.operation.Terms`; ``definitions`` and ``supports`` collect what readings assert."""

    def __init__(self) -> None:
        import z3

        self._z3 = z3
        self.context: Any = z3.Context()
        self.definitions: list[Term] = []
        self.supports: list[tuple[Term, str]] = []
        self._count = 0

    def real(self, value: float) -> Term:
        """Return the exact rational value of a finite float or integer."""
        fraction = Fraction(value)
        return self._z3.RealVal(f"{fraction.numerator}/{fraction.denominator}", self.context)

    def truth(self, value: bool) -> Term:
        """Return a fixed truth value."""
        return self._z3.BoolVal(value, self.context)

    def number(self, term: Term) -> Term:
        """Return a truth value as 0 or 1; a number unchanged."""
        return self.either(term, self.real(1), self.real(0)) if self._z3.is_bool(term) else term

    def constant(self, term: Term) -> float | None:
        """Return the value of a term that is a fixed number, unless no float is as large."""
        simple = self._z3.simplify(term)
        if not self._z3.is_rational_value(simple):
            return None
        try:
            return float(Fraction(simple.numerator_as_long(), simple.denominator_as_long()))
        except OverflowError:  # there are integers that no float is
            return None

    def either(self, condition: Term, then: Term, otherwise: Term) -> Term:
        """Return a term that equals ``then`` where ``condition`` holds, and ``otherwise`` elsewhere."""
        return self._z3.If(condition, then, otherwise, self.context)

    def fresh(self, kind: Kind) -> Term:
        """Return a term about which nothing is known; ``None`` for Python objects."""
        if kind.is_boxed:
            return None
        if kind.trailing:
            return tuple(self.fresh(Kind.SCALAR) for _ in range(kind.trailing[0]))
        self._count += 1
        name = f"v{self._count}"
        if kind is Kind.BOOLEAN:
            return self._z3.Bool(name, self.context)
        if kind is Kind.INTEGER:
            return self._z3.ToReal(self._z3.Int(name, self.context))
        return self._z3.Real(name, self.context)

    def integer_part(self, term: Term) -> Term:
        """Return the floor of a real term."""
        return self._z3.ToReal(self._z3.ToInt(term))

    def define(self, condition: Term) -> None:
        """Assert a condition that defines a fresh term."""
        self.definitions.append(condition)

    def support(self, condition: Term, phrase: str) -> None:
        """Assert a condition of the primitive value being encoded."""
        self.supports.append((condition, phrase))


class Questions:
    """A fixed set of formulas: the solver decides which of them can hold together, given the facts that always hold."""

    def __init__(self, terms: SolverTerms, always: Sequence[Term], formulas: Sequence[Term]) -> None:
        import z3

        self._z3 = z3
        self._terms = terms
        self._solver: Any = z3.Solver(ctx=terms.context)
        self._solver.set("rlimit", BUDGET)
        self._solver.add(*always)
        self._names = [z3.Bool(f"formula{number}", terms.context) for number in range(len(formulas))]
        for name, formula in zip(self._names, formulas, strict=True):
            self._solver.add(z3.Implies(name, formula, terms.context))

    def ask(self, members: Sequence[int]) -> SolverAnswer:
        """Return whether the formulas of these numbers can hold together."""
        if self._spent() >= TOTAL:
            return SolverAnswer.UNKNOWN
        result = self._solver.check(*(self._names[number] for number in members))
        if result == self._z3.sat:
            return SolverAnswer.POSSIBLE
        return SolverAnswer.IMPOSSIBLE if result == self._z3.unsat else SolverAnswer.UNKNOWN

    def _spent(self) -> int:
        """The count of all questions so far; z3 keeps one for the context, which is ours alone."""
        statistics = self._solver.statistics()
        return int(statistics.get_key_value("rlimit count")) if "rlimit count" in statistics.keys() else 0  # noqa: SIM118 - z3's object has no `in`

    def contradiction(self, members: Sequence[int]) -> tuple[int, ...] | None:
        """Return a smallest-possible part of ``members`` that cannot hold together: taking any of it away would mend it.

        ``None`` where they can, or nothing was decided. Earlier members are taken away first.
        """
        if self.ask(members) is not SolverAnswer.IMPOSSIBLE:
            return None
        numbers = {name.get_id(): number for number, name in enumerate(self._names)}
        core = sorted(numbers[name.get_id()] for name in self._solver.unsat_core())
        for member in tuple(core):
            rest = [number for number in core if number != member]
            if self.ask(rest) is SolverAnswer.IMPOSSIBLE:
                core = rest
        return tuple(core)

    def refutes(self, formula: Term, members: Sequence[int]) -> bool:
        """Return whether ``formula`` is certainly false where the formulas of these numbers hold."""
        self._solver.push()
        try:
            self._solver.add(formula)
            return self.ask(members) is SolverAnswer.IMPOSSIBLE
        finally:
            self._solver.pop()
