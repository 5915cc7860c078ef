"""Properties of the repairs of diagnostics."""

from typing import Final

from fuzz.properties.case import FILENAME, Case, Property, Violation, describe, is_syntax_error
from scenic.compiler.check import check_text
from scenic.compiler.fixes import apply_fixes
from scenic.compiler.parser import parse
from scenic.language.diagnostics import Diagnostic, Fix

__all__ = ["OF_TEXTS"]

_NO_CLAUSE: Final = frozenset({"SC134", "SC132"})
"""Codes for what is missing around the edit, and may be what is broken: a clause, the blocks of a scenario."""
_MOST: Final = 3
"""So many repairs of one text are tried, one from every part of it."""


def repairs_repair(case: Case) -> None:
    """A repair takes its diagnostic away, and makes no error of syntax where there was none."""
    text = case.source.text
    before = case.checked
    repairable = [each for each in before if each.fix is not None]
    for diagnostic in repairable[:: -(-len(repairable) // _MOST) or 1]:
        if diagnostic.fix is None:
            continue
        new_text, edit_count = apply_fixes(text, [diagnostic.fix])
        if edit_count != 1 or new_text == text:
            raise Violation(f"the repair changes nothing: {describe(diagnostic)}")
        after = check_text(new_text, filename=FILENAME)
        if _shown(diagnostic) in map(_shown, after) and _starts_before_edits(diagnostic):
            raise Violation(f"the repair leaves: {describe(diagnostic)}\n{new_text}")
        # By the parser: what only Python's compiler refuses may have been there before, behind other errors.
        errors = [each for each in parse(new_text).diagnostics if is_syntax_error(each)]
        if case.has_error:
            # Of several errors in one statement only the first may be reported, so others may come out now.
            error_count = sum(map(is_syntax_error, case.result.diagnostics))
            errors = [
                each for each in errors if len(errors) > error_count and _is_of_edit(each, diagnostic.fix)
            ]
        if errors:
            raise Violation(f"the repair of {describe(diagnostic)} makes {describe(errors[0])}\n{new_text}")


def _shown(diagnostic: Diagnostic) -> tuple[str, str, object]:
    span = diagnostic.span
    return diagnostic.code, diagnostic.message, span and (span.line, span.column)


def _is_of_edit(diagnostic: Diagnostic, fix: Fix) -> bool:
    """Return whether a diagnostic of the repaired text is about the inserted text."""
    span = diagnostic.span
    # The line with the mistake could have been the clause that is missing before it.
    return (
        diagnostic.code not in _NO_CLAUSE
        and span is not None
        and any(
            edit.span.line == span.line and 0 <= span.column - edit.span.column < max(len(edit.text), 1)
            for edit in fix.edits
        )
    )


def _starts_before_edits(diagnostic: Diagnostic) -> bool:
    """Return whether the edits leave the place of the diagnostic unchanged: a diagnostic after an edit may be
    another one of the same kind.
    """
    assert diagnostic.fix is not None
    return diagnostic.span is not None and all(
        (edit.span.line, edit.span.column) >= (diagnostic.span.line, diagnostic.span.column)
        for edit in diagnostic.fix.edits
    )


OF_TEXTS: Final = (Property.of(repairs_repair, one_in=3),)
