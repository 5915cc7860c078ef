"""Values where types are declared: what is certainly of another kind is reported."""

import ast
import re
from bisect import bisect_left
from collections.abc import Callable, Iterable, Iterator, Sequence
from typing import Final

from scenic.compiler.checks.context import CheckContext
from scenic.compiler.scopes import Scope
from scenic.compiler.semantics.kinds import ValueKind, accepts
from scenic.compiler.traversal import position
from scenic.language.diagnostics import Diagnostic
from scenic.language.types import BEHAVIOR, COLOR, VECTOR, Type, wanted

__all__ = ["is_attempt", "may_be_meant", "wrong_kinds"]


def wrong_kinds(
    title: str | Callable[[], str], types: Sequence[Type], value: ast.expr | None, context: CheckContext
) -> Iterable[Diagnostic]:
    """Report SC404 for a value that certainly is of none of the declared types. ``title`` is quoted."""
    kind = context.kind_of(value)
    is_wrong = kind is not None and not accepts(types, kind)
    if value is None or not (is_wrong or types[0] is COLOR):
        return ()
    return _wrong(
        title if isinstance(title, str) else title(), types, value, kind if is_wrong else None, context
    )


def _wrong(
    title: str, types: Sequence[Type], value: ast.expr, kind: ValueKind | None, context: CheckContext
) -> Iterator[Diagnostic]:
    """``kind`` is ``None`` if the kind of the value is right."""
    if types[0] is COLOR and isinstance(value, ast.Tuple | ast.List):
        yield from _too_bright(title, value, context)
    if kind is None:
        return
    if context.broken and kind.name == "function" and BEHAVIOR in types:
        return  # `behaviour Go():` was read as a function.
    noun, advice = wanted(types)
    if types[0] is COLOR and isinstance(value, ast.Constant) and isinstance(value.value, str):
        yield _colour_name(title, value, value.value, context)
        return
    odd = kind.odd or (kind.items if any(each.items is not None for each in types) else None)
    lengths = {length for each in types for length in each.lengths}
    if odd is not None and (kind.size in lengths or not lengths):
        message = f"{title}: expected {noun}, and this {kind.name} has {odd.phrase} in it"
    elif types == (VECTOR,) and kind.size is not None:
        message = f"{title}: a vector has 2 or 3 coordinates, not {kind.size}"
    else:
        message = f"{title}: expected {noun}, not {kind.phrase}"
    ranges = [each for each in (value, *getattr(value, "elts", ())) if isinstance(each, ast.Call)]
    range_call = next((each for each in ranges if context.provided(each.func) == "range"), None)
    if range_call is not None and (text := context.text(range_call)) is not None:
        yield context.error(
            "SC404",
            message,
            range_call,
            f"a random number between two bounds is `Range{text[len('range') :]}`; `range` counts",
            fix=context.renaming(range_call.func, "range", "Range"),
        )
        return
    yield context.error("SC404", message, value, advice or f"give it {noun}")


_COLOURS: Final = {
    "black": "(0, 0, 0)",
    "blue": "(0, 0, 1)",
    "brown": "(0.6, 0.3, 0.1)",
    "cyan": "(0, 1, 1)",
    "gray": "(0.5, 0.5, 0.5)",
    "green": "(0, 0.5, 0)",
    "grey": "(0.5, 0.5, 0.5)",
    "magenta": "(1, 0, 1)",
    "orange": "(1, 0.65, 0)",
    "pink": "(1, 0.75, 0.8)",
    "purple": "(0.5, 0, 0.5)",
    "red": "(1, 0, 0)",
    "silver": "(0.75, 0.75, 0.75)",
    "white": "(1, 1, 1)",
    "yellow": "(1, 1, 0)",
}
"""Names of colours (CSS Color Module), as the language writes them."""
_HEXADECIMAL: Final = re.compile(r"#([0-9a-fA-F]{2})([0-9a-fA-F]{2})([0-9a-fA-F]{2})")


def _colour_name(title: str, value: ast.expr, name: str, context: CheckContext) -> Diagnostic:
    """Return SC404 for ``with color "red"``, ``with color "#ff0000"``."""
    parts = _HEXADECIMAL.fullmatch(name)
    replacement = _COLOURS.get(name.lower()) if parts is None else None
    if parts is not None:
        replacement = f"({', '.join(f'{int(part, 16) / _MOST:.3g}' for part in parts.groups())})"
    return context.error(
        "SC404",
        f"{title}: expected a colour, 3 or 4 numbers from 0 to 1, not text",
        value,
        f"write `{replacement}`"
        if replacement
        else "write red, green, blue and maybe opacity as numbers from 0 to 1, in parentheses",
        fix=context.replacement(f"Write `{replacement}`", value, replacement) if replacement else None,
    )


_MOST: Final = 255
"""The greatest part of a colour in other programs."""


def _too_bright(title: str, value: ast.Tuple | ast.List, context: CheckContext) -> Iterator[Diagnostic]:
    parts = [part.value if isinstance(part, ast.Constant) else None for part in value.elts]
    numbers = [part for part in parts if isinstance(part, int | float)]
    wrong = next(
        (
            part
            for part, number in zip(value.elts, parts, strict=True)
            if isinstance(number, int | float) and number > 1
        ),
        None,
    )
    if wrong is None or len(parts) not in COLOR.lengths:
        return
    # The opacity goes up to 1 in most programs.
    shares = [
        _divided(part, context) if number in numbers and at < len("rgb") else context.text(part) or ""
        for at, (part, number) in enumerate(zip(value.elts, parts, strict=True))
    ]
    replacement = f"({', '.join(shares)})"
    fits = max(numbers) <= _MOST and all(shares)
    yield context.error(
        "SC404",
        f"{title}: a colour is made of numbers from 0 to 1, not {context.text(wrong)}",
        wrong,
        f"divide parts that go up to {_MOST}: `{replacement}`"
        if fits
        else "write red, green, blue and maybe opacity as numbers from 0 to 1",
        fix=context.replacement(f"Write `{replacement}`", value, replacement, certain=False)
        if fits
        else None,
    )


def _divided(part: ast.expr, context: CheckContext) -> str:
    text = context.text(part) or ""
    return {"0": "0", f"{_MOST}": "1"}.get(text, f"{text} / {_MOST}")


def may_be_meant(node: ast.AST, scope: Scope, context: CheckContext) -> bool:
    """Return whether what fails may be expected to: in a function without a name, or where exceptions are caught."""
    return isinstance(scope.node, ast.Lambda) or is_attempt(node, context)


def is_attempt(node: ast.AST, context: CheckContext) -> bool:
    """Return whether exceptions are caught where a node stands."""
    attempts = context.attempts
    if not attempts:
        return False
    place = position(node)
    index = bisect_left(attempts, (place,))
    return index > 0 and place < attempts[index - 1][1]
