"""Temporal formulas with negations at atoms only, so that what is left to hold after a state is a monotone thing.

Each subformula is one object, compared and hashed by identity.
"""

from typing import TypeAlias

from scenic.dataclass import dataclass
from scenic.runtime.temporal.formulas import Atom, Formula

__all__ = ["Connective", "Literal", "Next", "Normal", "Obligation", "Until", "normal"]


@dataclass(frozen=True, slots=True, eq=False)
class Literal:
    index: int
    wanted: bool


@dataclass(frozen=True, slots=True, eq=False)
class Connective:
    conjunction: bool
    parts: "tuple[Normal, ...]"


@dataclass(frozen=True, slots=True, eq=False)
class Next:
    weak: bool
    part: "Normal"


@dataclass(frozen=True, slots=True, eq=False)
class Until:
    """``held until goal``; ``weak`` for its dual: the goal holds up to and including the state where ``held`` does."""

    weak: bool
    held: "Normal | None"
    goal: "Normal"


Normal: TypeAlias = "Literal | Connective | Next | Until"


class _Pool:
    """Makes normal forms, one object for each: so they are compared and hashed by identity."""

    def __init__(self) -> None:
        self._made: dict[tuple[object, ...], Normal] = {}

    def _one(self, made: Normal, *key: object) -> Normal:
        return self._made.setdefault((type(made), *key), made)

    def make(self, formula: Formula, wanted: bool) -> Normal:
        """Return the formula, or its negation, with negations at atoms only."""
        if isinstance(formula, Atom):
            return self._one(Literal(formula.index, wanted), formula.index, wanted)
        match formula.operator, formula.operands:
            case "not", (operand,):
                return self.make(operand, not wanted)
            case "implies", (premise, conclusion):
                return self._junction(
                    not wanted, (self.make(premise, not wanted), self.make(conclusion, wanted))
                )
            case ("and" | "or") as operator, operands:
                parts = tuple(self.make(each, wanted) for each in operands)
                return self._junction((operator == "and") is wanted, parts)
            case "next", (operand,):
                part = self.make(operand, wanted)
                return self._one(Next(not wanted, part), not wanted, part)
            case "eventually", (operand,):
                return self._until(not wanted, None, self.make(operand, wanted))
            case "always", (operand,):
                return self._until(wanted, None, self.make(operand, wanted))
            case "until", (condition, goal):
                return self._until(not wanted, self.make(condition, wanted), self.make(goal, wanted))
        raise AssertionError(formula)

    def _junction(self, conjunction: bool, parts: tuple[Normal, ...]) -> Normal:
        return self._one(Connective(conjunction, parts), conjunction, parts)

    def _until(self, weak: bool, held: "Normal | None", goal: Normal) -> Normal:
        return self._one(Until(weak, held, goal), weak, held, goal)


Obligation: TypeAlias = tuple[bool, Normal]
"""Something that the next state has to meet, and before it whether it is weak: met if there is no next state."""


def normal(formula: Formula) -> Normal:
    """Return the normal form of a formula."""
    return _Pool().make(formula, True)
