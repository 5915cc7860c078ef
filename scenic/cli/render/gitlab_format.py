"""Diagnostics as a code quality report of GitLab, which shows them in merge requests.

https://docs.gitlab.com/ci/testing/code_quality/ describes the fields.
"""

import hashlib
import json
from collections import Counter
from typing import Any, Final

from scenic.cli.render.report import Report
from scenic.language.diagnostics import Diagnostic, Severity

__all__ = ["render_gitlab"]

_SEVERITIES: Final = {Severity.ERROR: "major", Severity.WARNING: "minor", Severity.INFORMATION: "info"}


def render_gitlab(report: Report) -> str:
    """A list of findings, each with a fingerprint that does not depend on its line."""
    counts: Counter[str] = Counter()
    findings = []
    for diagnostic in report.diagnostics:
        text = _text_at(diagnostic, report)
        key = f"{diagnostic.filename}\0{diagnostic.code}\0{diagnostic.message}\0{text}"
        counts[key] += 1
        fingerprint = hashlib.sha256(f"{key}\0{counts[key]}".encode("utf-8", "surrogatepass")).hexdigest()
        findings.append(_finding(diagnostic, fingerprint))
    return json.dumps(findings, indent=2) + "\n"


def _finding(diagnostic: Diagnostic, fingerprint: str) -> dict[str, Any]:
    message = f"{diagnostic.message} ({diagnostic.help})" if diagnostic.help else diagnostic.message
    span = diagnostic.span
    first, last = (1, 1) if span is None else (span.line, span.end_line)
    return {
        "description": message,
        "check_name": diagnostic.code,
        "fingerprint": fingerprint,
        "severity": _SEVERITIES[diagnostic.severity],
        "location": {"path": diagnostic.filename or "", "lines": {"begin": first, "end": last}},
    }


def _text_at(diagnostic: Diagnostic, report: Report) -> str:
    """Return the line of a diagnostic, without its indentation."""
    source = report.sources.get(diagnostic.filename)
    if source is None or diagnostic.span is None:
        return ""
    return source.line(diagnostic.span.line).strip()
