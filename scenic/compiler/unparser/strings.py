"""The text of numbers, strings, bytes and of the literal parts of f-strings."""

import sys
from collections.abc import Sequence
from typing import Final, NamedTuple

QUOTES: Final = ('"', "'", '"""', "'''")
"""The quotes of f-strings, in the order in which they are preferred."""
NESTED_QUOTES: Final = ("'", '"', "'''", '"""')
"""The same within a field of an f-string."""

_INFINITY: Final = f"1e{sys.float_info.max_10_exp + 1}"
_LONGEST_DECIMAL: Final = 4000
"""Python refuses to read longer decimal numbers (its limit is 4300 digits); other bases have no limit."""


class Piece(NamedTuple):
    """A piece of an f-string: a literal part before it is escaped, or finished text."""

    text: str
    is_literal: bool = False
    in_specification: bool = False


def number(value: int | float | complex) -> str:  # noqa: PYI041 # an integer is written in another way
    """The text of a number; of a negative one, and of a complex one with a real part, an expression."""
    if isinstance(value, int):
        return hex(value) if value.bit_length() > 3 * _LONGEST_DECIMAL else repr(value)
    text = repr(value)
    if text[0] == "(":
        text = text[1:-1]
    if "n" not in text:
        return text
    if value != value:
        return text.replace("nan", f"({_INFINITY} - {_INFINITY})")
    return text.replace("inf", _INFINITY)


def plain(value: str | bytes, *, nested: bool) -> str:
    """The text of a string or of bytes: in double quotes, within an f-string in single ones, where nothing forces others."""
    text = repr(value)
    if nested:
        return text
    if text[0] == "'":
        return f'"{text[1:-1]}"' if '"' not in text else text
    if text[0] == "b" and text[1] == "'" and '"' not in text:
        return f'b"{text[2:-1]}"'
    return text


def documentation(value: str) -> str:
    """The text of a string in triple quotes, its lines as they are."""
    if value.isprintable() and "\\" not in value and '"' not in value:
        return f'"""{value}"""'
    pieces = []
    for line in value.split("\n"):
        body = _escaped(line).replace("\\t", "\t") if "\\" not in line else _escaped(line)
        pieces.append(body)
    body = _in_triple("\n".join(pieces), '"')
    return f'"""{body}"""'


def _in_triple(text: str, mark: str) -> str:
    """A text for within three quotes, with escapes for those that would end it."""
    text = text.replace(mark * 3, f"{mark}{mark}\\{mark}")
    if text.endswith(mark):
        body = text[:-1]
        is_escaped = (len(body) - len(body.rstrip("\\"))) % 2 == 1
        return text if is_escaped else f"{body}\\{mark}"
    return text


def literal(value: str, quote: str, *, specification: bool) -> str:
    """The text of a literal part of an f-string that is in such quotes."""
    text = _escaped(value)
    if specification:
        # A brace cannot be doubled here.
        text = text.replace("{", "\\x7b").replace("}", "\\x7d")
    else:
        text = text.replace("{", "{{").replace("}", "}}")
    if len(quote) == 1:
        return text.replace(quote, f"\\{quote}")
    return _in_triple(text, quote[0])


def _escaped(value: str) -> str:
    """The text of a string with escapes for all but quotes."""
    if value.isprintable() and "\\" not in value:
        return value
    # With both quotes in it, the single ones are escaped.
    return repr(value + "'\"")[1:-4].replace("\\'", "'")


def formatted(pieces: Sequence[Piece], *, nested: bool) -> str:
    """An f-string of such pieces, in quotes that do not occur in its fields if there are such."""
    fields = "".join([piece.text for piece in pieces if not piece.is_literal])
    literals = "".join([piece.text for piece in pieces if piece.is_literal])
    order = NESTED_QUOTES if nested else QUOTES
    # Only Scenic, and Python since 3.12, can read the quotes of an f-string within its fields.
    free = [quote for quote in order if quote not in fields] or [order[0]]
    quote = next((each for each in free if each not in literals), free[0])
    text = "".join(
        [
            literal(piece.text, quote, specification=piece.in_specification)
            if piece.is_literal
            else piece.text
            for piece in pieces
        ]
    )
    return f"f{quote}{text}{quote}"
