"""Diagnostics for people: the message, the source lines with carets below them, and what to do."""

import os
import unicodedata
from collections.abc import Iterator, Sequence
from typing import Final

from scenic.cli.render.report import Report
from scenic.cli.render.sources import Sources
from scenic.dataclass import dataclass
from scenic.language.diagnostics import Diagnostic, Severity
from scenic.language.source import Source
from scenic.language.spans import Span

__all__ = ["render_report", "render_text"]

_RESET: Final = "\x1b[0m"
_BOLD: Final = "\x1b[1m"
_BLUE: Final = "\x1b[1;34m"
_COLOURS: Final = {
    Severity.ERROR: "\x1b[1;31m",
    Severity.WARNING: "\x1b[1;33m",
    Severity.INFORMATION: "\x1b[1;36m",
}
_TAB: Final = 4
_WIDEST: Final = 160
"""So many characters of a long line are shown, around the place in question."""
_BEFORE: Final = 60
"""So many of them before it."""


def render_text(diagnostics: Sequence[Diagnostic], sources: Sources, colour: bool) -> str:
    """Write one block for each diagnostic, with an empty line after each."""
    blocks = []
    for diagnostic in diagnostics:
        lines = _block(diagnostic, sources.get(diagnostic.filename), _Paint(colour))
        blocks.append("\n".join(lines) + "\n\n")
    return "".join(blocks)


def render_report(report: Report) -> str:
    """The diagnostics of a report, without its numbers, which go elsewhere."""
    return render_text(report.diagnostics, report.sources, report.colour)


class _Paint:
    """Puts colours around text, or does not."""

    def __init__(self, on: bool) -> None:
        self._on = on

    def __call__(self, text: str, colour: str) -> str:
        return f"{colour}{text}{_RESET}" if self._on and text else text


@dataclass(frozen=True, slots=True)
class _Mark:
    """A stretch of one line to be underlined."""

    line: int
    start: int
    end: int
    sign: str
    text: str
    colour: str


def _block(diagnostic: Diagnostic, source: Source | None, paint: _Paint) -> Iterator[str]:
    colour = _COLOURS[diagnostic.severity]
    message = _visible(diagnostic.message)
    yield paint(f"{diagnostic.severity.value}[{diagnostic.code}]", colour) + paint(f": {message}", _BOLD)
    span = diagnostic.span
    place = _visible(diagnostic.filename or "")
    if span is not None:
        place += f":{span.line}:{span.column + 1}"
    marks = [] if span is None or source is None else list(_marks(diagnostic, span, source, colour))
    width = max((len(str(mark.line)) for mark in marks), default=1)
    margin = " " * width
    if place:
        yield f"{margin}{paint('-->', _BLUE)} {place}"
    if source is not None and marks:
        yield f"{margin} {paint('|', _BLUE)}"
        yield from _snippet(marks, source, width, paint)
    for label in diagnostic.labels:
        if label.filename not in (None, diagnostic.filename):
            there = f"{_visible(_near(label.filename))}:{label.span.line}:{label.span.column + 1}"
            yield f"{margin} {paint(':::', _BLUE)} {there}: {_visible(label.text)}"
    advice = list(_advice(diagnostic))
    if advice and marks:
        yield f"{margin} {paint('|', _BLUE)}"
    for text in advice:
        yield f"{margin} {paint('=', _BLUE)} {paint('help', _BOLD)}: {_visible(text)}"


def _near(filename: str | None) -> str:
    """Return the path from the current folder, if the file lies there."""
    try:
        relative = os.path.relpath(filename or "")
    except ValueError:  # on another drive
        return filename or ""
    return filename or "" if relative.startswith(os.pardir) else relative


def _advice(diagnostic: Diagnostic) -> Iterator[str]:
    """Yield the advice of a diagnostic: its help, and its repair if that adds something."""
    if diagnostic.help:
        yield diagnostic.help
    fix = diagnostic.fix
    if fix is None or fix.title.lower() == (diagnostic.help or "").lower():
        return
    title = fix.title[:1].lower() + fix.title[1:]
    text = fix.edits[0].text.strip() if len(fix.edits) == 1 else ""
    if text and len(text) <= _WIDEST and "\n" not in text:
        if text in (diagnostic.help or ""):
            return
        yield title if text in title else f"{title}: `{text}`"
    else:
        yield title


def _marks(diagnostic: Diagnostic, span: Span, source: Source, colour: str) -> Iterator[_Mark]:
    """Yield the stretches to underline: of a span over several lines, its part of the first one."""
    places = [(span, "^", "", colour)]
    places += [
        (label.span, "-", _visible(label.text), _BLUE)
        for label in diagnostic.labels
        if label.filename in (None, diagnostic.filename)
    ]
    for place, sign, text, paint in places:
        if place.line <= len(source.lines):
            content = source.line(place.line)
            end = place.end_column if place.end_line == place.line else len(content.rstrip())
            yield _Mark(place.line, place.column, max(end, place.column + 1), sign, text, paint)


def _snippet(marks: Sequence[_Mark], source: Source, width: int, paint: _Paint) -> Iterator[str]:
    line_numbers = sorted({mark.line for mark in marks})
    bar = paint("|", _BLUE)
    for previous, line in zip([None, *line_numbers], line_numbers, strict=False):
        if previous is not None and line > previous + 1:
            yield paint("..." if width < 3 else "." * width, _BLUE)
        here = sorted(
            (mark for mark in marks if mark.line == line), key=lambda mark: (mark.sign != "^", mark.start)
        )
        content, window = _window(source.line(line), here[0])
        yield f"{paint(f'{line:>{width}}', _BLUE)} {bar} {content}".rstrip()
        for mark in here:
            start, end = window.column(mark.start), window.column(mark.end)
            signs = mark.sign * max(1, end - start)
            text = f" {mark.text}" if mark.text else ""
            yield f"{' ' * width} {bar} {' ' * start}{paint(signs + text, mark.colour)}"


@dataclass(frozen=True, slots=True)
class _Window:
    """The part of a line that is shown, and the columns of its characters on the terminal."""

    first: int
    indent: int
    columns: tuple[int, ...]

    def column(self, character: int) -> int:
        """Return the column at which a character is shown; a character outside the line is shown at the nearer end."""
        place = min(max(character - self.first, 0), len(self.columns) - 1)
        return self.indent + self.columns[place]


def _window(line: str, mark: _Mark) -> tuple[str, _Window]:
    """A line made fit for a terminal, cut around the mark if it is too long."""
    first, last = 0, len(line)
    if last > _WIDEST:
        first = max(0, min(mark.start - _BEFORE, last - _WIDEST))
        last = min(last, first + _WIDEST)
    head, tail = "… " if first else "", " …" if last < len(line) else ""
    columns, pieces, column = [], [], 0
    for character in line[first:last]:
        columns.append(column)
        text = " " * (_TAB - column % _TAB) if character == "\t" else _visible(character)
        pieces.append(text)
        column += _cells(text)
    # Marks may stand one after the last character, where something is missing.
    columns += (column, column + 1)
    return head + "".join(pieces) + tail, _Window(first, len(head), tuple(columns))


def _cells(text: str) -> int:
    """Return the number of terminal columns that a text takes."""
    if text.isascii():
        return len(text)
    return sum(
        0 if unicodedata.combining(character) else 2 if unicodedata.east_asian_width(character) in "WF" else 1
        for character in text
    )


def _visible(text: str) -> str:
    """Replace characters that would control a terminal: source texts and file names may contain any."""
    if text.isprintable():
        return text
    return "".join(
        character if character.isprintable() or character == "\u3000" else "\N{REPLACEMENT CHARACTER}"
        for character in text
    )
