"""Turns the tokens of a sentence into text: spaces, line ends, indentation, comments."""

import random
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Final

from fuzz.terminals import CLOSERS, OPENERS, Piece, Shape

__all__ = ["lay_out"]

_BEFORE_BRACKETS: Final = frozenset(
    [
        "and",
        "as",
        "assert",
        "at",
        "await",
        "by",
        "case",
        "do",
        "elif",
        "else",
        "except",
        "for",
        "from",
        "if",
        "in",
        "is",
        "lambda",
        "new",
        "not",
        "of",
        "on",
        "or",
        "raise",
        "require",
        "return",
        "to",
        "until",
        "while",
        "with",
        "yield",
        "import",
        "del",
        "match",
    ]
)
_GLUED: Final = frozenset({Shape.FORMATTED_TEXT, Shape.FORMATTED_END, Shape.FIELD_OPEN, Shape.FIELD_MARK})
_GLUING: Final = frozenset(
    {Shape.FORMATTED_START, Shape.FORMATTED_TEXT, Shape.FIELD_CLOSE, Shape.FIELD_MARK, Shape.FIELD_OPEN}
)
_WORDLIKE: Final = frozenset({Shape.WORD, Shape.NUMBER, Shape.STRING, Shape.FORMATTED_START})


@dataclass(frozen=True, slots=True)
class _Style:
    """Probabilities of the ways to lay out a text, and the characters for them."""

    indent: str = "    "
    line_end: str = "\n"
    tight: float = 0.0
    wide: float = 0.0
    comment: float = 0.0
    blank: float = 0.0
    broken: float = 0.0
    continued: float = 0.0
    final_line_end: bool = True


def _style(choice: random.Random) -> _Style:
    if choice.random() < 0.5:
        return _Style()
    rare = (0.0, 0.0, 0.0, 0.1, 0.4)
    return _Style(
        indent=choice.choice(("    ", "  ", " ", "\t", " \t")),
        line_end=choice.choice(("\n", "\n", "\n", "\r\n", "\r")),
        tight=choice.choice((0.0, 0.0, 0.5, 1.0)),
        wide=choice.choice(rare),
        comment=choice.choice(rare),
        blank=choice.choice(rare),
        broken=choice.choice(rare),
        continued=choice.choice(rare),
        final_line_end=choice.random() < 0.9,
    )


def lay_out(pieces: Sequence[Piece], *, seed: int = 0) -> str:
    """Write a row of tokens as text. Seed 0 gives plain text; others vary all that has no meaning."""
    choice = random.Random(seed)
    style = _style(choice) if seed else _Style()
    writer = _Writer(style, choice)
    for piece in pieces:
        writer.write(piece)
    text = "".join(writer.parts)
    if not style.final_line_end:
        text = text.removesuffix("\n")
    return text if style.line_end == "\n" else text.replace("\n", style.line_end)


class _Writer:
    """The text so far, and what the place at its end is."""

    def __init__(self, style: _Style, choice: random.Random) -> None:
        self.parts: list[str] = []
        self.style = style
        self.choice = choice
        self.depth = 0
        self.brackets = 0
        self.strings = 0
        self.before: Piece | None = None

    def write(self, piece: Piece) -> None:
        match piece.shape:
            case Shape.NEWLINE:
                if self.happens(self.style.comment):
                    self.parts.append("  # comment")
                self.parts.append("\n")
                self.before = None
            case Shape.INDENT:
                self.depth += 1
            case Shape.DEDENT:
                self.depth -= 1
            case shape:
                self.parts.append(
                    self.start_of_line() if self.before is None else self.between(self.before, piece)
                )
                self.parts.append(piece.text)
                self.before = piece
                if shape is Shape.FORMATTED_START:
                    self.strings += 1
                elif shape is Shape.FORMATTED_END:
                    self.strings -= 1
                elif shape is Shape.OPERATOR and piece.text in OPENERS:
                    self.brackets += 1
                elif shape is Shape.OPERATOR and piece.text in CLOSERS:
                    self.brackets -= 1

    def happens(self, probability: float) -> bool:
        return probability > 0 and self.choice.random() < probability

    def start_of_line(self) -> str:
        indentation = self.style.indent * self.depth
        if self.happens(self.style.blank):
            line = self.choice.choice(("", " ", "# comment", "        # comment", "\f"))
            return f"{line}\n{indentation}"
        return indentation

    def between(self, left: Piece, right: Piece) -> str:
        """Return the text between two tokens of one line."""
        if right.shape in _GLUED or left.shape in _GLUING:
            # Two braces would be one; otherwise nothing may stand beside the text of an f-string.
            return " " if left.shape is Shape.FIELD_OPEN and right.text.startswith("{") else ""
        space = "" if self.may_touch(left, right) and self.touches(left, right) else " "
        if self.strings:
            return space
        style = self.style
        if self.happens(style.wide):
            space += self.choice.choice((" ", "  ", "\t", "\f"))
        if self.brackets and self.happens(style.broken):
            comment = "  # comment" if self.happens(style.comment) else ""
            return f"{comment}\n{' ' * self.choice.randrange(6)}"
        if self.happens(style.continued):
            return f" \\\n{' ' * self.choice.randrange(6)}"
        return space

    @staticmethod
    def may_touch(left: Piece, right: Piece) -> bool:
        """Return whether two tokens remain two without a blank between them."""
        if left.text in OPENERS or right.text in CLOSERS or left.text == "," or right.text in (",", ";"):
            return True
        if left.shape is Shape.NUMBER and (right.shape in _WORDLIKE or right.text.startswith(".")):
            return False
        left_wordlike = left.shape in _WORDLIKE or left.shape is Shape.FORMATTED_END
        right_wordlike = right.shape in _WORDLIKE
        if left_wordlike and right_wordlike:
            return False
        if not left_wordlike and not right_wordlike:
            return left.text in CLOSERS or right.text in OPENERS
        return not (left.text.startswith(".") and right.shape is Shape.NUMBER)

    def touches(self, left: Piece, right: Piece) -> bool:
        """Return whether two tokens that may touch do so: as people write them, or as tightly as possible."""
        if self.happens(self.style.tight):
            return True
        if left.text in OPENERS or right.text in CLOSERS or right.text in (",", ";", ":"):
            return True
        if right.text in ("(", "["):
            return left.text not in _BEFORE_BRACKETS and (
                left.shape is not Shape.OPERATOR or left.text in CLOSERS
            )
        if left.text == "." or right.text == ".":
            return right.text not in ("import", "from") and left.text not in ("import", "from")
        return left.text == "~"
