"""The meanings of the names of one program: bindings, definitions, values, and what other modules and the language provide."""

import ast
from bisect import bisect_left, bisect_right
from collections import Counter
from collections.abc import Collection, Iterator, Mapping, Sequence
from functools import cached_property
from typing import Any, Final

from scenic.compiler import tree as scenic
from scenic.compiler.scopes import Binding, BindingKind, Resolution, Scope, ScopeKind
from scenic.compiler.surroundings import Foreign, Surroundings
from scenic.compiler.traversal import first_position, position

__all__ = ["DEFINITIONS", "Definition", "Names"]

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


_YIELDS: Final = (ast.Yield, ast.YieldFrom)
_GROWING: Final = frozenset(
    {"append", "clear", "extend", "insert", "pop", "popitem", "remove", "setdefault", "update"}
)
"""Methods that change the elements of a list or dictionary."""


class Names:
    """The meanings of the names of a program, as far as its text and the modules that it imports show them."""

    def __init__(
        self, tree: ast.Module, resolution: Resolution, surroundings: Surroundings | None = None
    ) -> None:
        self.tree: Final = tree
        self.resolution: Final = resolution
        self.surroundings: Final = surroundings
        self.brought: Final[Collection[str]] = () if surroundings is None else surroundings.names
        """The names that star imports and the model are known to bring."""
        self._foreign: Final[dict[ast.expr, Foreign | None]] = {}

    def nodes(self, cls: type[ast.AST]) -> Sequence[tuple[Any, Scope]]:
        """All nodes of a class, with their scopes."""
        return self.resolution.nodes(cls)

    def nodes_around(self, node: ast.AST, cls: type[ast.AST]) -> Iterator[Any]:
        """The nodes of a class in the statement of the top level that a node stands in."""
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
        stars = [
            node for node, _ in self.nodes(ast.ImportFrom) if any(alias.name == "*" for alias in node.names)
        ]
        models = [node for node, _ in self.nodes(scenic.Model)]
        return max(map(position, (*stars, *models)), default=(0, 0))

    def binding(self, name: ast.Name) -> Binding | None:
        """The meaning of a name of the program, as far as the text shows it."""
        return self.resolution.binding(name)

    def is_unbound(self, name: ast.Name) -> bool:
        """Return whether the text binds a name of the program nowhere in reach."""
        reference = self.resolution.references.get(name)
        return reference is not None and reference.binding is None

    def definition(self, name: ast.expr | None) -> Definition | None:
        """The one definition that an expression can only mean; ``None`` if there may be others, or decorators."""
        if not isinstance(name, ast.Name) or self.resolution.reflective:
            return None
        binding = self.binding(name)
        if binding is None or len(binding.sites) != 1:
            return None
        [site] = binding.sites
        if not isinstance(site, DEFINITIONS) or getattr(site, "decorator_list", None):
            return None
        return site if self._stands(name.id, site) else None

    def _stands(self, name: str, site: ast.AST) -> bool:
        """Return whether no names that the text does not show may replace what is bound to a name there."""
        if position(site) >= self._last_wildcard:
            return True
        return not self.resolution.wildcard and name not in self.brought

    def foreign(self, name: ast.expr | None) -> Foreign | None:
        """The meaning of an expression, if another module certainly defines it."""
        if self.surroundings is None or self.resolution.reflective or name is None:
            return None
        # Several rules ask about each name.
        if name not in self._foreign:
            self._foreign[name] = self._foreign_of(name, self.surroundings)
        return self._foreign[name]

    def _foreign_of(self, name: ast.expr, surroundings: Surroundings) -> Foreign | None:
        if isinstance(name, ast.Attribute):
            return surroundings.attribute(name)
        reference = self.resolution.references.get(name) if isinstance(name, ast.Name) else None
        if reference is None:
            return None
        binding = reference.binding
        if binding is None:
            known = reference.node.id in self.brought and not self.resolution.wildcard
            return surroundings.brought(reference.node.id) if known else None
        if len(binding.sites) != 1 or binding.kinds != {BindingKind.IMPORTED}:
            return None
        [site] = binding.sites
        if not isinstance(site, ast.alias) or not self._stands(binding.name, site):
            return None
        return surroundings.imported(site)

    def kind_of_brought(self, name: ast.expr) -> str | None:
        """The kind of the value that another module defines under a name, in the word of the declared type."""
        if self.surroundings is None or not isinstance(name, ast.Name) or self.resolution.reflective:
            return None
        reference = self.resolution.references.get(name)
        if reference is None or reference.binding is not None or self.resolution.wildcard:
            return None
        return self.surroundings.kind_of(name.id) if name.id in self.brought else None

    def provided(self, name: ast.expr | None) -> str | None:
        """The name that an expression is, if it means what the language provides under that name."""
        if not isinstance(name, ast.Name) or self.resolution.wildcard:
            return None
        reference = self.resolution.references.get(name)
        own = reference is not None and reference.binding is None and name.id not in self.brought
        return name.id if own else None

    def constant(self, name: ast.Name) -> ast.expr | None:
        """The literal that is certainly the value of a name: a number, text or collection assigned just once."""
        binding = self.binding(name)
        if binding is None or len(binding.sites) != 1 or self.resolution.reflective:
            return None
        value = self.assigned.get(binding.sites[0])
        literal = isinstance(value, ast.Constant | ast.List | ast.Tuple | ast.Dict | ast.Set | ast.JoinedStr)
        return value if literal and value is not None and self._stands(name.id, value) else None

    @cached_property
    def assigned(self) -> "Assigned":
        """The value of each name that is the whole target of an assignment."""
        return Assigned(self.resolution)

    @cached_property
    def grown(self) -> frozenset[str]:
        """The names of lists and dictionaries whose elements the program may change."""
        called = (node.value for node, _ in self.nodes(ast.Attribute) if node.attr in _GROWING)
        stored = (node.value for node, _ in self.nodes(ast.Subscript) if not isinstance(node.ctx, ast.Load))
        return frozenset(value.id for value in (*called, *stored) if isinstance(value, ast.Name))

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

    def _only(self, name: ast.Name) -> Binding | None:
        """The binding of a name that is bound just once, in the text."""
        binding = self.binding(name)
        if binding is None or len(binding.sites) != 1 or self.resolution.reflective:
            return None
        if binding.scope is self.resolution.module and binding.name in self.brought:
            return None
        return binding

    def only_value(self, name: ast.Name) -> tuple[ast.expr, bool] | None:
        """The expression that is certainly bound to a name; true if it is the parts of that expression in turn."""
        binding = self._only(name)
        if binding is None:
            return None
        [site] = binding.sites
        value = self.assigned.part(site)
        if value is not None:
            return value, False
        for loop in self.nodes_around(site, ast.For):
            if loop.target is site:
                return loop.iter, True
        return None

    def annotation(self, name: ast.Name) -> ast.expr | None:
        """The annotation of the parameter that a name certainly is."""
        binding = self._only(name)
        [site] = [None] if binding is None else binding.sites
        return site.annotation if isinstance(site, ast.arg) else None

    def returned(self, function: ast.expr) -> Sequence[ast.expr]:
        """The expressions of which a function of the program certainly returns one; none if it may return others."""
        definition = self.definition(function)
        scope = None if definition is None else self.resolution.scopes.get(definition)
        if not isinstance(definition, ast.FunctionDef) or scope is None:
            return ()
        if any(self.resolution.nodes_in(scope, cls) for cls in _YIELDS):
            return ()
        found = [node.value for node in self.resolution.nodes_in(scope, ast.Return)]
        return () if None in found else found


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
        """The value that is assigned to a name there, which is a whole target."""
        value, whole = self._values.get(site, (None, False))
        return value if whole else None

    def part(self, site: ast.AST) -> ast.expr | None:
        """The value that is assigned to a name there, also as a part of a tuple."""
        return self._values.get(site, (None, False))[0]


def _parts(
    target: ast.expr, value: ast.expr, *, whole: bool = True
) -> Iterator[tuple[ast.AST, tuple[ast.expr, bool]]]:
    """The names of a target, each with its value, and whether it is a whole target; tuples in the text part by part."""
    if isinstance(target, ast.Name):
        yield target, (value, whole)
    elif isinstance(target, ast.Tuple | ast.List) and isinstance(value, ast.Tuple | ast.List):
        starred = any(isinstance(each, ast.Starred) for each in (*target.elts, *value.elts))
        if not starred and len(target.elts) == len(value.elts):
            for part, of in zip(target.elts, value.elts, strict=True):
                yield from _parts(part, of, whole=False)
