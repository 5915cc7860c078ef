"""Truth: conjunction, disjunction, negation, and the conditional expression.

None but negation is strict. As in Python, operands are read from the left and only as far as needed: a fault or a
rejection of a later operand does not count in lanes that an earlier one decides.
"""

import operator
from typing import Any

import numpy as np

from scenic.graph.bounds import Bounds
from scenic.graph.kinds import Column, Kind
from scenic.graph.operation import OK, Call, Operation, Terms, always, stacking
from scenic.graph.operations.choosing import can_give, choose, hull_of_possible, joined_kind
from scenic.graph.operations.inverse_readings import certain, truth, where
from scenic.graph.operations.solver_readings import chain, conjunction, disjunction


def _all(*operands: bool) -> bool:
    return all(operands)


def _any(*operands: bool) -> bool:
    return any(operands)


def _decide(call: Call, columns: tuple[Column, ...], *, decisive: bool) -> Column:
    """The truth of operands read from the left until one is ``decisive``, or fails."""
    if all(status is None for status in call.operands):
        result = columns[0]
        for column in columns[1:]:
            result = result | column if decisive else result & column
        return result
    open_lanes = np.ones(call.shape, dtype=np.bool_)
    for position, column in enumerate(columns):
        call.inherit(position, open_lanes)
        status = call.operands[position]
        if status is not None:
            open_lanes &= status == OK
        open_lanes &= column != decisive
    return ~open_lanes if decisive else open_lanes


def _if(call: Call, test: Column, then: Column, otherwise: Column) -> Column:
    everywhere = np.ones(1, dtype=np.bool_)
    call.inherit(0, everywhere)
    status = call.operands[0]
    ready = everywhere if status is None else status == OK
    masks = [np.broadcast_to(mask, (call.lanes,)) for mask in (test & ready, ~test & ready)]
    return choose(call, masks, (then, otherwise), first=1)


def _and_bounds(_payload: object, *operands: Bounds) -> Bounds:
    result = operands[0]
    for operand in operands[1:]:
        result = Bounds(np.minimum(result.lower, operand.lower), np.minimum(result.upper, operand.upper))
    return result


def _or_bounds(_payload: object, *operands: Bounds) -> Bounds:
    result = operands[0]
    for operand in operands[1:]:
        result = Bounds(np.maximum(result.lower, operand.lower), np.maximum(result.upper, operand.upper))
    return result


def _and_inverse(_payload: object, result: Bounds, *operands: Bounds) -> list[Bounds | None]:
    """All hold where the conjunction holds; where it fails and all others hold, the last one fails.

    An operand is reached when all before it hold.
    """
    true, false = certain(result)
    bounds: list[Bounds | None] = []
    earlier = np.ones(1, dtype=np.bool_)
    for place, operand in enumerate(operands):
        alone = false & earlier
        for other in operands[place + 1 :]:
            alone = alone & (other.lower > 0)
        bounds.append(where(true | earlier, truth(true, alone)))
        earlier = earlier & (operand.lower > 0)
    return bounds


def _or_inverse(_payload: object, result: Bounds, *operands: Bounds) -> list[Bounds | None]:
    return _mirrored(_and_inverse(None, _not_bounds(None, result), *(_not_bounds(None, a) for a in operands)))


def _mirrored(narrowed: list[Bounds | None]) -> list[Bounds | None]:
    return [None if bounds is None else _not_bounds(None, bounds) for bounds in narrowed]


def _not_bounds(_payload: object, value: Bounds) -> Bounds:
    return Bounds(1 - value.upper, 1 - value.lower)


def _if_inverse(
    _payload: object, result: Bounds, test: Bounds, then: Bounds | None, otherwise: Bounds | None
) -> list[Bounds | None]:
    true, false = certain(test)
    narrowed: list[Bounds | None] = [truth(~can_give(otherwise, result), ~can_give(then, result))]
    for mask, option in ((true, then), (false, otherwise)):
        fits = option is not None and option.lower.shape[1:] == result.lower.shape[1:]
        narrowed.append(where(mask, result) if fits else None)
    return narrowed


def _if_solver(terms: Terms, _payload: object, test: object, then: object, otherwise: object) -> Any:
    return chain(terms, terms.either(test, terms.real(0), terms.real(1)), (then, otherwise))


OPERATIONS = (
    stacking(
        "and",
        always(Kind.BOOLEAN),
        lambda call, *columns: _decide(call, columns, decisive=False),
        "Whether all operands hold.",
        python=_all,
        bounds=_and_bounds,
        inverse=_and_inverse,
        solver=lambda _terms, _payload, *operands: conjunction(operands),
        strict=False,
    ),
    stacking(
        "or",
        always(Kind.BOOLEAN),
        lambda call, *columns: _decide(call, columns, decisive=True),
        "Whether any operand holds.",
        python=_any,
        bounds=_or_bounds,
        inverse=_or_inverse,
        solver=lambda _terms, _payload, *operands: disjunction(operands),
        strict=False,
    ),
    stacking(
        "not",
        always(Kind.BOOLEAN),
        lambda _call, value: ~value,
        "Whether the operand does not hold.",
        python=operator.not_,
        bounds=_not_bounds,
        inverse=lambda _payload, result, _value: [_not_bounds(None, result)],
        solver=lambda _terms, _payload, value: ~value,
    ),
    Operation(
        "if",
        lambda operands, payload: joined_kind(operands[1:], payload),
        _if,
        "The second operand where the first holds, else the third.",
        python=lambda test, then, otherwise: then if test else otherwise,
        bounds=lambda _payload, test, then, otherwise: hull_of_possible(
            (then, otherwise), (test.upper > 0, test.lower < 1)
        ),
        inverse=_if_inverse,
        solver=_if_solver,
        strict=False,
    ),
)
