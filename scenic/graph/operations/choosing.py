"""Taking each lane's value from one of several columns, which may be of different kinds."""

from collections.abc import Sequence

import numpy as np

from scenic.graph.bounds import Bounds
from scenic.graph.kinds import Column, Kind, boxed, join
from scenic.graph.node import Node
from scenic.graph.operation import OK, Call


def joined_kind(operands: Sequence[Node], _payload: object) -> Kind:
    """Return the kind of a value that is one of ``operands``."""
    return join(*(operand.kind for operand in operands))


def choose(call: Call, masks: Sequence[Column], columns: Sequence[Column], *, first: int) -> Column:
    """Return the column that takes the lanes of ``masks[i]`` (all of shape ``(n,)``, disjoint) from ``columns[i]``.

    ``columns[i]`` belongs to operand ``first + i``, whose status counts in those lanes. Where the operands' kinds
    differ the result holds decoded values, so that the program sees each option as what it is.
    """
    kind = call.kind
    result = np.zeros((call.lanes, *kind.trailing), dtype=kind.dtype)
    if kind.is_boxed:
        result[:] = None
    for place, (mask, column) in enumerate(zip(masks, columns, strict=True)):
        if not mask.any():
            continue
        position = first + place
        call.inherit(position, mask)
        option = call.kinds[position]
        if option is kind:
            # A single row stays in an array: assigned bare, a list or tuple would be spread over the lanes.
            result[mask] = column[mask] if len(column) > 1 else column[:1]
            continue
        if call.codec is None:
            raise ValueError("a choice among values of different kinds needs a codec")
        status = call.operands[position]
        lanes = np.flatnonzero(mask if status is None else mask & (status == OK))
        rows = column[:1] if len(column) == 1 and len(lanes) else column[lanes]
        values = [call.codec.encode(kind, value) for value in call.codec.decode(option, rows)]
        result[lanes] = boxed(values) if kind.is_boxed else np.asarray(values).reshape(-1, *kind.trailing)
    return result


def hull_of_possible(options: Sequence[Bounds | None], possible: Sequence[Column]) -> Bounds | None:
    """Return, box by box, the bounds of a value that is one of the options that are possible.

    ``None`` where a possible option is no number or vector, or options are of different shapes.
    """
    result: Bounds | None = None
    for option, mask in zip(options, possible, strict=True):
        if not mask.any():
            continue
        if option is None or (result is not None and result.lower.shape[1:] != option.lower.shape[1:]):
            return None
        wide = mask if option.lower.ndim == 1 else mask[:, np.newaxis]
        # Where it is impossible the option is left out: empty bounds add nothing to a hull.
        part = Bounds(np.where(wide, option.lower, np.inf), np.where(wide, option.upper, -np.inf))
        result = part if result is None else result.hull(part)
    if result is not None and bool(result.empty().any()):
        # No option is possible in some box; bounds of no value are for the caller to find elsewhere.
        empty = result.lower > result.upper
        result = Bounds(np.where(empty, -np.inf, result.lower), np.where(empty, np.inf, result.upper))
    return result


def can_give(option: Bounds | None, result: Bounds) -> Column:
    """Return the mask of the boxes in which the bounds of an option and of the result have a value in common."""
    if option is None or option.lower.shape[1:] != result.lower.shape[1:]:
        return np.ones(1, dtype=np.bool_)
    return ~option.meet(result).empty()
