"""The common ground of numeric operations: their kinds, and evaluation by Python's own functions lane by lane."""

from collections.abc import Callable, Sequence
from typing import Any, Final

import numpy as np

from scenic.graph.bounding import whole_limits
from scenic.graph.bounds import Bounds
from scenic.graph.kinds import Column, Kind
from scenic.graph.node import Node
from scenic.graph.operation import BoundsReading, Call, KindRule

EXACT: Final = 2**53
"""Integers up to this size are floats too."""


def arithmetic_kind(reading: BoundsReading) -> KindRule:
    """Numbers follow Python: a float makes a float, integers stay integers while they provably fit 64 bits."""

    def rule(operands: Sequence[Node], payload: object) -> Kind:
        kinds = [operand.kind for operand in operands]
        if not all(kind.is_number for kind in kinds):
            return Kind.OTHER
        if Kind.SCALAR in kinds:
            return Kind.SCALAR
        return Kind.INTEGER if whole_limits(reading, operands, payload) is not None else Kind.OTHER

    return rule


def where_defined(reading: BoundsReading, *vectors: tuple[bool, ...]) -> BoundsReading:
    """A bounds reading of numbers, and of vectors where those stand as in one of ``vectors``.

    Elsewhere Python does not define the operation, and nothing is known.
    """

    def bounds(payload: object, *operands: Bounds) -> Bounds | None:
        shapes = [operand.lower.shape[1:] for operand in operands]
        pattern = tuple(shape == (3,) for shape in shapes)
        if any(shapes) and (pattern not in vectors or (4,) in shapes):
            return None
        return reading(payload, *operands)

    return bounds


def as_integers(column: Column) -> Column:
    """Convert booleans to the integers that they are in Python's arithmetic; return other numbers unchanged."""
    return column.astype(np.int64) if column.dtype == np.bool_ else column


def are_exact(*columns: Column) -> bool:
    """Return whether every integer of the columns is a float too, so that mixed arithmetic loses nothing."""
    return all(column.dtype != np.int64 or bool((np.abs(column) <= EXACT).all()) for column in columns)


def fail_as_python(call: Call, mask: Column, function: Callable[..., Any], *columns: Column) -> None:
    """Let the lanes of ``mask`` fail with the exception that Python's ``function`` raises there."""
    if not mask.any():
        return
    bad, *arrays = np.broadcast_arrays(mask, *columns)
    lane = int(np.flatnonzero(bad)[0])
    try:
        function(*(array.flat[lane].item() for array in arrays))
    except ArithmeticError as error:
        call.fault(mask, error)
    else:
        raise AssertionError("Python has a value where its exception was expected")


def lane_by_lane(call: Call, function: Callable[..., Any], dtype: type[Any], *columns: Column) -> Column:
    """Python's ``function`` on the plain numbers of each lane; its exceptions are faults of the lane.

    A complex result (of a negative base and a broken exponent) is no real number and a fault as well.
    """
    arrays = np.broadcast_arrays(*columns)
    result = np.zeros(arrays[0].shape, dtype=dtype)
    faulty_lanes = np.zeros(arrays[0].shape, dtype=np.bool_)
    error: Exception | None = None
    values_of_lanes = zip(*(array.ravel().tolist() for array in arrays), strict=True)
    for lane, values in enumerate(values_of_lanes):
        try:
            value = function(*values)
            if isinstance(value, complex):
                raise TypeError("the result of a negative number to a broken power is not a real number")
            result.flat[lane] = value
        except (ArithmeticError, ValueError, TypeError) as problem:
            faulty_lanes.flat[lane] = True
            error = problem if error is None else error
    if error is not None:
        call.fault(faulty_lanes, error)
    return result
