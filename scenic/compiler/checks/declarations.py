"""Parameters, properties and probabilities: what is declared twice, wrongly, or under a misspelt name."""

import ast
from collections.abc import Iterator
from typing import Final

from scenic.compiler import tree as scenic
from scenic.compiler.checks.places import header_span, word_span
from scenic.compiler.scopes import Resolution, ScopeKind
from scenic.compiler.traversal import walk
from scenic.language.diagnostics import Diagnostic, Label, Severity
from scenic.language.properties import CLASSES, PROPERTY_ATTRIBUTES, properties_of
from scenic.language.source import Source
from scenic.language.spelling import nearest

__all__ = ["check_declarations"]

_NEAR: Final = 2
"""A name within so many edits of a property's is taken for a slip (section 6.1)."""

_CHECKED: Final = frozenset({ast.ClassDef, scenic.New, scenic.Param, scenic.PropertyDef, scenic.Require})


def check_declarations(tree: ast.Module, source: Source, resolution: Resolution) -> Iterator[Diagnostic]:
    """SC110, SC200, SC210, SC220 and SC300 in declarations and specifiers."""
    classes = _Classes(resolution)
    for node in walk(tree):
        if node.__class__ not in _CHECKED:
            continue
        match node:
            case scenic.Param():
                yield from _duplicates(source, [(item.name, item) for item in node.items], "parameter")
            case ast.ClassDef():
                definitions = [item for item in node.body if isinstance(item, scenic.PropertyDef)]
                yield from _duplicates(source, [(item.name, item) for item in definitions], "property")
            case scenic.PropertyDef():
                yield from _property(source, node, resolution)
            case scenic.Require(probability=float() | int() as probability) if not 0 <= probability <= 1:
                yield Diagnostic(
                    "SC220",
                    f"a probability lies between 0 and 1, not {probability:g}",
                    header_span(source, node),
                    Severity.ERROR,
                    source.filename,
                    "write for example `require[0.9] condition`",
                )
            case scenic.New():
                yield from _misspelt(source, node, classes)


def _duplicates(source: Source, items: list[tuple[str, ast.AST]], what: str) -> Iterator[Diagnostic]:
    first: dict[str, ast.AST] = {}
    for name, node in items:
        if name in first:
            yield Diagnostic(
                "SC210",
                f"the {what} `{name}` is defined twice",
                word_span(source, node, name),
                Severity.ERROR,
                source.filename,
                "remove one of the definitions",
                (Label(word_span(source, first[name], name), "first defined here"),),
            )
        first.setdefault(name, node)


def _property(source: Source, node: scenic.PropertyDef, resolution: Resolution) -> Iterator[Diagnostic]:
    for attribute in node.attributes:
        if attribute not in PROPERTY_ATTRIBUTES:
            yield Diagnostic(
                "SC110",
                f"`{attribute}` is no attribute of properties",
                word_span(source, node, attribute),
                Severity.ERROR,
                source.filename,
                "use `additive`, `dynamic` or `final`",
            )
    read = {id(part.value) for part in walk(node.value) if isinstance(part, ast.Attribute)}
    for part in walk(node.value):
        if isinstance(part, ast.Name) and part.id == "self" and id(part) not in read:
            binding = resolution.binding(part)
            if binding is not None and binding.scope.kind is ScopeKind.PROPERTY:
                yield Diagnostic(
                    "SC200",
                    "`self` stands alone in the default of a property",
                    source.span(part),
                    Severity.ERROR,
                    source.filename,
                    "a default may only read other properties, as `self.name`",
                )


class _Classes:
    """The properties of the classes that the module defines, as far as the text tells."""

    def __init__(self, resolution: Resolution) -> None:
        self._resolution = resolution
        self._known: dict[ast.AST, frozenset[str] | None] = {}

    def properties(self, name: ast.expr) -> frozenset[str] | None:
        """All properties of the class that an expression names; ``None`` if they cannot be known."""
        if not isinstance(name, ast.Name):
            return None
        reference = self._resolution.references.get(name)
        if reference is None:
            return None
        if reference.binding is None:
            built_in = name.id in CLASSES and not self._resolution.wildcard
            return frozenset(properties_of(name.id)) if built_in else None
        sites = reference.binding.sites
        if len(sites) != 1 or not isinstance(sites[0], ast.ClassDef):
            return None
        return self._defined(sites[0])

    def _defined(self, node: ast.ClassDef) -> frozenset[str] | None:
        if node not in self._known:
            self._known[node] = None  # A class among its own bases: nothing is known.
            inherited = [self.properties(base) for base in node.bases] or [frozenset(properties_of("Object"))]
            names = {item.name for item in node.body if isinstance(item, scenic.PropertyDef)}
            for properties in inherited:
                if properties is None:
                    break
                names |= properties
            else:
                self._known[node] = frozenset(names)
        return self._known[node]


def _misspelt(source: Source, node: scenic.New, classes: _Classes) -> Iterator[Diagnostic]:
    known = classes.properties(node.cls)
    if known is None:
        return
    for specifier in node.specifiers:
        name = specifier.property
        if name is None or name in known:
            continue
        suggestion = nearest(name, known, limit=_NEAR)
        if suggestion is not None:
            yield Diagnostic(
                "SC300",
                f"`{node.cls.id}` has no property `{name}`, so `with` creates it",
                word_span(source, specifier, name),
                Severity.WARNING,
                source.filename,
                f"did you mean `{suggestion}`?",
            )
