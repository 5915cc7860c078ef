"""Splitting in small, as the benchmark measures it in large: beside OpenTURNS, and by simulations of a car that cuts in."""

import math

import numpy as np

import scenic
from benchmarks.estimates import CUT_IN, by_openturns, disorder, split, tail, true_cut_in
from tests.amounts import amount


def logarithmic_error(estimates: list[float], probability: float) -> float:
    return float(np.sqrt(np.mean([math.log(max(item, 1e-12) / probability) ** 2 for item in estimates])))


def test_a_tail_is_found_as_well_as_by_openturns() -> None:
    seeds = range(1, amount(6, 60))
    ours = [split(tail, 10, seed) for seed in seeds]
    theirs = [by_openturns(tail, 10, seed) for seed in seeds]
    error = logarithmic_error([item[0] for item in ours], 1e-6)
    # Of five estimates the error is known to a third.
    assert error < 1.6 * max(0.35, logarithmic_error([item[0] for item in theirs], 1e-6))
    assert sum(low <= 1e-6 <= high for _, low, high, _ in ours) >= len(seeds) - amount(1, 8)
    assert all(runs <= 10_000 for *_, runs in ours)


def test_a_failure_of_many_parts_is_found_better_than_by_openturns() -> None:
    probability = 1 / math.factorial(9)
    ours = [split(disorder, 9, seed)[0] for seed in range(1, amount(5, 50))]
    theirs = [by_openturns(disorder, 9, seed)[0] for seed in range(1, amount(5, 50))]
    assert logarithmic_error(ours, probability) < min(1.0, logarithmic_error(theirs, probability))


def test_a_cut_in_is_as_probable_as_by_another_computation() -> None:
    step, steps = 0.6, 10
    probability = true_cut_in(48, step, steps, 400_000)
    result = scenic.estimate(
        scenic.scenarioFromString(CUT_IN.replace("gap = 66, step = 0.2", f"gap = 48, step = {step}")),
        "kinematic", rare=True, budget=600, seed=1, timestep=step, max_steps=steps,
    )  # fmt: skip
    low, high = result.interval
    assert 1e-3 < probability < 1e-2
    assert low < probability < high < 300 * low
    assert probability / 3 < result.probability < 3 * probability
