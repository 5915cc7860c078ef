"""Global parameters: where a program and the modules that it imports set them."""

import ast
from collections.abc import Iterator

from scenic.compiler import tree as scenic
from scenic.compiler.semantics.modules import Module
from scenic.compiler.traversal import walk
from scenic.dataclass import dataclass
from scenic.ide.snapshot import Snapshot
from scenic.language.spans import Span
from scenic.project.index import Project

__all__ = ["Setting", "parameter_at", "settings"]


@dataclass(frozen=True, slots=True)
class Setting:
    """A place where a global parameter is given a value, in the text of a module."""

    name: str
    filename: str
    span: Span
    extent: Span
    value: str


def settings(project: Project, module: Module) -> Iterator[Setting]:
    """Yield the settings of a module, then those of the Scenic modules that it imports, however far."""
    files_done = {module.filename}
    modules = [module]
    for each in modules:
        for node in each.derived("parameter nodes", lambda own=each: tuple(_nodes(own))):  # type: ignore[misc]
            if isinstance(node, scenic.Param):
                yield from (_setting(each, item) for item in node.items if item.name.isidentifier())
                continue
            for filename in _imported(project, each, node):
                imported_module = None if filename in files_done else project.module(filename)
                files_done.add(filename)
                if imported_module is not None and imported_module.is_scenic:
                    modules.append(imported_module)


def parameter_at(snapshot: Snapshot, line: int, column: int) -> tuple[str, Span] | None:
    """Return the parameter that is read at a place (``globalParameters.speed``), and its name's place."""
    node = snapshot.path_to(line, column)[-1]
    index = snapshot.token_at(line, column)
    if not isinstance(node, ast.Attribute) or not isinstance(node.value, ast.Name) or index is None:
        return None
    if node.value.id != "globalParameters" or snapshot.tokens.texts[index] != node.attr:
        return None
    return node.attr, snapshot.span_of_token(index)


def _nodes(module: Module) -> Iterator[ast.AST]:
    return (
        node
        for node in walk(module.tree)
        if isinstance(node, scenic.Param | scenic.Model | ast.Import | ast.ImportFrom)
    )


def _imported(project: Project, module: Module, node: ast.AST) -> Iterator[str]:
    """Yield the files of the modules that a statement imports."""
    level = node.level if isinstance(node, ast.ImportFrom) else 0
    names = [alias.name for alias in node.names] if isinstance(node, ast.Import) else []
    if isinstance(node, scenic.Model):
        names = [node.name]
    elif isinstance(node, ast.ImportFrom):
        names = [node.module or ""]
    for name in names:
        module_found = project.find(name, importer=module.filename, level=level)
        if module_found.filename is not None:
            yield module_found.filename


def _setting(module: Module, item: scenic.ParamItem) -> Setting:
    extent = module.source.span(item)
    value = ast.get_source_segment(module.source.text, item.value) or "..."
    return Setting(item.name, module.filename, module.word_span(item, item.name), extent, value)
