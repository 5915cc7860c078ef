"""Classification of the grammar's alternatives as Scenic's or Python's."""

import keyword
import re
from collections.abc import Collection, Iterable, Iterator
from typing import Final

from grammar.generator.model import (
    Gather,
    Grammar,
    Item,
    Look,
    Optional,
    Reference,
    Repeat,
    Token,
    TokenChoice,
)
from grammar.tracing import AlternativeId, alternatives

__all__ = ["of_scenic"]

_PYTHON_WORDS: Final = frozenset({*keyword.kwlist, "match", "case", "type", "_"})


def of_scenic(grammar: Grammar, nodes: Collection[str]) -> frozenset[AlternativeId]:
    """Return the alternatives that no program of Python alone uses.

    They hold a word of Scenic, make one of its ``nodes``, need a rule that does, or are in a rule used by such ones only.
    """
    everything = alternatives(grammar)
    items = {
        each: [entry.item for entry in scenic_alternatives.items]
        for each, scenic_alternatives in everything.items()
    }
    scenic_alternatives = {
        each
        for each, alternative in everything.items()
        if not _PYTHON_WORDS.issuperset(_words(items[each]))
        or any(name in nodes for name in re.findall(r"(\w+)\s*\(", alternative.action or ""))
    }
    rules = {each.rule for each in everything}
    while True:
        count = len(scenic_alternatives)
        whole = {
            rule
            for rule in rules
            if all(each in scenic_alternatives for each in everything if each.rule == rule)
        }
        scenic_alternatives |= {each for each in everything if whole.intersection(_needed(items[each]))}
        of_python: set[str] = set()
        stack = [grammar.start]
        while stack:
            rule = stack.pop()
            if rule not in of_python:
                of_python.add(rule)
                for each in everything:
                    if each.rule == rule and each not in scenic_alternatives:
                        stack += _referred(items[each])
        scenic_alternatives |= {each for each in everything if each.rule not in of_python}
        if len(scenic_alternatives) == count:
            return frozenset(scenic_alternatives)


def _words(items: Iterable[Item]) -> Iterator[str]:
    """The keywords among items."""
    for item in items:
        match item:
            case Token(literal=True) if item.text.isidentifier():
                yield item.text
            case TokenChoice():
                yield from _words(item.tokens)
            case Look():
                yield from _words([item.item])
            case _:
                pass


def _needed(items: Iterable[Item]) -> Iterator[str]:
    """The rules that items cannot do without."""
    for item in items:
        match item:
            case Reference():
                yield item.rule
            case Repeat(at_least_one=True) | Gather():
                yield from _needed([item.item])
            case _:
                pass


def _referred(items: Iterable[Item]) -> Iterator[str]:
    """The rules that items refer to."""
    for item in items:
        match item:
            case Reference():
                yield item.rule
            case Optional() | Repeat() | Gather():
                yield from _referred([item.item])
            case _:
                pass
