"""Declarations of operations about their operands: whether a lane may fail or be rejected (`Operation.faults`)."""

from collections.abc import Sequence

import numpy as np

from scenic.graph.bounding import overall
from scenic.graph.node import Node


def is_finite(operand: Node) -> bool:
    """Return whether a number or vector certainly has no infinite part."""
    bounds = overall(operand)
    return bounds is not None and bool(np.isfinite(bounds.lower).all() and np.isfinite(bounds.upper).all())


def may_divide_by_zero(operands: Sequence[Node], _payload: object) -> bool:
    """Return whether the second operand may be zero."""
    bounds = overall(operands[1])
    return bounds is None or bool((bounds.lower <= 0).any() and (bounds.upper >= 0).any())


def may_be_infinite(operands: Sequence[Node], _payload: object) -> bool:
    """Return whether some operand may be infinite."""
    return not all(is_finite(operand) for operand in operands)
