"""Programs of Scenic 2: one diagnostic in place of one for each line that Scenic 3 writes otherwise."""

import os
import re
from collections.abc import Sequence
from typing import Final

from scenic.language.diagnostics import Diagnostic, Severity
from scenic.language.source import Source
from scenic.language.spans import Span

__all__ = ["as_old_dialect"]

_SIGNS: Final = frozenset({"SC111", "SC115"})
"""Codes of what Scenic 2 wrote otherwise: objects without `new`, constructors, monitors without parentheses."""

_FEWEST: Final = 2
"""Number of lines with signs that show a program of Scenic 2; a single one is more likely a slip."""

_NEW: Final = re.compile(r"^[^#\n]*\bnew\s+[^\W\d]", re.MULTILINE)

_MADE: Final = re.compile(
    r"^[ \t]*(?P<ego>ego[ \t]*=[ \t]*|\w+[ \t]*=[ \t]*|)(?P<cls>[A-Z]\w*)[ \t]+"
    r"(?:at|on|in|with|facing|beyond|behind|following|offset|left of|right of|ahead of|apparently|visible)\b",
    re.MULTILINE,
)
"""A line that makes an object. As the ego it can be nothing else; `Field at p` is an operator elsewhere."""

_STRING: Final = re.compile(r"('''|\"\"\").*?\1", re.DOTALL)


def as_old_dialect(diagnostics: Sequence[Diagnostic], source: Source) -> list[Diagnostic]:
    """Return the diagnostics of a program; of a program of Scenic 2 a single one, at its first sign."""
    places = {
        item.span.line: item.span for item in diagnostics if item.code in _SIGNS and item.span is not None
    }
    if (not places and "ego" not in source.text) or _NEW.search(source.text):
        return list(diagnostics)
    text = _STRING.sub(lambda found: "\n" * found[0].count("\n"), source.text)
    constructions = list(_MADE.finditer(text))
    if not places and not any(found["ego"].startswith("ego") for found in constructions):
        return list(diagnostics)
    for found in constructions:
        line = text.count("\n", 0, found.start("cls")) + 1
        column = found.start("cls") - (text.rfind("\n", 0, found.start("cls")) + 1)
        places.setdefault(line, Span(line, column, line, column + len(found["cls"])))
    if len(places) < _FEWEST:
        return list(diagnostics)
    return [
        Diagnostic(
            "SC136",
            "this is a program of Scenic 2",
            places[min(places)],
            Severity.ERROR,
            source.filename,
            f"`scenic migrate --write {os.path.basename(source.filename)}` converts it; `--diff` shows the changes",
        )
    ]
