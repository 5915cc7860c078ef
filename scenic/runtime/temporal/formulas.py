"""Temporal formulas: atoms (indices into what the caller evaluates in each state) and operators."""

from typing import Final, TypeAlias

from scenic.dataclass import dataclass

__all__ = ["ARITY", "Atom", "Compound", "Formula", "is_temporal"]

ARITY: Final = {"not": 1, "next": 1, "always": 1, "eventually": 1, "until": 2, "implies": 2}
"""Operands of each operator; ``and`` and ``or`` have any number."""


@dataclass(frozen=True, slots=True)
class Atom:
    """A condition on one state; ``index`` is its number among the atoms of its requirement."""

    index: int


@dataclass(frozen=True, slots=True)
class Compound:
    """``operator`` is ``and``, ``or`` or a key of `ARITY`."""

    operator: str
    operands: "tuple[Formula, ...]"

    def __post_init__(self) -> None:
        count = ARITY.get(self.operator)
        if count is None and self.operator not in ("and", "or"):
            raise ValueError(f"unknown operator {self.operator!r}")
        if count not in (None, len(self.operands)):
            raise ValueError(f"`{self.operator}` takes {count} operands, not {len(self.operands)}")


Formula: TypeAlias = "Atom | Compound"


def is_temporal(formula: Formula) -> bool:
    """Return whether a formula depends on more than one state."""
    if isinstance(formula, Atom):
        return False
    return formula.operator in ("next", "always", "eventually", "until") or any(
        is_temporal(operand) for operand in formula.operands
    )
