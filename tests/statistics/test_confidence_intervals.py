"""Exact intervals, beside those of SciPy and the binomial distribution itself."""

import pytest
from hypothesis import given
from hypothesis import strategies as st
from scipy.stats import binom, binomtest

from scenic.statistics.confidence_intervals import Interval, exact_interval

CONFIDENCES = st.floats(0.5, 0.999)


@given(st.integers(2, 500), st.data(), CONFIDENCES)
def test_interval_is_that_of_clopper_and_pearson(runs: int, data: st.DataObject, confidence: float) -> None:
    violations = data.draw(st.integers(1, runs - 1))
    expected = binomtest(violations, runs).proportion_ci(confidence, "exact")
    assert tuple(exact_interval(violations, runs, confidence)) == pytest.approx(
        (expected.low, expected.high), abs=1e-9
    )


@given(st.integers(1, 10_000), CONFIDENCES)
def test_without_a_violation_the_bound_has_the_whole_of_the_error(runs: int, confidence: float) -> None:
    low, high = exact_interval(0, runs, confidence)
    assert low == 0
    assert high == pytest.approx(1 - (1 - confidence) ** (1 / runs), rel=1e-9)
    assert exact_interval(runs, runs, confidence) == pytest.approx((1 - high, 1.0), rel=1e-6)


@given(st.integers(1, 200), st.data())
def test_runs_without_outcome_widen_the_interval_to_either_outcome(runs: int, data: st.DataObject) -> None:
    violations = data.draw(st.integers(0, runs))
    unknown = data.draw(st.integers(0, runs - violations))
    low, high = exact_interval(violations, runs, 0.9, unknown=unknown)
    assert low == exact_interval(violations, runs, 0.9).low
    assert high >= exact_interval(violations + unknown, runs, 0.9).high - 1e-12


@pytest.mark.parametrize("probability", [0.5, 0.05, 0.005])
def test_intervals_hold_the_probability_as_often_as_promised(probability: float) -> None:
    runs = 1000
    held = sum(
        float(binom.pmf(count, runs, probability))
        for count in range(runs + 1)
        if exact_interval(count, runs, 0.95).low <= probability <= exact_interval(count, runs, 0.95).high
    )
    assert 0.95 <= held <= 0.99


def test_interval_in_words() -> None:
    assert str(Interval(0.001234567, 0.25)) == "0.00123 to 0.25"
    assert Interval(0.1, 0.3).half_width == pytest.approx(0.1)
