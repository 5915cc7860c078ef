"""Trees as text for golden files: one node a line, with its place."""

import ast
from collections.abc import Iterator

HIDDEN = (ast.expr_context,)


def tree_text(tree: ast.AST) -> str:
    """The text of a tree."""
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
            if isinstance(field, HIDDEN) or field is None or field == []:
                continue
            if isinstance(field, ast.AST) and not field._fields:
                simple.append(f"{name}={type(field).__name__}")
            elif isinstance(field, (ast.AST, list)):
                inner.append((name, field))
            else:
                simple.append(f"{name}={field!r}")
        yield " ".join([f"{start}{type(value).__name__}{place}", *simple])
        for name, field in inner:
            yield from _lines(field, name, depth + 1)
    elif isinstance(value, list):
        if not any(isinstance(each, ast.AST) for each in value):
            yield f"{start}{value!r}"
        else:
            for index, each in enumerate(value):
                yield from _lines(each, f"{label}[{index}]", depth)
    else:
        yield f"{start}{value!r}"
