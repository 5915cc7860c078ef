"""Statements in places where they cannot stand (section 2.1)."""

import ast
from collections.abc import Iterable, Iterator
from dataclasses import dataclass, replace
from typing import Any, Final

from scenic.compiler import tree as scenic
from scenic.compiler.checks.places import header_span
from scenic.compiler.traversal import parts
from scenic.language.diagnostics import Diagnostic, Severity
from scenic.language.names import TRACKED
from scenic.language.source import Source
from scenic.language.statements import STATEMENTS, Place

__all__ = ["check_placement"]


@dataclass(frozen=True, slots=True)
class _Where:
    """What surrounds a node. ``function`` is ``None``, ``"def"`` or ``"async def"``, within ``place``."""

    place: Place = Place.TOP
    function: str | None = None
    in_loop: bool = False
    in_class_block: bool = False
    interruptible: bool = False


_DYNAMIC: Final = frozenset({Place.BEHAVIOR, Place.MONITOR, Place.COMPOSE})
_SUSPENDING: Final = (
    scenic.Take,
    scenic.Wait,
    scenic.WaitFor,
    scenic.WaitUntil,
    scenic.Do,
    scenic.DoChoose,
    scenic.DoShuffle,
    scenic.TryInterrupt,
    scenic.Abort,
    scenic.Terminate,
)
"""Statements that act on the running behavior, scenario or monitor itself, never on a function called by it."""

_Task = tuple[ast.AST, _Where]


def check_placement(tree: ast.Module, source: Source) -> Iterator[tuple[ast.AST, Diagnostic]]:
    """SC201: every node that stands where it must not, and what is to be said about it."""
    stack: list[_Task] = [(tree, _Where())]
    while stack:
        node, where = stack.pop()
        cls = node.__class__
        if cls in _CHECKED:
            for message, help_ in _problems(node, where):
                place = header_span(source, node)
                yield node, Diagnostic("SC201", message, place, Severity.ERROR, source.filename, help_)
        if cls in _SURROUNDING:
            stack.extend(reversed(list(_children(node, where))))
        else:
            inner = _outside_blocks(where)
            stack.extend([(part, inner) for part in reversed(parts(node))])


def _problems(node: ast.AST, where: _Where) -> Iterator[tuple[str, str]]:
    """Messages and help for one node."""
    statement = STATEMENTS.get(type(node).__name__)
    if statement is not None:
        if where.place not in statement.places:
            allowed = " or ".join(sorted(str(place) for place in statement.places))
            yield f"`{statement.title}` cannot be used {where.place}", f"it can stand {allowed}"
            return
        if where.function is not None and where.place in _DYNAMIC and isinstance(node, _SUSPENDING):
            yield (
                f"`{statement.title}` cannot be used in a function {where.place}",
                "it acts on what is running: move it out of the function",
            )
            return
    match node:
        case scenic.PropertyDef() if not where.in_class_block:
            yield (
                "a property is defined directly in the body of its class",
                "move it out of the nested statement",
            )
        case scenic.Do(targets=[_, _, *_]) if where.place is not Place.COMPOSE:
            yield (
                f"`do` with several targets cannot be used {where.place}",
                "only scenarios run in parallel, in a compose block; write one `do` for each",
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
        case ast.Yield() | ast.YieldFrom() if where.function is None:
            yield f"`yield` cannot be used {where.place}", "it belongs in a function"
        case ast.Return() if where.function is None and where.place in (Place.TOP, Place.CLASS):
            yield f"`return` cannot be used {where.place}", "it belongs in a function"
        case ast.Break() | ast.Continue() if not where.in_loop:
            yield (
                f"`{type(node).__name__.lower()}` outside of a loop",
                "it belongs in a `for` or `while` loop",
            )
        case ast.AsyncFunctionDef() if where.place in _DYNAMIC:
            yield f"`async def` cannot be used {where.place}", "define the coroutine at the top level"
        case ast.Await() | ast.AsyncFor() | ast.AsyncWith() if where.function != "async def":
            word = {ast.Await: "await", ast.AsyncFor: "async for", ast.AsyncWith: "async with"}[type(node)]
            yield f"`{word}` outside of an `async def` function", "it belongs in a coroutine"


def _children(node: Any, where: _Where) -> Iterable[_Task]:
    """The parts of a node that changes what surrounds them, with what does."""
    match node:
        case ast.Module():
            yield from _all(node.body, where)
        case ast.FunctionDef() | ast.AsyncFunctionDef():
            word = "def" if isinstance(node, ast.FunctionDef) else "async def"
            # A method is an ordinary function, whatever class it belongs to.
            place = Place.TOP if where.place is Place.CLASS else where.place
            yield from _all([*node.decorator_list, node.args, node.returns], _outside_blocks(where))
            yield from _all(node.body, _Where(place, word))
        case ast.Lambda():
            yield from _all([node.args], _outside_blocks(where))
            yield node.body, replace(_outside_blocks(where), function="lambda")
        case ast.ClassDef():
            yield from _all([*node.decorator_list, *node.bases, *node.keywords], _outside_blocks(where))
            yield from _all(node.body, _Where(Place.CLASS, in_class_block=True))
        case scenic.BehaviorDef():
            yield node.args, _outside_blocks(where)
            yield from _all([*node.guards, *node.body], _Where(Place.BEHAVIOR))
        case scenic.MonitorDef():
            yield node.args, _outside_blocks(where)
            yield from _all(node.body, _Where(Place.MONITOR))
        case scenic.ScenarioDef():
            yield from _all([node.args], _outside_blocks(where))
            yield from _all([*node.guards, *(node.setup or ())], _Where(Place.SETUP))
            yield from _all(node.compose or (), _Where(Place.COMPOSE))
        case ast.For() | ast.AsyncFor() | ast.While():
            inner = _outside_blocks(where)
            header = [node.test] if isinstance(node, ast.While) else [node.target, node.iter]
            yield from _all(header, inner)
            yield from _all(node.body, replace(inner, in_loop=True))
            yield from _all(node.orelse, inner)
        case scenic.TryInterrupt():
            inner = replace(_outside_blocks(where), interruptible=True)
            yield from _all([*node.body, *node.interrupts], inner)
            yield from _all([*node.handlers, *node.orelse, *node.finalbody], _outside_blocks(where))


def _outside_blocks(where: _Where) -> _Where:
    return replace(where, in_class_block=False) if where.in_class_block else where


def _all(nodes: Iterable[ast.AST | None], where: _Where) -> Iterator[_Task]:
    for node in nodes:
        if node is not None:
            yield node, where


_SURROUNDING: Final = frozenset(
    {
        ast.Module,
        ast.FunctionDef,
        ast.AsyncFunctionDef,
        ast.Lambda,
        ast.ClassDef,
        ast.For,
        ast.AsyncFor,
        ast.While,
        scenic.BehaviorDef,
        scenic.MonitorDef,
        scenic.ScenarioDef,
        scenic.TryInterrupt,
    }
)
_CHECKED: Final = frozenset(
    {
        ast.AnnAssign,
        ast.Assign,
        ast.AsyncFor,
        ast.AsyncFunctionDef,
        ast.AsyncWith,
        ast.Await,
        ast.Break,
        ast.Continue,
        ast.ImportFrom,
        ast.Return,
        ast.Yield,
        ast.YieldFrom,
        *(getattr(scenic, node) for node in STATEMENTS),
    }
)
