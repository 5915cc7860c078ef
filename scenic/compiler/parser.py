"""From source text to a tree and diagnostics.

`parse` never raises because of the text. What is right is parsed by the fast parser in one go; only a text with a
mistake goes through `scenic.compiler.recovery`, which explains the mistakes and keeps the rest of the tree.
"""

import ast
import sys
from bisect import bisect_left, bisect_right
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass, replace
from typing import Final

from scenic.compiler.actions import Actions, Problem
from scenic.compiler.actions.common import Place
from scenic.compiler.careful import lex_carefully
from scenic.compiler.closing_words import closed_operands, in_parentheses
from scenic.compiler.garbage import no_garbage_collection
from scenic.compiler.generated import WORDS, build_parser
from scenic.compiler.lexer import lex
from scenic.compiler.tokens import Tokens
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
    with no_garbage_collection():
        tokens, tree, problems = _parse_text(text)
        if not problems and not tokens.diagnostics:
            return ParseResult(tree, ())
    source = Source(tokens.text, filename)
    diagnostics = {replace(each, filename=filename) for each in tokens.diagnostics}
    diagnostics.update(_diagnostic(each, source) for each in problems)
    return ParseResult(tree, tuple(sorted(diagnostics, key=_order)))


def _parse_text(text: str) -> tuple[Tokens, ast.Module, list[Problem]]:
    """The tokens and the tree of a text, and what is wrong with it, as far as the lexer did not notice."""
    tokens = lex(text, WORDS)
    tree, problems = _fast(tokens)
    if tree is not None:
        return tokens, tree, problems
    # Statements that are wrong because an operator took a closing word from another are read once more without that.
    operands = closed_operands(tokens)
    if operands:
        again = in_parentheses(tokens, operands)
        tree, problems = _fast(again)
        if tree is not None:
            return again, tree, problems
    # Now the text is known to be wrong.
    tokens = lex_carefully(text, WORDS)
    operands = closed_operands(tokens) if operands else []
    for _ in range(2):
        if not operands:
            break
        again = in_parentheses(tokens, operands)
        tree, problems = _recovered(again)
        wrong = [problem.place[:2] for problem in problems]
        wrong += [(each.span.line, each.span.column) for each in tokens.diagnostics if each.span is not None]
        wrong.sort()
        right = [
            each for each in operands if bisect_left(wrong, each.start) == bisect_right(wrong, each.stop)
        ]
        if len(right) == len(operands):
            return again, tree, problems
        operands = right
    return tokens, *_recovered(tokens)


def _fast(tokens: Tokens) -> tuple[ast.Module | None, list[Problem]]:
    """The tree of a text that has no mistake of syntax, with what else is wrong."""
    actions = Actions(tokens)
    tree = _parse_file(tokens, actions)
    return tree, list(actions.problems.values())


def _recovered(tokens: Tokens) -> tuple[ast.Module, list[Problem]]:
    """The tree of a text with mistakes, and what they are."""
    # A text without mistakes does not wait for all that explains them.
    from scenic.compiler.recovery import Recovery

    actions = Actions(tokens)
    recovery = Recovery(tokens, actions)
    with recursion_limit(DEEPEST):
        tree = recovery.file()
    return tree, [*actions.problems.values(), *recovery.problems]


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
    run = build_parser(*tokens.lists(), actions)
    try:
        tree: ast.Module | None = run("file", 0)[0]
    except RecursionError:
        return None
    return tree


@contextmanager
def recursion_limit(limit: int) -> Iterator[None]:
    """Allow deeper recursion of Python functions for a while."""
    before = sys.getrecursionlimit()
    sys.setrecursionlimit(max(limit, before))
    try:
        yield
    finally:
        sys.setrecursionlimit(before)
