"""Differences between two trees."""

import ast

__all__ = ["difference"]

_PLACE = ("lineno", "col_offset", "end_lineno", "end_col_offset")


def difference(left: ast.AST, right: ast.AST, *, places: bool = False) -> str | None:
    """Describe the first difference between two trees; ``None`` if they are equal.

    Positions count if ``places``.
    """
    stack: list[tuple[str, object, object]] = [("tree", left, right)]
    while stack:
        path, one, other = stack.pop()
        if isinstance(one, ast.AST):
            if one.__class__ is not other.__class__:
                return f"{path}: {_name(one)} and {_name(other)}"
            names = (*one._fields, *one._attributes) if places else one._fields
            stack.extend(
                (f"{path}.{name}", getattr(one, name, None), getattr(other, name, None))
                for name in reversed(names)
            )
        elif isinstance(one, list):
            if not isinstance(other, list):
                return f"{path}: a list and {_name(other)}"
            if len(one) != len(other):
                return f"{path}: {len(one)} and {len(other)} elements"
            pairs = list(zip(one, other, strict=True))
            stack.extend((f"{path}[{index}]", *pairs[index]) for index in reversed(range(len(pairs))))
        elif one.__class__ is not other.__class__ or repr(one) != repr(other):
            # By their texts, since `nan` differs from itself, and `0.0` from `-0.0`.
            return f"{path}: {one!r} and {other!r}"
    return None


def _name(value: object) -> str:
    return type(value).__name__ if isinstance(value, ast.AST) else repr(value)
