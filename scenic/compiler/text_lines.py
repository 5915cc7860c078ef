"""The lines of a text: where they start, how deep they are indented, and the tokens that this makes."""

from typing import Final

from scenic.compiler import lexemes, lexical_errors
from scenic.compiler.tokens import DEDENT, ERROR, INDENT, Tokens
from scenic.language.diagnostics import Diagnostic
from scenic.language.spans import Span

MOST_DIAGNOSTICS: Final = 1000
"""So many are reported of one text; a file of random bytes has no use for millions."""

MOST_INDENTS: Final = 100
"""The largest number of levels of indentation, with that of the module, as in CPython."""

_TAB: Final = 8
_WHITE: Final = " \t\f"


class NestedTooDeeplyError(Exception):
    """Brackets or blocks are nested too deeply at ``pos``."""

    def __init__(self, pos: int) -> None:
        super().__init__(pos)
        self.pos = pos


class LineReader:
    """The part of the lexer that knows where it is: the present line, and the blocks around it.

    Places are offsets in the text. Methods that read on return where to.
    """

    __slots__ = ("indents", "line", "line_start", "multiline", "text", "tokens", "white")

    def __init__(self, text: str) -> None:
        self.text = text
        self.tokens = Tokens(text)
        self.line = 1
        self.line_start = 0
        # The open blocks: width of their indentation, with tabs of eight and with tabs of one.
        self.indents = [(0, 0)]
        # The indentation of the innermost block as written: nearly every line has the same.
        self.white = ""
        # Tokens that end on another line than they start, which is rare: index, and line of the end.
        self.multiline: list[tuple[int, int]] = []

    # Adding tokens.

    def add(self, kind: int, start: int, end: int) -> None:
        """Add the token of ``text[start:end]``, which starts on the present line."""
        tokens = self.tokens
        tokens.kinds.append(kind)
        tokens.texts.append(self.text[start:end])
        tokens.columns.append(start - self.line_start)
        tokens.end_columns.append(end - self.line_start)

    def add_empty(self, kind: int, pos: int) -> None:
        """Add a token without text."""
        self.add(kind, pos, pos)

    def fill_lines(self) -> None:
        """Note the line of all tokens added since the last call, which is the present one."""
        lines = self.tokens.lines
        lines.extend([self.line] * (len(self.tokens.kinds) - len(lines)))

    def next_line(self, line_start: int) -> None:
        """Go on to the line after the present one."""
        self.fill_lines()
        self.line += 1
        self.line_start = line_start

    def next_lines(self, start: int, end: int) -> None:
        """Go on from a line end at ``start``, over empty lines, to the line with ``end`` in it."""
        text = self.text
        self.fill_lines()
        line_start = text.rfind("\n", start, end) + 1
        if line_start == start + 1:
            self.line += 1
        else:
            if text.find("#", start, line_start) >= 0:
                self.comment_lines(start + 1, line_start, self.line + 1)
            self.line += text.count("\n", start, line_start)
        self.line_start = line_start

    def lines_within(self, start: int, end: int) -> None:
        """Advance to the last line of the token added last, which extends from ``start`` to ``end`` over line ends."""
        tokens = self.tokens
        self.fill_lines()
        self.line += self.text.count("\n", start, end)
        self.line_start = self.text.rfind("\n", start, end) + 1
        self.multiline.append((len(tokens.kinds) - 1, self.line))
        tokens.end_columns[-1] = end - self.line_start

    def report(self, diagnostic: Diagnostic) -> None:
        if len(self.tokens.diagnostics) < MOST_DIAGNOSTICS:
            self.tokens.diagnostics.append(diagnostic)

    def here(self, start: int, end: int) -> Span:
        """Return the span of ``text[start:end]``, which lies on the present line."""
        return Span(self.line, start - self.line_start, self.line, end - self.line_start)

    # Lines and indentation.

    def start_line(self, pos: int) -> int:
        """Go from the start of a line over empty lines and comments to the next token; indent and dedent."""
        text = self.text
        match = lexemes.LINE_START.match(text, pos)
        start, end = match.span(1) if match else (pos, pos)
        if start != pos:
            self.comment_lines(pos, start, self.line)
            self.line += text.count("\n", pos, start)
            self.line_start = start
        if end == len(text):
            return end
        if text[end] == "\\":
            return self.continued_indentation(start)
        white = text[start:end]
        if white != self.white:
            self.indent(*measure(white), white, end)
        return end

    def comment_lines(self, start: int, end: int, line: int) -> None:
        """Collect the comments of lines that hold nothing else; ``start`` is on ``line``."""
        text = self.text
        for found in lexemes.COMMENT_LINE.finditer(text, start, end):
            line += text.count("\n", start, found.start())
            start = found.start()
            self.tokens.comments.append((line, found.start(1) - start, found[1]))

    def indent(self, column: int, strict_column: int, white: str, end: int) -> None:
        """Compare the indentation of a line with the blocks around it; its first token is at ``end``.

        ``column`` counts a tab to the next multiple of eight, ``strict_column`` as one: indentation must
        not depend on the width of a tab, so both have to agree on what is deeper.
        """
        indents = self.indents
        self.white = white
        top, strict_top = indents[-1]
        if column > top:
            is_ambiguous = strict_column <= strict_top
            if len(indents) == MOST_INDENTS:
                raise NestedTooDeeplyError(end)
            indents.append((column, strict_column))
            self.add(INDENT, self.line_start, end)
        else:
            while column < indents[-1][0]:
                if column > indents[-2][0]:
                    # Between two levels: take the line for one of the inner block.
                    self.report(lexical_errors.unmatched_unindent(self.here(self.line_start, end)))
                    indents[-1] = (column, strict_column)
                    return
                self.close_level(end)
            is_ambiguous = strict_column != indents[-1][1]
        if is_ambiguous:
            self.report(lexical_errors.mixed_indentation(self.here(self.line_start, end)))

    def close_level(self, end: int) -> None:
        """Close the innermost block before the token at ``end``."""
        self.indents.pop()
        self.add_empty(DEDENT, end)

    def continued_indentation(self, start: int) -> int:
        """Read the indentation of a line that starts with a backslash: the blanks before the first backslash."""
        text = self.text
        column = strict_column = first = 0
        pos = start
        while pos < len(text):
            character = text[pos]
            if character in _WHITE:
                column, strict_column = _after(character, column, strict_column)
            elif text.startswith("\\\n", pos):
                first = first or column
                pos += 1
                self.next_line(pos + 1)
            else:
                break
            pos += 1
        if pos == len(text):
            self.continuation_at_end(pos)
            return pos
        if text[pos] in "#\n":
            line_end = text.index("\n", pos)
            if line_end != pos:
                self.tokens.comments.append((self.line, pos - self.line_start, text[pos:line_end]))
            self.next_line(line_end + 1)
            return self.start_line(line_end + 1)
        # No line has a backslash among its blanks, so that the next one is measured again.
        self.indent(first or column, first or strict_column, "\\", pos)
        return pos

    def continuation_at_end(self, end: int) -> None:
        """The text ends with a backslash and a line end."""
        line, column = self.line - 1, end - 2 - (self.text.rfind("\n", 0, end - 1) + 1)
        self.report(lexical_errors.continuation_at_end(Span(line, column, line, column + 1)))
        self.fill_lines()
        tokens = self.tokens
        tokens.kinds.append(ERROR)
        tokens.texts.append("\\")
        tokens.lines.append(line)
        tokens.columns.append(column)
        tokens.end_columns.append(column + 1)


def measure(white: str) -> tuple[int, int]:
    """Return the width of an indentation with tabs to the next multiple of eight, and with tabs of one."""
    if not white.strip(" "):
        return len(white), len(white)
    column = strict_column = 0
    for character in white:
        column, strict_column = _after(character, column, strict_column)
    return column, strict_column


def _after(character: str, column: int, strict_column: int) -> tuple[int, int]:
    """Return the two widths after one more blank."""
    if character == "\f":  # starts the line again
        return 0, 0
    return (column + 1 if character == " " else (column // _TAB + 1) * _TAB), strict_column + 1
