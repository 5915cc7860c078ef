"""The parts of its spelling that a formatted statement keeps: numbers, and parentheses that group operands.

The unparser writes values and the parentheses that precedence asks for. Its tokens are laid beside those of the text; where the
two differ in another way than in numbers, quotes and parentheses, the unparser's text stays as it is.
"""

from collections.abc import Iterator, Sequence
from typing import Final, NamedTuple

from scenic.compiler.generated import HARD_KEYWORDS, OPERATORS, WORDS
from scenic.compiler.lexer import lex
from scenic.compiler.tokens import (
    ENDMARKER,
    FSTRING_END,
    FSTRING_MIDDLE,
    FSTRING_START,
    NAME,
    NEWLINE,
    NUMBER,
    STRING,
)
from scenic.dataclass import dataclass

__all__ = ["Token", "as_written"]

_QUOTED: Final = frozenset({STRING, FSTRING_START, FSTRING_MIDDLE, FSTRING_END})
_MARKS: Final = frozenset({"(", ")", "[", "]", "{", "}", ",", ":", ";", ".", "=", "->", ":=", "@"})
_OPERATORS: Final = frozenset(OPERATORS).difference(_MARKS) | {"and", "or", "not", "in", "is"}
_VALUES: Final = frozenset({"None", "True", "False", "self"})


class Token(NamedTuple):
    """A token: kind and text."""

    kind: int
    text: str


@dataclass(slots=True)
class _Pair:
    """Parentheses of the text that the unparser has left out: their tokens, and their places in the new text."""

    opening: int
    start: int
    closing: int = -1
    end: int = -1


def as_written(old: Sequence[Token], text: str) -> str:
    """One line that the unparser has written, with the numbers and the grouping of the tokens that it comes from."""
    if _bare("".join(token.text for token in old)) == _bare(text):
        return text
    tokens = lex(text, WORDS)
    new = [
        (Token(kind, word), begin, end)
        for kind, word, begin, end in zip(
            tokens.kinds, tokens.texts, tokens.columns, tokens.end_columns, strict=True
        )
        if kind not in (NEWLINE, ENDMARKER)
    ]
    edits = _edits(old, new) if text.isascii() else None
    for start, end, written in sorted(edits or (), reverse=True):
        text = text[:start] + written + text[end:]
    return text


def _bare(text: str) -> str:
    return text.replace(" ", "").rstrip(":;")


def _edits(old: Sequence[Token], new: Sequence[tuple[Token, int, int]]) -> list[tuple[int, int, str]] | None:
    """Replacements in the new text; ``None`` if it differs in another way."""
    edits: list[tuple[int, int, str]] = []
    brackets: list[_Pair | None] = []
    left_out: list[_Pair] = []
    at = 0
    for index, token in enumerate(old):
        wanted, start, end = new[at] if at < len(new) else (Token(ENDMARKER, ""), -1, -1)
        same = token.text == wanted.text or (token.kind in _QUOTED and wanted.kind == token.kind)
        if token.text == ")" and brackets and brackets[-1] is not None:
            pair = brackets.pop()
            assert pair is not None
            pair.closing, pair.end = index, new[at - 1][2] if at else 0
            left_out.append(pair)
        elif same or (token.text == "elif" and wanted.text == "if" and not at):
            if token.text == "(":
                brackets.append(None)
            elif token.text == ")" and brackets:
                brackets.pop()
            at += 1
        elif token.kind == NUMBER and wanted.kind == NUMBER:
            edits.append((start, end, token.text))
            at += 1
        elif token.text == "(" and start >= 0:
            brackets.append(_Pair(index, start))
        elif not (token.text in (";", ":") and at == len(new)):
            return None
    if at != len(new):
        return None
    for pair in left_out:
        if _groups(old, pair):
            edits += [(pair.start, pair.start, "("), (pair.end, pair.end, ")")]
    return edits


def _groups(old: Sequence[Token], pair: _Pair) -> bool:
    """Return whether parentheses show what an operator takes: an operation in them, and an operator beside them."""
    around = [old[index] for index in (pair.opening - 1, pair.closing + 1) if 0 <= index < len(old)]
    return any(map(_is_operator, around)) and any(
        map(_is_operator, _at_top(old[pair.opening + 1 : pair.closing]))
    )


def _at_top(tokens: Sequence[Token]) -> Iterator[Token]:
    """The tokens that are in no further brackets."""
    depth = 0
    for token in tokens:
        depth -= token.text in (")", "]", "}")
        if not depth:
            yield token
        depth += token.text in ("(", "[", "{")


def _is_operator(token: Token) -> bool:
    if token.text in _OPERATORS:
        return True
    # Words of operators, such as `deg` and `relative`, have kinds of their own.
    is_word = token.kind > NAME and token.text.isidentifier()
    return is_word and token.text not in HARD_KEYWORDS and token.text not in _VALUES
