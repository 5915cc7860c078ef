"""Tracing of the grammar's alternatives that a text uses.

`TracingParser` is made from the grammar in memory, for tests and for the fuzzer; nothing of it is shipped.

An alternative is *reached* by a text if it is part of the derivation that the text's tree is made of; one that was
tried and given up for another is not. So it is not enough that the items of an alternative match: its action has to
accept them, and all that encloses them has to match, too. What lookaheads look at is not part of the tree and does not
count; but which of several tokens a positive lookahead found does.

How that is known: the position in the text, which all functions of the parser share, carries the way to it, as a list
that is linked backwards. A parser that gives something up puts the position back, and with it the way; there is nothing
to undo. What is memoised is the way through a rule alone, which is appended to the way there. An operator of the ladder
is noted when its loop has applied it; a step that applied none notes the alternative that is just its operand, which in
a left-recursive rule is where every derivation starts. Alternatives with a common beginning are parsed together, but
each is noted by itself, at its end.
"""

from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from typing import Any, NamedTuple, Self

from grammar.generator.analysis import Analysis
from grammar.generator.emitter import Emitter
from grammar.generator.model import (
    Alternative,
    BlockEnded,
    Cut,
    Gather,
    Grammar,
    Item,
    Look,
    Optional,
    Reference,
    Repeat,
    TokenChoice,
    is_varied,
)

__all__ = [
    "AlternativeId",
    "Choice",
    "Position",
    "Trace",
    "TracingParser",
    "alternatives",
    "choices",
    "explain",
]


class AlternativeId(NamedTuple):
    """An alternative of a rule of the grammar; ``number`` counts from 1."""

    rule: str
    number: int

    def __str__(self) -> str:
        return f"{self.rule}/{self.number}"


class Choice(NamedTuple):
    """A choice at one place of the grammar, which a text may make or not.

    With ``item`` 0 it is to use the alternative; otherwise ``outcome`` is the form that the item with this number, from
    1, has there: ``absent`` or ``present``, ``one`` or ``several``, or one of several tokens.
    """

    alternative: AlternativeId
    item: int = 0
    outcome: str = ""


class Match(NamedTuple):
    """One use of an alternative; ``values`` are those of its items of several forms."""

    rule: str
    number: int
    values: tuple[Any, ...]


class Position(int):
    """The index of the next token, and the matches that led there."""

    way: tuple[Any, ...] | None

    def __new__(cls, index: int, way: tuple[Any, ...] | None = None) -> Self:
        position = super().__new__(cls, index)
        position.way = way
        return position

    def __add__(self, count: int) -> "Position":
        return Position(int(self) + count, self.way)

    def after(self, rule: str, number: int, *values: Any) -> "Position":
        """This position, with one match more; lists are copied, since actions may change them later."""
        kept = tuple(tuple(value) if type(value) is list else value for value in values)
        return Position(int(self), (self.way, Match(rule, number, kept)))

    def through(self, other: "Position") -> "Position":
        """Return the position ``other``, reached from this one by the way that it carries."""
        return Position(int(other), (self.way, other.way))

    def matches(self) -> Iterator[Match]:
        """All matches on the way, the last one first."""
        stack: list[Any] = [self.way]
        while stack:
            way = stack.pop()
            if isinstance(way, Match):
                yield way
            elif way is not None:
                stack += way


def alternatives(grammar: Grammar) -> Mapping[AlternativeId, Alternative]:
    """Return the alternatives that a derivation can use, by their identity, in the order of the grammar.

    Left out are rules that are only looked at, and groups of one alternative, which are used with the one around them.
    """
    rule_names: set[str] = set()
    stack = [grammar.start]
    while stack:
        name = stack.pop()
        if name not in rule_names:
            rule_names.add(name)
            stack += _references(
                entry.item for alternative in grammar.rules[name].alternatives for entry in alternative.items
            )
    return {
        AlternativeId(rule.name, number): alternative
        for rule in grammar.rules.values()
        if rule.name in rule_names
        for number, alternative in enumerate(rule.alternatives, 1)
    }


def _references(items: Iterable[Item]) -> Iterator[str]:
    for item in items:
        match item:
            case Reference():
                yield item.rule
            case Optional() | Repeat() | Gather():
                yield from _references([item.item])
            case _:
                pass


def choices(grammar: Grammar) -> tuple[Choice, ...]:
    """Return all choices of a text, in the order of the grammar."""
    found: list[Choice] = []
    for identity, alternative in alternatives(grammar).items():
        rule = grammar.rules[identity.rule]
        if not (rule.lifted and len(rule.alternatives) == 1):
            found.append(Choice(identity))
        for number, named in enumerate(alternative.items, 1):
            found += (Choice(identity, number, outcome) for outcome in _outcomes(named.item))
    return tuple(found)


def _outcomes(item: Item) -> Iterator[str]:
    """The forms that an item can have."""
    match item:
        case Optional():
            yield "absent"
            yield "present"
            yield from _outcomes(item.item)
        case Repeat(at_least_one=False):
            yield "absent"
            yield "present"
        case Repeat() | Gather():
            yield "one"
            yield "several"
        case TokenChoice():
            yield from (str(token) for token in item.tokens)
        case Look(item=TokenChoice() as inner, positive=True):
            yield from _outcomes(inner)
        case _:
            pass
    if isinstance(item, Repeat | Gather):
        yield from _outcomes(item.item)


@dataclass(frozen=True, slots=True)
class Trace:
    """The tree of a text, ``None`` if it is wrong, and what it does to get there."""

    tree: Any
    choices: frozenset[Choice]


class TracingParser:
    """A parser that records the alternatives of ``grammar`` that a text uses."""

    def __init__(self, grammar: Grammar) -> None:
        self._grammar = grammar
        self._analysis = Analysis(grammar)
        self._choices = frozenset(choices(grammar))
        names: dict[str, Any] = {}
        text = Emitter(self._analysis, tracing=True).emit("# Made in memory by grammar/tracing.py.")
        exec(compile(text, "<tracing parser>", "exec"), names)
        self._build = names["build"]

    def parse(self, lists: Sequence[Sequence[Any]], actions: Any) -> Trace:
        """Parse tokens, given as the lists that a generated parser takes, and build the tree with ``actions``."""
        kinds = lists[0]
        tree, position = self._build(*lists, actions)(self._grammar.start, 0)
        if tree is None:
            return Trace(None, frozenset())
        choices: set[Choice] = set()
        for match in position.matches():
            identity = AlternativeId(match.rule, match.number)
            choices.add(Choice(identity))
            items = self._grammar.rules[match.rule].alternatives[match.number - 1].items
            variable_items = [
                (number, entry.item) for number, entry in enumerate(items, 1) if is_varied(entry.item)
            ]
            for (number, item), value in zip(variable_items, match.values, strict=True):
                choices.update(Choice(identity, number, each) for each in self._found(item, value, kinds))
        return Trace(tree, self._choices & choices)

    def _found(self, item: Item, value: Any, kinds: Sequence[int]) -> Iterator[str]:
        """The forms that an item has, whose value is ``value``."""
        match item:
            case Optional():
                yield "absent" if value is None else "present"
                if value is not None:
                    yield from self._found(item.item, value, kinds)
            case Repeat(at_least_one=False):
                yield "present" if value else "absent"
            case Repeat() | Gather():
                yield "several" if len(value) > 1 else "one"
            case TokenChoice():
                kind = kinds[value]
                yield next(str(token) for token in item.tokens if kind in self._analysis.kinds_of(token))
            case Look():
                yield from self._found(item.item, value, kinds)
            case _:
                pass
        if isinstance(item, Repeat | Gather):
            for each in value:
                yield from self._found(item.item, each, kinds)


def explain(grammar: Grammar, choice: Choice) -> str:
    """Describe a choice in words, with the text of its alternative."""
    alternative = grammar.rules[choice.alternative.rule].alternatives[choice.alternative.number - 1]
    text = _written(grammar, alternative)
    if not choice.item:
        return f"{choice.alternative}: {text}"
    item = _written_item(grammar, alternative.items[choice.item - 1].item)
    return f"{choice.alternative}: {choice.outcome} for {item} in {text}"


def _written(grammar: Grammar, alternative: Alternative) -> str:
    return " ".join(_written_item(grammar, named.item) for named in alternative.items)


def _written_item(grammar: Grammar, item: Item) -> str:
    """An item about as it is written in the grammar."""
    match item:
        case Reference():
            rule = grammar.rules[item.rule]
            if not rule.lifted:
                return rule.name
            return "(" + " | ".join(_written(grammar, each) for each in rule.alternatives) + ")"
        case TokenChoice():
            return "(" + " | ".join(map(str, item.tokens)) + ")"
        case Optional():
            return _written_item(grammar, item.item) + "?"
        case Repeat():
            return _written_item(grammar, item.item) + ("+" if item.at_least_one else "*")
        case Gather():
            return f"{_written_item(grammar, item.separator)}.{_written_item(grammar, item.item)}+"
        case Look():
            return ("&" if item.positive else "!") + _written_item(grammar, item.item)
        case Cut():
            return "~"
        case BlockEnded():
            return "BLOCK_ENDED"
        case _:
            return str(item)
