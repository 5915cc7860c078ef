"""Facts about each option of a rule that do not depend on the sentence: a table for the generator."""

from collections.abc import Iterator, Mapping
from dataclasses import dataclass, replace
from typing import Final, NamedTuple

from fuzz.derivations import Derivations, Option
from fuzz.names import SIGNATURES, Role, role_given, roles_of
from fuzz.places import (
    Demand,
    Step,
    all_of,
    any_of,
    demand_of,
    nodes_of,
    properties_given,
    reads_ego,
    step_into,
    within,
)
from fuzz.terminals import NAMES_WITHOUT
from grammar.generator.model import Gather, Item, Optional, Reference, Repeat, Token

__all__ = ["Ban", "Plan", "count_names", "plans_of"]


class Ban(NamedTuple):
    """Things that must not be chosen within a rule: names, and options that begin with a word."""

    names: frozenset[str]
    starts: frozenset[str]


_BANS: Final[Mapping[str, Ban]] = {
    # Temporal operators where a name was meant; and the operands of a specifier reach as far as possible,
    # so that in `new C at x and always y` the word `always` would be a name.
    "require_statement": Ban(frozenset({"always", "eventually", "next"}), frozenset({"new"})),
    # `facing toward not visible from x` faces something, whatever comes then.
    "specifier": Ban(frozenset({"toward", "away", "directly"}), frozenset()),
    # `record final x every 2 seconds` has no `every`, and in `record initial scenario` the value is `scenario`.
    "record_statement": Ban(frozenset({"initial", "final"}), frozenset({"initial"})),
    # `match [final]:` begins like a property.
    "subject": Ban(frozenset({"additive", "dynamic", "final"}), frozenset()),
}

_STARRED: Final = Ban(frozenset(), frozenset({"altitude", "angle", "apparent", "distance", "relative"}))
"""After a star. In `[* distance from x and distance from y to z]` the second operator takes the `to`, and then `and` cannot stand there."""

_STARS: Final = frozenset({"stored", "place", "targets", "case_pattern", "sequence_pattern"})
"""Rules of rows in which one item may be starred."""


@dataclass(frozen=True, slots=True)
class Plan:
    """An option with all that follows from it alone.

    ``steps`` are the scopes and blocks that its items stand in, ``roles`` those of its names, ``given`` the roles of
    the first names in what its items refer to.
    """

    option: Option
    steps: tuple[Step | None, ...]
    roles: tuple[Role, ...]
    given: tuple[Role | None, ...]
    demand: Demand | None
    bans: tuple[Ban, ...]
    has_parameters: bool
    """True if the option contains parameters that it binds."""
    starred: bool
    """True for a starred item of a row that may have only one such item."""
    row: bool
    """True for a row that may have only one starred item."""
    one_target: bool
    """True if rows have to consist of one item outside of compose blocks."""
    outer: bool
    """True if the option names variables of enclosing functions."""
    reads_ego: bool
    properties: frozenset[str]
    """Properties that a specifier gives, and that no other specifier may give."""
    first_specifier: bool
    """True if the specifiers that follow belong to a new object."""
    has_lines: bool
    """True if the specifiers are on lines of their own."""


def plans_of(derivations: Derivations) -> dict[str, tuple[Plan, ...]]:
    """The plans of the options of all rules, in their order."""
    plans = {
        rule: tuple(_plan(derivations, option) for option in options)
        for rule, options in derivations.options.items()
    }
    # What all options of a rule demand, the options that need the rule demand, too.
    rules_done: set[str] = set()
    while True:
        rules = {
            rule: any_of([plan.demand for plan in plans_of_rule if plan.demand is not None])
            for rule, plans_of_rule in plans.items()
            if rule not in rules_done and all(plan.demand is not None for plan in plans_of_rule)
        }
        if not rules:
            return plans
        rules_done |= rules.keys()
        plans = {
            rule: tuple(_with_demands(plan, rules) for plan in plans_of_rule)
            for rule, plans_of_rule in plans.items()
        }


def _plan(derivations: Derivations, option: Option) -> Plan:
    alternatives = [derivations.alternative(each) for each in option.counts_as]
    nodes = frozenset[str]().union(*map(nodes_of, alternatives))
    steps: list[Step | None] = [None] * len(option.items)
    roles: list[Role | None] = [None] * len(option.items)
    for rule, index in option.leads_to:
        steps[index] = steps[index] or step_into(option, nodes, rule)
        roles[index] = roles[index] or role_given(option, rule)
    if "comprehension" in steps:
        steps = ["comprehension"] * len(steps)
    names = sum(map(count_names, option.items))
    return Plan(
        option,
        tuple(steps),
        tuple(roles_of(option, nodes, names)),
        tuple(roles),
        demand_of(option, nodes),
        tuple(_bans(option)),
        option.rule in SIGNATURES,
        _is_star(option.items[0]) and (option.rule in ("stored_item", "target") or "MatchStar" in nodes),
        option.rule in _STARS,
        "Do" in nodes,
        "Nonlocal" in nodes,
        reads_ego(option, alternatives),
        frozenset[str]().union(*map(properties_given, alternatives)),
        option.rule == "new_expression" or "Override" in nodes,
        option.rule in ("new_block", "override_block"),
    )


def _bans(option: Option) -> Iterator[Ban]:
    for each in option.counts_as:
        if each.rule in _BANS:
            yield _BANS[each.rule]
    if option.start in ("*", "**"):
        yield _STARRED


def _with_demands(plan: Plan, rules: Mapping[str, Demand]) -> Plan:
    """A plan that also demands what the rules demand that it cannot do without."""
    needed = [
        rules[item.rule] if step is None else within(step, rules[item.rule])
        for item, step in zip(plan.option.items, plan.steps, strict=True)
        if isinstance(item, Reference) and item.rule in rules
    ]
    if not needed:
        return plan
    return replace(plan, demand=all_of([*needed, *([plan.demand] if plan.demand else [])]))


def count_names(item: Item) -> int:
    """Return the number of names that an item needs itself, without the rules that it refers to; a row counts once."""
    match item:
        case Token(literal=False):
            return int(item.text in NAMES_WITHOUT)
        case Reference():
            return int(item.rule in NAMES_WITHOUT)
        case Optional() | Repeat() | Gather():
            return count_names(item.item)
        case _:
            return 0


def _is_star(item: Item) -> bool:
    return isinstance(item, Token) and item.literal and item.text == "*"
