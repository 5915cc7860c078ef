"""Places of errors in programs that were changed.

A program was changed between two places, and is none any more. Then an error must be reported near the change, and not at
the end of the file, or at a statement that has nothing to do with it. What is near:

- It begins with the line of the statement that holds the first change: what stands before a `;` may be read as
  something else with it. If the change touches the beginning of that statement, or the
  space before it, then with the statement or header before, to which the change may belong as well: a header whose
  block is gone is wrong itself.
- It ends with the first line of the statement, or clause, after the one that holds the last change; where a header was
  changed, the whole of its statement counts. A bracket or string of the changed text that goes on beyond that, to where it is
  closed, is part of it: a quote may begin a string that takes many lines.
"""

import ast
from bisect import bisect_left, bisect_right
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any, Final

from fuzz.properties.case import Case, Property, Violation, describe, is_syntax_error
from scenic.compiler.generated import WORDS
from scenic.compiler.lexer import lex
from scenic.compiler.parser import parse
from scenic.compiler.tokens import (
    DEDENT,
    ENDMARKER,
    ERROR,
    FSTRING_END,
    FSTRING_START,
    INDENT,
    NEWLINE,
    STRING,
    Tokens,
)
from scenic.language.source import Source

__all__ = ["OF_TEXTS", "Region", "region"]

_BLANKS: Final = (" ", "\t", "\f")
_LAYOUT: Final = frozenset({NEWLINE, INDENT, DEDENT, ENDMARKER})


class _Offsets:
    """Offsets in characters of places in a text, which are lines and columns."""

    def __init__(self, text: str) -> None:
        self.source = Source(text, "<fuzz>")
        starts = [0]
        for line in self.source.lines:
            starts.append(starts[-1] + len(line) + 1)
        self._starts = starts

    def of(self, line: int, column: int) -> int:
        """Of a line and a column in characters."""
        return self._starts[min(line, len(self._starts)) - 1] + column

    def of_bytes(self, line: int, column: int) -> int:
        """Of a line and a column in bytes."""
        return self.of(line, self.source.character(line, column))

    def spans(self, tokens: Tokens) -> list[tuple[int, int, int]]:
        """Start, end and kind of each token that has a text of its own."""
        return [
            (self.of_bytes(line, column), self.of_bytes(end_line, end_column), kind)
            for kind, line, column, end_line, end_column in zip(
                tokens.kinds,
                tokens.lines,
                tokens.columns,
                tokens.end_lines,
                tokens.end_columns,
                strict=True,
            )
            if kind not in _LAYOUT
        ]


@dataclass(frozen=True, slots=True)
class Region:
    """The range in which an error must be, in offsets of the changed text, both inclusive."""

    start: int
    end: int


def region(original: str, text: str) -> Region | None:
    """Return the range in which the errors of ``text`` must be, which was made from the program ``original``;
    ``None`` if the texts are equal.
    """
    before, after = _Offsets(original), _Offsets(text)
    old, new = before.source.text, after.source.text
    if old == new:
        return None
    first = _common(old, new)
    rest = min(_common(old[::-1], new[::-1]), len(old) - first, len(new) - first)
    shift = len(new) - len(old)
    last = len(old) - rest
    program = _Program(old, before)
    start, end = program.touched(first, last, layout="\n" in new[first : len(new) - rest])
    end = _extended(after.spans(lex(new, WORDS)), new, start, max(end, last) + shift)
    return Region(program.line_start(start), program.after(max(end - shift, last)) + shift)


class _Program:
    """The statements of a program, in offsets."""

    def __init__(self, text: str, offsets: _Offsets) -> None:
        tokens = lex(text, WORDS)
        self._text = text
        self._tokens = offsets.spans(tokens)
        self._line_ends = sorted(
            offsets.of_bytes(line, column)
            for kind, line, column in zip(tokens.kinds, tokens.lines, tokens.columns, strict=True)
            if kind == NEWLINE
        )
        self._length = len(text)
        self._statements = sorted(
            (offsets.of_bytes(*start), offsets.of_bytes(*end)) for start, end in _extents(parse(text).tree)
        )
        starts = {start for start, _ in self._statements}
        self._line_starts: list[int] = []
        fresh = True
        for kind, line, column in zip(tokens.kinds, tokens.lines, tokens.columns, strict=True):
            if kind not in _LAYOUT and fresh:
                self._line_starts.append(offsets.of_bytes(line, column))
            fresh = kind in _LAYOUT
        starts.update(self._line_starts)
        self._starts = sorted(starts)

    def touched(self, first: int, last: int, *, layout: bool) -> tuple[int, int]:
        """Start and end of the statements that a change touches.

        ``layout`` says whether there is a line end in what was put in.
        """
        starts = [start for start, _, _ in self._tokens]
        while self._text[last : last + 1] in _BLANKS:
            # The space before a token may be its indentation.
            last += 1
        low = bisect_left([end for _, end, _ in self._tokens], first)
        high = bisect_right(starts, last)
        reach = [self._innermost(start, end) for start, end, _ in self._tokens[low:high]]
        start = min((start for start, _ in reach), default=first)
        end = max((end for _, end in reach), default=last)
        if layout or not reach:
            # What comes after may belong to what comes before, or no longer.
            end = max(end, *(self._innermost(*token[:2])[1] for token in self._tokens[high : high + 1]), 0)
        previous = bisect_left(self._starts, min(start, first)) - 1
        if previous >= 0 and (first <= start or not reach):
            start = min(start, self._starts[previous])
        return min(start, first), end

    def _innermost(self, start: int, end: int) -> tuple[int, int]:
        """The smallest statement around a token."""
        found = (0, self._length)
        for statement in self._statements:
            if statement[0] > start:
                break
            if statement[1] >= end and statement[1] - statement[0] <= found[1] - found[0]:
                found = statement
        return found

    def line_start(self, offset: int) -> int:
        """The start of the line that an offset lies in."""
        index = bisect_right(self._line_starts, offset) - 1
        return min(offset, self._line_starts[index]) if index >= 0 else offset

    def after(self, end: int) -> int:
        """The end of the next line of statements, or clause, from an offset on; of the text, if there is none."""
        index = bisect_left(self._line_starts, end)
        if index == len(self._line_starts):
            return self._length + 1
        line_end = bisect_left(self._line_ends, self._line_starts[index])
        return self._line_ends[line_end] if line_end < len(self._line_ends) else self._length + 1


def _extents(tree: ast.AST) -> list[tuple[Any, Any]]:
    """Start and end of each statement, with its decorators."""
    ranges = []
    for node in ast.walk(tree):
        if isinstance(node, ast.stmt):
            start = (node.lineno, node.col_offset)
            decorators = getattr(node, "decorator_list", ())
            if decorators:
                # The `@` stands before it.
                start = (decorators[0].lineno, 0)
            ranges.append((start, (node.end_lineno, node.end_col_offset)))
    return ranges


def _common(left: str, right: str) -> int:
    """The length of the common beginning."""
    low, high = 0, min(len(left), len(right))
    while low < high:
        middle = (low + high + 1) // 2
        if left[:middle] == right[:middle]:
            low = middle
        else:
            high = middle - 1
    return low


def _extended(tokens: Sequence[tuple[int, int, int]], text: str, start: int, end: int) -> int:
    """The end of the brackets and strings that begin between ``start`` and ``end``, and of those that begin in them."""
    starts: list[int] = []
    pairs: list[tuple[int, int]] = []
    for token_start, token_end, kind in tokens:
        mark = text[token_start:token_end]
        if kind in (STRING, ERROR):
            pairs.append((token_start, token_end))
        elif kind == FSTRING_START or mark in ("(", "[", "{"):
            starts.append(token_start)
        elif (kind == FSTRING_END or mark in (")", "]", "}")) and starts:
            pairs.append((starts.pop(), token_end))
    for pair_start, pair_end in sorted(pairs):
        if start <= pair_start < end < pair_end:
            end = pair_end
    return end


def errors_are_near_the_change(case: Case) -> None:
    """If a program that was changed is none any more, an error is reported near the change."""
    if case.mutant is None:
        return
    errors = [each for each in case.result.diagnostics if is_syntax_error(each)]
    if not errors or any(is_syntax_error(each) for each in parse(case.mutant.original).diagnostics):
        return
    near = region(case.mutant.original, case.text)
    if near is None:
        return
    offsets = _Offsets(case.text)
    for each in errors:
        span = each.span
        if span is not None and (
            offsets.of(span.line, span.column) <= near.end
            and offsets.of(span.end_line, span.end_column) >= near.start
        ):
            return
    raise Violation(
        f"no error near the change, between {near.start} and {near.end}: "
        + "; ".join(describe(each) for each in errors[:3])
        + f"\nof {case.mutant.original!r}"
    )


OF_TEXTS: Final = (Property.of(errors_are_near_the_change),)
