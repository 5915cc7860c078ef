"""Integers and options of choices: what cannot occur, alone or together, is dropped before anything is sampled."""

import itertools
import math
from collections import Counter

import numpy as np
import pytest
from scipy import stats

from scenic.graph.operations import TABLE
from tests.runtime.programs import scenario

EXACT = {
    "a, b, c, d = (DiscreteRange(0, 20) for i in range(4))\nrequire a + b + c + d == 23\nrequire a > b + c\nrequire c == 2 * d\nparam v = (a, b, c, d)\n": [
        (a, b, c, d) for a in range(21) for b in range(21) for c in range(21) for d in range(21)
        if a + b + c + d == 23 and a > b + c and c == 2 * d
    ],
    "n = DiscreteRange(1, 400)\nrequire n % 7 == 3\nrequire n % 5 == 2\nparam v = (n,)\n": [(n,) for n in range(1, 401) if n % 35 == 17],
    "a, b, c = (Discrete({120: 1, 350: 2, 480: 3, 760: 1, 990: 1}) for i in range(3))\nrequire 1300 <= a + b + c < 1600\nrequire a > b\nparam v = (a, b, c)\n": [
        v for v in itertools.product((120, 350, 480, 760, 990), repeat=3) if 1300 <= sum(v) < 1600 and v[0] > v[1]
    ],
    "a, b = Uniform(0.1, 0.2, 0.7), Uniform(0.1, 0.2, 0.7)\nrequire a + b == 0.3 or a + b >= 0.9\nparam v = (a, b)\n": [
        (a, b) for a in (0.1, 0.2, 0.7) for b in (0.1, 0.2, 0.7) if a + b == 0.3 or a + b >= 0.9
    ],
}  # fmt: skip
"""Programs of discrete values, with all that can occur."""


@pytest.mark.parametrize("text", list(EXACT))
def test_discrete_values_that_cannot_occur_together_are_dropped(text: str) -> None:
    program = scenario(text)
    scenes = program.sample(3000, seed=0)
    if "0.3" not in text:  # rounding may make such a sum equal or not: intervals leave that open
        assert max(scene.attempts for scene in scenes) == 1
    found = Counter(tuple(scene.params["v"]) for scene in scenes)
    assert set(found) == set(EXACT[text])
    # The weights of what is left are those of the program.
    weights = {120: 1, 350: 2, 480: 3, 760: 1, 990: 1}
    shares = np.array([math.prod(weights.get(value, 1) for value in row) for row in EXACT[text]], dtype=float)
    expected = 3000 * shares / shares.sum()
    if len(expected) > 1:
        assert stats.chisquare([found[row] for row in EXACT[text]], expected).pvalue > 1e-4


def test_cuts_are_where_values_change() -> None:
    for low, high in [(0, 6), (-3, 3), (1, 1000), (5, 104)]:
        program = scenario(f"n = DiscreteRange({low}, {high})\nparam n = n\n")
        (node,) = (item for item in program.outline.graph.nodes if item.operation.name == "discrete range")
        cuts = node.operation.cuts(node.payload, node.operands)
        count = high - low + 1
        assert len(cuts) == count - 1
        for axis, shift in ((cuts, 1), (np.nextafter(cuts, 0), 0)):
            assert (np.floor(axis * count) == np.arange(count - 1) + shift).all()
    assert [item.name for item in TABLE.values() if item.cuts is not None] == [
        "discrete range",
        "weighted integer",
        "choice",
    ]
