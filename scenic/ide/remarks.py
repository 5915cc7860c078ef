"""Remarks of the last run of a program on its text: the share that each requirement rejects, ranges after narrowing."""

import ast
from collections.abc import Iterator, Mapping
from typing import Any, Final

from scenic.compiler import tree as scenic
from scenic.compiler.traversal import walk
from scenic.dataclass import dataclass
from scenic.ide.name_places import span_of
from scenic.ide.snapshot import Snapshot
from scenic.language.spans import Span

__all__ = ["Range", "Remarks", "Share", "ranges", "shares"]

_OPTIONS: Final = 4
"""Options of a choice that are shown."""


@dataclass(frozen=True, slots=True)
class Remarks:
    """The remarks about a text, as ``scenic preview --remarks`` writes them; they hold for this text only.

    ``scenario`` is the scenario of the file that was run, if one was named.
    """

    text: str
    scenario: str | None
    data: Mapping[str, Any]


@dataclass(frozen=True, slots=True)
class Share:
    """The share of candidates that a requirement rejects, in words, at its place."""

    span: Span
    words: str


@dataclass(frozen=True, slots=True)
class Range:
    """The values that narrowing leaves of a random value, in words, at its place."""

    span: Span
    left: str
    before: str


def shares(snapshot: Snapshot, remarks: Remarks) -> tuple[Share, ...]:
    """The shares of the requirements of a program, and of what the language requires, at most one for each line."""
    if remarks.text != snapshot.text or not remarks.data["candidates"]:
        return ()
    share_by_span: dict[Span, Share] = {}
    worst: dict[Span, float] = {}
    nodes = {
        span_of(snapshot, node): node for node in walk(snapshot.tree) if isinstance(node, ast.stmt | ast.expr)
    }
    for row in remarks.data["requirements"]:
        span, node = _span(row["span"]), nodes.get(_span(row["span"]))
        # The requirement of an imported module may have the place of another node.
        if node is None or row["rejected"] <= worst.get(span, 0):
            continue
        worst[span] = row["rejected"]
        subject = "" if isinstance(node, scenic.Require) else f"{row['label']} "
        share_by_span[span] = Share(span, f"{subject}rejects {_percent(row['rejected'])}{_alone(row)}")
    none = f"rejects none of {remarks.data['candidates']:,} candidates"
    if remarks.data["values"]:
        none += ", after narrowing"
    for node in _requirements(snapshot, remarks.scenario):
        span = span_of(snapshot, node)
        share_by_span.setdefault(span, Share(span, none))
    return tuple(sorted(share_by_span.values(), key=lambda each: (each.span.line, each.span.column)))


def _requirements(snapshot: Snapshot, scenario: str | None) -> Iterator[scenic.Require]:
    """Yield the requirements of the scenes that were looked for: those in time reject simulations."""
    statements: list[ast.stmt] = list(snapshot.tree.body)
    for node in snapshot.tree.body:
        if isinstance(node, scenic.ScenarioDef) and node.name == scenario:
            statements += node.setup or ()
    for node in statements:
        if isinstance(node, scenic.Require) and not any(
            isinstance(part, scenic.Temporal) for part in walk(node.condition)
        ):
            yield node


def ranges(snapshot: Snapshot, remarks: Remarks) -> tuple[Range, ...]:
    """Return the ranges of the random values of a program of which narrowing removes a part."""
    if remarks.text != snapshot.text:
        return ()
    calls = {span_of(snapshot, node) for node in walk(snapshot.tree) if isinstance(node, ast.Call)}
    rows = [(_span(row["span"]), row) for row in remarks.data["values"]]
    range_by_span = {
        span: Range(span, _values(row["after"]), _values(row["before"]))
        for span, row in rows
        if span in calls
    }
    # What is written once and drawn several times, in a loop or function, has a range for each.
    several = {span for span in range_by_span if sum(span == each for each, _ in rows) > 1}
    return tuple(
        each for span, each in range_by_span.items() if span not in several and each.left != each.before
    )


def _span(data: Mapping[str, int]) -> Span:
    return Span(data["line"], data["column"] - 1, data["end_line"], data["end_column"] - 1)


def _percent(share: float) -> str:
    """A share in percent, where little is not nothing and much is not all."""
    text = f"{share:.0%}"
    if text == "0%":
        return "less than 1%"
    return "more than 99%" if text == "100%" and share < 1 else text


def _alone(row: Mapping[str, Any]) -> str:
    """The share that nothing else rejects, where that is another one."""
    text = _percent(row["alone"]) if row["alone"] else "none"
    return " of candidates" if text == _percent(row["rejected"]) else f" of candidates, {text} alone"


def _values(ends: list[Any]) -> str:
    if ends and all(isinstance(end, int | float) for end in ends):
        return f"{ends[0]:.4g} to {ends[1]:.4g}"
    shown = ", ".join(map(str, ends[:_OPTIONS]))
    return shown + (f" and {len(ends) - _OPTIONS} more" if len(ends) > _OPTIONS else "")
