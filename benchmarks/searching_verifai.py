"""The problems of `benchmarks.searching` with VerifAI's own samplers: runs until the first counterexample, medians over seeds.

VerifAI is in a folder of its own (see ``docs/howto/falsification.md``):

    SCENIC_VERIFAI=FOLDER python -m benchmarks.searching_verifai [--seeds 20] [--most 2000] [SAMPLER ...]
"""

import argparse
import os
import random
import re
import statistics
import sys
from pathlib import Path
from typing import Any

import numpy as np

from benchmarks.falsification import problems

FOLDER = Path(__file__).parent / "falsification"


def main() -> None:
    """Print a table."""
    options = argparse.ArgumentParser(description=__doc__)
    options.add_argument("samplers", nargs="*", default=["random", "halton", "ce", "mab"])
    options.add_argument("--problem", default="*", help="of which name")
    options.add_argument("--seeds", type=int, default=20)
    options.add_argument("--most", type=int, default=2000)
    given = options.parse_args()
    sys.path.append(os.environ["SCENIC_VERIFAI"])
    for path in sorted(FOLDER.glob(f"{given.problem}.scenic")):
        ranges = re.findall(r"VerifaiRange\(([-\d.]+), ([-\d.]+)\)", path.read_text())
        for name in given.samplers:
            counts = [runs(path.stem, ranges, name, seed, given.most) for seed in range(given.seeds)]
            print(f"{path.stem:16} {name:8} median {statistics.median(counts):7.1f}", flush=True)


def runs(problem: str, ranges: list[Any], name: str, seed: int, most: int) -> int:
    """Return the number of points that a sampler tries until one fails."""
    from dotmap import DotMap
    from verifai.features import Box, Feature, FeatureSpace
    from verifai.samplers.feature_sampler import FeatureSampler

    np.random.seed(seed)  # noqa: NPY002 - VerifAI draws from the global generators
    random.seed(seed)
    space = FeatureSpace(
        {f"x{place}": Feature(Box((float(low), float(high)))) for place, (low, high) in enumerate(ranges)}
    )
    sampler: Any = {
        "random": FeatureSampler.randomSamplerFor,
        "ce": FeatureSampler.crossEntropySamplerFor,
        "mab": FeatureSampler.multiArmedBanditSamplerFor,
        "halton": lambda space: FeatureSampler.haltonSamplerFor(
            space, halton_params=DotMap(sample_index=0, bases_skipped=0)
        ),
    }[name](space)
    feedback = None
    for number in range(1, most + 1):
        point = sampler.nextSample(feedback)
        values = [float(np.ravel(getattr(point, f"x{place}"))[0]) for place in range(len(ranges))]
        feedback = getattr(problems, problem)(*values)
        if feedback <= 0:
            return number
    return most + 1


if __name__ == "__main__":
    main()
