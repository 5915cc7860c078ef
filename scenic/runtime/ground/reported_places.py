"""Places of errors: those of a library's line also name the program's line that led there."""

import os
from pathlib import Path
from typing import Final

from scenic.language.diagnostics import Label
from scenic.language.spans import Span

__all__ = ["Place", "is_library", "reported"]

_PACKAGE: Final = f"{Path(__file__).parents[2]}{os.sep}"
"""The directory of this project's package, ending in a separator."""

Place = tuple[Span | None, str | None]
"""A span and its file, each ``None`` if unknown."""


def is_library(filename: str) -> bool:
    """Return whether a file is one of this package, and not the user's."""
    return filename.startswith(_PACKAGE)


def reported(place: Place, own: Place) -> tuple[Place, tuple[Label, ...]]:
    """Return where an error is reported, and the labels that name the other line, if there is another one.

    Args:
        place: where the error was raised.
        own: the program's own line that led there. Errors in a library of this package are reported there; errors in
            modules of the user stay where they are.

    """
    (span, filename), (own_span, own_file) = place, own
    if own_span is None or own_file is None or own_file == filename:
        return place, ()
    if span is None or filename is None:
        return own, ()
    if is_library(filename):
        return own, (Label(span, "raised here", filename),)
    return place, (Label(own_span, "reached from here", own_file),)
