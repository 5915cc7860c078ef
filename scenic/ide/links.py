"""Files that a document names: modules that it imports, meshes and other data that it reads."""

import ast
import os
from collections.abc import Iterator
from typing import Final

from scenic.compiler.semantics.model import Model
from scenic.compiler.traversal import walk
from scenic.dataclass import dataclass
from scenic.ide.name_places import span_of
from scenic.ide.snapshot import Snapshot
from scenic.language.spans import Span
from scenic.project.index import Project
from scenic.project.queries import occurrences, symbol_of

__all__ = ["FileLink", "links"]

_FILES: Final = frozenset({"localPath", "fromFile", "open", "Path"})
"""Functions and methods whose first argument names a file."""


@dataclass(frozen=True, slots=True)
class FileLink:
    """A name of a file in the text, and the file that it means."""

    span: Span
    path: str


def links(project: Project, snapshot: Snapshot) -> tuple[FileLink, ...]:
    """Return the files that a document names, in order of place, as far as they exist. Runs nothing to find them."""
    folder = os.path.dirname(snapshot.filename)
    if not os.path.isabs(snapshot.filename):
        return ()
    file_links = [
        FileLink(span, path)
        for span, name in _names(snapshot)
        if os.path.exists(path := os.path.normpath(os.path.join(folder, name)))
    ]
    file_links += _modules(project, snapshot)
    return tuple(sorted(file_links, key=lambda link: link.span))


def _modules(project: Project, snapshot: Snapshot) -> Iterator[FileLink]:
    """Yield the modules that are imported: each word of a dotted name leads to its own part of it."""
    module = project.module(snapshot.filename)
    model = None if module is None else Model(module, project)
    for each in () if module is None else occurrences(module):
        if each.index is None or model is None:
            continue
        symbol = symbol_of(model, each)
        if symbol is not None and symbol.filename is not None and os.path.isfile(symbol.filename):
            yield FileLink(each.span, symbol.filename)


def _names(snapshot: Snapshot) -> Iterator[tuple[Span, str]]:
    for node in walk(snapshot.tree):
        if not isinstance(node, ast.Call) or not node.args:
            continue
        function = node.func
        name = function.id if isinstance(function, ast.Name) else getattr(function, "attr", "")
        argument = node.args[0]
        if name in _FILES and isinstance(argument, ast.Constant) and isinstance(argument.value, str):
            text = argument.value
            span = span_of(snapshot, argument)
            if text and "\0" not in text and span.line == span.end_line:
                yield (
                    Span(
                        span.line, span.column + 1, span.end_line, max(span.column + 1, span.end_column - 1)
                    ),
                    text,
                )
