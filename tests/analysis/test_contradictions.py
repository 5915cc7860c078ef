"""Contradictions planted in programs are told at their lines, and programs that have scenes get no false report."""

from pathlib import Path

import pytest

from scenic.deep.findings import deep_check
from tests.amounts import amount

ROOT = Path(__file__).parents[2]

FAMILIES = {
    # Of each: a program with a hole, what makes it contradictory, what does not, and the line that is blamed.
    "one range": ("x = Range(0, 10)\nego = new Object at (x, 0)\nrequire x > {}\n", [11, 10.5, 100], [9, 5, -1], 3),
    "two requirements": ("x = Range(0, 10)\nrequire x > 6\nrequire x < {}\n", [5, 6, -3], [7, 6.5, 20], 3),
    "a chain": ("x, y, z = Range(0, 1), Range(0, 1), Range(0, 1)\nrequire x > y\nrequire y > z\nrequire z > x + {}\n", [0, 0.5, 0.001], [-0.5, -1, -0.2], 4),
    "a sum": ("a, b, c = Range(0, 5), Range(0, 5), Range(0, 5)\nrequire a + b + c > {}\n", [15.5, 16, 40], [14, 10, 3], 2),
    "a product": ("a, b = Range(1, 5), Range(1, 5)\nrequire a * b > {}\nparam v = (a, b)\n", [26, 25.5, 99], [24, 10, 2], 2),
    "integers": ("n, m = DiscreteRange(1, 9), DiscreteRange(1, 9)\nrequire n + m == 12\nrequire n - m == {}\n", [1, 3, 9], [0, 2, 4], 3),
    "remainders": ("n = DiscreteRange(1, 30)\nrequire n % 4 == 2\nrequire n % 2 == {}\n", [1, 3, 5], [0], 3),
    "options": ("a, b = Uniform(1, 2, 4), Uniform(1, 2, 4)\nrequire a + b == {}\n", [7, 9, 1], [3, 6, 8], 2),
    "distances": ("ego = new Object at (0, 0)\nother = new Object at (Range(-5, 5), Range(10, 12))\nrequire (distance from ego to other) < {}\n", [9, 5, 2], [11, 12, 13], 3),
    "nearness": ("ego = new Object at (Range(0, 2), 0)\nother = new Object at (Range(8, 9), 0)\nrequire (distance to other) < {}\n", [5, 2, 5.9], [7, 8, 6.5], 3),
    "containers": ("ego = new Object at (Range(-1, 1), 0), with width {}, with regionContainedIn RectangularRegion((0, 0), 0, 4, 4)\n", [5, 6, 9], [1, 2, 3], 1),
    "views": ("ego = new Object at (0, 0), with visibleDistance 10\nnew Object at ({} + Range(0, 5), 0), with requireVisible True\n", [20, 15, 90], [2, 5, 4], 2),
    "time": ("ego = new Object at (Range(0, 9), 0)\nrequire always ego.x > 3\nrequire eventually {}ego.x > 3\n", ["not ", "(not True) and ", "not True or not "], ["", "True and ", "not not "], 3),
    "time beside": ("ego = new Object at (Range(0, 9), 0)\nrequire ego.x > 3\nrequire always {}ego.x > 3\n", ["not ", "not not not "], ["", "not not "], 3),
}  # fmt: skip

PLANTED = [
    (name, text.format(value), line) for name, (text, bad, _, line) in FAMILIES.items() for value in bad
]
FINE = [text.format(value) for text, _, good, _ in FAMILIES.values() for value in good]


def blamed(path: Path) -> list[int | None]:
    return [item.span.line if item.span else None for item in deep_check(path) if item.severity == "error"]


def test_there_are_enough_of_them() -> None:
    assert len(PLANTED) >= 40
    assert len(FINE) >= 38


@pytest.mark.parametrize("family", list(FAMILIES))
def test_planted_contradictions_are_told_at_their_lines(family: str, tmp_path: Path) -> None:
    path = tmp_path / "program.scenic"
    for name, text, line in PLANTED:
        if name == family:
            path.write_text(text)
            assert blamed(path) == [line], text


def test_programs_that_have_scenes_get_no_false_report(tmp_path: Path) -> None:
    path = tmp_path / "program.scenic"
    for text in FINE:
        path.write_text(text)
        assert blamed(path) == [], text


def test_rare_scenes_are_no_contradictions() -> None:
    programs = sorted((ROOT / "benchmarks" / "pruning").glob("*.scenic"))
    assert len(programs) == 30
    for path in programs[:: amount(6, 3)]:
        assert blamed(path) == [], path.name
