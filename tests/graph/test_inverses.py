"""What single inverse readings must find; that they lose nothing is tested for all of them in `test_readings`."""

import itertools
import math

import numpy as np
import pytest

from scenic.graph.bounds import Bounds
from scenic.graph.operations import TABLE

FREE = (-math.inf, math.inf)
TRUE, FALSE, OPEN = (1, 1), (0, 0), (0, 1)


def box(low, high):
    return Bounds(np.array([float(low)]), np.array([float(high)]))


def narrowed(name, result, *operands, payload=None):
    """Ends of each operand after intersection with what the inverse says; ``None`` where nothing is left."""
    before = [box(*operand) for operand in operands]
    with np.errstate(all="ignore"):
        parts = TABLE[name].inverse(payload, box(*result), *before)
    after = [old if part is None else old.meet(part) for old, part in zip(before, parts, strict=True)]
    return [None if item.empty()[0] else (item.lower[0], item.upper[0]) for item in after]


def near(found, *expected):
    for ends, wanted in zip(found, expected, strict=True):
        assert (ends is None) == (wanted is None)
        if ends is not None:
            assert ends == pytest.approx(wanted, rel=1e-9, abs=1e-9)


def test_powers():
    near(narrowed("power", (4, 9), (0, 10), (2, 2)), (2, 3), (2, 2))
    near(narrowed("power", (4, 9), (-10, 0), (2, 2)), (-3, -2), (2, 2))
    near(narrowed("power", (4, 9), (-10, 10), (2, 2)), (-3, 3), (2, 2))
    near(narrowed("power", (-8, 27), (-10, 10), (3, 3)), (-2, 3), (3, 3))
    near(narrowed("power", (2, 3), (-10, 100), (0.5, 0.5)), (4, 9), (0.5, 0.5))
    near(narrowed("power", (4, 9), (-10, 10), (1, 2)), (-10, 10), (1, 2))


def test_whole_results():
    near(narrowed("round", (2, 3), (0, 10)), (1.5, 3.5))
    near(narrowed("int", (2, 3), (-10, 10)), (2, 4))
    near(narrowed("int", (-3, 0), (-10, 10)), (-4, 1))
    near(narrowed("floor divide", (2, 3), (-100, 100), (5, 5)), (10, 20), (5, 5))


def test_orders():
    near(narrowed("less", TRUE, (0, 10), (-5, 5)), (0, 5), (0, 5))
    near(narrowed("less", FALSE, (0, 10), (7, 20)), (7, 10), (7, 10))
    near(narrowed("greater", TRUE, (0, 10), (7, 20)), (7, 10), (7, 10))
    near(narrowed("greater or equal", FALSE, (0, 10), (-5, 5)), (0, 5), (0, 5))
    near(narrowed("less", OPEN, (0, 10), (-5, 5)), (0, 10), (-5, 5))
    assert narrowed("less", TRUE, (3, 4), (3, 3)) == [None, None]


def test_a_failed_order_says_nothing_of_what_may_be_no_number():
    """NaN is neither less nor greater than anything."""
    assert narrowed("less", FALSE, (0, math.inf), (7, 20)) == [(0, math.inf), (7, 20)]
    assert narrowed("less", TRUE, (0, math.inf), (7, 20)) == [(0, pytest.approx(20)), (7, 20)]


@pytest.mark.parametrize("name", ["less", "less or equal", "greater", "greater or equal"])
@pytest.mark.parametrize("wild", [(7, math.inf), (-math.inf, 3), FREE])
def test_a_failed_order_with_what_may_be_no_number_on_either_side(name, wild):
    for operands in (((0, 10), wild), (wild, (0, 10))):
        assert narrowed(name, FALSE, *operands) == list(operands)


def test_equality():
    near(narrowed("equal", TRUE, (0, 10), (7, 20)), (7, 10), (7, 10))
    near(narrowed("not equal", FALSE, (0, 10), (7, 20)), (7, 10), (7, 10))
    near(narrowed("equal", FALSE, (0, 10), (7, 20)), (0, 10), (7, 20))
    near(narrowed("truth", FALSE, (-5, 5)), (0, 0))
    near(narrowed("float", (2, 3), (0, 10)), (2, 3))
    near(narrowed("positive", (2, 3), (0, 10)), (2, 3))


def test_logic():
    assert narrowed("and", TRUE, OPEN, OPEN) == [TRUE, TRUE]
    assert narrowed("and", FALSE, TRUE, OPEN) == [TRUE, FALSE]
    assert narrowed("and", FALSE, OPEN, OPEN) == [OPEN, OPEN]
    assert narrowed("or", FALSE, OPEN, OPEN) == [FALSE, FALSE]
    assert narrowed("or", TRUE, FALSE, OPEN) == [FALSE, TRUE]
    assert narrowed("or", TRUE, OPEN, OPEN) == [OPEN, OPEN]
    assert narrowed("and", TRUE, FALSE, OPEN)[0] is None


@pytest.mark.parametrize(("name", "decisive"), [("and", 0), ("or", 1)])
@pytest.mark.parametrize("count", [1, 2, 3])
def test_logic_by_brute_force(name, decisive, count):
    """Bounds and inverses are those of all values that the operands may have, of operands that are certainly evaluated."""
    for boxes in itertools.product((TRUE, FALSE, OPEN), repeat=count):
        rows = [row for row in itertools.product((0, 1), repeat=count) if all(low <= value <= high for value, (low, high) in zip(row, boxes, strict=True))]  # fmt: skip
        results = [decisive if decisive in row else 1 - decisive for row in rows]
        known = TABLE[name].bounds(None, *(box(*each) for each in boxes))
        assert (known.lower[0], known.upper[0]) == (min(results), max(results))
        for wanted in (TRUE, FALSE, OPEN):
            left = [
                row for row, result in zip(rows, results, strict=True) if wanted[0] <= result <= wanted[1]
            ]
            if not left:
                continue
            parts = TABLE[name].inverse(None, box(*wanted), *(box(*each) for each in boxes))
            for place, part in enumerate(parts):
                if np.isfinite(part.lower[0]) or np.isfinite(part.upper[0]):
                    assert all(decisive not in row[:place] for row in left)
                    met = part.meet(box(*boxes[place]))
                    values = {row[place] for row in left}
                    assert (met.lower[0], met.upper[0]) == (min(values), max(values))
                else:
                    assert any(decisive in row[:place] for row in left)


def test_operands_that_may_not_be_evaluated_are_left_unbounded():
    """By infinite ends an inverse that is not strict says that an operand may not be reached."""
    parts = TABLE["or"].inverse(None, box(*TRUE), box(*OPEN), box(*OPEN))
    assert np.isfinite(parts[0].lower).all()
    assert parts[1].lower[0] == -math.inf
    assert parts[1].upper[0] == math.inf
    parts = TABLE["if"].inverse(None, box(2, 3), box(*OPEN), box(0, 5), box(0, 5))
    assert [part.upper[0] for part in parts] == [1, math.inf, math.inf]


def test_conditionals_and_choices():
    near(narrowed("if", (2, 3), TRUE, (0, 10), (0, 10)), TRUE, (2, 3), (0, 10))
    near(narrowed("if", (2, 3), OPEN, (0, 10), (5, 10)), TRUE, (0, 10), (5, 10))
    near(narrowed("select", (2, 3), (0, 2), (0, 1), (2, 9), (8, 9)), (1, 1), (0, 1), (2, 3), (8, 9))
    near(narrowed("select", (2, 8), (0, 2), (0, 1), (2, 9), (8, 9)), (1, 2), (0, 1), (2, 9), (8, 9))
    assert narrowed("select", (50, 60), (0, 1), (0, 1), (2, 9))[0] is None


def test_options_of_which_nothing_is_known_may_give_anything():
    def ends(name, result, *operands):
        given = [None if item is None else box(*item) for item in operands]
        return [
            None if part is None else (part.lower[0], part.upper[0])
            for part in TABLE[name].inverse(None, box(*result), *given)
        ]

    unknown = None
    assert ends("select", (5, 6), (0, 2), (0, 1), unknown, (2, 9))[0] == (1, 2)
    assert ends("select", (5, 6), (0, 2), unknown, (0, 1), (2, 3))[0] == (0, 0)
    assert ends("select", (5, 6), (0, 2), (0, 1), (5, 7), unknown)[0] == (1, 2)
    assert ends("if", (5, 6), OPEN, unknown, (0, 1))[0] == TRUE
    assert ends("if", (5, 6), OPEN, (0, 1), unknown)[0] == FALSE
    assert ends("if", (5, 6), OPEN, (5, 7), unknown)[0] == OPEN
    assert ends("if", (5, 6), OPEN, unknown, (5, 7))[0] == OPEN


def test_extremes():
    near(narrowed("minimum", (2, 3), (0, 10), (0, 10)), (2, 10), (2, 10))
    near(narrowed("minimum", (2, 3), (0, 10), (5, 10)), (2, 3), (5, 10))
    near(narrowed("maximum", (2, 3), (0, 10), (0, 10)), (0, 3), (0, 3))
    near(narrowed("maximum", (7, 8), (0, 10), (0, 5)), (7, 8), (0, 5))


def test_lengths():
    near(narrowed("hypot", (0, 5), (-10, 10), (3, 3)), (-4, 4), (3, 3))
    near(narrowed("hypot", (5, 13), (0, 100), (0, 3)), (4, 13), (0, 3))
    assert narrowed("hypot", (0, 1), (2, 3), (0, 0))[0] is None


def test_draws():
    cumulative = (0.25, 0.25, 1.0)
    near(narrowed("choice", (0, 0), (0, 1), payload=cumulative), (0, 0.25))
    near(narrowed("choice", (2, 2), (0, 1), payload=cumulative), (0.25, 1))
    near(narrowed("weighted integer", (7, 7), (0, 1), payload=(5, cumulative)), (0.25, 1))
    assert narrowed("choice", (5, 6), (0, 1), payload=cumulative) == [None]
    near(narrowed("range", (2, 3), (0, 1), (0, 0), (10, 10)), (0.2, 0.3), (0, 0), (10, 10))
    near(narrowed("range", (2, 3), (0, 1), (10, 10), (0, 0)), (0.7, 0.8), (10, 10), (0, 0))
    near(narrowed("range", (2, 3), (0, 1), (0, 5), (6, 20)), (0, 0.5), (0, 3), (6, 20))
    near(narrowed("discrete range", (2, 3), (0, 1), (1, 1), (4, 4)), (0.25, 0.75), (1, 1), (4, 4))
    near(narrowed("normal", (5, 9), (0, 1), (5, 5), (2, 2)), (0.5, 0.977249868), (5, 5), (2, 2))


def test_rotations_are_equal_up_to_the_sign_of_their_quaternions():
    """So equality says nothing of components."""
    turn = np.array([[0.1, 0.2, 0.3, math.sqrt(0.86)]])
    near = 1e-3
    one, other = Bounds(turn - near, turn + near), Bounds(-turn - near, -turn + near)
    for name, result in (("equal", TRUE), ("not equal", FALSE)):
        for operands in ((one, other), (other, one), (one, one)):
            for old, part in zip(operands, TABLE[name].inverse(None, box(*result), *operands), strict=True):
                met = old if part is None else old.meet(part)
                assert (met.lower == old.lower).all()
                assert (met.upper == old.upper).all()


@pytest.mark.parametrize("name", ["minimum", "maximum"])
@pytest.mark.parametrize("wild", [(4, math.inf), (-math.inf, 4), FREE])
def test_an_extreme_says_nothing_where_a_number_may_be_none(name, wild):
    """NaN is passed over, or is the result, by where it stands: no operand is known by it."""
    for others in ([(0, 10)], [(0, 10), (2, 9)], [(0, 10), wild]):
        for place in range(len(others) + 1):
            operands = [*others[:place], wild, *others[place:]]
            assert narrowed(name, (3, 5), *operands) == operands
