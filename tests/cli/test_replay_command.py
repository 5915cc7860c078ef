"""``scenic replay``: runs that were kept, made again."""

import json
from pathlib import Path

import pytest

from tests.cli.commands import run_here

PROGRAM = """
from scenic.simulators.kinematic import SetVelocity
param more = 0
speed = VerifaiRange(2, 8) + globalParameters.more
lead = new Object at (0, Range(8, 30))
behavior Drive():
    while True:
        take SetVelocity((0, speed, 0))
ego = new Object with behavior Drive()
record (distance from ego to lead) as gaps
require always (distance from ego to lead) > 3 as 'keeps off'
"""


@pytest.fixture(scope="module")
def place(tmp_path_factory: pytest.TempPathFactory) -> Path:
    folder = tmp_path_factory.mktemp("replays")
    (folder / "drive.scenic").write_text(PROGRAM)
    common = [
        "drive.scenic",
        "--seed",
        1,
        "--simulator",
        "kinematic",
        "--timestep",
        0.1,
        "--time",
        30,
        "-p",
        "more=1",
    ]
    found = run_here(["falsify", *common, "-n", 8, "--sampler", "random", "-o", "found"], folder=folder)
    assert "again: scenic replay found " in found.stdout
    assert (
        run_here(["simulate", *common, "-n", 2, "--keep", "all", "-o", "runs"], folder=folder).returncode == 0
    )
    return folder


def test_kept_runs_are_the_same_again(place: Path) -> None:
    rows = [json.loads(line) for line in (place / "found/runs.jsonl").read_text().splitlines()]
    failed = [row["run"] for row in rows if row["status"] == "counterexample"]
    assert failed
    worst = min(rows, key=lambda row: row["values"][0])["run"]
    for words, number in (
        (["found"], worst),
        (["found", failed[0]], failed[0]),
        ([f"found/counterexamples/{failed[0]:04d}"], failed[0]),
        (["runs/simulation-0001.jsonl", "--view", "page.html"], 1),
    ):
        again = run_here(["replay", *words], folder=place)
        assert again.returncode == 0, again.stdout + again.stderr
        assert again.stdout.startswith(f"run {number}: ")
        assert again.stdout.endswith("the same as kept, bit by bit\n")
    assert "<html" in (place / "page.html").read_text()


def test_a_changed_program_departs_where_it_differs(place: Path) -> None:
    changed = PROGRAM.replace("take SetVelocity((0, speed, 0))", "take SetVelocity((0, speed + 1, 0))")
    (place / "changed.scenic").write_text(changed)
    for words in (["found"], ["runs", 1]):
        again = run_here(["replay", *words, "--program", "changed.scenic"], folder=place)
        assert again.returncode == 3
        assert "differs: the program or its parameters have changed since\n" in again.stdout
        assert "differs: keeps off: was " in again.stdout
    assert "from step 0 (time 0 s) on it departs: the actions of ego are others" in again.stdout
    (place / "changed.scenic").write_text("param more = 0\nego = new Object at (Range(0, 1), 0)")
    again = run_here(["replay", "found", "--program", "changed.scenic"], folder=place)
    assert (again.returncode, "the program draws other values" in again.stderr) == (1, True)


def test_what_is_no_run_is_said(place: Path) -> None:
    (place / "other.jsonl").write_text("{}\n")
    (place / "sweep/more=1").mkdir(parents=True)
    (place / "sweep/more=1/manifest.json").write_text((place / "found/manifest.json").read_text())
    for words, message in (
        (["missing"], "there is no such file or folder"),
        (["found", 99], "'found' holds no run 99"),
        (["runs", 99], "'runs' holds no run 99"),
        (["sweep"], "'sweep' holds the searches of a sweep"),
        (["other.jsonl"], "holds no simulation that says how it was made"),
    ):
        again = run_here(["replay", *words], folder=place)
        assert again.returncode == 1
        assert message in again.stderr
