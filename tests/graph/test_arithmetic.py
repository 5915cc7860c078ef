"""Numbers in batches against Python's own, over all floats and integers."""

import itertools
import math
import operator

import numpy as np
import pytest
from hypothesis import example, given, settings
from hypothesis import strategies as st

from graph.programs import Triple, constant, evaluate, is_fine, make, source
from scenic.graph.kinds import Kind
from scenic.graph.node import Graph
from scenic.graph.operations import TABLE
from tests.each import each

floats = st.one_of(
    st.floats(),
    st.floats(-100, 100),
    st.integers(-50, 50).map(float),
    st.sampled_from([0.0, -0.0, math.inf, -math.inf, math.nan, 5e-324, 2.0**53, 1e308]),
)
small = st.integers(-1000, 1000)
integers = st.one_of(small, st.integers(-(2**62) + 1, 2**62 - 1))
quick = settings(max_examples=40, deadline=None)
BINARY = ("add", "subtract", "multiply", "divide", "floor divide", "modulo", "power")
COMPARISONS = ("less", "less or equal", "greater", "greater or equal", "equal", "not equal")
UNARY = ("negative", "positive", "absolute", "round", "int", "float", "truth")


def check(name, *columns):
    """Every lane has Python's result, of Python's type, or fails with Python's exception."""
    kinds = {float: Kind.SCALAR, int: Kind.INTEGER, bool: Kind.BOOLEAN}
    lanes = len(columns[0])
    node = make(name, *(source(kinds[type(column[0])], column) for column in columns))
    batch = evaluate(node, lanes)
    fine = is_fine(batch, node)
    for lane in range(lanes):
        values = [column[lane] for column in columns]
        try:
            expected = TABLE[name].python(*values)
        except (ArithmeticError, ValueError) as error:
            expected = error
        if isinstance(expected, Exception):
            assert not fine[lane]
            single = make(name, *(source(kinds[type(v)], [v]) for v in values))
            alone = evaluate(single, 1)
            assert alone.status(single) == 1
            assert type(alone.errors[single]) is type(expected)
            continue
        if isinstance(expected, complex):
            assert not fine[lane]
            continue
        assert fine[lane]
        found = batch.value(node, lane)
        assert (repr(found), type(found)) == (repr(expected), type(expected))


@each(BINARY + COMPARISONS)
@quick
@given(st.lists(st.tuples(floats, floats), min_size=1, max_size=9))
@example(
    [(-0.0, 3.0), (0.0, -3.0), (-1e-20, 1.0), (math.inf, 2.0), (5.0, math.inf), (-8.0, 0.5), (0.0, -1.0)]
)
def test_floats(name, pairs):
    check(name, *(list(column) for column in zip(*pairs, strict=True)))


@each([*BINARY[:-1], *COMPARISONS])
@quick
@given(st.lists(st.tuples(integers, integers), min_size=1, max_size=9))
@example([(2**53 + 1, 3), (7, -2), (-7, 2), (5, 0)])
@example([(2**62 - 1, 2**62 - 1)])
def test_integers(name, pairs):
    check(name, *(list(column) for column in zip(*pairs, strict=True)))


@each([*BINARY, *COMPARISONS])
@quick
@given(st.lists(st.tuples(small, floats), min_size=1, max_size=5))
def test_an_integer_and_a_float(name, pairs):
    first, second = (list(column) for column in zip(*pairs, strict=True))
    check(name, first, second)
    check(name, second, first)


@each(COMPARISONS)
@quick
@given(st.lists(st.tuples(integers, integers.map(float)), min_size=1, max_size=5))
@example([(2**53 + 1, float(2**53))])
def test_large_integers_are_compared_with_floats_exactly(name, pairs):
    check(name, *(list(column) for column in zip(*pairs, strict=True)))


@quick
@given(st.lists(st.tuples(st.integers(-30, 30), st.integers(-3, 40)), min_size=1, max_size=5))
def test_integer_powers(pairs):
    check("power", *(list(column) for column in zip(*pairs, strict=True)))


@each(UNARY)
@quick
@given(
    st.lists(
        st.one_of(st.floats(-1e6, 1e6), st.sampled_from([0.5, 1.5, 2.5, -0.5, -0.0])), min_size=1, max_size=9
    )
)
def test_functions_of_a_float(name, values):
    check(name, values)


@pytest.mark.parametrize("name", ["round", "int"])
def test_no_integer_of_what_is_not_finite(name):
    check(name, [math.inf, 1.5, math.nan])


def test_halves_are_rounded_to_even():
    halves = [half / 2 for half in range(-9, 10)]
    near = [math.nextafter(half, way) for half in halves for way in (-math.inf, math.inf)]
    for name in ("round", "int"):
        check(name, halves + near)
        # Numbers that are known not to be large are rounded as columns.
        node = make(name, make("divide", source(Kind.INTEGER, range(-9, 10)), 2.0))
        assert node.kind is Kind.INTEGER
        assert evaluate(node, 19).full(node).tolist() == [TABLE[name].python(half) for half in halves]
    for digits in (-1, 0, 1):
        check("round", [*halves, *near, 15.0, 25.0, 0.25, 0.35], [digits] * (len(halves) + len(near) + 4))


@quick
@given(st.lists(floats, min_size=1, max_size=9), st.integers(-3, 8))
def test_rounding_to_digits(values, digits):
    check("round", values, [digits] * len(values))


@pytest.mark.parametrize("name", ["minimum", "maximum"])
@quick
@given(st.lists(st.tuples(floats, floats, floats), min_size=1, max_size=9))
@example([(0.0, -0.0, 0.0), (-0.0, 0.0, 0.0), (math.nan, 1.0, 2.0), (1.0, math.nan, 0.0)])
def test_extremes(name, triples):
    check(name, *(list(column) for column in zip(*triples, strict=True)))


@pytest.mark.parametrize("name", ["sin", "cos"])
@quick
@given(st.lists(floats, min_size=1, max_size=9))
def test_waves(name, values):
    check(name, values)


@quick
@given(st.lists(st.tuples(floats, floats), min_size=1, max_size=9))
def test_hypot(pairs):
    check("hypot", *(list(column) for column in zip(*pairs, strict=True)))


def test_integers_stay_integers_while_they_fit():
    """The kind follows the limits of the operands; beyond 62 bits Python's own integers take over, exactly."""
    node = source(Kind.INTEGER, [3, -5, 7])
    for _ in range(20):
        assert node.kind in (Kind.INTEGER, Kind.OTHER)
        node = make("multiply", node, 10)
    assert node.kind is Kind.OTHER
    batch = evaluate(node, 3)
    assert [batch.value(node, lane) for lane in range(3)] == [3 * 10**20, -5 * 10**20, 7 * 10**20]


def test_limits_are_exact_for_chains_of_whole_numbers():
    node = source(Kind.INTEGER, [0, 10])
    for _ in range(50):
        node = make("add", node, 1)
    assert node.limits == (50, 60)
    assert make("power", node, 2).limits == (2500, 3600)
    assert make("floor divide", node, 7).limits == (7, 8)
    assert make("int", make("divide", node, 4)).limits == (12, 15)


@pytest.mark.parametrize(
    ("exponents", "kind"),
    [
        ([0], Kind.INTEGER),
        ([0, 3], Kind.INTEGER),
        ([-1], Kind.SCALAR),
        ([-3, -1], Kind.SCALAR),
        ([-1, 0], Kind.OTHER),
        ([-1, 2], Kind.OTHER),
        ([3, 40], Kind.OTHER),
    ],
)
def test_powers_of_integers_are_of_the_kind_that_their_exponents_say(exponents, kind):
    """A negative exponent gives a float; what may be one or the other, or too large, is Python's own."""
    node = make("power", source(Kind.INTEGER, [3] * len(exponents)), source(Kind.INTEGER, exponents))
    assert node.kind is kind
    batch = evaluate(node, len(exponents))
    assert [batch.value(node, lane) for lane in range(len(exponents))] == [3**power for power in exponents]
    found = [type(batch.value(node, lane)) for lane in range(len(exponents))]
    assert found == [type(3**power) for power in exponents]


def test_a_float_of_unknown_size_gives_no_machine_integer():
    wild = make("divide", 1.0, make("subtract", source(Kind.SCALAR, [0.5]), 0.5))
    assert make("round", wild).kind is Kind.OTHER
    assert make("round", make("range", source(Kind.SCALAR, [0.5]), 0.0, 9.0)).kind is Kind.INTEGER


def test_truth_values_count_as_integers():
    truth = source(Kind.BOOLEAN, [True, False])
    node = make("add", truth, truth)
    assert node.kind is Kind.INTEGER
    assert evaluate(node, 2).column(node).tolist() == [2, 0]


@pytest.mark.parametrize(("name", "function"), [("add", operator.add), ("subtract", operator.sub)])
def test_vectors_add_by_components(name, function):
    a, b = np.arange(6.0).reshape(2, 3), np.array([[0.5, -1.0, 2.0], [3.0, 1e-3, -7.0]])
    node = make(name, source(Kind.VECTOR, a), source(Kind.VECTOR, b))
    assert node.kind is Kind.VECTOR
    assert (evaluate(node, 2).column(node) == function(a, b)).all()


def test_vectors_are_scaled_by_numbers():
    vectors, numbers = np.arange(6.0).reshape(2, 3), np.array([2.0, -3.0])
    for operands in ((vectors, numbers), (numbers, vectors)):
        kinds = [Kind.VECTOR if len(part.shape) == 2 else Kind.SCALAR for part in operands]
        node = make("multiply", *(source(kind, part) for kind, part in zip(kinds, operands, strict=True)))
        assert (evaluate(node, 2).column(node) == vectors * numbers[:, None]).all()
    quotient = make("divide", source(Kind.VECTOR, vectors), source(Kind.SCALAR, [0.0, 4.0]))
    batch = evaluate(quotient, 2)
    assert batch.status(quotient).tolist() == [1, 0]
    assert (batch.column(quotient)[1] == vectors[1] / 4).all()


def test_a_vector_plus_a_number_fails_as_in_python():
    node = make("add", source(Kind.VECTOR, [[1.0, 2.0, 3.0]]), 1.0)
    batch = evaluate(node, 1)
    assert node.kind is Kind.OTHER
    assert batch.status(node).tolist() == [1]
    assert isinstance(batch.errors[node], TypeError)


def test_boxed_operands_go_through_python():
    words = np.array(["ab", "c"], dtype=object)
    node = make("multiply", source(Kind.OTHER, words), 3)
    batch = evaluate(node, 2)
    assert [batch.value(node, lane) for lane in range(2)] == ["ababab", "ccc"]
    text = make("str", source(Kind.SCALAR, [0.5, -0.0]))
    assert evaluate(text, 2).column(text).tolist() == ["0.5", "-0.0"]
    pair = make("divmod", source(Kind.SCALAR, [7.5]), 2)
    assert evaluate(pair, 1).value(pair) == (3.0, 1.5)


def test_items_of_vectors():
    vectors = source(Kind.VECTOR, [[1.0, 2.0, 3.0]] * 4)
    node = make("getitem", vectors, source(Kind.INTEGER, [0, -1, 2, 3]))
    batch = evaluate(node, 4)
    assert batch.status(node).tolist() == [0, 0, 0, 1]
    assert batch.column(node)[:3].tolist() == [1.0, 3.0, 3.0]
    for index in range(-5, 5):
        node = make("getitem", vectors, source(Kind.INTEGER, [index]))
        batch = evaluate(node, 4)
        if -3 <= index < 3:
            assert batch.status(node) is None
            assert set(batch.full(node).tolist()) == {[1.0, 2.0, 3.0][index]}
        else:
            assert batch.status(node).tolist() == [1] * 4
    truth = source(Kind.BOOLEAN, [True, False])
    rows = source(Kind.VECTOR, [[1.0, 2.0, 3.0], [4.0, 5.0, 6.0]])
    assert evaluate(make("getitem", rows, truth), 2).full(make("getitem", rows, truth)).tolist() == [2.0, 4.0]
    one = make("getitem", Triple((1.0, 2.0, 3.0)), source(Kind.INTEGER, [2, 0, -2, 1, -3]))
    assert evaluate(one, 5).full(one).tolist() == [3.0, 1.0, 2.0, 2.0, 1.0]
    length = make("len", vectors)
    assert evaluate(length, 4).value(length) == 3


def test_a_constant_operand_has_one_row():
    node = make("vector", 1.0, source(Kind.SCALAR, [1.0, 2.0]), 3.0)
    assert Graph([node]).dimension == 0
    assert evaluate(node, 2).column(node).tolist() == [[1.0, 1.0, 3.0], [1.0, 2.0, 3.0]]
    assert constant(Triple((1.0, 2.0, 3.0))).payload.column.shape == (1, 3)


def test_vectors_and_orientations_are_true():
    """Also those whose parts are all nothing: they have items, as objects have."""
    for kind, rows in (
        (Kind.VECTOR, [[0.0, 0.0, 0.0], [0.0, 2.0, 0.0]]),
        (Kind.ORIENTATION, [[0.0, 0.0, 0.0, 1.0], [1.0, 0.0, 0.0, 0.0]]),
    ):
        node = make("truth", source(kind, rows))
        assert evaluate(node, 2).full(node).tolist() == [True, True]


SIGNS = {"less": "<", "less or equal": "<=", "greater": ">", "greater or equal": ">="}
ONE, TURN = [[1.0, 2.0, 3.0]], [[0.0, 0.0, 0.0, 1.0]]


@each(COMPARISONS)
def test_vectors_and_orientations_have_no_order(name):
    """They are equal or not, also to what is of another kind; the error names the sign that was written."""
    parts = [(Kind.VECTOR, ONE), (Kind.ORIENTATION, TURN), (Kind.SCALAR, [1.0]), (Kind.INTEGER, [1])]
    for one, other in itertools.product(parts, repeat=2):
        if one[0].trailing or other[0].trailing:
            for lanes in (1, 3):
                node = make(
                    name, *(source(kind, rows * count) for (kind, rows), count in ((one, lanes), (other, 1)))
                )
                batch = evaluate(node, lanes)
                if name in ("equal", "not equal"):
                    expected = (one is other) is (name == "equal")
                    assert is_fine(batch, node).all()
                    assert batch.full(node).tolist() == [expected] * lanes
                else:
                    assert batch.status(node).tolist() == [1] * lanes
                    if lanes == 1:
                        assert type(batch.errors[node]) is TypeError
                        assert f"'{SIGNS[name]}'" in str(batch.errors[node])


def test_large_whole_numbers_are_compared_and_divided_by_their_values():
    """Neighbours that are one float are still two numbers, against each other and against floats; also where one side is small."""
    large = [2**53 + place for place in (-1, 0, 1, 2)] + [-(2**53) - 1, 2**61 + 1]
    for name, first, second in itertools.product(
        (*COMPARISONS, "divide"), (large, [-(2**53) - 1], [3, -7]), (large, [-(2**61) - 1], [3, -7])
    ):
        pairs = list(itertools.product(first, second))
        check(name, *map(list, zip(*pairs, strict=True)))
        check(name, [a for a, _ in pairs], [float(b) for _, b in pairs])
        check(name, [float(a) for a, _ in pairs], [b for _, b in pairs])
