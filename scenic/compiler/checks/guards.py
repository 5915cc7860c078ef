"""Guards under a misspelt name, which are annotations of variables and guard nothing."""

import ast
from collections.abc import Iterator, Sequence
from typing import Any

from scenic.compiler import tree as scenic
from scenic.compiler.checks.context import CheckContext
from scenic.language.diagnostics import Diagnostic
from scenic.language.spelling import nearest

__all__ = ["check_guards"]


def check_guards(context: CheckContext) -> Iterator[Diagnostic]:
    """Report SC310 for ``precondtion: condition`` in a behavior or scenario."""
    for cls in (scenic.BehaviorDef, scenic.ScenarioDef):
        for node, _ in context.nodes(cls):
            body = node.body if isinstance(node, scenic.BehaviorDef) else node.setup or []
            for index, statement in enumerate(body):
                yield from _misspelt(context, body, index, statement)


def _misspelt(
    context: CheckContext, body: Sequence[Any], index: int, statement: object
) -> Iterator[Diagnostic]:
    if not isinstance(statement, ast.AnnAssign) or statement.value is not None:
        return
    target = statement.target
    if not statement.simple or not isinstance(target, ast.Name):
        return
    guard = nearest(target.id, scenic.GUARDS)
    if guard is None or _used(context, target):
        return
    # Elsewhere it would be a guard in the wrong place. Of several the first is repaired first.
    first = all(map(scenic.is_documentation, body[:index]))
    yield context.warning(
        "SC310",
        f"`{target.id}` is annotated here and guards nothing",
        target,
        f"did you mean `{guard}`?"
        if first
        else f"did you mean `{guard}`? Guards stand before all other statements",
        fix=context.replacement(f"Write `{guard}`", target, guard)
        if first and _is_alone(context, statement)
        else None,
    )


def _used(context: CheckContext, target: ast.Name) -> bool:
    """Return whether a name is assigned elsewhere or read: then it is meant to be a variable."""
    binding = context.binding(target)
    return binding is not None and (len(binding.sites) > 1 or binding in context.resolution.read)


def _is_alone(context: CheckContext, statement: ast.stmt) -> bool:
    """Return whether a statement has its line for itself."""
    span = context.source.span(statement)
    before = context.source.line(span.line)[: span.column]
    return (
        not before.strip()
        and ";" not in context.source.line(span.end_line)[span.end_column :].partition("#")[0]
    )
