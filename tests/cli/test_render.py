import json
from pathlib import Path

from hypothesis import given
from hypothesis import strategies as st

from scenic.cli.output import exit_code, summary
from scenic.cli.render import Sources, render_json, render_text
from scenic.language.diagnostics import Diagnostic, Label, Severity
from scenic.language.source import Source
from scenic.language.spans import Span


def shown(text: str, diagnostic: Diagnostic, *, colour: bool = False) -> list[str]:
    return render_text([diagnostic], Sources([Source(text, "f.scenic")]), colour).splitlines()


def at(*place: int, **others: object) -> Diagnostic:
    return Diagnostic("SC103", "bad", Span(*place), filename="f.scenic", **others)  # type: ignore[arg-type]


def test_labels_on_other_lines() -> None:
    label = Label(Span(1, 4, 1, 5), "opened here")
    assert shown("x = [1,\n 2,\n 3)\n", at(3, 2, 3, 3, help="close it", labels=(label,))) == [
        "error[SC103]: bad",
        " --> f.scenic:3:3",
        "  |",
        "1 | x = [1,",
        "  |     - opened here",
        "...",
        "3 |  3)",
        "  |   ^",
        "  |",
        "  = help: close it",
        "",
    ]


def test_labels_on_the_same_line() -> None:
    label = Label(Span(1, 4, 1, 5), "opened here")
    lines = shown("x = [1)\n", at(1, 6, 1, 7, labels=(label,)))
    assert lines[3:6] == ["1 | x = [1)", "  |       ^", "  |     - opened here"]


def test_spans_over_several_lines_are_underlined_on_the_first() -> None:
    assert shown("f(1,\n  2)  \n", at(1, 0, 2, 4))[3:5] == ["1 | f(1,", "  | ^^^^"]


def test_tabs_wide_and_combining_characters() -> None:
    lines = shown("\t漢e\u0301 = $", at(1, 7, 1, 8))
    assert lines[3:5] == ["1 |     漢e\u0301 = $", "  | " + " " * 10 + "^"]


def test_end_of_line_and_empty_spans() -> None:
    assert shown("x = ", at(1, 4, 1, 4))[3:5] == ["1 | x =", "  |     ^"]
    assert shown("", at(1, 0, 1, 0))[3:5] == ["1 |", "  | ^"]


def test_long_lines_are_cut() -> None:
    lines = shown("a" * 5000 + "$" + "b" * 5000, at(1, 5000, 1, 5001))
    assert max(map(len, lines)) < 200
    assert lines[3][lines[4].index("^")] == "$"


def test_without_source_and_without_place() -> None:
    lines = render_text(
        [Diagnostic("SC600", "no such file", filename="none.scenic", help="look")], Sources(), False
    )
    assert lines.splitlines() == ["error[SC600]: no such file", " --> none.scenic", "  = help: look", ""]
    assert render_text([at(3, 0, 3, 1)], Sources(), False).splitlines()[1] == " --> f.scenic:3:1"


def test_sources_are_read_when_needed(tmp_path: Path) -> None:
    file = tmp_path / "a.scenic"
    file.write_text("x = 1\n")
    source = Sources().get(str(file))
    assert source is not None
    assert source.lines[0] == "x = 1"


def test_colours() -> None:
    lines = shown("x", at(1, 0, 1, 1, severity=Severity.WARNING), colour=True)
    assert lines[0].startswith("\x1b[1;33mwarning[SC103]\x1b[0m")


@given(st.text(max_size=30), *[st.integers(0, 40)] * 4)
def test_anything_can_be_shown(text: str, line: int, column: int, more: int, end: int) -> None:
    diagnostic = at(
        line + 1, column, line + 1 + more, max(column, end), labels=(Label(Span(1, end, 1, end), "l"),)
    )
    lines = shown(text, diagnostic)
    assert lines[0] == "error[SC103]: bad"
    assert all(character.isprintable() for each in lines for character in each)
    assert (
        json.loads(render_json([diagnostic], Sources(), False))["diagnostics"][0]["span"]["line"] == line + 1
    )


def test_exit_codes_and_summary() -> None:
    error, warning = at(1, 0, 1, 0), at(1, 0, 1, 0, severity=Severity.WARNING)
    unreadable = Diagnostic("SC600", "none", filename="f")
    assert [exit_code(each) for each in ([], [warning], [error, warning], [error, unreadable])] == [
        0,
        0,
        1,
        2,
    ]
    assert exit_code([unreadable, Diagnostic("SC999", "fault")]) == 70
    assert summary([error, error, warning]) == "2 errors, 1 warning"
    assert summary([]) == "no problems"
