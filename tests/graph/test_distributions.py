"""Primitive distributions: their laws by goodness of fit, their ends, and what rejects or fails.

Each fit is one test at a false-alarm rate of one in ten thousand, with a fixed seed: it passes or fails for good.
"""

import math
from fractions import Fraction

import numpy as np
import pytest
from scipy import stats
from scipy.special import log_ndtr

from graph.programs import CODEC, batch_at, constant, faulty, make, one_of, sampled, source, uniform
from scenic.graph import bounding
from scenic.graph import node as graph
from scenic.graph.bounds import Bounds
from scenic.graph.kinds import Kind
from scenic.graph.node import Graph
from scenic.graph.operations.distributions import LookupTable
from scenic.graph.operations.normal_law import conditioned_cumulative, conditioned_quantile
from tests.each import each

ALARM = 1e-4
LANES = 20_000
ENDS = np.array([5e-324, 2.0**-54, 0.5, 1 - 2.0**-53])
"""Points of the open unit interval, its outermost included."""


def values_of(node, seed=0):
    return sampled([node], LANES, seed).full(node)


def at_ends(node):
    """The values at the outermost points of the node's only axis."""
    batch = batch_at(Graph([node]), ENDS[:, None], CODEC)
    return batch.full(node), batch.status(node)


@pytest.mark.parametrize(("low", "high"), [(2.0, 5.0), (5.0, 2.0), (-1, 1), (1e-3, 1e3)])
def test_range_is_uniform(low, high):
    values = values_of(uniform(low, high))
    bottom, top = min(low, high), max(low, high)
    assert stats.kstest(values, stats.uniform(bottom, top - bottom).cdf).pvalue > ALARM


def test_range_keeps_within_its_ends():
    for low, high in [(0.1, 0.3), (1e16, 1e16 + 2), (-1e308, 1e308), (5.0, 5.0), (0.3, 0.1)]:
        values, status = at_ends(uniform(low, high))
        assert status is None
        assert (values >= min(low, high)).all()
        assert (values <= max(low, high)).all()


@pytest.mark.parametrize(("low", "high"), [(0.1, 0.7), (-5.0, -7.5), (-1.7e308, 1.7e308), (1e308, -1.5e308)])
def test_places_on_the_axis_are_shares_of_the_way(low, high):
    """Also between ends so far apart that their distance is no float."""
    node = uniform(source(Kind.SCALAR, [low]), source(Kind.SCALAR, [high]))
    shares = [0.001, 0.25, 0.5, 0.9]
    found = batch_at(Graph([node]), np.array(shares)[:, None], CODEC).full(node)
    exact = [Fraction(low) * (1 - Fraction(share)) + Fraction(high) * Fraction(share) for share in shares]
    np.testing.assert_allclose(found, [float(value) for value in exact], rtol=1e-14)


def test_range_of_endless_ends_fails():
    endless, fixed = source(Kind.SCALAR, [1.0, math.inf, math.nan, -math.inf]), 0.0
    for ends in ((fixed, endless), (endless, fixed)):
        node = make("range", graph.axis(), *ends)
        batch = batch_at(Graph([node]), np.full((4, 1), 0.5), CODEC)
        assert batch.status(node).tolist() == [0, 1, 1, 1]


def test_range_with_random_ends():
    low = uniform(0.0, 1.0)
    node = make("range", graph.axis(), low, make("add", low, 1.0))
    batch = sampled([node, low], LANES)
    rest = batch.full(node) - batch.full(low)
    assert stats.kstest(rest, stats.uniform(0, 1).cdf).pvalue > ALARM
    assert abs(stats.pearsonr(rest, batch.full(low)).statistic) < 0.03


@pytest.mark.parametrize(("mean", "deviation"), [(0.0, 1.0), (-3, 0.25), (1.0, -2.0)])
def test_normal(mean, deviation):
    values = values_of(make("normal", graph.axis(), mean, deviation))
    assert stats.kstest(values, stats.norm(mean, abs(deviation)).cdf).pvalue > ALARM
    assert np.isfinite(at_ends(make("normal", graph.axis(), mean, deviation))[0]).all()


WINDOWS = [
    (0.0, 1.0, -1.0, 2.0),
    (0.0, 1.0, 2.0, 3.0),
    (5.0, 2.0, -math.inf, 4.0),
    (0.0, 1.0, 6.0, math.inf),
    (0.0, 1.0, -12.0, -9.0),
    (0.0, 1.0, 35.0, 36.0),
    (0.0, 1.0, -200.0, -150.0),
    (0.0, -1.0, 3.0, 7.0),
]


@pytest.mark.parametrize(("mean", "deviation", "low", "high"), WINDOWS)
def test_truncated_normal(mean, deviation, low, high):
    node = make("truncated normal", graph.axis(), mean, deviation, payload=(low, high))
    values = values_of(node)
    scale = abs(deviation)
    a, b = (low - mean) / scale, (high - mean) / scale
    law = stats.truncnorm(a, b, loc=mean, scale=scale)
    assert stats.kstest(values, law.cdf).pvalue > ALARM
    ends, status = at_ends(node)
    assert status is None
    assert ((ends >= low) & (ends <= high)).all()


@pytest.mark.parametrize("far", [1e5, 1e7])
def test_truncated_normal_in_the_far_tail_is_an_exponential(far):
    node = make("truncated normal", graph.axis(), 0.0, 1.0, payload=(far, 2 * far))
    values = (values_of(node) - far) * far
    assert stats.kstest(values, stats.expon().cdf).pvalue > ALARM


def test_truncated_normal_without_deviation():
    """It is its mean, if that lies in the window, ends included."""
    means = [1.0, 3.0, -0.5, 0.0, 2.0]
    for deviation in (source(Kind.SCALAR, [0.0]), source(Kind.SCALAR, [0.0] * 5), 0.0, uniform(0.0, 0.0)):
        node = make(
            "truncated normal", graph.axis(), source(Kind.SCALAR, means), deviation, payload=(0.0, 2.0)
        )
        net = Graph([node])
        batch = batch_at(net, np.full((5, net.dimension), 0.3), CODEC)
        assert batch.status(node).tolist() == [0, 1, 1, 0, 0]
        assert batch.column(node)[[0, 3, 4]].tolist() == [1.0, 0.0, 2.0]
    known = [Bounds(np.array([0.25]), np.array([0.5])), Bounds.exactly(1.0), Bounds.exactly(0.0)]
    found = node.operation.bounds((0.0, 2.0), *known)
    assert (found.lower[0], found.upper[0]) == (0.0, 2.0)
    place, *_ = node.operation.inverse((0.0, 2.0), Bounds.exactly(1.0), *known)
    assert not place.meet(known[0]).empty().any()


@pytest.mark.parametrize(
    ("a", "b"), [(-1.0, 2.0), (3.0, 5.0), (-40.0, -35.0), (31.0, 33.0), (-math.inf, 0.5)]
)
def test_quantile_and_cumulative_are_inverse(a, b):
    u = np.linspace(0.001, 0.999, 41)
    z = conditioned_quantile(np.float64(a), np.float64(b), u)
    share, error = conditioned_cumulative(np.float64(a), np.float64(b), z)
    assert (np.abs(share - u) <= error + 1e-9).all()
    assert (error < 1e-6).all()
    assert (np.diff(z) > 0).all()


def test_quantiles_stay_within_their_interval():
    """However narrow it is, and wherever: what is rounded does not leave it."""
    rng = np.random.default_rng(7)
    a = rng.choice([0.0, 1.0, 3.0, 8.0, 29.0, 31.0, 200.0, 9.99e3, 2e4], 4000) * rng.choice([-1, 1], 4000)
    b = a + np.abs(a) * rng.choice([2e-16, 1e-12, 1e-3], 4000) + rng.choice([0.0, 1e-300, 1e-9], 4000)
    u = rng.choice([1e-15, 0.25, 0.5, 0.75, 1 - 1e-15], 4000)
    z = conditioned_quantile(a, b, u)
    assert ((z >= a) & (z <= b)).all()


@pytest.mark.parametrize("far", [25.0, 35.0, 9.9e3, 1.01e4, 1e6])
@pytest.mark.parametrize("side", [-1, 1])
def test_quantiles_of_far_tails_rise(far, side):
    """From one end to the other, most of them close to the end next to the mean: how far is an exponential law."""
    a, b = sorted((side * far, side * (far + 20 / far)))
    u = np.linspace(0.0, 1.0, 21)
    u[[0, -1]] = 1e-15, 1 - 1e-15
    z = conditioned_quantile(np.float64(a), np.float64(b), u)
    assert (np.diff(z) > 0).all()
    assert (np.abs(z[[0, -1]] - [a, b]) < 1e-3 / far).any()
    assert (z[10] - side * far) * far * side == pytest.approx(math.log(2), rel=3 / far + 1e-4)


@pytest.mark.parametrize("far", [31.0, 300.0, 9.9e3, 1.01e4, 1e6])
@pytest.mark.parametrize("width", [0.01, 1.0, 5.0])
@pytest.mark.parametrize("side", [-1, 1])
def test_quantiles_of_windows_in_a_far_tail(far, width, side):
    """The law in the window is nearly an exponential one that is cut off there."""
    a, b = sorted((side * far, side * (far + width / far)))
    share = np.linspace(0.0, 1.0, 21)[1:-1]
    z = conditioned_quantile(np.float64(a), np.float64(b), share)
    inward = share if side > 0 else 1 - share
    expected = -np.log1p(inward * np.expm1(-width))
    # A narrow window far out is a few thousand floats wide.
    np.testing.assert_allclose(
        (np.abs(z) - far) * far, expected, rtol=5e-3, atol=1e-3 * width + 4e-16 * far**2
    )


@pytest.mark.parametrize("end", [-6.0, 0.5, 3.0, 29.0, 31.0, 300.0, 9.9e3, 1.01e4])
@pytest.mark.parametrize("side", [-1, 1])
def test_quantiles_of_half_lines(end, side):
    """What lies beyond a quantile is its share of all beyond the end, however far out both are."""
    share = np.array([1e-9, 0.01, 0.25, 0.5, 0.9, 1 - 1e-9])
    a, b = (end, math.inf) if side > 0 else (-math.inf, -end)
    z = conditioned_quantile(np.float64(a), np.float64(b), share if side > 0 else 1 - share)
    beyond = log_ndtr(-side * z) - log_ndtr(-end)
    np.testing.assert_allclose(beyond, np.log1p(-share), rtol=1e-6, atol=1e-12 * end**2 + 1e-9)


@pytest.mark.parametrize(("low", "high"), [(1, 6), (0.5, 3.5), (-3, -3), (-2.0, 2)])
def test_discrete_range_is_uniform(low, high):
    node = make("discrete range", graph.axis(), low, high)
    values = values_of(node)
    support = np.arange(math.ceil(low), math.floor(high) + 1)
    counts = [(values == value).sum() for value in support]
    assert sum(counts) == LANES
    if len(support) > 1:
        assert stats.chisquare(counts).pvalue > ALARM
    ends, _ = at_ends(node)
    assert ends[0] == support[0]
    assert ends[-1] == support[-1]


def test_empty_discrete_range_rejects():
    node = make(
        "discrete range", graph.axis(), source(Kind.SCALAR, [0.2, 0.2]), source(Kind.SCALAR, [0.8, 1.8])
    )
    batch = batch_at(Graph([node]), np.full((2, 1), 0.5), CODEC)
    assert batch.status(node).tolist() == [2, 0]


def test_discrete_range_of_huge_ends_fails():
    node = make("discrete range", graph.axis(), 0.0, source(Kind.SCALAR, [1e300, math.nan]))
    batch = batch_at(Graph([node]), np.full((2, 1), 0.5), CODEC)
    assert batch.status(node).tolist() == [1, 1]
    for end in (3e18, -3e18):
        for ends in ((uniform(0.0, end), 0.0), (0.0, uniform(0.0, end))):
            node = make("discrete range", graph.axis(), *ends)
            batch = batch_at(Graph([node]), np.full((1, 2), 0.99), CODEC)
            assert batch.status(node).tolist() == [1]


def test_weights():
    weights = np.array([3.0, 0.0, 1.0, 6.0, 0.0])
    cumulative = tuple((np.cumsum(weights) / weights.sum()).tolist())
    for node, first in (
        (make("weighted integer", graph.axis(), payload=(10, cumulative)), 10),
        (make("choice", graph.axis(), payload=cumulative), 0),
    ):
        assert node.limits == (first, first + 3)
        values = values_of(node)
        counts = np.array([(values == first + place).sum() for place in range(5)])
        assert counts[weights == 0].tolist() == [0, 0]
        positive = weights > 0
        expected = LANES * weights[positive] / weights.sum()
        assert stats.chisquare(counts[positive], expected).pvalue > ALARM
        ends, _ = at_ends(node)
        assert ends.tolist() == [first, first, first + 3, first + 3]


def test_an_option_of_weight_zero_is_not_drawn_at_a_limit():
    node = make("choice", graph.axis(), payload=(0.0, 0.5, 0.5, 1.0))
    batch = batch_at(Graph([node]), np.array([[1e-300], [0.5]]), CODEC)
    assert batch.column(node).tolist() == [1, 3]


def test_choice_among_numbers():
    values = values_of(one_of(1, 2.5, 1e9, weights=[1, 2, 1]))
    counts = [sum(value == option for value in values) for option in (1, 2.5, 1e9)]
    assert stats.chisquare(counts, [LANES / 4, LANES / 2, LANES / 4]).pvalue > ALARM


def test_undrawn_options_cannot_reject():
    empty = make("discrete range", graph.axis(), 2, 1)
    node = one_of(empty, 5)
    batch = sampled([node], 1000)
    status = batch.status(node)
    rejected = (status == 2).mean()
    assert 0.4 < rejected < 0.6
    assert set(batch.column(node)[status == 0].tolist()) == {5}


def test_the_fate_of_the_index_counts():
    index = faulty(Kind.INTEGER, [0, 1, 0], [0, 1, 2], ValueError())
    node = make("select", index, 1.0, 2.0)
    batch = batch_at(Graph([node]), np.empty((3, 0)), CODEC)
    assert batch.status(node).tolist() == [0, 1, 2]


def test_an_option_of_weight_zero_is_not_drawn_beyond_the_last_limit():
    """Sums of weights are rounded: the last limit may lie below the outermost points of the axis."""
    limit = 1 - 2.0**-52
    node = make("choice", graph.axis(), payload=(0.5, limit, limit))
    assert batch_at(Graph([node]), np.array([[1 - 2.0**-53]]), CODEC).column(node).tolist() == [1]


@each([2.0**exponent for exponent in (52, 53, 60, 61, 62, 63, 64)])
def test_discrete_ranges_of_any_size_keep_within_their_ends_or_fail(end):
    for low, high in ((-end, end), (0.0, end), (end, end), (-end, -end)):
        node = make("discrete range", graph.axis(), source(Kind.SCALAR, [low]), source(Kind.SCALAR, [high]))
        batch = batch_at(Graph([node]), ENDS[:, None], CODEC)
        status = batch.status(node)
        if status is None:
            values = batch.full(node).tolist()
            assert all(low <= value <= high for value in values)
            assert values[0] == low
        else:
            assert status.tolist() == [1] * len(ENDS)
            assert end >= 2.0**61


def counted(low, high):
    return make("discrete range", graph.axis(), low, high)


WEIGHTS = tuple((np.cumsum([3.0, 0.0, 1.0, 6.0, 0.0, 1.0]) / 11).tolist())
STEPS = [
    *((counted(-2, last), np.arange(1, last + 4) / (last + 3)) for last in range(60)),
    (make("weighted integer", graph.axis(), payload=(10, WEIGHTS)), np.array(WEIGHTS)),
    (make("choice", graph.axis(), payload=WEIGHTS), np.array(WEIGHTS)),
]


def test_inverses_keep_the_neighbours_of_every_step():
    """Where a whole number becomes the next one, by a few units in the last place."""
    for node, borders in STEPS:
        points = borders[borders < 1]
        around = [points]
        for towards in (0.0, 1.0):
            moved = points
            for _ in range(3):
                moved = np.nextafter(moved, towards)
                around.append(moved)
        axis = np.unique(np.concatenate([*around, ENDS]))
        axis = axis[(axis > 0) & (axis < 1)]
        values = batch_at(Graph([node]), axis[:, None], CODEC).full(node).astype(float)
        result = Bounds(values, values)
        whole = Bounds(np.zeros(len(axis)), np.ones(len(axis)))
        others = [bounding.of_constant(operand) for operand in node.operands[1:]]
        place = node.operation.inverse(node.payload, result, whole, *others)[0]
        assert ((place.lower <= axis) & (axis <= place.upper)).all(), node
        # And no more than that: a number is drawn by its own stretch of the axis.
        shares = np.diff([0.0, *borders])
        assert ((place.upper - place.lower) <= shares.max() + 1e-12).all()


def test_bounds_of_whole_constants_hold_them_exactly():
    for value in (
        0,
        1,
        -7,
        *(
            sign * 2**bits + more
            for bits in (52, 53, 54, 60, 61)
            for more in (-1, 0, 1, 3)
            for sign in (1, -1)
        ),
    ):
        bounds = bounding.of_constant(constant(value))
        # As whole numbers: NumPy would make a float of the value first.
        assert int(bounds.lower[0]) <= value <= int(bounds.upper[0])
        if abs(value) <= 2**53:
            assert bounds.lower[0] == value == bounds.upper[0]


@each([2**53 + more for more in (-1, 0, 1, 3)] + [2**60 + 1, 2**61 - 1])
def test_bounds_of_whole_numbers_hold_their_limits(end):
    for values in ([0, end], [-end, 0], [-end, end]):
        bounds = bounding.overall(source(Kind.INTEGER, values))
        assert int(bounds.lower[0]) <= values[0]
        assert values[1] <= int(bounds.upper[0])
        if end <= 2**53:
            assert [bounds.lower[0], bounds.upper[0]] == values or end == 2**53


@each([2**53 + more for more in (-1, 0, 1, 3)] + [2**60 + 1, 2**61 - 1])
def test_bounds_of_tables_hold_whole_numbers_of_any_size(end):
    """Whatever smaller ones stand beside them."""
    for values in ([1, end], [end, 1], [-1, -end], [-end, end], [1, -end, 0, end], [1, -2, 3]):
        node = one_of(*values)
        for place, value in enumerate(values):
            bounds = node.operation.bounds(node.payload, Bounds.exactly(place))
            assert int(bounds.lower[0]) <= value <= int(bounds.upper[0])
            if max(map(abs, values)) <= 2**53:
                assert bounds.lower[0] == value == bounds.upper[0]


def test_bounds_of_kinds_hold_every_value():
    turns = np.random.default_rng(3).normal(size=(500, 4))
    turns /= np.linalg.norm(turns, axis=1, keepdims=True)
    turns = np.concatenate([turns, np.eye(4), -np.eye(4)])
    for kind, values in (
        (Kind.ORIENTATION, turns),
        (Kind.BOOLEAN, np.array([0.0, 1.0])),
        (Kind.INTEGER, np.array([-(2.0**70), 2.0**70])),
        (Kind.SCALAR, np.array([-1e308, 1e308])),
        (Kind.VECTOR, np.array([[-1e308, 0, 1e308]])),
    ):
        bounds = bounding.of_kind(kind)
        assert ((bounds.lower <= values) & (values <= bounds.upper)).all()
    assert bounding.of_kind(Kind.OTHER) is None


@each([0.0, -0.7, 3.0, -8.0, 29.0, -31.0, 2e4])
def test_inverses_of_windows_of_any_width_keep_what_was_drawn(centre):
    """Shares of a narrow window lose digits, which the inverse has to allow for; of a wide one it says nearly where it was."""
    share = np.linspace(0.0, 1.0, 401)[1:-1]
    for width in 10.0 ** np.arange(-14, 3):
        for mean, deviation in ((0.0, 1.0), (5.0, -0.01), (-3.0, 200.0)):
            low, high = mean + abs(deviation) * centre, mean + abs(deviation) * (centre + width)
            if low == high:
                continue
            node = make("truncated normal", graph.axis(), mean, deviation, payload=(low, high))
            values = batch_at(Graph([node]), share[:, None], CODEC).full(node)
            known = [Bounds.exactly(0.5), Bounds.exactly(mean), Bounds.exactly(deviation)]
            place, *_ = node.operation.inverse(node.payload, Bounds(values, values), *known)
            assert ((place.lower <= share) & (share <= place.upper)).all(), (width, mean)
            if 0.1 <= width <= 10 and abs(centre) < 5:
                inner = (values > low) & (values < high)
                assert (place.upper - place.lower)[inner].max() < 1e-6


def test_tables_are_equal_only_if_their_values_are_of_one_kind():
    """Zeros look alike in every kind: whole, broken, or false."""
    tables = [
        LookupTable(kind, np.array(values, dtype=kind.dtype))
        for kind, values in (
            (Kind.INTEGER, [0, 0]),
            (Kind.SCALAR, [0.0, 0.0]),
            (Kind.SCALAR, [0.0, -0.0]),
            (Kind.BOOLEAN, [False] * 16),
        )
    ]
    assert len(set(tables)) == len(tables)
    assert LookupTable(Kind.INTEGER, np.array([0, 0])) == tables[0]
