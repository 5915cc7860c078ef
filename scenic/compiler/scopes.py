"""Scopes and what is bound in them: the result of name resolution.

A scope is built once by `scenic.compiler.resolver` and only read afterwards. Nodes of the tree are keys by identity.
"""

import ast
import builtins
import threading
from bisect import bisect_left, bisect_right
from collections.abc import Callable, Collection, Iterator, Mapping, Sequence
from dataclasses import field
from enum import StrEnum
from functools import cached_property
from typing import Any, Final, TypeVar

from scenic.compiler import tree as scenic
from scenic.compiler.traversal import first_line, position
from scenic.dataclass import dataclass
from scenic.language.diagnostics import Diagnostic
from scenic.language.names import NAMES, TRACKED

__all__ = [
    "PROVIDED",
    "REFLECTION",
    "Binding",
    "BindingKind",
    "Contents",
    "Reference",
    "Resolution",
    "Scope",
    "ScopeKind",
    "Stretch",
    "key_of",
]

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
    """The kinds of constructs that open scopes."""

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
    """A name in a scope. ``sites`` are the nodes that bind it, in no particular order; ``kinds`` how they do.

    A name of the module has its sites from ``stretches``, when they are first asked for.
    """

    __slots__ = ("_sites", "kinds", "name", "scope", "stretches")

    def __init__(
        self,
        name: str,
        scope: "Scope",
        sites: list[ast.AST] | None = None,
        kinds: set[BindingKind] | None = None,
        *,
        stretches: "list[Stretch] | None" = None,
    ) -> None:
        self.name: Final = name
        self.scope: Final = scope
        self.kinds: Final = set() if kinds is None else kinds
        self.stretches: Final = stretches
        self._sites = [] if sites is None and stretches is None else sites

    @property
    def sites(self) -> list[ast.AST]:
        if self._sites is None:
            self._sites = [site for each in self.stretches or () for _, site in each.bound[self.name]]
        return self._sites

    @property
    def first_site(self) -> Any:
        """The site that comes first in the text."""
        if self._sites is None and self.stretches:
            return min((site for _, site in self.stretches[0].bound[self.name]), key=position)
        return min(self.sites, key=position)


@dataclass(slots=True, eq=False)
class Scope:
    """A stretch of the program in which names are bound.

    The scope of a module holds no bindings itself: it stays the same from one version of a text to the next, and what is
    bound at the top level is in `Resolution.names`.
    """

    kind: ScopeKind
    name: str
    node: ast.AST = field(repr=False)
    parent: "Scope | None" = field(repr=False)
    bindings: dict[str, Binding] = field(default_factory=dict, repr=False)
    global_names: set[str] = field(default_factory=set)
    nonlocal_names: set[str] = field(default_factory=set)

    def ancestors(self) -> Iterator["Scope"]:
        """The scope itself and those around it, innermost first."""
        scope: Scope | None = self
        while scope is not None:
            yield scope
            scope = scope.parent

    def lookup(self, name: str) -> Binding | None:
        """The binding that a read of ``name`` in this scope means; ``None`` if no scope within the module binds it in reach.

        As in Python, the names of a class body are out of reach of the functions in it.
        """
        transparent = True
        scope: Scope | None = self
        while scope is not None:
            if name in scope.global_names:
                return None
            reachable = transparent or scope.kind is not ScopeKind.CLASS
            if reachable and name in scope.bindings and name not in scope.nonlocal_names:
                return scope.bindings[name]
            transparent = transparent and scope.kind is ScopeKind.TYPE_PARAMETERS
            scope = scope.parent
        return None


@dataclass(frozen=True, slots=True, eq=False)
class Reference:
    """One ``ast.Name`` of the program: where it stands and what it means (``None``: nothing that the text binds)."""

    node: ast.Name = field(repr=False)
    scope: Scope = field(repr=False)
    binding: Binding | None


@dataclass(frozen=True, slots=True, eq=False)
class Contents:
    """The names and nodes in a stretch of the top level, as far as they do not depend on other stretches.

    ``bound`` gives the nodes that bind each name of the module, and how. ``references`` to names of the module have no
    binding here. ``nodes``, ``scopes``, ``nonlocals`` and ``tolerated`` are as in `Resolution`; ``reserved`` are the
    places that bind a name which must not be bound, ``classes`` those of all nodes but names, constants and what only
    definitions have, ``reflecting`` the names read here that could mean builtins by
    which programs read or bind names. ``wildcard`` tells whether names come in that the text does not show.
    """

    bound: Mapping[str, Sequence[tuple[BindingKind, ast.AST]]]
    references: Mapping[ast.AST, Reference]
    scopes: Mapping[ast.AST, Scope]
    nonlocals: Mapping[ast.AST, Scope]
    nodes: Mapping[type[ast.AST], list[tuple[Any, Scope]]]
    classes: frozenset[type]
    tolerated: Collection[ast.AST]
    reserved: Sequence[tuple[str, ast.AST]]
    reflecting: frozenset[str]
    wildcard: bool


_T = TypeVar("_T")

_IMPORTS: Final = (ast.Import, ast.ImportFrom, scenic.Model)


class Stretch:
    """Successive statements of the top level, with all facts that do not depend on the statements around them.

    What has been found out without saying where is handed on to the same statements further down (`moved`); their
    ``contents`` are looked at only when somebody asks for nodes.
    """

    def __init__(
        self,
        statements: Sequence[ast.stmt],
        collect: "Callable[[Stretch], Contents]",
        common: dict[str, Any] | None = None,
    ) -> None:
        self.statements: Final = tuple(statements)
        self._collect: Final = collect
        self._common: Final = {} if common is None else common
        """Results that are the same wherever the statements are, by key."""
        self._contents: Contents | None = None
        self._lock: Final = threading.Lock()

    def moved(self, statements: Sequence[ast.stmt]) -> "Stretch":
        """The same for copies of the statements on other lines."""
        return Stretch(statements, self._collect, self._common)

    def common(self, key: str, find: "Callable[[Stretch], _T]") -> _T:
        """Something that holds wherever the statements stand, found out but once."""
        if key not in self._common:
            self._common[key] = find(self)
        found: _T = self._common[key]
        return found

    @property
    def contents(self) -> Contents:
        """The contents of the stretch."""
        if self._contents is None:
            # Scopes are compared by identity: all threads must have the same.
            with self._lock:
                if self._contents is None:
                    self._contents = self._collect(self)
        return self._contents

    # Where it stands

    @cached_property
    def keys(self) -> tuple[object, ...]:
        """Keys of the statements: each is shared with copies on other lines, and with no other statement."""
        return tuple(key_of(each) for each in self.statements)

    @cached_property
    def lines(self) -> tuple[int, ...]:
        """The first line of each statement."""
        return tuple(first_line(each) for each in self.statements)

    @property
    def last_line(self) -> int:
        """The last line of the last statement."""
        last = self.statements[-1]
        return last.end_lineno or last.lineno

    # Its nodes

    @property
    def bound(self) -> Mapping[str, Sequence[tuple[BindingKind, ast.AST]]]:
        """See `Contents`."""
        return self.contents.bound

    @property
    def references(self) -> Mapping[ast.AST, Reference]:
        """See `Contents`."""
        return self.contents.references

    @property
    def scopes(self) -> Mapping[ast.AST, Scope]:
        """See `Contents`."""
        return self.contents.scopes

    def nodes(self, cls: type[ast.AST]) -> Sequence[tuple[Any, Scope]]:
        """Its nodes of a class, each with the scope in which it stands."""
        return self.contents.nodes.get(cls, ()) if cls in self.noted else ()

    @cached_property
    def named(self) -> Mapping[str, Sequence[Reference]]:
        """The uses of each name that no scope within the module binds."""
        found: dict[str, list[Reference]] = {}
        for each in self.references.values():
            if each.binding is None:
                found.setdefault(each.node.id, []).append(each)
        return found

    @cached_property
    def mentions(self) -> Mapping[str, Sequence[tuple[int, int]]]:
        """The places, line and column, where each name is read or written."""
        found: dict[str, list[tuple[int, int]]] = {}
        for each in self.references.values():
            found.setdefault(each.node.id, []).append((each.node.lineno, each.node.col_offset))
        return found

    @cached_property
    def loaded(self) -> frozenset[Binding]:
        """Names of scopes within the module that are read here."""
        return frozenset(
            each.binding
            for each in self.references.values()
            if each.binding is not None and each.node.ctx.__class__ is ast.Load
        )

    @cached_property
    def sites(self) -> Mapping[ast.AST, Binding | str]:
        """By the nodes that bind something: the binding, of what belongs to the module only the name."""
        found: dict[ast.AST, Binding | str] = {
            site: binding
            for scope in self.scopes.values()
            for binding in scope.bindings.values()
            for site in binding.sites
        }
        found.update((site, name) for name, sites in self.bound.items() for _, site in sites)
        return found

    # What holds wherever it stands

    @property
    def noted(self) -> frozenset[type[ast.AST]]:
        """The classes that the checks look for of which it has nodes."""
        return self.common(
            "noted", lambda own: frozenset(cls for cls, found in own.contents.nodes.items() if found)
        )

    @property
    def kinds(self) -> Mapping[str, frozenset[BindingKind]]:
        """The names of the module that are bound here, and how."""
        return self.common(
            "kinds",
            lambda own: {name: frozenset(kind for kind, _ in sites) for name, sites in own.bound.items()},
        )

    @property
    def used(self) -> frozenset[str]:
        """The names that are used here and that no scope within the module binds."""
        return self.common("used", lambda own: frozenset(own.named))

    @property
    def read(self) -> frozenset[str]:
        """The names among `used` that are read."""
        return self.common(
            "read",
            lambda own: frozenset(
                name
                for name, uses in own.named.items()
                if any(each.node.ctx.__class__ is ast.Load for each in uses)
            ),
        )

    @property
    def bound_by(self) -> Mapping[str, frozenset[object]]:
        """For each name of the module that is bound here, the keys of the statements that bind it."""

        def find(own: Stretch) -> Mapping[str, frozenset[object]]:
            # Statements of one line count as one.
            by_line = dict(zip(own.lines, own.keys, strict=True))
            lines = [*by_line]

            def key(site: Any) -> object:
                return by_line[lines[bisect_right(lines, site.lineno) - 1]]

            return {name: frozenset(key(site) for _, site in sites) for name, sites in own.bound.items()}

        return self.common("bound by", find)

    @property
    def importing(self) -> Sequence[object]:
        """The keys of the statements that import, in order."""

        def find(own: Stretch) -> Sequence[object]:
            imports = [node for cls in _IMPORTS for node, _ in own.nodes(cls)]
            return [
                key
                for key, statement in zip(own.keys, own.statements, strict=True)
                if any(
                    first_line(statement) <= node.lineno <= (statement.end_lineno or 0) for node in imports
                )
            ]

        return self.common("importing", find)

    @property
    def needs(self) -> Mapping[str, frozenset[str]]:
        """For each name of the module that is bound here: such names in the definitions and values that it is bound to."""
        return self.common("needs", _needs)


def _needs(stretch: Stretch) -> Mapping[str, frozenset[str]]:
    values: dict[ast.AST, ast.AST] = {}
    for node, _ in stretch.nodes(ast.Assign):
        values.update((target, node) for target in node.targets)
    for node, _ in stretch.nodes(ast.AnnAssign):
        values[node.target] = node
    used = sorted(
        (use.node.lineno, use.node.col_offset, name) for name, uses in stretch.named.items() for use in uses
    )

    def within(site: Any) -> Iterator[str]:
        node = values.get(site, site)
        first = node.decorator_list[0] if getattr(node, "decorator_list", None) else node
        begin = bisect_left(used, (first.lineno, first.col_offset))
        end = bisect_left(used, (node.end_lineno, node.end_col_offset))
        return (name for _, _, name in used[begin:end])

    return {
        name: frozenset(needed for _, site in sites for needed in within(site))
        for name, sites in stretch.bound.items()
    }


def key_of(statement: ast.stmt) -> object:
    """The key of a statement of the top level: shared with its copies on other lines, and with no other statement."""
    # Copies have the attributes of the original.
    return statement.__dict__.setdefault("scenic_key", object())


REBINDING: Final = frozenset({"exec", "globals", "vars"})
"""Builtins with which programs may bind names in ways that the text does not show."""

REFLECTION: Final = REBINDING | {"dir", "eval", "locals"}
"""Builtins with which programs may read names in ways that the text does not show."""


class Resolution:
    """Every scope, binding and reference of a module.

    It is put together from what is known of stretches of the module, when that is first asked for: a question about a
    single node is answered without looking at all the others.

    ``module`` is the scope of the whole module and ``names`` what is bound in it. ``wildcard`` tells whether names may
    exist that the text does not show, ``reflective`` whether the program may read and bind names in ways that the text
    does not show (``globals()``, ``exec``), and ``rebinding`` whether it may bind them so.
    """

    def __init__(self, tree: ast.Module, module: Scope, stretches: Sequence[Stretch]) -> None:
        self.module: Final = module
        self.stretches: Final = tuple(stretches)
        self.diagnostics: tuple[Diagnostic, ...] = ()
        self.names: Final[Mapping[str, Binding]] = self._names()
        reflecting = (
            frozenset()
            .union(*(each.common("reflecting", lambda own: own.contents.reflecting) for each in stretches))
            .difference(self.names)
        )
        self.reflective: Final = bool(reflecting)
        self.rebinding: Final = not reflecting.isdisjoint(REBINDING)
        self.wildcard: bool = self.rebinding or any(
            each.common("wildcard", lambda own: own.contents.wildcard) for each in stretches
        )
        self._tree = tree
        self._nodes: dict[type[ast.AST], list[tuple[Any, Scope]]] = {}
        self._more: Mapping[ast.AST, Reference] = {}
        self._asked: dict[ast.AST, Reference] = {}

    def _names(self) -> dict[str, Binding]:
        names: dict[str, Binding] = {}
        for stretch in self.stretches:
            for name, kinds in stretch.kinds.items():
                binding = names.get(name)
                if binding is None:
                    names[name] = Binding(name, self.module, None, {*kinds}, stretches=[stretch])
                elif binding.stretches is not None:
                    binding.stretches.append(stretch)
                    binding.kinds.update(kinds)
        return names

    def _copy(self) -> "Resolution":
        new = Resolution.__new__(Resolution)
        new.__dict__.update(self.__dict__)
        return new

    def with_findings(self, diagnostics: tuple[Diagnostic, ...], *, wildcard: bool) -> "Resolution":
        """The same names, with what was found out about them."""
        new = self._copy()
        new.diagnostics = diagnostics
        new.wildcard = wildcard
        return new

    def with_references(self, more: Mapping[ast.AST, Reference]) -> "Resolution":
        """The same names, with some more nodes that mean one of them."""
        new = self._copy()
        new._more, new._asked = {**self._more, **more}, {}
        new.__dict__.pop("references", None)
        return new

    # All of them

    @cached_property
    def references(self) -> Mapping[ast.AST, Reference]:
        """The meanings of names, in no particular order.

        Names bound by other nodes than ``ast.Name`` (functions, parameters, imports, captures) are found through
        `Binding.sites`.
        """
        found: dict[ast.AST, Reference] = dict(self._more)
        names = self.names
        for stretch in self.stretches:
            found.update(stretch.references)
            for node, reference in stretch.references.items():
                if reference.binding is None and reference.node.id in names:
                    found[node] = Reference(reference.node, reference.scope, names[reference.node.id])
        return found

    @cached_property
    def scopes(self) -> Mapping[ast.AST, Scope]:
        """The scope that a node opens."""
        found: dict[ast.AST, Scope] = {self._tree: self.module}
        for each in self.stretches:
            found.update(each.scopes)
        return found

    @cached_property
    def nonlocals(self) -> Mapping[ast.AST, Scope]:
        """The scope in which a ``nonlocal`` statement stands."""
        return {node: scope for each in self.stretches for node, scope in each.contents.nonlocals.items()}

    @cached_property
    def tolerated(self) -> Collection[ast.AST]:
        """The names read where a missing name is provided for."""
        return frozenset().union(
            *(
                each.contents.tolerated
                for each in self.stretches
                if each.common("tolerates", lambda own: bool(own.contents.tolerated))
            )
        )

    @property
    def reserved(self) -> Sequence[tuple[str, ast.AST]]:
        """The places where the program binds a name that it must not bind."""
        return [
            item
            for each in self.stretches
            if each.common("binds reserved", lambda own: bool(own.contents.reserved))
            for item in each.contents.reserved
        ]

    def nodes(self, cls: type[ast.AST]) -> Sequence[tuple[Any, Scope]]:
        """The nodes of one of the classes that the checks look for, each with the scope in which it stands."""
        if len(self.stretches) == 1:
            return self.stretches[0].nodes(cls)
        found = self._nodes.get(cls)
        if found is None:
            found = [item for each in self.stretches for item in each.nodes(cls)]
            self._nodes[cls] = found
        return found

    def around(self, node: Any) -> Iterator[Stretch]:
        """The stretches in which a node of the tree may stand, by its line: more than one if they share that."""
        line: int | None = getattr(node, "lineno", None)
        stretches = self.stretches
        if line is None or len(stretches) == 1:
            yield from stretches
            return
        index = bisect_right(self._first_lines, line) - 1
        while index >= 0 and stretches[index].last_line >= line:
            yield stretches[index]
            index -= 1

    @cached_property
    def _first_lines(self) -> list[int]:
        return [each.lines[0] for each in self.stretches]

    def sites(self) -> Iterator[tuple[ast.AST, Binding]]:
        """Every node that binds a name, with what it binds; in no particular order."""
        for stretch in self.stretches:
            for site, found in stretch.sites.items():
                yield site, self.names[found] if isinstance(found, str) else found

    def uses(self, name: str) -> Iterator[Reference]:
        """Yield the uses of a name that no scope within the module binds, in no particular order and without their bindings."""
        for stretch in self.stretches:
            if name in stretch.used:
                yield from stretch.named[name]

    @cached_property
    def used(self) -> Collection[str]:
        """The names that are used and that no scope within the module binds."""
        return frozenset().union(*(each.used for each in self.stretches))

    def is_read(self, binding: Binding) -> bool:
        """Return whether the value of a binding is read anywhere."""
        if binding.scope is self.module:
            return any(binding.name in each.read for each in self.stretches)
        return any(binding in each.loaded for each in self.around(binding.scope.node))

    # One of them

    def reference(self, node: ast.AST | None) -> Reference | None:
        """Return the reference of a node that is a name of the program: its scope and binding; ``None`` for all other nodes."""
        known: Mapping[ast.AST, Reference] | None = self.__dict__.get("references")
        if known is not None:
            return known.get(node)  # type: ignore[arg-type]
        if not isinstance(node, ast.Name):
            return None
        asked = self._asked.get(node)
        if asked is not None:
            return asked
        found = self._more.get(node)
        if found is None:
            found = next(
                (each.references[node] for each in self.around(node) if node in each.references), None
            )
            if found is None:
                return None
        binding = found.binding or self.names.get(found.node.id)
        if binding is not found.binding:
            found = Reference(found.node, found.scope, binding)
        self._asked[node] = found
        return found

    def binding(self, name: ast.AST) -> Binding | None:
        """The meaning of a name of the program, as far as the text shows it."""
        reference = self.reference(name)
        return None if reference is None else reference.binding

    def binding_at(self, site: ast.AST) -> Binding | None:
        """The binding that a node (a name, definition, parameter or alias) belongs to."""
        for stretch in self.around(site):
            found = stretch.sites.get(site)
            if found is not None:
                return self.names[found] if isinstance(found, str) else found
        return None

    def scope(self, node: ast.AST) -> Scope | None:
        """The scope that a node opens."""
        if "scopes" in self.__dict__:
            return self.scopes.get(node)
        if node is self._tree:
            return self.module
        return next((each.scopes[node] for each in self.around(node) if node in each.scopes), None)

    def lookup(self, name: str, scope: Scope) -> Binding | None:
        """The binding that a read of ``name`` in a scope means; ``None`` if the text binds it nowhere in reach."""
        return scope.lookup(name) or self.names.get(name)

    def bindings(self, scope: Scope) -> Mapping[str, Binding]:
        """The bindings of a scope."""
        return self.names if scope.kind is ScopeKind.MODULE else scope.bindings

    def names_in_reach(self, scope: Scope) -> set[str]:
        """All names that a read in a scope can mean, for suggestions."""
        return {
            name
            for outer in scope.ancestors()
            if outer is scope or outer.kind is not ScopeKind.CLASS
            for name in self.bindings(outer)
        }
