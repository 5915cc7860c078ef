"""Indentation of the header of a clause as soon as it is typed: `else:` below its `if`, `interrupt when ...:`
below its `try`.
"""

import re
from collections.abc import Mapping
from types import MappingProxyType
from typing import Final

from scenic.compiler.tokens import DEDENT, INDENT, NEWLINE
from scenic.ide.snapshot import Snapshot
from scenic.language.diagnostics import Edit
from scenic.language.spans import Span

__all__ = ["dedented"]

_BELOW: Final[Mapping[str, frozenset[str]]] = MappingProxyType(
    {
        "elif": frozenset({"if", "elif"}),
        "else": frozenset({"if", "elif", "for", "while", "try", "except", "interrupt"}),
        "except": frozenset({"try", "except", "interrupt"}),
        "finally": frozenset({"try", "except", "interrupt", "else"}),
        "interrupt": frozenset({"try", "interrupt"}),
        "compose": frozenset({"setup"}),
    }
)
"""By the first word of a clause: those of the headers with which it stands in one column."""


def dedented(snapshot: Snapshot, line: int, column: int) -> tuple[Edit, ...]:
    """The change that moves a header, of which the colon has just been typed before a place, to where it belongs.

    None if it stands there already, or continues nothing.
    """
    text = snapshot.source.line(line)
    first = _word(text)
    here = _indentation(text)
    if first not in _BELOW or text[:column].rstrip()[-1:] != ":" or not _begins(snapshot, line):
        return ()
    least = here + 1
    for number in range(line - 1, 0, -1):
        above = snapshot.source.line(number)
        depth = _indentation(above)
        if not above.strip() or above.lstrip().startswith("#") or depth >= least:
            continue
        if _word(above) in _BELOW[first] and _begins(snapshot, number):
            if depth == here:
                return ()
            blanks = above[: len(above) - len(above.lstrip())]
            return (Edit(Span(line, 0, line, len(text) - len(text.lstrip())), blanks),)
        least = depth
    return ()


def _word(line: str) -> str:
    found = re.match(r"\s*([^\W\d]\w*)", line)
    return "" if found is None else found[1]


def _indentation(line: str) -> int:
    """Return the width of the blanks that a line begins with, as the lexer counts them."""
    return len(line.expandtabs(8)) - len(line.expandtabs(8).lstrip())


def _begins(snapshot: Snapshot, line: int) -> bool:
    """Return whether a line begins a statement: not in the middle of a string, or of brackets."""
    tokens = snapshot.tokens
    found = [index for index in snapshot.tokens_of_line(line) if tokens.kinds[index] not in (INDENT, DEDENT)]
    if not found or _word(snapshot.source.line(line)) != tokens.texts[found[0]]:
        return False
    before = found[0] - 1
    while before >= 0 and tokens.kinds[before] in (INDENT, DEDENT):
        before -= 1
    return before < 0 or tokens.kinds[before] == NEWLINE
