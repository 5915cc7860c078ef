"""Simulations that violate requirements, kept: their rows, summary and table."""

import csv
import io
from pathlib import Path
from xml.etree import ElementTree

import scenic
from scenic.batch.simulations import Simulations, SimulationSettings
from scenic.batch.summaries import SettingRuns, csv_of, summary, verdict_of
from tests.cli.commands import run_here

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
    table = list(csv.DictReader(io.StringIO(csv_of([SettingRuns(dict(enumerate(rows)))]))))
    assert [line["verdict"] for line in table] == [verdict_of(row) for row in rows]
    assert min(float(line["robustness"]) for line in table) == min(
        row.about["requirements"][0]["robustness"] for row in rows
    )
    failed = sum(verdict_of(row) == "violated" for row in rows)
    assert 0 < failed < 8
    assert summary(SettingRuns(dict(enumerate(rows)))).startswith(
        f"8 simulations: {8 - failed} held, {failed} violated; robustness "
    )
    assert summary(SettingRuns(dict(enumerate(rejecting)))).startswith(
        f"8 simulations: {8 - failed} held, {failed} rejected"
    )


def test_only_violations_are_written_where_that_is_asked(tmp_path: Path) -> None:
    running = SimulationSettings(1, 10, 1.0, keep_violations=True)
    batch = Simulations(
        scenic.scenarioFromString(PROGRAM), "kinematic", running, folder=tmp_path, only_violations=True
    )
    rows = [batch(k) for k in range(8)]
    written = {path.name for path in tmp_path.iterdir()}
    assert written == {f"simulation-{row.k:04d}.jsonl" for row in rows if verdict_of(row) == "violated"}


def test_a_sweep_has_one_table_and_one_plot(tmp_path: Path) -> None:
    program = tmp_path / "sweep.scenic"
    program.write_text("param gap = 1, mode = 'a'\n" + PROGRAM.replace("(0, 8)", "(0, globalParameters.gap)"))
    options = ["-n", 3, "--seed", 1, "--time", 5, "--timestep", 1, "--keep", "all"]
    swept = ["-p", "gap=4,40", "-p", 'mode="a,b"', "-o", "runs", "--table", "t.csv", "--plot", "p.svg"]
    done = run_here(["simulate", program, *options, *swept], folder=tmp_path)
    assert done.returncode == 0, done.stderr
    assert "gap=4: 3 simulations: 2 held, 1 violated" in done.stdout
    assert "gap=40: 3 simulations: 3 held" in done.stdout
    table = list(csv.DictReader(io.StringIO((tmp_path / "t.csv").read_text())))
    assert [(line["gap"], line["k"]) for line in table] == [(gap, k) for gap in ("4", "40") for k in "012"]
    plot = ElementTree.parse(tmp_path / "p.svg").getroot()
    assert sum(item.tag.endswith("circle") for item in plot.iter()) == 6
    assert len(list((tmp_path / "runs" / "gap=40").glob("*.jsonl"))) == 3
    # What is there already is not simulated again.
    assert (
        run_here(["simulate", program, *options, *swept, "--resume"], folder=tmp_path).stdout == done.stdout
    )
