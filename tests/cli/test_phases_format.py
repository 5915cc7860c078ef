"""Phases in which programs would fail: what ``scenic check --format phases`` says is so when they run."""

from pathlib import Path

import pytest

from scenic.cli.render.phases_format import PASSES
from scenic.language.errors import ParseCompileError
from scenic.pipeline import scenarioFromString
from scenic.runtime.sampling.rejection_report import Exhausted
from scenic.simulators.dummy import DummySimulator
from tests.cli.commands import run_here

PROGRAMS = {
    "open bracket": ("ego = new Object at (1, 2\n", "parse"),
    "old form": ("ego = new Object facing toward\n", "parse"),
    "undefined name": ("ego = new Object\nx = undefined_name\n", "load"),
    "random condition": (
        "x = Range(0, 1)\nego = new Object\nif x > 0.5:\n    new Object at (9, 9)\n",
        "load",
    ),
    "wrong value": ('ego = new Object with width "3"\n', "load"),
    "wrong in a behavior": (
        "behavior Go():\n    wait\n    x = Vector(1, 2).lenght()\nego = new Object with behavior Go\n",
        "simulate",
    ),
    "wrong in a monitor": (
        "monitor Watch():\n    wait\n    x = Vector(1, 2).lenght()\nego = new Object\nrequire monitor Watch()\n",
        "simulate",
    ),
    "wrong in both": (
        "behavior Go():\n    wait\n    x = Vector(1, 2).lenght()\nego = new Objekt with behavior Go\n",
        "load",
    ),
    "undefined name in a behavior": (
        "behavior Go():\n    wait\n    x = undefined_name\nego = new Object with behavior Go\n",
        "load",
    ),
    "right": ("ego = new Object at (Range(0, 9), 0)\nrequire ego.x > 3\n", PASSES),
}
IMPOSSIBLE = ("ego = new Object at (Range(0, 9), 0)\nrequire ego.x > 12\n", "sample")


def phase_of_run(text: str) -> str:
    """The phase in which a run really fails."""
    try:
        scenario = scenarioFromString(text)
    except ParseCompileError as error:
        return "parse" if error.diagnostics[0].code.startswith("SC1") else "load"
    except Exception:  # noqa: BLE001 - whatever a program raises
        return "load"
    (scene,) = scenario.stream(1, seed=0, max_attempts=50)
    if isinstance(scene, Exhausted):
        return "sample"
    try:
        DummySimulator().simulate(scene, maxSteps=4)
    except Exception:  # noqa: BLE001 - whatever a behavior raises
        return "simulate"
    return PASSES


@pytest.mark.parametrize("name", PROGRAMS)
def test_the_oracle_agrees(name: str) -> None:
    text, phase = PROGRAMS[name]
    assert phase_of_run(text) == phase


def test_a_corpus(tmp_path: Path) -> None:
    for name, (text, _) in PROGRAMS.items():
        (tmp_path / f"{name}.scenic").write_text(text)
    done = run_here(["check", ".", "--format", "phases"], folder=tmp_path)
    *rows, total = done.stdout.splitlines()
    found = {row[10:].partition(".scenic")[0]: row[:10].strip() for row in rows}
    assert found == {name: phase for name, (_, phase) in PROGRAMS.items()}
    assert total == "10 programs: 2 parse, 5 load, 2 simulate, 1 passes"
    assert done.returncode == 1


def test_what_analysis_proves(tmp_path: Path) -> None:
    text, phase = IMPOSSIBLE
    assert phase_of_run(text) == phase
    (tmp_path / "program.scenic").write_text(text)
    done = run_here(["check", "program.scenic", "--deep", "--format", "phases"], folder=tmp_path)
    assert done.stdout.startswith("sample    program.scenic:2: SC700 ")
