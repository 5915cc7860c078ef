"""Diagnostics as JSON, for other programs.

One object: ``version`` (1), ``diagnostics`` and ``summary``.

``diagnostics`` is a list of the objects of `scenic.language.diagnostic_data`.

``summary`` has ``files`` (how many were checked), ``errors``, ``warnings``, ``information`` (how many of each),
``fixable`` (how many have a fix) and ``fixed`` (how many repairs were made).
"""

import json
from typing import Final

from scenic.cli.render.report import Report
from scenic.language.diagnostic_data import diagnostic_data
from scenic.language.diagnostics import Severity

__all__ = ["VERSION", "render_json"]

VERSION: Final = 1


def render_json(report: Report) -> str:
    """The whole report as one JSON object."""
    content = {
        "version": VERSION,
        "diagnostics": [diagnostic_data(item) for item in report.diagnostics],
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
