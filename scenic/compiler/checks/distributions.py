"""Arguments that a distribution cannot have: weights that are not numbers or too few, and empty windows."""

import ast
from collections.abc import Iterator
from typing import Final

from scenic.compiler.checks.context import CheckContext, NodeRule
from scenic.compiler.literals import literal_number
from scenic.compiler.scopes import Scope
from scenic.compiler.semantics.kinds import NUMBERS
from scenic.language.diagnostics import Diagnostic

__all__ = ["RULES"]


def _call(node: ast.Call, _scope: Scope, context: CheckContext) -> Iterator[Diagnostic]:
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
                if kind is not None and kind.name not in NUMBERS:
                    yield context.error(
                        "SC404",
                        f"`{name}`: a weight is a fixed number, not {kind.phrase}",
                        weight,
                        "write `{value: weight, ...}`",
                    )
        case "DiscreteRange":
            yield from _weights(node, context)
        case "TruncatedNormal" if len(node.args) == 4 and not node.keywords:
            low, high = map(literal_number, node.args[2:])
            if low is not None and high is not None and low >= high:
                yield context.error(
                    "SC405",
                    f"the window of `TruncatedNormal` is empty: {low} is not below {high}",
                    node.args[2],
                    "give the lower limit first",
                )


def _weights(node: ast.Call, context: CheckContext) -> Iterator[Diagnostic]:
    """SC405: ``DiscreteRange(1, 3, [1, 2])``."""
    given = dict(zip(("low", "high", "weights"), node.args, strict=False))
    given.update((each.arg, each.value) for each in node.keywords if each.arg is not None)
    low, high = literal_number(given.get("low")), literal_number(given.get("high"))
    weights = given.get("weights")
    if low is None or high is None or not isinstance(weights, ast.List | ast.Tuple):
        return
    spread = any(isinstance(each, ast.Starred) for each in weights.elts)
    if spread or not all(isinstance(end, int) or end.is_integer() for end in (low, high)):
        return
    needed = int(high) - int(low) + 1
    if 0 < needed != len(weights.elts):
        yield context.error(
            "SC405",
            f"`DiscreteRange` from {int(low)} to {int(high)} needs {needed} weights, not {len(weights.elts)}",
            weights,
            "give one weight for each integer; both ends are included",
        )


RULES: Final[dict[type[ast.AST], NodeRule]] = {ast.Call: _call}
