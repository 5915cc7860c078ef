"""The rules of the grammar as data, and what follows from them: which words begin statements, blocks and operands.

Lookaheads and most of the actions are left out, so a row says what a text consists of, not which of several readings wins.
"""

from collections.abc import Iterable, Iterator, Mapping
from itertools import pairwise
from types import MappingProxyType
from typing import Any, Final, TypeAlias

from scenic.compiler.generated import HARD_KEYWORDS, SOFT_KEYWORDS, syntax_rules
from scenic.dataclass import dataclass

__all__ = [
    "BLOCK_STARTERS",
    "OPERAND_WORDS",
    "RULES",
    "SOFT_STATEMENT_WORDS",
    "STATEMENT_FORMS",
    "STATEMENT_WORDS",
    "Alternative",
    "Choice",
    "ConstantField",
    "Item",
    "ListOf",
    "Many",
    "Optional",
    "Row",
    "Rule",
    "RuleReference",
    "StatementForm",
    "TokenKind",
    "Word",
    "first_words",
    "reached_from",
    "read_row",
    "words_in",
    "words_of",
]


@dataclass(frozen=True, slots=True)
class Word:
    """A keyword or operator as it is written."""

    text: str


@dataclass(frozen=True, slots=True)
class TokenKind:
    """A token of varying text, such as ``NAME``, or of layout, such as ``NEWLINE``."""

    name: str


@dataclass(frozen=True, slots=True)
class RuleReference:
    """The text that another rule matches."""

    rule: str


@dataclass(frozen=True, slots=True)
class Optional:
    """A row that may be left out."""

    row: "Row"


@dataclass(frozen=True, slots=True)
class Many:
    """A row that stands at least once."""

    row: "Row"


@dataclass(frozen=True, slots=True)
class ListOf:
    """A row that stands at least once, with a separator in between."""

    row: "Row"
    separator: "Row"


@dataclass(frozen=True, slots=True)
class Choice:
    """One of several rows."""

    rows: tuple["Row", ...]


Item: TypeAlias = Word | TokenKind | RuleReference | Optional | Many | ListOf | Choice
Row: TypeAlias = tuple[Item, ...]


@dataclass(frozen=True, slots=True)
class Alternative:
    """One way to write what a rule matches.

    ``node`` is the class of the node that it makes, if it makes one. ``fields`` tells of each field of that node which item of the
    row gives its value, by index, or which constant it is; ``None`` if some field is computed otherwise.
    """

    row: Row
    node: str | None
    fields: Mapping[str, "int | ConstantField"] | None = None


@dataclass(frozen=True, slots=True)
class ConstantField:
    """A value that a field of a node has whatever the text."""

    value: object


@dataclass(frozen=True, slots=True)
class Rule:
    """A rule; ``label`` is what messages call what it matches."""

    name: str
    label: str | None
    alternatives: tuple[Alternative, ...]


@dataclass(frozen=True, slots=True)
class StatementForm:
    """One way to write a statement, or a clause of one, that starts with a word.

    ``row`` begins with that word, ``start``. ``node`` is the class of the node that it makes, ``None`` where an action
    decides. ``has_block`` tells whether a block follows its header.
    """

    rule: str
    node: str | None
    row: Row
    start: str
    has_block: bool

    @property
    def is_soft(self) -> bool:
        """Return whether it starts with a word that is a name elsewhere."""
        return self.start in SOFT_KEYWORDS


def _item(raw: tuple[Any, ...]) -> Item:
    match raw:
        case ("word", text):
            return Word(text)
        case ("kind", name):
            return TokenKind(name)
        case ("rule", name):
            return RuleReference(name)
        case ("optional", row):
            return Optional(read_row(row))
        case ("many", row):
            return Many(read_row(row))
        case ("list", row, separator):
            return ListOf(read_row(row), read_row(separator))
        case ("choice", rows):
            return Choice(tuple(read_row(row) for row in rows))
    raise ValueError(f"the generated rules hold {raw!r}, which is no item")


def read_row(raw: Iterable[tuple[Any, ...]]) -> Row:
    """Return the items that a generated row stands for."""
    return tuple(_item(each) for each in raw)


def _fields(raw: Iterable[tuple[str, str, Any]] | None) -> Mapping[str, int | ConstantField] | None:
    if raw is None:
        return None
    return MappingProxyType(
        {field: value if source == "item" else ConstantField(value) for field, source, value in raw}
    )


RULES: Final[Mapping[str, Rule]] = MappingProxyType(
    {
        name: Rule(
            name,
            label,
            tuple(Alternative(read_row(row), node, _fields(made)) for row, node, made in alternatives),
        )
        for name, (label, alternatives) in syntax_rules().items()
    }
)
"""All rules, in the order of the grammar."""


def _within(row: Row) -> Iterator[Item]:
    """The items of a row and all items within them, in order."""
    for item in row:
        yield item
        match item:
            case Optional() | Many():
                yield from _within(item.row)
            case ListOf():
                yield from _within(item.row)
                yield from _within(item.separator)
            case Choice():
                for each in item.rows:
                    yield from _within(each)
            case _:
                pass


def reached_from(*rules: str) -> frozenset[str]:
    """Return the rules that these need, themselves included; those that do not exist are left out."""
    reached_rules: set[str] = set()
    stack = [rule for rule in rules if rule in RULES]
    while stack:
        rule = stack.pop()
        if rule not in reached_rules:
            reached_rules.add(rule)
            for alternative in RULES[rule].alternatives:
                stack += [item.rule for item in _within(alternative.row) if isinstance(item, RuleReference)]
    return frozenset(reached_rules)


def words_in(rules: Iterable[str]) -> frozenset[str]:
    """Return the keywords in the rows of rules."""
    return frozenset(
        word
        for rule in rules
        for alternative in RULES[rule].alternatives
        for word in words_of(alternative.row)
    )


def words_of(row: Row) -> Iterator[str]:
    """The keywords in a row itself, in order."""
    return (item.text for item in _within(row) if isinstance(item, Word) and item.text.isidentifier())


def first_words(row: Row) -> frozenset[str]:
    """Return the keywords and operators that a row can begin with, as such and not as names."""
    words: set[str] = set()
    rules: set[str] = set()
    stack = [row]
    while stack:
        for item in stack.pop():
            match item:
                case Word():
                    words.add(item.text)
                case RuleReference() if item.rule not in rules:
                    rules.add(item.rule)
                    stack += [each.row for each in RULES[item.rule].alternatives]
                case Optional() | Many() | ListOf():
                    stack.append(item.row)
                case Choice():
                    stack += item.rows
                case _:
                    pass
            if not isinstance(item, Optional):
                break
    return frozenset(words)


_OPERANDS: Final = ("expression", "specifier", "temporal_expression", "case_pattern", "targets", "parameters")
"""The rules of what stands within statements."""

_OF_OPERANDS: Final = reached_from(*_OPERANDS)

OPERAND_WORDS: Final = words_in(_OF_OPERANDS)
"""The keywords that expressions, specifiers, conditions, patterns and parameters hold."""

_OF_STATEMENTS: Final = reached_from("statement") - _OF_OPERANDS

_BLOCKS: Final = frozenset(
    rule.name for rule in RULES.values() for each in rule.alternatives if TokenKind("INDENT") in each.row
)


def _alone(rule: str) -> Iterator[str]:
    """Yield the rule, and those that can be all that it matches."""
    yield rule
    for each in RULES[rule].alternatives if rule in RULES else ():
        match each.row:
            case (RuleReference(rule=inner), *_) if inner not in _OF_OPERANDS:
                yield from _alone(inner)


def _statement_forms() -> Iterator[StatementForm]:
    whole = frozenset(_alone("statement"))
    for rule in (name for name in RULES if name in _OF_STATEMENTS):
        for alternative in RULES[rule].alternatives:
            row = alternative.row
            starts = [item.text for item in row if isinstance(item, Word) and item.text.isidentifier()]
            has_block = any(isinstance(item, RuleReference) and item.rule in _BLOCKS for item in row) or any(
                pair == (Word(":"), TokenKind("NEWLINE")) for pair in pairwise(row)
            )
            if starts and (has_block or (row[0] == Word(starts[0]) and (alternative.node or rule in whole))):
                rest = row[row.index(Word(starts[0])) :]
                yield StatementForm(rule, alternative.node, rest, starts[0], has_block)


STATEMENT_FORMS: Final = tuple(_statement_forms())
"""All statements and clauses that start with a word, Python's and Scenic's, in the order of the grammar."""

BLOCK_STARTERS: Final = frozenset(form.start for form in STATEMENT_FORMS if form.has_block)
"""The first words of lines that begin a block."""

STATEMENT_WORDS: Final = frozenset(
    form.start for form in STATEMENT_FORMS if form.start in HARD_KEYWORDS and form.start not in OPERAND_WORDS
)
"""The words that begin statements and nothing else."""

SOFT_STATEMENT_WORDS: Final = frozenset(
    form.start for form in STATEMENT_FORMS if form.is_soft and not form.has_block
)
"""The words that begin statements without blocks, and are names elsewhere."""
