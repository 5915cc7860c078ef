"""Which vectors and orientations are equal, by lanes and by bounds: all components count, and a turn has two quaternions."""

from itertools import combinations, product

import numpy as np
import pytest

from graph.programs import evaluate, make, source
from scenic.graph.bounds import Bounds
from scenic.graph.kinds import Kind
from scenic.graph.operations import TABLE

LIKE = {
    "same": lambda row: row,
    "opposite": lambda row: -row,
    **{
        f"other {place}": lambda row, place=place: np.where(
            np.arange(len(row)) == place, np.nextafter(row, 9), row
        )
        for place in range(4)
    },
}
QUATERNION = np.array([0.1, -0.5, 0.7, 0.5])


def pairs(kind):
    """Rows, others, and whether they are equal."""
    size = 3 if kind is Kind.VECTOR else 4
    row = QUATERNION[:size]
    found = []
    for name, change in LIKE.items():
        if name == "other 3" and size == 3:
            continue
        equal = name == "same" or (name == "opposite" and kind is Kind.ORIENTATION)
        found += [(row, change(row), equal), (change(row), row, equal)]
    return found


@pytest.mark.parametrize("kind", [Kind.VECTOR, Kind.ORIENTATION])
def test_lanes(kind):
    rows, others, equal = (np.array(column) for column in zip(*pairs(kind), strict=True))
    one, other = source(kind, rows), source(kind, others)
    for name, expected in (("equal", equal), ("not equal", ~equal)):
        node = make(name, one, other)
        np.testing.assert_array_equal(evaluate(node, len(rows)).full(node), expected)
        # Each lane against all others, where one side has a single lane.
        for row, other_row, is_equal in pairs(kind):
            node = make(name, source(kind, row[np.newaxis]), source(kind, other_row[np.newaxis]))
            assert bool(evaluate(node, 1).full(node)[0]) is (is_equal if name == "equal" else not is_equal)


@pytest.mark.parametrize("kind", [Kind.VECTOR, Kind.ORIENTATION])
@pytest.mark.parametrize("name", ["equal", "not equal"])
def test_bounds(kind, name):
    """What is certain of points, and of boxes that touch, holds of the values in them."""
    for row, other, equal in pairs(kind):
        known = TABLE[name].bounds(
            None, *(Bounds(each[np.newaxis], each[np.newaxis]) for each in (row, other))
        )
        truth = equal if name == "equal" else not equal
        assert known is None or known.lower[0] <= truth <= known.upper[0]
        if known is not None and kind is Kind.VECTOR:
            assert known.lower[0] == known.upper[0]


def test_sums_of_products_that_cancel_keep_their_operands():
    """A sum is rounded after each product: what it was computed of must stay possible, however far off the exact sum is."""
    numbers = [1.0, -1.0, 1e16, -1e16, 3.0, 1e8, -1e8, 0.1]
    lost = 0
    for first in combinations(numbers, 3):
        for second in product([1.0, 1e8, 0.3], repeat=3):
            a, b = np.array([first]), np.array([second])
            node = make("dot", source(Kind.VECTOR, a), source(Kind.VECTOR, b))
            result = evaluate(node, 1).full(node)
            exact = sum(np.longdouble(x) * np.longdouble(y) for x, y in zip(first, second, strict=True))
            lost += float(exact) != result[0]
            for index, part in enumerate(
                TABLE["dot"].inverse(None, Bounds(result, result), Bounds(a, a), Bounds(b, b))
            ):
                operand = (a, b)[index]
                assert (part.lower <= operand).all()
                assert (operand <= part.upper).all()
    assert lost > 50
