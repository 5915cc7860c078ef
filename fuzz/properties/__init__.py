"""Properties that must hold of every text, and of every program that the grammar makes.

One module for each family.

A property is a function of a `Case` that returns if it holds and raises `Violation`, or whatever the compiler raised,
if it does not. To add one, write the function and enter it in its module's ``OF_TEXTS`` or ``OF_PROGRAMS``.
"""

from typing import Final

from fuzz.properties import (
    acceptance,
    columns,
    content,
    formatting,
    forms,
    lowering,
    neighbours,
    parsers,
    parsing,
    python,
    recovery,
    repairs,
    surgery,
    tokens,
    tools,
    trees,
)
from fuzz.properties.acceptance import REFUSED
from fuzz.properties.case import Case, Change, Property, Violation

__all__ = ["OF_PROGRAMS", "OF_TEXTS", "PARSING", "REFUSED", "Case", "Change", "Property", "Violation"]

PARSING: Final = (
    *parsing.OF_TEXTS,
    *trees.OF_TEXTS,
    *tokens.OF_TEXTS,
    *columns.OF_TEXTS,
    *forms.OF_TEXTS,
    *python.OF_TEXTS,
    *parsers.OF_TEXTS,
    *recovery.OF_TEXTS,
)
"""Properties of the parser alone, for every text."""

OF_TEXTS: Final = (
    *PARSING,
    *formatting.OF_TEXTS,
    *neighbours.OF_TEXTS,
    *lowering.OF_TEXTS,
    *content.OF_TEXTS,
    *surgery.OF_TEXTS,
    *tools.OF_TEXTS,
    *repairs.OF_TEXTS,
)
"""Properties of every text."""

OF_PROGRAMS: Final = (*OF_TEXTS, *acceptance.OF_PROGRAMS)
"""Properties of every program that the grammar makes."""
