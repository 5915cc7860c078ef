"""The sequential test: its errors and its mean number of runs, computed exactly over all paths."""

import itertools

import numpy as np
import pytest

from scenic.statistics.sequential_test import BoundTest


def exact(test: BoundTest, probability: float, most: int = 4000) -> tuple[float, float]:
    """The chance of the answer "at most", and the mean number of runs, by going through all counts of violations."""
    chances = np.zeros(most + 2)
    chances[0] = 1.0
    at_most = mean = 0.0
    for runs in range(1, most + 1):
        moved = chances * (1 - probability)
        moved[1:] += chances[:-1] * probability
        chances = moved
        for violations in np.flatnonzero(chances > 0).tolist():
            answer = test.is_at_most(violations, runs)
            if answer is not None:
                at_most += chances[violations] * answer
                mean += chances[violations] * runs
                chances[violations] = 0.0
        if chances.sum() < 1e-9:
            break
    assert chances.sum() < 1e-6
    return at_most, mean


TEST = BoundTest(bound=0.2, good=0.1, confidence=0.95, power=0.9)


@pytest.mark.parametrize(
    ("probability", "most", "least"), [(0.2, 0.05, 0.04), (0.1, 0.903, 0.9), (0.4, 0.05, 0.0)]
)
def test_both_errors_are_as_promised(probability: float, most: float, least: float) -> None:
    chance, _ = exact(TEST, probability)
    assert least <= chance <= most


@pytest.mark.parametrize("given", [(0.05, 0.01, 0.9, 0.99), (0.6, 0.3, 0.95, 0.5), (0.02, 0.004, 0.8, 0.8)])
def test_errors_of_other_tests_are_as_promised(given: tuple[float, float, float, float]) -> None:
    test = BoundTest(*given)
    assert exact(test, test.bound)[0] <= 1 - test.confidence + 1e-6
    assert exact(test, test.good)[0] >= test.power - 1e-6


@pytest.mark.parametrize("probability", [0.2, 0.1, 0.05, 0.35])
def test_mean_number_of_runs_is_near_that_of_wald(probability: float) -> None:
    _, mean = exact(TEST, probability)
    assert mean == pytest.approx(TEST.expected_runs(probability), rel=0.1)


def test_mean_number_of_runs_is_known_where_nothing_drifts() -> None:
    # In between there is a probability at which the evidence goes nowhere on average.
    runs = [TEST.expected_runs(p) for p in np.linspace(0.1, 0.2, 101)]
    assert all(np.isfinite(runs))
    assert max(runs) < 2 * runs[0]
    assert np.max(np.abs(np.diff(runs))) < 10


def test_thresholds_of_small_bounds_are_near_one_another() -> None:
    """The law of the evidence depends on the ratio of the probabilities alone where they are small."""
    needed = []
    for bound in (0.02, 1e-6):
        test = BoundTest(bound, bound / 2, 0.95, 0.9)
        needed.append(next(k for k in itertools.count(4) if test.is_at_most(k, round(4 / bound)) is False))
    assert max(needed) - min(needed) <= 1


def test_no_run_is_no_evidence() -> None:
    assert TEST.evidence(0, 0) == 0
    assert TEST.is_at_most(0, 1) is None
    assert TEST.is_at_most(100, 100) is False
    assert TEST.is_at_most(0, 1000) is True
