"""Temporal formulas under their established names."""

from collections.abc import Callable, Sequence

from scenic.runtime.temporal.formulas import Atom, Compound, Formula

__all__ = [
    "Always",
    "AtomicProposition",
    "Eventually",
    "Implies",
    "Next",
    "PropositionAnd",
    "PropositionNot",
    "PropositionOr",
    "Until",
]


def AtomicProposition(closure: Callable[[], object], syntaxId: int) -> Atom:  # noqa: ARG001
    """The atom with the number ``syntaxId`` among the atoms of its requirement."""
    return Atom(syntaxId)


def PropositionAnd(reqs: Sequence[Formula]) -> Compound:
    """Return the formula that all of these hold."""
    return Compound("and", tuple(reqs))


def PropositionOr(reqs: Sequence[Formula]) -> Compound:
    """Return the formula that one of these holds."""
    return Compound("or", tuple(reqs))


def PropositionNot(req: Formula) -> Compound:
    """Return the formula that another does not hold."""
    return Compound("not", (req,))


def Always(req: Formula) -> Compound:
    """Return the formula that another holds in this state and in all later ones."""
    return Compound("always", (req,))


def Eventually(req: Formula) -> Compound:
    """Return the formula that another holds in this state or in a later one."""
    return Compound("eventually", (req,))


def Next(req: Formula) -> Compound:
    """Return the formula that another holds in the next state."""
    return Compound("next", (req,))


def Until(lhs: Formula, rhs: Formula) -> Compound:
    """Return the formula that one holds until another does, which it does at some time."""
    return Compound("until", (lhs, rhs))


def Implies(lhs: Formula, rhs: Formula) -> Compound:
    """Return the formula that one holds wherever another does."""
    return Compound("implies", (lhs, rhs))
