"""The classes of a program and of the modules that it imports: their members, their own and inherited ones."""

import ast
import os
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import field
from functools import cached_property
from types import MappingProxyType
from typing import Any, Final

from scenic import language
from scenic.compiler import tree as scenic
from scenic.compiler.scopes import Binding
from scenic.compiler.semantics.modules import Module, Modules
from scenic.compiler.semantics.names import Names
from scenic.compiler.semantics.symbols import Symbol, SymbolKind, symbol_of_binding
from scenic.compiler.traversal import position, walk
from scenic.dataclass import dataclass
from scenic.language.properties import CLASSES, BuiltinProperty, attributes_of, properties_of

__all__ = ["LIBRARY", "Class", "ClassMember", "Classes", "find_cycle", "is_of_library"]

LIBRARY: Final = os.path.dirname(os.path.dirname(os.path.abspath(language.__file__ or ""))) + os.sep
"""The folder of the package, with a separator at its end."""

_DEEPEST: Final = 20
"""Classes within classes whose names are looked up."""

_FROM_NARROWEST: Final = ("Object", "OrientedPoint", "Point")

_WITHOUT_MEMBERS: Final = frozenset({"object", "Exception", "ABC"})
"""Bases that give nothing that programs use."""


@dataclass(frozen=True, slots=True)
class ClassMember:
    """Something that instances of a class have.

    ``owner`` is the name of the class that defines it, ``builtin_default`` the text of a default that the language declares,
    ``type`` the type in words; ``attributes`` are those in the brackets of a property definition, and ``needs`` the
    properties that the default reads. ``value`` is a property's default or an attribute's value in a program.
    ``symbol`` is ``None`` for what built-in classes define.
    """

    name: str
    kind: SymbolKind
    owner: str
    builtin_default: str | None = None
    type: str | None = None
    attributes: tuple[str, ...] = ()
    needs: tuple[str, ...] = ()
    declared: str | None = field(default=None, compare=False)
    symbol: Symbol | None = None
    value: ast.expr | None = field(default=None, compare=False)

    @property
    def default(self) -> str | None:
        """The text of a property's default or of an attribute's value."""
        module = None if self.symbol is None else self.symbol.module
        return self.builtin_default if module is None or self.value is None else module.text(self.value)

    @property
    def documentation(self) -> str | None:
        """The documentation that the language declares, or that the definition has."""
        return self.declared if self.symbol is None else self.symbol.documentation

    @property
    def final(self) -> bool:
        """Return whether no class and no specifier may give it."""
        return "final" in self.attributes


@dataclass(frozen=True, eq=False)
class Class:
    """A class with all its members, the nearest definition of each, own ones first.

    ``parents`` are the classes it names (``Object`` if it names none and is written in Scenic), as far as they are known. It is
    ``complete`` if it certainly has no other members, and ``is_scenic`` if it is a class of objects: created with ``new``.
    """

    symbol: Symbol
    members: tuple[ClassMember, ...]
    parents: "tuple[Class, ...]"
    complete: bool
    is_scenic: bool

    @cached_property
    def _by_name(self) -> Mapping[str, ClassMember]:
        return {each.name: each for each in self.members}

    def member(self, name: str) -> ClassMember | None:
        """The member of a name."""
        return self._by_name.get(name)

    @property
    def bases(self) -> tuple[Symbol, ...]:
        """The classes that it names, as far as they are known."""
        return tuple(each.symbol for each in self.parents)

    @property
    def initial_is_own(self) -> bool:
        """Return whether the class itself says how instances are made."""
        initial = self.member("__init__")
        return initial is not None and initial.owner == self.symbol.name

    @cached_property
    def properties(self) -> Mapping[str, ClassMember]:
        """Properties that can be given after ``with``."""
        return {each.name: each for each in self.members if each.kind is SymbolKind.PROPERTY}

    @cached_property
    def inherited(self) -> Mapping[str, ClassMember]:
        """The properties that it has from its parents."""
        inherited: dict[str, ClassMember] = {}
        for parent in reversed(self.parents):
            inherited.update(parent.properties)
        return inherited

    @cached_property
    def names(self) -> frozenset[str] | None:
        """All attributes and methods of its instances, if it is a class of objects; ``None`` if there may be others."""
        if not (self.complete and self.is_scenic) or self.member("__getattr__") is not None:
            return None
        return frozenset(self._by_name)

    @cached_property
    def built_in(self) -> str | None:
        """The class of the language from which it certainly derives; ``None`` if it may derive from a narrower one as well."""
        built_in: set[str] = set()
        waiting = [self]
        while waiting:
            cls = waiting.pop()
            built_in.add(cls.symbol.name if cls.symbol.is_builtin else "")
            waiting += cls.parents
        narrowest = next((name for name in _FROM_NARROWEST if name in built_in), None)
        return narrowest if self.complete or narrowest == _FROM_NARROWEST[0] else None

    @cached_property
    def is_circular(self) -> bool:
        """Return whether the defaults of its properties need one another in a circle."""
        properties = self.properties
        if not any(each.needs and each.symbol is not None for each in properties.values()):
            return False  # Those of the language are in no circle.

        def needed(name: str) -> tuple[str, ...]:
            return properties[name].needs if name in properties else ()

        return find_cycle(list(properties), needed) is not None

    @property
    def parameters(self) -> ast.arguments | None:
        """The parameters of a class that is called like a function, as calls give them; ``None`` if they are not known."""
        node: Any = self.symbol.node
        if self.is_scenic or node is None:
            return None
        has_own_initial = self.initial_is_own and not node.keywords
        if not (has_own_initial or self.complete) or self.member("__new__") is not None:
            return None
        initial = self.member("__init__")
        method: Any = None if initial is None or initial.symbol is None else initial.symbol.node
        if not isinstance(method, ast.FunctionDef) or method.decorator_list:
            return None
        args = method.args
        if args.posonlyargs or not args.args:
            return None
        rest = args.args[1:]
        return ast.arguments(
            posonlyargs=[],
            args=rest,
            vararg=args.vararg,
            kwonlyargs=args.kwonlyargs,
            kw_defaults=args.kw_defaults,
            kwarg=args.kwarg,
            defaults=args.defaults[-len(rest) :] if rest and args.defaults else [],
        )


def is_of_library(filename: str | None) -> bool:
    """Return whether a file is one of the library, which does not change."""
    return filename is not None and filename.startswith(LIBRARY)


class Classes:
    """The classes of a program and of the modules that it imports. Each is examined once, on first use."""

    def __init__(self, modules: Modules, names: Names | None = None) -> None:
        """Make a table of classes; ``names`` are those of the program, if they are known already."""
        self.modules: Final = modules
        self._names: Final[dict[Module, Names]] = {} if names is None else {names.module: names}
        self._own: Final[dict[object, Any]] = {}
        self._named: Final[dict[Binding, Class | None]] = {}
        self._others: Final = modules.derived
        self._examined: Final[set[object]] = set()
        self._program: Final = None if names is None else names.module

    def names(self, module: Module) -> Names:
        """The names of a module."""
        known = self._names.get(module)
        if known is None:
            known = self._names[module] = Names(module, self.modules)
        return known

    def of_symbol(self, symbol: Symbol | None) -> Class | None:
        """Return the class that a symbol is; ``None`` if it is none."""
        if symbol is None or symbol.kind is not SymbolKind.CLASS:
            return None
        module = symbol.module
        if symbol.is_builtin:
            return _BUILT_IN.get(symbol.name) or Class(symbol, (), (), False, False)
        if module is None or not isinstance(symbol.node, ast.ClassDef):
            return None
        if is_of_library(symbol.filename):
            return module.derived(symbol.binding or symbol.node, lambda: self._of_name(module, symbol))
        binding = symbol.binding
        if binding is None:
            return self._of_name(module, symbol)
        if binding not in self._named:
            self._named[binding] = self._of_name(module, symbol)
        return self._named[binding]

    def of_node(self, module: Module, node: ast.AST) -> Class | None:
        """Return the class that a statement of a module defines, whatever else has its name."""
        binding = module.resolution.sites.get(node)
        if binding is None or not isinstance(node, ast.ClassDef):
            return None
        names = self.names(module)
        return self._once(module, names.symbol_of(names.own(binding)), node, definite=True)

    def _meaning(self, module: Module, node: ast.expr, depth: int = 0) -> Symbol | None:
        """The meaning of a name, or of an attribute of a module or class; ``None`` if it is unknown."""
        symbol = self.names(module).name_meaning(node)
        if symbol is not None or not isinstance(node, ast.Attribute) or depth > _DEEPEST:
            return symbol
        owner = self.of_symbol(self._meaning(module, node.value, depth + 1))
        member = None if owner is None else owner.member(node.attr)
        return None if member is None else member.symbol

    def _of_name(self, module: Module, symbol: Symbol) -> Class | None:
        """Return the class that a name means: of several definitions the first."""
        node: Any = symbol.node
        sites = () if symbol.binding is None else sorted(symbol.binding.sites, key=position)
        if len(sites) > 1 and all(_refines(site, sites[0]) for site in sites[1:]):
            return self._once(module, symbol, sites[0], definite=True)
        return self._once(module, symbol, node, definite=_are_alike(sites))

    def _once(self, module: Module, symbol: Symbol, node: Any, *, definite: bool) -> Class | None:
        key = (node, definite)
        classes = self._own if module is self._program else self._others
        if key not in classes and key not in self._examined:
            self._examined.add(key)
            classes[key] = self._examine(module, symbol, node, definite)
        # A class among its own bases is not known yet.
        known: Class | None = classes.get(key)
        return known

    def _examine(self, module: Module, symbol: Symbol, node: ast.ClassDef, definite: bool) -> Class:
        # Decorators and metaclasses of the library add no attributes.
        plain = is_of_library(module.filename) or not (node.keywords or node.decorator_list)
        complete = definite and plain
        parents: list[Class] = []
        if not node.bases and module.is_scenic:
            parents.append(_BUILT_IN["Object"])
        for base in node.bases:
            parent = self._parent(module, symbol, node, base)
            if parent is not None:
                parents.append(parent)
                complete = complete and self.names(module).stays(base)
            elif not (isinstance(base, ast.Name) and base.id in _WITHOUT_MEMBERS):
                complete = False
        members: dict[str, ClassMember] = {}
        for member in _own(module, symbol, node):
            members.setdefault(member.name, member)
        for parent in parents:
            for member in parent.members:
                members.setdefault(member.name, member)
        complete = complete and all(each.complete for each in parents)
        is_scenic = any(each.is_scenic for each in parents)
        return Class(symbol, tuple(members.values()), tuple(parents), complete, is_scenic)

    def _parent(self, module: Module, symbol: Symbol, node: ast.ClassDef, base: ast.expr) -> Class | None:
        meant = self._meaning(module, base)
        if meant is not None and meant.node is node:
            # `class Car(Car)` extends the class that a star import or the model brings.
            before = self.names(module).before(symbol.name)
            meant = None if before is None else self.names(module).symbol_of(before)
        return self.of_symbol(meant)


def _are_alike(sites: Sequence[ast.AST]) -> bool:
    """Return whether a name means one class, or classes with the same bases and properties, such as those of two branches."""
    if len(sites) == 1:
        return True
    outlines = {_outline(site) for site in sites}
    return len(outlines) == 1 and None not in outlines


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
    """Return the bases and properties of a class that has nothing else; ``None`` for any other definition."""
    if not isinstance(site, ast.ClassDef) or site.keywords or site.decorator_list:
        return None
    properties = []
    for item in site.body:
        if isinstance(item, scenic.PropertyDef):
            properties.append(item.name)
        elif not (isinstance(item, ast.Expr) and isinstance(item.value, ast.Constant)):
            return None
    bases = tuple(base.id if isinstance(base, ast.Name) else ast.dump(base) for base in site.bases)
    return bases, tuple(sorted(properties))


def _built_in(name: str) -> Class:
    """Return a class of objects of the language."""
    members = [_declared(each, name) for each in properties_of(name).values()]
    members += [
        ClassMember(
            each.name,
            SymbolKind.METHOD if each.is_method else SymbolKind.ATTRIBUTE,
            name,
            type=each.type,
            declared=each.documentation,
        )
        for each in attributes_of(name).values()
    ]
    base = CLASSES[name].base
    parents = () if base is None else (_built_in(base),)
    return Class(Symbol(name, SymbolKind.CLASS), tuple(members), parents, True, True)


def _declared(each: BuiltinProperty, owner: str) -> ClassMember:
    attributes = tuple(name for name in ("additive", "dynamic", "final") if getattr(each, name))
    return ClassMember(
        each.name,
        SymbolKind.PROPERTY,
        owner,
        each.default,
        each.type,
        attributes,
        each.needs,
        each.documentation,
    )


_BUILT_IN: Final = MappingProxyType({name: _built_in(name) for name in CLASSES})


def _own(module: Module, symbol: Symbol, node: ast.ClassDef) -> Iterator[ClassMember]:
    """Yield the members that the body of a class defines, and the attributes that its methods set."""
    for item in node.body:
        if isinstance(item, scenic.PropertyDef):
            place = Symbol(
                item.name,
                SymbolKind.PROPERTY,
                module.filename,
                symbol.name,
                module,
                item,
            )
            yield ClassMember(
                item.name,
                SymbolKind.PROPERTY,
                symbol.name,
                attributes=tuple(item.attributes),
                needs=_needs(item.value),
                symbol=place,
                value=item.value,
            )
    scope = module.resolution.scopes.get(node)
    for binding in () if scope is None else scope.bindings.values():
        inner = symbol_of_binding(module, binding)
        kind = SymbolKind.METHOD if inner.kind is SymbolKind.METHOD else SymbolKind.ATTRIBUTE
        statement = None if inner.node is None else module.assignment_of.get(inner.node)
        value = None if statement is None else statement.value
        yield ClassMember(binding.name, kind, symbol.name, symbol=inner, value=value)
    yield from _set_by_methods(module, symbol, node)


def _needs(default: ast.expr) -> tuple[str, ...]:
    """Return the properties that a default reads."""
    if isinstance(default, ast.Constant):
        return ()
    needs = [
        part.attr
        for part in walk(default)
        if isinstance(part, ast.Attribute) and isinstance(part.value, ast.Name) and part.value.id == "self"
    ]
    return tuple(dict.fromkeys(needs))


def _set_by_methods(module: Module, symbol: Symbol, node: ast.ClassDef) -> Iterator[ClassMember]:
    """Yield the attributes that methods set on their first parameter."""
    for method in node.body:
        if not isinstance(method, ast.FunctionDef | ast.AsyncFunctionDef):
            continue
        positional = [*method.args.posonlyargs, *method.args.args]
        if not positional:
            continue
        first_parameter = positional[0].arg
        for part in walk(method):
            match part:
                case ast.Attribute(value=ast.Name(id=name), attr=attribute, ctx=ast.Store()) if (
                    name == first_parameter
                ):
                    place = Symbol(
                        attribute,
                        SymbolKind.ATTRIBUTE,
                        module.filename,
                        symbol.name,
                        module,
                        part,
                    )
                    yield ClassMember(attribute, SymbolKind.ATTRIBUTE, symbol.name, symbol=place)


def find_cycle(names: list[str], needed: Callable[[str], tuple[str, ...]]) -> list[str] | None:
    """The properties of one cycle, in order; ``None`` if there is none."""
    names_done: set[str] = set()
    for start in names:
        path: list[str] = []
        stack: list[tuple[str, Iterator[str]]] = []
        if start not in names_done:
            path.append(start)
            stack.append((start, iter(needed(start))))
        while stack:
            name, rest = stack[-1]
            following = next(rest, None)
            if following is None:
                stack.pop()
                path.pop()
                names_done.add(name)
            elif following in path:
                return path[path.index(following) :]
            elif following not in names_done:
                path.append(following)
                stack.append((following, iter(needed(following))))
    return None
