"""Features of the language that this version does not build: refused where they stand."""

import ast
from collections.abc import Container, Iterator
from typing import Final

from scenic.compiler import tree as scenic
from scenic.compiler.checks.places import header_span
from scenic.compiler.scopes import BindingKind, Resolution
from scenic.compiler.traversal import parts
from scenic.language.diagnostics import Diagnostic, Severity
from scenic.language.keywords import TEMPORAL_OPERATORS
from scenic.language.names import NAMES
from scenic.language.operators import OPERATORS
from scenic.language.properties import CLASSES
from scenic.language.source import Source
from scenic.language.specifiers import SPECIFIERS
from scenic.language.statements import STATEMENTS
from scenic.language.support import COMPOSE_AVAILABLE

__all__ = ["check_support"]


def check_support(
    tree: ast.Module, source: Source, resolution: Resolution, misplaced: Container[ast.AST]
) -> Iterator[Diagnostic]:
    """SC900: every use of a feature that is declared but not available, but for statements that are misplaced anyway.

    The bodies of behaviors are carried as data until there are simulations, so nothing in them is refused.
    """
    stack: list[ast.AST] = [tree]
    while stack:
        node = stack.pop()
        feature = _refused(node, resolution) if node.__class__ in _CHECKED else None
        forgotten = _class_without_new(node, resolution)
        if forgotten is not None:
            yield _missing_new(forgotten, source)
        elif feature is not None and node not in misplaced:
            yield _refusal(feature, node, source)
        if isinstance(node, scenic.ScenarioDef) and node.compose and not COMPOSE_AVAILABLE:
            yield _refusal("the compose block of a scenario", node.compose[0], source)
        stack.extend(reversed(_children(node)))


def _class_without_new(node: ast.AST, resolution: Resolution) -> ast.Name | None:
    """The class in ``C at position``, which reads as the operator but can only be meant as a specifier."""
    match node:
        case scenic.Operation(operator="at", operands=[ast.Name(id=name) as cls, *_]):
            reference = resolution.references.get(cls)
            binding = None if reference is None else reference.binding
            is_class = name in CLASSES if binding is None else binding.kinds == {BindingKind.CLASS}
            return cls if is_class else None
    return None


def _missing_new(cls: ast.Name, source: Source) -> Diagnostic:
    return Diagnostic(
        "SC111",
        f"`new` is missing before `{cls.id}`",
        header_span(source, cls),
        Severity.ERROR,
        source.filename,
        f"to create an object write `new {cls.id} at ...`",
    )


def _refusal(feature: str, node: ast.AST, source: Source) -> Diagnostic:
    return Diagnostic(
        "SC900",
        f"{feature} is not supported in this version",
        header_span(source, node),
        Severity.ERROR,
        source.filename,
        "leave it out for now",
    )


def _refused(node: ast.AST, resolution: Resolution) -> str | None:
    """What the program asks for here, if it cannot have it."""
    match node:
        case scenic.Operation(operator=name) if not OPERATORS[name].available:
            return f"the operator `{name}`"
        case scenic.Specifier(specifier=name) if not SPECIFIERS[name].available:
            return f"the specifier `{name}`"
        case scenic.Temporal(operator=name) if not TEMPORAL_OPERATORS[name].available:
            return f"the temporal operator `{name}`"
        case ast.Name(id=name) if name in NAMES and not NAMES[name].available:
            reference = resolution.references.get(node)
            shadowed = reference is None or reference.binding is not None or resolution.wildcard
            return None if shadowed else f"`{name}`"
    statement = STATEMENTS.get(type(node).__name__)
    if statement is not None and not statement.available:
        return f"`{statement.title}`"
    return None


def _children(node: ast.AST) -> list[ast.AST]:
    if isinstance(node, scenic.BehaviorDef):
        return [node.args]
    if isinstance(node, scenic.MonitorDef):
        return []
    if isinstance(node, scenic.ScenarioDef) and not COMPOSE_AVAILABLE:
        return [part for part in (node.args, *(node.setup or ())) if part is not None]
    return parts(node)


_CHECKED: Final = frozenset(
    {
        ast.Name,
        scenic.Operation,
        scenic.Specifier,
        scenic.Temporal,
        *(getattr(scenic, node) for node in STATEMENTS),
    }
)
"""The nodes that a feature can belong to."""
