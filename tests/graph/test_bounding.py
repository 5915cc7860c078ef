"""What is known without sampling: of constants of every kind, of whole numbers at the limits of 64 bits, of partial operations."""

import math

import numpy as np
import pytest

from graph.programs import Triple, constant, make, source, uniform
from scenic.graph import bounding, construction
from scenic.graph import node as graph
from scenic.graph.bounds import Bounds
from scenic.graph.kinds import Kind
from scenic.graph.operation import Operation, always
from tests.each import each

LIMIT = 2**62
FREE = (-math.inf, math.inf)


def ends(bounds):
    return None if bounds is None else (bounds.lower[0].tolist(), bounds.upper[0].tolist())


def boxed(value):
    """A constant among Python's objects, as it stands where kinds are mixed."""
    return graph.constant(value, Kind.OTHER, value)


@pytest.mark.parametrize(
    ("node", "expected"),
    [
        *((make_it(value), (value, value)) for make_it in (constant, boxed) for value in (2.5, -0.5, 3, -7, 2**53, True, False)),
        *((constant(value), FREE) for value in (math.inf, -math.inf, math.nan)),
        *((boxed(value), None) for value in (math.inf, -math.inf, math.nan, LIMIT, -LIMIT, 10**400, -(10**400))),
        *((boxed(value), None) for value in ("2", None, (1.0, 2.0), [3])),
        (constant(Triple((1.0, -2.0, 3.0))), ([1, -2, 3], [1, -2, 3])),
        *((constant(Triple(row)), ([-math.inf] * 3, [math.inf] * 3)) for row in np.where(np.eye(3), math.inf, 1.0).tolist()),
        (constant(Triple((0.0, math.nan, -math.inf))), ([-math.inf] * 3, [math.inf] * 3)),
    ],
    ids=lambda part: repr(part)[:40],
)  # fmt: skip
def test_constants(node, expected):
    assert ends(bounding.of_constant(node)) == expected
    assert ends(bounding.overall(node)) == expected


@pytest.mark.parametrize("sign", [1, -1])
@pytest.mark.parametrize("make_it", [constant, boxed])
def test_whole_constants_beyond_floats_lie_within_neighbours(make_it, sign):
    for value in (2**53 + 1, 2**60 + 3, LIMIT - 1):
        low, high = ends(bounding.of_constant(make_it(sign * value)))
        assert int(low) <= sign * value <= int(high)
        assert high <= low + 4 * math.ulp(float(value))


@pytest.mark.parametrize(
    ("low", "high", "limits"),
    [
        (-0.5, 1.5, (0, 1)),
        (-7.0, 3.0, (-7, 3)),
        (2.25, 2.75, (3, 2)),
        (-(2.0**61), 2.0**61, (-(2**61), 2**61)),
        (math.nextafter(-(2.0**62), 0), math.nextafter(2.0**62, 0), (512 - LIMIT, LIMIT - 512)),
        (-(2.0**62), 0.0, None),
        (0.0, 2.0**62, None),
        (3.0, 2.0, None),
        (-math.inf, 0.0, None),
        (0.0, math.inf, None),
        (math.nan, 0.0, None),
        (0.0, math.nan, None),
    ],
)
def test_limits_of_whole_numbers(low, high, limits):
    assert bounding.limits_of(Bounds(np.array([low]), np.array([high]))) == limits


def test_only_one_number_has_limits():
    assert bounding.limits_of(None) is None
    for shape in ((1, 3), (1, 1), (2,)):
        assert bounding.limits_of(Bounds(np.zeros(shape), np.ones(shape))) is None


@each(
    [(0, 1), (-(2**53) + 1, 2**53 - 1), (-(2**53), 0), (0, 2**53), (-LIMIT + 1, -(2**60)), (2**60, LIMIT - 1)]
)
def test_whole_numbers_lie_within_their_limits(known):
    low, high = ends(bounding.overall(source(Kind.INTEGER, known)))
    assert int(low) <= known[0] <= known[1] <= int(high)
    if max(map(abs, known)) < 2**53:
        assert (low, high) == known
    else:
        assert (high - low) <= (known[1] - known[0]) * (1 + 2.0**-40)


def reading_of_first(_payload, first, _second):
    return first


@pytest.mark.parametrize(
    ("options", "expected"),
    [({}, FREE), ({"partial": True}, (2, 3)), ({"strict": False}, (2, 3)), ({"bounds": None}, FREE)],
)
def test_operations_that_need_not_know_all_operands(options, expected):
    """Beside an operand of which nothing is known, a reading is asked only if it can do without."""
    operation = Operation(
        "first",
        always(Kind.SCALAR),
        lambda call, a, b: a,
        "A test.",
        **{"bounds": reading_of_first, **options},
    )
    node = construction.make_node(operation, [uniform(2.0, 3.0), constant("word")])
    assert ends(bounding.overall(node)) == pytest.approx(expected)


def test_kinds_that_have_whole_numbers_alone_are_bounded_by_such():
    rough = Bounds(np.array([-0.5]), np.array([1.5]))
    for kind, expected in (
        (Kind.INTEGER, (0, 1)),
        (Kind.BOOLEAN, (0, 1)),
        (Kind.SCALAR, (-0.5, 1.5)),
        (Kind.OTHER, (-0.5, 1.5)),
    ):
        assert ends(bounding.integral(kind, rough)) == expected
    assert bounding.integral(Kind.INTEGER, None) is None


def test_a_drawn_number_is_any_of_its_axis():
    assert ends(bounding.overall(graph.axis())) == (0, 1)
    assert ends(bounding.overall(make("and", make("less", graph.axis(), 0.5), True))) == (0, 1)
