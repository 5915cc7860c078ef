"""Weights of importance sampling, and the interval of a weighted share."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from scipy.special import ndtri
from scipy.stats import chi2

from scenic.statistics.weighting import Proposal, effective_size, weighted_interval


def test_weights_have_mean_one_and_are_bounded() -> None:
    proposal = Proposal(np.array([2.0, -1.0]), np.array([0.5, 0.8]))
    points = proposal.draw(np.random.default_rng(1), 100_000)
    weights = proposal.weights(points)
    assert weights.max() <= 10 + 1e-9
    assert weights.mean() == pytest.approx(1, abs=0.02)
    # Under the weights, the points are uniform again.
    assert (weights[points[:, 0] < 0.3]).sum() / len(points) == pytest.approx(0.3, abs=0.02)


def test_proposal_around_points_has_their_means() -> None:
    points = np.random.default_rng(2).uniform(0.6, 0.9, (40, 3))
    proposal = Proposal.around(points)
    assert proposal.means == pytest.approx(ndtri(points).mean(axis=0))
    assert (proposal.deviations >= 0.2).all()
    assert Proposal.around(points[:1]).deviations == pytest.approx([1, 1, 1])


@given(st.integers(1, 300), st.floats(0.01, 5), st.floats(0.5, 0.99))
def test_equal_weights_give_the_exact_interval_of_a_count(
    count: int, weight: float, confidence: float
) -> None:
    weights = np.full(count, weight)
    miss = (1 - confidence) / 2
    low, high = weighted_interval(weights, 10_000, confidence)
    assert low == pytest.approx(weight * chi2.ppf(miss, 2 * count) / 2 / 10_000, rel=1e-6)
    assert high == pytest.approx(weight * chi2.isf(miss, 2 * count + 2) / 2 / 10_000, rel=1e-6)
    assert effective_size(weights) == pytest.approx(count)


def test_interval_holds_a_tail_of_the_normal_distribution() -> None:
    proposal = Proposal(np.array([3.0]), np.array([0.5]))
    generator = np.random.default_rng(3)
    held = 0
    for _ in range(100):
        points = proposal.draw(generator, 500)
        weights = proposal.weights(points)[points[:, 0] > 1 - 0.001]
        low, high = weighted_interval(weights, 500, 0.95)
        held += low <= 0.001 <= high
    assert held >= 90


def test_nothing_is_known_without_weights() -> None:
    assert weighted_interval(np.zeros(0), 100, 0.95) == (0, 1)
    assert effective_size(np.zeros(0)) == 0
