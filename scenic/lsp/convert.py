"""Between the protocol's types and ours: the only place that knows both.

The protocol counts lines from 0, and columns in code units of an encoding that client and server agree on;
we count lines from 1 and columns in characters.
"""

from collections.abc import Iterable
from typing import Final

from lsprotocol import types

from scenic.ide.hover import Hover
from scenic.language.diagnostics import Diagnostic, Edit, Severity
from scenic.language.source import Source
from scenic.language.spans import Span

__all__ = ["Encoding", "from_position", "from_range", "to_diagnostic", "to_edits", "to_hover", "to_range"]

Encoding = types.PositionEncodingKind | str
"""The agreed encoding; anything but UTF-8 and UTF-32 is UTF-16, the protocol's default."""

_SEVERITIES: Final = {
    Severity.ERROR: types.DiagnosticSeverity.Error,
    Severity.WARNING: types.DiagnosticSeverity.Warning,
    Severity.INFORMATION: types.DiagnosticSeverity.Information,
}
_UNNECESSARY: Final = frozenset({"SC205", "SC206", "SC303", "SC390"})
"""Codes of what can be left out, which editors show faded."""


def to_range(span: Span, source: Source, encoding: Encoding) -> types.Range:
    """A span as a range of the protocol."""
    return types.Range(
        _to_position(span.line, span.column, source, encoding),
        _to_position(span.end_line, span.end_column, source, encoding),
    )


def from_position(position: types.Position, source: Source, encoding: Encoding) -> tuple[int, int]:
    """A position of the protocol as line and column; inside a character, the column of that character."""
    content = source.line(position.line + 1)
    units = seen = 0
    for seen, character in enumerate(content):
        units += _units(character, encoding)
        if units > position.character:
            return position.line + 1, seen
    return position.line + 1, len(content)


def from_range(found: types.Range, source: Source, encoding: Encoding) -> Span:
    """A range of the protocol as a span; one that ends before it starts is empty."""
    start = from_position(found.start, source, encoding)
    return Span(*start, *max(start, from_position(found.end, source, encoding)))


def to_edits(
    edits: Iterable[Edit], source: Source, encoding: Encoding, line_end: str
) -> list[types.TextEdit]:
    """The changes of a repair, with the line ends of the document."""
    return [
        types.TextEdit(to_range(edit.span, source, encoding), edit.text.replace("\n", line_end))
        for edit in edits
    ]


def to_diagnostic(diagnostic: Diagnostic, source: Source, uri: str, encoding: Encoding) -> types.Diagnostic:
    """A diagnostic as the protocol has it: the help is a line of the message, labels are related places."""
    span = diagnostic.span or Span(1, 0, 1, 0)
    message = diagnostic.message
    if diagnostic.help:
        message += f"\nhelp: {diagnostic.help}"
    related = [
        types.DiagnosticRelatedInformation(
            types.Location(uri, to_range(label.span, source, encoding)), label.text
        )
        for label in diagnostic.labels
    ]
    return types.Diagnostic(
        to_range(span, source, encoding),
        message,
        severity=_SEVERITIES[diagnostic.severity],
        code=diagnostic.code,
        source="scenic",
        related_information=related or None,
        tags=[types.DiagnosticTag.Unnecessary] if diagnostic.code in _UNNECESSARY else None,
    )


def to_hover(hover: Hover, source: Source, encoding: Encoding) -> types.Hover:
    """An explanation as the protocol has it."""
    return types.Hover(
        types.MarkupContent(types.MarkupKind.Markdown, hover.markdown),
        to_range(hover.span, source, encoding),
    )


def _to_position(line: int, column: int, source: Source, encoding: Encoding) -> types.Position:
    return types.Position(line - 1, _units(source.line(line)[:column], encoding))


def _units(text: str, encoding: Encoding) -> int:
    if text.isascii() or encoding == types.PositionEncodingKind.Utf32:
        return len(text)
    if encoding == types.PositionEncodingKind.Utf8:
        return len(text.encode("utf-8", "surrogatepass"))
    return len(text.encode("utf-16-le", "surrogatepass")) // 2
