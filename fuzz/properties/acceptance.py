"""Acceptance: every sentence of the grammar is a program."""

from dataclasses import dataclass
from typing import Final

from fuzz.properties.case import Case, Property, Violation, describe, is_syntax_error

__all__ = ["OF_PROGRAMS", "REFUSED", "Refusal"]


@dataclass(frozen=True, slots=True)
class Refusal:
    """A diagnostic that a program of the grammar may get from the parser all the same, and why."""

    code: str
    message: str
    reason: str


REFUSED: Final = (
    Refusal("SC120", "type parameters need Python 3.12 or newer", "depends on the running Python"),
    Refusal("SC120", "`type` statements need Python 3.12 or newer", "depends on the running Python"),
)
"""All that may be refused. What else the grammar does not say is in ``fuzz/narrowing.gram``."""


def programs_are_accepted(case: Case) -> None:
    """The parser finds nothing wrong with what the grammar makes."""
    for diagnostic in case.result.diagnostics:
        refused = (diagnostic.code, diagnostic.message)
        if is_syntax_error(diagnostic) and refused not in _REFUSED:
            raise Violation(f"refused: {describe(diagnostic)}")


_REFUSED: Final = frozenset((each.code, each.message) for each in REFUSED)

OF_PROGRAMS: Final = (Property.of(programs_are_accepted),)
