"""Tokens of a text after a change: those of lines that are as before are taken over, also where there are mistakes.

A lexer stands *afresh* before a token if nothing that it has read matters any more: no bracket, string or block is open.
What it makes of a text from such a place on depends on the text from there on alone. What it has made of the text before
depends on little after it: on the line that begins there, and as far as `LOOKAHEAD` says (but for strings of several lines
that are not closed, and characters that cannot be read, which are told after all else: then all is read again). So a stretch between two such
places can be read again alone, and what follows stays as it was if the lexer stands afresh there once more.
"""

from bisect import bisect_left, bisect_right
from collections.abc import Callable, Sequence
from dataclasses import replace
from typing import Final

from scenic.compiler.lexical_errors import is_open_text, unreadable
from scenic.compiler.lines import MOST_DIAGNOSTICS
from scenic.compiler.tokens import Tokens
from scenic.dataclass import dataclass
from scenic.language.diagnostics import Diagnostic
from scenic.language.spans import Span

__all__ = ["LOOKAHEAD", "Change", "Lexed", "Splice", "lex_again"]

LOOKAHEAD: Final = 300
"""So many characters after a place a lexer may look at, besides the whole line."""

_FARTHER: Final = (0, 2, 12)
"""At how many places further on the lexer is expected to stand afresh again, one after the other."""


@dataclass(frozen=True, slots=True)
class Change:
    """The difference between two texts: ``first`` lines at the beginning are the same, and ``last`` at the end.

    ``before`` and ``after`` are the numbers of their lines.
    """

    first: int
    last: int
    before: int
    after: int

    @property
    def shift(self) -> int:
        """By how much the lines at the end have moved."""
        return self.after - self.before


@dataclass(frozen=True, slots=True)
class Splice:
    """Tokens of which those before ``begin`` are as they were, and so are those that began at ``end``.

    ``old`` are the tokens before; ``moved`` is by how many tokens the latter are further back.
    """

    tokens: Tokens
    old: Tokens
    begin: int
    end: int
    moved: int


@dataclass(frozen=True, slots=True, eq=False)
class Lexed:
    """The tokens of a text, and before which of them the lexer stood afresh, in order."""

    tokens: Tokens
    afresh: Sequence[int]


def lex_again(
    text: str, lines: Sequence[str], before: Lexed, change: Change, lex: Callable[[str], Lexed]
) -> tuple[Lexed, Splice] | None:
    """The tokens of a text as ``lex`` finds them, with the help of an earlier result; ``None`` if the earlier result does not help.

    ``lines`` are those of the text.
    """
    if any(map(is_open_text, before.tokens.diagnostics)):
        return None
    places = [before.tokens.lines[index] for index in before.afresh]
    safe, room = change.first, LOOKAHEAD
    while safe > 0 and room > 0:
        safe -= 1
        room -= len(lines[safe]) + 1
    # As far before the change as a lexer looks ahead, on a line that stays.
    head = bisect_right(places, safe) - 1
    first_line = places[head] if head >= 0 else 1
    tail = bisect_right(places, change.before - change.last)
    for farther in _FARTHER:
        last = tail + farther
        last_line = places[last] + change.shift if last < len(places) else len(lines)
        room = LOOKAHEAD + 1
        while last_line < len(lines) and room > 0:
            room -= len(lines[last_line]) + 1
            last_line += 1
        fresh = lex("\n".join(lines[first_line - 1 : last_line]))
        if any(unreadable(fresh.tokens.text)) or any(map(is_open_text, fresh.tokens.diagnostics)):
            return None
        own_lines = [fresh.tokens.lines[index] + first_line - 1 for index in fresh.afresh]
        for at in range(tail, min(last + 1, len(places))):
            own = bisect_left(own_lines, places[at] + change.shift)
            if own < len(own_lines) and own_lines[own] == places[at] + change.shift:
                return _joined(text, before, fresh, (head, at), (own, first_line), change)
        if last_line == len(lines):
            return _joined(text, before, fresh, (head, len(places)), (len(fresh.afresh), first_line), change)
    return None


def _joined(
    text: str,
    before: Lexed,
    fresh: Lexed,
    kept: tuple[int, int],
    own: tuple[int, int],
    change: Change,
) -> tuple[Lexed, Splice] | None:
    """Fresh tokens between old ones.

    ``kept`` are the fresh places before which, and from which on, the old tokens stay; ``own`` is the one at which the new
    tokens end, and the line at which they begin.
    """
    (head, at), (own_at, first_line) = kept, own
    old, new = before.tokens, fresh.tokens
    begin = before.afresh[head] if head >= 0 else 0
    goes_on = at < len(before.afresh)
    end = before.afresh[at] if goes_on else len(old.kinds)
    stop = fresh.afresh[own_at] if goes_on else len(new.kinds)
    down, shift = first_line - 1, change.shift
    # The line, of the old text and of the part, from which on the old tokens stay.
    old_line = old.lines[end] if goes_on else change.before + 1
    own_line = new.lines[stop] if goes_on else change.after + 1
    diagnostics = [each for each in old.diagnostics if _line(each) < first_line]
    diagnostics += [_shifted(each, down) for each in new.diagnostics if _line(each) < own_line]
    diagnostics += [_shifted(each, shift) for each in old.diagnostics if _line(each) >= old_line]
    if len(diagnostics) >= MOST_DIAGNOSTICS:
        return None
    if text and not text.endswith("\n"):
        text += "\n"
    tokens = Tokens(
        text,
        old.kinds[:begin] + new.kinds[:stop] + old.kinds[end:],
        old.texts[:begin] + new.texts[:stop] + old.texts[end:],
        old.lines[:begin] + _moved(new.lines[:stop], down) + _moved(old.lines[end:], shift),
        old.columns[:begin] + new.columns[:stop] + old.columns[end:],
        old.end_lines[:begin] + _moved(new.end_lines[:stop], down) + _moved(old.end_lines[end:], shift),
        old.end_columns[:begin] + new.end_columns[:stop] + old.end_columns[end:],
        [each for each in old.comments if each[0] < first_line]
        + [(line + down, column, comment) for line, column, comment in new.comments if line < own_line]
        + [(line + shift, column, comment) for line, column, comment in old.comments if line >= old_line],
        diagnostics,
    )
    moved = begin + stop - end
    afresh = [
        *before.afresh[: max(head, 0)],
        *(begin + index for index in fresh.afresh[:own_at]),
        *(index + moved for index in before.afresh[at:]),
    ]
    return Lexed(tokens, afresh), Splice(tokens, old, begin, end, moved)


def _line(diagnostic: Diagnostic) -> int:
    return diagnostic.span.line if diagnostic.span is not None else 0


def _shifted(diagnostic: Diagnostic, by: int) -> Diagnostic:
    """A diagnostic, moved down by a number of lines."""
    if not by:
        return diagnostic
    fix = diagnostic.fix
    return replace(
        diagnostic,
        span=diagnostic.span and _lower(diagnostic.span, by),
        labels=tuple(replace(each, span=_lower(each.span, by)) for each in diagnostic.labels),
        fix=fix
        and replace(fix, edits=tuple(replace(each, span=_lower(each.span, by)) for each in fix.edits)),
    )


def _lower(span: Span, by: int) -> Span:
    return Span(span.line + by, span.column, span.end_line + by, span.end_column)


def _moved(lines: list[int], by: int) -> list[int]:
    return [line + by for line in lines] if by else lines
