"""Specifiers of one object that specify the same, or that need one another (section 6.1)."""

import ast
from collections.abc import Iterator, Mapping, Sequence
from types import MappingProxyType
from typing import Any, Final

from scenic.compiler import tree as scenic
from scenic.compiler.checks.context import CheckContext, NodeRule
from scenic.compiler.places import word_span
from scenic.compiler.scopes import Scope
from scenic.compiler.semantics.classes import ClassMember, find_cycle
from scenic.language.diagnostics import Diagnostic
from scenic.language.operators import OPERATORS
from scenic.language.spans import Span
from scenic.language.specifiers import SPECIFIERS, Specified
from scenic.language.types import REGION

__all__ = ["RULES"]


_SPECIFIER_OF_SIDE: Final = MappingProxyType(
    {
        "front of": "ahead of",
        "back of": "behind",
        "left of": "left of",
        "right of": "right of",
        "top of": "above",
        "bottom of": "below",
    }
)
"""The specifier that places an object beyond a side."""


_OF_REGIONS: Final = frozenset(
    name
    for name, declared in SPECIFIERS.items()
    if any(operand.types == (REGION,) for operand in declared.operands)
)
"""Specifiers with an operand that must be a region."""


def _specified(node: scenic.SpecifierPhrase) -> tuple[Specified, ...]:
    """Return the properties that a specifier gives a value, with their priorities."""
    if node.property is not None:
        return (Specified(node.property, 1),)
    return SPECIFIERS[node.specifier].specifies if node.specifier in SPECIFIERS else ()


def _title(node: scenic.SpecifierPhrase) -> str:
    return f"with {node.property}" if node.property is not None else node.specifier


def _override(node: scenic.Override, _scope: Scope, context: CheckContext) -> Iterator[Diagnostic]:
    yield from _conflicts(node.specifiers, context)


def _new(node: scenic.New, _scope: Scope, context: CheckContext) -> Iterator[Diagnostic]:
    yield from _regions(node.specifiers, context)
    conflicts = list(_conflicts(node.specifiers, context))
    yield from conflicts
    properties = context.properties(node.cls)
    if properties is None:
        return
    finals = list(_finals(node, properties, context))
    yield from finals
    if not conflicts and not finals:
        yield from _cycle(node, properties, context)


def _regions(specifiers: list[scenic.SpecifierPhrase], context: CheckContext) -> Iterator[Diagnostic]:
    """Report SC404 for a point where a region is wanted: ``in front of x``."""
    for specifier in specifiers:
        if specifier.specifier not in _OF_REGIONS:
            continue
        for operand, value in zip(SPECIFIERS[specifier.specifier].operands, specifier.operands, strict=False):
            if operand.types != (REGION,) or not isinstance(value, scenic.Operation):
                continue
            operator = OPERATORS.get(value.operator)
            if operator is None or operator.result != "oriented point":
                continue
            side = _SPECIFIER_OF_SIDE.get(value.operator)
            yield context.error(
                "SC404",
                f"`{specifier.specifier}` needs a region, and `{value.operator}` gives a point",
                value,
                f"write `at {value.operator} ...`"
                + (f", or `{side} ...`, which leaves a gap" if side else ""),
            )


def _conflicts(specifiers: list[scenic.SpecifierPhrase], context: CheckContext) -> Iterator[Diagnostic]:
    """Report SC301 for the same specifier twice, or two that give one property with the same priority."""
    strongest: dict[str, int] = {}
    for specifier in specifiers:
        for item in _specified(specifier):
            if item.when is None:
                strongest[item.property] = min(item.priority, strongest.get(item.property, item.priority))
    specifiers_by_property: dict[str, scenic.SpecifierPhrase] = {}
    kinds: dict[str, scenic.SpecifierPhrase] = {}
    for specifier in specifiers:
        title = _title(specifier)
        if title in kinds:
            yield context.error(
                "SC301",
                f"`{title}` is given twice",
                specifier,
                "keep one of them",
                labels=(context.label(kinds[title], "first given here"),),
            )
            continue
        kinds[title] = specifier
        modifies = SPECIFIERS[specifier.specifier].modifies if specifier.specifier in SPECIFIERS else ()
        # What a stronger specifier gives anyway is no cause of conflict.
        claims = [
            item
            for item in _specified(specifier)
            if item.when is None
            and item.property not in modifies
            and item.priority == strongest[item.property]
        ]
        for item in claims:
            first = specifiers_by_property.get(item.property)
            if first is not None:
                yield context.error(
                    "SC301",
                    f"`{title}` and `{_title(first)}` both give the {item.property}",
                    specifier,
                    "keep one of them",
                    labels=(context.label(first, "first given here"),),
                )
                break
        for item in claims:
            specifiers_by_property.setdefault(item.property, specifier)


def _finals(
    node: scenic.New, properties: Mapping[str, ClassMember], context: CheckContext
) -> Iterator[Diagnostic]:
    """Report SC301 for properties that follow from others and cannot be given."""
    for specifier in node.specifiers:
        name = specifier.property
        if name is None or name not in properties or not properties[name].final:
            continue
        place = word_span(context.source, specifier, name)
        if name == "heading":
            start = context.source.span(specifier)
            both = Span(start.line, start.column, start.line, max(start.column, place.end_column))
            # The compatibility mode for two dimensions reads it as `facing`, so this is no error in itself.
            yield context.warning(
                "SC301",
                "`heading` follows from the orientation, so it can only be given in 2D mode",
                place,
                "write `facing` instead of `with heading`",
                fix=context.replacement("Write `facing`", both, "facing")
                if place.line == start.line
                else None,
            )
        else:
            yield context.error(
                "SC301",
                f"`{name}` is final, so it cannot be given",
                place,
                "it always follows from its definition: give the properties that it is computed from",
            )


# Properties that need one another


def _needs(specifier: scenic.SpecifierPhrase) -> tuple[str, ...]:
    """Return the properties that the value of a specifier certainly depends on."""
    declared = SPECIFIERS.get(specifier.specifier)
    if declared is None:
        return ()
    beside_vector = declared.needs_beside_vector and specifier.operands and _is_vector(specifier.operands[0])
    return declared.needs + (declared.needs_beside_vector if beside_vector else ())


def _is_vector(node: ast.expr | None) -> bool:
    """Return whether a value can only be a position, without an orientation."""
    if isinstance(node, scenic.Operation):
        return node.operator == "@"
    return isinstance(node, ast.Tuple | ast.List)


def _cycle(
    node: scenic.New, properties: Mapping[str, ClassMember], context: CheckContext
) -> Iterator[Diagnostic]:
    """Report SC308 for a value that cannot be computed, because it needs itself in the end."""
    providers: dict[str, Any] = {}
    uncertain: set[str] = set()
    strength: dict[str, int] = {}
    modifier: scenic.SpecifierPhrase | None = None
    for specifier in node.specifiers:
        declaration = SPECIFIERS.get(specifier.specifier)
        if declaration is None:
            return
        if declaration.modifies:
            modifier = specifier
            continue
        for item in _specified(specifier):
            if item.when is not None:
                uncertain.add(item.property)
            elif item.priority < strength.get(item.property, 9):
                strength[item.property] = item.priority
                providers[item.property] = specifier
    if modifier is not None:
        # Next to another specifier of the position it needs that one's value, which needs nothing of it.
        providers.setdefault("position", modifier)
        uncertain.add("parentOrientation")
    for name in uncertain:
        if strength.get(name) != 1:
            providers[name] = None

    def needed(name: str) -> tuple[str, ...]:
        if name in providers:
            return _needs(providers[name]) if providers[name] is not None else ()
        return properties[name].needs if name in properties else ()

    # Where the defaults need one another in no circle, there can only be one through what the specifiers give. Those of
    # other modules are checked there.
    cls = context.class_named(node.cls)
    is_here = cls is not None and cls.symbol.module is context.module
    circular_properties = properties if cls is not None and is_here and cls.is_circular else ()
    cycle = find_cycle([*(name for name in providers if needed(name)), *circular_properties], needed)
    if cycle is not None:
        yield _needs_itself(node, cycle, providers, context)


def _needs_itself(
    node: scenic.New, cycle: Sequence[str], providers: Mapping[str, Any], context: CheckContext
) -> Diagnostic:
    places = [providers[name] for name in cycle if providers.get(name) is not None]
    chain = ", ".join(f"`{a}` needs `{b}`" for a, b in zip(cycle, [*cycle[1:], cycle[0]], strict=True))
    place: ast.AST = places[0] if places else node.cls
    others = [other for other in dict.fromkeys(places) if other is not place]
    return context.error(
        "SC308",
        f"these properties depend on each other: {chain}",
        place,
        "give one of them a value that needs none of the others, for example with `with`",
        labels=tuple(context.label(other, "takes part in it") for other in others),
    )


RULES: Final[dict[type[ast.AST], NodeRule]] = {scenic.New: _new, scenic.Override: _override}
