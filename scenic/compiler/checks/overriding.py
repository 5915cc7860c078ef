"""Properties that `override` cannot give: those that the simulator decides, and those that no object has."""

import ast
from collections.abc import Iterator
from typing import Final

from scenic.compiler import tree as scenic
from scenic.compiler.checks.context import CheckContext, NodeRule
from scenic.compiler.places import word_span
from scenic.compiler.scopes import Scope
from scenic.language.diagnostics import Diagnostic
from scenic.language.properties import properties_of
from scenic.language.spelling import nearest

__all__ = ["RULES"]

_PROPERTIES: Final = properties_of("Object")


def _override(node: scenic.Override, _scope: Scope, context: CheckContext) -> Iterator[Diagnostic]:
    for specifier in node.specifiers:
        name = specifier.property
        if name is None:
            continue
        declaration = _PROPERTIES.get(name)
        place = word_span(context.source, specifier, name)
        if name == "heading":
            continue  # Two-dimensional programs give it.
        if declaration is not None and (declaration.dynamic or declaration.final):
            reason = "dynamic and cannot be overridden: the simulator decides it"
            yield context.error(
                "SC402",
                f"the property `{name}` is {'final and cannot be overridden' if declaration.final else reason}",
                place,
                "let a behavior change it by actions",
            )
        elif declaration is None and not _is_defined(name, context):
            similar_name = nearest(name, _PROPERTIES.keys())
            if similar_name is not None:
                yield context.error(
                    "SC300",
                    f"there is no property `{name}` to override",
                    place,
                    f"did you mean `{similar_name}`?",
                    fix=context.renaming(place, name, similar_name),
                )


def _is_defined(name: str, context: CheckContext) -> bool:
    """Return whether a class of the program or of its imports may define a property of a name."""
    if any(name == item.name for item, _ in context.nodes(scenic.PropertyDef)):
        return True
    overridden = {id(part) for node, _ in context.nodes(scenic.Override) for part in node.specifiers}
    if any(
        name == item.property and id(item) not in overridden
        for item, _ in context.nodes(scenic.SpecifierPhrase)
    ):
        return True
    return name in context.properties_brought


RULES: Final[dict[type[ast.AST], NodeRule]] = {scenic.Override: _override}
