"""The tokens that sentences are made of: what they look like, by kind.

Each kind has a row of examples, the simplest first, because shrinking goes to the first.
"""

from collections.abc import Mapping
from dataclasses import dataclass
from enum import Enum, auto
from typing import Final, NamedTuple

__all__ = ["CLOSERS", "OPENERS", "Piece", "Pools", "Shape", "pools"]


class Shape(Enum):
    """How a token behaves beside others; see `fuzz.layout`."""

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
    """What separates the parts of a replacement field: ``=``, ``!``, ``:``."""
    FIELD_CLOSE = auto()


class Piece(NamedTuple):
    """One token of a sentence."""

    text: str
    shape: Shape


OPENERS: Final = frozenset("([{")
CLOSERS: Final = frozenset(")]}")

_NAMES: Final = ("x", "y", "a", "b", "f", "C", "M", "ego", "self", "workspace", "Range", "Object")
_ODD_NAMES: Final = ("_", "__x", "é", "ﬁ", "𝐱", "print", "int")
"""Among them two that are normalised to other characters."""
_REALS: Final = ("0", "1", "2.5", ".5", "1.", "1e3", "1_000", "0xFf", "0o17", "0b1", "1E-3")
_IMAGINARIES: Final = ("1j", "2.5J", "1e3j")
_TEXTS: Final = (
    "''", '"a"', "'a b'", "'\\n'", 'r"\\d"', "u'x'", "'é'", "'😀'", '"#"', "'{'", "'''t'''", '"""a\n  b"""', "'\\x41'",
)  # fmt: skip
_BYTES: Final = ("b''", "b'a'", 'rb"\\d"', "B'''t'''")

_NEVER_EXPRESSIONS: Final = frozenset({"visible", "follow"})
"""As expressions these can be read as operators of a longer text than what was meant."""
_BLOCK_WORDS: Final = frozenset({"precondition", "invariant", "setup", "compose"})

FORMATTED_STARTS: Final = ("f'", 'f"', "rf'", "f'''", 'F"', 'fR"""')
FORMATTED_TEXTS: Final = ("a", " ", "{{", "}}", "\\n", "é😀", "#")
SPECIFICATIONS: Final = (">", "10", ".3f", "é")


@dataclass(frozen=True, slots=True)
class Pools:
    """The examples of each kind of token whose text varies, with their shape."""

    rows: Mapping[str, tuple[Piece, ...]]


def pools(soft_keywords: frozenset[str]) -> Pools:
    """The examples, given the soft keywords: these may stand wherever a name may."""
    soft = tuple(sorted(soft_keywords))
    # Ordinary names are the rule: of five names, one is a soft keyword or odd.
    weight = 1 + 4 * (len(soft) + len(_ODD_NAMES)) // len(_NAMES)
    names = _NAMES + _ODD_NAMES + soft + _NAMES * weight
    return Pools(
        {
            "NAME": _row(names, Shape.WORD),
            "EXPRESSION_NAME": _row(names, Shape.WORD, without=_NEVER_EXPRESSIONS),
            "PLAIN_NAME": _row(names, Shape.WORD, without=_NEVER_EXPRESSIONS | _BLOCK_WORDS),
            "CAPTURED_NAME": _row(names, Shape.WORD, without=frozenset({"_"})),
            "NUMBER": _row(_REALS + _IMAGINARIES, Shape.NUMBER),
            "REAL": _row(_REALS, Shape.NUMBER),
            "IMAGINARY": _row(_IMAGINARIES, Shape.NUMBER),
            "PROBABILITY": _row(("1", "0", "0.5", ".25", "1e-3"), Shape.NUMBER),
            "STRING": _row(_TEXTS + _BYTES, Shape.STRING),
            "TEXT": _row(_TEXTS, Shape.STRING),
            "BYTES": _row(_BYTES, Shape.STRING),
            "CONVERSION": _row(("r", "s", "a"), Shape.WORD),
            "FSTRING_START": _row(FORMATTED_STARTS, Shape.FORMATTED_START),
            "FSTRING_MIDDLE": _row(FORMATTED_TEXTS, Shape.FORMATTED_TEXT),
            "SPECIFICATION": _row(SPECIFICATIONS, Shape.FORMATTED_TEXT),
        }
    )


def _row(texts: tuple[str, ...], shape: Shape, *, without: frozenset[str] = frozenset()) -> tuple[Piece, ...]:
    return tuple(Piece(text, shape) for text in texts if text not in without)


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
