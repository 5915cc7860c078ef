"""Trees as text for golden files: one node a line, with its place."""

import ast
from collections.abc import Iterator

COMMON = (ast.Load,)
"""What is so common that only its absence is worth a word."""

ABSENCES = frozenset({("Constant", "value", type(None)), ("ScenarioDef", "setup", list)})
"""Fields that say something when they are ``None``, or an empty list: a class, a field and the type of its value."""


def tree_text(tree: ast.AST) -> str:
    """The text of a tree; of a module, that of its statements.

    A line has the name of the field, the class of the node, its place (``line:column-line:column``, columns in
    bytes from 0) and its fields that are no nodes. Absent fields and empty lists are left out, but for the value of a
    constant and an empty set-up; so is ``ctx`` where it is ``Load``.
    """
    if isinstance(tree, ast.Module):
        return "".join(tree_text(statement) for statement in tree.body)
    return "\n".join(_lines(tree, "", 0)) + "\n"


def _lines(value: object, label: str, depth: int) -> Iterator[str]:
    start = "  " * depth + (f"{label}: " if label else "")
    if isinstance(value, ast.AST):
        place = ""
        if hasattr(value, "lineno"):
            place = f" {value.lineno}:{value.col_offset}-{value.end_lineno}:{value.end_col_offset}"
        simple, inner = [], []
        for name in value._fields:
            field = getattr(value, name, None)
            tells = (type(value).__name__, name, type(field)) in ABSENCES
            if isinstance(field, COMMON) or ((field is None or field == []) and not tells):
                continue
            if isinstance(field, ast.AST) and not field._fields:
                simple.append(f"{name}={type(field).__name__}")
            elif isinstance(field, ast.AST) or (
                isinstance(field, list) and any(isinstance(each, ast.AST) for each in field)
            ):
                inner.append((name, field))
            else:
                simple.append(f"{name}={field!r}")
        yield " ".join([f"{start}{type(value).__name__}{place}", *simple])
        for name, field in inner:
            yield from _lines(field, name, depth + 1)
    elif isinstance(value, list):
        for index, each in enumerate(value):
            yield from _lines(each, f"{label}[{index}]", depth)
    else:
        yield f"{start}{value!r}"
