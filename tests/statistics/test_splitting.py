"""Splitting on problems whose probabilities are known, and what it notices about itself."""

import itertools
import math
from collections.abc import Callable
from typing import Any

import numpy as np
import pytest
from scipy.special import ndtr, ndtri

from scenic.statistics.splitting import (
    Move,
    Repetition,
    Splitting,
    SplittingRun,
    repeated_interval,
    repeated_probability,
)
from tests.amounts import amount

Problem = Callable[[tuple[float, ...]], float | None]


def solved(
    problem: Problem, dimension: int, budget: int, seed: int, repetitions: int = 5
) -> Splitting[tuple[float, ...]]:
    """Run a splitting of a function of the unit cube."""
    splitting: Splitting[tuple[float, ...]] = Splitting(seed, budget, repetitions)
    generator = np.random.default_rng(seed)
    making = splitting.runs()
    try:
        moves = next(making)
        while True:
            points = [moved(move, dimension, generator) for move in moves]
            moves = making.send([SplittingRun(point, problem(point)) for point in points])
    except StopIteration:
        assert sum(item.runs for item in [splitting.pilot, *splitting.repetitions]) <= budget
        return splitting


def moved(move: Move[Any], dimension: int, generator: np.random.Generator) -> tuple[float, ...]:
    fresh = generator.standard_normal(dimension)
    if move.parent is None:
        return tuple(ndtr(fresh))
    places = ndtri(np.array(move.parent))
    chosen = generator.random(dimension) < move.share
    places = np.where(chosen, math.sqrt(1 - move.step**2) * places + move.step * fresh, places)
    return tuple(ndtr(places))


def tail(point: tuple[float, ...]) -> float:
    return float(-ndtri(1e-5) - np.sum(ndtri(np.array(point))) / math.sqrt(len(point)))


def disorder(point: tuple[float, ...]) -> float:
    return max(first - second for first, second in itertools.pairwise(point))


@pytest.mark.parametrize(
    ("problem", "dimension", "probability"),
    [(tail, 2, 1e-5), (tail, 20, 1e-5), (disorder, 6, 1 / math.factorial(6))],
)
def test_known_probabilities_lie_in_the_intervals(
    problem: Problem, dimension: int, probability: float
) -> None:
    count = amount(4, 60)
    misses, errors = 0, []
    for seed in range(count):
        repetitions = solved(problem, dimension, 3000, seed).repetitions
        low, high = repeated_interval(repetitions, 0.95)
        misses += not low <= probability <= high
        errors.append(math.log(repeated_probability(repetitions) / probability))
    assert misses <= amount(1, 9)
    assert np.mean(errors) == pytest.approx(0, abs=amount(9, 3) / 10)


def test_values_that_are_all_equal_are_noticed() -> None:
    splitting = solved(lambda point: math.inf if point[0] > 0.001 else -math.inf, 2, 2000, 1)
    assert splitting.pilot.is_flat
    assert splitting.repetitions == []
    assert len(splitting.first_values) == 100


def test_a_budget_that_ends_early_leaves_what_is_finished() -> None:
    splitting = solved(tail, 3, 300, 1)
    assert splitting.is_out_of_budget
    assert not [item for item in splitting.repetitions if item.log_probability is not None]
    generous = solved(tail, 3, 3000, 1)
    assert not generous.is_out_of_budget
    assert sum(item.runs for item in [generous.pilot, *generous.repetitions]) > 2990
    assert len({tuple(item.levels) for item in generous.repetitions}) == 1
    assert len({item.log_probability for item in generous.repetitions}) == 5


def test_a_small_budget_has_fewer_repetitions() -> None:
    small = solved(lambda point: point[0] - 0.02, 2, 320, 1)
    assert 3 <= len(small.repetitions) <= 5
    assert all(item.log_probability is not None for item in small.repetitions)


def test_runs_that_are_none_of_the_law_are_left_out() -> None:
    """Condition a uniform number on being below a half: one in a hundred of these fails."""
    splitting = solved(lambda point: point[0] - 0.005 if point[0] < 0.5 else None, 1, 5000, 3)
    assert repeated_probability(splitting.repetitions) == pytest.approx(0.01, rel=0.3)


def test_moves_that_are_hardly_ever_accepted_are_noticed() -> None:
    # Between failures and the rest lies a wall: of the children of one member none is a member.
    splitting = solved(lambda point: float(hash(point) % 1_000_003) + 1, 3, 20_000, 1)
    assert all(item.mixes_badly for item in [splitting.pilot])


def test_repetitions_share_each_level() -> None:
    halves = [Repetition(math.log(a * b), shares=[math.log(a)]) for a, b in ((0.1, 0.4), (0.3, 0.2))]
    assert repeated_probability(halves) == pytest.approx(0.2 * 0.3)
    assert repeated_probability([Repetition(math.log(0.2)), Repetition(math.log(0.4))]) == pytest.approx(0.3)


def test_an_interval_contains_its_probability() -> None:
    repetitions = [Repetition(item, shares=[item / 2]) for item in (-9.0, -10.5, -8.7, -9.9)]
    low, high = repeated_interval(repetitions, 0.9)
    assert low < repeated_probability(repetitions) < high
    wider = repeated_interval(repetitions, 0.99)
    assert wider.low < low < high < wider.high
