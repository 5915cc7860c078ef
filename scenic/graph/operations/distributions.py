"""Primitive distributions: each maps its axis of the unit cube, its first operand, to a value by inverse transform.

Every one is monotone in its axis, so that an interval of values is an interval of the axis: that is what makes exact
pruning possible.
"""

import math
from collections.abc import Callable, Sequence
from typing import Any, Final

import numpy as np

from scenic.graph import intervals
from scenic.graph.bounding import overall
from scenic.graph.bounds import Bounds, Floats, outward
from scenic.graph.construction import make_node
from scenic.graph.kinds import Column, Kind
from scenic.graph.node import Node
from scenic.graph.operation import Call, Operation, Terms, always, stacking
from scenic.graph.operations.choosing import can_give, choose, hull_of_possible, joined_kind
from scenic.graph.operations.inverse_readings import Mask, before_rounding, where
from scenic.graph.operations.normal_functions import ndtr, ndtri
from scenic.graph.operations.normal_law import conditioned_cumulative, conditioned_quantile
from scenic.graph.operations.numbers import EXACT
from scenic.graph.operations.possible_faults import is_finite
from scenic.graph.operations.solver_readings import chain, disjunction

FIRST: Final = 5e-324
LAST: Final = 1 - 2.0**-53
"""The outermost points of the open unit interval."""

_Shares = Sequence[float]
"""The cumulative shares of the options of a choice."""

_Weighted = tuple[int, _Shares]
"""The first of consecutive integers, and their cumulative shares."""

_Window = tuple[float, float]
"""The ends of a truncated distribution."""


def _range(call: Call, axis: Column, low: Column, high: Column) -> Column:
    low, high = low.astype(np.float64), high.astype(np.float64)
    endless = ~(np.isfinite(low) & np.isfinite(high))
    if endless.any():
        call.fault(endless, ValueError("the ends of a range must be finite"))
    width = high - low
    value = low + width * axis
    if not np.isfinite(width).all():
        # Ends so far apart that their distance overflows.
        value = np.where(np.isfinite(width), value, low * (1 - axis) + high * axis)
    return np.asarray(np.clip(value, np.minimum(low, high), np.maximum(low, high)))


def _normal(_call: Call, axis: Column, mean: Column, deviation: Column) -> Column:
    return np.asarray(mean + deviation * ndtri(np.ascontiguousarray(axis)))


def _truncated_normal(call: Call, axis: Column, mean: Column, deviation: Column) -> Column:
    low, high = call.payload
    mean, deviation = mean.astype(np.float64), np.abs(deviation.astype(np.float64))
    is_constant = deviation == 0
    if is_constant.any():
        impossible = is_constant & ((mean < low) | (mean > high))
        if impossible.any():
            call.fault(impossible, ValueError("a normal without deviation lies outside its window"))
    scale = np.where(is_constant, 1.0, deviation)
    z = conditioned_quantile((low - mean) / scale, (high - mean) / scale, axis)
    return np.asarray(np.clip(np.where(is_constant, mean, mean + scale * z), low, high))


def _discrete_range(call: Call, axis: Column, low: Column, high: Column) -> Column:
    first, last = np.broadcast_arrays(_rounded(call, low, np.ceil), _rounded(call, high, np.floor))
    count = last - first + 1
    call.reject(count <= 0)
    # A rounded product may reach the count itself.
    return np.asarray(first + np.minimum((axis * count).astype(np.int64), np.maximum(count, 1) - 1))


def _rounded(call: Call, end: Column, function: Callable[[Column], Column]) -> Column:
    if end.dtype != np.float64:
        return end.astype(np.int64)
    rounded = function(end)
    large = ~(np.abs(rounded) < 2.0**61)
    if large.any():
        call.fault(large, OverflowError("an end of a range of integers is too large"))
        rounded = np.where(large, 0.0, rounded)
    return np.asarray(rounded.astype(np.int64))


def _weighted_integer(call: Call, axis: Column) -> Column:
    first, cumulative = call.payload
    return np.asarray(first + _position(axis, cumulative))


def _piecewise(call: Call, axis: Column) -> Column:
    sums, edges = call.payload
    return np.asarray(np.interp(axis, sums, edges))


def _piecewise_bounds(payload: tuple[Floats, Floats], axis: Bounds) -> Bounds:
    sums, edges = payload
    ends = (np.interp(end, sums, edges) for end in (axis.lower, axis.upper))
    margin = 4 * intervals.EPSILON * max(map(abs, edges))
    first, last = ends
    return Bounds(np.maximum(first - margin, edges[0]), np.minimum(last + margin, edges[-1]))


def _choice(call: Call, axis: Column) -> Column:
    return _position(axis, call.payload)


def _position(axis: Column, cumulative: _Shares) -> Column:
    """Return the index of the option that each point of the axis draws; an option of weight zero is never drawn."""
    limits = np.asarray(cumulative, dtype=np.float64)
    found = np.searchsorted(limits, axis, side="right")
    # The last limit is 1 but for rounding; what lies above it belongs to the last option of positive weight.
    last = int(np.searchsorted(limits, limits[-1], side="left"))
    return np.minimum(found, last).astype(np.int64)


class LookupTable:
    """The values of a choice among constants of one kind: the payload of a look-up.

    Args:
        kind: their kind, none of Python objects.
        column: their rows, one after the other.

    """

    __slots__ = ("_key", "column", "kind")

    def __init__(self, kind: Kind, column: Column) -> None:
        self.kind = kind
        self.column = column
        self._key = (kind, column.tobytes())

    def __eq__(self, other: object) -> bool:
        return isinstance(other, LookupTable) and self._key == other._key

    def __hash__(self) -> int:
        return hash(self._key)

    def __repr__(self) -> str:
        return f"<table of {len(self.column)} of kind {self.kind.value}>"


def _lookup(call: Call, index: Column) -> Column:
    table: LookupTable = call.payload
    found: Column = table.column[index]
    return found


def _within(payload: LookupTable, index: Bounds) -> tuple[Bounds, Mask]:
    """Return the table's values, one a row, and which of them each box admits, ``(m, values)``."""
    places = np.arange(len(payload.column))
    mask = (index.lower[:, np.newaxis] <= places) & (places <= index.upper[:, np.newaxis])
    values = payload.column.astype(np.float64)
    is_exact = payload.kind is not Kind.INTEGER or bool((np.abs(payload.column) <= EXACT).all())
    return Bounds(values, values) if is_exact else outward(values, values), mask


def _lookup_bounds(payload: LookupTable, index: Bounds) -> Bounds:
    values, mask = _within(payload, index)
    wide = mask if values.lower.ndim == 1 else mask[..., np.newaxis]
    lower = np.where(wide, values.lower, np.inf).min(axis=1)
    upper = np.where(wide, values.upper, -np.inf).max(axis=1)
    # No value of the table in some box: bounds of nothing are for the caller to find elsewhere.
    nothing = lower > upper
    return Bounds(np.where(nothing, -np.inf, lower), np.where(nothing, np.inf, upper))


def _lookup_inverse(payload: LookupTable, result: Bounds, index: Bounds) -> list[Bounds]:
    values, mask = _within(payload, index)
    fits = (result.lower[:, np.newaxis] <= values.upper) & (values.lower <= result.upper[:, np.newaxis])
    mask = mask & (fits if fits.ndim == 2 else fits.all(axis=2))
    places = np.arange(len(payload.column), dtype=np.float64)
    return [Bounds(np.where(mask, places, np.inf).min(axis=1), np.where(mask, places, -np.inf).max(axis=1))]


def _lookup_solver(terms: Terms, payload: LookupTable, index: Any) -> Any:
    if payload.kind is Kind.BOOLEAN:
        options: list[Any] = [terms.real(float(value)) == terms.real(1) for value in payload.column]
    elif payload.column.ndim == 1:
        options = [terms.real(value) for value in payload.column.tolist()]
    else:
        options = [tuple(terms.real(float(part)) for part in value) for value in payload.column]
    return chain(terms, index, options)


LOOKUP: Final = stacking(
    "look-up",
    lambda _operands, payload: payload.kind,
    _lookup,
    "The value of a table of constants that an index draws; payload the table.",
    bounds=_lookup_bounds,
    inverse=_lookup_inverse,
    solver=_lookup_solver,
)


def _constants(operands: Sequence[Node], _payload: object) -> Node | None:
    """A choice among constants is a table, however many there are."""
    index, *options = operands
    kinds = {option.kind for option in options}
    if len(kinds) > 1 or not all(option.is_constant and not option.kind.is_boxed for option in options):
        return None
    table = LookupTable(kinds.pop(), np.concatenate([option.payload.column for option in options]))
    return make_node(LOOKUP, [index], table)


def _may_be_narrow(operands: Sequence[Node], _payload: object) -> bool:
    """Return whether a deviation may be zero."""
    bounds = overall(operands[2])
    return bounds is None or bool(bounds.lower[0] <= 0 <= bounds.upper[0])


def _is_below(bounds: Bounds | None, limit: float) -> bool:
    return bounds is not None and bool(-limit < bounds.lower[0] <= bounds.upper[0] < limit)


def _may_be_empty(operands: Sequence[Node], _payload: object) -> bool:
    """Return whether a range of integers may hold none."""
    low, high = (overall(operand) for operand in operands[1:])
    return low is None or high is None or bool(np.ceil(low.upper[0]) > np.floor(high.lower[0]))


def _select(call: Call, index: Column, *options: Column) -> Column:
    status = call.operands[0]
    is_table = all(other is None for other in call.operands[1:]) and _are_alike(call, options)
    if is_table and status is None:
        # Options that are the same in every lane: a table.
        table: Column = np.concatenate(options)
        return table[index]
    call.inherit(0, np.ones(1, dtype=np.bool_))
    if is_table:
        return np.concatenate(options)[np.where(status == 0, index, 0)]
    index = np.broadcast_to(index, (call.lanes,))
    if status is not None:
        index = np.where(status == 0, index, -1)
    return choose(call, [index == place for place in range(len(options))], options, first=1)


def _are_alike(call: Call, options: Sequence[Column]) -> bool:
    return all(kind is call.kind for kind in call.kinds[1:]) and all(len(option) == 1 for option in options)


# Bounds, inverses and terms.


def _opened(axis: Bounds) -> Bounds:
    """Bounds of an axis without the ends of the interval, which no point of the cube has."""
    return Bounds(np.maximum(axis.lower, FIRST), np.minimum(axis.upper, LAST))


def _fixed(*operands: Bounds) -> Mask:
    """Return a mask of the boxes in which every operand has a single finite value."""
    result = np.ones(1, dtype=np.bool_)
    for operand in operands:
        result = result & (operand.lower == operand.upper) & np.isfinite(operand.lower)
    return result


def _if_fixed(fixed: Mask, known: Bounds, otherwise: Bounds) -> Bounds:
    return Bounds(
        np.where(fixed, known.lower, otherwise.lower), np.where(fixed, known.upper, otherwise.upper)
    )


def _range_rounding(low: Bounds, high: Bounds) -> Floats:
    """Return the largest error that rounding may add to ``low + (high - low) * u``."""
    return 4 * intervals.EPSILON * np.maximum(intervals.size(low), intervals.size(high))


def _range_bounds(_payload: object, axis: Bounds, low: Bounds, high: Bounds) -> Bounds:
    # The value grows with either end, and runs straight from one to the other along the axis.
    bottoms = [low.lower + (high.lower - low.lower) * u for u in (axis.lower, axis.upper)]
    tops = [low.upper + (high.upper - low.upper) * u for u in (axis.lower, axis.upper)]
    margin = _range_rounding(low, high)
    line = Bounds(np.minimum(*bottoms) - margin, np.maximum(*tops) + margin)
    ends = Bounds(np.minimum(low.lower, high.lower), np.maximum(low.upper, high.upper))
    line = Bounds(
        np.where(np.isnan(line.lower), -np.inf, line.lower),
        np.where(np.isnan(line.upper), np.inf, line.upper),
    )
    return intervals.doubtful(line.meet(ends), low, high)


def _range_inverse(
    _payload: object, result: Bounds, _axis: Bounds, low: Bounds, high: Bounds
) -> list[Bounds | None]:
    exact = intervals.widened(result, _range_rounding(low, high))
    place = intervals.divide(intervals.subtract(exact, low), intervals.subtract(high, low))
    rising = high.lower >= low.upper
    falling = low.lower >= high.upper
    # Between ordered ends the place falls as either end grows, so that its extremes are at theirs.
    is_certain = rising & (exact.upper <= high.lower)
    last = np.where(is_certain, (exact.upper - low.lower) / (high.lower - low.lower), np.inf)
    is_certain = rising & (exact.lower >= low.upper)
    first = np.where(is_certain, (exact.lower - low.upper) / (high.upper - low.upper), -np.inf)
    shares = Bounds(np.where(np.isnan(first), -np.inf, first), np.where(np.isnan(last), np.inf, last))
    # At the very ends the clipped value hides where on the axis it came from by no more than rounding.
    place = intervals.widened(intervals.relaxed(place.meet(shares), 1e-15), 1e-15)
    new_low = Bounds(np.where(falling, exact.lower, -np.inf), np.where(rising, exact.upper, np.inf))
    new_high = Bounds(np.where(rising, exact.lower, -np.inf), np.where(falling, exact.upper, np.inf))
    return [place, new_low, new_high]


def _range_solver(terms: Terms, _payload: object, _axis: object, low: Any, high: Any) -> Any:
    value = terms.fresh(Kind.SCALAR)
    low, high = terms.number(low), terms.number(high)
    first, last = terms.constant(low), terms.constant(high)
    if first is None or last is None:
        inside = ((value >= low) & (value <= high)) | ((value >= high) & (value <= low))
        terms.support(inside, "lies between its ends")
        return value
    first, last = min(first, last), max(first, last)
    terms.support(value >= terms.real(first), f"is at least {first:.12g}")
    terms.support(value <= terms.real(last), f"is at most {last:.12g}")
    return value


def _normal_bounds(_payload: object, axis: Bounds, mean: Bounds, deviation: Bounds) -> Bounds:
    inside = _opened(axis)
    z = intervals.widened(intervals.relaxed(Bounds(ndtri(inside.lower), ndtri(inside.upper)), 1e-12), 1e-12)
    return intervals.add(mean, intervals.multiply(deviation, z))


def _normal_inverse(
    _payload: object, result: Bounds, axis: Bounds, mean: Bounds, deviation: Bounds
) -> list[Bounds | None]:
    shift = before_rounding(intervals.subtract(before_rounding(result), mean))
    z = intervals.widened(intervals.relaxed(intervals.divide(shift, deviation), 1e-12), 1e-12)
    # Far in the tail a probability is a few units in the last place, or rounded to nothing.
    place = outward(ndtr(z.lower) * (1 - 1e-11), ndtr(z.upper) * (1 + 1e-11), ulps=4)
    inside = _opened(axis)
    standard_normal = intervals.widened(
        intervals.relaxed(Bounds(ndtri(inside.lower), ndtri(inside.upper)), 1e-12), 1e-12
    )
    product = intervals.multiply(deviation, standard_normal)
    return [
        place,
        intervals.subtract(before_rounding(result), product),
        intervals.divide(shift, standard_normal),
    ]


def _standardised(payload: _Window, mean: Bounds, deviation: Bounds) -> tuple[Floats, Floats, Floats, Mask]:
    """The window in deviations from the mean, the deviation, and where both parameters are fixed."""
    low, high = payload
    fixed = _fixed(mean, deviation) & (deviation.lower != 0)
    scale = np.where(fixed, np.abs(deviation.lower), 1.0)
    centre = np.where(fixed, mean.lower, 0.0)
    return (low - centre) / scale, (high - centre) / scale, scale, fixed


def _truncated_bounds(payload: _Window, axis: Bounds, mean: Bounds, deviation: Bounds) -> Bounds:
    low, high = payload
    a, b, scale, fixed = _standardised(payload, mean, deviation)
    inside = _opened(axis)
    z = Bounds(conditioned_quantile(a, b, inside.lower), conditioned_quantile(a, b, inside.upper))
    z = intervals.widened(intervals.relaxed(z, 1e-11), 1e-11)
    value = intervals.add(mean, outward(z.lower * scale, z.upper * scale))
    window = Bounds(np.full_like(value.lower, low), np.full_like(value.upper, high))
    return intervals.doubtful(_if_fixed(fixed, value.meet(window), window), mean, deviation)


def _truncated_inverse(
    payload: _Window, result: Bounds, _axis: Bounds, mean: Bounds, deviation: Bounds
) -> list[Bounds | None]:
    low, high = payload
    a, b, scale, is_constant = _standardised(payload, mean, deviation)
    shift = intervals.subtract(before_rounding(result), mean)
    z = intervals.widened(intervals.relaxed(Bounds(shift.lower / scale, shift.upper / scale), 1e-11), 1e-11)
    below, above = (conditioned_cumulative(a, b, np.clip(end, a, b)) for end in (z.lower, z.upper))
    place = Bounds(below[0] - below[1], above[0] + above[1])
    # A value on the window's end may have been moved there.
    place = Bounds(
        np.where(result.lower <= low, 0.0, place.lower), np.where(result.upper >= high, 1.0, place.upper)
    )
    nothing = intervals.unbounded(place)
    return [_if_fixed(is_constant, place, nothing), None, None]


def _truncated_solver(
    terms: Terms, payload: _Window, _axis: object, _mean: object, _deviation: object
) -> Any:
    low, high = payload
    value = terms.fresh(Kind.SCALAR)
    if np.isfinite(low):
        terms.support(value >= terms.real(low), f"is at least {low:.12g}")
    if np.isfinite(high):
        terms.support(value <= terms.real(high), f"is at most {high:.12g}")
    return value


def _discrete_bounds(_payload: object, axis: Bounds, low: Bounds, high: Bounds) -> Bounds:
    ends = Bounds(np.ceil(low.lower), np.floor(high.upper))
    # An empty range rejects its lane, so that whatever is said of its value is right.
    ends = Bounds(ends.lower, np.maximum(ends.lower, ends.upper))
    fixed = _fixed(low, high)
    count = np.where(fixed, ends.upper - ends.lower + 1, 1.0)
    first, last = (np.minimum(np.floor(u * count), count - 1) for u in (axis.lower, axis.upper))
    return _if_fixed(fixed, Bounds(ends.lower + first, ends.lower + last), ends)


def _discrete_inverse(
    _payload: object, result: Bounds, _axis: Bounds, low: Bounds, high: Bounds
) -> list[Bounds | None]:
    first, last = np.ceil(low.lower), np.floor(high.upper)
    has_fixed_ends = _fixed(low, high)
    count = np.where(has_fixed_ends, last - first + 1, 1.0)
    start = (np.ceil(result.lower) - first) / count
    end = (np.floor(result.upper) - first + 1) / count
    place = intervals.relaxed(Bounds(start, end), 1e-15)
    place = Bounds(place.lower, np.where(result.upper >= last, 1.0, place.upper))
    nothing = intervals.unbounded(place)
    below = Bounds(np.full_like(result.lower, -np.inf), result.upper)
    above = Bounds(result.lower, np.full_like(result.upper, np.inf))
    return [_if_fixed(has_fixed_ends & (count > 0), place, nothing), below, above]


def _discrete_solver(terms: Terms, _payload: object, _axis: object, low: Any, high: Any) -> Any:
    value = terms.fresh(Kind.INTEGER)
    low, high = terms.number(low), terms.number(high)
    first, last = terms.constant(low), terms.constant(high)
    if first is None or last is None:
        # An empty range rejects its sample only if it is drawn at all.
        terms.support((low > high) | ((value >= low) & (value <= high)), "lies between its ends")
    elif first <= last:
        terms.support(value >= low, f"is at least {first:.12g}")
        terms.support(value <= high, f"is at most {last:.12g}")
    return value


def _position_bounds(axis: Bounds, cumulative: _Shares) -> Bounds:
    inside = _opened(axis)
    first, last = (_position(end, cumulative).astype(np.float64) for end in (inside.lower, inside.upper))
    return Bounds(first, last)


def _position_inverse(result: Bounds, cumulative: _Shares) -> Bounds:
    """Return the stretch of the axis that draws the options within ``result``; exact, since nothing is rounded."""
    limits = np.asarray(cumulative, dtype=np.float64)
    last = int(np.searchsorted(limits, limits[-1], side="left"))
    starts = np.concatenate([[0.0], limits])
    ends = np.nextafter(limits, 0.0)
    ends[last:] = 1.0
    low, high = np.ceil(result.lower), np.floor(result.upper)
    lower = starts[np.clip(low, 0, last).astype(np.intp)]
    upper = ends[np.clip(high, 0, last).astype(np.intp)]
    impossible = (low > last) | (high < 0)
    return Bounds(np.where(impossible, np.inf, lower), np.where(impossible, -np.inf, upper))


def _weighted_bounds(payload: _Weighted, axis: Bounds) -> Bounds:
    first, cumulative = payload
    place, room = _position_bounds(axis, cumulative), _room(first, cumulative)
    return Bounds(first + place.lower - room, first + place.upper + room)


def _weighted_inverse(payload: _Weighted, result: Bounds, _axis: Bounds) -> list[Bounds]:
    first, cumulative = payload
    room = _room(first, cumulative)
    place = Bounds(result.lower - first - room, result.upper - first + room)
    return [_position_inverse(place, cumulative)]


def _room(first: int, cumulative: _Shares) -> float:
    """Return the largest distance of floats from the whole numbers from ``first`` on, one for each weight."""
    most = max(abs(first), abs(first + len(cumulative)))
    return math.ulp(most) if most > EXACT else 0.0


def _weighted_solver(terms: Terms, payload: _Weighted, _axis: object) -> Any:
    first, cumulative = payload
    return _drawn(terms, first, cumulative)


def _drawn(terms: Terms, first: int, cumulative: _Shares) -> Any:
    value = terms.fresh(Kind.INTEGER)
    weights = np.diff(np.asarray(cumulative, dtype=np.float64), prepend=0.0)
    places = [first + place for place in range(len(weights)) if weights[place] > 0]
    terms.support(value >= terms.real(places[0]), f"is at least {places[0]}")
    terms.support(value <= terms.real(places[-1]), f"is at most {places[-1]}")
    for never in range(places[0], places[-1]):
        if never not in places:
            terms.support(value != terms.real(never), f"is never {never}")
    return value


def _choice_solver(terms: Terms, payload: _Shares, _axis: object) -> Any:
    value = terms.fresh(Kind.INTEGER)
    weights = np.diff(np.asarray(payload, dtype=np.float64), prepend=0.0)
    options = [value == terms.real(place) for place in range(len(weights)) if weights[place] > 0]
    terms.support(disjunction(options), "takes one of its options")
    return value


MOST_CUTS: Final = 4096
"""Values of a discrete distribution, at most, between which its axis is cut."""


def _between_options(cumulative: _Shares) -> Floats:
    # Without the index NumPy would import its masked arrays, which takes longer than the rest of a small program.
    limits, _ = np.unique(np.asarray(cumulative, dtype=np.float64), return_index=True)
    return np.asarray(limits[(limits > 0) & (limits < limits[-1])])


def _discrete_cuts(_payload: object, operands: Sequence[Node]) -> Floats | None:
    low, high = operands[1:]
    if not (low.is_constant and high.is_constant and is_finite(low) and is_finite(high)):
        return None
    count = math.floor(high.value) - math.ceil(low.value) + 1
    if not 1 < count <= MOST_CUTS:
        return None
    numbers = np.arange(1, count)
    cuts = numbers / count
    # Exactly where the rounded product of axis and count reaches the number.
    before = np.nextafter(cuts, 0.0)
    cuts = np.where(np.floor(before * count) >= numbers, before, cuts)
    return np.asarray(np.where(np.floor(cuts * count) < numbers, np.nextafter(cuts, 1.0), cuts))


def _possible(index: Bounds, count: int) -> list[Mask]:
    return [np.asarray((index.lower <= place) & (place <= index.upper)) for place in range(count)]


def _select_inverse(
    _payload: object, result: Bounds, index: Bounds, *options: Bounds | None
) -> list[Bounds | None]:
    possible = [
        mask & can_give(option, result)
        for mask, option in zip(_possible(index, len(options)), options, strict=True)
    ]
    boxes = np.broadcast_shapes(*(mask.shape for mask in possible))
    first, last = np.full(boxes, np.inf), np.full(boxes, -np.inf)
    for place, mask in enumerate(possible):
        first = np.where(mask, np.minimum(first, place), first)
        last = np.where(mask, float(place), last)
    bounds: list[Bounds | None] = [Bounds(first, last)]
    for place, option in enumerate(options):
        fits = option is not None and option.lower.shape[1:] == result.lower.shape[1:]
        bounds.append(where((first == place) & (last == place), result) if fits else None)
    return bounds


SELECT: Final = Operation(
    "select",
    lambda operands, payload: joined_kind(operands[1:], payload),
    _select,
    "The option that an index draws; only its faults and rejections count.",
    python=lambda index, *options: options[index],
    bounds=lambda _payload, index, *options: hull_of_possible(options, _possible(index, len(options))),
    inverse=_select_inverse,
    solver=lambda terms, _payload, index, *options: chain(terms, index, options),
    strict=False,
    rewrite=_constants,
)

OPERATIONS = (
    stacking(
        "range",
        always(Kind.SCALAR),
        _range,
        "A real number, uniform between two ends in either order.",
        bounds=_range_bounds,
        inverse=_range_inverse,
        solver=_range_solver,
        faults=lambda operands, _payload: not (is_finite(operands[1]) and is_finite(operands[2])),
    ),
    stacking(
        "piecewise",
        always(Kind.SCALAR),
        _piecewise,
        "A real number with a piecewise constant density; payload cumulative probabilities from 0 on, and edges.",
        bounds=_piecewise_bounds,
    ),
    stacking(
        "normal",
        always(Kind.SCALAR),
        _normal,
        "A real number of the normal law (mean, standard deviation).",
        bounds=_normal_bounds,
        inverse=_normal_inverse,
        solver=lambda terms, _payload, _axis, _mean, _deviation: terms.fresh(Kind.SCALAR),
    ),
    stacking(
        "truncated normal",
        always(Kind.SCALAR),
        _truncated_normal,
        "A real number of the normal law (mean, standard deviation) conditioned to a window, the payload.",
        bounds=_truncated_bounds,
        inverse=_truncated_inverse,
        solver=_truncated_solver,
        faults=_may_be_narrow,
    ),
    stacking(
        "discrete range",
        always(Kind.INTEGER),
        _discrete_range,
        "An integer, uniform between two ends inclusive; rejected where there is none.",
        bounds=_discrete_bounds,
        inverse=_discrete_inverse,
        solver=_discrete_solver,
        faults=lambda operands, _payload: any(
            operand.kind is Kind.SCALAR and not _is_below(overall(operand), 2.0**61)
            for operand in operands[1:]
        ),
        rejects=_may_be_empty,
        missing="whole number in the range",
        cuts=_discrete_cuts,
    ),
    stacking(
        "weighted integer",
        always(Kind.INTEGER),
        _weighted_integer,
        "An integer of given weights; payload (first, cumulative weights).",
        bounds=_weighted_bounds,
        inverse=_weighted_inverse,
        solver=_weighted_solver,
        cuts=lambda payload, _operands: _between_options(payload[1]),
    ),
    stacking(
        "choice",
        always(Kind.INTEGER),
        _choice,
        "Which option is drawn; payload cumulative weights.",
        bounds=lambda payload, axis: _position_bounds(axis, payload),
        inverse=lambda payload, result, _axis: [_position_inverse(result, payload)],
        solver=_choice_solver,
        cuts=lambda payload, _operands: _between_options(payload),
    ),
    SELECT,
    LOOKUP,
)
