"""Features of the language that this version does not build: refused where they stand."""

import ast
from collections.abc import Container, Iterator
from typing import Any, Final

from scenic.compiler import tree as scenic
from scenic.compiler.checks.blocks import in_compose
from scenic.compiler.checks.context import CheckContext
from scenic.compiler.checks.instances import missing_new
from scenic.compiler.scopes import BindingKind, Scope, ScopeKind
from scenic.compiler.traversal import position
from scenic.language.diagnostics import Diagnostic
from scenic.language.keywords import TEMPORAL_OPERATORS
from scenic.language.names import NAMES
from scenic.language.operators import OPERATORS
from scenic.language.properties import CLASSES
from scenic.language.specifiers import SPECIFIERS
from scenic.language.statements import STATEMENTS

__all__ = ["check_support", "check_supported_names"]

_STATEMENTS: Final = tuple(
    getattr(scenic, statement.node) for statement in STATEMENTS.values() if not statement.available
)
_FEATURES: Final = (scenic.Operation, scenic.SpecifierPhrase, scenic.Temporal, *_STATEMENTS)
"""The nodes that a feature can belong to, beside names."""

_INSTEAD: Final = (
    "with `Range`, `DiscreteRange`, `Uniform` or `Options` in its place the values are independent draws: "
    "no external sampler chooses them, and feedback changes nothing"
)
"""Advice on replacing external samplers, the only unsupported feature, and the difference that this makes."""
_NAMES: Final = frozenset(name.name for name in NAMES.values() if not name.available)


def _checked() -> frozenset[type[ast.AST]]:
    """Return the classes of nodes among `_FEATURES` that may have to be refused in this version."""
    tables = ((scenic.SpecifierPhrase, SPECIFIERS), (scenic.Temporal, TEMPORAL_OPERATORS))
    found = {cls for cls, table in tables if not all(each.available for each in table.values())}
    return frozenset({scenic.Operation, *_STATEMENTS, *found})


_CHECKED: Final = _checked()


def check_support(context: CheckContext, misplaced: Container[ast.AST]) -> Iterator[Diagnostic]:
    """Report SC900 for every use of a feature that is declared but not available, except in statements that are misplaced anyway.

    What only simulations run is refused when one comes to it; so may be what stands in a block whose beginning is wrong.
    """
    gaps = [node for node, _ in context.nodes(scenic.ErrorStatement)]
    for cls in _FEATURES:
        if cls not in _CHECKED:
            continue
        for node, scope in context.nodes(cls):
            if cls is scenic.Operation:
                class_name = _class_without_new(node, context)
                if class_name is not None:
                    if not _carried(node, scope):
                        yield missing_new(class_name, context, f"new {class_name.id} at ...")
                    continue
            feature = _refused(node)
            if (
                feature is not None
                and node not in misplaced
                and not _carried(node, scope)
                and not any(_within(node, gap) for gap in gaps)
            ):
                yield _refusal(feature, node, context)


def check_supported_names(context: CheckContext) -> Iterator[Diagnostic]:
    """Report SC900 for every use of a name that is declared but not available."""
    if _NAMES and not context.wildcard:
        for name in _NAMES.difference(context.resolution.names):
            for reference in context.resolution.uses.get(name, ()):
                if not _carried(reference.node, reference.scope):
                    yield _refusal(f"`{name}`", reference.node, context)


def _class_without_new(node: scenic.Operation, context: CheckContext) -> ast.Name | None:
    """Return the class in ``C at position``, which reads as the operator but can only be meant as a specifier."""
    match node:
        case scenic.Operation(operator="at", operands=[ast.Name(id=name) as cls, *_]):
            reference = context.resolution.references.get(cls)
            binding = None if reference is None else reference.binding
            is_class = name in CLASSES if binding is None else binding.kinds == {BindingKind.CLASS}
            return cls if is_class else None
    return None


def _refusal(feature: str, node: ast.AST, context: CheckContext) -> Diagnostic:
    return context.error("SC900", f"{feature} is not supported in this version", node, _INSTEAD)


def _refused(node: object) -> str | None:
    """Return the description of an unsupported element that a node uses, or ``None``."""
    match node:
        case scenic.Operation(operator=name):
            return None if OPERATORS[name].available else f"the operator `{name}`"
        case scenic.SpecifierPhrase(specifier=name):
            return None if SPECIFIERS[name].available else f"the specifier `{name}`"
        case scenic.Temporal(operator=name):
            return None if TEMPORAL_OPERATORS[name].available else f"the temporal operator `{name}`"
    statement = STATEMENTS.get(type(node).__name__)
    return None if statement is None or statement.available else f"`{statement.title}`"


def _carried(node: ast.AST, scope: Scope) -> bool:
    """Return whether a node stands in code that only simulations run."""
    for outer in scope.ancestors():
        if outer.kind in (ScopeKind.BEHAVIOR, ScopeKind.MONITOR):
            return True
        if isinstance(outer.node, scenic.ScenarioDef) and in_compose(node, outer.node):
            return True
    return False


def _within(node: object, outer: Any) -> bool:
    return position(outer) <= position(node) < (outer.end_lineno, outer.end_col_offset)
