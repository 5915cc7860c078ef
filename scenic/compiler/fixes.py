r"""Applies the repairs that diagnostics carry.

Texts here are as they stand in the file: with their byte order mark and their line ends, which repairs leave alone.
"""

import re
from bisect import bisect_right
from collections.abc import Callable, Iterable, Sequence
from typing import Final

from scenic.compiler.check import check_text
from scenic.compiler.surroundings import SurroundingsOf
from scenic.dataclass import dataclass
from scenic.language.diagnostics import Diagnostic, Edit, Fix, Severity

__all__ = ["Repaired", "apply_fixes", "repair"]

_LINE_END: Final = re.compile(r"\r\n|\r|\n")
_MOST_ROUNDS: Final = 20
"""A repair may make another one possible; more rounds than this would mean that two undo each other."""


@dataclass(frozen=True, slots=True)
class Repaired:
    """A text after its repairs, with their number and the remaining diagnostics."""

    text: str
    count: int
    diagnostics: tuple[Diagnostic, ...]


def repair(
    text: str,
    *,
    filename: str,
    shown: Callable[[Sequence[Diagnostic]], Sequence[Diagnostic]],
    surroundings_of: SurroundingsOf | None = None,
) -> Repaired:
    """Make the certain repairs of the diagnostics that ``shown`` leaves, again and again until none is left.

    A repair that would leave the program with more errors than before is not made. ``surroundings_of`` as in
    `check_text`.
    """

    def check(text: str) -> tuple[Diagnostic, ...]:
        return check_text(text, filename=filename, surroundings_of=surroundings_of)

    count = 0
    diagnostics = check(text)
    texts = {text}
    for _ in range(_MOST_ROUNDS):
        fixes = list(
            dict.fromkeys(
                item.fix for item in shown(diagnostics) if item.fix is not None and item.fix.certain
            )
        )
        if not fixes:
            break
        better = _attempt(text, fixes, diagnostics, check) or _one_by_one(text, fixes, diagnostics, check)
        if better is None or better[0] in texts:
            break
        text, repairs, diagnostics = better
        texts.add(text)
        count += repairs
    return Repaired(text, count, tuple(shown(diagnostics)))


_Attempt = tuple[str, int, tuple[Diagnostic, ...]]


_Check = Callable[[str], tuple[Diagnostic, ...]]


def _attempt(text: str, fixes: Sequence[Fix], before: Sequence[Diagnostic], check: _Check) -> _Attempt | None:
    """The text with all repairs that do not overlap, unless it has more errors than before."""
    repaired, made = apply_fixes(text, fixes)
    if repaired == text:
        return None
    found = check(repaired)
    return None if _errors(found) > _errors(before) else (repaired, made, found)


def _one_by_one(
    text: str, fixes: Sequence[Fix], before: Sequence[Diagnostic], check: _Check
) -> _Attempt | None:
    """The text with the first repair that alone adds no errors."""
    if len(fixes) == 1:
        return None
    return next(filter(None, (_attempt(text, [fix], before, check) for fix in fixes)), None)


def _errors(diagnostics: Iterable[Diagnostic]) -> int:
    return sum(item.severity is Severity.ERROR for item in diagnostics)


def apply_fixes(text: str, fixes: Iterable[Fix]) -> tuple[str, int]:
    """Make all repairs that do not overlap, earlier ones first; return the text and the number of repairs."""
    starts = [
        len(text) - len(text.lstrip("\ufeff")),
        *(line_match.end() for line_match in _LINE_END.finditer(text)),
    ]
    line_end = line_match[0] if (line_match := _LINE_END.search(text)) is not None else "\n"

    def offset(line: int, column: int) -> int:
        if line > len(starts):
            return len(text)
        # A column past the end of its line means that end.
        end = _LINE_END.search(text, starts[line - 1])
        return min(starts[line - 1] + column, len(text) if end is None else end.start())

    def place(edit: Edit) -> tuple[int, int, str]:
        span = edit.span
        replacement = edit.text.replace("\n", line_end)
        return offset(span.line, span.column), offset(span.end_line, span.end_column), replacement

    applied_edits: list[tuple[int, int, str]] = []
    count = 0
    for edits in sorted(sorted(map(place, fix.edits)) for fix in fixes if fix.edits):
        if not any(_clash(edit, applied_edits) for edit in edits):
            applied_edits = sorted(applied_edits + edits)
            count += 1
    for start, end, replacement in reversed(applied_edits):
        text = text[:start] + replacement + text[end:]
    return text, count


def _clash(edit: tuple[int, int, str], taken: Sequence[tuple[int, int, str]]) -> bool:
    """Return whether an edit touches one of those taken, which are in order; two insertions at one place do."""
    start, end, _ = edit
    index = bisect_right(taken, start, key=lambda each: each[0])
    before = taken[index - 1] if index else None
    after = taken[index] if index < len(taken) else None
    if before is not None and (before[1] > start or before[:2] == (start, end) or before[0] == start):
        return True
    return after is not None and after[0] < end
