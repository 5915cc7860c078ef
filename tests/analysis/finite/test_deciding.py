"""Programs whose discrete values are coupled: candidates, laws against enumeration, independence of batches and pruning."""

from collections.abc import Callable, Sequence
from itertools import pairwise, product
from typing import Any

import numpy as np
import pytest
from scipy import stats

import scenic
from scenic.analysis.finite import solving
from scenic.graph.finite import Distinct
from scenic.runtime.scenes.scenario import Scenario
from tests.amounts import amount
from tests.runtime.programs import unpruned

SCENES = amount(1500, 20_000)
FALSE_ALARM = 1e-3 / 60
"""Of each test of a law; there are about 60 of them."""

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
DIGIT = {0: 1.0, 1: 3.0, 2: 1.0, 3: 2.0, 4: 1.0, 5: 4.0}
DIGITS = f"""
d = [Discrete({DIGIT}) for i in range(4)]
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
MAGIC_VALUES = {1: 1.0, 2: 2.0, 3: 3.0, 4: 1.0, 5: 2.0, 6: 3.0}
MAGIC = f"""
x = [Discrete({MAGIC_VALUES}) for i in range(4)]
for i in range(4):
    for j in range(i):
        require x[i] != x[j]
require x[0] + x[1] == x[2] + x[3]
param v = x
"""
COLOR = {"r": 1.0, "g": 2.0, "b": 2.0, "y": 3.0}
CLUES = f"""
c = [Discrete({COLOR}) for i in range(4)]
def score(code, guess):
    return sum(1 for a, b in zip(code, guess) if a == b)
require score(c, 'rgby') == 1
require score(c, 'rrgg') == 2
param v = c
"""
NESTED = """
kind = Discrete({'car': 3, 'bus': 1})
lane = Discrete({0: 2, 1: 1, 2: 1})
side = Discrete({-1: 2, 1: 1})
require kind != 'bus' or lane == 0
require lane != 2 or (side == 1 and kind == 'car')
param v = (kind, lane, side)
"""
ONE = """
s = [Discrete({1: 1, 0: 3}) for i in range(7)]
require sum(s) == 1
param v = s
"""
STEPS = {0: 4.0, 1: 1.0, 2: 1.0, 3: 2.0, 4: 1.0, 5: 3.0, 6: 1.0, 7: 1.0}
EXTREMES = f"""
a, b, c = [Discrete({STEPS}) for i in range(3)]
require max(a, b, c) - min(a, b, c) == 5
param v = (a, b, c)
"""
TILES = {(0, 0): 1.0, (0, 1): 2.0, (1, 2): 3.0, (2, 0): 1.0, (1, 1): 2.0}
DOMINOES = f"""
d = [Discrete({TILES}) for i in range(4)]
for i in range(3):
    require d[i][1] == d[i + 1][0]
param v = d
"""
PLACES = {0: 3.0, 1: 1.0, 2: 2.0, 3: 1.0}
WIDTHS = {1.8: 2.0, 2.2: 1.0, 2.5: 1.0}
PARKING = f"""
s = [Discrete({PLACES}) for i in range(3)]
w = [Discrete({WIDTHS}) for i in range(3)]
for i in range(3):
    require w[i] < 2 + 0.3 * (s[i] % 3)
    for j in range(i):
        require s[i] != s[j]
param v = (*s, *w)
"""
HOURS = {8: 2.0, 9: 1.0, 10: 1.0}
ROOMS = {"a": 1.0, "b": 2.0}
TIMETABLE = f"""
t = [Discrete({HOURS}) for i in range(4)]
r = [Discrete({ROOMS}) for i in range(4)]
for i in range(4):
    for j in range(i):
        require t[i] != t[j] or r[i] != r[j]
require t[0] < t[1]
require t[2] < t[3]
param v = (*t, *r)
"""
SEATS = {0: 1.0, 1: 2.0, 2: 1.0, 3: 3.0, 4: 1.0}
SEATING = f"""
s = [Discrete({SEATS}) for i in range(5)]
for i in range(5):
    for j in range(i):
        require s[i] != s[j]
require abs(s[0] - s[1]) == 1
require s[2] < s[3]
param v = s
"""
LATIN_VALUES = {1: 1.0, 2: 2.0, 3: 1.0}
LATIN = f"""
x = [[Discrete({LATIN_VALUES}) for j in range(3)] for i in range(3)]
for i in range(3):
    for j in range(3):
        for k in range(j):
            require x[i][j] != x[i][k]
            require x[j][i] != x[k][i]
param v = [value for row in x for value in row]
"""
EDGES = [(0, 1), (1, 2), (2, 3), (3, 4), (4, 0), (0, 5), (5, 2), (5, 3)]
PAINT = {"red": 1.0, "green": 2.0, "blue": 3.0}
COLORING = f"""
c = [Discrete({PAINT}) for i in range(6)]
for a, b in {EDGES}:
    require c[a] != c[b]
param v = c
"""
FORBIDDEN = f"""
s = [Discrete({SEATS}) for i in range(5)]
for i in range(5):
    require s[i] != i
    for j in range(i):
        require s[i] != s[j]
param v = s
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
        [DIGIT] * 4,
        lambda *d: sum(d) == 10 and all((a + b) % 2 for a, b in pairwise(d)),
    ),
    "different": (
        DIFFERENT,
        [{1: 1.0, 2: 2.0, 3: 3.0, 4: 1.0, 5: 1.0}] * 4,
        lambda *x: differ(*x) and x[0] != 2,
    ),
    "magic": (MAGIC, [MAGIC_VALUES] * 4, lambda *x: differ(*x) and x[0] + x[1] == x[2] + x[3]),
    "clues": (
        CLUES,
        [COLOR] * 4,
        lambda *c: sum(map(str.__eq__, c, "rgby")) == 1 and sum(map(str.__eq__, c, "rrgg")) == 2,
    ),
    "nested": (
        NESTED,
        [{"car": 3.0, "bus": 1.0}, {0: 2.0, 1: 1.0, 2: 1.0}, {-1: 2.0, 1: 1.0}],
        lambda kind, lane, side: (
            (kind != "bus" or lane == 0) and (lane != 2 or (side == 1 and kind == "car"))
        ),
    ),
    "one of many": (ONE, [{1: 1.0, 0: 3.0}] * 7, lambda *s: sum(s) == 1),
    "extremes": (EXTREMES, [STEPS] * 3, lambda *x: max(x) - min(x) == 5),
    "dominoes": (
        DOMINOES,
        [TILES] * 4,
        lambda *d: all(a[1] == b[0] for a, b in pairwise(d)),
    ),
    "parking": (
        PARKING,
        [PLACES] * 3 + [WIDTHS] * 3,
        lambda *v: differ(*v[:3]) and all(w < 2 + 0.3 * (s % 3) for s, w in zip(v[:3], v[3:], strict=True)),
    ),
    "timetable": (
        TIMETABLE,
        [HOURS] * 4 + [ROOMS] * 4,
        lambda *v: differ(*zip(v[:4], v[4:], strict=True)) and v[0] < v[1] and v[2] < v[3],
    ),
    "seating": (
        SEATING,
        [SEATS] * 5,
        lambda *s: differ(*s) and abs(s[0] - s[1]) == 1 and s[2] < s[3],
    ),
    "Latin square": (
        LATIN,
        [LATIN_VALUES] * 9,
        lambda *x: all(differ(*x[3 * i : 3 * i + 3]) and differ(*x[i::3]) for i in range(3)),
    ),
    "coloring": (COLORING, [PAINT] * 6, lambda *c: all(c[a] != c[b] for a, b in EDGES)),
    "forbidden places": (
        FORBIDDEN,
        [SEATS] * 5,
        lambda *s: differ(*s) and all(value != place for place, value in enumerate(s)),
    ),
}
OCCUPYING = ("different", "magic", "parking", "timetable", "seating", "forbidden places")
"""Programs with values that differ."""


@pytest.mark.parametrize("name", CASES)
def test_laws_are_exact(name: str) -> None:
    text, values, holds = CASES[name]
    scenario = scenic.scenarioFromString(text)
    scenes = list(scenario.stream(SCENES, seed=3))
    assert np.mean([scene.attempts for scene in scenes]) == 1
    exact = law(values, holds)
    check_law([tuple(scene.params["v"]) for scene in scenes], exact)


@pytest.mark.parametrize("name", OCCUPYING)
def test_laws_of_values_that_differ_are_exact(name: str, monkeypatch: pytest.MonkeyPatch) -> None:
    """Small problems are listed or eliminated otherwise."""
    monkeypatch.setattr(solving, "_listed", lambda *_: None)
    monkeypatch.setattr(solving, "_eliminated", lambda *_: None)
    text, values, holds = CASES[name]
    scenario = scenic.scenarioFromString(text)
    assert any(isinstance(part.law, Distinct) for part in scenario.domain.finite)
    check_law(drawn(scenario), law(values, holds))


@pytest.mark.parametrize("name", CASES)
def test_laws_without_pruning_are_equal(name: str) -> None:
    text, values, holds = CASES[name]
    assert scenic.scenarioFromString(text).domain.finite
    program = unpruned(text)
    assert not program.domain.finite
    check_law(drawn(program, 400), law(values, holds))


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


def test_scenes_do_not_depend_on_batches(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(solving, "_listed", lambda *_: None)
    monkeypatch.setattr(solving, "_eliminated", lambda *_: None)
    scenario = scenic.scenarioFromString(TIMETABLE)
    monkeypatch.setattr("scenic.graph.finite._MOST_ENTRIES", 30)
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
