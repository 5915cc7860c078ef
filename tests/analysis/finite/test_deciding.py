"""Programs whose discrete values are coupled: candidates, laws against enumeration, independence of batches and pruning."""

from collections.abc import Callable, Sequence
from itertools import pairwise, product
from typing import Any

import numpy as np
import pytest
from scipy import stats

import scenic
from scenic.runtime.scenes.scenario import Scenario
from tests.amounts import amount
from tests.runtime.programs import unpruned

SCENES = amount(1500, 20_000)
FALSE_ALARM = 1e-3 / 40
"""Of each test of a law; there are about 40 of them."""

Values = Sequence[dict[Any, float]]
"""For each variable the weights of its values."""


def even(*values: Any) -> dict[Any, float]:
    return dict.fromkeys(values, 1.0)


def law(values: Values, holds: Callable[..., bool]) -> dict[tuple[Any, ...], float]:
    """The exact law of the combinations that hold, by enumeration."""
    weights = {
        row: float(np.prod([each[value] for each, value in zip(values, row, strict=True)]))
        for row in product(*values)
        if holds(*row)
    }
    total = sum(weights.values())
    return {row: weight / total for row, weight in weights.items()}


def drawn(scenario: Scenario, count: int = SCENES, seed: int = 3) -> list[tuple[Any, ...]]:
    return [tuple(scene.params["v"]) for scene in scenario.stream(count, seed=seed)]


def check_law(found: Sequence[tuple[Any, ...]], exact: dict[tuple[Any, ...], float]) -> None:
    """Chi-square of the counts, with rare combinations pooled."""
    counts = dict.fromkeys(exact, 0)
    for row in found:
        counts[row] += 1  # a row that does not hold is a KeyError
    often = [row for row in exact if exact[row] * len(found) >= 5]
    observed = [counts[row] for row in often]
    expected = [exact[row] * len(found) for row in often]
    if len(found) - sum(expected) >= 5:
        observed.append(len(found) - sum(observed))
        expected.append(len(found) - sum(expected))
    elif expected:
        expected[-1] += len(found) - sum(expected)
        observed[-1] += len(found) - sum(observed)
    assert len(expected) > 1
    assert stats.chisquare(observed, expected).pvalue > FALSE_ALARM


def differ(*values: Any) -> bool:
    return len(set(values)) == len(values)


SWITCH = {True: 1.0, False: 2.0}
SWITCHES = """
s = [Discrete({True: 1, False: 2}) for i in range(6)]
for i in range(5):
    require (not s[i]) or s[i + 1]
param v = s
"""
RING = """
c = [Discrete({'red': 1, 'green': 2, 'blue': 3}) for i in range(6)]
for i in range(6):
    require c[i] != c[(i + 1) % 6]
param v = c
"""
DIGITS = """
d = [DiscreteRange(0, 5) for i in range(4)]
require sum(d) == 10
for i in range(3):
    require (d[i] + d[i + 1]) % 2 == 1
param v = d
"""
DIFFERENT = """
x = [Discrete({1: 1, 2: 2, 3: 3, 4: 1, 5: 1}) for i in range(4)]
for i in range(4):
    for j in range(i):
        require x[i] != x[j]
require x[0] != 2
param v = x
"""
MAGIC = """
x = [DiscreteRange(1, 6) for i in range(4)]
for i in range(4):
    for j in range(i):
        require x[i] != x[j]
require x[0] + x[1] == x[2] + x[3]
param v = x
"""
CLUES = """
c = [Uniform(*'rgby') for i in range(4)]
def score(code, guess):
    return sum(1 for a, b in zip(code, guess) if a == b)
require score(c, 'rgby') == 1
require score(c, 'rrgg') == 2
param v = c
"""
NESTED = """
kind = Discrete({'car': 3, 'bus': 1})
lane = Discrete({0: 2, 1: 1, 2: 1})
side = Uniform(-1, 1)
require kind != 'bus' or lane == 0
require lane != 2 or (side == 1 and kind == 'car')
param v = (kind, lane, side)
"""
ONE = """
s = [Discrete({1: 1, 0: 3}) for i in range(7)]
require sum(s) == 1
param v = s
"""
EXTREMES = """
a, b, c = DiscreteRange(0, 7), DiscreteRange(0, 7), DiscreteRange(0, 7)
require max(a, b, c) - min(a, b, c) == 5
param v = (a, b, c)
"""
DOMINOES = """
tiles = [(0, 0), (0, 1), (1, 2), (2, 0), (1, 1)]
d = [Uniform(*tiles) for i in range(4)]
for i in range(3):
    require d[i][1] == d[i + 1][0]
param v = d
"""

CASES: dict[str, tuple[str, Values, Callable[..., bool]]] = {
    "switches": (SWITCHES, [SWITCH] * 6, lambda *s: all(not a or b for a, b in pairwise(s))),
    "ring": (
        RING,
        [{"red": 1.0, "green": 2.0, "blue": 3.0}] * 6,
        lambda *c: all(a != b for a, b in zip(c, c[1:] + c[:1], strict=True)),
    ),
    "digits": (
        DIGITS,
        [even(*range(6))] * 4,
        lambda *d: sum(d) == 10 and all((a + b) % 2 for a, b in pairwise(d)),
    ),
    "different": (
        DIFFERENT,
        [{1: 1.0, 2: 2.0, 3: 3.0, 4: 1.0, 5: 1.0}] * 4,
        lambda *x: differ(*x) and x[0] != 2,
    ),
    "magic": (MAGIC, [even(*range(1, 7))] * 4, lambda *x: differ(*x) and x[0] + x[1] == x[2] + x[3]),
    "clues": (
        CLUES,
        [even(*"rgby")] * 4,
        lambda *c: sum(map(str.__eq__, c, "rgby")) == 1 and sum(map(str.__eq__, c, "rrgg")) == 2,
    ),
    "nested": (
        NESTED,
        [{"car": 3.0, "bus": 1.0}, {0: 2.0, 1: 1.0, 2: 1.0}, even(-1, 1)],
        lambda kind, lane, side: (
            (kind != "bus" or lane == 0) and (lane != 2 or (side == 1 and kind == "car"))
        ),
    ),
    "one of many": (ONE, [{1: 1.0, 0: 3.0}] * 7, lambda *s: sum(s) == 1),
    "extremes": (EXTREMES, [even(*range(8))] * 3, lambda *x: max(x) - min(x) == 5),
    "dominoes": (
        DOMINOES,
        [even((0, 0), (0, 1), (1, 2), (2, 0), (1, 1))] * 4,
        lambda *d: all(a[1] == b[0] for a, b in pairwise(d)),
    ),
}


@pytest.mark.parametrize("name", CASES)
def test_laws_are_exact(name: str) -> None:
    text, values, holds = CASES[name]
    scenario = scenic.scenarioFromString(text)
    scenes = list(scenario.stream(SCENES, seed=3))
    assert np.mean([scene.attempts for scene in scenes]) == 1
    exact = law(values, holds)
    check_law([tuple(scene.params["v"]) for scene in scenes], exact)


@pytest.mark.parametrize("name", ["nested", "different", "clues"])
def test_laws_without_pruning_are_equal(name: str) -> None:
    text, values, holds = CASES[name]
    prune = scenic.scenarioFromString(text)
    assert prune.domain.finite
    found = drawn(unpruned(text), 400)
    check_law(found, law(values, holds))


SLOTS = """
slots = [(4 * i, 0) for i in range({count})]
new Object at Uniform(*slots), with width 2
for i in range({count} - 1):
    new Object at Uniform(*slots), with width Uniform(1, 2), with yaw Range(-5, 5) deg
"""


@pytest.mark.parametrize("count", [3, 16])
def test_objects_that_differ_take_slots_evenly(count: int) -> None:
    scenario = scenic.scenarioFromString(SLOTS.format(count=count))
    scenes = list(scenario.stream(600, seed=1))
    assert np.mean([scene.attempts for scene in scenes]) == 1
    places = np.array([[round(item.position.x / 4) for item in scene.objects] for scene in scenes])
    assert all(len(set(row)) == count for row in places.tolist())
    for column in places.T[:3]:
        assert stats.chisquare(np.bincount(column, minlength=count)).pvalue > FALSE_ALARM
    pairs = places[:, 0] * count + places[:, 1]
    different = [one * count + other for one in range(count) for other in range(count) if one != other]
    assert stats.chisquare(np.bincount(pairs, minlength=count**2)[different]).pvalue > FALSE_ALARM


def test_many_values_that_differ_are_drawn_under_a_bound() -> None:
    scenario = scenic.scenarioFromString(
        "x = [DiscreteRange(1, 24) for i in range(22)]\n"
        "for i in range(22):\n    require x[i] != 1 + i\n    for j in range(i):\n        require x[i] != x[j]\n"
        "param v = x\n"
    )
    scenes = list(scenario.stream(400, seed=1))
    rows = np.array([scene.params["v"] for scene in scenes])
    assert all(len(set(row)) == 22 for row in rows.tolist())
    assert (rows != np.arange(1, 23)).all()
    assert np.mean([scene.attempts for scene in scenes]) < 3
    # The first one may not be 1; the others' own places are alike, and so are the two that nobody must leave out.
    counts = np.bincount(rows[:, 0], minlength=25)[1:]
    assert counts[0] == 0
    assert stats.chisquare(counts[1:22]).pvalue > FALSE_ALARM
    assert stats.chisquare(counts[22:]).pvalue > FALSE_ALARM
    lanes = list(scenario.stream(30, seed=1, lanes=7))
    assert [tuple(scene.params["v"]) for scene in lanes] == [tuple(row) for row in rows[:30].tolist()]


def test_more_values_that_differ_than_there_are_have_no_scene() -> None:
    scenario = scenic.scenarioFromString(
        "x = [DiscreteRange(1, 22) for i in range(23)]\n"
        "for i in range(23):\n    for j in range(i):\n        require x[i] != x[j]\n"
    )
    assert scenario.impossible


def test_scenes_do_not_depend_on_batches() -> None:
    scenario = scenic.scenarioFromString(DIFFERENT)
    every = drawn(scenario, 40, seed=9)
    for lanes in (1, 7):
        rows = [tuple(scene.params["v"]) for scene in scenario.stream(40, seed=9, lanes=lanes)]
        assert rows == every
    alone = [next(iter(scenario.stream(1, seed=9, first=k))).params["v"] for k in range(0, 40, 13)]
    assert [tuple(row) for row in alone] == every[::13]


def test_a_program_without_solutions_names_a_minimal_set() -> None:
    text = (
        "a, b, c = DiscreteRange(0, 1), DiscreteRange(0, 1), DiscreteRange(0, 1)\n"
        "require a != b as first\nrequire b != c as second\nrequire c != a as third\nrequire a + b + c < 3 as fourth\n"
    )
    scenario = scenic.scenarioFromString(text)
    assert set(scenario.impossible) == {"first", "second", "third"}


def test_what_gains_nothing_is_left_alone() -> None:
    scenario = scenic.scenarioFromString(
        "a, b = DiscreteRange(0, 9), DiscreteRange(0, 9)\nrequire a + b > 2\n"
    )
    assert scenario.domain.is_whole


def test_code_that_draws_or_prints_is_not_tabulated(capsys: pytest.CaptureFixture[str]) -> None:
    draws = "import random\na = DiscreteRange(0, 9)\ndef f(x): return x > 5 and random.random() < 0.5\nrequire f(a)\n"
    assert not scenic.scenarioFromString(draws).domain.finite
    prints = "a = DiscreteRange(0, 9)\ndef f(x):\n    print('seen')\n    return x > 5\nrequire f(a)\n"
    assert not scenic.scenarioFromString(prints).domain.finite
    assert capsys.readouterr().out == ""
