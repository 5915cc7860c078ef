"""Putting an expression into a variable of its own, and a variable's value in its place.

Both are offered only where the program certainly means the same: a value may be random, so that copies of it would be drawn apart,
and conditions are evaluated again and again.
"""

import ast
from collections.abc import Iterator
from itertools import pairwise
from typing import Any, Final

from scenic.compiler import tree as scenic
from scenic.compiler.semantics.model import Model
from scenic.compiler.semantics.modules import Modules
from scenic.compiler.traversal import parts, walk
from scenic.dataclass import dataclass
from scenic.ide.snapshot import Snapshot
from scenic.language.diagnostics import Edit
from scenic.language.spans import Span

__all__ = ["Refactoring", "extract_variable", "inline_variable"]

_ONCE: Final = (ast.Assign, ast.AnnAssign, ast.AugAssign, ast.Expr, ast.Return, scenic.Param, scenic.Take)
"""Statements that evaluate all of their expressions once, when they are reached."""
_SOMETIMES: Final = (
    ast.BoolOp, ast.IfExp, ast.Lambda, ast.ListComp, ast.SetComp, ast.DictComp, ast.GeneratorExp, ast.NamedExpr,
    ast.Compare, ast.JoinedStr, ast.Await, ast.Yield, ast.YieldFrom, ast.Starred, scenic.Temporal,
)  # fmt: skip
"""Expressions that do not evaluate all parts of themselves just once, or that have a part which is not an expression of its own."""
_ATOMS: Final = (ast.Name, ast.Constant, ast.Attribute, ast.Call, ast.Subscript, ast.List, ast.Dict, ast.Set)


@dataclass(frozen=True, slots=True)
class Refactoring:
    """A change that leaves the meaning of a program as it is."""

    title: str
    edits: tuple[Edit, ...]


def extract_variable(modules: Modules, snapshot: Snapshot, span: Span) -> Refactoring | None:
    """Give the expression that is selected a name, in a line before its statement."""
    if snapshot.parsed.diagnostics or (span.line, span.column) == (span.end_line, span.end_column):
        return None
    path = _path_of(snapshot, span)
    place = max((at for at, node in enumerate(path) if isinstance(node, ast.stmt)), default=None)
    if place is None:
        return None
    statement: Any = path[place]
    expression, between = path[-1], path[place + 1 : -1]
    if not isinstance(statement, _ONCE) or isinstance(expression, ast.Constant | ast.Name):
        return None
    if any(isinstance(node, _SOMETIMES) for node in between) or isinstance(
        expression, ast.JoinedStr | ast.Starred
    ):
        return None
    if not isinstance(getattr(expression, "ctx", ast.Load()), ast.Load) or _own_names(
        snapshot.model(modules), expression
    ):
        return None
    line = snapshot.source.line(statement.lineno)
    indentation = line[: len(line) - len(line.lstrip())]
    if snapshot.source.character(statement.lineno, statement.col_offset) != len(indentation):
        return None  # It shares its line with another one.
    text = _text(snapshot, span)
    name = _unused(snapshot, "value")
    if span.line != span.end_line and text[:1] not in "([{":
        text = f"({text})"
    before = Span(statement.lineno, 0, statement.lineno, 0)
    edits = (Edit(before, f"{indentation}{name} = {text}\n"), Edit(span, name))
    return Refactoring(f"Extract into a variable `{name}`", edits)


def inline_variable(modules: Modules, snapshot: Snapshot, line: int, column: int) -> Refactoring | None:
    """Put the value of the variable at a place where it is used, and remove the variable: one that is used just once."""
    node: Any = snapshot.path_to(line, column)[-1]
    if snapshot.parsed.diagnostics or not isinstance(node, ast.Name):
        return None
    model = snapshot.model(modules)
    binding = model.binding(node)
    if binding is None or len(binding.sites) != 1 or model.resolution.reflective or not model.stays(node):
        return None
    uses: list[Any] = [
        each for each in model.names() if model.binding(each) is binding and each is not binding.sites[0]
    ]
    if len(uses) != 1:
        return None
    neighbours = _neighbours(snapshot.tree, binding.sites[0], uses[0])
    if neighbours is None:
        return None
    assignment, statement = neighbours
    path = snapshot.path_to(uses[0].lineno, snapshot.source.character(uses[0].lineno, uses[0].col_offset))
    inside = path[path.index(statement) + 1 :] if statement in path else [uses[0], uses[0]]
    if any(isinstance(each, _SOMETIMES) for each in inside) or inside[-1] is not uses[0]:
        return None
    if not isinstance(statement, _ONCE) or assignment.lineno != assignment.end_lineno:
        return None
    text = _text(snapshot, snapshot.source.span(assignment.value))
    if not isinstance(assignment.value, _ATOMS):
        text = f"({text})"
    line_span = Span(assignment.lineno, 0, assignment.lineno + 1, 0)
    edits = (Edit(line_span, ""), Edit(snapshot.source.span(uses[0]), text))
    return Refactoring(f"Inline `{binding.name}`", edits)


def _path_of(snapshot: Snapshot, span: Span) -> list[ast.AST]:
    """Return the nodes around an expression that stands exactly at a span, that expression last."""
    path: list[ast.AST] = [snapshot.tree]
    while True:
        if isinstance(path[-1], ast.expr) and snapshot.source.span(path[-1]) == span:
            return path
        inner = next((child for child in parts(path[-1]) if snapshot.source.span(child).contains(span)), None)
        if inner is None:
            return []
        path.append(inner)


def _own_names(model: Model, expression: ast.AST) -> bool:
    """Return whether an expression reads ``self`` of the object that a specifier is about, or binds a name."""
    for node in walk(expression):
        if isinstance(node, ast.NamedExpr):
            return True
        if isinstance(node, ast.Name) and node.id == "self" and model.binding(node) is None:
            return True
    return False


def _neighbours(tree: ast.Module, site: ast.AST, use: ast.AST) -> tuple[ast.Assign, ast.stmt] | None:
    """The assignment to a name and the statement that uses it, if the one follows the other."""
    for block in _blocks(tree):
        for first, second in pairwise(block):
            if isinstance(first, ast.Assign) and first.targets == [site]:
                return (first, second) if any(node is use for node in walk(second)) else None
    return None


def _blocks(tree: ast.AST) -> Iterator[list[ast.stmt]]:
    for node in walk(tree):
        for name in ("body", "orelse", "finalbody", "setup", "compose"):
            block = getattr(node, name, None)
            if isinstance(block, list):
                yield block


def _unused(snapshot: Snapshot, name: str) -> str:
    """A name that nothing in a document has."""
    taken = set(snapshot.tokens.texts)
    if name not in taken:
        return name
    return next(f"{name}{number}" for number in range(2, len(taken) + 3) if f"{name}{number}" not in taken)


def _text(snapshot: Snapshot, span: Span) -> str:
    lines = list(snapshot.source.lines[span.line - 1 : span.end_line])
    lines[-1:] = [lines[-1][: span.end_column]]
    lines[0:1] = [lines[0][span.column :]]
    return "\n".join(lines)
