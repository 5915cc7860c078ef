"""Diagnostics as JSON, for other programs.

One object: ``version`` (1), ``diagnostics`` and ``summary``.

``diagnostics`` is a list of objects with ``code``, ``severity`` ("error", "warning" or "information"), ``message``,
``help`` (or null), ``filename`` (or null), ``span`` (or null), ``labels``, a list of objects with ``span``, ``text`` and
(in another file) ``filename``, and ``fix`` (or null), an object with ``title`` and ``edits``, a list of objects with ``span`` and the
``text`` that takes its place. A span has ``line``, ``column``, ``end_line`` and ``end_column``; lines and columns count
from 1, columns in characters (code points), and the end is exclusive.

``summary`` has ``files`` (how many were checked), ``errors``, ``warnings``, ``information`` (how many of each),
``fixable`` (how many have a fix) and ``fixed`` (how many repairs were made).
"""

import json
from typing import Any, Final

from scenic.cli.render.report import Report
from scenic.language.diagnostics import Diagnostic, Fix, Severity
from scenic.language.spans import Span

__all__ = ["VERSION", "render_json"]

VERSION: Final = 1


def render_json(report: Report) -> str:
    """The whole report as one JSON object."""
    content = {
        "version": VERSION,
        "diagnostics": [_plain(item) for item in report.diagnostics],
        "summary": _summary(report),
    }
    return json.dumps(content, indent=2) + "\n"


def _summary(report: Report) -> dict[str, int]:
    severities = [item.severity for item in report.diagnostics]
    return {
        "files": report.files,
        "errors": severities.count(Severity.ERROR),
        "warnings": severities.count(Severity.WARNING),
        "information": severities.count(Severity.INFORMATION),
        "fixable": sum(item.fix is not None for item in report.diagnostics),
        "fixed": report.fixed,
    }


def _plain(diagnostic: Diagnostic) -> dict[str, Any]:
    return {
        "code": diagnostic.code,
        "severity": diagnostic.severity.value,
        "message": diagnostic.message,
        "help": diagnostic.help,
        "filename": diagnostic.filename,
        "span": None if diagnostic.span is None else _span(diagnostic.span),
        "labels": [
            {"span": _span(label.span), "text": label.text}
            | ({} if label.filename is None else {"filename": label.filename})
            for label in diagnostic.labels
        ],
        "fix": None if diagnostic.fix is None else _fix(diagnostic.fix),
    }


def _fix(fix: Fix) -> dict[str, Any]:
    edits = [{"span": _span(edit.span), "text": edit.text} for edit in fix.edits]
    return {"title": fix.title, "edits": edits}


def _span(span: Span) -> dict[str, int]:
    return {
        "line": span.line,
        "column": span.column + 1,
        "end_line": span.end_line,
        "end_column": span.end_column + 1,
    }
