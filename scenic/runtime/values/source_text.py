"""Values as text that a program could hold: what ``print`` shows of numbers, and of random values before they are drawn."""

from types import MappingProxyType
from typing import Any, Final

from scenic.graph.node import Node
from scenic.language.names import NAMES, NameKind

__all__ = ["plain_number", "spelled"]

_CALLS: Final = MappingProxyType(
    {declared.operation: declared for declared in NAMES.values() if declared.operation is not None}
)
"""The calls that make values, by operation of the graph."""
_INFIX: Final = MappingProxyType({"add": "+", "subtract": "-", "multiply": "*", "divide": "/", "floor divide": "//", "modulo": "%", "power": "**", "compose": "*"})  # fmt: skip
_DEPTH: Final = 4
"""Expressions within expressions that are shown; beyond, three points stand for one."""
_MOST: Final = 8
"""Options of a choice that are shown."""


def plain_number(number: float) -> str:
    """A number as a program writes it: whole ones without a point, never a negative zero."""
    return repr(number + 0.0).removesuffix(".0")


def spelled(node: Node, depth: int = _DEPTH) -> str:
    """Return the value of a node as an expression; ``<random KIND: OPERATION>`` where programs have no words for it."""
    if node.is_constant:
        return plain_number(node.value) if type(node.value) is float else repr(node.value)
    if depth == 0:
        return "..."
    name = node.operation.name
    if name == "truncated normal":
        window = ", ".join(map(plain_number, node.payload))
        return f"TruncatedNormal({_listed(node.operands[1:], depth)}, {window})"
    if name in ("look-up", "select") and node.operands[0].operation.name == "choice":
        return _choice(node, depth)
    if name in _CALLS:
        is_drawn = _CALLS[name].kind is NameKind.DISTRIBUTION  # The first operand is the draw.
        return f"{_CALLS[name].name}({_listed(node.operands[is_drawn:], depth)})"
    if name in _INFIX and len(node.operands) == 2:
        left, right = (spelled(operand, depth - 1) for operand in node.operands)
        return f"({left} {_INFIX[name]} {right})"
    return f"<random {node.kind.value}: {name}>"


def _listed(operands: Any, depth: int) -> str:
    return ", ".join(spelled(operand, depth - 1) for operand in operands)


def _choice(node: Node, depth: int) -> str:
    """Write ``Uniform`` or ``Discrete``, by the weights."""
    sums = node.operands[0].payload
    weights = [after - before for before, after in zip((0.0, *sums), sums, strict=False)]
    if node.operation.name == "select":
        options = [spelled(option, depth - 1) for option in node.operands[1 : _MOST + 1]]
    else:
        rows = node.payload.column[:_MOST].tolist()
        options = [plain_number(row) if isinstance(row, float) else repr(row) for row in rows]
    more = ["..."] if len(weights) > len(options) else []
    if max(weights) - min(weights) < 1e-9:
        return f"Uniform({', '.join([*options, *more])})"
    pairs = [f"{option}: {weight:.6g}" for option, weight in zip(options, weights, strict=False)]
    return f"Discrete({{{', '.join([*pairs, *more])}}})"
