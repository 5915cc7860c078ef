"""Findings that are proved by running and analysing a program: `scenic check --deep`."""

import re
from dataclasses import replace
from pathlib import Path
from typing import Final

from scenic.analysis.contraction import contract
from scenic.analysis.fact_diagnostics import prove, prove_dead, prove_in_time
from scenic.analysis.finite.explaining import contradiction, narrowed_values
from scenic.analysis.solver_terms import has_solver
from scenic.deep.dead_branches import prove_branches
from scenic.failures import diagnose
from scenic.graph.domain import Domain
from scenic.language.diagnostics import Diagnostic, Severity
from scenic.language.errors import ScenicSyntaxError
from scenic.language.extras import installation
from scenic.narrowing import conditions, decision_of
from scenic.pipeline import load

__all__ = ["deep_check"]


_ADVICE: Final = Diagnostic(
    "SC604",
    "the library z3 is not installed: contradictions were looked for by intervals and tables only",
    None,
    Severity.INFORMATION,
    help=f"install it: {installation('deep')}",
)


def deep_check(path: str | Path, *, mode2D: bool = False) -> tuple[Diagnostic, ...]:
    """Return the faults of a program that running and analysing it, in the 2D mode or not, finds (no scene is sampled)."""
    filename = str(path)
    try:
        scenario = load(path, prune=False, mode2D=mode2D)
    except ScenicSyntaxError as error:
        return error.diagnostics
    except Exception as error:
        diagnostic = diagnose(error)
        if diagnostic is None:
            raise
        return (diagnostic,)
    graph, facts = scenario.outline.graph, conditions(scenario.outline)
    findings = prove(graph, facts)
    decision = decision_of(scenario.outline)
    if all(item.severity is not Severity.ERROR for item in findings):
        findings += contradiction(decision, scenario.outline.checks)
    temporal = [item.formula for item in scenario.requirements if item.formula and item.probability == 1]
    findings += prove_in_time(temporal, {item.span for item in findings if item.severity is Severity.ERROR})
    if all(item.severity is not Severity.ERROR for item in findings):
        names = {address: name.thing for address, name in scenario.draw_names.items()}
        boxes = contract(graph, facts).domain
        narrowed_domain = Domain.whole(graph.dimension).with_finite(narrowed_values(decision))
        findings += tuple(
            _placed(item, scenario.text) for item in prove_dead(graph, (boxes, narrowed_domain), names)
        )
        findings += prove_branches(scenario.text, filename, scenario.program, graph.nodes, facts)
    if not has_solver():
        findings += (_ADVICE,)
    return tuple(
        Diagnostic(
            item.code,
            item.message,
            item.span,
            item.severity,
            item.filename or filename,
            item.help,
            item.labels,
        )
        for item in findings
    )


def _placed(item: Diagnostic, text: str) -> Diagnostic:
    """A finding about a draw, without a place where that is in another file than the program: draws do not know their files."""
    span, lines = item.span, text.split("\n")
    if span is None or (
        span.end_line <= len(lines) and lines[span.end_line - 1][: span.end_column].endswith(")")
    ):
        return item
    message = re.sub(
        r"of this (choice|range)", rf"of a \1 in an imported module (line {span.line})", item.message, count=1
    )
    return replace(item, message=message, span=None)
