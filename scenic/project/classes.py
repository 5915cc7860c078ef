"""Members of classes: properties, methods and attributes, their own and inherited ones; and the classes of values."""

import ast
from dataclasses import dataclass, field
from typing import Any, Final

from scenic.compiler import tree as scenic
from scenic.compiler.scopes import BindingKind, Scope, ScopeKind
from scenic.compiler.traversal import walk
from scenic.language.properties import CLASSES, BuiltinProperty, attributes_of, properties_of
from scenic.project.index import Project
from scenic.project.modules import Module
from scenic.project.search import Found
from scenic.project.symbols import (
    Symbol,
    SymbolKind,
    builtin_symbol,
    symbol_of_binding,
    symbol_of_exported,
    symbol_of_module,
)

__all__ = ["Class", "Member", "class_of", "class_of_symbol", "meaning", "module_behind"]

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
    def properties(self) -> tuple[Member, ...]:
        """Properties that can be given after ``with``."""
        return tuple(each for each in self.members if each.kind is SymbolKind.PROPERTY)


def class_of_symbol(project: Project, symbol: Symbol) -> Class | None:
    """The class that a symbol is; ``None`` if it is none."""
    return _class(project, symbol, 0)


def _class(project: Project, symbol: Symbol, depth: int) -> Class | None:
    if symbol.kind is not SymbolKind.CLASS or depth > _DEEPEST:
        return None
    if symbol.is_builtin:
        return _built_in(symbol)
    node, module = symbol.node, symbol.module
    if not isinstance(node, ast.ClassDef) or module is None:
        return None
    bases: list[Symbol] = []
    complete = len(symbol.binding.sites) == 1 if symbol.binding is not None else False
    complete = complete and not node.keywords and not node.decorator_list
    is_scenic = False
    members: dict[str, Member] = {}
    inherited: list[Class] = []
    if not node.bases and module.is_scenic:
        inherited.append(_built_in(Symbol("Object", SymbolKind.CLASS)))
    for base in node.bases:
        meant = _meaning(project, module, base, depth + 1)
        if meant is None and isinstance(base, ast.Name) and base.id in ("object", "Exception", "ABC"):
            continue
        known = None if meant is None else _class(project, meant, depth + 1)
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


def _built_in(symbol: Symbol) -> Class:
    """A class of the language; of those that are no classes of objects, members are not declared."""
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
    """What the body of a class defines, and the attributes that its methods set."""
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
    scope = module.resolution.scope(node)
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


def meaning(project: Project, module: Module, node: ast.expr) -> Symbol | None:
    """The meaning of a name or an attribute of a program; ``None`` if that cannot be told."""
    return _meaning(project, module, node, 0)


def _meaning(project: Project, module: Module, node: ast.expr, depth: int) -> Symbol | None:
    if depth > _DEEPEST:
        return None
    if isinstance(node, ast.Name):
        return _of_name(project, module, node)
    if not isinstance(node, ast.Attribute):
        return None
    home = module_behind(project, module, node.value)
    if home is not None:
        target = project.member(home, node.attr, importer=module.filename)
        if target is None:
            return None
        return symbol_of_module(target) if isinstance(target, Found) else symbol_of_exported(project, target)
    owner: Symbol | None = _meaning(project, module, node.value, depth + 1)
    if owner is None or owner.kind is not SymbolKind.CLASS:
        owner = _class_of(project, module, node.value, depth + 1)
    known = None if owner is None else _class(project, owner, depth + 1)
    member = None if known is None else known.member(node.attr)
    if member is None or known is None:
        return None
    return member.symbol or Symbol(member.name, member.kind, container=member.owner)


def _of_name(project: Project, module: Module, node: ast.Name) -> Symbol | None:
    reference = module.resolution.reference(node)
    binding = None if reference is None else reference.binding
    if binding is not None:
        exported = project.own(module, binding)
        return symbol_of_exported(project, exported)
    brought = project.exports(module).names.get(node.id)
    if brought is not None and not (brought.module is module and brought.binding is not None):
        return symbol_of_exported(project, brought)
    return builtin_symbol(node.id) if module.is_scenic else None


def module_behind(project: Project, module: Module, node: ast.expr) -> Found | None:
    """The module that an expression such as ``m`` or ``package.m`` means; ``None`` if it is none."""
    parts: list[str] = []
    while isinstance(node, ast.Attribute):
        parts.insert(0, node.attr)
        node = node.value
    if not isinstance(node, ast.Name):
        return None
    reference = module.resolution.reference(node)
    binding = None if reference is None else reference.binding
    if binding is None:
        exported = project.exports(module).names.get(node.id)
    else:
        exported = project.own(module, binding)
    found = None if exported is None else project.follow(exported)
    if not isinstance(found, Found):
        return None
    for part in parts:
        target = project.member(found, part, importer=module.filename)
        if target is not None and not isinstance(target, Found):
            target = project.follow(target)
        if not isinstance(target, Found):
            return None
        found = target
    return found


def class_of(project: Project, module: Module, node: ast.expr) -> Symbol | None:
    """The class of the value of an expression, where the text tells it: ``new C``, ``C(...)``, names of such values."""
    return _class_of(project, module, node, 0)


def _class_of(project: Project, module: Module, node: ast.expr, depth: int) -> Symbol | None:
    if depth > _DEEPEST:
        return None
    match node:
        case scenic.New(cls=cls):
            meant = _meaning(project, module, cls, depth + 1)
            return meant if meant is not None and meant.kind is SymbolKind.CLASS else None
        case ast.Call(func=function):
            meant = _meaning(project, module, function, depth + 1)
            return meant if meant is not None and meant.kind is SymbolKind.CLASS else None
        case ast.Name():
            return _class_of_name(project, module, node, depth)
    return None


def _class_of_name(project: Project, module: Module, node: ast.Name, depth: int) -> Symbol | None:
    reference = module.resolution.reference(node)
    if reference is None:
        return None
    binding = reference.binding
    if binding is None:
        values = [value for value in module.egos if node.id == "ego"]
        if values:
            return _common(project, module, values, depth)
        brought = project.exports(module).names.get(node.id)
        if brought is None or brought.binding is None or brought.module is None:
            return None
        target = project.follow(brought)
        if isinstance(target, Found) or target.module is None or target.binding is None:
            return None
        module, binding = target.module, target.binding
    if binding.kinds == {BindingKind.SELF} or binding.kinds == {BindingKind.PARAMETER}:
        return _class_of_self(module, binding.scope, binding.name)
    if binding.kinds == {BindingKind.IMPORTED}:
        followed = project.follow(project.own(module, binding))
        if isinstance(followed, Found) or followed.module is None or followed.binding is None:
            return None
        module, binding = followed.module, followed.binding
    statements = [module.assignment_of.get(site) for site in binding.sites]
    values = [each.value for each in statements if each is not None and each.value is not None]
    return _common(project, module, values, depth) if len(values) == len(binding.sites) else None


def _common(project: Project, module: Module, values: list[ast.expr], depth: int) -> Symbol | None:
    """The class that all of the values have."""
    classes = {_class_of(project, module, value, depth + 1) for value in values}
    return classes.pop() if len(classes) == 1 else None


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
    binding = module.resolution.binding_at(owner.node)
    return None if binding is None else symbol_of_binding(module, binding)
