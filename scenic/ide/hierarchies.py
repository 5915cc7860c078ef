"""Hierarchies of calls and of classes."""

import ast
from collections.abc import Iterator
from typing import Any

from scenic.compiler import tree as scenic
from scenic.compiler.semantics.classes import Classes
from scenic.compiler.semantics.model import Model
from scenic.compiler.semantics.modules import Module
from scenic.compiler.semantics.symbols import DEFINITIONS, Symbol, SymbolKind, symbol_of_binding
from scenic.compiler.traversal import parts, walk
from scenic.dataclass import dataclass
from scenic.ide.inheritance import subclasses
from scenic.language.spans import Span
from scenic.project.index import Project
from scenic.project.queries import references, symbol_at

__all__ = [
    "CallSite",
    "callable_at",
    "callees",
    "callers",
    "class_at",
    "module_symbol",
    "subtypes",
    "supertypes",
]

_CALLABLE = (
    SymbolKind.CLASS,
    SymbolKind.FUNCTION,
    SymbolKind.METHOD,
    SymbolKind.BEHAVIOR,
    SymbolKind.MONITOR,
    SymbolKind.SCENARIO,
)


@dataclass(frozen=True, slots=True)
class CallSite:
    """Another function, and where the calls are: in the caller's file."""

    symbol: Symbol
    filename: str
    spans: tuple[Span, ...]


def callable_at(project: Project, filename: str, line: int, column: int) -> Symbol | None:
    """Return the function, behavior, monitor, scenario or class that the name at a place means."""
    symbol = symbol_at(project, filename, line, column)
    return symbol if symbol is not None and symbol.kind in _CALLABLE and not symbol.is_builtin else None


def class_at(project: Project, filename: str, line: int, column: int) -> Symbol | None:
    """Return the class that the name at a place means, if a file defines it."""
    symbol = symbol_at(project, filename, line, column)
    return (
        symbol if symbol is not None and symbol.kind is SymbolKind.CLASS and not symbol.is_builtin else None
    )


def callers(project: Project, symbol: Symbol) -> tuple[CallSite, ...]:
    """Return the callers of a function, each once. Code outside of functions is its module."""
    spans_of_caller: dict[Symbol, list[Span]] = {}
    for place in references(project, symbol):
        module = project.module(place.filename)
        if place.defines or module is None:
            continue
        if not _is_called(module, place.span):
            continue
        caller = _around(module, place.span)
        spans_of_caller.setdefault(caller, []).append(place.span)
    return tuple(
        CallSite(caller, caller.filename or "", tuple(spans)) for caller, spans in spans_of_caller.items()
    )


def callees(project: Project, symbol: Symbol) -> tuple[CallSite, ...]:
    """The callees of a function, each once, with the places of the calls in the function.

    Calls in definitions within it are those of the inner ones. The callees of a module are called outside of definitions.
    """
    module, node = symbol.module, symbol.node
    if module is None or node is None:
        return ()
    spans_of_callee: dict[Symbol, list[Span]] = {}
    model = Model(module, project)
    for call in _calls(node):
        target = model.meaning(call)
        if target is not None and target.kind in _CALLABLE and not target.is_builtin:
            span = (
                module.attribute_span(call) if isinstance(call, ast.Attribute) else module.source.span(call)
            )
            spans_of_callee.setdefault(target, []).append(span)
    return tuple(CallSite(target, module.filename, tuple(spans)) for target, spans in spans_of_callee.items())


def supertypes(project: Project, symbol: Symbol) -> tuple[Symbol, ...]:
    """Return the classes that a class names as its bases, as far as files define them."""
    cls = Classes(project).of_symbol(symbol)
    return () if cls is None else tuple(base for base in cls.bases if not base.is_builtin)


def subtypes(project: Project, symbol: Symbol) -> tuple[Symbol, ...]:
    """Return the classes of the workspace that name a class as a base."""
    return subclasses(project, symbol, deep=False)


def _calls(node: ast.AST) -> Iterator[ast.expr]:
    """Yield the functions that are called in a definition itself, and the classes of which it makes instances."""
    pending = [node]
    while pending:
        part = pending.pop()
        if part is not node and isinstance(part, DEFINITIONS):
            continue
        pending += reversed(parts(part))
        if isinstance(part, ast.Call):
            yield part.func
        elif isinstance(part, scenic.Do | scenic.DoChoose | scenic.DoShuffle):
            yield from (target for target in part.targets if isinstance(target, ast.Name | ast.Attribute))
        elif isinstance(part, scenic.New):
            yield part.cls


def _is_called(module: Module, span: Span) -> bool:
    called = module.derived("called", lambda: _called_spans(module))
    return (span.line, span.column) in called


def _called_spans(module: Module) -> frozenset[tuple[int, int]]:
    spans = set()
    inner = (node for node in walk(module.tree) if isinstance(node, DEFINITIONS))
    for function in (call for node in (module.tree, *inner) for call in _calls(node)):
        span = (
            module.attribute_span(function)
            if isinstance(function, ast.Attribute)
            else module.source.span(function)
        )
        spans.add((span.line, span.column))
    return frozenset(spans)


def _around(module: Module, span: Span) -> Symbol:
    """The innermost definition around a place, or the module."""
    place = (span.line, module.source.byte(span.line, span.column))
    inner: Any = None
    for node in walk(module.tree):
        if isinstance(node, DEFINITIONS):
            start, end = (node.lineno, node.col_offset), (node.end_lineno or 0, node.end_col_offset or 0)
            if start <= place < end:
                inner = node
    binding = None if inner is None else module.resolution.sites.get(inner)
    if binding is not None:
        return symbol_of_binding(module, binding)
    return module_symbol(module)


def module_symbol(module: Module) -> Symbol:
    """Return a module as the caller of what is called in it outside of definitions."""
    name = module.filename.replace("\\", "/").rpartition("/")[2]
    return Symbol(name, SymbolKind.MODULE, module.filename, module=module, node=module.tree)
