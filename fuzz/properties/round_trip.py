"""Writing a tree and reading it again."""

from typing import Final

from fuzz.properties.case import Case, Property, Violation, describe
from fuzz.properties.differences import difference
from scenic.compiler.parser import parse
from scenic.compiler.unparser import unparse
from scenic.language.diagnostics import Severity

__all__ = ["OF_TEXTS"]


def written_trees_read_the_same(case: Case) -> None:
    """``parse(unparse(t)) == t`` for the tree of a text without errors, and what is written is written the same again."""
    if case.has_error:
        return
    written = unparse(case.result.tree)
    again = parse(written)
    for diagnostic in again.diagnostics:
        if diagnostic.severity is Severity.ERROR:
            raise Violation(f"what was written is refused: {describe(diagnostic)}\n{written}")
    where = difference(case.result.tree, again.tree)
    if where is not None:
        raise Violation(f"another tree: {where}\n{written}")
    if case.number % 4 == 0 or case.thorough:
        # It would not if the writer looked at places.
        twice = unparse(again.tree)
        if twice != written:
            raise Violation(f"written differently the second time:\n{written}{twice}")


OF_TEXTS: Final = (Property.of(written_trees_read_the_same),)
