"""Reports on the finite part of programs: solutions, dead options, contradictions."""

from collections.abc import Mapping, Sequence
from itertools import product
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
    assert deep(tmp_path, text) == [("SC702", 2), ("SC702", 3), ("SC702", 4)]


def test_contradictions_that_only_tables_show_are_reported(tmp_path: Path) -> None:
    text = (
        "ego = new Object\na, b, c = Uniform('r', 'g'), Uniform('r', 'g'), Uniform('r', 'g')\n"
        "require a != b\nrequire b != c\nrequire c != a\n"
    )
    assert deep(tmp_path, text) == [("SC700", 5)]


def differ(names: str) -> str:
    return " and ".join(f"{one} != {other}" for place, one in enumerate(names) for other in names[:place])


PROGRAMS: dict[str, tuple[Mapping[str, Sequence[object]], Sequence[str]]] = {
    "parking with sizes": (
        dict.fromkeys("abcd", range(4)),
        [f"(2, 2, 3, 4)[{car}] >= {size}" for car, size in zip("abcd", (2, 3, 2, 4), strict=True)]
        + [differ("abcd")],
    ),
    "seating": (
        dict.fromkeys("abc", ("window", "aisle", "door")),
        ["a != b", "b != c", "a != c", "a != 'door'", "b == 'window' or c == 'window'"],
    ),
    "timetable": (
        dict.fromkeys("mpas", (9, 10, 11, 12, 13)),
        ["m < p", "p < a", "abs(a - s) >= 2", "s < 11", "m != s", "p != s"],
    ),
    "graph colouring": (
        dict.fromkeys("uvwxyz", ("red", "green", "blue")),
        ["u == 'red'", "u != v", "v != w", "w != u", "v != x", "w != x", "x != y", "y != z"],
    ),
    "a row of a Latin square with clues": (
        dict.fromkeys("abcdefgh", range(1, 5)),
        [
            differ("abcd"),
            differ("efgh"),
            *(f"{one} != {two}" for one, two in zip("abcd", "efgh", strict=True)),
            "a == 1",
            "f == 2",
            "b == 3",
        ],
    ),
    "dominoes": (
        dict.fromkeys("abcdef", range(5)),
        ["b == c", "d == e", "a + b == 5", "c + d == 5", "e + f == 5", "a == 3"],
    ),
    "permutation with forbidden places": (
        dict.fromkeys("abcde", range(5)),
        ["len({a, b, c, d, e}) == 5", "a < 2", "b < 2", "c != 4"],
    ),
    "weights": ({"w": (2, 3, 4), "l": (100, 250, 600)}, ["l <= w * 100", "w == 4 or l > 150"]),
    "all is alive": (dict.fromkeys("abc", range(3)), [differ("abc")]),
    "implications": (
        dict.fromkeys("abcde", (True, False)),
        ["not a or b", "not b or c", "e or d", "not c or d", "not (a and d)", "a or (b and not c)"],
    ),
    "pigeons": (dict.fromkeys("abcd", (1, 2, 3)), [differ("abcd"), "a + b > 0"]),
}


@pytest.mark.parametrize("kind", ["Uniform", "Discrete"])
@pytest.mark.parametrize("name", PROGRAMS)
def test_dead_options_and_contradictions_are_those_that_trying_all_combinations_shows(
    name: str, kind: str, tmp_path: Path
) -> None:
    from scenic.deep.findings import deep_check

    draws, requirements = PROGRAMS[name]

    def solutions(required: Sequence[str]) -> list[tuple[object, ...]]:
        rows = product(*draws.values())
        return [row for row in rows if all(eval(one, dict(zip(draws, row, strict=True))) for one in required)]

    lines = [
        f"{draw} = Uniform{tuple(values)}"
        if kind == "Uniform"
        else f"{draw} = Discrete({dict.fromkeys(values, 2)})"
        for draw, values in draws.items()
    ]
    lines += [f"require {one}" for one in requirements]
    (tmp_path / "program.scenic").write_text("\n".join([*lines, "ego = new Object", ""]))
    found = deep_check(tmp_path / "program.scenic")
    rows = solutions(requirements)
    dead = {
        (line, tuple(repr(value) for value in values if value not in {row[line - 1] for row in rows}))
        for line, values in enumerate(draws.values(), 1)
    }
    if rows:
        told = {
            (item.span.line, item.message.partition(": ")[2])
            for item in found
            if item.span and item.code == "SC702"
        }
        assert told == {(line, ", ".join(values)) for line, values in dead if values}
        assert not [item for item in found if item.severity == "error"]
        return
    (error,) = [item for item in found if item.severity == "error"]
    assert error.code == "SC700"
    assert error.span is not None
    marked = {error.span.line, *(label.span.line for label in error.labels)}
    core = [one for line, one in enumerate(requirements, len(draws) + 1) if line in marked]
    assert not solutions(core)
    assert all(solutions([one for one in core if one is not left_out]) for left_out in core)


@pytest.mark.parametrize("count", [12, 26])
def test_values_that_too_few_others_could_take_are_found_dead(count: int, tmp_path: Path) -> None:
    from scenic.deep.findings import deep_check

    text = f"s = [Uniform(*range({count})) for i in range({count})]\nfor i in range({count}):\n    for j in range(i):\n        require s[i] != s[j]\n"
    text += "for i in range(2):\n    require s[i] < 2\nego = new Object\n"
    (tmp_path / "program.scenic").write_text(text)
    (found,) = deep_check(tmp_path / "program.scenic")
    assert found.message == (
        f"some options of this choice never occur in some of its {count} draws: s[0] is only 0 or 1; s[1] is only 0 or 1; "
        f"s[2] is never 0 or 1; s[3] is never 0 or 1; s[4] is never 0 or 1; and so on, for {count} draws"
    )
    outlined = scenic.scenarioFromString(text.replace("s[i] < 2", "s[i] < 1")).outline
    assert decision_of(outlined).impossible


def test_a_choice_of_another_file_is_not_marked_in_the_program(tmp_path: Path) -> None:
    from scenic.deep.findings import deep_check

    (tmp_path / "colours_of_cars.scenic").write_text("\n" * 5 + "pick = Uniform(1, 2, 3)\n")
    (tmp_path / "program.scenic").write_text(
        "from colours_of_cars import pick\nrequire pick < 3\nego = new Object with foo pick\n"
    )
    (found,) = deep_check(tmp_path / "program.scenic")
    assert found.span is None
    assert found.message == "1 of the 3 options of a choice in an imported module (line 6) never occurs: 3"
