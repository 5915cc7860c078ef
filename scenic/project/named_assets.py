"""Checks of what a program names as maps, textures and appearances, if its text shows what is meant."""

import ast
import os
from collections.abc import Iterator
from functools import lru_cache
from typing import Final

from scenic.compiler import tree as scenic
from scenic.compiler.scopes import Resolution
from scenic.compiler.semantics.modules import Module
from scenic.formats.appearance_names import NAMES, advice
from scenic.formats.opendrive.reader import read_map
from scenic.formats.opendrive.xml_tree import MapError
from scenic.formats.texture_names import SUFFIXES, is_image_name
from scenic.language.diagnostics import Diagnostic, Severity
from scenic.language.spelling import nearest

__all__ = ["asset_findings"]

_CHOICES: Final = frozenset({"Uniform", "Discrete"})
_SUFFIX: Final = ".xodr"
_MOST_NAMES: Final = 5
"""Number of maps in a folder that are named at most."""


def asset_findings(module: Module) -> Iterator[Diagnostic]:
    """Report maps and appearances that there are not, and warn of images that are not there.

    Scenes are sampled without their textures: only pictures and labels need the files.
    """
    yield from _of_maps(module)
    yield from _of_textures(module)
    for value in _values(module, "appearance"):
        match value:
            case ast.Constant(value=str() as name) if name not in NAMES:
                yield Diagnostic(
                    "SC616",
                    f"there is no appearance '{name}'",
                    module.source.span(value),
                    filename=module.filename,
                    help=advice(name),
                )


def _values(module: Module, name: str) -> Iterator[ast.expr]:
    """Yield the values that specifiers and classes give to a property."""
    if name not in module.source.text:
        return
    resolution: Resolution = module.resolution
    for node, _ in (*resolution.nodes(scenic.SpecifierPhrase), *resolution.nodes(scenic.PropertyDef)):
        match node:
            case scenic.SpecifierPhrase(operands=[ast.expr() as value, *_]) if node.property == name:
                yield value
            case scenic.PropertyDef(value=ast.expr() as value) if node.name == name:
                yield value


def _similar(path: str, suffixes: str | tuple[str, ...]) -> tuple[str | None, list[str]]:
    """Return the name in the folder of a missing file that is probably meant, and all names there with these endings."""
    folder, file_name = os.path.split(path)
    try:
        names = sorted(name for name in os.listdir(folder) if name.lower().endswith(suffixes))
    except OSError:
        names = []
    near = nearest(file_name, names)
    return None if near is None else f"did you mean '{near}'?", names


# Textures


def _of_textures(module: Module) -> Iterator[Diagnostic]:
    folder = os.path.dirname(os.path.abspath(module.filename))
    for value in _values(module, "texture"):
        for name, place in _images(value):
            path = os.path.join(folder, name)
            if "\0" in name or os.path.isfile(path):
                continue
            near, _ = _similar(path, SUFFIXES)
            yield Diagnostic(
                "SC613",
                f"there is no texture '{name}'",
                module.source.span(place),
                Severity.WARNING,
                module.filename,
                help=near or "paths of textures start from the folder of the program",
            )


def _images(value: ast.expr | None) -> Iterator[tuple[str, ast.expr]]:
    """Yield names of image files in a texture, with their places: alone, as options of a choice, and under ``image``."""
    match value:
        case ast.Constant(value=str() as text) if is_image_name(text):
            yield text, value
        case ast.Call(func=ast.Name(id=name), args=args) if name in _CHOICES:
            for option in args:
                # The options of `Discrete` are keys, those of `Uniform` may be textures with an image.
                options = option.keys if name == "Discrete" and isinstance(option, ast.Dict) else [option]
                for item in options:
                    yield from _images(item)
        case ast.Dict(keys=keys, values=values):
            for key, item in zip(keys, values, strict=True):
                if isinstance(key, ast.Constant) and key.value == "image":
                    yield from _images(item)


# Maps


def _of_maps(module: Module) -> Iterator[Diagnostic]:
    """Report that ``param map = localPath('...')`` or an absolute path names no file, or one that is not a map that can be read.

    Other paths are relative to a working directory that is not known here, and not looked at.
    """
    folder = os.path.dirname(os.path.abspath(module.filename))
    items = (item for node in module.tree.body if isinstance(node, scenic.Param) for item in node.items)
    for item in items:
        name = _map_path(item.value) if item.name == "map" else None
        wrong = None if name is None else _wrong(os.path.normpath(os.path.join(folder, name)), name)
        if wrong is not None:
            message, help_line = wrong
            span = module.source.span(item.value)
            yield Diagnostic("SC620", message, span, filename=module.filename, help=help_line)


def _map_path(value: ast.expr) -> str | None:
    """Return the text in ``localPath('...')``, or an absolute path; ``None`` of other values."""
    match value:
        case ast.Constant(value=str() as text) if os.path.isabs(text) and "\0" not in text:
            return text
        case ast.Call(func=ast.Name(id="localPath"), args=[ast.Constant(value=str() as text)]):
            return None if "\0" in text else text
    return None


def _wrong(path: str, name: str) -> tuple[str, str] | None:
    """Return the message and the help about a path that cannot be used as a map."""
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
    """Return a hint at the maps in the folder of one that is missing."""
    folder = os.path.dirname(path)
    if not os.path.isdir(folder):
        return f"there is no folder '{folder}'"
    near, names = _similar(path, _SUFFIX)
    there = f"there are {', '.join(names[:_MOST_NAMES])}" if names else None
    return near or there or "paths of `localPath` are relative to the folder of the program"


@lru_cache(maxsize=32)
def _unreadable(path: str, _changed: int, _size: int) -> tuple[str, str] | None:
    """Return the message and the help about a file that is not a map; look at it again when it has changed."""
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
