"""The checks of a program that need neither its running nor its modules: one module per kind of rule."""

import ast
from collections.abc import Collection, Iterable, Iterator

from scenic.compiler.checks.declarations import check_declarations
from scenic.compiler.checks.names import check_names, check_reserved
from scenic.compiler.checks.placement import check_placement
from scenic.compiler.checks.support import check_support
from scenic.compiler.scopes import Resolution
from scenic.language.diagnostics import Diagnostic
from scenic.language.source import Source

__all__ = ["check"]


def check(
    tree: ast.Module,
    source: Source,
    resolution: Resolution,
    *,
    reserved: Iterable[tuple[str, ast.AST]],
    tolerated: Collection[ast.AST],
    provided: Collection[str],
) -> tuple[Diagnostic, ...]:
    """All findings about a module, ordered by place.

    ``reserved`` are the places where the program binds a name that it must not bind, ``tolerated`` the names read
    where a missing name is provided for, ``provided`` the names in scope that nothing binds.
    """

    def findings() -> Iterator[Diagnostic]:
        yield from check_reserved(source, reserved)
        yield from check_names(tree, source, resolution, tolerated, provided)
        misplaced = dict(check_placement(tree, source))
        yield from misplaced.values()
        yield from check_support(tree, source, resolution, misplaced)
        yield from check_declarations(tree, source, resolution)

    return tuple(sorted(findings(), key=_order))


def _order(diagnostic: Diagnostic) -> tuple[int, int, str]:
    span = diagnostic.span
    return (0, 0, diagnostic.code) if span is None else (span.line, span.column, diagnostic.code)
