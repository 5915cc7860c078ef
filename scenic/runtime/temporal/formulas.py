"""Temporal formulas, and their verdicts on the states seen so far (section 12.6 of the specification).

A formula is made of atoms (indices into what the caller evaluates in each state) and operators. A `Monitor` holds what has
yet to come true, not the states: what it costs to add a state is bounded by the formula. For that, negations are
pushed to the atoms when a monitor is made, and what is left to hold is kept as a disjunction of conjunctions of
*obligations*: subformulas that the next state has to meet, each weak (true if there is no next state) or strong. Since
obligations are subformulas and clauses absorb each other, what is left is one of finitely many.

The verdicts are those of RV-LTL (Bauer, Leucker and Schallhart, "Comparing LTL semantics for runtime verification", 2010).
That a formula which its operands do not decide is valid, as ``always (a or not a)`` is, goes unnoticed.
"""

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from enum import IntEnum
from functools import partial
from typing import Final, TypeAlias

__all__ = ["ARITY", "Atom", "Formula", "Monitor", "Operation", "Verdict", "atoms", "is_temporal"]

ARITY: Final = {"not": 1, "next": 1, "always": 1, "eventually": 1, "until": 2, "implies": 2}
"""Operands of each operator; ``and`` and ``or`` have any number."""


class Verdict(IntEnum):
    """What is known of a formula after a finite trace; true if it holds as far as the trace goes."""

    FALSE = 1
    PRESUMABLY_FALSE = 2
    PRESUMABLY_TRUE = 3
    TRUE = 4

    def __bool__(self) -> bool:
        return self.value > 2

    @property
    def is_certain(self) -> bool:
        """Whether no further state can change it."""
        return self in (Verdict.FALSE, Verdict.TRUE)


@dataclass(frozen=True, slots=True)
class Atom:
    """A condition on one state; ``index`` is its number among the atoms of its requirement."""

    index: int


@dataclass(frozen=True, slots=True)
class Operation:
    """``operator`` is ``and``, ``or`` or a key of `ARITY`."""

    operator: str
    operands: "tuple[Formula, ...]"

    def __post_init__(self) -> None:
        count = ARITY.get(self.operator)
        if count is None and self.operator not in ("and", "or"):
            raise ValueError(f"unknown operator {self.operator!r}")
        if count not in (None, len(self.operands)):
            raise ValueError(f"`{self.operator}` takes {count} operands, not {len(self.operands)}")


Formula: TypeAlias = "Atom | Operation"


def is_temporal(formula: Formula) -> bool:
    """Whether a formula speaks of more than one state."""
    if isinstance(formula, Atom):
        return False
    return formula.operator in ("next", "always", "eventually", "until") or any(
        is_temporal(operand) for operand in formula.operands
    )


def atoms(formula: Formula) -> list[Atom]:
    """The atoms of a formula, from left to right."""
    if isinstance(formula, Atom):
        return [formula]
    return [atom for operand in formula.operands for atom in atoms(operand)]


# Negation normal form: ("atom", index, wanted), (and/or, parts), ("next", weak, part), (until/release, left, right)


@dataclass(frozen=True, slots=True, eq=False)
class _Literal:
    index: int
    wanted: bool


@dataclass(frozen=True, slots=True, eq=False)
class _Junction:
    conjunction: bool
    parts: "tuple[_Normal, ...]"


@dataclass(frozen=True, slots=True, eq=False)
class _Next:
    weak: bool
    part: "_Normal"


@dataclass(frozen=True, slots=True, eq=False)
class _Until:
    """``held until goal``; ``weak`` for its dual: the goal holds up to and including the state where ``held`` does."""

    weak: bool
    held: "_Normal | None"
    goal: "_Normal"


_Normal: TypeAlias = "_Literal | _Junction | _Next | _Until"


class _Pool:
    """Makes normal forms, one object for each: so they are compared and hashed by identity."""

    def __init__(self) -> None:
        self._made: dict[tuple[object, ...], _Normal] = {}

    def _one(self, made: _Normal, *key: object) -> _Normal:
        return self._made.setdefault((type(made), *key), made)

    def normal(self, formula: Formula, wanted: bool) -> _Normal:
        """The formula, or its negation, with negations at atoms only."""
        if isinstance(formula, Atom):
            return self._one(_Literal(formula.index, wanted), formula.index, wanted)
        match formula.operator, formula.operands:
            case "not", (operand,):
                return self.normal(operand, not wanted)
            case "implies", (premise, conclusion):
                return self._junction(
                    not wanted, (self.normal(premise, not wanted), self.normal(conclusion, wanted))
                )
            case ("and" | "or") as operator, operands:
                parts = tuple(self.normal(each, wanted) for each in operands)
                return self._junction((operator == "and") is wanted, parts)
            case "next", (operand,):
                part = self.normal(operand, wanted)
                return self._one(_Next(not wanted, part), not wanted, part)
            case "eventually", (operand,):
                return self._until(not wanted, None, self.normal(operand, wanted))
            case "always", (operand,):
                return self._until(wanted, None, self.normal(operand, wanted))
            case "until", (held, goal):
                return self._until(not wanted, self.normal(held, wanted), self.normal(goal, wanted))
        raise AssertionError(formula)

    def _junction(self, conjunction: bool, parts: tuple[_Normal, ...]) -> _Normal:
        return self._one(_Junction(conjunction, parts), conjunction, parts)

    def _until(self, weak: bool, held: "_Normal | None", goal: _Normal) -> _Normal:
        return self._one(_Until(weak, held, goal), weak, held, goal)


_Obligation: TypeAlias = tuple[bool, _Normal]
"""Whether it is weak, and what the next state has to meet."""

_Clauses: TypeAlias = frozenset[frozenset[_Obligation]]

_FALSE: Final[_Clauses] = frozenset()
_TRUE: Final[_Clauses] = frozenset([frozenset()])


def _either(left: _Clauses, right: _Clauses) -> _Clauses:
    if not left or right == _TRUE or left == right:
        return right
    if not right or left == _TRUE:
        return left
    return _absorbed(left | right)


def _both(left: _Clauses, right: _Clauses) -> _Clauses:
    if not left or not right:
        return _FALSE
    if left in (_TRUE, right):
        return right
    if right == _TRUE:
        return left
    return _absorbed(frozenset(one | other for one in left for other in right))


def _absorbed(clauses: _Clauses) -> _Clauses:
    """Without the clauses that another one implies."""
    if len(clauses) == 1:
        return clauses
    kept: list[frozenset[_Obligation]] = []
    for clause in sorted(clauses, key=len):
        if not any(other <= clause for other in kept):
            kept.append(clause)
    return frozenset(kept)


class Monitor:
    """Follows one formula along a trace.

    Args:
        formula: what is to hold from the first state on.

    """

    __slots__ = ("_left", "_start", "verdict")

    def __init__(self, formula: Formula) -> None:
        self._start: _Normal | None = _Pool().normal(formula, True)
        self._left: _Clauses = _FALSE
        self.verdict: Verdict | None = None
        """The verdict on the states so far; ``None`` before the first."""

    def add(self, evaluate: Callable[[int], bool]) -> Verdict:
        """The verdict after one more state, in which ``evaluate`` gives the truth of atoms by their number.

        Only atoms that still matter are evaluated, and none once the verdict is certain. An exception of an atom counts
        only where the others do not decide; then it is raised.
        """
        if self._start is not None:
            left = _progressed(self._start, evaluate)
            self._start = None
        elif self._left == _TRUE or not self._left:
            assert self.verdict is not None
            return self.verdict
        else:
            left = self._next(evaluate)
        self._left = left
        if not left:
            self.verdict = Verdict.FALSE
        elif left == _TRUE:
            self.verdict = Verdict.TRUE
        elif any(all(weak for weak, _ in clause) for clause in left):
            self.verdict = Verdict.PRESUMABLY_TRUE
        else:
            self.verdict = Verdict.PRESUMABLY_FALSE
        return self.verdict

    def _next(self, evaluate: Callable[[int], bool]) -> _Clauses:
        known: dict[_Normal, _Clauses | Exception] = {}

        def clause(parts: frozenset[_Obligation]) -> _Clauses:
            return _decided(True, [partial(_once, part, evaluate, known) for _, part in parts])

        clauses = [partial(clause, parts) for parts in self._left]
        return clauses[0]() if len(clauses) == 1 else _decided(False, clauses)


def _once(
    part: _Normal, evaluate: Callable[[int], bool], known: dict[_Normal, "_Clauses | Exception"]
) -> _Clauses:
    """What is left of an obligation, which several clauses may share."""
    found = known.get(part)
    if found is None:
        try:
            found = _progressed(part, evaluate)
        except Exception as error:  # noqa: BLE001 - it may not count
            found = error
        known[part] = found
    if isinstance(found, Exception):
        raise found
    return found


def _progressed(part: _Normal, evaluate: Callable[[int], bool]) -> _Clauses:
    """What is left to hold after one more state."""
    match part:
        case _Literal(index, wanted):
            return _TRUE if evaluate(index) is wanted else _FALSE
        case _Junction(conjunction, parts):
            return _decided(conjunction, [partial(_progressed, each, evaluate) for each in parts])
        case _Next(weak, later):
            return frozenset([frozenset([(weak, later)])])
        case _Until(weak, held, goal):
            again: _Clauses = frozenset([frozenset([(weak, part)])])

            def go_on() -> _Clauses:
                if held is None:
                    return again
                return _decided(not weak, [lambda: _progressed(held, evaluate), lambda: again])

            return _decided(weak, [lambda: _progressed(goal, evaluate), go_on])


def _decided(conjunction: bool, parts: Sequence[Callable[[], _Clauses]]) -> _Clauses:
    """The parts joined; raises the first exception of one only if the others do not decide."""
    join, neutral, deciding = (_both, _TRUE, _FALSE) if conjunction else (_either, _FALSE, _TRUE)
    result = neutral
    error: Exception | None = None
    for part in parts:
        try:
            result = join(result, part())
        except Exception as problem:  # noqa: BLE001 - whatever the program raises
            error = problem if error is None else error
        if result == deciding:
            return result
    if error is not None:
        raise error
    return result
