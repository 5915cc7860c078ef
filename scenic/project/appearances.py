"""Checks of the names that a program gives as appearances of objects."""

import ast
from collections.abc import Iterator

from scenic.compiler import tree as scenic
from scenic.compiler.scopes import Resolution
from scenic.formats.appearance_names import NAMES, advice
from scenic.language.diagnostics import Diagnostic
from scenic.language.source import Source

__all__ = ["appearance_findings"]


def appearance_findings(resolution: Resolution, source: Source) -> Iterator[Diagnostic]:
    """Reports names of appearances that there are not, where they are written out."""
    if "appearance" not in source.text:
        return
    for node, _ in (*resolution.nodes(scenic.SpecifierPhrase), *resolution.nodes(scenic.PropertyDef)):
        match node:
            case (
                scenic.SpecifierPhrase(
                    property="appearance", operands=[ast.Constant(value=str() as name) as value, *_]
                )
                | scenic.PropertyDef(name="appearance", value=ast.Constant(value=str() as name) as value)
            ) if name not in NAMES:
                yield Diagnostic(
                    "SC616",
                    f"there is no appearance '{name}'",
                    source.span(value),
                    filename=source.filename,
                    help=advice(name),
                )
