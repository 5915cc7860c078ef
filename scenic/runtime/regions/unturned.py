"""Readings of a turned or random rectangle in its own frame, for analysis.

Bounds of a place in a turned corridor are a box about all of it. In the corridor's frame, where many such places are drawn, they are
two numbers that do not depend on each other.
"""

from dataclasses import replace
from typing import Any

import numpy as np

from scenic.graph.kinds import Kind
from scenic.graph.node import Node
from scenic.runtime.regions.base import CONTAINS_BODY, CONTAINS_POINT, Region
from scenic.runtime.regions.knowledge import Containment
from scenic.runtime.regions.planar import Footprint
from scenic.runtime.regions.rectangular import RectangularRegion
from scenic.runtime.values.values import Random, apply, as_node, as_value, operate, vector

_UPRIGHT = "from euler"


def unturned(condition: Node) -> Node | None:
    """Derive from a rectangle's containment of a point or body that the same rectangle, unturned about the
    origin, contains it in the rectangle's frame; ``None`` for other conditions.

    It follows from the condition, up to rounding.
    """
    operation, payload = condition.operation, condition.payload
    if operation is not CONTAINS_BODY and operation is not CONTAINS_POINT:
        return None
    region = payload.region if isinstance(payload, Containment) else payload
    rectangle = region.region if isinstance(region, Footprint) else region
    if not isinstance(rectangle, RectangularRegion):
        return None
    *operands, centre, heading, width, length = condition.operands
    if centre.is_constant and heading.is_constant and heading.value == 0:
        return None
    plain: Region = RectangularRegion(vector(0, 0, 0), 0.0, as_value(width), as_value(length))
    if rectangle is not region:
        plain = plain.footprint
    turn = operate(_UPRIGHT, as_value(heading), 0.0, 0.0)
    values = [as_value(operand) for operand in operands]
    values[0] = _seen_from(operands[0], centre, turn)
    if operation is CONTAINS_BODY:
        values[1] = operate("compose", operate("inverse", turn), values[1])
        payload = replace(payload, region=plain)
    else:
        payload = plain
    result = apply(operation, *values, *plain.parameters, payload=payload)
    return result.node if isinstance(result, Random) else None


def _seen_from(place: Node, centre: Node, turn: object) -> Any:
    """A place in a frame: parts of it that were turned into the world with the frame are turned back by leaving that out."""
    terms, is_there = [], False
    for term in _terms(place):
        if not is_there and _same(term, centre):
            is_there = True
        else:
            terms.append(term)
    if not is_there and not (centre.is_constant and not centre.payload.column.any()):
        terms.append(as_node(operate("negative", as_value(centre))))
    back, rotation = operate("inverse", turn), as_node(turn)
    result: Any = vector(0, 0, 0)
    for term in terms:
        if term.operation.name == "rotate" and _same(term.operands[0], rotation):
            local_term = as_value(term.operands[1])
        elif term.is_constant and not term.payload.column[0, :2].any():
            local_term = as_value(term)
        else:
            local_term = operate("rotate", back, as_value(term))
        result = operate("add", result, local_term)
    return result


def _terms(place: Node) -> list[Node]:
    """Return the vectors of which a place is the sum."""
    if place.operation.name == "add" and place.kind is Kind.VECTOR:
        return [term for operand in place.operands for term in _terms(operand)]
    return [place]


def _same(one: Node, other: Node) -> bool:
    if one.is_constant and other.is_constant:
        return one.kind is other.kind and bool(np.array_equal(one.payload.column, other.payload.column))
    return one is other


__all__ = ["unturned"]
