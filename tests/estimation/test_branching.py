"""Rare failures: moves that keep the law, rows that are equal however they come about, and what is said where splitting cannot help."""

import json
import math
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from scipy.stats import kstest

import scenic
from scenic.estimation.estimate import Estimate
from scenic.estimation.goals import EstimateError
from scenic.estimation.sentences import notes
from scenic.falsification.lineages import Ancestry, Descent, Lineage, LineageStep
from scenic.falsification.replaying import kept_run, replay
from scenic.falsification.search_folder import read_rows
from scenic.runtime.dynamics.time_draws import Draw, Seeded
from tests.estimation.test_estimating import BRAKE, rows_of

TAIL = """
xs = [Normal(0, 1) for i in range(3)]
param beyond = 3.719016 - sum(xs) / 3 ** 0.5
ego = new Object
"""
"""The probability of at most 0 is 1e-4."""

CORNER = """
x = Range(0, 1)
y = Range(0, 1)
ego = new Object at x @ y
require x + y < 0.02
param depth = x - 0.0002
"""
"""Of a thousand random draws not one makes a scene; of the scenes 0.0199 have at most 0."""


def split(text: str, **options: Any) -> Estimate:
    wanted = {"static": True, "rare": True, "seed": 1, **options}
    return scenic.estimate(scenic.scenarioFromString(text), **wanted)


def driven(**options: Any) -> Estimate:
    wanted = {"rare": True, "seed": 1, "timestep": 0.1, "max_steps": 12, "budget": 420, **options}
    wanted.setdefault("minimize", "min(gaps) - 4.6")
    text = f"{BRAKE}\nrecord (distance from ego to lead) as gaps"
    return scenic.estimate(scenic.scenarioFromString(text), "kinematic", **wanted)


def test_a_rare_failure_has_an_interval(tmp_path: Path) -> None:
    result = split(TAIL, objective="beyond", budget=4000, folder=tmp_path / "kept")
    low, high = result.interval
    assert low < 1e-4 < high < 1e-3
    assert low < result.probability < high
    assert result.runs == len(result.rows) <= 4000
    rows, lines = rows_of(result), (tmp_path / "kept" / "runs.jsonl").read_bytes()
    for cut in (len(lines) // 5, 4 * len(lines) // 5):
        (tmp_path / "kept" / "runs.jsonl").write_bytes(lines[:cut])
        again = split(TAIL, objective="beyond", budget=4000, folder=tmp_path / "kept", resume=True)
        assert rows_of(again) == rows
    run = next(row["run"] for row in rows if row["level"][1] == 3 and row["status"] == "counterexample")
    made = replay(kept_run(tmp_path / "kept", run), scenic.scenarioFromString(TAIL))
    assert made.departures == []


def test_parts_of_a_failure_count_together() -> None:
    """Seven uniform numbers are in order with probability 1/5040; each step down is a part."""
    text = "xs = [Range(0, 1) for i in range(7)]\nparam xs = xs\nego = new Object"
    result = split(text, minimize="max(x - y for x, y in zip(xs, xs[1:]))", budget=3000)
    assert result.interval.low < 1 / math.factorial(7) < result.interval.high < 1e-3
    for row in result.rows:
        (value,) = row["values"]
        (distance,) = row.get("distances", row["values"])
        assert distance >= value > 0 or distance == value
    assert sum("distances" in row for row in result.rows) > 1000


def test_parts_of_a_requirement_count_together() -> None:
    text = BRAKE.split("require")[0] + "\nrequire always (ego.position.y < 3 or lead.position.y < 22) as both"
    result = scenic.estimate(
        scenic.scenarioFromString(text),
        "kinematic",
        rare=True,
        budget=250,
        seed=1,
        timestep=0.1,
        max_steps=12,
    )
    assert any("distances" in row for row in result.rows)
    for row in result.rows:
        (value,), (distance,) = row["values"], row.get("distances", row["values"])
        assert (float(distance) <= 0) is (float(value) <= 0)
        assert float(distance) >= float(value)


def test_levels_are_of_scenes_that_meet_the_requirements() -> None:
    result = split(CORNER, objective="depth", budget=3000)
    low, high = result.interval
    assert low < 0.0199 < high
    assert all(row["values"] is not None for row in result.rows if row.get("move") is None)


def test_simulations_are_split_the_same_way_in_any_number_of_processes(tmp_path: Path) -> None:
    result = driven(folder=tmp_path / "kept")
    moved = [row for row in result.rows if row.get("move") is not None]
    assert moved
    assert 0 < result.interval.low < result.interval.high < 0.3
    lines = (tmp_path / "kept" / "runs.jsonl").read_bytes()
    (tmp_path / "kept" / "runs.jsonl").write_bytes(lines[: len(lines) // 2])
    again = driven(folder=tmp_path / "kept", resume=True, processes=2)
    assert rows_of(again) == rows_of(result)
    run = kept_run(tmp_path / "kept", moved[-1]["run"])
    text = f"{BRAKE}\nrecord (distance from ego to lead) as gaps"
    assert replay(run, scenic.scenarioFromString(text), "kinematic").departures == []
    plain = driven(rare=False, budget=None, n=100)
    assert result.interval.low < plain.interval.high
    assert plain.interval.low < result.interval.high


def test_moves_keep_the_law_of_scenes() -> None:
    text = "ego = new Object at Range(0, 1) @ Normal(0, 1), facing Uniform(0, 1, 2)"
    ancestry = Ancestry(scenic.scenarioFromString(text), 5)
    parents = [Lineage(run) for run in range(600)]
    children = [item.child(LineageStep(1000 + item.first, 0.7, 0.6)) for item in parents]
    before = np.array([item.places for item in ancestry.all_draws(parents)])
    after = np.array([item.places for item in ancestry.all_draws(children)])
    assert before.shape == (600, len(ancestry.axes)) == (600, 3)
    stayed = (before == after).mean(axis=0)
    assert stayed == pytest.approx(0.4, abs=0.08)
    for axis in range(3):
        assert kstest(after[:, axis], "norm").pvalue > 0.001
        together = np.corrcoef(before[:, axis], after[:, axis])[0, 1]
        assert together == pytest.approx(0.4 + 0.6 * math.sqrt(1 - 0.49), abs=0.08)


def test_moves_keep_the_law_of_draws_in_time() -> None:
    what = Draw(1, None, "", 0, 0, 0)
    lineage = Lineage(3).child(LineageStep(9, 0.5, 1.0)).child(LineageStep(12, 0.8, 0.5))
    source = Descent(7, lineage)(Seeded(b"other"))
    first = Seeded(b"7:3:1")
    numbers = np.array([source.draw(place, what) for place in range(1500)])
    assert kstest(numbers, "uniform").pvalue > 0.001
    assert np.corrcoef(numbers, [first.draw(place, what) for place in range(1500)])[0, 1] > 0.5
    assert Descent(7, Lineage(3))(Seeded(b"other")).draw(4, what) == first.draw(4, what)
    words = [source.word(place) for place in range(300)]
    assert 0.3 < np.mean([word == first.word(place) for place, word in enumerate(words)]) < 0.8


@pytest.mark.parametrize(
    ("text", "options", "words"),
    [
        (
            "param v = Discrete({1: 0.97, 0: 0.03})\nego = new Object",
            {"objective": "v", "budget": 500},
            "say how near",
        ),
        (TAIL, {"objective": "beyond", "budget": 300}, "ended before two repetitions"),
        ("param v = Range(-1, 1)\nego = new Object", {"objective": "v", "budget": 900}, "not rare here"),
    ],
)
def test_what_is_said_where_splitting_does_not_help(text: str, options: dict[str, Any], words: str) -> None:
    result = split(text, **options)
    assert any(words in note for note in notes(result))
    low, high = result.interval
    assert 0 <= low <= result.probability <= high <= 1
    assert result.runs <= options["budget"]


def test_values_that_say_nothing_leave_plain_runs() -> None:
    text = "import math\nparam v = Discrete({math.inf: 0.97, -math.inf: 0.03})\nego = new Object"
    result = split(text, objective="v", budget=800)
    assert result.total.runs == len(result.rows) == 800
    assert result.interval.low < 0.03 < result.interval.high


def test_a_splitting_of_other_size_is_another_estimate(tmp_path: Path) -> None:
    split(TAIL, objective="beyond", budget=300, folder=tmp_path / "kept")
    before = read_rows(tmp_path / "kept")
    with pytest.raises(Exception, match="its budget of the splitting differs"):
        split(TAIL, objective="beyond", budget=400, folder=tmp_path / "kept", resume=True)
    assert read_rows(tmp_path / "kept") == before
    with pytest.raises(EstimateError, match="begin with number 0"):
        split(TAIL, objective="beyond", first=3)
    with pytest.raises(EstimateError, match="contradict each other"):
        split(TAIL, objective="beyond", precision=0.1)


def test_one_scene_is_held(tmp_path: Path) -> None:
    text = f"{BRAKE}\nrecord initial lead.position.y as start\nrecord final ego.position.y as end"
    scenario = scenic.scenarioFromString(text)
    options: dict[str, Any] = {"seed": 1, "timestep": 0.1, "max_steps": 40, "hold": 0, "n": 8}
    start = {
        row["values"][0] for row in scenic.estimate(scenario, "kinematic", minimize="start", **options).rows
    }
    end = {row["values"][0] for row in scenic.estimate(scenario, "kinematic", minimize="end", **options).rows}
    assert (len(start), len(end)) == (1, 8)
    (scene,) = scenario.sample(1, seed=1)
    assert start == {scene.objects[1].position.y}
    options["hold"] = scene
    kept = scenic.estimate(scenario, "kinematic", minimize="end", folder=tmp_path / "kept", **options)
    assert {row["values"][0] for row in kept.rows} == end
    assert replay(kept_run(tmp_path / "kept", 5), scenario, "kinematic").departures == []
    with pytest.raises(EstimateError, match="in one scene"):
        split(TAIL, objective="beyond", rare=False, hold=0)
    assert json.loads((tmp_path / "kept" / "manifest.json").read_text())["held"]["scene"] == 0
