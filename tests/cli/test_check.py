"""``scenic check`` as a process, and what the frame around all commands does."""

import json
import os
import pty
import re
import signal
import subprocess
import sys
from pathlib import Path

import pytest

from scenic.cli.file_changes import watch
from tests.cli.commands import run_here
from tests.processes import interruptible

ROOT = Path(__file__).parents[2]
GOOD = "ego = new Object at (1, 2, 0), with width 3\nrequire ego.position.x > 0\n"
BAD = "x = 1\nego = new Object at (1, 2\nrequire x >\n"
COMMAND = [sys.executable, "-m", "scenic.cli.main"]
ENVIRONMENT = {**os.environ, "PYTHONPATH": str(ROOT), "NO_COLOR": ""}


def run(*arguments: str | Path) -> "subprocess.CompletedProcess[str]":
    return run_here(arguments, folder=ROOT, variables={"NO_COLOR": ""})


def run_process(*arguments: str | Path, code: str | None = None) -> "subprocess.CompletedProcess[str]":
    """Run the command as a process; with ``code``, run this Python code instead, which may prepare what fails."""
    command = [sys.executable, "-c", code] if code else COMMAND
    return subprocess.run(
        [*command, *map(str, arguments)],
        cwd=ROOT,
        env=ENVIRONMENT,
        capture_output=True,
        text=True,
        timeout=60,
        check=False,
    )


@pytest.fixture
def good(tmp_path: Path) -> Path:
    file = tmp_path / "good.scenic"
    file.write_text(GOOD)
    return file


@pytest.fixture
def bad(tmp_path: Path) -> Path:
    file = tmp_path / "bad.scenic"
    file.write_text(BAD)
    return file


def test_clean_program(good: Path) -> None:
    for result in (run("check", good), run_process("check", good)):
        assert (result.returncode, result.stdout, result.stderr) == (0, "", "")


def test_errors_are_shown_with_their_place(bad: Path) -> None:
    result = run("check", bad)
    process = run_process("check", bad)
    assert (result.returncode, result.stdout, result.stderr) == (1, process.stdout, process.stderr)
    assert process.returncode == 1
    assert f"--> {bad}:2:21" in result.stdout
    assert "2 | ego = new Object at (1, 2" in result.stdout
    assert re.search(r"^  \| {21}\^$", result.stdout, re.MULTILINE)
    assert "= help: add `)`" in result.stdout
    assert "error" in result.stderr
    assert "\x1b" not in result.stdout + result.stderr


def test_json(good: Path, bad: Path) -> None:
    clean = run("check", "--format", "json", good)
    assert clean.returncode == 0
    numbers = dict.fromkeys(("errors", "warnings", "information", "fixable", "fixed"), 0)
    assert json.loads(clean.stdout) == {"version": 1, "diagnostics": [], "summary": {"files": 1, **numbers}}
    result = run("check", "--format", "json", bad, good)
    assert (result.returncode, result.stderr) == (1, "")
    found = json.loads(result.stdout)["diagnostics"]
    assert {item["filename"] for item in found} == {str(bad)}
    first = found[0]
    assert (first["code"], first["severity"], first["help"]) == ("SC103", "error", "add `)`")
    assert first["span"] == {"line": 2, "column": 21, "end_line": 2, "end_column": 22}
    places = [(item["span"]["line"], item["span"]["column"]) for item in found]
    assert places == sorted(places)
    assert len({json.dumps(item) for item in found}) == len(found)


def test_files_that_cannot_be_read(tmp_path: Path, good: Path) -> None:
    missing = tmp_path / "missing.scenic"
    warned = tmp_path / "warned.scenic"
    warned.write_text("ego = new Object with wdth 3\n")
    result = run("check", missing, good, warned)
    assert result.returncode == 2
    assert result.stdout.count("error[SC600]") == 1
    assert f"--> {missing}\n" in result.stdout
    assert "warning[SC300]" in result.stdout
    assert "Traceback" not in result.stderr
    for command in ("ast", "python"):
        other = run(command, missing)
        assert (other.returncode, other.stdout) == (2, "")
        assert "error[SC600]" in other.stderr


def test_other_encodings(tmp_path: Path) -> None:
    file = tmp_path / "latin.scenic"
    file.write_bytes(b"x = 1\ny = '\xe9'\n")
    result = run("check", file)
    assert result.returncode == 1
    assert "error[SC107]" in result.stdout
    assert f"--> {file}:2:6" in result.stdout


@pytest.mark.parametrize(
    "arguments",
    [
        ["check", "--frmat", "x"],
        ["chek"],
        ["check", "--format", "xml", "f"],
        ["check", "--select", "SC8", "f"],
        ["check", "--fix", "--diff", "f"],
        ["check", "--config", "f", "--no-config", "f"],
        ["check", "--deep", "-"],
        ["check", "--jobs", "0", "f"],
    ],
)
def test_wrong_usage(arguments: list[str]) -> None:
    result = run(*arguments)
    assert result.returncode == 2
    assert "Usage:" in result.stderr
    assert "Traceback" not in result.stderr


def test_a_misspelt_command_names_the_one_meant() -> None:
    done = run("chek", "x.scenic")
    assert done.returncode == 2
    assert "Did you mean 'check'?" in done.stderr
    unlike = run("zzzzzz", "x.scenic")
    assert unlike.returncode == 2
    assert "zzzzzz" in unlike.stderr
    assert "mean" not in unlike.stderr


def test_help_and_version() -> None:
    result = run("--help")
    assert result.returncode == 0
    for command in ("check", "sample", "ast", "python", "lsp"):
        assert re.search(rf"^  {command} ", result.stdout, re.MULTILINE)
    shown = run("--version")
    assert (shown.returncode, shown.stderr) == (0, "")
    assert re.fullmatch(r"scenic \S.*\n", shown.stdout)
    assert "Exit codes" in run("check", "--help").stdout


def test_check_needs_no_heavy_library(good: Path) -> None:
    code = (
        "import sys; from scenic.cli.main import scenic\n"
        "scenic.main(['check', sys.argv[1]], standalone_mode=False)\n"
        "print(sorted({name.partition('.')[0] for name in sys.modules}))"
    )
    result = run_process(good, code=code)
    assert result.returncode == 0, result.stderr
    loaded = set(result.stdout.translate({ord(each): None for each in "[]',"}).split())
    assert "click" in loaded
    assert not loaded & {"numpy", "scipy", "trimesh", "z3", "rich", "shapely", "pygls", "asyncio", "pegen"}


def test_closed_pipe(bad: Path) -> None:
    bad.write_text("x = $\n" * 1000)
    command = " ".join([*COMMAND, "check", str(bad), "| head -n 1"])
    result = subprocess.run(
        ["bash", "-o", "pipefail", "-c", command],
        cwd=ROOT,
        env=ENVIRONMENT,
        capture_output=True,
        text=True,
        timeout=60,
        check=False,
    )
    assert result.stdout == "error[SC100]: invalid character `$`\n"
    assert "Traceback" not in result.stderr
    assert "BrokenPipe" not in result.stderr
    assert result.returncode == 1


def test_interruption(good: Path) -> None:
    code = (
        "import sys, time, scenic.cli.main, scenic.cli.checking as check\n"
        "def slow(*_, **__):\n    print('ready', flush=True)\n    time.sleep(60)\n"
        "check.check_text = slow\n"
        "sys.argv[1:1] = ['check']\n"
        "scenic.cli.main.main()"
    )
    process = subprocess.Popen(
        [sys.executable, "-c", code, str(good)],
        cwd=ROOT,
        env=ENVIRONMENT,
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
        preexec_fn=interruptible,
        text=True,
    )
    try:
        assert process.stdout is not None
        assert process.stdout.readline() == "ready\n"
        process.send_signal(signal.SIGINT)
        stdout, stderr = process.communicate(timeout=30)
    finally:
        process.kill()
        process.wait(30)
    assert (process.returncode, stdout, stderr.strip()) == (130, "", "interrupted")


def test_internal_errors_ask_for_a_report(good: Path) -> None:
    code = (
        "import sys, scenic.cli.main, scenic.cli.checking as check\n"
        "def fail(*_, **__): raise ZeroDivisionError('oops')\n"
        "check.check_text = fail\n"
        "sys.argv[1:1] = ['check']\n"
        "scenic.cli.main.main()"
    )
    result = run_process(good, code=code)
    assert result.returncode == 70
    assert "error[SC999]: internal error: ZeroDivisionError: oops" in result.stdout
    assert f"--> {good}\n" in result.stdout
    assert "please report" in result.stdout
    assert ", in fail" in result.stderr


@pytest.mark.parametrize(
    ("variable", "value", "coloured"), [("NO_COLOR", "", True), ("NO_COLOR", "1", False)]
)
def test_colours_on_a_terminal(bad: Path, variable: str, value: str, coloured: bool) -> None:
    main, terminal = pty.openpty()
    environment = {**ENVIRONMENT, "TERM": "xterm", variable: value}
    process = subprocess.Popen(
        [*COMMAND, "check", str(bad)], cwd=ROOT, env=environment, stdout=terminal, stderr=subprocess.DEVNULL
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
        assert process.wait(60) == 1
    assert (b"\x1b[1;31merror[SC103]" in shown) is coloured
    assert b"SC103" in shown


def test_the_screen_cannot_be_controlled_by_a_program(tmp_path: Path) -> None:
    file = tmp_path / "evil.scenic"
    file.write_text("x = '\x1b[2J' $\n")
    result = run("check", file)
    assert result.returncode == 1
    assert "\x1b" not in result.stdout


def test_output_that_the_terminal_cannot_show(tmp_path: Path) -> None:
    file = tmp_path / "greek.scenic"
    file.write_text("α = 'é' $\n")
    result = subprocess.run(
        [*COMMAND, "check", str(file)],
        cwd=ROOT,
        env={**ENVIRONMENT, "PYTHONIOENCODING": "ascii"},
        capture_output=True,
        timeout=60,
        check=False,
    )
    assert result.returncode == 1
    assert rb"\u03b1 = '\xe9' $" in result.stdout


def test_tree_and_python(good: Path, bad: Path) -> None:
    tree = run("ast", good)
    assert tree.returncode == 0
    assert tree.stdout.startswith("Module(")
    assert "New(" in tree.stdout
    assert "lineno=1" in run("ast", "--positions", good).stdout
    python = run("python", good)
    assert python.returncode == 0
    compile(python.stdout, "shown", "exec")
    assert python.stdout.strip()
    broken = run("python", bad)
    assert (broken.returncode, broken.stdout) == (1, "")
    assert "error[SC103]" in broken.stderr
    partial = run("ast", bad)
    assert partial.returncode == 1
    assert "ErrorStatement(" in partial.stdout


def test_deep_trees_are_refused_in_words(tmp_path: Path) -> None:
    file = tmp_path / "deep.scenic"
    file.write_text("x = " + "not " * 20_000 + "True\n")
    for command in ("ast", "python"):
        result = run(command, file)
        assert result.returncode == 1
        assert "error[SC112]" in result.stderr


def test_deep_runs_programs_in_two_dimensions_if_asked_to(tmp_path: Path) -> None:
    file = tmp_path / "high.scenic"
    file.write_text("ego = new Object at (0, 0, Range(2, 3))\nrequire ego.position.z > 2.5\n")
    assert run("check", "--deep", file).returncode == 0
    assert run("check", "--2d", file).returncode == 0
    result = run("check", "--deep", "--2d", file)
    assert result.returncode == 1
    assert "line 2" in result.stdout or ":2:1" in result.stdout


def test_deep_adds_what_analysis_proves(good: Path) -> None:
    result = run("check", "--deep", "--format", "json", good)
    assert result.returncode == 1, result.stderr
    (found,) = json.loads(result.stdout)["diagnostics"]
    assert (found["code"], found["severity"], found["span"]["line"]) == ("SC701", "warning", 2)
    good.write_text(GOOD.replace("> 0", "> 0  # scenic: ignore[SC701]"))
    assert run("check", "--deep", good).returncode == 0
    assert run("check", good).returncode == 0


def test_the_error_of_which_there_is_more_to_read_is_an_error(tmp_path: Path) -> None:
    """Not the warning before it."""
    file = tmp_path / "both.scenic"
    file.write_text("import math\nego = new Object\nx = egoo\n")
    result = run("check", file)
    found = json.loads(run("check", "--format", "json", file).stdout)["diagnostics"]
    assert [item["severity"] for item in found] == ["warning", "error"]
    assert f"scenic explain {found[1]['code']}\n" in result.stderr
    file.write_text("import math\nego = new Object\n")
    assert "scenic explain" not in run("check", file).stderr


def test_faults_of_ours_in_other_commands_ask_for_a_report(
    good: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """With the way to where they came up, which is to be sent."""

    def fail(*_: object, **__: object) -> None:
        raise ZeroDivisionError("oops")

    monkeypatch.setattr("scenic.pipeline.load", fail)
    result = run("sample", good)
    assert result.returncode == 70
    assert "error[SC999]: internal error: ZeroDivisionError: oops" in result.stderr
    assert "please report" in result.stderr
    assert ", in sample\n" in result.stderr
    assert ", in fail\n" in result.stderr


def test_reports_go_to_files_and_into_numbers(tmp_path: Path) -> None:
    program, report = tmp_path / "a.scenic", tmp_path / "report.json"
    program.write_text("import os\nimport re\nx = y\n")

    def said(*options: str) -> str:
        found = run("check", "--no-config", *options, program)
        assert found.returncode == 1, found.stderr
        return found.stdout

    assert said("--format", "json", "--output-file", str(report)) == ""
    assert len(json.loads(report.read_text())["diagnostics"]) == 3
    first, second = said("--statistics").splitlines()
    assert first.split()[:3] == ["2", "SC206", "[*]"]
    assert second.split()[:2] == ["1", "SC202"]
    assert said("--select", "SC202,ALL", "--statistics") == said("--statistics")


def test_watching_checks_again_when_something_changes(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    program = tmp_path / "a.scenic"
    program.write_text("x = 1\n")
    looks = 0

    def wait(_seconds: float) -> None:
        nonlocal looks
        looks += 1
        if looks == 1:
            (tmp_path / "helper.py").write_text("y = 2\n")
        elif looks == 3:
            raise KeyboardInterrupt

    runs: list[int] = []
    monkeypatch.setattr("scenic.cli.file_changes.time.sleep", wait)
    with pytest.raises(KeyboardInterrupt):
        watch([str(program)], lambda: runs.append(looks))
    assert runs == [0, 1]
