"""``scenic explain``."""

import re

import pytest
from click.testing import CliRunner, Result

from scenic.cli import explain as command
from scenic.cli.main import scenic
from scenic.language.diagnostics import CODES
from scenic.language.explanations import explanation


def run(*arguments: str) -> Result:
    return CliRunner().invoke(scenic, ["explain", *arguments])


@pytest.mark.parametrize("written", ["SC111", "sc111", "111", "error[SC111]", " Sc111 "])
def test_the_page_as_it_is_where_there_is_no_terminal(written: str) -> None:
    result = run(written)
    assert result.exit_code == 0
    assert result.output == explanation("SC111").text


def test_colours_on_a_terminal(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(command, "has_colours", lambda stream: True)
    output = run("SC300").output
    assert "\x1b[" in output
    plain = re.sub(r"\x1b\[[0-9;]*m", "", output)
    assert "```" not in plain
    assert "#" not in plain.replace("# scenic: ignore", "")
    assert "    ego = new Object with widht 2\n" in plain
    assert re.search(r"\x1b\[1;33m1:\d+: warning\[SC300\]", output)


def test_without_a_code_all_are_listed() -> None:
    result = run()
    assert result.exit_code == 0
    listed = dict(re.findall(r"^  (SC\d{3})  (.*)$", result.output, re.MULTILINE))
    assert listed == dict(CODES)
    assert "Lexical and syntax errors\n  SC100" in result.output


@pytest.mark.parametrize(("written", "meant"), [("SC1111", "SC111"), ("SX111", "SC111"), ("SC139", "SC136")])
def test_a_code_that_does_not_exist(written: str, meant: str) -> None:
    result = run(written)
    assert result.exit_code == 2
    assert f"There is no diagnostic '{written}'. Did you mean '{meant}'?" in result.stderr
    assert "'scenic explain' lists all" in result.stderr


def test_nonsense_is_like_nothing() -> None:
    result = run("nonsense")
    assert result.exit_code == 2
    assert "Did you mean" not in result.stderr
