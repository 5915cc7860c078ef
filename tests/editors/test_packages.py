"""What editors and other tools install: its parts are there, and the commands that it names exist."""

import json
import re
import shlex
from pathlib import Path
from typing import Any

import pytest
from click.testing import CliRunner

from scenic.cli.main import scenic

ROOT = Path(__file__).resolve().parents[2]
VSCODE = ROOT / "editors" / "vscode"


def manifest() -> Any:
    return json.loads((VSCODE / "package.json").read_text(encoding="utf-8"))


def paths(value: Any) -> list[str]:
    """All relative paths in a manifest."""
    match value:
        case dict():
            return [path for each in value.values() for path in paths(each)]
        case list():
            return [path for each in value for path in paths(each)]
        case str() if value.startswith("./") and "/dist/" not in value:
            return [value]
    return []


def test_the_extension_has_all_its_files() -> None:
    found = paths(manifest())
    assert len(found) == 4
    for path in found:
        json.loads((VSCODE / path).read_text(encoding="utf-8"))


def test_the_extension_runs_nothing_where_nobody_is_trusted() -> None:
    trust = manifest()["capabilities"]["untrustedWorkspaces"]
    assert trust["supported"] == "limited"
    settings = manifest()["contributes"]["configuration"]["properties"]
    commands = [name for name in settings if "command" in name]
    # A workspace must not say what the editor starts.
    assert commands == trust["restrictedConfigurations"]
    assert all(settings[name]["scope"].startswith("machine") for name in commands)


def test_the_extension_uses_the_commands_of_the_server() -> None:
    from scenic.lsp.capabilities import COMMANDS

    client = (VSCODE / "src" / "extension.ts").read_text(encoding="utf-8")
    plugin = (ROOT / "editors" / "neovim" / "lua" / "scenic" / "init.lua").read_text(encoding="utf-8")
    for command in COMMANDS:
        assert f'"{command}"' in client
        assert f'"{command}"' in plugin
    offered = {each["command"] for each in manifest()["contributes"]["commands"]}
    registered = set(re.findall(r'registerCommand\("(.*?)"', client))
    assert offered == registered


def commands() -> list[str]:
    hooks = re.findall(r"entry: (.*)", (ROOT / ".pre-commit-hooks.yaml").read_text(encoding="utf-8"))
    [action] = re.findall(r"run: (scenic .*)", (ROOT / "action.yml").read_text(encoding="utf-8"))
    return [*hooks, action.replace("$OPTIONS", "").replace("$PATHS", "")]


@pytest.mark.parametrize(("text", "code"), [("x = 3\n", 0), ("x = = 3\n", 1)])
@pytest.mark.parametrize("command", commands())
def test_hooks_and_actions_tell_right_from_wrong(command: str, text: str, code: int, tmp_path: Path) -> None:
    file = tmp_path / "program.scenic"
    file.write_text(text)
    name, *arguments = shlex.split(command)
    assert name == "scenic"
    result = CliRunner().invoke(scenic, [*arguments, str(file)], standalone_mode=False)
    assert result.return_value == code, result.output
