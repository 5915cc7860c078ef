"""From source text to a tree and diagnostics.

`parse` never raises because of the text. What is right is parsed by the fast parser in one go; only a text with a
mistake goes through `scenic.compiler.recovery`, which explains the mistakes and keeps the rest of the tree.
"""

import ast
import gc
import sys
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass, replace
from typing import Final

from scenic.compiler.actions import Actions, Problem
from scenic.compiler.actions.common import Place
from scenic.compiler.generated import WORDS, build_parser
from scenic.compiler.lexer import Tokens, lex
from scenic.compiler.recovery import Recovery
from scenic.language.diagnostics import Diagnostic, Edit, Fix, Label
from scenic.language.source import Source
from scenic.language.spans import Span

__all__ = ["ParseResult", "parse"]

DEEPEST: Final = 1_000_000
"""The deepest recursion that is tried; some 300 MB of Python frames, which use no C stack."""


@dataclass(frozen=True, slots=True)
class ParseResult:
    """The tree of a text, as complete as it could be made, and what is wrong with the text, in order."""

    tree: ast.Module
    diagnostics: tuple[Diagnostic, ...]


def parse(text: str, *, filename: str = "<string>") -> ParseResult:
    """Parse a Scenic program.

    Never raises because of ``text``, which may hold anything. Statements that cannot be parsed are
    `scenic.compiler.tree.ErrorStatement` nodes in the tree, and what is wrong with them is in the diagnostics.
    """
    with _no_garbage_collection():
        tokens = lex(text, WORDS)
        actions = Actions(tokens)
        tree = _parse_file(tokens, actions)
        recovery = None
        if tree is None:
            # What the failed attempt reported comes again.
            actions.problems.clear()
            recovery = Recovery(tokens, actions)
            with recursion_limit(DEEPEST):
                tree = recovery.file()
        problems = [*actions.problems.values(), *(recovery.problems if recovery else ())]
        if not problems and not tokens.diagnostics:
            return ParseResult(tree, ())
    source = Source(tokens.text, filename)
    diagnostics = {replace(each, filename=filename) for each in tokens.diagnostics}
    diagnostics.update(_diagnostic(each, source) for each in problems)
    return ParseResult(tree, tuple(sorted(diagnostics, key=_order)))


def _diagnostic(problem: Problem, source: Source) -> Diagnostic:
    fix = None
    if problem.fix is not None:
        title, edits = problem.fix
        fix = Fix(title, tuple(Edit(_span(place, source), text) for place, text in edits))
    return Diagnostic(
        problem.code,
        problem.message,
        _span(problem.place, source),
        filename=source.filename,
        help=problem.help,
        labels=tuple(Label(_span(place, source), text) for place, text in problem.labels),
        fix=fix,
    )


def _span(place: Place, source: Source) -> Span:
    line, column, end_line, end_column = place
    start = (line, source.character(line, column))
    end = max(start, (end_line, source.character(end_line, end_column)))
    return Span(*start, *end)


def _order(diagnostic: Diagnostic) -> tuple[int, int, str, str]:
    span = diagnostic.span
    if span is None:
        return (0, 0, diagnostic.code, diagnostic.message)
    return (span.line, span.column, diagnostic.code, diagnostic.message)


def _parse_file(tokens: Tokens, actions: Actions) -> ast.Module | None:
    """The tree of a text without mistakes, ``None`` if it has one."""
    if tokens.diagnostics:
        return None
    # The parser looks at a few tokens after the present one.
    run = build_parser(
        [*tokens.kinds, 0, 0, 0, 0],
        tokens.texts,
        tokens.lines,
        tokens.columns,
        tokens.end_lines,
        tokens.end_columns,
        actions,
    )
    try:
        tree: ast.Module | None = run("file", 0)[0]
    except RecursionError:
        return None
    return tree


@contextmanager
def _no_garbage_collection() -> Iterator[None]:
    """Nothing that a parser makes is garbage in a cycle, and looking for some takes longer than parsing."""
    enabled = gc.isenabled()
    gc.disable()
    try:
        yield
    finally:
        if enabled:
            gc.enable()


@contextmanager
def recursion_limit(limit: int) -> Iterator[None]:
    """Allow deeper recursion of Python functions for a while."""
    before = sys.getrecursionlimit()
    sys.setrecursionlimit(max(limit, before))
    try:
        yield
    finally:
        sys.setrecursionlimit(before)
