"""Properties of the parser's result, for any text."""

import ast
from itertools import pairwise

from fuzz.properties.case import (
    Case,
    Property,
    Violation,
    describe,
    is_syntax_error,
    spans_of,
)
from fuzz.properties.differences import difference
from fuzz.properties.work import work
from scenic.compiler.check import check_text
from scenic.compiler.parser import parse
from scenic.compiler.tree import ErrorStatement
from scenic.language.spans import Span

__all__ = ["OF_TEXTS"]


def parsing_gives_a_tree(case: Case) -> None:
    """Parsing never raises, and reports an error for a tree with gaps."""
    result = case.result
    if not isinstance(result.tree, ast.Module):
        raise Violation(f"the tree is a {type(result.tree).__name__}")
    if not case.has_error and any(isinstance(node, ErrorStatement) for node in ast.walk(result.tree)):
        raise Violation("there is an ErrorStatement, but no error")


def diagnostics_lie_in_the_text(case: Case) -> None:
    """Every place in a diagnostic of the parser or of the static check lies in the text.

    So do the places of labels and of the changes that repair it; these do not overlap. The check says what the parser says,
    and never raises.
    """
    check_diagnostics = set(case.checked)
    for diagnostic in {*case.result.diagnostics, *check_diagnostics}:
        for what, span in spans_of(diagnostic):
            if span is None:
                raise Violation(f"{what} without a place: {describe(diagnostic)}")
            if not _lies_in(span, case):
                raise Violation(f"{what} outside the text, at {span}: {describe(diagnostic)}")
        if diagnostic.fix is not None:
            edits = sorted((edit.span, edit.text) for edit in diagnostic.fix.edits)
            for (before, _), (after, _) in pairwise(edits):
                if (before.end_line, before.end_column) > (after.line, after.column):
                    raise Violation(f"edits overlap: {describe(diagnostic)}")
    keys = {(each.code, each.span, each.message) for each in check_diagnostics}
    for diagnostic in case.result.diagnostics:
        if is_syntax_error(diagnostic) and (diagnostic.code, diagnostic.span, diagnostic.message) not in keys:
            raise Violation(f"the check does not say: {describe(diagnostic)}")


def parsing_is_deterministic(case: Case) -> None:
    """Parsing again gives the same tree and diagnostics, and so does parsing the text with other line ends."""
    plain = case.source.text
    for text in (case.text, plain, plain.replace("\n", "\r\n"), plain.replace("\n", "\r"), f"\ufeff{plain}"):
        again = parse(text)
        where = difference(case.result.tree, again.tree, places=True)
        if where is not None:
            raise Violation(f"another tree for {text[:40]!r}: {where}")
        if again.diagnostics != case.result.diagnostics:
            raise Violation("other diagnostics for the same text")


_SMALL, _LARGE = 4, 8
_ALLOWANCE = 3000
"""Calls more than the proportion: a report costs some until the bound of reports is reached."""


def work_is_linear(case: Case) -> None:
    """Twice the text takes about twice the work, counted in calls, to parse and to check."""
    text = case.source.text
    text = text if text.endswith("\n") else f"{text}\n"
    for name, function in (("parsing", parse), ("checking", _check)):
        small, large = (work(function, text * times) for times in (_SMALL, _LARGE))
        if large > 2.5 * small + _ALLOWANCE:
            raise Violation(
                f"{name} is not linear: {small} calls for {_SMALL} times the text, {large} for {_LARGE}"
            )


def _check(text: str) -> object:
    return check_text(text, filename="<fuzz>")


def _lies_in(span: Span, case: Case) -> bool:
    # The column after the last one is that of the line end.
    lines = case.lines
    return span.end_line <= len(lines) and all(
        column <= len(lines[line - 1]) + 1
        for line, column in ((span.line, span.column), (span.end_line, span.end_column))
    )


OF_TEXTS = (
    Property.of(parsing_gives_a_tree),
    Property.of(diagnostics_lie_in_the_text),
    Property.of(parsing_is_deterministic, one_in=8),
    Property.of(work_is_linear, one_in=100),
)
