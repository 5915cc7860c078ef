"""The items of the grammars for constrained decoding."""

from collections.abc import Iterator
from typing import TypeAlias

from scenic.compiler.syntax import TokenKind, Word
from scenic.dataclass import dataclass

__all__ = [
    "CharacterClass",
    "Line",
    "TextChoice",
    "TextItem",
    "TextMany",
    "TextOptional",
    "TextRow",
    "Use",
    "Variant",
    "within",
]


@dataclass(frozen=True, slots=True)
class Variant:
    """A rule in one of its places.

    ``inside`` brackets, line ends and comments count as blanks. What is ``bare`` begins with a symbol, so that it can stand
    directly after a word.
    """

    rule: str
    inside: bool = False
    bare: bool = False

    @property
    def name(self) -> str:
        return self.rule + "_in" * self.inside + "_bare" * self.bare


@dataclass(frozen=True, slots=True)
class Use:
    """The text of a variant; ``deeper`` by how many levels of indentation."""

    variant: Variant
    deeper: int = 0


@dataclass(frozen=True, slots=True)
class Line:
    """A line end, comments and empty lines, and the indentation of the next line."""

    deeper: int


@dataclass(frozen=True, slots=True)
class TextOptional:
    """A row that may be left out."""

    row: "TextRow"


@dataclass(frozen=True, slots=True)
class TextMany:
    """A row that stands at least once."""

    row: "TextRow"


@dataclass(frozen=True, slots=True)
class TextChoice:
    """One of several rows."""

    rows: tuple["TextRow", ...]


@dataclass(frozen=True, slots=True)
class CharacterClass:
    """One of the characters of a class, written as in regular expressions: ``[a-z]``."""

    text: str


TextItem: TypeAlias = Word | TokenKind | CharacterClass | Use | Line | TextOptional | TextMany | TextChoice
TextRow: TypeAlias = tuple[TextItem, ...]


def within(rows: tuple[TextRow, ...]) -> Iterator[TextItem]:
    """Yield all items in rows."""
    for row in rows:
        for item in row:
            yield item
            match item:
                case TextOptional() | TextMany():
                    yield from within((item.row,))
                case TextChoice():
                    yield from within(item.rows)
                case _:
                    pass
