"""Scopes and what is bound in them: the result of name resolution.

A scope is built once by `scenic.compiler.resolver` and only read afterwards. Nodes of the tree are keys by identity.
"""

import ast
import builtins
from collections.abc import Collection, Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from enum import StrEnum
from typing import Any, Final

from scenic.language.diagnostics import Diagnostic
from scenic.language.names import NAMES, TRACKED

__all__ = ["PROVIDED", "Binding", "BindingKind", "Reference", "Resolution", "Scope", "ScopeKind"]

_MODULE_ATTRIBUTES: Final = frozenset(
    {
        "__annotations__",
        "__builtins__",
        "__cached__",
        "__class__",
        "__debug__",
        "__doc__",
        "__file__",
        "__loader__",
        "__module__",
        "__name__",
        "__package__",
        "__path__",
        "__qualname__",
        "__spec__",
    }
)

PROVIDED: Final = frozenset(dir(builtins)) | frozenset(NAMES) | frozenset(TRACKED) | _MODULE_ATTRIBUTES
"""Every name that is in scope without being bound by the program."""


class ScopeKind(StrEnum):
    """What opens a scope."""

    MODULE = "module"
    CLASS = "class"
    FUNCTION = "function"
    LAMBDA = "lambda"
    COMPREHENSION = "comprehension"
    BEHAVIOR = "behavior"
    MONITOR = "monitor"
    SCENARIO = "scenario"
    PROPERTY = "property default"
    TYPE_PARAMETERS = "type parameters"


class BindingKind(StrEnum):
    """How a name is bound."""

    VARIABLE = "variable"
    PARAMETER = "parameter"
    FUNCTION = "function"
    CLASS = "class"
    MODULE = "module"
    IMPORTED = "imported name"
    BEHAVIOR = "behavior"
    MONITOR = "monitor"
    SCENARIO = "scenario"
    EXCEPTION = "exception"
    CAPTURE = "pattern capture"
    TYPE_PARAMETER = "type parameter"
    SELF = "self"


@dataclass(slots=True, eq=False)
class Binding:
    """A name in a scope. ``sites`` are the nodes that bind it, in no particular order; ``kinds`` how they do."""

    name: str
    scope: "Scope" = field(repr=False)
    sites: list[ast.AST] = field(default_factory=list, repr=False)
    kinds: set[BindingKind] = field(default_factory=set)


@dataclass(slots=True, eq=False)
class Scope:
    """A stretch of the program in which names are bound.

    ``wildcard`` marks scopes into which names come that the text does not show (``from m import *``, ``model m``).
    """

    kind: ScopeKind
    name: str
    node: ast.AST = field(repr=False)
    parent: "Scope | None" = field(repr=False)
    bindings: dict[str, Binding] = field(default_factory=dict, repr=False)
    global_names: set[str] = field(default_factory=set)
    nonlocal_names: set[str] = field(default_factory=set)
    wildcard: bool = False

    def ancestors(self) -> Iterator["Scope"]:
        """The scope itself and those around it, innermost first."""
        scope: Scope | None = self
        while scope is not None:
            yield scope
            scope = scope.parent

    @property
    def module(self) -> "Scope":
        """The scope of the whole module."""
        *_, module = self.ancestors()
        return module

    def lookup(self, name: str) -> Binding | None:
        """What a read of ``name`` in this scope means; ``None`` if the text binds it nowhere in reach.

        As in Python, the names of a class body are out of reach of the functions in it.
        """
        transparent = True
        for scope in self.ancestors():
            if name in scope.global_names:
                return self.module.bindings.get(name)
            reachable = scope.kind is not ScopeKind.CLASS or transparent
            if reachable and name in scope.bindings and name not in scope.nonlocal_names:
                return scope.bindings[name]
            transparent = transparent and scope.kind is ScopeKind.TYPE_PARAMETERS
        return None

    def names_in_reach(self) -> set[str]:
        """All names that a read in this scope can mean, for suggestions."""
        return {
            name
            for scope in self.ancestors()
            if scope is self or scope.kind is not ScopeKind.CLASS
            for name in scope.bindings
        }


@dataclass(frozen=True, slots=True, eq=False)
class Reference:
    """One ``ast.Name`` of the program: where it stands and what it means (``None``: nothing that the text binds)."""

    node: ast.Name = field(repr=False)
    scope: Scope = field(repr=False)
    binding: Binding | None


@dataclass(frozen=True, slots=True)
class Resolution:
    """Every scope, binding and reference of a module.

    ``scopes`` gives the scope that a node opens, ``references`` what a name means, ``nonlocals`` the scope in which a
    ``nonlocal`` statement stands. Names bound by other nodes than
    ``ast.Name`` (functions, parameters, imports, captures) are found through `Binding.sites`.

    ``nodes`` lists the nodes of the classes that the checks look for, each with the scope in which it stands, in no
    particular order. ``tolerated`` are the names read where a missing name is provided for. ``reflective`` tells
    whether the program may read and bind names in ways that the text does not show (``globals()``, ``exec``), and
    ``rebinding`` whether it may bind them so.
    """

    module: Scope
    scopes: Mapping[ast.AST, Scope]
    references: Mapping[ast.AST, Reference]
    nonlocals: Mapping[ast.AST, Scope]
    nodes: Mapping[type[ast.AST], Sequence[tuple[Any, Scope]]]
    tolerated: Collection[ast.AST] = frozenset()
    reflective: bool = False
    rebinding: bool = False
    diagnostics: tuple[Diagnostic, ...] = ()

    def binding(self, name: ast.Name) -> Binding | None:
        """What a name of the program means, as far as the text says."""
        reference = self.references.get(name)
        return None if reference is None else reference.binding

    @property
    def wildcard(self) -> bool:
        """Whether names may exist that the text does not show."""
        return self.module.wildcard
