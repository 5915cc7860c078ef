"""Checks of the image files that a program names as textures, if its text shows which file is meant."""

import ast
import os
from collections.abc import Iterator
from typing import Final

from scenic.compiler import tree as scenic
from scenic.compiler.scopes import Resolution
from scenic.formats.texture_names import SUFFIXES, is_image_name
from scenic.language.diagnostics import Diagnostic, Severity
from scenic.language.source import Source
from scenic.language.spelling import nearest

__all__ = ["texture_findings"]

_CHOICES: Final = frozenset({"Uniform", "Discrete"})


def texture_findings(resolution: Resolution, source: Source) -> Iterator[Diagnostic]:
    """Warns of ``texture`` properties that name image files which are not there.

    A warning only: scenes are sampled without their textures, and only pictures and labels need the files.
    """
    if "texture" not in source.text:
        return
    folder = os.path.dirname(os.path.abspath(source.filename))
    nodes = (*resolution.nodes(scenic.SpecifierPhrase), *resolution.nodes(scenic.PropertyDef))
    for node, _ in nodes:
        for name, place in _names(_texture(node)):
            path = os.path.join(folder, name)
            if "\0" in name or os.path.isfile(path):
                continue
            yield Diagnostic(
                "SC613",
                f"there is no texture '{name}'",
                source.span(place),
                Severity.WARNING,
                source.filename,
                help=_advice(path),
            )


def _texture(node: ast.AST) -> ast.expr | None:
    """Return the value that a specifier or class gives to the property ``texture``."""
    match node:
        case scenic.SpecifierPhrase(property="texture", operands=[ast.expr() as value, *_]):
            return value
        case scenic.PropertyDef(name="texture", value=value):
            return value
    return None


def _names(value: ast.expr | None) -> Iterator[tuple[str, ast.expr]]:
    """Names of image files in a texture, with their places: alone, as options of a choice, and under ``image``."""
    match value:
        case ast.Constant(value=str() as text) if is_image_name(text):
            yield text, value
        case ast.Call(func=ast.Name(id=name), args=args) if name in _CHOICES:
            for option in args:
                # The options of `Discrete` are keys, those of `Uniform` may be textures with an image.
                options = option.keys if name == "Discrete" and isinstance(option, ast.Dict) else [option]
                for item in options:
                    yield from _names(item)
        case ast.Dict(keys=keys, values=values):
            for key, item in zip(keys, values, strict=True):
                if isinstance(key, ast.Constant) and key.value == "image":
                    yield from _names(item)


def _advice(path: str) -> str:
    """Return a hint at the images in the folder of one that is missing."""
    folder, file_name = os.path.split(path)
    try:
        names = sorted(name for name in os.listdir(folder) if name.lower().endswith(SUFFIXES))
    except OSError:
        names = []
    near = nearest(file_name, names)
    if near is not None:
        return f"did you mean '{near}'?"
    return "paths of textures start from the folder of the program"
