"""The blocks of a program: every list of statements, and what surrounds it."""

import ast
from collections.abc import Iterable, Iterator
from typing import Any, Final, NamedTuple

from scenic.compiler import tree as scenic
from scenic.compiler.scopes import Scope, ScopeKind
from scenic.compiler.traversal import position
from scenic.language.statements import Place

__all__ = ["DYNAMIC", "Block", "Where", "blocks", "in_compose", "where_of"]

DYNAMIC: Final = frozenset({Place.BEHAVIOR, Place.MONITOR, Place.COMPOSE})
"""Places where statements run step by step during a simulation."""


class Where(NamedTuple):
    """The surroundings of a node. ``function`` is ``None``, ``"def"``, ``"async def"`` or ``"lambda"``, within ``place``."""

    place: Place = Place.TOP
    function: str | None = None
    in_loop: bool = False
    in_class_block: bool = False
    interruptible: bool = False
    broken: bool = False
    """True if the text around the statements could not be parsed, so that their place is not known."""


class Block(NamedTuple):
    """The statements of one suite, and the node that it belongs to."""

    owner: ast.AST
    statements: list[Any]
    where: Where


def blocks(tree: ast.Module, statements: Iterable[ast.stmt]) -> Iterator[Block]:
    """Yield every block of some statements of a module, outer ones before those in them."""
    stack = [Block(tree, list(statements), Where())]
    while stack:
        block = stack.pop()
        yield block
        for statement in block.statements:
            if statement.__class__ in _HOLDING:
                stack.extend(inner for inner in _inner(statement, block.where) if inner.statements)


def _inner(node: object, where: Where) -> Iterable[Block]:
    """Return the blocks directly in a statement."""
    inner = where._replace(in_class_block=False) if where.in_class_block else where
    match node:
        case ast.FunctionDef() | ast.AsyncFunctionDef():
            word = "def" if isinstance(node, ast.FunctionDef) else "async def"
            # A method is an ordinary function, whatever class it belongs to.
            place = Place.TOP if where.place is Place.CLASS else where.place
            yield Block(node, node.body, Where(place, word))
        case ast.ClassDef():
            yield Block(node, node.body, Where(Place.CLASS, in_class_block=True))
        case scenic.BehaviorDef():
            yield Block(node, node.guards, Where(Place.BEHAVIOR))
            yield Block(node, node.body, Where(Place.BEHAVIOR))
        case scenic.MonitorDef():
            yield Block(node, node.body, Where(Place.MONITOR))
        case scenic.ScenarioDef():
            yield Block(node, node.guards, Where(Place.SETUP))
            yield Block(node, node.setup or [], Where(Place.SETUP))
            yield Block(node, node.compose or [], Where(Place.COMPOSE))
        case ast.For() | ast.AsyncFor() | ast.While():
            yield Block(node, node.body, inner._replace(in_loop=True))
            yield Block(node, node.orelse, inner)
        case scenic.TryInterrupt():
            within = inner._replace(interruptible=True)
            yield Block(node, node.body, within)
            for interrupt in node.interrupts:
                yield Block(interrupt, interrupt.body, within)
            for handler in node.handlers:
                yield Block(handler, handler.body, inner)
            yield Block(node, node.orelse, inner)
            yield Block(node, node.finalbody, inner)
        case ast.Try() | ast.TryStar():
            yield Block(node, node.body, inner)
            for handler in node.handlers:
                yield Block(handler, handler.body, inner)
            yield Block(node, node.orelse, inner)
            yield Block(node, node.finalbody, inner)
        case ast.If():
            yield Block(node, node.body, inner)
            yield Block(node, node.orelse, inner)
        case ast.With() | ast.AsyncWith():
            yield Block(node, node.body, inner)
        case scenic.ErrorStatement():
            yield Block(node, node.body, inner._replace(broken=True))
        case ast.Match():
            for case in node.cases:
                yield Block(case, case.body, inner)


_HOLDING: Final = frozenset(
    {
        ast.AsyncFor,
        ast.AsyncFunctionDef,
        ast.AsyncWith,
        ast.ClassDef,
        ast.For,
        ast.FunctionDef,
        ast.If,
        ast.Match,
        ast.Try,
        ast.TryStar,
        ast.While,
        ast.With,
        scenic.BehaviorDef,
        scenic.ErrorStatement,
        scenic.MonitorDef,
        scenic.ScenarioDef,
        scenic.TryInterrupt,
    }
)
"""Statements that hold blocks."""

_PLACES: Final = {
    ScopeKind.BEHAVIOR: Place.BEHAVIOR,
    ScopeKind.CLASS: Place.CLASS,
    ScopeKind.MODULE: Place.TOP,
    ScopeKind.MONITOR: Place.MONITOR,
    ScopeKind.PROPERTY: Place.CLASS,
}


def where_of(node: object, scope: Scope) -> Where:
    """Return the surroundings of an expression in ``scope``, apart from loops and the like."""
    function: str | None = None
    for outer in scope.ancestors():
        if outer.kind is ScopeKind.FUNCTION:
            function = function or ("async def" if isinstance(outer.node, ast.AsyncFunctionDef) else "def")
        elif outer.kind is ScopeKind.LAMBDA:
            function = function or "lambda"
        elif outer.kind is ScopeKind.SCENARIO:
            return Where(Place.COMPOSE if in_compose(node, outer.node) else Place.SETUP, function)
        elif outer.kind in _PLACES:
            place = _PLACES[outer.kind]
            # A method is an ordinary function, whatever class it belongs to.
            return Where(Place.TOP if place is Place.CLASS and function else place, function)
    return Where(Place.TOP, function)


def in_compose(node: object, scenario: Any) -> bool:
    """Return whether a node of a scenario stands in its compose block, which is always the last."""
    return bool(scenario.compose) and position(node) >= position(scenario.compose[0])
