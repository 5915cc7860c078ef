"""The grammar as the generator sees it: rules of alternatives of items, groups lifted to rules of their own."""

from collections.abc import Mapping
from dataclasses import dataclass
from typing import TypeAlias


class GrammarError(Exception):
    """The grammar cannot be used; the message gives the rule and the reason."""


@dataclass(frozen=True, slots=True)
class Token:
    """One token: a word or operator as it is written, or a kind such as ``NAME``.

    ``soft`` tells ``"word"`` from ``'word'``; ``literal`` tells both from a kind.
    """

    text: str
    literal: bool
    soft: bool = False

    def __str__(self) -> str:
        if not self.literal:
            return self.text
        return f'"{self.text}"' if self.soft else f"'{self.text}'"


@dataclass(frozen=True, slots=True)
class TokenChoice:
    """One of several tokens."""

    tokens: tuple[Token, ...]


@dataclass(frozen=True, slots=True)
class Reference:
    """A reference to another rule; it matches the text that the rule matches."""

    rule: str


@dataclass(frozen=True, slots=True)
class Optional:
    """``item?``."""

    item: "Item"


@dataclass(frozen=True, slots=True)
class Repeat:
    """``item*`` or ``item+``."""

    item: "Item"
    at_least_one: bool


@dataclass(frozen=True, slots=True)
class Gather:
    """``separator.item+``."""

    separator: "Item"
    item: "Item"


@dataclass(frozen=True, slots=True)
class Look:
    """``&item`` or ``!item``."""

    item: "Item"
    positive: bool


@dataclass(frozen=True, slots=True)
class Cut:
    """``~``."""


@dataclass(frozen=True, slots=True)
class BlockEnded:
    """``BLOCK_ENDED``."""


Item: TypeAlias = Token | TokenChoice | Reference | Optional | Repeat | Gather | Look | Cut | BlockEnded


def is_varied(item: Item) -> bool:
    """Return whether an item matches in several forms: absent or present, one or several, one of several tokens."""
    if isinstance(item, Look):
        return item.positive and isinstance(item.item, TokenChoice)
    return isinstance(item, Optional | Repeat | Gather | TokenChoice)


@dataclass(frozen=True, slots=True)
class Named:
    """An item and the variable that its value gets, if any."""

    item: Item
    name: str | None


@dataclass(frozen=True, slots=True)
class Alternative:
    """Items in a row, and the action that makes the value of them."""

    items: tuple[Named, ...]
    action: str | None


@dataclass(frozen=True, slots=True)
class Rule:
    """A rule; ``label`` is what messages call what it matches. Those with ``lifted`` were groups."""

    name: str
    alternatives: tuple[Alternative, ...]
    label: str | None = None
    memo: bool = False
    lifted: bool = False


@dataclass(frozen=True, slots=True)
class Vocabulary:
    """The kinds of all words: hard keywords and operators from 16, soft keywords from 257."""

    hard_keywords: Mapping[str, int]
    operators: Mapping[str, int]
    soft_keywords: Mapping[str, int]

    def kind(self, token: Token) -> int:
        """Return the kind of a token."""
        if not token.literal:
            return KINDS[token.text]
        table = self.soft_keywords if token.soft else {**self.hard_keywords, **self.operators}
        return table[token.text]

    def describe(self, kind: int) -> str:
        """The name of a kind, for comments in what is generated."""
        for table in (self.hard_keywords, self.operators, self.soft_keywords):
            for word, value in table.items():
                if value == kind:
                    return word
        return next(name for name, value in KINDS.items() if value == kind)


@dataclass(frozen=True, slots=True)
class Grammar:
    """All rules in order, the start rule, and the rules after whose mistakes a loop continues."""

    rules: Mapping[str, Rule]
    start: str
    recover: frozenset[str]
    vocabulary: Vocabulary
    digest: str


KINDS = {
    "ENDMARKER": 0,
    "NEWLINE": 1,
    "INDENT": 2,
    "DEDENT": 3,
    "NUMBER": 4,
    "STRING": 5,
    "FSTRING_START": 6,
    "FSTRING_MIDDLE": 7,
    "FSTRING_END": 8,
    "NAME": 256,
}
"""The kinds that the lexer fixes."""

ERROR = 9
"""The kind of text that is not a token; nothing in a grammar matches it."""

FIRST_WORD_KIND = 16
NAME = KINDS["NAME"]
LAYOUT = frozenset({KINDS["ENDMARKER"], KINDS["NEWLINE"], KINDS["INDENT"], KINDS["DEDENT"]})
