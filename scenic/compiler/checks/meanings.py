"""Meanings of the names of a program for the inference of kinds (`scenic.compiler.kinds`)."""

import ast
from collections.abc import Collection, Iterator, Mapping, Sequence
from types import MappingProxyType
from typing import Any, Final, Protocol

from scenic.compiler import tree as scenic
from scenic.compiler.checks.classes import Classes
from scenic.compiler.scopes import Binding, Resolution
from scenic.compiler.surroundings import Foreign
from scenic.language.properties import CLASSES, attributes_of, properties_of

__all__ = ["ProgramMeanings"]

_DEEPEST: Final = 20
"""Length to which a chain of base classes is followed."""


_DEFINED: Final[Mapping[type[Any], str]] = MappingProxyType(
    {
        ast.FunctionDef: "function",
        scenic.BehaviorDef: "behavior",
        scenic.MonitorDef: "monitor",
        scenic.ScenarioDef: "scenario",
    }
)
_YIELDS: Final = (ast.Yield, ast.YieldFrom)


class Values(Protocol):
    """The values of names in targets of assignments."""

    def part(self, site: ast.AST) -> ast.expr | None:
        """The value that is assigned to a name there, also as a part of a tuple."""


class Program(Protocol):
    """The part of a `Context` that this module uses."""

    resolution: Resolution
    brought: Collection[str]

    @property
    def assigned(self) -> Values: ...
    @property
    def classes(self) -> Classes: ...
    def provided(self, name: ast.expr) -> str | None: ...
    def binding(self, name: ast.Name) -> Binding | None: ...
    @property
    def grown(self) -> frozenset[str]: ...
    @property
    def owners(self) -> Mapping[str, int]: ...
    def definition(self, name: ast.expr) -> ast.AST | None: ...
    def foreign(self, name: ast.expr | None) -> Foreign | None: ...
    def kind_of_brought(self, name: ast.expr) -> str | None: ...
    def nodes_around(self, node: ast.AST, cls: type[ast.AST]) -> Iterator[Any]: ...
    @property
    def ego_members(self) -> frozenset[str] | None: ...


class ProgramMeanings:
    """The meanings of names in a program under examination."""

    def __init__(self, context: Program) -> None:
        self._context = context

    def provided(self, name: ast.expr) -> str | None:
        """The name of what the language provides."""
        return self._context.provided(name)

    def _only(self, name: ast.Name) -> Binding | None:
        """The binding of a name that is bound just once, in the text."""
        context = self._context
        binding = context.binding(name)
        if binding is None or len(binding.sites) != 1 or context.resolution.reflective:
            return None
        if binding.scope is context.resolution.module and binding.name in context.brought:
            return None
        return binding

    def only_value(self, name: ast.Name) -> tuple[ast.expr, bool] | None:
        """The expression that is certainly bound to a name; true if it is the parts of that expression in turn."""
        binding = self._only(name)
        if binding is None:
            return None
        [site] = binding.sites
        value = self._context.assigned.part(site)
        if value is not None:
            return value, False
        for loop in self._context.nodes_around(site, ast.For):
            if loop.target is site:
                return loop.iter, True
        return None

    def annotation(self, name: ast.Name) -> ast.expr | None:
        """The annotation of the parameter that a name certainly is."""
        binding = self._only(name)
        [site] = [None] if binding is None else binding.sites
        return site.annotation if isinstance(site, ast.arg) else None

    def defined(self, name: ast.expr) -> str | None:
        """The kind of what the program or a module that it imports defines under a name, in a word: function, behavior, ..."""
        if not isinstance(name, ast.Name | ast.Attribute) or self._context.provided(name) is not None:
            return None
        foreign = self._context.foreign(name)
        definition = self._context.definition(name) if foreign is None else foreign.definition
        if foreign is None and getattr(definition, "name", None) != getattr(name, "id", None):
            return None  # `self` in a behavior.
        if isinstance(definition, ast.ClassDef):
            return "class" if self._context.classes.properties(name) is not None else None
        return _DEFINED.get(type(definition))

    def returned(self, function: ast.expr) -> Sequence[ast.expr]:
        """The expressions of which a function of the program certainly returns one; none if it may return others."""
        definition = self._context.definition(function)
        scope = None if definition is None else self._context.resolution.scopes.get(definition)
        if not isinstance(definition, ast.FunctionDef) or scope is None:
            return ()
        resolution = self._context.resolution
        if any(resolution.nodes_in(scope, cls) for cls in _YIELDS):
            return ()
        found = [node.value for node in resolution.nodes_in(scope, ast.Return)]
        return () if None in found else found

    def kind_of_brought(self, name: ast.expr) -> str | None:
        """The kind of a value that a module defines, in the word of the declared type."""
        return self._context.kind_of_brought(name)

    def grows(self, name: ast.Name) -> bool:
        """Return whether the program may change the elements of the list or dictionary that a name means."""
        return name.id in self._context.grown

    def redefines(self, name: str) -> bool:
        """Return whether classes of the program define a method or attribute of a name."""
        return name in self._context.owners

    def base(self, cls: ast.expr, depth: int = 0) -> str | None:
        """The built-in class from which a class derives."""
        name = self._context.provided(cls)
        if name is not None:
            return name if name in CLASSES else None
        foreign = self._context.foreign(cls)
        if foreign is not None:
            return foreign.base
        definition = self._context.definition(cls)
        if depth > _DEEPEST or not isinstance(definition, ast.ClassDef):
            return None
        return self.base(definition.bases[0], depth + 1) if definition.bases else "Object"

    def members(self, cls: ast.expr, depth: int = 0) -> frozenset[str] | None:
        """All attributes and methods of the instances of a class of objects."""
        name = self._context.provided(cls)
        if name is not None:
            return frozenset(properties_of(name)).union(attributes_of(name)) if name in CLASSES else None
        foreign = self._context.foreign(cls)
        if foreign is not None:
            return foreign.members
        definition = self._context.definition(cls)
        if depth > _DEEPEST or not isinstance(definition, ast.ClassDef):
            return None
        return self.members_of(definition, depth)

    def members_of(self, definition: ast.ClassDef, depth: int = 0) -> frozenset[str] | None:
        """All attributes and methods of the instances of a class that the program defines."""
        properties = self._context.classes.of(definition)
        scope = self._context.resolution.scopes.get(definition)
        if properties is None or scope is None or definition.decorator_list:
            return None
        found = frozenset(properties).union(scope.bindings, attributes_of("Object"))
        for base in definition.bases:
            inherited = self.members(base, depth + 1)
            if inherited is None:
                return None
            found |= inherited
        return found

    def ego_members(self) -> frozenset[str] | None:
        """All attributes and methods of the ego."""
        return self._context.ego_members
