"""The established command line is understood, and said in our words."""

import runpy
import sys

import pytest

from scenic.cli.old_command_line import translated

COMMANDS = ["check", "sample", "ast", "python", "simulate"]


@pytest.mark.parametrize(
    ("theirs", "ours"),
    [
        ("x.scenic", "sample x.scenic"),
        ("--2d x.scenic", "sample x.scenic --2d"),
        ("-s 3 x.scenic --count 5", "sample x.scenic --seed 3 -n 5"),
        ("x.sc -p time 12 --param a b", "sample x.sc -p time=12 -p a=b"),
        ("x.scenic -m world --scenario Main -v 2", "sample x.scenic --model world --scenario Main"),
        ("x.scenic --gather-stats -20 --no-pruning", "sample x.scenic -n 20 --no-prune"),
        ("--pdb -b x.scenic --show-params -z 2 -d 0.5", "sample x.scenic"),
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
