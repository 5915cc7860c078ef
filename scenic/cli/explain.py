"""``scenic explain``: the page of a diagnostic code."""

import re
import sys
from collections.abc import Iterator
from typing import Final

import click

from scenic.cli.output import has_colours
from scenic.language.diagnostics import CODES
from scenic.language.explanations import explanation
from scenic.language.spelling import distance

__all__ = ["explain"]

_RESET: Final = "\x1b[0m"
_BOLD: Final = "\x1b[1m"
_HEADING: Final = "\x1b[1;34m"
_CODE: Final = "\x1b[36m"
_SEVERITIES: Final = {"error": "\x1b[1;31m", "warning": "\x1b[1;33m", "information": "\x1b[1;36m"}

_GROUPS: Final = {
    "SC1": "Lexical and syntax errors",
    "SC2": "Names and placement",
    "SC3": "Meaning, found without running the program",
    "SC4": "Found while the program runs",
    "SC5": "Found while sampling",
    "SC6": "Files, options, parameters",
    "SC7": "Found by analysis",
    "SC9": "The tools themselves",
}


@click.command()
@click.argument("code", required=False)
def explain(code: str | None) -> None:
    """Explain a diagnostic by its code, such as SC111, with an example and its repair.

    Without a code, list all of them.
    """
    colours = has_colours(sys.stdout)
    if code is None:
        lines: Iterator[str] = _all_codes(colours)
    else:
        lines = _rendered(explanation(_known(code)).text, colours)
    sys.stdout.write("\n".join(lines) + "\n")


def _known(written: str) -> str:
    """Return the code that a user has written in some way: `sc111`, `111`, `error[SC111]`."""
    name = written.strip().upper()
    match = re.search(r"\[(.*)\]", name)
    if match is not None:
        name = match[1]
    if name.isdecimal():
        name = f"SC{name}"
    if name in CODES:
        return name
    # Among equally similar codes the one with the smallest difference in number, so that SC119 is nearer to SC118.
    similar = sorted(CODES, key=lambda code: (distance(name, code, limit=3), _gap(name, code), code))
    message = f"There is no diagnostic {written!r}."
    if distance(name, similar[0], limit=3) <= 2:
        message += f" Did you mean {similar[0]!r}?"
    raise click.UsageError(f"{message} 'scenic explain' lists all of them.")


def _gap(first: str, second: str) -> int:
    numbers = [int(re.sub(r"\D", "", name) or 0) for name in (first, second)]
    return abs(numbers[0] - numbers[1])


def _all_codes(colours: bool) -> Iterator[str]:
    group = ""
    for code, title in CODES.items():
        if code[:3] != group:
            if group:
                yield ""
            group = code[:3]
            yield _painted(_GROUPS[group], _HEADING, colours)
        shown = _inline(title, colours)
        yield f"  {_painted(code, _BOLD, colours)}  {shown}"


def _rendered(text: str, colours: bool) -> Iterator[str]:
    """Yield the lines of a page: unchanged for a file or another program, with colours in place of marks for a terminal."""
    if not colours:
        yield from text.rstrip("\n").split("\n")
        return
    in_block = False
    for line in text.rstrip("\n").split("\n"):
        if line.startswith("```"):
            in_block = not in_block
        elif in_block:
            severity = re.match(r"(?:\d+:\d+: )?(error|warning|information)\[\w+\]", line)
            colour = _SEVERITIES[severity[1]] if severity else _CODE
            yield f"    {_painted(line, colour, True)}" if line else ""
        elif line.startswith("#"):
            yield _painted(line.lstrip("# "), _HEADING, True)
        else:
            yield _inline(line, True)


def _inline(line: str, colours: bool) -> str:
    """Return a line of text in which code is coloured instead of quoted."""
    return re.sub(r"`([^`]+)`", rf"{_CODE}\1{_RESET}", line) if colours else line


def _painted(text: str, colour: str, colours: bool) -> str:
    return f"{colour}{text}{_RESET}" if colours else text
