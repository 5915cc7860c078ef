"""From source text to a tree and diagnostics.

`parse` never raises because of the text. What is right is parsed by the fast parser in one go; only a text with a
mistake goes through `scenic.compiler.recovery`, which explains the mistakes and keeps the rest of the tree.
"""

import ast
import sys
import threading
from bisect import bisect_left, bisect_right
from collections.abc import Callable, Iterator, Mapping, Sequence
from contextlib import AbstractContextManager, contextmanager
from dataclasses import field, replace
from types import MappingProxyType
from typing import Any, Final, TypeAlias

from scenic.compiler.actions import Actions, SyntaxProblem
from scenic.compiler.actions.common import Place
from scenic.compiler.generated import WORDS, build_parser
from scenic.compiler.lexer import lex
from scenic.compiler.tokens import DEDENT, ENDMARKER, INDENT, NEWLINE, TokenLists, Tokens
from scenic.dataclass import dataclass
from scenic.language.diagnostics import Diagnostic, Edit, Fix, Label
from scenic.language.garbage import no_garbage_collection
from scenic.language.source import Source
from scenic.language.spans import Span

__all__ = ["ParseResult", "bare_text", "parse", "parse_lexed"]

_FRAMES: Final = 10_000
"""Frames of functions that explain a mistake within 200 brackets; CPython's compiler accepts as many levels without harm."""


@dataclass(frozen=True, slots=True)
class ParseResult:
    """The tree of a text, as complete as it could be made, and what is wrong with the text, in order.

    ``longest_line`` is at least the number of tokens of the longest logical line, if they have been counted.
    """

    tree: ast.Module
    diagnostics: tuple[Diagnostic, ...]
    longest_line: int = field(default=sys.maxsize, compare=False)


Run: TypeAlias = Callable[[str, int], tuple[Any, int]]
"""Parses what a rule has from a token on: what was made of it (``None`` if it does not stand there), and the token after."""


@dataclass(frozen=True, slots=True, eq=False)
class Parsed:
    """The result of parsing: the tokens that were parsed, the tree, and the mistakes."""

    tokens: Tokens
    tree: ast.Module
    problems: list[SyntaxProblem]


def parse(text: str, *, filename: str = "<string>") -> ParseResult:
    """Parse a Scenic program.

    Never raises, whatever ``text`` contains. Statements that cannot be parsed are
    `scenic.compiler.tree.ErrorStatement` nodes in the tree, and the diagnostics describe their errors.
    """
    with no_garbage_collection():
        return parse_lexed(lex(text, WORDS), filename=filename)


def parse_lexed(tokens: Tokens, *, filename: str) -> ParseResult:
    """Parse the tokens of a text, as the plain lexer gives them."""
    if any(each.code == "SC112" for each in tokens.diagnostics):
        diagnostics_of_tokens = (replace(each, filename=filename) for each in tokens.diagnostics)
        return ParseResult(ast.Module(body=[], type_ignores=[]), tuple(diagnostics_of_tokens))
    with no_garbage_collection():
        result = _parse_tokens(tokens)
    problems = result.problems
    tokens = result.tokens
    if not problems and not tokens.diagnostics:
        return ParseResult(result.tree, (), _tokens_of_longest_line(tokens.kinds))
    source = Source(tokens.text, filename)
    diagnostics = {replace(each, filename=filename) for each in tokens.diagnostics}
    diagnostics.update(_diagnostic(each, source) for each in problems)
    return ParseResult(result.tree, tuple(sorted(diagnostics, key=_order)))


def bare_text(text: str) -> str:
    """Return the tokens of a text, one a line: equal for texts that differ in comments, blanks and empty lines alone."""
    tokens = lex(text, WORDS)
    return "\n".join(
        _LAYOUT.get(kind) or repr(word) for kind, word in zip(tokens.kinds, tokens.texts, strict=True)
    )


_LAYOUT: Final[Mapping[int, str]] = MappingProxyType({NEWLINE: "end", INDENT: "in", DEDENT: "out"})
"""Symbols for tokens that are only layout."""


def _tokens_of_longest_line(kinds: list[int]) -> int:
    """The number of tokens of the longest logical line."""
    longest = start = 0
    for _ in range(kinds.count(NEWLINE)):
        end = kinds.index(NEWLINE, start) + 1
        if end - start > longest:
            longest = end - start
        start = end
    return max(longest, len(kinds) - start)


def _parse_tokens(tokens: Tokens) -> Parsed:
    text = tokens.text
    result = _fast(tokens)
    if result is not None:
        return result
    # A text without mistakes does not wait for all that reads another one.
    from scenic.compiler.shared_words import closed_operands, in_parentheses
    from scenic.compiler.tolerant_lexer import lex_tolerantly

    # Statements that are wrong because an operator took a closing word from another are read once more without that.
    operands = None if tokens.diagnostics else closed_operands(tokens)
    if operands:
        result = _fast(in_parentheses(tokens, operands))
        if result is not None:
            return result
    # Now the text is known to be wrong.
    tokens = lex_tolerantly(text, WORDS)
    operands = [] if operands == [] else closed_operands(tokens)
    for _ in range(2):
        if not operands:
            break
        result = _recovered(in_parentheses(tokens, operands))
        wrong = [problem.place[:2] for problem in result.problems]
        wrong += [(each.span.line, each.span.column) for each in tokens.diagnostics if each.span is not None]
        wrong.sort()
        right = [
            each for each in operands if bisect_left(wrong, each.start) == bisect_right(wrong, each.stop)
        ]
        if len(right) == len(operands):
            return result
        operands = right
    return _recovered(tokens)


def _fast(tokens: Tokens) -> Parsed | None:
    """Parse the tokens of a text without syntax errors; return ``None`` if the text has an error."""
    if tokens.diagnostics:
        return None
    actions = Actions(tokens)
    lists = tokens.lists()
    with _PARSERS.reading(lists, actions) as run:
        statements = _statements(run, lists[0])
    if statements is None:
        return None
    return Parsed(tokens, actions.module(statements), list(actions.problems.values()))


def _statements(run: Run, kinds: Sequence[int]) -> list[ast.stmt] | None:
    """Return the statements of the top level; ``None`` if there is a mistake."""
    statements: list[ast.stmt] = []
    position = 0
    try:
        while kinds[position] != ENDMARKER:
            node, position = run("statement", position)
            if node is None:
                return None
            statements += node if isinstance(node, list) else [node]
    except RecursionError:
        return None
    return statements


def _recovered(tokens: Tokens) -> Parsed:
    """Parse the tokens of a text with syntax errors, recovering from each."""
    # A text without mistakes does not wait for all that explains them.
    from scenic.compiler.recovery import Recovery

    actions = Actions(tokens)
    recovery = Recovery(tokens, actions)
    with deep_recursion():
        tree = recovery.file()
    problems = [*actions.problems.values(), *recovery.problems]
    return Parsed(tokens, tree, problems)


class _Parsers:
    """The fast parsers that wait for a text: making one takes as long as parsing twenty lines with it.

    What one has read it forgets before it waits, so that what is made of a text depends on that text alone.
    """

    def __init__(self) -> None:
        self._idle: list[Any] = []

    @contextmanager
    def reading(self, lists: TokenLists, actions: Actions) -> Iterator[Run]:
        """Provide a parser of these tokens that nobody else uses meanwhile; each thread and each nested parse has its own."""
        try:
            run = self._idle.pop()
        except IndexError:
            run = build_parser(*lists, actions)
        else:
            run.read(*lists, actions)
        try:
            yield run
        finally:
            run.forget()
            self._idle.append(run)


_PARSERS: Final = _Parsers()


def _diagnostic(problem: SyntaxProblem, source: Source) -> Diagnostic:
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


class _Recursion:
    """The limit of recursion, which all threads share: raised as long as any of them reads a program."""

    def __init__(self) -> None:
        self._lock = threading.Lock()
        self._users = 0
        self._ordinary = sys.getrecursionlimit()

    @contextmanager
    def raised(self) -> Iterator[None]:
        with self._lock:
            if not self._users:
                self._ordinary = sys.getrecursionlimit()
                sys.setrecursionlimit(max(_FRAMES, self._ordinary))
            self._users += 1
        try:
            yield
        finally:
            with self._lock:
                self._users -= 1
                if not self._users:
                    sys.setrecursionlimit(self._ordinary)


_RECURSION: Final = _Recursion()


def deep_recursion() -> AbstractContextManager[None]:
    """Allow the recursion of functions that the deepest programs need, which have 200 brackets within each other."""
    return _RECURSION.raised()
