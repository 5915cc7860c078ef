"""Warnings about textures whose image files are missing."""

from pathlib import Path

import pytest

from scenic.batch.source_files import warn_of_textures
from scenic.language.diagnostics import Severity
from scenic.language.errors import ScenicWarning
from scenic.pipeline import load
from tests.project.test_checks import findings

PROGRAM = """\
class Box:
    texture: "deal.png"
ego = new Box
new Object at (4, 4), with texture Uniform("oak.png", {"image": "deel.png", "scale": 2}, "checker")
new Object at (8, 8), with texture Discrete({"deel.png": 1, "deal.png": 2})
new Object at (12, 8), with texture "wood" + ".png"
"""


@pytest.fixture
def program(tmp_path: Path) -> Path:
    (tmp_path / "deal.png").touch()
    path = tmp_path / "room.scenic"
    path.write_text(PROGRAM)
    return path


def test_check_warns_at_the_name(program: Path) -> None:
    found = [item for item in findings(program, PROGRAM) if item.code == "SC613"]
    lines = PROGRAM.splitlines()
    shown = [
        lines[item.span.line - 1][item.span.column : item.span.end_column] for item in found if item.span
    ]
    assert shown == ['"oak.png"', '"deel.png"', '"deel.png"']
    assert [item.severity for item in found] == [Severity.WARNING] * 3
    assert [item.help for item in found] == [
        "paths of textures start from the folder of the program",
        *["did you mean 'deal.png'?"] * 2,
    ]


def test_sampling_warns_once_a_file(program: Path) -> None:
    program.write_text(PROGRAM.replace("deal.png", "deel.png"))
    scenario = load(program)
    with pytest.warns(ScenicWarning) as caught:
        warn_of_textures(scenario)
    messages = [str(item.message) for item in caught]
    assert [name for message in messages for name in ("oak", "deel", "wood") if f"{name}.png" in message] == [
        "deel",
        "oak",
        "wood",
    ]
