"""Diagnostics as plain data that JSON can hold.

An object has ``code``, ``severity`` ("error", "warning" or "information"), ``message``, ``help`` (or null), ``filename`` (or null),
``span`` (or null), ``labels``, a list of objects with ``span``, ``text`` and (in another file) ``filename``, and ``fix`` (or null), an object
with ``title`` and ``edits``, a list of objects with ``span`` and the ``text`` that takes its place. A span has ``line``, ``column``,
``end_line`` and ``end_column``; lines and columns count from 1, columns in characters (code points), and the end is exclusive.
"""

from typing import Any

from scenic.language.diagnostics import Diagnostic, Fix
from scenic.language.spans import Span

__all__ = ["diagnostic_data", "span_data"]


def diagnostic_data(diagnostic: Diagnostic) -> dict[str, Any]:
    """Return a diagnostic as plain data."""
    return {
        "code": diagnostic.code,
        "severity": diagnostic.severity.value,
        "message": diagnostic.message,
        "help": diagnostic.help,
        "filename": diagnostic.filename,
        "span": None if diagnostic.span is None else span_data(diagnostic.span),
        "labels": [
            {"span": span_data(label.span), "text": label.text}
            | ({} if label.filename is None else {"filename": label.filename})
            for label in diagnostic.labels
        ],
        "fix": None if diagnostic.fix is None else _fix(diagnostic.fix),
    }


def _fix(fix: Fix) -> dict[str, Any]:
    edits = [{"span": span_data(edit.span), "text": edit.text} for edit in fix.edits]
    return {"title": fix.title, "edits": edits}


def span_data(span: Span) -> dict[str, int]:
    """A place as plain data, with lines and columns from 1."""
    return {
        "line": span.line,
        "column": span.column + 1,
        "end_line": span.end_line,
        "end_column": span.end_column + 1,
    }
