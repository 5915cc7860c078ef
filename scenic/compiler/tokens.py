"""Tokens: their kinds, and a text as parallel lists of them, which is what a parser reads fastest."""

from bisect import bisect_left, bisect_right
from dataclasses import field
from typing import Final, TypeAlias

from scenic.dataclass import dataclass
from scenic.language.diagnostics import Diagnostic

ENDMARKER: Final = 0
NEWLINE: Final = 1
INDENT: Final = 2
DEDENT: Final = 3
NUMBER: Final = 4
STRING: Final = 5
FSTRING_START: Final = 6
FSTRING_MIDDLE: Final = 7
FSTRING_END: Final = 8
ERROR: Final = 9
NAME: Final = 256
"""Hard keywords and operators lie between ERROR and NAME, soft keywords above NAME."""


@dataclass(slots=True)
class Tokens:
    r"""The tokens of a text as parallel lists, with what was wrong with it.

    ``lines`` and ``end_lines`` count from 1, ``columns`` and ``end_columns`` count UTF-8 bytes from 0, as
    `ast` does. ``texts`` holds the text of each token; of a name its normal form (NFKC), of
    ``FSTRING_MIDDLE`` the text with doubled braces made single, of ``NEWLINE``, ``DEDENT`` and
    ``ENDMARKER`` nothing. ``text`` is what the lists describe: the source without byte order mark, with
    ``\n`` at the end of each line. ``comments`` are triples of line, column in characters, and text.
    """

    text: str
    kinds: list[int] = field(default_factory=list)
    texts: list[str] = field(default_factory=list)
    lines: list[int] = field(default_factory=list)
    columns: list[int] = field(default_factory=list)
    end_lines: list[int] = field(default_factory=list)
    end_columns: list[int] = field(default_factory=list)
    comments: list[tuple[int, int, str]] = field(default_factory=list)
    diagnostics: list[Diagnostic] = field(default_factory=list)

    def lists(self) -> "TokenLists":
        """Return the input of a parser, which looks a few tokens ahead: so the kinds extend a little beyond the end."""
        return (
            [*self.kinds, 0, 0, 0, 0],
            self.texts,
            self.lines,
            self.columns,
            self.end_lines,
            self.end_columns,
        )

    def count_bytes(self) -> None:
        """Turn columns in characters into columns in bytes, on the lines that are not ASCII."""
        for number, content in enumerate(self.text.split("\n"), start=1):
            if content.isascii():
                continue
            for lines, columns in ((self.lines, self.columns), (self.end_lines, self.end_columns)):
                last_column = count = 0
                for index in range(bisect_left(lines, number), bisect_right(lines, number)):
                    column = columns[index]
                    # The line end is one more than the characters of the line.
                    count += len(content[last_column:column].encode("utf-8", "surrogatepass"))
                    last_column = column
                    columns[index] = count + max(0, column - len(content))


TokenLists: TypeAlias = tuple[list[int], list[str], list[int], list[int], list[int], list[int]]
"""Kinds, texts, lines, columns, end lines and end columns."""
