"""Trees to texts and back."""

import ast
from typing import Any, Final

from scenic.compiler.parser import parse
from scenic.compiler.unparser import unparse

IGNORED: Final = frozenset({"lineno", "col_offset", "end_lineno", "end_col_offset", "ctx", "type_comment"})


def difference(found: Any, expected: Any) -> str | None:
    """Where two trees differ, without their places, contexts and type comments."""
    stack = [(found, expected)]
    while stack:
        left, right = stack.pop()
        if type(left) is not type(right):
            return f"{left!r} is not {right!r}"
        if isinstance(right, ast.AST):
            stack += [
                (getattr(left, field, None), getattr(right, field, None))
                for field in right._fields
                if field not in IGNORED
            ]
        elif isinstance(right, list):
            if len(left) != len(right):
                return f"{len(left)} elements are not {len(right)}"
            stack += zip(left, right, strict=True)
        elif left != right or (isinstance(right, float | complex) and repr(left) != repr(right)):
            return "two values differ"
    return None


def written_again(expected: ast.Module) -> str:
    """The text of a tree, which has to be parsed to it again, and to be written alike then."""
    text = unparse(expected)
    found = parse(text).tree
    assert difference(found, expected) is None, text
    assert unparse(found) == text
    return text
