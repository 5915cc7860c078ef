import os
from pathlib import Path

import pytest
from hypothesis import given
from hypothesis import strategies as st

from scenic.configuration.project import PLAIN, Configuration, Configurations, read_configuration
from scenic.language.code_selection import Rules
from scenic.language.diagnostics import Severity


def configuration(folder: Path, text: str) -> Configuration:
    file = folder / "pyproject.toml"
    file.write_text(text)
    found = read_configuration(str(file))
    assert found is not None
    return found


def test_everything(tmp_path: Path) -> None:
    found = configuration(
        tmp_path,
        """
        [tool.scenic]
        select = ["SC3", "SC7"]
        ignore = ["SC300"]
        exclude = ["old", "gen/*.sc"]
        per-file-ignores = { "tests/**" = ["SC390"], "*.sc" = ["SC7"] }
        severity = { SC390 = "error", SC7 = "information" }
        """,
    )
    assert found.problems == ()
    severity = (("SC390", Severity.ERROR), ("SC7", Severity.INFORMATION))
    assert found.rules == Rules(("SC3", "SC7"), ("SC300",), (), severity)
    assert found.excludes(str(tmp_path / "a" / "old"))
    assert found.excludes(str(tmp_path / "gen" / "x.sc"))
    assert not found.excludes(str(tmp_path / "x.sc"))
    assert not found.excludes(str(tmp_path.parent / "old"))
    assert found.rules_for(str(tmp_path / "tests" / "a.sc")).never == ("SC390", "SC7")
    assert found.rules_for(str(tmp_path / "a.scenic")).never == ()
    assert found.rules_for(str(tmp_path / "a.scenic"), ("SC300",)).shows("SC300")


@pytest.mark.parametrize(
    ("text", "place", "message", "advice"),
    [
        ('selct = ["SC3"]', (2, 0, 5), "unknown key `selct`", "did you mean `select`?"),
        ("per_file_ignores = {}", (2, 0, 16), "unknown key", "did you mean `per-file-ignores`?"),
        ("colour = 3", (2, 0, 6), "unknown key `colour`", "the keys are `exclude`"),
        ('select = "SC3"', (2, 0, 6), "`select` must be an array of strings, not a string", "brackets"),
        ("ignore = [3, true]", (2, 0, 6), "`ignore` must hold strings, not an integer", "quotes"),
        ('ignore = ["SC300",\n  "SC30O"]', (3, 2, 9), "there is no code `SC30O`", "did you mean `SC300`?"),
        ("ignore = ['sc3']", (2, 10, 15), "there is no code `sc3`", "did you mean `SC3`?"),
        ('exclude = [""]', (2, 11, 13), "an empty pattern", "remove"),
        ('severity = "error"', (2, 0, 8), "`severity` must be a table, not a string", "for example"),
        ('severity = { SC300 = "warn" }', (2, 21, 27), "`warn` is no severity", "did you mean `warning`?"),
        ('severity = { SC300 = "off" }', (2, 21, 26), "`off` is no severity", "list `SC300` in `ignore`"),
        ("severity.SC300 = 3", (2, 9, 14), "an integer is no severity", "it is one of"),
        ('severity = { SC8 = "error" }', (2, 13, 16), "there is no code `SC8`", ""),
        ('[tool.scenic.severity]\nSC300 = "bad"', (3, 8, 13), "`bad` is no severity", "it is one of"),
        ("[tool.scenic.selct]", (2, 13, 18), "unknown key `selct`", "did you mean"),
        ('per-file-ignores = { "a" = ["x"] }', (2, 28, 31), "there is no code `x`", "scenic explain"),
        ('per-file-ignores."a/*" = ["x"]', (2, 26, 29), "there is no code `x`", "scenic explain"),
        ("ignore = [1979-05-27]", (2, 0, 6), "`ignore` must hold strings, not a date or time", "quotes"),
        ("ignore = [", (2, 10, 10), "this is not TOML: ", "https://toml.io"),
        ("ignore = ]", (2, 9, 9), "this is not TOML: invalid value", "https://toml.io"),
    ],
)
def test_what_can_be_wrong(
    tmp_path: Path, text: str, place: tuple[int, int, int], message: str, advice: str
) -> None:
    found = configuration(tmp_path, f"[tool.scenic]\n{text}")
    problem = found.problems[0]
    assert problem.code == "SC606"
    assert problem.message.startswith(message)
    assert advice in (problem.help or "")
    assert problem.filename == str(tmp_path / "pyproject.toml")
    assert problem.span is not None
    assert (problem.span.line, problem.span.column, problem.span.end_column) == place


def test_the_rest_of_a_bad_configuration_holds(tmp_path: Path) -> None:
    found = configuration(tmp_path, '[tool.scenic]\nignore = ["SC300", "x", 3]\nselect = 3\n')
    assert found.rules.ignore == ("SC300",)
    assert len(found.problems) == 3


@pytest.mark.parametrize("text", ["", "[tool]\n", "[tool.other]\nx = 1\n"])
def test_without_the_table(tmp_path: Path, text: str) -> None:
    assert [each.message for each in configuration(tmp_path, text).problems] == [
        "there is no table `[tool.scenic]` in the file"
    ]
    assert read_configuration(str(tmp_path / "pyproject.toml"), required=False) is None
    (problem,) = configuration(tmp_path, "tool = 3").problems
    assert problem.message == "`tool` must be a table, not an integer"


def test_files_that_cannot_be_read(tmp_path: Path) -> None:
    missing = read_configuration(str(tmp_path / "none.toml"))
    assert missing is not None
    assert [(each.code, each.message) for each in missing.problems] == [("SC606", "there is no such file")]
    (tmp_path / "pyproject.toml").write_bytes(b"[tool.scenic]\nselect = ['\xff']")
    bad = read_configuration(str(tmp_path / "pyproject.toml"))
    assert bad is not None
    assert bad.problems[0].code == "SC606"
    # What is not ours does not matter when it is only looked at on the way.
    (tmp_path / "pyproject.toml").write_text("[broken")
    assert read_configuration(str(tmp_path / "pyproject.toml"), required=False) is None


def test_the_nearest_one_holds(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    inner = tmp_path / "a" / "b" / "c"
    inner.mkdir(parents=True)
    (tmp_path / "pyproject.toml").write_text('[tool.scenic]\nignore = ["SC300"]\nselect = 1\n')
    (tmp_path / "a" / "pyproject.toml").write_text("[project]\nname = 'scenic'\n")
    (tmp_path / "a" / "b" / "pyproject.toml").write_text("[tool.scenic]\n")
    configurations = Configurations()
    assert configurations.of_file(str(inner / "x.scenic")).rules == Rules()
    assert configurations.problems == ()
    outer = configurations.of_file(str(tmp_path / "a" / "x.scenic"))
    assert outer.rules.ignore == ("SC300",)
    assert configurations.of_file(str(tmp_path / "y.scenic")) is outer
    monkeypatch.chdir(tmp_path / "a" / "b")
    assert Configurations().of_file("x.scenic").folder == str(tmp_path / "a" / "b")
    monkeypatch.chdir(tmp_path / "a")
    assert Configurations().of_folder(os.curdir) == outer
    assert len(configurations.problems) == 1
    fixed = Configurations(PLAIN)
    assert fixed.of_folder(str(tmp_path)) is PLAIN
    assert fixed.problems == ()


@given(st.text(st.sampled_from("[]{}.='\" \n#abtoolscenicseverity-SC3,"), max_size=80))
def test_any_text_is_answered(tmp_path_factory: pytest.TempPathFactory, text: str) -> None:
    file = tmp_path_factory.getbasetemp() / "any.toml"
    file.write_text(f"[tool.scenic]\n{text}")
    found = read_configuration(str(file))
    assert found is not None
    lines = file.read_text().split("\n")
    for problem in found.problems:
        span = problem.span
        assert span is None or span.end_column <= len(lines[span.end_line - 1])
