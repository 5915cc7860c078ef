"""Simulations as JSON Lines and Parquet, and back as arrays."""

import importlib.util
import json
import math
import sys
from contextlib import closing
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import scenic
from scenic.formats import trajectory_tables
from scenic.formats.trajectories import LinesFile, TrajectoryFile, course_document, step_document
from scenic.formats.trajectory_reading import TrajectoryArrays, TrajectoryFileError
from scenic.formats.trajectory_tables import ParquetFile, parquet_steps
from scenic.language.errors import MissingFileError
from scenic.runtime.dynamics.requirements import RequirementOutcome
from scenic.simulators.dummy import DummySimulator
from tests.cli.commands import run_here

needs_parquet = pytest.mark.skipif(
    importlib.util.find_spec("pyarrow") is None, reason="needs the extra [parquet]"
)
PROGRAM = """
from scenic.simulators.kinematic import *
behavior Go():
    while True:
        take SetVelocity((Range(-1, 1), 1, 0))
scenario Main():
    setup:
        ego = new Object with behavior Go, with width 0.5
        other = new Object at (9, 0, 1), facing 0.4, with behavior Go
        record ego.position.y as y
        record final other.position as end
        require always (distance from ego to other) > 1 as apart
    compose:
        wait for 2 steps
        do Later() for 9 steps
scenario Later():
    setup:
        new Object at (-9, 0)
"""


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    path: Path = tmp_path_factory.mktemp("runs")
    (path / "program.scenic").write_text(PROGRAM)
    return path


def simulated(folder: Path, form: str, *arguments: object) -> list[Path]:
    options = ["-n", 2, "--seed", 1, "--time", 6, "--format", form, "-o", form, "--resume", *arguments]
    done = run_here(["simulate", "program.scenic", *options], folder=folder)
    assert done.returncode == 0, done.stderr
    return sorted((folder / form).glob(f"*.{form}"))


def write(file: TrajectoryFile, about: dict[str, Any], steps: list[dict[str, Any]]) -> None:
    with closing(file):
        for step in steps:
            file.add(step)
        file.finish(about)


def test_arrays_are_what_the_lines_say(folder: Path) -> None:
    (path, _) = simulated(folder, "jsonl")
    read = scenic.read_trajectory(path)
    _, *lines = (json.loads(line) for line in path.read_text().splitlines())
    assert read.positions.shape == (7, 3, 3)
    assert read.orientations.shape == (7, 3, 4)
    np.testing.assert_array_equal(read.times, [line["time"] for line in lines])
    for line, places in zip(lines, read.positions, strict=True):
        present = len(line["positions"])
        np.testing.assert_array_equal(places[:present], line["positions"])
        assert np.isnan(places[present:]).all()
    assert np.isnan(read.positions[1, 2]).all()
    assert not np.isnan(read.positions[2, 2]).any()
    assert read.record("y") == read.position("ego")[:, 1].tolist()
    assert read.record("end") == read.positions[-1, 1].tolist()
    assert read.size("ego") == (0.5, 1, 1)
    np.testing.assert_array_equal(read.position(0), read.position("ego"))
    np.testing.assert_array_equal(read.orientation(0), read.orientation("ego"))
    with pytest.raises(IndexError):
        read.position(3)
    assert read.orientations[0, 1].tolist() == pytest.approx([0, 0, math.sin(0.2), math.cos(0.2)])
    assert set(read.actions[0]) == {0, 1}
    assert read.actions[6] == {}
    with pytest.raises(KeyError):
        read.orientation("third")


@needs_parquet
def test_both_forms_hold_the_same(folder: Path) -> None:
    for lines, table in zip(simulated(folder, "jsonl"), simulated(folder, "parquet"), strict=True):
        assert table.suffix == ".parquet"
        about, *steps = (json.loads(line) for line in lines.read_text().splitlines())
        assert parquet_steps(table) == steps
        first, second = scenic.read_trajectory(lines), scenic.read_trajectory(table)
        assert first.about == second.about
        assert first.actions == second.actions
        for name in ("times", "positions", "orientations"):
            np.testing.assert_array_equal(getattr(first, name), getattr(second, name))
        again = folder / "again.parquet"
        write(ParquetFile(again), about, steps)
        assert again.read_bytes() == table.read_bytes()


@needs_parquet
def test_rows_are_written_in_groups(folder: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    from pyarrow import parquet

    (lines, _) = simulated(folder, "jsonl")
    about, *steps = (json.loads(line) for line in lines.read_text().splitlines())
    monkeypatch.setattr(trajectory_tables, "GROUP", 4)
    write(ParquetFile(folder / "groups.parquet"), about, steps)
    found = parquet.ParquetFile(folder / "groups.parquet")
    sizes = [found.metadata.row_group(group).num_rows for group in range(found.num_row_groups)]
    assert sizes == [4, 6, 6, 3]
    assert parquet_steps(folder / "groups.parquet") == steps
    assert trajectory_tables.parquet_about(folder / "groups.parquet") == about


@needs_parquet
def test_columns_are_read_by_anyone(folder: Path) -> None:
    from pyarrow import parquet

    (path, _) = simulated(folder, "parquet")
    table = parquet.read_table(path)
    assert {name: str(table.schema.field(name).type) for name in table.column_names} == {
        "step": "int32",
        "time": "double",
        "object": "int32",
        **dict.fromkeys(("x", "y", "z", "qx", "qy", "qz", "qw"), "double"),
        "actions": "string",
    }
    assert table.num_rows == 2 * 7 + 5


@needs_parquet
def test_runs_go_on_in_columns(folder: Path) -> None:
    before = {path: path.stat().st_mtime_ns for path in simulated(folder, "parquet")}
    assert {path: path.stat().st_mtime_ns for path in simulated(folder, "parquet")} == before
    one, two = before
    one.write_bytes(two.read_bytes()[:100])
    simulated(folder, "parquet")
    assert two.stat().st_mtime_ns == before[two]
    assert scenic.read_trajectory(one).about["k"] == 0


@needs_parquet
def test_tables_of_something_else_are_refused(tmp_path: Path) -> None:
    import pyarrow
    from pyarrow import parquet

    parquet.write_table(pyarrow.table({"step": [0, 1]}), tmp_path / "other.parquet")
    with pytest.raises(ValueError, match="there is no simulation in it"):
        trajectory_tables.parquet_about(tmp_path / "other.parquet")


@needs_parquet
def test_numbers_that_are_not_finite(tmp_path: Path) -> None:
    about: dict[str, Any] = {"format": "scenic-simulation", "version": 1, "steps": 0, "timestep": 1.0}
    about["objects"] = [{"name": None}]
    about["records"] = {"ttc": [[0, {"$float": "inf"}], [1, 2.5]]}
    state = {"step": 0, "time": 0.0, "actions": {}, "orientations": [[0, 0, 0, 1]]}
    state["positions"] = [[{"$float": "inf"}, {"$float": "nan"}, -1.5]]
    write(ParquetFile(tmp_path / "a.parquet"), about, [state])
    write(LinesFile(tmp_path / "a.jsonl"), about, [state])
    for name in ("a.parquet", "a.jsonl"):
        np.testing.assert_array_equal(
            scenic.read_trajectory(tmp_path / name).positions, [[[math.inf, math.nan, -1.5]]]
        )
        assert scenic.read_trajectory(tmp_path / name).record("ttc") == [math.inf, 2.5]


@pytest.mark.parametrize("text", ["", "{}", '{"format": "scenic-scene", "version": 1}', "PAR1", "no"])
def test_other_files_are_refused(tmp_path: Path, text: str) -> None:
    if text == "PAR1" and importlib.util.find_spec("pyarrow") is None:
        pytest.skip("needs the extra [parquet]")
    (tmp_path / "file").write_text(text)
    with pytest.raises(TrajectoryFileError, match="holds no simulation"):
        scenic.read_trajectory(tmp_path / "file")
    with pytest.raises(MissingFileError):
        scenic.read_trajectory(tmp_path / "missing")


def test_without_the_library_the_extra_is_named(folder: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setitem(sys.modules, "pyarrow", None)
    done = run_here(["simulate", "program.scenic", "--format", "parquet", "-o", "none"], folder=folder)
    assert done.returncode != 0
    assert "error[SC900]: Parquet files need the package pyarrow" in done.stderr
    assert "scenic-lang[parquet]" in done.stderr
    assert not (folder / "none").exists()


def test_a_document_holds_what_the_simulation_did() -> None:
    text = (
        "behavior B():\n    while True:\n        take simulation().currentTime, 'go'\n"
        "ego = new Object with behavior B\n"
        "require always ego.position.y < 10 as near\nrequire ego.position.x == 0 as there\n"
        "record final [[1, 2, 3], [4, 5, 6]] as rows\n"
    )
    scene = scenic.scenarioFromString(text).sample(1, seed=1)[0]
    simulator = DummySimulator(drift=1, timestep=0.5)
    steps: list[dict[str, Any]] = []
    done = simulator.simulate(
        scene,
        maxSteps=3,
        on_state=lambda *state: steps.append(step_document(*state)),
        robustness=True,
        keep_course=False,
    )
    about = course_document(done, k=4, tries=2)
    assert (about["k"], about["tries"], about["steps"], about["timestep"]) == (4, 2, 3, 0.5)
    assert [step["actions"] for step in steps] == [{"0": [0, "go"]}, {"0": [1, "go"]}, {"0": [2, "go"]}, {}]
    assert [step["time"] for step in steps] == [0, 0.5, 1, 1.5]
    assert [step["positions"][0][1] for step in steps] == [0, 1, 2, 3]
    near, there = about["requirements"]
    assert (near["label"], near["line"], near["verdict"]) == ("near", 5, "PRESUMABLY_TRUE")
    assert near["robustness"] == 7
    assert there["robustness"] == {"$float": "inf"}
    # What was never evaluated has no verdict.
    done.result.requirements = (RequirementOutcome("late", None, None, None),)
    (late,) = course_document(done, k=4, tries=2)["requirements"]
    assert late == {"label": "late", "line": None, "verdict": None, "robustness": None}
    read = TrajectoryArrays(about, *(np.empty(0),) * 3, [])
    assert read.record("rows") == [[1, 2, 3], [4, 5, 6]]


@pytest.mark.parametrize("form", ["jsonl", pytest.param("parquet", marks=needs_parquet)])
def test_what_a_file_holds_says_how_it_is_read(folder: Path, form: str) -> None:
    """Not its name, which may be any."""
    (path, _) = simulated(folder, form)
    expected = scenic.read_trajectory(path)
    for name in ("run", "run.dat", "run.parquet.jsonl", "run.jsonl.parquet"):
        (folder / name).write_bytes(path.read_bytes())
        found = scenic.read_trajectory(folder / name)
        assert found.about == expected.about
        np.testing.assert_array_equal(found.positions, expected.positions)


def test_what_cannot_be_read_is_told(tmp_path: Path) -> None:
    """A folder, a file that is not there, and one below a file."""
    (tmp_path / "file").write_text("")
    for path in (tmp_path, tmp_path / "nothing", tmp_path / "file" / "run.jsonl"):
        with pytest.raises(MissingFileError, match="cannot read"):
            scenic.read_trajectory(path)
