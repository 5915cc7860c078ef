"""The tokens that sentences are made of: what they look like, by kind.

Each kind has a row of examples, the simplest first, because shrinking goes to the first.
"""

from collections.abc import Mapping
from enum import Enum, auto
from typing import Final, NamedTuple

from scenic.compiler import syntax
from scenic.compiler.phrases import SCENIC_FORMS
from scenic.compiler.precedence import Ladder, Slot, Word
from scenic.compiler.syntax import STATEMENT_FORMS

__all__ = ["CLOSERS", "FIXED", "NAMES_WITHOUT", "OPENERS", "ROWS", "Piece", "Shape"]


class Shape(Enum):
    """The shape of a token, which decides its layout beside other tokens; see `fuzz.layout`."""

    WORD = auto()
    NUMBER = auto()
    STRING = auto()
    OPERATOR = auto()
    NEWLINE = auto()
    INDENT = auto()
    DEDENT = auto()
    FORMATTED_START = auto()
    FORMATTED_TEXT = auto()
    FORMATTED_END = auto()
    FIELD_OPEN = auto()
    FIELD_MARK = auto()
    """A separator of the parts of a replacement field: ``=``, ``!``, ``:``."""
    FIELD_CLOSE = auto()


class Piece(NamedTuple):
    """One token of a sentence."""

    text: str
    shape: Shape


OPENERS: Final = frozenset("([{")
CLOSERS: Final = frozenset(")]}")

_REALS: Final = ("0", "1", "2.5", ".5", "1.", "1e3", "1_000", "0xFf", "0o17", "0b1", "1E-3")
_IMAGINARIES: Final = ("1j", "2.5J", "1e3j")
_TEXTS: Final = (
    "''", '"a"', "'a b'", "'\\n'", 'r"\\d"', "u'x'", "'é'", "'😀'", '"#"', "'{'", "'''t'''", '"""a\n  b"""', "'\\x41'",
)  # fmt: skip
_BYTES: Final = ("b''", "b'a'", 'rb"\\d"', "B'''t'''")

_NEVER_EXPRESSIONS: Final = frozenset(
    form.words[0]
    for form in SCENIC_FORMS
    if form.ladder is Ladder.ORDINARY and isinstance(form.parts[0], Word) and isinstance(form.parts[1], Slot)
)
"""As expressions these can be read as operators of a longer text than what was meant."""
_DIRECTIONS: Final = frozenset({"top", "bottom", "front", "back"})
"""Before ``left of`` these are refused as halves of a corner (`ExpressionActions.is_direction`), though they could be names."""
_BLOCK_WORDS: Final = frozenset(
    form.start for form in STATEMENT_FORMS if form.is_soft and form.row[1:2] == (syntax.Word(":"),)
)

NAMES_WITHOUT: Final[Mapping[str, frozenset[str]]] = {
    "NAME": frozenset(),
    "EXPRESSION_NAME": _NEVER_EXPRESSIONS | _DIRECTIONS,
    "PLAIN_NAME": _NEVER_EXPRESSIONS | _DIRECTIONS | _BLOCK_WORDS,
    "CAPTURED_NAME": frozenset({"_"}),
    "TRACKED_NAME": frozenset(),
    "RUNNABLE_NAME": _NEVER_EXPRESSIONS,
}
"""The kinds of names, and what they cannot be; `fuzz.names` chooses among the others."""


def _row(*texts: str, shape: Shape) -> tuple[Piece, ...]:
    return tuple(Piece(text, shape) for text in texts)


ROWS: Final[Mapping[str, tuple[Piece, ...]]] = {
    "NUMBER": _row(*_REALS, *_IMAGINARIES, shape=Shape.NUMBER),
    "REAL": _row(*_REALS, shape=Shape.NUMBER),
    "IMAGINARY": _row(*_IMAGINARIES, shape=Shape.NUMBER),
    "PROBABILITY": _row("1", "0", "0.5", ".25", "1e-3", shape=Shape.NUMBER),
    "STRING": _row(*_TEXTS, *_BYTES, shape=Shape.STRING),
    "TEXT": _row(*_TEXTS, shape=Shape.STRING),
    "BYTES": _row(*_BYTES, shape=Shape.STRING),
    "CONVERSION": _row("r", "s", "a", shape=Shape.WORD),
    "FSTRING_START": _row("f'", 'f"', "rf'", "f'''", 'F"', 'fR"""', shape=Shape.FORMATTED_START),
    "FSTRING_MIDDLE": _row("a", " ", "{{", "}}", "\\n", "é😀", "#", shape=Shape.FORMATTED_TEXT),
    "SPECIFICATION": _row(">", "10", ".3f", "é", shape=Shape.FORMATTED_TEXT),
}
"""The examples of each kind of token whose text varies, but of names."""

FIXED: Final = {
    "NEWLINE": Piece("", Shape.NEWLINE),
    "INDENT": Piece("", Shape.INDENT),
    "DEDENT": Piece("", Shape.DEDENT),
    "FIELD_OPEN": Piece("{", Shape.FIELD_OPEN),
    "FIELD_EQUALS": Piece("=", Shape.FIELD_MARK),
    "FIELD_MARK": Piece("!", Shape.FIELD_MARK),
    "FIELD_COLON": Piece(":", Shape.FIELD_MARK),
    "FIELD_CLOSE": Piece("}", Shape.FIELD_CLOSE),
}
"""Kinds with one text."""
