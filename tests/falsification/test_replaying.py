"""Runs of searches that were made in Python, made again."""

from pathlib import Path
from typing import Any

import pytest

import scenic
from scenic.falsification.objectives import Objective, ObjectiveError
from scenic.falsification.replaying import ReplayError, kept_run, program_of, replay
from scenic.simulators.kinematic import KinematicSimulator
from tests.falsification.test_search import BRAKE, STATIC


class Own(KinematicSimulator):
    """A simulator that has no name."""


def nearest(result: Any) -> float:
    return min(value for _, value in result.records["gaps"]) - 3


@pytest.fixture(scope="module")
def scenario() -> Any:
    return scenic.scenarioFromString(BRAKE)


def searched(scenario: Any, folder: Path, simulator: Any = "kinematic", **options: Any) -> Any:
    return scenic.falsify(
        scenario,
        simulator,
        n=6,
        seed=1,
        sampler="random",
        timestep=0.1,
        max_steps=30,
        folder=folder,
        **options,
    )


def test_the_value_of_a_function_is_compared_where_the_function_is_given(
    scenario: Any, tmp_path: Path
) -> None:
    result = searched(scenario, tmp_path / "a", objective=nearest)
    assert {row["status"] for row in result.rows} == {"held", "counterexample"}
    for row in result.rows:
        run = kept_run(tmp_path / "a", row["run"])
        without = replay(run, scenario)
        assert without.departures == []
        assert without.about["values"] == row["values"]
        assert without.unknown == ["the value: the objective was a function of Python, `nearest`"]
        same = replay(run, scenario, objectives=[Objective(function=nearest)])
        assert (same.departures, same.unknown) == ([], [])
    (other,) = replay(run, scenario, objectives=[Objective(function=lambda result: 5.0)]).departures[-1:]
    assert other == f"values: was [{row['values'][0]}], now [5.0]"


def test_a_static_search_by_a_function(tmp_path: Path) -> None:
    static = scenic.scenarioFromString(STATIC)
    searched(static, tmp_path / "a", None, objective=lambda scene: scene.params["total"] - 9, static=True)
    found = replay(kept_run(tmp_path / "a"), static, shown=True)
    assert found.departures == []
    assert found.unknown
    assert found.page is not None
    assert len(found.pictures or ()) == 1


def test_a_simulator_object_is_asked_for(scenario: Any, tmp_path: Path) -> None:
    searched(scenario, tmp_path / "a", Own())
    run = kept_run(tmp_path / "a")
    with pytest.raises(ReplayError, match="an object of the class `Own`") as caught:
        replay(run, scenario)
    assert "--simulator MODULE:CLASS" in (caught.value.help or "")
    assert replay(run, scenario, Own()).departures == []
    scenario.simulate(1, seed=1, simulator=Own(), folder=tmp_path / "b", keep_violations=True)
    run = kept_run(tmp_path / "b")
    with pytest.raises(ReplayError, match="an object of the class `Own`"):
        replay(run, scenario)
    assert replay(run, scenario, Own()).departures == []


def test_a_program_without_a_file_is_asked_for(scenario: Any, tmp_path: Path) -> None:
    searched(scenario, tmp_path / "a")
    with pytest.raises(ReplayError, match="was a text in Python") as caught:
        program_of(kept_run(tmp_path / "a"))
    assert "--program FILE" in (caught.value.help or "")


def test_an_objective_that_is_gone(scenario: Any, tmp_path: Path) -> None:
    searched(scenario, tmp_path / "a", objective="y")
    changed = scenic.scenarioFromString(BRAKE.replace("record final ego.position.y as y", ""))
    with pytest.raises(ObjectiveError, match="neither a requirement nor recorded"):
        replay(kept_run(tmp_path / "a"), changed)


def test_runs_without_a_value_are_the_same_again(tmp_path: Path) -> None:
    text = BRAKE + "require ego.position.y < gap - 10\n"
    rejecting = scenic.scenarioFromString(
        text.replace("v = speed", "v = speed\n    if speed > 6:\n        raise KeyError('x')")
    )
    result = searched(rejecting, tmp_path / "a")
    assert {row["status"] for row in result.rows} >= {"rejected", "failed"}
    for row in result.rows:
        found = replay(kept_run(tmp_path / "a", row["run"]), rejecting, shown=True)
        assert (found.departures, found.about["status"]) == ([], row["status"])
        assert (found.page is None) == (row["values"] is None)


def test_the_worst_are_counted_from_the_least_value(scenario: Any, tmp_path: Path) -> None:
    result = searched(scenario, tmp_path / "a")
    ranked = [row["run"] for row in sorted(result.rows, key=lambda row: row["values"][0])]
    assert [kept_run(tmp_path / "a", worst=place).number for place in (1, 2, 6)] == [
        ranked[0],
        ranked[1],
        ranked[5],
    ]
    with pytest.raises(ReplayError, match="holds 6 runs with a value, fewer than 7"):
        kept_run(tmp_path / "a", worst=7)
    (tmp_path / "a" / "runs.jsonl").write_text("")
    with pytest.raises(ReplayError, match="holds no run") as caught:
        kept_run(tmp_path / "a")
    assert "--resume" in (caught.value.help or "")
