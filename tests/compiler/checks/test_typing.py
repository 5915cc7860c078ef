"""While a line is typed, no other line is accused of what the rest of it will bind."""

import pytest

from scenic.compiler.check import check_text
from scenic.language.diagnostics import Severity
from scenic.project.index import Project
from scenic.project.surroundings import surroundings_in

USES = "print(first, others)\n"
BLOCK = "print(\n    1,\n)\nif (\n    2 > 1\n):\n    print('small')\nelse:\n    print('large')\n"


def errors(text: str) -> list[tuple[int, str]]:
    """The lines and codes of the errors that an editor shows."""
    found = check_text(
        text, filename="/nowhere/typed.scenic", surroundings_of=surroundings_in(Project()), typing=True
    )
    return [
        (each.span.line, each.code)
        for each in found
        if each.severity is Severity.ERROR and each.span is not None
    ]


@pytest.mark.parametrize("right", ["first, *others = [1, 2]", "[first, others] = 1, 2", "first = others = 1"])
def test_targets_half_typed(right: str) -> None:
    typed = right[: right.index("=")]
    for length in range(1, len(typed) + 2):
        line = right[:length]
        # A name alone hides only what it may become.
        expected = {1, 2} if line.strip().isidentifier() else {1}
        assert {number for number, _ in errors(f"{line}\n{USES}")} <= expected, line


@pytest.mark.parametrize(
    "line",
    [
        *("model"[:length] for length in (1, 3, 5)),
        "import ma",
        "import math, o",
        "from math import r",
        "w = f(",
    ],
)
def test_statements_half_typed_that_may_bind_anything(line: str) -> None:
    assert {number for number, _ in errors(f"{line}\nnew Truck\nprint(paths)\n")} <= {1}


@pytest.mark.parametrize("line", ["x = [", "x = [new", "x = [new Object at (1, 2", "x = f(1, {2: 3"])
def test_open_brackets_before_statements_of_several_lines(line: str) -> None:
    assert {number for number, _ in errors(f"{line}\n{BLOCK}")} == {1}


@pytest.mark.parametrize(
    ("text", "found"),
    [
        ("length = 3\nx = lenght\nego\n", [(2, "SC202")]),
        ("from math import sinus\nprint(nothing)\n", [(1, "SC212"), (2, "SC202")]),
        ("import math\nprint(nothing)\n", [(2, "SC202")]),
        ("print(later)\nlater = 1\nlater\n", [(1, "SC204")]),
        ("nothing\nanything\n", [(1, "SC202"), (2, "SC202")]),
        ("x = 1 +\nprint(nothing)\n", [(1, "SC110"), (2, "SC202")]),
    ],
)
def test_what_is_wrong_by_itself_is_said_all_the_same(text: str, found: list[tuple[int, str]]) -> None:
    assert sorted(errors(text)) == found


def test_a_name_alone_hides_only_what_it_may_become() -> None:
    text = "fir\nprint(first)\nprint(others)\n"
    assert errors(text) == [(1, "SC202"), (3, "SC202")]
    written = check_text(text, filename="f")
    assert [(each.span.line, each.code) for each in written if each.span] == [(n, "SC202") for n in (1, 2, 3)]


def test_an_earlier_use_is_none_while_the_targets_are_typed() -> None:
    assert not errors("a = b = c = 1\n(b, c) = a, a\n")
    assert {number for number, _ in errors("a,\nprint(b)\nb = 1\n")} == {1}
