"""Between the protocol's positions and ours: the only place that knows both.

The protocol counts lines from 0, and columns in code units of an encoding that client and server agree on; we count
lines from 1 and columns in characters. A byte order mark at the beginning is a character for the protocol, and none for
us.
"""

import os
from collections.abc import Callable, Iterable, Mapping
from dataclasses import field
from enum import StrEnum
from typing import Final

from lsprotocol import types

from scenic.dataclass import dataclass
from scenic.language.diagnostics import Diagnostic, Edit, Label, Severity
from scenic.language.explanations import explanation_file
from scenic.language.source import Source
from scenic.language.spans import Span
from scenic.lsp.uris import to_uri

__all__ = ["Encoding", "Lines", "to_diagnostic", "units"]

_SEVERITIES: Final[Mapping[Severity, types.DiagnosticSeverity]] = {
    Severity.ERROR: types.DiagnosticSeverity.Error,
    Severity.WARNING: types.DiagnosticSeverity.Warning,
    Severity.INFORMATION: types.DiagnosticSeverity.Information,
}
_UNNECESSARY: Final = frozenset({"SC205", "SC206", "SC303", "SC390"})
"""Codes of what can be left out, which editors show faded."""


class Encoding(StrEnum):
    """The encodings in which columns are counted."""

    UTF8 = "utf-8"
    UTF16 = "utf-16"
    UTF32 = "utf-32"


def units(text: str, encoding: Encoding) -> int:
    """Return the length of a text in code units."""
    if encoding is Encoding.UTF32 or text.isascii():
        return len(text)
    if encoding is Encoding.UTF8:
        return len(text.encode("utf-8", "surrogatepass"))
    return len(text.encode("utf-16-le", "surrogatepass")) // 2


@dataclass(frozen=True, slots=True)
class Lines:
    """The lines of a text, and where the protocol sees them.

    ``marks`` is how many byte order marks it begins with, ``before`` how many lines of its document precede it.
    """

    source: Source
    encoding: Encoding
    marks: int = 0
    before: int = 0
    _lead: int = field(init=False, default=0)

    def __post_init__(self) -> None:
        object.__setattr__(self, "_lead", units("\ufeff" * self.marks, self.encoding))

    def to_position(self, line: int, column: int) -> types.Position:
        """A place as a position."""
        character = units(self.source.line(line)[:column], self.encoding)
        return types.Position(self.before + line - 1, character + (self._lead if line == 1 else 0))

    def to_range(self, span: Span) -> types.Range:
        """Return a span as a range."""
        return types.Range(
            self.to_position(span.line, span.column), self.to_position(span.end_line, span.end_column)
        )

    def from_position(self, position: types.Position) -> tuple[int, int]:
        """Return a position as line and column.

        Inside a character, the column of that character; past the end of a line, its end; past the end of the text,
        the end of that.
        """
        line, character = position.line - self.before, position.character
        if line < 0:
            return 1, 0
        if line >= len(self.source.lines):
            return len(self.source.lines), len(self.source.lines[-1])
        content = self.source.line(line + 1)
        if line == 0:
            character = max(0, character - self._lead)
        if content.isascii() or self.encoding is Encoding.UTF32:
            return line + 1, min(character, len(content))
        unit_count = 0
        for column, each in enumerate(content):
            unit_count += units(each, self.encoding)
            if unit_count > character:
                return line + 1, column
        return line + 1, len(content)

    def from_range(self, found: types.Range) -> Span:
        """Return a range as a span; one that ends before it starts is empty."""
        first = self.from_position(found.start)
        return Span(*first, *max(first, self.from_position(found.end)))

    def to_edits(self, edits: Iterable[Edit], line_end: str) -> list[types.TextEdit]:
        """Changes of the text, with the line ends of the document."""
        return [types.TextEdit(self.to_range(edit.span), edit.text.replace("\n", line_end)) for edit in edits]


def to_diagnostic(
    diagnostic: Diagnostic,
    lines: Lines,
    uri: str,
    *,
    elsewhere: Callable[[str, Span], types.Location] | None = None,
    related: bool = True,
    tags: bool = True,
    pages: bool = False,
) -> types.Diagnostic:
    """Return a diagnostic as the protocol has it: the help is a line of the message, labels are related places.

    ``elsewhere`` gives the places in other files; without it, they are left out.
    ``related`` and ``tags`` tell whether the client shows such, ``pages`` whether it opens the page of a code.
    """
    message = diagnostic.message
    if diagnostic.help:
        message += f"\nhelp: {diagnostic.help}"
    places = []
    for label in diagnostic.labels:
        if label.filename is None or label.filename == diagnostic.filename:
            location = types.Location(uri, lines.to_range(label.span))
        elif elsewhere is not None:
            location = elsewhere(label.filename, label.span)
        else:
            continue
        places.append(types.DiagnosticRelatedInformation(location, label.text))
    if places and not related:
        message += "".join(f"\n{_place(label)}: {label.text}" for label in diagnostic.labels)
    page = explanation_file(diagnostic.code) if pages else None
    return types.Diagnostic(
        lines.to_range(diagnostic.span or Span(1, 0, 1, 0)),
        message,
        severity=_SEVERITIES[diagnostic.severity],
        code=diagnostic.code,
        code_description=None if page is None else types.CodeDescription(to_uri(page)),
        source="scenic",
        tags=[types.DiagnosticTag.Unnecessary] if tags and diagnostic.code in _UNNECESSARY else None,
        related_information=places if places and related else None,
    )


def _place(label: Label) -> str:
    """A place in words."""
    line = f"line {label.span.line}"
    return line if label.filename is None else f"{os.path.basename(label.filename)}, {line}"
