import json
from dataclasses import replace
from pathlib import Path
from typing import Any
from xml.etree import ElementTree

import jsonschema
import pytest
from hypothesis import given
from hypothesis import strategies as st

from scenic.cli.output import exit_code, summary
from scenic.cli.render import FORMATS, Report, Sources, render, render_text
from scenic.language.diagnostics import Diagnostic, Edit, Fix, Label, Severity
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
    both = (Severity.ERROR, Severity.WARNING)
    known = at(1, 0, 1, 0, severity=Severity.INFORMATION)
    assert [exit_code(each, failing=both) for each in ([], [known], [warning], [warning, unreadable])] == [
        0,
        0,
        1,
        2,
    ]
    assert exit_code([Diagnostic("SC606", "bad")]) == 2
    assert summary([error, error, warning]) == "2 errors, 1 warning"
    assert summary([]) == "no problems"


def fixed(text: str, help: str | None = None, title: str = "Write it so") -> Diagnostic:
    return at(1, 0, 1, 1, help=help, fix=Fix(title, (Edit(Span(1, 0, 1, 1), text),)))


@pytest.mark.parametrize(
    ("diagnostic", "advice"),
    [
        (fixed("ab"), ["write it so: `ab`"]),
        (fixed("ab", "did you mean `ab`?"), ["did you mean `ab`?"]),
        (fixed("ab", "look", "Write `ab`"), ["look", "write `ab`"]),
        (fixed(""), ["write it so"]),
        (fixed("a\nb"), ["write it so"]),
        (fixed("", "write it so"), ["write it so"]),
    ],
)
def test_repairs_are_shown_where_they_say_more(diagnostic: Diagnostic, advice: list[str]) -> None:
    assert [line.removeprefix("  = help: ") for line in shown("x", diagnostic) if "= help" in line] == advice


ROOT = Path(__file__).parents[2]
SARIF = json.loads((ROOT / "tests/data/sarif.schema.json").read_text())

ODD = Diagnostic(
    "SC300",
    "50% of: a,b\nmore",
    Span(2, 1, 2, 4),
    Severity.WARNING,
    "a b,é%:1.scenic",
    "do",
    (Label(Span(1, 0, 1, 2), "here \ud800"),),
    Fix("Repair", (Edit(Span(2, 1, 2, 1), "x"), Edit(Span(2, 3, 3, 0), ""))),
)
UNREADABLE = Diagnostic("SC600", "no such file", filename="/elsewhere/x.scenic")
MISCONFIGURED = Diagnostic("SC606", "bad", Span(1, 0, 1, 1), filename="pyproject.toml")
NOTED = at(1, 0, 2, 1, severity=Severity.INFORMATION)


def test_json() -> None:
    report = Report([ODD, UNREADABLE, NOTED], files=2, fixed=4)
    content = json.loads(render("json", report))
    jsonschema.validate(content, json.loads((ROOT / "docs/reference/check.schema.json").read_text()))
    assert content["summary"] == {
        "files": 2,
        "errors": 1,
        "warnings": 1,
        "information": 1,
        "fixable": 1,
        "fixed": 4,
    }
    first, second, _ = content["diagnostics"]
    assert first["fix"] == {
        "title": "Repair",
        "edits": [
            {"span": {"line": 2, "column": 2, "end_line": 2, "end_column": 2}, "text": "x"},
            {"span": {"line": 2, "column": 4, "end_line": 3, "end_column": 1}, "text": ""},
        ],
    }
    assert (second["fix"], second["span"], second["help"]) == (None, None, None)


def test_github() -> None:
    assert render("github", Report([ODD, UNREADABLE, NOTED])).split("\n") == [
        (
            "::warning title=scenic SC300,file=a b%2Cé%25%3A1.scenic,line=2,endLine=2,col=2,endColumn=5"
            "::SC300: 50%25 of: a,b%0Amore%0Ahelp: do"
        ),
        "::error title=scenic SC600,file=/elsewhere/x.scenic::SC600: no such file",
        "::notice title=scenic SC103,file=f.scenic,line=1,endLine=2::SC103: bad",
        "",
    ]
    windows = Diagnostic("SC600", "a\r\nb")
    assert render("github", Report([windows])) == "::error title=scenic SC600::SC600: a%0D%0Ab\n"


def sarif(*diagnostics: Diagnostic, code: int = 1) -> dict[str, Any]:
    text = render("sarif", Report(diagnostics, exit_code=code))
    text.encode("utf-8")
    log = json.loads(text)
    jsonschema.validate(log, SARIF)
    assert len(log["runs"]) == 1
    run: dict[str, Any] = log["runs"][0]
    return run


def check_structure(run: dict[str, Any]) -> None:
    """What no schema says: results and notes name their rules, and regions end after they begin."""
    rules = run["tool"]["driver"]["rules"]
    for result in run["results"]:
        assert rules[result["ruleIndex"]]["id"] == result["ruleId"]
        for location in (*result.get("locations", []), *result.get("relatedLocations", [])):
            region = location["physicalLocation"].get("region")
            if region is not None:
                begin = (region["startLine"], region["startColumn"])
                assert begin <= (region["endLine"], region["endColumn"])
    for kind in ("toolExecutionNotifications", "toolConfigurationNotifications"):
        for note in run["invocations"][0].get(kind, []):
            assert rules[note["associatedRule"]["index"]]["id"] == note["associatedRule"]["id"]


def test_sarif(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    run = sarif(ODD, UNREADABLE, MISCONFIGURED, NOTED, Diagnostic("SC999", "fault"), code=2)
    check_structure(run)
    (invocation,) = run["invocations"]
    assert (invocation["executionSuccessful"], invocation["exitCode"]) == (False, 2)
    assert [note["message"]["text"] for note in invocation["toolExecutionNotifications"]] == [
        "no such file",
        "fault",
    ]
    assert len(invocation["toolConfigurationNotifications"]) == 1
    assert run["originalUriBaseIds"] == {"%SRCROOT%": {"uri": f"{tmp_path.as_uri()}/"}}
    odd, noted = run["results"]
    assert [odd["level"], noted["level"]] == ["warning", "note"]
    assert odd["message"]["text"] == "50% of: a,b\nmore\nhelp: do"
    assert odd["locations"][0]["physicalLocation"] == {
        "artifactLocation": {"uri": "a%20b%2C%C3%A9%25%3A1.scenic", "uriBaseId": "%SRCROOT%"},
        "region": {"startLine": 2, "startColumn": 2, "endLine": 2, "endColumn": 5},
    }
    assert odd["relatedLocations"][0]["id"] == 1
    (change,) = odd["fixes"][0]["artifactChanges"]
    assert [each.get("insertedContent") for each in change["replacements"]] == [{"text": "x"}, None]
    place = invocation["toolExecutionNotifications"][0]["locations"][0]["physicalLocation"]
    assert place == {"artifactLocation": {"uri": "file:///elsewhere/x.scenic"}}
    check_structure(sarif(code=0))


def test_sarif_explains_its_rules() -> None:
    (rule,) = sarif(ODD)["tool"]["driver"]["rules"]
    assert rule["shortDescription"] == {"text": "misspelt property"}
    (rule,) = sarif(at(1, 0, 1, 0, severity=Severity.WARNING))["tool"]["driver"]["rules"]
    assert rule["id"] == "SC103"
    page = sarif(Diagnostic("SC390", "m"))["tool"]["driver"]["rules"][0]["help"]
    assert page["markdown"].startswith("# SC390: ")


@given(st.text(max_size=20), st.text(max_size=20).filter(lambda name: "\0" not in name))
def test_any_text_in_any_format(text: str, filename: str) -> None:
    diagnostic = Diagnostic(
        "SC103", text, Span(1, 0, 1, 0), filename=filename, help=text, fix=fixed(text, title=text).fix
    )
    report = Report([diagnostic])
    for name in FORMATS:
        assert render(name, report)
    assert json.loads(render("json", report))["diagnostics"][0]["message"] == text
    assert render("github", report).count("\n") == 1
    check_structure(sarif(diagnostic))


def test_gitlab() -> None:
    moved = replace(ODD, span=Span(7, 0, 7, 1))
    first, second, third = json.loads(render("gitlab", Report((ODD, moved, NOTED))))
    assert first["check_name"] == ODD.code
    assert first["location"]["path"] == ODD.filename
    assert first["fingerprint"] != second["fingerprint"]
    assert third["severity"] in ("info", "minor", "major")
    again, *_ = json.loads(render("gitlab", Report((moved,))))
    assert again["fingerprint"] == first["fingerprint"]


def test_junit() -> None:
    suite = ElementTree.fromstring(render("junit", Report((ODD, NOTED))))[0]
    assert suite.get("tests") == "2"
    assert [each.get("classname") for each in suite] == [f"scenic.{ODD.code}", f"scenic.{NOTED.code}"]
    empty = ElementTree.fromstring(render("junit", Report(())))[0]
    assert (empty.get("failures"), len(empty)) == ("0", 1)
