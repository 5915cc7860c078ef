"""The ways to derive a sentence from each rule of the grammar, shortest first.

`Derivations` joins ``grammar/scenic.gram`` with ``fuzz/narrowing.gram``, which says what actions and lookaheads demand.
Alternatives that consist of one rule are replaced by those of that rule, so that one choice makes an operator of any
precedence instead of one choice for each step of the ladder.
"""

import re
from collections.abc import Callable, Iterable, Iterator, Mapping
from dataclasses import dataclass, replace
from functools import cached_property
from pathlib import Path
from types import MappingProxyType
from typing import Final, TypeAlias

from fuzz.weights import WEIGHTS
from grammar.generator import read_grammar, read_grammar_text
from grammar.generator.model import (
    Alternative,
    BlockEnded,
    Cut,
    Gather,
    Grammar,
    GrammarError,
    Item,
    Look,
    Optional,
    Reference,
    Repeat,
    Rule,
    Token,
)
from grammar.tracing import AlternativeId, choices

__all__ = ["AlternativeId", "Derivations", "Option", "load"]

_INFINITE: Final = 10**6
_HERE: Final = Path(__file__).resolve().parent


@dataclass(frozen=True, slots=True)
class Option:
    """One way to expand a rule.

    ``counts_as`` are the alternatives of the grammar that it uses, ``rule`` is the one whose items these are.
    ``height`` is the number of expansions from here down in its shortest sentence, ``weight`` how often it is
    chosen. ``leads_to`` are the rules among its items, with the index of the item. ``start`` and ``second``
    are its first words if they are fixed; ``has_colon`` tells whether ``:`` stands outside its brackets.
    """

    rule: str
    counts_as: tuple[AlternativeId, ...]
    items: tuple[Item, ...]
    height: int
    weight: float
    leads_to: tuple[tuple[str, int], ...]
    start: str | None
    second: str | None
    has_colon: bool


@dataclass(frozen=True, slots=True)
class _Source:
    """An alternative as generation uses it."""

    rule: str
    counts_as: tuple[AlternativeId, ...]
    items: tuple[Item, ...]


_Path: TypeAlias = tuple[_Source, ...]
"""Alternatives of one rule each, and one of other items at the end."""


class Derivations:
    """All options of all rules of a grammar, narrowed by a second one.

    ``weights`` says how often an alternative, or those of a rule, are chosen, compared to others.

    Raises `GrammarError` if the narrowing refers to what the grammar does not have.
    """

    def __init__(
        self, grammar: Grammar, narrowing: Grammar, weights: Mapping[str, float] = MappingProxyType({})
    ) -> None:
        self.grammar = grammar
        self._alternatives = {
            AlternativeId(rule.name, number): alternative
            for rule in grammar.rules.values()
            for number, alternative in enumerate(rule.alternatives, 1)
        }
        self._sources: dict[str, tuple[_Source, ...]] = {}
        self._replaced: dict[AlternativeId, tuple[Item, ...]] = {}
        for rule in narrowing.rules.values():
            self._narrow(rule)
        for rule in grammar.rules.values():
            self._sources[rule.name] = tuple(
                self._source_of(AlternativeId(rule.name, number))
                for number in range(1, len(rule.alternatives) + 1)
            )
        for name in [
            item.rule
            for sources in list(self._sources.values())
            for source in sources
            for item in _within(source.items)
            if isinstance(item, Reference) and item.rule not in self._sources
        ]:
            self._sources[name] = (self._source_of(self._resolve(name)),)
        self._heights = self._all_heights()
        self._weights = {self._weighted(name): weight for name, weight in weights.items()}

    def _weighted(self, name: str) -> AlternativeId | str:
        """Return the alternative, or the rule for all its alternatives, that a name in the table of weights denotes."""
        if "__" in name:
            return self._resolve(name)
        if name not in self._sources:
            raise GrammarError(f"weights: there is no rule {name!r}")
        return name

    # Reading the narrowing.

    def _narrow(self, rule: Rule) -> None:
        if "__" in rule.name:
            target = self._resolve(rule.name)
            if len(rule.alternatives) != 1 or target in self._replaced:
                raise GrammarError(f"narrowing of {target}: there has to be one row of items")
            self._replaced[target] = self._items(rule.alternatives[0])
        else:
            name = _renamed(rule)
            if name in self.grammar.rules:
                raise GrammarError(f"narrowing: {name!r} is a rule of the grammar")
            self._sources[name] = tuple(
                _Source(name, tuple(map(self._resolve, _keys(each))), self._items(each))
                for each in rule.alternatives
            )

    def _items(self, alternative: Alternative) -> tuple[Item, ...]:
        return tuple(_map_references(named.item, _renamed_reference) for named in alternative.items)

    def _source_of(self, alternative: AlternativeId) -> _Source:
        items = self._replaced.get(alternative)
        if items is None:
            items = tuple(
                named.item
                for named in self._alternatives[alternative].items
                if not isinstance(named.item, Look | Cut | BlockEnded)
            )
        return _Source(alternative.rule, (alternative,), items)

    def _resolve(self, name: str) -> AlternativeId:
        """The alternative that a name of the form ``rule__key`` or ``rule__key__number`` means."""
        rule, _, key = name.partition("__")
        if rule not in self.grammar.rules or not key:
            raise GrammarError(f"narrowing: there is no rule {name!r}")
        count = len(self.grammar.rules[rule].alternatives)
        if key.isdecimal():
            candidates = [int(key)] if 1 <= int(key) <= count else []
        else:
            key, _, nth = key.partition("__")
            numbers = range(1, count + 1)
            candidates = [
                number for number in numbers if key in _words(self._alternatives[AlternativeId(rule, number)])
            ]
            if nth:
                candidates = candidates[int(nth) - 1 : int(nth)]
            elif len(candidates) > 1:
                candidates = [
                    number
                    for number in candidates
                    if _only_reference(self._source_of(AlternativeId(rule, number)).items) == key
                ]
        if len(candidates) != 1:
            raise GrammarError(f"narrowing: {name!r} means {len(candidates)} alternatives, not one")
        return AlternativeId(rule, candidates[0])

    def alternative(self, identity: AlternativeId) -> Alternative:
        """Return the alternative of the grammar with this identity."""
        return self._alternatives[identity]

    # Options.

    @cached_property
    def countable(self) -> frozenset[AlternativeId]:
        """The alternatives whose coverage is counted: all that the start rule needs, but trivial groups."""
        return frozenset(choice.alternative for choice in choices(self.grammar) if not choice.item)

    @cached_property
    def options(self) -> Mapping[str, tuple[Option, ...]]:
        """The options of every rule, the simplest first; equally simple ones in the order of the grammar."""
        return {rule: self._options_of(rule) for rule in self._sources}

    def _options_of(self, rule: str) -> tuple[Option, ...]:
        found = [self._option(path, weight) for path, weight in self._flattened(rule, frozenset())]
        return tuple(sorted(found, key=_simplicity))

    def _option(self, path: _Path, weight: float) -> Option:
        source = path[-1]
        start, second = _leading(source.items)
        return Option(
            source.rule,
            tuple(each for step in path for each in step.counts_as),
            source.items,
            self._height_of(source.items, self._heights),
            weight,
            tuple((rule, index) for index, item in enumerate(source.items) for rule in _references((item,))),
            start,
            second,
            _has_colon(source.items),
        )

    def _flattened(self, rule: str, seen: frozenset[str]) -> list[tuple[_Path, float]]:
        paths: list[tuple[_Path, float]] = []
        for source in self._sources[rule]:
            target = _only_reference(source.items)
            weight_of_source = self._weights.get(source.rule, 1.0)
            for alternative in source.counts_as:
                weight_of_source *= self._weights.get(alternative, 1.0)
            if target is None:
                paths.append(((source,), weight_of_source))
            elif target not in seen and target != rule:
                inner = self._flattened(target, seen | {rule})
                # Otherwise the many operators would crowd out the few other statements.
                factor = weight_of_source * len(inner) ** 0.5 / sum(weight for _, weight in inner)
                paths += (((source, *path), weight * factor) for path, weight in inner)
        return paths

    def distances(self, aim: AlternativeId) -> Mapping[str, int]:
        """Return the least number of expansions from each rule to the alternative ``aim``; 0 if one is enough."""
        distances: dict[str, int] = {}
        frontier = {
            rule
            for rule, sources in self._sources.items()
            if any(aim in source.counts_as for source in sources)
        }
        distance = 0
        while frontier:
            distances.update(dict.fromkeys(frontier, distance))
            distance += 1
            frontier = {
                user for rule in frontier for user in self._users.get(rule, ()) if user not in distances
            }
        return distances

    @cached_property
    def _users(self) -> Mapping[str, frozenset[str]]:
        """The rules that refer to each rule."""
        users: dict[str, set[str]] = {}
        for rule, sources in self._sources.items():
            for target in _references(item for source in sources for item in source.items):
                users.setdefault(target, set()).add(rule)
        return {rule: frozenset(found) for rule, found in users.items()}

    def height(self, rule: str) -> int:
        """The number of expansions, one within the other, in the shortest sentence of ``rule``."""
        return self._heights[rule]

    def item_height(self, item: Item) -> int:
        """Return the height that an item needs if it is there; that of a token is 0."""
        match item:
            case Reference():
                return self._heights.get(item.rule, 0)
            case Optional() | Repeat():
                return self.item_height(item.item)
            case Gather():
                return max(self.item_height(item.item), self.item_height(item.separator))
            case _:
                return 0

    def _all_heights(self) -> dict[str, int]:
        heights = dict.fromkeys(self._sources, _INFINITE)
        is_changing = True
        while is_changing:
            is_changing = False
            for rule, sources in self._sources.items():
                height = min(
                    heights[target]
                    if (target := _only_reference(source.items)) is not None
                    else self._height_of(source.items, heights)
                    for source in sources
                )
                if height < heights[rule]:
                    heights[rule] = height
                    is_changing = True
        if endless := [rule for rule, height in heights.items() if height >= _INFINITE]:
            raise GrammarError(f"no sentence can be made of {endless}")
        return heights

    def _height_of(self, items: Iterable[Item], heights: Mapping[str, int]) -> int:
        height = 0
        for item in items:
            match item:
                case Reference() if not _is_terminal(item.rule):
                    height = max(height, heights[item.rule])
                case Repeat(item=inner, at_least_one=True):
                    height = max(height, self._height_of((inner,), heights) - 1)
                case Gather():
                    height = max(height, self._height_of((item.item,), heights) - 1)
                case _:
                    pass
        return height + 1


def load() -> Derivations:
    """Return the derivations of ``grammar/scenic.gram``."""
    narrowing = (_HERE / "narrowing.gram").read_text(encoding="utf-8")
    return Derivations(
        read_grammar(_HERE.parent / "grammar" / "scenic.gram"),
        read_grammar_text(narrowing, digest=""),
        WEIGHTS,
    )


# Items.


def _references(items: Iterable[Item]) -> Iterator[str]:
    """The rules that items refer to."""
    return (item.rule for item in _within(items) if isinstance(item, Reference))


def _is_terminal(name: str) -> bool:
    return name.isupper()


def _only_reference(items: tuple[Item, ...]) -> str | None:
    """The rule that is all of ``items``, if there is one."""
    if len(items) == 1 and isinstance(items[0], Reference) and not _is_terminal(items[0].rule):
        return items[0].rule
    return None


def _within(items: Iterable[Item]) -> Iterator[Item]:
    """Items and all items in them; terminals are left out."""
    for item in items:
        match item:
            case Optional() | Repeat() | Look():
                yield from _within((item.item,))
            case Gather():
                yield from _within((item.separator, item.item))
            case Reference() if _is_terminal(item.rule):
                pass
            case _:
                yield item


def _map_references(item: Item, change: Callable[[str], str]) -> Item:
    match item:
        case Reference():
            return Reference(change(item.rule))
        case Optional() | Repeat() | Look():
            return replace(item, item=_map_references(item.item, change))
        case Gather():
            return Gather(_map_references(item.separator, change), _map_references(item.item, change))
        case _:
            return item


def _renamed_reference(name: str) -> str:
    # Groups have numbers, by which those of the two grammars would be mixed up.
    return f"narrowing_{name}" if name.startswith("group_") else name


def _renamed(rule: Rule) -> str:
    return _renamed_reference(rule.name)


def _keys(alternative: Alternative) -> list[str]:
    return re.findall(r"\w+", alternative.action or "")


def _words(alternative: Alternative) -> set[str]:
    """Return the names by which an alternative can be called: functions of its action, and rules and words among its items."""
    words = set(re.findall(r"(\w+)\s*\(", alternative.action or ""))
    for item in _within(entry.item for entry in alternative.items):
        match item:
            case Reference():
                words.add(item.rule)
            case Token():
                words.add(item.text)
            case BlockEnded():
                words.add("BLOCK_ENDED")
            case _:
                pass
    return words


def _simplicity(option: Option) -> tuple[int, int, bool]:
    """The order of the options of a rule: shrinking goes to the first."""
    first = option.items[0]
    return option.height, len(option.items), isinstance(first, Token) and first.soft


def _leading(items: tuple[Item, ...]) -> tuple[str | None, str | None]:
    words: list[str | None] = [
        item.text if isinstance(item, Token) and item.literal else None for item in items[:2]
    ]
    first, second = (*words, None, None)[:2]
    return first, second


def _has_colon(items: tuple[Item, ...]) -> bool:
    depth = 0
    for item in items:
        if isinstance(item, Token) and item.literal:
            if item.text in ("(", "[", "{"):
                depth += 1
            elif item.text in (")", "]", "}"):
                depth -= 1
            elif item.text == ":" and not depth:
                return True
    return False
