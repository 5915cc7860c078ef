"""Scopes and what is bound in them: the result of name resolution.

A scope is built once by `scenic.compiler.resolver` and only read afterwards. Nodes of the tree are keys by identity.
"""

import ast
import builtins
from collections.abc import Collection, Iterator, Mapping, Sequence
from copy import copy
from dataclasses import field
from enum import StrEnum
from functools import cached_property
from typing import Any, Final, NamedTuple
from weakref import ref

from scenic.compiler.traversal import position
from scenic.dataclass import dataclass
from scenic.language.diagnostics import Diagnostic
from scenic.language.names import NAMES, TRACKED
from scenic.language.word_sets import word_set

__all__ = [
    "PROVIDED",
    "REFLECTION",
    "Binding",
    "BindingKind",
    "Reference",
    "Resolution",
    "Scope",
    "ScopeKind",
]

_MODULE_ATTRIBUTES: Final = word_set(
    "__annotations__ __builtins__ __cached__ __class__ __debug__ __doc__ __file__ __loader__ "
    "__module__ __name__ __package__ __path__ __qualname__ __spec__"
)

PROVIDED: Final = frozenset(dir(builtins)) | frozenset(NAMES) | frozenset(TRACKED) | _MODULE_ATTRIBUTES
"""Every name that is in scope without being bound by the program."""


class ScopeKind(StrEnum):
    """The kinds of constructs that open scopes."""

    __hash__ = str.__hash__  # that of enumerations is a function in Python

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
    """The ways in which names are bound."""

    __hash__ = str.__hash__  # as above

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


class Binding:
    """A name in a scope. ``sites`` are the nodes that bind it, in no particular order; ``kinds`` how they do."""

    __slots__ = ("_scope", "kinds", "name", "sites")

    def __init__(self, name: str, scope: "Scope") -> None:
        self.name: Final = name
        # Scopes hold their bindings: without a reference back trees are gone as soon as nobody needs them.
        self._scope: Final = ref(scope)
        self.sites: list[ast.AST] = []
        self.kinds: set[BindingKind] = set()

    @property
    def scope(self) -> "Scope":
        """The scope that the name is bound in, as long as somebody holds its resolution."""
        scope = self._scope()
        assert scope is not None
        return scope

    @property
    def first_site(self) -> Any:
        """The site that comes first in the text."""
        return min(self.sites, key=position)


@dataclass(slots=True, eq=False, weakref_slot=True)
class Scope:
    """A part of the program in which names are bound."""

    kind: ScopeKind
    name: str
    node: ast.AST = field(repr=False)
    parent: "Scope | None" = field(repr=False)
    bindings: dict[str, Binding] = field(default_factory=dict, repr=False)
    global_names: set[str] = field(default_factory=set)
    nonlocal_names: set[str] = field(default_factory=set)

    def ancestors(self) -> Iterator["Scope"]:
        """Yield the scope itself and those around it, innermost first."""
        scope: Scope | None = self
        while scope is not None:
            yield scope
            scope = scope.parent

    def lookup(self, name: str) -> Binding | None:
        """Return the binding that a read of ``name`` in this scope means; ``None`` if no scope binds it in reach.

        As in Python, the names of a class body are out of reach of the functions in it.
        """
        transparent = True
        is_global = False
        scope: Scope | None = self
        while scope is not None:
            is_global = is_global or name in scope.global_names
            if scope.parent is None:
                return scope.bindings.get(name)
            reachable = not is_global and (transparent or scope.kind is not ScopeKind.CLASS)
            if reachable and name in scope.bindings and name not in scope.nonlocal_names:
                return scope.bindings[name]
            transparent = transparent and scope.kind is ScopeKind.TYPE_PARAMETERS
            scope = scope.parent
        return None


class Reference(NamedTuple):
    """One ``ast.Name`` of the program: where it stands and what it means (``None``: nothing that the text binds)."""

    node: ast.Name
    scope: Scope
    binding: Binding | None


REBINDING: Final = frozenset({"exec", "globals", "vars"})
"""Builtins with which programs may bind names in ways that the text does not show."""

REFLECTION: Final = REBINDING | {"dir", "eval", "locals"}
"""Builtins with which programs may read names in ways that the text does not show."""


@dataclass(eq=False)
class Resolution:
    """Every scope, binding and reference of a module.

    ``module`` is the scope of the whole module. ``references`` are the meanings of names, in no particular order, and
    ``mentions`` the same by the names; names bound by other nodes than ``ast.Name`` (functions, parameters, imports,
    captures) are found through `Binding.sites`. ``read`` are the bindings whose values are read anywhere.
    ``scopes`` gives the scope that a node opens, ``nonlocals`` the scope in which a ``nonlocal`` statement stands.
    ``by_class`` are all nodes but names and constants by their classes, each with its scope, in no particular order.
    ``tolerated`` are the names read where a missing name is provided for, ``reserved`` the places that bind a name which must not be bound.
    ``wildcard`` tells whether names may exist that the text does not show.
    """

    module: Scope
    references: Mapping[ast.AST, Reference]
    mentions: Mapping[str, Sequence[Reference]]
    read: Collection[Binding]
    scopes: Mapping[ast.AST, Scope]
    nonlocals: Mapping[ast.AST, Scope]
    by_class: Mapping[type[ast.AST], Sequence[tuple[Any, Scope]]]
    tolerated: Collection[ast.AST]
    reserved: Sequence[tuple[str, ast.AST]]
    wildcard: bool
    diagnostics: tuple[Diagnostic, ...] = ()

    @property
    def names(self) -> Mapping[str, Binding]:
        """The names that are bound in the module's own scope."""
        return self.module.bindings

    @cached_property
    def _reflecting(self) -> frozenset[str]:
        return REFLECTION.intersection(self.uses).difference(self.names)

    @cached_property
    def reflective(self) -> bool:
        """Return whether the program may read and bind names in ways that the text does not show (``globals()``, ``exec``)."""
        return bool(self._reflecting)

    @property
    def rebinding(self) -> bool:
        """Return whether the program may bind names in ways that the text does not show."""
        return not self._reflecting.isdisjoint(REBINDING)

    def with_findings(self, diagnostics: tuple[Diagnostic, ...] = (), *, wildcard: bool) -> "Resolution":
        """Return a copy of the resolution with the diagnostics of a check."""
        new = copy(self)
        new.diagnostics, new.wildcard = diagnostics, wildcard
        return new

    # All names

    def nodes(self, cls: type[ast.AST]) -> Sequence[tuple[Any, Scope]]:
        """The nodes of a class in the order of the text, each with the scope in which it stands; none of names and constants."""
        nodes = self._nodes_in_order.get(cls)
        if nodes is None:
            nodes = list(self.by_class.get(cls, ()))
            if "lineno" in cls._attributes:
                places = [(node.lineno, node.col_offset) for node, _ in nodes]
                nodes = [nodes[index] for index in sorted(range(len(nodes)), key=places.__getitem__)]
            self._nodes_in_order[cls] = nodes
        return nodes

    def nodes_in(self, scope: Scope, cls: type[ast.AST]) -> Sequence[Any]:
        """Return the nodes of a class that stand directly in a scope."""
        by_scope = self._nodes_by_scope.get(cls)
        if by_scope is None:
            by_scope = self._nodes_by_scope[cls] = {}
            for node, where in self.nodes(cls):
                by_scope.setdefault(where, []).append(node)
        return by_scope.get(scope, ())

    @cached_property
    def _nodes_in_order(self) -> dict[type[ast.AST], list[tuple[Any, Scope]]]:
        return {}

    @cached_property
    def _nodes_by_scope(self) -> dict[type[ast.AST], dict[Scope, list[Any]]]:
        return {}

    @cached_property
    def uses(self) -> Mapping[str, Sequence[Reference]]:
        """The uses of each name that no scope within the module binds, in no particular order."""
        own = set(self.names.values())
        return {
            name: uses
            for name, mentions in self.mentions.items()
            if (uses := [each for each in mentions if each.binding is None or each.binding in own])
        }

    @cached_property
    def sites(self) -> Mapping[ast.AST, Binding]:
        """The binding that a node (a name, definition, parameter or alias) belongs to; in no particular order.

        A behavior binds its own name and, within it, ``self``: it belongs to its own name.
        """
        bindings = [binding for scope in self.scopes.values() for binding in scope.bindings.values()]
        bindings.sort(key=lambda binding: binding.kinds != {BindingKind.SELF})
        return {site: binding for binding in bindings for site in binding.sites}

    # One name

    def binding(self, name: ast.AST) -> Binding | None:
        """The meaning of a name of the program, as far as the text shows it."""
        reference = self.references.get(name)
        return None if reference is None else reference.binding

    def names_in_reach(self, scope: Scope) -> set[str]:
        """All names that a read in a scope can mean, for suggestions."""
        return {
            name
            for outer in scope.ancestors()
            if outer is scope or outer.kind is not ScopeKind.CLASS
            for name in outer.bindings
        }
