"""What must hold: of every text, and of every program that the grammar makes.

A property is a function of a `Case` that returns if it holds and raises `Violation`, or whatever the compiler raised,
if it does not. To add one, write the function and enter it in `OF_TEXTS` or `OF_PROGRAMS`.
"""

import ast
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import Any, Final

from scenic.compiler.check import check_text
from scenic.compiler.parser import ParseResult, parse
from scenic.compiler.tree import ErrorStatement
from scenic.language.diagnostics import Diagnostic, Severity
from scenic.language.source import Source
from scenic.language.spans import Span

__all__ = ["OF_PROGRAMS", "OF_TEXTS", "REFUSED", "Case", "Property", "Violation"]


class Violation(AssertionError):
    """A property does not hold; the message says where."""


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


class Case:
    """A text, parsed once for all properties."""

    def __init__(self, text: str) -> None:
        self.text = text

    @cached_property
    def result(self) -> ParseResult:
        """What the parser makes of it; raises what the parser raises."""
        return parse(self.text)

    @cached_property
    def lines(self) -> tuple[str, ...]:
        """The lines as the compiler reads them: every text is one that ends with a line end."""
        lines = Source(self.text, "<fuzz>").lines
        return (*lines, "") if lines[-1] else lines


# Of every text.


def parsing_gives_a_tree(case: Case) -> None:
    """Parsing never raises, and says of a tree with gaps that there is an error."""
    result = case.result
    if not isinstance(result.tree, ast.Module):
        raise Violation(f"the tree is a {type(result.tree).__name__}")
    if not _has_error(result.diagnostics):
        for node in ast.walk(result.tree):
            if isinstance(node, ErrorStatement):
                raise Violation("there is an ErrorStatement, but no error")


def diagnostics_lie_in_the_text(case: Case) -> None:
    """Every span of a diagnostic lies in the text."""
    _check_spans(case.result.diagnostics, case)


def nodes_lie_in_the_text(case: Case) -> None:
    """The places of all nodes lie in the text, and do not end before they start."""
    lines = [len(line.encode("utf-8", "surrogatepass")) for line in case.lines]
    for node in ast.walk(case.result.tree):
        located: Any = node
        if "lineno" not in node._attributes:
            continue
        try:
            start = (located.lineno, located.col_offset)
            end = (located.end_lineno, located.end_col_offset)
        except AttributeError as problem:
            raise Violation(f"{type(node).__name__} has no place: {problem}") from None
        name = type(node).__name__
        for line, column in (start, end):
            # The column after the last one is that of the line end.
            if not (1 <= line <= len(lines) and 0 <= column <= lines[line - 1] + 1):
                raise Violation(f"{name} at {line}:{column} lies outside the text")
        if end < start:
            raise Violation(f"{name} at {start} ends before that, at {end}")


def checking_never_raises(case: Case) -> None:
    """The static check gives diagnostics, which lie in the text."""
    _check_spans(check_text(case.text, filename="<fuzz>"), case)


# Of programs.


def programs_are_accepted(case: Case) -> None:
    """The parser finds nothing wrong with what the grammar makes."""
    for diagnostic in case.result.diagnostics:
        if (
            diagnostic.severity is Severity.ERROR
            and diagnostic.code.startswith("SC1")
            and not any(
                (diagnostic.code, diagnostic.message) == (refusal.code, refusal.message)
                for refusal in REFUSED
            )
        ):
            raise Violation(f"refused: {_describe(diagnostic)}")


@dataclass(frozen=True, slots=True)
class Property:
    """A named property."""

    name: str
    holds: Callable[[Case], None]


def _named(*functions: Callable[[Case], None]) -> tuple[Property, ...]:
    return tuple(Property(function.__name__, function) for function in functions)


OF_TEXTS: Final = _named(
    parsing_gives_a_tree, diagnostics_lie_in_the_text, nodes_lie_in_the_text, checking_never_raises
)
OF_PROGRAMS: Final = (*OF_TEXTS, *_named(programs_are_accepted))


def _has_error(diagnostics: Sequence[Diagnostic]) -> bool:
    return any(diagnostic.severity is Severity.ERROR for diagnostic in diagnostics)


def _check_spans(diagnostics: Sequence[Diagnostic], case: Case) -> None:
    for diagnostic in diagnostics:
        for span in (diagnostic.span, *(label.span for label in diagnostic.labels)):
            if span is not None and not _lies_in(span, case.lines):
                raise Violation(f"outside the text: {_describe(diagnostic)}")


def _lies_in(span: Span, lines: Sequence[str]) -> bool:
    # The column after the last one is that of the line end.
    return span.end_line <= len(lines) and all(
        column <= len(lines[line - 1]) + 1
        for line, column in ((span.line, span.column), (span.end_line, span.end_column))
    )


def _describe(diagnostic: Diagnostic) -> str:
    return f"{diagnostic.code} {diagnostic.message!r} at {diagnostic.span}"
