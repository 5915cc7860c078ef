"""Imports that an editor writes: of names that are missing, and all of a document in order."""

import ast
import os
import sys
from collections.abc import Callable, Iterator, Mapping, Sequence
from typing import Final

from scenic.compiler import tree as scenic
from scenic.compiler.fixes import apply_fixes
from scenic.compiler.loader import SUFFIXES
from scenic.compiler.parser import parse
from scenic.compiler.semantics.modules import Module
from scenic.dataclass import dataclass
from scenic.ide.repairs import difference
from scenic.ide.snapshot import Snapshot
from scenic.language.diagnostics import Diagnostic, Edit
from scenic.language.names import IMPORTABLE
from scenic.language.spans import Span
from scenic.language.word_sets import word_set
from scenic.project.index import Project

__all__ = ["Missing", "can_organize", "missing_imports", "organize_imports"]

_UNKNOWN: Final = frozenset({"SC202", "SC203"})
_UNUSED: Final = "SC206"
_SHORT: Final[Mapping[str, str]] = {
    "np": "numpy",
    "plt": "matplotlib.pyplot",
    "pd": "pandas",
    "numpy": "numpy",
}
"""Modules by the names under which programs usually import them."""
_COMMON: Final[Mapping[str, frozenset[str]]] = {
    "math": word_set(
        "acos asin atan atan2 ceil copysign degrees dist e exp floor hypot inf isclose log log10 pi "
        "radians tan tau"
    ),
    "itertools": frozenset(
        ["chain", "combinations", "count", "cycle", "pairwise", "permutations", "product"]
    ),
    "collections": frozenset(["Counter", "defaultdict", "deque", "namedtuple"]),
    "functools": frozenset(["cache", "partial", "reduce"]),
    "dataclasses": frozenset(["dataclass", "field"]),
    "pathlib": frozenset({"Path"}),
}
"""The names that programs import most often from Python's library."""
_MOST: Final = 5
"""So many modules are offered for one name."""


@dataclass(frozen=True, slots=True)
class Missing:
    """A name that is not defined, and the import that would bring it."""

    diagnostic: Diagnostic
    title: str
    edit: Edit


def missing_imports(
    project: Project,
    snapshot: Snapshot,
    found: Sequence[Diagnostic],
    touches: Callable[[Span], bool],
) -> Iterator[Missing]:
    """The imports of the workspace that would bring the names that are not defined, of those that ``touches`` chooses."""
    for item in found:
        if item.code not in _UNKNOWN or item.span is None or not touches(item.span):
            continue
        name = snapshot.source.line(item.span.line)[item.span.column : item.span.end_column]
        if not name.isidentifier():
            continue
        modules = [*_modules_with(project, snapshot.filename, name)]
        if name in IMPORTABLE:
            modules.append(IMPORTABLE[name])
        modules += [module for module, names in _COMMON.items() if name in names]
        for module in dict.fromkeys(modules):
            edit = _import(snapshot, module, name)
            yield Missing(item, f"Import `{name}` from `{module}`", edit)
        whole = _SHORT.get(name, name)
        if name in _SHORT or name in sys.stdlib_module_names:
            statement = f"import {whole}" if whole == name else f"import {whole} as {name}"
            yield Missing(item, f"Write `{statement}`", _on_own_line(snapshot, statement))


def _modules_with(project: Project, importer: str, name: str) -> list[str]:
    """The names of the modules of the workspace that define something of this name, the nearest ones first."""
    names = []
    for filename in project.files():
        if filename == importer:
            continue
        module = project.module(filename)
        if module is None or not _defines(module, name):
            continue
        module_name = _module_name(project, filename, importer)
        if module_name is not None:
            names.append(module_name)
    return sorted(names, key=lambda each: (each.count("."), each))[:_MOST]


def _defines(module: Module, name: str) -> bool:
    """Return whether a module itself binds a name at its top level, and not by an import."""
    binding = module.resolution.names.get(name)
    return binding is not None and not any(isinstance(site, ast.alias) for site in binding.sites)


def _module_name(project: Project, filename: str, importer: str) -> str | None:
    """Return the name under which a program imports the module in a file; ``None`` if it cannot import it."""
    for base in (os.path.dirname(importer), *project.finder.roots):
        if not filename.startswith(base + os.sep):
            continue
        path = os.path.relpath(filename, base)
        stem, ending = os.path.splitext(path)
        parts = stem.split(os.sep)
        if ending not in (*SUFFIXES, ".py"):
            continue
        if parts[-1] == "__init__" and len(parts) > 1:
            parts.pop()
        name = ".".join(parts)
        same = project.find(name, importer=importer).filename == filename
        if same and all(part.isidentifier() for part in parts):
            return name
    return None


def _import(snapshot: Snapshot, module: str, name: str) -> Edit:
    """Return the edit that imports a name: by an import of the module that is there already, or on a line of its own."""
    imports = _imports(snapshot.tree.body)
    for node in imports:
        if isinstance(node, ast.ImportFrom) and not node.level and node.module == module:
            last = node.names[-1]
            if last.name != "*":
                span = snapshot.source.span(last)
                return Edit(Span(span.end_line, span.end_column, span.end_line, span.end_column), f", {name}")
    return _on_own_line(snapshot, f"from {module} import {name}")


def _on_own_line(snapshot: Snapshot, statement: str) -> Edit:
    """Return the edit that adds an import after those that are there."""
    imports = _imports(snapshot.tree.body)
    line = 1
    body = snapshot.tree.body
    if imports:
        line = (imports[-1].end_lineno or imports[-1].lineno) + 1
    elif body and scenic.is_documentation(body[0]):
        line = (body[0].end_lineno or 1) + 1
    else:
        lines = snapshot.source.lines
        while line < len(lines) and lines[line - 1].startswith("#"):
            line += 1
    text = f"{statement}\n"
    if line > len(snapshot.source.lines):
        end = len(snapshot.source.lines)
        column = len(snapshot.source.lines[-1])
        return Edit(Span(end, column, end, column), "\n" + text)
    return Edit(Span(line, 0, line, 0), text)


def _imports(body: Sequence[ast.stmt]) -> list[ast.Import | ast.ImportFrom | scenic.Model]:
    """The imports at the top of a program: those before anything that is none."""
    found: list[ast.Import | ast.ImportFrom | scenic.Model] = []
    for node in body:
        if isinstance(node, ast.Import | ast.ImportFrom | scenic.Model):
            found.append(node)
        elif not scenic.is_documentation(node):
            break
    return found


# Imports in order


def can_organize(snapshot: Snapshot, found: Sequence[Diagnostic]) -> bool:
    """Return whether `organize_imports` has something to do; decided without working out what."""
    if snapshot.parsed.diagnostics:
        return False
    return any(item.code == _UNUSED for item in found) or organize_imports(snapshot, ()) is not None


def organize_imports(snapshot: Snapshot, found: Sequence[Diagnostic]) -> Edit | None:
    """Removes imports that are not used, and puts the others in order where that changes nothing.

    Modules of Scenic add to the scene when they are imported, in the order of the imports: only neighbouring imports of
    Python's own library are sorted, and the names within one import. ``None`` if there is nothing to do, and in a text
    with mistakes of syntax, of which it is not known what it uses.
    """
    if snapshot.parsed.diagnostics:
        return None
    fixes = [item.fix for item in found if item.code == _UNUSED and item.fix is not None]
    text, _ = apply_fixes(snapshot.text, fixes)
    tree = snapshot.tree if text == snapshot.text else parse(text).tree
    lines = text.split("\n")
    groups: list[list[tuple[int, str]]] = []
    before = 0
    for node in tree.body:
        line = None if not isinstance(node, ast.Import | ast.ImportFrom) else _sorted(node, lines)
        if line is None:
            continue
        if _is_of_python(node) and groups and before == node.lineno - 1:
            groups[-1].append((node.lineno, line))
        else:
            groups.append([(node.lineno, line)])
        before = node.lineno if _is_of_python(node) else 0
    for group in groups:
        lines_in_order = sorted((line for _, line in group), key=_order)
        for (number, _), line in zip(group, lines_in_order, strict=True):
            lines[number - 1] = line
    return difference(snapshot.text, "\n".join(lines))


def _sorted(node: ast.Import | ast.ImportFrom, lines: Sequence[str]) -> str | None:
    """The line of an import with its names in order; ``None`` if it shares its line, or goes over several."""
    line = lines[node.lineno - 1]
    if node.end_lineno != node.lineno or line[node.end_col_offset or 0 :].strip() or node.col_offset:
        return None
    if isinstance(node, ast.Import) or "(" in line or any(alias.name == "*" for alias in node.names):
        return line
    names = sorted((alias.name.lower(), alias.name, alias.asname) for alias in node.names)
    listed = ", ".join(name if other is None else f"{name} as {other}" for _, name, other in names)
    return f"from {'.' * node.level}{node.module or ''} import {listed}"


def _is_of_python(node: ast.stmt) -> bool:
    if isinstance(node, ast.ImportFrom):
        return not node.level and (node.module or "").partition(".")[0] in sys.stdlib_module_names
    return isinstance(node, ast.Import) and all(
        alias.name.partition(".")[0] in sys.stdlib_module_names for alias in node.names
    )


def _order(line: str) -> tuple[bool, str]:
    """Imports of modules come before those of names, each by the module."""
    return line.startswith("from"), line.split()[1].lower()
