"""Specifiers that read as operators or tuples, since `new` or a comma is missing, or nothing follows the comma."""

import pytest

from scenic.compiler.check import check_text
from scenic.compiler.fixes import apply_fixes
from tests.each import each


@each(
    [
        ("ego = Object «»left of (1, 2)", "SC111", "ego = new Object left of (1, 2)"),
        ("ego = new Object\nx = new Object at ego «behind» ego", "SC113", "at ego, behind ego"),
        (
            "ego = new Object\nx = new Object with width 3 «ahead» of ego",
            "SC113",
            "with width 3, ahead of ego",
        ),
        ("ego = new Object with width 4«,»", "SC311", "ego = new Object with width 4"),
        ("ego = new Object\nx = new Object«,»\ny = 3", "SC311", "x = new Object\ny = 3"),
        ("x = 3\nego = new Object«,»\nwith (x): pass", "SC311", "ego = new Object\nwith (x): pass"),
        ("ego = new Object\nnew Object at (1, 2)«,»", "SC311", "new Object at (1, 2)"),
    ]
)
def test_what_is_meant_is_found_and_repaired(case: tuple[str, str, str]) -> None:
    marked, code, repaired = case
    text = marked.replace("«", "").replace("»", "")
    (found,) = (item for item in check_text(text, filename="f") if item.code == code)
    assert found.span is not None
    before = marked[: marked.index("«")]
    if marked[marked.index("«") + 1] != "»":
        assert (found.span.line, found.span.column) == (before.count("\n") + 1, len(before.split("\n")[-1]))
    assert found.fix is not None
    assert repaired in apply_fixes(text, [found.fix])[0]


@pytest.mark.parametrize(
    "text",
    [
        "x = (new Object),",
        "x = new Object with seen ego left of ego",
        "x = new Object with seen (3 left of ego)",
    ],
)
def test_what_may_be_meant_is_left_alone(text: str) -> None:
    found = {item.code for item in check_text(f"ego = new Object\n{text}", filename="f")}
    assert not found & {"SC111", "SC113", "SC311"}
