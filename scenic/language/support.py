"""Parts of the language that this version refuses, computed from the declarations."""

from collections.abc import Iterator

from scenic.language.keywords import TEMPORAL_OPERATORS
from scenic.language.names import NAMES
from scenic.language.operators import OPERATORS
from scenic.language.specifiers import SPECIFIERS
from scenic.language.statements import STATEMENTS

__all__ = ["refused_features"]


def refused_features() -> Iterator[str]:
    """Yield every feature that this version refuses, one line of text each, in order of declaration."""
    for operator in OPERATORS.values():
        if not operator.available:
            yield f"operator {operator.name}"
    for specifier in SPECIFIERS.values():
        if not specifier.available:
            yield f"specifier {specifier.name}"
    for temporal in TEMPORAL_OPERATORS.values():
        if not temporal.available:
            yield f"temporal operator {temporal.name}"
    for statement in STATEMENTS.values():
        if not statement.available:
            yield f"statement {statement.title}"
    for name in NAMES.values():
        if not name.available:
            yield f"name {name.name}"
