"""Code that is never reached, and behaviors that never let time pass."""

import ast
from collections.abc import Iterator, Sequence
from typing import Any, Final

from scenic.compiler import tree as scenic
from scenic.compiler.checks.blocks import DYNAMIC, Where
from scenic.compiler.checks.conditions import truth
from scenic.compiler.checks.context import CheckContext
from scenic.compiler.places import word_span
from scenic.compiler.scopes import PROVIDED
from scenic.compiler.traversal import parts
from scenic.language.diagnostics import Diagnostic

__all__ = ["check_flow"]

_LASTING: Final = (
    scenic.Take,
    scenic.Wait,
    scenic.WaitFor,
    scenic.WaitUntil,
    scenic.Do,
    scenic.DoChoose,
    scenic.DoShuffle,
    scenic.Terminate,
)
"""Statements that give control back to the simulation (note e of section 2.1)."""

_LEAVING: Final = (ast.Return, ast.Raise, scenic.Abort)
"""Statements that leave a loop from anywhere within it, beside ``break``."""

_OWN_BODIES: Final = (
    ast.FunctionDef,
    ast.AsyncFunctionDef,
    ast.ClassDef,
    ast.Lambda,
    scenic.BehaviorDef,
    scenic.MonitorDef,
    scenic.ScenarioDef,
)
"""Nodes whose contents run at other times than what surrounds them."""


def check_flow(context: CheckContext) -> Iterator[Diagnostic]:
    """Report SC303 for code that is never reached, and SC304 and SC305 where no time passes."""
    endless: set[ast.AST] = set()
    for _, statements, where in context.blocks:
        yield from _after_end(statements, where, context)
        if where.place in DYNAMIC and where.function is None:
            for statement in statements:
                if (
                    isinstance(statement, ast.While)
                    and truth(statement.test) is True
                    and not _gives_way(statement, context)
                    and not context.broken
                ):
                    endless.add(statement)
                    yield _endless(context, statement)
    yield from _timeless(context, endless)


def _after_end(statements: Sequence[object], where: Where, context: CheckContext) -> Iterator[Diagnostic]:
    last = len(statements) - 1
    for index, statement in enumerate(statements):
        if index < last and _ends(statement, where):
            yield from _unreachable(context, statement, statements[index + 1 :])
            break


def _unreachable(context: CheckContext, ending: Any, rest: Sequence[Any]) -> Iterator[Diagnostic]:
    # A lone `yield` or `wait` after `return` makes a generator or a behavior of what has nothing else to do; `terminate` is
    # something to do.
    if len(rest) == 1:
        only = rest[0]
        if isinstance(only, ast.Pass) or (
            isinstance(only, scenic.Wait) and not isinstance(ending, scenic.Terminate)
        ):
            return
        if isinstance(only, ast.Expr) and isinstance(only.value, ast.Yield | ast.YieldFrom | ast.Constant):
            return
    if any(isinstance(statement, scenic.ErrorStatement) for statement in rest):
        return
    yield context.warning(
        "SC303",
        "this code is never reached",
        rest[0],
        "remove it, or move it before what ends the block",
        labels=(context.label(ending, "nothing after this runs"),),
    )


def _ends(statement: object, where: Where) -> bool:
    """Return whether nothing after a statement of its block ever runs; misplaced statements are taken for nothing."""
    match statement:
        case ast.Raise():
            return True
        case ast.Return():
            return where.function is not None or where.place in DYNAMIC
        case ast.Break() | ast.Continue():
            return where.in_loop
        case scenic.Terminate():
            return where.place in DYNAMIC and where.function is None
        case scenic.Abort():
            return where.interruptible
        case ast.If():
            # The blocks of long chains of `elif` lie in one another.
            while statement.orelse:
                if not any(_ends(inner, where) for inner in statement.body):
                    return False
                if len(statement.orelse) != 1 or not isinstance(statement.orelse[0], ast.If):
                    return any(_ends(inner, where) for inner in statement.orelse)
                statement = statement.orelse[0]
            return False
        case ast.While():
            return truth(statement.test) is True and not _breaks(statement)
    return False


def _breaks(loop: ast.While) -> bool:
    """Return whether a ``break`` in a loop may leave this loop, or something in it ends differently than it looks."""
    stack: list[tuple[Any, bool]] = [(statement, True) for statement in loop.body]
    while stack:
        node, is_of_loop = stack.pop()
        if isinstance(node, scenic.ErrorStatement) or (is_of_loop and isinstance(node, ast.Break)):
            return True
        if isinstance(node, (*_OWN_BODIES, ast.expr)):
            continue
        if isinstance(node, ast.For | ast.AsyncFor | ast.While):
            stack.extend((part, False) for part in node.body)
            stack.extend((part, is_of_loop) for part in node.orelse)
        else:
            stack.extend((part, is_of_loop) for part in parts(node))
    return False


def _gives_way(loop: ast.While, context: CheckContext) -> bool:
    """Return whether a loop may let time pass or end."""
    if _breaks(loop):
        return True
    stack: list[ast.AST] = [*loop.body]
    while stack:
        node = stack.pop()
        if isinstance(node, (*_LASTING, *_LEAVING, scenic.TryInterrupt, ast.Yield, ast.YieldFrom, ast.Await)):
            return True
        if _is_forgotten(node, context):
            return True
        if not isinstance(node, _OWN_BODIES):
            stack.extend(parts(node))
    return False


def _endless(context: CheckContext, loop: ast.While) -> Diagnostic:
    return context.warning(
        "SC304",
        "this loop never lets time pass, so the simulation would never go on",
        loop,
        "let each round `wait`, `take` an action or `do` something",
    )


def _timeless(context: CheckContext, endless: set[ast.AST]) -> Iterator[Diagnostic]:
    for cls in (scenic.BehaviorDef, scenic.MonitorDef, scenic.ScenarioDef):
        for node, _ in context.nodes(cls):
            body = node.compose if cls is scenic.ScenarioDef else node.body
            if (
                not body
                or _lasts(body, context)
                or any(loop in endless for loop in _loops(body))
                or context.broken
            ):
                continue
            kind = {scenic.BehaviorDef: "behavior", scenic.MonitorDef: "monitor"}.get(cls)
            if kind is None:
                message = f"the compose block of the scenario `{node.name}` never waits and does nothing"
                place: Any = body[0]
            else:
                message = (
                    f"the {kind} `{node.name}` never {'takes an action' if kind == 'behavior' else 'waits'}"
                )
                place = word_span(context.source, node, node.name)
            yield context.warning(
                "SC305",
                message,
                place,
                "it needs at least one `wait`, `do` or `terminate`"
                if kind != "behavior"
                else "it needs at least one `take`, `wait`, `do` or `terminate`",
            )


def _lasts(body: list[Any], context: CheckContext) -> bool:
    stack: list[ast.AST] = [*body]
    while stack:
        node = stack.pop()
        if isinstance(node, _LASTING) or _is_begun(node, context) or _is_forgotten(node, context):
            return True
        if isinstance(node, ast.Expr) and isinstance(node.value, ast.Yield | ast.YieldFrom):
            return True  # It is reported itself.
        if not isinstance(node, (*_OWN_BODIES, ast.expr)):
            stack.extend(parts(node))
    return False


def _is_begun(node: ast.AST, context: CheckContext) -> bool:
    """Return whether a statement is a `take` of which only the word is written, or a word that may be a misspelt `wait`."""
    if not isinstance(node, ast.Expr) or not isinstance(node.value, ast.Name):
        return False
    name = node.value
    return name.id == "take" or (context.binding(name) is None and name.id not in PROVIDED)


def _is_forgotten(node: ast.AST, context: CheckContext) -> bool:
    """Return whether a statement makes or names a behavior or scenario without `do`, which SC312 reports."""
    if not isinstance(node, ast.Expr):
        return False
    function = node.value.func if isinstance(node.value, ast.Call) else node.value
    symbol = context.definition(function)
    definition: Any = None if symbol is None else symbol.node
    return isinstance(definition, scenic.BehaviorDef | scenic.ScenarioDef)


def _loops(body: list[Any]) -> Iterator[ast.AST]:
    stack: list[ast.AST] = [*body]
    while stack:
        node = stack.pop()
        if isinstance(node, ast.While):
            yield node
        if not isinstance(node, (*_OWN_BODIES, ast.expr)):
            stack.extend(parts(node))
