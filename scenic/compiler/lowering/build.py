"""Making Python nodes at places of the program."""

import ast
from collections.abc import Mapping, Sequence
from types import MappingProxyType
from typing import Any, TypeVar

from scenic.language.generated_code import PRELUDE

__all__ = [
    "at",
    "constant",
    "function",
    "instance_attribute",
    "lambda_",
    "name",
    "parameters",
    "prelude",
    "prelude_call",
    "rebuilt",
    "sliceable",
    "start_of",
    "statement",
    "store_on_instance",
    "tuple_",
]

_Node = TypeVar("_Node", bound=ast.AST)


def at(node: _Node, origin: ast.AST) -> _Node:
    """Give ``node`` the place of ``origin`` and return it."""
    place: Any = origin
    target: Any = node
    target.lineno = place.lineno
    target.col_offset = place.col_offset
    target.end_lineno = place.end_lineno
    target.end_col_offset = place.end_col_offset
    return node


def sliceable(node: ast.Subscript) -> ast.expr:
    """Return the container of a subscript whose value is read; of a slice one that takes bounds which are random or lazy."""
    bounds = node.slice
    if not isinstance(bounds, ast.Slice) or not isinstance(node.ctx, ast.Load):
        return node.value
    if all(part is None or _is_plain(part) for part in (bounds.lower, bounds.upper, bounds.step)):
        return node.value
    return prelude_call("sliceable", [node.value], node.value)


def _is_plain(node: ast.expr) -> bool:
    """Return whether an expression is a constant, perhaps with a sign."""
    return isinstance(node.operand if isinstance(node, ast.UnaryOp) else node, ast.Constant)


def start_of(node: _Node, origin: ast.AST) -> _Node:
    """``node``, placed at the point where ``origin`` begins.

    What is called has to stand on one line: for a call of an attribute that ends on a later line than it begins,
    CPython moves the place of the call there.
    """
    place: Any = origin
    target: Any = node
    target.lineno = target.end_lineno = place.lineno
    target.col_offset = target.end_col_offset = place.col_offset
    return node


def rebuilt(node: _Node, **changes: Any) -> _Node:
    """A copy of ``node`` with other values of some fields; children are shared."""
    copy = type(node).__new__(type(node))
    copy.__dict__.update(node.__dict__)
    copy.__dict__.update(changes)
    return copy


def constant(value: Any, origin: ast.AST) -> ast.Constant:
    """A constant at a place."""
    return at(ast.Constant(value), origin)


def name(identifier: str, origin: ast.AST) -> ast.Name:
    """A read of a name at a place."""
    return at(ast.Name(identifier, ast.Load()), origin)


def tuple_(elements: Sequence[ast.expr], origin: ast.AST) -> ast.Tuple:
    """A tuple display at a place."""
    return at(ast.Tuple(list(elements), ast.Load()), origin)


def prelude(attribute: str, origin: ast.AST, context: ast.expr_context | None = None) -> ast.Attribute:
    """``__scenic__.attribute``, for use as a value: an error in it is an error of the whole ``origin``."""
    owner = start_of(ast.Name(PRELUDE, ast.Load()), origin)
    return at(ast.Attribute(owner, attribute, context or ast.Load()), origin)


def prelude_call(
    function: str,
    args: Sequence[ast.expr],
    origin: ast.AST,
    *,
    options: Mapping[str, object] = MappingProxyType({}),
) -> ast.Call:
    """``__scenic__.function(*args, **options)`` at a place; ``options`` are constants, or expressions that are lowered."""
    callee = start_of(
        ast.Attribute(start_of(ast.Name(PRELUDE, ast.Load()), origin), function, ast.Load()), origin
    )
    constants = [
        at(ast.keyword(option, value if isinstance(value, ast.expr) else constant(value, origin)), origin)
        for option, value in options.items()
    ]
    return at(ast.Call(callee, list(args), constants), origin)


def parameters(names: Sequence[ast.arg]) -> ast.arguments:
    """Return plain positional parameters."""
    return ast.arguments(
        posonlyargs=[], args=list(names), vararg=None, kwonlyargs=[], kw_defaults=[], kwarg=None, defaults=[]
    )


def lambda_(names: Sequence[tuple[str, ast.AST]], body: ast.expr, origin: ast.AST) -> ast.Lambda:
    """``lambda names: body`` at a place; each parameter with its own."""
    args = [at(ast.arg(identifier, None), place) for identifier, place in names]
    return at(ast.Lambda(parameters(args), body), origin)


def function(
    identifier: str,
    args: ast.arguments,
    body: Sequence[ast.stmt],
    decorator: str,
    origin: ast.AST,
) -> ast.FunctionDef:
    """Return ``@__scenic__.decorator`` on ``def identifier(args): body``."""
    mark = prelude(decorator, origin)
    start_of(mark, origin)
    fields: dict[str, Any] = {
        "name": identifier,
        "args": args,
        "body": list(body),
        "decorator_list": [mark],
        "returns": None,
        "type_comment": None,
    }
    if "type_params" in ast.FunctionDef._fields:  # Python 3.12
        fields["type_params"] = []
    return at(ast.FunctionDef(**fields), origin)


def statement(value: ast.expr, origin: ast.AST) -> ast.Expr:
    """Return an expression as a statement."""
    return at(ast.Expr(value), origin)


def instance_attribute(
    instance: str, identifier: str, origin: ast.AST, context: ast.expr_context | None = None
) -> ast.Attribute:
    """Return ``instance.identifier``, a local name of a scenario."""
    owner = start_of(ast.Name(instance, ast.Load()), origin)
    return at(ast.Attribute(owner, identifier, context or ast.Load()), origin)


def store_on_instance(instance: str, identifier: str, origin: ast.AST) -> ast.Assign:
    """Return ``instance.identifier = identifier``, at the beginning of ``origin``."""
    target = start_of(instance_attribute(instance, identifier, origin, ast.Store()), origin)
    value = start_of(ast.Name(identifier, ast.Load()), origin)
    return start_of(ast.Assign([target], value), origin)
