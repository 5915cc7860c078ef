"""Emits the grammar without ordered choice: what the grammars for constrained decoding are made of.

The rules of ``grammar/demands.gram`` stand in place of those of ``grammar/scenic.gram``, and lookaheads and cuts are left
out. The rows are those of the module ``syntax``.
"""

import re
from collections.abc import Iterator
from dataclasses import replace
from pathlib import Path

from grammar.generator.model import (
    Alternative,
    Gather,
    Grammar,
    GrammarError,
    Item,
    Optional,
    Reference,
    Repeat,
    Token,
)
from grammar.generator.reader import read_grammar_text
from grammar.generator.syntax import rows_of

__all__ = ["emit_context_free"]


def emit_context_free(grammar_path: Path, header: str) -> str:
    """Write the text of the module ``context_free``; raises `GrammarError` if a rule is missing, or none uses it."""
    demands = grammar_path.with_name("demands.gram")
    additions = demands.read_text(encoding="utf-8") if demands.is_file() else ""
    grammar = _with_alternatives(
        read_grammar_text(grammar_path.read_text(encoding="utf-8") + additions, replacing=True)
    )
    rule_names = _reachable(grammar)
    if idle := set(re.findall(r"^(\w+?)(?:__\w+)?:", additions, re.MULTILINE)) - rule_names:
        raise GrammarError(f"demands.gram: no rule uses {', '.join(sorted(idle))}")
    lines = [
        header.rstrip(),
        "",
        "from types import MappingProxyType",
        "",
        "RULES = MappingProxyType(",
        "    {",
    ]
    lines += (
        f"        {rule.name!r}: {tuple(rows_of(grammar, rule))!r},"
        for rule in grammar.rules.values()
        if rule.name in rule_names and not rule.lifted
    )
    lines += ["    }", ")", '"""The alternatives of each rule."""', "", f"START = {grammar.start!r}", ""]
    return "\n".join(lines)


def _with_alternatives(grammar: Grammar) -> Grammar:
    """The grammar with the rules ``rule__word`` in place of the alternatives that they are for."""
    rules = dict(grammar.rules)
    for name in [each for each in rules if "__" in each]:
        new, (target, word) = rules.pop(name), name.split("__")
        rule = rules.get(target)
        remaining = (
            () if rule is None else tuple(each for each in rule.alternatives if _first_word(each) != word)
        )
        if rule is None or len(remaining) == len(rule.alternatives):
            raise GrammarError(f"demands.gram: there is nothing for {name!r} to replace")
        rules[target] = replace(rule, alternatives=(*remaining, *new.alternatives))
    return replace(grammar, rules=rules)


def _first_word(alternative: Alternative) -> str | None:
    first = alternative.items[0].item
    return first.text if isinstance(first, Token) else None


def _reachable(grammar: Grammar) -> set[str]:
    names: set[str] = set()
    roots = [grammar.start]
    while roots:
        name = roots.pop()
        if name in names:
            continue
        names.add(name)
        if name not in grammar.rules:
            raise GrammarError(f"demands.gram: there is no rule {name!r}")
        for alternative in grammar.rules[name].alternatives:
            for entry in alternative.items:
                roots += _references(entry.item)
    return names


def _references(item: Item) -> Iterator[str]:
    match item:
        case Reference():
            yield item.rule
        case Optional() | Repeat():
            yield from _references(item.item)
        case Gather():
            yield from _references(item.item)
            yield from _references(item.separator)
        case _:
            pass
