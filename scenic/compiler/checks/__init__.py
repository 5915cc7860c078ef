"""The checks of a program that need neither its running nor its modules: one module per kind of rule.

`check` finds what no program may contain; it is part of every compilation. `lint` finds what is legal, or fails only
when it is reached, and is hardly meant. The resolver sorts all nodes by their classes, so that no rule has to walk the
tree again.
"""

import ast
from collections import Counter
from collections.abc import Callable, Iterable, Iterator, Mapping
from types import MappingProxyType
from typing import Final

from scenic.compiler.checks import (
    agents,
    angles,
    arguments,
    clashes,
    class_bodies,
    conditions,
    declarations,
    defaults,
    distributions,
    flow,
    guards,
    instances,
    library_attributes,
    making,
    meant_specifiers,
    names,
    operands,
    order,
    overriding,
    placement,
    python_habits,
    randomness,
    specifiers,
    support,
    uses,
    values,
    written_forms,
)
from scenic.compiler.checks.context import CheckContext, NodeRule, ProgramRule
from scenic.language.diagnostics import Diagnostic
from scenic.language.garbage import no_garbage_collection

__all__ = ["CheckContext", "check", "lint"]

_OF_NODES: Final = (
    angles,
    arguments,
    clashes,
    class_bodies,
    conditions,
    distributions,
    making,
    operands,
    overriding,
    python_habits,
    randomness,
    specifiers,
    values,
)
_NODE_RULES: Final[Mapping[type[ast.AST], tuple[NodeRule, ...]]] = MappingProxyType(
    {
        cls: tuple(module.RULES[cls] for module in _OF_NODES if cls in module.RULES)
        for each in _OF_NODES
        for cls in each.RULES
    }
)


def _nodes(context: CheckContext) -> Iterator[Diagnostic]:
    """Yield the diagnostics of rules about single nodes."""
    for cls, rules in _NODE_RULES.items():
        for node, scope in context.nodes(cls):
            # All rules while the processor has the node in its cache.
            for rule in rules:
                yield from rule(node, scope, context)


def _misplaced(context: CheckContext) -> Iterator[Diagnostic]:
    """Yield the diagnostics of statements in the wrong place, and of statements that are not supported at all."""
    misplaced = dict(placement.check_placement(context))
    yield from filter(None, misplaced.values())
    yield from support.check_support(context, misplaced)


_CHECKS: Final[tuple[ProgramRule, ...]] = (
    names.check_reserved,
    names.check_names,
    names.check_classes,
    _misplaced,
    declarations.check_declarations,
    making.check_monitors,
    meant_specifiers.check_meant_specifiers,
    support.check_supported_names,
)
_LINTS: Final[tuple[ProgramRule, ...]] = (
    _nodes,
    defaults.check_defaults,
    flow.check_flow,
    guards.check_guards,
    instances.check_instances,
    order.check_order,
    python_habits.check_maps,
    uses.check_uses,
    written_forms.check_written_forms,
)

MOST_OF_ONE_CODE: Final = 200
"""Largest number of findings of one kind that are reported."""


def check(context: CheckContext, go_on: Callable[[], None] = lambda: None) -> tuple[Diagnostic, ...]:
    """Report constructs that no program may contain, ordered by place.

    ``go_on`` is called now and then, and may raise to stop.
    """
    diagnostics: list[Diagnostic] = []
    for rule in _CHECKS:
        go_on()
        diagnostics += rule(context)
    return tuple(_capped(sorted(diagnostics, key=_order)))


_ATTRIBUTE: Final = "SC214"
"""The code of unknown attributes, about which annotations of the library say more."""


def lint(context: CheckContext, go_on: Callable[[], None] = lambda: None) -> tuple[Diagnostic, ...]:
    """Report constructs that hardly mean what they say, or are bound to fail when they are reached, ordered by place.

    ``go_on`` is called now and then, and may raise to stop.
    """
    surroundings = context.surroundings
    with no_garbage_collection():
        missing = [*agents.check_agents(context), *library_attributes.check_library_attributes(context)]
        missing += () if surroundings is None else surroundings.findings()
        places = {item.span for item in missing}
        diagnostics = list(missing)
        for rule in _LINTS:
            go_on()
            # A name that cannot be imported is not unused as well.
            diagnostics += (
                item
                for item in rule(context)
                if item.span not in places or (rule is not uses.check_uses and item.code != _ATTRIBUTE)
            )
        return tuple(_capped(sorted(dict.fromkeys(diagnostics), key=_order)))


def _capped(found: Iterable[Diagnostic]) -> Iterator[Diagnostic]:
    """Yield the diagnostics without those of one code that are too many to be read."""
    counts: Counter[str] = Counter()
    for item in found:
        counts[item.code] += 1
        if counts[item.code] <= MOST_OF_ONE_CODE:
            yield item


def _order(diagnostic: Diagnostic) -> tuple[int, int, str]:
    span = diagnostic.span
    return (0, 0, diagnostic.code) if span is None else (span.line, span.column, diagnostic.code)
