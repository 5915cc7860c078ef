"""The texts of the grammars: Lark as llguidance reads it, and GBNF and EBNF as llama.cpp and xgrammar do.

Rules that depend on the level of indentation are there once for each level. (llguidance has rules with parameters, but follows
them in time that grows with the square of the text.)
"""

import json
from abc import ABC, abstractmethod
from collections.abc import Iterator
from typing import Final

from scenic.compiler.syntax import TokenKind, Word
from scenic.constrained.items import (
    CharacterClass,
    Line,
    TextChoice,
    TextItem,
    TextMany,
    TextOptional,
    TextRow,
    Use,
    Variant,
    within,
)
from scenic.constrained.layout import Laid
from scenic.constrained.terminals import INDENTATION, TokenDefinitions, letters

__all__ = ["MOST_LEVELS", "write_ebnf", "write_gbnf", "write_lark"]

MOST_LEVELS: Final = 8
"""The deepest level of indentation."""

_DIGITS: Final = "0123456789"
_ASCII_PARTS: Final = f"ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz{_DIGITS}_"


def write_lark(laid: Laid, tokens: TokenDefinitions) -> str:
    """Return the grammar in the dialect of Lark that llguidance reads."""
    return _Lark(laid, tokens).text()


def write_gbnf(laid: Laid, tokens: TokenDefinitions) -> str:
    """Return the grammar as llama.cpp reads it."""
    return _Gbnf(laid, tokens).text()


def write_ebnf(laid: Laid, tokens: TokenDefinitions) -> str:
    """Return the grammar as xgrammar reads it."""
    return _Ebnf(laid, tokens).text()


class _Writer(ABC):
    """Writes the rules; subclasses know the notation."""

    define = " ::= "

    def __init__(self, laid: Laid, tokens: TokenDefinitions) -> None:
        self._laid = laid
        self._tokens = tokens
        self._level = 0

    def text(self) -> str:
        return (
            "\n".join([*self.head(), *self._rules(), *self._lines(), *self._terminals(), *self.names()])
            + "\n"
        )

    @abstractmethod
    def head(self) -> Iterator[str]:
        """Return the beginning of the text: comments and the first rule."""

    @abstractmethod
    def rule(self, name: str) -> str:
        """The name of a rule."""

    @abstractmethod
    def token(self, name: str) -> str:
        """The name of the definition of a kind of tokens."""

    @abstractmethod
    def names(self) -> Iterator[str]:
        """The definitions of the kinds of names, which some words are not."""

    def characters(self, text: str) -> str:
        return text

    @property
    def whole(self) -> str:
        """All of a text."""
        return f"{self.token('EMPTY_LINES')}? {self._use(self._laid.start, 0)} {self.token('END')}"

    # Rules.

    def _rules(self) -> Iterator[str]:
        """Yield the definitions of all rules that a text needs, each once or once for each level."""
        dead = self._dead()
        pending = [(self._laid.start, 0)]
        variants_done = set(pending)
        while pending:
            variant, self._level = pending.pop()
            rows = tuple(row for row in self._laid.rules[variant] if self._is_alive(row, dead))
            yield self._definition(self._use(variant, 0), rows)
            for item in within(rows):
                if isinstance(item, Use):
                    level = self._level + item.deeper if item.variant in self._laid.nested else 0
                    if (item.variant, level) not in variants_done:
                        variants_done.add((item.variant, level))
                        pending.append((item.variant, level))
        self._level = 0

    def _dead(self) -> set[tuple[Variant, int]]:
        """Return the rules, with their levels, that need deeper levels than there are."""
        dead: set[tuple[Variant, int]] = set()
        for self._level in range(MOST_LEVELS, -1, -1):
            size = -1
            while size != len(dead):
                size = len(dead)
                for variant in self._laid.nested:
                    if not any(self._is_alive(row, dead) for row in self._laid.rules[variant]):
                        dead.add((variant, self._level))
        return dead

    def _is_alive(self, row: TextRow, dead: set[tuple[Variant, int]]) -> bool:
        return all(
            self._level + item.deeper <= MOST_LEVELS
            and not (isinstance(item, Use) and (item.variant, self._level + item.deeper) in dead)
            for item in within((row,))
            if isinstance(item, Use | Line)
        )

    def _definition(self, name: str, rows: tuple[TextRow, ...]) -> str:
        return f"{name}{self.define}{' | '.join(map(self._row, rows))}"

    def _use(self, variant: Variant, deeper: int) -> str:
        level = f"_{self._level + deeper}" if variant in self._laid.nested else ""
        return self.rule(variant.name + level)

    # Tokens.

    def _lines(self) -> Iterator[str]:
        for level in range(MOST_LEVELS + 1):
            blanks = f" {json.dumps(' ' * level * INDENTATION)}" if level else ""
            yield f"{self.token(f'LINE_{level}')}{self.define}{self.token('EMPTY_LINES')}{blanks}"

    def _terminals(self) -> Iterator[str]:
        for name, item in self._tokens.definitions.items():
            rows = item.rows if isinstance(item, TextChoice) else ((item,),)
            yield self._definition(self.token(name), rows)

    # Items.

    def _row(self, row: TextRow) -> str:
        return " ".join(map(self._item, row))

    def _item(self, item: TextItem) -> str:
        match item:
            case Word():
                return json.dumps(item.text)
            case TokenKind():
                return self.token(item.name)
            case CharacterClass():
                return self.characters(item.text)
            case Use():
                return self._use(item.variant, item.deeper)
            case Line():
                return self.token(f"LINE_{self._level + item.deeper}")
            case TextOptional(row=(TextMany(row=row),)):
                return f"{self._unit(row)}*"
            case TextOptional(row=row):
                return f"{self._unit(row)}?"
            case TextMany(row=row):
                return f"{self._unit(row)}+"
            case TextChoice():
                return f"({' | '.join(map(self._row, item.rows))})"

    def _unit(self, row: TextRow) -> str:
        is_single = len(row) == 1 and not isinstance(row[0], TextOptional | TextMany)
        return self._row(row) if is_single else f"({self._row(row)})"


class _Lark(_Writer):
    define = ": "

    def head(self) -> Iterator[str]:
        yield "// Scenic 3, in the dialect of Lark that llguidance reads."
        yield f"start: {self.whole}"

    def rule(self, name: str) -> str:
        return name

    def token(self, name: str) -> str:
        return name

    def characters(self, text: str) -> str:
        return f"/{text}/"

    def names(self) -> Iterator[str]:
        for kind, words in self._tokens.names.items():
            others = "|".join(sorted(words))
            yield f"{kind}: /[A-Za-z_{letters(first=True)}][A-Za-z0-9_{letters(first=False)}]*/ & ~/({others})/"


class _Gbnf(_Writer):
    def head(self) -> Iterator[str]:
        yield "# Scenic 3, in GBNF."
        yield f"root ::= {self.whole}"

    def rule(self, name: str) -> str:
        return name.replace("_", "-")

    def token(self, name: str) -> str:
        return self.rule(f"t_{name.lower()}")

    def names(self) -> Iterator[str]:
        """Yield trees of the beginnings of the words that are not names: a name leaves its tree somewhere."""
        rule = self.rule
        yield f"{rule('name_part')} ::= [A-Za-z0-9_{letters(first=False)}]"
        yield f"{rule('letter_beyond')} ::= [{letters(first=True)}]"
        yield f"{rule('part_beyond')} ::= [{letters(first=False)}]"
        for kind, words in self._tokens.names.items():
            for beginning in sorted({word[:length] for word in words for length in range(len(word) + 1)}):
                yield f"{self._after(kind, beginning)} ::= {' | '.join(self._ways(kind, words, beginning))}"

    def _ways(self, kind: str, words: frozenset[str], beginning: str) -> Iterator[str]:
        """The ways to go on after the beginning of one of ``words``, so that none of them results."""
        following = sorted(
            {word[len(beginning)] for word in words if word.startswith(beginning) and word != beginning}
        )
        if beginning and beginning not in words:
            yield '""'
        for letter in following:
            yield f'"{letter}" {self._after(kind, beginning + letter)}'
        others = "".join(
            character
            for character in _ASCII_PARTS
            if character not in following and (beginning or character not in _DIGITS)
        )
        beyond = self.rule("part_beyond" if beginning else "letter_beyond")
        yield f"([{others}] | {beyond}) {self.rule('name_part')}*"

    def _after(self, kind: str, beginning: str) -> str:
        return self.rule(f"{kind.lower()}_after_{beginning}") if beginning else self.token(kind)


class _Ebnf(_Gbnf):
    def head(self) -> Iterator[str]:
        yield "# Scenic 3, in EBNF as xgrammar reads it."
        yield f"root ::= {self.whole}"

    def rule(self, name: str) -> str:
        return name
