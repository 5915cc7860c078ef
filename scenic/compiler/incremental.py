"""Parsing a text again after a change: statements at the top level that are as before are neither lexed nor parsed.

The result is the same as that of parsing the whole text. Two things make that so. Tokens are taken over where the lexers
have nothing else in mind (`scenic.compiler.relexing`). And what the parser makes of a statement depends on its tokens alone,
and on whether what follows goes on with it, which is looked at each time.
"""

import ast
from bisect import bisect_left, bisect_right
from collections.abc import Callable, Sequence
from typing import Any

from scenic.compiler.actions import Problem
from scenic.compiler.generated import WORDS
from scenic.compiler.lexer import lex
from scenic.compiler.parser import (
    Parsed,
    ParseResult,
    Statements,
    parse_tokens,
    result_of,
    tokens_of_longest_line,
)
from scenic.compiler.relexing import Change, Lexed, Splice, lex_again
from scenic.compiler.tokens import DEDENT, ENDMARKER, INDENT, NEWLINE, Tokens
from scenic.compiler.traversal import FIELDS
from scenic.dataclass import dataclass
from scenic.language.garbage import no_garbage_collection

__all__ = ["Revision", "revise"]

_LAYOUT = frozenset({NEWLINE, INDENT, DEDENT, ENDMARKER})
_ENDS = frozenset({NEWLINE, DEDENT})


@dataclass(frozen=True, slots=True, eq=False)
class Revision:
    """One version of a text with its tokens and tree, from which the next version takes what has not changed.

    ``plain`` is what the plain lexer made of it, ``careful`` what the careful one made of the last version with a mistake,
    after the lines of that. ``parsed`` says where in the tokens that were parsed the statements of the top level stand.
    """

    lines: tuple[str, ...]
    plain: Lexed
    careful: tuple[tuple[str, ...], Lexed] | None
    parsed: Parsed
    result: ParseResult

    @property
    def tokens(self) -> Tokens:
        """The tokens of the plain lexer."""
        return self.plain.tokens


def revise(text: str, before: Revision | None = None, *, filename: str = "<string>") -> Revision:
    r"""Parse a text, with the help of the version before it. ``text`` has ``\n`` at each line end and no byte order mark.

    Never raises because of ``text``, and gives what `scenic.compiler.parser.parse` gives.
    """
    lines = tuple(text.split("\n"))
    longest: int | None = None
    # A text with a mistake may be parsed several times.
    shifted: dict[int, list[ast.stmt]] = {}
    careful = None if before is None else before.careful

    def reread(text: str) -> Tokens:
        nonlocal careful
        again = None
        if careful is not None:
            again = lex_again(text, lines, careful[1], _difference(careful[0], lines), _carefully)
        careful = lines, _carefully(text) if again is None else again[0]
        return careful[1].tokens

    with no_garbage_collection():
        if before is None:
            plain = _plainly(text)
            parsed = parse_tokens(plain.tokens, reread=reread)
        else:
            change = _difference(before.lines, lines)
            again = lex_again(text, lines, before.plain, change, _plainly)
            plain, splice = (_plainly(text), None) if again is None else again
            tokens = plain.tokens
            parsed = parse_tokens(
                tokens, lambda read: _known(read, before.parsed, change, splice, shifted), reread
            )
            if splice is not None and before.result.longest_line <= len(tokens.kinds):
                fresh = tokens.kinds[splice.begin : splice.end + splice.moved]
                longest = max(before.result.longest_line, tokens_of_longest_line(fresh))
    return Revision(lines, plain, careful, parsed, result_of(parsed, filename, longest))


def _difference(before: Sequence[str], after: Sequence[str]) -> Change:
    most = min(len(before), len(after))
    first = _same(lambda begin, end: before[begin:end] == after[begin:end], most)
    last = _same(
        lambda begin, end: (
            before[len(before) - end : len(before) - begin] == after[len(after) - end : len(after) - begin]
        ),
        most - first,
    )
    return Change(first, last, len(before), len(after))


def _same(agree: Callable[[int, int], bool], most: int) -> int:
    """Return the number of equal items at the beginning, ``most`` at most, by bisection; ``agree`` compares a range at once."""
    found = 0
    while most > found:
        half = (most - found + 1) // 2
        if agree(found, found + half):
            found += half
        else:
            most = found + half - 1
    return found


# Tokens


def _plainly(text: str) -> Lexed:
    tokens = lex(text, WORDS)
    kinds, columns = tokens.kinds, tokens.columns
    afresh = [
        index
        for index, column in enumerate(columns)
        if not column and kinds[index] not in _LAYOUT and (not index or kinds[index - 1] in _ENDS)
    ]
    return Lexed(tokens, afresh)


def _carefully(text: str) -> Lexed:
    # A text without mistakes does not wait for what reads another one.
    from scenic.compiler.careful import lex_carefully

    afresh: list[int] = []
    tokens = lex_carefully(text, WORDS, afresh)
    return Lexed(tokens, afresh)


# Statements


def _known(
    tokens: Tokens,
    before: Parsed,
    change: Change,
    splice: Splice | None,
    shifted: dict[int, list[ast.stmt]],
) -> Statements:
    """The statements of the version before that stand in these tokens too: by their first token.

    ``shifted`` are copies of such statements where they stand now, by where their first tokens stood.
    """

    def moved(start: int, statements: list[ast.stmt]) -> list[ast.stmt]:
        if start not in shifted:
            shifted[start] = [_shifted(each, change.shift) for each in statements]
        return shifted[start]

    old = before.tokens
    wrong = _wrong_lines(before)
    if splice is not None and not (splice.tokens is tokens and splice.old is old and not wrong):
        splice = None
    found: dict[int, tuple[list[ast.stmt], int]] = {}
    for start, known in before.statements.items():
        statements, stop = known
        if splice is not None and (stop <= splice.begin or start >= splice.end):
            # There is no need to compare tokens that have been taken over.
            if start < splice.end or not (splice.moved or change.shift):
                found[start] = known
                continue
            if change.shift:
                statements = moved(start, statements)
            found[start + splice.moved] = (statements, stop + splice.moved)
            continue
        line, last_line = old.lines[start], old.end_lines[stop - 1]
        if old.kinds[stop - 1] == DEDENT:
            # It stands where the next statement begins.
            last_line = max(line, old.lines[stop - 1] - 1)
        if last_line <= change.first:
            shift = 0
        elif line > change.before - change.last:
            shift = change.shift
        else:
            continue
        if wrong and bisect_left(wrong, line) != bisect_right(wrong, last_line):
            continue
        begin = bisect_left(tokens.lines, line + shift)
        count = stop - start
        while begin < len(tokens.kinds) and tokens.kinds[begin] == DEDENT:
            begin += 1
        if tokens.kinds[begin : begin + count] != old.kinds[start:stop]:
            continue
        if tokens.columns[begin : begin + count] != old.columns[start:stop]:
            continue
        if tokens.lines[begin] != line + shift:
            continue
        if shift:
            statements = moved(start, statements)
        found[begin] = (statements, begin + count)
    return found


def _wrong_lines(parsed: Parsed) -> list[int]:
    """The lines that something is wrong with."""
    found: set[int] = set()
    for problem in parsed.problems:
        found.update(_lines_of(problem))
    for item in parsed.tokens.diagnostics:
        for span in (item.span, *(label.span for label in item.labels)):
            if span is not None:
                found.update((span.line, span.end_line))
    return sorted(found)


def _lines_of(problem: Problem) -> set[int]:
    places = [problem.place, *(place for place, _ in problem.labels)]
    if problem.fix is not None:
        places += [place for place, _ in problem.fix[1]]
    return {line for place in places for line in (place[0], place[2])}


def _shifted(node: ast.stmt, by: int) -> ast.stmt:
    """A copy of a tree of any depth, moved down by a number of lines."""
    new: ast.stmt = _empty(node)
    stack: list[tuple[ast.AST, ast.AST]] = [(node, new)]
    while stack:
        old, copy = stack.pop()
        values = copy.__dict__ = {**old.__dict__}
        if "lineno" in values:
            values["lineno"] += by
            end = values.get("end_lineno")
            if end is not None:
                values["end_lineno"] = end + by
        for field in FIELDS[old.__class__]:
            value: Any = values.get(field)
            cls = value.__class__
            if cls is list:
                parts = values[field] = [*value]
                for index, part in enumerate(parts):
                    if part.__class__ in FIELDS:
                        parts[index] = inner = _empty(part)
                        stack.append((part, inner))
            elif cls in FIELDS:
                values[field] = inner = _empty(value)
                stack.append((value, inner))
    return new


def _empty(node: Any) -> Any:
    """A node of the same class, of which nothing is known."""
    return node.__class__.__new__(node.__class__)
