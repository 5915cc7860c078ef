"""Statements in places where they cannot stand (section 2.1)."""

import ast
from collections.abc import Iterator
from typing import Final

from scenic.compiler import tree as scenic
from scenic.compiler.checks.blocks import DYNAMIC, Where, where_of
from scenic.compiler.checks.context import HEADED, CheckContext
from scenic.compiler.traversal import walk
from scenic.language.diagnostics import Diagnostic
from scenic.language.names import TRACKED
from scenic.language.statements import STATEMENTS, Place, Statement

__all__ = ["check_placement"]

_ASKED: Final = (scenic.Record, scenic.Require, scenic.Simulator, scenic.TerminateWhen)
"""Statements whose expressions become functions of their own."""

_EXPRESSIONS: Final = (ast.Await, ast.Yield, ast.YieldFrom)
"""The expressions that cannot stand everywhere."""


def check_placement(context: CheckContext) -> Iterator[tuple[ast.AST, Diagnostic | None]]:
    """Yield the misplaced nodes, each with its SC201.

    A node has no diagnostic where its place follows from another mistake.
    """
    for _, statements, where in context.blocks:
        if where.broken:
            continue
        header_before = False
        checked = _CHECKED if where.place is Place.CLASS else _CHECKED_ELSEWHERE
        for statement in statements:
            if statement.__class__ is scenic.ErrorStatement:
                header_before = True
            elif isinstance(statement, HEADED):
                header_before = False
            if statement.__class__ in checked:
                if header_before and statement.__class__ in _OF_BEHAVIORS:
                    # It may belong to the block whose header is wrong.
                    yield statement, None
                    continue
                for message, help_ in _problems(statement, where):
                    yield statement, context.error("SC201", message, statement, help_)
    misplacements = list(_misplaced_expressions(context))
    if misplacements and not context.broken:
        yield from misplacements


def _misplaced_expressions(context: CheckContext) -> Iterator[tuple[ast.AST, Diagnostic]]:
    later = _evaluated_later(context)
    for cls in _EXPRESSIONS:
        for node, scope in context.nodes(cls):
            if node in later:
                message = "`await` cannot be used in what simulations ask for later, outside of the function"
                yield node, context.error("SC201", message, node, "await the value before, and name it here")
                continue
            for message, help_ in _misplaced_expression(node, where_of(node, scope)):
                yield node, context.error("SC201", message, node, help_)


def _evaluated_later(context: CheckContext) -> set[ast.AST]:
    """Return the expressions with ``await`` in conditions and values that become functions."""
    awaiting = {node for node, _ in context.nodes(ast.Await)}
    if not awaiting:
        return set()
    return {
        part
        for block in context.blocks
        for statement in block.statements
        if isinstance(statement, _ASKED)
        for part in walk(statement)
        if part in awaiting
    }


def _declared_problem(statement: Statement, where: Where) -> tuple[str, str] | None:
    """The message and the help for a statement that is not at one of its declared places."""
    if where.place not in statement.places:
        places = " or ".join(sorted(str(place) for place in statement.places))
        if where.function is not None and where.place is Place.TOP:
            return (
                f"`{statement.title}` cannot be used in a function",
                f"it can stand {places}; a function cannot act for an agent",
            )
        return f"`{statement.title}` cannot be used {where.place}", f"it can stand {places}"
    if where.function is not None and where.place in DYNAMIC and statement.suspends:
        return (
            f"`{statement.title}` cannot be used in a function {where.place}",
            "it acts on what is running: move it out of the function",
        )
    return None


def _problems(node: ast.AST, where: Where) -> Iterator[tuple[str, str]]:
    """Messages and help for one statement."""
    statement = STATEMENTS.get(type(node).__name__)
    problem = None if statement is None else _declared_problem(statement, where)
    if problem is not None:
        yield problem
        return
    match node:
        case scenic.PropertyDef() if not where.in_class_block:
            yield (
                "a property is defined directly in the body of its class",
                "move it out of the nested statement",
            )
        case scenic.Do(targets=[_, _, *_]) if where.place not in (Place.COMPOSE, Place.BEHAVIOR):
            yield (
                f"`do` with several targets cannot be used {where.place}",
                "only scenarios and behaviors run side by side; write one `do` for each",
            )
        case scenic.Abort() if not where.interruptible:
            yield (
                "`abort` outside of a try-interrupt statement",
                "use it inside `try: ... interrupt when ...:`",
            )
        case scenic.Model() if where.function is not None:
            yield "`model` cannot be used in a function", "move it to the beginning of the file"
        case ast.ImportFrom(names=[ast.alias(name="*")]) if not (
            where.place is Place.TOP and where.function is None
        ):
            yield "`import *` can only be used at the top level", "import the names that are needed"
        case ast.Assign(targets=[ast.Name(id=name)]) if (
            where.place is Place.CLASS and where.function is None and name in TRACKED
        ):
            yield f"`{name}` cannot be set in the body of a class", "move the statement out of the class"
        case ast.AnnAssign() if where.place is Place.CLASS and where.function is None:
            yield (
                "annotated assignments are not allowed in the body of a class",
                "write `name: default` for a property, `name = value` for an attribute",
            )
        case _:
            yield from _python_problems(node, where)


def _python_problems(node: ast.AST, where: Where) -> Iterator[tuple[str, str]]:
    match node:
        case ast.Return() if where.function is None and where.place in (Place.TOP, Place.CLASS):
            yield f"`return` cannot be used {where.place}", "it belongs in a function"
        case ast.Break() | ast.Continue() if not where.in_loop:
            yield (
                f"`{type(node).__name__.lower()}` outside of a loop",
                "it belongs in a `for` or `while` loop",
            )
        case ast.AsyncFunctionDef() if where.place in DYNAMIC:
            yield f"`async def` cannot be used {where.place}", "define the coroutine at the top level"
        case ast.AsyncFor() | ast.AsyncWith() if where.function != "async def":
            word = "async for" if isinstance(node, ast.AsyncFor) else "async with"
            yield f"`{word}` outside of an `async def` function", "it belongs in a coroutine"


def _misplaced_expression(node: object, where: Where) -> Iterator[tuple[str, str]]:
    if isinstance(node, ast.Await):
        if where.function != "async def":
            yield "`await` outside of an `async def` function", "it belongs in a coroutine"
    elif where.function is None:
        yield f"`yield` cannot be used {where.place}", "it belongs in a function"


_OF_BEHAVIORS: Final = frozenset(
    getattr(scenic, statement.node) for statement in STATEMENTS.values() if statement.suspends
)
"""Statements that stand in behaviors and the like only."""

_CHECKED: Final = frozenset(
    {
        ast.AnnAssign,
        ast.Assign,
        ast.AsyncFor,
        ast.AsyncFunctionDef,
        ast.AsyncWith,
        ast.Break,
        ast.Continue,
        ast.ImportFrom,
        ast.Return,
        *(getattr(scenic, node) for node in STATEMENTS),
    }
)
_CHECKED_ELSEWHERE: Final = _CHECKED - {ast.AnnAssign, ast.Assign}
"""Assignments stand everywhere but in classes."""
