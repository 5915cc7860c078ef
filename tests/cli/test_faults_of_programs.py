"""What commands tell of programs that fail, end themselves or do not end, while they run and on samples."""

from pathlib import Path
from typing import Any

import pytest

import scenic
from scenic.cli import sample
from scenic.failures import diagnose
from tests.cli.commands import run_here

TOOLS = "def boom(v):\n    raise ValueError(f'boom')\ndef root(v):\n    import math\n    return math.sqrt(-1 - v)\n"

CASES = [
    # (program, code, the line of the program, what is shown beside it)
    ("import tools\ny = tools.boom(1)\n", "SC400", 2, "tools.py:2:5: raised here"),
    ("import tools\nx = Range(0, 1)\nrequire tools.boom(x)\n", "SC501", 3, "tools.py:2:5: raised here"),
    ("import tools\nx = Range(0, 1)\nrequire tools.root(x) > 0\n", "SC501", 3, "tools.py:5:12: raised here"),
    ("import tools\nego = new Object with tag tools.root(3)\n", "SC400", 2, "tools.py:5:12: raised here"),
    ("x = Range(0, 1)\ndef f(v):\n    return v / 0\nrequire f(x)\n", "SC501", 4, "- raised here"),
    ("import sys\nsys.exit(3)\n", "SC401", 2, "ended itself"),
    ("import sys\nx = Range(0, 1)\ndef f(v): sys.exit(3)\nrequire f(x)\n", "SC401", 4, "ended itself"),
    ("import sys\nx = Range(0, 1)\nparam y = distributionFunction(sys.exit)(x)\n", "SC401", 3, "ended itself"),
]  # fmt: skip


@pytest.mark.parametrize(("text", "code", "line", "shown"), CASES, ids=[case[0] for case in CASES])
def test_programs_that_fail(tmp_path: Path, text: str, code: str, line: int, shown: str) -> None:
    (tmp_path / "tools.py").write_text(TOOLS)
    program = tmp_path / "program.scenic"
    program.write_text(text)
    result = run_here(["sample", program.name, "--seed", 1], folder=tmp_path)
    assert result.returncode == 1
    assert f"error[{code}]" in result.stderr
    assert f"program.scenic:{line}:" in result.stderr
    assert shown in result.stderr
    assert "help: " in result.stderr
    assert result.stdout == ""


def test_an_end_that_a_requirement_rejects_is_none(tmp_path: Path) -> None:
    program = tmp_path / "program.scenic"
    program.write_text(
        "import sys\nx = Range(0, 1)\ndef f(v):\n    if v > 0.2: sys.exit(3)\n    return True\n"
        "def g(v): return v < 0.2\nrequire f(x)\nrequire g(x)\nparam x = x\n"
    )
    result = run_here(["sample", program.name, "--seed", 1, "-n", 3], folder=tmp_path)
    assert result.returncode == 0, result.stderr
    assert result.stdout.count("\n") == 3


ENDLESS = [
    ("while True: pass\n", 1, "still being run when the time limit of 0.5 s was over"),
    ("import time\ntime.sleep(60)\n", 2, "still being run when the time limit of 0.5 s was over"),
    ("try:\n    while True: pass\nexcept Exception:\n    while True: pass\n", 2, "still being run"),
    ("x = Range(0, 1)\ndef f(v):\n    while True: pass\nrequire f(x)\n", 3, "a candidate was still being evaluated"),
]  # fmt: skip


@pytest.mark.parametrize(("text", "line", "message"), ENDLESS, ids=[case[0] for case in ENDLESS])
def test_programs_that_do_not_end(
    tmp_path: Path, text: str, line: int, message: str, monkeypatch: Any
) -> None:
    monkeypatch.setattr(sample, "PATIENCE", 0.2)
    program = tmp_path / "program.scenic"
    program.write_text(text)
    result = run_here(["sample", program.name, "--seed", 1, "--time-limit", "0.5"], folder=tmp_path)
    assert result.returncode == 1
    assert "error[SC608]" in result.stderr
    assert message in result.stderr
    assert f"program.scenic:{line}:" in result.stderr


@pytest.mark.parametrize("option", [None, "-b", "--full-backtrace"])
def test_all_calls_of_an_exception_are_shown_where_that_is_wanted(tmp_path: Path, option: str | None) -> None:
    """Also of our own frames; the exit code and the diagnostic are the same."""
    (tmp_path / "tools.py").write_text(TOOLS)
    (tmp_path / "program.scenic").write_text("import tools\ny = tools.boom(1)\n")
    given = [] if option is None else [option]
    result = run_here([*given, "sample", "program.scenic", "--seed", 1], folder=tmp_path)
    assert result.returncode == 1
    assert "error[SC400]" in result.stderr
    assert ("Traceback (most recent call last)" in result.stderr) is (option is not None)
    assert ("pipeline.py" in result.stderr) is (option is not None)


@pytest.mark.parametrize(
    ("arguments", "words"),
    [
        (["--resume"], "--resume does not go with standard output; it goes with JSON Lines"),
        (["--resume", "-o", "-"], "--resume does not go with standard output; it goes with JSON Lines"),
        *(
            ([*given, *sink], f"{given[0]} does not go with {name}")
            for given in (
                ["--resume"],
                ["-j", 2],
                ["--resume", "-o", "out.jsonl"],
                ["-j", 2, "-o", "out.jsonl"],
            )
            for *sink, name in (
                ["--view", "page.html", "a page (--view)"],
                ["--png", "images", "images (--png)"],
            )
        ),
        (["--resume", "-o", "out.glb"], "--resume does not go with 3D files"),
        (["-j", 2, "-o", "out.glb"], "-j does not go with 3D files"),
        (["--overlay"], "--overlay is for labelled images (--camera NAME)"),
        (["--minimize", "1"], "--minimize is for --sampler"),
        (
            ["--format", "tar", "-o", "out/"],
            "--format tar does not go with data sets (-o FOLDER/): give parquet or jsonl",
        ),
        (["--sampler", "halton", "-j", 2], "-j does not go with --sampler"),
        (["--approximate", 4, "--sobol"], "--sobol does not go with --approximate"),
        (["--show-params", "-j", 2], "--show-params does not go with several processes"),
        (["--profile", "-o", "x.jsonl"], "--profile makes no files"),
        (["--verify"], "--verify does not go with standard output"),
        (["--verify", "-o", "out/"], "--verify and --accept-changes go with --resume"),
        (["--camera", "ego"], "--camera needs a folder"),
    ],
)
def test_options_that_do_not_go_together_are_wrong_usage(
    tmp_path: Path, arguments: list[object], words: str
) -> None:
    """Told before anything is sampled or written."""
    (tmp_path / "program.scenic").write_text("ego = new Object\n")
    result = run_here(["sample", "program.scenic", "--seed", 1, *arguments], folder=tmp_path)
    assert result.returncode == 2
    assert words in " ".join(result.stderr.split())
    assert [path.name for path in tmp_path.iterdir()] == ["program.scenic"]


def test_the_script_that_called_is_no_place_of_the_fault() -> None:
    with pytest.raises(TypeError) as caught:
        scenic.scenarioFromString("x = Range(0, 1)\nparam y = x + 'a'\n").sample(1)
    found = diagnose(caught.value)
    assert found is not None
    assert found.code == "SC501"
    assert not found.labels
