"""JSON Lines by several processes, and runs that are taken up again: always the same bytes."""

import json
import os
import random
import signal
import subprocess
import sys
import time
from collections.abc import Callable, Iterable, Iterator
from pathlib import Path
from typing import Any

import pytest

import scenic
from scenic.batch import workers
from scenic.batch.engines import Processes
from scenic.batch.scenes import Job, Made, WorkerDiedError, _Pieces, in_processes
from scenic.formats.growing import GrowingFile
from scenic.formats.json_lines import SceneLines
from scenic.formats.resuming import ResumeError, continued
from tests.cli.commands import run_here

PROGRAM = """
workspace = Workspace(RectangularRegion((0, 0, 0), 0, 30, 30))
for _ in range(6):
    new Object in workspace, facing Range(0, 360) deg, with width 2, with foo Range(0, 1)
"""
COUNT = 600


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    made = tmp_path_factory.mktemp("batches")
    (made / "room.scenic").write_text(PROGRAM)
    (made / "whole.jsonl").write_bytes(b"")
    result = run(made, "-o", "whole.jsonl")
    assert result.returncode == 0, result.stderr
    return made


def command(*arguments: object) -> list[str]:
    given = ["sample", "room.scenic", "-n", str(COUNT), "--seed", "5", *map(str, arguments)]
    return [sys.executable, "-m", "scenic.cli.main", *given]


def run(folder: Path, *arguments: object) -> subprocess.CompletedProcess[str]:
    return subprocess.run(
        command(*arguments), cwd=folder, capture_output=True, text=True, check=False, timeout=120
    )


def whole(folder: Path) -> bytes:
    return (folder / "whole.jsonl").read_bytes()


@pytest.mark.slow
def test_any_number_of_processes_makes_the_same_lines(folder: Path) -> None:
    assert run(folder, "-j", 3, "-o", "3.jsonl").returncode == 0
    assert (folder / "3.jsonl").read_bytes() == whole(folder)
    part = run(folder, "-j", 2, "--first", 590, "-o", "-")
    assert part.stdout.encode().splitlines()[:10] == whole(folder).splitlines()[590:]


@pytest.mark.slow
def test_a_killed_run_goes_on_to_the_same_bytes(folder: Path) -> None:
    rng = random.Random(8)
    target = folder / "killed.jsonl"
    part = folder / "killed.jsonl.part"
    kills = 0
    for _ in range(2):
        with subprocess.Popen(
            command("-j", 2, "-o", target.name, "--resume"),
            cwd=folder,
            stderr=subprocess.DEVNULL,
            start_new_session=True,
        ) as process:
            deadline = time.monotonic() + 60
            size = part.stat().st_size if part.exists() else 0
            while process.poll() is None and time.monotonic() < deadline:
                if part.exists() and part.stat().st_size > size:
                    break
                time.sleep(0.002)
            time.sleep(rng.random() * 0.02)
            if process.poll() is None:
                kills += 1
                process.send_signal(signal.SIGKILL)
        if target.exists():
            break
    assert kills > 0
    assert run(folder, "-o", target.name, "--resume").returncode == 0
    assert target.read_bytes() == whole(folder)
    assert not part.exists()


def children(parent: int) -> list[int]:
    """The processes that a process has started."""
    try:
        return [int(pid) for pid in Path(f"/proc/{parent}/task/{parent}/children").read_text().split()]
    except FileNotFoundError:
        return []


@pytest.mark.slow
@pytest.mark.skipif(not Path("/proc/self/task").exists(), reason="finds processes in /proc")
def test_killed_workers_change_nothing(folder: Path) -> None:
    rng = random.Random(11)
    target = folder / "workers.jsonl"
    kills = 0
    while kills < 2:
        target.unlink(missing_ok=True)
        with subprocess.Popen(
            command("-j", 2, "-o", target.name), cwd=folder, stderr=subprocess.PIPE, text=True
        ) as process:
            for _ in range(3):  # as often as a piece may lose its process
                while process.poll() is None and not children(process.pid):
                    time.sleep(0.002)
                time.sleep(rng.random() * 0.1)
                workers = children(process.pid)
                if process.poll() is None and workers:
                    os.kill(rng.choice(workers), signal.SIGKILL)
                    kills += 1
            assert process.stderr is not None
            shown = process.stderr.read()
        assert process.returncode == 0, shown
        assert target.read_bytes() == whole(folder)


def made_by(run: Any, monkeypatch: pytest.MonkeyPatch, job: Job) -> bytes:
    """The lines of a job by processes that answer as ``run`` says."""
    scenario = scenic.scenarioFromString("ego = new Object with foo Range(0, 1)\n")
    monkeypatch.setattr(workers, "run", run)
    return b"".join(made.encoded for made in in_processes(scenario, SceneLines().block, job, Processes(2)))


def test_pieces_are_told_in_order_whatever_the_order_in_which_they_are_made(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    job = Job(seed=3, first=5, last=105, max_attempts=10, deadline=None)

    def one_by_one(function: Any, pieces: Iterable[Job], **_others: Any) -> Iterator[Any]:
        yield from enumerate(map(function, pieces))

    def mixed(function: Any, pieces: Iterable[Job], **others: Any) -> Iterator[Any]:
        results = list(one_by_one(function, pieces, **others))
        assert len(results) > 4
        random.Random(2).shuffle(results)
        yield from results

    def backwards(function: Any, pieces: Iterable[Job], **others: Any) -> Iterator[Any]:
        yield from reversed(list(one_by_one(function, pieces, **others)))

    expected = made_by(one_by_one, monkeypatch, job)
    assert [json.loads(line)["k"] for line in expected.splitlines()] == list(range(5, 105))
    assert made_by(mixed, monkeypatch, job) == expected
    assert made_by(backwards, monkeypatch, job) == expected


def test_a_piece_that_fails_in_a_process_alone_is_made_here(monkeypatch: pytest.MonkeyPatch) -> None:
    """Whatever a process lacked: nothing is lost, neither the scenes nor word of those that were not found."""
    scenario = scenic.scenarioFromString(
        "x = Range(0, 1)\ndef half(v): return v < 0.5\nrequire half(x)\nego = new Object with foo x\n"
    )
    job = Job(seed=3, first=5, last=105, max_attempts=1, deadline=None)

    def told(fails: Callable[[Job], bool]) -> tuple[bytes, list[int], list[int], int]:
        def run(function: Any, pieces: Iterable[Job], **_others: Any) -> Iterator[Any]:
            for number, piece in enumerate(pieces):
                yield number, Made(piece, b"", (), failed=True) if fails(piece) else function(piece)

        monkeypatch.setattr(workers, "run", run)
        made = list(in_processes(scenario, SceneLines().block, job, Processes(2)))
        return (
            b"".join(each.encoded for each in made),
            [each.k for piece in made for each in piece.missing],
            [k for piece in made for k in range(piece.job.first, piece.job.last)],
            sum(piece.attempts for piece in made),
        )

    expected = told(lambda _: False)
    assert expected[2] == list(range(5, 105))
    assert expected[3] == 100
    found = [json.loads(line)["k"] for line in expected[0].splitlines()]
    assert 20 < len(found) < 80
    assert sorted([*found, *expected[1]]) == expected[2]
    assert told(lambda piece: piece.first > 5) == told(lambda _: True) == expected


@pytest.mark.parametrize("deaths", [0, 1, 3, 4])
def test_a_piece_is_made_again_three_times(monkeypatch: pytest.MonkeyPatch, deaths: int) -> None:
    """The piece of scene 6 loses its process so often, and is given up at the fourth loss."""
    job = Job(seed=3, first=0, last=40, max_attempts=10, deadline=None)
    left = deaths

    def dying(function: Any, pieces: Iterable[Job], *, lost: Any, **_others: Any) -> Iterator[Any]:
        nonlocal left
        for number, piece in enumerate(pieces):
            dies = piece.first <= 6 < piece.last and left > 0
            left -= dies
            yield number, lost(piece, -9) if dies else function(piece)

    if deaths == 4:
        with pytest.raises(WorkerDiedError, match="exit code -9"):
            made_by(dying, monkeypatch, job)
    else:
        lines = made_by(dying, monkeypatch, job)
        assert [json.loads(line)["k"] for line in lines.splitlines()] == list(range(40))


def test_a_torn_line_is_made_again(folder: Path) -> None:
    rows = whole(folder).splitlines(keepends=True)
    target = folder / "torn.jsonl"
    (folder / "torn.jsonl.part").write_bytes(b"".join(rows[:590]) + rows[590][:100])
    assert run(folder, "-o", target.name, "--resume").returncode == 0
    assert target.read_bytes() == whole(folder)


@pytest.mark.parametrize(
    ("arguments", "change", "words"),
    [
        (["--seed", 6], {}, "of seed 5, which this run does not make"),
        (["-n", 3], {}, "scenes 0 to 3"),
        ([], {"digest": "other"}, "another program"),
        ([], {"seed": "none"}, "does not hold scenes"),
    ],
)
def test_other_lines_are_not_gone_on_with(
    folder: Path, arguments: list[object], change: dict[str, object], words: str
) -> None:
    rows = [json.loads(row) for row in whole(folder).splitlines()[:4]]
    target = folder / "other.jsonl"
    content = "".join(json.dumps(row | change) + "\n" for row in rows)
    target.write_text(content)
    result = run_here(command(*arguments, "-o", target.name, "--resume")[3:], folder=folder)
    assert result.returncode != 0
    assert "SC609" in result.stderr
    assert words in " ".join(result.stderr.split())
    assert target.read_text() == content


def test_scenes_by_rows_of_a_sequence(folder: Path) -> None:
    """They are those of the API, evenly spread, whatever the number of processes, and not mixed with others."""
    target = folder / "even.jsonl"
    assert run_here(command("-n", 32, "--sobol", "-o", target.name)[3:], folder=folder).returncode == 0
    lines = target.read_bytes()
    scenario = scenic.load(folder / "room.scenic")
    rows = [json.loads(line) for line in lines.splitlines()]
    for row, scene in zip(rows, scenario.sample(32, seed=5, source=scenic.Sobol()), strict=True):
        assert [thing["position"] for thing in row["objects"]] == [
            [*thing.position] for thing in scene.objects
        ]
        assert row["points"] == "sobol"
    target.write_bytes(b"".join(lines.splitlines(keepends=True)[:9]))
    wrong = run_here(command("-n", 32, "--resume", "-o", target.name)[3:], folder=folder)
    assert "holds scenes of other random numbers" in " ".join(wrong.stderr.split())
    assert run(folder, "-n", 32, "--sobol", "-j", 2, "--resume", "-o", target.name).returncode == 0
    assert target.read_bytes() == lines
    # One coordinate of 32 rows: a number in each 32nd of its range.
    (folder / "one.scenic").write_text("ego = new Object with foo Range(0, 32)\n")
    shown = run_here(["sample", "one.scenic", "-n", 32, "--seed", 1, "--sobol"], folder=folder)
    numbers = [json.loads(line)["objects"][0]["properties"]["foo"] for line in shown.stdout.splitlines()]
    assert sorted(map(int, numbers)) == list(range(32))


def test_what_the_program_gives_can_be_told_alone(folder: Path) -> None:
    shown = run(folder, "-n", 2, "--properties", "changed")
    everything = [json.loads(row) for row in whole(folder).splitlines()[:2]]
    for line, full in zip(shown.stdout.splitlines(), everything, strict=True):
        for thing, other in zip(json.loads(line)["objects"], full["objects"], strict=True):
            assert set(thing["properties"]) == {"foo", "yaw", "pitch", "roll"}
            assert thing["properties"].items() <= other["properties"].items()
            assert len(other["properties"]) > 20


def test_what_classes_of_the_program_say_is_told_with_what_it_gives(folder: Path) -> None:
    """Not what they inherit; whether an object, too, says something of the property or not."""
    text = "class A:\n    speed: 3\n    colour: 2\n    visibleDistance: Range(1, 2)\nclass B(A):\n    cameraOffset: (1, 2, 3)\nego = new B with speed 4\nnew A at (9, 9)\n"
    (folder / "classes.scenic").write_text(text)
    shown = run_here(["sample", "classes.scenic", "--seed", 1, "--properties", "changed"], folder=folder)
    first, second = json.loads(shown.stdout)["objects"]
    own = {"speed", "colour", "visibleDistance"}
    assert {*first["properties"]} & {*own, "cameraOffset", "viewAngles"} == {*own, "cameraOffset"}
    assert {*second["properties"]} & {*own, "cameraOffset", "viewAngles"} == own


@pytest.mark.skipif(not Path("/dev/full").exists(), reason="the system has no full device")
def test_a_full_output_is_told(folder: Path) -> None:
    with Path("/dev/full").open("wb") as full:
        result = subprocess.run(
            command(), cwd=folder, stdout=full, stderr=subprocess.PIPE, text=True, check=False
        )
    assert result.returncode == 2
    assert "SC601" in result.stderr
    assert "no space left" in result.stderr


@pytest.mark.slow
def test_no_worker_outlives_a_killed_parent(folder: Path) -> None:
    with subprocess.Popen(
        command("-n", 10**6, "-j", 2, "-o", "orphans.jsonl"),
        cwd=folder,
        stderr=subprocess.DEVNULL,
        start_new_session=True,
    ) as process:
        deadline = time.monotonic() + 60
        while not (folder / "orphans.jsonl.part").exists() and time.monotonic() < deadline:
            time.sleep(0.01)
        process.send_signal(signal.SIGKILL)
    while time.monotonic() < deadline:
        try:
            os.killpg(process.pid, 0)  # the group lives as long as one of its processes
        except ProcessLookupError:
            return
        time.sleep(0.05)
    raise AssertionError("a worker lives on")


@pytest.mark.parametrize(
    ("kept", "first", "count", "done"),
    [
        ([], 3, 5, 0),
        ([0], 0, 1, 1),
        ([0, 1, 2], 0, 5, 3),
        ([0, 1, 2], 0, 3, 3),
        ([0, 2], 0, 5, 3),  # the scene between them was not found, and is not looked for again
        ([2], 0, 5, 3),
        ([3, 4], 3, 2, 2),
        ([4], 3, 5, 2),
        ([7], 3, 5, 5),
        ([0, 1, 2], 0, 2, None),
        ([8], 3, 5, None),
        ([2, 3], 3, 5, None),
        ([2], 3, 5, None),
    ],
)
def test_a_run_goes_on_after_its_last_scene(
    tmp_path: Path, kept: list[int], first: int, count: int, done: int | None
) -> None:
    """The number of scenes from ``--first`` on that need not be made; ``None`` for lines of another run."""
    target = tmp_path / "out.jsonl"
    target.write_text("".join(json.dumps({"digest": "d", "seed": 5, "k": k}) + "\n" for k in kept))
    grown = GrowingFile(target, resume=True)
    for seed in (5, None):
        if done is None:
            with pytest.raises(ResumeError, match="which this run does not make"):
                continued(grown, "d", seed, first, count)
        else:
            assert continued(grown, "d", seed, first, count) == (5 if kept else seed, done)
    for other in (6, 0, -5):
        if kept:
            with pytest.raises(ResumeError, match="of seed 5"):
                continued(grown, "d", other, first, count)


def test_the_part_of_a_killed_run_is_gone_on_with_before_the_older_file(tmp_path: Path) -> None:
    target = tmp_path / "out.jsonl"
    target.write_bytes(b"old\n")
    part = tmp_path / "out.jsonl.part"
    part.write_bytes(b"one\ntwo\nto")
    grown = GrowingFile(target, resume=True)
    assert grown.kept() == [b"one\n", b"two\n"]
    with grown:
        grown.write(b"three\n")
    assert target.read_bytes() == b"one\ntwo\nthree\n"
    assert not part.exists()


def test_a_run_that_finds_nothing_leaves_an_empty_file(tmp_path: Path) -> None:
    """Unless it is ended before: then nothing is left, or the older file."""
    target = tmp_path / "out.jsonl"
    with GrowingFile(target) as grown:
        grown.write(b"")
    assert target.read_bytes() == b""
    target.write_bytes(b"old\n")
    with pytest.raises(KeyboardInterrupt), GrowingFile(target) as grown:
        raise KeyboardInterrupt
    assert target.read_bytes() == b"old\n"
    assert [path.name for path in tmp_path.iterdir()] == ["out.jsonl"]


@pytest.mark.parametrize(
    "change", [{"digest": None}, {"seed": None}, {"seed": [1]}, {"k": None}, {"k": "x"}, {"digest": 3}, None]
)
@pytest.mark.parametrize("place", [0, -1])
def test_lines_of_any_other_kind_are_refused(
    tmp_path: Path, change: dict[str, Any] | None, place: int
) -> None:
    """Whatever is in the first or the last line: an error that names the file, and nothing of it is lost."""
    rows: list[Any] = [{"digest": "d", "seed": 5, "k": k} for k in range(3)]
    for other in ([1], 7, "text", None, {}) if change is None else (rows[place] | change,):
        lines = [*rows]
        lines[place] = other
        target = tmp_path / "out.jsonl"
        target.write_text(content := "".join(json.dumps(line) + "\n" for line in lines))
        with pytest.raises(ResumeError, match=r"out\.jsonl"):
            continued(GrowingFile(target, resume=True), "d", 5, 0, 9)
        assert target.read_text() == content


@pytest.mark.parametrize("seconds", [1e-9, 0.8, 1e3, 1e9])
@pytest.mark.parametrize("jobs", [2, 7])
def test_pieces_are_a_job_whole_however_long_they_take(seconds: float, jobs: int) -> None:
    """None is empty, and none holds more than may wait in memory."""
    pieces = _Pieces(Job(seed=1, first=3, last=9003, max_attempts=None, deadline=None), Processes(jobs))
    reached = 3
    for number, piece in enumerate(pieces):
        assert piece.first == reached < piece.last <= reached + 4096
        assert number < 9000
        reached = piece.last
        pieces.learn(Made(piece, b"", (), seconds=seconds))
    assert reached == 9003


@pytest.mark.parametrize("source", [None, scenic.Sobol()])
def test_scenario_samples_the_same_scenes_in_processes(source: Any) -> None:
    scenario = scenic.scenarioFromString(
        "param noise = Normal(0, 1)\nego = new Object with foo Range(0, 1)\nrequire[0.5] ego.foo < 0.3\nrequire ego.foo < 0.8\n"
    )
    alone = scenario.sample(60, seed=4, source=source)
    shared = scenario.sample(60, seed=4, source=source, processes=2)
    assert [scene.params["noise"] for scene in shared] == [scene.params["noise"] for scene in alone]
    assert [scene.attempts for scene in shared] == [scene.attempts for scene in alone]
    assert scenario.sceneToBytes(shared[7]) == scenario.sceneToBytes(alone[7])


def test_scenario_rejects_in_processes_as_alone() -> None:
    scenario = scenic.scenarioFromString(
        "def half(v): return v < 0.5\nego = new Object with foo Range(0, 1)\nrequire half(ego.foo)\n"
    )
    messages = []
    for processes in (1, 2):
        with pytest.raises(scenic.RejectionException) as caught:
            scenario.sample(40, seed=1, max_attempts=1, processes=processes)
        messages.append(str(caught.value))
    assert messages[0] == messages[1]


FINITE = [
    (
        "s = [DiscreteRange(0, 11) for i in range(12)]\nfor i in range(12):\n    for j in range(i):\n"
        "        require s[i] != s[j]\nrequire s[0] + s[1] == 3\nego = new Object with foo s\n"
    ),
    (
        "a, b, c = (Uniform('x', 'y', 'z') for i in range(3))\nrequire a != b\nrequire b != c\nrequire a != c\n"
        "ego = new Object with foo (a, b, c)\n"
    ),
    (
        "n, m, t = DiscreteRange(1, 9), Uniform(2, 4, 8), Range(0, 40)\nrequire n * m < 20\nrequire 30 < t * m + n < 31\n"
        "ego = new Object at (t, n, 0), with foo m\n"
    ),
]


@pytest.mark.parametrize("text", FINITE)
def test_decided_values_are_the_same_with_a_store_and_in_processes(
    text: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    (tmp_path / "program.scenic").write_text(text)

    def lines(processes: int) -> list[bytes]:
        scenario = scenic.scenarioFromFile(tmp_path / "program.scenic")
        return [scenario.sceneToBytes(scene) for scene in scenario.sample(40, seed=3, processes=processes)]

    alone = lines(1)
    assert lines(2) == alone
    monkeypatch.setenv("SCENIC_CACHE", "")
    monkeypatch.setenv("SCENIC_CACHE_DIR", str(tmp_path / "store"))
    assert lines(1) == alone
    # The second time what the first has stored is read.
    assert lines(2) == alone
    assert len(set(alone)) > 5
