"""Going through trees quickly: the parts of a node without contexts, operators and plain values."""

import ast
from collections.abc import Iterator
from typing import Final

from scenic.compiler import tree
from scenic.language.word_sets import word_set

__all__ = ["FIELDS", "first_position", "parts", "position", "walk"]

_PLAIN: Final = word_set(
    "arg attr attributes conversion ctx docstring id kind kwd_attrs level module moment op operator "
    "ops probability property rest simple simulation specifier type_comment type_ignores unit"
)
"""Fields that never hold parts, in any class of node."""


FIELDS: Final[dict[object, tuple[str, ...]]] = {
    cls: tuple(field for field in cls._fields if field not in _PLAIN)
    for cls in (*vars(ast).values(), *vars(tree).values())
    if isinstance(cls, type) and issubclass(cls, ast.AST)
}
"""The fields of each class of node that may hold parts."""


def parts(node: ast.AST) -> list[ast.AST]:
    """The nodes directly in a node, in order; no contexts and no operators of Python's."""
    nodes: list[ast.AST] = []
    values = node.__dict__
    for field in FIELDS[node.__class__]:
        value = values.get(field)
        if value.__class__ is list:
            nodes.extend([part for part in value if isinstance(part, ast.AST)])
        elif isinstance(value, ast.AST):
            nodes.append(value)
    return nodes


def walk(node: ast.AST) -> Iterator[ast.AST]:
    """A node and all nodes in it, in order, however deep."""
    stack = [node]
    while stack:
        part = stack.pop()
        yield part
        inner = parts(part)
        inner.reverse()
        stack.extend(inner)


def position(node: object) -> tuple[int, int]:
    """Return the line and column at which a node begins, for comparisons; nodes without a place come first."""
    return getattr(node, "lineno", 0), getattr(node, "col_offset", 0)


def first_position(statement: ast.stmt) -> tuple[int, int]:
    """Return the line and column at which a statement begins; a decorated definition begins with its decorators."""
    decorators = getattr(statement, "decorator_list", None)
    return position(decorators[0] if decorators else statement)
