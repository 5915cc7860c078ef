"""Reports on the finite part of programs: solutions, dead options, contradictions."""

from pathlib import Path

import pytest

import scenic
from scenic.analysis.finite.explaining import findings, left_to_chance
from scenic.narrowing import decision_of

LATIN = """
x = [[DiscreteRange(1, 4) for j in range(4)] for i in range(4)]
for i in range(4):
    for j in range(4):
        for k in range(j):
            require x[i][j] != x[i][k]
            require x[j][i] != x[k][i]
"""
SEATS = """
s = [DiscreteRange(0, 6) for i in range(5)]
for i in range(5):
    for j in range(i):
        require s[i] != s[j]
"""


@pytest.mark.parametrize(("text", "solutions", "combinations"), [(LATIN, 576, 4**16), (SEATS, 2520, 7**5)])
def test_solutions_are_counted(text: str, solutions: int, combinations: int) -> None:
    outlined = scenic.scenarioFromString(text).outline
    (found,) = findings(decision_of(outlined), outlined.checks)
    assert round(found.solutions) == solutions
    assert found.combinations == combinations
    assert not found.left
    assert f"{solutions} of" in str(found)


def test_what_is_left_to_chance_is_named() -> None:
    text = "a, b, c = Uniform(1, 2), Uniform(1, 2), Range(0, 4)\nrequire a != b as apart\nrequire c > a + b as above\n"
    outlined = scenic.scenarioFromString(text).outline
    decision = decision_of(outlined)
    assert [outlined.checks[number].label for number in decision.left] == ["above"]
    assert "apart" in {outlined.checks[number].label for number in decision.settled}


def test_boxes_with_continuous_values_are_preferred_where_they_leave_less() -> None:
    text = "v, w = Uniform(5, 8, 13, 21), Uniform(5, 8, 13, 21)\nt = Range(0, 100)\nrequire 990 < (v + w) * t < 1000\nrequire w > v\n"
    scenario = scenic.scenarioFromString(text)
    assert not scenario.domain.finite
    assert sum(scene.attempts for scene in scenario.stream(100, seed=1)) < 120
    outlined = scenario.outline
    (found,) = findings(decision_of(outlined), outlined.checks, scenario.domain)
    assert str(found) == "2 discrete values: 6 of 16 combinations, drawn in boxes with continuous values"


REASONS = {
    "c > a + b": "it depends on values that are not discrete, too",
    "sum(k for k in many if same(k)) == 3": "its 9 values have 19,683 combinations, of which at most 8,192 are tried where code of "
    "the program is called",
    "noisy(a)": "it draws random numbers by itself, or fails for some combination",
    "shown(a)": "it calls code that prints, asks or draws",
}


@pytest.mark.parametrize("condition", REASONS)
def test_the_reason_why_something_is_left_to_chance_is_given(condition: str) -> None:
    text = (
        "import random\ndef same(k): return k > 0\ndef noisy(k): return random.random() < 0.1 * k\n"
        "def shown(k):\n    print(k)\n    return k > 1\n"
        "a, b, c = Uniform(1, 2), Uniform(1, 2), Range(0, 4)\nmany = [Uniform(0, 1, 2) for i in range(9)]\n"
        f"require a + b == 3\nrequire {condition}\n"
    )
    outlined = scenic.scenarioFromString(text).outline
    (left,) = left_to_chance(decision_of(outlined), outlined.checks)
    assert left.line == 10
    assert left.reason == REASONS[condition]
    assert str(left) == f"left to chance: requirement on line 10: {left.reason}"


def deep(tmp_path: Path, text: str) -> list[tuple[str, int]]:
    from scenic.deep.findings import deep_check

    (tmp_path / "program.scenic").write_text(text)
    found = deep_check(tmp_path / "program.scenic")
    return [(item.code, 0 if item.span is None else item.span.line) for item in found]


def test_options_that_no_solution_has_are_reported(tmp_path: Path) -> None:
    text = (
        "ego = new Object\na = DiscreteRange(0, 5)\nb = Uniform(1, 2, 3, 4)\nc = Uniform('x', 'y', 'z')\n"
        "require a + b > 7\nrequire c != 'z' or a < 2\n"
    )
    assert deep(tmp_path, text) == [("SC702", 3), ("SC702", 4)]


def test_contradictions_that_only_tables_show_are_reported(tmp_path: Path) -> None:
    text = (
        "ego = new Object\na, b, c = Uniform('r', 'g'), Uniform('r', 'g'), Uniform('r', 'g')\n"
        "require a != b\nrequire b != c\nrequire c != a\n"
    )
    assert deep(tmp_path, text) == [("SC700", 5)]
