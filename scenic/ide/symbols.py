"""Definitions of a document, as a tree, and of a workspace, as a list to search in."""

import ast
from bisect import bisect_left
from collections.abc import Iterator, Sequence
from enum import StrEnum
from typing import Any, Final

from scenic.compiler import tree as scenic
from scenic.compiler.traversal import position
from scenic.dataclass import dataclass
from scenic.ide.name_places import name_span, span_of
from scenic.ide.snapshot import Snapshot
from scenic.ide.spacing import text_of
from scenic.language.spans import Span

__all__ = ["OutlineKind", "OutlineSymbol", "flat", "matches", "symbols"]

_DEEPEST: Final = 40
"""The largest number of definitions within each other: answers nest twice as deeply."""


class OutlineKind(StrEnum):
    """The kinds of symbols, in the language's own words."""

    CLASS = "class"
    PROPERTY = "property"
    FUNCTION = "function"
    METHOD = "method"
    BEHAVIOR = "behavior"
    MONITOR = "monitor"
    SCENARIO = "scenario"
    OBJECT = "object"
    VARIABLE = "variable"
    CONSTANT = "constant"
    PARAMETER = "global parameter"
    REQUIREMENT = "requirement"


@dataclass(frozen=True, slots=True)
class OutlineSymbol:
    """One definition: ``span`` is all of it, ``name_span`` the name in it, ``detail`` what to say beside the name."""

    name: str
    kind: OutlineKind
    detail: str
    span: Span
    name_span: Span
    children: tuple["OutlineSymbol", ...] = ()


def symbols(snapshot: Snapshot) -> tuple[OutlineSymbol, ...]:
    """The definitions of a document, in order; those within more than 40 other definitions are left out."""
    return snapshot.derived("symbols", lambda: tuple(_of_block(snapshot, snapshot.tree.body, _DEEPEST)))


def flat(found: Sequence[OutlineSymbol], container: str = "") -> Iterator[tuple[OutlineSymbol, str]]:
    """Symbols and those in them, each with the name of what contains it."""
    for symbol in found:
        yield symbol, container
        yield from flat(symbol.children, symbol.name)


def matches(name: str, query: str) -> bool:
    """Return whether the characters of a query occur in a name, in order, whatever their case."""
    rest = iter(name.lower())
    return all(character in rest for character in query.lower() if not character.isspace())


def _of_block(
    snapshot: Snapshot, statements: Sequence[ast.stmt], depth: int, *, in_class: bool = False
) -> Iterator[OutlineSymbol]:
    """Yield the definitions in a block and in the blocks within it, with up to ``depth`` levels of definitions in them."""
    if not depth:
        return
    names: set[str] = set()
    # Definitions under a condition or in a loop belong to the block around it. Such blocks may nest deeply.
    stack: list[Any] = [*reversed(statements)]
    while stack:
        node = stack.pop()
        inner = _blocks_of(node)
        if inner is None:
            yield from _of_statement(snapshot, node, names, depth - 1, in_class=in_class)
        else:
            stack.extend(reversed(inner))


def _blocks_of(node: object) -> list[ast.stmt] | None:
    """Return the statements within a statement that does not define anything; ``None`` for one that does."""
    if isinstance(node, _DEFINING):
        return None
    inner: list[ast.stmt] = []
    for field in ("body", "orelse", "finalbody"):
        inner += getattr(node, field, None) or ()
    for part in (
        *getattr(node, "handlers", ()),
        *getattr(node, "interrupts", ()),
        *getattr(node, "cases", ()),
    ):
        inner += part.body
    return inner


def _of_statement(
    snapshot: Snapshot, node: object, seen: set[str], depth: int, *, in_class: bool
) -> Iterator[OutlineSymbol]:
    if isinstance(node, ast.FunctionDef | ast.AsyncFunctionDef):
        kind = OutlineKind.METHOD if in_class else OutlineKind.FUNCTION
        yield _symbol(snapshot, node, kind, _signature(snapshot, node), _inner(snapshot, node.body, depth))
    elif isinstance(node, ast.ClassDef):
        bases = ", ".join(_text(snapshot, base) for base in node.bases)
        children = tuple(_of_block(snapshot, node.body, depth, in_class=True))
        yield _symbol(snapshot, node, OutlineKind.CLASS, f"({bases})" if bases else "", children)
    elif isinstance(node, scenic.BehaviorDef | scenic.MonitorDef):
        kind = OutlineKind.BEHAVIOR if isinstance(node, scenic.BehaviorDef) else OutlineKind.MONITOR
        yield _symbol(snapshot, node, kind, _signature(snapshot, node), _inner(snapshot, node.body, depth))
    elif isinstance(node, scenic.ScenarioDef):
        body = [*(node.setup or ()), *(node.compose or ())]
        children = tuple(_of_block(snapshot, body, depth))
        yield _symbol(
            snapshot, node, OutlineKind.SCENARIO, _signature(snapshot, node) if node.args else "", children
        )
    elif isinstance(node, scenic.PropertyDef):
        attributes = f"[{', '.join(node.attributes)}]" if node.attributes else ""
        yield _symbol(
            snapshot, node, OutlineKind.PROPERTY, f"{attributes}: {_text(snapshot, node.value)}".strip(": ")
        )
    elif isinstance(node, scenic.Param):
        for item in node.items:
            yield _symbol(snapshot, item, OutlineKind.PARAMETER, _text(snapshot, item.value))
    elif isinstance(node, scenic.Require | scenic.RequireMonitor | scenic.TerminateWhen):
        if isinstance(node.name, str):
            span = span_of(snapshot, node)
            yield OutlineSymbol(node.name, OutlineKind.REQUIREMENT, "", span, span)
    elif isinstance(node, ast.Assign | ast.AnnAssign):
        targets = node.targets if isinstance(node, ast.Assign) else [node.target]
        for target in targets:
            for bound in _names(target):
                if bound.id not in seen:
                    seen.add(bound.id)
                    yield OutlineSymbol(
                        bound.id,
                        _kind_of_value(node.value, bound.id),
                        "" if node.value is None else _text(snapshot, node.value),
                        span_of(snapshot, node),
                        name_span(snapshot, bound),
                    )


def _inner(snapshot: Snapshot, body: Sequence[ast.stmt], depth: int) -> tuple[OutlineSymbol, ...]:
    """Return the definitions in a function, without its variables."""
    kinds = (OutlineKind.VARIABLE, OutlineKind.CONSTANT, OutlineKind.OBJECT)
    return tuple(each for each in _of_block(snapshot, body, depth) if each.kind not in kinds)


def _symbol(
    snapshot: Snapshot, node: Any, kind: OutlineKind, detail: str, children: tuple[OutlineSymbol, ...] = ()
) -> OutlineSymbol:
    span, name = span_of(snapshot, node), name_span(snapshot, node)
    first = getattr(node, "decorator_list", None)
    if first:
        start = span_of(snapshot, first[0])
        span = Span(start.line, 0 if start.column < 2 else start.column - 1, span.end_line, span.end_column)
    return OutlineSymbol(node.name, kind, detail, span, name, children)


def _kind_of_value(value: ast.expr | None, name: str) -> OutlineKind:
    if isinstance(value, scenic.New):
        return OutlineKind.OBJECT
    return OutlineKind.CONSTANT if name.isupper() else OutlineKind.VARIABLE


def _names(target: ast.expr) -> Iterator[ast.Name]:
    """The names that a target binds, in order."""
    stack = [target]
    while stack:
        part = stack.pop()
        if isinstance(part, ast.Name):
            yield part
        elif isinstance(part, ast.Tuple | ast.List):
            stack.extend(reversed(part.elts))
        elif isinstance(part, ast.Starred):
            stack.append(part.value)


def _signature(snapshot: Snapshot, node: Any) -> str:
    """Return the parameters of a definition as they are written, on one line."""
    tokens = snapshot.tokens
    begin = _token_at(snapshot, node.lineno, node.col_offset)
    if begin == len(tokens.texts) or (tokens.lines[begin], tokens.columns[begin]) != position(node):
        # A string before it is left open, which only the parser knows: to the plain lexer the definition is inside.
        body = getattr(node, "body", None)  # Not of a scenario.
        first, *lines = snapshot.source.lines[node.lineno - 1 : body[0].lineno if body else node.end_lineno]
        header = "\n".join([first.encode()[node.col_offset :].decode(), *lines])
        snapshot, begin = Snapshot(header, snapshot.filename), 0
        tokens = snapshot.tokens
    count = len(tokens.texts)
    while begin < count and tokens.texts[begin] not in ("(", ":"):
        begin += 1
    end, depth = begin, 0
    while end < count and (depth or tokens.texts[end] != ":"):
        depth += (tokens.texts[end] in ("(", "[", "{")) - (tokens.texts[end] in (")", "]", "}"))
        end += 1
    return text_of(snapshot, begin, end).partition(" ->")[0]


def _token_at(snapshot: Snapshot, line: int, column: int) -> int:
    """The first token at a place or after it; ``column`` counts bytes."""
    lines, columns = snapshot.tokens.lines, snapshot.tokens.columns
    return bisect_left(range(len(lines)), (line, column), key=lambda index: (lines[index], columns[index]))


def _text(snapshot: Snapshot, node: ast.expr) -> str:
    """Return an expression on one line; a long one is cut."""
    begin = _token_at(snapshot, node.lineno, node.col_offset)
    end = _token_at(snapshot, node.end_lineno or 0, node.end_col_offset or 0)
    text = text_of(snapshot, begin, end)
    line, more, _ = text.partition("\n")
    return line[:_LONGEST] + ("..." if more or len(line) > _LONGEST else "")


_LONGEST = 80

_DEFINING: Final = (
    ast.FunctionDef,
    ast.AsyncFunctionDef,
    ast.ClassDef,
    ast.Assign,
    ast.AnnAssign,
    scenic.BehaviorDef,
    scenic.MonitorDef,
    scenic.ScenarioDef,
    scenic.PropertyDef,
    scenic.Param,
    scenic.Require,
    scenic.RequireMonitor,
    scenic.TerminateWhen,
)
