"""Columns of diagnostics count characters: what they are outside ASCII, in bytes, is nothing to them."""

import re
from typing import Final

from fuzz.properties.case import Case, Property, Violation, describe
from scenic.compiler.parser import parse
from scenic.compiler.tokens import STRING

__all__ = ["OF_TEXTS"]

_PLAIN: Final = re.compile(r"(['\"])(?!\1)[^\\\n]*[A-Za-z][^\\\n]*\1")
"""A string without prefix and escapes, on one line and with letters."""
_OTHERS: Final = {
    letter: chr(0x4E00 + letter) for letter in range(ord("A"), ord("z") + 1) if chr(letter).isalpha()
}
"""A character of three bytes for each letter."""


def columns_count_characters(case: Case) -> None:
    """With other letters in its strings, of which each takes three bytes, a text has the same mistakes at the same places."""
    diagnostics_before = case.result.diagnostics
    if not diagnostics_before or ("'" not in case.text and '"' not in case.text):
        return
    other = _with_other_letters(case)
    if other is None:
        return
    again = parse(other).diagnostics
    places = [[(each.code, each.span) for each in diagnostics] for diagnostics in (diagnostics_before, again)]
    if places[0] != places[1]:
        first = next(
            (pair for pair in zip(diagnostics_before, again, strict=False) if pair[0].span != pair[1].span),
            diagnostics_before[:1],
        )
        raise Violation(f"other places with other letters: {'; '.join(map(describe, first))}\n{other}")


def _with_other_letters(case: Case) -> str | None:
    """The text with other letters in its plain strings; ``None`` if it has none."""
    tokens = case.tokens
    lines = [line.encode("utf-8", "surrogatepass") for line in tokens.text.split("\n")]
    has_changes = False
    # From the end, so that the columns before stay right.
    for index in reversed(range(len(tokens.kinds))):
        text, line = tokens.texts[index], tokens.lines[index] - 1
        if tokens.kinds[index] == STRING and _PLAIN.fullmatch(text) is not None:
            start, end = tokens.columns[index], tokens.end_columns[index]
            token_text = lines[line][start:end]
            if tokens.end_lines[index] == line + 1 and token_text == text.encode("utf-8", "surrogatepass"):
                new = text.translate(_OTHERS).encode("utf-8", "surrogatepass")
                lines[line] = lines[line][:start] + new + lines[line][end:]
                has_changes = True
    return b"\n".join(lines).decode("utf-8", "surrogatepass") if has_changes else None


OF_TEXTS: Final = (Property.of(columns_count_characters),)
