"""Joint laws of discrete values, compared with enumeration."""

import math
from itertools import product

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy import stats

from scenic.graph.finite import BoundedDistinct

FALSE_ALARM = 1e-6

Tables = list[dict[tuple[int, int], float]]


def bounded(variables: list[list[tuple[int, float]]], width: int) -> BoundedDistinct:
    """The law of variables whose values have labels and weights; the first two share a label."""
    labels = tuple(np.array([label for label, _ in values], dtype=np.intp) for values in variables)
    weights = tuple(np.array([weight for _, weight in values]) for values in variables)
    shared = next(iter(set(labels[0].tolist()) & set(labels[1].tolist())))
    clash = np.zeros(len(variables), dtype=np.intp)
    clash[0], clash[1] = labels[0].tolist().index(shared), labels[1].tolist().index(shared)
    return BoundedDistinct(labels, weights, width, clash)


def exact(law: BoundedDistinct) -> dict[tuple[int, ...], float]:
    """The weights of the combinations without a label twice."""
    found = {}
    for row in product(*(range(len(labels)) for labels in law.labels)):
        used = [labels[value] for labels, value in zip(law.labels, row, strict=True)]
        weight = math.prod(weights[value] for weights, value in zip(law.weights, row, strict=True))
        if len(set(used)) == len(used) and weight > 0:
            found[row] = weight
    return found


@st.composite
def laws(draw: st.DrawFn) -> BoundedDistinct:
    width = draw(st.integers(2, 5))
    count = draw(st.integers(2, min(4, width)))
    weights = st.sampled_from([0.0, 0.25, 0.5, 1.0])
    variables = []
    for _ in range(count):
        values = draw(st.lists(st.tuples(st.integers(0, width - 1), weights), min_size=1, max_size=5))
        variables.append([(0, 1.0), *values])
    return bounded(variables, width)


@settings(max_examples=25, deadline=None)
@given(laws())
def test_accepted_draws_follow_the_exact_law(law: BoundedDistinct) -> None:
    count = 4000
    rows = law.choose(np.random.default_rng(1).random((law.numbers, count))).T.tolist()
    weights = exact(law)
    found = [tuple(row) for row in rows if tuple(row) in weights]
    clash = tuple(law.clash.tolist())
    assert all(tuple(row) in weights or tuple(row) == clash for row in rows)
    total = sum(weights.values())
    if not weights:
        assert not found
        return
    # The share that is accepted is what the bound promises.
    largest = math.prod(
        np.bincount(labels, weights=each).max() for labels, each in zip(law.labels, law.weights, strict=True)
    )
    share = total / (largest * math.exp(law.bound))
    assert 0 < share <= 1 + 1e-9
    assert stats.binomtest(len(found), count, min(share, 1.0)).pvalue > FALSE_ALARM
    expected = [weight / total * len(found) for weight in weights.values()]
    observed = [found.count(row) for row in weights]
    often = [place for place, each in enumerate(expected) if each >= 5]
    rest = len(found) - sum(observed[place] for place in often)
    left = len(found) - sum(expected[place] for place in often)
    counts, means = [observed[place] for place in often], [expected[place] for place in often]
    if left >= 5:
        counts, means = [*counts, rest], [*means, left]
    elif counts:
        counts[-1] += rest
        means[-1] += left
    if len(counts) > 1:
        assert stats.chisquare(counts, means).pvalue > FALSE_ALARM


@pytest.mark.parametrize(("count", "width", "accepted"), [(30, 30, 0.5), (26, 30, 0.5), (40, 64, 0.4)])
def test_dense_problems_are_seldom_rejected(count: int, width: int, accepted: float) -> None:
    law = bounded([[(label, 1.0) for label in range(width)]] * count, width)
    rows = law.choose(np.random.default_rng(2).random((law.numbers, 200))).T
    differ = np.array([len(set(row)) == count for row in rows.tolist()])
    assert differ.mean() > accepted


def test_a_lane_does_not_depend_on_the_others() -> None:
    law = bounded([[(label, 1.0 + label % 3) for label in range(24)]] * 22, 24)
    draws = np.random.default_rng(3).random((law.numbers, 50))
    together = law.choose(draws)
    alone = np.concatenate([law.choose(draws[:, lane : lane + 1]) for lane in range(50)], axis=1)
    assert np.array_equal(together, alone)
