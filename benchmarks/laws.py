"""Compares pruned and unpruned samples: ``python -m benchmarks.laws [--scenes N]``.

Samples of programs with what analysis does and without it (Kolmogorov and Smirnov's test of every number that scenes show, and of a
mixture of them): those in ``pruning/`` whose requirements a thousandth of samples meets, others of two and three dimensions, and
pairs of both side by side, which are independent components. Also whether every scene that is found without analysis lies
in what analysis keeps. Prints each program's least p-value; p below 0.001 over the number of tests counts as a difference.
"""

import argparse
from itertools import pairwise
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray
from scipy import stats

import scenic
from scenic.graph.domain import Domain
from scenic.runtime.sampling.engine import Engine
from scenic.runtime.scenes.saving import draws_of
from scenic.runtime.scenes.scenario import Scenario

HERE = Path(__file__).parent / "pruning"

RAREST = 1e-3
"""Programs that fewer samples meet are left out: without analysis they would take too long."""

OTHERS = (
    "ego = new Object in CircularRegion((0, 0), 9)\nrequire ego.x > 4\nrequire ego.y < {}\n",
    "workspace = Workspace(RectangularRegion((0, 0), 0, 8, 8))\nego = new Object in workspace, facing Range(0, 6), with length {}\nrequire ego.x + ego.y > 2\n",
    "ego = new Object at (Range(-4, 4), Range(-4, 4), Range(0, {})), facing (Range(0, 6), Range(0, 1), 0)\nrequire ego.z > 1\nrequire ego.z > ego.x\n",
    "ego = new Object at (0, 0), with viewAngle 60 deg, with visibleDistance 9\nnew Object at (Range(-9, 9), Range(-9, {})), with requireVisible True\n",
    "floor = new Object with width 9, with length 9, with height 0.1\nnew Object on floor, with width Range(0.5, {})\n",
    "a, b = Normal(0, 1), TruncatedNormal(1, 2, -1, {})\nrequire a > b\nrequire a * a + b * b > 1\nparam v = [a, b]\n",
    "n, m = DiscreteRange(0, 9), Discrete({{1: 1, 3: 2, {}: 3}})\nrequire n % 3 == m % 3\nrequire n + m > 5\nparam v = [n, m]\n",
    "ego = new Object at (Range(-9, 9), Range(-9, 9))\nother = new Object at (Range(-9, 9), Range(-9, 9))\nrequire (distance to other) < {}\nrequire[0.5] ego.x > 0\n",
    "ego = new Object at (Range(-9, 9), Range(-9, 9)), facing Range(0, 6)\nother = new Object ahead of ego by Range(0, 4)\nrequire (relative heading of other) < 1\nrequire other.y > {}\n",
    "x = Range(0, {})\ny = Range(x, x + 2)\nrequire sin(y) > 0.9\nrequire x < y - 0.5\nparam v = [x, y]\n",
)
"""Programs of other kinds, each with a hole for a number."""


def programs() -> dict[str, str]:
    """Names and texts."""
    found = {path.stem: path.read_text() for path in sorted(HERE.glob("*.scenic"))}
    for number, text in enumerate(OTHERS):
        found |= {f"other {number}, {value}": text.format(value) for value in (2, 3.5 if number != 6 else 5)}
    lots = [
        f"for i in range(3):\n    new Object at ({50 * place} + Range(-2, 2), Range(-2, 2)), facing Range(0, 7)\n"
        for place in range(11)
    ]
    found |= {f"lots {number}": one + other for number, (one, other) in enumerate(pairwise(lots))}
    return found


def observed(scenario: Scenario, scenes: int, seed: int) -> NDArray[np.float64]:
    """The numbers that scenes show, a row each."""
    rows = []
    for scene in scenario.sample(scenes, seed=seed):
        values: list[Any] = [
            part for item in scene.objects for part in (*item.position, item.heading, item.width)
        ]
        for value in scene.params.values():
            values += value if isinstance(value, list | tuple) else [value]
        rows.append([float(value) for value in values if isinstance(value, int | float)])
    return np.array(rows)


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--scenes", type=int, default=1000, help="of each program, with analysis and without")
    given = parser.parse_args()
    tests, found, outside, compared = 0, [], 0, 0
    for name, text in programs().items():
        pruned = scenic.scenarioFromString(text)
        share = pruned.domain.volume * np.prod(
            [part.acceptance for part in pruned.estimates(seed=0, candidates=2000)]
        )
        if share < RAREST:
            continue
        plain = scenic.scenarioFromString(text)
        plan = plain.outline.plan(Domain.whole(plain.outline.graph.dimension))
        plain._sampler._finder = plain._sampler.engine = Engine(plan)
        ours, theirs = observed(pruned, given.scenes, 1), observed(plain, given.scenes, 2)
        mixture = np.arange(1, ours.shape[1] + 1)[:, np.newaxis] % 7 - 2.6
        columns = zip((*ours.T, *(ours @ mixture).T), (*theirs.T, *(theirs @ mixture).T), strict=True)
        values = [float(stats.ks_2samp(one, other).pvalue) for one, other in columns]
        graph = plain.outline.graph
        for scene in plain.sample(min(200, given.scenes), seed=3):
            numbers, _ = draws_of(scene.found, scene.lane)
            point = np.array([[numbers[graph.address(axis)] for axis in graph.axes]])
            outside += not pruned.domain.contains(point).all()
            compared += 1
        tests += len(values)
        found.append((min(values), name))
        print(
            f"{name:24} kept {pruned.domain.volume:9.3g}, acceptance before {share:9.3g}, least p {min(values):.4f}",
            flush=True,
        )
    differing = [name for value, name in found if value < 1e-3 / tests]
    print(f"{len(found)} programs, {tests} tests: {len(differing)} differ {differing}")
    print(f"{outside} of {compared} scenes found without analysis lie outside of what it keeps")


if __name__ == "__main__":
    main()
