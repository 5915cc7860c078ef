"""Conditions that are always the same, judged by their literals."""

import ast
import operator
from collections.abc import Callable, Iterator, Mapping
from types import MappingProxyType
from typing import Any, Final

from scenic.compiler import tree as scenic
from scenic.compiler.checks.arguments import required_parameters
from scenic.compiler.checks.context import CheckContext, NodeRule
from scenic.compiler.literals import literal_number
from scenic.compiler.scopes import Scope
from scenic.compiler.traversal import walk
from scenic.language.diagnostics import Diagnostic, Edit, Fix
from scenic.language.spans import Span
from scenic.language.types import INSTANCES

__all__ = ["RULES", "truth"]

_COMPARISONS: Final[Mapping[type[ast.cmpop], Callable[[Any, Any], Any]]] = MappingProxyType(
    {
        ast.Eq: operator.eq,
        ast.NotEq: operator.ne,
        ast.Lt: operator.lt,
        ast.LtE: operator.le,
        ast.Gt: operator.gt,
        ast.GtE: operator.ge,
    }
)


_ALWAYS_TRUE: Final = INSTANCES | {"vector", "orientation", "region", "workspace", "shape", "vector field"}
_TRUTH: Final = frozenset({"__bool__", "__len__"})
"""Methods by which a class of the program decides on the truth of its instances."""


def truth(condition: ast.expr) -> bool | None:
    """Return whether a condition always or never holds, by its literals alone; ``None`` if the literals do not decide it."""
    negated = False
    while isinstance(condition, ast.UnaryOp) and isinstance(condition.op, ast.Not):
        negated = not negated
        condition = condition.operand
    found = _truth(condition)
    return None if found is None else found != negated


def _truth(condition: ast.expr) -> bool | None:
    match condition:
        case ast.Constant():
            return bool(condition.value)
        case ast.Tuple() | ast.List() | ast.Set():
            if any(isinstance(item, ast.Starred) for item in condition.elts):
                return None
            return bool(condition.elts)
        case ast.BoolOp():
            # Operands that are no literals may be of any truth, so only one that decides alone tells.
            deciding = isinstance(condition.op, ast.Or)
            truths = [_simple_truth(value) for value in condition.values]
            if deciding in truths:
                return deciding
            return None if None in truths else not deciding
        case ast.Compare(left=left, ops=[op], comparators=[right]) if type(op) in _COMPARISONS:
            first, second = literal_number(left), literal_number(right)
            if first is None or second is None:
                return None
            return bool(_COMPARISONS[type(op)](first, second))
    return None


def _simple_truth(value: ast.expr) -> bool | None:
    """Return the truth of an operand that is a plain literal."""
    return bool(value.value) if isinstance(value, ast.Constant) else None


def _require(node: scenic.Require, _scope: Scope, context: CheckContext) -> Iterator[Diagnostic]:
    if node.probability not in (None, 1) and any(
        isinstance(part, scenic.Temporal) for part in walk(node.condition)
    ):
        yield context.error(
            "SC401",
            "a temporal requirement cannot have a probability",
            node,
            "leave out the probability, or the temporal operators",
        )
        return
    condition = node.condition
    while isinstance(condition, scenic.Temporal) and len(condition.operands) == 1:
        (condition,) = condition.operands
    diagnostics = list(_constant(condition, context, "requirement", literals=True))
    yield from diagnostics
    if not diagnostics and node.probability in (0, 1):
        yield from _needless_probability(node, context)


def _needless_probability(node: scenic.Require, context: CheckContext) -> Iterator[Diagnostic]:
    span = context.span(node)
    line = context.source.line(span.line)
    start, end = line.find("[", span.column), line.find("]", span.column)
    if not span.column < start < end:
        return
    place = Span(span.line, start, span.line, end + 1)
    if node.probability == 1:
        # What follows must not become a part of the word.
        blank = "" if line[end + 1 : end + 2].isspace() else " "
        fix = Fix("Remove the probability", (Edit(place, blank),))
        message, help_ = "a requirement of probability 1 is a plain requirement", "leave out the brackets"
        yield context.warning("SC306", message, place, help_, fix=fix)
    else:
        message = "a requirement of probability 0 is never enforced"
        yield context.warning("SC306", message, place, "remove it, or give it a larger probability")


def _branch(node: ast.If | ast.IfExp, _scope: Scope, context: CheckContext) -> Iterator[Diagnostic]:
    if isinstance(node, ast.If) and _makes_generator(node.body):
        return
    yield from _constant(node.test, context, "condition", literals=True)


def _loop(node: ast.While, _scope: Scope, context: CheckContext) -> Iterator[Diagnostic]:
    if _makes_generator(node.body):
        return
    if truth(node.test) is False:
        yield from _constant(node.test, context, "condition", literals=True)
    else:
        # `while True` is the way to write an endless loop.
        yield from _constant(node.test, context, "condition", literals=False)


def _makes_generator(body: list[ast.stmt]) -> bool:
    """Return whether a block holds a lone ``yield``: it may be there to make a generator of a function."""
    return len(body) == 1 and isinstance(body[0], ast.Expr) and isinstance(body[0].value, ast.Yield)


def _constant(
    condition: ast.expr, context: CheckContext, what: str, *, literals: bool
) -> Iterator[Diagnostic]:
    """Report SC306 for a condition that is known beforehand."""
    truth_value = truth(condition)
    if truth_value is not None:
        if not literals:
            return
        if isinstance(condition, ast.Tuple) and condition.elts:
            message = f"this {what} is a tuple, which is always true"
            help_ = "join the conditions with `and`"
        else:
            message = f"this {what} {'always' if truth_value else 'never'} holds"
            help_ = "remove it, or write what it depends on"
        yield context.warning("SC306", message, condition, help_)
        return
    function_name = context.provided(condition)
    kind = context.kind_of(condition) if function_name is not None else None
    if kind is not None and kind.name in ("function", "class"):
        message = f"this {what} is `{function_name}` itself, which is always true"
        yield context.warning("SC306", message, condition, f"call it: `{function_name}(...)`")
        return
    always = context.kind_of(condition) if literals else None
    if always is not None and always.name in _ALWAYS_TRUE and not _TRUTH & context.owners.keys():
        yield context.warning(
            "SC306",
            f"this {what} is {always.phrase}, which is always true",
            condition,
            "compare something: `ego.position.x > 3`, or `ego in region`",
        )
        return
    symbol = context.definition(condition)
    definition: Any = None if symbol is None else symbol.node
    if isinstance(definition, ast.FunctionDef | ast.AsyncFunctionDef):
        name = definition.name
        yield context.warning(
            "SC306",
            f"this {what} is the function `{name}` itself, which is always true",
            condition,
            f"call it: `{name}({', '.join(required_parameters(definition))})`",
            fix=None
            if required_parameters(definition)
            else context.insertion("Call the function", (condition, "()")),
        )


def _comparison(node: ast.Compare, _scope: Scope, context: CheckContext) -> Iterator[Diagnostic]:
    """Report mistakes such as ``x == x``; ``x != x`` is excepted, since it tests for a value that is not a number."""
    left = node.left
    for op, right in zip(node.ops, node.comparators, strict=False):
        if type(op) is not ast.NotEq and _same(left, right):
            always = isinstance(op, ast.Eq | ast.LtE | ast.GtE | ast.Is)
            text = context.text(left) or "a value"
            yield context.warning(
                "SC306",
                f"`{text}` is compared with itself, which {'always' if always else 'never'} holds",
                node,
                "compare it with something else",
            )
            return
        left = right


def _same(first: ast.expr, second: ast.expr) -> bool:
    """Return whether two expressions are the same name, or the same attribute of the same name."""
    while isinstance(first, ast.Attribute) and isinstance(second, ast.Attribute):
        if first.attr != second.attr:
            return False
        first, second = first.value, second.value
    return isinstance(first, ast.Name) and isinstance(second, ast.Name) and first.id == second.id


RULES: Final[dict[type[ast.AST], NodeRule]] = {
    ast.Compare: _comparison,
    ast.If: _branch,
    ast.IfExp: _branch,
    ast.While: _loop,
    scenic.Require: _require,
}
