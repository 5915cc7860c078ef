"""Arguments that a distribution cannot have: weights that are not numbers or too few, and empty windows."""

import ast
from collections.abc import Iterator
from typing import Final

from scenic.compiler.checks.context import Context, NodeRule
from scenic.compiler.scopes import Scope
from scenic.language.diagnostics import Diagnostic

__all__ = ["RULES"]

_NUMBERS: Final = frozenset({"number", "boolean"})


def _call(node: ast.Call, _scope: Scope, context: Context) -> Iterator[Diagnostic]:
    match context.provided(node.func):
        case "Uniform":
            for keyword in node.keywords:
                if keyword.arg is not None:
                    yield context.error(
                        "SC211",
                        f"the distribution `Uniform` has no parameter `{keyword.arg}`",
                        keyword,
                        "give weights by `Discrete({value: weight, ...})`",
                    )
        case "Discrete" | "Options" as name if node.args and isinstance(node.args[0], ast.Dict):
            for weight in node.args[0].values:
                kind = context.kind_of(weight)
                if kind is not None and kind.name not in _NUMBERS:
                    yield context.error(
                        "SC404",
                        f"`{name}`: a weight is a fixed number, not {kind.phrase}",
                        weight,
                        "write `{value: weight, ...}`",
                    )
        case "DiscreteRange":
            yield from _weights(node, context)
        case "TruncatedNormal" if len(node.args) == 4 and not node.keywords:
            low, high = map(_number, node.args[2:])
            if low is not None and high is not None and low >= high:
                yield context.error(
                    "SC405",
                    f"the window of `TruncatedNormal` is empty: {low:g} is not below {high:g}",
                    node.args[2],
                    "give the lower limit first",
                )


def _weights(node: ast.Call, context: Context) -> Iterator[Diagnostic]:
    """SC405: ``DiscreteRange(1, 3, [1, 2])``."""
    given = dict(zip(("low", "high", "weights"), node.args, strict=False))
    given.update((each.arg, each.value) for each in node.keywords if each.arg is not None)
    low, high = _number(given.get("low")), _number(given.get("high"))
    weights = given.get("weights")
    if low is None or high is None or not isinstance(weights, ast.List | ast.Tuple):
        return
    needed = int(high) - int(low) + 1
    spread = any(isinstance(each, ast.Starred) for each in weights.elts)
    if low == int(low) and high == int(high) and 0 < needed != len(weights.elts) and not spread:
        yield context.error(
            "SC405",
            f"`DiscreteRange` from {low:g} to {high:g} needs {needed} weights, not {len(weights.elts)}",
            weights,
            "give one weight for each integer; both ends are included",
        )


def _number(value: ast.expr | None) -> float | None:
    """The number that a literal is."""
    if isinstance(value, ast.UnaryOp) and isinstance(value.op, ast.USub):
        inner = _number(value.operand)
        return None if inner is None else -inner
    if isinstance(value, ast.Constant) and isinstance(value.value, int | float):
        return float(value.value) if abs(value.value) < 1e15 else None
    return None


RULES: Final[dict[type[ast.AST], NodeRule]] = {ast.Call: _call}
