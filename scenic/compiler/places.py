"""Places of words that have no node of their own in the tree."""

import ast
import re
from typing import Final
from unicodedata import normalize

from scenic.language.source import Source
from scenic.language.spans import Span

__all__ = ["header_span", "word_span"]

_WORD: Final = re.compile(r"\w+")


def word_span(source: Source, node: ast.AST, word: str) -> Span:
    """The first place of ``word``, as a whole word, in the text of ``node``; else the beginning of the node.

    A name may be written in other characters that Python takes for the same (NFKC).
    """
    whole = source.span(node)
    lines = source.lines
    for line in range(whole.line, min(whole.end_line, len(lines)) + 1):
        text = lines[line - 1]
        start = whole.column if line == whole.line else 0
        end = whole.end_column if line == whole.end_line else len(text)
        column = _whole_word(text, word, start, end)
        if column >= 0:
            return Span(line, column, line, column + len(word))
        if not text.isascii():
            for each in _WORD.finditer(text, start, end):
                if normalize("NFKC", each[0]) == word:
                    return Span(line, each.start(), line, each.end())
    return header_span(source, node)


def _whole_word(text: str, word: str, start: int, end: int) -> int:
    """Return the column of a word in a stretch of a line, with no letter, digit or underscore beside it; -1 if absent."""
    found = text.find(word, start, end)
    while found >= 0:
        after = found + len(word)
        if not (found and _in_word(text[found - 1])) and not (after < end and _in_word(text[after])):
            return found
        found = text.find(word, found + 1, end)
    return -1


def _in_word(character: str) -> bool:
    return character.isalnum() or character == "_"


def header_span(source: Source, node: ast.AST) -> Span:
    """Return the first line of a node: the header of a block, all of a statement that fits on a line."""
    whole = source.span(node)
    if whole.end_line == whole.line:
        return whole
    lines = source.lines
    text = lines[whole.line - 1].rstrip() if whole.line <= len(lines) else ""
    return Span(whole.line, whole.column, whole.line, max(whole.column, len(text)))
