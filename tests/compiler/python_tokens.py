"""Tokens in the form in which those of the lexer can be compared with those of the standard library's `tokenize`."""

import io
import keyword
import token
import tokenize
import unicodedata
from collections.abc import Iterator
from typing import Final, TypeAlias

from scenic.compiler.tokens import (
    DEDENT,
    ENDMARKER,
    ERROR,
    FSTRING_END,
    FSTRING_MIDDLE,
    FSTRING_START,
    INDENT,
    NAME,
    NEWLINE,
    NUMBER,
    STRING,
    Tokens,
)

OPERATORS: Final = sorted({*token.EXACT_TOKEN_TYPES, "!"})
WORDS: Final = {
    **{word: 16 + index for index, word in enumerate([*keyword.kwlist, *OPERATORS])},
    **{word: 257 + index for index, word in enumerate(["ego", "facing", "match"])},
}
NAMES_OF_KINDS: Final = {
    ENDMARKER: "END",
    NEWLINE: "NEWLINE",
    INDENT: "INDENT",
    DEDENT: "DEDENT",
    NUMBER: "NUMBER",
    STRING: "STRING",
    FSTRING_START: "FSTART",
    FSTRING_MIDDLE: "FMIDDLE",
    FSTRING_END: "FEND",
    ERROR: "ERROR",
    NAME: "NAME",
}
FROM_TOKENIZE: Final = {
    tokenize.ENDMARKER: "END",
    tokenize.NEWLINE: "NEWLINE",
    tokenize.INDENT: "INDENT",
    tokenize.DEDENT: "DEDENT",
    tokenize.NUMBER: "NUMBER",
    tokenize.STRING: "STRING",
    tokenize.NAME: "NAME",
    tokenize.OP: "OP",
    tokenize.ERRORTOKEN: "ERROR",
}

Row: TypeAlias = tuple[str, str, tuple[int, int], tuple[int, int]]
"""Kind, text, start and end."""


def rows(tokens: Tokens) -> Iterator[Row]:
    for kind, text, line, column, end_line, end_column in zip(
        tokens.kinds,
        tokens.texts,
        tokens.lines,
        tokens.columns,
        tokens.end_lines,
        tokens.end_columns,
        strict=True,
    ):
        name = NAMES_OF_KINDS.get(kind) or ("NAME" if text.isidentifier() else "OP")
        yield name, text, (line, column), (end_line, end_column)


def with_whole_formatted_strings(tokens: Tokens) -> list[Row]:
    """As before Python 3.12: one token for a whole f-string; its text is left out of the comparison."""
    result: list[Row] = []
    starts: list[tuple[int, int]] = []
    for row in rows(tokens):
        if row[0] == "FSTART":
            starts.append(row[2])
        elif row[0] == "FEND":
            start = starts.pop()
            if not starts:
                result.append(("STRING", "f", start, row[3]))
        elif not starts:
            result.append(row)
    return result


def of_tokenize(text: str) -> list[Row]:
    text = text.replace("\r\n", "\n").replace("\r", "\n")
    if text and not text.endswith("\n"):
        text += "\n"
    lines = text.split("\n")

    def in_bytes(line: int, column: int) -> tuple[int, int]:
        content = lines[line - 1] if line <= len(lines) else ""
        return line, len(content[:column].encode()) + max(0, column - len(content))

    result: list[Row] = []
    depth = 0
    start = (0, 0)
    for each in tokenize.generate_tokens(io.StringIO(text).readline):
        name = tokenize.tok_name[each.type]
        if name in ("NL", "COMMENT"):
            continue
        if name == "FSTRING_START":
            start = start if depth else in_bytes(*each.start)
            depth += 1
        elif name == "FSTRING_END":
            depth -= 1
            if not depth:
                result.append(("STRING", "f", start, in_bytes(*each.end)))
        elif not depth:
            kind, string = FROM_TOKENIZE[each.type], each.string
            if kind in ("NEWLINE", "DEDENT", "END"):
                string = ""
            elif kind == "STRING" and "f" in string[:2].lower().split('"')[0].split("'")[0]:
                string = "f"
            elif kind == "NAME":
                string = unicodedata.normalize("NFKC", string)
            result.append((kind, string, in_bytes(*each.start), in_bytes(*each.end)))
    return result
