"""`Scenario.profile`: where the time of sampling goes."""

from pathlib import Path

import pytest

from scenic.language.errors import SamplingError
from scenic.runtime.sampling.profiling import CheckRow
from tests.cli.commands import run_here
from tests.runtime.programs import fingerprint, scenario

PROGRAM = """
ego = new Object at (Range(-5, 5), 0)
other = new Object at (Range(-5, 5), 5)
def far(a, b):
    return abs(a.position.x - b.position.x) > 1
require far(ego, other)
require ego.position.x > 2 * other.position.x
require[0.5] other.position.x > 0
"""


def check_row(rows: list[CheckRow], line: int) -> CheckRow:
    (row,) = (row for row in rows if row.line == line)
    return row


def test_profile_counts_candidates_and_names_lines() -> None:
    program = scenario(PROGRAM)
    found = program.profile(100, seed=2)
    attempts = sum(scene.attempts for scene in program.sample(100, seed=2))
    assert found.scenes == 100
    assert found.candidates >= attempts
    assert found.passed >= 100
    assert found.acceptance == found.passed / found.candidates
    assert [row.line for row in found.in_python] == [6]
    rows = list(found.checks)
    assert {row.line for row in rows} == {None, 6, 7, 8}
    # Requirements that are asked together may both reject a candidate.
    assert sum(row.candidates - row.passed for row in rows) >= found.candidates - found.passed
    called = check_row(rows, 6)
    (operation,) = (row for row in found.operations if row.in_python)
    assert (operation.line, operation.values) == (6, called.candidates)
    assert operation == found.operations[0]
    ranges = {row.line: row.values for row in found.operations if row.operation == "range"}
    assert set(ranges) == {2, 3}
    assert sum(row.seconds for row in found.operations) <= found.seconds
    shown = str(found)
    assert f"{found.candidates} candidates" in shown
    assert f"requirement on line 6 (line 6, in Python): {called.passed} of {called.candidates} pass" in shown


def test_profile_changes_no_scene() -> None:
    program, other = scenario(PROGRAM), scenario(PROGRAM)
    program.profile(50, seed=2)
    assert [*map(fingerprint, program.sample(5, seed=2))] == [*map(fingerprint, other.sample(5, seed=2))]


def test_profile_has_limits_and_raises_as_sampling_does() -> None:
    never = scenario(
        "ego = new Object at (Range(0, 1), 0)\ndef f(x):\n    return False\nrequire f(ego.width)"
    )
    assert never.profile(2, max_attempts=30).scenes == 0
    wrong = scenario("ego = new Object at (Range(0, 1), 0)\ndef f(x):\n    return x.y\nrequire f(ego.width)")
    with pytest.raises((SamplingError, AttributeError)):
        wrong.profile(1)


def test_command_shows_a_profile(tmp_path: Path) -> None:
    (tmp_path / "program.scenic").write_text(PROGRAM)
    shown = run_here(
        ["sample", "program.scenic", "-n", "20", "--seed", "2", "--profile"],
        folder=tmp_path,
        variables={"NO_COLOR": "1", "COLUMNS": "100"},
    )
    assert shown.returncode == 0
    assert "20 scenes from" in shown.stdout
    assert "opaque condition (in Python) │    6 │" in shown.stdout
    assert "requirement on line 6 calls Python code for each candidate" in shown.stdout
    refused = run_here(
        ["sample", "program.scenic", "--profile", "-o", "x.jsonl"], folder=tmp_path, variables={}
    )
    assert refused.returncode == 2
