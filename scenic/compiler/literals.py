"""The values of number and string literals."""

import ast
import re
import unicodedata
from typing import Final

_SIMPLE_ESCAPES: Final = {
    "\n": "",
    "\\": "\\",
    "'": "'",
    '"': '"',
    "a": "\a",
    "b": "\b",
    "f": "\f",
    "n": "\n",
    "r": "\r",
    "t": "\t",
    "v": "\v",
}
_ESCAPE: Final = re.compile(r"\\(?:([0-7]{1,3})|N\{([^}]*)\}|x(.{0,2})|u(.{0,4})|U(.{0,8})|(.))", re.DOTALL)
_BYTES_ESCAPE: Final = re.compile(r"\\(?:([0-7]{1,3})|(?!)|x(.{0,2})|(?!)|(?!)|(.))", re.DOTALL)
_HEXADECIMAL: Final = re.compile(r"[0-9a-fA-F]+")


class LiteralError(ValueError):
    """The error for a literal that has no value; the message gives the reason."""


def number_value(text: str) -> int | float | complex:
    """The value of a number; raises `LiteralError` for a decimal integer of too many digits."""
    if text.isdecimal():
        # Everything else that Python takes for a digit is no number here: the lexer knows ASCII digits only.
        return _integer(text)
    text = text.replace("_", "")
    if text[-1] in "jJ":
        return complex(0.0, float(text[:-1]))
    if text[:2] in ("0x", "0X", "0o", "0O", "0b", "0B"):
        return int(text, 0)
    if text.isdecimal():
        return _integer(text)
    return float(text)


def _integer(text: str) -> int:
    try:
        return int(text)
    except ValueError:
        raise LiteralError(f"this number has {len(text)} digits, which is too many") from None


def literal_number(value: ast.expr | None) -> int | float | None:
    """The number that an expression is, with or without a minus sign; ``None`` for all else. Truth values count as 0 and 1."""
    sign = 1
    if isinstance(value, ast.UnaryOp) and isinstance(value.op, ast.USub):
        sign, value = -1, value.operand
    if isinstance(value, ast.Constant) and isinstance(value.value, int | float):
        return sign * value.value
    return None


def string_value(text: str) -> str | bytes:
    """Return the value of a string token that is not an f-string; raises `LiteralError` for an impossible escape."""
    quote = text[-1]
    start = text.index(quote)
    end = -1
    if len(text) >= start + 6 and text.startswith(quote * 3, start):
        body = text[start + 3 : -3]
    else:
        body = text[start + 1 : end]
    if start == 0:
        return decoded(body) if "\\" in body else body
    prefix = text[:start].lower()
    if "b" in prefix:
        if not body.isascii():
            raise LiteralError("bytes can only contain ASCII characters")
        if "\\" in body and "r" not in prefix:
            return _BYTES_ESCAPE.sub(_bytes_escape, body).encode("latin-1")
        return body.encode("ascii")
    return decoded(body) if "\\" in body and "r" not in prefix else body


def decoded(body: str) -> str:
    """Return a text with its escapes replaced; raises `LiteralError`."""
    return _ESCAPE.sub(_escape, body)


def _escape(found: re.Match[str]) -> str:
    octal, name, short, medium, long, other = found.groups()
    if other is not None:
        if other == "N":
            raise LiteralError("`\\N` needs the name of a character in braces")
        # An unknown escape stands for itself, as in Python.
        return _SIMPLE_ESCAPES.get(other, found[0])
    if octal is not None:
        return chr(int(octal, 8))
    if name is not None:
        try:
            return unicodedata.lookup(name)
        except KeyError:
            raise LiteralError(f"there is no character called {name!r}") from None
    for digits, length in ((short, 2), (medium, 4), (long, 8)):
        if digits is not None:
            return chr(_code(found[0][:2], digits, length))
    raise AssertionError(found)


def _bytes_escape(found: re.Match[str]) -> str:
    octal, digits, other = found.groups()
    if octal is not None:
        return chr(int(octal, 8) & 0xFF)
    if digits is not None:
        return chr(_code("\\x", digits, 2))
    return _SIMPLE_ESCAPES.get(other, found[0])


def _code(escape: str, digits: str, length: int) -> int:
    if len(digits) < length or not _HEXADECIMAL.fullmatch(digits):
        raise LiteralError(f"`{escape}` needs {length} hexadecimal digits")
    code = int(digits, 16)
    if code > 0x10FFFF:
        raise LiteralError(f"`{escape}{digits}` is beyond the last character")
    return code
