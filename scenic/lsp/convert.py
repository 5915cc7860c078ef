"""Between the protocol's positions and ours: the only place that knows both.

The protocol counts lines from 0, and columns in code units of an encoding that client and server agree on; we count
lines from 1 and columns in characters. A byte order mark at the beginning is a character for the protocol, and none for
us.
"""

import os
from collections.abc import Callable, Iterable, Mapping
from dataclasses import dataclass, field
from enum import StrEnum
from typing import Any, Final, TypeAlias

from scenic.language.diagnostics import Diagnostic, Edit, Label, Severity
from scenic.language.explanations import explanation_file
from scenic.language.source import Source
from scenic.language.spans import Span
from scenic.lsp.uris import to_uri

__all__ = ["Encoding", "Json", "Lines", "to_diagnostic", "units"]

Json: TypeAlias = Any
"""What a message holds: built from dictionaries with texts as keys, lists, texts, numbers, booleans and ``None``."""

_SEVERITIES: Final[Mapping[Severity, int]] = {
    Severity.ERROR: 1,
    Severity.WARNING: 2,
    Severity.INFORMATION: 3,
}
_UNNECESSARY: Final = frozenset({"SC205", "SC206", "SC303", "SC390"})
"""Codes of what can be left out, which editors show faded."""
_TAG_UNNECESSARY: Final = 1


class Encoding(StrEnum):
    """How columns are counted."""

    UTF8 = "utf-8"
    UTF16 = "utf-16"
    UTF32 = "utf-32"


def units(text: str, encoding: Encoding) -> int:
    """The length of a text in code units."""
    if encoding is Encoding.UTF32 or text.isascii():
        return len(text)
    if encoding is Encoding.UTF8:
        return len(text.encode("utf-8", "surrogatepass"))
    return len(text.encode("utf-16-le", "surrogatepass")) // 2


@dataclass(frozen=True, slots=True)
class Lines:
    """The lines of a text, and where the protocol sees them; ``marks`` is how many byte order marks it begins with."""

    source: Source
    encoding: Encoding
    marks: int = 0
    _lead: int = field(init=False, default=0)

    def __post_init__(self) -> None:
        object.__setattr__(self, "_lead", units("\ufeff" * self.marks, self.encoding))

    def to_position(self, line: int, column: int) -> Json:
        """A place as a position."""
        character = units(self.source.line(line)[:column], self.encoding)
        return {"line": line - 1, "character": character + (self._lead if line == 1 else 0)}

    def to_range(self, span: Span) -> Json:
        """A span as a range."""
        return {
            "start": self.to_position(span.line, span.column),
            "end": self.to_position(span.end_line, span.end_column),
        }

    def from_position(self, line: int, character: int) -> tuple[int, int]:
        """A position as line and column.

        Inside a character, the column of that character; past the end of a line, its end; past the end of the text,
        the end of that.
        """
        if line >= len(self.source.lines):
            return len(self.source.lines), len(self.source.lines[-1])
        content = self.source.line(line + 1)
        if line == 0:
            character = max(0, character - self._lead)
        if content.isascii() or self.encoding is Encoding.UTF32:
            return line + 1, min(character, len(content))
        seen = 0
        for column, each in enumerate(content):
            seen += units(each, self.encoding)
            if seen > character:
                return line + 1, column
        return line + 1, len(content)

    def from_range(self, start: tuple[int, int], end: tuple[int, int]) -> Span:
        """A range, as two pairs of line and character, as a span; one that ends before it starts is empty."""
        first = self.from_position(*start)
        return Span(*first, *max(first, self.from_position(*end)))

    def to_edits(self, edits: Iterable[Edit], line_end: str) -> list[Json]:
        """Changes of the text, with the line ends of the document."""
        return [
            {"range": self.to_range(edit.span), "newText": edit.text.replace("\n", line_end)}
            for edit in edits
        ]


def to_diagnostic(
    diagnostic: Diagnostic,
    lines: Lines,
    uri: str,
    *,
    elsewhere: Callable[[str, Span], Json] | None = None,
    related: bool = True,
    tags: bool = True,
    pages: bool = False,
) -> Json:
    """A diagnostic as the protocol has it: the help is a line of the message, labels are related places.

    ``elsewhere`` gives the places in other files; without it, they are left out.
    ``related`` and ``tags`` tell whether the client shows such, ``pages`` whether it opens the page of a code.
    """
    message = diagnostic.message
    if diagnostic.help:
        message += f"\nhelp: {diagnostic.help}"
    found: dict[str, Json] = {
        "range": lines.to_range(diagnostic.span or Span(1, 0, 1, 0)),
        "severity": _SEVERITIES[diagnostic.severity],
        "code": diagnostic.code,
        "source": "scenic",
        "message": message,
    }
    page = explanation_file(diagnostic.code) if pages else None
    if page is not None:
        found["codeDescription"] = {"href": to_uri(page)}
    if tags and diagnostic.code in _UNNECESSARY:
        found["tags"] = [_TAG_UNNECESSARY]
    places: list[Json] = []
    for label in diagnostic.labels:
        if label.filename is None or label.filename == diagnostic.filename:
            location: Json = {"uri": uri, "range": lines.to_range(label.span)}
        elif elsewhere is not None:
            location = elsewhere(label.filename, label.span)
        else:
            continue
        places.append({"location": location, "message": label.text})
    if places and related:
        found["relatedInformation"] = places
    elif places:
        found["message"] += "".join(f"\n{_place(label)}: {label.text}" for label in diagnostic.labels)
    return found


def _place(label: Label) -> str:
    """A place in words."""
    line = f"line {label.span.line}"
    return line if label.filename is None else f"{os.path.basename(label.filename)}, {line}"
