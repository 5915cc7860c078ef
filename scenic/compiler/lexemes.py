"""The regular expressions of the lexer: what the words, numbers, strings and operators look like.

All of them use possessive repetition, so that no input makes one of them go back over what it has read:
the lexer takes linear time. Any character beyond ASCII is taken for a part of a name at first, as CPython
does; whether the name is a proper one is looked at afterwards.
"""

import re
from functools import cache
from typing import Final

# Groups of TOKEN, in the order of their alternatives; the lexer compares them with ``match.lastindex``.
WORD: Final = 1  # a name of ASCII characters, a keyword, or an operator
OPENER: Final = 2
CLOSER: Final = 3
LINE_END: Final = 4  # with the empty lines after it and the indentation of the next line that is not empty
COLON: Final = 5
NUMERAL: Final = 6
TEXT: Final = 7
COMMENT: Final = 8
FORMATTED: Final = 9
OPEN_TEXT: Final = 10
ODD_WORD: Final = 11  # a name beyond ASCII, or one that touches a quote and is no prefix of a string
CONTINUATION: Final = 12
ODD_NUMERAL: Final = 13
END: Final = 14
STRAY: Final = 15

_NAME_START: Final = r"[^\x00-@\[-^`{-\x7f]"
_NAME_PART: Final = r"[^\x00-/:-@\[-^`{-\x7f]"
_DIGITS: Final = r"[0-9](?:_?[0-9])*+"
_NUMBER: Final = (
    r"(?:0[xX](?:_?[0-9a-fA-F])++|0[oO](?:_?[0-7])++|0[bB](?:_?[01])++"
    rf"|(?:{_DIGITS}(?:\.(?:{_DIGITS})?+)?+|\.{_DIGITS})(?:[eE][+-]?{_DIGITS})?+[jJ]?+)"
)
_PREFIX: Final = r"(?:[bB][rR]?+|[rR][bB]?+|[uU])?+"
_FORMAT_PREFIX: Final = r"(?:[fF][rR]?+|[rR][fF])"
_QUOTES: Final = r"(?:\"\"\"|'''|\"|')"


def _closed_string() -> str:
    bodies = []
    for quote in ('"', "'"):
        plain = rf"[^{quote}\\]*+"
        bodies.append(
            rf"{quote * 3}{plain}(?:(?:\\.|{quote}(?!{quote * 2})){plain})*+{quote * 3}"
            rf"|{quote}(?!{quote * 2})[^{quote}\\\n]*+(?:\\.[^{quote}\\\n]*+)*+{quote}"
        )
    return "(?:" + "|".join(bodies) + ")"


_EMPTY_LINES: Final = r"(?:[ \t\f]*+(?:\#[^\n]*+)?+\n)*+"

_ALTERNATIVES: Final = (
    # The look-ahead keeps out a quote and everything beyond ASCII.
    (
        r"[A-Za-z_][A-Za-z0-9_]*+(?![^\x00-!#-&(-\x7f])"
        r"|,|\.(?:\.\.|(?![0-9]))|==?|-[>=]?|[+%&|^@]=?|\*\*?=?|//?=?|<<?=?|>>?=?|!=|~|;"
    ),
    r"[(\[{]",
    r"[)\]}]",
    rf"\n{_EMPTY_LINES}[ \t\f]*+",
    r":=?|!",
    rf"{_NUMBER}(?!{_NAME_PART})",
    rf"{_PREFIX}{_closed_string()}",
    r"\#[^\n]*+",
    rf"{_FORMAT_PREFIX}{_QUOTES}",
    rf"{_PREFIX}{_QUOTES}",
    rf"{_NAME_START}{_NAME_PART}*+",
    r"\\\n",
    r"\.?[0-9]",
    r"\Z",
    r".",
)

TOKEN: Final = re.compile(r"[ \t\f]*+(?:" + "|".join(f"({each})" for each in _ALTERNATIVES) + ")", re.DOTALL)
"""One token with the blanks before it; matches at every place of every text."""

LINE_START: Final = re.compile(rf"{_EMPTY_LINES}([ \t\f]*+)")
"""From the start of a line over empty lines and comments; group 1 is the indentation of the next line."""

COMMENT_LINE: Final = re.compile(r"^[ \t\f]*+(\#[^\n]*+)", re.MULTILINE)

STATEMENT_WORD: Final = re.compile(
    r"(?:assert|break|class|continue|def|del|except|finally|global|import|nonlocal|pass|raise"
    r"|require|return|try|while)(?=[ \t:(\n])"
)
"""Starts of lines that cannot continue a bracket: a bracket before must be unclosed."""

NUMBER: Final = re.compile(_NUMBER)
LEADING_ZERO: Final = re.compile(r"0[0-9_]*[1-9][0-9_]*")
WORD_AFTER_NUMBER: Final = re.compile(
    r"and|else|for|i[fns]|or|not|(?:at|by|deg|from|offset|relative|seconds|steps|to|until)\b"
)
"""Words that may touch a number in front of them: keywords that CPython lets, as in ``1if x else y``, and words of Scenic's
operators and durations, as in ``30deg`` and ``5seconds``."""
BAD_NUMBER: Final = re.compile(rf"(?:[eE][+-](?=[0-9])|\.(?=[0-9])|{_NAME_PART})++|\.")

BACKSLASHES: Final = re.compile(r"\\++([ \t\f]*+\n)?+")
STRAY_RUN: Final = re.compile(r"[\x00-\x08\x0b\x0e-\x1f\x7f$?`]++")
UNREADABLE: Final = re.compile(r"(\x00++)|([\ud800-\udfff]++)")
NON_ASCII: Final = re.compile(r"[^\x00-\x7f]")

# The rest of a string with one quote that is not closed: to the end of its line, and of those joined to it.
OPEN_STRING: Final = re.compile(r"[^\\\n]*+(?:\\.[^\\\n]*+)*+", re.DOTALL)


@cache
def literal(quote: str, *, specification: bool, raw: bool) -> re.Pattern[str]:
    """The literal text of an f-string up to a brace, its end, or an error.

    ``specification`` says whether it is a format specification, where no brace can be doubled.
    """
    mark = quote[0]
    if len(quote) == 3:
        pieces = [rf"[^{mark}\\{{}}]++", rf"{mark}(?!{mark * 2})"]
    else:
        pieces = [rf"[^{mark}\\{{}}\n]++"]
    if not raw:
        pieces.append(rf"\\N\{{[^\\{{}}\n{mark}]*+\}}")
    # A backslash before a brace stands for itself; otherwise it takes the next character with it.
    pieces += [r"\\[^{}]", r"\\(?=[{}])"]
    if not specification:
        pieces += [r"\{\{", r"\}\}"]
    return re.compile("(?:" + "|".join(pieces) + ")*+")
