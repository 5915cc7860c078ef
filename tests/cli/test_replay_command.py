"""``scenic replay``: runs that were kept, made again."""

import json
import re
import shutil
import webbrowser
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


def test_another_version_is_named(place: Path) -> None:
    shutil.copytree(place / "runs", place / "older")
    file = place / "older" / "simulation-0000.jsonl"
    file.write_text(re.sub(r'"scenic":"[^"]+"', '"scenic":"0.0.7"', file.read_text(), count=1))
    result = run_here(["replay", "older"], folder=place)
    assert "kept by Scenic 0.0.7, made again by " in result.stdout
    assert "kept by" not in run_here(["replay", "runs"], folder=place).stdout


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


def test_a_run_is_shown_in_one_command(place: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    image = pytest.importorskip("PIL.Image")
    opened: list[str] = []
    monkeypatch.setattr(webbrowser, "open", opened.append)
    rows = [json.loads(line) for line in (place / "found/runs.jsonl").read_text().splitlines()]
    third = sorted(rows, key=lambda row: row["values"][0])[2]
    words = ["--worst", 3, "--image-size", "120x90", "--open", "--png", "run.png", "--film", "run.gif"]
    again = run_here(["replay", "found", *words, "--every", 10], folder=place)
    assert again.returncode == 0, again.stderr
    assert again.stdout.startswith(f"run {third['run']}: ")
    page = Path(opened[0].removeprefix("file://"))
    assert "keeps off" in page.read_text()
    shutil.rmtree(page.parent)
    with image.open(place / "run.png") as sheet:
        assert sheet.size == (120, 90)
    # 30 steps: every tenth state and the last one.
    with image.open(place / "run.gif") as film:
        assert film.size == (120, 90)
        assert film.n_frames == 4
    again = run_here(["replay", "runs", 1, "--png", "states", "--image-size", "40x30"], folder=place)
    assert again.returncode == 0, again.stderr
    assert sorted(item.name for item in (place / "states").iterdir()) == [
        f"state-{k:02}.png" for k in range(31)
    ]


def test_scenes_of_static_searches_are_shown(place: Path) -> None:
    image = pytest.importorskip("PIL.Image")
    (place / "static.scenic").write_text("x = Range(-5, 5)\nparam far = abs(x)\nego = new Object at (x, 0)")
    words = ["--static", "--objective", "far", "-n", 6, "--sampler", "random", "--seed", 1, "--threshold", 2]
    assert run_here(["falsify", "static.scenic", *words, "-o", "scenes"], folder=place).returncode == 0
    words = ["--view", "scene.html", "--png", "scene.png", "--image-size", "40x30"]
    again = run_here(["replay", "scenes", *words], folder=place)
    assert again.stdout.endswith("the same as kept, bit by bit\n"), again.stdout + again.stderr
    assert "far" in (place / "scene.html").read_text()
    with image.open(place / "scene.png") as drawn:
        assert drawn.size == (40, 30)
    (kept, *_) = (place / "scenes/counterexamples").glob("*/scene.json")
    kept.write_text(kept.read_text() + " ")
    again = run_here(["replay", kept.parent], folder=place)
    assert (again.returncode, "the scene differs" in again.stdout) == (3, True)


def test_other_parameters_are_another_run(place: Path) -> None:
    again = run_here(["replay", "found", "-p", "more=2"], folder=place)
    assert again.returncode == 3
    assert "differs: the program or its parameters have changed since\n" in again.stdout
    assert "the actions of ego are others" in again.stdout
    again = run_here(["replay", "found", "-p", "less=2"], folder=place)
    assert (again.returncode, "SC603" in again.stderr) == (2, True)


@pytest.mark.parametrize(
    ("form", "library"), [("parquet", "pyarrow"), ("openscenario", "scenariogeneration")]
)
def test_simulations_of_every_format_are_replayed(place: Path, form: str, library: str) -> None:
    pytest.importorskip(library)
    (place / "road.scenic").write_text(
        "param map = 'none.xodr'\n" + PROGRAM.replace("speed)", "speed + globalParameters.more)")
    )
    words = ["road.scenic", "-n", 2, "--seed", 1, "--timestep", 0.1, "--time", 30, "--keep", "all"]
    done = run_here(["simulate", *words, "--format", form, "-o", form], folder=place)
    assert done.returncode == 0, done.stderr
    again = run_here(["replay", form, 1, "--view", "page.html"], folder=place)
    assert again.returncode == 0, again.stdout + again.stderr
    assert again.stdout.endswith("the same as kept, bit by bit\n")
    again = run_here(["replay", form, 1, "-p", "more=0.5"], folder=place)
    assert again.returncode == 3
    departs = "from step 0 (time 0 s)" if form == "parquet" else "from time 0.1 s"
    assert f"differs: {departs} on it departs: " in again.stdout


@pytest.mark.parametrize(
    ("words", "code", "message"),
    [
        (["found", "--png", "run.jpg"], "SC604", "--png makes no '.jpg' file"),
        (["found", "--film", "run.avi"], "SC604", "--film makes no '.avi' file"),
        (["found", "--view", "run.png"], "SC604", "--view makes a page"),
        (["found", "--film", "nowhere/run.gif"], "SC601", "does not exist"),
        (["found", "--worst", 9], "SC609", "holds 8 runs with a value"),
        (["runs", "--worst", 1], "SC609", "is no folder of a search"),
        (["found", 1, "--worst", 1], "", "NUMBER and --worst"),
        (["found", "--simulator", "kinematics"], "SC604", "did you mean `kinematic`?"),
    ],
)
def test_what_cannot_be_shown_is_said(place: Path, words: list[object], code: str, message: str) -> None:
    again = run_here(["replay", *words], folder=place)
    assert again.returncode in (1, 2)
    assert code in again.stderr
    assert message in again.stderr


def test_a_program_that_has_moved_is_named(place: Path) -> None:
    (place / "elsewhere").mkdir()
    again = run_here(["replay", place / "found"], folder=place / "elsewhere")
    assert again.returncode == 1
    assert "'drive.scenic', is not there" in again.stderr
    assert "--program FILE" in again.stderr
    again = run_here(
        ["replay", place / "found", "--program", place / "drive.scenic"], folder=place / "elsewhere"
    )
    assert again.returncode == 0, again.stdout + again.stderr


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


def test_images_follow_an_object(place: Path) -> None:
    common = ["replay", "runs", 0, "--image-size", "90x60", "--png"]
    for name in ("ego", "lead", "0"):
        done = run_here([*common, f"{name}.png", "--follow", name, "--around", 6], folder=place)
        assert done.returncode == 0, done.stderr
    # What stands still beside a road without marks is seen from where it is; the other one leaves it.
    assert (
        (place / "ego.png").read_bytes()
        == (place / "0.png").read_bytes()
        != (place / "lead.png").read_bytes()
    )
    wrong = run_here([*common, "wrong.png", "--follow", "leed"], folder=place)
    assert wrong.returncode != 0
    assert "there is no object 'leed' to follow" in wrong.stderr
    assert "did you mean 'lead'?" in wrong.stderr
    assert not (place / "wrong.png").exists()
    alone = run_here([*common, "wrong.png", "--around", 6], folder=place)
    assert (alone.returncode, "--around belongs to --follow" in alone.stderr) == (2, True)
