"""Interval arithmetic: outward rounding, infinities, and the promise that finite bounds exclude NaN."""

import itertools
import math
from fractions import Fraction

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from graph.readings import CASES, Case, bounds_of, values_of
from scenic.graph import intervals
from scenic.graph.bounds import Bounds, outward
from scenic.graph.kinds import Kind
from scenic.graph.operations import TABLE
from scenic.graph.operations.choosing import hull_of_possible
from tests.each import each

numbers = st.floats(-1e6, 1e6)
ends = st.tuples(numbers, numbers).map(lambda pair: (min(pair), max(pair)))


def box(low, high):
    return Bounds(np.array([float(low)]), np.array([float(high)]))


EXACT = {
    intervals.add: lambda a, b: a + b,
    intervals.subtract: lambda a, b: a - b,
    intervals.multiply: lambda a, b: a * b,
}


@each(EXACT)
@given(ends, ends)
def test_exact_results_are_held(function, first, second):
    """The real number is within the bounds, not only its rounding."""
    result = function(box(*first), box(*second))
    corners = [EXACT[function](Fraction(a), Fraction(b)) for a in first for b in second]
    assert Fraction(float(result.lower[0])) <= min(corners)
    assert max(corners) <= Fraction(float(result.upper[0]))


def test_a_third():
    result = intervals.divide(box(1, 1), box(3, 3))
    assert Fraction(float(result.lower[0])) < Fraction(1, 3) < Fraction(float(result.upper[0]))


def test_dividing_by_what_may_be_zero_says_nothing():
    for divisor in ((0, 0), (-1, 1), (0, 5)):
        with np.errstate(all="ignore"):
            result = intervals.divide(box(1, 2), box(*divisor))
        assert (result.lower[0], result.upper[0]) == (-math.inf, math.inf)
        assert not result.empty()[0]


WILD = [(1, math.inf), (-math.inf, 2), (-math.inf, math.inf)]
TAME = [(0, 0), (-1, 2), (3, 4)]


@pytest.mark.parametrize("wild", WILD)
@pytest.mark.parametrize("tame", TAME)
def test_what_may_be_no_number_is_never_bounded(wild, tame):
    """An operand that may be infinite may be NaN, and so may the result: some end must be infinite."""
    both = (
        "add",
        "subtract",
        "multiply",
        "divide",
        "floor divide",
        "modulo",
        "power",
        "minimum",
        "maximum",
        "hypot",
    )
    for name in both:
        for operands in ((wild, tame), (tame, wild), (wild, wild)):
            with np.errstate(all="ignore"):
                result = TABLE[name].bounds(None, *(box(*operand) for operand in operands))
            assert intervals.infinite(result).all(), name
            assert not result.empty().any(), name
    for name in ("negative", "absolute", "sin", "cos", "normalize angle", "float"):
        with np.errstate(all="ignore"):
            assert intervals.infinite(TABLE[name].bounds(None, box(*wild))).all(), name


def test_comparisons_with_what_may_be_no_number_are_never_certain_to_hold():
    for name, first, second in (("less", (-math.inf, 1), (2, 3)), ("greater", (2, math.inf), (0, 1))):
        result = TABLE[name].bounds(None, box(*first), box(*second))
        assert (result.lower[0], result.upper[0]) == (0, 1)
    result = TABLE["less"].bounds(None, box(2, math.inf), box(0, 1))
    assert (result.lower[0], result.upper[0]) == (0, 0)


@given(st.floats(-30, 30), st.floats(0, 7), st.floats(0, 1))
def test_waves_hold_their_values(start, width, share):
    angle = start + width * share
    for name, function in (("sin", math.sin), ("cos", math.cos)):
        result = TABLE[name].bounds(None, box(start, start + width))
        assert result.lower[0] <= function(angle) <= result.upper[0]


def test_waves_are_tight():
    result = TABLE["sin"].bounds(None, box(0.1, 0.2))
    assert result.lower[0] == pytest.approx(math.sin(0.1), abs=1e-12)
    assert result.upper[0] == pytest.approx(math.sin(0.2), abs=1e-12)
    result = TABLE["cos"].bounds(None, box(-0.1, 0.2))
    assert result.upper[0] == 1


@given(st.floats(-50, 50), st.floats(0, 3), st.floats(0, 1))
def test_normalised_angles_hold_their_values(start, width, share):
    angle = start + width * share
    value = TABLE["normalize angle"].python(angle)
    result = TABLE["normalize angle"].bounds(None, box(start, start + width))
    assert result.lower[0] <= value <= result.upper[0]


def test_azimuths_are_tight_away_from_the_seam():
    east = Bounds(np.array([[1.0, -0.1, 0.0]]), np.array([[2.0, 0.1, 0.0]]))
    result = TABLE["azimuth"].bounds(None, east)
    assert result.lower[0] == pytest.approx(-math.pi / 2 - math.atan(0.1))
    assert result.upper[0] == pytest.approx(-math.pi / 2 + math.atan(0.1))
    south = Bounds(np.array([[-0.1, -2.0, 0.0]]), np.array([[0.1, -1.0, 0.0]]))
    result = TABLE["azimuth"].bounds(None, south)
    assert (result.lower[0], result.upper[0]) == (-math.pi, math.pi)


@each([(0.0, 1.0), (-1.0, -0.0), (-1.0, 1.0), (5e-324, 1.0), (-1.0, -1e-300)])
def test_azimuths_next_to_the_seam_hold_their_values(side):
    """Due South is half a turn one way or the other, by the sign of a zero or of what is rounded to one."""
    low, high = side
    case = Case("azimuth", (Kind.VECTOR,))
    places = [
        x for x in (low, high, 0.0, -0.0, 5e-324, -5e-324, 1e-17, -1e-17, 0.5, -0.5) if low <= x <= high
    ]
    columns = [np.array([(x, y, 1.0) for x in places for y in (-5.0, -1.0)])]
    values, fine = values_of(case, columns)
    lower, upper = bounds_of(case, columns, [((low, -5.0, 1.0), (high, -1.0, 1.0))])
    assert fine.all()
    assert ((values >= lower) & (values <= upper)).all()


def test_bounds_themselves():
    a, b = box(0, 2), box(1, 5)
    assert a.meet(b).lower[0] == 1
    assert a.hull(b).upper[0] == 5
    assert not a.empty()[0]
    assert a.meet(box(3, 4)).empty()[0]
    assert box(math.nan, 1).empty()[0]
    assert Bounds.exactly([1.0, 2.0, 3.0]).lower.shape == (1, 3)
    wide = outward(np.array([1.0]), np.array([1.0]), 2)
    assert wide.lower[0] == 1 - 2.0**-52
    assert wide.upper[0] == 1 + 2.0**-51


def test_of_no_possible_option_nothing_is_known():
    """Where no option is possible, not even bounds that exclude each other: others find out that there is no value."""
    options = [
        Bounds(np.array([1.0, 2.0]), np.array([3.0, 4.0])),
        Bounds(np.array([5.0, 6.0]), np.array([7.0, 8.0])),
    ]
    possible = [np.array([True, False]), np.array([True, False])]
    found = hull_of_possible(options, possible)
    assert found is not None
    assert found.lower.tolist() == [1.0, -np.inf]
    assert found.upper.tolist() == [7.0, np.inf]
    points = [Bounds(np.array([[1.0, 2.0, 3.0]] * 2), np.array([[2.0, 3.0, 4.0]] * 2))]
    found = hull_of_possible(points, [np.array([False, True])])
    assert found is not None
    assert found.lower.tolist() == [[-np.inf] * 3, [1.0, 2.0, 3.0]]
    assert found.upper.tolist() == [[np.inf] * 3, [2.0, 3.0, 4.0]]
    assert hull_of_possible(options, [np.array([False, False])] * 2) is None
    mixed = [Bounds.exactly(2.0), Bounds.exactly([1.0, 2.0, 3.0])]
    for order in (mixed, mixed[::-1]):  # a number or a vector
        assert hull_of_possible(order, [np.array([True])] * 2) is None
        assert hull_of_possible(order, [np.array([True]), np.array([False])]) is not None


UNTOLD = {"from euler", "from yaw", "compose", "inverse", "quaternion", "euler"}
"""Of turns that are none, their bounds do not tell: who asks for that looks at the angles."""
POINTS = {Kind.SCALAR: 0.5, Kind.VECTOR: (1.0, -2.0, 0.5), Kind.ORIENTATION: (0.6, 0.0, 0.0, 0.8)}


@each(
    [
        case
        for case in CASES
        if TABLE[case.name].bounds is not None
        and case.name not in UNTOLD
        and set(case.operands) <= POINTS.keys()
    ]
)
def test_where_nan_goes_in_no_bounds_are_finite(case):
    """Each component of each operand by itself: a result that it makes NaN may be anything."""
    rows = [np.atleast_1d(np.array(POINTS[part])) for part in case.operands]
    for operand, place, (low, high) in itertools.product(range(len(rows)), range(4), WILD):
        if case.operands[operand] is Kind.ORIENTATION or place >= len(rows[operand]):
            continue
        columns = [row[np.newaxis].copy() for row in rows]
        columns[operand][0, place] = math.nan
        ends = [[row.copy(), row.copy()] for row in rows]
        ends[operand][0][place], ends[operand][1][place] = low, high
        scalars = [part is Kind.SCALAR for part in case.operands]
        columns = [column[:, 0] if flat else column for column, flat in zip(columns, scalars, strict=True)]
        boxes = [
            (low_[0], high_[0]) if flat else (low_, high_)
            for (low_, high_), flat in zip(ends, scalars, strict=True)
        ]
        with np.errstate(all="ignore"):
            values, fine = values_of(case, columns)
        lower, upper = bounds_of(case, columns, boxes)
        if fine[0]:
            nowhere = np.isnan(values[0])
            assert not (nowhere & np.isfinite(lower) & np.isfinite(upper)).any(), (operand, place)
