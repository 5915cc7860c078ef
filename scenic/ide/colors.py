"""Colours that a document gives to objects: where they are written, and how another one would be."""

import ast
from collections.abc import Iterator

from scenic.compiler import tree as scenic
from scenic.compiler.traversal import walk
from scenic.dataclass import dataclass
from scenic.ide.name_places import span_of
from scenic.ide.snapshot import Snapshot
from scenic.language.spans import Span

__all__ = ["Color", "colors", "presentation"]

_PROPERTY = "color"


@dataclass(frozen=True, slots=True)
class Color:
    """A colour and where it is written; its parts lie between 0 and 1."""

    span: Span
    red: float
    green: float
    blue: float
    opacity: float


def colors(snapshot: Snapshot) -> tuple[Color, ...]:
    """Return the colours that are written out as numbers, in order of place."""
    return tuple(sorted(_find(snapshot), key=lambda each: each.span))


def presentation(red: float, green: float, blue: float, opacity: float) -> str:
    """Return the text of a colour."""
    parts = [red, green, blue] if opacity == 1 else [red, green, blue, opacity]
    return "(" + ", ".join(f"{round(part, 3):g}" for part in parts) + ")"


def _find(snapshot: Snapshot) -> Iterator[Color]:
    for node in walk(snapshot.tree):
        value: ast.expr | None = None
        if isinstance(node, scenic.SpecifierPhrase) and node.property == _PROPERTY:
            value = node.operands[0]
        elif isinstance(node, scenic.PropertyDef) and node.name == _PROPERTY:
            value = node.value
        if isinstance(value, ast.Tuple | ast.List) and len(value.elts) in (3, 4):
            parts = [_number(each) for each in value.elts]
            if all(part is not None and 0 <= part <= 1 for part in parts):
                red, green, blue, opacity = [part or 0.0 for part in parts] + [1.0] * (4 - len(parts))
                yield Color(span_of(snapshot, value), red, green, blue, opacity)


def _number(node: ast.expr) -> float | None:
    if isinstance(node, ast.Constant) and type(node.value) in (int, float):
        return float(node.value)  # type: ignore[arg-type]
    return None
