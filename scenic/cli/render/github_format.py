"""Diagnostics as workflow commands of GitHub Actions, which shows them beside the lines of a change.

https://docs.github.com/en/actions/reference/workflow-commands-for-github-actions says how they are written.
"""

from typing import Final

from scenic.cli.render.report import Report
from scenic.language.diagnostics import Diagnostic, Severity

__all__ = ["render_github"]

_COMMANDS: Final = {Severity.ERROR: "error", Severity.WARNING: "warning", Severity.INFORMATION: "notice"}


def render_github(report: Report) -> str:
    """Write one line for each diagnostic."""
    return "".join(f"{_command(item)}\n" for item in report.diagnostics)


def _command(diagnostic: Diagnostic) -> str:
    properties = {"title": f"scenic {diagnostic.code}"}
    if diagnostic.filename is not None:
        properties["file"] = diagnostic.filename
    span = diagnostic.span
    if span is not None:
        properties |= {"line": str(span.line), "endLine": str(span.end_line)}
        if span.line == span.end_line:  # columns of different lines are refused
            properties |= {"col": str(span.column + 1), "endColumn": str(span.end_column + 1)}
    assignments = ",".join(f"{name}={_property(value)}" for name, value in properties.items())
    message = f"{diagnostic.code}: {diagnostic.message}"
    if diagnostic.help:
        message += f"\nhelp: {diagnostic.help}"
    return f"::{_COMMANDS[diagnostic.severity]} {assignments}::{_data(message)}"


def _data(text: str) -> str:
    return text.replace("%", "%25").replace("\r", "%0D").replace("\n", "%0A")


def _property(text: str) -> str:
    return _data(text).replace(":", "%3A").replace(",", "%2C")
