"""The contexts of names, attributes, items and displays: whether they are read, assigned or deleted."""

import ast
from typing import Any, Final

from scenic.compiler.traversal import FIELDS

__all__ = ["set_contexts"]

_LOAD: Final = ast.Load()
_STORE: Final = ast.Store()
_TARGETS: Final[dict[tuple[type[ast.AST] | None, str], ast.expr_context]] = {
    (ast.Assign, "targets"): _STORE,
    (ast.AugAssign, "target"): _STORE,
    (ast.AnnAssign, "target"): _STORE,
    (ast.For, "target"): _STORE,
    (ast.AsyncFor, "target"): _STORE,
    (ast.comprehension, "target"): _STORE,
    (ast.withitem, "optional_vars"): _STORE,
    (ast.NamedExpr, "target"): _STORE,
    (getattr(ast, "TypeAlias", None), "name"): _STORE,
    (ast.Delete, "targets"): ast.Del(),
}
_HOLDERS: Final = frozenset({ast.Tuple, ast.List, ast.Starred})
"""Nodes that pass their context on to their elements."""


def set_contexts(tree: ast.AST) -> None:
    """Give every expression in a tree the context of its place.

    The parser makes targets of expressions in place. Where it tries several readings of a text with a mistake, an
    expression may be a target in one that was given up, and a value in the other.
    """
    stack: list[tuple[Any, ast.expr_context]] = [(tree, _LOAD)]
    while stack:
        node, context = stack.pop()
        kind, values = node.__class__, node.__dict__
        if "ctx" in values:
            node.ctx = context
        for field in FIELDS[kind]:
            value = values.get(field)
            inner = context if kind in _HOLDERS else _TARGETS.get((kind, field), _LOAD)
            if value.__class__ is list:
                stack += [(part, inner) for part in value if isinstance(part, ast.AST)]
            elif isinstance(value, ast.AST):
                stack.append((value, inner))
