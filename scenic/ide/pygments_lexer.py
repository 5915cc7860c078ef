"""Scenic for Pygments: documentation, terminals and notebooks show programs in colours."""

import re
from collections.abc import Iterator
from types import MappingProxyType
from typing import Any, ClassVar, Final

from pygments.lexer import inherit
from pygments.lexers.python import PythonLexer
from pygments.token import Keyword, Name, Operator, Text

from scenic.ide.highlighting import PATTERNS, Category

__all__ = ["ScenicLexer"]

_TOKENS: Final = MappingProxyType(
    {
        Category.STATEMENT: Keyword,
        Category.DEFINITION: Keyword.Declaration,
        Category.OPERATOR: Operator.Word,
        Category.CONSTANT: Keyword.Constant,
        Category.VARIABLE: Name.Builtin.Pseudo,
        Category.CLASS: Name.Builtin,
        Category.FUNCTION: Name.Builtin,
        Category.PROPERTY: Name.Attribute,
        Category.DEFINED: Name.Class,
    }
)


def _rules() -> Iterator[tuple[Any, ...]]:
    for pattern in PATTERNS:
        yield pattern.regex, _by_groups(pattern.categories)


def _by_groups(categories: tuple[Category, ...]) -> Any:
    """Shows each group as its category and what is between them as text."""
    kinds = [_TOKENS[category] for category in categories]

    def show(_lexer: object, match: re.Match[str], _context: object = None) -> Iterator[tuple[int, Any, str]]:
        end = match.start()
        for number, kind in enumerate(kinds, 1):
            if match.start(number) > end:
                yield end, Text, match.string[end : match.start(number)]
            yield match.start(number), kind, match[number]
            end = match.end(number)
        if end < match.end():
            yield end, Text, match.string[end : match.end()]

    return show


class ScenicLexer(PythonLexer):  # type: ignore[misc] # the library has no types
    """The lexer: Python's, with Scenic's words where they are keywords."""

    name = "Scenic"
    aliases: ClassVar[list[str]] = ["scenic"]
    filenames: ClassVar[list[str]] = ["*.scenic"]
    alias_filenames: ClassVar[list[str]] = []
    mimetypes: ClassVar[list[str]] = ["text/x-scenic", "application/x-scenic"]
    flags = re.MULTILINE

    tokens: ClassVar[dict[str, list[Any]]] = {
        "root": [*_rules(), inherit],
        "expr": [*_rules(), inherit],
    }

    def analyse_text(text: str) -> float:  # noqa: N805 - the library's own way to declare it
        """Return 0: a text is never guessed to be Scenic, since programs in Python look the same."""
        return 0.0
