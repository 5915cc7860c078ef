"""Selection of diagnostics and of their severities, by code, or by the beginning of codes.

A *selector* is a code (``SC304``) or what codes begin with (``SC3``, ``SC``).
"""

from collections.abc import Iterable, Sequence
from dataclasses import replace
from typing import Final

from scenic.dataclass import dataclass
from scenic.language.diagnostics import CODES, Diagnostic, Severity
from scenic.language.spelling import nearest

__all__ = ["EVERYTHING", "Rules", "is_lasting", "is_selector", "longest_match", "similar_selector"]

EVERYTHING: Final = ("SC",)
"""The selectors of all codes."""

_LASTING: Final = ("SC1", "SC6", "SC999")


def is_selector(text: str) -> bool:
    """Return whether ``text`` is a code that exists, or what such codes begin with."""
    return text.startswith("SC") and any(code.startswith(text) for code in CODES)


def similar_selector(text: str) -> str | None:
    """Return the code or beginning of codes that was probably meant."""
    for meant in (text.strip().upper(), f"SC{text.strip()}"):
        if meant != text and is_selector(meant):
            return meant
    return nearest(text, CODES)


def is_lasting(diagnostic: Diagnostic) -> bool:
    """Return whether a diagnostic is shown whatever is selected or ignored.

    So are errors of syntax, without which nothing else can be said about a program, of files and options, and
    faults of the tools.
    """
    return diagnostic.severity is Severity.ERROR and diagnostic.code.startswith(_LASTING)


def longest_match(code: str, selectors: Iterable[str]) -> int:
    """Return the length of the longest of the selectors that ``code`` begins with, or -1."""
    return max((len(each) for each in selectors if code.startswith(each)), default=-1)


@dataclass(frozen=True, slots=True)
class Rules:
    """Rules that select a file's diagnostics.

    Of ``select`` and ``ignore`` the longer selector decides, and of equal ones ``ignore``; so ``SC304`` can be
    selected although ``SC3`` is ignored, and the other way round. What is in ``never`` is not shown whatever is
    selected. ``severity`` gives another severity to codes, again by the longest selector.
    """

    select: tuple[str, ...] = EVERYTHING
    ignore: tuple[str, ...] = ()
    never: tuple[str, ...] = ()
    severity: tuple[tuple[str, Severity], ...] = ()

    def shows(self, code: str) -> bool:
        """Return whether diagnostics of a code are shown, if they are none that always are."""
        chosen = longest_match(code, self.select)
        return chosen > longest_match(code, self.ignore) and longest_match(code, self.never) < 0

    def apply(self, diagnostics: Sequence[Diagnostic]) -> tuple[Diagnostic, ...]:
        """Return the diagnostics that are shown, with the severity that the selection gives them."""
        if self == _PLAIN:
            return tuple(diagnostics)
        selection = []
        for each in diagnostics:
            if is_lasting(each):
                selection.append(each)
            elif self.shows(each.code):
                length = longest_match(each.code, (selector for selector, _ in self.severity))
                severity = dict(self.severity).get(each.code[:length]) if length > 0 else None
                selection.append(
                    each if severity in (None, each.severity) else replace(each, severity=severity)
                )
        return tuple(selection)

    def overridden(self, select: Sequence[str], ignore: Sequence[str]) -> "Rules":
        """Return these rules below a choice that is made nearer to the user.

        A ``select`` of that choice replaces both lists of these rules; an ``ignore`` adds to theirs.
        """
        if select:
            return replace(self, select=tuple(select), ignore=tuple(ignore))
        return replace(self, ignore=(*self.ignore, *ignore))


_PLAIN: Final = Rules()
