"""Places of keys and values in a TOML text: `tomllib` gives their content, but not their places."""

import re
from collections.abc import Iterator, Sequence
from typing import Final

from scenic.language.source import Source
from scenic.language.spans import Span

__all__ = ["place_in_toml"]

_KEY: Final = r"(?:[A-Za-z0-9_-]+|\"[^\"\n]*\"|'[^'\n]*')"
_DOTTED: Final = rf"{_KEY}(?:[ \t]*\.[ \t]*{_KEY})*"
# Compiled when they are first needed: most files are right.
_HEADER: Final = rf"[ \t]*\[\[?[ \t]*({_DOTTED})[ \t]*\]\]?[ \t]*(?:#.*)?"
_ENTRY: Final = rf"[ \t]*({_DOTTED})[ \t]*="


def place_in_toml(source: Source, keys: Sequence[str], value: str | None = None) -> Span | None:
    """The place of the key that ``keys`` leads to, or of the string ``value`` in what that key holds.

    Found by looking at lines; ``None`` if it is written in a way that is not found so. For people only.
    """
    key_path = tuple(keys)
    lines = source.lines
    for number, path, spans, end in _keys(lines):
        common = len(path)
        if path[: len(key_path)] == key_path:
            key = spans[len(key_path) - 1]
            where = Span(number, key[0], number, key[1])
            if value is None or common > len(key_path):
                return where
            return _quoted(lines, number, end, value) or where
        if key_path[:common] == path:
            # The rest of the keys stands in a table that is written as the value of this one.
            inner = _inner(lines, number, end, key_path[common])
            if inner is not None:
                return (value is not None and _quoted(lines, inner.line, inner.end_column, value)) or inner
    return None


def _keys(lines: Sequence[str]) -> Iterator[tuple[int, tuple[str, ...], list[tuple[int, int]], int]]:
    """Line, whole path, place of each part of it on the line, and the column after it, of every key."""
    table: tuple[str, ...] = ()
    for number, line in enumerate(lines, 1):
        header = re.fullmatch(_HEADER, line)
        match = header or re.match(_ENTRY, line)
        if match is None:
            continue
        parts = list(re.compile(_KEY).finditer(line, match.start(1), match.end(1)))
        names = tuple(part[0].strip("\"'") for part in parts)
        spans = [part.span() for part in parts]
        if header is not None:
            table = names
            yield number, table, spans, len(line)
        else:
            # The parts of the table's name stand elsewhere; those of the key are what is looked for.
            yield number, (*table, *names), [*[spans[0]] * len(table), *spans], match.end()


def _ends(line: str) -> bool:
    return re.fullmatch(_HEADER, line) is not None or re.match(_ENTRY, line) is not None


def _quoted(lines: Sequence[str], number: int, column: int, value: str) -> Span | None:
    """The string ``value`` after a place, before the next key."""
    pattern = re.compile(rf"\"{re.escape(value)}\"|'{re.escape(value)}'")
    return _search(lines, number, column, pattern)


def _inner(lines: Sequence[str], number: int, column: int, key: str) -> Span | None:
    """Return a key of a table that is written in braces."""
    pattern = re.compile(
        rf"(?<![\w-])(?:{re.escape(key)}|\"{re.escape(key)}\"|'{re.escape(key)}')(?=[ \t]*[=.])"
    )
    return _search(lines, number, column, pattern)


def _search(lines: Sequence[str], number: int, column: int, pattern: re.Pattern[str]) -> Span | None:
    for line in range(number, len(lines) + 1):
        text = lines[line - 1]
        if line > number and _ends(text):
            return None
        found = pattern.search(text, column if line == number else 0)
        if found is not None:
            return Span(line, found.start(), line, found.end())
    return None
