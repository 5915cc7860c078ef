"""What `check --deep` finds beside contradictions of a moment: temporal ones, and options that never occur."""

import pytest

from scenic.analysis.traces import shortest_trace
from scenic.deep.findings import deep_check
from tests.runtime.programs import scenario

HEAD = "ego = new Object at (Range(0, 9), 0)\nx = Range(0, 1)\nspeeds = [Uniform(1, 2), Uniform(1, 2)]\nclass Other: pass\n"

CONTRADICTIONS = {
    "require always ego.x > 1\nrequire eventually not ego.x > 1\n": (6, [5], "1 state would"),
    "require eventually (ego.x > 3 and not ego.x > 3)\n": (5, [], "change or remove"),
    "require always (x < 2 implies ego.x > 1)\nrequire always x < 2\nrequire eventually not (ego.x > 1)\n": (7, [5, 6], "1 state would"),
    "require next next ego.x > 5\nrequire always not ego.x > 5\n": (6, [5], "3 states would"),
    "require ego.x > 5 until ego.y > 5\nrequire always not ego.y > 5\n": (6, [5], "1 state would"),
    "require eventually ego.x > 5\nrequire always ego.y > 3\nrequire always not ego.x > 5\n": (7, [5], "1 state would"),
    "require always (ego.x > 1 implies next not ego.x > 1)\nrequire always ego.x > 1\nrequire next next ego.x > 1\n": (6, [5], "1 state would"),
}  # fmt: skip
"""Programs with the line that is blamed, the lines beside it, and what is said of a witness."""

SATISFIABLE = (
    "require always ego.x > 1\nrequire eventually ego.x > 1\n",
    "require eventually ego.x > 5\nrequire eventually not ego.x > 5\n",
    "require ego.x > 5 until ego.y > 5\nrequire eventually not ego.x > 5\n",
    "require always (ego.x > 5 or ego.y > 5)\nrequire eventually not ego.y > 5\nrequire eventually not ego.x > 5\n",
    "require always (ego.x > 5 implies next not ego.x > 5)\nrequire eventually ego.x > 5\n",
    # The same words about other values, or about functions that may give anything.
    "y = ego.x\nrequire always y > 1\ny = ego.y\nrequire eventually not y > 1\n",
    "import random\ndef f(): return random.random()\nrequire always f() < 0.5\nrequire eventually not f() < 0.5\n",
    "require always speeds[0] > 1\nrequire eventually not speeds[1] > 1\n",
    "require[0.5] always ego.x > 1\nrequire eventually not ego.x > 1\n",
)


@pytest.mark.parametrize("text", list(CONTRADICTIONS))
def test_temporal_contradictions_are_told_at_their_lines(text, tmp_path):
    path = tmp_path / "program.scenic"
    path.write_text(HEAD + text)
    line, others, witness = CONTRADICTIONS[text]
    found = [item for item in deep_check(path) if "however a simulation goes on" in item.message]
    assert [(item.code, item.span.line, [label.span.line for label in item.labels]) for item in found] == [
        ("SC700", line, others)
    ]
    assert witness in found[0].help


def test_satisfiable_ones_are_left_alone(tmp_path):
    path = tmp_path / "program.scenic"
    for text in SATISFIABLE:
        path.write_text(HEAD + text)
        assert [item for item in deep_check(path) if "simulation" in item.message] == [], text


def test_witnesses_are_as_short_as_they_can_be():
    for count in range(4):
        program = scenario(f"{HEAD}require {'next ' * count}ego.x > 5\nrequire always (ego.x > 5 or x > 0)\n")
        assert shortest_trace([item.formula for item in program.requirements]) == count + 1


OPTIONS = {
    "speed, time = Uniform(5, 10, 20), Range(1, 2)\nrequire speed * time > 25\nparam v = speed\n": ["2 of the 3 options of this choice never occur: 5, 10"],
    "a, b = Uniform(1, 2, 4, 8), Uniform(1, 2, 4, 8)\nrequire a + b == 9\nparam v = (a, b)\n": ["2 of the 4 options of this choice never occur: 2, 4"] * 2,
    "a = Uniform('one', 'two')\nn = Uniform(1, 2)\nrequire n > 0.5\nparam v = (a, n)\n": [],
}  # fmt: skip


@pytest.mark.parametrize("text", list(OPTIONS))
def test_options_that_never_occur(text, tmp_path):
    path = tmp_path / "program.scenic"
    path.write_text(text)
    assert [item.message for item in deep_check(path) if item.code == "SC702"] == OPTIONS[text]
