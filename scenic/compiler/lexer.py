"""From source text to tokens, as CPython 3.12 reads it.

One regular expression matches a token with the blanks before it, and the loop of `Lexer.run` sorts the
matches into parallel lists, which is what the parser reads fastest. Whatever is rare (indentation that
changes, f-strings, errors) is in the methods around it.

Nothing raises: what is wrong becomes a diagnostic, and an ``ERROR`` token where text had to be left out or
something is missing. Indentation is repaired instead, so that the blocks around a bad line stay whole.
"""

import unicodedata
from collections.abc import Callable, Mapping
from itertools import islice
from typing import ClassVar, Final, NamedTuple

from scenic.compiler import lexemes, lexical_errors
from scenic.compiler.text_lines import MOST_DIAGNOSTICS, LineReader, NestedTooDeeplyError
from scenic.compiler.tokens import (
    DEDENT,
    ENDMARKER,
    ERROR,
    FSTRING_END,
    FSTRING_MIDDLE,
    FSTRING_START,
    INDENT,
    NAME,
    NEWLINE,
    NUMBER,
    STRING,
    Tokens,
)
from scenic.dataclass import dataclass
from scenic.language.spans import Span

MOST_BRACKETS: Final = 200
"""The largest number of brackets within each other, as in CPython."""

_MOST_BRACKETS_SEARCHED: Final = 100
"""So far out an opening bracket is looked for when a closing one does not fit; keeps the time linear."""


def lex(text: str, words: Mapping[str, int]) -> Tokens:
    """Split ``text`` into tokens; ``words`` gives the kind of each keyword and operator. Never raises."""
    return prepared(text, words, Lexer)


def prepared(
    text: str, words: Mapping[str, int], lexer: "Callable[[str, Mapping[str, int]], Lexer]"
) -> Tokens:
    """Return the tokens that ``lexer`` reads from a text without its byte order mark, with uniform line ends."""
    text = text.lstrip("\ufeff")
    if "\r" in text:
        text = text.replace("\r\n", "\n").replace("\r", "\n")
    if text and not text.endswith("\n"):
        text += "\n"
    tokens = lexer(text, words).run()
    if not text.isascii():
        tokens.count_bytes()
    return tokens


class Bracket(NamedTuple):
    """An opening bracket that is not closed yet.

    ``closer`` is what closes it, or nothing if it opens a replacement field of an f-string, so that the
    loop leaves the end of the field to a method.
    """

    closer: str
    opener: str
    line: int
    column: int

    @property
    def span(self) -> Span:
        return Span(self.line, self.column, self.line, self.column + 1)


@dataclass(frozen=True, slots=True, eq=False)
class _FormattedString:
    """An f-string that is not closed yet."""

    quote: str
    raw: bool
    span: Span


@dataclass(frozen=True, slots=True)
class _Field:
    """A replacement field ``{...}`` that is being read: where it stands, and the brackets around it."""

    string: _FormattedString
    in_specification: bool
    outer_brackets: list[Bracket]


class Lexer(LineReader):
    """The state of one run.

    Places are offsets in the text. Methods that read on return where to; they may put other values into
    ``line_start`` and ``brackets``, which the loop keeps in variables and fetches again afterwards.
    ``brackets`` are those of the innermost replacement field, beginning with its own brace.
    """

    __slots__ = ("brackets", "fields", "words")

    tolerant: ClassVar[bool] = False
    """True if the methods that are called only then doubt what they read (see `scenic.compiler.tolerant_lexer`)."""

    def __init__(self, text: str, words: Mapping[str, int]) -> None:
        super().__init__(text)
        self.words = words
        self.brackets: list[Bracket] = []
        self.fields: list[_Field] = []

    def run(self) -> Tokens:
        """Tokenise the whole text."""
        try:
            pos: int | None = self.start_line(0)
            while pos is not None:
                pos = self.run_from(pos)
        except NestedTooDeeplyError as error:
            self.tokens.diagnostics[:] = [
                lexical_errors.nested_too_deeply(self.here(error.pos, error.pos + 1))
            ]
            self.brackets = []
            self.end(error.pos)
        return self.tokens

    def run_from(self, pos: int) -> int | None:
        """Tokenise from ``pos``; return the position to continue from after a leap, ``None`` at the end.

        Iterating over the matches is nearly twice as fast as asking for each, but cannot leap.
        """
        text, words, tokens, brackets, fields = self.text, self.words, self.tokens, self.brackets, self.fields
        kinds, texts, columns, end_columns = tokens.kinds, tokens.texts, tokens.columns, tokens.end_columns
        add_kind, add_text = kinds.append, texts.append
        add_column, add_end_column = columns.append, end_columns.append
        kind_of, name_kind, tolerant = words.get, NAME, self.tolerant
        closers = lexical_errors.CLOSER_OF
        line_start = self.line_start
        for match in lexemes.TOKEN.finditer(text, pos):
            group = match.lastindex or 0
            start, end = match.span(group)
            if group == 1:  # WORD
                word = text[start:end]
                kind = kind_of(word, name_kind)
            elif group == 2:  # OPENER
                word = text[start]
                kind = words[word]
                if len(brackets) == MOST_BRACKETS:
                    raise NestedTooDeeplyError(start)
                brackets.append(Bracket(closers[word], word, self.line, start - line_start))
            elif group == 3:  # CLOSER
                word = text[start]
                if not (brackets and brackets[-1][0] == word):
                    return self.odd_closer(start)
                brackets.pop()
                kind = words[word]
            elif group == 4:  # LINE_END
                if brackets:
                    leap = self.line_end_in_brackets(start, end)
                    if leap is not None:
                        return leap
                    line_start = self.line_start
                else:
                    self.line_end(start, end)
                    line_start = self.line_start
                    if text[line_start:end] != self.white or tolerant:
                        return self.start_line(line_start)
                continue
            elif group == 5:  # COLON, and an exclamation mark
                if fields and len(brackets) == 1:
                    return self.in_field(start)
                word = text[start:end]
                if word == "!":
                    return self.stray(start)
                kind = words[word]
            elif group == 6:  # NUMERAL
                word = text[start:end]
                if word[0] == "0" and lexemes.LEADING_ZERO.fullmatch(word):
                    self.bad_number(start, end, word)
                    continue
                kind = NUMBER
            elif group == 7:  # TEXT
                if tolerant and self.text_is_open(start, end):
                    prefix = len(text[start:end]) - len(text[start:end].lstrip("bBrRuU"))
                    return self.open_text(start, start + prefix + 3)
                self.add(STRING, start, end)
                if "\n" in text[start:end]:
                    self.lines_within(start, end)
                    line_start = self.line_start
                continue
            elif group == 8:  # COMMENT
                tokens.comments.append((self.line, start - line_start, text[start:end]))
                continue
            elif group == lexemes.END:
                self.end(start)
                return None
            else:
                return self.rare(group, start, end)
            add_kind(kind)
            add_text(word)
            add_column(start - line_start)
            add_end_column(end - line_start)
        raise AssertionError("the last match is that of the end")

    def line_end(self, start: int, end: int) -> None:
        """Add the end of a statement's line."""
        self.add(NEWLINE, start, start + 1)
        self.tokens.texts[-1] = ""
        self.next_lines(start, end)

    def line_end_in_brackets(self, start: int, end: int) -> int | None:
        """Go on to the next line; returns where to read on if that is not the next character."""
        self.next_lines(start, end)
        if lexemes.STATEMENT_WORD.match(self.text, end):
            self.never_closed(start)
            return self.start_line(self.line_start)
        return self.line_in_brackets(start, end) if self.tolerant else None

    def end(self, pos: int) -> None:
        """Close what is open, and fill the lists that hold the same for nearly every token."""
        tokens = self.tokens
        if self.brackets:
            self.never_closed(pos)
        elif tokens.kinds and tokens.kinds[-1] not in (NEWLINE, INDENT, DEDENT):
            self.add_empty(NEWLINE, pos)
        while len(self.indents) > 1:
            self.close_level(pos)
        self.add_empty(ENDMARKER, pos)
        self.fill_lines()
        tokens.end_lines = tokens.lines.copy()
        for index, line in self.multiline:
            tokens.end_lines[index] = line
        room = MOST_DIAGNOSTICS - len(tokens.diagnostics)
        tokens.diagnostics += islice(lexical_errors.unreadable(self.text), room)

    # Brackets.

    def never_closed(self, pos: int) -> None:
        """The statement ends although a bracket is open; ``pos`` is the end of a line, or of the text."""
        tokens = self.tokens
        opener = self.brackets[-1]
        is_field = not opener.closer
        self.fields.clear()
        self.brackets = []
        self.fill_lines()
        index = len(tokens.kinds) - 1
        # The last token may be a string of several lines.
        several = self.multiline and self.multiline[-1][0] == index
        last = (self.multiline[-1][1] if several else tokens.lines[index], tokens.end_columns[index])
        end_of_statement = Span(*last, *last)
        self.report(
            lexical_errors.never_closed(
                opener.opener, opener.span, is_field=is_field, noticed=end_of_statement
            )
        )
        # The tokens stand at the line end, and the present line may be a later one.
        line, line_start = self.line, self.line_start
        if pos < line_start:
            line -= self.text.count("\n", pos, line_start)
            line_start = self.text.rfind("\n", 0, pos) + 1
        column = pos - line_start
        tokens.kinds += (ERROR, NEWLINE)
        tokens.texts += ("", "")
        tokens.lines += (line, line)
        tokens.columns += (column, column)
        tokens.end_columns += (column, column + (pos < len(self.text)))

    def odd_closer(self, start: int) -> int:
        """Read a closing bracket that ends a replacement field, or does not fit."""
        closer = self.text[start]
        opener = lexical_errors.OPENER_OF[closer]
        brackets, span = self.brackets, self.here(start, start + 1)
        if closer == "}" and self.fields and len(brackets) == 1:
            self.add(self.words["}"], start, start + 1)
            return self.end_field(start + 1)
        self.add(ERROR, start, start + 1)
        if not brackets:
            self.report(lexical_errors.needless_closer(closer, span))
            return start + 1
        innermost = brackets[-1]
        self.report(lexical_errors.wrong_closer(closer, span, innermost.opener, innermost.span))
        # If it fits an opener further out, those inside that one were left open.
        if any(bracket.opener == opener for bracket in brackets[-_MOST_BRACKETS_SEARCHED:]):
            while brackets[-1].opener != opener:
                brackets.pop()
            if not brackets[-1].closer:
                return self.end_field(start + 1)
            brackets.pop()
        return start + 1

    def line_in_brackets(self, start: int, end: int) -> int | None:
        """Return the position from which to continue if the line with its first token at ``end`` does not
        belong to the open brackets; ``None`` if it does.
        """
        return None

    # Strings.

    def text_is_open(self, start: int, end: int) -> bool:
        """Return whether a string that is closed only seems to be."""
        return False

    def open_text(self, start: int, end: int) -> int:
        """Go on after a string of several lines that is not closed; ``end`` is after its quotes."""
        return end

    # f-strings.

    def in_field(self, start: int) -> int:
        """Read ``:`` or ``!`` directly inside a replacement field."""
        mark = self.text[start]
        self.add(self.words.get(mark, ERROR), start, start + 1)
        if mark == "!":
            return start + 1
        return self.literal(self.fields[-1].string, start + 1, in_specification=True)

    def end_field(self, pos: int) -> int:
        """Read on after the brace that ends the innermost replacement field."""
        ended = self.fields.pop()
        self.brackets = ended.outer_brackets
        return self.literal(ended.string, pos, in_specification=ended.in_specification)

    def literal(self, string: _FormattedString, pos: int, *, in_specification: bool) -> int:
        """Read an f-string from ``pos``, in its text, to the next replacement field or to its end."""
        text, quote = self.text, string.quote
        while True:
            pattern = lexemes.literal(quote, specification=in_specification, raw=string.raw)
            match = pattern.match(text, pos)
            start, pos = match.span() if match else (pos, pos)
            if pos == len(text) and text.endswith("\n", start, pos):
                # It is never closed, and the last line end may not be in the source.
                pos -= 1
            if pos > start:
                self.add(FSTRING_MIDDLE, start, pos)
                middle = self.tokens.texts[-1]
                if not in_specification and ("{{" in middle or "}}" in middle):
                    self.tokens.texts[-1] = middle.replace("{{", "{").replace("}}", "}")
                if "\n" in middle:
                    self.lines_within(start, pos)
            if text.startswith("{", pos):
                self.fields.append(_Field(string, in_specification, self.brackets))
                self.brackets = [Bracket("", "{", self.line, pos - self.line_start)]
                self.add(self.words["{"], pos, pos + 1)
                return pos + 1
            if text.startswith("}", pos):
                if in_specification:
                    self.add(self.words["}"], pos, pos + 1)
                    field = self.fields.pop()
                    self.brackets = field.outer_brackets
                    in_specification = field.in_specification
                else:
                    self.report(lexical_errors.single_brace(self.here(pos, pos + 1)))
                    self.add(ERROR, pos, pos + 1)
                pos += 1
            elif not text.startswith(quote, pos):
                # The end of the line or of the text.
                self.report(lexical_errors.open_string(quote, string.span))
                self.add_empty(ERROR, pos)
                self.leave(string)
                return pos
            elif in_specification:
                return self.close_early(pos)
            else:
                self.add(FSTRING_END, pos, pos + len(quote))
                return pos + len(quote)

    def close_early(self, pos: int) -> int:
        """The quote of the innermost open f-string stands at ``pos`` while a field of it is still open."""
        string, innermost = self.fields[-1].string, self.brackets[-1]
        end = pos + len(string.quote)
        self.report(lexical_errors.closed_early(self.here(pos, end), innermost.opener, innermost.span))
        self.add(ERROR, pos, end)
        self.leave(string)
        return end

    def leave(self, string: _FormattedString) -> None:
        """Forget the open fields of ``string``."""
        while self.fields and self.fields[-1].string is string:
            self.brackets = self.fields.pop().outer_brackets

    # What is rare.

    def rare(self, group: int, start: int, end: int) -> int:
        """A match that the loop does not treat itself."""
        text = self.text
        if group == lexemes.FORMATTED:
            quote = text[start:end].lstrip("fFrR")
            raw = "r" in text[start : end - len(quote)].lower()
            self.add(FSTRING_START, start, end)
            string = _FormattedString(quote, raw, self.here(start, end))
            return self.literal(string, end, in_specification=False)
        if group == lexemes.ODD_WORD:
            self.odd_word(start, end)
            return end
        if group == lexemes.CONTINUATION:
            kinds = self.tokens.kinds
            if not self.brackets and (not kinds or kinds[-1] == NEWLINE):
                return self.continued_indentation(self.line_start)
            self.next_line(end)
            if end == len(text):
                self.continuation_at_end(end)
            return end
        if group == lexemes.OPEN_TEXT:
            return self.open_string(start, end)
        if group == lexemes.ODD_NUMERAL:
            return self.odd_number(start)
        return self.stray(start)

    def odd_word(self, start: int, end: int) -> None:
        """A name with characters beyond ASCII, or a word before a quote that is not a prefix of the string."""
        name = self.text[start:end]
        if name.isascii():
            self.add(self.words.get(name, NAME), start, end)
        elif name.isidentifier():
            # No keyword, whatever it is normalised to.
            self.add(NAME, start, end)
            self.tokens.texts[-1] = unicodedata.normalize("NFKC", name)
        else:
            offset = 0
            if name[0].isidentifier():
                offset = next(index for index, part in enumerate(name) if not f"_{part}".isidentifier())
            self.invalid_character(start + offset)
            self.add(ERROR, start, end)

    def open_string(self, start: int, end: int) -> int:
        """Read a string that is not closed; ``end`` is after the quote that opens it."""
        text = self.text
        quote = text[start:end].lstrip("bBrRuU")
        if self.fields and self.fields[-1].string.quote == quote and end - start == len(quote):
            # Rather than to open a string, this quote was to end the f-string around it.
            return self.close_early(start)
        self.report(lexical_errors.open_string(quote, self.here(start, end)))
        rest = lexemes.OPEN_STRING.match(text, end)
        # The last line end may not be in the source, and ends the statement.
        stop = max(end, len(text) - 1) if len(quote) == 3 or rest is None else rest.end()
        self.add(ERROR, start, stop)
        if "\n" in text[start:stop]:
            self.lines_within(start, stop)
        return stop

    def odd_number(self, start: int) -> int:
        """A number that touches a word."""
        text = self.text
        number = lexemes.NUMBER.match(text, start)
        valid = "" if number is None else number[0]
        end = start + len(valid)
        if valid and lexemes.WORD_AFTER_NUMBER.match(text, end) and not lexemes.LEADING_ZERO.fullmatch(valid):
            self.add(NUMBER, start, end)
            return end
        rest = lexemes.BAD_NUMBER.match(text, end)
        end = max(end if rest is None else rest.end(), start + 1)
        self.bad_number(start, end, valid)
        return end

    def bad_number(self, start: int, end: int, number: str) -> None:
        """Report that ``text[start:end]`` is not a number, although its beginning ``number`` may be one."""
        self.report(lexical_errors.bad_number(self.text[start:end], number, self.here(start, end)))
        self.add(ERROR, start, end)

    def stray(self, start: int) -> int:
        """Read a character that starts no token."""
        text = self.text
        if text[start] != "\\":
            match = lexemes.STRAY_RUN.match(text, start)
            end = start + 1 if match is None else match.end()
            self.invalid_character(start)
            self.add(ERROR, start, end)
            return end
        match = lexemes.BACKSLASHES.match(text, start)
        start_of_rest, end_of_rest = match.span(1) if match else (-1, -1)
        if start_of_rest >= 0:
            # Only blanks between a backslash and the line end: what was meant is clear.
            self.report(lexical_errors.after_continuation(self.here(start, end_of_rest - 1), blank=True))
            self.add(ERROR, start, start_of_rest)
            self.next_line(end_of_rest)
            return end_of_rest
        end = start + 1 if match is None else match.end()
        self.report(lexical_errors.after_continuation(self.here(start, end), blank=False))
        self.add(ERROR, start, end)
        return end

    def invalid_character(self, pos: int) -> None:
        character = self.text[pos]
        # Null characters and surrogates are reported together at the end.
        if lexemes.UNREADABLE.match(character) is None:
            self.report(lexical_errors.invalid_character(character, self.here(pos, pos + 1)))
