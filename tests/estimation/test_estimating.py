"""Estimates: the same rows however they run, intervals that hold, and what is said of bad input."""

import json
from pathlib import Path
from typing import Any

import pytest
from scipy.stats import binomtest

import scenic
from scenic.estimation.estimate import Asked, Estimate, Tally
from scenic.estimation.estimating import asked_of, load_estimate
from scenic.estimation.goals import EstimateError
from scenic.falsification.evaluating import SearchError
from scenic.falsification.objectives import ObjectiveError
from scenic.falsification.replaying import kept_run, replay
from scenic.falsification.search_folder import EstimateFolderError, read_rows
from scenic.statistics.confidence_intervals import exact_interval
from tests.amounts import amount
from tests.cli.commands import run_here

BRAKE = """
from scenic.simulators.kinematic import SetVelocity
speed = Range(2, 8)
gap = Range(4, 30)
lead = new Object at (0, gap + 4)
behavior Drive():
    v = speed
    while True:
        if (distance to lead) < 12:
            v = max(0, v - Range(0.2, 0.3))
        take SetVelocity((0, v, 0))
ego = new Object with behavior Drive()
require always (distance from ego to lead) > 3 as keeps_distance
require eventually ego.position.y > 1.5 as drives
"""

COIN = "param x = Range(0, 1)\nego = new Object at Range(0, 1) @ 0\nrequire ego.position.x > 0.5"


def rows_of(result: Estimate) -> list[dict[str, Any]]:
    return [{name: value for name, value in row.items() if name != "seconds"} for row in result.rows]


def braking(**options: Any) -> Estimate:
    wanted = {"n": 40, "seed": 1, "timestep": 0.1, "max_steps": 30, **options}
    return scenic.estimate(scenic.scenarioFromString(BRAKE), "kinematic", **wanted)


def tossed(threshold: float, **options: Any) -> Estimate:
    scenario = scenic.scenarioFromString(COIN)
    return scenic.estimate(
        scenario, static=True, objective="x", threshold=threshold, **{"seed": 1, **options}
    )


def test_rows_are_equal_for_any_number_of_processes_and_after_a_resumption(tmp_path: Path) -> None:
    whole = braking(folder=tmp_path / "whole")
    rows = rows_of(whole)
    assert rows_of(braking(processes=2)) == rows
    lines = (tmp_path / "whole" / "runs.jsonl").read_bytes()
    for number, cut in enumerate((len(lines) // 3, len(lines) - 1)):
        folder = tmp_path / f"cut{number}"
        braking(folder=folder, n=1)
        manifest = json.loads((tmp_path / "whole" / "manifest.json").read_text())
        (folder / "manifest.json").write_text(json.dumps(manifest))
        (folder / "runs.jsonl").write_bytes(lines[:cut])
        again = braking(folder=folder, resume=True, processes=1 + number)
        assert rows_of(again) == rows
        assert len(read_rows(folder)) == 40
        assert again.interval == whole.interval
    assert whole.is_repeatable


def test_rows_of_scenes_are_equal_for_any_number_of_processes() -> None:
    rows = rows_of(tossed(0.2, n=300))
    assert rows_of(tossed(0.2, n=300, processes=2)) == rows
    with pytest.raises(ObjectiveError, match="is not a parameter"):
        scenic.estimate(
            scenic.scenarioFromString(COIN), static=True, objective="y", n=10, processes=2, seed=1
        )


def test_runs_are_the_simulations_of_the_seed() -> None:
    result = braking(n=6, first=3)
    scenario = scenic.scenarioFromString(BRAKE)
    from scenic.batch.simulations import simulated

    options: dict[str, Any] = {"seed": 1, "first": 3, "timestep": 0.1, "max_steps": 30}
    rows = simulated(scenario, 6, simulator="kinematic", keep_violations=True, **options)
    for row, other in zip(result.rows, rows, strict=True):
        assert other.about is not None
        assert row["run"] == other.k
        wanted = {item["label"]: item["robustness"] for item in other.about["requirements"]}
        assert {name: item["robustness"] for name, item in row["requirements"].items()} == wanted


def test_counts_follow_from_the_rows() -> None:
    result = braking()
    failed = [row for row in result.rows if row["status"] == "counterexample"]
    assert 0 < result.violations == len(failed) < 40
    assert result.interval == exact_interval(len(failed), 40, 0.95)
    for row in result.rows:
        verdicts = [item["verdict"] for item in row["requirements"].values()]
        is_violated = any(verdict in ("FALSE", "PRESUMABLY_FALSE") for verdict in verdicts)
        assert (row["status"] == "counterexample") == is_violated
    distance, drives = result.requirements
    assert (distance.label, drives.label) == ("keeps_distance", "drives")
    assert distance.violations <= len(failed) <= distance.violations + drives.violations
    alone = braking(requirement="keeps_distance")
    assert (alone.violations, len(alone.requirements)) == (distance.violations, 1)
    assert braking(requirement="line 13").violations == distance.violations


def test_intervals_hold_the_probability_as_often_as_promised() -> None:
    """Cut a long estimate into short ones: each follows the program's law by itself."""
    length, count, probability = 100, amount(60, 2000), 0.05
    rows = tossed(probability, n=length * count).rows
    hits = 0
    for start in range(0, len(rows), length):
        tally = Tally()
        for row in rows[start : start + length]:
            tally.add(row)
        low, high = tally.interval(0.9, at_any_time=False)
        hits += low <= probability <= high
    assert binomtest(hits, count, 0.9, alternative="less").pvalue > 0.001


def test_an_estimate_stops_at_its_precision() -> None:
    result = tossed(0.3, precision=0.05, confidence=0.9)
    low, high = result.interval
    assert (result.is_finished, result.at_any_time) == (True, True)
    assert high - low <= 0.1
    assert low < 0.3 < high
    assert 500 < result.runs < 3000
    short = tossed(0.3, precision=0.05, budget=50)
    assert (short.is_finished, short.runs) == (False, 50)
    assert short.interval.half_width > 0.05


def test_a_test_of_a_bound_answers() -> None:
    answers = [tossed(share, at_most=0.2, seed=seed).answer for share in (0.05, 0.4) for seed in range(5)]
    assert answers == [True] * 5 + [False] * 5
    undecided = tossed(0.15, at_most=0.2, budget=10)
    assert undecided.answer is None
    assert not undecided.is_finished


def test_looking_before_more_runs_widens_the_interval(tmp_path: Path) -> None:
    first = tossed(0.3, n=100, folder=tmp_path / "a")
    same = tossed(0.3, n=100, folder=tmp_path / "a", resume=True)
    assert same.interval == first.interval
    more = tossed(0.3, n=200, folder=tmp_path / "a", resume=True)
    exact = exact_interval(more.violations, 200, 0.95)
    assert more.at_any_time
    assert more.interval.low < exact.low < exact.high < more.interval.high
    assert load_estimate([tmp_path / "a"]).interval == more.interval


def test_folders_of_disjoint_ranges_join(tmp_path: Path) -> None:
    whole = tossed(0.3, n=100)
    tossed(0.3, n=60, folder=tmp_path / "a")
    tossed(0.3, n=40, first=60, folder=tmp_path / "b")
    both = load_estimate([tmp_path / "b", tmp_path / "a"])
    assert both.rows == whole.rows
    assert both.interval == whole.interval
    tossed(0.3, n=10, first=55, folder=tmp_path / "c")
    tossed(0.4, n=10, first=200, folder=tmp_path / "d")
    with pytest.raises(EstimateFolderError, match="both hold run 55"):
        load_estimate([tmp_path / "a", tmp_path / "c"])
    with pytest.raises(EstimateFolderError, match="their threshold differs"):
        load_estimate([tmp_path / "a", tmp_path / "d"])


def test_a_kept_run_is_made_again(tmp_path: Path) -> None:
    result = braking(n=5, first=2, folder=tmp_path / "kept")
    run = kept_run(tmp_path / "kept", 4)
    again = replay(run, scenic.scenarioFromString(BRAKE), "kinematic")
    assert again.departures == []
    assert again.about["values"] == result.rows[2]["values"]


def test_failing_runs_count_for_both_outcomes() -> None:
    tally = Tally()
    for status in ["held"] * 8 + ["failed"] * 2 + ["rejected"] * 5:
        tally.add({"status": status, "values": [1.0]})
    low, high = tally.interval(0.95, at_any_time=False)
    assert (tally.runs, tally.unknown, tally.rejected, tally.share) == (10, 2, 5, 0)
    assert (low, high) == (0, exact_interval(2, 10, 0.95).high)
    failing = "behavior B():\n    raise KeyError('x')\n    wait\nego = new Object with behavior B()\nrequire always True"
    with pytest.raises(SearchError, match="10 runs in a row failed"):
        scenic.estimate(scenic.scenarioFromString(failing), "dummy", n=30)


@pytest.mark.parametrize(
    ("options", "words", "help"),
    [
        (
            {"requirement": "keeps_distanc"},
            "no requirement 'keeps_distanc'",
            "did you mean 'keeps_distance'?",
        ),
        ({"requirement": "speed"}, "no requirement 'speed'", "keeps_distance, drives"),
        ({"requirement": "drives", "minimize": "1"}, "contradict", "one of them"),
        ({"at_most": 1.5, "n": None}, "the bound 1.5 is not between 0 and 1", "1e-3"),
        ({"confidence": 95}, "the confidence 95 is not between", "0.01"),
        ({"precision": 0.1, "at_most": 0.1, "n": None}, "contradict", "one of them"),
        ({"precision": 0.1}, "contradicts", "budget"),
        ({"budget": 10}, "goes with", "the number of runs is fixed"),
        ({"good": 0.1}, "belongs to a bound", "--at-most"),
        ({"good": 0.1, "at_most": 0.1, "n": None}, "not below the bound", "more runs"),
        ({"static": True}, "scenes alone meet all requirements", "--minimize"),
    ],
)
def test_what_cannot_be_estimated(options: dict[str, Any], words: str, help: str) -> None:
    with pytest.raises(EstimateError, match=words) as caught:
        braking(**options)
    assert help in (caught.value.help or "")


def test_programs_without_runs() -> None:
    with pytest.raises(EstimateError, match="nothing in this program happens over time"):
        scenic.estimate(scenic.scenarioFromString(COIN))
    with pytest.raises(EstimateError, match="has no requirement"):
        scenic.estimate(scenic.scenarioFromString("ego = new Object"), "dummy")
    with pytest.raises(ObjectiveError, match="'y' is not a parameter"):
        scenic.estimate(scenic.scenarioFromString(COIN), static=True, objective="y")


def test_all_intervals_of_a_sweep_hold_together() -> None:
    one, four = asked_of(runs=10), asked_of(runs=10, together=4)
    assert one.confidence == 0.95
    assert four.confidence == pytest.approx(0.9875)
    assert Asked.from_data(json.loads(json.dumps(four.to_data()))) == four
    bound = asked_of(runs=None, at_most=0.1)
    assert Asked.from_data(json.loads(json.dumps(bound.to_data()))) == bound


def test_the_command(tmp_path: Path) -> None:
    (tmp_path / "coin.scenic").write_text(
        f"param p = 0.5\n{COIN}\nparam y = globalParameters.x - globalParameters.p"
    )
    common = ["estimate", "coin.scenic", "--static", "--objective", "y", "--seed", 1]
    made = run_here([*common, "-n", 50, "-o", "kept", "--report", "page.html"], folder=tmp_path)
    assert (made.returncode, made.stderr) == (0, "")
    probability = exact_interval(int(made.stdout.split(", ")[2].split()[0]), 50, 0.95)
    assert f"(95% interval {probability})" in made.stdout
    assert "50 runs, 50 with a value" in made.stdout
    assert "<svg" in (tmp_path / "page.html").read_text()
    again = run_here(["estimate", "kept"], folder=tmp_path)
    assert again.stdout == made.stdout
    first = json.loads((tmp_path / "kept" / "manifest.json").read_text())
    refused = run_here([*common, "-n", 60, "-o", "kept"], folder=tmp_path)
    assert (refused.returncode, "error[SC609]" in refused.stderr) == (1, True)
    other = run_here([*common[:-1], 2, "-n", 50, "-o", "kept", "--resume"], folder=tmp_path)
    assert "its seed differs" in other.stderr
    assert json.loads((tmp_path / "kept" / "manifest.json").read_text()) == first
    joined = run_here([*common, "-n", 50, "--first", 50, "-o", "more"], folder=tmp_path)
    assert joined.returncode == 0
    joined = run_here(["estimate", "kept", "--join", "more"], folder=tmp_path)
    assert "100 runs" in joined.stdout
    swept = run_here([*common, "-p", "p=0.1,0.6", "-n", 50, "-o", "swept"], folder=tmp_path)
    assert swept.stdout.count("97.5% interval") == 2
    assert run_here(["estimate", "swept"], folder=tmp_path).stdout == swept.stdout
    compared = run_here([*common, "--against", "coin.scenic", "-n", 50, "-o", "pair"], folder=tmp_path)
    assert "McNemar" in compared.stdout
    assert run_here(["estimate", "pair"], folder=tmp_path).stdout == compared.stdout
    assert run_here([*common, "--at-most", "0.2"], folder=tmp_path).returncode == 3
    assert run_here([*common, "--at-most", "0.9"], folder=tmp_path).returncode == 0


@pytest.mark.parametrize(
    ("words", "message"),
    [
        (["-n", 5, "--precision", 0.1], "-n does not go with --precision"),
        (["--precision", 0.1, "--at-most", 0.1], "--at-most does not go with --precision"),
        (["--budget", 5], "--budget is for --precision, --at-most"),
        (["--resume"], "--resume is for folders of estimates"),
        (["-r", "a", "--objective", "b"], "--requirement does not go with"),
        (["--join", "."], "--join is for a folder"),
    ],
)
def test_options_that_contradict(tmp_path: Path, words: list[object], message: str) -> None:
    (tmp_path / "coin.scenic").write_text(COIN)
    refused = run_here(["estimate", "coin.scenic", *words], folder=tmp_path)
    assert (refused.returncode, message in refused.stderr) == (2, True)


def test_folders_that_hold_something_else(tmp_path: Path) -> None:
    (tmp_path / "coin.scenic").write_text(COIN)
    common = ["coin.scenic", "--static", "--objective", "x", "--seed", 1, "-n", 20]
    run_here(["falsify", *common, "--sampler", "random", "-o", "search"], folder=tmp_path)
    before = (tmp_path / "search" / "runs.jsonl").read_bytes()
    for words in (["estimate", *common, "-o", "search", "--resume"], ["estimate", "search"]):
        refused = run_here(words, folder=tmp_path)
        assert (refused.returncode, "error[SC609]" in refused.stderr) == (1, True)
        assert "scenic estimate -o FOLDER" in refused.stderr
    assert (tmp_path / "search" / "runs.jsonl").read_bytes() == before
    assert "-n does not go with a folder" in run_here(["estimate", "search", "-n", 5], folder=tmp_path).stderr


def test_requirements_that_only_hold_or_fail_are_estimated() -> None:
    # The robustness of a condition without a number is infinite.
    text = "ego = new Object at Range(0, 1) @ 0\nrequire eventually bool(ego.position.x > 0.5) as right"
    result = scenic.estimate(scenic.scenarioFromString(text), "kinematic", n=40, seed=2, max_steps=2)
    right = result.requirements[0]
    assert (right.label, right.runs, right.flat) == ("right", 40, 40)
    assert right.violations == sum(row["status"] == "counterexample" for row in result.rows) > 10
