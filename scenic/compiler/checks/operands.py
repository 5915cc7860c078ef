"""Arguments of functions and methods, and operands of statements, whose types are declared."""

import ast
from collections.abc import Iterator, Mapping, Sequence
from types import MappingProxyType
from typing import Any, Final

from scenic.compiler import tree as scenic
from scenic.compiler.checks.context import CheckContext, NodeRule
from scenic.compiler.checks.randomness import is_random
from scenic.compiler.checks.wanted import may_be_meant, wrong_kinds
from scenic.compiler.scopes import Scope
from scenic.language.diagnostics import Diagnostic
from scenic.language.members import Member
from scenic.language.names import NAMES
from scenic.language.statements import STATEMENTS
from scenic.language.types import FIXED_NUMBER, Type

__all__ = ["RULES"]


def _call(node: ast.Call, scope: Scope, context: CheckContext) -> Iterator[Diagnostic]:
    """Report mistakes such as ``CircularRegion(5, (0, 0))``, ``room.containsPoint(3)``."""
    name = context.provided(node.func)
    method = context.method(node.func) if name is None and isinstance(node.func, ast.Attribute) else None
    if (name not in NAMES and method is None) or may_be_meant(node, scope, context):
        return
    if method is not None:
        yield from _method(node, method, context)
        return
    declaration = NAMES[name or ""]
    if not declaration.accepted:
        return
    arguments = dict(zip(declaration.parameters, _before_stars(node.args), strict=False))
    arguments.update((each.arg, each.value) for each in node.keywords if each.arg is not None)
    for parameter, types in declaration.accepted.items():
        if parameter in arguments:
            yield from wrong_kinds(f"`{declaration.name}` {parameter}", types, arguments[parameter], context)


def _method(node: ast.Call, method: Member, context: CheckContext) -> Iterator[Diagnostic]:
    arguments = list(_before_stars(node.args))
    for types, value in zip(method.takes, arguments, strict=False):
        if types:
            yield from wrong_kinds(f"`{method.name}`", types, value, context)
    needed_count = next((number for number, types in enumerate(method.takes) if not types), len(method.takes))
    if len(arguments) == len(node.args) < needed_count and not node.keywords:
        count = f"{needed_count} argument{'s' if needed_count > 1 else ''}"
        yield context.error(
            "SC211",
            f"the method `{method.name}` needs {count}, and {len(arguments)} {'is' if len(arguments) == 1 else 'are'} given",
            node,
            "give " + ", ".join(types[0].noun for types in method.takes[:needed_count]),
        )


def _before_stars(args: Sequence[ast.expr]) -> Iterator[ast.expr]:
    """Yield the positional arguments whose positions are certain."""
    for each in args:
        if isinstance(each, ast.Starred):
            return
        yield each


def _statement(node: Any, scope: Scope, context: CheckContext) -> Iterator[Diagnostic]:
    """Report mistakes such as ``mutate ego by "2"``, ``terminate after "10" seconds``."""
    declaration = STATEMENTS[type(node).__name__]
    for field, types in declaration.takes.items():
        value = getattr(node, field)
        title = (
            f"`{declaration.title}`" if len(declaration.takes) == 1 else f"`{declaration.title} ... {field}`"
        )
        operand = value.value if isinstance(value, scenic.Duration) else value
        if operand is None or may_be_meant(node, scope, context):
            continue
        if types == (FIXED_NUMBER,) and is_random(operand, context):
            yield _not_fixed(title, operand, types[0], context)
        else:
            yield from wrong_kinds(title, types, operand, context)


def _not_fixed(title: str, operand: ast.expr, wanted: Type, context: CheckContext) -> Diagnostic:
    return context.error(
        "SC404", f"{title}: expected {wanted.noun}, not a random one", operand, wanted.advice
    )


_OF_STATEMENTS: Final[Mapping[type[ast.AST], NodeRule]] = MappingProxyType(
    {getattr(scenic, name): _statement for name, declared in STATEMENTS.items() if declared.takes}
)

RULES: Final[dict[type[ast.AST], NodeRule]] = {ast.Call: _call, **_OF_STATEMENTS}
