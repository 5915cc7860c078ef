"""Facts about imported modules, which a project hands to the checks of a program."""

import ast
from collections.abc import Collection, Iterator, Mapping
from functools import cached_property
from types import MappingProxyType
from typing import Any

from scenic.compiler import tree as scenic
from scenic.compiler.scopes import Resolution
from scenic.compiler.semantics.classes import BUILT_IN, own_property
from scenic.compiler.semantics.meanings import Class, class_of_symbol
from scenic.compiler.semantics.modules import Exported, Exports, FoundModule, ModuleKind
from scenic.compiler.semantics.names import DEFINITIONS
from scenic.compiler.semantics.symbols import Symbol, symbol_of_exported
from scenic.compiler.surroundings import Foreign, Property, Surroundings, SurroundingsOf
from scenic.language.diagnostics import Diagnostic
from scenic.language.source import Source
from scenic.project.agents import agent_findings
from scenic.project.appearances import appearance_findings
from scenic.project.imports import Imports
from scenic.project.index import Project
from scenic.project.maps import map_findings
from scenic.project.members import kind_of_exported, member_findings
from scenic.project.textures import texture_findings

__all__ = ["surroundings_in"]


def surroundings_in(project: Project, *, verbose: bool = False) -> SurroundingsOf:
    """Resolves the imports of programs of a project; if ``verbose``, also reports unknown ones."""

    def surroundings_of(tree: ast.Module, source: Source, resolution: Resolution) -> Surroundings:
        return _Surroundings(project, tree, source, resolution, verbose)

    return surroundings_of


class _Surroundings:
    """The imports of one program and the names that they bring.

    A module is read when its names are first needed.
    """

    def __init__(
        self, project: Project, tree: ast.Module, source: Source, resolution: Resolution, verbose: bool
    ) -> None:
        self._project = project
        self._tree = tree
        self._source = source
        self._resolution = resolution
        self._imports = Imports(project, tree, source, resolution, verbose)
        self.state = project.state_beside(source.filename)

    @cached_property
    def _stars(self) -> tuple[Exports, ...]:
        """The names that each star import and each `model` brings, in order."""
        return tuple(self._project.exports_of(self._imports.found(node)) for node in self._imports.stars)

    @cached_property
    def complete(self) -> bool:
        return all(exports.complete for exports in self._stars)

    @cached_property
    def _names(self) -> Mapping[str, Exported]:
        return {
            name: exports.names[name]
            for exports in self._stars
            for name in exports.public
            if name in exports.names
        }

    @property
    def names(self) -> Collection[str]:
        return self._names.keys()

    def brought(self, name: str) -> Foreign | None:
        exported = self._names.get(name)
        return None if exported is None else _foreign(self._project, exported)

    def kind_of(self, name: str) -> str | None:
        exported = self._names.get(name)
        return None if exported is None else kind_of_exported(self._project, exported)

    def imported(self, alias: ast.alias) -> Foreign | None:
        found = self._imports.member(alias)
        return _foreign(self._project, found) if isinstance(found, Exported) else None

    def attribute(self, node: ast.Attribute) -> Foreign | None:
        found = self._imports.attribute(node)
        return _foreign(self._project, found) if isinstance(found, Exported) else None

    def is_missing(self, alias: ast.alias) -> bool:
        return self._imports.is_missing(alias)

    def is_begun(self, alias: ast.alias) -> bool:
        return self._imports.is_begun(alias)

    def sets_ego(self, statement: ast.Import | ast.ImportFrom | scenic.Model) -> bool:
        return any(self._may_set_ego(found) for found in self._imports.modules(statement))

    def _may_set_ego(self, found: FoundModule) -> bool:
        if found.kind is ModuleKind.SCENIC:
            exports = self._project.exports_of(found)
            return exports.sets_ego or not exports.complete
        return found.is_missing

    def findings(self) -> Iterator[Diagnostic]:
        yield from self._imports.findings()
        yield from map_findings(self._tree, self._source)
        yield from texture_findings(self._tree, self._source)
        yield from appearance_findings(self._tree, self._source)
        yield from agent_findings(self._project, self._tree, self._source, self._resolution, self._names)
        yield from member_findings(self._project, self._tree, self._source, self._resolution, self._names)


def _foreign(project: Project, exported: Exported) -> Foreign | None:
    if exported.module is None or exported.binding is None:
        return None
    key = (exported.module.filename, exported.binding)
    if key not in project.derived:
        project.derived[key] = _explored(project, exported)
    found: Foreign | None = project.derived[key]
    return found


def _explored(project: Project, exported: Exported) -> Foreign | None:
    symbol = symbol_of_exported(project, exported)
    binding, node = symbol.binding, symbol.node
    if binding is None or symbol.module is None or len(binding.sites) != 1:
        return None
    if not isinstance(node, DEFINITIONS) or getattr(node, "decorator_list", None):
        return None
    parameters, properties, is_plain_class = None, None, False
    members, base = None, None
    if isinstance(node, ast.ClassDef):
        known = class_of_symbol(project, symbol)
        if known is not None and not known.is_scenic and not node.keywords and known.initial_is_own:
            # Whatever its bases are.
            parameters = _parameters(known)
        if known is not None and known.complete:
            properties = _properties(known) if known.is_scenic else None
            parameters = None if known.is_scenic else _parameters(known)
            is_plain_class = not known.is_scenic
            if known.is_scenic and known.member("__getattr__") is None:
                members = frozenset(each.name for each in known.members)
                base = _built_in_base(project, known)
    return Foreign(
        symbol.name, node, parameters, properties, symbol.filename, symbol.span, is_plain_class, members, base
    )


def _built_in_base(project: Project, known: Class) -> str | None:
    """The built-in class from which a class of objects derives."""
    waiting = [known.symbol]
    while waiting:
        symbol = waiting.pop(0)
        if symbol.is_builtin:
            return symbol.name if symbol.name in BUILT_IN else None
        found = class_of_symbol(project, symbol)
        waiting += () if found is None else found.bases
    return None


def _properties(known: Class) -> Mapping[str, Property]:
    found: dict[str, Property] = {}
    for member in known.properties:
        if member.symbol is None:
            found[member.name] = BUILT_IN[member.owner][member.name]
        elif isinstance(member.symbol.node, scenic.PropertyDef):
            found[member.name] = own_property(member.symbol.node)
    return MappingProxyType(found)


def _parameters(known: Class) -> ast.arguments | None:
    """The parameters of a class that is called, without the first one of its ``__init__``."""
    if known.member("__new__") is not None:
        return None
    initial = known.member("__init__")
    symbol: Symbol | None = None if initial is None else initial.symbol
    node: Any = None if symbol is None else symbol.node
    if initial is None or not isinstance(node, ast.FunctionDef) or node.decorator_list:
        return None
    own = node.args
    if own.posonlyargs or not own.args:
        return None
    rest = own.args[1:]
    return ast.arguments(
        posonlyargs=[],
        args=rest,
        vararg=own.vararg,
        kwonlyargs=own.kwonlyargs,
        kw_defaults=own.kw_defaults,
        kwarg=own.kwarg,
        defaults=own.defaults[-len(rest) :] if rest and own.defaults else [],
    )
