"""Checks of the road maps that a program names, if its text shows which file is meant."""

import ast
import os
from collections.abc import Iterator
from functools import lru_cache
from typing import Final

from scenic.compiler import tree as scenic
from scenic.formats.opendrive.reader import read_map
from scenic.formats.opendrive.xml_tree import MapError
from scenic.language.diagnostics import Diagnostic, Severity
from scenic.language.source import Source
from scenic.language.spelling import nearest

__all__ = ["map_findings"]

_SUFFIX: Final = ".xodr"
_MOST_NAMES: Final = 5
"""So many of the maps that are there are named."""


def map_findings(tree: ast.Module, source: Source) -> Iterator[Diagnostic]:
    """Reports that ``param map = localPath('...')`` or an absolute path names no file, or one that is not a map that can be read.

    Other paths are relative to a working directory that is not known here, and not looked at.
    """
    folder = os.path.dirname(source.filename)
    if not os.path.isabs(folder):
        folder = os.path.abspath(folder)
    for statement in tree.body:
        if not isinstance(statement, scenic.Param):
            continue
        for item in statement.items:
            name = _path(item.value) if item.name == "map" else None
            wrong = None if name is None else _wrong(os.path.normpath(os.path.join(folder, name)), name)
            if wrong is not None:
                message, advice = wrong
                yield Diagnostic(
                    "SC620", message, source.span(item.value), Severity.ERROR, source.filename, help=advice
                )


def _path(value: ast.expr) -> str | None:
    """Return the text in ``localPath('...')``, or an absolute path; ``None`` of other values."""
    match value:
        case ast.Constant(value=str() as text) if os.path.isabs(text) and "\0" not in text:
            return text
        case ast.Call(func=ast.Name(id="localPath"), args=[ast.Constant(value=str() as text)]) if (
            "\0" not in text
        ):
            return text
    return None


def _wrong(path: str, name: str) -> tuple[str, str] | None:
    """The message and the help about a path that cannot be used as a map."""
    if not os.path.splitext(path)[1] and not os.path.exists(path):
        path += _SUFFIX
    if os.path.isdir(path):
        return f"'{name}' is a folder, not a map", f"give the {_SUFFIX} file"
    if os.path.splitext(path)[1].lower() not in ("", _SUFFIX):
        return f"'{name}' is not a map that scenic reads", f"it reads OpenDRIVE, {_SUFFIX} files"
    try:
        status = os.stat(path)
    except OSError:
        return f"there is no map '{name}'", _beside(path)
    return _unreadable(path, status.st_mtime_ns, status.st_size)


def _beside(path: str) -> str:
    """A hint at the maps in the folder of one that is missing."""
    folder, file_name = os.path.split(path)
    if not os.path.isdir(folder):
        return f"there is no folder '{folder}'"
    try:
        names = sorted(name for name in os.listdir(folder) if name.endswith(_SUFFIX))
    except OSError:
        return "paths of `localPath` are relative to the folder of the program"
    near = nearest(file_name, names)
    if near is not None:
        return f"did you mean '{near}'?"
    if names:
        return f"there are {', '.join(names[:_MOST_NAMES])}"
    return "paths of `localPath` are relative to the folder of the program"


@lru_cache(maxsize=32)
def _unreadable(path: str, _changed: int, _size: int) -> tuple[str, str] | None:
    """The message and the help about a file that is not a map; looked at again when it has changed."""
    try:
        with open(path, "rb") as file:
            read_map(file.read(), path)
    except OSError as error:
        return f"the map cannot be read: {error.strerror}", "check the file and who may read it"
    except MapError as error:
        line = f", line {error.span.line}" if error.span is not None else ""
        return (
            f"{error.message} ({os.path.basename(path)}{line})",
            error.help or "`scenic check` lists what is wrong with a map",
        )
    return None
