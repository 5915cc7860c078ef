"""Estimates of failures beside what is known: ``python -m benchmarks.estimates [PART ...] [--repetitions N]``.

- coverage: 2,000 estimates of each method, of programs whose probability is 0.5, 0.05 or 0.005: the share of intervals that hold it, at the
  worst time to stop, too, with the exact binomial test of the promise;
- test: the errors of the sequential test of a bound, and its mean number of runs beside Wald's approximation;
- rare: splitting on problems with known answers, 10,000 evaluations each, beside the subset simulation of OpenTURNS at as many;
- cutin: a car that cuts in and brakes, p of about a millionth, by simulations: runs, and how many plain ones would be needed.

Takes some minutes; nothing here is a test.
"""

import argparse
import math
from collections.abc import Callable
from functools import partial
from typing import Any, Final

import numpy as np
from numpy.typing import NDArray
from scipy.special import ndtr, ndtri
from scipy.stats import binomtest

import scenic
from scenic.estimation.estimating import Runs
from scenic.estimation.goals import goals_of
from scenic.runtime.temporal.robustness import joint_margin
from scenic.statistics.confidence_intervals import exact_interval
from scenic.statistics.confidence_sequences import is_checked, log_wealth, sequence_interval
from scenic.statistics.sequential_test import BoundTest
from scenic.statistics.splitting import Move, Splitting, SplittingRun, repeated_interval, repeated_probability

Floats = NDArray[np.float64]

LEVEL: Final = 0.001
"""Level of the binomial tests."""

RUNS: Final = 500
"""Runs of one estimate of the coverage."""

BUDGET: Final = 10_000

NUMBERS: Final = """
param x = Range(0, 1)
ego = new Object
"""


def numbers(count: int, seed: int) -> Floats:
    """Uniform numbers ``(count,)`` that a program draws, one in each scene."""
    scenario = scenic.scenarioFromString(NUMBERS)
    runs = Runs(scenario, seed, goals_of(scenario, (), "x"), is_static=True)
    evaluation = runs.evaluation()
    parts = [
        [row["values"][0] for row in evaluation.chosen(first, {}, min(8192, count - first))]
        for first in range(0, count, 8192)
    ]
    return np.concatenate(parts)


def promise(kept: int, count: int, share: float) -> str:
    """Tell whether a share is at least as promised."""
    test = binomtest(kept, count, share, alternative="less").pvalue
    return f"{kept / count:.4f} of {share:g}  {'as promised' if test > LEVEL else f'BROKEN (p = {test:.1g})'}"


def coverage(repetitions: int) -> None:
    """Print the shares of intervals that hold the probability."""
    drawn = numbers(repetitions * RUNS, 1).reshape(repetitions, RUNS)
    for probability in (0.5, 0.05, 0.005):
        violations = np.cumsum(drawn < probability, axis=1)
        for confidence in (0.95, 0.99):
            intervals = [exact_interval(int(k), RUNS, confidence) for k in violations[:, -1]]
            kept = sum(low <= probability <= high for low, high in intervals)
            print(f"p = {probability:<6g} fixed number      {promise(kept, repetitions, confidence)}")
            limit = -math.log1p(-confidence)
            kept = sum(not _is_ever_missed(row, probability, limit) for row in violations)
            print(f"p = {probability:<6g} any time to stop  {promise(kept, repetitions, confidence)}")
            kept = sum(_at_precision(row, probability, confidence) for row in violations)
            print(f"p = {probability:<6g} at a precision    {promise(kept, repetitions, confidence)}")


def _is_ever_missed(violations: NDArray[np.int64], probability: float, limit: float) -> bool:
    """Tell whether an interval after any of the runs misses the probability: the worst time to stop."""
    return any(log_wealth(int(k), runs, probability) > limit for runs, k in enumerate(violations, 1))


def _at_precision(violations: NDArray[np.int64], probability: float, confidence: float) -> bool:
    """Tell whether the interval holds the probability where its precision is reached, or the runs end."""
    precision = 0.6 * math.sqrt(probability * (1 - probability) / 25)
    for runs, k in enumerate(violations, 1):
        if not is_checked(runs) and runs < len(violations):
            continue
        interval = sequence_interval(int(k), runs, confidence)
        if interval.half_width <= precision:
            break
    return interval.low <= probability <= interval.high


def bound_test(repetitions: int) -> None:
    """Print the errors of the sequential test, and its mean number of runs."""
    test = BoundTest(0.1, 0.05, 0.95, 0.9)
    stream = iter(np.tile(numbers(2_000_000, 2), 2).tolist())
    for probability in (0.05, 0.1, 0.02, 0.2):
        answers, lengths = [], []
        for _ in range(repetitions):
            runs = violations = 0
            answer = None
            while answer is None:
                runs += 1
                violations += next(stream) < probability
                answer = test.is_at_most(violations, runs)
            answers.append(answer)
            lengths.append(runs)
        wanted = test.expected_runs(probability)
        words = ""
        if probability <= test.good:
            words = promise(sum(answers), repetitions, test.power)
        elif probability >= test.bound:
            words = promise(repetitions - sum(answers), repetitions, test.confidence)
        mean = float(np.mean(lengths))
        print(
            f"p = {probability:<5g} right answers {words}; {mean:.0f} runs, Wald {wanted:.0f} ({mean / wanted - 1:+.1%})"
        )


def tail(points: Floats) -> Floats:
    """A half space ``(n, d)`` of normals, p = 1e-6."""
    return np.asarray(-ndtri(1e-6) - points.sum(axis=1, keepdims=True) / math.sqrt(points.shape[1]))


def branches(points: Floats) -> Floats:
    """Four branches of two normals (Waarts 2000): the series system of four limits."""
    first, second = points[:, 0], points[:, 1]
    square, both = 0.1 * (first - second) ** 2, (first + second) / math.sqrt(2)
    far = 7 / math.sqrt(2)
    limits = [3 + square - both, 3 + square + both, first - second + far, second - first + far]
    return np.min(limits, axis=0)[:, None]


def disorder(points: Floats) -> Floats:
    """An ordered chain of uniforms: the steps down, as of ``require not (x1 < x2 and x2 < x3 and ...)``."""
    return np.asarray(ndtr(points[:, :-1]) - ndtr(points[:, 1:]))


PROBLEMS: Final[dict[str, tuple[Callable[[Floats], Floats], int, float]]] = {
    "tail, 2 dimensions": (tail, 2, 1e-6),
    "tail, 10 dimensions": (tail, 10, 1e-6),
    "tail, 50 dimensions": (tail, 50, 1e-6),
    "four branches": (branches, 2, 2.22e-3),
    "ordered chain of 9": (disorder, 9, 1 / math.factorial(9)),
}
"""Margins ``(n, parts)`` of normals, all of which are 0 or less in a failure; dimension, and probability; that of the four branches is computed
below."""


def joint(points: Floats, problem: Callable[[Floats], Floats]) -> Floats:
    """By how much points ``(n, d)`` are off a failure, as splitting takes it."""
    return np.array([joint_margin(parts) for parts in problem(points).tolist()])


def largest(points: Floats, problem: Callable[[Floats], Floats]) -> Floats:
    """By how much points ``(n, d)`` are off a failure, as robustness is defined."""
    return np.asarray(problem(points).max(axis=1))


def split(problem: Callable[[Floats], Floats], dimension: int, seed: int) -> tuple[float, float, float, int]:
    """The probability by our splitting, the ends of its interval, and the number of evaluations."""
    splitting: Splitting[tuple[float, ...]] = Splitting(seed, BUDGET)
    generator = np.random.default_rng(seed)
    making = splitting.runs()
    moves: list[Move[tuple[float, ...]]] | None = next(making, None)
    while moves:
        points = _moved(moves, dimension, generator)
        outcomes = [
            SplittingRun(tuple(point), value)
            for point, value in zip(points.tolist(), joint(points, problem).tolist(), strict=True)
        ]
        try:
            moves = making.send(outcomes)
        except StopIteration:
            moves = None
    finished = [item for item in splitting.repetitions if item.log_probability is not None]
    runs = splitting.pilot.runs + sum(item.runs for item in splitting.repetitions)
    if len(finished) < 2:
        return math.nan, 0.0, 1.0, runs
    return repeated_probability(finished), *repeated_interval(finished, 0.95), runs


def _moved(moves: list[Move[tuple[float, ...]]], dimension: int, generator: np.random.Generator) -> Floats:
    fresh = generator.standard_normal((len(moves), dimension))
    if moves[0].parent is None:
        return fresh
    before = np.array([move.parent for move in moves])
    steps = np.array([[move.step] for move in moves])
    chosen = generator.random((len(moves), dimension)) < np.array([[move.share] for move in moves])
    return np.where(chosen, np.sqrt(1 - steps**2) * before + steps * fresh, before)


def by_openturns(
    problem: Callable[[Floats], Floats],
    dimension: int,
    seed: int,
    margin: Callable[[Floats, Callable[[Floats], Floats]], Floats] = largest,
) -> tuple[float, float, float, int]:
    """The same by the subset simulation of OpenTURNS, whose levels are as large as the number of evaluations allows."""
    import openturns as ot

    ot.RandomGenerator.SetSeed(seed)
    ot.Log.Show(ot.Log.NONE)

    def values(sample: Any) -> Any:
        return margin(np.array(sample), problem).reshape(-1, 1).tolist()

    function = ot.PythonFunction(dimension, 1, func_sample=values)
    event = ot.ThresholdEvent(
        ot.CompositeRandomVector(function, ot.RandomVector(ot.Normal(dimension))), ot.LessOrEqual(), 0.0
    )
    levels = 7 if problem is not branches else 3
    algorithm = ot.SubsetSampling(event)
    algorithm.setMaximumOuterSampling(max(1, BUDGET // levels // 10))
    algorithm.setBlockSize(10)
    algorithm.setConditionalProbability(0.1)
    algorithm.run()
    result = algorithm.getResult()
    probability = result.getProbabilityEstimate()
    half = result.getConfidenceLength(0.95) / 2
    return probability, max(0.0, probability - half), probability + half, function.getEvaluationCallsNumber()


def true_branches() -> float:
    """The probability of the four branches, from a fine grid of the first normal."""
    along, across = np.linspace(-9, 9, 6001), np.linspace(-9, 9, 6001)
    cell = (along[1] - along[0]) * (across[1] - across[0])
    total = 0.0
    for value in along:
        points = np.column_stack([np.full_like(across, value), across])
        density = np.exp(-0.5 * (value**2 + across**2)) / (2 * math.pi)
        total += float(density[branches(points)[:, 0] <= 0].sum()) * cell
    return total


def rare(repetitions: int) -> None:
    """Print how near splitting comes to known probabilities, beside OpenTURNS."""
    for name, (problem, dimension, true_probability) in PROBLEMS.items():
        probability = true_branches() if problem is branches else true_probability
        print(f"{name}: p = {probability:.3g}")
        methods = {"scenic": split, "openturns": by_openturns}
        if problem is disorder:
            methods["openturns, our margin"] = partial(by_openturns, margin=joint)
        for label, method in methods.items():
            results = [method(problem, dimension, seed) for seed in range(1, repetitions + 1)]
            silent = sum(math.isnan(item[0]) for item in results)
            ratios = (
                np.array([max(item[0], 1e-12) for item in results if not math.isnan(item[0])]) / probability
            )
            error = math.exp(math.sqrt(float(np.mean(np.log(ratios) ** 2))))
            near = float(np.mean((ratios > 1 / 1.5) & (ratios < 1.5)))
            kept = sum(low <= probability <= high for _, low, high, _ in results)
            print(
                f"  {label:<21} mean {ratios.mean():.2f} p, typical factor {error:.2f}, within 1.5 {near:.0%}, intervals hold it"
                f" {kept} of {repetitions} ({silent} without an estimate); {np.mean([item[3] for item in results]):.0f} evaluations"
            )


STEP: Final = 0.2
STEPS: Final = 30
GAP: Final = 66.0

CUT_IN: Final = """
from scenic.simulators.kinematic import SetVelocity

param gap = 66, step = 0.2
gap = Normal(globalParameters.gap, 4)
pace = Normal(24, 0.5)
pace_ahead = Normal(23, 0.5)
braking = TruncatedNormal(5, 0.4, 3, 8)
braking_ahead = TruncatedNormal(5, 0.4, 3, 8)
reaction = TruncatedNormal(0.8, 0.15, 0.2, 2)

behavior Brake(speed, rate, wait):
    while True:
        take SetVelocity((0, max(0, speed - rate * max(0, simulation().currentTime * globalParameters.step - wait)), 0))

ego = new Object with length 4, with behavior Brake(pace, braking, reaction)
ahead = new Object at (0, 4 + gap), with length 4, with behavior Brake(pace_ahead, braking_ahead, 0)
require always (distance from ego to ahead) > 4 as keeps_off
"""
"""A car cuts in and brakes at once; the ego brakes after its reaction. Both drive straight ahead."""


def nearest_cut_in(uniforms: Floats, step: float = STEP, steps: int = STEPS) -> Floats:
    """By how much the ego of the cut-in program comes nearer to the car ahead ``(n,)``, by the same steps, from numbers ``(n, 5)``."""

    def truncated(place: int, mean: float, deviation: float, low: float, high: float) -> Floats:
        ends = ndtr((np.array([low, high]) - mean) / deviation)
        shares = float(ends[0]) + uniforms[:, place] * float(ends[1] - ends[0])
        return np.asarray(mean + deviation * ndtri(shares))

    pace, ahead = 24 + 0.5 * ndtri(uniforms[:, 0]), 23 + 0.5 * ndtri(uniforms[:, 1])
    rate, rate_ahead = truncated(2, 5, 0.4, 3, 8), truncated(3, 5, 0.4, 3, 8)
    reaction = truncated(4, 0.8, 0.15, 0.2, 2)
    closer, nearest = np.zeros(len(uniforms)), np.zeros(len(uniforms))
    for number in range(steps):
        time = number * step
        closer += step * (
            np.maximum(0, pace - rate * np.maximum(0, time - reaction))
            - np.maximum(0, ahead - rate_ahead * time)
        )
        nearest = np.maximum(nearest, closer)
    return nearest


def true_cut_in(gap: float = GAP, step: float = STEP, steps: int = STEPS, samples: int = 4_000_000) -> float:
    """The probability of the cut-in program with a mean gap: exact in the gap, which is normal; the rest by chance."""
    nearest = nearest_cut_in(np.random.default_rng(1).random((samples, 5)), step, steps)
    return float(np.mean(ndtr((nearest - gap) / 4)))


def margin_cut_in(points: Floats) -> Floats:
    """The margin ``(n, 1)`` of the cut-in program by its formula, from normals ``(n, 6)``; the first is the gap."""
    uniforms = np.clip(ndtr(points[:, 1:]), 1e-16, 1 - 1e-16)
    return (GAP + 4 * points[:, 0] - nearest_cut_in(uniforms))[:, None]


def _plain(low: float, high: float, probability: float) -> float:
    """The number of plain runs whose interval is as narrow."""
    return (1.96 / (math.log(high / low) / 2)) ** 2 / probability


def cut_in(_repetitions: int) -> None:
    """Print the estimate of the cut-in program by simulations."""
    probability = true_cut_in()
    print(f"cut-in, p = {probability:.3g}")
    by_formula = [split(margin_cut_in, 6, seed) for seed in range(1, 101)]
    ratios = np.array([item[0] for item in by_formula]) / probability
    print(
        f"  by its formula, 100 seeds: mean {ratios.mean():.2f} p, plain runs of the same standard error"
        f" {1 / (ratios.var() * probability) / BUDGET:.0f} times as many, of intervals as narrow"
        f" {np.median([_plain(low, high, chance) for chance, low, high, _ in by_formula]) / BUDGET:.0f} times (median);"
        f" {sum(low <= probability <= high for _, low, high, _ in by_formula)} intervals hold it"
    )
    scenario = scenic.scenarioFromString(CUT_IN)
    for seed in (1, 2, 3):
        result = scenic.estimate(
            scenario,
            "kinematic",
            rare=True,
            budget=BUDGET,
            seed=seed,
            timestep=STEP,
            max_steps=STEPS,
            processes=2,
        )
        plain = _plain(*result.interval, result.probability)
        assert result.rare is not None
        logarithms = result.rare.logarithms
        error = float(np.std(logarithms, ddof=1)) / math.sqrt(len(logarithms))
        as_sure = 1 / (error**2 * result.probability)
        print(
            f"  seed {seed}: {result.probability:.3g} (95% interval {result.interval}), {result.runs} runs; plain ones for such an"
            f" interval: {plain:.3g}, {plain / result.runs:.0f} times as many; for such a standard error {as_sure / result.runs:.0f} times"
        )


PARTS: Final = {"coverage": coverage, "test": bound_test, "rare": rare, "cutin": cut_in}


def main() -> None:
    """Run the parts that are named, or all."""
    parser = argparse.ArgumentParser(description="Estimates beside what is known.")
    parser.add_argument("parts", nargs="*", choices=[[], *PARTS], help="what to run; all by default")
    parser.add_argument("--repetitions", type=int, help="2,000 by default, 100 of rare problems")
    given = parser.parse_args()
    for name in given.parts or PARTS:
        PARTS[name](given.repetitions or (100 if name == "rare" else 2000))


if __name__ == "__main__":
    main()
