"""``scenic check`` on many files: which are checked, by which rules, and what is changed in them."""

import json
import os
import pty
import signal
import subprocess
import sys
from pathlib import Path

import pytest

from scenic.cli.discovery import discover
from scenic.configuration.project import PLAIN, Configurations
from tests.cli.commands import run_here
from tests.processes import interruptible

ROOT = Path(__file__).parents[2]
WARNED = "ego = new Object with wdth 3\n"
CLEAN = "ego = new Object\n"
COMMAND = [sys.executable, "-m", "scenic.cli.main", "check"]
ENVIRONMENT = {**os.environ, "PYTHONPATH": str(ROOT), "NO_COLOR": "1"}


@pytest.fixture(autouse=True)
def _in_folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)


def run(*arguments: str, text: str | bytes = b"") -> "subprocess.CompletedProcess[str]":
    data = text.encode() if isinstance(text, str) else text
    return run_here(["check", *arguments], variables={"NO_COLOR": "1"}, text=data)


def run_process(*arguments: str, text: str | None = None) -> "subprocess.CompletedProcess[bytes]":
    return subprocess.run(
        [*COMMAND, *arguments],
        env=ENVIRONMENT,
        input=None if text is None else text.encode(),
        capture_output=True,
        timeout=60,
        check=False,
    )


def found(*arguments: str) -> list[str]:
    """File, line and code of what is found."""
    result = run("--format", "json", *arguments)
    return [
        f"{item['filename']}:{item['span']['line'] if item['span'] else 0}:{item['code']}"
        for item in json.loads(result.stdout)["diagnostics"]
    ]


def put(name: str, text: str = WARNED) -> None:
    path = Path(name)
    path.parent.mkdir(parents=True, exist_ok=True)
    path.write_bytes(text.encode())


def files(*arguments: str, configurations: Configurations | None = None) -> list[str]:
    return list(discover(arguments, configurations or Configurations(PLAIN)).files)


# Which files.


def test_folders_are_searched() -> None:
    for name in (
        "b.scenic",
        "a/c.sc",
        "a/b/d.scenic",
        "a/other.py",
        "a.scenic/x.scenic",
        "-x.scenic",
        "B.scenic",
    ):
        put(name)
    for name in (".hidden/x.scenic", "__pycache__/x.scenic", "env/x.scenic", "a/.git/x.scenic"):
        put(name)
    put("env/pyvenv.cfg", "")
    os.symlink("..", "a/loop")
    os.symlink("b", "a/folder.scenic")
    os.symlink("nowhere", "a/broken.scenic")
    expected = [
        "-x.scenic",
        "B.scenic",
        "a/b/d.scenic",
        "a/broken.scenic",
        "a/c.sc",
        "a.scenic/x.scenic",
        "b.scenic",
    ]
    assert files() == files(".") == expected
    assert files("a") == ["a/b/d.scenic", "a/broken.scenic", "a/c.sc"]
    assert files("b.scenic", "a/other.py", "./b.scenic", "a", "a/c.sc") == [
        "b.scenic",
        "a/other.py",
        "a/b/d.scenic",
        "a/broken.scenic",
        "a/c.sc",
    ]
    assert files("env", ".hidden/x.scenic") == ["env/x.scenic", ".hidden/x.scenic"]
    assert [each.replace("a/loop/", "") for each in files("a/loop")] == expected
    assert run("--", "-x.scenic").returncode == 1


def test_excluded_files() -> None:
    put("pyproject.toml", '[tool.scenic]\nexclude = ["gen", "a/*.sc"]\n')
    put("sub/pyproject.toml", "[tool.scenic]\n")
    for name in ("gen/x.scenic", "a/b.sc", "a/b.scenic", "sub/gen/y.scenic"):
        put(name)
    assert files(configurations=Configurations()) == ["a/b.scenic", "sub/gen/y.scenic"]
    assert files("a/b.sc", configurations=Configurations()) == ["a/b.sc"]
    assert files("gen", configurations=Configurations()) == ["gen/x.scenic"]


def test_folders_that_cannot_be_read(monkeypatch: pytest.MonkeyPatch) -> None:
    put("a/x.scenic")
    put("b/y.scenic")
    scan = os.scandir

    def refusing(folder: str) -> object:
        if folder == "a":
            raise PermissionError(13, "Permission denied")
        return scan(folder)

    monkeypatch.setattr(os, "scandir", refusing)
    result = discover(["."], Configurations(PLAIN))
    assert result.files == ("b/y.scenic",)
    (problem,) = result.problems
    assert (problem.code, problem.filename) == ("SC600", "a")
    assert problem.message == "the folder cannot be read: permission denied"


def test_without_files() -> None:
    result = run()
    assert (result.returncode, result.stdout) == (0, "")
    assert "there are no Scenic files" in result.stderr
    assert run("--format", "json").returncode == 0


def test_exit_codes() -> None:
    put("clean.scenic", CLEAN)
    put("warned.scenic")
    assert run("clean.scenic").returncode == 0
    result = run()
    assert result.returncode == 1
    assert result.stderr.startswith("1 warning in 2 files")
    assert run("--exit-zero").returncode == 0
    assert run("--exit-zero", "missing.scenic").returncode == 2


# Standard input.


def test_standard_input() -> None:
    result = run("-", text=WARNED)
    assert result.returncode == 1
    assert "--> <stdin>:1:23" in result.stdout
    assert "1 | ego = new Object with wdth 3" in result.stdout
    put("pyproject.toml", '[tool.scenic]\nper-file-ignores = { "x.scenic" = ["SC300"] }\n')
    assert run("-", "--stdin-filename", "x.scenic", text=WARNED).returncode == 0
    assert run("-", "--stdin-filename", "y.scenic", text=WARNED).returncode == 1
    assert "SC107" in run("-", text=b"\xff").stdout


# Selection and configuration.


def test_selection() -> None:
    put("a.scenic", WARNED + "x = 1  # scenic: ignore\ny = z\n".replace("y = z\n", ""))
    assert found() == ["a.scenic:1:SC300", "a.scenic:2:SC390"]
    assert found("--select", "SC300") == ["a.scenic:1:SC300"]
    assert found("--ignore", "SC30, SC7") == ["a.scenic:2:SC390"]
    assert found("--ignore", "SC3", "--select", "SC390") == ["a.scenic:2:SC390"]
    assert found("--select", "SC2,SC300", "--select", "SC1") == ["a.scenic:1:SC300"]
    put("a.scenic", "x = (\n")
    assert found("--select", "SC7") == ["a.scenic:1:SC103"]
    result = run("--ignore", "SC30O")
    assert result.returncode == 2
    assert "Did you mean 'SC300'?" in result.stderr


def test_configuration() -> None:
    put("pyproject.toml", '[tool.scenic]\nignore = ["SC300"]\nseverity = { SC390 = "error" }\n')
    put("a.scenic", WARNED + "x = 1  # scenic: ignore\n")
    put("sub/pyproject.toml", "[tool.scenic]\n")
    put("sub/b.scenic")
    assert found() == ["a.scenic:2:SC390", "sub/b.scenic:1:SC300"]
    assert "error[SC390]" in run().stdout
    assert found("--no-config", "a.scenic") == ["a.scenic:1:SC300", "a.scenic:2:SC390"]
    assert found("--select", "SC300", "a.scenic") == ["a.scenic:1:SC300"]
    assert found("--ignore", "SC390", "a.scenic") == []
    assert found("--config", "pyproject.toml", "sub") == []


def test_bad_configuration() -> None:
    put("pyproject.toml", '[tool.scenic]\nselct = ["SC3"]\n')
    put("a.scenic")
    result = run()
    assert result.returncode == 2
    assert "error[SC606]: unknown key `selct`" in result.stdout
    assert "--> pyproject.toml:2:1" in result.stdout
    assert "2 | selct" in result.stdout
    assert "warning[SC300]" in result.stdout
    assert run("--no-config").returncode == 1
    assert run("--config", "none.toml").returncode == 2


# Repairs.


def test_fix() -> None:
    text = "\ufeffx = 1  # scenic: ignore\r\ny = 2\r\n"
    put("a.scenic", text)
    put("b.scenic", CLEAN)
    os.chmod("a.scenic", 0o640)
    os.symlink("a.scenic", "link.sc")
    patch = run("--diff", "a.scenic")
    assert patch.returncode == 1
    assert "-x = 1  # scenic: ignore\r\n+x = 1\r\n" in patch.stdout.replace("\ufeff", "")
    assert Path("a.scenic").read_bytes().decode() == text
    assert run("--fix", "--ignore", "SC390").returncode == 0
    assert Path("a.scenic").read_bytes().decode() == text
    result = run("--fix", "link.sc")
    assert (result.returncode, result.stderr) == (0, "no problems in 1 file; 1 repair made\n")
    assert Path("a.scenic").read_bytes().decode() == "\ufeffx = 1\r\ny = 2\r\n"
    assert os.path.islink("link.sc")
    assert Path("a.scenic").stat().st_mode & 0o777 == 0o640
    assert run("--diff").returncode == 0
    assert sorted(os.listdir()) == ["a.scenic", "b.scenic", "link.sc"]


def test_fix_of_standard_input() -> None:
    result = run("--fix", "-", text="x = 1  # scenic: ignore\nego = new Object with qwertz 3\nx = y\n")
    assert (result.returncode, result.stdout) == (
        1,
        "x = 1  # scenic: ignore\nego = new Object with qwertz 3\nx = y\n",
    )
    assert "error[SC202]" in result.stderr
    result = run("--fix", "-", text="x = 1  # scenic: ignore\n")
    assert (result.returncode, result.stdout, result.stderr) == (0, "x = 1\n", "")
    process = run_process("--fix", "-", text="x = 1  # scenic: ignore\n")
    assert (process.returncode, process.stdout, process.stderr) == (0, b"x = 1\n", b"")
    result = run("--diff", "-", text="x = 1  # scenic: ignore")
    assert result.stdout.endswith(
        "-x = 1  # scenic: ignore\n\\ No newline at end of file\n+x = 1\n\\ No newline at end of file\n"
    )


def test_the_patch_can_be_applied() -> None:
    put("a.scenic", "x = 1  # scenic: ignore\ny = 2\n# scenic: ignore[SC300]\nz = 3")
    patch = run("--diff").stdout
    applied = subprocess.run(
        ["git", "apply", "-p0", "-"], input=patch.encode(), check=False, capture_output=True
    )
    assert applied.returncode == 0, applied.stderr
    assert Path("a.scenic").read_text() == "x = 1\ny = 2\nz = 3"


# Many files.


def test_the_same_in_several_processes() -> None:
    for number in range(60):
        put(f"f{number:02}.scenic", (WARNED if number % 7 == 0 else CLEAN) + "x = 1\n" * 300)
    alone = run_process("--jobs", "1", "--format", "json")
    several = run_process("--jobs", "3", "--format", "json")
    assert alone.stdout == several.stdout
    assert json.loads(alone.stdout)["summary"]["warnings"] == 9
    assert json.loads(alone.stdout)["summary"]["files"] == 60


DYING = """
import os, sys, signal, time
import scenic.cli.main, scenic.cli.check as command, scenic.cli.checking as checking
original = checking.Checker()
class Checker:
    def __call__(self, task):
        if 'f01' in task.filename:
            {what}
        return original(task)
command.Checker = Checker
if __name__ == '__main__':
    scenic.cli.main.main()
"""


def test_a_worker_that_dies() -> None:
    for number in range(4):
        put(f"f{number:02}.scenic", WARNED + "x = 1\n" * 10_000)
    program = DYING.format(what="os.kill(os.getpid(), signal.SIGKILL)")
    done = subprocess.run(
        [sys.executable, "-c", program, "check", "--jobs", "2", "--format", "json"],
        env=ENVIRONMENT,
        capture_output=True,
        text=True,
        timeout=60,
        check=False,
    )
    assert done.returncode == 70, done.stderr
    diagnostics = json.loads(done.stdout)["diagnostics"]
    assert [item["code"] for item in diagnostics] == ["SC300", "SC999", "SC300", "SC300"]
    assert diagnostics[1]["filename"] == "f01.scenic"
    assert "signal 9" in diagnostics[1]["message"]


def test_interruption_of_several_processes() -> None:
    for number in range(4):
        put(f"f{number:02}.scenic", CLEAN + "x = 1\n" * 10_000)
    program = DYING.format(what="print('ready', flush=True); time.sleep(600)")
    process = subprocess.Popen(
        [sys.executable, "-c", program, "check", "--jobs", "2"],
        env=ENVIRONMENT,
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
        text=True,
        preexec_fn=interruptible,
        start_new_session=True,
    )
    try:
        assert process.stdout is not None
        assert process.stdout.readline() == "ready\n"
        os.killpg(process.pid, signal.SIGINT)  # as a terminal does
        stdout, stderr = process.communicate(timeout=30)
    finally:
        process.kill()
        process.wait(30)
    assert (process.returncode, stdout, stderr.strip()) == (130, "", "interrupted")
    with pytest.raises(ProcessLookupError):
        os.killpg(process.pid, 0)


def test_progress_is_shown_on_a_terminal_when_it_takes_long() -> None:
    for number in range(2):
        put(f"f{number:02}.scenic", CLEAN)
    main, terminal = pty.openpty()
    program = DYING.format(what="time.sleep(1.2)")
    process = subprocess.Popen(
        [sys.executable, "-c", program, "check"], env=ENVIRONMENT, stdout=subprocess.DEVNULL, stderr=terminal
    )
    os.close(terminal)
    shown = b""
    try:
        while chunk := os.read(main, 4096):
            shown += chunk
    except OSError:  # how Linux tells that the other side of a terminal is closed
        pass
    finally:
        os.close(main)
        assert process.wait(60) == 0
    assert b"\rchecked 2 of 2 files\r\x1b[K" in shown
    assert shown.endswith(b"no problems in 2 files\r\n")
