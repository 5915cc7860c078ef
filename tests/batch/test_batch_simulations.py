from pathlib import Path

import pytest

import scenic
from scenic.batch.engines import Processes
from scenic.batch.simulations import FailedSimulationError, SimulationRow, Simulations, SimulationSettings

PROGRAM = """
behavior Drive():
    while True:
        take ()
ego = new Object with behavior Drive, with velocity (Range(0, 2), 0, 0), with foo Range(0, 1)
record ego.position.x as x
require always ego.position.x < 100
terminate after 3 steps
"""


def test_simulations_do_not_depend_on_the_number_of_processes(tmp_path: Path) -> None:
    scenario = scenic.scenarioFromString(PROGRAM)
    alone = scenario.simulate(4, seed=3, folder=tmp_path / "alone")
    shared = scenario.simulate(4, seed=3, processes=2, folder=tmp_path / "shared")
    assert alone == shared
    assert [row.k for row in alone] == [0, 1, 2, 3]
    assert all(row.about is not None and row.about["steps"] == 3 for row in alone)
    assert len({row.about["records"]["x"][-1][1] for row in alone if row.about}) == 4
    for k in range(4):
        name = f"simulation-{k:04d}.jsonl"
        assert (tmp_path / "alone" / name).read_bytes() == (tmp_path / "shared" / name).read_bytes()


def test_kept_simulations_are_not_made_again(tmp_path: Path) -> None:
    scenario = scenic.scenarioFromString(PROGRAM)
    first = scenario.simulate(2, seed=3, folder=tmp_path)
    times = {path: path.stat().st_mtime_ns for path in tmp_path.glob("*.jsonl")}
    again = scenario.simulate(3, seed=3, folder=tmp_path, resume=True)
    assert [row.about for row in again[:2]] == [row.about for row in first]
    assert {path: path.stat().st_mtime_ns for path in times} == times


def test_a_failing_simulation_is_raised_with_its_diagnostic() -> None:
    scenario = scenic.scenarioFromString(
        "behavior B():\n    take 1 / 0\nego = new Object with behavior B\n", filename="failing.scenic"
    )
    with pytest.raises(FailedSimulationError, match="simulation 0 failed") as caught:
        scenario.simulate(1, seed=1)
    found = caught.value.row.error
    assert found is not None
    assert found.span is not None
    assert found.span.line == 2


DYING = """
import os
from pathlib import Path
deaths = Path(globalParameters.deaths)
behavior Drive():
    while True:
        if ego.foo > 0.9 and deaths.stat().st_size < 3:
            with deaths.open("a") as file:
                file.write("x")
            os.kill(os.getpid(), 9)
        take ()
ego = new Object with behavior Drive, with foo Range(0, 1)
record ego.foo as foo
terminate after 2 steps
"""
"""A program whose simulations with ``foo`` above 0.9 kill their process, until so many deaths are written down."""

NUMBERS = range(12)


def rows_of(deaths: Path, processes: int) -> dict[int, SimulationRow]:
    scenario = scenic.scenarioFromString(DYING, params={"deaths": str(deaths)})
    rows = Simulations(scenario, None, SimulationSettings(5)).rows(NUMBERS, Processes(processes))
    return {row.k: row for row in rows}


def foo(row: SimulationRow) -> float:
    assert row.about is not None
    value: float = row.about["records"]["foo"][-1][1]
    return value


def test_a_simulation_whose_process_is_killed_is_made_again(tmp_path: Path) -> None:
    deaths = tmp_path / "deaths"
    deaths.write_text("x" * 3)
    alone = rows_of(deaths, 1)
    assert sum(foo(row) > 0.9 for row in alone.values()) == 1
    deaths.write_text("x")
    assert rows_of(deaths, 2) == alone
    assert deaths.read_text() == "x" * 3


def test_a_simulation_that_always_kills_its_process_is_an_error_after_three(tmp_path: Path) -> None:
    deaths = tmp_path / "deaths"
    deaths.touch()
    rows = rows_of(deaths, 2)
    assert sorted(rows) == list(NUMBERS)
    failed = [row for row in rows.values() if row.error is not None]
    assert [(row.error.code, row.error.message) for row in failed if row.error] == [
        ("SC503", f"the process of simulation {row.k} died (exit code -9)") for row in failed
    ]
    assert len(failed) == 1
    assert deaths.read_text() == "x" * 3
    assert all(foo(row) <= 0.9 for row in rows.values() if row.error is None)
