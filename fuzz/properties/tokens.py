"""Tokens have the right places: the places of nodes, which are derived from them, cannot show this."""

import re
import unicodedata
from typing import Final

from fuzz.properties.case import Case, Property, Violation
from scenic.compiler.tokens import DEDENT, ENDMARKER, ERROR, FSTRING_MIDDLE, INDENT, NEWLINE, STRING

__all__ = ["OF_TEXTS"]

_LAYOUT: Final = frozenset({NEWLINE, INDENT, DEDENT, ENDMARKER})
_BETWEEN: Final = re.compile(rb"(?:[ \t\f\n]|\\\n|#[^\n]*)*+")
"""The text allowed between tokens."""


def tokens_are_where_they_are_written(case: Case) -> None:
    """At the place of each token stands its text; between those of a program, there are only blanks and comments."""
    tokens = case.tokens
    data = tokens.text.encode("utf-8", "surrogatepass")
    starts = [0, 0]
    for line in data.split(b"\n"):
        starts.append(starts[-1] + len(line) + 1)
    last = 0
    for kind, text, line, column, end_line, end_column in zip(
        tokens.kinds,
        tokens.texts,
        tokens.lines,
        tokens.columns,
        tokens.end_lines,
        tokens.end_columns,
        strict=True,
    ):
        if kind in _LAYOUT:
            continue
        start, end = starts[line] + column, starts[end_line] + end_column
        # Of a text with mistakes, what is missing may have been put in.
        if kind != ERROR and not (kind == STRING and case.has_error):
            source_text = data[start:end].decode("utf-8", "surrogatepass")
            plain_text = (
                source_text.replace("{{", "{").replace("}}", "}") if kind == FSTRING_MIDDLE else source_text
            )
            if text not in (source_text, plain_text, unicodedata.normalize("NFKC", source_text)):
                raise Violation(
                    f"the token {text!r} at {line}:{column} stands where {source_text!r} is written"
                )
        if not case.has_error:
            if start < last:
                raise Violation(f"the token {text!r} at {line}:{column} begins before the one before it ends")
            if _BETWEEN.fullmatch(data, last, start) is None:
                raise Violation(f"no token for {data[last:start]!r}, before {line}:{column}")
        last = end


OF_TEXTS: Final = (Property.of(tokens_are_where_they_are_written),)
