"""The README's example is the file it names, and prints what it says."""

import re
import subprocess
import sys
from pathlib import Path

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


def test_links_lead_somewhere() -> None:
    for target in re.findall(r"\]\((?!https?:)([^)#]+)\)", README):
        assert (ROOT / target).exists(), target
