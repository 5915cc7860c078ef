"""All tools say the same, at the same places."""

import json
import os
import re
from functools import cache
from typing import Any, Final

from lsprotocol.types import Position

from fuzz.properties.case import FILENAME, Case, Property, Violation, describe, spans_of
from scenic.cli.checking import Checker, CheckTask
from scenic.cli.render import FORMATS, Report, render
from scenic.compiler.check import check_text
from scenic.ide.diagnostics import diagnostics
from scenic.language.code_selection import Rules
from scenic.language.diagnostics import Diagnostic
from scenic.language.source import Source
from scenic.language.spans import Span
from scenic.lsp.convert import Encoding, Lines, to_diagnostic
from scenic.project.index import Project
from scenic.project.surroundings import surroundings_in

__all__ = ["OF_TEXTS"]

_SPARED: Final = frozenset({"SC202", "SC203", "SC204", "SC209"})
"""Codes that the editor may leave out while a line is half typed."""
_ALONE: Final = "nothing by itself"
"""The end of what is said of a word that stands alone, which the editor leaves out, too."""
_URI: Final = "file:///fuzz.scenic"
_ENCODINGS: Final = {
    Encoding.UTF8: "utf-8",
    Encoding.UTF16: "utf-16-le",
    Encoding.UTF32: "utf-32-le",
}
_PAIRED: Final = re.compile("[\ud800-\udbff][\udc00-\udfff]")
_UNIT: Final = {"utf-8": 1, "utf-16-le": 2, "utf-32-le": 4}


@cache
def _project() -> Project:
    """The project that all texts belong to: the current folder."""
    return Project([os.getcwd()])


@cache
def _command() -> Checker:
    return Checker()


def check_and_server_agree(case: Case) -> None:
    """The command ``check``, the check itself and the editor's diagnostics say the same.

    The editor spares a line that may be half typed, and leaves out what depends on it: names that are not defined.
    """
    project = _project()
    expected_diagnostics = check_text(case.text, filename=FILENAME, surroundings_of=surroundings_in(project))
    answers = {
        "the editor": diagnostics(case.text, filename=FILENAME, project=project),
        "the command": _command()(CheckTask(FILENAME, Rules(), text=case.text)).diagnostics,
    }
    for who, answer in answers.items():
        if who == "the editor":
            missing = [each for each in expected_diagnostics if each not in answer]
            is_allowed = all(each.code in _SPARED or each.message.endswith(_ALONE) for each in missing)
            if is_allowed and all(each in expected_diagnostics for each in answer):
                continue
        if answer != expected_diagnostics:
            difference = next((describe(each) for each in answer if each not in expected_diagnostics), "less")
            raise Violation(f"{who} says: {difference}")


def places_survive_conversion(case: Case) -> None:
    """Editors and other programs receive the same places as the check reports, in any encoding of columns."""
    diagnostics = case.checked
    for kind, encoding in _ENCODINGS.items():
        if encoding == "utf-16-le" and _PAIRED.search(case.text):
            # In this encoding two such halves are one character, so that no client can have them as two.
            continue
        for each in diagnostics:
            _check_protocol(each, case.source, kind, encoding)
    report = Report(diagnostics)
    for name in FORMATS:
        text = render(name, report)
        if name == "json":
            report_diagnostics = json.loads(text)["diagnostics"]
            if report_diagnostics != [_plain(each) for each in diagnostics]:
                raise Violation("the JSON says something else")


def _check_protocol(item: Diagnostic, source: Source, kind: Encoding, encoding: str) -> None:
    lines = Lines(source, kind)
    converted_item = to_diagnostic(item, lines, _URI)
    if converted_item.code != item.code or not converted_item.message.startswith(item.message):
        raise Violation(f"the protocol says something else: {describe(item)}")
    spans = [span for _, span in spans_of(item)]
    edits = () if item.fix is None else lines.to_edits(item.fix.edits, "\n")
    ranges = [
        converted_item.range,
        *(each.location.range for each in converted_item.related_information or ()),
        *(each.range for each in edits),
    ]
    if len(ranges) != len(spans):
        raise Violation(f"the protocol has other labels or changes: {describe(item)}")
    for span, range_here in zip(spans, ranges, strict=True):
        back = (*_column(range_here.start, source, encoding), *_column(range_here.end, source, encoding))
        if span is not None and back != _clipped(span, source):
            raise Violation(f"{span} comes back from {encoding} as {back}: {describe(item)}")


def _column(position: Position, source: Source, encoding: str) -> tuple[int, int]:
    """A position of the protocol in lines and characters, computed from the encoded line."""
    data = source.line(position.line + 1).encode(encoding, "surrogatepass")
    before = data[: position.character * _UNIT[encoding]]
    return position.line + 1, len(before.decode(encoding, "surrogatepass"))


def _clipped(span: Span, source: Source) -> tuple[int, int, int, int]:
    """A span whose columns do not go past the ends of their lines, as no position of the protocol can."""
    column = min(span.column, len(source.line(span.line)))
    return span.line, column, span.end_line, min(span.end_column, len(source.line(span.end_line)))


def _plain(item: Diagnostic) -> dict[str, Any]:
    """Return the data that JSON should contain for a diagnostic."""
    spans = [None if span is None else _json_span(span) for _, span in spans_of(item)]
    labels = spans[1 : 1 + len(item.labels)]
    edits = spans[1 + len(item.labels) :]
    return {
        "code": item.code,
        "severity": str(item.severity),
        "message": item.message,
        "help": item.help,
        "filename": item.filename,
        "span": spans[0],
        "labels": [
            {"span": span, "text": label.text} for span, label in zip(labels, item.labels, strict=True)
        ],
        "fix": None
        if item.fix is None
        else {
            "title": item.fix.title,
            "edits": [
                {"span": span, "text": edit.text} for span, edit in zip(edits, item.fix.edits, strict=True)
            ],
        },
    }


def _json_span(span: Span) -> dict[str, int]:
    return {
        "line": span.line,
        "column": span.column + 1,
        "end_line": span.end_line,
        "end_column": span.end_column + 1,
    }


OF_TEXTS: Final = (
    Property.of(check_and_server_agree, one_in=5),
    Property.of(places_survive_conversion, one_in=20),
)
