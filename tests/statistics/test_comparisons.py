"""The comparison of paired runs, beside the sum over the binomial distribution."""

import math
from fractions import Fraction

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from scenic.statistics.comparisons import PairedComparison


@given(st.integers(0, 40), st.integers(0, 40))
def test_p_value_is_that_of_the_binomial_distribution(first: int, second: int) -> None:
    total = first + second
    tail = sum(Fraction(math.comb(total, k), 2**total) for k in range(max(first, second), total + 1))
    expected = 1.0 if first == second else min(1.0, float(2 * tail))
    assert PairedComparison(100, first, second).p_value == pytest.approx(expected)


@pytest.mark.parametrize(("first", "second"), [(0.05, 0.01), (0.3, 0.3), (0.0, 0.02)])
def test_the_difference_lies_in_its_interval(first: float, second: float) -> None:
    generator = np.random.default_rng(5)
    held = 0
    for _ in range(200):
        counts = generator.multinomial(300, [first, second, 1 - first - second])
        comparison = PairedComparison(300, int(counts[0]), int(counts[1]))
        low, high = comparison.interval(0.9)
        assert low <= comparison.difference <= high
        held += low <= first - second <= high
    assert held >= 175


@given(st.integers(0, 30), st.integers(0, 30), st.floats(0.5, 0.999))
def test_an_interval_without_zero_says_what_the_test_says(first: int, second: int, confidence: float) -> None:
    comparison = PairedComparison(80, first, second)
    low, high = comparison.interval(confidence)
    level = 0.8 * (1 - confidence)
    if not math.isclose(comparison.p_value, level):
        assert (low > 0 or high < 0) is (comparison.p_value < level)
    if low > 0 or high < 0:
        assert (low > 0) is (first > second)


def test_nothing_is_known_without_pairs() -> None:
    nothing = PairedComparison(0, 0, 0)
    assert nothing.p_value == 1
    assert nothing.interval(0.95) == (-1, 1)
