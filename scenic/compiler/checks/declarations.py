"""Parameters, properties and probabilities: what is declared twice, wrongly, or under a misspelt name."""

import ast
from collections.abc import Iterator
from typing import Any

from scenic.compiler import tree as scenic
from scenic.compiler.checks.context import CheckContext
from scenic.compiler.places import word_span
from scenic.compiler.scopes import ScopeKind
from scenic.compiler.traversal import walk
from scenic.language.diagnostics import Diagnostic, Label
from scenic.language.properties import PROPERTY_ATTRIBUTES
from scenic.language.spelling import nearest_property

__all__ = ["check_declarations"]


def check_declarations(context: CheckContext) -> Iterator[Diagnostic]:
    """Report SC110, SC200, SC210, SC220 and SC300 in declarations and specifiers."""
    for node, _ in context.nodes(ast.ClassDef):
        definitions = [item for item in node.body if isinstance(item, scenic.PropertyDef)]
        yield from _duplicates(context, [(item.name, item) for item in definitions], "property")
    for node, _ in context.nodes(scenic.PropertyDef):
        yield from _property(context, node)
    for node, _ in context.nodes(scenic.Require):
        if node.probability is not None and not 0 <= node.probability <= 1:
            yield context.error(
                "SC220",
                f"a probability lies between 0 and 1, not {node.probability:g}",
                node,
                "write for example `require[0.9] condition`",
            )
    for node, _ in context.nodes(scenic.New):
        yield from _misspelt(context, node)
    for cls in (scenic.BehaviorDef, scenic.MonitorDef):
        for node, _ in context.nodes(cls):
            yield from _self(context, node)


def _self(context: CheckContext, node: Any) -> Iterator[Diagnostic]:
    """Report SC200 for ``behavior Come(self, speed)``."""
    parameters = [] if node.args is None else [*node.args.posonlyargs, *node.args.args]
    if parameters and parameters[0].arg == "self":
        kind = "behavior" if isinstance(node, scenic.BehaviorDef) else "monitor"
        rest = ", ".join(arg.arg for arg in parameters[1:])
        yield context.error(
            "SC200",
            f"a {kind} has `self` without a parameter for it",
            parameters[0],
            f"remove it: `{kind} {node.name}({rest})`"
            + (", in which `self` is the agent" if kind == "behavior" else ""),
        )


def _duplicates(context: CheckContext, items: list[tuple[str, ast.AST]], what: str) -> Iterator[Diagnostic]:
    first: dict[str, ast.AST] = {}
    for name, node in items:
        if name in first:
            yield context.error(
                "SC210",
                f"the {what} `{name}` is defined twice",
                word_span(context.source, node, name),
                "remove one of the definitions",
                labels=(Label(word_span(context.source, first[name], name), "first defined here"),),
            )
        first.setdefault(name, node)


def _property(context: CheckContext, node: scenic.PropertyDef) -> Iterator[Diagnostic]:
    for attribute in node.attributes:
        if attribute not in PROPERTY_ATTRIBUTES:
            yield context.error(
                "SC110",
                f"`{attribute}` is no attribute of properties",
                word_span(context.source, node, attribute),
                "use `additive`, `dynamic` or `final`",
            )
    scope = context.resolution.scopes.get(node)
    self_binding = None if scope is None else scope.bindings.get("self")
    if self_binding is None or self_binding not in context.resolution.read:
        return
    read = {id(part.value) for part in walk(node.value) if isinstance(part, ast.Attribute)}
    for part in walk(node.value):
        if isinstance(part, ast.Name) and part.id == "self" and id(part) not in read:
            binding = context.binding(part)
            if binding is not None and binding.scope.kind is ScopeKind.PROPERTY:
                yield context.error(
                    "SC200",
                    "`self` stands alone in the default of a property",
                    part,
                    "a default may only read other properties, as `self.name`",
                )


def _misspelt(context: CheckContext, node: Any) -> Iterator[Diagnostic]:
    if not any(specifier.property for specifier in node.specifiers):
        return
    properties = context.properties(node.cls)
    if properties is None:
        return
    for specifier in node.specifiers:
        name = specifier.property
        if name is None or name in properties:
            continue
        suggestion = nearest_property(name, properties)
        if suggestion is not None:
            place = word_span(context.source, specifier, name)
            yield context.warning(
                "SC300",
                f"`{node.cls.id}` has no property `{name}`, so `with` creates it",
                place,
                f"did you mean `{suggestion}`?",
                fix=context.renaming(place, name, suggestion),
            )
