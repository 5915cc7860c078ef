"""The symbol at a place of a module, and the other places where it is used."""

import ast
from bisect import bisect_right
from collections.abc import Callable, Container, Iterator, Mapping, Sequence
from dataclasses import field
from typing import Any, Final
from unicodedata import normalize

from scenic.compiler import tree as scenic
from scenic.compiler.scopes import Binding, BindingKind, Scope
from scenic.compiler.semantics.model import Model
from scenic.compiler.semantics.modules import FoundModule, Module
from scenic.compiler.semantics.signatures import Signature, signature_of
from scenic.compiler.semantics.symbols import (
    DEFINITIONS,
    Symbol,
    SymbolKind,
    symbol_of_binding,
    symbol_of_exported,
    symbol_of_module,
)
from scenic.compiler.traversal import walk
from scenic.dataclass import dataclass
from scenic.language.spans import Span
from scenic.project.index import Project

__all__ = [
    "Location",
    "Occurrence",
    "call_signature",
    "definition",
    "exported",
    "occurrence_at",
    "occurrences",
    "references",
    "symbol_at",
    "symbol_of",
]


_WITH_WORDS: Final = (
    ast.Attribute,
    ast.Global,
    ast.Import,
    ast.ImportFrom,
    ast.Nonlocal,
    ast.keyword,
    scenic.Model,
    scenic.PropertyDef,
    scenic.SpecifierPhrase,
)
"""Nodes that hold names as plain texts."""


@dataclass(frozen=True, slots=True)
class Occurrence:
    """A word of a module that names something.

    ``defines`` tells whether it is (one of) the places that bind the name. ``node`` is the node that it belongs to, and
    ``index`` which part of a dotted name of a module it is, else ``None``.
    """

    name: str
    span: Span
    defines: bool
    node: ast.AST = field(repr=False)
    index: int | None = None


@dataclass(frozen=True, slots=True)
class Location:
    """A place in a file."""

    filename: str
    span: Span
    defines: bool = False


def occurrences(module: Module) -> Sequence[Occurrence]:
    """Return all words of a module that name something, in order of place."""
    resolution = module.resolution

    def find() -> tuple[Occurrence, ...]:
        return _in_order(_occurrences(module, module.tree, resolution.references, resolution.sites))

    return module.derived("occurrences", find)


def _in_order(found: Iterator[Occurrence]) -> tuple[Occurrence, ...]:
    return tuple(sorted(found, key=lambda each: each.span))


def _occurrences(
    module: Module, part: ast.AST, references: Container[ast.AST], bindings: Mapping[ast.AST, Binding]
) -> Iterator[Occurrence]:
    """Yield the words of a part of a module that name something."""
    for node in walk(part):
        if isinstance(node, ast.Name):
            if node in references:
                defines = not isinstance(node.ctx, ast.Load)
                yield Occurrence(node.id, module.source.span(node), defines, node)
            continue
        binding = bindings.get(node)
        # Of behaviors and properties, `self` is bound without a word.
        if binding is not None and binding.kinds != {BindingKind.SELF} and not isinstance(node, ast.alias):
            yield Occurrence(binding.name, module.word_span(node, binding.name), True, node)
        yield from _words(node, module)


def _words(node: object, module: Module) -> Iterator[Occurrence]:
    """The names in a node that are not nodes of their own."""
    if not isinstance(node, _WITH_WORDS):
        return
    match node:
        case ast.Attribute():
            yield Occurrence(node.attr, module.attribute_span(node), not isinstance(node.ctx, ast.Load), node)
        case ast.keyword(arg=str(name)):
            yield Occurrence(name, module.word_span(node, name), False, node)
        case scenic.SpecifierPhrase(property=str(name)):
            yield Occurrence(name, module.word_span(node, name), False, node)
        case scenic.PropertyDef():
            yield Occurrence(node.name, module.word_span(node, node.name), True, node)
        case ast.Global() | ast.Nonlocal():
            for name in node.names:
                yield Occurrence(name, module.word_span(node, name), False, node)
        case scenic.Model():
            yield from _dotted(node, node.name, module, start="model")
        case ast.Import():
            for alias in node.names:
                yield from _dotted(alias, alias.name, module)
                if alias.asname:
                    yield _asname(alias, module)
        case ast.ImportFrom():
            if node.module:
                yield from _dotted(node, node.module, module, start="from")
            for alias in node.names:
                if alias.name != "*":
                    yield Occurrence(
                        alias.name, module.word_span(alias, alias.name), alias.asname is None, alias
                    )
                if alias.asname:
                    yield _asname(alias, module)


def _asname(alias: ast.alias, module: Module) -> Occurrence:
    whole = module.source.span(alias)
    start = max(0, whole.end_column - len(alias.asname or ""))
    span = Span(whole.end_line, start, whole.end_line, whole.end_column)
    return Occurrence(alias.asname or "", span, True, alias)


def _dotted(node: ast.AST, name: str, module: Module, start: str | None = None) -> Iterator[Occurrence]:
    """The parts of the name of a module, if they stand on the first line of the node without blanks between."""
    whole = module.source.span(node)
    text = module.source.line(whole.line)
    after = text.find(start, whole.column) + len(start) if start is not None else whole.column
    column = text.find(name, after)
    if column < 0:
        return
    for index, part in enumerate(name.split(".")):
        yield Occurrence(part, Span(whole.line, column, whole.line, column + len(part)), False, node, index)
        column += len(part) + 1


def occurrence_at(module: Module, line: int, column: int) -> Occurrence | None:
    """The word at a place (``line`` from 1, ``column`` in characters from 0), also just after its end."""
    if module.knows("occurrences"):
        every = occurrences(module)
    else:
        # One word is wanted, perhaps while someone types: the statement around it is all that needs to be looked at.
        resolution = module.resolution
        parts = [each for each in module.tree.body if _first_line(each) <= line <= (each.end_lineno or line)]
        nodes = [node for part in parts for node in walk(part)]
        bindings = {node: binding for node in nodes if (binding := resolution.sites.get(node)) is not None}
        names = {node for node in nodes if node in resolution.references}
        around = ast.Module(body=parts, type_ignores=[])
        every = _in_order(_occurrences(module, around, names, bindings))
    index = bisect_right(every, (line, column), key=lambda each: (each.span.line, each.span.column)) - 1
    if index < 0:
        return None
    span = every[index].span
    return every[index] if span.line == line and column <= span.end_column else None


def _first_line(node: ast.stmt) -> int:
    decorators: list[ast.expr] = getattr(node, "decorator_list", None) or []
    return min([node.lineno, *(each.lineno for each in decorators)])


def symbol_at(project: Project, filename: str, line: int, column: int) -> Symbol | None:
    """Return the symbol that the word at a place means."""
    module = project.module(filename)
    found = None if module is None else occurrence_at(module, line, column)
    return None if module is None or found is None else symbol_of(Model(module, project), found)


def definition(project: Project, filename: str, line: int, column: int) -> Symbol | None:
    """The definition of the name at a place, in whatever file; ``None`` without one, or if the language provides it."""
    symbol = symbol_at(project, filename, line, column)
    return None if symbol is None or symbol.is_builtin else symbol


def symbol_of(model: Model, occurrence: Occurrence) -> Symbol | None:
    """Return the symbol that a word of a module means."""
    node: Any = occurrence.node
    match node:
        case ast.Name():
            return model.meaning(node) or _bound(model, node)
        case ast.Attribute():
            return model.meaning(node)
        case ast.keyword():
            return _keyword(model, node)
        case scenic.SpecifierPhrase():
            return _property(model, node)
        case scenic.PropertyDef():
            return _own_property(model, node)
        case scenic.Model():
            return _module(model, node.name, occurrence.index or 0, 0)
        case ast.ImportFrom():
            return _module(model, node.module or "", occurrence.index or 0, node.level)
        case ast.alias():
            return _alias(model, node, occurrence)
        case ast.Global() | ast.Nonlocal():
            binding = model.module.resolution.names.get(occurrence.name)
            return None if binding is None else symbol_of_exported(model.modules, model.own(binding))
    return _bound(model, node)


def _bound(model: Model, node: ast.AST) -> Symbol | None:
    binding = model.module.resolution.sites.get(node)
    return None if binding is None else symbol_of_exported(model.modules, model.own(binding))


def _module(model: Model, name: str, index: int, level: int) -> Symbol | None:
    """Return the module that the beginning of a dotted name means."""
    found = model.modules.find(
        ".".join(name.split(".")[: index + 1]), importer=model.module.filename, level=level
    )
    return None if found.is_missing else symbol_of_module(found)


def _alias(model: Model, alias: ast.alias, occurrence: Occurrence) -> Symbol | None:
    statement = model.module.import_of.get(alias)
    if isinstance(statement, ast.Import):
        if occurrence.index is not None:
            return _module(model, alias.name, occurrence.index, 0)
        return _bound(model, alias)
    if statement is None:
        return None
    module_found = model.modules.found_by(statement, model.module.filename)
    target = model.modules.member(
        module_found, alias.name, importer=model.module.filename, level=statement.level
    )
    if target is None:
        return _bound(model, alias)
    return (
        symbol_of_module(target)
        if isinstance(target, FoundModule)
        else symbol_of_exported(model.modules, target)
    )


def _property(model: Model, node: scenic.SpecifierPhrase) -> Symbol | None:
    """Return the property after ``with``: that of the class which is made."""
    owner = model.module.owner_of_specifier.get(node)
    if not isinstance(owner, scenic.New):
        return None
    cls = model.meaning(owner.cls)
    owner_class = None if cls is None else model.class_of_symbol(cls)
    member = None if owner_class is None else owner_class.member(node.property or "")
    if member is None:
        return None
    return member.symbol or Symbol(member.name, member.kind, container=member.owner)


def _own_property(model: Model, node: scenic.PropertyDef) -> Symbol | None:
    scope = model.module.resolution.scopes.get(node)
    owner = None if scope is None else scope.parent
    binding = None if owner is None else model.module.resolution.sites.get(owner.node)
    known = None if binding is None else model.class_of_symbol(symbol_of_binding(model.module, binding))
    member = None if known is None else known.member(node.name)
    return None if member is None else member.symbol


def _keyword(model: Model, node: ast.keyword) -> Symbol | None:
    """Return the parameter that an argument by name is given to."""
    call = model.module.call_of.get(node)
    callee = None if call is None else model.meaning(call.func)
    if callee is not None and callee.kind is SymbolKind.CLASS:
        callee_class = model.class_of_symbol(callee)
        initial = None if callee_class is None else callee_class.member("__init__")
        callee = None if initial is None else initial.symbol
    if callee is None or callee.module is None or not isinstance(callee.node, DEFINITIONS):
        return None
    scope: Scope | None = callee.module.resolution.scopes.get(callee.node)
    binding = None if scope is None else scope.bindings.get(node.arg or "")
    return None if binding is None else symbol_of_binding(callee.module, binding)


def call_signature(model: Model, call: ast.Call) -> Signature | None:
    """Return the signature of the function that a call calls."""
    callee = model.meaning(call.func)
    return None if callee is None else signature_of(model.modules, callee)


def exported(project: Project, filename: str) -> dict[str, Symbol]:
    """The names that ``import *`` of a file brings, with what they mean."""
    module = project.module(filename)
    if module is None:
        return {}
    exports = project.exports(module)
    return {
        name: symbol_of_exported(project, exports.names[name])
        for name in sorted(exports.public)
        if name in exports.names
    }


def references(
    project: Project, *symbols: Symbol, go_on: Callable[[], None] = lambda: None
) -> Iterator[Location]:
    """Every place that names one of some symbols, their definitions among them, in all files of the workspace.

    The symbols have one name. The files that define them come first; ``go_on`` is called before each, and may raise.
    """
    targets = {each for each in symbols if not each.is_builtin}
    if not targets:
        return
    name = symbols[0].name
    homes = [each.filename for each in symbols if each.filename is not None]
    for filename in dict.fromkeys([*homes, *project.files()]):
        go_on()
        module = project.module(filename)
        if module is None or not _mentions(module.source.text, name):
            continue
        names = {name} | {
            alias.asname for alias in module.import_of if alias.asname and name in alias.name.split(".")
        }
        model = Model(module, project)
        spans = {
            each.span: each.defines
            for each in occurrences(module)
            if each.name in names and symbol_of(model, each) in targets
        }
        yield from (Location(module.filename, span, defines) for span, defines in spans.items())


def _mentions(text: str, name: str) -> bool:
    """Tell whether a name stands in a text, maybe in other characters that Python takes for the same."""
    return name in text or (not text.isascii() and name in normalize("NFKC", text))
