"""Typed programs: a few of them in each run, and that what fails is found and shrunk."""

import pytest

from fuzz.semantics import rounds
from fuzz.semantics.properties import Run


def test_some_programs_hold_what_every_program_must() -> None:
    report = rounds.run_round(3, 8)
    assert not report.failures, report.failures[0]
    assert report.outcomes["sampled"] >= 2


def test_a_failure_is_shown_with_a_small_program(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    def has_no_region(run: Run) -> None:
        assert "CircularRegion" not in run.program.text

    monkeypatch.setattr(rounds, "PROPERTIES", {"has_no_region": has_no_region})
    [failure] = rounds.run_round(5, 60).failures
    assert failure.startswith("FAILED has_no_region (seed 5)")
    assert "\nego = new Object\nr0 = CircularRegion(Vector(0, 0, 0), 3)\n" in failure
