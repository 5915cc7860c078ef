"""Findings that are proved by running and analysing a program: `scenic check --deep`."""

from importlib.util import find_spec
from pathlib import Path

from scenic.analysis.contraction import contract
from scenic.analysis.finite.explaining import contradiction, narrowed_values
from scenic.deep.dead_branches import prove_branches
from scenic.failures import diagnose
from scenic.language.diagnostics import Diagnostic, Severity
from scenic.language.errors import ScenicSyntaxError
from scenic.language.extras import installation
from scenic.narrowing import conditions, decision_of
from scenic.pipeline import load

__all__ = ["deep_check"]


def deep_check(path: str | Path) -> tuple[Diagnostic, ...]:
    """Return the faults of a program that running and analysing it finds (no scene is sampled)."""
    if find_spec("z3") is None:
        from scenic.formats.imaging import MissingLibraryError

        missing = MissingLibraryError(
            "the deep check needs the library z3, which is not installed",
            help=f"install it: {installation('deep')}",
        )
        return (missing.diagnostic(),)
    from scenic.analysis.report import prove, prove_dead, prove_in_time

    filename = str(path)
    try:
        scenario = load(path, prune=False)
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
        domain = contract(graph, facts).domain.with_finite(narrowed_values(decision))
        findings += prove_dead(graph, domain)
        findings += prove_branches(scenario.text, filename, scenario.program, graph.nodes, facts)
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
