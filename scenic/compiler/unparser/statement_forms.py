"""The texts of statements as the grammar has them: for statements that need no writer of their own.

A form is one alternative of the grammar that makes the node of a statement. It can write a node if it gives every field by
a constant or by an operand that this module knows.
"""

import ast
from collections.abc import Iterator, Mapping
from itertools import chain
from types import MappingProxyType
from typing import Any, Final

from scenic.compiler.syntax import RULES, Alternative, Constant, Item, ListOf, Optional, Reference, Word
from scenic.compiler.unparser.places import DO, PREFIX, RECORD, REQUIRE, level_of
from scenic.dataclass import dataclass
from scenic.language.statements import STATEMENTS

__all__ = ["FORMS", "StatementText", "TextPart", "form_of"]

_FLAGS: Final = MappingProxyType({"do": DO, "record": RECORD, "require": REQUIRE})
"""The flags of the operand that follows the first word of a statement."""

_OPERANDS: Final = frozenset({"dotted_name", "duration", "name_load", "requirement_name", "specifier"})
"""Rules of operands that are not expressions."""


@dataclass(frozen=True, slots=True)
class TextPart:
    """An operand of a statement.

    ``rule`` is the rule of the grammar that it matches, ``level`` the loosest level that an expression may have there, ``lead``
    how the parser reads its first words. ``word`` stands before an operand that may be left out, or is empty.
    """

    field: str
    rule: str
    level: int
    lead: int
    is_list: bool = False
    may_be_left_out: bool = False
    word: str = ""

    @property
    def first_word(self) -> str:
        """The word that its text begins with, where that is always the same."""
        if self.word:
            return self.word
        firsts = {each.row[0] for each in RULES[self.rule].alternatives}
        only = firsts.pop()
        return only.text if isinstance(only, Word) and not firsts else ""


@dataclass(frozen=True, slots=True)
class StatementText:
    """One form of a statement: its words and operands in order, and the values that other fields have."""

    parts: tuple[str | TextPart, ...]
    constants: tuple[tuple[str, object], ...]

    def fits(self, node: ast.AST) -> bool:
        """Return whether a node can be written so."""
        return all(getattr(node, field) == value for field, value in self.constants) and all(
            part.may_be_left_out or getattr(node, part.field) not in (None, [])
            for part in self.parts
            if isinstance(part, TextPart)
        )


def _part(field: str, item: Item, lead: int) -> TextPart | None:
    match item:
        case Reference(rule=rule):
            pass
        case ListOf(row=(Reference(rule=rule),), separator=(Word(","),)):
            part = _part(field, Reference(rule), lead)
            return part and TextPart(field, rule, part.level, part.lead, is_list=True)
        case Optional(row=(Reference(rule=rule),)):
            part = _part(field, Reference(rule), 0)
            return part and TextPart(field, rule, part.level, part.lead, may_be_left_out=True)
        case Optional(row=(Word(text=word), Reference(rule=rule))):
            part = _part(field, Reference(rule), 0)
            return part and TextPart(field, rule, part.level, part.lead, may_be_left_out=True, word=word)
        case _:
            return None
    level = level_of(rule)
    if level is not None:
        return TextPart(field, rule, level, lead | (PREFIX if level <= _LOOSE else 0))
    return TextPart(field, rule, 0, 0) if rule in _OPERANDS else None


_LOOSE: Final = level_of("prefix") or 0


def _text(alternative: Alternative) -> StatementText | None:
    if alternative.fields is None:
        return None
    by_index = {index: field for field, index in alternative.fields.items() if isinstance(index, int)}
    constants = [
        (field, [] if value.value == () else value.value)
        for field, value in alternative.fields.items()
        if isinstance(value, Constant)
    ]
    parts: list[str | TextPart] = []
    for index, item in enumerate(alternative.row):
        if index in by_index:
            first = parts[0] if len(parts) == 1 else ""
            part = _part(by_index[index], item, _FLAGS.get(str(first), 0))
            if part is None:
                return None
            parts.append(part)
        elif isinstance(item, Word):
            parts.append(item.text)
        else:
            return None
    return StatementText(tuple(parts), tuple(constants))


def _forms(node: str) -> Iterator[StatementText]:
    for alternative in chain.from_iterable(rule.alternatives for rule in RULES.values()):
        if alternative.node == node and (text := _text(alternative)) is not None:
            yield text


FORMS: Final[Mapping[str, tuple[StatementText, ...]]] = MappingProxyType(
    {node: forms for node in STATEMENTS if (forms := tuple(_forms(node)))}
)
"""The forms of each statement, by the name of its node."""


def form_of(node: Any) -> StatementText | None:
    """The first form that a node can be written in."""
    return next((form for form in FORMS[type(node).__name__] if form.fits(node)), None)
