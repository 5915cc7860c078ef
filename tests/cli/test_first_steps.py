"""Commands that help with the installation and with the first steps."""

from importlib import metadata
from pathlib import Path

import pytest

import scenic
from scenic.cli.main import scenic as command_line
from scenic.installation import State, findings
from scenic.language.extras import EXTRAS, installation
from scenic.simulators.numbered_simulations import choose_simulator, simulate_number
from scenic.templates import TEMPLATES, copy
from tests.cli.commands import run_here

ROOT = Path(__file__).parents[2]


def test_the_help_lists_every_command_once_with_examples() -> None:
    shown = run_here(["--help"]).stdout
    assert "Examples:\n  scenic new kitchen --template tabletop  # begin\n" in shown
    for name in command_line.list_commands(None):  # type: ignore[arg-type]
        assert shown.count(f"\n  {name} ") == (name != "preview"), name


def test_a_misspelt_choice_reminds_of_the_right_one() -> None:
    refused = run_here(["check", "--format", "jsn"])
    assert refused.returncode == 2
    assert "did you mean 'json'?" in refused.stderr
    assert "did you mean" not in run_here(["check", "--format", "xml"]).stderr


@pytest.mark.parametrize("shell", ["bash", "zsh", "fish"])
def test_completion_scripts_ask_for_completions(shell: str) -> None:
    script = run_here(["completion", shell]).stdout
    assert "_SCENIC_COMPLETE" in script


def test_commands_and_options_are_completed() -> None:
    asked = {"_SCENIC_COMPLETE": "bash_complete", "COMP_WORDS": "scenic sim", "COMP_CWORD": "1"}
    assert run_here([], variables=asked).stdout == "plain,simulate\n"
    asked |= {"COMP_WORDS": "scenic sample --see", "COMP_CWORD": "2"}
    assert run_here([], variables=asked).stdout == "plain,--seed\n"
    asked |= {"COMP_WORDS": "scenic sample ro", "COMP_CWORD": "2"}
    assert run_here([], variables=asked).stdout == "file,ro\n"


def test_doctor_tells_what_is_there_and_how_to_get_the_rest(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setitem(__import__("sys").modules, "websockets", None)
    monkeypatch.setattr("importlib.util.find_spec", lambda name: None if name == "websockets" else object())
    monkeypatch.setattr(metadata, "packages_distributions", lambda: {"scenic": ["scenic-lang", "scenic"]})
    done = run_here(["doctor"])
    assert done.returncode == 1
    assert "the distribution 'scenic' brings a package `scenic`, too" in done.stdout
    assert "--  extra playground" in done.stdout
    assert installation("playground") in done.stdout
    assert "ok  rendering" in done.stdout


def test_doctor_finds_nothing_wrong_here() -> None:
    assert [finding for finding in findings() if finding.state is State.PROBLEM] == []


def test_extras_are_those_of_the_package() -> None:
    text = (ROOT / "pyproject.toml").read_text(encoding="utf-8")
    section = text.split("[project.optional-dependencies]")[1].split("\n[")[0]
    declared = {line.split(" = ")[0] for line in section.splitlines() if line.endswith(" = [")}
    assert set(EXTRAS) == declared - {"dev", "docs", "fuzz"}


def test_the_cache_is_told_of_and_emptied(tmp_path: Path) -> None:
    chosen = {"SCENIC_CACHE": "on", "SCENIC_CACHE_DIR": str(tmp_path)}
    (tmp_path / "one.arrays").write_bytes(b"x" * 2**20)
    (tmp_path / "other.txt").write_text("not ours")
    assert "files   1\nsize    1.0 of" in run_here(["cache", "info"], variables=chosen).stdout
    assert run_here(["cache", "clear"], variables=chosen).stdout == "1.0 MiB removed\n"
    assert [path.name for path in tmp_path.iterdir()] == ["other.txt"]
    off = run_here(["cache", "info"], variables={"SCENIC_CACHE": "off"})
    assert off.stdout == "the cache is turned off (SCENIC_CACHE)\n"


@pytest.mark.parametrize("template", TEMPLATES)
def test_templates_are_programs_without_mistakes(template: str, tmp_path: Path) -> None:
    assert {"README.md", "scene.scenic"} <= set(copy(template, tmp_path / "new"))
    program = tmp_path / "new" / "scene.scenic"
    assert list(scenic.parse(program.read_text()).diagnostics) == []
    scenario = scenic.load(program, mode2D=template == "driving")
    scenario.sample(2, seed=1)
    if template != "tabletop":
        simulator = choose_simulator(None, scenario)
        done = simulate_number(scenario, simulator, seed=1, k=0, tries=5, maxSteps=150)
        assert done.simulation is not None, done.rejections


def test_new_makes_a_folder_and_keeps_what_is_there(tmp_path: Path) -> None:
    made = run_here(["new", "first", "--template", "drone"], folder=tmp_path)
    assert made.stdout.startswith("first/README.md\nfirst/scene.scenic\nnext: scenic sample")
    again = run_here(["new", "first"], folder=tmp_path)
    assert again.returncode == 2
    assert "'first' is not empty" in again.stderr
