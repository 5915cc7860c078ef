"""Bodies of classes of objects: attributes where properties are meant, and properties under misspelt names."""

import ast
from collections.abc import Iterator, Mapping
from typing import Final

from scenic.compiler import tree as scenic
from scenic.compiler.checks.context import CheckContext, NodeRule
from scenic.compiler.places import word_span
from scenic.compiler.scopes import Scope
from scenic.compiler.semantics.classes import ClassMember
from scenic.language.diagnostics import Diagnostic, Edit, Fix
from scenic.language.spans import Span
from scenic.language.spelling import distance

__all__ = ["RULES"]


def _class(node: ast.ClassDef, _scope: Scope, context: CheckContext) -> Iterator[Diagnostic]:
    cls = context.class_at(node)
    if cls is None:
        return
    base_properties = cls.inherited
    own_names = {item.name for item in node.body if isinstance(item, scenic.PropertyDef)}
    for item in node.body:
        match item:
            case ast.Assign(targets=[ast.Name(id=name) as target]) if (
                name in own_names or name in base_properties
            ):
                yield _attribute(context, node, target, item.value, known=name in own_names)
            case scenic.PropertyDef(name=name) if name not in base_properties:
                yield from _misspelt(context, node, item, base_properties, own_names)


def _attribute(
    context: CheckContext, node: ast.ClassDef, target: ast.Name, value: ast.expr, *, known: bool
) -> Diagnostic:
    """Return SC313 for ``width = 0.3``."""
    start, end = context.source.span(target), context.source.span(value)
    between = Span(start.end_line, start.end_column, end.line, end.column)
    plain = (
        start.end_line == end.line
        and context.source.line(end.line)[start.end_column : end.column].strip() == "="
    )
    return context.error(
        "SC313",
        f"`{target.id}` is a property of `{node.name}`, which an attribute of that name does not set",
        target,
        "remove the attribute" if known else f"write `{target.id}: {context.text(value) or 'value'}`",
        fix=Fix("Write `:`", (Edit(between, ": "),)) if plain and not known else None,
    )


def _misspelt(
    context: CheckContext,
    node: ast.ClassDef,
    item: scenic.PropertyDef,
    inherited: Mapping[str, ClassMember],
    own: set[str],
) -> Iterator[Diagnostic]:
    """Report SC300 for ``lenght: 4``, of which nothing else in the program speaks."""
    name = item.name
    if name in context.attributes or name in context.given:
        return
    for candidate in sorted(inherited):
        if candidate not in own and _is_slip(name, candidate):
            place = word_span(context.source, item, name)
            yield context.warning(
                "SC300",
                f"`{node.name}` has no property `{name}` to give a default, so this line defines one",
                place,
                f"did you mean `{candidate}`?",
                fix=context.renaming(place, name, candidate),
            )
            return


_SHORTEST: Final = 5


def _is_slip(name: str, meant: str) -> bool:
    """Return whether a new property is more likely an old one mistyped: a letter missing, doubled or swapped, no other word."""
    if len(meant) < _SHORTEST or name[0] != meant[0] or not name.isalpha() or meant + "s" == name:
        return False
    if distance(name, meant, limit=1) > 1:
        return False
    return len(name) != len(meant) or sorted(name) == sorted(meant)


RULES: Final[dict[type[ast.AST], NodeRule]] = {ast.ClassDef: _class}
