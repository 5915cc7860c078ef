"""The established command line is understood, and said in our words."""

import json
import runpy
import sys
from pathlib import Path

import pytest

import scenic
from scenic.cli.old_command_line import translated
from tests.cli.commands import run_here

COMMANDS = ["check", "sample", "ast", "python", "simulate"]


@pytest.mark.parametrize(
    ("theirs", "ours"),
    [
        ("x.scenic", "sample x.scenic"),
        ("--2d x.scenic", "sample x.scenic --2d"),
        ("-s 3 x.scenic --count 5", "sample x.scenic --seed 3 -n 5"),
        ("x.sc -p time 12 --param a b", "sample x.sc -p time=12 -p a=b --extra-params"),
        ('x.scenic -p a 1,2 -p b "c"', 'sample x.scenic -p a="1,2" -p b="\\"c\\"" --extra-params'),
        ("x.scenic -m world --scenario Main -v 2", "sample x.scenic --model world --scenario Main"),
        ("x.scenic --gather-stats -20 --no-pruning", "sample x.scenic -n 20 --no-prune"),
        ("--pdb -b x.scenic --show-params -z 2 -d 0.5", "sample x.scenic --show-params"),
        ("x.scenic --show-records -S", "simulate x.scenic --show-records"),
        ("x.scenic --show-records", "sample x.scenic"),
        ("--dump-ast x.scenic", "ast x.scenic"),
        ("x.scenic --dump-python", "python x.scenic"),
        ("-S x.scenic --time 100 --count=2", "simulate x.scenic -n 2 --time 100"),
        ("-S x.scenic --max-sims-per-scene 3 --no-pruning", "simulate x.scenic --tries 3"),
        ("check x.scenic", None),
        ("x.scenic y.scenic", None),
        ("x.scenic --unknown", None),
        ("--version", None),
    ],
)
def test_options_are_translated(theirs: str, ours: str | None) -> None:
    found = translated(theirs.split(), COMMANDS)
    assert found == (None if ours is None else ours.split())


def test_the_module_is_the_command(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    """``python -m scenic``, as existing scripts call it."""
    monkeypatch.setattr(sys, "argv", ["scenic", "explain", "SC900"])
    with pytest.raises(SystemExit) as ended:
        runpy.run_module("scenic", run_name="__main__")
    assert ended.value.code == 0
    assert "SC900" in capsys.readouterr().out
    # Workers that import it again run no command.
    runpy.run_module("scenic.__main__", run_name="__mp_main__")


PROGRAM = """
from scenic.core.simulators import DummySimulator
simulator DummySimulator(drift=1)
param place = "here", sizes = [1, 2]
ego = new Object
record ego.y as path
record initial (1, 2) as first
record final ego.x as last
"""


def test_parameters_and_records_are_shown(tmp_path: Path) -> None:
    (tmp_path / "x.scenic").write_text(PROGRAM)
    done = run_here(
        [
            "-S",
            "x.scenic",
            "--time",
            "2",
            "--count",
            "1",
            "--show-params",
            "--show-records",
            "-p",
            "extra",
            "1,2",
            "-p",
            "sizes",
            "5",
            "-s",
            "3",
        ],
        folder=tmp_path,
    )
    assert done.returncode == 0
    assert done.stdout.splitlines()[1:] == [
        '  parameter place = "here"',
        "  parameter sizes = 5",
        '  parameter extra = "1,2"',
        "  record first = [1, 2]",
        "  record path:",
        "    0: 0.0",
        "    1: 1.0",
        "    2: 2.0",
        "  record last = 0.0",
    ]
    done = run_here(
        ["x.scenic", "--count", "2", "--show-params", "-p", "extra", "no", "-s", "3"], folder=tmp_path
    )
    assert [json.loads(line)["params"]["extra"] for line in done.stdout.splitlines()] == ["no", "no"]
    shown = "scene 0:\n  place = here\n  sizes = [1, 2]\n  extra = no\n"
    assert done.stderr.endswith(shown + shown.replace("0", "1"))
    done = run_here(
        ["sample", "x.scenic", "--show-params", "-p", "place=3", "-o", "out.jsonl", "--seed", "1"],
        folder=tmp_path,
    )
    assert done.stdout == "scene 0:\n  place = 3\n  sizes = [1, 2]\n"
    # The parameter is the program's own only in the other command line.
    assert run_here(["sample", "x.scenic", "-p", "extra=3"], folder=tmp_path).returncode == 2


def test_kept_simulations_tell_their_parameters(tmp_path: Path) -> None:
    (tmp_path / "x.scenic").write_text(PROGRAM)
    command = [
        "simulate",
        "x.scenic",
        "--time",
        "1",
        "--seed",
        "3",
        "--show-params",
        "-o",
        "runs",
        "-p",
        "place=1,2",
    ]
    first, again = (run_here([*command, *more], folder=tmp_path).stdout for more in ([], ["--resume"]))
    assert first == again
    assert [line for line in first.splitlines() if "place = " in line] == [
        "  parameter place = 1",
        "  parameter place = 2",
    ]
    assert (
        scenic.read_trajectory(tmp_path / "runs" / "place=2" / "simulation-0000.jsonl").about["params"][
            "place"
        ]
        == 2
    )
