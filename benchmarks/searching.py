"""Runs until the first counterexample, by sampler: medians over seeds, for the problems of ``benchmarks/falsification``.

python -m benchmarks.searching [--seeds 20] [--most 2000] [--share] [SAMPLER ...]
"""

import argparse
import statistics
import time
from pathlib import Path

import scenic

FOLDER = Path(__file__).parent / "falsification"


def main() -> None:
    """Print a table."""
    options = argparse.ArgumentParser()
    options.add_argument(
        "samplers", nargs="*", default=["random", "halton", "ce", "mab", "eg", "sa", "cma", "tpe", "bo"]
    )
    options.add_argument("--problem", default="*", help="of which name")
    options.add_argument("--seeds", type=int, default=20)
    options.add_argument("--most", type=int, default=2000)
    options.add_argument(
        "--share", action="store_true", help="the share of failing points, of 20,000, instead"
    )
    arguments = options.parse_args()
    for path in sorted(FOLDER.glob(f"{arguments.problem}.scenic")):
        scenario = scenic.load(path)
        if arguments.share:
            result = scenic.falsify(
                scenario, objective="robustness", static=True, sampler="random", n=20000, seed=0
            )
            print(
                f"{path.stem:16} share {result.share()[0]:.5f} least {result.best['values'][0]:.4f}",
                flush=True,
            )
            continue
        for sampler in arguments.samplers:
            start_time, counts = time.process_time(), []
            for seed in range(arguments.seeds):
                result = scenic.falsify(
                    scenario,
                    objective="robustness",
                    static=True,
                    sampler=sampler,
                    n=arguments.most,
                    seed=seed,
                    stop_after=1,
                    batch=None if sampler == "cma" else 1 if sampler != "random" else 64,
                )
                first = result.counterexamples[:1] and min(row["run"] for row in result.counterexamples)
                counts.append(first + 1 if result.counterexamples else arguments.most + 1)
            seconds = time.process_time() - start_time
            print(
                f"{path.stem:16} {sampler:8} median {statistics.median(counts):7.1f}  ({seconds:.1f} s)",
                flush=True,
            )


if __name__ == "__main__":
    main()
