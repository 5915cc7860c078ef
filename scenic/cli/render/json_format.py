"""Diagnostics as JSON, for other programs.

One object: ``version`` (1) and ``diagnostics``, a list of objects with ``code``, ``severity`` ("error",
"warning" or "information"), ``message``, ``help`` (or null), ``filename`` (or null), ``span`` (or null) and
``labels``, a list of objects with ``span`` and ``text``. A span has ``line``, ``column``, ``end_line`` and
``end_column``; lines and columns count from 1, columns in characters (code points), and the end is exclusive.
"""

import json
from collections.abc import Sequence
from typing import Any, Final

from scenic.cli.render.sources import Sources
from scenic.language.diagnostics import Diagnostic
from scenic.language.spans import Span

__all__ = ["VERSION", "render_json"]

VERSION: Final = 1


def render_json(diagnostics: Sequence[Diagnostic], sources: Sources, colour: bool) -> str:  # noqa: ARG001 - as every renderer
    """All diagnostics as one JSON object."""
    return (
        json.dumps({"version": VERSION, "diagnostics": [_plain(item) for item in diagnostics]}, indent=2)
        + "\n"
    )


def _plain(diagnostic: Diagnostic) -> dict[str, Any]:
    return {
        "code": diagnostic.code,
        "severity": diagnostic.severity.value,
        "message": diagnostic.message,
        "help": diagnostic.help,
        "filename": diagnostic.filename,
        "span": None if diagnostic.span is None else _span(diagnostic.span),
        "labels": [{"span": _span(label.span), "text": label.text} for label in diagnostic.labels],
    }


def _span(span: Span) -> dict[str, int]:
    return {
        "line": span.line,
        "column": span.column + 1,
        "end_line": span.end_line,
        "end_column": span.end_column + 1,
    }
