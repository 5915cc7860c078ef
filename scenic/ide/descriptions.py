"""Descriptions of named things, as Markdown: header, documentation, place."""

import ast
import builtins
import inspect
import os
from typing import Final

from scenic.compiler.semantics.classes import Classes
from scenic.compiler.semantics.model import Model
from scenic.compiler.semantics.signatures import signature_of
from scenic.compiler.semantics.symbols import Symbol, SymbolKind
from scenic.ide import documentation
from scenic.project.index import Project

__all__ = ["describe", "header", "of_python"]

_WORDS: Final = {
    SymbolKind.CLASS: "class",
    SymbolKind.FUNCTION: "def",
    SymbolKind.METHOD: "def",
    SymbolKind.BEHAVIOR: "behavior",
    SymbolKind.MONITOR: "monitor",
    SymbolKind.SCENARIO: "scenario",
}
_MOST_MEMBERS: Final = 30


def describe(project: Project, symbol: Symbol) -> str:
    """Return the description of a symbol: its signature, its documentation, and its origin."""
    if symbol.is_builtin:
        language_text = documentation.of_name(symbol.name) or documentation.of_property(symbol.name)
        if language_text is not None:
            return language_text
    parts = [f"```scenic\n{header(project, symbol)}\n```"]
    text = _of_module(project, symbol) if symbol.kind is SymbolKind.MODULE else symbol.documentation
    if text:
        parts.append(text)
    elif (
        symbol.kind is SymbolKind.VARIABLE and symbol.module is not None and isinstance(symbol.node, ast.Name)
    ):
        cls = Model(symbol.module, project).class_of(symbol.node)
        if cls is not None:
            summary = (cls.documentation or "").split("\n")[0]
            parts.append(f"`{cls.name}`: {summary}" if summary else f"`{cls.name}`")
    if symbol.kind is SymbolKind.CLASS:
        parts += _members(project, symbol)
    if symbol.kind in (SymbolKind.PROPERTY, SymbolKind.ATTRIBUTE) and not text:
        property_text = documentation.of_property(symbol.name)
        if property_text is not None:
            parts.append(property_text)
    if symbol.filename is not None and symbol.span is not None:
        name = os.path.basename(symbol.filename)
        parts.append(
            f"*{name}*" if symbol.kind is SymbolKind.MODULE else f"*{name}, line {symbol.span.line}*"
        )
    return "\n\n".join(parts)


def header(project: Project, symbol: Symbol) -> str:
    """Return a line that describes a symbol."""
    word = _WORDS.get(symbol.kind)
    if symbol.kind is SymbolKind.MODULE:
        return f"module {symbol.name}"
    if symbol.kind is SymbolKind.CLASS:
        cls = Classes(project).of_symbol(symbol)
        bases = ", ".join(base.name for base in cls.bases) if cls is not None else ""
        return f"class {symbol.name}({bases})" if bases else f"class {symbol.name}"
    if word is not None:
        signature = signature_of(project, symbol)
        return f"{word} {symbol.name}(...)" if signature is None else f"{word} {signature}"
    value = "" if symbol.module is None or symbol.extent is None else _text(symbol)
    owner = f"{symbol.container}." if symbol.container and symbol.kind is not SymbolKind.PARAMETER else ""
    title = value if value.startswith(symbol.name) and value != symbol.name else f"{owner}{symbol.name}"
    return f"({symbol.kind}) {title}"


def of_python(name: str) -> str | None:
    """Describe one of Python's own builtins."""
    value = getattr(builtins, name, None)
    text = inspect.getdoc(value) if value is not None else None
    if not text:
        return None
    return f"```python\n{name}\n```\n\n{text.partition(chr(10) + chr(10))[0]}"


def _of_module(project: Project, symbol: Symbol) -> str | None:
    """Return the docstring of a module."""
    module = None if symbol.filename is None else project.module(symbol.filename)
    return None if module is None else ast.get_docstring(module.tree)


def _text(symbol: Symbol) -> str:
    """Return the definition as it is written, if that is one short line."""
    assert symbol.module is not None
    assert symbol.extent is not None
    extent = symbol.extent
    if extent.line != extent.end_line:
        return ""
    text = symbol.module.source.line(extent.line)[extent.column : extent.end_column].strip()
    return text if len(text) <= 100 else ""


def _members(project: Project, symbol: Symbol) -> list[str]:
    """Return the properties of a class that it does not inherit from the language, with their defaults."""
    cls = Classes(project).of_symbol(symbol)
    own = [each for each in cls.properties.values() if each.symbol is not None] if cls is not None else []
    lines = [f"- `{each.name}`: {each.default}" for each in own[:_MOST_MEMBERS]]
    return ["\n".join(lines)] if lines else []
