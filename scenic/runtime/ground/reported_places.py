"""Places of errors: those of a library's line also name the program's line that led there."""

import ast
import os
from collections.abc import Sequence
from pathlib import Path
from typing import Final

from scenic.language.diagnostics import Label
from scenic.language.spans import Span

__all__ = ["Place", "argument_span", "is_library", "reported"]

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


def argument_span(span: Span, text: str, parameters: Sequence[str], name: str | None) -> Span:
    """Return the span of one argument of a call; that of the call where the argument is not seen in its text.

    Args:
        span: of the call.
        text: of the call.
        parameters: of what is called, in order.
        name: of the parameter.

    """
    try:
        call = ast.parse(text, mode="eval").body
    except SyntaxError:
        # Text of the language that Python does not read, such as `30 deg`.
        return span
    if not isinstance(call, ast.Call) or name not in parameters:
        return span
    place = parameters.index(name)
    values = [item.value for item in call.keywords if item.arg == name] + call.args[place : place + 1]
    if not values or any(isinstance(item, ast.Starred) for item in call.args[: place + 1]):
        return span
    value, lines = values[0], text.split("\n")

    def column(line: int, count: int) -> int:
        characters = len(lines[line - 1].encode()[:count].decode(errors="ignore"))
        return characters + (span.column if line == 1 else 0)

    end_line, end = value.end_lineno or value.lineno, value.end_col_offset or value.col_offset
    first, last = column(value.lineno, value.col_offset), column(end_line, end)
    return Span(span.line + value.lineno - 1, first, span.line + end_line - 1, last)
