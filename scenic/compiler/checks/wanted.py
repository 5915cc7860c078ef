"""Values where types are declared: what is certainly of another kind is reported."""

import ast
from collections.abc import Iterator, Sequence

from scenic.compiler.checks.context import CheckContext
from scenic.compiler.scopes import Scope
from scenic.compiler.semantics.kinds import accepts
from scenic.compiler.traversal import position
from scenic.language.diagnostics import Diagnostic
from scenic.language.types import COLOR, VECTOR, Type, wanted

__all__ = ["may_be_meant", "wrong_kinds"]


def wrong_kinds(
    title: str, types: Sequence[Type], value: ast.expr | None, context: CheckContext
) -> Iterator[Diagnostic]:
    """SC404: a value that certainly does not do where some types are declared. ``title`` is quoted."""
    kind = context.kind_of(value)
    if types[0] is COLOR and isinstance(value, ast.Tuple | ast.List):
        yield from _too_bright(title, value, context)
    if value is None or kind is None or accepts(types, kind):
        return
    noun, advice = wanted(types)
    odd = kind.odd or (kind.items if any(each.items is not None for each in types) else None)
    lengths = {length for each in types for length in each.lengths}
    if odd is not None and (kind.size in lengths or not lengths):
        message = f"{title}: expected {noun}, and this {kind.name} has {odd.phrase} in it"
    elif types == (VECTOR,) and kind.size is not None:
        message = f"{title}: a vector has 2 or 3 coordinates, not {kind.size}"
    else:
        message = f"{title}: expected {noun}, not {kind.phrase}"
    ranges = [each for each in (value, *getattr(value, "elts", ())) if isinstance(each, ast.Call)]
    counted = next((each for each in ranges if context.provided(each.func) == "range"), None)
    if counted is not None and (text := context.text(counted)) is not None:
        yield context.error(
            "SC404",
            message,
            counted,
            f"a random number between two bounds is `Range{text[len('range') :]}`; `range` counts",
            fix=context.renaming(counted.func, "range", "Range"),
        )
        return
    yield context.error("SC404", message, value, advice or f"give it {noun}")


def _too_bright(title: str, value: ast.Tuple | ast.List, context: CheckContext) -> Iterator[Diagnostic]:
    for part in value.elts:
        if isinstance(part, ast.Constant) and isinstance(part.value, int | float) and part.value > 1:
            yield context.error(
                "SC404",
                f"{title}: a colour is made of numbers from 0 to 1, not {part.value}",
                part,
                "divide parts that go up to 255: `(255 / 255, 128 / 255, 0)`",
            )
            return


def may_be_meant(node: ast.AST, scope: Scope, context: CheckContext) -> bool:
    """Return whether what fails may be expected to: in a function without a name, or where exceptions are caught."""
    if isinstance(scope.node, ast.Lambda):
        return True
    place = position(node)
    return any(
        position(attempt) < place < position(attempt.handlers[0])
        for attempt in context.nodes_around(node, ast.Try)
        if attempt.handlers
    )
