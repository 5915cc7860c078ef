"""Functions of the established Python API where the language has syntax for what they do."""

from collections.abc import Iterator

from scenic.compiler.checks.context import CheckContext
from scenic.compiler.traversal import position
from scenic.language.diagnostics import Diagnostic, Severity
from scenic.language.names import NAMES

__all__ = ["check_written_forms"]


def check_written_forms(context: CheckContext) -> Iterator[Diagnostic]:
    """Report SC315, as information, at the first use of each function that the language writes in words."""
    for name, uses in context.resolution.uses.items():
        declaration = NAMES.get(name)
        if declaration is None or declaration.syntax is None:
            continue
        node = min((use.node for use in uses if context.provided(use.node)), key=position, default=None)
        if node is None:
            continue
        yield Diagnostic(
            "SC315",
            f"the language writes `{declaration.name}` in words",
            context.span(node),
            Severity.INFORMATION,
            context.source.filename,
            f"write {declaration.syntax}",
        )
