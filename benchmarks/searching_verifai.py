"""Runs until the first counterexample, beside VerifAI's samplers of the same names, for the problems of ``benchmarks/falsification``.

VerifAI is in a folder of its own (see ``docs/howto/falsification.md``); its `bo` needs ``verifai[bayesopt]``:

    SCENIC_VERIFAI=FOLDER python -m benchmarks.searching_verifai [--seeds 300] [--most 3000] [--problem NAME] [SAMPLER ...]

Prints for each problem and sampler the medians and means of both, the ratios ours / theirs with bootstrapped 95% intervals, and the p-value of
Mann and Whitney's test that both need equally many runs.
"""

import argparse
import os
import random
import sys
import time
from collections.abc import Callable, Iterator, Mapping
from pathlib import Path
from types import MappingProxyType
from typing import Any, Final

import numpy as np
from numpy.typing import NDArray
from scipy.stats import mannwhitneyu

import scenic
from benchmarks.falsification import problems
from scenic.falsification.samplers import make_sampler
from scenic.falsification.space import Space, space_of

FOLDER: Final = Path(__file__).parent / "falsification"
FACTORIES: Final[Mapping[str, str]] = MappingProxyType(
    {
        "random": "randomSamplerFor",
        "halton": "haltonSamplerFor",
        "ce": "crossEntropySamplerFor",
        "mab": "multiArmedBanditSamplerFor",
        "sa": "simulatedAnnealingSamplerFor",
        "bo": "bayesianOptimizationSamplerFor",
    }
)
"""Functions of VerifAI that make samplers. Its `eg` fails with an error, and it has no `cma` and `tpe`."""

OPTIONS: Final[Mapping[str, Mapping[str, Any]]] = MappingProxyType(
    {
        "halton": {"sample_index": 0, "bases_skipped": 0},
        "sa": {"T": 1.0, "decay_rate": 0.97, "iterations": 100, "num_epoch": 1_000_000},
    }
)
"""Options given to both; VerifAI has no default for them."""

Points = Callable[[float | None], "list[float]"]
"""A sampler: takes the value of its last point, and returns the next one."""


def main() -> None:
    """Print a line for each problem and sampler."""
    options = argparse.ArgumentParser(description=__doc__)
    options.add_argument("samplers", nargs="*", default=["random", "halton", "ce", "mab", "sa"])
    options.add_argument("--problem", default="*", help="of which name")
    options.add_argument("--seeds", type=int, default=300)
    options.add_argument("--most", type=int, default=3000)
    arguments = options.parse_args()
    sys.path.append(os.environ["SCENIC_VERIFAI"])
    for path in sorted(FOLDER.glob(f"{arguments.problem}.scenic")):
        space = space_of(scenic.load(path), "external")
        for name in arguments.samplers:
            seeds = range(1 if name == "halton" else arguments.seeds)
            start_time = time.process_time()
            ours = [runs(path.stem, our_points(space, name, seed), arguments.most) for seed in seeds]
            halfway = time.process_time()
            theirs = [runs(path.stem, their_points(space, name, seed), arguments.most) for seed in seeds]
            seconds = f"({halfway - start_time:.0f} s, {time.process_time() - halfway:.0f} s)"
            print(
                f"{path.stem:14} {name:6} {compared(np.array(ours), np.array(theirs))} {seconds}", flush=True
            )


def our_points(space: Space, name: str, seed: int) -> Points:
    """One of the package's samplers."""
    sampler = make_sampler(name, space, seed, OPTIONS.get(name))

    def points() -> Iterator[list[float]]:
        while True:
            place = sampler.ask(1)
            value = yield [item.value(float(place[0, k])) for k, item in enumerate(space.coordinates)]
            sampler.tell(place, np.array([value], dtype=np.float64))

    return points().send  # type: ignore[attr-defined, no-any-return]


def their_points(space: Space, name: str, seed: int) -> Points:
    """A sampler of VerifAI."""
    from dotmap import DotMap
    from verifai.features import Box, Feature, FeatureSpace
    from verifai.samplers.feature_sampler import FeatureSampler

    np.random.seed(seed)  # noqa: NPY002 - VerifAI draws from the global generators
    random.seed(seed)
    names = [f"x{place}" for place in range(len(space))]
    boxes = {
        key: Feature(Box((item.low, item.high))) for key, item in zip(names, space.coordinates, strict=True)
    }
    chosen = [DotMap(OPTIONS[name])] if name in OPTIONS else []
    sampler = getattr(FeatureSampler, FACTORIES[name])(FeatureSpace(boxes), *chosen)

    def points(feedback: float | None) -> list[float]:
        found = sampler.nextSample(feedback)
        return [float(np.ravel(getattr(found, key))[0]) for key in names]

    return points


def runs(problem: str, points: Points, most: int) -> int:
    """Return the number of points that a sampler tries until one fails."""
    value = None
    for number in range(1, most + 1):
        value = getattr(problems, problem)(*points(value))
        if value <= 0:
            return number
    return most + 1


def compared(ours: NDArray[np.int64], theirs: NDArray[np.int64]) -> str:
    """Return medians, means, and how sure their ratios are."""
    words = f"median {np.median(ours):6.1f} ({np.median(theirs):6.1f})  mean {ours.mean():6.1f} ({theirs.mean():6.1f})"
    if len(ours) == 1:
        return words
    generator = np.random.default_rng(0)
    drawn = [some[generator.integers(len(some), size=(4000, len(some)))] for some in (ours, theirs)]
    for name, measure in (("medians", np.median), ("means", np.mean)):
        ratio = measure(ours) / measure(theirs)
        low, high = np.percentile(measure(drawn[0], axis=1) / measure(drawn[1], axis=1), [2.5, 97.5])
        words += f"  {name} {ratio:.2f} ({low:.2f} to {high:.2f})"
    return f"{words}  p = {mannwhitneyu(ours, theirs).pvalue:.3f}"


if __name__ == "__main__":
    main()
