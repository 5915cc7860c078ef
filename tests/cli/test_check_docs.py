"""docs/reference/check.md shows what is so."""

import json
import re
import tomllib
from pathlib import Path

from click.testing import CliRunner

from scenic.cli.check import check
from scenic.configuration.project import read_configuration

PAGE = (Path(__file__).parents[2] / "docs" / "reference" / "check.md").read_text(encoding="utf-8")


def block(language: str) -> str:
    (found,) = re.findall(rf"```{language}(?: fragment)?\n(.*?)```", PAGE, re.DOTALL)
    return str(found)


def test_every_option_is_named() -> None:
    for option in check.params:
        for name in option.opts:
            if name.startswith("--"):
                assert name in PAGE


def test_the_configuration_is_right(tmp_path: Path) -> None:
    file = tmp_path / "pyproject.toml"
    file.write_text(block("toml"))
    found = read_configuration(str(file))
    assert found is not None
    assert found.problems == ()
    assert set(tomllib.loads(block("toml"))["tool"]["scenic"]) < set(
        re.findall(r"^\| `([a-z-]+)` \|", PAGE, re.MULTILINE)
    )


def test_the_json_is_what_comes_out(tmp_path: Path) -> None:
    file = tmp_path / "road.scenic"
    program = block("scenic").partition("#")[0]
    file.write_text(program)
    result = CliRunner().invoke(check, ["--format", "json", "--no-config", str(file)], standalone_mode=False)
    assert json.loads(result.stdout.replace(str(file), "road.scenic")) == json.loads(block("json"))
    file.write_text(block("scenic"))
    assert json.loads(CliRunner().invoke(check, ["--format", "json", str(file)]).stdout)["diagnostics"] == []
