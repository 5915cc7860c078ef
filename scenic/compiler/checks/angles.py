"""Degrees where radians are meant: numbers too large for an angle in radians, in places declared to take one."""

import ast
import math
from collections.abc import Iterator
from typing import Any, Final

from scenic.compiler import tree as scenic
from scenic.compiler.checks.context import CheckContext, NodeRule
from scenic.compiler.scopes import Scope
from scenic.language.diagnostics import Diagnostic
from scenic.language.names import ANGLE_METHODS, NAMES, NameKind
from scenic.language.operators import OPERATORS, Operand
from scenic.language.properties import CLASSES, properties_of
from scenic.language.specifiers import SPECIFIERS
from scenic.language.types import INSTANCES

__all__ = ["RULES"]

_LARGEST: Final = 2 * math.pi
"""A number beyond a full turn is taken for degrees."""

_DEEPEST: Final = 20
"""Depth to which sums and similar expressions are examined: nobody writes an angle that is nested deeper."""

_PROPERTIES: Final = frozenset(
    name for cls in CLASSES for name, entry in properties_of(cls).items() if entry.angle
)
_OF_SPECIFIERS: Final = frozenset(
    name for name, declared in SPECIFIERS.items() if any(each.angle for each in declared.operands)
)
_OF_OPERATORS: Final = frozenset(
    name for name, declared in OPERATORS.items() if any(each.angle for each in declared.operands)
)
"""Specifiers and operators with operands that are angles."""
_COMPOSING: Final = frozenset({"relative to", "offset by"})
"""Operators whose operands are angles where the result is one."""


def _specifier(node: scenic.SpecifierPhrase, _scope: Scope, context: CheckContext) -> Iterator[Diagnostic]:
    if node.property is not None:
        if node.property in _PROPERTIES:
            yield from _found(context, node.operands[0], f"`{node.property}` is")
    elif node.specifier in _OF_SPECIFIERS:
        yield from _operands(context, node.operands, SPECIFIERS[node.specifier].operands)


def _operation(node: scenic.Operation, _scope: Scope, context: CheckContext) -> Iterator[Diagnostic]:
    inner = node.operands[0] if node.operands else None
    if node.operator == "deg" and isinstance(inner, scenic.Operation) and inner.operator == "deg":
        yield context.warning("SC307", "this angle is converted from degrees twice", node, "write `deg` once")
    if node.operator in _OF_OPERATORS:
        yield from _operands(context, node.operands, OPERATORS[node.operator].operands)


def _operands(
    context: CheckContext, found: list[ast.expr | None], declared: tuple[Operand, ...]
) -> Iterator[Diagnostic]:
    for value, operand in zip(found, declared, strict=False):
        if operand.angle:
            yield from _found(context, value, f"a {operand.name} is")


def _property(node: scenic.PropertyDef, _scope: Scope, context: CheckContext) -> Iterator[Diagnostic]:
    if node.name in _PROPERTIES:
        yield from _found(context, node.value, f"`{node.name}` is")


def _call(node: ast.Call, _scope: Scope, context: CheckContext) -> Iterator[Diagnostic]:
    function = node.func
    if isinstance(function, ast.Name):
        if function.id not in NAMES or context.provided(function) is None:
            return
        declaration = NAMES[function.id]
        if not declaration.angles:
            return
        angles, parameters = declaration.angles, declaration.parameters
    elif isinstance(function, ast.Attribute) and function.attr in ANGLE_METHODS:
        angles = parameters = ANGLE_METHODS[function.attr]
    else:
        return
    if any(isinstance(argument, ast.Starred) for argument in node.args):
        return
    arguments = dict(zip(parameters, node.args, strict=False))
    arguments.update((keyword.arg, keyword.value) for keyword in node.keywords if keyword.arg is not None)
    for name in angles:
        if name in arguments:
            value = arguments[name]
            yield from _found(
                context,
                value.body if isinstance(value, ast.Lambda) else value,
                f"the {name} is" if name != "x" else "the argument is",
            )


def _comparison(node: ast.Compare, _scope: Scope, context: CheckContext) -> Iterator[Diagnostic]:
    """Report mistakes such as ``(relative heading of x) < 30``: an angle against a number that is none."""
    sides = [node.left, *node.comparators]
    if any(_is_angle(side, context) for side in sides):
        for side in sides:
            yield from _found(context, side, "the other side is")


def _is_angle(node: ast.expr, context: CheckContext) -> bool:
    while isinstance(node, ast.Call) and len(node.args) == 1 and context.provided(node.func) == "abs":
        node = node.args[0]
    if isinstance(node, ast.Attribute) and node.attr in _PROPERTIES:
        kind = context.kind_of(node.value)
        return kind is not None and kind.name in INSTANCES
    return (
        isinstance(node, scenic.Operation) and node.operator in OPERATORS and OPERATORS[node.operator].angle
    )


def _found(context: CheckContext, value: ast.expr | None, what: str) -> Iterator[Diagnostic]:
    """Yield the warnings about a value that is used as an angle; ``what`` names the angle."""
    places = list(_degrees(value, context))
    if places:
        text = context.text(places[0])
        literal = context.constant(places[0]) if isinstance(places[0], ast.Name) else None
        yield context.warning(
            "SC302",
            f"{what} an angle in radians, and {_number(literal or places[0], context):g} is more than a full turn",
            places[0],
            f"write `{text} deg` if degrees are meant"
            if text
            else "write `deg` after it if degrees are meant",
            fix=context.insertion("Add `deg`", *((place, _deg_after(place, context)) for place in places)),
        )


def _deg_after(place: ast.expr, context: CheckContext) -> str:
    """Return the operator, with a blank where a word follows at once: ``(90)by``."""
    span = context.source.span(place)
    following = context.source.line(span.end_line)[span.end_column : span.end_column + 1]
    return " deg " if following.isidentifier() else " deg"


def _degrees(value: ast.expr | None, context: CheckContext, depth: int = _DEEPEST) -> Iterator[ast.expr]:
    """Yield the parts of an angle that read as degrees, each of which ``deg`` can follow."""
    if value is None or not depth:
        return
    if isinstance(value, ast.Tuple | ast.List):
        # `deg` cannot follow a tuple, and who writes one of its angles in degrees writes all of them so.
        if any(list(_degrees(item, context, depth - 1)) for item in value.elts):
            yield from (item for item in value.elts if _largest([item]))
    elif isinstance(value, ast.BinOp) and isinstance(value.op, ast.Add | ast.Sub):
        yield from _degrees(value.left, context, depth - 1)
        yield from _degrees(value.right, context, depth - 1)
    elif isinstance(value, ast.IfExp):
        yield from _degrees(value.body, context, depth - 1)
        yield from _degrees(value.orelse, context, depth - 1)
    elif isinstance(value, scenic.Operation) and value.operator in _COMPOSING:
        for operand in value.operands:
            if not isinstance(operand, ast.Tuple | ast.List):
                yield from _degrees(operand, context, depth - 1)
    elif isinstance(value, ast.Name):
        constant = context.constant(value)
        if (
            constant is not None
            and isinstance(constant, ast.Constant)
            and _number(constant, context) > _LARGEST
        ):
            yield value
    elif _number(value, context) > _LARGEST:
        yield value


def _number(value: ast.expr, context: CheckContext) -> float:
    """The size of the largest number that a literal is, or that a distribution is made of; 0 for all else."""
    if isinstance(value, ast.Call):
        provided = context.provided(value.func)
        if provided is None or provided not in NAMES or NAMES[provided].kind is not NameKind.DISTRIBUTION:
            return 0
        return _largest(value.args)
    return _largest([value])


def _largest(values: list[ast.expr]) -> float:
    size = 0.0
    for value in values:
        literal: Any = value.operand if isinstance(value, ast.UnaryOp) else value
        if (
            isinstance(literal, ast.Constant)
            and isinstance(literal.value, int | float)
            and not isinstance(literal.value, bool)
        ):
            size = max(size, _size(literal.value))
    return size


def _size(value: float) -> float:
    try:
        return abs(float(value))
    except OverflowError:
        return math.inf


RULES: Final[dict[type[ast.AST], NodeRule]] = {
    ast.Call: _call,
    ast.Compare: _comparison,
    scenic.Operation: _operation,
    scenic.PropertyDef: _property,
    scenic.SpecifierPhrase: _specifier,
}
