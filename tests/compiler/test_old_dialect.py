"""Programs of Scenic 2 get one message; single slips keep theirs."""

import pytest

from scenic.compiler.check import check_text
from scenic.language.errors import ParseCompileError
from scenic.pipeline import scenarioFromString

OLD = "ego = Object at (0, 0)\nObject left of ego by 2\nmonitor M:\n    wait\n"


def codes(text: str) -> list[str]:
    return [item.code for item in check_text(text, filename="program.scenic")]


def test_one_message() -> None:
    assert codes(OLD) == ["SC136"]
    with pytest.raises(ParseCompileError) as caught:
        scenarioFromString(OLD)
    assert [item.code for item in caught.value.diagnostics] == ["SC136"]


def test_a_program_with_new_is_scenic_3() -> None:
    assert codes("ego = new Object\nObject at (2, 3)\nObject at (5, 6)\n") == ["SC111", "SC111"]


def test_a_single_slip() -> None:
    assert codes("ego = Object facing 3 deg\n") == ["SC111"]


def test_new_in_a_comment_is_none() -> None:
    assert codes(f"# the new Object\n{OLD}") == ["SC136"]


def test_specifiers_that_are_operators_as_well() -> None:
    assert codes("ego = Object at 1 @ 2\nObject offset by 3 @ 4\n") == ["SC136"]
    with pytest.raises(ParseCompileError):
        scenarioFromString("ego = Object at 1 @ 2\nx = Object at 3 @ 4\n")


def test_fields_and_texts_are_none() -> None:
    module = (
        '"""Write `ego = new Object`.\n\nego = Object at 1 @ 2\nObject at 3 @ 4\n"""\n'
        "Wind = VectorField('wind', lambda p: 1)\ndef f(p):\n    x = Wind at p\n    return Wind at x\n"
    )
    assert "SC136" not in codes(module.replace("new ", ""))
