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
        case "Uniform" if (text := _one_sequence(node, context)) is not None:
            yield context.warning(
                "SC407",
                "`Uniform` of one value always gives it, and this value is a list",
                node,
                f"draw one of its elements: `Uniform(*{text})`",
                fix=context.replacement(
                    f"Write `Uniform(*{text})`", node, f"Uniform(*{text})", certain=False
                ),
            )
        case "Discrete" if len(node.args) == 1 and isinstance(node.args[0], ast.List | ast.Tuple | ast.Set):
            yield _without_weights(node, context)
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


def _one_sequence(node: ast.Call, context: CheckContext) -> str | None:
    """The text of the only argument of a call, if it is certainly a list."""
    if len(node.args) != 1 or node.keywords:
        return None
    kind = context.kind_of(node.args[0])
    is_list = kind is not None and kind.name == "list"
    return context.text(node.args[0]) if is_list else None


def _without_weights(node: ast.Call, context: CheckContext) -> Diagnostic:
    text = context.text(node.args[0])
    return context.error(
        "SC404",
        "`Discrete` takes a dictionary of values and their weights, `{value: weight, ...}`",
        node.args[0],
        f"for equal weights write `Uniform(*{text or 'values'})`",
        fix=context.replacement("Write `Uniform`", node, f"Uniform({text[1:-1].rstrip(', ')})")
        if text
        else None,
    )


def _weights(node: ast.Call, context: CheckContext) -> Iterator[Diagnostic]:
    """Report SC405 for ``DiscreteRange(1, 3, [1, 2])``."""
    arguments = dict(zip(("low", "high", "weights"), node.args, strict=False))
    arguments.update((each.arg, each.value) for each in node.keywords if each.arg is not None)
    low, high = literal_number(arguments.get("low")), literal_number(arguments.get("high"))
    weights = arguments.get("weights")
    if low is None or high is None or not isinstance(weights, ast.List | ast.Tuple):
        return
    spread = any(isinstance(each, ast.Starred) for each in weights.elts)
    if spread or not all(isinstance(end, int) or end.is_integer() for end in (low, high)):
        return
    count = int(high) - int(low) + 1
    if 0 < count != len(weights.elts):
        yield context.error(
            "SC405",
            f"`DiscreteRange` from {int(low)} to {int(high)} needs {count} weights, not {len(weights.elts)}",
            weights,
            "give one weight for each integer; both ends are included",
        )


RULES: Final[dict[type[ast.AST], NodeRule]] = {ast.Call: _call}
