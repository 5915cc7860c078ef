"""Members of classes: properties, methods and attributes, their own and inherited ones; and the classes of values."""

import ast
import os
from collections.abc import Iterable, Sequence
from dataclasses import field
from typing import Any, Final

from scenic import language
from scenic.compiler import tree as scenic
from scenic.compiler.scopes import Binding, BindingKind, Scope, ScopeKind
from scenic.compiler.semantics.modules import Exported, FoundModule, Module, Modules
from scenic.compiler.semantics.symbols import (
    Symbol,
    SymbolKind,
    builtin_symbol,
    symbol_of_binding,
    symbol_of_exported,
    symbol_of_module,
)
from scenic.compiler.traversal import position, walk
from scenic.dataclass import dataclass
from scenic.language.properties import CLASSES, BuiltinProperty, attributes_of, properties_of

__all__ = [
    "LIBRARY",
    "Class",
    "Member",
    "class_of",
    "class_of_elements",
    "class_of_exported",
    "class_of_symbol",
    "is_of_library",
    "meaning",
    "module_behind",
]

LIBRARY: Final = os.path.dirname(os.path.dirname(os.path.abspath(language.__file__ or ""))) + os.sep
"""The folder of the package, with a separator at its end."""

_DEEPEST: Final = 50
"""Steps from a name to what it means, through values and bases, after which nothing is known."""


@dataclass(frozen=True, slots=True)
class Member:
    """Something that instances of a class have.

    ``owner`` is the name of the class that defines it. ``default`` is the text of a property's default or of an
    attribute's value, ``type`` the type in words; ``attributes`` are those in the brackets of a property definition.
    ``symbol`` is ``None`` for what built-in classes define.
    """

    name: str
    kind: SymbolKind
    owner: str
    default: str | None = None
    type: str | None = None
    attributes: tuple[str, ...] = ()
    documentation: str | None = field(default=None, compare=False)
    symbol: Symbol | None = None


@dataclass(frozen=True, slots=True)
class Class:
    """A class with all its members, the nearest definition of each, own ones first.

    ``bases`` are the classes it names (``Object`` if it names none and is written in Scenic). It is ``complete`` if all
    of its bases are known, and ``is_scenic`` if it is a class of objects: created with ``new``.
    """

    symbol: Symbol
    members: tuple[Member, ...]
    bases: tuple[Symbol, ...]
    complete: bool
    is_scenic: bool

    def member(self, name: str) -> Member | None:
        """The member of a name."""
        return next((each for each in self.members if each.name == name), None)

    @property
    def initial_is_own(self) -> bool:
        """Return whether the class itself says how instances are made."""
        initial = self.member("__init__")
        return initial is not None and initial.owner == self.symbol.name

    @property
    def properties(self) -> tuple[Member, ...]:
        """Properties that can be given after ``with``."""
        return tuple(each for each in self.members if each.kind is SymbolKind.PROPERTY)


def class_of_symbol(modules: Modules, symbol: Symbol) -> Class | None:
    """The class that a symbol is; ``None`` if it is none."""
    return _class(modules, symbol, 0)


def is_of_library(filename: str | None) -> bool:
    """Return whether a file is one of the library, which does not change."""
    return filename is not None and filename.startswith(LIBRARY)


def _class(modules: Modules, symbol: Symbol, depth: int) -> Class | None:
    module = symbol.module
    if module is None or not is_of_library(symbol.filename):
        return _examined(modules, symbol, depth)
    return module.derived(f"class {symbol.name} {symbol.span}", lambda: _examined(modules, symbol, depth))


def _examined(modules: Modules, symbol: Symbol, depth: int) -> Class | None:
    if symbol.kind is not SymbolKind.CLASS or depth > _DEEPEST:
        return None
    if symbol.is_builtin:
        return _built_in(symbol)
    node: Any = symbol.node
    module = symbol.module
    if not isinstance(node, ast.ClassDef) or module is None:
        return None
    bases: list[Symbol] = []
    sites = () if symbol.binding is None else sorted(symbol.binding.sites, key=position)
    if len(sites) > 1 and all(_refines(site, sites[0]) for site in sites[1:]):
        node, complete = sites[0], True
    else:
        complete = symbol.binding is not None and _are_alike(sites)
    # Decorators and metaclasses of the library add no attributes.
    complete = complete and (is_of_library(module.filename) or not (node.keywords or node.decorator_list))
    is_scenic = False
    members: dict[str, Member] = {}
    inherited: list[Class] = []
    if not node.bases and module.is_scenic:
        inherited.append(_built_in(Symbol("Object", SymbolKind.CLASS)))
    for base in node.bases:
        meant = _meaning(modules, module, base, depth + 1)
        if meant is not None and meant.node is node:
            # `class Car(Car)` extends the class that a star import or the model brings.
            meant = _replaced(modules, module, symbol.name)
        if meant is None and isinstance(base, ast.Name) and base.id in ("object", "Exception", "ABC"):
            continue
        known = None if meant is None else _class(modules, meant, depth + 1)
        if known is None:
            complete = False
        else:
            inherited.append(known)
    for member in _own(module, symbol, node):
        members.setdefault(member.name, member)
    for known in inherited:
        bases.append(known.symbol)
        complete = complete and known.complete
        is_scenic = is_scenic or known.is_scenic
        for member in known.members:
            members.setdefault(member.name, member)
    return Class(symbol, tuple(members.values()), tuple(bases), complete, is_scenic)


def _are_alike(sites: Sequence[ast.AST]) -> bool:
    """Return whether a name means one class, or classes with the same bases and properties, such as those of two branches."""
    if len(sites) == 1:
        return True
    found = {_outline(site) for site in sites}
    return len(found) == 1 and None not in found


def _refines(site: ast.AST, first: ast.AST) -> bool:
    """Return whether a class extends the class of the same name, and only changes defaults of its properties."""
    if not (isinstance(first, ast.ClassDef) and isinstance(site, ast.ClassDef)):
        return False
    match site.bases:
        case [ast.Name(id=name)] if name == site.name == first.name:
            outline = _outline(site)
            own = {item.name for item in first.body if isinstance(item, scenic.PropertyDef)}
            return outline is not None and own.issuperset(outline[1])
    return False


def _outline(site: ast.AST) -> tuple[tuple[str, ...], tuple[str, ...]] | None:
    """Bases and properties of a class that has nothing else; ``None`` for any other definition."""
    if not isinstance(site, ast.ClassDef) or site.keywords or site.decorator_list:
        return None
    properties = []
    for item in site.body:
        if isinstance(item, scenic.PropertyDef):
            properties.append(item.name)
        elif not (isinstance(item, ast.Expr) and isinstance(item.value, ast.Constant)):
            return None
    return tuple(map(ast.dump, site.bases)), tuple(sorted(properties))


def _built_in(symbol: Symbol) -> Class:
    """A class of the language; only classes of objects have declared members."""
    name = symbol.name
    if name not in CLASSES:
        return Class(symbol, (), (), False, False)
    members = [_declared(each, name) for each in properties_of(name).values()]
    members += [
        Member(
            each.name,
            SymbolKind.METHOD if each.is_method else SymbolKind.ATTRIBUTE,
            name,
            type=each.type,
            documentation=each.documentation,
        )
        for each in attributes_of(name).values()
    ]
    base = CLASSES[name].base
    bases = () if base is None else (Symbol(base, SymbolKind.CLASS),)
    return Class(symbol, tuple(members), bases, True, True)


def _declared(each: BuiltinProperty, owner: str) -> Member:
    attributes = tuple(name for name in ("additive", "dynamic", "final") if getattr(each, name))
    return Member(
        each.name, SymbolKind.PROPERTY, owner, each.default, each.type, attributes, each.documentation
    )


def _own(module: Module, symbol: Symbol, node: ast.ClassDef) -> list[Member]:
    """Return the members that the body of a class defines, and the attributes that its methods set."""
    found: list[Member] = []
    for item in node.body:
        if isinstance(item, scenic.PropertyDef):
            place = Symbol(
                item.name,
                SymbolKind.PROPERTY,
                module.filename,
                module.word_span(item, item.name),
                module.source.span(item),
                symbol.name,
                module,
                item,
            )
            text = module.text(item.value)
            found.append(
                Member(
                    item.name,
                    SymbolKind.PROPERTY,
                    symbol.name,
                    text,
                    attributes=tuple(item.attributes),
                    documentation=place.documentation,
                    symbol=place,
                )
            )
    scope = module.resolution.scopes.get(node)
    for binding in () if scope is None else scope.bindings.values():
        inner = symbol_of_binding(module, binding)
        kind = SymbolKind.METHOD if inner.kind is SymbolKind.METHOD else SymbolKind.ATTRIBUTE
        statement = None if inner.node is None else module.assignment_of.get(inner.node)
        value = None if statement is None or statement.value is None else module.text(statement.value)
        found.append(
            Member(
                binding.name,
                kind,
                symbol.name,
                value,
                documentation=inner.documentation,
                symbol=inner,
            )
        )
    found += _set_by_methods(module, symbol, node)
    return found


def _set_by_methods(module: Module, symbol: Symbol, node: ast.ClassDef) -> list[Member]:
    """Attributes that methods set on their first parameter."""
    found: list[Member] = []
    for method in node.body:
        if not isinstance(method, ast.FunctionDef | ast.AsyncFunctionDef):
            continue
        positional = [*method.args.posonlyargs, *method.args.args]
        if not positional:
            continue
        own = positional[0].arg
        for part in walk(method):
            match part:
                case ast.Attribute(value=ast.Name(id=name), attr=attribute, ctx=ast.Store()) if name == own:
                    place = Symbol(
                        attribute,
                        SymbolKind.ATTRIBUTE,
                        module.filename,
                        module.attribute_span(part),
                        module.source.span(part),
                        symbol.name,
                        module,
                        part,
                    )
                    found.append(Member(attribute, SymbolKind.ATTRIBUTE, symbol.name, symbol=place))
    return found


def meaning(modules: Modules, module: Module, node: ast.expr) -> Symbol | None:
    """The meaning of a name or an attribute of a program; ``None`` if it is unknown."""
    return _meaning(modules, module, node, 0)


def _meaning(modules: Modules, module: Module, node: ast.expr, depth: int) -> Symbol | None:
    if depth > _DEEPEST:
        return None
    if isinstance(node, ast.Name):
        return _of_name(modules, module, node)
    if not isinstance(node, ast.Attribute):
        return None
    home = module_behind(modules, module, node.value)
    if home is not None:
        target = modules.member(home, node.attr, importer=module.filename)
        if target is None:
            return None
        return (
            symbol_of_module(target)
            if isinstance(target, FoundModule)
            else symbol_of_exported(modules, target)
        )
    owner: Symbol | None = _meaning(modules, module, node.value, depth + 1)
    if owner is None or owner.kind is not SymbolKind.CLASS:
        owner = _single(
            _of_attribute(modules, owner, depth + 1)
            if isinstance(node.value, ast.Attribute)
            else _value_of(modules, module, node.value, depth + 1)
        )
    known = None if owner is None else _class(modules, owner, depth + 1)
    member = None if known is None else known.member(node.attr)
    if member is None or known is None:
        return None
    return member.symbol or Symbol(member.name, member.kind, container=member.owner)


def _of_name(modules: Modules, module: Module, node: ast.Name) -> Symbol | None:
    reference = module.resolution.references.get(node)
    binding = None if reference is None else reference.binding
    if binding is not None:
        exported = Exported(binding.name, module, binding)
        return symbol_of_exported(modules, exported)
    brought = modules.exports(module).names.get(node.id)
    if brought is not None and not (brought.module is module and brought.binding is not None):
        return symbol_of_exported(modules, brought)
    return builtin_symbol(node.id) if module.is_scenic else None


def _replaced(modules: Modules, module: Module, name: str) -> Symbol | None:
    """The meaning of a name before the module itself binds it: the one that its last star import or model brings."""
    for statement in reversed(module.tree.body):
        if isinstance(statement, scenic.Model) or (
            isinstance(statement, ast.ImportFrom) and any(alias.name == "*" for alias in statement.names)
        ):
            brought = modules.exports_of(modules.found_by(statement, module.filename)).names.get(name)
            if brought is not None:
                return symbol_of_exported(modules, brought)
    return None


def module_behind(modules: Modules, module: Module, node: ast.expr) -> FoundModule | None:
    """The module that an expression such as ``m`` or ``package.m`` means; ``None`` if it is none."""
    parts: list[str] = []
    while isinstance(node, ast.Attribute):
        parts.insert(0, node.attr)
        node = node.value
    if not isinstance(node, ast.Name):
        return None
    reference = module.resolution.references.get(node)
    binding = None if reference is None else reference.binding
    if binding is None:
        exported = modules.exports(module).names.get(node.id)
    else:
        exported = Exported(binding.name, module, binding)
    found = None if exported is None else modules.follow(exported)
    if not isinstance(found, FoundModule):
        return None
    for part in parts:
        target = modules.member(found, part, importer=module.filename)
        if target is not None and not isinstance(target, FoundModule):
            target = modules.follow(target)
        if not isinstance(target, FoundModule):
            return None
        found = target
    return found


def class_of(modules: Modules, module: Module, node: ast.expr) -> Symbol | None:
    """The class of the value of an expression, if the text shows it.

    That is so of ``new C`` and ``C(...)``, of what is annotated, of elements of sequences, and of names of such values.
    """
    return _single(_value_of(modules, module, node, 0))


def class_of_elements(modules: Modules, module: Module, node: ast.expr) -> Symbol | None:
    """The class of the elements of the sequence that an expression is, if the text shows it."""
    value = _value_of(modules, module, node, 0)
    return value.cls if value is not None and value.is_sequence else None


def class_of_exported(modules: Modules, exported: Exported) -> Symbol | None:
    """The class of a value that a module defines; see `class_of`."""
    target = modules.follow(exported)
    if isinstance(target, FoundModule) or target.module is None or target.binding is None:
        return None
    return _single(_value_of_binding(modules, target.module, target.binding, 0))


@dataclass(frozen=True, slots=True)
class _Value:
    """A value: an object of a class, or a sequence of them."""

    cls: Symbol
    is_sequence: bool = False


_SEQUENCES: Final = frozenset(
    {"tuple", "list", "Sequence", "Iterable", "Iterator", "Collection", "frozenset", "set"}
)
"""Types whose values hold others of one type."""
_SAME_SEQUENCE: Final = frozenset({"list", "tuple", "sorted", "reversed", "set"})
"""Functions that give the elements of their first argument again."""


def _value_of(modules: Modules, module: Module, node: ast.expr, depth: int) -> _Value | None:
    if depth > _DEEPEST:
        return None
    match node:
        case scenic.New(cls=cls):
            meant = _meaning(modules, module, cls, depth + 1)
            return _Value(meant) if meant is not None and meant.kind is SymbolKind.CLASS else None
        case ast.Call(func=function):
            return _value_of_call(modules, module, node, function, depth)
        case ast.Name():
            return _value_of_name(modules, module, node, depth)
        case ast.Attribute():
            return _of_attribute(modules, _meaning(modules, module, node, depth + 1), depth)
        case ast.Subscript(value=value, slice=index) if not isinstance(index, ast.Slice):
            return _element(_value_of(modules, module, value, depth + 1))
    return None


def _alike(values: Iterable[_Value | None]) -> _Value | None:
    """The value that all are; looks no further once that is not to be, since names may lead back to themselves."""
    common: _Value | None = None
    for value in values:
        if value is None or (common is not None and value != common):
            return None
        common = value
    return common


def _single(value: _Value | None) -> Symbol | None:
    """The class of a value that is not a sequence."""
    return None if value is None or value.is_sequence else value.cls


def _of_attribute(modules: Modules, meant: Symbol | None, depth: int) -> _Value | None:
    """The value of an attribute with this meaning; in long chains of attributes, each meaning is computed once."""
    return None if meant is None else _annotated_symbol(modules, meant, depth, called=False)


def _element(value: _Value | None) -> _Value | None:
    return None if value is None or not value.is_sequence else _Value(value.cls)


def _value_of_call(
    modules: Modules, module: Module, node: ast.Call, function: ast.expr, depth: int
) -> _Value | None:
    name = function.id if isinstance(function, ast.Name) else None
    if name == "Uniform":
        return _alike(
            _element(_value_of(modules, module, value.value, depth + 1))
            if isinstance(value, ast.Starred)
            else _value_of(modules, module, value, depth + 1)
            for value in node.args
        )
    if name == "filter" and len(node.args) == 2:
        return _value_of(modules, module, node.args[1], depth + 1)
    if name in _SAME_SEQUENCE and len(node.args) == 1:
        return _value_of(modules, module, node.args[0], depth + 1)
    meant = _meaning(modules, module, function, depth + 1)
    if meant is None or meant.kind is SymbolKind.CLASS:
        return None if meant is None else _Value(meant)
    return _annotated_symbol(modules, meant, depth, called=True)


def _annotated_symbol(modules: Modules, symbol: Symbol, depth: int, *, called: bool) -> _Value | None:
    """The value of what a symbol means, or of a call of it, by its annotation."""
    node, home = symbol.node, symbol.module
    if home is None or node is None:
        return None
    if isinstance(node, ast.FunctionDef):
        is_property = any(_last_word(item) in ("property", "cached_property") for item in node.decorator_list)
        annotation = node.returns if is_property != called else None
    else:
        annotation = None if called else home.annotation_of.get(node)
    return None if annotation is None else _annotated(modules, home, annotation, depth + 1)


def _last_word(node: ast.expr) -> str:
    return node.id if isinstance(node, ast.Name) else node.attr if isinstance(node, ast.Attribute) else ""


def _annotated(modules: Modules, module: Module, annotation: ast.expr, depth: int) -> _Value | None:
    """The value that an annotation of a module describes; ``None`` beside a class counts for nothing."""
    if depth > _DEEPEST:
        return None
    match annotation:
        case ast.Constant(value=str() as text):
            try:
                inner = ast.parse(text, mode="eval").body
            except (SyntaxError, ValueError, RecursionError):
                return None
            return _annotated(modules, module, inner, depth + 1)
        case ast.BinOp(left=left, op=ast.BitOr(), right=right):
            sides = [
                _annotated(modules, module, side, depth + 1)
                for side in (left, right)
                if not (isinstance(side, ast.Constant) and side.value is None)
            ]
            return sides[0] if len(sides) == 1 else None
        case ast.Subscript(value=value, slice=inner) if _last_word(value) in _SEQUENCES:
            first = inner.elts[0] if isinstance(inner, ast.Tuple) and inner.elts else inner
            element = _annotated(modules, module, first, depth + 1)
            return None if element is None or element.is_sequence else _Value(element.cls, is_sequence=True)
        case ast.Name(id=name):
            exported = modules.exports(module).names.get(name)
            symbol = None if exported is None else symbol_of_exported(modules, exported)
            return None if symbol is None or symbol.kind is not SymbolKind.CLASS else _Value(symbol)
    return None


def _value_of_name(modules: Modules, module: Module, node: ast.Name, depth: int) -> _Value | None:
    reference = module.resolution.references.get(node)
    if reference is None:
        return None
    binding = reference.binding
    if binding is None:
        values = [value for value in module.egos if node.id == "ego"]
        if values:
            return _common(modules, module, values, depth)
        brought = modules.exports(module).names.get(node.id)
        if brought is None or brought.binding is None or brought.module is None:
            return None
        target = modules.follow(brought)
        if isinstance(target, FoundModule) or target.module is None or target.binding is None:
            return None
        module, binding = target.module, target.binding
    return _value_of_binding(modules, module, binding, depth)


def _value_of_binding(modules: Modules, module: Module, binding: Binding, depth: int) -> _Value | None:
    if len(binding.sites) == 1 and (run := module.loop_of.get(binding.sites[0])) is not None:
        return _element(_value_of(modules, module, run, depth + 1))
    if binding.kinds == {BindingKind.SELF} or binding.kinds == {BindingKind.PARAMETER}:
        own = _class_of_self(module, binding.scope, binding.name)
        return None if own is None else _Value(own)
    if binding.kinds == {BindingKind.IMPORTED}:
        followed = modules.follow(Exported(binding.name, module, binding))
        if isinstance(followed, FoundModule) or followed.module is None or followed.binding is None:
            return None
        module, binding = followed.module, followed.binding
    if len(binding.sites) == 1 and (run := module.loop_of.get(binding.sites[0])) is not None:
        return _element(_value_of(modules, module, run, depth + 1))
    statements = [module.assignment_of.get(site) for site in binding.sites]
    values = [each.value for each in statements if each is not None and each.value is not None]
    return _common(modules, module, values, depth) if len(values) == len(binding.sites) else None


def _common(modules: Modules, module: Module, values: list[ast.expr], depth: int) -> _Value | None:
    """The class that all of the values have."""
    return _alike(_value_of(modules, module, value, depth + 1) for value in values)


def _class_of_self(module: Module, scope: Scope, name: str) -> Symbol | None:
    """The class in whose property default or method ``self`` stands."""
    owner = scope.parent
    if owner is None or owner.kind is not ScopeKind.CLASS:
        return None
    if scope.kind is not ScopeKind.PROPERTY:
        method: Any = scope.node
        args = getattr(method, "args", None)
        first = [*args.posonlyargs, *args.args][:1] if args is not None else []
        if not first or first[0].arg != name:
            return None
    binding = module.resolution.sites.get(owner.node)
    return None if binding is None else symbol_of_binding(module, binding)
