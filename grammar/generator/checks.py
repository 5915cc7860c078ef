"""Mistakes in a grammar that would silently make a part of it dead."""

from grammar.generator.analysis import Analysis
from grammar.generator.model import (
    NAME,
    Alternative,
    Cut,
    GrammarError,
    Item,
    Look,
    Named,
    Optional,
    Repeat,
    Rule,
    Token,
    TokenChoice,
)


def check(analysis: Analysis) -> None:
    """Raise `GrammarError` for unreachable rules, shadowed alternatives, indirect left recursion, odd values."""
    unreachable = analysis.rules.keys() - analysis.reachable()
    if unreachable:
        raise GrammarError(f"no rule uses {', '.join(sorted(unreachable))}")
    missing = analysis.grammar.recover - analysis.rules.keys()
    if missing:
        raise GrammarError(f"`@recover` names rules that do not exist: {sorted(missing)}")
    for rule in analysis.rules.values():
        if any(analysis.is_nullable(alternative.items) for alternative in rule.alternatives):
            raise GrammarError(f"rule {rule.name!r} can match nothing: make it optional where it is used")
        _check_shadowing(analysis, rule)
        _check_twins(rule)
        for alternative in rule.alternatives:
            if alternative.action is None:
                value_item(alternative, rule.name)
    _check_left_recursion(analysis)


def _check_shadowing(analysis: Analysis, rule: Rule) -> None:
    for index, earlier in enumerate(rule.alternatives):
        for later in rule.alternatives[index + 1 :]:
            if len(earlier.items) <= len(later.items) and all(
                _covers(analysis, one.item, other.item)
                for one, other in zip(earlier.items, later.items, strict=False)
            ):
                raise GrammarError(
                    f"rule {rule.name!r}: {describe(later)} is never reached: {describe(earlier)} wins before it"
                )


def _covers(analysis: Analysis, one: Item, other: Item) -> bool:
    """Return whether ``one`` matches whenever ``other`` does, and the same text."""
    if one == other:
        return True
    return (
        isinstance(one, Token | TokenChoice)
        and isinstance(other, Token | TokenChoice)
        and analysis.kinds_of(one) >= analysis.kinds_of(other)
    )


def _check_twins(rule: Rule) -> None:
    if rule.alternatives and len(set(rule.alternatives)) < len(rule.alternatives):
        raise GrammarError(f"rule {rule.name!r} has the same alternative twice")


def _check_left_recursion(analysis: Analysis) -> None:
    leftmost = {name: analysis.leftmost(rule) for name, rule in analysis.rules.items()}
    for name, direct in leftmost.items():
        rules_done: set[str] = set()
        roots = list(direct - {name})
        while roots:
            rule = roots.pop()
            if rule == name:
                raise GrammarError(f"rule {name!r} is left-recursive through other rules")
            if rule not in rules_done:
                rules_done.add(rule)
                roots += leftmost[rule] - {rule}
        rule_object = analysis.rules[name]
        if name in direct and not analysis.is_left_recursive(rule_object):
            raise GrammarError(f"rule {name!r} is left-recursive behind something optional")
        if name in direct:
            heads = [
                alternative.items[0].name
                for alternative in rule_object.alternatives
                if _starts_with(alternative, name)
            ]
            if None in heads or len(set(heads)) > 1:
                raise GrammarError(f"rule {name!r}: the left operand needs the same name everywhere")


def _starts_with(alternative: Alternative, rule: str) -> bool:
    item = alternative.items[0].item
    return getattr(item, "rule", None) == rule


def value_item(alternative: Alternative, rule: str) -> Named:
    """Return the item whose value is that of an alternative without an action."""
    items_with_names = [each for each in alternative.items if each.name is not None]
    bearing = [each for each in alternative.items if not isinstance(each.item, Look | Cut)]
    candidates = items_with_names or bearing
    if len(candidates) != 1:
        raise GrammarError(f"rule {rule!r}: {describe(alternative)} needs an action")
    item = candidates[0].item
    if isinstance(item, Optional):
        raise GrammarError(f"rule {rule!r}: the value of {describe(alternative)} may be None")
    return candidates[0]


def describe(alternative: Alternative) -> str:
    """Write an alternative about as the grammar has it."""
    return "`" + " ".join(describe_item(named.item) for named in alternative.items) + "`"


def describe_item(item: Item) -> str:
    """Write an item about as the grammar has it."""
    match item:
        case Token():
            return str(item)
        case TokenChoice():
            return "(" + " | ".join(map(str, item.tokens)) + ")"
        case Optional():
            return describe_item(item.item) + "?"
        case Repeat():
            return describe_item(item.item) + ("+" if item.at_least_one else "*")
        case Look():
            return ("&" if item.positive else "!") + describe_item(item.item)
        case Cut():
            return "~"
    return getattr(item, "rule", type(item).__name__)


__all__ = ["NAME", "check", "describe", "describe_item", "value_item"]
