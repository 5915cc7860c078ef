"""``scenic simulate`` as a user runs it."""

import json
import os
import signal
import subprocess
import sys
import time
from pathlib import Path
from typing import Any

import pytest

import scenic
from tests.cli.commands import run_here
from tests.processes import interruptible

ROOT = Path(__file__).parents[2]
MOVING = """
from scenic.simulators.kinematic import SetVelocity
behavior Go():
    while True:
        take SetVelocity((0, Range(0, 3)))
ego = new Object at (Range(-3, 3), 0), with behavior Go
other = new Object at (Range(5, 9), 3), facing 30 deg
require always (distance from ego to other) > 1 as apart
record ego.position.y as y
"""
REJECTED = "ego = new Object\nrequire eventually ego.position.y > 2\n"
RAISING = """
behavior B():
    take 1
    if ego.x > 0:
        raise ValueError('oops')
ego = new Object at (Range(-1, 1), 0), with behavior B
"""
SPINNING = "behavior B():\n    while True:\n        pass\n    take 1\nego = new Object with behavior B\n"
NOTING = """
behavior B():
    for number in range(7):
        simulation().note(self, f'note {number}')
        wait
ego = new Object with behavior B
"""
SLOW = """
import time
behavior B():
    while True:
        time.sleep(0.05)
        wait
ego = new Object with behavior B
"""


@pytest.fixture
def folder(tmp_path: Path) -> Path:
    programs = {
        "moving": MOVING,
        "rejected": REJECTED,
        "raising": RAISING,
        "spinning": SPINNING,
        "slow": SLOW,
        "noting": NOTING,
    }
    for name, text in programs.items():
        (tmp_path / f"{name}.scenic").write_text(text)
    return tmp_path


def run(folder: Path, *arguments: object) -> "subprocess.CompletedProcess[str]":
    return run_here(["simulate", *arguments], folder=folder, variables={"NO_COLOR": "1", "COLUMNS": "100"})


def rows(file: Path) -> list[dict[str, Any]]:
    return [json.loads(line) for line in file.read_text().splitlines()]


def test_trajectories_records_and_verdicts(folder: Path) -> None:
    result = run(
        folder, "moving.scenic", "-n", 2, "--seed", 3, "--time", 5, "-o", "out", "--view", "page.html"
    )
    assert result.returncode == 0, result.stderr
    assert "simulation 1: 5 steps, reached time limit (5 steps)" in result.stdout
    about, *steps = rows(folder / "out" / "simulation-0001.jsonl")
    assert (about["format"], about["k"], about["steps"], about["timestep"]) == (
        "scenic-simulation",
        1,
        5,
        0.1,
    )
    assert [item["name"] for item in about["objects"]] == ["ego", "other"]
    # What the file says of the requirement follows from the places in it.
    distances = [sum((a - b) ** 2 for a, b in zip(*step["positions"], strict=True)) ** 0.5 for step in steps]
    assert len(distances) == 6
    assert about["requirements"][0]["robustness"] == pytest.approx(min(distances) - 1)
    assert [y for _, y in about["records"]["y"]] == [step["positions"][0][1] for step in steps]
    assert steps[0]["actions"].keys() == {"0"}
    assert "<script>" in (folder / "page.html").read_text()


def test_a_run_goes_on_where_it_ended(folder: Path) -> None:
    first = run(folder, "moving.scenic", "-n", 3, "--seed", 3, "--time", 4, "-o", "out")
    times = {path: path.stat().st_mtime_ns for path in (folder / "out").iterdir()}
    kept = {path: path.read_text() for path in times}
    (folder / "out" / "simulation-0001.jsonl").unlink()
    (folder / "out" / "simulation-0002.jsonl").write_text('{"format": "scen')
    second = run(folder, "moving.scenic", "-n", 3, "--time", 4, "-o", "out", "--resume")
    assert second.stdout == first.stdout
    assert {path: path.read_text() for path in kept} == kept
    untouched = folder / "out" / "simulation-0000.jsonl"
    assert untouched.stat().st_mtime_ns == times[untouched]
    for more in ([], ["--resume"]):
        other = run(folder, "moving.scenic", "-n", 1, "--seed", 4, "--time", 4, "-o", "out", *more)
        assert other.returncode == 1
        assert "error[SC612]" in other.stderr
    assert untouched.read_text() == kept[untouched]


def test_rejected_simulations(folder: Path) -> None:
    result = run(folder, "rejected.scenic", "--seed", 3, "--time", 4, "--tries", 2)
    assert result.returncode == 3
    assert "simulation 0: rejected (1 tried: another would be the same simulation again" in result.stdout
    assert "requirement on line" in result.stdout
    assert ": 1 try" in result.stdout


def test_what_rejected_simulations_is_counted(folder: Path) -> None:
    (folder / "often.scenic").write_text(
        "behavior B():\n"
        "    x = Range(0, 1)\n"
        "    require x < 0.5\n"
        "    do C()\n"
        "behavior C():\n    precondition: False\n    wait\n"
        "ego = new Object with behavior B\n"
    )
    result = run(folder, "often.scenic", "-n", 1, "--seed", 3, "--time", 4, "--tries", 9)
    assert result.returncode == 3
    head, *reasons = result.stdout.splitlines()
    assert head == "simulation 0: rejected (9 tried)"
    assert sum(int(line.rpartition(": ")[2].split()[0]) for line in reasons) == 9
    assert sorted(line.rpartition(":")[0].strip() for line in reasons) == [
        "requirement on line 3 is violated",
        "violated precondition of C on line 6",
    ]


def test_what_is_noted_of_objects_is_shown(folder: Path) -> None:
    done = run(folder, "noting.scenic", "--time", 8)
    assert done.stdout.splitlines()[1:] == [
        *(f"  ego at 0.{number} s: note {number}" for number in range(5)),
        "  and 2 more notes, which files of --format json contain",
    ]


def test_simulations_by_rows_of_a_sequence(folder: Path) -> None:
    """They are others than those at random, evenly spread, the same whatever the number of processes, and kept apart."""
    options = ("moving.scenic", "-n", 4, "--seed", 3, "--time", 4)
    assert run(folder, *options, "--sobol", "-o", "even").returncode == 0
    assert run(folder, *options, "--sobol", "-j", 2, "-o", "again").returncode == 0
    assert run(folder, *options, "-o", "random").returncode == 0
    kept = {name: sorted((folder / name).glob("*.jsonl")) for name in ("even", "again", "random")}
    even, again, other = ([path.read_text() for path in kept[name]] for name in kept)
    assert even == again
    assert not set(even) & set(other)
    refused = run(folder, *options, "-o", "even", "--resume")
    assert "made otherwise: sobol None, not True" in refused.stderr


def test_one_that_fails_leaves_the_others(folder: Path) -> None:
    result = run(
        folder, "raising.scenic", "-n", 8, "--seed", 3, "--time", 4, "--simulator", "dummy", "-o", "out"
    )
    assert result.returncode == 1
    assert "error[SC400]: ValueError: oops\n --> raising.scenic:5:9" in result.stderr
    made = len(list((folder / "out").glob("*.jsonl")))
    assert 0 < made < 8
    assert result.stdout.count("reached time limit") == made


def test_an_error_tells_more_than_a_rejection(folder: Path) -> None:
    """The exit code of a run in which some simulations fail and others are rejected."""
    (folder / "both.scenic").write_text(RAISING + "require eventually ego.position.y > 2\n")
    result = run(
        folder, "both.scenic", "-n", 8, "--seed", 3, "--time", 4, "--tries", 1, "--simulator", "dummy"
    )
    assert "rejected (1 tried" in result.stdout
    assert "error[SC400]: ValueError: oops" in result.stderr
    assert result.returncode == 1


def test_trajectories_are_kept_for_what_decides_them(folder: Path) -> None:
    """Another limit on the time of a step makes no other simulation; another number of steps or of tries would."""
    options = ("moving.scenic", "--seed", 3, "--time", 4, "-o", "out", "--resume")
    kept = folder / "out" / "simulation-0000.jsonl"
    assert run(folder, *options).returncode == 0
    for more, again in (
        (["--step-limit", 5], False),
        (["-n", 2], False),
        (["--tries", 7], True),
        (["--timestep", 0.5], True),
        (["--simulator", "dummy"], True),
    ):
        before = kept.stat().st_ino, kept.stat().st_mtime_ns
        assert run(folder, *options, *more).returncode == (1 if again else 0), more
        assert (kept.stat().st_ino, kept.stat().st_mtime_ns) == before


def test_code_that_spins_is_named(folder: Path) -> None:
    result = run(folder, "spinning.scenic", "--seed", 3, "--step-limit", 0.1)
    assert result.returncode == 1
    assert "has run for 0.1 s within one step" in result.stderr
    assert "allow it more time (`--step-limit`)" in result.stderr
    assert "spinning.scenic:" in result.stderr


@pytest.mark.parametrize(
    "arguments", [["--simulator", "nothing"], ["--simulator", "json:missing"], ["--time", "-1"]]
)
def test_wrong_usage(folder: Path, arguments: list[str]) -> None:
    assert run(folder, "moving.scenic", *arguments).returncode == 2


@pytest.mark.slow
def test_results_do_not_depend_on_processes(folder: Path) -> None:
    for jobs in (1, 2):
        result = run(
            folder, "moving.scenic", "-n", 4, "--seed", 3, "--time", 4, "-o", f"out{jobs}", "-j", jobs
        )
        assert result.returncode == 0, result.stderr
    one, two = (
        {path.name: path.read_text() for path in (folder / f"out{jobs}").iterdir()} for jobs in (1, 2)
    )
    assert one == two
    assert len(one) == 5  # with the manifest


@pytest.mark.slow
@pytest.mark.parametrize("number", [signal.SIGINT, signal.SIGKILL])
def test_files_are_complete_or_absent(folder: Path, number: int) -> None:
    arguments = ["simulate", "slow.scenic", "-n", "50", "--seed", "3", "--time", "5", "-o", "out"]
    process = subprocess.Popen(
        [sys.executable, "-m", "scenic.cli.main", *arguments],
        cwd=folder,
        env={**os.environ, "PYTHONPATH": str(ROOT)},
        stdout=subprocess.DEVNULL,
        stderr=subprocess.DEVNULL,
        preexec_fn=interruptible,
    )
    end = time.monotonic() + 60
    while time.monotonic() < end and not (folder / "out" / "simulation-0001.jsonl").exists():
        time.sleep(0.05)
    process.send_signal(number)
    code = process.wait(30)
    assert code == (130 if number == signal.SIGINT else -signal.SIGKILL)
    files = sorted((folder / "out").glob("simulation-*.jsonl"))
    assert 2 <= len(files) < 50
    for file in files:
        about, *steps = rows(file)
        assert len(steps) == about["steps"] + 1


CHOOSING = """
model world
param far = 1
scenario First():
    setup:
        ego = new Object with tag "first"
        record initial (ego.tag, far_from_model, globalParameters.far, ego.height) as who
scenario Second():
    setup:
        ego = new Object with tag "second"
        record initial (ego.tag, far_from_model, globalParameters.far, ego.height) as who
"""


@pytest.mark.parametrize(
    ("options", "who"),
    [
        (["--scenario", "First"], ["first", "world", 1, 1]),
        (["--scenario", "Second"], ["second", "world", 1, 1]),
        (["--scenario", "Second", "--model", "moon"], ["second", "moon", 1, 1]),
        (["--scenario", "First", "-p", "far=3"], ["first", "world", 3, 1]),
        (["--scenario", "First", "--2d"], ["first", "world", 1, 2]),
    ],
)
@pytest.mark.parametrize("jobs", [1, 2])
def test_what_is_simulated_is_what_was_chosen(
    folder: Path, options: list[str], who: list[Any], jobs: int
) -> None:
    """Every option of the program, in this process and in others."""
    for model in ("world", "moon"):
        (folder / f"{model}.scenic").write_text(
            f"far_from_model = {model!r}\nclass Object(Object):\n    width: 2\n"
        )
    (folder / "choosing.scenic").write_text(CHOOSING)
    made = run(
        folder, "choosing.scenic", *options, "-n", 2, "--seed", 1, "--time", 1, "-j", jobs, "-o", "chosen"
    )
    assert made.returncode == 0, made.stderr
    for number in range(2):
        about, *_ = rows(folder / "chosen" / f"simulation-{number:04d}.jsonl")
        assert about["records"]["who"] == who


@pytest.mark.parametrize(
    "content", ["", "[1]", "3", "null", '"text"', "{}", '{"settings": null}', "{", "\xff"]
)
def test_a_file_that_is_none_of_ours_is_made_anew(folder: Path, content: str) -> None:
    arguments = ["moving.scenic", "-n", 1, "--seed", 3, "--time", 2, "-o", "anew"]
    assert run(folder, *arguments).returncode == 0
    file = folder / "anew" / "simulation-0000.jsonl"
    expected = file.read_bytes()
    file.write_bytes(content.encode("latin-1") + b"\n")
    made = run(folder, *arguments, "--resume")
    assert made.returncode == 0, made.stderr
    assert file.read_bytes() == expected


@pytest.mark.parametrize(("limit", "margin"), [(0, "0"), (-2, "2"), (-0.5, "0.5")])
def test_margins_are_told_that_of_nothing_included(folder: Path, limit: float, margin: str) -> None:
    (folder / "margin.scenic").write_text(
        f"ego = new Object\nrequire always ego.position.x >= {limit} as far\n"
    )
    shown = run(folder, "margin.scenic", "--seed", 1, "--time", 2)
    assert shown.returncode == 0, shown.stderr
    assert f"far: presumably true, robustness {margin}\n" in shown.stdout


def test_a_process_that_dies_is_a_failure_and_the_others_go_on(folder: Path) -> None:
    (folder / "dying.scenic").write_text(
        "import os\nbehavior B():\n    take 1\n    if ego.x > 0:\n        os._exit(9)\n"
        "ego = new Object at (Range(-1, 1), 0), with behavior B\n"
    )
    signs = [scene.egoObject.x > 0 for scene in scenic.load(folder / "dying.scenic").sample(4, seed=1)]
    assert len(set(signs)) == 2
    shown = run(folder, "dying.scenic", "-n", 4, "--seed", 1, "--time", 2, "-j", 2, "--simulator", "dummy")
    assert shown.returncode == 1
    for number, dies in enumerate(signs):
        assert (
            f"process of simulation {number} died (exit code 9)" in " ".join(shown.stderr.split())
        ) is dies
        assert (f"simulation {number}: 2 steps" in shown.stdout) is not dies
