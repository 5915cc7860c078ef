"""Classes of objects where an instance is meant: older programs made objects without `new`."""

import ast
from collections.abc import Iterator

from scenic.compiler.checks.context import CheckContext
from scenic.language.diagnostics import Diagnostic, Edit, Fix, Severity
from scenic.language.spans import Span

__all__ = ["check_instances", "missing_new"]


def check_instances(context: CheckContext) -> Iterator[Diagnostic]:
    """Report SC111 for ``ego = Car``, and for a class that is a whole statement."""
    for block in context.blocks:
        for statement in block.statements:
            cls = statement.value if isinstance(statement, ast.Assign | ast.Expr) else None
            if not isinstance(cls, ast.Name):
                continue
            severity = Severity.WARNING
            if isinstance(statement, ast.Assign):
                target = statement.targets[-1]
                if not (isinstance(target, ast.Name) and target.id == "ego"):
                    continue
                severity = Severity.ERROR
            if context.properties(cls) is not None:
                yield missing_new(cls, context, f"new {cls.id}", severity)


def missing_new(
    cls: ast.Name, context: CheckContext, example: str, severity: Severity = Severity.ERROR
) -> Diagnostic:
    """Return SC111 for a class; ``example`` is what to write instead."""
    message, help_ = f"`new` is missing before `{cls.id}`", f"to create an object write `{example}`"
    if severity is not Severity.ERROR:
        # The statement does nothing, but it is no mistake for certain.
        return context.warning("SC111", message, cls, help_)
    span = context.source.span(cls)
    start = Span(span.line, span.column, span.line, span.column)
    return context.error("SC111", message, cls, help_, fix=Fix("Insert `new`", (Edit(start, "new "),)))
