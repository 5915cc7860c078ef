"""Messages of the lexer about text that it cannot read."""

import re
from collections.abc import Iterator
from typing import Final

from scenic.compiler import lexemes
from scenic.language.diagnostics import Diagnostic, Edit, Fix, Label
from scenic.language.spans import Span

CLOSER_OF: Final = {"(": ")", "[": "]", "{": "}"}
OPENER_OF: Final = {")": "(", "]": "[", "}": "{"}

_NUMBER_KINDS: Final = {"x": "hexadecimal", "o": "octal", "b": "binary"}


def wrong_closer(closer: str, span: Span, opener: str, opener_span: Span) -> Diagnostic:
    """``closer`` stands where ``opener`` has to be closed first."""
    return Diagnostic(
        "SC103",
        f"`{closer}` does not match `{opener}`",
        span,
        help=f"close `{opener}` with `{CLOSER_OF[opener]}`",
        labels=(Label(opener_span, f"`{opener}` was opened here"),),
    )


def needless_closer(closer: str, span: Span) -> Diagnostic:
    return Diagnostic("SC103", f"`{closer}` closes no bracket", span, help=f"remove `{closer}`")


def never_closed(opener: str, span: Span, *, is_field: bool, noticed: Span | None = None) -> Diagnostic:
    """A bracket, or the brace of a replacement field, is still open at the end of the statement, ``noticed``."""
    if is_field:
        return Diagnostic(
            "SC105", "this replacement field of an f-string is never closed", span, help="add `}`"
        )
    closer = CLOSER_OF[opener]
    labels: tuple[Label, ...] = ()
    if noticed is not None and (noticed.line, noticed.column) > (span.end_line, span.end_column):
        labels = (Label(noticed, f"`{closer}` is missing here at the latest"),)
    return Diagnostic("SC103", f"`{opener}` is never closed", span, help=f"add `{closer}`", labels=labels)


def closed_early(span: Span, opener: str, opener_span: Span) -> Diagnostic:
    """An f-string ends inside one of its replacement fields."""
    closer = CLOSER_OF[opener]
    return Diagnostic(
        "SC105",
        f"the f-string ends before `{closer}`",
        span,
        help=f"add `{closer}` before the quote",
        labels=(Label(opener_span, f"`{opener}` was opened here"),),
    )


def single_brace(span: Span) -> Diagnostic:
    return Diagnostic("SC105", "single `}` in an f-string", span, help="write `}}` for a brace")


def nested_too_deeply(span: Span) -> Diagnostic:
    return Diagnostic(
        "SC112",
        "this is nested too deeply",
        span,
        help="write at most 200 brackets, and 99 blocks, within each other",
    )


def open_string(quote: str, span: Span) -> Diagnostic:
    return Diagnostic("SC101", "this string is never closed", span, help=f"add `{quote}`")


def is_open_text(diagnostic: Diagnostic) -> bool:
    """Return whether a diagnostic reports an unclosed string of several lines, which any later text may change."""
    return diagnostic.code == "SC101" and (diagnostic.help or "").endswith(('"""`', "'''`"))


def unmatched_unindent(span: Span) -> Diagnostic:
    return Diagnostic(
        "SC102",
        "unindent does not match any outer indentation level",
        span,
        help="align the line with the block that it belongs to",
    )


def unexpected_indent(span: Span) -> Diagnostic:
    return Diagnostic(
        "SC102",
        "this line is indented more than the one before, which begins no block",
        span,
        help="align it with the line before",
    )


def conflict_marker(span: Span) -> Diagnostic:
    return Diagnostic(
        "SC110",
        "a merge conflict is not resolved",
        span,
        help="keep the lines that are wanted, and remove the others and the markers",
    )


def mixed_indentation(span: Span) -> Diagnostic:
    return Diagnostic(
        "SC102", "inconsistent use of tabs and spaces in indentation", span, help="indent with spaces only"
    )


def continuation_at_end(span: Span) -> Diagnostic:
    return Diagnostic("SC106", "the file ends after a line continuation", span, help="remove the backslash")


def after_continuation(span: Span, *, blank: bool) -> Diagnostic:
    return Diagnostic(
        "SC106",
        f"{'blanks' if blank else 'text'} after a line continuation",
        span,
        help="a backslash outside strings must be the last character of its line",
    )


def bad_number(whole: str, number: str, span: Span) -> Diagnostic:
    """``whole`` is not a number, although its beginning ``number`` may be one."""
    kind = _NUMBER_KINDS.get(whole[1:2].lower(), "decimal") if whole[0] == "0" else "decimal"
    message = f"invalid {kind} number `{_short(whole)}`"
    if lexemes.LEADING_ZERO.fullmatch(number):
        message = "a decimal number must not start with 0"
        advice = "remove the zeros, or write `0o` before an octal number"
    elif whole.endswith("_") or "__" in whole:
        advice = "an underscore must stand between two digits"
    elif kind != "decimal":
        advice = f"write one or more {kind} digits after `{whole[:2]}`"
    else:
        return _with_unit(whole, message, span) or Diagnostic(
            "SC104", message, span, help="put a space or an operator between the number and what follows"
        )
    return Diagnostic("SC104", message, span, help=advice)


_NUMBER: Final = re.compile(r"(\d+(?:\.\d*)?)(°|[^\W\d_]+)")
_METRES: Final = {"m": 1.0, "km": 1000.0, "cm": 0.01, "mm": 0.001, "ft": 0.3048}
_WORDS_AFTER: Final = {
    **dict.fromkeys(("°", "deg", "degree", "degrees"), "deg"),
    **dict.fromkeys(("s", "sec", "secs", "second", "seconds"), "seconds"),
    **dict.fromkeys(("step", "steps"), "steps"),
}


def _with_unit(whole: str, message: str, span: Span) -> Diagnostic | None:
    """Explain a number with a unit: ``90°``, ``5s``, ``3m``."""
    match = _NUMBER.fullmatch(whole)
    if match is None:
        return None
    number, unit = match.groups()
    word = _WORDS_AFTER.get(unit.lower())
    if word is not None:
        fix = Fix(f"Write `{number} {word}`", (Edit(span, f"{number} {word}"),), certain=word == "deg")
        kind = "an angle" if word == "deg" else "a duration"
        return Diagnostic("SC104", message, span, help=f"write {kind} as `{number} {word}`", fix=fix)
    if unit == "rad":
        return Diagnostic(
            "SC104", message, span, help=f"angles are in radians: write `{number}`, or `30 deg` for degrees"
        )
    if unit in _METRES:
        metres = f"{float(number) * _METRES[unit]:g}"
        fix = Fix(f"Write `{metres}`", (Edit(span, metres),), certain=False)
        return Diagnostic(
            "SC104",
            message,
            span,
            help=f"numbers have no units: lengths are in metres, write `{metres}`",
            fix=fix,
        )
    if unit in ("kmh", "kph", "mph", "mps", "ms"):
        return Diagnostic(
            "SC104",
            message,
            span,
            help="numbers have no units: speeds are in metres per second, durations in seconds",
        )
    return None


def invalid_character(character: str, span: Span) -> Diagnostic:
    code = ord(character)
    if character.isprintable():
        message = f"invalid character `{character}`" + (f" (U+{code:04X})" if code > 127 else "")
    else:
        message = f"invalid non-printable character U+{code:04X}"
    if character == "`":
        message, advice = "invalid character: a backtick", "use the plain quotes `\"` or `'`"
    elif character == "?":
        advice = "write `a if condition else b` for a choice between two values"
    elif character in "“”„«»‘’‚":
        advice = "use the plain quotes `\"` or `'`"
    elif character == "!":
        advice = "write `not` or `!=`"
    elif character == "°":
        fix = Fix("Write `deg`", (Edit(span, " deg"),))
        return Diagnostic("SC100", message, span, help="write `deg` after a number of degrees", fix=fix)
    elif character in "−–—":
        advice = "use the plain hyphen `-`"
    elif character.isspace():
        advice = "replace it by a plain space"
    else:
        advice = "remove it, or put it into a string"
    return Diagnostic("SC100", message, span, help=advice)


def unreadable(text: str) -> Iterator[Diagnostic]:
    """Null characters and lone surrogates wherever they are, in strings and comments too."""
    if "\0" not in text and (text.isascii() or lexemes.UNREADABLE.search(text) is None):
        return
    line, line_start, counted_to = 1, 0, 0
    for match in lexemes.UNREADABLE.finditer(text):
        start, end = match.span()
        count = text.count("\n", counted_to, start)
        if count:
            line += count
            line_start = text.rfind("\n", counted_to, start) + 1
        counted_to = end
        if match[1]:
            message = "null character in the source"
        else:
            message = f"half of a character (lone surrogate U+{ord(text[start]):04X}) in the source"
        span = Span(line, start - line_start, line, end - line_start)
        yield Diagnostic("SC100", message, span, help="is this really a text file in UTF-8?")


def _short(text: str) -> str:
    return text if len(text) <= 40 else text[:39] + "…"
