"""Facts about imported modules, which a project hands to the checks of a program."""

import ast
from collections.abc import Iterator

from scenic.compiler import tree as scenic
from scenic.compiler.semantics.model import Model
from scenic.compiler.semantics.modules import FoundModule, Module, ModuleKind, Modules
from scenic.compiler.surroundings import Surroundings, SurroundingsOf
from scenic.language.diagnostics import Diagnostic
from scenic.project.imports import Imports
from scenic.project.index import Project
from scenic.project.named_assets import asset_findings

__all__ = ["surroundings_in"]


def surroundings_in(project: Project, *, verbose: bool = False) -> SurroundingsOf:
    """Resolves the imports of programs of a project; if ``verbose``, also reports unknown ones."""

    def surroundings_of(module: Module) -> Surroundings:
        return _Surroundings(project, module, verbose)

    return surroundings_of


class _Surroundings:
    """The imports of one program."""

    def __init__(self, project: Project, module: Module, verbose: bool) -> None:
        self._model = Model(module, project)
        self._imports = Imports(project, self._model, verbose)
        self.modules: Modules = project

    def is_missing(self, alias: ast.alias) -> bool:
        return self._imports.is_missing(alias)

    def is_begun(self, alias: ast.alias) -> bool:
        return self._imports.is_begun(alias)

    def sets_ego(self, statement: ast.Import | ast.ImportFrom | scenic.Model) -> bool:
        return any(self._may_set_ego(found) for found in self._imports.modules(statement))

    def _may_set_ego(self, found: FoundModule) -> bool:
        if found.kind is ModuleKind.SCENIC:
            exports = self._model.modules.exports_of(found)
            return exports.sets_ego or not exports.complete
        return found.is_missing

    def findings(self) -> Iterator[Diagnostic]:
        yield from self._imports.findings()
        yield from asset_findings(self._model.module)
