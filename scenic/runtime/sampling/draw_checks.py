"""Checks that the values of a scene can be drawn, labelled by the expressions of the program that may have no value."""

from collections.abc import Mapping, Sequence
from typing import Final

from scenic.graph.node import Graph, Node
from scenic.language.spans import Span
from scenic.runtime.description.outcome import Program
from scenic.runtime.program.starred_calls import chooses_element
from scenic.runtime.sampling.checks import Check, DrawingCheck
from scenic.runtime.values.values import Random, is_random

__all__ = ["called", "drawing_checks"]

_LONGEST: Final = 60
"""Characters of an expression that a label quotes."""


def drawing_checks(outputs: Sequence[Node], program: Program) -> list[Check]:
    """One check for each node that may have no value in some lane.

    Below a choice only the drawn option counts, so that there the choice itself is checked.
    """
    sources: dict[Node, None] = {}
    stack = list(outputs)[::-1]
    nodes_done: set[Node] = set()
    while stack:
        node = stack.pop()
        if node in nodes_done:
            continue
        nodes_done.add(node)
        if not node.operation.strict:
            if any(_may_mark(below) for operand in node.operands for below in Graph([operand]).nodes):
                sources[node] = None
            continue
        if _may_mark(node):
            sources[node] = None
        stack.extend(reversed(node.operands))
    owners = _owners(program) if sources else {}
    return [_check(node, program, owners) for node in sources]


def _may_mark(node: Node) -> bool:
    """Return whether a lane may fail at a node, or have no value there."""
    if node.is_constant or node.is_drawn:
        return False
    operation = node.operation
    return operation.may_fault(node.operands, node.payload, node.kind) or operation.may_reject(
        node.operands, node.payload, node.kind
    )


def _owners(program: Program) -> Mapping[Node, object]:
    """Return the first object of the program whose properties read each node."""
    owners: dict[Node, object] = {}
    for item in program.objects:
        stack = [value.node for value in vars(item).values() if isinstance(value, Random)]
        while stack:
            node = stack.pop()
            if node not in owners:
                owners[node] = item
                stack.extend(node.operands)
    return owners


def _check(node: Node, program: Program, owners: Mapping[Node, object]) -> DrawingCheck:
    """The check of a node; a node of a library's line is reported at the object whose property asks for it."""
    missing = node.operation.missing
    span = node.span if isinstance(node.span, Span) else None
    quote = None if span is None else program.context.quote(span)
    if quote is None:
        return DrawingCheck(node, missing, span)
    filename: str | None
    filename, text = quote
    expression = f"`{_shortened(text)}`"
    owner = owners.get(node)
    if owner is not None and id(owner) in program.places:
        place, file = program.places[id(owner)]
        if file != filename:
            span, filename = place, file
            expression = f"{expression} of {called(program, owner)}"
    if chooses_element(node):
        reason = f"{expression} finds nothing to choose from"
    else:
        reason = f"{expression} is missing" if missing == "value" else f"{expression} finds no {missing}"
    return DrawingCheck(node, expression, span, filename=filename, reason=reason)


def _shortened(text: str) -> str:
    """Return an expression on one line, without its middle if it is long."""
    line = " ".join(text.split())
    half = (_LONGEST - 3) // 2
    return line if len(line) <= _LONGEST else f"{line[:half]}...{line[-half:]}"


def called(program: Program, item: object, *, article: str = "") -> str:
    """Return the property `name` of an instance, else the variable that holds it, else its class after ``article``."""
    if is_random(item):
        return f"{article}random observer"
    given = getattr(item, "name", None)
    if not (isinstance(given, str) and given):
        given = program.variables.get(id(item))
    return given or article + type(item).__name__
