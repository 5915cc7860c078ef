"""Intervals that hold at all times: stopped at the worst one, and beside an integral over the mixture."""

import itertools
import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from scipy.integrate import quad
from scipy.stats import beta, binomtest

from scenic.statistics.confidence_sequences import is_checked, log_wealth, sequence_interval
from tests.amounts import amount


@given(st.integers(0, 12), st.integers(0, 12), st.floats(0.01, 0.99))
def test_wealth_is_the_ratio_of_a_mixture_to_the_likelihood(
    violations: int, held: int, probability: float
) -> None:
    def likelihood(p: float) -> float:
        return float(p**violations * (1 - p) ** held)

    mixed, _ = quad(
        lambda angle: 2 / math.pi * likelihood(math.sin(angle) ** 2), 0, math.pi / 2
    )  # Beta(1/2, 1/2)
    expected = math.log(mixed / likelihood(probability))
    assert log_wealth(violations, violations + held, probability) == pytest.approx(expected, abs=1e-6)


@given(st.integers(1, 100_000), st.data(), st.floats(0.5, 0.9999))
def test_interval_holds_the_values_against_which_no_bet_has_paid(
    runs: int, data: st.DataObject, confidence: float
) -> None:
    violations = data.draw(st.integers(0, runs))
    low, high = sequence_interval(violations, runs, confidence)
    limit = -math.log1p(-confidence)
    assert 0 <= low <= violations / runs <= high <= 1
    for end in (low, high):
        if 0 < end < 1:
            assert log_wealth(violations, runs, end) == pytest.approx(limit, abs=1e-3)
    # It costs something to look at all times.
    assert low <= beta.ppf((1 - confidence) / 2, violations + 0.5, runs - violations + 0.5) + 1e-12
    if violations < runs - 1:
        widened = sequence_interval(violations, runs, confidence, unknown=1)
        assert widened.low == low
        assert widened.high > high


@pytest.mark.parametrize("probability", [0.5, 0.05, 0.005])
def test_the_probability_is_missed_seldom_even_at_the_worst_time(probability: float) -> None:
    count, runs = amount(200, 2000), 1000
    outcomes = np.random.default_rng(1).random((count, runs)) < probability
    limit = -math.log(0.05)
    missed = 0
    for path in np.cumsum(outcomes, axis=1):
        missed += any(log_wealth(int(path[n - 1]), n, probability) >= limit for n in range(1, runs + 1, 3))
    assert binomtest(missed, count, 0.05, "greater").pvalue > 0.001


def test_looks_become_rarer_as_runs_grow() -> None:
    looks = [runs for runs in range(1, 100_000) if is_checked(runs)]
    assert looks[:70] == list(range(1, 71))
    assert len(looks) < 1000
    assert max(after / before for before, after in itertools.pairwise(looks[64:])) <= 1 + 1 / 64


def test_nothing_is_known_before_the_first_run() -> None:
    assert sequence_interval(0, 0, 0.95) == (0, 1)
