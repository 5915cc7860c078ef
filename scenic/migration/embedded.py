"""Programs in the strings of Python and JSON files, and in the blocks of Markdown."""

import ast
import io
import json
import re
import tokenize
from collections.abc import Callable, Iterator
from typing import Final

from scenic.dataclass import dataclass
from scenic.migration.converting import Converted
from scenic.migration.migration_rules import Note, decision
from scenic.migration.texts import TextEdit, edited

__all__ = ["SUFFIXES", "convert_embedded"]

SUFFIXES: Final = (".py", ".json", ".jsonl", ".md", ".markdown")
"""Endings of the files that may contain programs in strings."""

_JSON_STRING: Final = re.compile(r'"(?:[^"\\\n]|\\.)*"')
_FENCE: Final = re.compile(
    r"^(?P<indent>[ \t]*)(?P<fence>`{3,}|~{3,})[ \t]*\{?\.?scenic\b[^\n]*\n(?P<body>.*?)^(?P=indent)(?P=fence)[ \t]*$",
    re.MULTILINE | re.DOTALL,
)
_SIGN: Final = re.compile(
    r"^\s*ego\s*=|^\s*(model|param|from|import|behavior|monitor|constructor)\b", re.MULTILINE
)
"""Statements that only programs have; a text without any is prose."""

Convert = Callable[[str], Converted]


@dataclass(frozen=True, slots=True)
class _String:
    """A string of a file: its place, the line on which its value begins, its value, and how to write another value."""

    start: int
    end: int
    line: int
    value: str
    written: Callable[[str], str | None]


def convert_embedded(text: str, filename: str, convert: Convert) -> tuple[str, tuple[Note, ...]]:
    """Convert the programs of Scenic 2 in a file; strings that are no such programs are left alone.

    ``text`` is the file's, with its own line ends; the lines of the notes count in the file.
    """
    if filename.endswith(".py"):
        strings = _of_python(text)
    elif filename.endswith((".json", ".jsonl")):
        strings = _of_json(text)
    else:
        strings = _of_markdown(text)
    edits: list[TextEdit] = []
    notes: list[Note] = []
    for string in strings:
        if not _SIGN.search(string.value):
            continue
        conversion = convert(string.value)
        if not conversion.is_old or conversion.problem is not None:
            continue
        several = "\n" in text[string.start : string.end]
        if conversion.text != string.value:
            literal = string.written(conversion.text)
            if literal is None:
                notes.append(decision("formatted-string", string.line))
                continue
            edits.append(TextEdit(string.start, string.end, literal))
        notes += [
            Note(
                string.line + (note.line - 1 if several else 0),
                note.rule,
                note.rewritten,
                note.message,
                note.help,
            )
            for note in conversion.notes
        ]
    return edited(text, edits), tuple(notes)


def _of_markdown(text: str) -> Iterator[_String]:
    for block in _FENCE.finditer(text):
        indent = block["indent"]
        body = block["body"]
        lines = body.splitlines(keepends=True)
        if any(line.strip() and not line.startswith(indent) for line in lines):
            continue
        value = "".join(line.removeprefix(indent) for line in lines)

        def written(result: str, indent: str = indent) -> str:
            return "".join(
                indent + line if line.strip() else line for line in result.splitlines(keepends=True)
            )

        start = block.start("body")
        yield _String(start, block.end("body"), text.count("\n", 0, start) + 1, value, written)


def _of_json(text: str) -> Iterator[_String]:
    for match in _JSON_STRING.finditer(text):
        literal = match[0]
        try:
            value = json.loads(literal)
        except ValueError:
            continue

        def written(result: str, literal: str = literal) -> str:
            return json.dumps(result, ensure_ascii=literal.isascii())

        yield _String(match.start(), match.end(), text.count("\n", 0, match.start()) + 1, value, written)


def _of_python(text: str) -> Iterator[_String]:
    lines = text.splitlines(keepends=True)
    starts = [0]
    for line in lines:
        starts.append(starts[-1] + len(line))
    try:
        tokens = list(tokenize.generate_tokens(io.StringIO(text, newline="").readline))
    except (tokenize.TokenError, SyntaxError):
        return
    for token in tokens:
        if token.type != tokenize.STRING:
            continue
        literal = token.string
        prefix = literal[: len(literal) - len(literal.lstrip("rRbBuUfF"))]
        if "b" in prefix.lower():
            continue
        quote = (
            literal[len(prefix) :][:3]
            if literal[len(prefix) :][:3] in ('"""', "'''")
            else literal[len(prefix)]
        )
        body = literal[len(prefix) + len(quote) : -len(quote)]
        start = starts[token.start[0] - 1] + token.start[1] + len(prefix) + len(quote)
        if body.startswith("\\\n"):
            # The line end after the quotes is no part of the value.
            body, start = body[2:], start + 2
            literal = f"{prefix}{quote}{body}{quote}"
        value: str
        write: Callable[[str], str | None]
        if "f" in prefix.lower():
            value, write = re.sub(r"\{[^{}]*\}", "x", body), _refuse
        elif "\\" not in body or "r" in prefix.lower():
            value, write = body, _plain(quote)
        else:
            try:
                value = ast.literal_eval(literal)
            except (ValueError, SyntaxError):
                continue
            write = _escaped(body, quote)
        yield _String(start, start + len(body), token.start[0], value, write)


def _refuse(_result: str) -> None:
    """F-strings are not rewritten."""


def _plain(quote: str) -> Callable[[str], str | None]:
    """Return a function that writes a string without escapes."""

    def written(result: str) -> str | None:
        return None if quote in result or (len(quote) == 1 and "\n" in result) else result

    return written


_PIECE: Final = re.compile(r"\\(?:\r\n|[0-7]{1,3}|x..|u.{4}|U.{8}|N\{[^}]*\}|.)|.", re.DOTALL)
"""One character of a value, or an escape, as a literal writes it."""


def _escaped(body: str, quote: str) -> Callable[[str], str | None]:
    """Return a function that writes a string with escapes: lines that do not change keep the way in which they are written."""

    def written(result: str) -> str | None:
        pieces = [
            (match[0], ast.literal_eval(f'"""{match[0]}"""'))
            for match in _PIECE.finditer(body)
            if match[0] != '"'
        ]
        lines: dict[str, str] = {}
        line = source = ""
        for literal, character in pieces:
            line, source = line + character, source + literal
            if character == "\n":
                lines.setdefault(line, source)
                line = source = ""
        lines.setdefault(line, source)
        real = "\n" in body and len(quote) == 3
        return "".join(
            lines.get(each) or _escape(each, quote, real=real) for each in result.splitlines(keepends=True)
        )

    return written if '"' not in body else (lambda result: _escape(result, quote, real="\n" in body))


def _escape(text: str, quote: str, *, real: bool) -> str:
    """Return the text as it is written between quotes; ``real`` keeps line ends as they are."""
    text = text.replace("\\", "\\\\").replace(quote, "\\" + quote)
    text = text.replace("\t", "\\t").replace("\r", "\\r")
    return text if real else text.replace("\n", "\\n")
