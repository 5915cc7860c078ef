r"""The shapes of tokens: names, numbers, strings, blanks, line ends.

They are a little wider than the parser's: the name of a character in ``\N{...}`` is not looked up.
"""

import re
import sys
from collections.abc import Iterator, Mapping
from functools import cache
from typing import Final

from scenic.compiler.generated import HARD_KEYWORDS
from scenic.compiler.syntax import TokenKind, Word
from scenic.constrained.items import CharacterClass, TextChoice, TextItem, TextMany, TextOptional, TextRow
from scenic.dataclass import dataclass

__all__ = ["INDENTATION", "TokenDefinitions", "letters", "tokens"]

INDENTATION: Final = 4
"""Blanks for each level of indentation."""


@dataclass(frozen=True, slots=True)
class TokenDefinitions:
    """Kinds of tokens: the definitions of some, and of kinds of names the words that are none."""

    definitions: Mapping[str, TextItem]
    names: Mapping[str, frozenset[str]]


_MARKS: Final = {"'": '"\'"', '"': r'"\""'}
"""The quotes, and each as a literal of the notation of `tokens`."""


def _quoted(escape: str, *, beside: str = "") -> str:
    """The texts in quotes of all kinds, in the notation of `tokens`; ``beside`` are characters that cannot stand in one."""
    forms = []
    for quote, mark in _MARKS.items():
        forms.append(rf"{mark} ([^{quote}\\\r\n\x00{beside}] | {escape})* {mark}")
        long = rf"({mark} {mark}?)? ([^{quote}\\\x00{beside}] | {escape})"
        forms.append(rf"{mark} {mark} {mark} ({long})* {mark} {mark} {mark}")
    return " | ".join(forms)


_BEYOND_ASCII: Final = r"\u0080-\U0010FFFF"


def _formatted() -> Iterator[str]:
    """Yield the parts of f-strings."""
    for word, (quote, mark) in zip(("SINGLE", "DOUBLE"), _MARKS.items(), strict=True):
        yield f"{word}_QUOTES ::= {mark} {mark}?"
        for kind, marks, line_end in ((word, mark, r"\r\n"), (f"LONG_{word}", f"{mark} {mark} {mark}", "")):
            text = rf"[^{quote}\\{{}}\x00{line_end}] | FORMAT_ESCAPE"
            yield f"{kind}_START ::= FORMAT_PREFIX {marks}"
            yield f"{kind}_END ::= {marks}"
            yield f"{kind}_MIDDLE ::= ({text})+"
            yield f"{kind}_FORMAT ::= ({text})+"


_DEFINITIONS: Final = (
    r'DIGITS ::= [0-9] ("_"? [0-9])*',
    r'BASED ::= [xX] ("_"? [0-9a-fA-F])+ | [oO] ("_"? [0-7])+ | [bB] ("_"? [01])+',
    r'INTEGER ::= "0" (("_"? "0")* | BASED) | [1-9] ("_"? [0-9])*',
    r'DECIMAL ::= (DIGITS "." DIGITS? | "." DIGITS) EXPONENT? | DIGITS EXPONENT',
    r"EXPONENT ::= [eE] [+-]? DIGITS",
    r"REAL ::= INTEGER | DECIMAL",
    r"IMAGINARY ::= (DECIMAL | DIGITS) [jJ]",
    r'QUANTITY ::= (REAL | IMAGINARY) "deg"',
    r'DURATION ::= REAL ("seconds" | "steps")',
    r'PROBABILITY ::= "0"? "." DIGITS | "0" "."? | "1" ("." "0"*)? | DIGITS ("." DIGITS?)? [eE] "-" DIGITS',
    r"HEX ::= [0-9a-fA-F]",
    r'CODE ::= "x" HEX HEX | "u" HEX HEX HEX HEX | "U00" ("0" HEX | "10") HEX HEX HEX HEX',
    r'CHARACTER ::= "N{" [A-Za-z] [A-Za-z0-9 -]* "}"',
    r'ESCAPE ::= "\\" ([^xuUN\x00] | CODE | CHARACTER)',
    r'RAW ::= "\\" [^\x00]',
    r'BYTE_ESCAPE ::= "\\" ([\x01-wy-\x7f] | "x" HEX HEX)',
    r'RAW_BYTE ::= "\\" [\x01-\x7f]',
    f"BARE_TEXT ::= {_quoted('ESCAPE')}",
    f"RAW_TEXT ::= {_quoted('RAW')}",
    r"TEXT ::= [uU]? BARE_TEXT | [rR] RAW_TEXT",
    f"BARE_BYTES ::= {_quoted('BYTE_ESCAPE', beside=_BEYOND_ASCII)}",
    f"RAW_BYTES ::= {_quoted('RAW_BYTE', beside=_BEYOND_ASCII)}",
    r"BYTES ::= [bB] BARE_BYTES | ([bB] [rR] | [rR] [bB]) RAW_BYTES",
    r"FORMAT_PREFIX ::= [fF] [rR]? | [rR] [fF]",
    r"""EMPTY_FORMATTED ::= FORMAT_PREFIX ("''" | "\"\"")""",
    r'FORMAT_ESCAPE ::= "\\" ([^xuUN{}\x00] | CODE | CHARACTER)',
    r'BRACES ::= "{{" | "}}"',
    *_formatted(),
    r'FIELD_OPEN ::= "{"',
    r'FIELD_CLOSE ::= "}"',
    r'FIELD_EQUALS ::= "="',
    r'FIELD_MARK ::= "!"',
    r'FIELD_COLON ::= ":"',
    r"CONVERSION ::= [rsa]",
    r'NEXT_LINE ::= "\r"? "\n"',
    r'COMMENT ::= "#" [^\r\n\x00]*',
    r'BLANKS ::= ([ \t\x0c] | "\\" NEXT_LINE)+',
    r'SPACE ::= ([ \t\x0c] | "\\" NEXT_LINE | COMMENT? NEXT_LINE)+',
    r"EMPTY_LINES ::= ([ \t\x0c]* COMMENT? NEXT_LINE)+",
    r"END ::= [ \t\x0c]* COMMENT? (NEXT_LINE [ \t\x0c]* COMMENT?)*",
)


class _Reader:
    """Reads the right side of a definition."""

    _TOKEN: Final = re.compile(r'\s*(?:("(?:\\.|[^"\\])*")|(\[(?:\\.|[^\]\\])*\])|(\w+)|([()|*+?]))')

    def __init__(self, text: str) -> None:
        self._tokens = [found.groups(default="") for found in self._TOKEN.finditer(text)]
        self._at = 0

    def _mark(self) -> str:
        return self._tokens[self._at][3] if self._at < len(self._tokens) else ")"

    def choice(self) -> TextItem:
        rows = [self._row()]
        while self._mark() == "|":
            self._at += 1
            rows.append(self._row())
        return TextChoice(tuple(rows))

    def _row(self) -> TextRow:
        items: list[TextItem] = []
        while self._mark() not in ("|", ")"):
            item = self._item()
            mark = self._mark()
            if mark and mark in "*+?":
                self._at += 1
                item = TextOptional((item,)) if mark == "?" else TextMany((item,))
                item = TextOptional((item,)) if mark == "*" else item
            items.append(item)
        return tuple(items)

    def _item(self) -> TextItem:
        literal, characters, name, _ = self._tokens[self._at]
        self._at += 1
        if literal:
            return Word(
                re.sub(r"\\(.)", lambda found: {"n": "\n", "r": "\r"}.get(found[1], found[1]), literal[1:-1])
            )
        if characters or name:
            return CharacterClass(characters) if characters else TokenKind(name)
        item = self.choice()
        self._at += 1
        return item


@cache
def tokens() -> TokenDefinitions:
    """Return the kinds of tokens of the language; line ends, which depend on the indentation, are left out."""
    pairs = (line.split(" ::= ", 1) for line in _DEFINITIONS)
    definitions = {name: _Reader(text).choice() for name, text in pairs}
    return TokenDefinitions(definitions, {"NAME": frozenset(HARD_KEYWORDS)})


@cache
def letters(*, first: bool) -> str:
    """Return the characters beyond ASCII that a name can begin with, or go on with, as ranges of a character class."""
    prefix = "" if first else "a"
    ranges: list[list[int]] = []
    for code in range(0x80, sys.maxunicode + 1):
        character = chr(code)
        if (prefix + character).isidentifier():
            if ranges and ranges[-1][1] == code - 1:
                ranges[-1][1] = code
            else:
                ranges.append([code, code])
    return "".join(_escaped(low) + ("" if low == high else f"-{_escaped(high)}") for low, high in ranges)


def _escaped(code: int) -> str:
    return f"\\u{code:04X}" if code <= 0xFFFF else f"\\U{code:08X}"
