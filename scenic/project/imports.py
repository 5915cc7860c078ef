"""The imports of one program: what they mean in its project, and what is wrong with them."""

import ast
import os
from collections.abc import Collection, Iterator
from functools import cached_property
from typing import Any, Final

from scenic.compiler import tree as scenic
from scenic.compiler.places import header_span, word_span
from scenic.compiler.scopes import BindingKind
from scenic.compiler.semantics.modules import Exported, Exports, FoundModule, ModuleKind
from scenic.compiler.semantics.names import Names
from scenic.compiler.traversal import position
from scenic.established import MODULES as ESTABLISHED
from scenic.language.diagnostics import Diagnostic, Edit, Fix, Severity
from scenic.language.libraries import FAMILIES, LIBRARIES, how_to_get
from scenic.language.spans import Span
from scenic.language.spelling import is_slip, nearest
from scenic.project.index import Project

__all__ = ["Imports"]

_MOST_SUGGESTIONS: Final = 100
"""Names for which a similar one is looked for: a file full of unknown names must not take long."""

_MOST_FOLDERS: Final = 4
"""So many of the folders that were searched are named."""

_GUARDS: Final = (ast.Try, ast.TryStar, scenic.TryInterrupt)


class Imports:
    """The imports of a program, in its project. If ``verbose``, those of which nothing is known are reported."""

    def __init__(self, project: Project, names: Names, verbose: bool) -> None:
        self._project = project
        self._names = names
        self._source = names.module.source
        self._resolution = names.resolution
        self._verbose = verbose
        self._suggested = 0

    # What they mean

    @cached_property
    def _froms(self) -> tuple[ast.ImportFrom, ...]:
        return tuple(
            node for node, _ in self._resolution.nodes(ast.ImportFrom) if node.module != "__future__"
        )

    @cached_property
    def _models(self) -> tuple[scenic.Model, ...]:
        return tuple(node for node, _ in self._resolution.nodes(scenic.Model))

    @cached_property
    def _plain(self) -> tuple[ast.Import, ...]:
        return tuple(node for node, _ in self._resolution.nodes(ast.Import))

    @cached_property
    def _statements(self) -> dict[ast.alias, ast.ImportFrom]:
        return {alias: node for node in self._froms for alias in node.names}

    def found(self, node: ast.ImportFrom | scenic.Model) -> FoundModule:
        """Return the module that a statement names."""
        return self._project.found_by(node, self._source.filename)

    def modules(self, statement: ast.Import | ast.ImportFrom | scenic.Model) -> tuple[FoundModule, ...]:
        """Return the modules that a statement runs."""
        importer = self._source.filename
        if isinstance(statement, ast.Import):
            return tuple(self._project.find(alias.name, importer=importer) for alias in statement.names)
        found = self.found(statement)
        if isinstance(statement, scenic.Model) or found.is_missing:
            return (found,)
        inner = (self.member(alias) for alias in statement.names if alias.name != "*")
        return (found, *(each for each in inner if isinstance(each, FoundModule)))

    def member(self, alias: ast.alias) -> Exported | FoundModule | None:
        """Return the definition that ``from m import name`` brings."""
        return self._names.imported(alias) if alias in self._statements else None

    def is_missing(self, alias: ast.alias) -> bool:
        """Return whether the module does not exist, or is not known to have the name."""
        statement = self._statements.get(alias)
        if statement is None:
            return self._project.find(alias.name, importer=self._source.filename).is_missing
        return self.member(alias) is None

    def is_begun(self, alias: ast.alias) -> bool:
        """Return whether what an import names is missing, and the beginning of something that is there."""
        if not self.is_missing(alias):
            return False
        importer = self._source.filename
        statement = self._statements.get(alias)
        if statement is None:
            home, _, beginning = alias.name.rpartition(".")
            names: Collection[str] = self._project.finder.importable(os.path.dirname(importer), home)
            if home:
                names = {*names, *self._project.exports_of(self._project.find(home, importer=importer)).names}
        else:
            beginning, names = alias.name, self._project.exports_of(self.found(statement)).names
        return any(name.startswith(beginning) for name in names)

    # What is wrong with them

    def findings(self) -> Iterator[Diagnostic]:
        """SC212 (a module lacks a name), SC213 (nothing is known about a module) and SC406 (a module does not exist)."""
        for model in self._models:
            yield from self._module_findings(self.found(model), model, model.name, 0)
        for plain in self._plain:
            for alias in plain.names:
                target = self._project.find(alias.name, importer=self._source.filename)
                yield from self._module_findings(target, alias, alias.name, 0)
        for statement in self._froms:
            target = self.found(statement)
            before = list(self._module_findings(target, statement, statement.module or "", statement.level))
            yield from before
            if not target.is_missing:
                yield from self._name_findings(target, statement)
        yield from self._attribute_findings()

    def _module_findings(self, found: FoundModule, node: Any, name: str, level: int) -> Iterator[Diagnostic]:
        star = isinstance(node, scenic.Model) or node in self._names.module.stars
        if not found.is_missing:
            exports = self._project.exports_of(found) if star and self._verbose else None
            for missing_part in () if exports is None else exports.unseen:
                inner = missing_part.module not in (name, name.rpartition(".")[2] + ".scenic")
                why = f"of `{missing_part.module}`, {missing_part.reason}" if inner else missing_part.reason
                yield self._unknown(node, name, why)
            return
        severity, near = _judgement(found, node, level)
        place = self._place(node, name)
        if isinstance(node, scenic.Model) and severity is not Severity.ERROR:
            yield self._elsewhere(found, node, place)
            return
        if severity is None or self._is_guarded(node):
            if self._verbose:
                yield self._unknown(node, name, "it is not installed here")
            return
        fix = None
        if near is not None:
            help_ = f"did you mean `{near}`?"
            fix = self._renaming(node, place, name, near)
        else:
            help_ = self._searched(found, node, level)
        what = "world model" if isinstance(node, scenic.Model) else "module"
        yield Diagnostic(
            "SC406",
            f"there is no {what} `{'.' * level}{name}`",
            place,
            severity,
            self._source.filename,
            help_,
            fix=fix,
        )

    def _elsewhere(self, found: FoundModule, node: scenic.Model, place: Span) -> Diagnostic:
        """Return a world model that may be installed where the program runs: its names are unknown, all else can be checked."""
        return Diagnostic(
            "SC406",
            f"the world model `{node.name}` is not here, so that its names are not checked and nothing can be sampled",
            place,
            Severity.INFORMATION,
            self._source.filename,
            f"{self._searched(found, node, 0)}; {how_to_get(node.name)}",
        )

    def _searched(self, found: FoundModule, node: object, level: int) -> str:
        own_folder = os.path.dirname(os.path.abspath(self._source.filename))
        folders = [
            "beside the program" if each == own_folder else f"in `{_shown(each, own_folder)}`"
            for each in found.searched
        ]
        if len(folders) > _MOST_FOLDERS:
            folders = [*folders[:_MOST_FOLDERS], f"in {len(folders) - _MOST_FOLDERS} other folders"]
        if not level and not found.found:
            folders.append("on Python's path")
        places = folders[0] if len(folders) == 1 else f"{', '.join(folders[:-1])} or {folders[-1]}"
        kind = ".scenic" if isinstance(node, scenic.Model) else ".scenic or .py"
        return f"there is no {kind} file of that name {places}" if folders else "correct the name"

    def _unknown(self, node: object, name: str, why: str) -> Diagnostic:
        return Diagnostic(
            "SC213",
            f"not all names that `{name}` brings are known: {why}",
            self._place(node, name),
            Severity.INFORMATION,
            self._source.filename,
            "names that nothing else defines are taken to come from there",
        )

    def _name_findings(self, found: FoundModule, statement: ast.ImportFrom) -> Iterator[Diagnostic]:
        exports: Exports | None = None
        for alias in statement.names:
            if alias.name == "*" or self.member(alias) is not None:
                continue
            exports = self._project.exports_of(found) if exports is None else exports
            module = f"{'.' * statement.level}{statement.module or ''}"
            if not exports.complete:
                if self._verbose:
                    yield self._unknown(statement, module, f"it may have `{alias.name}`")
                continue
            if self._is_guarded(statement):
                continue
            place = self._alias_place(alias)
            yield self._without(module, alias.name, exports, place, alias)

    def _attribute_findings(self) -> Iterator[Diagnostic]:
        module_names = {
            binding.name
            for binding in self._resolution.names.values()
            if binding.kinds <= {BindingKind.MODULE, BindingKind.IMPORTED}
        }
        if not module_names or self._resolution.reflective:
            return
        for node, _ in self._resolution.nodes(ast.Attribute):
            base = node.value
            while isinstance(base, ast.Attribute):
                base = base.value
            if not (
                isinstance(base, ast.Name) and base.id in module_names and isinstance(node.ctx, ast.Load)
            ):
                continue
            home = self._names.module_behind(node.value)
            if home is None or home.is_missing or home.kind is ModuleKind.NAMESPACE:
                continue
            exports = self._project.exports_of(home)
            if (
                node.attr in exports.names
                or node.attr.startswith("__")
                or self._names.attribute_of_module(node) is not None
            ):
                continue
            if f"{home.name}.{node.attr}" in ESTABLISHED:
                continue
            if not exports.complete or self._is_guarded(node) or self._is_stored(node):
                continue
            whole = self._source.span(node)
            start = max(0, whole.end_column - len(node.attr))
            place = Span(whole.end_line, start, whole.end_line, whole.end_column)
            yield self._without(home.name, node.attr, exports, place)

    def _is_stored(self, node: ast.Attribute) -> bool:
        """Return whether the program gives a module such an attribute somewhere."""
        return any(
            other.attr == node.attr and not isinstance(other.ctx, ast.Load)
            for other, _ in self._resolution.nodes(ast.Attribute)
        )

    def _without(
        self, module: str, name: str, exports: Exports, place: Span, alias: ast.alias | None = None
    ) -> Diagnostic:
        near = None
        if self._suggested < _MOST_SUGGESTIONS:
            self._suggested += 1
            near = nearest(name, exports.names)
        return Diagnostic(
            "SC212",
            f"the module `{module}` has no `{name}`",
            place,
            Severity.ERROR,
            self._source.filename,
            f"did you mean `{near}`?" if near else "correct the name, or define it there",
            fix=None if near is None else self._renaming(alias, place, name, near),
        )

    def _renaming(self, node: ast.AST | None, place: Span, name: str, near: str) -> Fix | None:
        """The repair of a name, also where the program uses what the import binds to it."""
        edits = [Edit(place, near)]
        if place.end_column - place.column != len(name):
            return None
        if isinstance(node, ast.alias) and node.asname is None:
            if "." in name:
                return None
            edits += [
                Edit(self._source.span(reference.node), near)
                for reference in self._resolution.references.values()
                if reference.binding is not None and node in reference.binding.sites
            ]
        return Fix(f"Write `{near}`", tuple(edits), is_slip(name, near))

    def _is_guarded(self, node: ast.AST) -> bool:
        """Return whether a node stands in a ``try`` that catches errors, so that its failure may be provided for."""
        return any(first <= position(node) <= last for first, last in self._guards)

    @cached_property
    def _guards(self) -> list[tuple[tuple[int, int], tuple[int, int]]]:
        """The beginning and the end of each ``try`` that catches errors."""
        return [
            (position(owner), (owner.end_lineno or 0, owner.end_col_offset or 0))
            for cls in _GUARDS
            for owner, _ in self._resolution.nodes(cls)
            if owner.handlers
        ]

    def _place(self, node: Any, name: str) -> Span:
        """The name of the module in its statement."""
        whole = header_span(self._source, node)
        line = self._source.line(whole.line)
        start = whole.column
        if isinstance(node, scenic.Model | ast.ImportFrom):
            start = line.find(" ", whole.column) + 1 or whole.column
        column = line.find(name, start) if name else -1
        return whole if column < 0 else Span(whole.line, column, whole.line, column + len(name))

    def _alias_place(self, alias: ast.alias) -> Span:
        return word_span(self._source, alias, alias.name)


def _judgement(found: FoundModule, node: object, level: int) -> tuple[Severity | None, str | None]:
    """Return the severity of a missing module (``None``: do not report it), and the name that may be meant.

    A library may be installed where the program runs and not here; whatever belongs to the program must be here.
    """
    name = found.name
    if level:
        return Severity.ERROR, found.near
    if name == "scenic" or name.startswith("scenic."):
        if name in LIBRARIES or ".".join(name.split(".")[:2]) in FAMILIES:
            return None, None
        near = nearest(name, LIBRARIES, limit=2)
        return (Severity.WARNING, None) if near is None else (Severity.ERROR, near)
    if found.near is not None:
        return Severity.ERROR, found.near
    if found.found:
        # The beginning of the name was found. An installed package may make modules as it likes.
        return (Severity.ERROR if found.within else None), None
    if isinstance(node, scenic.Model) and "." not in name:
        return Severity.ERROR, None
    return Severity.WARNING, None


def _shown(folder: str, own: str) -> str:
    """Return a folder as seen from the program, if it is near."""
    try:
        relative = os.path.relpath(folder, own)
    except ValueError:  # on another drive
        return folder
    return folder if relative.startswith(os.path.join(os.pardir, os.pardir)) else relative
