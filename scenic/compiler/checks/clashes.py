"""Property definitions that no class may have: final properties, names of attributes, attributes that exclude each other; sizes."""

import ast
from collections.abc import Iterator
from functools import partial
from typing import Final

from scenic.compiler import tree as scenic
from scenic.compiler.checks.context import CheckContext, NodeRule
from scenic.compiler.literals import literal_number
from scenic.compiler.places import word_span
from scenic.compiler.scopes import Scope
from scenic.language.diagnostics import Diagnostic
from scenic.language.properties import attributes_of, properties_of

__all__ = ["RULES"]

_POSITIVE: Final = frozenset(name for name, entry in properties_of("Object").items() if entry.positive)


def _class(node: ast.ClassDef, _scope: Scope, context: CheckContext) -> Iterator[Diagnostic]:
    cls = context.class_at(node)
    if cls is None:
        return
    properties, base = cls.inherited, cls.built_in
    base_attributes = attributes_of(base) if base is not None else {}
    for item in node.body:
        match item:
            case scenic.PropertyDef(name=name, attributes=attributes, value=value):
                place = partial(word_span, context.source, item, name)
                if "additive" in attributes and "dynamic" in attributes:
                    yield context.error(
                        "SC401",
                        f"the property `{name}` cannot be both additive and dynamic",
                        place(),
                        "keep one of the two words",
                    )
                # Programs of the plane define the heading.
                if name in properties and properties[name].final and name != "heading":
                    yield context.error(
                        "SC401",
                        f"the property `{name}` is final and cannot be defined again",
                        place(),
                        "define the properties that it follows from: `parentOrientation`, `yaw`, `pitch` or `roll`"
                        if name == "orientation"
                        else "use another name",
                    )
                if name in base_attributes and not base_attributes[name].yields:
                    what = "a method" if base_attributes[name].is_method else "an attribute"
                    yield context.error(
                        "SC402",
                        f"`{name}` is {what} of `{base}` and cannot be a property",
                        place(),
                        "use another name",
                    )
                if base == "Object":
                    yield from check_size(name, value, context)
            case ast.FunctionDef(args=args, decorator_list=[]) if not (
                args.args or args.posonlyargs or args.vararg or args.kwonlyargs or args.kwarg
            ):
                yield context.warning(
                    "SC211",
                    f"the method `{item.name}` has no parameter for the instance",
                    word_span(context.source, item, item.name),
                    f"write `def {item.name}(self)`",
                )


def check_size(name: str, value: ast.expr | None, context: CheckContext) -> Iterator[Diagnostic]:
    """Report SC405 for an extent of an object that is a number and not positive."""
    number = literal_number(value)
    if value is not None and name in _POSITIVE and number is not None and number <= 0:
        yield context.error(
            "SC405",
            f"the property `{name}` must be greater than 0",
            value,
            "give a positive number; a place without extent is made by `new Point` or `new OrientedPoint`",
        )


def _new(node: scenic.New, _scope: Scope, context: CheckContext) -> Iterator[Diagnostic]:
    """Report mistakes such as ``new Object with width 0``."""
    if context.built_in(node.cls) == "Object":
        for specifier in node.specifiers:
            if specifier.property is not None and specifier.operands:
                yield from check_size(specifier.property, specifier.operands[0], context)


RULES: Final[dict[type[ast.AST], NodeRule]] = {ast.ClassDef: _class, scenic.New: _new}
