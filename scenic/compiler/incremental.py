"""Parsing a text again after a change: statements at the top level that are as before are neither lexed nor parsed.

The result is the same as that of parsing the whole text. Two things make that so. The lexer is in the same state at every
line that begins a statement at the top level of a text without lexical mistakes, so that a stretch of lines between two
such can be replaced by itself. And what the parser makes of a statement depends on its tokens alone, and on whether what
follows goes on with it, which is looked at each time.
"""

import ast
from bisect import bisect_left, bisect_right
from collections.abc import Callable, Sequence
from dataclasses import dataclass
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
from scenic.compiler.tokens import DEDENT, ENDMARKER, INDENT, NEWLINE, Tokens
from scenic.compiler.traversal import FIELDS
from scenic.language.garbage import no_garbage_collection

__all__ = ["Revision", "revise"]

_LAYOUT = frozenset({NEWLINE, INDENT, DEDENT, ENDMARKER})


@dataclass(frozen=True, slots=True, eq=False)
class Revision:
    """One version of a text with its tokens and tree, from which the next version takes what has not changed.

    ``tokens`` are those of the plain lexer. ``parsed`` says where in the tokens that were parsed (which may be others, if
    there are mistakes) the statements of the top level stand.
    """

    lines: tuple[str, ...]
    tokens: Tokens
    parsed: Parsed
    result: ParseResult


@dataclass(frozen=True, slots=True)
class _Change:
    """What has changed between two texts: ``first`` lines at the beginning are the same, and ``last`` at the end."""

    first: int
    last: int
    before: int
    after: int

    @property
    def shift(self) -> int:
        """By how much the lines at the end have moved."""
        return self.after - self.before


def revise(text: str, before: Revision | None = None, *, filename: str = "<string>") -> Revision:
    r"""Parse a text, with the help of the version before it. ``text`` has ``\n`` at each line end and no byte order mark.

    Never raises because of ``text``, and gives what `scenic.compiler.parser.parse` gives.
    """
    lines = tuple(text.split("\n"))
    longest: int | None = None
    with no_garbage_collection():
        if before is None:
            tokens = lex(text, WORDS)
            parsed = parse_tokens(tokens)
        else:
            change = _difference(before.lines, lines)
            splice = _lexed(text, lines, before, change)
            tokens = lex(text, WORDS) if splice is None else splice.tokens
            parsed = parse_tokens(tokens, lambda read: _known(read, before.parsed, change, splice))
            if splice is not None and before.result.longest_line <= len(tokens.kinds):
                fresh = tokens.kinds[splice.begin : splice.end + splice.moved]
                longest = max(before.result.longest_line, tokens_of_longest_line(fresh))
    return Revision(lines, tokens, parsed, result_of(parsed, filename, longest))


def _difference(before: Sequence[str], after: Sequence[str]) -> _Change:
    most = min(len(before), len(after))
    first = _same(lambda begin, end: before[begin:end] == after[begin:end], most)
    last = _same(
        lambda begin, end: (
            before[len(before) - end : len(before) - begin] == after[len(after) - end : len(after) - begin]
        ),
        most - first,
    )
    return _Change(first, last, len(before), len(after))


def _same(agree: Callable[[int, int], bool], most: int) -> int:
    """How many items are the same, of at most so many: found by halves, each of which is compared at once."""
    found = 0
    while most > found:
        half = (most - found + 1) // 2
        if agree(found, found + half):
            found += half
        else:
            most = found + half - 1
    return found


# Tokens


@dataclass(frozen=True, slots=True)
class _Splice:
    """Tokens of which those before ``begin`` are as they were, and so are those that began at ``end``.

    ``old`` are the tokens before; ``moved`` is by how many tokens the latter are further back.
    """

    tokens: Tokens
    old: Tokens
    begin: int
    end: int
    moved: int


def _lexed(text: str, lines: Sequence[str], before: Revision, change: _Change) -> _Splice | None:
    """The tokens of a text, those of unchanged lines taken over; ``None`` if lexical mistakes are in the way."""
    old = before.tokens
    if old.diagnostics:
        return None
    starts = _starts(old, before.parsed)
    start_lines = [old.lines[index] for index in starts]
    # The statement before the change may go on with what has changed.
    head = bisect_left(start_lines, change.first + 1) - 1
    begin, first_line = (starts[head], start_lines[head]) if head >= 0 else (0, 1)
    tail = bisect_right(start_lines, change.before - change.last)
    if tail < len(starts):
        end, end_line = starts[tail], start_lines[tail] + change.shift
    else:
        end, end_line = len(old.kinds), len(lines) + 1
    part = "\n".join(lines[first_line - 1 : end_line - 1])
    if end_line <= len(lines):
        part += "\n"
    fresh = lex(part, WORDS)
    if fresh.diagnostics:
        return None
    if end_line <= len(lines):
        for column in (
            fresh.kinds,
            fresh.texts,
            fresh.lines,
            fresh.columns,
            fresh.end_lines,
            fresh.end_columns,
        ):
            column.pop()  # The end of the file, which is not here.
    down, shift = first_line - 1, change.shift
    if text and not text.endswith("\n"):
        text += "\n"
    tokens = Tokens(
        text,
        old.kinds[:begin] + fresh.kinds + old.kinds[end:],
        old.texts[:begin] + fresh.texts + old.texts[end:],
        old.lines[:begin] + _moved(fresh.lines, down) + _moved(old.lines[end:], shift),
        old.columns[:begin] + fresh.columns + old.columns[end:],
        old.end_lines[:begin] + _moved(fresh.end_lines, down) + _moved(old.end_lines[end:], shift),
        old.end_columns[:begin] + fresh.end_columns + old.end_columns[end:],
        [each for each in old.comments if each[0] < first_line]
        + [(line + down, column, comment) for line, column, comment in fresh.comments]
        + [
            (line + shift, column, comment)
            for line, column, comment in old.comments
            if line + shift >= end_line and line > change.before - change.last
        ],
    )
    return _Splice(tokens, old, begin, end, begin + len(fresh.kinds) - end)


def _starts(tokens: Tokens, parsed: Parsed) -> list[int]:
    """The tokens with which statements of the top level begin."""
    kinds, columns = tokens.kinds, tokens.columns
    # Where these tokens were parsed, the statements are known already.
    candidates = sorted(parsed.statements) if parsed.tokens is tokens else range(len(kinds))
    return [
        index
        for index in candidates
        if columns[index] == 0
        and kinds[index] not in _LAYOUT
        and (index == 0 or kinds[index - 1] in (NEWLINE, DEDENT))
    ]


def _moved(lines: list[int], by: int) -> list[int]:
    return [line + by for line in lines] if by else lines


# Statements


def _known(tokens: Tokens, before: Parsed, change: _Change, splice: _Splice | None) -> Statements:
    """The statements of the version before that stand in these tokens too: by their first token."""
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
                statements = [_shifted(each, change.shift) for each in statements]
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
            statements = [_shifted(each, shift) for each in statements]
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


def _shifted(node: Any, by: int) -> Any:
    """A copy of a tree, so many lines further down."""
    new = node.__class__.__new__(node.__class__)
    values = new.__dict__
    values.update(node.__dict__)
    if "lineno" in values:
        values["lineno"] += by
        end = values.get("end_lineno")
        if end is not None:
            values["end_lineno"] = end + by
    for field in FIELDS[node.__class__]:
        value = values.get(field)
        if value.__class__ is list:
            values[field] = [_shifted(part, by) if isinstance(part, ast.AST) else part for part in value]
        elif isinstance(value, ast.AST):
            values[field] = _shifted(value, by)
    return new
