"""Diagnostics as a report of JUnit, which most services for continuous integration read: a test case for each diagnostic."""

import re
from typing import Final
from xml.etree import ElementTree

from scenic.cli.render.report import Report
from scenic.language.diagnostics import CODES, Severity

__all__ = ["render_junit"]

_UNREADABLE: Final = re.compile(r"[^\t\n\r\x20-\ud7ff\ue000-\ufffd\U00010000-\U0010ffff]")
"""Characters that XML cannot hold."""


def render_junit(report: Report) -> str:
    """Write one suite; a run without diagnostics is one case that succeeds."""
    failures = [each for each in report.diagnostics if each.severity is not Severity.INFORMATION]
    suites = ElementTree.Element("testsuites")
    suite = ElementTree.SubElement(
        suites,
        "testsuite",
        name="scenic check",
        tests=str(max(1, len(report.diagnostics))),
        failures=str(len(failures)),
        errors="0",
    )
    for diagnostic in report.diagnostics:
        span = diagnostic.span
        place = "" if span is None else f":{span.line}:{span.column + 1}"
        name = f"{diagnostic.filename or 'scenic'}{place}"
        case = ElementTree.SubElement(
            suite, "testcase", classname=f"scenic.{diagnostic.code}", name=_readable(name)
        )
        if span is not None and diagnostic.filename is not None:
            case.set("file", _readable(diagnostic.filename))
            case.set("line", str(span.line))
        text = f"{name}: {diagnostic.severity.value}[{diagnostic.code}]: {diagnostic.message}"
        if diagnostic.help:
            text += f"\nhelp: {diagnostic.help}"
        kind = "system-out" if diagnostic.severity is Severity.INFORMATION else "failure"
        child = ElementTree.SubElement(case, kind)
        if kind == "failure":
            child.set("type", CODES[diagnostic.code])
            child.set("message", _readable(diagnostic.message))
        child.text = _readable(text)
    if not report.diagnostics:
        ElementTree.SubElement(suite, "testcase", classname="scenic", name="check")
    ElementTree.indent(suites)
    return (
        '<?xml version="1.0" encoding="utf-8"?>\n' + ElementTree.tostring(suites, encoding="unicode") + "\n"
    )


def _readable(text: str) -> str:
    return _UNREADABLE.sub("\ufffd", text)
