"""A reference evaluator of temporal formulas over finite traces, with the four verdicts of RV-LTL.

It follows section 12.6 of the specification literally, without regard to speed. A formula is a tree of tuples: an atom is
its name, an operator a tuple of its word and its operands. A trace is a sequence of states, each the set of the atoms
that hold in it.

Certainty is that of the column *becomes certain* there: a verdict is certain as soon as the operands that are decided
decide it. Formulas are rewritten state by state into what has yet to hold (progression), and constants fold. That a
formula which is not decided so is a tautology, as ``always (a or not a)`` is, remains unnoticed.
"""

import ast
from collections.abc import Callable, Sequence
from collections.abc import Set as AbstractSet
from enum import Enum
from typing import Final, TypeAlias

from scenic.compiler import tree

__all__ = [
    "WORDS",
    "Formula",
    "State",
    "Verdict",
    "atoms_of",
    "conditional",
    "formula_of",
    "holds",
    "progressed",
    "text_of",
    "verdict",
]

Formula: TypeAlias = "str | bool | tuple[str, *tuple[Formula, ...]]"
State: TypeAlias = AbstractSet[str]

WORDS: Final = {"always": 1, "eventually": 1, "next": 1, "not": 1, "until": 2, "implies": 2}
"""The operators with a fixed number of operands; ``and`` and ``or`` have two or more."""


class Verdict(Enum):
    """The verdict on a formula after a finite trace."""

    TRUE = 4
    PRESUMABLY_TRUE = 3
    PRESUMABLY_FALSE = 2
    FALSE = 1

    def __bool__(self) -> bool:
        return self.value > 2


def verdict(formula: Formula, trace: Sequence[State]) -> Verdict:
    """The verdict after all states of a trace, of which there is at least one.

    Raises `ValueError` if there is none.
    """
    if not trace:
        raise ValueError("the trace is empty")
    rest = formula
    for state in trace:
        rest = progressed(rest, state)
    if isinstance(rest, bool):
        return Verdict.TRUE if rest else Verdict.FALSE
    return Verdict.PRESUMABLY_TRUE if holds(formula, trace, 0) else Verdict.PRESUMABLY_FALSE


def holds(formula: Formula, trace: Sequence[State], position: int) -> bool:
    """The value on a finite trace that ends (column *finite-trace value* of section 12.6)."""
    places = range(position, len(trace))
    match formula:
        case bool():
            return formula
        case str():
            return formula in trace[position]
        case ("not", operand):
            return not holds(operand, trace, position)
        case ("and", *operands):
            return all(holds(each, trace, position) for each in operands)
        case ("or", *operands):
            return any(holds(each, trace, position) for each in operands)
        case ("implies", premise, conclusion):
            return not holds(premise, trace, position) or holds(conclusion, trace, position)
        case ("next", operand):
            return position + 1 < len(trace) and holds(operand, trace, position + 1)
        case ("always", operand):
            return all(holds(operand, trace, place) for place in places)
        case ("eventually", operand):
            return any(holds(operand, trace, place) for place in places)
        case ("until", before, goal):
            return any(
                holds(goal, trace, end) and all(holds(before, trace, place) for place in range(position, end))
                for end in places
            )
    raise ValueError(f"no formula: {formula!r}")


def progressed(formula: Formula, state: State) -> Formula:
    """Return the formula that must hold from the next state on, so that ``formula`` holds from this state on."""
    match formula:
        case bool():
            return formula
        case str():
            return formula in state
        case ("not", operand):
            return _negated(progressed(operand, state))
        case ("and", *operands):
            return _joined("and", [progressed(each, state) for each in operands])
        case ("or", *operands):
            return _joined("or", [progressed(each, state) for each in operands])
        case ("implies", premise, conclusion):
            return _joined("or", [_negated(progressed(premise, state)), progressed(conclusion, state)])
        case ("next", operand):
            return operand
        case ("always", operand):
            return _joined("and", [progressed(operand, state), formula])
        case ("eventually", operand):
            return _joined("or", [progressed(operand, state), formula])
        case ("until", before, goal):
            later = _joined("and", [progressed(before, state), formula])
            return _joined("or", [progressed(goal, state), later])
    raise ValueError(f"no formula: {formula!r}")


def _negated(formula: Formula) -> Formula:
    return not formula if isinstance(formula, bool) else ("not", formula)


def _joined(word: str, operands: Sequence[Formula]) -> Formula:
    """A conjunction or disjunction, without operands that do not matter."""
    deciding = word == "or"
    open_ones = list(dict.fromkeys(each for each in operands if not isinstance(each, bool)))
    if deciding in [each for each in operands if isinstance(each, bool)]:
        return deciding
    if not open_ones:
        return not deciding
    return open_ones[0] if len(open_ones) == 1 else (word, *open_ones)


def formula_of(node: ast.expr, atom: Callable[[ast.expr], str] | None = None) -> Formula:
    """Return the formula of a condition. Atoms are names; the name of any other atom is what ``atom`` makes of it.

    Raises `ValueError` if there is no ``atom`` and something else than a name is one.
    """
    match node:
        case ast.Name(id=name):
            return name
        case ast.UnaryOp(op=ast.Not(), operand=operand):
            return ("not", formula_of(operand, atom))
        case ast.BoolOp(op=operator, values=values):
            word = "and" if isinstance(operator, ast.And) else "or"
            return (word, *(formula_of(each, atom) for each in values))
        case ast.IfExp(test=test, body=body, orelse=orelse):
            # There is no temporal operator in it, so all three are about one state.
            yes, no, condition = (formula_of(each, atom) for each in (body, orelse, test))
            return conditional(yes, condition, no)
        case tree.Temporal(operator=word, operands=operands):
            return (word, *(formula_of(each, atom) for each in operands))
    if atom is None:
        raise ValueError(f"no condition: {ast.dump(node)}")
    return atom(node)


def conditional(yes: Formula, test: Formula, no: Formula) -> Formula:
    """Return the formula of ``yes if test else no``."""
    return ("or", ("and", test, yes), ("and", ("not", test), no))


def atoms_of(formula: Formula) -> frozenset[str]:
    """Return the atoms of a formula."""
    match formula:
        case bool():
            return frozenset()
        case str():
            return frozenset({formula})
        case (_, *operands):
            return frozenset().union(*map(atoms_of, operands))
    raise ValueError(f"no formula: {formula!r}")


def text_of(formula: Formula) -> str:
    """Write a formula as a condition with parentheses around every operation."""
    match formula:
        case str():
            return formula
        case (("and" | "or" | "until" | "implies") as word, *operands):
            return f"({f' {word} '.join(map(text_of, operands))})"
        case (str(word), operand):
            return f"({word} {text_of(operand)})"
    raise ValueError(f"no condition: {formula!r}")
