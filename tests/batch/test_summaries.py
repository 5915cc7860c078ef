"""Simulations that violate requirements, kept: their rows, summary and table."""

import csv
import io
from pathlib import Path

import scenic
from scenic.batch.simulations import Running, Simulations
from scenic.batch.summaries import csv_of, summary, verdict_of

PROGRAM = """
from scenic.simulators.kinematic import SetVelocity
behavior Go():
    while True:
        take SetVelocity((0, 1))
ego = new Object at (Range(-3, 3), 0), with behavior Go
other = new Object at (0, 8), with allowCollisions True
require always (distance from ego to other) > 2 as apart
"""


def test_violations_are_kept_with_their_robustness(tmp_path: Path) -> None:
    scenario = scenic.scenarioFromString(PROGRAM)
    options = {"seed": 1, "simulator": "kinematic", "max_steps": 10, "timestep": 1.0}
    rejecting = scenario.simulate(8, tries=2, **options)
    rows = scenario.simulate(8, keep_violations=True, **options)
    for row, strict in zip(rows, rejecting, strict=True):
        assert row.about is not None
        (outcome,) = row.about["requirements"]
        violated = outcome["robustness"] < 0
        assert (outcome["verdict"] == "FALSE") == violated == (strict.about is None)
        assert verdict_of(row) == ("violated" if violated else "held")
        assert row.about["steps"] == 10  # to its end
    table = list(csv.DictReader(io.StringIO(csv_of(rows))))
    assert [line["verdict"] for line in table] == [verdict_of(row) for row in rows]
    assert min(float(line["robustness"]) for line in table) == min(
        row.about["requirements"][0]["robustness"] for row in rows
    )
    failed = sum(verdict_of(row) == "violated" for row in rows)
    assert 0 < failed < 8
    assert summary(rows).startswith(f"8 simulations: {8 - failed} held, {failed} violated; robustness ")
    assert summary(rejecting).startswith(f"8 simulations: {8 - failed} held, {failed} rejected")


def test_only_violations_are_written_where_that_is_asked(tmp_path: Path) -> None:
    running = Running(1, 10, 1.0, keep_violations=True)
    batch = Simulations(
        scenic.scenarioFromString(PROGRAM), "kinematic", running, folder=tmp_path, only_violations=True
    )
    rows = [batch(k) for k in range(8)]
    written = {path.name for path in tmp_path.iterdir()}
    assert written == {f"simulation-{row.k:04d}.jsonl" for row in rows if verdict_of(row) == "violated"}
