"""Symbols of a project: the definition, signature and documentation of a name."""

import ast
import re
from dataclasses import field
from enum import StrEnum
from functools import cached_property
from typing import Any, Final

from scenic.compiler import tree as scenic
from scenic.compiler.places import header_span
from scenic.compiler.scopes import Binding, BindingKind, ScopeKind
from scenic.compiler.semantics.modules import Exported, FoundModule, Module, Modules
from scenic.compiler.traversal import position
from scenic.dataclass import dataclass
from scenic.language.names import NAMES, TRACKED, NameKind
from scenic.language.properties import CLASSES
from scenic.language.spans import Span

__all__ = [
    "DEFINITIONS",
    "Definition",
    "Symbol",
    "SymbolKind",
    "builtin_symbol",
    "documentation_of",
    "symbol_of_binding",
    "symbol_of_exported",
    "symbol_of_module",
    "symbols_of",
]


class SymbolKind(StrEnum):
    """The kinds of symbols."""

    __hash__ = str.__hash__  # that of enumerations is a function in Python

    MODULE = "module"
    CLASS = "class"
    FUNCTION = "function"
    METHOD = "method"
    BEHAVIOR = "behavior"
    MONITOR = "monitor"
    SCENARIO = "scenario"
    PROPERTY = "property"
    ATTRIBUTE = "attribute"
    VARIABLE = "variable"
    PARAMETER = "parameter"
    TYPE_PARAMETER = "type parameter"


@dataclass(frozen=True, eq=False)
class Symbol:
    """One thing that has a name.

    ``filename`` is ``None`` for what the language provides. ``container`` is the name of the class, function or scenario
    that it is in. Two symbols are equal if they are the same thing. ``node`` is the defining node of the tree.
    """

    name: str
    kind: SymbolKind
    filename: str | None = None
    container: str | None = None
    module: Module | None = field(default=None, repr=False)
    node: ast.AST | None = field(default=None, repr=False)
    binding: Binding | None = field(default=None, repr=False)

    def __eq__(self, other: object) -> bool:
        if self is other or not isinstance(other, Symbol):
            return self is other
        alike = self.name == other.name and self.kind is other.kind and self.filename == other.filename
        return alike and self.span == other.span

    def __hash__(self) -> int:
        return hash((self.name, self.kind, self.filename))

    @cached_property
    def span(self) -> Span | None:
        """The place of the name where it is defined; ``None`` for what the language provides."""
        module, node = self.module, self.node
        if module is None or node is None or isinstance(node, ast.Module):
            return None if self.filename is None else _ORIGIN
        if isinstance(node, ast.Attribute):
            return module.attribute_span(node)
        return module.word_span(node, self.name)

    @cached_property
    def extent(self) -> Span | None:
        """The place of the whole definition: of a name the assignment whose target it is."""
        module, node = self.module, self.node
        if module is None or node is None:
            return None
        if isinstance(node, ast.Module):
            return Span(1, 0, len(module.source.lines), len(module.source.lines[-1]))
        statement = None if type(node) in _KINDS else module.assignment_of.get(node)
        return module.source.span(node) if statement is None else header_span(module.source, statement)

    @property
    def is_builtin(self) -> bool:
        """Return whether the language provides it, so that it has no place."""
        return self.filename is None

    @property
    def is_definite(self) -> bool:
        """Return whether its name can only mean this one definition, which no decorator changes."""
        binding, node = self.binding, self.node
        if binding is None or len(binding.sites) != 1 or not isinstance(node, DEFINITIONS):
            return False
        return not getattr(node, "decorator_list", None)

    @property
    def documentation(self) -> str | None:
        """The docstring of the definition, or the language's documentation of the name."""
        return documentation_of(self)


_ORIGIN: Final = Span(1, 0, 1, 0)

DEFINITIONS: Final = (
    ast.FunctionDef,
    ast.AsyncFunctionDef,
    ast.ClassDef,
    scenic.BehaviorDef,
    scenic.MonitorDef,
    scenic.ScenarioDef,
)
"""Statements that bind a name to something that can be called, instantiated or run."""

Definition = (
    ast.FunctionDef
    | ast.AsyncFunctionDef
    | ast.ClassDef
    | scenic.BehaviorDef
    | scenic.MonitorDef
    | scenic.ScenarioDef
)

_KINDS: Final = {
    ast.FunctionDef: SymbolKind.FUNCTION,
    ast.AsyncFunctionDef: SymbolKind.FUNCTION,
    ast.ClassDef: SymbolKind.CLASS,
    scenic.BehaviorDef: SymbolKind.BEHAVIOR,
    scenic.MonitorDef: SymbolKind.MONITOR,
    scenic.ScenarioDef: SymbolKind.SCENARIO,
    scenic.PropertyDef: SymbolKind.PROPERTY,
}

_PROVIDED_KINDS: Final = {
    NameKind.CLASS: SymbolKind.CLASS,
    NameKind.DISTRIBUTION: SymbolKind.CLASS,
    NameKind.EXCEPTION: SymbolKind.CLASS,
    NameKind.FUNCTION: SymbolKind.FUNCTION,
    NameKind.REGION: SymbolKind.CLASS,
    NameKind.SHAPE: SymbolKind.CLASS,
    NameKind.VALUE: SymbolKind.VARIABLE,
}


def builtin_symbol(name: str) -> Symbol | None:
    """The symbol of a name that the language provides."""
    declared = NAMES.get(name)
    if declared is not None:
        value = declared.signature == name and name not in CLASSES and declared.kind is NameKind.REGION
        return Symbol(name, SymbolKind.VARIABLE if value else _PROVIDED_KINDS[declared.kind])
    return Symbol(name, SymbolKind.VARIABLE) if name in TRACKED else None


def symbol_of_module(found: FoundModule) -> Symbol:
    """Return the symbol of a module: its place is the beginning of its file."""
    return Symbol(
        found.name.rpartition(".")[2],
        SymbolKind.MODULE,
        found.filename,
    )


def symbol_of_exported(modules: Modules, target: Exported | FoundModule) -> Symbol:
    """Return the symbol of a module, or of what is behind a name that a module has."""
    if isinstance(target, Exported):
        target = modules.follow(target)
    if isinstance(target, FoundModule):
        return symbol_of_module(target)
    if target.module is None or target.binding is None:
        return Symbol(target.name, SymbolKind.VARIABLE)
    symbol: Symbol | None = modules.derived.get(target.binding)
    if symbol is None:
        symbol = modules.derived[target.binding] = symbol_of_binding(target.module, target.binding)
    return symbol


def symbol_of_binding(module: Module, binding: Binding) -> Symbol:
    """Return the symbol of a binding: its first definition, else the first place where it gets a value."""
    sites = binding.sites if len(binding.sites) == 1 else sorted(binding.sites, key=position)
    node: Any = next((site for site in sites if type(site) in _KINDS), sites[0])
    kind = _kind(node, binding)
    scope = binding.scope
    return Symbol(
        binding.name,
        kind,
        module.filename,
        None if scope.kind is ScopeKind.MODULE else scope.name,
        module,
        node,
        binding,
    )


def _kind(node: ast.AST, binding: Binding) -> SymbolKind:
    kind = _KINDS.get(type(node))
    if binding.kinds == {BindingKind.SELF}:
        return SymbolKind.PARAMETER
    if kind is SymbolKind.FUNCTION and binding.scope.kind is ScopeKind.CLASS:
        return SymbolKind.METHOD
    if kind is not None:
        return kind
    if binding.kinds == {BindingKind.PARAMETER}:
        return SymbolKind.PARAMETER
    if binding.kinds == {BindingKind.TYPE_PARAMETER}:
        return SymbolKind.TYPE_PARAMETER
    if binding.kinds == {BindingKind.MODULE}:
        return SymbolKind.MODULE
    return SymbolKind.ATTRIBUTE if binding.scope.kind is ScopeKind.CLASS else SymbolKind.VARIABLE


def symbols_of(module: Module) -> tuple[Symbol, ...]:
    """Return the symbols that a module binds at its top level, in order of place."""
    bindings = module.resolution.names.values()
    return tuple(
        sorted(
            (symbol_of_binding(module, binding) for binding in bindings),
            key=lambda item: item.span or _ORIGIN,
        )
    )


def documentation_of(symbol: Symbol) -> str | None:
    """Return the docstring of a symbol, or the language's documentation of it; ``None`` if it has neither."""
    if symbol.is_builtin:
        declaration = NAMES.get(symbol.name)
        if declaration is None:
            return TRACKED.get(symbol.name)
        return declaration.documentation
    node: Any = symbol.node
    match node:
        case ast.FunctionDef() | ast.AsyncFunctionDef() | ast.ClassDef():
            return ast.get_docstring(node)
        case scenic.BehaviorDef() | scenic.MonitorDef():
            return _docstring(node.body)
        case scenic.ScenarioDef():
            return node.docstring
    if symbol.module is None or node is None or symbol.span is None:
        return None
    return _comment(symbol.module, symbol.span.line)


def _docstring(body: list[Any]) -> str | None:
    if body and isinstance(body[0], ast.Expr) and isinstance(body[0].value, ast.Constant):
        value = body[0].value.value
        if isinstance(value, str):
            return ast.get_docstring(ast.Module(body=[body[0]], type_ignores=[]))
    return None


def _comment(module: Module, line: int) -> str | None:
    """The comment at the end of a line, else the comments alone on the lines before it."""
    text = module.source.line(line)
    match = re.fullmatch(r"[^#'\"]*#:?\s*(.*)", text)
    if match is not None:
        return match[1] or None
    lines: list[str] = []
    while line > 1:
        line -= 1
        above = re.fullmatch(r"\s*#:?\s?(.*)", module.source.line(line))
        if above is None or above[1].startswith("!"):
            break
        lines.insert(0, above[1])
    return "\n".join(lines).strip() or None
