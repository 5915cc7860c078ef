"""``scenic sample`` as a user runs it, from the program to the files."""

import json
import os
import pty
import re
import signal
import subprocess
import sys
import time
from pathlib import Path

import pytest
import trimesh

import scenic
from tests.cli.commands import run_here

ROOT = Path(__file__).parents[2]

BALLS = """
param far = 5
param count = 1
ego = new Object at (Range(0, 1), 0, 0), with color (1, 0, 0)
ball = new Object at (Range(0, globalParameters.far), 3, 0), with shape SpheroidShape()
require ball.position.x > 0.5
"""
NEVER = "ego = new Object at (Range(0, 1), 0, 0)\nrequire ego.position.x * ego.position.x > 2\n"
SLOW = """
ego = new Object at (Range(0, 1), 0, 0)
def rare(x):
    return x > 0.9999999
require rare(ego.position.x)
"""


@pytest.fixture
def folder(tmp_path: Path) -> Path:
    for name, text in (("balls", BALLS), ("never", NEVER), ("slow", SLOW)):
        (tmp_path / f"{name}.scenic").write_text(text)
    return tmp_path


def command(*arguments: object) -> list[str]:
    return [sys.executable, "-m", "scenic.cli.main", "sample", *map(str, arguments)]


def environment() -> dict[str, str]:
    return {**os.environ, "PYTHONPATH": str(ROOT), "NO_COLOR": "1", "COLUMNS": "100"}


def run(folder: Path, *arguments: object) -> "subprocess.CompletedProcess[str]":
    return run_here(["sample", *arguments], folder=folder, variables={"NO_COLOR": "1", "COLUMNS": "100"})


@pytest.mark.slow
def test_every_output_at_once(folder: Path) -> None:
    outputs = ("-o", "balls.jsonl", "--view", "balls.html", "--png", "pictures")
    result = subprocess.run(
        command("balls.scenic", "-n", 3, "--seed", 4, "-p", "far=2", *outputs),
        cwd=folder,
        env=environment(),
        capture_output=True,
        text=True,
        check=False,
    )
    assert (result.returncode, result.stdout, result.stderr) == (0, "", "")
    rows = [json.loads(line) for line in (folder / "balls.jsonl").read_text().splitlines()]
    assert [row["k"] for row in rows] == [0, 1, 2]
    assert {row["params"]["far"] for row in rows} == {2}
    assert [thing["name"] for thing in rows[0]["objects"]] == ["ego", "ball"]
    assert all(0.5 < row["objects"][1]["position"][0] < 2 for row in rows)
    assert sorted(os.listdir(folder / "pictures")) == [f"balls-00{k}.png" for k in range(3)]
    assert "<title>balls.scenic</title>" in (folder / "balls.html").read_text()
    assert run(folder, "balls.scenic", "--seed", 4, "-p", "far=2", "-o", "one.glb").returncode == 0
    loaded = trimesh.load_scene(folder / "one.glb")
    matrix, _ = loaded.graph["ball"]
    assert matrix[0, 3] == pytest.approx(rows[0]["objects"][1]["position"][0], abs=1e-5)


def test_the_same_seed_gives_the_same_text(folder: Path) -> None:
    first = run(folder, "balls.scenic", "-n", 5, "--seed", 4)
    assert first.stdout == run(folder, "balls.scenic", "-n", 5, "--seed", 4).stdout
    drawn = run(folder, "balls.scenic")
    (seed,) = re.findall(r"--seed (\d+)", drawn.stderr)
    assert run(folder, "balls.scenic", "--seed", seed).stdout == drawn.stdout


def test_a_part_of_a_run_is_that_part(folder: Path) -> None:
    """Whichever part, in whichever way it is made, and taken up wherever it was left."""
    rows = run(folder, "balls.scenic", "-n", 7, "--seed", 4).stdout.splitlines()
    for first, count in ((0, 1), (3, 2), (2, 5), (6, 1)):
        part = ["balls.scenic", "--seed", 4, "--first", first, "-n", count]
        wanted = rows[first : first + count]
        assert run(folder, *part).stdout.splitlines() == wanted
        assert run(folder, *part, "-o", "some.jsonl").returncode == 0
        written = (folder / "some.jsonl").read_text()
        assert written.splitlines() == wanted
        for left in range(count):
            (folder / "some.jsonl").write_text("".join(line + "\n" for line in wanted[:left]))
            assert run(folder, *part, "-o", "some.jsonl", "--resume").returncode == 0
            assert (folder / "some.jsonl").read_text() == written


@pytest.mark.parametrize(
    ("arguments", "code", "words"),
    [
        (["missing.scenic"], 2, "missing.scenic"),
        (["."], 2, "SC600"),
        (["latin.scenic"], 1, "SC107"),
        (["broken.scenic"], 1, "SC1"),
        (["badmesh.scenic"], 1, "SC602"),
        (["balls.scenic", "-p", "fra=2"], 2, "far"),
        (["balls.scenic", "-n", "0"], 2, "-n"),
        (["balls.scenic", "-o", "no/such/folder.jsonl"], 2, "SC601"),
        (["balls.scenic", "--scenario", "Other"], 2, "SC605"),
        (["balls.scenic", "-o", "x.png"], 2, "--png"),
        (["never.scenic"], 3, "line 2"),
        (["slow.scenic", "--max-attempts", "1000"], 3, "1000 candidates"),
        (["slow.scenic", "--time-limit", "0.2"], 3, "time limit"),
    ],
)
def test_trouble_is_told_once_and_leaves_nothing(
    folder: Path, arguments: list[str], code: int, words: str
) -> None:
    (folder / "latin.scenic").write_bytes(b"# caf\xe9\nego = new Object\n")
    (folder / "broken.scenic").write_text("ego = new Object at\n")
    (folder / "badmesh.scenic").write_text(
        'ego = new Object with shape MeshShape.fromFile(localPath("m.obj"))\n'
    )
    (folder / "m.obj").write_text("v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n")
    before = sorted(os.listdir(folder))
    outputs = [] if "-o" in arguments else ["-o", "out.glb", "--view", "out.html"]
    result = run(folder, *arguments, "--seed", 1, *outputs)
    assert result.returncode == code
    assert words in result.stderr
    assert result.stdout == ""
    assert "Traceback" not in result.stderr
    assert "SC999" not in result.stderr
    assert sorted(set(os.listdir(folder)) - {"__pycache__"}) == before


def test_scenes_that_are_found_are_written_when_others_are_not(folder: Path) -> None:
    (folder / "rare.scenic").write_text(
        "ego = new Object at (Range(0, 1), 0, 0)\nrequire ego.position.x > 0.9\n"
    )
    result = run(folder, "rare.scenic", "-n", 20, "--seed", 1, "--max-attempts", 5, "--no-prune")
    assert result.returncode == 3
    several = run(folder, "rare.scenic", "-n", 20, "--seed", 1, "--max-attempts", 5, "--no-prune", "-j", 2)
    assert (several.returncode, several.stdout, several.stderr) == (3, result.stdout, result.stderr)
    found = [json.loads(line)["k"] for line in result.stdout.splitlines()]
    assert 0 < len(found) < 20
    assert f"{20 - len(found)} scenes were not found" in result.stderr
    assert "line 2" in " ".join(result.stderr.split()) or re.search(r"\b2 +│", result.stderr)


def test_a_closed_pipe_is_no_trouble(folder: Path) -> None:
    with subprocess.Popen(
        command("balls.scenic", "-n", 2000, "--seed", 1),
        cwd=folder,
        env=environment(),
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
    ) as process:
        assert process.stdout is not None
        assert process.stderr is not None
        assert process.stdout.readline().startswith(b"{")
        process.stdout.close()
        assert process.stderr.read() == b""


@pytest.mark.parametrize("number", [signal.SIGINT, signal.SIGTERM])
def test_an_interrupt_ends_it_in_one_line(folder: Path, number: signal.Signals) -> None:
    before = sorted(os.listdir(folder))
    arguments = (
        "slow.scenic",
        "--seed",
        1,
        "--max-attempts",
        10**12,
        "-o",
        "out.jsonl",
        "--view",
        "out.html",
    )
    with subprocess.Popen(
        command(*arguments),
        cwd=folder,
        env=environment(),
        stderr=subprocess.PIPE,
        # Shells let what runs in the background ignore the interrupts of their terminal.
        preexec_fn=lambda: signal.signal(number, signal.SIG_DFL),
    ) as process:
        deadline = time.monotonic() + 30
        while not any(name.endswith(".part") for name in os.listdir(folder)):
            assert time.monotonic() < deadline
            time.sleep(0.05)
        process.send_signal(number)
        assert process.stderr is not None
        shown = process.stderr.read().decode()
    assert process.returncode == 128 + number
    # An empty line ends the one in which the terminal shows ^C.
    assert len(shown.strip().splitlines()) <= 1
    assert sorted(set(os.listdir(folder)) - {"__pycache__"}) == before


def test_progress_is_shown_on_a_terminal_only(folder: Path) -> None:
    reader, writer = pty.openpty()
    variables = {**environment(), "TERM": "xterm"}
    with subprocess.Popen(
        command("balls.scenic", "-n", 30, "--seed", 1, "-o", "balls.jsonl"),
        cwd=folder,
        env=variables,
        stderr=writer,
    ) as process:
        os.close(writer)
        shown = b""
        while True:
            try:
                part = os.read(reader, 4096)
            except OSError:  # the other end is closed
                break
            if not part:
                break
            shown += part
    os.close(reader)
    assert process.returncode == 0
    assert b"sampling" in shown
    assert b"/30" in shown


@pytest.mark.parametrize("jobs", [1, 2])
def test_progress_tells_which_part_of_the_candidates_was_accepted(folder: Path, jobs: int) -> None:
    (folder / "third.scenic").write_text(
        "def few(x): return x < 0.3\nego = new Object at (Range(0, 1), 0)\nrequire few(ego.x)\n"
    )
    shown = run_here(
        ["sample", "third.scenic", "--seed", 1, "-n", 40, "-j", jobs, "-o", "third.jsonl"],
        folder=folder,
        variables={"TERM": "xterm", "COLUMNS": "100"},
        terminal=True,
    )
    assert shown.returncode == 0
    scenes = scenic.load(folder / "third.scenic").sample(40, seed=1)
    accepted = 40 / sum(scene.attempts for scene in scenes)
    assert float(re.findall(r"([\d.]+) accepted", shown.stderr)[-1]) == pytest.approx(accepted, rel=0.05)


@pytest.mark.parametrize("done", [0, 1, 4, 5])
@pytest.mark.parametrize("jobs", [1, 2])
def test_progress_ends_when_all_scenes_are_there(folder: Path, done: int, jobs: int) -> None:
    """Those of the run that is resumed are among them, and no scene counts twice."""
    target = folder / f"progress-{done}-{jobs}.jsonl"
    common = ["sample", "balls.scenic", "--seed", 1, "-o", target.name]
    if done:
        assert run_here([*common, "-n", done], folder=folder).returncode == 0
    shown = run_here(
        [*common, "-n", 5, "--resume", "-j", jobs],
        folder=folder,
        variables={"TERM": "xterm", "COLUMNS": "100"},
        terminal=True,
    )
    assert shown.returncode == 0
    assert re.findall(r"(\d+)/5", shown.stderr)[-1] == "5"
    assert len(target.read_text().splitlines()) == 5


@pytest.mark.slow
@pytest.mark.parametrize(
    "outputs", [["-o", "ball.glb"], ["--view", "balls.html"], ["-o", "more.jsonl", "--view", "more.html"]]
)
def test_progress_counts_scenes_once_wherever_they_go(folder: Path, outputs: list[str]) -> None:
    shown = run_here(
        ["sample", "balls.scenic", "--seed", 1, "-n", 3, *outputs],
        folder=folder,
        variables={"TERM": "xterm", "COLUMNS": "100"},
        terminal=True,
    )
    assert shown.returncode == 0
    assert re.findall(r"(\d+)/3", shown.stderr)[-1] == "3"


def test_what_is_computed_of_meshes_is_kept_unless_it_must_not(tmp_path: Path) -> None:
    (tmp_path / "cones.scenic").write_text(
        "for i in range(4):\n    new Object at (Range(-1, 1), Range(-1, 1), 0), with shape ConeShape(), facing (0, 40 deg, 0)\n"
    )
    variables = {**environment(), "SCENIC_CACHE": "", "SCENIC_CACHE_DIR": str(tmp_path / "kept")}
    found = []
    for options in (["--no-cache"], []):
        result = subprocess.run(
            command("cones.scenic", "-n", 60, "--seed", 2, *options),
            cwd=tmp_path,
            env=variables,
            capture_output=True,
            text=True,
            check=True,
        )
        found.append(result.stdout)
        assert (tmp_path / "kept").exists() == (options == [])
    assert found[0] == found[1]


@pytest.mark.parametrize("target", ["-", "images.jsonl", "images.png", "images.glb"])
def test_labelled_images_need_a_folder(folder: Path, target: str) -> None:
    result = run(folder, "balls.scenic", "--camera", "ball", "-o", target)
    assert result.returncode == 2
    assert "labelled images cannot be written" in result.stderr
    assert not (folder / target).exists()


def test_labelled_images_do_not_replace_a_file(folder: Path) -> None:
    (folder / "images").write_text("mine")
    result = run(folder, "balls.scenic", "--camera", "ball", "-o", "images")
    assert result.returncode == 2
    assert "is not a folder" in result.stderr
    assert (folder / "images").read_text() == "mine"


def test_images_of_a_camera_have_their_labels_beside_them(folder: Path) -> None:
    result = run(folder, "balls.scenic", "--camera", "ego", "-n", 2, "--image-size", "32x24", "-o", "seen")
    assert result.returncode == 0, result.stderr
    index = json.loads((folder / "seen" / "annotations.json").read_text())
    assert len(index["images"]) == 2
    assert all((folder / "seen" / image["file_name"]).exists() for image in index["images"])


@pytest.mark.skipif(not hasattr(signal, "setitimer"), reason="there is no timer to limit it with")
def test_what_a_limit_of_time_takes_is_given_back(folder: Path) -> None:
    before = signal.getsignal(signal.SIGALRM)
    for program in ("balls.scenic", "slow.scenic"):
        run(folder, program, "--time-limit", "0.3")
        assert signal.getsignal(signal.SIGALRM) is before
        assert signal.getitimer(signal.ITIMER_REAL) == (0.0, 0.0)
