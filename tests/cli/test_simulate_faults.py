"""``scenic simulate`` when things outside of the program go wrong: what is lost, what is said, and how it goes on."""

import os
import shutil
import subprocess
import sys
from pathlib import Path

import pytest

from tests.cli.commands import run_here

ROOT = Path(__file__).parents[2]
PROGRAM = """
behavior B():
    while True:
        take Range(0, 1)
ego = new Object with behavior B
record ego.position to "place-{simulation}.jsonl"
"""
FAILING = """
import os
from pathlib import Path
from scenic.simulators.dummy import DummySimulation, DummySimulator

class Failing(DummySimulation):
    def step(self):
        if self.currentTime == 3 and self.name.startswith("1") and (how := Path(__file__).with_name("how")).exists():
            if how.read_text() == "dies":
                os._exit(7)
            if how.read_text() == "exits":
                raise SystemExit(3)
            raise ConnectionResetError("the server has gone")
        super().step()

class Fragile(DummySimulator):
    def createSimulation(self, scene, **options):
        return Failing(scene, drift=self.drift, **options)
"""


@pytest.fixture
def folder(tmp_path: Path) -> Path:
    (tmp_path / "program.scenic").write_text(PROGRAM)
    (tmp_path / "fragile_simulator.py").write_text(FAILING)
    return tmp_path


def run(folder: Path, *arguments: object) -> "subprocess.CompletedProcess[str]":
    options = ["program.scenic", "-n", 3, "--seed", 1, "--time", 5, "-o", "out"]
    variables = {"NO_COLOR": "1", "COLUMNS": "100"}
    return run_here(["simulate", *options, *arguments], folder=folder, variables=variables)


def kept(folder: Path) -> dict[str, str]:
    """The files that the run has left, by name: all but the manifest, which is there before the first simulation."""
    files = {path.name: path for path in [*(folder / "out").iterdir(), *folder.glob("*place*")]}
    files.pop("manifest.json")
    return {name: path.read_text() for name, path in files.items()}


def whole(*numbers: int) -> set[str]:
    return {f"simulation-000{k}.jsonl" for k in numbers} | {f"place-{k}.jsonl" for k in numbers}


def check_resumed(folder: Path, before: dict[str, str], *arguments: object) -> None:
    """Called again with ``--resume``, the command makes what is missing, and leaves the rest as it is."""
    (folder / "how").unlink()
    times = {name: (folder / "out" / name).stat().st_mtime_ns for name in before if name.startswith("sim")}
    again = run(folder, *arguments, "--resume")
    assert again.returncode == 0, again.stderr
    after = kept(folder)
    assert set(after) == whole(0, 1, 2)
    assert {name: after[name] for name in before} == before
    assert {name: (folder / "out" / name).stat().st_mtime_ns for name in times} == times


def test_a_simulator_that_fails_costs_one_simulation(folder: Path) -> None:
    (folder / "how").write_text("fails")
    result = run(folder, "--simulator", "fragile_simulator:Fragile")
    assert result.returncode == 1
    assert "simulation 1 failed:\nerror[SC503]: ConnectionResetError: the server has gone" in result.stderr
    before = kept(folder)
    assert set(before) == whole(0, 2)
    check_resumed(folder, before, "--simulator", "fragile_simulator:Fragile")


def test_a_simulator_that_asks_for_the_end_costs_one_simulation(folder: Path) -> None:
    (folder / "how").write_text("exits")
    result = run(folder, "--simulator", "fragile_simulator:Fragile")
    assert result.returncode == 1
    assert "has asked for the end of the process (exit code 3)" in result.stderr
    assert set(kept(folder)) == whole(0, 2)


@pytest.mark.parametrize(
    ("name", "words", "help"),
    [
        ("fragile_simulator:Unreachable", "cannot be made: no server at port 2000", ""),
        ("fragile_simulator:Other", "'fragile_simulator:Other' is no simulator", "derive from"),
        ("Kinematics", "there is no simulator 'Kinematics'", "did you mean `kinematic`?"),
        (":", "there is no simulator ':'", "kinematic, mujoco, newtonian, dummy, or MODULE:CLASS"),
    ],
)
def test_simulators_that_cannot_be_had(folder: Path, name: str, words: str, help: str) -> None:
    with (folder / "fragile_simulator.py").open("a") as file:
        file.write("class Other:\n    pass\nclass Unreachable:\n    def __init__(self):\n")
        file.write("        raise ConnectionRefusedError('no server at port 2000')\n")
    result = run(folder, "--simulator", name)
    assert result.returncode == 2
    assert "error[SC604]: " in result.stderr
    shown = " ".join(result.stderr.split())
    assert words in shown
    assert help in shown


def test_a_program_that_names_something_else_as_its_simulator(folder: Path) -> None:
    (folder / "program.scenic").write_text("simulator 3\nego = new Object\n")
    result = run(folder)
    assert result.returncode == 2
    assert "error[SC604]: what the program names is no simulator" in result.stderr


@pytest.mark.parametrize(
    ("output", "words"),
    [("program.scenic", "is not a folder"), ("program.scenic/a", "cannot make the folder")],
)
def test_folders_that_cannot_be_made(folder: Path, output: str, words: str) -> None:
    result = run(folder, "-o", output)
    assert result.returncode == 2
    assert "error[SC601]: " in result.stderr
    assert words in " ".join(result.stderr.split())


def test_a_trajectory_that_does_not_fit_is_told(folder: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    def full(*_: object) -> None:
        raise OSError(28, "No space left on device")

    monkeypatch.setattr(shutil, "copyfileobj", full)
    (folder / "program.scenic").write_text("ego = new Object\n")
    result = run(folder)
    assert result.returncode == 1
    assert result.stderr.count("no space left on device\n  = help: nothing of this simulation is kept") == 3
    assert kept(folder) == {}


@pytest.mark.slow
def test_a_process_that_dies_costs_one_simulation(folder: Path) -> None:
    (folder / "how").write_text("dies")
    arguments = ("--simulator", "fragile_simulator:Fragile", "-j", 2)
    result = run(folder, *arguments)
    assert result.returncode == 1
    assert "the process of simulation 1 died (exit code 7)" in result.stderr
    before = kept(folder)
    assert set(before) == whole(0, 2)
    check_resumed(folder, before, *arguments)


@pytest.mark.skipif(sys.platform == "win32", reason="limits of files are POSIX")
@pytest.mark.parametrize("target", ["place-{simulation}.jsonl", "place-{simulation}-{step}.npy"])
def test_a_full_disk_leaves_no_half_files(folder: Path, target: str) -> None:
    text = PROGRAM.replace("place-{simulation}.jsonl", target).replace("ego.position to", "[[1.5] * 900] to")
    (folder / "program.scenic").write_text(text)
    arguments = ["simulate", "program.scenic", "-n", "2", "--seed", "1", "--time", "50", "-o", "out"]
    arguments += ["--simulator", "dummy"]
    code = (
        "import resource, signal, sys\n"
        "signal.signal(signal.SIGXFSZ, signal.SIG_IGN)\n"
        "resource.setrlimit(resource.RLIMIT_FSIZE, (2000, 2000))\n"
        f"sys.argv = ['scenic', *{arguments!r}]\n"
        "from scenic.cli.main import main\nmain()\n"
    )
    result = subprocess.run(
        [sys.executable, "-c", code],
        cwd=folder,
        env={**os.environ, "PYTHONPATH": str(ROOT), "NO_COLOR": "1", "COLUMNS": "200", "SCENIC_CACHE": "off"},
        capture_output=True,
        text=True,
        check=False,
    )
    assert result.returncode == 1, result.stderr
    assert result.stderr.count("File too large: 'place-") == 2
    assert "nothing of this simulation is kept" in result.stderr
    assert kept(folder) == {}


def test_scenes_that_are_not_found_and_runs_without_events(tmp_path: Path) -> None:
    program = "ego = new Object at (Range(0, 1), 0)\nrequire ego.x > 2 or ego.y > 3\n"
    (tmp_path / "program.scenic").write_text(program)
    variables = {"NO_COLOR": "1", "COLUMNS": "100"}
    done = run_here(
        ["simulate", "program.scenic", "-n", 2, "--seed", 1], folder=tmp_path, variables=variables
    )
    assert done.returncode == 3
    assert "nothing happens in this simulation" in done.stderr
    lines = done.stdout.splitlines()
    assert lines[0] == "simulation 0: no scene found"
    assert "requirement on line 2 rejected every candidate" in lines
    assert lines[-3:-1] == [
        "                  100.0%    100.0%  requirement on line 2 (line 2)",
        "simulation 1: no scene found",
    ]
