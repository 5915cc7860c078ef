"""Repairs at a place, and all at once."""

import pytest

from scenic.compiler.fixes import apply_fixes, repair
from scenic.ide.diagnostics import diagnostics
from scenic.ide.repairs import repair_all, repairs
from scenic.language.code_selection import Rules
from scenic.language.diagnostics import Fix
from scenic.language.spans import Span

TEXT = "import os\nego = new Object with wdth 3\nx = 1 if ego else 2\nnew Object with widht 2\n"


def titles(text: str, span: Span) -> list[str]:
    found = repairs(diagnostics(text, filename="f"), span)
    return [item.fix.title for item in found if item.fix is not None]


def test_what_touches_the_place_is_offered() -> None:
    assert titles(TEXT, Span(2, 22, 2, 22)) == ["Write `width`"]
    # The ends of the word belong to it.
    assert titles(TEXT, Span(2, 26, 2, 26)) == ["Write `width`"]
    assert titles(TEXT, Span(2, 27, 2, 27)) == []
    assert titles(TEXT, Span(1, 0, 4, 0)) == ["Remove the import", "Write `width`"]
    assert titles(TEXT, Span(3, 0, 3, 5)) == []


def test_a_repair_elsewhere_than_its_diagnostic_is_offered_at_both() -> None:
    text = "if x\n    pass\n"
    assert titles(text, Span(1, 4, 1, 4)) == ["Insert `:`"]


@pytest.mark.parametrize(
    "text",
    [
        TEXT,
        "import os\n",
        "x = 1\nimport os",
        "😀 = 3\nego = new Object with wdth 3, with note '\u2028'\n",
        "\x0cif x\n    ego = new Object at 1 with wdth 3\n",
    ],
)
def test_all_at_once_is_what_the_command_does(text: str) -> None:
    edit = repair_all(text, filename="f")
    assert edit is not None
    applied, _ = apply_fixes(text, [Fix("all", (edit,))])
    assert applied == repair(text, filename="f", shown=lambda found: found).text != text


def test_no_more_than_is_needed_is_changed() -> None:
    edit = repair_all("x = 1\nego = new Object with wdth 3, with length 3\ny = 2\n", filename="f")
    assert edit is not None
    assert edit.span.line == edit.span.end_line == 2
    assert len(edit.text) <= len("width")


def test_only_what_is_shown_is_repaired() -> None:
    assert repair_all("x = 3\n", filename="f") is None
    assert repair_all("import os\n", filename="f", rules=Rules(ignore=frozenset({"SC206"}))) is None
