"""Names that must not be bound, and names that nothing binds."""

import ast
import re
from collections.abc import Collection, Iterable, Iterator
from typing import Final

from scenic.compiler.checks.places import word_span
from scenic.compiler.scopes import Resolution
from scenic.compiler.traversal import walk
from scenic.compiler.tree import ErrorStatement
from scenic.language.diagnostics import Diagnostic, Severity
from scenic.language.names import CONVERSIONS, TRACKED
from scenic.language.source import Source
from scenic.language.spelling import nearest

__all__ = ["check_names", "check_reserved"]

MOST_SUGGESTIONS: Final = 100
"""Names for which a similar one is looked for: a file full of undefined names must not take long."""


def check_reserved(source: Source, reserved: Iterable[tuple[str, ast.AST]]) -> Iterator[Diagnostic]:
    """SC200: bindings of names with a fixed meaning (section 1.3)."""
    for name, site in reserved:
        if name in TRACKED:
            message = f"`{name}` can only be set by `{name} = value`"
            help_ = f"write `{name} = value` as a statement of its own, or use another name here"
        elif name in CONVERSIONS:
            message = f"`{name}` is the conversion function and cannot be bound"
            help_ = "use another name"
        else:
            message = f"`{name}` cannot be bound"
            help_ = "set global parameters with `param name = value`"
        yield Diagnostic(
            "SC200", message, word_span(source, site, name), Severity.ERROR, source.filename, help_
        )


def check_names(
    tree: ast.Module,
    source: Source,
    resolution: Resolution,
    tolerated: Collection[ast.AST],
    provided: Collection[str],
) -> Iterator[Diagnostic]:
    """SC202: names that are read and that nothing binds."""
    if resolution.wildcard:
        return
    skipped: set[str] | None = None
    suggestions: dict[str, str | None] = {}
    for reference in resolution.references.values():
        name = reference.node.id
        if (
            reference.binding is not None
            or name in provided
            or reference.node in tolerated
            or isinstance(reference.node.ctx, ast.Store)
        ):
            continue
        if skipped is None:
            skipped = _skipped_words(tree, source)
        if name in skipped:
            continue
        if name not in suggestions and len(suggestions) < MOST_SUGGESTIONS:
            candidates = reference.scope.names_in_reach() | {word for word in provided if word[0] != "_"}
            suggestions[name] = nearest(name, candidates)
        suggestion = suggestions.get(name)
        yield Diagnostic(
            "SC202",
            f"the name `{name}` is not defined",
            source.span(reference.node),
            Severity.ERROR,
            source.filename,
            f"did you mean `{suggestion}`?" if suggestion else "define it before it is used, or import it",
        )


def _skipped_words(tree: ast.Module, source: Source) -> set[str]:
    """All words in statements that could not be parsed: they may bind any of them."""
    words: set[str] = set()
    for node in walk(tree):
        if isinstance(node, ErrorStatement):
            span = source.span(node)
            for line in range(span.line, span.end_line + 1):
                words.update(re.findall(r"\w+", source.line(line)))
    return words
