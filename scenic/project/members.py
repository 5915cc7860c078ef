"""Attributes that the values of world models do not have: ``network.lane``.

The class of such a value follows from annotations of the library (`scenic.project.classes.class_of`), which the compiler does not see.
"""

import ast
import os
from collections.abc import Collection, Iterator
from typing import Final

from scenic import language
from scenic.compiler.scopes import Resolution
from scenic.language.diagnostics import Diagnostic, Edit, Fix, Severity
from scenic.language.properties import attributes_of, properties_of
from scenic.language.source import Source
from scenic.language.spans import Span
from scenic.language.spelling import nearest
from scenic.project.classes import class_of, class_of_symbol
from scenic.project.index import Project
from scenic.project.modules import Module

__all__ = ["member_findings"]

_LIBRARY: Final = os.path.dirname(os.path.dirname(os.path.abspath(language.__file__ or ""))) + os.sep
_COMMON: Final = frozenset(properties_of("Object")) | frozenset(attributes_of("Object"))


def member_findings(
    project: Project, tree: ast.Module, source: Source, resolution: Resolution, brought: Collection[str]
) -> Iterator[Diagnostic]:
    """Reports slips in attributes of what star imports and the model bring; ``brought`` are the names of that."""
    if not brought:
        return
    module = Module(source, tree, resolution, is_scenic=True, broken=False)
    stored = {node.attr for node, _ in resolution.nodes(ast.Attribute) if isinstance(node.ctx, ast.Store)}
    seen: dict[tuple[str, str], tuple[str, str] | None] = {}
    for node, _ in resolution.nodes(ast.Attribute):
        if node.attr in stored or node.attr in _COMMON or node.attr.startswith("_"):
            continue
        value = node.value
        if not isinstance(value, ast.Name) or value.id not in brought or value.id in resolution.names:
            continue
        key = (value.id, node.attr)
        if key not in seen:
            seen[key] = _slip(project, module, node)
        found = seen[key]
        if found is not None:
            kind, meant = found
            whole = source.span(node)
            place = Span(
                whole.end_line, max(0, whole.end_column - len(node.attr)), whole.end_line, whole.end_column
            )
            yield Diagnostic(
                "SC214",
                f"a `{kind}` has no attribute `{node.attr}`",
                place,
                Severity.WARNING,
                source.filename,
                f"did you mean `{meant}`?",
                fix=Fix(f"Change to `{meant}`", (Edit(place, meant),)),
            )


def _slip(project: Project, module: Module, node: ast.Attribute) -> tuple[str, str] | None:
    """The class of the owner of an attribute and the name that was meant, if the class has no such attribute."""
    symbol = class_of(project, module, node.value)
    if symbol is None or symbol.filename is None or not symbol.filename.startswith(_LIBRARY):
        return None
    cls = class_of_symbol(project, symbol)
    if (
        cls is None
        or cls.is_scenic
        or cls.member(node.attr) is not None
        or cls.member("__getattr__") is not None
    ):
        return None
    meant = nearest(node.attr, {each.name for each in cls.members if not each.name.startswith("_")})
    return None if meant is None else (symbol.name, meant)
