"""Modules as the model of a program sees them: one parsed module, its names, and what it asks of those who know the others."""

import ast
from collections.abc import Callable, Mapping
from dataclasses import field
from enum import StrEnum
from functools import cached_property
from typing import Any, Final, Protocol, TypeVar

from scenic.compiler import tree as scenic
from scenic.compiler.places import word_span
from scenic.compiler.scopes import Binding, Resolution, Scope, ScopeKind
from scenic.compiler.traversal import walk
from scenic.dataclass import dataclass
from scenic.language.source import Source
from scenic.language.spans import Span

__all__ = ["NO_MODULES", "Exported", "Exports", "FoundModule", "Module", "ModuleKind", "Modules", "Unseen"]

_T = TypeVar("_T")


@dataclass(frozen=True, eq=False)
class Module:
    """A parsed module; ``is_scenic`` gives its language, and ``broken`` is true if parts of it could not be parsed."""

    source: Source
    tree: ast.Module = field(repr=False)
    resolution: Resolution = field(repr=False)
    is_scenic: bool
    broken: bool
    _derived: dict[object, Any] = field(default_factory=dict, init=False, repr=False)

    @property
    def filename(self) -> str:
        """The absolute path of the file."""
        return self.source.filename

    @cached_property
    def import_of(self) -> dict[ast.alias, ast.Import | ast.ImportFrom]:
        """The statement that each alias stands in."""
        return {
            alias: node
            for cls in (ast.Import, ast.ImportFrom)
            for node, _ in self.resolution.nodes(cls)
            for alias in node.names
        }

    @cached_property
    def assignment_of(self) -> dict[ast.AST, ast.Assign | ast.AnnAssign]:
        """The assignment of which each name is a whole target."""
        found: dict[ast.AST, ast.Assign | ast.AnnAssign] = {}
        for node, _ in self.resolution.nodes(ast.Assign):
            found.update((target, node) for target in node.targets if isinstance(target, ast.Name))
        for node, _ in self.resolution.nodes(ast.AnnAssign):
            if isinstance(node.target, ast.Name):
                found[node.target] = node
        return found

    @cached_property
    def annotation_of(self) -> dict[ast.AST, ast.expr]:
        """The annotation of each name or attribute that is assigned or declared with one."""
        return {node.target: node.annotation for node, _ in self.resolution.nodes(ast.AnnAssign)}

    @cached_property
    def loop_of(self) -> dict[ast.AST, ast.expr]:
        """The values that each name runs through, of loops, comprehensions and functions without a name that are called for each."""
        values_by_target: dict[ast.AST, ast.expr] = {}
        loops: list[ast.For | ast.comprehension] = [node for node, _ in self.resolution.nodes(ast.For)]
        for kind in (ast.ListComp, ast.SetComp, ast.GeneratorExp, ast.DictComp):
            for node, _ in self.resolution.nodes(kind):
                loops += node.generators
        for loop in loops:
            if isinstance(loop.target, ast.Name):
                values_by_target[loop.target] = loop.iter
        for node, _ in self.resolution.nodes(ast.Call):
            match node:
                case ast.Call(func=ast.Name(id="filter" | "map"), args=[ast.Lambda() as function, values]):
                    pass
                case ast.Call(
                    func=ast.Name(id="max" | "min" | "sorted"),
                    args=[values],
                    keywords=[ast.keyword(arg="key", value=ast.Lambda() as function)],
                ):
                    pass
                case _:
                    continue
            if len(function.args.args) == 1:
                values_by_target[function.args.args[0]] = values
        return values_by_target

    def word_span(self, node: ast.AST, word: str) -> Span:
        """The place of a word in a node."""
        return word_span(self.source, node, word)

    def attribute_span(self, node: ast.Attribute) -> Span:
        """The place of the name after the dot, which ends the node."""
        whole = self.source.span(node)
        start = max(0, whole.end_column - len(node.attr))
        return Span(whole.end_line, start, whole.end_line, whole.end_column)

    def text(self, node: ast.AST) -> str:
        """Return the text of a node, on one line."""
        span = self.source.span(node)
        if span.line == span.end_line:
            return self.source.line(span.line)[span.column : span.end_column]
        lines = [self.source.line(span.line)[span.column :]]
        lines += [self.source.line(number).strip() for number in range(span.line + 1, span.end_line)]
        lines.append(self.source.line(span.end_line)[: span.end_column].strip())
        return " ".join(lines)

    @cached_property
    def owner_of_specifier(self) -> dict[ast.AST, scenic.New | scenic.Override]:
        """The class or module that each specifier belongs to."""
        return {
            specifier: node
            for node in walk(self.tree)
            if isinstance(node, scenic.New | scenic.Override)
            for specifier in node.specifiers
        }

    @cached_property
    def call_of(self) -> dict[ast.keyword, ast.Call]:
        """The call that each argument by name belongs to."""
        return {
            keyword: node
            for node in walk(self.tree)
            if isinstance(node, ast.Call)
            for keyword in node.keywords
        }

    def knows(self, name: str) -> bool:
        """Return whether what is computed under a name is there already."""
        return name in self._derived

    def derived(self, name: object, compute: Callable[[], _T]) -> _T:
        """The result of a computation from the module, computed on first use and kept under a name."""
        known = self._derived.get(name)
        if known is None:
            known = self._derived[name] = compute()
        found: _T = known
        return found

    @cached_property
    def stars(self) -> tuple[ast.ImportFrom | scenic.Model, ...]:
        """The statements that bring names that the text does not show, in order."""
        nodes = self.resolution.nodes
        found: list[Any] = [node for node, _ in nodes(scenic.Model)]
        found += [node for node, _ in nodes(ast.ImportFrom) if any(alias.name == "*" for alias in node.names)]
        return tuple(sorted(found, key=lambda node: (node.lineno, node.col_offset)))

    @cached_property
    def public(self) -> frozenset[str] | None:
        """The names in ``__all__``; ``None`` without it, or if it is not a plain list of strings."""
        binding = self.resolution.names.get("__all__")
        if binding is None:
            return None
        for reference in self.resolution.uses.get("__all__", ()):
            if isinstance(reference.node.ctx, ast.Load) and reference.scope.kind is ScopeKind.MODULE:
                return None  # It may be changed in place: `__all__.append("name")`.
        names: set[str] = set()
        assignments: set[ast.AST] = set()
        for node in self.tree.body:
            match node:
                case ast.Assign(targets=[ast.Name(id="__all__") as target], value=value):
                    pass
                case ast.AugAssign(target=ast.Name(id="__all__") as target, op=ast.Add(), value=value):
                    pass
                case _:
                    continue
            texts = [getattr(each, "value", None) for each in getattr(value, "elts", (value,))]
            if not all(isinstance(text, str) for text in texts):
                return None
            names.update(text for text in texts if isinstance(text, str))
            assignments.add(target)
        return frozenset(names) if assignments.issuperset(binding.sites) else None

    @cached_property
    def is_dynamic(self) -> bool:
        """Return whether it may have names that its text does not show, apart from those that star imports bring."""
        if self.broken or "__getattr__" in self.resolution.names:
            return True
        return self.resolution.rebinding

    @cached_property
    def sets_ego(self) -> bool:
        """Return whether running the module may set the ego (that of a scenario in it does not count)."""
        return any(
            not isinstance(reference.node.ctx, ast.Load) and not _in_scenario(reference.scope)
            for reference in self.resolution.uses.get("ego", ())
        )


def _in_scenario(scope: Scope) -> bool:
    own = (ScopeKind.SCENARIO, ScopeKind.BEHAVIOR, ScopeKind.MONITOR)
    return any(outer.kind in own for outer in scope.ancestors())


class ModuleKind(StrEnum):
    """The kinds of modules that are found."""

    SCENIC = "Scenic module"
    PYTHON = "Python module"
    COMPILED = "compiled module"
    NAMESPACE = "folder"
    MISSING = "missing module"


@dataclass(frozen=True, slots=True)
class FoundModule:
    """The result of the search for a module.

    ``filename`` is its file; of a folder without ``__init__`` the folder, of a module that is built into Python
    nothing. Of a missing module, ``searched`` are the folders in which it was looked for (without those of Python's
    own library and installed packages), ``found`` is the longest beginning of its name that does exist (``within`` tells
    whether in the project itself), and ``near`` a module with a similar name.
    """

    name: str
    kind: ModuleKind
    filename: str | None = None
    searched: tuple[str, ...] = ()
    found: str = ""
    within: bool = False
    near: str | None = None

    @property
    def is_missing(self) -> bool:
        """Return whether there is no such module."""
        return self.kind is ModuleKind.MISSING


@dataclass(frozen=True, slots=True)
class Exported:
    """A name of a module, and the binding that it comes from, possibly in another module.

    Without a ``binding`` it is a name of a compiled module, or (with a ``module``) that module itself.
    """

    name: str
    module: Module | None = None
    binding: Binding | None = None


@dataclass(frozen=True, slots=True)
class Unseen:
    """The reason why not all names of a module are known: the module with the dotted name ``module`` cannot be read."""

    module: str
    reason: str


@dataclass(frozen=True, slots=True)
class Exports:
    """The names that a module has.

    ``names`` are all of them, ``public`` those that ``import *`` and ``model`` bring. If ``unseen`` is not empty, the
    module may have others. ``sets_ego`` tells whether importing it may set the ego.
    """

    names: Mapping[str, Exported] = field(repr=False)
    public: frozenset[str] = field(repr=False)
    unseen: tuple[Unseen, ...] = ()
    sets_ego: bool = False

    @property
    def complete(self) -> bool:
        """Return whether it has no other names."""
        return not self.unseen


class Modules(Protocol):
    """The modules that a program can reach, which the model of a program asks for; a project implements it."""

    @property
    def derived(self) -> dict[object, Any]:
        """Results about these modules, kept for all programs until one of the modules changes."""

    def find(self, name: str, *, importer: str, level: int = 0) -> FoundModule:
        """Return the module that an import in a file means; ``level`` counts the dots before the name."""

    def found_by(self, node: ast.ImportFrom | scenic.Model, importer: str) -> FoundModule:
        """Return the module that ``from m import ...`` or ``model m`` means."""

    def exports_of(self, found: FoundModule) -> Exports:
        """The names of a module that was found; none and `Exports.unseen` if nobody can look into it."""

    def member(
        self, found: FoundModule, name: str, *, importer: str, level: int = 0
    ) -> Exported | FoundModule | None:
        """Return the meaning of ``from m import name``: a name of the module, else a module in it; ``None`` if it has neither."""

    def follow(self, exported: Exported) -> Exported | FoundModule:
        """The definition behind an imported name, through all modules that pass it on."""


class _NoModules:
    """The modules of a program of which nobody knows the others."""

    @property
    def derived(self) -> dict[object, Any]:
        return {}

    def find(self, name: str, *, importer: str, level: int = 0) -> FoundModule:
        return FoundModule(name, ModuleKind.MISSING)

    def found_by(self, node: ast.ImportFrom | scenic.Model, importer: str) -> FoundModule:
        return FoundModule(
            (node.name if isinstance(node, scenic.Model) else node.module) or "", ModuleKind.MISSING
        )

    def exports_of(self, found: FoundModule) -> Exports:
        return Exports({}, frozenset(), (Unseen(found.name, "nobody looks for it"),))

    def member(
        self, found: FoundModule, name: str, *, importer: str, level: int = 0
    ) -> Exported | FoundModule | None:
        return None

    def follow(self, exported: Exported) -> Exported | FoundModule:
        return exported


NO_MODULES: Final[Modules] = _NoModules()
"""The modules of a program that is looked at alone."""
