"""Compares external parameters with those of the reference, which needs VerifAI in its environment:

    python -m benchmarks.external_laws --reference COMMAND [--scenes 3000]

A program with every kind of external parameter is sampled by both under `random` and `halton`. Prints the p-value of a two-sample test
for each parameter (Kolmogorov and Smirnov's, of discrete values chi-squared), and how far the points of Halton's sequence differ.
"""

import argparse
import json
import shlex
import subprocess
import tempfile
from collections import Counter
from pathlib import Path
from typing import Any, Final

from scipy.stats import chi2_contingency, ks_2samp

import scenic

PROGRAM: Final = """
x = VerifaiRange(2, 5)
p = VerifaiParameter.withPrior(Normal(0, 1))
y = VerifaiRange(0, 1, weights=[1, 2, 3])
d = VerifaiDiscreteRange(1, 4, weights=[1, 1, 3, 2])
e = VerifaiDiscreteRange(-1, 3)
o = VerifaiOptions({10: 1, 20: 2, 30: 1})
w = VerifaiParameter.withPrior(Normal(10, 2), buckets=4)
t = VerifaiParameter.withPrior(TruncatedNormal(0, 1, -1, 2))
r = VerifaiParameter.withPrior(Range(2, 6))
z = VerifaiRange(-4, 4, buckets=3)
q = VerifaiParameter.withPrior(Discrete({1: 2, 3: 1}))
param x = x, y = y, z = z, d = d, e = e, o = o, p = p, w = w, t = t, r = r, q = q
ego = new Object
"""
"""Every kind but `TimeSeries`, which this version of the reference does not know."""

ON_THE_SEQUENCE: Final = "xyz"


def main() -> None:
    """Print a line for each sampler and parameter."""
    options = argparse.ArgumentParser(description=__doc__)
    options.add_argument("--reference", required=True)
    options.add_argument("--scenes", type=int, default=3000)
    arguments = options.parse_args()
    for sampler in ("random", "halton"):
        scenario = scenic.scenarioFromString(PROGRAM, params={"verifaiSamplerType": sampler})
        ours = [scenario.generate()[0].params for _ in range(arguments.scenes)]
        theirs = reference(arguments.reference, sampler, arguments.scenes)
        for name in "xyzdeopwtrq":
            first, second = ([float(row[name]) for row in rows] for rows in (ours, theirs))
            words = f"{sampler:7} {name} p = {p_value(first, second):.3f}"
            if sampler == "halton" and name in ON_THE_SEQUENCE:
                words += f", differs by {max(abs(a - b) for a, b in zip(first, second, strict=True)):.1e}"
            print(words, flush=True)


def reference(command: str, sampler: str, scenes: int) -> list[dict[str, Any]]:
    """The parameters of the reference's scenes."""
    with tempfile.TemporaryDirectory() as folder:
        program = Path(folder) / "program.scenic"
        program.write_text(PROGRAM)
        arguments = [
            str(program),
            "-n",
            str(scenes),
            "--seed",
            "1",
            "--param",
            f"verifaiSamplerType={sampler}",
        ]
        done = subprocess.run([*shlex.split(command), *arguments], check=True, capture_output=True, text=True)
    return [json.loads(line)["params"] for line in done.stdout.splitlines()]


def p_value(first: list[float], second: list[float]) -> float:
    """Return the p-value of the difference of two samples, if both have one law."""
    values = sorted({*first, *second})
    if len(values) > 10:
        return float(ks_2samp(first, second).pvalue)
    counts = [Counter(first), Counter(second)]
    return float(chi2_contingency([[count[value] for value in values] for count in counts])[1])


if __name__ == "__main__":
    main()
