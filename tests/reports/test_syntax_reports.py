"""Reports about messages: the right line, the right cause, the file."""

import pytest

import scenic
from scenic.language.errors import ParseCompileError, ScenicTypeError
from tests.each import each
from tests.reports.programs import Programs, programs  # noqa: F401 - a fixture

BROKEN = {
    "an open bracket is named where it is opened": ("ego = new Object at (1,\nx = 3\n", "SC103", 1),
    "a stray word is not a missing `new`": ("ego = new Object\nx = foo bar\n", "SC110", 2),
    "a missing colon": ("ego = new Object\nif True\n    x = 3\n", "SC121", 2),
    "a missing block": ("ego = new Object\nfor i in range(3):\nx = 3\n", "SC127", 2),
    "an unexpected indent": ("ego = new Object\n    x = 3\n", "SC102", 2),
    "tabs and spaces": ("ego = new Object\nif ego:\n\tx = 1\n        y = 2\n", "SC102", 4),
    "an expression in an f-string": ("ego = new Object\nx = f'{1 + }'\n", "SC110", 2),
    "an open f-string": ("ego = new Object\nx = f'{1'\n", "SC105", 2),
    "after a text of several lines": ('x = """\na\nb\n"""\nego = new Object att 3\n', "SC118", 5),
}


@each(BROKEN)
def test_the_line_of_the_mistake(name: str) -> None:
    text, code, line = BROKEN[name]
    with pytest.raises(ParseCompileError) as caught:
        scenic.scenarioFromString(text, filename="broken.scenic")
    (first, *_) = [item for item in caught.value.diagnostics if item.severity.value == "error"]
    assert first.span is not None
    assert (first.code, first.span.line, first.filename) == (code, line, "broken.scenic")


def test_a_mistake_in_an_imported_file_names_that_file(programs: Programs) -> None:  # noqa: F811
    (programs.folder / "shapes.scenic").write_text("class Ball:\n    width: f'{'\n")
    with pytest.raises(ParseCompileError) as caught:
        programs.compiled("from shapes import Ball\nego = new Ball\n")
    assert caught.value.filename == str(programs.folder / "shapes.scenic")
    assert caught.value.lineno == 2


def test_unknown_arguments_of_library_behaviors(programs: Programs) -> None:  # noqa: F811
    text = "behavior B():\n    do FollowLaneBehavior(targetSpeed=3)\nego = new Car with behavior B()\n"
    (first, *_) = programs.found(text, map="street")
    assert (first.code, first.span and first.span.line) == ("SC211", 4)
    assert first.help == "did you mean `target_speed`?"


@pytest.mark.parametrize(
    "expression",
    ["(5, 5) intersects ego", "(1, 2) can see ego", "front of (1, 2)", "relative heading of (1, 2)"],
)
def test_a_vector_where_an_object_is_expected(programs: Programs, expression: str) -> None:  # noqa: F811
    (first,) = programs.found(f"ego = new Object\nx = {expression}\n")
    assert (first.code, first.span and first.span.line) == ("SC404", 2)
    assert "not a tuple of 2" in first.message


def test_tuples_after_do(programs: Programs) -> None:  # noqa: F811
    inner = "scenario {}():\n    setup:\n        new Object at (5, {})\n    compose:\n        wait\n"
    text = inner.format("A", 5) + inner.format("B", 9)
    main = "scenario Main():\n    setup:\n        ego = new Object\n    compose:\n        do {}\n"
    with pytest.raises(ScenicTypeError) as caught:
        programs.simulated(text + main.format("(A(), B())"), 3)
    assert caught.value.lineno == 15
    assert caught.value.help == "write the targets one after the other, `do A(), B()`"
    assert len(programs.simulated(text + main.format("A(), B()"), 3).trajectory[1]) == 3
