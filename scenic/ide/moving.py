"""Changes of the imports of a project when files or folders get other names, or move."""

import ast
import os
from collections.abc import Iterable, Iterator

from scenic.compiler import tree as scenic
from scenic.compiler.loader import SUFFIXES
from scenic.compiler.semantics.modules import FoundModule, Module, ModuleKind
from scenic.compiler.semantics.symbols import symbol_of_module
from scenic.language.spans import Span
from scenic.project.index import Project
from scenic.project.queries import Location, occurrences, references

__all__ = ["imports_after_moves"]


def imports_after_moves(
    project: Project, moves: Iterable[tuple[str, str]]
) -> tuple[tuple[Location, str], ...]:
    """The changes that let imports find what they did, once each first path of a pair has become the second.

    With another name in the same folder, every word changes that means the module. Of what moves elsewhere, ``model m``
    and ``from m import ...`` change, where the new place can be named from the same beginning.
    """
    changes: dict[tuple[str, Span], tuple[Location, str]] = {}
    for old, new in moves:
        old, new = os.path.abspath(old), os.path.abspath(new)
        same = os.path.dirname(old) == os.path.dirname(new)
        for place, text in (_renamed if same else _moved)(project, old, new):
            changes.setdefault((place.filename, place.span), (place, text))
    return tuple(changes.values())


def _module_name(path: str) -> str:
    """The last part of the dotted name of a file or folder."""
    name = os.path.basename(path)
    return next((name.removesuffix(end) for end in (*SUFFIXES, ".py") if name.endswith(end)), name)


def _renamed(project: Project, old: str, new: str) -> Iterator[tuple[Location, str]]:
    name, new_name = _module_name(old), _module_name(new)
    if name == new_name or not new_name.isidentifier():
        return
    initial = [os.path.join(old, f"__init__{end}") for end in (*SUFFIXES, ".py")]
    for filename in (old, *initial):
        for kind in (ModuleKind.SCENIC, ModuleKind.NAMESPACE):
            symbol = symbol_of_module(FoundModule(name, kind, filename))
            for place in references(project, symbol):
                module = project.module(place.filename)
                line = "" if module is None else module.source.line(place.span.line)
                if line[place.span.column : place.span.end_column] == name:
                    yield place, new_name


def _moved(project: Project, old: str, new: str) -> Iterator[tuple[Location, str]]:
    for filename in project.files():
        module = project.module(filename)
        if module is None or _module_name(old) not in module.source.text:
            continue
        for node, name, span in _named(module):
            module_found = project.find(name, importer=filename)
            target = _after(module_found.filename, old, new)
            if module_found.filename is None or target is None:
                continue
            base = _without(module_found.filename, name)
            dotted_name = None if base is None else _dotted(target, base)
            if dotted_name is not None and dotted_name != name:
                yield Location(filename, span, isinstance(node, scenic.Model)), dotted_name


def _named(module: Module) -> Iterator[tuple[ast.AST, str, Span]]:
    """The dotted names of the modules that a program takes names from, but for relative ones."""
    parts: dict[ast.AST, list[Span]] = {}
    for each in occurrences(module):
        if each.index is not None and isinstance(each.node, ast.ImportFrom | scenic.Model):
            parts.setdefault(each.node, []).append(each.span)
    for node, spans in parts.items():
        name = node.name if isinstance(node, scenic.Model) else getattr(node, "module", None)
        if name and not getattr(node, "level", 0):
            yield node, name, Span(spans[0].line, spans[0].column, spans[-1].end_line, spans[-1].end_column)


def _after(filename: str | None, old: str, new: str) -> str | None:
    """Return the new path of a file after the path ``old`` has become ``new``; ``None`` if the file stays."""
    if filename == old:
        return new
    if filename is not None and filename.startswith(old + os.sep):
        return new + filename[len(old) :]
    return None


def _without(filename: str, name: str) -> str | None:
    """Return the folder that a dotted name begins in, if it leads to this file."""
    folder, last = os.path.split(filename)
    parts = name.split(".")
    if not last.startswith("__init__.") and not os.path.isdir(filename):
        parts = parts[:-1]
    elif os.path.isdir(filename):
        folder = filename
    for part in reversed(parts):
        folder, last_part = os.path.split(folder)
        if last_part != part:
            return None
    return folder


def _dotted(filename: str, base: str) -> str | None:
    """The dotted name of a file from a folder on; ``None`` if it has none."""
    relative = os.path.relpath(filename, base)
    folder, last = os.path.split(relative)
    parts = [part for part in folder.split(os.sep) if part]
    if not last.startswith("__init__."):
        parts.append(_module_name(last))
    return ".".join(parts) if parts and all(part.isidentifier() for part in parts) else None
