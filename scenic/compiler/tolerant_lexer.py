"""Tokens of a text that is known to be wrong, read so that each mistake spoils no more than its own statement.

The ordinary lexer believes what it reads: an open bracket or string goes on until it is closed, and every change of indentation
is a block. That is right for right programs, and the only right thing. Once the parser has refused a text, `lex_tolerantly`
reads it again and doubts: it looks at indentation, and at whether a line looks like the start of a statement, to find where a
bracket or a string was left open; it repairs indentation that belongs to no block; and it leaves out the markers of a merge.
"""

import re
from collections.abc import Iterable, Mapping
from functools import cache
from typing import Final

from scenic.compiler import lexemes, lexical_errors
from scenic.compiler.generated import HARD_KEYWORDS, OPERATORS, WORDS
from scenic.compiler.lexer import Bracket, Lexer, prepared
from scenic.compiler.precedence import SPECIFIERS, Form, Slot
from scenic.compiler.precedence import Word as Written
from scenic.compiler.syntax import (
    BLOCK_STARTERS,
    STATEMENT_FORMS,
    STATEMENT_WORDS,
    ListOf,
    Optional,
    RuleReference,
    StatementForm,
    TokenKind,
    Word,
)
from scenic.compiler.text_lines import MOST_DIAGNOSTICS, measure
from scenic.compiler.tokens import DEDENT, ERROR, INDENT, NEWLINE, STRING, Tokens

__all__ = ["lex_tolerantly"]

_HEADERS: Final = frozenset(WORDS[word] for word in BLOCK_STARTERS)
"""The first words of lines that begin a block."""

_LEAST_TYPED: Final = 3
"""So many letters of such a word are enough to know it by them."""

_COLON: Final = OPERATORS[":"]
_COMMA: Final = OPERATORS[","]

_MOST_TOKENS_SEARCHED: Final = 2000
_MOST_CHARACTERS_SEARCHED: Final = 300
_MOST_BRACKETS_COMPARED: Final = 20
"""So far is looked around from one place; keeps the time linear."""

_HEADER_END: Final = re.compile(r"(?:[^\n:#\\]|\\\n)*+:")

_TARGET: Final = r"[A-Za-z_][\w.]*+(?:\[[^\]\n]{0,40}+\])?+"


def _soft_start(form: StatementForm) -> str:
    """Return a regular expression for the beginning of a line that is a statement by its first word, although
    the word may be a name.
    """
    match form.row[1:]:
        case (Word(text=":"), *_):
            return rf"{form.start}[ \t]*+:"
        case (TokenKind(name="NAME"), *_) if form.has_block:
            return rf"{form.start}[ \t]++\w++[ \t]*+[(:]"
        case (Word(text=second), *_) if form.has_block or second in HARD_KEYWORDS:
            return rf"{form.start}[ \t]++{second}\b"
        case () | (Optional(),):
            return rf"{form.start}[ \t]*+(?=[#\n])"
    return rf"{form.start}[ \t]++(?:['\"(]|[A-Za-z_\d])"


def _any_of(patterns: Iterable[str]) -> str:
    return "(?:" + "|".join(dict.fromkeys(patterns)) + ")"


_WITH_OPERAND: Final = frozenset(
    form.start
    for form in STATEMENT_FORMS
    if form.has_block
    and form.start not in STATEMENT_WORDS
    and isinstance(form.row[1], RuleReference | ListOf)
) | {"else", "async"}
"""The words that begin blocks, but stand elsewhere as well or may be names: their lines end with a colon."""


@cache
def _statement() -> re.Pattern[str]:
    """Return the pattern of a line that is a statement if it is indented no more than the statement around it."""
    return re.compile(
        # Words that start nothing but statements,
        rf"{_any_of(sorted(STATEMENT_WORDS | {'from'}))}(?=[ \t:(\n\[])"
        # those that start other things as well, if their line ends as it must,
        rf"|{_any_of(sorted(_WITH_OPERAND))}\b[^\n]*+(?<=[:(\[{{])(?:[ \t]*+(?:\#[^\n]*+)?+)(?=\n)"
        rf"|{_any_of(_soft_start(form) for form in STATEMENT_FORMS if form.is_soft and form.start not in _WITH_OPERAND)}"
        r"|new[ \t]++[A-Z]|@[A-Za-z_]"
        # and assignments.
        rf"|(?:\*?{_TARGET}[ \t]*+,[ \t]*+){{0,8}}+\*?{_TARGET}[ \t]*+(?:[-+*/%&|^@]|//|\*\*|<<|>>)?=(?!=)"
    )


@cache
def _after_text() -> re.Pattern[str]:
    """Return the pattern of a line that is hardly prose, in a text that is never closed."""
    return re.compile(
        r"(?:def|class|behavior|monitor|scenario)[ \t]++\w++[ \t]*+[(:]"
        r"|from[ \t]++[\w.]++[ \t]++import\b|(?:import|model)[ \t]++[\w.]++(?:[ \t]++as[ \t]++\w++)?+[ \t]*+(?=[#\n,;])"
        r"|@[A-Za-z_]|(?:if|for|while|with|try|else|elif|setup|compose)\b[^\n]*+(?<=:)(?=\n)"
        rf"|(?:param[ \t]++)?(?:{_TARGET}[ \t]*+,[ \t]*+){{0,8}}+{_TARGET}[ \t]*+=(?!=)"
        r"|(?:\w++[ \t]++)?new[ \t]++[A-Z]|require\b[^\n]*+[<>=()\[]"
    )


@cache
def _call() -> re.Pattern[str]:
    """Return the pattern of a line in a bracket, not in a string, that looks like a call on a line of its own or a property."""
    return re.compile(
        r"[A-Za-z_][\w.]*+\((?:[^\n]*+(?<=\)))?+[ \t]*+(?=\n)|[a-z]\w*+(?:\[[a-z, ]++\])?+:[ \t]++\S"
    )


def _specifier_start(form: Form) -> str:
    """Return a regular expression for the words that a specifier begins with, and the property of `with`."""
    words: list[str] = []
    for part in form.parts:
        if isinstance(part, Slot):
            break
        words.append(part.text if isinstance(part, Written) else r"\w++")
    return r"[ \t]++".join(words)


@cache
def _specifier() -> re.Pattern[str]:
    """Return the pattern of a line that contains a specifier."""
    return re.compile(rf"{_any_of(map(_specifier_start, SPECIFIERS))}[ \t]++(?![=:,.])[^\n]*+(?<![:\n])\n")


_CONFLICT: Final = re.compile(r"(<{7}|={7}|>{7}|\|{7})(?:[ \t][^\n]*+)?+\n")
_CONFLICT_END: Final = re.compile(r"^>{7}(?:[ \t][^\n]*+)?+\n", re.MULTILINE)
_MARKS: Final = re.compile(r"\"[^\"\n]*+\"|'[^'\n]*+'|([()\[\]{}])|\#")


def lex_tolerantly(text: str, words: Mapping[str, int]) -> Tokens:
    """Split a text with a mistake into tokens, as `scenic.compiler.lexer.lex` does for a right one.

    ``afresh`` is given the tokens before which nothing mattered any more (see `scenic.compiler.relexing`).
    """
    return prepared(text, words, _TolerantLexer)


class _TolerantLexer(Lexer):
    __slots__ = ("columns", "conflicts_end", "in_conflict", "phantoms", "shifted", "specifiers")

    tolerant = True

    def __init__(self, text: str, words: Mapping[str, int]) -> None:
        super().__init__(text, words)
        # The indentation of lines on which brackets are open.
        self.columns: dict[int, int] = {}
        # Whether a line has said that a merge conflict begins.
        self.in_conflict = False
        # Whether the end of one may still come.
        self.conflicts_end = True
        # How many levels of indentation there are with one that begins no block.
        self.phantoms: set[int] = set()
        # How many levels there are with one that holds specifiers.
        self.specifiers: set[int] = set()
        # The level (a number of levels) that a line was indented less than, and its column.
        self.shifted: tuple[int, int] | None = None

    # Lines and indentation.

    def start_line(self, pos: int) -> int:
        text = self.text
        while True:
            match = lexemes.LINE_START.match(text, pos)
            start = match.start(1) if match else pos
            marker = _CONFLICT.match(text, start)
            if marker is None:
                return super().start_line(pos)
            if start != pos:
                self.comment_lines(pos, start, self.line)
                self.line += text.count("\n", pos, start)
                self.line_start = start
            pos = self.conflict(marker)

    def conflict(self, marker: re.Match[str]) -> int:
        """Leave out the line with a marker, which is the present one, and the second side of a conflict."""
        end = marker.end()
        if marker[1][0] == "<":
            self.in_conflict = True
        if marker[1][0] == "<" or not self.in_conflict:
            self.report(lexical_errors.conflict_marker(self.here(*marker.span(1))))
        elif marker[1][0] == ">":
            self.in_conflict = False
        else:
            last = _CONFLICT_END.search(self.text, end) if self.conflicts_end else None
            self.conflicts_end = last is not None
            self.in_conflict = False
            if last is not None:
                self.fill_lines()
                self.line += self.text.count("\n", marker.start(), last.end() - 1)
                end = last.end()
        self.next_line(end)
        return end

    def indent(self, column: int, strict_column: int, white: str, end: int) -> None:
        indents = self.indents
        self.white = white
        top, strict_top = indents[-1]
        if column > top:
            if self.shifted == (len(indents), column) and not self.block_begins(end):
                # Back in the block that the lines before were indented less than.
                self.shifted = None
                indents[-1] = (column, strict_column)
                return
            is_ambiguous = strict_column <= strict_top
            indents.append((column, strict_column))
            if self.block_begins(end):
                if self.tokens.kinds[-2] == _COMMA:
                    self.specifiers.add(len(indents))
                self.add(INDENT, self.line_start, end)
            else:
                self.phantoms.add(len(indents))
                if not is_ambiguous:
                    self.report(lexical_errors.unexpected_indent(self.here(self.line_start, end)))
        else:
            while column < indents[-1][0]:
                if column > indents[-2][0] and self.shifted != (len(indents) - 1, column):
                    # Between two levels: take the line for one of the inner block.
                    self.report(lexical_errors.unmatched_unindent(self.here(self.line_start, end)))
                    if len(indents) in self.specifiers:
                        # No statement stands among specifiers.
                        self.close_level(end)
                        indents.append((column, strict_column))
                        self.phantoms.add(len(indents))
                        return
                    self.shifted = (len(indents), indents[-1][0])
                    indents[-1] = (column, strict_column)
                    return
                self.close_level(end)
                if column > indents[-1][0]:
                    self.shifted = None
                    indents[-1] = (column, strict_column)
            is_ambiguous = strict_column != indents[-1][1]
            indents[-1] = (column, strict_column)
        if is_ambiguous:
            self.report(lexical_errors.mixed_indentation(self.here(self.line_start, end)))

    def close_level(self, end: int) -> None:
        if len(self.indents) in self.phantoms:
            self.phantoms.discard(len(self.indents))
        else:
            self.add_empty(DEDENT, end)
        self.specifiers.discard(len(self.indents))
        self.indents.pop()

    def block_begins(self, end: int) -> bool:
        """Return whether the logical line before begins a block, or the line at ``end`` looks like one of specifiers."""
        kinds = self.tokens.kinds
        if len(kinds) < 2 or kinds[-1] != NEWLINE:
            return False
        if kinds[-2] in (_COLON, _COMMA):
            return True
        first = self.statement_start()
        if kinds[first] in _HEADERS or _specifier().match(self.text, end) is not None:
            return True
        # A header of which one word is being typed.
        word = self.tokens.texts[first]
        return (
            first == len(kinds) - 2
            and len(word) >= _LEAST_TYPED
            and any(each.startswith(word) for each in BLOCK_STARTERS)
        )

    def statement_start(self) -> int:
        """Return the first token of the logical line that the tokens end with."""
        kinds = self.tokens.kinds
        first = len(kinds) - 1
        least = max(0, first - _MOST_TOKENS_SEARCHED)
        while first > least and kinds[first - 1] not in (NEWLINE, INDENT, DEDENT):
            first -= 1
        return first

    # Brackets.

    def line_in_brackets(self, start: int, end: int) -> int | None:
        """Decide whether a line inside brackets, with its first token at ``end``, continues the brackets.

        ``start`` is the line end before. Returns where to go on if it does not.
        """
        text = self.text
        marker = _CONFLICT.match(text, self.line_start)
        if marker is not None:
            return self.conflict(marker)
        if end == len(text) or (
            self.fields and (len(self.fields[-1].string.quote) > 1 or text[end] in ")]}")
        ):
            return None
        column = measure(text[self.line_start : end])[0]
        self.columns[self.line] = column
        if text[end] in ")]}":
            self.close_inner(text[end], column)
            return None
        if not self.broken_off(column, end):
            return None
        self.never_closed(start)
        return self.start_line(self.line_start)

    def broken_off(self, column: int, end: int) -> bool:
        text = self.text
        kinds = self.tokens.kinds
        looks_new = column <= self.indents[-1][0] and (
            _statement().match(text, end) or _call().match(text, end)
        )
        if not looks_new and kinds[-1] != _COLON:
            return False
        first = self.statement_start()
        if kinds[first] in _HEADERS and first + 1 < len(kinds):
            # A parameter with an annotation looks like a property; and a header may end with its colon although a bracket is open.
            return not self.header_goes_on(end)
        return bool(looks_new)

    def header_goes_on(self, pos: int) -> bool:
        """Return whether the open bracket closes after ``pos`` and a colon then ends the header; the last colon
        was inside the bracket.
        """
        rest = self.text[pos : pos + _MOST_CHARACTERS_SEARCHED]
        depth = len(self.brackets)
        for offset, mark in enumerate(rest):
            if mark in "([{":
                depth += 1
            elif mark in ")]}":
                depth -= 1
                if depth == 0:
                    return _HEADER_END.match(rest, offset + 1) is not None
        return False

    def close_inner(self, closer: str, column: int) -> None:
        """A line starts with ``closer``: by its indentation it may close an outer bracket, and the inner ones are open."""
        brackets = self.brackets
        inner = brackets[-1]
        if len(brackets) < 2 or self.column_of(inner) <= column:
            return
        for index in range(len(brackets) - 2, max(-1, len(brackets) - _MOST_BRACKETS_COMPARED), -1):
            if self.column_of(brackets[index]) <= column:
                if brackets[index].closer == closer and self.column_of(brackets[index]) == column:
                    first = brackets[index + 1]
                    self.report(lexical_errors.never_closed(first.opener, first.span, is_field=False))
                    del brackets[index + 1 :]
                    self.add_empty(ERROR, self.line_start)
                return

    def column_of(self, bracket: Bracket) -> int:
        """Return the indentation of the line that a bracket is on."""
        return self.columns.get(bracket.line, self.indents[-1][0])

    def odd_closer(self, start: int) -> int:
        brackets, closer = self.brackets, self.text[start]
        if self.fields or not brackets or len(self.tokens.diagnostics) >= MOST_DIAGNOSTICS:
            return super().odd_closer(start)
        innermost = brackets[-1]
        span = self.here(start, start + 1)
        self.add(ERROR, start, start + 1)
        self.report(lexical_errors.wrong_closer(closer, span, innermost.opener, innermost.span))
        # It may stand for the closer that is wanted, close a bracket further out, or be one too many. The brackets that
        # come on the same line tell.
        missing_closers = self.wanted_closers()
        choices = [missing_closers[1:], missing_closers]
        if closer in missing_closers:
            choices.insert(0, missing_closers[missing_closers.index(closer) + 1 :])
        rest = self.closers(start + 1)
        likely = [rest]
        if self.text[self.line_start : start].strip():
            # At the end of the line, what was open at its beginning should be open.
            opened_here = sum(bracket.line == self.line for bracket in brackets[-_MOST_BRACKETS_COMPARED:])
            likely.insert(0, rest + missing_closers[opened_here:])
        matching = [each for left in likely for each in choices if each == left]
        matching += [each for each in choices if each.startswith(rest)]
        best = (matching or choices)[0]
        del brackets[len(brackets) - (len(missing_closers) - len(best)) :]
        return start + 1

    def wanted_closers(self) -> str:
        """Return the characters that close the open brackets, innermost first."""
        return "".join(bracket.closer for bracket in self.brackets[: -_MOST_BRACKETS_COMPARED - 1 : -1])

    def closers(self, pos: int, *, in_text: bool = False) -> str:
        """Return the closing brackets in the rest of a line, as far as they are not opened there."""
        text = self.text
        farthest = min(len(text), pos + _MOST_CHARACTERS_SEARCHED)
        end = text.find("\n", pos, farthest)
        if end < 0:
            end = farthest
        open_brackets: list[str] = []
        closing = []
        for match in _MARKS.finditer(text, pos, end):
            marks = [match[1]] if match[1] else [each for each in match[0] if in_text and each in "()[]{}"]
            if match[0] == "#":
                break
            for mark in marks:
                if mark in lexical_errors.CLOSER_OF:
                    open_brackets.append(mark)
                elif open_brackets:
                    open_brackets.pop()
                else:
                    closing.append(mark)
        return "".join(closing)

    # Strings.

    def open_string(self, start: int, end: int) -> int:
        text = self.text
        triple = text[end - 3 : end] in ('"""', "'''")
        if triple:
            return self.open_text(start, end)
        closing = self.closers(end, in_text=True)
        fields = len(self.fields)
        stop = super().open_string(start, end)
        if len(self.fields) < fields:
            return stop  # It was the end of an f-string around it.
        # The brackets around it were to be closed after it.
        if self.fields:
            if len(self.fields[-1].string.quote) == 1:
                self.leave(self.fields[-1].string)
        elif closing and self.wanted_closers().startswith(closing):
            del self.brackets[len(self.brackets) - len(closing) :]
        return stop

    def text_is_open(self, start: int, end: int) -> bool:
        """Return whether the quotes that end a text of several lines look like those that begin the next one."""
        text = self.text
        if text[end - 3 : end] not in ('"""', "'''"):
            return False
        if text[end].isalnum():
            return True
        line_start = text.rfind("\n", start, end) + 1
        if not line_start:
            return False  # Opened and closed on one line.
        before = text[line_start : end - 3].strip()
        return before[-1:] in ("=", "(", ",", "[") and _statement().match(before + "\n") is not None

    def is_code_again(self, line_start: int, first: int) -> bool:
        """Return whether a line in a text that is never closed looks like a statement that follows it."""
        text = self.text
        if not _statement().match(text, first):
            return False
        before = text[text.rfind("\n", 0, max(0, line_start - 1)) + 1 : max(0, line_start - 1)]
        return not before.strip() or _after_text().match(text, first) is not None

    def open_text(self, start: int, end: int) -> int:
        """Recover from a string that is not closed: continue at the next line that looks like a statement; ``end`` is after its quotes."""
        text = self.text
        quote = text[end - 3 : end]
        self.report(lexical_errors.open_string(quote, self.here(start, end)))
        column = self.indents[-1][0]
        line_end = text.index("\n", end)
        while line_end + 1 < len(text):
            match = lexemes.LINE_START.match(text, line_end + 1)
            first = match.end() if match else line_end + 1
            line_start = text.rfind("\n", line_end, first) + 1
            if first < len(text):
                if measure(text[line_start:first])[0] <= column and self.is_code_again(line_start, first):
                    break
                line_end = text.index("\n", first)
            else:
                line_end = len(text) - 1
        kinds = self.tokens.kinds
        if not kinds or kinds[-1] in (NEWLINE, INDENT, DEDENT):
            # A docstring: what follows it should not suffer for its quotes.
            self.add(STRING, start, line_end)
            self.tokens.texts[-1] = quote * 2
        else:
            self.add(ERROR, start, line_end)
        if "\n" in text[start:line_end]:
            self.lines_within(start, line_end)
        return line_end
