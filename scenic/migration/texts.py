r"""Texts under conversion: tokens with their offsets, and edits.

All texts here have ``\n`` at each line end and no byte order mark; `restored` brings both back.
"""

import difflib
import re
from collections.abc import Iterable
from typing import Final, NamedTuple

from scenic.compiler._generated.tables import WORDS
from scenic.compiler.lexer import lex
from scenic.compiler.tokens import DEDENT, ENDMARKER, INDENT, NEWLINE
from scenic.language.source import Source

__all__ = ["TextEdit", "Token", "edited", "first_of_line", "restored", "tokens_of"]

_LINE: Final = re.compile(r"[^\r\n]*(?:\r\n|\r|\n)|[^\r\n]+")
_LAYOUT: Final = frozenset({NEWLINE, INDENT, DEDENT})


class Token(NamedTuple):
    """A token; ``start`` and ``end`` are offsets in characters, ``line`` counts from 1."""

    kind: int
    text: str
    start: int
    end: int
    line: int

    @property
    def is_layout(self) -> bool:
        """Return whether it has no text: a line end, or a change of indentation."""
        return self.kind in _LAYOUT or self.kind == ENDMARKER


class TextEdit(NamedTuple):
    """The replacement of a part of a text."""

    start: int
    end: int
    text: str


def tokens_of(source: Source) -> list[Token]:
    """Return the tokens of a text, without comments."""
    tokens = lex(source.text, WORDS)
    starts = line_starts(source)
    last = len(source.lines)

    def offset(line: int, byte: int) -> int:
        return len(source.text) if line > last else starts[line - 1] + source.character(line, byte)

    return [
        Token(kind, text, offset(line, column), offset(end_line, end_column), line)
        for kind, text, line, column, end_line, end_column in zip(
            tokens.kinds,
            tokens.texts,
            tokens.lines,
            tokens.columns,
            tokens.end_lines,
            tokens.end_columns,
            strict=True,
        )
    ]


def line_starts(source: Source) -> list[int]:
    """The offset at which each line begins."""
    starts = [0]
    for line in source.lines:
        starts.append(starts[-1] + len(line) + 1)
    return starts


def first_of_line(tokens: list[Token], index: int) -> int:
    """Return the index of the first token of the logical line that contains a token."""
    while index > 0 and not tokens[index - 1].is_layout:
        index -= 1
    return index


def edited(text: str, edits: Iterable[TextEdit]) -> str:
    """Return the text with all edits, which must not overlap; insertions at one place are made in the order given."""
    pieces: list[str] = []
    position = 0
    for edit in sorted(edits, key=lambda each: (each.start, each.end)):
        pieces += (text[position : edit.start], edit.text)
        position = max(position, edit.end)
    return "".join((*pieces, text[position:]))


def restored(result: str, original: str) -> str:
    """A result with the byte order mark and the line ends of the text that it was made from.

    Lines that are new get the end of the line before them.
    """
    if "\r" in original:
        lines = _LINE.findall(original.lstrip("\ufeff"))
        before = [re.sub(r"[\r\n]+$", "\n", line) for line in lines]
        ends = [line[len(line.rstrip("\r\n")) :] for line in lines]
        after = result.splitlines(keepends=True) if result.isascii() else _LINE.findall(result)
        pieces: list[str] = []
        for _, start, end, new_start, new_end in difflib.SequenceMatcher(
            None, before, after, autojunk=False
        ).get_opcodes():
            for place in range(new_start, new_end):
                of = min(start + place - new_start, max(start, end - 1), len(ends) - 1)
                line = after[place]
                line_end = ends[of] or ends[max(0, of - 1)]
                pieces.append(line[:-1] + line_end if line.endswith("\n") else line)
        result = "".join(pieces)
    return "\ufeff" * original.startswith("\ufeff") + result
