"""Meanings of the names of a program for the inference of kinds (`scenic.compiler.kinds`)."""

import ast
from collections.abc import Collection, Iterator
from typing import Any, Final, Protocol

from scenic.compiler.checks.classes import Classes
from scenic.compiler.scopes import Binding, Resolution
from scenic.language.properties import CLASSES, attributes_of, properties_of

__all__ = ["ProgramMeanings"]

_DEEPEST: Final = 20
"""Length to which a chain of base classes is followed."""


class Values(Protocol):
    """The values of names that are the whole targets of assignments."""

    def get(self, site: ast.AST) -> ast.expr | None:
        """The value that is assigned to a name there."""


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
    def definition(self, name: ast.expr) -> ast.AST | None: ...
    def nodes_around(self, node: ast.AST, cls: type[ast.AST]) -> Iterator[Any]: ...
    def fact(self, name: str) -> Any: ...


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
        value = self._context.assigned.get(site)
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

    def base(self, cls: ast.expr, depth: int = 0) -> str | None:
        """The built-in class from which a class derives."""
        name = self._context.provided(cls)
        if name is not None:
            return name if name in CLASSES else None
        definition = self._context.definition(cls)
        if depth > _DEEPEST or not isinstance(definition, ast.ClassDef):
            return None
        return self.base(definition.bases[0], depth + 1) if definition.bases else "Object"

    def members(self, cls: ast.expr, depth: int = 0) -> frozenset[str] | None:
        """All attributes and methods of the instances of a class of objects."""
        name = self._context.provided(cls)
        if name is not None:
            return frozenset(properties_of(name)).union(attributes_of(name)) if name in CLASSES else None
        definition = self._context.definition(cls)
        if depth > _DEEPEST or not isinstance(definition, ast.ClassDef):
            return None
        return self.members_of(definition, depth)

    def members_of(self, definition: ast.ClassDef, depth: int = 0) -> frozenset[str] | None:
        """All attributes and methods of the instances of a class that the program defines."""
        properties = self._context.classes.of(definition)
        scope = self._context.resolution.scope(definition)
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
        found: frozenset[str] | None = self._context.fact("ego members")
        return found
