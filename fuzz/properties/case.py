"""Properties, and the cases that they are checked on."""

import ast
import zlib
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from functools import cached_property
from typing import Any, Final, Protocol

from scenic.compiler.check import check_text
from scenic.compiler.generated import WORDS
from scenic.compiler.lexer import lex
from scenic.compiler.parser import ParseResult, parse
from scenic.compiler.tokens import Tokens
from scenic.compiler.tolerant_lexer import lex_tolerantly
from scenic.language.diagnostics import Diagnostic, Severity
from scenic.language.source import Source
from scenic.language.spans import Span

__all__ = [
    "FILENAME",
    "Case",
    "Change",
    "Property",
    "Violation",
    "describe",
    "is_syntax_error",
    "spans_of",
]

FILENAME: Final = "<fuzz>"
"""The name under which texts are checked."""


class Violation(AssertionError):
    """Raised if a property does not hold; the message gives the place."""


class Change(Protocol):
    """The change that made a text from a program; `fuzz.mutations.Mutant` is one."""

    @property
    def original(self) -> str:
        """The program."""


class Case:
    """A text, parsed once for all properties.

    ``mutant`` says which program it was made of, if it was. Properties that are dear are tried on a sample of the texts
    only, unless the case is ``thorough``: as it must be where a known failure is tried again, on shorter texts or later.
    """

    def __init__(self, text: str, mutant: Change | None = None, *, thorough: bool = False) -> None:
        self.text = text
        self.mutant = mutant
        self.thorough = thorough

    @cached_property
    def result(self) -> ParseResult:
        """The result of parsing the text; raises the parser's exceptions."""
        return parse(self.text)

    @cached_property
    def has_error(self) -> bool:
        """True if the parser finds an error."""
        return any(each.severity is Severity.ERROR for each in self.result.diagnostics)

    @cached_property
    def checked(self) -> tuple[Diagnostic, ...]:
        """The diagnostics of the static check of the text; raises the check's exceptions."""
        return check_text(self.text, filename=FILENAME)

    @cached_property
    def source(self) -> Source:
        """The text as the compiler reads it."""
        return Source(self.text, FILENAME)

    @cached_property
    def tokens(self) -> Tokens:
        """The tokens that the tree was made of."""
        return lex_tolerantly(self.text, WORDS) if self.has_error else lex(self.text, WORDS)

    @cached_property
    def lines(self) -> tuple[str, ...]:
        """The lines as the compiler reads them: every text is one that ends with a line end."""
        lines = self.source.lines
        return (*lines, "") if lines[-1] else lines

    @cached_property
    def widths(self) -> tuple[int, ...]:
        """The length of each line in bytes of UTF-8."""
        return tuple(len(line.encode("utf-8", "surrogatepass")) for line in self.lines)

    @cached_property
    def number(self) -> int:
        """A number that depends on the text alone, for all that is to be done at random."""
        return zlib.crc32(self.text.encode("utf-8", "surrogatepass"))

    def fresh_tree(self) -> ast.Module:
        """The tree once more, to do with as one likes."""
        return parse(self.text).tree


@dataclass(frozen=True, slots=True)
class Property:
    """A named property: ``holds`` returns if it holds of a case, or is not to be tried on it, and raises if it does not.

    It is tried on one text in ``one_in``.
    """

    name: str
    holds: Callable[[Case], None]
    one_in: int = 1

    @staticmethod
    def of(function: Callable[[Case], None], *, one_in: int = 1) -> "Property":
        """Return the property that a function states."""
        name = function.__name__

        def holds(case: Case) -> None:
            # The name takes part, so that the properties do not all sample the same texts.
            if case.thorough or (case.number + zlib.crc32(name.encode())) % one_in == 0:
                function(case)

        return Property(name, function if one_in == 1 else holds, one_in)


def is_syntax_error(diagnostic: Diagnostic) -> bool:
    """Return whether a diagnostic is a syntax error."""
    return diagnostic.severity is Severity.ERROR and diagnostic.code.startswith("SC1")


def spans_of(diagnostic: Diagnostic) -> Iterator[tuple[str, Span | None]]:
    """All places in a diagnostic, each with a description."""
    yield "span", diagnostic.span
    for label in diagnostic.labels:
        yield "label", label.span
    if diagnostic.fix is not None:
        for edit in diagnostic.fix.edits:
            yield "edit", edit.span


def describe(diagnostic: Diagnostic) -> str:
    """Write a diagnostic in one line."""
    return f"{diagnostic.code} {diagnostic.message!r} at {diagnostic.span}"


def place(node: ast.AST) -> tuple[tuple[int, int], tuple[int, int]]:
    """Start and end of a node, each as line and column in bytes."""
    located: Any = node
    return (located.lineno, located.col_offset), (located.end_lineno, located.end_col_offset)
