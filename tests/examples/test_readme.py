"""The README's example is the file it names, and prints what it says."""

import re
import subprocess
import sys
from pathlib import Path

import pytest

from tests.cli.commands import run_here

ROOT = Path(__file__).parents[2]
README = (ROOT / "README.md").read_text()


def blocks(language: str) -> list[str]:
    return re.findall(rf"^```{language}\n(.*?)^```$", README, re.DOTALL | re.MULTILINE)


def test_the_program_is_the_one_in_the_file() -> None:
    (program,) = blocks("scenic")
    assert (ROOT / "examples" / "indoor" / "desk.scenic").read_text().endswith(program)


def test_the_code_prints_what_is_shown() -> None:
    (code,), (shown,) = blocks("python"), blocks("text")
    result = subprocess.run(
        [sys.executable, "-c", code], cwd=ROOT, capture_output=True, text=True, check=True
    )
    assert result.stdout == shown


@pytest.mark.slow
def test_its_commands_run_in_order(tmp_path: Path) -> None:
    (tmp_path / "examples").symlink_to(ROOT / "examples")
    lines = [line.partition("#")[0].split() for block in blocks("sh") for line in block.splitlines()]
    commands = [words[1:] for words in lines if words[:1] == ["scenic"]]
    assert [command[0] for command in commands] == ["sample", "simulate", "doctor", "new"]
    for command in commands:
        done = run_here(command, folder=tmp_path)
        assert done.returncode == 0, done.stderr
    assert {"desks.html", "desks.jsonl", "kitchen", "pictures", "runs", "runs.html"} <= {
        path.name for path in tmp_path.iterdir()
    }


def test_links_lead_somewhere() -> None:
    for target in re.findall(r"\]\((?!https?:)([^)#]+)\)", README):
        assert (ROOT / target).exists(), target
