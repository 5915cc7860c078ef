"""Diagnostics as SARIF 2.1.0, the OASIS standard for results of static analysis.

https://docs.oasis-open.org/sarif/sarif/v2.1.0/sarif-v2.1.0.html. One run. What is wrong with a program is a result;
what is wrong with files, options and the tools themselves is a notification of the run's invocation. Places below the
current folder are given relative to it, as ``%SRCROOT%``.
"""

import contextlib
import json
import os
import urllib.parse
from collections.abc import Sequence
from importlib import resources
from importlib.metadata import PackageNotFoundError, version
from pathlib import Path
from typing import Any, Final

from scenic.cli.render.report import Report
from scenic.language.diagnostics import CODES, Diagnostic, Fix, Severity
from scenic.language.spans import Span

__all__ = ["render_sarif"]

_SCHEMA: Final = "https://docs.oasis-open.org/sarif/sarif/v2.1.0/errata01/os/schemas/sarif-schema-2.1.0.json"
_ROOT: Final = "%SRCROOT%"
_LEVELS: Final = {Severity.ERROR: "error", Severity.WARNING: "warning", Severity.INFORMATION: "note"}
_SUCCESSFUL: Final = (0, 1)
"""Exit codes of a run that could do its work."""


def render_sarif(report: Report) -> str:
    """The whole report as one SARIF log."""
    results = [item for item in report.diagnostics if not _is_of_the_run(item)]
    codes = sorted({item.code for item in report.diagnostics})
    invocation: dict[str, Any] = {
        "executionSuccessful": report.exit_code in _SUCCESSFUL,
        "exitCode": report.exit_code,
        "workingDirectory": {"uri": _folder_uri(Path.cwd())},
    }
    for item in filter(_is_of_the_run, report.diagnostics):
        kind = "toolConfigurationNotifications" if item.code == "SC606" else "toolExecutionNotifications"
        invocation.setdefault(kind, []).append(_notification(item, codes))
    run = {
        "tool": {"driver": _driver(codes)},
        "invocations": [invocation],
        "originalUriBaseIds": {_ROOT: {"uri": _folder_uri(Path.cwd())}},
        "columnKind": "unicodeCodePoints",
        "results": [_result(item, codes) for item in results],
    }
    return json.dumps({"$schema": _SCHEMA, "version": "2.1.0", "runs": [run]}, indent=2) + "\n"


def _is_of_the_run(diagnostic: Diagnostic) -> bool:
    return diagnostic.code.startswith("SC6") or diagnostic.code == "SC999"


def _driver(codes: Sequence[str]) -> dict[str, Any]:
    driver: dict[str, Any] = {"name": "scenic", "rules": [_rule(code) for code in codes]}
    with contextlib.suppress(PackageNotFoundError):
        driver["version"] = version("scenic-lang")
    return driver


def _rule(code: str) -> dict[str, Any]:
    title = CODES[code]
    rule: dict[str, Any] = {"id": code, "shortDescription": {"text": title}, "help": {"text": title}}
    page = resources.files("scenic.language").joinpath("explanations", f"{code}.md")
    if page.is_file():
        text = page.read_text(encoding="utf-8")
        rule["help"] = {"text": text, "markdown": text}
    return rule


def _message(diagnostic: Diagnostic) -> dict[str, str]:
    text = diagnostic.message
    return {"text": _encodable(f"{text}\nhelp: {diagnostic.help}" if diagnostic.help else text)}


def _result(diagnostic: Diagnostic, codes: Sequence[str]) -> dict[str, Any]:
    result: dict[str, Any] = {
        "ruleId": diagnostic.code,
        "ruleIndex": codes.index(diagnostic.code),
        "level": _LEVELS[diagnostic.severity],
        "message": _message(diagnostic),
    }
    locations = _locations(diagnostic)
    if locations:
        result["locations"] = locations
    if diagnostic.labels and diagnostic.filename is not None:
        result["relatedLocations"] = [
            {
                "id": number,
                "physicalLocation": _place(label.filename or diagnostic.filename, label.span),
                "message": {"text": _encodable(label.text)},
            }
            for number, label in enumerate(diagnostic.labels, 1)
        ]
    if diagnostic.fix is not None and diagnostic.fix.edits and diagnostic.filename is not None:
        result["fixes"] = [_fix(diagnostic.fix, diagnostic.filename)]
    return result


def _notification(diagnostic: Diagnostic, codes: Sequence[str]) -> dict[str, Any]:
    notification: dict[str, Any] = {
        "associatedRule": {"id": diagnostic.code, "index": codes.index(diagnostic.code)},
        "level": _LEVELS[diagnostic.severity],
        "message": _message(diagnostic),
    }
    locations = _locations(diagnostic)
    if locations:
        notification["locations"] = locations
    return notification


def _locations(diagnostic: Diagnostic) -> list[dict[str, Any]]:
    if diagnostic.filename is None:
        return []
    return [{"physicalLocation": _place(diagnostic.filename, diagnostic.span)}]


def _place(filename: str, span: Span | None) -> dict[str, Any]:
    place: dict[str, Any] = {"artifactLocation": _artifact(filename)}
    if span is not None:
        place["region"] = _region(span)
    return place


def _region(span: Span) -> dict[str, int]:
    return {
        "startLine": span.line,
        "startColumn": span.column + 1,
        "endLine": span.end_line,
        "endColumn": span.end_column + 1,
    }


def _fix(fix: Fix, filename: str) -> dict[str, Any]:
    replacements = []
    for edit in fix.edits:
        replacement: dict[str, Any] = {"deletedRegion": _region(edit.span)}
        if edit.text:
            replacement["insertedContent"] = {"text": _encodable(edit.text)}
        replacements.append(replacement)
    change = {"artifactLocation": _artifact(filename), "replacements": replacements}
    return {"description": {"text": _encodable(fix.title)}, "artifactChanges": [change]}


def _artifact(filename: str) -> dict[str, str]:
    path = os.path.abspath(filename)
    try:
        relative = os.path.relpath(path)
    except ValueError:  # on another drive
        relative = os.pardir
    if relative.split(os.sep)[0] == os.pardir:
        return {"uri": Path(path).as_uri()}
    return {"uri": urllib.parse.quote(os.fsencode(relative.replace(os.sep, "/"))), "uriBaseId": _ROOT}


def _folder_uri(folder: Path) -> str:
    return folder.as_uri().rstrip("/") + "/"


def _encodable(text: str) -> str:
    """Replace lone surrogates in a text: a program may contain them, and UTF-8 may not."""
    return text.encode("utf-8", "replace").decode("utf-8")
