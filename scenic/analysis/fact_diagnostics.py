"""Diagnostics of facts that analysis proves."""

from collections import Counter
from collections.abc import Collection, Mapping, Sequence
from typing import Final

from scenic.analysis.contraction import contract
from scenic.analysis.facts import Fact
from scenic.analysis.smt import Contradiction, Support, judge
from scenic.analysis.solver_terms import has_solver
from scenic.analysis.supports import DISCRETE, DeadValues, dead_values
from scenic.analysis.traces import contradictions
from scenic.graph.bounding import overall
from scenic.graph.domain import Domain
from scenic.graph.node import Graph, Node
from scenic.graph.operations import TABLE
from scenic.language.diagnostics import Diagnostic, Label, Severity
from scenic.language.names import NAMES
from scenic.language.spans import Span
from scenic.runtime.description.declarations import Required

_SHOWN: Final = 5
"""Options that are shown by name."""

_MEND: Final = "no scene can meet all of the marked places; change one of them"


def prove(graph: Graph, conditions: Sequence[Fact]) -> tuple[Diagnostic, ...]:
    """Report contradictions among the conditions (SC700) and conditions that always hold (SC701), without sampling.

    A diagnostic lacks the file's name where that of its condition is not known.
    """
    if not conditions:
        return ()
    conditions_in_order = sorted(conditions, key=_place)
    diagnostics: list[Diagnostic] = []
    tautologies: Collection[Fact] = ()
    if has_solver():
        verdict = judge(conditions_in_order)
        diagnostics = [_contradiction(item, verdict.encoding.nodes) for item in verdict.contradictions]
        tautologies = verdict.tautologies
    if not diagnostics:
        core = _by_intervals(graph, conditions_in_order)
        if core:
            diagnostics = [_contradiction(Contradiction(core, ()))]
    diagnostics += [
        _tautology(item) for item in conditions_in_order if item in tautologies or _always_holds(item)
    ]
    return tuple(diagnostics)


def prove_in_time(
    requirements: Sequence[Required], told: Collection[Span | None] = ()
) -> tuple[Diagnostic, ...]:
    """Report temporal requirements that no simulation meets (SC700); nothing is reported without the solver.

    ``told`` contains the places of requirements that no scene meets, which are reported already.
    """
    diagnostics = []
    for core, length in contradictions(requirements) if has_solver() else ():
        *others, last = core
        if last.span in told:
            continue
        if others:
            message = (
                "this requirement cannot hold together with the others marked, however a simulation goes on"
            )
            advice = f"without it {length} {'state' if length == 1 else 'states'} would meet the others; change one of them"
        else:
            message = "this requirement cannot hold, however a simulation goes on"
            advice = "no simulation can meet it; change or remove it"
        labels = tuple(
            Label(other.span, "while this is required") for other in others if other.span is not None
        )
        diagnostics.append(
            Diagnostic("SC700", message, last.span, Severity.ERROR, last.filename, help=advice, labels=labels)
        )
    return tuple(diagnostics)


def prove_dead(graph: Graph, domains: Sequence[Domain], names: Mapping[int, str]) -> tuple[Diagnostic, ...]:
    """Report values of choices and of ranges of integers that no scene has, since the requirements exclude them (SC702).

    Of a range that is information, not a warning: its inner values cannot be removed, and who requires that a number be even
    means just this.

    Args:
        graph: the graph.
        domains: each with what the requirements leave of the cube, as far as one analysis shows it.
        names: of draws, by the addresses of their axes.

    """
    by_place: dict[tuple[Span, bool], list[DeadValues]] = {}
    draws: Counter[object] = Counter(node.span for node in graph.nodes if node.operation.name in DISCRETE)
    for row in dead_values(graph, domains):
        if isinstance(row.draw.span, Span):
            by_place.setdefault((row.draw.span, row.draw.operation.name == "choice"), []).append(row)
    diagnostics = []
    for (span, is_choice), rows in by_place.items():
        noun = "option" if is_choice else "integer"
        of = f"{noun}s of this {'choice' if is_choice else 'range'}"
        number = draws[span]
        if len(rows) == number and len({row.values for row in rows}) == 1:
            dead = rows[0].values
            verb = "never occurs" if len(dead) == 1 else "never occur"
            where = "" if number == 1 else f" in any of its {number} draws"
            message = f"{len(dead)} of the {rows[0].count} {of} {verb}{where}: {_some(dead)}"
        else:
            of_draws = (f"{names[graph.address(row.axis)]} is {_left(row)}" for row in rows[:_SHOWN])
            more = f"; and so on, for {len(rows)} draws" if len(rows) > _SHOWN else ""
            message = f"some {of} never occur in some of its {number} draws: {'; '.join(of_draws)}{more}"
        diagnostics.append(
            Diagnostic(
                "SC702",
                message,
                span,
                Severity.WARNING if is_choice else Severity.INFORMATION,
                help="the requirements exclude them; remove them, or check the requirements"
                if is_choice
                else "the requirements exclude them; if that is not meant, check the requirements",
            )
        )
    return tuple(diagnostics)


def _left(row: DeadValues) -> str:
    """Describe the values that are left of a draw, or those that are not, whichever are fewer."""
    if len(row.left) == 1:
        return f"always {row.left[0]}"
    if len(row.left) < len(row.values):
        return f"only {_some(row.left, ' or ')}"
    return f"never {_some(row.values, ' or ')}"


def _some(texts: Sequence[str], last: str = ", ") -> str:
    """Join the first few of some texts."""
    if len(texts) > _SHOWN:
        return ", ".join(texts[:_SHOWN]) + ", ..."
    return last.join([", ".join(texts[:-1]), texts[-1]] if len(texts) > 1 else texts)


def _place(condition: Fact) -> tuple[bool, Span]:
    """Sorts in program order; conditions of no place come last, in the order given."""
    if condition.span is None:
        return True, Span(1, 0, 1, 0)
    return False, condition.span


def _always_holds(condition: Fact) -> bool:
    """Return whether intervals show that a requirement of the program holds in every scene."""
    bounds = None if condition.built_in else overall(condition.node)
    return bounds is not None and bounds.lower.shape == (1,) and bool(bounds.lower[0] >= 1)


def _by_intervals(graph: Graph, conditions: Sequence[Fact]) -> tuple[Fact, ...]:
    """A minimal set of conditions that intervals prove impossible; empty where there is none.

    Intervals know functions that the solver does not, such as sine.
    """
    core = contract(graph, conditions).impossible
    for condition in core if len(core) > 1 else ():
        rest = tuple(member for member in core if member is not condition)
        if contract(graph, rest).impossible:
            core = rest
    return core


def _contradiction(item: Contradiction, nodes: Sequence[Node] = ()) -> Diagnostic:
    """Return a contradiction as a diagnostic; ``nodes`` are those that the solver has read."""
    *others, last = item.conditions
    subject = f"'{last.label}', which the language requires," if last.built_in else "this requirement"
    if others:
        message = f"{subject} cannot hold together with the others marked"
    elif item.supports:
        message = f"{subject} cannot hold for any value of what it depends on"
    else:
        message = f"{subject} can never hold"
    # A line in a loop is required many times, but marked once.
    labels = list(
        dict.fromkeys(
            Label(
                other.span,
                "while this is required",
                other.filename if other.filename != last.filename else None,
            )
            for other in others
            if other.span is not None and (other.span, other.filename) != (last.span, last.filename)
        )
    )
    phrases: dict[Span, tuple[str, list[str]]] = {}
    for support in item.supports:
        if isinstance(support.node.span, Span):
            noun, phrase = _words(support, nodes)
            parts = phrases.setdefault(support.node.span, (noun, []))[1]
            if phrase not in parts:
                parts.append(phrase)
    labels += [Label(span, f"{noun} {' and '.join(parts)}") for span, (noun, parts) in phrases.items()]
    labels.sort(key=lambda label: (label.filename or "", label.span))
    return Diagnostic(
        "SC700",
        message,
        last.span,
        Severity.ERROR,
        last.filename,
        help=_MEND if labels else "no scene can meet it; change or remove it",
        labels=tuple(labels),
    )


_NOUNS: Final = {
    operation: declared.noun
    for declared in NAMES.values()
    if declared.noun is not None
    for operation in (declared.operation, *declared.operations)
}
"""Values of distributions in words, by operation."""


def _words(support: Support, nodes: Sequence[Node]) -> tuple[str, str]:
    """A support in words: of what, and what about it."""
    operation = support.node.operation.name
    noun = f"this {_NOUNS.get(operation, operation)}"
    options = _options(support.node, nodes)
    if options:
        return noun, f"is one of {', '.join(options)}"
    return noun, support.phrase


def _options(choice: Node, nodes: Sequence[Node]) -> list[str]:
    """Return the values that a choice among fixed numbers picks from."""
    for node in nodes:
        if node.operation is TABLE["look-up"] and node.operands[0] is choice and node.kind.is_number:
            return [f"{value:.12g}" for value in node.payload.column.tolist()]
        if node.operation is TABLE["select"] and node.operands[0] is choice:
            options = node.operands[1:]
            if all(option.is_constant and isinstance(option.value, int | float) for option in options):
                return [f"{option.value:.12g}" for option in options]
    return []


def _tautology(condition: Fact) -> Diagnostic:
    return Diagnostic(
        "SC701",
        "this requirement always holds",
        condition.span,
        Severity.WARNING,
        condition.filename,
        help="it rejects no scene; remove it, or check that it says what it should",
    )
