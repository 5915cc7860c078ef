"""The meanings of the names of one program: bindings, definitions, values, and what other modules and the language provide."""

import ast
import builtins
from bisect import bisect_left, bisect_right
from collections import Counter
from collections.abc import Callable, Iterator, Mapping, Sequence
from functools import cached_property
from typing import Any, Final

from scenic.compiler.scopes import Binding, BindingKind, Resolution, Scope, ScopeKind
from scenic.compiler.semantics.modules import Exported, Exports, FoundModule, Module, Modules
from scenic.compiler.semantics.symbols import (
    DEFINITIONS,
    Symbol,
    builtin_symbol,
    symbol_of_binding,
    symbol_of_exported,
)
from scenic.compiler.traversal import first_position, position

__all__ = ["Names"]

_YIELDS: Final = (ast.Yield, ast.YieldFrom)
_GROWING: Final = frozenset(
    {"append", "clear", "extend", "insert", "pop", "popitem", "remove", "setdefault", "update"}
)
"""Methods that change the elements of a list or dictionary."""
_HANDING_ON: Final = (ast.Assign, ast.AnnAssign, ast.NamedExpr, ast.Return, ast.Yield)
"""Statements and expressions that give what they hold another name."""


class Names:
    """The meanings of the names of a module, as far as its text and the modules that it imports show them."""

    def __init__(self, module: Module, modules: Modules) -> None:
        self.module: Final = module
        self.modules: Final = modules
        self.tree: Final = module.tree
        self.resolution: Final = module.resolution
        self._definitions: Final[dict[ast.expr | None, Symbol | None]] = {}
        self._symbols: Final[dict[Binding, Symbol]] = {}
        self._homes: Final[dict[ast.expr, FoundModule | None]] = {}

    # What imports bring

    @cached_property
    def _stars(self) -> tuple[Exports, ...]:
        """The names that each star import and each ``model`` brings, in order."""
        found = (self.modules.found_by(node, self.module.filename) for node in self.module.stars)
        return tuple(map(self.modules.exports_of, found))

    @cached_property
    def complete(self) -> bool:
        """Return whether all names that star imports and the model bring are known."""
        return all(exports.complete for exports in self._stars)

    @cached_property
    def brought(self) -> Mapping[str, Exported]:
        """The names that star imports and the model are known to bring."""
        return {
            name: exports.names[name]
            for exports in self._stars
            for name in exports.public
            if name in exports.names
        }

    @cached_property
    def wildcard(self) -> bool:
        """Return whether names may exist that neither the text nor the modules that it imports show."""
        return self.resolution.wildcard and (self.module.is_dynamic or not self.complete)

    def imported(self, alias: ast.alias) -> Exported | FoundModule | None:
        """Return the definition or module that an import of a name brings; ``None`` if that is not known."""
        statement, importer = self.module.import_of.get(alias), self.module.filename
        if isinstance(statement, ast.ImportFrom):
            found = self.modules.found_by(statement, importer)
            return self.modules.member(found, alias.name, importer=importer, level=statement.level)
        return self.modules.find(
            alias.name if alias.asname else alias.name.partition(".")[0], importer=importer
        )

    def module_behind(self, node: ast.expr) -> FoundModule | None:
        """Return the module that an expression such as ``m`` or ``package.m`` means; ``None`` if it is none."""
        chain: list[ast.Attribute] = []
        while isinstance(node, ast.Attribute) and node not in self._homes:
            chain.append(node)
            node = node.value
        module = self._module_named(node) if isinstance(node, ast.Name) else self._homes.get(node)
        for attribute in reversed(chain):
            member = None
            if module is not None:
                member = self.modules.member(module, attribute.attr, importer=self.module.filename)
            module = self._homes[attribute] = self._as_module(member)
        return module

    def _module_named(self, name: ast.Name) -> FoundModule | None:
        """Return the module that all bindings of a name bring."""
        binding = self.resolution.binding(name)
        if binding is None:
            return self._as_module(self.brought.get(name.id))
        modules = [
            self._as_module(self.imported(site)) if isinstance(site, ast.alias) else None
            for site in binding.sites
        ]
        first = modules[0]
        alike = first is not None and all(
            each is not None and each.filename == first.filename for each in modules
        )
        return first if alike else None

    def _as_module(self, target: Exported | FoundModule | None) -> FoundModule | None:
        if isinstance(target, Exported):
            target = self.modules.follow(target)
        return target if isinstance(target, FoundModule) and not target.is_missing else None

    def attribute_of_module(self, node: ast.Attribute) -> Exported | FoundModule | None:
        """Return the meaning of ``m.name``, where ``m`` is a module; ``None`` if it is not known."""
        home = self.module_behind(node.value)
        return None if home is None else self.modules.member(home, node.attr, importer=self.module.filename)

    # What names mean

    def name_meaning(self, name: ast.expr | None) -> Symbol | None:
        """The meaning of a name, or of an attribute of a module, as likely as it is; ``None`` if it is unknown."""
        if isinstance(name, ast.Attribute):
            target = self.attribute_of_module(name)
            return None if target is None else self.symbol_of(target)
        if not isinstance(name, ast.Name):
            return None
        binding = self.resolution.binding(name)
        if binding is not None:
            return self._symbols.get(binding) or self.symbol_of(self.own(binding))
        target = self.brought.get(name.id)
        if target is not None:
            return self.symbol_of(target)
        return builtin_symbol(name.id) if self.module.is_scenic else None

    def symbol_of(self, target: Exported | FoundModule) -> Symbol:
        """Return the symbol of a module, or of what is behind a name that a module has."""
        if isinstance(target, FoundModule) or target.binding is None:
            return symbol_of_exported(self.modules, target)
        binding = target.binding
        if binding not in self._symbols:
            self._symbols[binding] = self._symbol_behind(self.modules.follow(target))
        return self._symbols[binding]

    def _symbol_behind(self, target: Exported | FoundModule) -> Symbol:
        if isinstance(target, FoundModule) or target.module is not self.module or target.binding is None:
            return symbol_of_exported(self.modules, target)
        # Symbols of the module itself go with its model.
        return self._symbols.get(target.binding) or symbol_of_binding(self.module, target.binding)

    def own(self, binding: Binding) -> Exported:
        """A binding of the module, to be followed."""
        return Exported(binding.name, self.module, binding)

    def at_top(self, name: str) -> Exported | None:
        """The meaning of a name at the top level of the module."""
        binding = self.resolution.names.get(name)
        return self.brought.get(name) if binding is None else self.own(binding)

    def before(self, name: str) -> Exported | None:
        """The meaning of a name before the module itself binds it: the one that its last star import or model brings."""
        stars = reversed(self._stars)
        return next((exports.names[name] for exports in stars if name in exports.names), None)

    def definition(self, name: ast.expr | None) -> Symbol | None:
        """Return the one definition that an expression can only mean, in whatever module; ``None`` if there may be others, or decorators."""
        # Several rules ask about each name.
        if name in self._definitions:
            return self._definitions[name]
        if name is None or self.resolution.reflective:
            return None
        symbol = self.name_meaning(name) if self._is_certain(name) else None
        definition = symbol if symbol is not None and symbol.is_definite else None
        self._definitions[name] = definition
        return definition

    def definitions_brought(self) -> Iterator[Symbol]:
        """Return the definitions that star imports and the model bring."""
        symbols = (self.symbol_of(each) for each in self.brought.values())
        return (each for each in symbols if each.is_definite)

    def _is_certain(self, name: ast.expr) -> bool:
        """Return whether an expression that may mean a definition can have no other meaning than the likely one."""
        if not isinstance(name, ast.Name):
            return isinstance(name, ast.Attribute)
        reference = self.resolution.references.get(name)
        binding = None if reference is None else reference.binding
        if binding is None:
            return reference is not None and name.id in self.brought and not self.wildcard
        if len(binding.sites) != 1 or binding.kinds == {BindingKind.SELF}:
            return False
        [site] = binding.sites
        return isinstance(site, (*DEFINITIONS, ast.alias)) and self.stands(binding.name, site)

    def nodes(self, cls: type[ast.AST]) -> Sequence[tuple[Any, Scope]]:
        """Return all nodes of a class, with their scopes."""
        return self.resolution.nodes(cls)

    def names(self) -> Iterator[ast.Name]:
        """Yield all names of the program, each where it stands."""
        return (node for node in self.resolution.references if isinstance(node, ast.Name))

    def nodes_around(self, node: ast.AST, cls: type[ast.AST]) -> Iterator[Any]:
        """Yield the nodes of a class in the statement of the top level that a node stands in."""
        nodes, starts = self.nodes(cls), self._starts
        index = bisect_right(starts, position(node))
        begin = bisect_left(nodes, starts[index - 1], key=_position_of_noted) if index else 0
        for each, _ in nodes[begin:]:
            if index < len(starts) and position(each) >= starts[index]:
                return
            yield each

    @cached_property
    def _starts(self) -> list[tuple[int, int]]:
        """The places at which the statements of the top level begin."""
        return [first_position(each) for each in self.tree.body]

    @cached_property
    def _last_wildcard(self) -> tuple[int, int]:
        """The last place where names come in that the text does not show; they may replace those before."""
        return max(map(position, self.module.stars), default=(0, 0))

    def binding(self, name: ast.Name) -> Binding | None:
        """The meaning of a name of the program, as far as the text shows it."""
        return self.resolution.binding(name)

    def is_unbound(self, name: ast.Name) -> bool:
        """Return whether the text binds a name of the program nowhere in reach."""
        reference = self.resolution.references.get(name)
        return reference is not None and reference.binding is None

    def stands(self, name: str, site: ast.AST) -> bool:
        """Return whether no names that the text does not show may replace what is bound to a name there."""
        if position(site) >= self._last_wildcard:
            return True
        return not self.wildcard and name not in self.brought

    def stays(self, name: ast.expr) -> bool:
        """Return whether no names that the text does not show may replace what a name likely means."""
        binding = self.resolution.binding(name)
        if binding is None:
            return not (isinstance(name, ast.Name) and self.wildcard)
        return self.stands(binding.name, binding.first_site)

    @cached_property
    def provided(self) -> Callable[[ast.AST | None], str | None]:
        """Returns the name that an expression is, if it certainly means what the language provides under that name."""
        provided: Mapping[ast.AST | None, str] = {} if self.wildcard else self._likely_provided
        return provided.get

    def likely_provided(self, name: ast.expr | None) -> str | None:
        """The name that an expression is, if nothing that is known binds it, but the language provides it."""
        return self._likely_provided.get(name)

    @cached_property
    def _likely_provided(self) -> Mapping[ast.AST | None, str]:
        return {
            use.node: name
            for name, uses in self.resolution.uses.items()
            if name not in self.brought and (self.module.is_scenic or hasattr(builtins, name))
            for use in uses
            if use.binding is None
        }

    def constant(self, name: ast.Name) -> ast.expr | None:
        """Return the literal that is certainly the value of a name: a number, text or collection assigned just once."""
        binding = self.binding(name)
        if binding is None or len(binding.sites) != 1 or self.resolution.reflective:
            return None
        value = self.assigned.get(binding.sites[0])
        literal = isinstance(value, ast.Constant | ast.List | ast.Tuple | ast.Dict | ast.Set | ast.JoinedStr)
        return value if literal and value is not None and self.stands(name.id, value) else None

    @cached_property
    def assigned(self) -> "Assigned":
        """The value of each name that is the whole target of an assignment."""
        return Assigned(self.resolution)

    @cached_property
    def grown(self) -> frozenset[str]:
        """The names of lists and dictionaries whose elements the program may change, by this name or by another."""
        containers = [node.value for node, _ in self.nodes(ast.Attribute) if node.attr in _GROWING]
        containers += [
            node.value for node, _ in self.nodes(ast.Subscript) if not isinstance(node.ctx, ast.Load)
        ]
        for cls in _HANDING_ON:
            containers += [part for node, _ in self.nodes(cls) for part in _shared_parts(node.value)]
        for node, _ in self.nodes(ast.Call):
            if self.provided(node.func) is None:
                containers += [part for each in node.args for part in _shared_parts(each)]
                containers += [part for each in node.keywords for part in _shared_parts(each.value)]
        names: set[str] = set()
        for each in containers:
            while isinstance(each, ast.Subscript | ast.Attribute):
                each = each.value
            names.update([each.id] if isinstance(each, ast.Name) else ())
        return frozenset(names)

    @cached_property
    def examined(self) -> frozenset[str]:
        """The names whose values the program asks for their type, so that an annotation may not tell it."""
        return frozenset(
            node.args[0].id
            for node, _ in self.nodes(ast.Call)
            if isinstance(node.func, ast.Name)
            and node.func.id in ("isinstance", "type", "hasattr")
            and node.args
            and isinstance(node.args[0], ast.Name)
        )

    @cached_property
    def owners(self) -> Mapping[str, int]:
        """Numbers of classes of the program that define an attribute or method of each name."""
        classes = (scope for scope in self.resolution.scopes.values() if scope.kind is ScopeKind.CLASS)
        return Counter(name for scope in classes for name in scope.bindings)

    @cached_property
    def ego_value(self) -> ast.expr | None:
        """The value of the ego, if the program sets it just once."""
        uses = self.resolution.uses.get("ego", ())
        stores = [use.node for use in uses if isinstance(use.node.ctx, ast.Store)]
        return self.assigned.get(stores[0]) if len(stores) == 1 else None

    def values(self, binding: Binding) -> list[tuple[ast.expr, bool]] | None:
        """Return the expressions that are bound to a name, one of which is its value; ``None`` if it may have another.

        Each comes with whether the name runs through the parts of that expression in turn.
        """
        values: list[tuple[ast.expr, bool]] = []
        for site in binding.sites:
            value, source = self.assigned.part(site), self.module.loop_of.get(site)
            if value is None and source is None:
                return None
            values.append((value, False) if value is not None else (source, True))  # type: ignore[arg-type]
        return values

    def is_hidden(self, binding: Binding) -> bool:
        """Return whether a name may have other values than the text shows."""
        if self.resolution.reflective:
            return True
        return binding.scope is self.resolution.module and binding.name in self.brought

    def returned(self, function: ast.AST) -> Sequence[ast.expr]:
        """Return the expressions of which a function of the module returns one; none if it may return others."""
        scope = self.resolution.scopes.get(function)
        if not isinstance(function, ast.FunctionDef) or scope is None:
            return ()
        if any(self.resolution.nodes_in(scope, cls) for cls in _YIELDS):
            return ()
        found = [node.value for node in self.resolution.nodes_in(scope, ast.Return)]
        return () if None in found else found


def _shared_parts(value: ast.expr | None) -> Iterator[ast.expr]:
    """The names whose values a value is, or holds."""
    match value:
        case ast.Name():
            yield value
        case ast.Tuple(elts=parts) | ast.List(elts=parts) | ast.Dict(values=parts) | ast.BoolOp(values=parts):
            for part in parts:
                yield from _shared_parts(part)
        case ast.IfExp(body=body, orelse=orelse):
            yield from _shared_parts(body)
            yield from _shared_parts(orelse)
        case ast.NamedExpr(value=inner):
            yield from _shared_parts(inner)


def _position_of_noted(noted: tuple[ast.AST, Scope]) -> tuple[int, int]:
    return position(noted[0])


class Assigned:
    """The values of names in targets of assignments, by the nodes of the names."""

    def __init__(self, resolution: Resolution) -> None:
        values: dict[ast.AST, tuple[ast.expr, bool]] = {}
        for node, _ in resolution.nodes(ast.Assign):
            for target in node.targets:
                values.update(_parts(target, node.value))
        for node, _ in resolution.nodes(ast.AnnAssign):
            if isinstance(node.target, ast.Name) and node.value is not None:
                values[node.target] = (node.value, True)
        self._values = values

    def get(self, site: ast.AST) -> ast.expr | None:
        """Return the value that is assigned to a name there, which is a whole target."""
        value, whole = self._values.get(site, (None, False))
        return value if whole else None

    def part(self, site: ast.AST) -> ast.expr | None:
        """Return the value that is assigned to a name there, also as a part of a tuple."""
        return self._values.get(site, (None, False))[0]


def _parts(
    target: ast.expr, value: ast.expr, *, whole: bool = True
) -> Iterator[tuple[ast.AST, tuple[ast.expr, bool]]]:
    """The names of a target, each with its value, and whether it is a whole target; tuples in the text part by part."""
    if isinstance(target, ast.Name):
        yield target, (value, whole)
    elif isinstance(target, ast.Tuple | ast.List) and isinstance(value, ast.Tuple | ast.List):
        has_star = any(isinstance(each, ast.Starred) for each in (*target.elts, *value.elts))
        if not has_star and len(target.elts) == len(value.elts):
            for part, of in zip(target.elts, value.elts, strict=True):
                yield from _parts(part, of, whole=False)
