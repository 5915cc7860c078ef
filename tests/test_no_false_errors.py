"""Programs that run, as was recorded of them, and that the check therefore must not call wrong."""

import json
from pathlib import Path
from typing import Any

import pytest

from scenic.compiler.check import check_text
from scenic.language.diagnostics import Severity
from scenic.project.index import Project
from scenic.project.surroundings import surroundings_in
from tests.dynamic_programs import FOLDER, programs, recorded, reviewed
from tests.reference_programs import DRAWN, FIXED

RECORDED = Path(__file__).parent / "data" / "reference"
TABLE: dict[str, Any] = json.loads((RECORDED / "table.json").read_text())
RESULTS: dict[str, dict[str, Any]] = json.loads((RECORDED / "fixed.json").read_text())


WRONG = {
    "expression VectorField('f', 3)",
    "mistake no width",
    "prop width -1",
    "specifier with height 0",
    "specifier with width -1",
    "prop width 0",
    "prop length 0",
    "prop height 0",
}
"""A field that fails as soon as it is used, and sizes that the specification refuses."""


def _simulated() -> dict[str, str]:
    """The programs of which simulations were recorded that came to their end."""
    found = {}
    differing = reviewed()
    for file in sorted(FOLDER.glob("*.txt")):
        results = recorded(file)
        for name, program in programs(file).items():
            result = differing.get(name) or results.get(name) or {}
            if "error" not in result:
                found[f"{file.stem}: {name}"] = program.text
    return found


def _sampled() -> dict[str, str]:
    """The programs of which scenes were recorded."""
    found = {name: program.text for name, program in DRAWN.items()}
    found |= {name: program.text for name, program in FIXED.items() if "error" not in RESULTS[name]}
    for name, entry in TABLE["programs"].items():
        if "params" in entry or "samples" in entry:
            found[name] = entry["program"].replace("{SETTING}", TABLE["setting"])
    return found


@pytest.mark.parametrize("texts", [_simulated(), _sampled()], ids=["simulated", "sampled"])
def test_programs_that_run_have_no_errors(texts: dict[str, str]) -> None:
    surroundings_of = surroundings_in(Project())
    assert len(texts) > 400
    texts = {name: text for name, text in texts.items() if name not in WRONG}
    wrong = {
        name: [f"{each.code} {each.message}" for each in found]
        for name, text in texts.items()
        if (
            found := [
                each
                for each in check_text(text, filename="/nowhere/p.scenic", surroundings_of=surroundings_of)
                if each.severity is Severity.ERROR
            ]
        )
    }
    assert not wrong
