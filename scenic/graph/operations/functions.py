"""Functions of real numbers that programs call by name."""

import math
from collections.abc import Callable, Sequence
from typing import Any, Final

import numpy as np

from scenic.graph import intervals
from scenic.graph.bounding import overall
from scenic.graph.bounds import Bounds
from scenic.graph.kinds import Column, Kind
from scenic.graph.node import Node
from scenic.graph.operation import Call, Terms, always, stacking
from scenic.graph.operations.inverse_readings import sides
from scenic.graph.operations.possible_faults import may_be_infinite
from scenic.graph.operations.solver_readings import root_of_squares, within
from scenic.graph.quaternions import normal_angle, normalize_angle


def _periodic(function: Callable[[float], float]) -> Callable[[Call, Column], Column]:
    def batch(call: Call, angle: Column) -> Column:
        # The C library lane by lane, as Python itself: NumPy's own version depends on the machine.
        angle = angle.astype(np.float64)
        infinite = np.isinf(angle)
        if infinite.any():
            call.fault(infinite, ValueError("math domain error"))
            angle = np.where(infinite, 0.0, angle)
        values = [function(value) for value in angle.ravel().tolist()]
        return np.array(values, dtype=np.float64).reshape(angle.shape)

    return batch


def _hypot(_call: Call, *sides: Column) -> Column:
    columns = np.broadcast_arrays(*(side.astype(np.float64) for side in sides))
    lanes = zip(*(column.ravel().tolist() for column in columns), strict=True)
    return np.array([math.hypot(*values) for values in lanes], dtype=np.float64).reshape(columns[0].shape)


def _wave_bounds(peak: float) -> Callable[[Any, Bounds], Bounds]:
    """Return a function for the bounds of a wave that reaches 1 at ``peak`` (plus whole turns) and -1 half a turn later."""

    def bounds(_payload: object, angle: Bounds) -> Bounds:
        # Positions in turns since the peak; a margin covers the rounding of large angles.
        start = (angle.lower - peak) / math.tau
        end = (angle.upper - peak) / math.tau
        margin = 1e-15 * (2 + np.maximum(np.abs(start), np.abs(end)))
        start, end = start - margin, end + margin
        wide = ~(end - start < 1)
        top = wide | (np.ceil(start) <= end)
        bottom = wide | (np.ceil(start - 0.5) <= end - 0.5)
        at_start, at_end = np.cos(math.tau * start), np.cos(math.tau * end)
        slack = 1e-15 + 8 * margin
        lower = np.where(bottom, -1.0, np.maximum(np.minimum(at_start, at_end) - slack, -1.0))
        upper = np.where(top, 1.0, np.minimum(np.maximum(at_start, at_end) + slack, 1.0))
        return intervals.doubtful(Bounds(lower, upper), angle)

    return bounds


sin_bounds = _wave_bounds(math.pi / 2)
cos_bounds = _wave_bounds(0.0)


def _tan_bounds(_payload: object, angle: Bounds) -> Bounds:
    # Half turns since an asymptote: the function grows between two of them. A margin covers the rounding of large angles.
    start, end = (angle.lower / math.pi - 0.5, angle.upper / math.pi - 0.5)
    margin = 1e-15 * (2 + np.maximum(np.abs(start), np.abs(end)))
    monotone = np.floor(start - margin) == np.floor(end + margin)
    ends = intervals.relaxed(Bounds(np.tan(angle.lower), np.tan(angle.upper)), 1e-15)
    return intervals.doubtful(
        Bounds(np.where(monotone, ends.lower, -np.inf), np.where(monotone, ends.upper, np.inf)), angle
    )


def _wave_solver(terms: Terms, _payload: object, _angle: object) -> Any:
    return within(terms, -1.0, 1.0)


def length_bounds(parts: Any) -> Bounds:
    """Return the bounds of the length of a vector from those of its components."""
    length = intervals.square_root(intervals.total([intervals.square(part) for part in parts]))
    length = intervals.relaxed(length, 1e-15)
    return Bounds(np.maximum(length.lower, 0.0), length.upper)


def _normalize_bounds(_payload: object, angle: Bounds) -> Bounds:
    low, high = normalize_angle(angle.lower), normalize_angle(angle.upper)
    # Both ends moved by the same number of turns: the interval moved as a whole.
    turns = (angle.lower - low) / math.tau
    whole = (np.rint(turns) == np.rint((angle.upper - high) / math.tau)) & (angle.upper - angle.lower < 7)
    margin = 1e-15 * intervals.size(angle)
    inside = (angle.lower >= -math.pi) & (angle.upper <= math.pi)
    margin = np.where(inside, 0.0, margin)
    # A value next to the seam may, once rounded, fall on its other side.
    whole = whole & (inside | ((low - margin > -math.pi) & (high + margin < math.pi)))
    lower = np.where(whole, low - margin, -math.pi)
    upper = np.where(whole, high + margin, math.pi)
    return intervals.doubtful(Bounds(lower, upper), angle)


def _normalize_inverse(_payload: object, result: Bounds, angle: Bounds) -> list[Bounds]:
    """Return the angles within the bounds known so far that whole turns move into the result's."""
    margin = 1e-12 * (1 + intervals.size(angle))
    low, high = result.lower - margin, result.upper + margin
    first = np.ceil((angle.lower - high) / math.tau)
    last = np.floor((angle.upper - low) / math.tau)
    shifted_range = Bounds(low + math.tau * first - margin, high + math.tau * last + margin)
    inside = (angle.lower >= -math.pi) & (angle.upper <= math.pi)
    is_precise = np.isfinite(margin) & (margin < 1e-3)
    # What is at the seam may count as either end.
    return [
        Bounds(
            np.where(inside, result.lower, np.where(is_precise, shifted_range.lower, -np.inf)),
            np.where(inside, result.upper, np.where(is_precise, shifted_range.upper, np.inf)),
        )
    ]


def _normalize_solver(terms: Terms, _payload: object, angle: object) -> Any:
    angle = terms.number(angle)
    pi = terms.real(math.pi)
    result = within(terms, -math.pi, math.pi)
    terms.define(~((angle >= -pi) & (angle <= pi)) | (result == angle))
    return result


_NORMAL: Final = frozenset({"azimuth", "euler", "normalize angle", "altitude"})
"""Operations whose results are normal angles already."""


def _already_normal(operands: Sequence[Node], _payload: object) -> Node | None:
    (angle,) = operands
    if angle.kind is not Kind.SCALAR:
        return None
    if angle.operation.name in _NORMAL:
        return angle
    bounds = overall(angle)
    inside = bounds is not None and bounds.lower[0] >= -math.pi and bounds.upper[0] <= math.pi
    return angle if inside else None


OPERATIONS = (
    stacking(
        "sin",
        always(Kind.SCALAR),
        _periodic(math.sin),
        "Sine of an angle in radians.",
        python=math.sin,
        bounds=sin_bounds,
        solver=_wave_solver,
        faults=may_be_infinite,
        scalar=lambda _payload, angle: math.sin(angle),
    ),
    stacking(
        "cos",
        always(Kind.SCALAR),
        _periodic(math.cos),
        "Cosine of an angle in radians.",
        python=math.cos,
        bounds=cos_bounds,
        solver=_wave_solver,
        faults=may_be_infinite,
        scalar=lambda _payload, angle: math.cos(angle),
    ),
    stacking(
        "tan",
        always(Kind.SCALAR),
        _periodic(math.tan),
        "Tangent of an angle in radians.",
        python=math.tan,
        bounds=_tan_bounds,
        solver=lambda terms, _payload, _angle: terms.fresh(Kind.SCALAR),
        faults=may_be_infinite,
        scalar=lambda _payload, angle: math.tan(angle),
    ),
    stacking(
        "hypot",
        always(Kind.SCALAR),
        _hypot,
        "Length of a diagonal from its sides.",
        python=math.hypot,
        bounds=lambda _payload, *parts: length_bounds(parts),
        inverse=lambda _payload, result, *parts: sides(result, parts),
        solver=lambda terms, _payload, *parts: root_of_squares(terms, [terms.number(part) for part in parts]),
    ),
    stacking(
        "normalize angle",
        always(Kind.SCALAR),
        lambda _call, angle: normalize_angle(angle.astype(np.float64)),
        "The angle moved by whole turns into [-pi, pi].",
        python=lambda angle: float(normalize_angle(np.array([float(angle)]))[0]),
        bounds=_normalize_bounds,
        inverse=_normalize_inverse,
        solver=_normalize_solver,
        rewrite=_already_normal,
        scalar=lambda _payload, angle: normal_angle(float(angle)),
    ),
)

NORMALIZE_ANGLE: Final = OPERATIONS[-1]
