"""The phase in which a run of each program would fail, a line for each."""

from collections import Counter
from collections.abc import Iterator
from typing import Final

from scenic.cli.render.report import Report
from scenic.compiler import tree as scenic
from scenic.compiler.parser import parse
from scenic.compiler.traversal import walk
from scenic.language.diagnostics import Diagnostic, Severity
from scenic.language.source import Source

__all__ = ["render_phases"]

PASSES: Final = "passes"
_ORDER: Final = ("parse", "load", "sample", "simulate")
"""The phases of a run, in order."""
_PARSING: Final = "SC1"
_LOADING: Final = ("SC202", "SC203")
"""Names are looked for when a program is loaded, also those in behaviors."""
_SAMPLING: Final = ("SC500", "SC501", "SC700")
_SIMULATING: Final = ("SC503", "SC504", "SC505")


def render_phases(report: Report) -> str:
    """Write a line for each program: the first phase in which it would fail, and the first error of that phase; then the numbers of programs by phase."""
    errors: dict[str, list[Diagnostic]] = {name: [] for name in report.names}
    for item in report.diagnostics:
        if item.severity is Severity.ERROR:
            errors.setdefault(item.filename or "", []).append(item)
    rows = [(name, *_worst(errors_of_program, report)) for name, errors_of_program in errors.items()]
    lines = [f"{phase:<8}  {name}{'' if first is None else _said(first)}\n" for name, phase, first in rows]
    counts = Counter(phase for _, phase, _ in rows)
    numbers = ", ".join(f"{counts[phase]} {phase}" for phase in (*_ORDER, PASSES) if counts[phase])
    return "".join(lines) + (
        f"{len(rows)} program{'' if len(rows) == 1 else 's'}: {numbers}\n" if rows else ""
    )


def _said(first: Diagnostic) -> str:
    line = "" if first.span is None else f":{first.span.line}"
    return f"{line}: {first.code} {first.message}"


def _worst(errors: list[Diagnostic], report: Report) -> tuple[str, Diagnostic | None]:
    """Return the first phase in which one of some errors of a file appears, and that error."""
    if not errors:
        return PASSES, None
    source = report.sources.get(errors[0].filename)
    later = list(_simulated(source)) if source is not None else []
    phases = [(_ORDER.index(_phase(each, later)), number) for number, each in enumerate(errors)]
    phase, number = min(phases)
    return _ORDER[phase], errors[number]


def _phase(error: Diagnostic, later: list[tuple[int, int]]) -> str:
    if error.code.startswith(_PARSING):
        return "parse"
    if error.code in _SAMPLING:
        return "sample"
    line = 0 if error.span is None or error.code in _LOADING else error.span.line
    if error.code in _SIMULATING or any(first <= line <= last for first, last in later):
        return "simulate"
    return "load"


def _simulated(source: Source) -> Iterator[tuple[int, int]]:
    """The first and last lines of what runs in simulations only."""
    for node in walk(parse(source.text, filename=source.filename).tree):
        bodies = [node.body] if isinstance(node, scenic.BehaviorDef | scenic.MonitorDef) else []
        if isinstance(node, scenic.ScenarioDef) and node.compose:
            bodies.append(node.compose)
        for body in bodies:
            yield body[0].lineno, body[-1].end_lineno or body[-1].lineno
